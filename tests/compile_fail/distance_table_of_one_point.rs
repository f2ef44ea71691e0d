//! There is no line through one point.
use fuzzypilot::ports::analog::DistanceTable;

pub static POINT: DistanceTable<1> = DistanceTable::new([(2300, 100)]);

fn main() {}
