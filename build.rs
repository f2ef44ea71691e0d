//! Gives the firmware its linker scripts. Not in `.cargo/config.toml`: there they would reach every bare-metal image of
//! the workspace, and the others have scripts of their own.

fn main() {
    println!("cargo::rerun-if-changed=build.rs");
    println!("cargo::rerun-if-changed=memory.x");
    let is = |name, value| std::env::var(name).is_ok_and(|found| found == value);
    if is("TARGET", "thumbv7em-none-eabihf") {
        let mut arguments = vec!["-Tlink.x", "-Tdefmt.x"];
        if is("PROFILE", "debug") {
            // See memory.x.
            arguments.push("--defsym=_debug_build=1");
        }
        for argument in arguments {
            println!("cargo::rustc-link-arg-bin=fuzzypilot={argument}");
        }
    }
}
