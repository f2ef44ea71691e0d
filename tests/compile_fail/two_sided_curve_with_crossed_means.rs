//! Between its means a two-sided curve is one: they ascend.
use fuzzypilot::fuzzy::system::shape::{ramp, two_sided_gaussian};
use fuzzypilot::fuzzy::system::{
    Block, Defuzzifier, Input, Literal::Is, Merge, Number::Constant, Output, Rule, System,
};

pub static SYSTEM: System = System::new(
    &[Input::new(
        [0, 10],
        &[&two_sided_gaussian::<8>((6, 2), (3, 2)), &ramp(0, 10)],
    )],
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
