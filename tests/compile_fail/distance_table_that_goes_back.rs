//! Points are given nearest first.
use fuzzypilot::ports::analog::DistanceTable;

pub static BACKWARDS: DistanceTable<3> = DistanceTable::new([(400, 800), (1300, 200), (2300, 100)]);

fn main() {}
