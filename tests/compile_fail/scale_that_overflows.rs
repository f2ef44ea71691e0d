//! A scale may not carry a peak out of the output's format: 2 × 100 is more than I8F8 holds.
use fixed::types::{I8F8, I16F16};
use fuzzypilot::fuzzy::Consequents;

pub static SPEED: Consequents<2, I8F8> = Consequents::scaled(
    [I16F16::lit("0"), I16F16::lit("3")],
    [I16F16::lit("1"), I16F16::lit("2")],
    I16F16::lit("100"),
);

fn main() {}
