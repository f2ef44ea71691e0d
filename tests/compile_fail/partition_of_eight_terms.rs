//! A partition has at most seven terms.
use fixed::types::I16F16;
use fuzzypilot::fuzzy::Partition;

pub static DISTANCE: Partition<8> = Partition::new([
    I16F16::lit("0"),
    I16F16::lit("1"),
    I16F16::lit("2"),
    I16F16::lit("3"),
    I16F16::lit("4"),
    I16F16::lit("5"),
    I16F16::lit("6"),
    I16F16::lit("7"),
]);

fn main() {}
