//! Where no rule fires, and which rules never do: not by sampling but piece by piece. Between two neighbouring knots of an
//! input's terms, none of them starts or ends; so which rules fire is the same in all of such a piece.
//!
//! ```text
//! system ──Axis──▶ pieces an input ──search──▶ boxes without a conclusion ──joined──▶ gaps
//! ```

mod axis;
mod search;
mod stretch;

pub(super) use axis::Axis;
pub use stretch::Stretch;

use crate::fuzzy::evaluate::{meets, rules};
use crate::fuzzy::model::{Rule, System};
use search::{Bare, Candidate, Search, joined};
use std::ops::Range;

/// Most rules that are looked at in boxes, in all, before it is given up: some seconds. A box that is left counts more, for
/// the memory that it takes.
pub const MOST_WORK: usize = 500_000_000;
/// Outputs that are looked at together: a bit each.
const TOGETHER: usize = 64;

/// A box of the inputs' ranges where outputs get no conclusion.
#[derive(Clone, Debug, PartialEq)]
pub struct Gap {
    /// Indices of the outputs.
    pub outputs: Vec<usize>,
    /// One stretch an input.
    pub region: Vec<Stretch>,
    /// Its part of the whole, 0 to 1.
    pub share: f64,
}

impl Gap {
    /// A point inside.
    pub fn example(&self) -> Vec<f64> {
        self.region.iter().map(Stretch::example).collect()
    }
}

/// What was found.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Coverage {
    /// Where outputs get no conclusion, the largest first: no rule about them fires, or only such as conclude sets that
    /// meet no sample. Boxes do not overlap (of the same 64 outputs), and together they are all of it.
    pub gaps: Vec<Gap>,
    /// Each rule: whether there is any place in the ranges where it fires.
    pub fires: Vec<bool>,
}

/// Looks a system through; `None` if that is more than `most_work` (see [`MOST_WORK`]).
///
/// Boxes of pieces are halved until rules hold everywhere in them or nowhere. So the work goes by how much the rules differ
/// from piece to piece, not by how many pieces there are.
pub fn coverage(system: &System, most_work: usize) -> Option<Coverage> {
    let axes: Vec<Axis> = system.inputs.iter().map(Axis::new).collect();
    let search = Search::new(&axes, most_work);
    let all: Vec<&Rule> = rules(system).map(|(_, rule)| rule).collect();
    let fires = search.fire(&all)?;
    let mut gaps = Vec::new();
    for first in (0..system.outputs.len()).step_by(TOGETHER) {
        let outputs = first..(first + TOGETHER).min(system.outputs.len());
        let bit = |output: usize| match outputs.contains(&output) {
            true => 1_u64 << (output - first),
            false => 0,
        };
        let candidates: Vec<Candidate> = all
            .iter()
            .zip(&fires)
            .filter(|(_, fires)| **fires)
            .map(|(rule, _)| Candidate {
                antecedent: &rule.antecedent,
                about: (rule.conclusions.iter())
                    .filter(|&&(output, term)| meets(&system.outputs[output], term))
                    .fold(0, |bits, &(output, _)| bits | bit(output)),
            })
            .collect();
        let every = outputs.clone().fold(0, |bits, output| bits | bit(output));
        let bare = joined(search.bare(&candidates, every)?, axes.len());
        gaps.extend(bare.iter().map(|bare| gap(system, &axes, first, bare)));
    }
    gaps.sort_by(|a, b| b.share.total_cmp(&a.share));
    Some(Coverage { gaps, fires })
}

fn gap(system: &System, axes: &[Axis], first: usize, bare: &Bare) -> Gap {
    let region: Vec<Stretch> = axes
        .iter()
        .zip(&bare.region)
        .map(|(axis, pieces)| axis.stretch(pieces))
        .collect();
    let shares = region.iter().zip(&system.inputs);
    Gap {
        outputs: (first..system.outputs.len().min(first + TOGETHER))
            .filter(|output| bare.outputs >> (output - first) & 1 == 1)
            .collect(),
        share: shares
            .map(|(stretch, input)| stretch.share(input))
            .product(),
        region,
    }
}

