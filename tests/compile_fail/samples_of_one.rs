//! One sample would be the output's only value.
use fuzzypilot::fuzzy::system::Samples;

pub static SAMPLES: Samples = Samples::ends([0, 100], 1);

fn main() {}
