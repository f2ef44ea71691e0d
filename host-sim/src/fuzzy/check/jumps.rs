//! Values at which a term jumps. Within two steps of one, a rounded input may be on the other side than the exact one; so
//! fixed point and `f64` are not compared there.

use crate::fuzzy::lower::Lowered;
use crate::fuzzy::model::{Input, System};

/// The jumps of all inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Jumps {
    /// Each input's, and how near is too near.
    inputs: Vec<(Vec<f64>, f64)>,
}

impl Jumps {
    /// Of a system in these steps.
    pub fn of(system: &System, lowered: &Lowered) -> Self {
        let steps = lowered
            .tables()
            .inputs
            .iter()
            .map(|input| input.format.value(1));
        Self {
            inputs: system
                .inputs
                .iter()
                .zip(steps)
                .map(|(input, step)| (jumps(input), 2.0 * step))
                .collect(),
        }
    }

    /// Whether any of a point's values is too near to one.
    pub fn near(&self, point: &[f64]) -> bool {
        (0..point.len()).any(|input| self.near_in(input, point[input]))
    }

    /// Whether an input's value is too near to one.
    pub fn near_in(&self, input: usize, x: f64) -> bool {
        let of = self.inputs.get(input);
        of.is_some_and(|(jumps, near)| jumps.iter().any(|jump| (x - jump).abs() <= *near))
    }
}

fn jumps(input: &Input) -> Vec<f64> {
    input
        .terms
        .iter()
        .flat_map(|term| term.shape.jumps())
        .collect()
}
