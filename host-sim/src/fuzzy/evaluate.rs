//! Exact evaluation in `f64`: every rule, every sample, no shortcut. What fixed point is measured against.
//!
//! It agrees with fuzzylite 8: a weighted average first merges the degrees of rules that conclude the same term, a centroid
//! merges sets sample by sample; an output whose rules all have the degree zero takes its default, or has no value.

use super::model::{
    Antecedent, Conclusion, Conjunction, Defuzzifier, Merge, Output, Rule, RuleBlock, Sampling,
    System,
};
use fuzzypilot::fuzzy::Grade;

/// What came of one evaluation.
#[derive(Clone, Debug, PartialEq)]
pub struct Evaluation {
    /// Each output's value; `None` where no rule fires, or only such as conclude sets that meet no sample, and the output
    /// has no default.
    pub outputs: Vec<Option<f64>>,
    /// Each rule's degree times its weight, 0 to 1, block after block in the file's order.
    pub rules: Vec<f64>,
}

/// Whatever evaluates a system: [`Exact`], or the library's fixed point.
pub trait Evaluator: Sync {
    /// Evaluates at one value an input, in the inputs' order; missing ones count as NaN. No rule fires through an input
    /// that is NaN.
    fn evaluate(&self, inputs: &[f64]) -> Evaluation;
}

/// All rules of a system with their blocks, in the order of [`Evaluation::rules`].
pub fn rules(system: &System) -> impl Iterator<Item = (&RuleBlock, &Rule)> {
    system
        .blocks
        .iter()
        .flat_map(|block| block.rules.iter().map(move |rule| (block, rule)))
}

/// A value as an input takes it: limited to its range if it clamps.
pub fn taken(system: &System, inputs: &[f64]) -> Vec<f64> {
    let value = |index: usize| inputs.get(index).copied().unwrap_or(f64::NAN);
    let limited = |(index, input): (usize, &super::model::Input)| {
        if input.clamp {
            value(index).clamp(*input.range.start(), *input.range.end())
        } else {
            value(index)
        }
    };
    system.inputs.iter().enumerate().map(limited).collect()
}

/// Every term's degree, input by input.
pub fn memberships(system: &System, inputs: &[f64]) -> Vec<Vec<f64>> {
    let values = taken(system, inputs);
    let degrees = |(input, &x): (&super::model::Input, &f64)| {
        input
            .terms
            .iter()
            .map(|term| term.shape.degree(x))
            .collect()
    };
    system.inputs.iter().zip(&values).map(degrees).collect()
}

/// Where a centroid looks at an output: its samples, ascending.
pub fn samples(output: &Output) -> Vec<f64> {
    let Defuzzifier::Centroid { points, sampling } = output.defuzzifier else {
        return Vec::new();
    };
    let (start, end) = (*output.range.start(), *output.range.end());
    let at = |i: usize| match sampling {
        Sampling::Middles => start + (i as f64 + 0.5) * ((end - start) / points as f64),
        Sampling::Ends => start + i as f64 * ((end - start) / (points.max(2) - 1) as f64),
    };
    (0..points).map(at).collect()
}

/// Whether what a term of an output concludes has a value: a number always, a set if it is anything at one of the samples.
/// Less than half a step of 2⁻¹⁵, as sets have it in fixed point, is nothing.
pub fn meets(output: &Output, term: usize) -> bool {
    const LEAST: f64 = 0.5 / Grade::ONE.bits() as f64;
    match &output.terms[term].conclusion {
        Conclusion::Set(shape) => samples(output).iter().any(|&x| shape.degree(x) >= LEAST),
        Conclusion::Constant(_) | Conclusion::Linear { .. } => true,
    }
}

/// Whether a rule with a weight concludes something about an output: one term of it, or any.
pub fn concluded(system: &System, output: usize, term: Option<usize>) -> bool {
    rules(system)
        .filter(|(_, rule)| rule.weight > 0.0)
        .flat_map(|(_, rule)| &rule.conclusions)
        .any(|&(of, what)| of == output && term.is_none_or(|term| term == what))
}

/// The evaluation in `f64`, with the outputs' sets sampled once.
pub struct Exact<'a> {
    system: &'a System,
    samples: Vec<Sampled>,
}

/// A centroid's samples and every term's degree at them; both empty for a weighted average.
struct Sampled {
    at: Vec<f64>,
    terms: Vec<Vec<f64>>,
}

impl<'a> Exact<'a> {
    /// Prepares a system.
    pub fn new(system: &'a System) -> Self {
        let sampled = |output: &Output| {
            let at = samples(output);
            let degrees = |conclusion: &Conclusion| match conclusion {
                Conclusion::Set(shape) => at.iter().map(|&x| shape.degree(x)).collect(),
                Conclusion::Constant(_) | Conclusion::Linear { .. } => vec![0.0; at.len()],
            };
            let terms = output
                .terms
                .iter()
                .map(|term| degrees(&term.conclusion))
                .collect();
            Sampled { at, terms }
        };
        Self {
            system,
            samples: system.outputs.iter().map(sampled).collect(),
        }
    }

