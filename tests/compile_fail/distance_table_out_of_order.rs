//! Nearer than 8 cm a GP2Y0A21's voltage falls again: no table can hold both branches.
use fuzzypilot::ports::analog::DistanceTable;

pub static BOTH_BRANCHES: DistanceTable<3> = DistanceTable::new([(1300, 40), (3100, 70), (2300, 100)]);

fn main() {}
