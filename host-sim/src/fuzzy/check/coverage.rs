//! Where no rule fires, and which rules never do: not by sampling but piece by piece. Between two neighbouring knots of an
//! input's terms, none of them starts or ends; so which rules fire is the same in all of such a piece.

use crate::fuzzy::evaluate::rules;
use crate::fuzzy::model::{Antecedent, Input, System};
use std::fmt;
use std::ops::Range;

/// Most cells (products of pieces) times rules that are looked through.
const MOST_WORK: usize = 1_000_000_000;
/// Most cells.
const MOST_CELLS: usize = 20_000_000;

/// A part of an input's range: an interval, each end inside it or not, or one value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Least value.
    pub from: f64,
    /// Greatest value.
    pub to: f64,
    /// Whether `from` belongs to it.
    pub with_from: bool,
    /// Whether `to` belongs to it.
    pub with_to: bool,
}

impl Stretch {
    fn point(x: f64) -> Self {
        Self {
            from: x,
            to: x,
            with_from: true,
            with_to: true,
        }
    }

    fn between(from: f64, to: f64) -> Self {
        Self {
            from,
            to,
            with_from: false,
            with_to: false,
        }
    }

    /// This stretch and the one that follows it without a gap, as one.
    fn joined(self, next: Self) -> Self {
        Self {
            to: next.to,
            with_to: next.with_to,
            ..self
        }
    }

    /// A value inside: the middle.
    pub fn example(&self) -> f64 {
        self.from + (self.to - self.from) / 2.0
    }

    /// Its part of a range, 0 to 1; 0 for one value.
    pub fn share(&self, input: &Input) -> f64 {
        (self.to - self.from) / (input.range.end() - input.range.start())
    }

    /// Whether `x` lies in it.
    pub fn contains(&self, x: f64) -> bool {
        let after = x > self.from || (x == self.from && self.with_from);
        let before = x < self.to || (x == self.to && self.with_to);
        after && before
    }
}

/// As an interval, `(1.5, 2]`, or the one value.
impl fmt::Display for Stretch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.from == self.to {
            return write!(f, "exactly {}", self.from);
        }
        let open = if self.with_from { '[' } else { '(' };
        let close = if self.with_to { ']' } else { ')' };
        write!(f, "{open}{}, {}{close}", self.from, self.to)
    }
}

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
    /// Where an input has no term at all: index of the input, and where.
    pub bare: Vec<(usize, Stretch)>,
    /// Where outputs get no conclusion, the largest first. Boxes do not overlap, and together they are all of it.
    pub gaps: Vec<Gap>,
    /// Each rule: whether there is any place in the ranges where it fires.
    pub fires: Vec<bool>,
    /// Input terms that reach no value of their input's range: indices of input and term.
    pub outside: Vec<(usize, usize)>,
}

/// Looks a system through; `None` if it has too many pieces for that, or more than 64 outputs.
pub fn coverage(system: &System) -> Option<Coverage> {
    let axes: Vec<Axis> = system.inputs.iter().map(Axis::new).collect();
    let count = rules(system).count();
    let cells = axes
        .iter()
        .try_fold(1_usize, |cells, axis| cells.checked_mul(axis.pieces.len()))
        .filter(|cells| *cells <= MOST_CELLS && cells.saturating_mul(count) <= MOST_WORK)
        .filter(|_| system.outputs.len() <= 64)?;
    let mut fires = vec![false; count];
    // A bit an output: whether it is left without a conclusion.
    let mut bare = vec![0_u64; cells];
    let every = u64::MAX >> (64 - system.outputs.len().clamp(1, 64));
    for (cell, bare) in bare.iter_mut().enumerate() {
        let place = place(&axes, cell);
        *bare = every;
        for (index, (_, rule)) in rules(system).enumerate() {
            let about = rule
                .conclusions
                .iter()
                .fold(0_u64, |bits, &(output, _)| bits | 1 << output);
            let new = !fires[index] || *bare & about != 0;
            if new && rule.weight > 0.0 && holds(&rule.antecedent, &axes, &place) {
                fires[index] = true;
                *bare &= !about;
            }
        }
    }
    let outside = system.inputs.iter().enumerate().flat_map(|(input, of)| {
        let reached = |term: usize| axes[input].pieces.iter().any(|piece| piece.reached[term]);
        (0..of.terms.len())
            .filter(move |&term| !reached(term))
            .map(move |term| (input, term))
            .collect::<Vec<_>>()
    });
    Some(Coverage {
        bare: bare_stretches(&axes),
        gaps: gaps(system, &axes, bare),
        fires,
        outside: outside.collect(),
    })
}

