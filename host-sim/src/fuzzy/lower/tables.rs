//! The owned tables of a lowered model, and the library's borrowed form of them.

use super::antecedent::conjunctions;
use super::pieces::{anchors, degree, pieces};
use super::set::set;
use super::{Format, LowerError};
use crate::fuzzy::evaluate::{concluded, samples};
use crate::fuzzy::model::{self, Conclusion, Conjunction, Place, Sampling};
use fuzzypilot::fuzzy::Grade;
use fuzzypilot::fuzzy::system::{
    self, Degree, Flaw, LIMIT, Linear, Literal, Merge, Norm, Piece, Samples,
};
use std::ops::RangeInclusive;

/// A system's tables, named as in the model.
#[derive(Clone, Debug)]
pub struct Tables {
    /// The system's name.
    pub name: String,
    /// The inputs.
    pub inputs: Vec<Input>,
    /// The rules.
    pub blocks: Vec<Block>,
    /// The outputs.
    pub outputs: Vec<Output>,
}

/// Combinations of terms times rules that a compiler may look through.
const MOST_TO_PROVE: usize = 20_000;

/// What is claimed to be complete; nothing by default.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Claims {
    /// Inputs: every value has a term.
    pub inputs: Vec<bool>,
    /// Outputs: every combination of terms has a rule.
    pub outputs: Vec<bool>,
}

/// An input.
#[derive(Clone, Debug)]
pub struct Input {
    /// Its name.
    pub name: String,
    /// Its numbers' format.
    pub format: Format,
    /// Its range, in steps.
    pub range: [i32; 2],
    /// Whether values are limited to it.
    pub clamp: bool,
    /// Its terms: name and pieces.
    pub terms: Vec<(String, Vec<Piece>)>,
}

/// Rules that share their operators.
#[derive(Clone, Debug)]
pub struct Block {
    /// Its name.
    pub name: String,
    /// AND.
    pub and: Norm,
    /// What a degree does to a set.
    pub implication: Norm,
    /// The rules.
    pub rules: Vec<Rule>,
}

/// A rule.
#[derive(Clone, Debug)]
pub struct Rule {
    /// OR of ANDs.
    pub when: Vec<Vec<Literal>>,
    /// Places of outputs and of their terms.
    pub then: Vec<(u8, u8)>,
    /// Its weight.
    pub weight: Degree,
}

/// An output.
#[derive(Clone, Debug)]
pub struct Output {
    /// Its name.
    pub name: String,
    /// Its numbers' format.
    pub format: Format,
    /// What its values are limited to, in steps: its range, or all numbers.
    pub range: [i32; 2],
    /// Whether they have to be. Where not, the library has proven that no conclusion lies beyond.
    pub clamp: bool,
    /// Its value where no rule fires.
    pub default: i32,
    /// How conclusions become a number, and its terms.
    pub defuzzifier: Defuzzifier,
}

/// How conclusions become a number, and the terms: name and what it concludes.
#[derive(Clone, Debug)]
pub enum Defuzzifier {
    /// The height method.
    WeightedAverage {
        /// Of rules that conclude the same.
        merge: Merge,
        /// The terms.
        terms: Vec<(String, Number)>,
    },
    /// The centroid.
    Centroid {
        /// At one place.
        merge: Merge,
        /// Where the sets are sampled.
        samples: Samples,
        /// The samples of the model's range: ends or middles.
        sampling: Sampling,
        /// The terms.
        terms: Vec<(String, Vec<Grade>)>,
    },
}

impl Defuzzifier {
    /// The names of its terms.
    pub fn names(&self) -> Vec<&str> {
        match self {
            Self::WeightedAverage { terms, .. } => {
                terms.iter().map(|(name, _)| &name[..]).collect()
            }
            Self::Centroid { terms, .. } => terms.iter().map(|(name, _)| &name[..]).collect(),
        }
    }
}

/// A number that rules conclude.
#[derive(Clone, Debug)]
pub enum Number {
    /// A singleton.
    Constant(i32),
    /// `constant + Σ coefficient · input / 2^shift`, in steps.
    Linear {
        /// One an input.
        coefficients: Vec<i32>,
        /// Of all coefficients.
        shift: u32,
        /// In steps of the output.
        constant: i32,
    },
}

impl Tables {
    /// From a model, with fewer fractional bits of each output than it could have.
    pub(super) fn of(model: &model::System, coarser: &[i32]) -> Result<Self, LowerError> {
        let inputs = model
            .inputs
            .iter()
            .map(input)
            .collect::<Result<Vec<_>, _>>()?;
        let outputs = model
            .outputs
            .iter()
            .enumerate()
            .map(|(index, this)| output(this, index, model, &inputs, coarser[index]))
            .collect::<Result<Vec<_>, _>>()?;
        let blocks = model.blocks.iter().map(block).collect::<Result<_, _>>()?;
        let mut tables = Self {
            name: model.name.clone(),
            inputs,
            blocks,
            outputs,
        };
        for (o, output) in model.outputs.iter().enumerate() {
            if !output.clamp {
                tables.keep_in_range(o, &output.range);
            }
        }
        Ok(tables)
    }

