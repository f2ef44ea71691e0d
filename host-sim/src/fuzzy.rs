//! Fuzzy systems from design files: what they say ([`model`]), read, checked, evaluated in `f64` and in the library's fixed
//! point, written again. They need no robot.

pub mod check;
pub mod describe;
pub mod evaluate;
pub mod files;
pub mod lower;
pub mod membership;
pub mod model;
pub mod picture;
pub mod random;

#[cfg(test)]
mod sample;
