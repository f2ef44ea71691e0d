//! The points at which a system is looked at when pieces cannot tell: a dense grid with every knot in it.

use crate::fuzzy::evaluate::rules;
use crate::fuzzy::model::{Defuzzifier, Input, Merge, Shape, System};

/// Points of a grid unless told otherwise.
pub const POINTS: usize = 100_000;
/// Degrees and samples that a grid may cost before it gets thinner, some seconds; and what it has at least all the same.
const MOST_WORK: usize = 4_000_000_000;
const LEAST_POINTS: usize = 2_000;
/// With fewer even values an input than this, the knots are left out.
const LEAST_EACH: usize = 5;
/// How far beside a jump it is looked, of the range: some steps of fixed point.
const BESIDE: f64 = 1e-4;

/// A grid over the ranges of all inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Each input's values, ascending.
    pub axes: Vec<Vec<f64>>,
}

impl Grid {
    /// At most about `points` points, evenly from end to end of each range and at the knots of the terms, where the greatest
    /// errors lie, as far as there is room for them. Costly systems get fewer.
    pub fn new(system: &System, points: usize) -> Self {
        let points = points.min((MOST_WORK / cost(system)).max(LEAST_POINTS));
        let knots: Vec<Vec<f64>> = system.inputs.iter().map(knots).collect();
        let size =
            |each: usize| -> f64 { knots.iter().map(|of| (each + of.len()) as f64).product() };
        // The most values an input that leave it small enough.
        let (mut each, mut above) = (1, points + 1);
        while above - each > 1 {
            let middle = each + (above - each) / 2;
            if size(middle) <= points as f64 {
                each = middle;
            } else {
                above = middle;
            }
        }
        if each < LEAST_EACH {
            let all = (points as f64).powf(1.0 / system.inputs.len().max(1) as f64);
            return Self::even(system, all as usize);
        }
        let axes = system.inputs.iter().zip(knots).map(|(input, knots)| {
            let mut axis = even(input, each);
            axis.extend(knots);
            axis.sort_by(f64::total_cmp);
            axis.dedup();
            axis
        });
        Self {
            axes: axes.collect(),
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

/// The terms' knots in the range, ascending, and both sides of their jumps.
fn knots(input: &Input) -> Vec<f64> {
    let beside = (input.range.end() - input.range.start()) * BESIDE;
    let terms = || input.terms.iter().map(|term| &term.shape);
    let mut knots: Vec<f64> = terms().flat_map(Shape::knots).collect();
    knots.extend(
        terms()
            .flat_map(Shape::jumps)
            .flat_map(|x| [x - beside, x + beside]),
    );
    knots.retain(|x| input.range.contains(x));
    knots.sort_by(f64::total_cmp);
    knots.dedup();
    knots
}

/// What a point costs, about: degrees of rules and samples of sets, in `f64` and in fixed point, and comparing the rules with each
/// other.
fn cost(system: &System) -> usize {
    let count = rules(system).count();
    let conclusions: usize = rules(system).map(|(_, rule)| rule.conclusions.len()).sum();
    let outputs = system.outputs.iter().map(|output| {
        let terms = output.terms.len();
        match (output.defuzzifier, output.merge) {
            (Defuzzifier::WeightedAverage, Merge::Sum) => 1 + conclusions,
            (Defuzzifier::WeightedAverage, Merge::Max) => 1 + conclusions * terms,
            // In `f64` rules that conclude the same are one; in fixed point all of them may fire and be added.
            (Defuzzifier::Centroid { points, .. }, _) => {
                points * (count.min(2 * terms) + conclusions)
            }
        }
    });
    (count * 24 + outputs.sum::<usize>()).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::sample::fan;

    #[test]
    fn of_thousands_of_rules_it_is_thinner() {
        let mut fan = fan();
        let sure = fan.blocks[0].rules.clone();
        assert!(Grid::new(&fan, POINTS).len() > POINTS * 9 / 10);
        fan.blocks[0].rules = sure.iter().cycle().take(4096).cloned().collect();
        fan.outputs[0].merge = Merge::Max;
        fan.outputs[0].defuzzifier = Defuzzifier::Centroid {
            points: 200,
            sampling: crate::fuzzy::model::Sampling::Middles,
        };
        let len = Grid::new(&fan, POINTS).len();
        assert!((LEAST_POINTS / 2..20_000).contains(&len), "{len}");
    }

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
            assert!(axis.len() >= 95 && axis.is_sorted());
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
