//! Weighted sums fit the accumulator whatever fires.
use fuzzypilot::fuzzy::system::shape::ramp;
use fuzzypilot::fuzzy::system::{
    Block, Defuzzifier, Input, Literal::Is, Merge, Number::Constant, Output, Rule, System,
};

const RULE: Rule = Rule::new(&[&[Is(0, 0)]], &[(0, 0)]);

pub static SYSTEM: System = System::new(
    &[Input::new([0, 10], &[&ramp(10, 0), &ramp(0, 10)])],
    &[Block::min(&[RULE; 513])],
    &[Output {
        range: [0, 1 << 29],
        clamp: false,
        default: 0,
        complete: false,
        defuzzifier: Defuzzifier::WeightedAverage {
            merge: Merge::Sum,
            terms: &[Constant(1 << 29)],
        },
    }],
);

fn main() {}
