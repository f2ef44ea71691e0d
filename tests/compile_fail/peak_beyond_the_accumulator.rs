//! The most negative number of the format would overflow the weighted sum.
use fixed::types::I8F8;
use fuzzypilot::fuzzy::Consequents;

pub static SPEED: Consequents<2, I8F8> = Consequents::new(
    [I8F8::lit("-128"), I8F8::lit("3")],
    [I8F8::lit("-128"), I8F8::lit("3")],
);

fn main() {}
