//! Sets that rules conclude are not empty, whether the output claims to be complete or not.
use fuzzypilot::fuzzy::Grade;
use fuzzypilot::fuzzy::system::shape::ramp;
use fuzzypilot::fuzzy::system::{
    Block, Defuzzifier, Input, Literal::Is, Merge, Output, Rule, Samples, System,
};

pub static SYSTEM: System = System::new(
    &[Input::new([0, 10], &[&ramp(10, 0), &ramp(0, 10)])],
    &[Block::min(&[
        Rule::new(&[&[Is(0, 0)]], &[(0, 0)]),
        Rule::new(&[&[Is(0, 1)]], &[(0, 1)]),
    ])],
    &[Output {
        range: [0, 100],
        clamp: false,
        default: 0,
        complete: false,
        defuzzifier: Defuzzifier::Centroid {
            merge: Merge::Sum,
            samples: Samples::ends([0, 100], 4),
            terms: &[&[Grade::ONE; 4], &[Grade::ZERO; 4]],
        },
    }],
);

fn main() {}
