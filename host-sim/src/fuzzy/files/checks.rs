//! What must hold of every system, whatever the format: sizes, unique names, ranges, weights, terms that fit how they are
//! defuzzified, no rule twice.

use super::cursor::Parameter;
use super::error::{ReadError, Source, counted, quoted};
use super::limits;
use crate::fuzzy::model::{
    Antecedent, Conclusion, Conjunction, Defuzzifier, Input, Output, Place, RuleBlock, Shape,
};
use std::collections::HashMap;
use std::fmt::Write;
use std::ops::RangeInclusive;

/// A rule's weight.
pub fn weight(source: Source<'_>, weight: Parameter) -> Result<f64, ReadError> {
    match (0.0..=1.0).contains(&weight.value) {
        true => Ok(weight.value),
        false => Err(source.error(
            weight.place,
            format!("the weight is {}", weight.value),
            "0 to 1",
        )),
    }
}

/// A variable's range.
pub fn range(
    source: Source<'_>,
    start: Parameter,
    end: Parameter,
) -> Result<RangeInclusive<f64>, ReadError> {
    for p in [start, end] {
        if !p.value.is_finite() {
            let found = format!("the range has an end at {}", p.value);
            return Err(source.error(p.place, found, "a finite number"));
        }
    }
    if start.value >= end.value {
        let found = format!("the range ends at {}", end.value);
        let allowed = format!("a number above its start, {}", start.value);
        return Err(source.error(end.place, found, allowed));
    }
    if !(end.value - start.value).is_finite() {
        return Err(source.error(end.place, "the range is wider than any number", ""));
    }
    Ok(start.value..=end.value)
}

/// That something is named once: `earlier` are the names before it, `what` is "the term", "the key" and so on.
pub fn unique<'n>(
    source: Source<'_>,
    what: &str,
    name: &str,
    place: Place,
    earlier: impl IntoIterator<Item = (&'n str, Place)>,
) -> Result<(), ReadError> {
    match earlier.into_iter().find(|&(e, _)| e == name) {
        None => Ok(()),
        Some((_, at)) => {
            let found = format!(
                "{what} {} is there already, in line {}",
                quoted(name),
                at.line
            );
            Err(source.error(place, found, "each once"))
        }
    }
}

/// That there are not too many of something.
pub fn count(
    source: Source<'_>,
    place: Place,
    what: &str,
    found: usize,
    most: usize,
) -> Result<(), ReadError> {
    match found <= most {
        true => Ok(()),
        false => Err(source.error(place, format!("too many {what}"), format!("at most {most}"))),
    }
}

/// That variables hold the model's promises; `end` is where a missing one is shown.
pub fn variables(
    source: Source<'_>,
    inputs: &[Input],
    outputs: &[Output],
    end: Place,
) -> Result<(), ReadError> {
    let missing = |what: &str, most: usize| {
        let found = format!("there is no {what}");
        Err(source.error(end, found, format!("1 to {most} {what}s")))
    };
    if inputs.is_empty() {
        return missing("input", limits::INPUTS);
    }
    if outputs.is_empty() {
        return missing("output", limits::OUTPUTS);
    }
    if let Some(input) = inputs.get(limits::INPUTS) {
        count(source, input.place, "inputs", inputs.len(), limits::INPUTS)?;
    }
    if let Some(output) = outputs.get(limits::OUTPUTS) {
        count(
            source,
            output.place,
            "outputs",
            outputs.len(),
            limits::OUTPUTS,
        )?;
    }
    for input in inputs {
        terms(source, "input", &input.name, input.place, input.terms.len())?;
    }
    for output in outputs {
        terms(
            source,
            "output",
            &output.name,
            output.place,
            output.terms.len(),
        )?;
        conclusions(source, output, inputs.len())?;
    }
    Ok(())
}

/// That rules hold the model's promises; `end` is where a missing one is shown.
pub fn rules(source: Source<'_>, blocks: &[RuleBlock], end: Place) -> Result<(), ReadError> {
    let rules: usize = blocks.iter().map(|b| b.rules.len()).sum();
    if rules == 0 {
        return Err(source.error(end, "there is no rule that counts", "one or more rules"));
    }
    count(source, end, "rules", rules, limits::RULES)?;
    duplicates(source, blocks)
}

