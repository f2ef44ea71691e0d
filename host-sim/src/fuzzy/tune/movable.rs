//! Which numbers of a design move, and how a vector moves them.
//!
//! * Knots of membership functions (peaks, feet, middles) that stand at the same value of a variable are one number: a
//!   Ruspini partition stays one. They keep their order and a least distance. Those at the ends of the range or outside it
//!   stay.
//! * Where an input has to stay evenly divided, its knots move together: their distance is one number, a quarter of what the
//!   range holds at least, and the first of them stays.
//! * Constants keep their order, a least distance and the range; each is its own number.
//! * Widths of curved functions are halved at least and doubled at most.
//! * Terms of order 1: an input's coefficient moves as far as would carry the output four times through its range, the
//!   constant four ranges.
//!
//! The zero vector is the design as it is; one unit is the width of the variable's range (of widths: a factor of two).

use super::ladder::Ladder;
use super::numbers::{Role, Slot, Variable, visit};
use crate::fuzzy::model::System;
use std::ops::RangeInclusive;

/// Which variables and terms move.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Selection {
    /// Only these, each a variable and perhaps one of its terms; empty: all.
    pub only: Vec<(Variable, Option<usize>)>,
    /// Not these. A knot that one of them shares with another term stays.
    pub fix: Vec<(Variable, Option<usize>)>,
    /// Inputs that stay evenly divided.
    pub even: Vec<usize>,
}

impl Selection {
    fn moves(&self, owners: &[(Variable, usize)]) -> bool {
        let names = |list: &[(Variable, Option<usize>)]| {
            owners.iter().any(|owner| {
                list.iter().any(|(variable, term)| {
                    *variable == owner.0 && term.is_none_or(|t| t == owner.1)
                })
            })
        };
        (self.only.is_empty() || names(&self.only)) && !names(&self.fix)
    }
}

/// The numbers that move.
#[derive(Clone, Debug)]
pub struct Movable {
    start: System,
    groups: Vec<Group>,
}

/// Numbers that move together: in a vector they follow each other.
#[derive(Clone, Debug)]
struct Group {
    /// Of one unit, in the variable's own.
    unit: f64,
    /// The numbers as they are; the slots of each, by their place in [`visit`]'s order.
    numbers: Vec<(f64, Vec<usize>)>,
    rule: Rule,
}

#[derive(Clone, Debug)]
enum Rule {
    /// Ascending. Rounded to this step.
    Ladder(Ladder, f64),
    /// Multiplied by two to the power of a number from −1 to 1.
    Factor,
    /// Moved by four units at most.
    Free,
    /// Evenly spaced from this value on, the last number between these two. The only number in the vector is the last one's.
    Even(f64, RangeInclusive<f64>),
}

/// A number that may stand on a ladder.
struct Rung {
    value: f64,
    slots: Vec<usize>,
    moves: bool,
}

/// Least distance of neighbours, as a share of the range. Numbers that are nearer than twice that may halve their distance.
const LEAST: f64 = 0.01;
/// The same for constants.
const LEAST_CONSTANT: f64 = 0.001;
/// Numbers are rounded to a power of ten not above this share of the range.
const ROUND: f64 = 1e-5;
/// Distances of [`Rule::Even`] numbers are multiples of a power of two not above this share of the range: so they are even in fixed
/// point, too.
const EVEN: f64 = 1e-3;
/// Most units that a [`Rule::Free`] number moves.
const FAR: f64 = 4.0;

impl Movable {
    /// The numbers of a design that are selected and can move.
    pub fn new(system: &System, selection: &Selection) -> Self {
        let mut slots: Vec<(Slot, f64)> = Vec::new();
        let mut start = system.clone();
        visit(&mut start, &mut |slot, x| slots.push((slot, *x)));
        let inputs = (0..system.inputs.len()).map(Variable::Input);
        let outputs = (0..system.outputs.len()).map(Variable::Output);
        let mut groups = Vec::new();
        for variable in inputs.chain(outputs) {
            let of: Vec<(usize, Slot, f64)> = slots
                .iter()
                .enumerate()
                .filter(|(_, (slot, _))| slot.variable == variable)
                .map(|(index, (slot, x))| (index, *slot, *x))
                .collect();
            match variable {
                Variable::Input(index) if selection.even.contains(&index) => {
                    groups.extend(evenly(&of, range(system, variable), selection));
                }
                _ => groups.extend(ladders(&of, range(system, variable), selection)),
            }
            groups.extend(alone(system, &of, selection));
        }
        Self { start, groups }
    }

