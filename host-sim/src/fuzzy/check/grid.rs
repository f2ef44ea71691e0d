//! The points at which a system is looked at when pieces cannot tell: a dense grid with every knot in it, unless the work forbids
//! that: then with even values alone, and it says so.

use super::MOST_VALUES;
use super::at_once::at_once;
use crate::fuzzy::evaluate::rules;
use crate::fuzzy::model::{Defuzzifier, Input, Merge, Shape, System};

/// Points of a grid unless told otherwise.
pub const POINTS: usize = 100_000;
/// Degrees and samples that a grid may cost before it gets thinner, some seconds; and what it may have at least all the same.
const MOST_WORK: usize = 4_000_000_000;
const LEAST_POINTS: usize = 2_000;
/// Points that the knots may take beyond those asked for.
const MOST_FOR_KNOTS: usize = 10 * POINTS;
/// With fewer even values an input than this, it matters how many of them fall on knots.
const LEAST_EACH: usize = 5;
/// How far beside a jump it is looked, of the range: some steps of fixed point.
const BESIDE: f64 = 1e-4;

/// A grid over the ranges of all inputs.
#[derive(Clone, Debug, PartialEq)]
pub struct Grid {
    /// Each input's values, ascending.
    pub axes: Vec<Vec<f64>>,
    /// Whether all knots of the terms are among them.
    pub has_knots: bool,
    /// Whether it would have had more points if each took less work.
    pub is_limited: bool,
}

impl Grid {
    /// At most about `points` points, evenly from end to end of each range and at the knots of the terms, where the greatest
    /// errors lie. Costly systems get fewer. Of [`POINTS`] or more there may be more than were asked for, up to a million, if the knots
    /// need them and the work and the values that can be kept allow it. Where there is no room for the knots they are left out.
    pub fn new(system: &System, points: usize) -> Self {
        let asked = points;
        let most = (MOST_WORK / cost(system)).max(LEAST_POINTS);
        let points = asked.min(most);
        let knots: Vec<Vec<f64>> = system.inputs.iter().map(knots).collect();
        let mut each = even_values(&knots, points);
        if each < LEAST_EACH {
            let kept = MOST_VALUES / system.outputs.len().max(1);
            let room = match asked >= POINTS {
                true => most.min(MOST_FOR_KNOTS).min(kept).max(points),
                false => points,
            };
            let fits = |each, room| size(&with_knots(system, &knots, each)) <= room;
            each = each.max(2);
            if !fits(each, room) {
                let all = (points as f64).powf(1.0 / system.inputs.len().max(1) as f64);
                return Self {
                    // Or else more points would be room enough.
                    is_limited: most < asked || !fits(each, most),
                    ..Self::even(system, all as usize)
                };
            }
            while fits(each + 1, points) {
                each += 1;
            }
        }
        Self {
            axes: with_knots(system, &knots, each),
            has_knots: true,
            is_limited: most < asked,
        }
    }

    /// About `points` points at most whose spaces are boxes to begin with: knots are among them where there are enough others, too.
    pub fn boxes(system: &System, points: usize) -> Self {
        let knots: Vec<Vec<f64>> = system.inputs.iter().map(knots).collect();
        let each = even_values(&knots, points);
        if each < LEAST_EACH {
            let all = (points as f64).powf(1.0 / system.inputs.len().max(1) as f64);
            return Self::even(system, all as usize);
        }
        Self {
            axes: with_knots(system, &knots, each),
            has_knots: true,
            is_limited: false,
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
            has_knots: false,
            is_limited: false,
        }
    }

