//! One look at every point of the grid, for all that is found there.

use super::accuracy::{Accuracy, FAINTEST, strength};
use super::dominance::Dominance;
use super::grid::Grid;
use super::jumps::Jumps;
use super::sampled::Sampled;
use super::watch::Watch;
use crate::fuzzy::evaluate::{Evaluator, Exact};
use crate::fuzzy::model::System;
use rayon::prelude::*;

/// Fixed point, and where not to compare it.
pub type Compared<'a> = (&'a dyn Evaluator, &'a Jumps);

/// A look at every point of a grid.
pub struct Sweep<'a> {
    /// Which system.
    pub system: &'a System,
    /// Where.
    pub grid: &'a Grid,
    /// Whether the outputs' values are kept.
    pub keep: bool,
    /// Whether it is for gaps, too.
    pub covers: bool,
    /// Who is told.
    pub watch: &'a dyn Watch,
}

/// What it shows.
pub struct Seen {
    /// Rules that are outdone.
    pub dominance: Dominance,
    /// How far fixed point is off, an entry an output.
    pub accuracy: Vec<Accuracy>,
    /// Gaps, if it was for them.
    pub sampled: Sampled,
    /// Point after point, in each every output, NaN where it has no value, infinite where that is not to be trusted (see
    /// [`FAINTEST`]); if they are kept.
    pub values: Vec<f64>,
}

impl Sweep<'_> {
    /// Looks at every point once.
    pub fn all(&self, fixed: Option<Compared<'_>>) -> Seen {
        let exact = Exact::new(self.system);
        let nothing = Seen {
            dominance: Dominance::new(self.system),
            accuracy: vec![Accuracy::default(); self.system.outputs.len()],
            sampled: Sampled::new(self.system),
            values: Vec::new(),
        };
        // Chunks of a fixed size, put together in order: sums do not depend on the number of cores.
        let starts: Vec<usize> = (0..self.grid.len()).step_by(1024).collect();
        let parts: Vec<Seen> = starts
            .into_par_iter()
            .map(|start| {
                let mut seen = nothing.empty();
                let end = (start + 1024).min(self.grid.len());
                for index in start..end {
                    self.at(index, &exact, fixed, &mut seen);
                }
                self.watch.done(end - start);
                seen
            })
            .collect();
        parts.into_iter().fold(nothing, Seen::and)
    }

    fn at(&self, index: usize, exact: &Exact<'_>, fixed: Option<Compared<'_>>, seen: &mut Seen) {
        let point = self.grid.point(index);
        let evaluation = exact.evaluate(&point);
        seen.dominance.see(&evaluation);
        if self.covers {
            seen.sampled.see(&point, &evaluation);
        }
        if self.keep {
            let values = evaluation.outputs.iter().enumerate();
            seen.values.extend(values.map(|(output, value)| {
                let faint = || {
                    let strength = strength(self.system, output, &evaluation);
                    strength > 0.0 && strength < FAINTEST
                };
                match value {
                    None => f64::NAN,
                    Some(_) if faint() => f64::INFINITY,
                    Some(value) => *value,
                }
            }));
        }
        if let Some((fixed, _)) = fixed.filter(|(_, jumps)| !jumps.near(&point)) {
            let found = fixed.evaluate(&point);
            Accuracy::see(&mut seen.accuracy, self.system, &point, &evaluation, &found);
        }
    }
}

impl Seen {
    /// One of the same system that has seen nothing; only such can be asked.
    fn empty(&self) -> Self {
        Self {
            dominance: self.dominance.clone(),
            accuracy: self.accuracy.clone(),
            sampled: self.sampled.clone(),
            values: Vec::new(),
        }
    }

    fn and(self, other: Self) -> Self {
        let accuracy = self.accuracy.into_iter().zip(other.accuracy);
        let mut values = self.values;
        values.extend(other.values);
        Self {
            dominance: self.dominance.and(other.dominance),
            accuracy: accuracy.map(|(a, b)| a.and(b)).collect(),
            sampled: self.sampled.and(other.sampled),
            values,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::evaluate::Evaluation;
    use crate::fuzzy::lower::lower;
    use crate::fuzzy::sample::fan;

    /// The exact values, off by `error` at 40 °C and 100 %.
    struct Off<'a>(Exact<'a>, f64);

    impl Evaluator for Off<'_> {
        fn evaluate(&self, inputs: &[f64]) -> Evaluation {
            let mut evaluation = self.0.evaluate(inputs);
            if inputs == [40.0, 100.0] {
                evaluation.outputs = vec![evaluation.outputs[0].map(|x| x - self.1)];
            }
            evaluation
        }
    }

    #[test]
    fn the_error_is_found_where_it_is() {
        let fan = fan();
        let (grid, jumps) = (
            Grid::new(&fan, 10_000),
            Jumps::of(&fan, &lower(&fan).unwrap()),
        );
        let off = Off(Exact::new(&fan), 0.25);
        let sweep = Sweep {
            system: &fan,
            grid: &grid,
            keep: false,
            covers: false,
            watch: &(),
        };
        let found = &sweep.all(Some((&off, &jumps))).accuracy[0].classes[0];
        assert_eq!(
            (found.worst, found.at.as_slice()),
            (0.25, &[40.0, 100.0][..])
        );
        assert!((found.rms() - 0.25 / (found.points as f64).sqrt()).abs() < 1e-12);
        assert_eq!(found.points, grid.len());
    }
}
