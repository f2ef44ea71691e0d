//! Samples ascend, as their range does.
use fuzzypilot::fuzzy::system::Samples;

pub static SAMPLES: Samples = Samples::ends([100, 0], 4);

fn main() {}
