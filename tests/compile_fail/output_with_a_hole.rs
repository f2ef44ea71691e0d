//! An output that claims to be complete has a rule for all terms together.
use fuzzypilot::fuzzy::system::shape::ramp;
use fuzzypilot::fuzzy::system::{
    Block, Defuzzifier, Input, Literal::Is, Merge, Number::Constant, Output, Rule, System,
};

pub static SYSTEM: System = System::new(
    &[
        Input::new([0, 10], &[&ramp(10, 0), &ramp(0, 10)]),
        Input::new([0, 10], &[&ramp(10, 0), &ramp(0, 10)]),
    ],
    &[Block::min(&[Rule::new(
        &[&[Is(0, 0)], &[Is(0, 1), Is(1, 0)]],
        &[(0, 0)],
    )])],
    &[Output {
        range: [0, 100],
        clamp: false,
        default: 0,
        complete: true,
        defuzzifier: Defuzzifier::WeightedAverage {
            merge: Merge::Sum,
            terms: &[Constant(0), Constant(100)],
        },
    }],
);

fn main() {}
