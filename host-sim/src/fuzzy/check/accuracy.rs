//! How far fixed point is from `f64`, measured point by point and told by how strongly rules fire: where the strongest rule
//! about an output has only a few steps of a degree left, so does the output.

use crate::fuzzy::evaluate::{Evaluation, rules};
use crate::fuzzy::model::{Output, System};

/// Classes of strength: each has the points where some rule about the output has at least this degree (above zero in
/// the last).
pub const STRENGTHS: [f64; 4] = [0.5, 0.125, 1.0 / 64.0, 0.0];

/// Nothing is compared where the strongest rule fires with less, and yet fires: below 1e-308 a degree in `f64` has few
/// digits and then one, and products with it even earlier, so that the quotient of two of them is anything.
pub const FAINTEST: f64 = 1e-290;

/// The error of one output over the points of one class.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Class {
    /// Number of points.
    pub points: usize,
    /// Greatest error, in the output's own unit.
    pub worst: f64,
    /// Where that was; empty without points.
    pub at: Vec<f64>,
    /// Sum of squared errors.
    squares: f64,
}

impl Class {
    /// Root of the mean square, in the output's own unit; 0 without points.
    pub fn rms(&self) -> f64 {
        (self.squares / self.points.max(1) as f64).sqrt()
    }

    fn see(&mut self, error: f64, at: &[f64]) {
        if self.points == 0 || error > self.worst {
            self.worst = error;
            self.at = at.to_vec();
        }
        self.points += 1;
        self.squares += error * error;
    }

    fn and(self, other: Self) -> Self {
        let (points, squares) = (self.points + other.points, self.squares + other.squares);
        // Of equals the first, so that the order in which threads end does not show.
        let keep = other.points == 0 || (self.points > 0 && self.worst >= other.worst);
        Self {
            points,
            squares,
            ..if keep { self } else { other }
        }
    }
}

/// The error of one output.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Accuracy {
    /// As [`STRENGTHS`]; each includes the ones before it.
    pub classes: [Class; STRENGTHS.len()],
}

impl Accuracy {
    /// Takes one point into account: what every output is in `f64` and in fixed point. Where `f64` has no value there is
    /// nothing to compare, nor below [`FAINTEST`], and where no rule fires both take the default.
    pub fn see(
        all: &mut [Self],
        system: &System,
        at: &[f64],
        exact: &Evaluation,
        fixed: &Evaluation,
    ) {
        for (index, (accuracy, output)) in all.iter_mut().zip(&system.outputs).enumerate() {
            let value = |of: &Evaluation| of.outputs.get(index).copied().flatten();
            let (Some(expected), strength) = (value(exact), strength(system, index, exact)) else {
                continue;
            };
            if strength < FAINTEST {
                continue;
            }
            // No value at all is as wrong as the range is wide.
            let error = value(fixed).map_or_else(|| span(output), |found| (found - expected).abs());
            for (class, least) in accuracy.classes.iter_mut().zip(STRENGTHS) {
                if strength >= least {
                    class.see(error, at);
                }
            }
        }
    }

    /// Puts two halves together.
    pub fn and(self, other: Self) -> Self {
        let mut theirs = other.classes.into_iter();
        Self {
            classes: self
                .classes
                .map(|mine| mine.and(theirs.next().unwrap_or_default())),
        }
    }
}

/// The place of a strength among [`STRENGTHS`].
pub fn class(strength: f64) -> usize {
    let found = STRENGTHS.iter().position(|least| strength >= *least);
    found.unwrap_or(STRENGTHS.len() - 1)
}

/// Degree of the strongest rule about an output.
pub fn strength(system: &System, output: usize, evaluation: &Evaluation) -> f64 {
    rules(system)
        .zip(&evaluation.rules)
        .filter(|((_, rule), _)| rule.conclusions.iter().any(|c| c.0 == output))
        .fold(0.0, |most, (_, degree)| degree.max(most))
}

fn span(output: &Output) -> f64 {
    output.range.end() - output.range.start()
}