    /// Length of a vector.
    pub fn len(&self) -> usize {
        self.groups.iter().map(Group::len).sum()
    }

    /// Whether nothing moves.
    pub fn is_empty(&self) -> bool {
        self.groups.is_empty()
    }

    /// The design as it is.
    pub fn start(&self) -> &System {
        &self.start
    }

    /// The design that is nearest to what a vector asks for, and how far off that is: the square of the distance in units.
    pub fn decode(&self, vector: &[f64]) -> (System, f64) {
        let mut values: Vec<(usize, f64)> = Vec::new();
        let mut excess = 0.0;
        let mut rest = vector;
        for group in &self.groups {
            let (moves, after) = rest.split_at(group.len().min(rest.len()));
            rest = after;
            let (numbers, off) = group.moved(moves);
            excess += off;
            for (number, (_, slots)) in numbers.into_iter().zip(&group.numbers) {
                values.extend(slots.iter().map(|&slot| (slot, number)));
            }
        }
        values.sort_by_key(|(slot, _)| *slot);
        let mut values = values.into_iter().peekable();
        let mut system = self.start.clone();
        let mut index = 0;
        visit(&mut system, &mut |_, x| {
            if let Some((_, value)) = values.next_if(|(slot, _)| *slot == index) {
                *x = value;
            }
            index += 1;
        });
        (system, excess)
    }
}

impl Group {
    /// How many numbers of a vector are its own.
    fn len(&self) -> usize {
        match self.rule {
            Rule::Even(..) => 1,
            Rule::Ladder(..) | Rule::Factor | Rule::Free => self.numbers.len(),
        }
    }

    /// The numbers moved, and the square of what was not possible.
    fn moved(&self, by: &[f64]) -> (Vec<f64>, f64) {
        let limited = |most: f64| {
            let limited: Vec<f64> = by.iter().map(|x| x.clamp(-most, most)).collect();
            let excess: f64 = by.iter().zip(&limited).map(|(x, l)| (x - l).powi(2)).sum();
            (limited, excess)
        };
        match &self.rule {
            Rule::Ladder(ladder, step) => {
                let starts = self.numbers.iter().map(|(start, _)| start);
                let wanted: Vec<f64> = starts.zip(by).map(|(s, x)| s + x * self.unit).collect();
                let found = ladder.nearest(&wanted);
                let off = |(w, f): (&f64, &f64)| ((w - f) / self.unit).powi(2);
                let excess = wanted.iter().zip(&found).map(off).sum();
                let rounded: Vec<f64> = found.iter().map(|x| round(*x, *step)).collect();
                // What stands at a wall that is no round number stays there.
                let kept = if ladder.holds(&rounded) {
                    rounded
                } else {
                    found
                };
                (kept, excess)
            }
            Rule::Factor => {
                let (by, excess) = limited(1.0);
                let numbers = self.numbers.iter().zip(by);
                (numbers.map(|((x, _), by)| x * by.exp2()).collect(), excess)
            }
            Rule::Free => {
                let (by, excess) = limited(FAR);
                let numbers = self.numbers.iter().zip(by);
                let moved = numbers.map(|((x, _), by)| x + by * self.unit);
                (moved.collect(), excess)
            }
            Rule::Even(first, last) => {
                let count = self.numbers.len().max(1) as f64;
                let start = self.numbers.last().map_or(*first, |(x, _)| *x);
                let wanted = start + by.first().map_or(0.0, |x| x * self.unit);
                let found = wanted.clamp(*last.start(), *last.end());
                let step = (EVEN * self.unit).log2().floor().exp2();
                let steps = ((found - first) / count / step).round();
                let most = ((last.end() - first) / count / step).floor();
                // As it is, if that is no round number.
                let apart = if wanted == start {
                    (start - first) / count
                } else {
                    steps.min(most) * step
                };
                let numbers = (1..=self.numbers.len()).map(|i| first + apart * i as f64);
                (numbers.collect(), ((wanted - found) / self.unit).powi(2))
            }
        }
    }
}

/// To the nearest multiple of a power of ten, as its decimal digits say it.
fn round(x: f64, step: f64) -> f64 {
    if step >= 1.0 {
        return (x / step).round() * step;
    }
    let ones = (1.0 / step).round();
    (x * ones).round() / ones
}

fn range(system: &System, variable: Variable) -> &RangeInclusive<f64> {
    match variable {
        Variable::Input(index) => &system.inputs[index].range,
        Variable::Output(index) => &system.outputs[index].range,
    }
}

