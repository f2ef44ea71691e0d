//! Tells the linker where `memory.x` is.

fn main() {
    println!("cargo::rerun-if-changed=memory.x");
    if let Ok(here) = std::env::var("CARGO_MANIFEST_DIR") {
        println!("cargo::rustc-link-search={here}");
    }
}
