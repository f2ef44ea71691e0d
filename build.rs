//! Gives the firmware its linker scripts, and the fuzzy engine what it must know of the processor.
//!
//! The scripts are not in `.cargo/config.toml`: there they would reach every bare-metal image of the workspace, and the
//! others have scripts of their own.

fn main() {
    processor();
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

/// Two kinds of processor that the compiler does not tell apart by a stable `cfg`. The results are the same on all.
fn processor() {
    let target = std::env::var("TARGET").unwrap_or_default();
    // No division, and of a product the lower half alone.
    println!("cargo::rustc-check-cfg=cfg(narrow)");
    if target.starts_with("thumbv6m") {
        println!("cargo::rustc-cfg=narrow");
    }
    // Products and sums of two 16-bit numbers in one register.
    println!("cargo::rustc-check-cfg=cfg(dsp)");
    if target.starts_with("thumbv7em") {
        println!("cargo::rustc-cfg=dsp");
    }
}