    /// Gives an output that is not limited its own range again, if the library proves that nothing leaves it.
    fn keep_in_range(&mut self, o: usize, range: &RangeInclusive<f64>) {
        let mut kept = self.outputs[o].clone();
        kept.range = in_steps(range, kept.format);
        kept.clamp = false;
        let free = std::mem::replace(&mut self.outputs[o], kept);
        if self.borrowed(|system| system.is_err()) {
            self.outputs[o] = free;
        }
    }

    /// What the library can prove of them: inputs without a gap, outputs with a rule for every combination of terms.
    pub fn claims(&self) -> Claims {
        let none = Claims {
            inputs: vec![false; self.inputs.len()],
            outputs: vec![false; self.outputs.len()],
        };
        let holds = |claims: &Claims| self.claiming(claims, |system| system.is_ok());
        let mut proven = none.clone();
        for (i, claim) in proven.inputs.iter_mut().enumerate() {
            let mut alone = none.clone();
            alone.inputs[i] = true;
            *claim = holds(&alone);
        }
        let combinations: usize = self.inputs.iter().map(|input| input.terms.len()).product();
        let rules: usize = self.blocks.iter().map(|block| block.rules.len()).sum();
        for (o, claim) in proven.outputs.iter_mut().enumerate() {
            let mut alone = none.clone();
            alone.outputs[o] = true;
            *claim = combinations.saturating_mul(rules) <= MOST_TO_PROVE && holds(&alone);
        }
        proven
    }

