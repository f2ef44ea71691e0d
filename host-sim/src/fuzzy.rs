//! Fuzzy systems from design files: what they say ([`model`]), read, checked, evaluated in `f64` and in the library's fixed
//! point, written again. They need no robot.

pub mod check;
pub mod describe;
pub mod emit;
pub mod evaluate;
pub mod fast;
pub mod files;
pub mod lower;
pub mod membership;
pub mod model;
pub mod picture;
pub mod random;
pub mod tune;

#[cfg(test)]
mod sample;
