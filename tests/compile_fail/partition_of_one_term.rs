//! A partition needs two terms: with one there is nothing between peaks.
use fixed::types::I16F16;
use fuzzypilot::fuzzy::Partition;

pub static DISTANCE: Partition<1> = Partition::new([I16F16::lit("0")]);

fn main() {}
