#![no_std]
//! What recorder, player and images share: the tape's form, and how an image starts, counts and writes.
//!
//! The tick is deterministic and a tape holds all its inputs. So as long as every output agrees with the recorded one,
//! playing a tape in open loop *is* the closed loop that was recorded: the plant would have answered the same.

pub mod fine;
pub mod navigation;
pub mod shapes;
pub mod systems;
pub mod tape;

#[cfg(target_os = "none")]
pub mod clock;
#[cfg(target_os = "none")]
pub mod files;
#[cfg(target_os = "none")]
pub mod owned;
#[cfg(target_os = "none")]
pub mod shell;
#[cfg(target_os = "none")]
pub mod stack;
#[cfg(target_os = "none")]
pub mod start;
