//! Gives the images their linker script: one layout, three memories.
//!
//! The script is no `memory.x`: the linker would take the one at the workspace's root, which is the firmware's.

use std::path::PathBuf;

fn main() {
    println!("cargo::rerun-if-changed=image.x");
    let target = std::env::var("TARGET").unwrap_or_default();
    let [flash, flash_size, ram, ram_size] = match target.as_str() {
        // QEMU's netduinoplus2, microbit, sifive_e.
        "thumbv7em-none-eabihf" => ["0x08000000", "1M", "0x20000000", "128K"],
        "thumbv6m-none-eabi" => ["0x00000000", "256K", "0x20000000", "16K"],
        "riscv32imc-unknown-none-elf" => ["0x20400000", "512M", "0x80000000", "16K"],
        _ => return,
    };
    let memory = format!(
        "MEMORY {{\n  FLASH : ORIGIN = {flash}, LENGTH = {flash_size}\n  RAM : ORIGIN = {ram}, LENGTH = {ram_size}\n}}\n"
    );
    let folder = PathBuf::from(std::env::var_os("OUT_DIR").expect("cargo sets it"));
    let script = folder.join("replica.x");
    std::fs::write(&script, memory + include_str!("image.x"))
        .expect("the build folder can be written");
    println!("cargo::rustc-link-arg-bins=-T{}", script.display());
}