/// An input's knots, if they are evenly spaced and all of them may move; the first of them does not.
fn evenly(
    slots: &[(usize, Slot, f64)],
    range: &RangeInclusive<f64>,
    selection: &Selection,
) -> Option<Group> {
    let mut knots: Vec<(f64, Vec<usize>)> = Vec::new();
    let mut of: Vec<&(usize, Slot, f64)> = slots
        .iter()
        .filter(|(_, slot, _)| slot.role == Role::Knot)
        .collect();
    of.sort_by(|a, b| a.2.total_cmp(&b.2));
    for (index, _, value) in of {
        match knots.last_mut() {
            Some(last) if last.0 == *value => last.1.push(*index),
            _ => knots.push((*value, vec![*index])),
        }
    }
    let mut owners: Vec<(Variable, usize)> = Vec::new();
    owners.extend(slots.iter().map(|(_, slot, _)| (slot.variable, slot.term)));
    let (first, last) = (knots.first()?.0, knots.last()?.0);
    let count = knots.len() - 1;
    let apart = (last - first) / count.max(1) as f64;
    let is_even = |(i, knot): (usize, &(f64, Vec<usize>))| {
        (knot.0 - first - apart * i as f64).abs() <= 1e-9 * apart
    };
    let moves = count > 0
        && last <= *range.end()
        && knots.iter().enumerate().all(is_even)
        && owners.iter().all(|owner| selection.moves(&[*owner]));
    moves.then(|| Group {
        unit: range.end() - range.start(),
        numbers: knots.split_off(1),
        rule: Rule::Even(first, first + (range.end() - first) / 4.0..=*range.end()),
    })
}

/// Knots and constants of one variable.
fn ladders(
    slots: &[(usize, Slot, f64)],
    range: &RangeInclusive<f64>,
    selection: &Selection,
) -> Vec<Group> {
    let (low, high) = (*range.start(), *range.end());
    let owners = |slots_of: &[usize]| -> Vec<(Variable, usize)> {
        let of = slots.iter().filter(|slot| slots_of.contains(&slot.0));
        of.map(|(_, slot, _)| (slot.variable, slot.term)).collect()
    };
    let rungs = |role: Role| {
        let mut found: Vec<&(usize, Slot, f64)> = slots
            .iter()
            .filter(|(_, slot, x)| slot.role == role && x.is_finite())
            .collect();
        found.sort_by(|a, b| a.2.total_cmp(&b.2));
        let mut rungs: Vec<Rung> = Vec::new();
        for (index, _, value) in found {
            match rungs.last_mut() {
                Some(last) if role == Role::Knot && last.value == *value => last.slots.push(*index),
                _ => rungs.push(Rung {
                    value: *value,
                    slots: vec![*index],
                    moves: true,
                }),
            }
        }
        for rung in &mut rungs {
            let inside = match role {
                Role::Knot => rung.value > low && rung.value < high,
                _ => range.contains(&rung.value),
            };
            rung.moves = inside && selection.moves(&owners(&rung.slots));
        }
        rungs
    };
    let mut groups = between(rungs(Role::Knot), range, LEAST, true);
    groups.extend(between(rungs(Role::Constant), range, LEAST_CONSTANT, false));
    groups
}

/// A ladder for every run of numbers that move, its walls the ones around it that stay, or the range's ends.
fn between(
    rungs: Vec<Rung>,
    range: &RangeInclusive<f64>,
    share: f64,
    ends_apart: bool,
) -> Vec<Group> {
    let (start, end) = (*range.start(), *range.end());
    let unit = end - start;
    let mut groups = Vec::new();
    let mut run: Vec<(f64, Vec<usize>)> = Vec::new();
    // The wall, and whether to keep away from it.
    let mut wall = (start, ends_apart);
    let close = |run: &mut Vec<(f64, Vec<usize>)>, low: (f64, bool), high: (f64, bool)| {
        let numbers = std::mem::take(run);
        if numbers.is_empty() {
            return None;
        }
        let mut marks = vec![low.0];
        marks.extend(numbers.iter().map(|(value, _)| *value));
        marks.push(high.0);
        let last = marks.len() - 2;
        let least: Vec<f64> = marks
            .windows(2)
            .enumerate()
            .map(|(i, two)| {
                let apart = (i > 0 || low.1) && (i < last || high.1);
                if apart {
                    (share * unit).min((two[1] - two[0]) / 2.0)
                } else {
                    0.0
                }
            })
            .collect();
        let narrow = least.iter().copied().filter(|x| *x > 0.0);
        let fine = narrow.fold(unit * ROUND, |step, least| step.min(least / 10.0));
        let step = 10.0_f64.powf(fine.log10().floor());
        let rule = Rule::Ladder(Ladder::new(low.0, high.0, least), step);
        Some(Group {
            unit,
            numbers,
            rule,
        })
    };
    for rung in rungs {
        if rung.moves {
            run.push((rung.value, rung.slots));
            continue;
        }
        if rung.value <= start {
            wall = (start, ends_apart || rung.value == start);
        } else if rung.value < end {
            groups.extend(close(&mut run, wall, (rung.value, true)));
            wall = (rung.value, true);
        } else {
            groups.extend(close(
                &mut run,
                wall,
                (end, ends_apart || rung.value == end),
            ));
        }
    }
    groups.extend(close(&mut run, wall, (end, ends_apart)));
    groups
}