/// A part of an input's range in which every one of its terms is there or not, and filled or not.
struct Piece {
    stretch: Stretch,
    reached: Vec<bool>,
    filled: Vec<bool>,
}

struct Axis {
    pieces: Vec<Piece>,
}

impl Axis {
    fn new(input: &Input) -> Self {
        let (start, end) = (*input.range.start(), *input.range.end());
        let mut knots: Vec<f64> = input
            .terms
            .iter()
            .flat_map(|term| term.shape.knots())
            .collect();
        knots.retain(|x| (start..=end).contains(x));
        knots.extend([start, end]);
        knots.sort_by(f64::total_cmp);
        knots.dedup();
        let mut stretches = Vec::new();
        for pair in knots.windows(2) {
            stretches.push(Stretch::point(pair[0]));
            let between = Stretch::between(pair[0], pair[1]);
            if between.example() > pair[0] && between.example() < pair[1] {
                stretches.push(between);
            }
        }
        stretches.push(Stretch::point(end));
        let mut pieces: Vec<Piece> = Vec::new();
        for stretch in stretches {
            let x = stretch.example();
            let shapes = || input.terms.iter().map(|term| &term.shape);
            let reached: Vec<bool> = shapes().map(|shape| shape.reaches(x)).collect();
            let filled: Vec<bool> = shapes().map(|shape| shape.fills(x)).collect();
            match pieces.last_mut() {
                Some(last) if last.reached == reached && last.filled == filled => {
                    last.stretch = last.stretch.joined(stretch);
                }
                _ => pieces.push(Piece {
                    stretch,
                    reached,
                    filled,
                }),
            }
        }
        Self { pieces }
    }

    fn stretch(&self, pieces: &Range<usize>) -> Stretch {
        let all = self.pieces.iter().map(|piece| piece.stretch);
        all.skip(pieces.start)
            .take(pieces.len())
            .reduce(Stretch::joined)
            .unwrap_or(Stretch::point(f64::NAN))
    }
}

/// The cell's piece of every axis; the first axis counts fastest.
fn place(axes: &[Axis], mut cell: usize) -> Vec<usize> {
    axes.iter()
        .map(|axis| {
            let piece = cell % axis.pieces.len();
            cell /= axis.pieces.len();
            piece
        })
        .collect()
}

fn holds(antecedent: &Antecedent, axes: &[Axis], place: &[usize]) -> bool {
    match antecedent {
        Antecedent::Is {
            input,
            term,
            negated,
        } => {
            let piece = &axes[*input].pieces[place[*input]];
            if *negated {
                !piece.filled[*term]
            } else {
                piece.reached[*term]
            }
        }
        Antecedent::And(parts) => parts.iter().all(|part| holds(part, axes, place)),
        Antecedent::Or(parts) => parts.iter().any(|part| holds(part, axes, place)),
    }
}

fn bare_stretches(axes: &[Axis]) -> Vec<(usize, Stretch)> {
    let mut found = Vec::new();
    for (input, axis) in axes.iter().enumerate() {
        let mut open: Option<Stretch> = None;
        for piece in &axis.pieces {
            if piece.reached.contains(&true) {
                found.extend(open.take().map(|stretch| (input, stretch)));
            } else {
                open = Some(open.map_or(piece.stretch, |open| open.joined(piece.stretch)));
            }
        }
        found.extend(open.map(|stretch| (input, stretch)));
    }
    found
}

