//! The pieces of a term meet.
use fuzzypilot::fuzzy::system::shape::{ramp, triangle};
use fuzzypilot::fuzzy::system::{
    Block, Defuzzifier, Input, Literal::Is, Merge, Number::Constant, Output, Piece, Rule, System,
};

static A: [Piece; 3] = triangle(0, 4, 8);
static B: [Piece; 3] = triangle(2, 5, 9);
static MIXED: [Piece; 3] = [A[0], B[1], A[2]];

pub static SYSTEM: System = System::new(
    &[Input::new([0, 10], &[&ramp(10, 0), &MIXED])],
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
