//! An output's peaks ascend, or its terms' names would lie.
use fixed::types::I8F8;
use fuzzypilot::fuzzy::Consequents;

pub static SPEED: Consequents<3, I8F8> = Consequents::new(
    [I8F8::lit("0"), I8F8::lit("3")],
    [I8F8::lit("0.5"), I8F8::lit("2"), I8F8::lit("1")],
);

fn main() {}
