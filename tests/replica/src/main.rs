//! The player: plays every tape of the file `tape` in the emulator's folder and writes the file `out`.
//!
//! By the tape's mode `out` holds every record's canonical bytes, or words: see `image`.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image;

#[cfg(not(target_os = "none"))]
fn main() {
    eprintln!("replica runs on emulated microcontrollers: `cargo bit-exact`, `cargo budgets`");
    std::process::exit(2);
}
