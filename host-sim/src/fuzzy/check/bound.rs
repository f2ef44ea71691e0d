//! How far fixed point can be from `f64` anywhere, not only where it was measured.
//!
//! 1. Each input's terms are compared along their own axis, at thousands of values: the greatest difference nearby, a tenth
//!    more and a step of a degree, is what a term may be off. It holds all of rounding the input, straight pieces for curves,
//!    rounding the degree.
//! 2. The ranges are cut into boxes, finer where the bound is greatest. In each, every term's least and greatest degree are known, so those of every rule are, and how
//!    far a rule may be off: the minimum and the maximum are off by no more than the worst of their operands, products by the
//!    sum of what their factors are off.
//! 3. An output Σ w·z / Σ w whose weights are off by E in all is off by E · (greatest z − least z) / (Σ w − E), where only
//!    conclusions count that have a weight in the box; a centroid likewise, by its samples. Rounding conclusions and the output
//!    is added.
//!
//! Where rules have little weight that is much, and truly so: the quotient of two small numbers of steps says little. So
//! the bound is told for each of [`STRENGTHS`]. It does not hold within two steps of where a term jumps: there a rounded input
//! may be on the other side.

use super::accuracy::STRENGTHS;
use super::grid::Grid;
use super::jumps::Jumps;
use crate::fuzzy::evaluate::{conjoined, merged, rules, samples};
use crate::fuzzy::lower::{Fixed, Lowered};
use crate::fuzzy::model::{
    Antecedent, Conclusion, Conjunction, Defuzzifier, Input, Merge, Output, Rule, RuleBlock, System,
};
use fuzzypilot::fuzzy::Grade;
use fuzzypilot::fuzzy::system::{self as fixed, Degree};
use rayon::prelude::*;
use std::ops::RangeInclusive;

/// The greatest error of each output, in its own unit, for each of [`STRENGTHS`].
pub type Bounds = Vec<[f64; STRENGTHS.len()]>;

/// About how many boxes it begins with; those with bounds near the greatest are halved, again and again.
const FIRST_BOXES: usize = 2_000;
/// How near, as a share of the greatest.
const NEAR: f64 = 0.7;
/// Boxes that are looked at more, fewer of a costly system.
const MOST_BOXES: usize = 20_000;
const MOST_WORK: usize = 100_000_000;
/// Values along an input at which its terms are compared, and parts in which the greatest difference is kept.
const VALUES: usize = 16_384;
const PARTS: usize = 1024;
/// A step of a degree.
const DEGREE: f64 = 1.0 / Degree::ONE.bits() as f64;
/// Half a step of a set's degree.
const SET: f64 = 0.5 / Grade::ONE.bits() as f64;

/// Finds the bounds of a system's fixed point.
pub fn bounds(system: &System, lowered: &Lowered) -> Bounds {
    let along = Along::all(system, lowered);
    let outputs: Vec<Target> = (0..system.outputs.len())
        .map(|index| Target::new(system, lowered, index))
        .collect();
    let looked_at = |region: Region| {
        let place: Vec<Cell> = along
            .iter()
            .zip(&region)
            .map(|(a, &(from, to))| a.cell(from, to))
            .collect();
        let degrees: Vec<Spread> = rules(system)
            .map(|(block, rule)| of_rule(rule, block, &place))
            .collect();
        let bounds = outputs
            .iter()
            .map(|output| output.bounds(system, &degrees, &place))
            .collect();
        Looked {
            halves: halves(&region, &along, &place),
            bounds,
        }
    };
    let grid = Grid::new(system, FIRST_BOXES);
    let mut boxes: Vec<Looked> = regions(&grid).into_par_iter().map(looked_at).collect();
    let mut left = (MOST_WORK / cost(system)).min(MOST_BOXES);
    loop {
        let worst = greatest(&boxes, outputs.len());
        let (near, mut rest): (Vec<Looked>, Vec<Looked>) = boxes
            .into_iter()
            .partition(|b| b.halves.is_some() && b.is_near(&worst));
        if near.is_empty() || left < 2 * near.len() {
            return worst;
        }
        left -= 2 * near.len();
        let halves: Vec<Region> = near
            .into_iter()
            .filter_map(|b| b.halves)
            .flatten()
            .collect();
        rest.par_extend(halves.into_par_iter().map(looked_at));
        boxes = rest;
    }
}

