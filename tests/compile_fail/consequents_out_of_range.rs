//! A peak lies within the output's range.
use fixed::types::I8F8;
use fuzzypilot::fuzzy::Consequents;

pub static SPEED: Consequents<2, I8F8> = Consequents::new(
    [I8F8::lit("0"), I8F8::lit("3")],
    [I8F8::lit("0.5"), I8F8::lit("3.5")],
);

fn main() {}
