//! A linear term stays in the range for every input.
use fuzzypilot::fuzzy::system::shape::ramp;
use fuzzypilot::fuzzy::system::{
    Block, Defuzzifier, Input, Linear, Literal::Is, Merge, Number, Number::Constant, Output, Rule,
    System,
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
        defuzzifier: Defuzzifier::WeightedAverage {
            merge: Merge::Sum,
            terms: &[
                Constant(0),
                Number::Linear(Linear {
                    coefficients: &[11],
                    shift: 0,
                    constant: 0,
                }),
            ],
        },
    }],
);

fn main() {}
