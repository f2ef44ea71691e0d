//! What must hold of every system, whatever the format: sizes, unique names, ranges, weights, terms that fit how they are
//! defuzzified, no rule twice.

use super::cursor::Parameter;
use super::error::{ReadError, Source, quoted};
use super::limits;
use crate::fuzzy::model::{
    Antecedent, Conclusion, Conjunction, Defuzzifier, Output, Place, RuleBlock, System,
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

/// That a name is new: `earlier` are the ones before it.
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
            Err(source.error(place, found, "a name of its own"))
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

/// A system that holds every promise of the model; `end` is where errors about something missing are shown.
pub fn finish(source: Source<'_>, system: System, end: Place) -> Result<System, ReadError> {
    let missing =
        |what: &str, allowed: &str| Err(source.error(end, format!("there is no {what}"), allowed));
    match system.inputs.get(limits::INPUTS) {
        _ if system.inputs.is_empty() => {
            return missing("input", &format!("1 to {} inputs", limits::INPUTS));
        }
        Some(input) => count(
            source,
            input.place,
            "inputs",
            system.inputs.len(),
            limits::INPUTS,
        )?,
        None => {}
    }
    match system.outputs.get(limits::OUTPUTS) {
        _ if system.outputs.is_empty() => {
            return missing("output", &format!("1 to {} outputs", limits::OUTPUTS));
        }
        Some(output) => count(
            source,
            output.place,
            "outputs",
            system.outputs.len(),
            limits::OUTPUTS,
        )?,
        None => {}
    }
    for input in &system.inputs {
        terms(source, "input", &input.name, input.place, input.terms.len())?;
    }
    for output in &system.outputs {
        terms(
            source,
            "output",
            &output.name,
            output.place,
            output.terms.len(),
        )?;
        conclusions(source, output, system.inputs.len())?;
    }
    if system.blocks.iter().all(|b| b.rules.is_empty()) {
        return missing("rule that counts", "one or more rules");
    }
    let rules: usize = system.blocks.iter().map(|b| b.rules.len()).sum();
    count(source, end, "rules", rules, limits::RULES)?;
    duplicates(source, &system.blocks)?;
    Ok(system)
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
            (Conclusion::Constant(_) | Conclusion::Linear { .. }, Defuzzifier::Centroid { .. }) => {
                let found = format!("the term {name} is no fuzzy set, but {of} takes a centroid");
                let allowed = "a fuzzy set; or a weighted average for the output";
                return Err(source.error(term.place, found, allowed));
            }
            (Conclusion::Linear { coefficients, .. }, _) if coefficients.len() != inputs => {
                let found = format!(
                    "the linear term {name} has {} numbers",
                    coefficients.len() + 1
                );
                let allowed = format!(
                    "{}: one for each of the {inputs} inputs, and the constant",
                    inputs + 1
                );
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
