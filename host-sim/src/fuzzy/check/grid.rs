//! The points at which a system is looked at when pieces cannot tell: a dense grid with every knot in it.

use crate::fuzzy::evaluate::rules;
use crate::fuzzy::model::{Defuzzifier, Input, System};

/// Points of a grid unless told otherwise.
pub const POINTS: usize = 100_000;
/// Degrees and samples that a grid may cost before it gets thinner, and what it has at least all the same.
const MOST_WORK: usize = 2_000_000_000;
const LEAST_POINTS: usize = 2_000;

/// A grid over the ranges of all inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Each input's values, ascending.
    pub axes: Vec<Vec<f64>>,
}

impl Grid {
    /// About `points` points in all, evenly from end to end of each range; the knots of the terms, where the greatest errors
    /// lie, come on top. Costly systems get fewer.
    pub fn new(system: &System, points: usize) -> Self {
        let points = points.min((MOST_WORK / cost(system)).max(LEAST_POINTS));
        let each = (points as f64)
            .powf(1.0 / system.inputs.len().max(1) as f64)
            .round() as usize;
        Self {
            axes: system
                .inputs
                .iter()
                .map(|input| with_knots(input, each.max(2)))
                .collect(),
        }
    }

    /// `each` values an input from end to end and nothing else.
    pub fn even(system: &System, each: usize) -> Self {
        Self {
            axes: system
                .inputs
                .iter()
                .map(|input| even(input, each.max(2)))
                .collect(),
        }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        self.axes.iter().map(Vec::len).product()
    }

    /// Whether it has no point.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// One point; the last input counts fastest, as a table of all is read.
    pub fn point(&self, mut index: usize) -> Vec<f64> {
        let mut point: Vec<f64> = self
            .axes
            .iter()
            .rev()
            .map(|axis| {
                let x = axis[index % axis.len()];
                index /= axis.len();
                x
            })
            .collect();
        point.reverse();
        point
    }
}

fn even(input: &Input, each: usize) -> Vec<f64> {
    let (start, end) = (*input.range.start(), *input.range.end());
    let last = each - 1;
    (0..=last)
        .map(|i| {
            if i == last {
                end
            } else {
                start + (end - start) * (i as f64 / last as f64)
            }
        })
        .collect()
}

fn with_knots(input: &Input, each: usize) -> Vec<f64> {
    let mut axis = even(input, each);
    let knots = input.terms.iter().flat_map(|term| term.shape.knots());
    axis.extend(knots.filter(|x| input.range.contains(x)));
    axis.sort_by(f64::total_cmp);
    axis.dedup();
    axis
}

/// What one evaluation costs, about: degrees of rules and samples of sets.
fn cost(system: &System) -> usize {
    let rules = rules(system).count();
    let samples: usize = system
        .outputs
        .iter()
        .map(|output| match output.defuzzifier {
            Defuzzifier::WeightedAverage => 1,
            Defuzzifier::Centroid { points, .. } => points * rules.min(2 * output.terms.len()),
        })
        .sum();
    (rules * 8 + samples).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::sample::fan;

    #[test]
    fn it_spans_the_ranges_and_has_every_knot() {
        let grid = Grid::new(&fan(), 10_000);
        assert_eq!(grid.point(0), [0.0, 0.0]);
        assert_eq!(grid.point(grid.len() - 1), [40.0, 100.0]);
        for (axis, knots) in grid
            .axes
            .iter()
            .zip([vec![18.0, 24.0, 32.0], vec![30.0, 80.0]])
        {
            assert!(axis.len() >= 100 && axis.is_sorted());
            assert!(knots.iter().all(|knot| axis.contains(knot)));
        }
        let plain = Grid::even(&fan(), 3);
        let points: Vec<Vec<f64>> = (0..plain.len()).map(|i| plain.point(i)).collect();
        assert_eq!(
            points[..4],
            [[0.0, 0.0], [0.0, 50.0], [0.0, 100.0], [20.0, 0.0]]
        );
    }
}
