//! A set that is made at an output's samples has a degree for each.
use fuzzypilot::fuzzy::Grade;
use fuzzypilot::fuzzy::system::Samples;
use fuzzypilot::fuzzy::system::shape::ramp;

pub static FAST: [Grade; 5] = Samples::ends([0, 100], 4).of(&ramp(0, 100));

fn main() {}