    /// Lends the library's form of them, or what the library finds wrong with them.
    pub(super) fn borrowed<R>(
        &self,
        use_it: impl FnOnce(Result<system::System<'_>, Flaw>) -> R,
    ) -> R {
        self.claiming(&Claims::default(), use_it)
    }

    fn claiming<R>(
        &self,
        claims: &Claims,
        use_it: impl FnOnce(Result<system::System<'_>, Flaw>) -> R,
    ) -> R {
        let claimed = |of: &[bool], i: usize| of.get(i).copied().unwrap_or(false);
        let terms: Vec<Vec<&[Piece]>> = self
            .inputs
            .iter()
            .map(|input| input.terms.iter().map(|(_, term)| &term[..]).collect())
            .collect();
        let inputs: Vec<system::Input<'_>> = self
            .inputs
            .iter()
            .zip(&terms)
            .enumerate()
            .map(|(i, (input, terms))| system::Input {
                range: input.range,
                clamp: input.clamp,
                complete: claimed(&claims.inputs, i),
                terms,
            })
            .collect();
        let whens: Vec<Vec<Vec<&[Literal]>>> = self
            .blocks
            .iter()
            .map(|block| {
                let rules = block.rules.iter();
                rules
                    .map(|rule| rule.when.iter().map(|all| &all[..]).collect())
                    .collect()
            })
            .collect();
        let rules: Vec<Vec<system::Rule<'_>>> = self
            .blocks
            .iter()
            .zip(&whens)
            .map(|(block, whens)| {
                block
                    .rules
                    .iter()
                    .zip(whens)
                    .map(|(rule, when)| system::Rule::new(when, &rule.then).weighted(rule.weight))
                    .collect()
            })
            .collect();
        let blocks: Vec<system::Block<'_>> = self
            .blocks
            .iter()
            .zip(&rules)
            .map(|(block, rules)| system::Block {
                and: block.and,
                implication: block.implication,
                rules,
            })
            .collect();
        let lists: Vec<Terms<'_>> = self.outputs.iter().map(Terms::of).collect();
        let outputs: Vec<system::Output<'_>> = self
            .outputs
            .iter()
            .zip(&lists)
            .enumerate()
            .map(|(o, (output, terms))| system::Output {
                range: output.range,
                clamp: output.clamp,
                default: output.default,
                complete: claimed(&claims.outputs, o),
                defuzzifier: terms.defuzzifier(&output.defuzzifier),
            })
            .collect();
        use_it(system::System::checked(&inputs, &blocks, &outputs))
    }
}

/// An output's terms as the library wants them.
enum Terms<'a> {
    Numbers(Vec<system::Number<'a>>),
    Sets(Vec<&'a [Grade]>),
}

impl<'a> Terms<'a> {
    fn of(output: &'a Output) -> Self {
        match &output.defuzzifier {
            Defuzzifier::WeightedAverage { terms, .. } => {
                let number = |number: &'a Number| match number {
                    Number::Constant(value) => system::Number::Constant(*value),
                    Number::Linear {
                        coefficients,
                        shift,
                        constant,
                    } => system::Number::Linear(Linear {
                        coefficients,
                        shift: *shift,
                        constant: *constant,
                    }),
                };
                Self::Numbers(terms.iter().map(|(_, term)| number(term)).collect())
            }
            Defuzzifier::Centroid { terms, .. } => {
                Self::Sets(terms.iter().map(|(_, term)| &term[..]).collect())
            }
        }
    }

    fn defuzzifier(&'a self, of: &Defuzzifier) -> system::Defuzzifier<'a> {
        match (self, of) {
            (Self::Sets(terms), Defuzzifier::Centroid { merge, samples, .. }) => {
                system::Defuzzifier::Centroid {
                    merge: *merge,
                    samples: *samples,
                    terms,
                }
            }
            (Self::Numbers(terms), Defuzzifier::WeightedAverage { merge, .. }) => {
                system::Defuzzifier::WeightedAverage {
                    merge: *merge,
                    terms,
                }
            }
            _ => unreachable!("the terms are made from the defuzzifier"),
        }
    }
}

fn input(input: &model::Input) -> Result<Input, LowerError> {
    let numbers = input.terms.iter().flat_map(|term| anchors(&term.shape));
    let format = format(&input.range, numbers)
        .ok_or_else(|| no_format(input.place, format!("the input `{}`", input.name)))?;
    Ok(Input {
        name: input.name.clone(),
        format,
        range: in_steps(&input.range, format),
        clamp: input.clamp,
        terms: input
            .terms
            .iter()
            .map(|term| (term.name.clone(), pieces(&term.shape, format)))
            .collect(),
    })
}

/// A format for a range and what else has to have a place in it.
fn format(range: &RangeInclusive<f64>, numbers: impl Iterator<Item = f64>) -> Option<Format> {
    let magnitude = numbers
        .chain([*range.start(), *range.end()])
        .fold(0.0, |most: f64, number| most.max(number.abs()));
    Format::of(range.end() - range.start(), magnitude)
}

fn no_format(place: Place, what: String) -> LowerError {
    LowerError::DoesNotFit {
        place,
        what,
        limit: "its largest number is more than two million times as large as its range is wide"
            .into(),
    }
}

fn in_steps(range: &RangeInclusive<f64>, format: Format) -> [i32; 2] {
    [format.nearest(*range.start()), format.nearest(*range.end())]
}

fn norm(conjunction: Conjunction) -> Norm {
    match conjunction {
        Conjunction::Min => Norm::Min,
        Conjunction::Product => Norm::Product,
    }
}

fn merge(merge: model::Merge) -> Merge {
    match merge {
        model::Merge::Sum => Merge::Sum,
        model::Merge::Max => Merge::Max,
    }
}

fn block(block: &model::RuleBlock) -> Result<Block, LowerError> {
    Ok(Block {
        name: block.name.clone(),
        and: norm(block.and),
        implication: norm(block.implication),
        rules: block.rules.iter().map(rule).collect::<Result<_, _>>()?,
    })
}

fn rule(rule: &model::Rule) -> Result<Rule, LowerError> {
    let then = rule.conclusions.iter().map(|&(output, term)| {
        let places = (u8::try_from(output), u8::try_from(term));
        let (Ok(output), Ok(term)) = places else {
            return Err(LowerError::TooMany {
                place: rule.place,
                what: format!(
                    "the rule concludes term {} of output {}",
                    term + 1,
                    output + 1
                ),
                limit: "255 outputs with 255 terms are possible".into(),
            });
        };
        Ok((output, term))
    });
    Ok(Rule {
        when: conjunctions(&rule.antecedent, rule.place)?,
        then: then.collect::<Result<_, _>>()?,
        weight: degree(rule.weight),
    })
}

fn output(
    output: &model::Output,
    index: usize,
    model: &model::System,
    inputs: &[Input],
    coarser: i32,
) -> Result<Output, LowerError> {
    let reach = reach(output, model);
    let mut format = format(&output.range, [*reach.start(), *reach.end()].into_iter())
        .ok_or_else(|| no_format(output.place, format!("the output `{}`", output.name)))?;
    format.fraction -= coarser;
    let middle = output.range.start() + (output.range.end() - output.range.start()) / 2.0;
    let default = output.default.unwrap_or(middle);
    let range = if output.clamp {
        in_steps(&output.range, format)
    } else {
        [-LIMIT, LIMIT]
    };
    let defuzzifier = defuzzifier(output, format, inputs)?;
    if let Defuzzifier::Centroid { samples, terms, .. } = &defuzzifier {
        let is_empty = |set: &[Grade]| set.iter().all(|grade| grade.bits() == 0);
        let empty = (0..terms.len())
            .find(|&term| is_empty(&terms[term].1) && concluded(model, index, Some(term)));
        if let Some(term) = empty {
            return Err(LowerError::EmptySet {
                place: output.terms[term].place,
                output: output.name.clone(),
                term: output.terms[term].name.clone(),
                samples: samples.count(),
            });
        }
    }
    Ok(Output {
        name: output.name.clone(),
        format,
        range,
        clamp: true,
        default: format.nearest(default).clamp(range[0], range[1]),
        defuzzifier,
    })
}

/// The least and the greatest number that an output can conclude, for inputs in their ranges; its default too.
fn reach(output: &model::Output, model: &model::System) -> RangeInclusive<f64> {
    let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
    let mut add = |low: f64, high: f64| {
        least = least.min(low);
        most = most.max(high);
    };
    add(*output.range.start(), *output.range.end());
    if let Some(default) = output.default {
        add(default, default);
    }
    for term in &output.terms {
        match &term.conclusion {
            Conclusion::Constant(value) => add(*value, *value),
            Conclusion::Linear {
                coefficients,
                constant,
            } => {
                let (mut low, mut high) = (*constant, *constant);
                for (coefficient, input) in coefficients.iter().zip(&model.inputs) {
                    let ends = [input.range.start(), input.range.end()].map(|x| x * coefficient);
                    low += ends[0].min(ends[1]);
                    high += ends[0].max(ends[1]);
                }
                add(low, high);
            }
            Conclusion::Set(_) => {}
        }
    }
    least..=most
}

fn defuzzifier(
    output: &model::Output,
    format: Format,
    inputs: &[Input],
) -> Result<Defuzzifier, LowerError> {
    let merge = merge(output.merge);
    let (points, sampling) = match output.defuzzifier {
        model::Defuzzifier::WeightedAverage => {
            let terms = output
                .terms
                .iter()
                .map(|term| Ok((term.name.clone(), number(term, format, inputs)?)));
            return Ok(Defuzzifier::WeightedAverage {
                merge,
                terms: terms.collect::<Result<_, _>>()?,
            });
        }
        model::Defuzzifier::Centroid { points, sampling } => (points, sampling),
    };
    if !(2..=Samples::MOST).contains(&points) {
        return Err(LowerError::TooMany {
            place: output.place,
            what: format!("the output `{}` is sampled at {points} points", output.name),
            limit: format!("2 to {} are possible", Samples::MOST),
        });
    }
    let range = in_steps(&output.range, format);
    let at = samples(output);
    let terms = output.terms.iter().map(|term| match &term.conclusion {
        Conclusion::Set(shape) => Ok((term.name.clone(), set(shape, &at))),
        _ => Err(not_a(term, "set", "centroid")),
    });
    Ok(Defuzzifier::Centroid {
        merge,
        samples: match sampling {
            Sampling::Middles => Samples::middles(range, points),
            Sampling::Ends => Samples::ends(range, points),
        },
        sampling,
        terms: terms.collect::<Result<_, _>>()?,
    })
}

fn not_a(term: &model::OutputTerm, wanted: &str, of: &str) -> LowerError {
    LowerError::DoesNotFit {
        place: term.place,
        what: format!("the term `{}`", term.name),
        limit: format!("a {of} takes {wanted}s"),
    }
}

fn number(
    term: &model::OutputTerm,
    format: Format,
    inputs: &[Input],
) -> Result<Number, LowerError> {
    let (coefficients, constant) = match &term.conclusion {
        Conclusion::Constant(value) => return Ok(Number::Constant(format.nearest(*value))),
        Conclusion::Linear {
            coefficients,
            constant,
        } => (coefficients, *constant),
        Conclusion::Set(_) => return Err(not_a(term, "number", "weighted average")),
    };
    // Steps of the output for a step of each input.
    let scaled: Vec<f64> = inputs
        .iter()
        .enumerate()
        .map(|(i, input)| {
            let coefficient = coefficients.get(i).copied().unwrap_or(0.0);
            coefficient * f64::from(format.fraction - input.format.fraction).exp2()
        })
        .collect();
    let most = scaled.iter().fold(0.0, |most: f64, c| most.max(c.abs()));
    const ROOM: f64 = 1_073_741_824.0;
    let mut shift = 60;
    while shift > 0 && most * f64::from(shift).exp2() > ROOM {
        shift -= 1;
    }
    if most * f64::from(shift).exp2() > ROOM {
        return Err(LowerError::DoesNotFit {
            place: term.place,
            what: format!("a coefficient of the term `{}`", term.name),
            limit: "it may multiply a step of its input by 2^30 steps of the output at most".into(),
        });
    }
    Ok(Number::Linear {
        coefficients: scaled
            .iter()
            .map(|c| (c * f64::from(shift).exp2()).round() as i32)
            .collect(),
        shift: shift as u32,
        constant: format.nearest(constant),
    })
}
