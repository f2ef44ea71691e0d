//! How far terms may be off along their own input.

use super::DEGREE;
use super::spread::Spread;
use crate::fuzzy::check::jumps::Jumps;
use crate::fuzzy::lower::{Fixed, Lowered};
use crate::fuzzy::model::{Input, System};
use fuzzypilot::fuzzy::system::{self as fixed, Degree};
use rayon::prelude::*;
use std::ops::RangeInclusive;

/// Even values along an input at which its terms are compared, and parts in which the greatest difference is kept.
const VALUES: usize = 16_384;
const PARTS: usize = 1024;
/// Values between two neighbours of a term's knots and its straight pieces' ends: in between, curve and line part once at most,
/// so that these see all of it but a hundredth.
const BETWEEN: usize = 32;

/// Along one input of a box: from where to where, two steps wider on both sides as a rounded input may be, and every term's
/// spread.
pub struct Cell {
    /// See above.
    pub range: RangeInclusive<f64>,
    /// See above.
    pub terms: Vec<Spread>,
}

/// An input, and how far its terms may be off along it.
pub struct Along<'a> {
    input: &'a Input,
    /// A step of it.
    pub step: f64,
    /// Each term's knots.
    knots: Vec<Vec<f64>>,
    /// Each term's greatest difference in each of [`PARTS`], then in pairs of them, fours, and so on from each.
    errors: Vec<Vec<Vec<f64>>>,
}

impl<'a> Along<'a> {
    /// Of every input.
    pub fn all(system: &'a System, lowered: &Lowered) -> Vec<Self> {
        let jumps = Jumps::of(system, lowered);
        let along = |index: usize| Self::new(system, lowered, index, &jumps);
        (0..system.inputs.len())
            .into_par_iter()
            .map(along)
            .collect()
    }

    fn new(system: &'a System, lowered: &Lowered, index: usize, jumps: &Jumps) -> Self {
        let (input, table) = (&system.inputs[index], &lowered.tables().inputs[index]);
        let mut along = Self {
            input,
            step: table.format.value(1),
            knots: input.terms.iter().map(|term| term.shape.knots()).collect(),
            errors: vec![vec![vec![0.0; PARTS]]; input.terms.len()],
        };
        for (term, (_, pieces)) in table.terms.iter().enumerate() {
            let ends = pieces.iter().map(|piece| table.format.value(piece.from()));
            let mut at = along.values(term, ends);
            at.retain(|&x| !jumps.near_in(index, x));
            let steps: Vec<i32> = at.iter().map(|&x| table.format.nearest(x)).collect();
            let found = lowered.open(|fixed| degrees(&fixed, index, term, &steps));
            for (&x, found) in at.iter().zip(found) {
                let exact = input.terms[term].shape.degree(x);
                let part = along.part(x);
                let error = &mut along.errors[term][0][part];
                *error = error.max((exact - found).abs());
            }
        }
        for levels in &mut along.errors {
            let mut width = 1;
            while 2 * width <= PARTS {
                let last = &levels[levels.len() - 1];
                let next = (0..=PARTS - 2 * width)
                    .map(|i| last[i].max(last[i + width]))
                    .collect();
                levels.push(next);
                width *= 2;
            }
        }
        along
    }

    fn part(&self, x: f64) -> usize {
        let share =
            (x - self.input.range.start()) / (self.input.range.end() - self.input.range.start());
        ((share * PARTS as f64) as usize).min(PARTS - 1)
    }

    /// Where a term is compared: evenly; at its knots and beside them; often between neighbours of these and its pieces' ends,
    /// however near they are; and as far as can be from what all of these are rounded to.
    fn values(&self, term: usize, ends: impl Iterator<Item = f64>) -> Vec<f64> {
        let (start, end) = (*self.input.range.start(), *self.input.range.end());
        let mut at: Vec<f64> = (0..=VALUES)
            .map(|i| start + (end - start) * (i as f64 / VALUES as f64))
            .collect();
        let beside = 3.0 * self.step;
        let knots = &self.knots[term];
        at.extend(knots.iter().flat_map(|x| [x - beside, *x, x + beside]));
        let mut marks: Vec<f64> = knots.iter().copied().chain(ends).collect();
        marks.sort_by(f64::total_cmp);
        for two in marks.windows(2).filter(|two| two[0] < two[1]) {
            let share = |i: usize| (two[1] - two[0]) * (i as f64 / BETWEEN as f64);
            at.extend((0..=BETWEEN).map(|i| two[0] + share(i)));
        }
        let rounded = |x: f64| {
            [
                x,
                ((x / self.step).round() + 0.499) * self.step,
                ((x / self.step).round() - 0.499) * self.step,
            ]
        };
        let mut at: Vec<f64> = at.into_iter().flat_map(rounded).collect();
        at.retain(|x| self.input.range.contains(x));
        at
    }

    /// Its terms from one value to another.
    pub fn cell(&self, from: f64, to: f64) -> Cell {
        let range = (from - 2.0 * self.step)..=(to + 2.0 * self.step);
        let inside = (to - from) * 1e-6;
        let (first, last) = (self.part(*range.start()), self.part(*range.end()));
        let level = (last - first + 1).ilog2() as usize;
        let spread = |term: usize| {
            let shape = &self.input.terms[term].shape;
            let knots = self.knots[term]
                .iter()
                .copied()
                .filter(|x| range.contains(x));
            let ends = [
                *range.start(),
                from,
                from + inside,
                to - inside,
                to,
                *range.end(),
            ];
            // At a jump all three count: a spike has its height on neither side, a saw's tooth only before it.
            let degrees = |x: f64| {
                let [before, behind] = shape.beside(x);
                [before, shape.degree(x), behind]
            };
            let (low, high) = (ends.into_iter().chain(knots).flat_map(degrees))
                .fold((1.0_f64, 0.0_f64), |(low, high), d| {
                    (low.min(d), high.max(d))
                });
            let of = &self.errors[term][level];
            let error = of[first].max(of[last + 1 - (1 << level)]);
            Spread {
                low,
                high,
                error: 1.1 * error + DEGREE,
            }
        };
        Cell {
            terms: (0..self.knots.len()).map(spread).collect(),
            range: range.clone(),
        }
    }
}

/// The library's degrees of one term of an input at many values, by a system that has no more than one rule.
fn degrees(fixed: &Fixed<'_>, index: usize, term: usize, at: &[i32]) -> Vec<f64> {
    let input = &fixed.system().inputs()[index];
    let inputs = [fixed::Input {
        terms: &input.terms[term..=term],
        ..*input
    }];
    let rules = [fixed::Rule::new(&[&[fixed::Literal::Is(0, 0)]], &[(0, 0)])];
    let blocks = [fixed::Block::min(&rules)];
    let outputs = [fixed::Output {
        range: [0, 1],
        clamp: true,
        default: 0,
        complete: false,
        defuzzifier: fixed::Defuzzifier::WeightedAverage {
            merge: fixed::Merge::Sum,
            terms: &[fixed::Number::Constant(0)],
        },
    }];
    let system = fixed::System::checked(&inputs, &blocks, &outputs);
    let system = system.expect("its input was checked before, and the rest is good");
    let degree = |x: &i32| {
        let mut terms = [Degree::ZERO];
        let done = system.evaluate(&[*x], &mut terms, &mut [Degree::ZERO], &mut [0]);
        done.expect("memory by the system's own sizes");
        f64::from(terms[0].bits()) * DEGREE
    };
    at.iter().map(degree).collect()
}
