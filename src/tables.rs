//! The rule tables as const data, each with its source, its variants and its axes.

pub mod clutter;
pub mod coarse;
pub mod fine;
