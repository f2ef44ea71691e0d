//! An output without a term could conclude nothing.
use fixed::types::I8F8;
use fuzzypilot::fuzzy::Consequents;

pub static SPEED: Consequents<0, I8F8> = Consequents::new([I8F8::lit("0"), I8F8::lit("3")], []);

fn main() {}
