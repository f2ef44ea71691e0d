//! A controller's sizes are its system's.
use fuzzypilot::fuzzy::system::shape::ramp;
use fuzzypilot::fuzzy::system::{
    Block, Controller, Defuzzifier, Input, Literal::Is, Merge, Number::Constant, Output, Rule,
    System,
};

pub static SYSTEM: Controller<1, 2, 3, 1> = Controller::new(System::new(
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
            terms: &[Constant(0), Constant(100)],
        },
    }],
));

fn main() {}
