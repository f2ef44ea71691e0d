//! Fuzzy systems from design files: what they say ([`model`]), read, checked, evaluated in `f64` and in the library's fixed
//! point, written again. They need no robot.

pub mod model;
