//! Equal peaks leave no interval between two terms.
use fixed::types::I16F16;
use fuzzypilot::fuzzy::Partition;

pub static DISTANCE: Partition<3> = Partition::new([
    I16F16::lit("0"),
    I16F16::lit("1"),
    I16F16::lit("1"),
]);

fn main() {}
