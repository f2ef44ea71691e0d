//! A system has an output.
use fuzzypilot::fuzzy::system::shape::ramp;
use fuzzypilot::fuzzy::system::{Block, Input, System};

pub static SYSTEM: System = System::new(
    &[Input::new([0, 10], &[&ramp(10, 0), &ramp(0, 10)])],
    &[Block::min(&[])],
    &[],
);

fn main() {}
