//! From inputs to outputs, with the same work for every input: loops run over the tables alone, and nothing is left out
//! because a degree is zero.

use super::arithmetic::{if_negative, limited, quotient, reduced, rounded};
use super::piece::membership;
use super::{Block, Defuzzifier, Degree, Literal, Merge, Norm, Number, Rule, Samples, Set, System};
use crate::fuzzy::Grade;

/// The most inputs.
pub const MAX_INPUTS: usize = 4;

impl System<'_> {
    /// Evaluates it. What is missing in `inputs` counts as 0; what has no place in the other lists is left out, so they are
    /// long enough or the outputs are wrong.
    #[inline]
    pub(super) fn run(
        &self,
        inputs: &[i32],
        terms: &mut [Degree],
        rules: &mut [Degree],
        outputs: &mut [i32],
    ) {
        let mut limited = [0; MAX_INPUTS];
        let mut places = terms.iter_mut();
        for ((input, taken), i) in self.inputs.iter().zip(&mut limited).zip(0..MAX_INPUTS) {
            let x = input.limited(inputs.get(i).copied().unwrap_or(0));
            *taken = x;
            for (term, place) in input.terms.iter().zip(&mut places) {
                *place = membership(term, x);
            }
        }
        let mut places = rules.iter_mut();
        for block in self.blocks {
            for (rule, place) in block.rules.iter().zip(&mut places) {
                *place = self.activation(block.and, rule, terms);
            }
        }
        let fired = Fired {
            blocks: self.blocks,
            degrees: rules,
        };
        // No `enumerate`: it counts with a check.
        let count = self.outputs.len();
        for ((output, place), i) in self.outputs.iter().zip(outputs).zip(0..count) {
            let (value, weight) = match output.defuzzifier {
                Defuzzifier::WeightedAverage { merge, terms } => {
                    fired.average(i, merge, terms, &limited)
                }
                Defuzzifier::Centroid {
                    merge,
                    samples,
                    terms,
                } => fired.centroid(i, merge, samples, terms),
            };
            let value = self::limited(value.into(), output.range);
            // All ones where nothing fired.
            let silent = if_negative((weight as i64).wrapping_sub(1));
            *place = (output.default & silent) | (value & !silent);
        }
    }

    /// A rule's degree.
    #[inline]
    fn activation(&self, and: Norm, rule: &Rule<'_>, terms: &[Degree]) -> Degree {
        let mut any = Degree::ZERO;
        for conjunction in rule.when {
            let mut all = Degree::ONE;
            for &literal in *conjunction {
                let degree = self.degree(literal, terms);
                all = match and {
                    Norm::Min => all.least(degree),
                    Norm::Product => all.product(degree),
                };
            }
            any = any.most(all);
        }
        if rule.weight.bits() < Degree::ONE.bits() {
            any.product(rule.weight)
        } else {
            any
        }
    }

    fn degree(&self, literal: Literal, terms: &[Degree]) -> Degree {
        let (Literal::Is(input, term) | Literal::IsNot(input, term)) = literal;
        let first = self.first_terms.get(usize::from(input)).copied();
        let place = usize::from(first.unwrap_or(0)).wrapping_add(usize::from(term));
        let degree = terms.get(place).copied().unwrap_or(Degree::ZERO);
        match literal {
            Literal::Is(..) => degree,
            Literal::IsNot(..) => degree.complement(),
        }
    }
}

/// Rules with their degrees.
struct Fired<'a> {
    blocks: &'a [Block<'a>],
    degrees: &'a [Degree],
}

impl Fired<'_> {
    /// Every conclusion about an output: the term, the degree and the implication.
    #[inline]
    fn conclusions(&self, output: usize, mut each: impl FnMut(u8, Degree, Norm)) {
        let mut degrees = self.degrees.iter();
        for block in self.blocks {
            for (rule, &degree) in block.rules.iter().zip(&mut degrees) {
                for &(of, term) in rule.then {
                    if usize::from(of) == output {
                        each(term, degree, block.implication);
                    }
                }
            }
        }
    }

    /// Σ w·z / Σ w, and Σ w. That the sums fit is checked when a system is made.
    fn average(
        &self,
        output: usize,
        merge: Merge,
        terms: &[Number<'_>],
        inputs: &[i32],
    ) -> (i32, u64) {
        let (mut sum, mut weight) = (0i64, 0u64);
        let mut add = |degree: u32, number: &Number<'_>| {
            let value = match number {
                Number::Constant(value) => *value,
                Number::Linear(linear) => linear.at(inputs),
            };
            sum = sum.wrapping_add(i64::from(degree as i32).wrapping_mul(value.into()));
            weight = weight.wrapping_add(degree.into());
        };
        match merge {
            Merge::Sum => self.conclusions(output, |term, degree, _| {
                if let Some(number) = terms.get(usize::from(term)) {
                    add(degree.bits(), number);
                }
            }),
            Merge::Max => {
                let count = terms.len();
                for (number, i) in terms.iter().zip(0..count) {
                    let mut merged = Degree::ZERO;
                    self.conclusions(output, |term, degree, _| {
                        if usize::from(term) == i {
                            merged = merged.most(degree);
                        }
                    });
                    add(merged.bits(), number);
                }
            }
        }
        (rounded(sum, weight), weight)
    }

    /// The centroid of the merged sets, and their area.
    fn centroid(
        &self,
        output: usize,
        merge: Merge,
        samples: Samples,
        terms: &[Set<'_>],
    ) -> (i32, u64) {
        let (mut moment, mut area) = (0u64, 0u64);
        for place in 0..samples.count() {
            // A sum has more than 32 bits where hundreds of rules conclude the same; the largest never has.
            let mut merged = 0u64;
            self.conclusions(output, |term, degree, implication| {
                let set = terms.get(usize::from(term)).copied().unwrap_or_default();
                let grade = set.get(place).copied().unwrap_or(Grade::ZERO);
                // A grade is a degree with nine bits less.
                let member = Degree::known(u32::from(grade.bits()).wrapping_shl(9));
                let implied = match implication {
                    Norm::Min => degree.least(member),
                    Norm::Product => degree.product(member),
                };
                merged = match merge {
                    Merge::Sum => merged.wrapping_add(implied.bits().into()),
                    Merge::Max => Degree::known(merged as u32).most(implied).bits().into(),
                };
            });
            area = area.wrapping_add(merged);
            moment = moment.wrapping_add(merged.wrapping_mul(place as u64));
        }
        let (top, bottom) = reduced(moment, area);
        let top = top.wrapping_shl(Samples::FRACTION);
        let mean = quotient(top.wrapping_add((bottom >> 1).into()), bottom);
        // Where nothing fired it means nothing, and is not used.
        (samples.at(mean), area)
    }
}