/// Input terms that reach no value of their input's range: indices of input and term.
pub fn outside(system: &System) -> Vec<(usize, usize)> {
    let mut found = Vec::new();
    for (input, of) in system.inputs.iter().enumerate() {
        let axis = Axis::new(of);
        let nowhere = |term: &usize| axis.holding(*term, false, &(0..axis.len())) == 0;
        let terms = (0..of.terms.len()).filter(nowhere);
        found.extend(terms.map(|term| (input, term)));
    }
    found
}

/// Where an input has no term at all: index of the input, and where.
pub fn bare(system: &System) -> Vec<(usize, Stretch)> {
    let mut found = Vec::new();
    for (input, of) in system.inputs.iter().enumerate() {
        let axis = Axis::new(of);
        let mut open: Option<Range<usize>> = None;
        for piece in 0..=axis.len() {
            let is_bare = piece < axis.len() && axis.is_bare(piece);
            match (&mut open, is_bare) {
                (Some(open), true) => open.end = piece + 1,
                (None, true) => open = Some(piece..piece + 1),
                (_, false) => found.extend(open.take().map(|open| (input, axis.stretch(&open)))),
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::evaluate::{Evaluator, Exact};
    use crate::fuzzy::membership::TAIL;
    use crate::fuzzy::model::{Place, Shape, Term};
    use crate::fuzzy::random;
    use crate::fuzzy::sample::{fan, rule};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    #[test]
    fn a_complete_table_has_no_gap() {
        let found = coverage(&fan(), MOST_WORK).unwrap();
        assert_eq!(
            (found.gaps.len(), bare(&fan()).len(), outside(&fan()).len()),
            (0, 0, 0)
        );
        assert!(found.fires.iter().all(|&fires| fires));
    }

    #[test]
    fn a_missing_rule_leaves_a_box_with_a_point_in_it() {
        let mut fan = fan();
        // Temperature high, humidity low.
        fan.blocks[0].rules.remove(4);
        let found = coverage(&fan, MOST_WORK).unwrap();
        // Only where these terms are alone: at 32 °C and above, at 30 % and below.
        assert_eq!(found.gaps.len(), 1, "{:?}", found.gaps);
        let gap = &found.gaps[0];
        assert_eq!(gap.region[0].to_string(), "[32, 40]");
        assert_eq!(gap.region[1].to_string(), "[0, 30]");
        assert_eq!(gap.example(), [36.0, 15.0]);
        assert!((gap.share - 8.0 / 40.0 * 0.3).abs() < 1e-12);
        assert_eq!(Exact::new(&fan).evaluate(&gap.example()).outputs, [None]);
    }

    #[test]
    fn feet_that_only_touch_leave_one_value() {
        let mut fan = fan();
        fan.inputs[0].terms[0].shape = Shape::Ramp {
            from: 24.0,
            to: 18.0,
        };
        fan.inputs[0].terms[1].shape = Shape::Ramp {
            from: 24.0,
            to: 32.0,
        };
        fan.inputs[0].terms[2].shape = Shape::Ramp {
            from: 60.0,
            to: 70.0,
        };
        let found = coverage(&fan, MOST_WORK).unwrap();
        let bare = bare(&fan);
        assert_eq!(bare.len(), 1);
        assert_eq!(bare[0].1.to_string(), "exactly 24");
        assert_eq!(found.gaps[0].region[0].example(), 24.0);
        assert_eq!(found.gaps[0].share, 0.0);
        assert_eq!(outside(&fan), [(0, 2)]);
        assert_eq!(found.fires, [true, true, true, true, false, false]);
    }

    #[test]
    fn not_holds_where_the_term_is_not_full() {
        let mut fan = fan();
        fan.blocks[0].rules = vec![rule(&[(0, 0, true)], &[(0, 0)])];
        let found = coverage(&fan, MOST_WORK).unwrap();
        assert_eq!(found.gaps.len(), 1);
        assert_eq!(found.gaps[0].region[0].to_string(), "[0, 18]");
    }

    /// Four inputs of eight Gaussian terms, a rule for each combination.
    fn large() -> System {
        let mut system = fan();
        let term = |i: u32| Term {
            name: format!("t{i}"),
            shape: Shape::Gaussian {
                mean: f64::from(i),
                deviation: 0.525,
            },
            place: Place::default(),
        };
        system.inputs[0].range = 0.0..=7.0;
        system.inputs[0].terms = (0..8).map(term).collect();
        system.inputs = vec![system.inputs[0].clone(); 4];
        let rules = (0..4096_usize).map(|i| {
            let asked = [0, 1, 2, 3].map(|input| (input, i >> (3 * input) & 7, false));
            rule(&asked, &[(0, i % 3)])
        });
        system.blocks[0].rules = rules.collect();
        system
    }

    #[test]
    fn thousands_of_rules_are_looked_through() {
        let mut large = large();
        assert_eq!(coverage(&large, MOST_WORK).unwrap().gaps, []);
        // Each ends where its neighbour is full: at a corner only one rule fires.
        let triangle = |peak: f64| Shape::Triangle {
            left: peak - 1.0,
            peak,
            right: peak + 1.0,
        };
        for input in &mut large.inputs {
            for (i, term) in input.terms.iter_mut().enumerate() {
                term.shape = triangle(i as f64);
            }
        }
        assert_eq!(coverage(&large, MOST_WORK).unwrap().gaps, []);
        large.blocks[0].rules.remove(0o7070);
        let gaps = coverage(&large, MOST_WORK).unwrap().gaps;
        assert_eq!(gaps.len(), 1);
        assert_eq!(gaps[0].example(), [0.0, 7.0, 0.0, 7.0]);
        assert_eq!(gaps[0].share, 0.0);
    }

    #[test]
    fn what_takes_too_long_is_given_up() {
        assert_eq!(coverage(&fan(), 100), None);
        assert!(coverage(&fan(), 10_000).is_some());
    }

    /// Against evaluation at random points of random systems: a point is in a gap exactly if no rule about the output fires.
    #[test]
    fn gaps_are_where_evaluation_finds_nothing() {
        let mut rng = Pcg64Mcg::seed_from_u64(7);
        let (mut inside, mut outside) = (0, 0);
        for _ in 0..300 {
            let system = random::system(&mut rng);
            let found = coverage(&system, MOST_WORK).unwrap();
            let exact = Exact::new(&system);
            for _ in 0..50 {
                let point: Vec<f64> = (system.inputs.iter())
                    .map(|input| rng.random_range(input.range.clone()))
                    .collect();
                let degrees = exact.evaluate(&point).rules;
                for output in 0..system.outputs.len() {
                    let strongest = rules(&system)
                        .zip(&degrees)
                        .filter(|((_, rule), _)| {
                            let mut about = rule.conclusions.iter().filter(|c| c.0 == output);
                            about.any(|&(_, term)| meets(&system.outputs[output], term))
                        })
                        .fold(0.0, |most, (_, degree)| degree.max(most));
                    let here = found.gaps.iter().filter(|gap| {
                        let mut places = gap.region.iter().zip(&point);
                        gap.outputs.contains(&output) && places.all(|(s, x)| s.contains(*x))
                    });
                    let gaps = here.count();
                    assert!(gaps <= 1, "{point:?} is in two gaps of {system:#?}");
                    let covered = gaps == 0;
                    // Of tails, less than their end is left in a gap; and outside, their product may be tiny.
                    if covered {
                        outside += 1;
                        assert!(strongest > 0.0, "{point:?} of {system:#?}");
                    } else {
                        inside += 1;
                        assert!(strongest <= TAIL, "{strongest} at {point:?} of {system:#?}");
                    }
                }
            }
            for (index, fires) in found.fires.iter().enumerate() {
                let weight = rules(&system).nth(index).unwrap().1.weight;
                assert!(*fires || weight <= 1.0);
            }
        }
        assert!(inside > 1000 && outside > 1000, "{inside}, {outside}");
    }
}