/// A box: from where to where along each input.
type Region = Vec<(f64, f64)>;

/// A box that was looked at.
struct Looked {
    bounds: Bounds,
    /// Its halves, if halving it may make the bounds less.
    halves: Option<[Region; 2]>,
}

impl Looked {
    /// Whether one of its bounds is among the greatest.
    fn is_near(&self, worst: &Bounds) -> bool {
        let mut pairs = self.bounds.iter().flatten().zip(worst.iter().flatten());
        pairs.any(|(own, worst)| *own > 0.0 && *own >= NEAR * worst)
    }
}

fn greatest(boxes: &[Looked], outputs: usize) -> Bounds {
    let mut worst = vec![[0.0_f64; STRENGTHS.len()]; outputs];
    for looked in boxes {
        for (worst, own) in worst
            .iter_mut()
            .flatten()
            .zip(looked.bounds.iter().flatten())
        {
            *worst = worst.max(*own);
        }
    }
    worst
}

/// The boxes between a grid's points.
fn regions(grid: &Grid) -> Vec<Region> {
    let mut regions: Vec<Region> = vec![Vec::new()];
    for axis in &grid.axes {
        regions = regions
            .into_iter()
            .flat_map(|region| {
                let longer = |two: &[f64]| [&region[..], &[(two[0], two[1])]].concat();
                axis.windows(2).map(longer).collect::<Vec<_>>()
            })
            .collect();
    }
    regions
}

/// Across the input whose terms' degrees differ most in it.
fn halves(region: &Region, along: &[Along], place: &[Cell]) -> Option<[Region; 2]> {
    let differ = |cell: &Cell| {
        let apart = cell.terms.iter().map(|spread| spread.high - spread.low);
        apart.fold(0.0, f64::max)
    };
    let wide = |input: usize| region[input].1 - region[input].0 > 8.0 * along[input].step;
    let across = (0..region.len())
        .filter(|&input| wide(input) && differ(&place[input]) > 0.0)
        .max_by(|&a, &b| differ(&place[a]).total_cmp(&differ(&place[b])))?;
    let (from, to) = region[across];
    let middle = from + (to - from) / 2.0;
    let half = |ends: (f64, f64)| {
        let mut half = region.clone();
        half[across] = ends;
        half
    };
    Some([half((from, middle)), half((middle, to))])
}

/// What looking at a box costs, about.
fn cost(system: &System) -> usize {
    let rules = rules(system).count();
    let samples: usize = system
        .outputs
        .iter()
        .map(|output| samples(output).len())
        .sum();
    8 * rules + samples * rules.min(16) + 100
}

/// A degree's least and greatest value in a box, and how far fixed point may be from it.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Spread {
    low: f64,
    high: f64,
    error: f64,
}

impl Spread {
    const NONE: Self = Self {
        low: 0.0,
        high: 0.0,
        error: 0.0,
    };

    /// What is zero everywhere is so in fixed point.
    fn settled(self) -> Self {
        if self.high <= 0.0 { Self::NONE } else { self }
    }
}

/// Along one input of a box: from where to where, two steps wider on both sides as a rounded input may be, and every term's
/// spread.
struct Cell {
    range: RangeInclusive<f64>,
    terms: Vec<Spread>,
}

/// An input, and how far its terms may be off along it.
struct Along<'a> {
    input: &'a Input,
    step: f64,
    /// Each term's knots.
    knots: Vec<Vec<f64>>,
    /// Each term's greatest difference in each of [`PARTS`], then in pairs of them, fours, and so on from each.
    errors: Vec<Vec<Vec<f64>>>,
}