    /// Every rule that concludes something about `output`, with its block's implication, its degree and the term.
    fn conclusions<'b>(
        &'b self,
        output: usize,
        degrees: &'b [f64],
    ) -> impl Iterator<Item = (Conjunction, f64, usize)> + 'b {
        rules(self.system)
            .zip(degrees)
            .flat_map(move |((block, rule), &degree)| {
                let about = rule.conclusions.iter().filter(move |c| c.0 == output);
                about.map(move |&(_, term)| (block.implication, degree, term))
            })
    }

    fn weighted_average(&self, index: usize, inputs: &[f64], degrees: &[f64]) -> Option<f64> {
        let output = self.system.outputs.get(index)?;
        let mut weights = vec![0.0; output.terms.len()];
        for (_, degree, term) in self.conclusions(index, degrees) {
            if let Some(weight) = weights.get_mut(term) {
                *weight = merged(output.merge, *weight, degree);
            }
        }
        let (mut sum, mut weight) = (0.0, 0.0);
        for (term, w) in output.terms.iter().zip(&weights).filter(|(_, w)| **w > 0.0) {
            sum += w * value(&term.conclusion, inputs);
            weight += w;
        }
        quotient(sum, weight)
    }

    fn centroid(&self, index: usize, degrees: &[f64]) -> Option<f64> {
        let output = self.system.outputs.get(index)?;
        let sampled = self.samples.get(index)?;
        // Rules that conclude the same may be put together before their set is looked at, where that is the same.
        let mut activated: Vec<(Conjunction, usize, f64)> = Vec::new();
        for (implication, degree, term) in self.conclusions(index, degrees).filter(|c| c.1 > 0.0) {
            let together = output.merge == Merge::Max || implication == Conjunction::Product;
            let same = activated
                .iter_mut()
                .find(|a| (a.0, a.1) == (implication, term));
            match same.filter(|_| together) {
                Some(same) => same.2 = merged(output.merge, same.2, degree),
                None => activated.push((implication, term, degree)),
            }
        }
        let mut set = vec![0.0; sampled.at.len()];
        for (implication, term, degree) in activated {
            for (grade, shape) in set.iter_mut().zip(sampled.terms.get(term)?) {
                *grade = merged(output.merge, *grade, conjoined(implication, degree, *shape));
            }
        }
        let sum = sampled
            .at
            .iter()
            .zip(&set)
            .map(|(x, grade)| x * grade)
            .sum();
        quotient(sum, set.iter().sum())
    }
}

impl Evaluator for Exact<'_> {
    fn evaluate(&self, inputs: &[f64]) -> Evaluation {
        let grades = memberships(self.system, inputs);
        let degrees: Vec<f64> = rules(self.system)
            .map(|(block, rule)| rule.weight * degree(&rule.antecedent, block.and, &grades))
            .collect();
        let values = taken(self.system, inputs);
        let crisp = |(index, output): (usize, &Output)| {
            let value = match output.defuzzifier {
                Defuzzifier::WeightedAverage => self.weighted_average(index, &values, &degrees),
                Defuzzifier::Centroid { .. } => self.centroid(index, &degrees),
            };
            value.or(output.default).map(|value| {
                if output.clamp {
                    value.clamp(*output.range.start(), *output.range.end())
                } else {
                    value
                }
            })
        };
        Evaluation {
            outputs: self.system.outputs.iter().enumerate().map(crisp).collect(),
            rules: degrees,
        }
    }
}

/// How far an antecedent holds, given every term's degree.
fn degree(antecedent: &Antecedent, and: Conjunction, grades: &[Vec<f64>]) -> f64 {
    match antecedent {
        Antecedent::Is {
            input,
            term,
            negated,
        } => match grades.get(*input).and_then(|terms| terms.get(*term)) {
            Some(grade) if grade.is_nan() => 0.0,
            Some(grade) if *negated => 1.0 - grade,
            Some(grade) => *grade,
            None => 0.0,
        },
        Antecedent::And(parts) => parts
            .iter()
            .map(|part| degree(part, and, grades))
            .fold(1.0, |a, b| conjoined(and, a, b)),
        Antecedent::Or(parts) => parts
            .iter()
            .map(|part| degree(part, and, grades))
            .fold(0.0, f64::max),
    }
}

/// AND of two degrees.
pub fn conjoined(and: Conjunction, a: f64, b: f64) -> f64 {
    match and {
        Conjunction::Min => a.min(b),
        Conjunction::Product => a * b,
    }
}

/// Two degrees of the same conclusion in one.
pub fn merged(merge: Merge, a: f64, b: f64) -> f64 {
    match merge {
        Merge::Sum => a + b,
        Merge::Max => a.max(b),
    }
}

/// A conclusion as a number; a set, which only a centroid can tell, as NaN.
pub fn value(conclusion: &Conclusion, inputs: &[f64]) -> f64 {
    match conclusion {
        Conclusion::Constant(value) => *value,
        Conclusion::Linear {
            coefficients,
            constant,
        } => {
            let sum: f64 = coefficients.iter().zip(inputs).map(|(c, x)| c * x).sum();
            sum + constant
        }
        Conclusion::Set(_) => f64::NAN,
    }
}

fn quotient(sum: f64, weight: f64) -> Option<f64> {
    Some(sum / weight).filter(|_| weight > 0.0)
}