/// Grows boxes over the cells that are left without a conclusion for the same outputs, from each that is in none yet, an axis
/// after the other as far as they go.
fn gaps(system: &System, axes: &[Axis], mut bare: Vec<u64>) -> Vec<Gap> {
    let strides: Vec<usize> = axes
        .iter()
        .scan(1, |stride, axis| {
            let own = *stride;
            *stride *= axis.pieces.len();
            Some(own)
        })
        .collect();
    let mut gaps = Vec::new();
    for first in 0..bare.len() {
        let outputs = bare[first];
        if outputs == 0 {
            continue;
        }
        let mut cells = vec![first];
        let mut region: Vec<Range<usize>> = Vec::new();
        for (axis, (piece, stride)) in axes
            .iter()
            .zip(place(axes, first).into_iter().zip(&strides))
        {
            let slab = cells.clone();
            let mut end = piece + 1;
            while end < axis.pieces.len() {
                let next: Vec<usize> = slab
                    .iter()
                    .map(|cell| cell + (end - piece) * stride)
                    .collect();
                if next.iter().any(|&cell| bare[cell] != outputs) {
                    break;
                }
                cells.extend(next);
                end += 1;
            }
            region.push(piece..end);
        }
        for cell in cells {
            bare[cell] = 0;
        }
        let region: Vec<Stretch> = axes
            .iter()
            .zip(&region)
            .map(|(axis, r)| axis.stretch(r))
            .collect();
        gaps.push(Gap {
            outputs: (0..system.outputs.len())
                .filter(|output| outputs >> output & 1 == 1)
                .collect(),
            share: region
                .iter()
                .zip(&system.inputs)
                .map(|(s, input)| s.share(input))
                .product(),
            region,
        });
    }
    gaps.sort_by(|a, b| b.share.total_cmp(&a.share));
    gaps
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::evaluate::{Evaluator, Exact};
    use crate::fuzzy::membership::TAIL;
    use crate::fuzzy::model::Shape;
    use crate::fuzzy::random;
    use crate::fuzzy::sample::{fan, rule};
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    #[test]
    fn a_complete_table_has_no_gap() {
        let found = coverage(&fan()).unwrap();
        assert_eq!(
            (found.gaps.len(), found.bare.len(), found.outside.len()),
            (0, 0, 0)
        );
        assert!(found.fires.iter().all(|&fires| fires));
    }

    #[test]
    fn a_missing_rule_leaves_a_box_with_a_point_in_it() {
        let mut fan = fan();
        // Temperature high, humidity low.
        fan.blocks[0].rules.remove(4);
        let found = coverage(&fan).unwrap();
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
        let found = coverage(&fan).unwrap();
        assert_eq!(found.bare.len(), 1);
        assert_eq!(found.bare[0].1.to_string(), "exactly 24");
        assert_eq!(found.gaps[0].region[0].example(), 24.0);
        assert_eq!(found.gaps[0].share, 0.0);
        assert_eq!(found.outside, [(0, 2)]);
        assert_eq!(found.fires, [true, true, true, true, false, false]);
    }

    #[test]
    fn not_holds_where_the_term_is_not_full() {
        let mut fan = fan();
        fan.blocks[0].rules = vec![rule(&[(0, 0, true)], &[(0, 0)])];
        let found = coverage(&fan).unwrap();
        assert_eq!(found.gaps.len(), 1);
        assert_eq!(found.gaps[0].region[0].to_string(), "[0, 18]");
    }

    /// Against evaluation at random points of random systems: a point is in a gap exactly if no rule about the output fires.
    #[test]
    fn gaps_are_where_evaluation_finds_nothing() {
        let mut rng = Pcg64Mcg::seed_from_u64(7);
        let (mut inside, mut outside) = (0, 0);
        for _ in 0..300 {
            let system = random::system(&mut rng);
            let found = coverage(&system).unwrap();
            let exact = Exact::new(&system);
            for _ in 0..50 {
                let point: Vec<f64> = (system.inputs.iter())
                    .map(|input| rng.random_range(input.range.clone()))
                    .collect();
                let degrees = exact.evaluate(&point).rules;
                for output in 0..system.outputs.len() {
                    let strongest = rules(&system)
                        .zip(&degrees)
                        .filter(|((_, rule), _)| rule.conclusions.iter().any(|c| c.0 == output))
                        .fold(0.0, |most, (_, degree)| degree.max(most));
                    let covered = !found.gaps.iter().any(|gap| {
                        let mut places = gap.region.iter().zip(&point);
                        gap.outputs.contains(&output) && places.all(|(s, x)| s.contains(*x))
                    });
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
