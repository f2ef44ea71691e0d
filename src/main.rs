//! The firmware for boards with an STM32F411: WeAct Black Pill and Nucleo-F411RE. Wiring and first drive:
//! `docs/wiring.md`.
//!
//! Only this file and its parts in `main/` name a chip; what the robot does is the library's.
#![cfg_attr(target_os = "none", no_std, no_main)]
// Registers, and statics that an interrupt owns.
#![allow(unsafe_code)]

#[cfg(target_os = "none")]
#[path = "main/board.rs"]
mod board;

#[cfg(not(target_os = "none"))]
fn main() {
    println!("this is the firmware of a board: `cargo fw` builds it, `cargo sim` is the simulator");
}