fn terms(
    source: Source<'_>,
    what: &str,
    name: &str,
    place: Place,
    count: usize,
) -> Result<(), ReadError> {
    let found = match count {
        0 => format!("the {what} {} has no term", quoted(name)),
        c if c > limits::TERMS => format!("the {what} {} has {c} terms", quoted(name)),
        _ => return Ok(()),
    };
    Err(source.error(place, found, format!("1 to {} terms", limits::TERMS)))
}

/// That an output's terms are what its defuzzifier can work with.
fn conclusions(source: Source<'_>, output: &Output, inputs: usize) -> Result<(), ReadError> {
    for term in &output.terms {
        let name = quoted(&term.name);
        let of = quoted(&output.name);
        match (&term.conclusion, output.defuzzifier) {
            (Conclusion::Set(_), Defuzzifier::WeightedAverage) => {
                let found =
                    format!("the term {name} is a fuzzy set, but {of} takes a weighted average");
                let allowed = "a constant or a linear term; or a centroid for the output";
                return Err(source.error(term.place, found, allowed));
            }
            (Conclusion::Set(Shape::Singleton(_)), _) => {
                let found =
                    format!("the term {name} of {of} has no width: it has no part in a centroid");
                return Err(source.error(term.place, found, "a set that has one"));
            }
            (Conclusion::Constant(_) | Conclusion::Linear { .. }, Defuzzifier::Centroid { .. }) => {
                let found = format!("the term {name} is no fuzzy set, but {of} takes a centroid");
                let allowed = "a fuzzy set; or a weighted average for the output";
                return Err(source.error(term.place, found, allowed));
            }
            (Conclusion::Linear { coefficients, .. }, _) if coefficients.len() != inputs => {
                let found = format!(
                    "the linear term {name} has {}",
                    counted(coefficients.len() + 1, "number")
                );
                let allowed = format!("{}: one for each input, and the constant", inputs + 1);
                return Err(source.error(term.place, found, allowed));
            }
            _ => {}
        }
    }
    Ok(())
}

/// That no two rules say the same: same condition (in any order), same conclusion, same AND.
fn duplicates(source: Source<'_>, blocks: &[RuleBlock]) -> Result<(), ReadError> {
    let mut seen: HashMap<(String, usize, usize), Place> = HashMap::new();
    for block in blocks {
        for rule in &block.rules {
            let key = key(&rule.antecedent, block.and);
            for &(output, term) in &rule.conclusions {
                if let Some(earlier) = seen.insert((key.clone(), output, term), rule.place) {
                    let found = format!(
                        "this rule says again what the one in line {} says",
                        earlier.line
                    );
                    return Err(source.error(rule.place, found, "each rule once"));
                }
            }
        }
    }
    Ok(())
}

/// The same text for conditions that differ in their order only. The model bounds the recursion: a condition is nested no
/// deeper than [`limits::DEPTH`].
fn key(antecedent: &Antecedent, and: Conjunction) -> String {
    let (sign, all) = match antecedent {
        Antecedent::Is {
            input,
            term,
            negated,
        } => {
            return format!("{}{input}:{term}", if *negated { "-" } else { "" });
        }
        Antecedent::And(all) if and == Conjunction::Min => ("&", all),
        Antecedent::And(all) => ("*", all),
        Antecedent::Or(all) => ("|", all),
    };
    let mut parts: Vec<String> = all.iter().map(|a| key(a, and)).collect();
    parts.sort();
    let mut text = String::from("(");
    for part in parts {
        // Writing to a text cannot fail.
        let _ = write!(text, "{sign}{part}");
    }
    text.push(')');
    text
}

/// A centroid's number of samples.
pub fn samples(source: Source<'_>, number: Parameter) -> Result<usize, ReadError> {
    let most = limits::SAMPLES;
    match number.value {
        x if x.fract() == 0.0 && (2.0..=most as f64).contains(&x) => Ok(x as usize),
        x => Err(source.error(
            number.place,
            format!("found {x} samples"),
            format!("a whole number from 2 to {most}"),
        )),
    }
}
