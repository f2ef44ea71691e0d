//! A system has a rule.
use fuzzypilot::fuzzy::system::shape::ramp;
use fuzzypilot::fuzzy::system::{
    Block, Defuzzifier, Input, Merge, Number::Constant, Output, System,
};

pub static SYSTEM: System = System::new(
    &[Input::new([0, 10], &[&ramp(10, 0), &ramp(0, 10)])],
    &[Block::min(&[])],
    &[Output {
        range: [0, 100],
        clamp: false,
        default: 0,
        complete: false,
        defuzzifier: Defuzzifier::WeightedAverage {
            merge: Merge::Sum,
            terms: &[Constant(0), Constant(100)],
        },
    }],
);

fn main() {}
