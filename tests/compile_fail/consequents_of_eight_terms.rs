//! An output has at most seven terms.
use fixed::types::I8F8;
use fuzzypilot::fuzzy::Consequents;

pub static SPEED: Consequents<8, I8F8> = Consequents::new(
    [I8F8::lit("0"), I8F8::lit("9")],
    [
        I8F8::lit("1"),
        I8F8::lit("2"),
        I8F8::lit("3"),
        I8F8::lit("4"),
        I8F8::lit("5"),
        I8F8::lit("6"),
        I8F8::lit("7"),
        I8F8::lit("8"),
    ],
);

fn main() {}