impl<'a> Along<'a> {
    fn all(system: &'a System, lowered: &Lowered) -> Vec<Self> {
        let jumps = Jumps::of(system, lowered);
        let along = |index: usize| Self::new(system, lowered, index, &jumps);
        (0..system.inputs.len())
            .into_par_iter()
            .map(along)
            .collect()
    }

    fn new(system: &'a System, lowered: &Lowered, index: usize, jumps: &Jumps) -> Self {
        let (input, format) = (&system.inputs[index], lowered.tables().inputs[index].format);
        let mut along = Self {
            input,
            step: format.value(1),
            knots: input.terms.iter().map(|term| term.shape.knots()).collect(),
            errors: vec![vec![vec![0.0; PARTS]]; input.terms.len()],
        };
        let mut at = along.values();
        at.retain(|&x| !jumps.near_in(index, x));
        let steps: Vec<i32> = at.iter().map(|&x| format.nearest(x)).collect();
        let found = lowered.open(|fixed| degrees(&fixed, index, &steps));
        for (&x, found) in at.iter().zip(found) {
            let part = along.part(x);
            for ((term, errors), found) in input.terms.iter().zip(&mut along.errors).zip(found) {
                let error = &mut errors[0][part];
                *error = error.max((term.shape.degree(x) - found).abs());
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

    /// Where terms are compared: evenly, at knots and beside them; and as far as can be from what they are rounded to.
    fn values(&self) -> Vec<f64> {
        let (start, end) = (*self.input.range.start(), *self.input.range.end());
        let mut at: Vec<f64> = (0..=VALUES)
            .map(|i| start + (end - start) * (i as f64 / VALUES as f64))
            .collect();
        let beside = 3.0 * self.step;
        at.extend(
            self.knots
                .iter()
                .flatten()
                .flat_map(|x| [x - beside, *x, x + beside]),
        );
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

    fn cell(&self, from: f64, to: f64) -> Cell {
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
            let (low, high) = (ends.into_iter().chain(knots).map(|x| shape.degree(x)))
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

/// The library's degrees of one input's terms at many values, by a system that has no more than one rule.
fn degrees(fixed: &Fixed<'_>, index: usize, at: &[i32]) -> Vec<Vec<f64>> {
    let inputs = &fixed.system().inputs()[index..=index];
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
    let system = fixed::System::checked(inputs, &blocks, &outputs);
    let system = system.expect("its input was checked before, and the rest is good");
    let mut terms = vec![Degree::ZERO; system.term_count()];
    let mut each = |x: &i32| {
        let done = system.evaluate(&[*x], &mut terms, &mut [Degree::ZERO], &mut [0]);
        done.expect("memory by the system's own sizes");
        terms
            .iter()
            .map(|degree| f64::from(degree.bits()) * DEGREE)
            .collect()
    };
    at.iter().map(&mut each).collect()
}

fn of_rule(rule: &Rule, block: &RuleBlock, place: &[Cell]) -> Spread {
    let antecedent = of_antecedent(&rule.antecedent, block.and, place);
    let rounding = if rule.weight < 1.0 { DEGREE } else { 0.0 };
    Spread {
        low: antecedent.low * rule.weight,
        high: antecedent.high * rule.weight,
        error: antecedent.error * rule.weight + rounding,
    }
    .settled()
}

fn of_antecedent(antecedent: &Antecedent, and: Conjunction, place: &[Cell]) -> Spread {
    match antecedent {
        Antecedent::Is {
            input,
            term,
            negated,
        } => {
            let spread = place[*input].terms[*term];
            let turned = Spread {
                low: 1.0 - spread.high,
                high: 1.0 - spread.low,
                ..spread
            };
            if *negated { turned } else { spread }.settled()
        }
        Antecedent::And(parts) => {
            let whole = Spread {
                low: 1.0,
                high: 1.0,
                error: 0.0,
            };
            let all = parts.iter().map(|part| of_antecedent(part, and, place));
            all.fold(whole, |a, b| Spread {
                low: conjoined(and, a.low, b.low),
                high: conjoined(and, a.high, b.high),
                error: match and {
                    Conjunction::Min => a.error.max(b.error),
                    Conjunction::Product => {
                        a.error * (b.high + b.error).min(1.0) + b.error * a.high + DEGREE
                    }
                },
            })
            .settled()
        }
        Antecedent::Or(parts) => {
            let any = parts.iter().map(|part| of_antecedent(part, and, place));
            any.fold(Spread::NONE, |a, b| Spread {
                low: a.low.max(b.low),
                high: a.high.max(b.high),
                error: a.error.max(b.error),
            })
        }
    }
}

/// An output as its bound needs it.
struct Target<'a> {
    index: usize,
    output: &'a Output,
    /// A step of it, and of each input.
    step: f64,
    input_steps: Vec<f64>,
    /// Its value where no rule fires in fixed point.
    default: f64,
    /// A centroid's samples, and its sets at them.
    samples: Vec<f64>,
    sets: Vec<Vec<f64>>,
}

impl<'a> Target<'a> {
    fn new(system: &'a System, lowered: &Lowered, index: usize) -> Self {
        let (output, table) = (&system.outputs[index], &lowered.tables().outputs[index]);
        let samples = samples(output);
        let set = |conclusion: &Conclusion| match conclusion {
            Conclusion::Set(shape) => samples.iter().map(|&x| shape.degree(x)).collect(),
            Conclusion::Constant(_) | Conclusion::Linear { .. } => Vec::new(),
        };
        Self {
            index,
            output,
            step: table.format.value(1),
            input_steps: (lowered.tables().inputs.iter())
                .map(|input| input.format.value(1))
                .collect(),
            default: table.format.value(table.default),
            sets: output
                .terms
                .iter()
                .map(|term| set(&term.conclusion))
                .collect(),
            samples,
        }
    }

    fn bounds(
        &self,
        system: &System,
        degrees: &[Spread],
        place: &[Cell],
    ) -> [f64; STRENGTHS.len()] {
        let about: Vec<(Conjunction, Spread, usize)> = rules(system)
            .zip(degrees)
            .flat_map(|((block, rule), spread)| {
                let conclusions = rule.conclusions.iter().filter(|c| c.0 == self.index);
                conclusions.map(|&(_, term)| (block.implication, *spread, term))
            })
            .filter(|(_, spread, _)| spread.high > 0.0)
            .collect();
        let strongest = about
            .iter()
            .map(|(_, spread, _)| spread.high)
            .fold(0.0, f64::max);
        let weights = match self.output.defuzzifier {
            Defuzzifier::WeightedAverage => self.of_numbers(&about, place),
            Defuzzifier::Centroid { .. } => self.of_sets(&about),
        };
        let whole = self.output.range.end() - self.output.range.start();
        STRENGTHS.map(|least| {
            if strongest <= 0.0 || strongest < least {
                return 0.0;
            }
            let weight = (weights.least)(least).max(weights.low);
            let (off, apart) = (weights.error, weights.high_value - weights.low_value);
            let silent = weight <= off;
            // In between the two ends it stays in any case, or, if fixed point may see no rule fire, at its default.
            let ends = if silent {
                weights.high_value.max(self.default) - weights.low_value.min(self.default)
            } else {
                apart
            };
            let quotient = if silent {
                ends
            } else {
                (apart * off / (weight - off)).min(ends)
            };
            let bound = quotient + weights.rounding;
            if self.output.clamp {
                bound.min(whole)
            } else {
                bound
            }
        })
    }

    /// Σ w·z / Σ w.
    fn of_numbers(&self, about: &[(Conjunction, Spread, usize)], place: &[Cell]) -> Weights<'_> {
        let mut groups = vec![Spread::NONE; self.output.terms.len()];
        for &(_, spread, term) in about {
            let group = &mut groups[term];
            *group = Spread {
                low: merged(self.output.merge, group.low, spread.low),
                high: merged(self.output.merge, group.high, spread.high),
                error: merged(self.output.merge, group.error, spread.error),
            };
        }
        let mut weights = Weights::new(Box::new(|least| least));
        weights.rounding = self.step;
        for (term, group) in self
            .output
            .terms
            .iter()
            .zip(&groups)
            .filter(|(_, g)| g.high > 0.0)
        {
            weights.low += group.low;
            weights.error += group.error;
            let (low, high, rounding) = self.number(&term.conclusion, place);
            weights.include(low, high);
            weights.rounding = weights.rounding.max(self.step + rounding);
        }
        weights
    }

    /// A conclusion's least and greatest value in a box, and how far fixed point may be from it.
    fn number(&self, conclusion: &Conclusion, place: &[Cell]) -> (f64, f64, f64) {
        match conclusion {
            Conclusion::Constant(value) => (*value, *value, self.step / 2.0),
            Conclusion::Linear {
                coefficients,
                constant,
            } => {
                let (mut low, mut high, mut rounding) = (*constant, *constant, self.step);
                let most = coefficients
                    .iter()
                    .fold(0.0_f64, |most, c| most.max(c.abs()));
                for ((c, cell), step) in coefficients.iter().zip(place).zip(&self.input_steps) {
                    let ends = [cell.range.start(), cell.range.end()];
                    let values = ends.map(|x| c * x);
                    low += values[0].min(values[1]);
                    high += values[0].max(values[1]);
                    // The input, and the coefficient: of the largest, 30 bits are kept.
                    let reach = ends[0].abs().max(ends[1].abs());
                    rounding += c.abs() * step / 2.0 + most * reach / f64::from(1 << 28);
                }
                (low, high, rounding)
            }
            Conclusion::Set(_) => (
                *self.output.range.start(),
                *self.output.range.end(),
                self.step,
            ),
        }
    }

    /// Where the largest counts, rules that do the same to the same set as one: thousands of rules have few sets.
    fn together(
        &self,
        about: &[(Conjunction, Spread, usize)],
    ) -> Vec<(Conjunction, Spread, usize)> {
        if self.output.merge == Merge::Sum {
            return about.to_vec();
        }
        let mut groups: Vec<(Conjunction, Spread, usize)> = Vec::new();
        for &(implication, spread, term) in about {
            let same = groups
                .iter_mut()
                .find(|group| (group.0, group.2) == (implication, term));
            match same {
                Some((_, group, _)) => {
                    *group = Spread {
                        low: group.low.max(spread.low),
                        high: group.high.max(spread.high),
                        error: group.error.max(spread.error),
                    };
                }
                None => groups.push((implication, spread, term)),
            }
        }
        groups
    }

    /// Σ μ·x / Σ μ over the samples.
    fn of_sets(&self, about: &[(Conjunction, Spread, usize)]) -> Weights<'_> {
        let rules: Vec<_> = self
            .together(about)
            .into_iter()
            .map(|(implication, spread, term)| (implication, spread, &self.sets[term]))
            .collect();
        // The least area that a rule of this degree has.
        let areas = rules.clone();
        let mut weights = Weights::new(Box::new(move |least| {
            let able = areas.iter().filter(|(_, spread, _)| spread.high >= least);
            let area = able.map(|(implication, _, set)| -> f64 {
                set.iter()
                    .map(|grade| conjoined(*implication, least, *grade))
                    .sum()
            });
            area.fold(f64::INFINITY, f64::min)
        }));
        // A place among the samples has so many bits; and rounding to steps.
        let apart = self
            .samples
            .windows(2)
            .map(|two| two[1] - two[0])
            .fold(0.0, f64::max);
        weights.rounding = 2.0 * self.step + apart / f64::from(1 << 20);
        for (sample, &x) in self.samples.iter().enumerate() {
            let (mut low, mut error, mut any) = (0.0, 0.0, false);
            for &(implication, spread, set) in &rules {
                let grade = set[sample];
                if grade <= 0.0 {
                    continue;
                }
                any = true;
                low = merged(
                    self.output.merge,
                    low,
                    conjoined(implication, spread.low, grade),
                );
                let own = match implication {
                    Conjunction::Min => spread.error.max(SET),
                    Conjunction::Product => spread.error * grade + spread.high * SET + DEGREE,
                };
                error = merged(self.output.merge, error, own);
            }
            weights.low += low;
            weights.error += error;
            if any {
                weights.include(x, x);
            }
        }
        weights
    }
}

/// What a quotient is made of.
struct Weights<'a> {
    /// The least that all weights come to in the box, and at least, if the strongest rule has a given degree.
    low: f64,
    least: Box<dyn Fn(f64) -> f64 + 'a>,
    /// How far they may be off in all.
    error: f64,
    /// The least and the greatest value that has a weight.
    low_value: f64,
    high_value: f64,
    /// What rounding the values and the quotient may add.
    rounding: f64,
}

impl<'a> Weights<'a> {
    fn new(least: Box<dyn Fn(f64) -> f64 + 'a>) -> Self {
        Self {
            low: 0.0,
            least,
            error: 0.0,
            low_value: f64::INFINITY,
            high_value: f64::NEG_INFINITY,
            rounding: 0.0,
        }
    }

    fn include(&mut self, low: f64, high: f64) {
        self.low_value = self.low_value.min(low);
        self.high_value = self.high_value.max(high);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::check::{class, strength};
    use crate::fuzzy::evaluate::{Evaluator, Exact};
    use crate::fuzzy::lower::lower;
    use crate::fuzzy::random;
    use crate::fuzzy::sample::fan;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    /// The greatest error in each class at random points, by output; points near jumps left out.
    fn measured(system: &System, lowered: &Lowered, rng: &mut Pcg64Mcg, points: usize) -> Bounds {
        let exact = Exact::new(system);
        let mut worst = vec![[0.0_f64; STRENGTHS.len()]; system.outputs.len()];
        let grids: Vec<Vec<f64>> = (Along::all(system, lowered).iter())
            .map(Along::values)
            .collect();
        let jumps = Jumps::of(system, lowered);
        for _ in 0..points {
            let point: Vec<f64> = system
                .inputs
                .iter()
                .zip(&grids)
                .map(|(input, grid)| {
                    let near = grid[rng.random_range(0..grid.len())];
                    let free = rng.random_range(input.range.clone());
                    if rng.random_bool(0.3) { near } else { free }
                })
                .collect();
            if jumps.near(&point) {
                continue;
            }
            let (expected, found) = (exact.evaluate(&point), lowered.evaluate(&point));
            for (index, worst) in worst.iter_mut().enumerate() {
                let strength = strength(system, index, &expected);
                if let (Some(a), Some(b)) = (expected.outputs[index], found.outputs[index])
                    && strength > 0.0
                {
                    let worst = &mut worst[class(strength)];
                    *worst = worst.max((a - b).abs());
                }
            }
        }
        worst
    }

    #[test]
    fn random_systems_stay_within() {
        let mut rng = Pcg64Mcg::seed_from_u64(11);
        let mut tightest = [0.0_f64; STRENGTHS.len()];
        for _ in 0..30 {
            let system = random::system(&mut rng);
            let Ok(lowered) = lower(&system) else {
                continue;
            };
            let bounds = bounds(&system, &lowered);
            let measured = measured(&system, &lowered, &mut rng, 500);
            for ((output, bound), worst) in system.outputs.iter().zip(&bounds).zip(&measured) {
                for class in 0..STRENGTHS.len() {
                    assert!(
                        worst[class] <= bound[class],
                        "class {class} of {}: {} above {} in\n{system:#?}",
                        output.name,
                        worst[class],
                        bound[class],
                    );
                    if bound[class] > 0.0 {
                        tightest[class] = tightest[class].max(worst[class] / bound[class]);
                    }
                }
            }
        }
        // Bounds that nothing comes near would hold as well, and tell nothing.
        assert!(tightest.iter().all(|share| *share > 0.05), "{tightest:?}");
    }

    #[test]
    fn a_complete_table_of_triangles_is_right_to_some_steps() {
        let fan = fan();
        let bounds = bounds(&fan, &lower(&fan).unwrap());
        assert!(
            bounds[0][0] > 0.0 && bounds[0][0] < 100.0 * 1e-4,
            "{bounds:?}"
        );
    }
}
