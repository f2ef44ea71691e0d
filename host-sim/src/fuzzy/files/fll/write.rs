//! A system as FLL, every property said.

use super::RESERVED_NAMES;
use crate::fuzzy::files::writing::{
    RuleStyle, WriteError, check, number, numbers, refuse_adaptable, rule,
};
use crate::fuzzy::model::{
    Conclusion, Conjunction, Defuzzifier, Merge, Output, Place, Sampling, Shape, System,
};
use std::fmt::Write;
use std::ops::RangeInclusive;

const STYLE: RuleStyle = RuleStyle {
    conclusions: " and ",
    mark_and: false,
};

/// Writes a system, which keeps the model's promises.
pub fn write(system: &System) -> Result<String, WriteError> {
    check(system, "FLL", RESERVED_NAMES)?;
    let mut text = String::new();
    line(&mut text, "", "Engine", &free(&system.name, "engine")?);
    description(&mut text, &system.description);
    for input in &system.inputs {
        line(&mut text, "", "InputVariable", &input.name);
        description(&mut text, &input.description);
        variable(&mut text, &input.range, input.clamp);
        for term in &input.terms {
            shape(&mut text, &term.name, &term.shape);
        }
    }
    for output in &system.outputs {
        line(&mut text, "", "OutputVariable", &output.name);
        description(&mut text, &output.description);
        variable(&mut text, &output.range, output.clamp);
        line(
            &mut text,
            "  ",
            "aggregation",
            match output.merge {
                Merge::Max => "Maximum",
                Merge::Sum => "UnboundedSum",
            },
        );
        line(&mut text, "  ", "defuzzifier", &defuzzifier(output)?);
        line(
            &mut text,
            "  ",
            "default",
            &number(output.default.unwrap_or(f64::NAN)),
        );
        line(&mut text, "  ", "lock-previous", "false");
        for term in &output.terms {
            match &term.conclusion {
                Conclusion::Set(set) => shape(&mut text, &term.name, set),
                Conclusion::Constant(value) => {
                    line(
                        &mut text,
                        "  ",
                        "term",
                        &format!("{} Constant {}", term.name, number(*value)),
                    );
                }
                Conclusion::Linear {
                    coefficients,
                    constant,
                } => {
                    let mut all = coefficients.clone();
                    all.push(*constant);
                    line(
                        &mut text,
                        "  ",
                        "term",
                        &format!("{} Linear {}", term.name, numbers(&all)),
                    );
                }
            }
        }
    }
    for block in &system.blocks {
        line(
            &mut text,
            "",
            "RuleBlock",
            &free(&block.name, "rule block")?,
        );
        description(&mut text, &block.description);
        line(&mut text, "  ", "enabled", "true");
        line(&mut text, "  ", "conjunction", conjunction(block.and));
        line(&mut text, "  ", "disjunction", "Maximum");
        line(
            &mut text,
            "  ",
            "implication",
            conjunction(block.implication),
        );
        line(&mut text, "  ", "activation", "General");
        for one in &block.rules {
            line(&mut text, "  ", "rule", &rule(system, one, STYLE)?);
        }
    }
    Ok(text)
}

fn line(text: &mut String, indent: &str, key: &str, value: &str) {
    let blank = if value.is_empty() { "" } else { " " };
    // Writing to a text cannot fail.
    let _ = writeln!(text, "{indent}{key}:{blank}{value}");
}

/// A description, if there is one, as a line can hold it.
fn description(text: &mut String, description: &str) {
    let plain = description.replace(|c: char| c == '#' || (c.is_control() && c != '\t'), " ");
    if !plain.trim().is_empty() {
        line(text, "  ", "description", plain.trim());
    }
}

fn variable(text: &mut String, range: &RangeInclusive<f64>, clamp: bool) {
    line(text, "  ", "enabled", "true");
    line(
        text,
        "  ",
        "range",
        &numbers(&[*range.start(), *range.end()]),
    );
    line(
        text,
        "  ",
        "lock-range",
        if clamp { "true" } else { "false" },
    );
}

fn shape(text: &mut String, name: &str, shape: &Shape) {
    let (family, all) = written(shape);
    line(
        text,
        "  ",
        "term",
        &format!("{name} {family} {}", numbers(&all)),
    );
}

fn defuzzifier(output: &Output) -> Result<String, WriteError> {
    match output.defuzzifier {
        Defuzzifier::WeightedAverage => Ok("WeightedAverage TakagiSugeno".to_owned()),
        // The number is said even where it is the default, for tools have different ones.
        Defuzzifier::Centroid {
            points,
            sampling: Sampling::Middles,
        } => Ok(format!("Centroid {points}")),
        Defuzzifier::Centroid {
            sampling: Sampling::Ends,
            ..
        } => refuse_adaptable(
            output.place,
            format!(
                "FLL cannot say that the centroid of `{}` is sampled from end to end",
                output.name
            ),
            "samples in the middles of equal pieces",
        ),
    }
}

fn conjunction(conjunction: Conjunction) -> &'static str {
    match conjunction {
        Conjunction::Min => "Minimum",
        Conjunction::Product => "AlgebraicProduct",
    }
}

/// A name that may be any text of one line.
fn free(name: &str, what: &str) -> Result<String, WriteError> {
    if name.contains(|c: char| c == '#' || c.is_control()) || name.trim() != name {
        return refuse_adaptable(
            Place::default(),
            format!("FLL has no such name: the {what} `{}`", name.escape_debug()),
            "one line without `#`, and without blanks around it",
        );
    }
    Ok(name.to_owned())
}

/// FLL's name of a shape and its numbers.
fn written(shape: &Shape) -> (&'static str, Vec<f64>) {
    match *shape {
        Shape::Triangle { left, peak, right } => ("Triangle", vec![left, peak, right]),
        Shape::Trapezoid {
            left,
            rise,
            fall,
            right,
        } => ("Trapezoid", vec![left, rise, fall, right]),
        Shape::Ramp { from, to } => ("Ramp", vec![from, to]),
        Shape::Singleton(x) => ("Rectangle", vec![x, x]),
        Shape::Points(ref points) => (
            "Discrete",
            points.iter().flat_map(|&(x, y)| [x, y]).collect(),
        ),
        Shape::Gaussian { mean, deviation } => ("Gaussian", vec![mean, deviation]),
        Shape::TwoSidedGaussian { left, right } => {
            ("GaussianProduct", vec![left.0, left.1, right.0, right.1])
        }
        Shape::Bell {
            centre,
            width,
            slope,
        } => ("Bell", vec![centre, width, slope]),
        Shape::Sigmoid { inflection, slope } => ("Sigmoid", vec![inflection, slope]),
        Shape::Spline { from, to } if from < to => ("SShape", vec![from, to]),
        Shape::Spline { from, to } => ("ZShape", vec![to, from]),
    }
}