/// Widths and numbers of order 1 of one variable: each for itself.
fn alone(system: &System, slots: &[(usize, Slot, f64)], selection: &Selection) -> Vec<Group> {
    let selected = slots
        .iter()
        .filter(|(_, slot, _)| selection.moves(&[(slot.variable, slot.term)]));
    let width = |range: &RangeInclusive<f64>| range.end() - range.start();
    selected
        .filter_map(|(index, slot, value)| {
            let own = width(range(system, slot.variable));
            let (unit, rule) = match slot.role {
                Role::Knot | Role::Constant => return None,
                Role::Width => (1.0, Rule::Factor),
                Role::Linear(None) => (own, Rule::Free),
                Role::Linear(Some(input)) => (own / width(&system.inputs[input].range), Rule::Free),
            };
            Some(Group {
                unit,
                numbers: vec![(*value, vec![*index])],
                rule,
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::check::{MOST_WORK, coverage};
    use crate::fuzzy::lower::{LowerError, lower};
    use crate::fuzzy::model::{Conclusion, Shape};
    use crate::fuzzy::random;
    use crate::fuzzy::sample::fan;
    use proptest::prelude::*;
    use rand::SeedableRng;
    use rand_pcg::Pcg64;

    fn all() -> Selection {
        Selection::default()
    }

    #[test]
    fn the_zero_vector_is_the_design() {
        let movable = Movable::new(&fan(), &all());
        // Three temperatures, two humidities, three speeds.
        assert_eq!(movable.len(), 8);
        assert_eq!(movable.decode(&[0.0; 8]), (fan(), 0.0));
    }

    #[test]
    fn what_is_shared_moves_together() {
        let movable = Movable::new(&fan(), &all());
        let (moved, excess) = movable.decode(&[0.0, 0.1, 0.0, 0.0, 0.0, 0.0, -0.2, 0.0]);
        assert_eq!(excess, 0.0);
        let temperature: Vec<_> = moved.inputs[0].terms.iter().map(|t| &t.shape).collect();
        let (low, mid, high) = (18.0, 28.0, 32.0);
        assert_eq!(temperature[0], &Shape::Ramp { from: mid, to: low });
        let middle = Shape::Triangle {
            left: low,
            peak: mid,
            right: high,
        };
        assert_eq!(temperature[1], &middle);
        assert_eq!(
            temperature[2],
            &Shape::Ramp {
                from: mid,
                to: high
            }
        );
        assert_eq!(
            moved.outputs[0].terms[1].conclusion,
            Conclusion::Constant(20.0)
        );
    }

    #[test]
    fn too_far_is_as_far_as_possible_and_costs() {
        let movable = Movable::new(&fan(), &all());
        let (moved, excess) = movable.decode(&[0.0, 0.0, 0.0, 0.0, 0.0, -1.0, 0.0, 5.0]);
        assert_eq!(moved, fan());
        assert!((excess - 26.0).abs() < 1e-9, "{excess}");
    }

    #[test]
    fn the_selection_holds() {
        let selection = Selection {
            only: vec![(Variable::Input(0), None), (Variable::Output(0), Some(1))],
            fix: vec![(Variable::Input(0), Some(0))],
            even: Vec::new(),
        };
        // The low temperature's foot is the middle one's peak: only the high peak is left, and the half speed.
        let movable = Movable::new(&fan(), &selection);
        assert_eq!(movable.len(), 2);
        let (moved, _) = movable.decode(&[-1.0, 1.0]);
        let high = &moved.inputs[0].terms[2].shape;
        assert_eq!(
            high,
            &Shape::Ramp {
                from: 24.0,
                to: 24.4
            }
        );
        assert_eq!(
            moved.outputs[0].terms[1].conclusion,
            Conclusion::Constant(99.9)
        );
    }

    #[test]
    fn what_has_to_stay_even_does() {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/designs/fine.fll");
        let fine = crate::fuzzy::files::load(std::path::Path::new(file), None).unwrap();
        let d = fine
            .inputs
            .iter()
            .position(|input| input.name == "d")
            .unwrap();
        let selection = Selection {
            only: vec![(Variable::Input(d), None)],
            even: vec![d],
            ..Selection::default()
        };
        let movable = Movable::new(&fine, &selection);
        assert_eq!(movable.len(), 1);
        assert_eq!(movable.decode(&[0.0]), (fine.clone(), 0.0));
        let peaks = |by: f64| {
            let (moved, excess) = movable.decode(&[by]);
            let shapes: Vec<Shape> = moved.inputs[d]
                .terms
                .iter()
                .map(|t| t.shape.clone())
                .collect();
            let [
                Shape::Ramp { to: a, from: b },
                ..,
                Shape::Ramp { from: d, to: e },
            ] = shapes[..]
            else {
                panic!("{shapes:?}");
            };
            let Shape::Triangle { left, peak, right } = shapes[2] else {
                panic!("{shapes:?}");
            };
            assert_eq!((left, right), (b, d));
            ([a, b, peak, d, e], excess)
        };
        assert_eq!(peaks(-0.25), ([0.0, 0.75, 1.5, 2.25, 3.0], 0.0));
        // Within what the range holds, and a quarter of it.
        assert_eq!(peaks(0.5), ([0.0, 1.0, 2.0, 3.0, 4.0], 0.25));
        assert_eq!(peaks(-1.0).0, [0.0, 0.25, 0.5, 0.75, 1.0]);
        // In steps that fixed point has, so that it is even there, too.
        let (uneven, _) = peaks(-0.123_456);
        assert!(
            uneven[1] != 1.0 && (uneven[1] * 512.0).fract() == 0.0,
            "{uneven:?}"
        );
        // One of its terms that stays keeps all of them.
        let fixed = Selection {
            fix: vec![(Variable::Input(d), Some(1))],
            ..selection
        };
        assert!(Movable::new(&fine, &fixed).is_empty());
    }

    /// Knots of an input that its range holds, in the order of their slots; equal ones have equal ranks.
    fn ranks(system: &System) -> Vec<usize> {
        let mut knots = Vec::new();
        visit(&mut system.clone(), &mut |slot, x| {
            if slot.role == Role::Knot {
                knots.push((slot.variable, *x));
            }
        });
        let below = |(variable, x): &(Variable, f64)| {
            let mut less: Vec<f64> = knots
                .iter()
                .filter(|other| other.0 == *variable && other.1 < *x)
                .map(|other| other.1)
                .collect();
            less.sort_by(f64::total_cmp);
            less.dedup();
            less.len()
        };
        knots.iter().map(below).collect()
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(200))]

        /// Whatever the vector: what the library proves of the start it proves of the candidate, order and ties stay, and
        /// a system of straight terms keeps its gaps and dead rules.
        #[test]
        fn every_candidate_keeps_every_proof(
            seed in any::<u64>(),
            far in prop::sample::select(vec![0.05, 0.5, 20.0]),
            moves in prop::collection::vec(-1.0..1.0, 200),
        ) {
            let start = random::system(&mut Pcg64::seed_from_u64(seed));
            prop_assume!(lower(&start).is_ok());
            let movable = Movable::new(&start, &all());
            let vector: Vec<f64> = moves.iter().map(|x| x * far).take(movable.len()).collect();
            prop_assume!(vector.len() == movable.len());
            let (candidate, _) = movable.decode(&vector);
            match lower(&candidate) {
                Ok(_) => {}
                // A set that has moved between the samples: the search refuses the candidate.
                Err(LowerError::EmptySet { .. }) => return Ok(()),
                Err(error) => prop_assert!(false, "{}", error),
            }
            prop_assert_eq!(ranks(&start), ranks(&candidate));
            let straight = |s: &System| s.inputs.iter().flat_map(|i| &i.terms).all(|term| {
                !matches!(
                    term.shape,
                    Shape::Gaussian { .. } | Shape::TwoSidedGaussian { .. } | Shape::Bell { .. } | Shape::Sigmoid { .. }
                )
            });
            if straight(&start)
                && let (Some(before), Some(after)) = (
                        coverage(&start, MOST_WORK),
                        coverage(&candidate, MOST_WORK),
                    )
            {
                prop_assert_eq!(before.fires, after.fires);
                prop_assert_eq!(before.gaps.is_empty(), after.gaps.is_empty());
            }
        }
    }
}
