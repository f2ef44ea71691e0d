//! From an FCL file's blocks to a system: what is not said follows from what is.

use super::{Fuzzified, Range, Reader, WrittenBlock};
use crate::fuzzy::files::checks;
use crate::fuzzy::files::conditions::Names;
use crate::fuzzy::files::error::{ReadError, Source, quoted};
use crate::fuzzy::files::lexer::Token;
use crate::fuzzy::files::norms::{Norm, Used};
use crate::fuzzy::files::shapes::extent;
use crate::fuzzy::model::{
    Conclusion, Conjunction, Defuzzifier, Input, Merge, Output, OutputTerm, Place, RuleBlock,
    System, Term,
};
use std::ops::RangeInclusive;

impl Reader<'_, '_> {
    /// Puts together what was read.
    pub(super) fn system(self, end: Place) -> Result<System, ReadError> {
        let source = self.source;
        let (mut inputs, mut outputs) = (Vec::new(), Vec::new());
        let mut merges = Vec::new();
        let mut defuzzified = self.defuzzified;
        let mut fuzzified = self.fuzzified;
        for declared in self.declared {
            let name = declared.name;
            let part = if declared.output {
                "DEFUZZIFY"
            } else {
                "FUZZIFY"
            };
            let missing = || {
                let found = format!("{} has no {part} block", quoted(name.text));
                source.error(
                    name.place,
                    found,
                    format!("`{part} {}` … `END_{part}`", name.text),
                )
            };
            if declared.output {
                let at = defuzzified
                    .iter()
                    .position(|d| d.variable.name.text == name.text);
                let block = defuzzified.swap_remove(at.ok_or_else(missing)?);
                let Some(defuzzifier) = block.method else {
                    let found = format!("the output {} has no method", quoted(name.text));
                    return Err(source.error(
                        block.variable.name.place,
                        found,
                        "`METHOD : COG;` or `METHOD : COGS;`",
                    ));
                };
                let range = block.variable.range(source, declared.range)?;
                merges.push(block.merge);
                outputs.push(Output {
                    name: name.text.to_owned(),
                    description: String::new(),
                    range,
                    clamp: block.variable.clamp,
                    default: block.default,
                    defuzzifier,
                    merge: block.merge.unwrap_or(Merge::Max),
                    terms: block.variable.output_terms(),
                    place: name.place,
                });
            } else {
                let at = fuzzified.iter().position(|f| f.name.text == name.text);
                let block = fuzzified.swap_remove(at.ok_or_else(missing)?);
                inputs.push(Input {
                    name: name.text.to_owned(),
                    description: String::new(),
                    range: block.range(source, declared.range)?,
                    clamp: block.clamp,
                    terms: block.input_terms(),
                    place: name.place,
                });
            }
        }
        checks::variables(source, &inputs, &outputs, end)?;
        let mut blocks = Vec::new();
        for block in self.blocks.iter().filter(|b| b.enabled) {
            let rules = block.resolve(source, &inputs, &outputs)?;
            if let Some((merge, place)) = block.merge {
                accumulate(source, &rules, &outputs, &mut merges, merge, place)?;
            }
            blocks.push(rules);
        }
        for (i, output) in outputs.iter_mut().enumerate() {
            output.merge = match (merges[i], output.defuzzifier) {
                (Some(merge), _) => merge,
                (None, Defuzzifier::Centroid { .. }) => Merge::Max,
                (None, Defuzzifier::WeightedAverage) => {
                    twice(source, i, output, &blocks)?;
                    Merge::Sum
                }
            };
        }
        checks::rules(source, &blocks, end)?;
        Ok(System {
            name: self.name,
            description: String::new(),
            inputs,
            outputs,
            blocks,
        })
    }
}

/// A rule block's ACCU is that of the outputs which it concludes and which have none of their own.
fn accumulate(
    source: Source<'_>,
    block: &RuleBlock,
    outputs: &[Output],
    merges: &mut [Option<Merge>],
    merge: Merge,
    place: Place,
) -> Result<(), ReadError> {
    for &(output, _) in block.rules.iter().flat_map(|r| &r.conclusions) {
        match merges[output] {
            Some(other) if other != merge => {
                let name = quoted(&outputs[output].name);
                let found = format!("the output {name} has another ACCU already");
                return Err(source.error(place, found, "the same one"));
            }
            _ => merges[output] = Some(merge),
        }
    }
    Ok(())
}

