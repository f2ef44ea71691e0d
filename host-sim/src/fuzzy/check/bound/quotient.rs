//! How far an output may be off in a box: it is a quotient of sums of weights, and so is its bound.

use super::along::Cell;
use super::spread::Spread;
use super::{DEGREE, SET};
use crate::fuzzy::check::accuracy::STRENGTHS;
use crate::fuzzy::evaluate::{conjoined, merged, rules, samples};
use crate::fuzzy::lower::Lowered;
use crate::fuzzy::model::{Conclusion, Conjunction, Defuzzifier, Merge, Output, System};

/// An output as its bound needs it.
pub struct Target<'a> {
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
    /// One of a system's.
    pub fn new(system: &'a System, lowered: &Lowered, index: usize) -> Self {
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

    /// Its bounds in a box, of [`STRENGTHS`]: from every rule's degree there, and from where the inputs are.
    pub fn bounds(
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
