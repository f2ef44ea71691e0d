//! More samples than a centroid's sums have room for.
use fuzzypilot::fuzzy::system::Samples;

pub static SAMPLES: Samples = Samples::middles([0, 100], 1025);

fn main() {}