    /// Number of points.
    pub fn len(&self) -> usize {
        size(&self.axes)
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

fn size(axes: &[Vec<f64>]) -> usize {
    axes.iter().map(Vec::len).product()
}

/// The most even values an input that make no more than `points` points beside the knots; none of them counts as one of these.
fn even_values(knots: &[Vec<f64>], points: usize) -> usize {
    let size = |each: usize| -> f64 { knots.iter().map(|of| (each + of.len()) as f64).product() };
    let (mut each, mut above) = (1, points + 1);
    while above - each > 1 {
        let middle = each + (above - each) / 2;
        if size(middle) <= points as f64 {
            each = middle;
        } else {
            above = middle;
        }
    }
    each
}

fn with_knots(system: &System, knots: &[Vec<f64>], each: usize) -> Vec<Vec<f64>> {
    let axes = system.inputs.iter().zip(knots).map(|(input, knots)| {
        let mut axis = even(input, each);
        axis.extend(knots);
        axis.sort_by(f64::total_cmp);
        axis.dedup();
        axis
    });
    axes.collect()
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

/// What a point costs, about: degrees of terms and of rules and samples of sets, in `f64` and in fixed point, and comparing the
/// rules with each other. Of a centroid only the rules that fire cost samples and, where the largest counts, of each set only the strongest, cut off
/// or scaled.
fn cost(system: &System) -> usize {
    let count = rules(system).count();
    let conclusions: usize = rules(system).map(|(_, rule)| rule.conclusions.len()).sum();
    let outputs = system.outputs.iter().enumerate().map(|(index, output)| {
        let terms = output.terms.len();
        match (output.defuzzifier, output.merge) {
            (Defuzzifier::WeightedAverage, Merge::Sum) => 1 + conclusions,
            (Defuzzifier::WeightedAverage, Merge::Max) => 1 + conclusions * terms,
            (Defuzzifier::Centroid { points, .. }, merge) => {
                let fire = at_once(system, index);
                let sets = match merge {
                    Merge::Max => fire.min(2 * terms),
                    Merge::Sum => fire,
                };
                2 * points * sets
            }
        }
    });
    let terms: usize = system.inputs.iter().map(|input| input.terms.len()).sum();
    (terms * 16 + count * 24 + outputs.sum::<usize>()).max(1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::model::Antecedent;
    use crate::fuzzy::sample::{fan, rule};

    /// Inputs 0 to 7 with eight terms each, a rule for every combination, and a centroid of two sets.
    fn crowd(inputs: usize, points: usize, merge: Merge) -> System {
        let mut crowd = fan();
        let input = crowd.inputs[0].clone();
        let term = |peak: f64| crate::fuzzy::model::Term {
            shape: Shape::Triangle {
                left: peak - 1.0,
                peak,
                right: peak + 1.0,
            },
            ..input.terms[0].clone()
        };
        crowd.inputs = vec![
            Input {
                range: 0.0..=7.0,
                terms: (0..8).map(|i| term(f64::from(i))).collect(),
                ..input.clone()
            };
            inputs
        ];
        let output = &mut crowd.outputs[0];
        output.merge = merge;
        output.terms.truncate(2);
        output.defuzzifier = Defuzzifier::Centroid {
            points,
            sampling: crate::fuzzy::model::Sampling::Middles,
        };
        let of = |index: usize| {
            let asked = (0..inputs).map(|i| (i, index >> (3 * i) & 7, false));
            rule(&asked.collect::<Vec<_>>(), &[(0, index % 2)])
        };
        crowd.blocks[0].rules = (0..8_usize.pow(inputs as u32)).map(of).collect();
        crowd
    }

    #[test]
    fn of_thousands_of_rules_it_is_thinner_and_has_the_knots() {
        assert!(Grid::new(&fan(), POINTS).len() > POINTS * 9 / 10);
        assert!(!Grid::new(&fan(), POINTS).is_limited);
        for merge in [Merge::Max, Merge::Sum] {
            let crowd = crowd(4, 1000, merge);
            let grid = Grid::new(&crowd, POINTS);
            assert!(grid.is_limited && grid.has_knots, "{merge:?}");
            assert!((8_000..POINTS / 2).contains(&grid.len()), "{}", grid.len());
            for axis in &grid.axes {
                assert!((0..8).all(|knot| axis.contains(&f64::from(knot))));
            }
            // More than the work allows is not had by asking for it.
            assert_eq!(Grid::new(&crowd, 10 * POINTS), grid);
        }
    }

    #[test]
    fn without_room_for_the_knots_it_says_so() {
        // Where all rules may fire at once each of them costs.
        let mut crowd = crowd(4, 1000, Merge::Sum);
        for rule in &mut crowd.blocks[0].rules {
            let parts = rule.antecedent.clone();
            rule.antecedent = Antecedent::Or(vec![parts]);
        }
        let grid = Grid::new(&crowd, POINTS);
        assert!(grid.is_limited && !grid.has_knots);
        assert_eq!(grid.len(), 6 * 6 * 6 * 6);
        // So few were asked for: it is not for the work.
        let grid = Grid::new(&self::crowd(4, 10, Merge::Max), 200);
        assert!(!grid.is_limited && !grid.has_knots && grid.len() < 200);
    }

    #[test]
    fn the_knots_take_a_million_points_at_most_and_no_more_than_can_be_kept() {
        // Few rules about many terms.
        let mut many = crowd(4, 10, Merge::Max);
        many.blocks[0].rules.truncate(8);
        let term = many.inputs[0].terms[0].clone();
        let at = |peak: f64| crate::fuzzy::model::Term {
            shape: Shape::Triangle {
                left: peak - 0.1,
                peak,
                right: peak + 0.1,
            },
            ..term.clone()
        };
        let with = |terms: u8, outputs: usize| {
            let mut many = many.clone();
            for input in &mut many.inputs {
                input.terms = (0..terms)
                    .map(|i| at(7.0 * f64::from(i) / f64::from(terms)))
                    .collect();
            }
            many.outputs = vec![many.outputs[0].clone(); outputs];
            many
        };
        let fits = Grid::new(&with(8, 1), POINTS);
        assert!(fits.has_knots && (POINTS..=MOST_FOR_KNOTS).contains(&fits.len()));
        for (terms, outputs) in [(64, 1), (20, 1), (8, 400)] {
            let grid = Grid::new(&with(terms, outputs), POINTS);
            assert!(!grid.has_knots && grid.len() <= POINTS, "{}", grid.len());
        }
        // Where not even the most points were enough, it is for the work.
        assert!(Grid::new(&with(64, 1), POINTS).is_limited);
    }

    #[test]
    fn more_than_are_asked_for_by_default_if_the_knots_need_them() {
        let mut wide = crowd(2, 10, Merge::Max);
        wide.inputs.extend(wide.inputs.clone());
        let last = wide.inputs[0].terms[7].clone();
        for input in &mut wide.inputs {
            let between = |i: i32| crate::fuzzy::model::Term {
                shape: Shape::Triangle {
                    left: 0.0,
                    peak: f64::from(i) + 0.3,
                    right: 7.0,
                },
                ..last.clone()
            };
            input.terms.extend((0..7).map(between));
            input
                .terms
                .extend((0..7).map(|i| crate::fuzzy::model::Term {
                    shape: Shape::Triangle {
                        left: 0.0,
                        peak: f64::from(i) + 0.6,
                        right: 7.0,
                    },
                    ..last.clone()
                }));
        }
        let grid = Grid::new(&wide, POINTS);
        assert!(grid.has_knots && !grid.is_limited);
        assert_eq!(grid.len(), 22 * 22 * 22 * 22);
        assert!(!Grid::new(&wide, POINTS - 1).has_knots);
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
