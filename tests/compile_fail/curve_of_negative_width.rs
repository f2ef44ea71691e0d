//! A symmetric curve has no direction: its width is above zero.
use fuzzypilot::fuzzy::system::shape::{gaussian, ramp};
use fuzzypilot::fuzzy::system::{
    Block, Defuzzifier, Input, Literal::Is, Merge, Number::Constant, Output, Rule, System,
};

pub static SYSTEM: System = System::new(
    &[Input::new([0, 10], &[&gaussian::<17>(5, -3), &ramp(0, 10)])],
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
            terms: &[Constant(0), Constant(100)],
        },
    }],
);

fn main() {}