/// Without an ACCU a weighted average is clear only as long as no term is concluded twice.
fn twice(
    source: Source<'_>,
    index: usize,
    output: &Output,
    blocks: &[RuleBlock],
) -> Result<(), ReadError> {
    let mut concluded = vec![None; output.terms.len()];
    for rule in blocks.iter().flat_map(|b| &b.rules) {
        for &(_, term) in rule.conclusions.iter().filter(|c| c.0 == index) {
            if concluded[term].replace(rule.place).is_some() {
                let found = format!(
                    "another rule concludes {} of {} already, and there is no ACCU to say what becomes of both",
                    quoted(&output.terms[term].name),
                    quoted(&output.name)
                );
                let allowed = "`ACCU : MAX;` or `ACCU : SUM;` in the rule block";
                return Err(source.error(rule.place, found, allowed));
            }
        }
    }
    Ok(())
}

impl<'s> Fuzzified<'s> {
    pub(super) fn new(name: Token<'s>) -> Self {
        Self {
            name,
            range: None,
            clamp: false,
            terms: Vec::new(),
        }
    }

    /// The range that is given here or where the variable is declared, else that of the terms.
    fn range(&self, source: Source<'_>, declared: Range) -> Result<RangeInclusive<f64>, ReadError> {
        if let Some(range) = self.range.clone().or(declared) {
            return Ok(range);
        }
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        const ALLOWED: &str = "`RANGE := (start .. end);`";
        for (name, conclusion) in &self.terms {
            let extent = match conclusion {
                Conclusion::Set(shape) => extent(shape),
                Conclusion::Constant(x) => Some((*x, *x)),
                Conclusion::Linear { .. } => None,
            };
            let Some((a, b)) = extent else {
                let found = format!(
                    "{} has no range, and its term {} has no end",
                    quoted(self.name.text),
                    quoted(name.text)
                );
                return Err(source.error(self.name.place, found, ALLOWED));
            };
            (least, most) = (least.min(a), most.max(b));
        }
        match least < most && (most - least).is_finite() {
            true => Ok(least..=most),
            false => {
                let found = format!(
                    "{} has no range, and its terms span none",
                    quoted(self.name.text)
                );
                Err(source.error(self.name.place, found, ALLOWED))
            }
        }
    }

    fn input_terms(self) -> Vec<Term> {
        let terms = self
            .terms
            .into_iter()
            .filter_map(|(name, conclusion)| match conclusion {
                Conclusion::Set(shape) => Some(Term {
                    name: name.text.to_owned(),
                    shape,
                    place: name.place,
                }),
                _ => None,
            });
        terms.collect()
    }

    fn output_terms(self) -> Vec<OutputTerm> {
        let terms = self.terms.into_iter().map(|(name, conclusion)| OutputTerm {
            name: name.text.to_owned(),
            conclusion,
            place: name.place,
        });
        terms.collect()
    }
}

impl WrittenBlock<'_> {
    fn resolve(
        &self,
        source: Source<'_>,
        inputs: &[Input],
        outputs: &[Output],
    ) -> Result<RuleBlock, ReadError> {
        let used = Used::by(&self.rules);
        // What is not said follows from the other one.
        let and = match (self.and, self.or) {
            (Norm::None, Norm::None | Norm::Known(())) => Norm::Known(Conjunction::Min),
            (and, _) => and,
        };
        let or = match (and, self.or) {
            (Norm::Known(Conjunction::Min), Norm::None) => Norm::Known(()),
            (_, or) => or,
        };
        let and = and.used(source, "AND", used.and, "`AND : MIN;` or `AND : PROD;`")?;
        or.used(source, "OR", used.or, "`OR : MAX;`")?;
        let and = and.unwrap_or(Conjunction::Min);
        let names = Names { inputs, outputs };
        let rules = self
            .rules
            .iter()
            .map(|rule| rule.resolve(source, names, and));
        Ok(RuleBlock {
            name: self.name.to_owned(),
            description: String::new(),
            and,
            implication: self.implication,
            rules: rules.collect::<Result<_, _>>()?,
        })
    }
}
