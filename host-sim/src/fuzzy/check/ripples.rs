//! Where an output rises and falls again along an input, seen on a grid. What is between the grid's points is not seen.

use super::grid::Grid;
use crate::fuzzy::model::System;
use rayon::prelude::*;

/// A rise or a fall counts from this share of the output's range on: sums over a centroid's samples ripple a little.
pub const LEAST: f64 = 1e-3;

/// How an output turns along one input.
#[derive(Clone, Debug, PartialEq)]
pub struct Ripples {
    /// Index of the output.
    pub output: usize,
    /// Index of the input along which it was looked.
    pub along: usize,
    /// Lines of the grid along it, and those of them with a turn.
    pub lines: usize,
    /// At least one.
    pub turning: usize,
    /// The greatest turn.
    pub greatest: Ripple,
}

/// One turn.
#[derive(Clone, Debug, PartialEq)]
pub struct Ripple {
    /// Where: a value an input, in the middle of the three.
    pub at: Vec<f64>,
    /// The input's value and the output's before, at and behind the turn, each as far as it goes on in one direction.
    pub values: [(f64, f64); 3],
}

impl Ripple {
    /// What it rises and falls by: the less of both.
    fn size(&self) -> f64 {
        let [before, at, behind] = self.values.map(|(_, y)| y);
        (at - before).abs().min((at - behind).abs())
    }
}

/// Looks along every input at every line of the grid; `values` holds an output's value at each of its points, NaN where it
/// has none: there a line ends and the next begins. What is infinite is passed over.
pub fn ripples(system: &System, grid: &Grid, output: usize, values: &[f64]) -> Vec<Ripples> {
    let range = &system.outputs[output].range;
    let least = LEAST * (range.end() - range.start());
    let each: Vec<usize> = grid.axes.iter().map(Vec::len).collect();
    let along = |along: usize| -> Option<Ripples> {
        let stride: usize = each[along + 1..].iter().product();
        let lines = grid.len() / each[along];
        let of_line = |line: usize| -> Option<Ripple> {
            let first = line / stride * stride * each[along] + line % stride;
            let axis = &grid.axes[along];
            let points: Vec<(f64, f64)> = (0..each[along])
                .map(|i| (axis[i], values[first + i * stride]))
                .filter(|(_, y)| !y.is_infinite())
                .collect();
            let found = points
                .split(|(_, y)| y.is_nan())
                .flat_map(|part| of_line(part, least))
                .map(|values| {
                    let mut at = grid.point(first);
                    at[along] = values[1].0;
                    Ripple { at, values }
                });
            found.reduce(greater)
        };
        let found: Vec<Ripple> = (0..lines).into_par_iter().filter_map(of_line).collect();
        Some(Ripples {
            output,
            along,
            lines,
            turning: found.len(),
            greatest: found.into_iter().reduce(greater)?,
        })
    };
    (0..each.len()).filter_map(along).collect()
}

/// Of equals the first.
fn greater(a: Ripple, b: Ripple) -> Ripple {
    if b.size() > a.size() { b } else { a }
}

/// The turns of one line: its ends and the extremes between them, three by three.
fn of_line(points: &[(f64, f64)], least: f64) -> Vec<[(f64, f64); 3]> {
    let Some(&first) = points.first() else {
        return Vec::new();
    };
    // The last of them is where the line has got to; it moves on as long as nothing goes back by enough.
    let mut extremes = vec![first, first];
    for &point in points {
        let last = extremes.len() - 1;
        let (before, at) = (extremes[last - 1].1, extremes[last].1);
        let further = match last {
            // No direction yet: both ends may move.
            1 => (point.1 - before).abs() >= (at - before).abs(),
            _ => (at > before) == (point.1 > at) && point.1 != at,
        };
        if further {
            extremes[last] = point;
        } else if (point.1 - at).abs() > least {
            if (at - before).abs() > least {
                extremes.push(point);
            } else {
                // What came before was too little to be a direction.
                extremes[last - 1] = extremes[last];
                extremes[last] = point;
            }
        }
    }
    extremes.windows(3).map(|w| [w[0], w[1], w[2]]).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::evaluate::{Evaluator, Exact};
    use crate::fuzzy::sample::fan;

    fn turns(values: &[f64]) -> Vec<f64> {
        let points: Vec<(f64, f64)> = values.iter().map(|&y| (0.0, y)).collect();
        of_line(&points, 0.1).into_iter().map(|t| t[1].1).collect()
    }

    #[test]
    fn a_turn_is_a_way_there_and_back() {
        assert_eq!(turns(&[]), [0.0; 0]);
        assert_eq!(turns(&[1.0, 1.0, 1.0]), [0.0; 0]);
        assert_eq!(turns(&[0.0, 0.5, 0.5, 1.0, 2.0]), [0.0; 0]);
        assert_eq!(turns(&[0.0, 1.0, 3.0, 3.0, 2.0, 1.0]), [3.0]);
        assert_eq!(turns(&[3.0, 2.0, 2.5, 2.6, 0.0]), [2.0, 2.6]);
        // Less than the least, before, between and behind.
        assert_eq!(turns(&[0.0, 0.05, 0.0, 0.5, 0.45, 1.0, 0.95]), [0.0; 0]);
        assert_eq!(turns(&[0.05, 0.0, 0.08, 0.02, -1.0, 0.0]), [-1.0]);
    }

    #[test]
    fn it_is_found_along_the_input_that_it_is_along() {
        let mut fan = fan();
        // Off at high temperature and humidity.
        fan.blocks[0].rules[5].conclusions = vec![(0, 0)];
        let (grid, exact) = (Grid::even(&fan, 41), Exact::new(&fan));
        let values: Vec<f64> = (0..grid.len())
            .map(|index| exact.evaluate(&grid.point(index)).outputs[0].unwrap())
            .collect();
        let found = ripples(&fan, &grid, 0, &values);
        assert_eq!(found[0].along, 0);
        assert_eq!(found[0].greatest.values[1], (24.0, 40.0));
        assert!(found[0].greatest.at[1] >= 80.0 && found[0].turning < found[0].lines);
    }
}
