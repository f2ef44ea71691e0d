//! A system's variables as figures want them.

use super::describe;
use super::model::{Conclusion, Input, Output, Shape, System};
use crate::plot::{Axis, Form, TermCurve, Variable};
use std::ops::RangeInclusive;

/// Points of a curved membership function.
const CURVE: usize = 240;

/// An input as an axis, its terms at the middle of where they are highest.
pub fn input_axis(input: &Input) -> Axis {
    let terms = input.terms.iter();
    let marks = terms.filter_map(|term| {
        let middle = middle(&term.shape, &input.range)?;
        Some((term.name.clone(), middle))
    });
    axis(&input.name, &input.range, marks.collect())
}

/// An output as an axis, marked with the numbers that its terms conclude.
pub fn output_axis(output: &Output) -> Axis {
    let marks = output
        .terms
        .iter()
        .filter_map(|term| match &term.conclusion {
            Conclusion::Constant(value) => Some((term.name.clone(), *value)),
            Conclusion::Set(shape) => Some((term.name.clone(), middle(shape, &output.range)?)),
            Conclusion::Linear { .. } => None,
        });
    axis(&output.name, &output.range, marks.collect())
}

fn axis(name: &str, range: &RangeInclusive<f64>, mut terms: Vec<(String, f64)>) -> Axis {
    terms.sort_by(|a, b| a.1.total_cmp(&b.1));
    Axis {
        name: name.to_owned(),
        unit: String::new(),
        terms,
        range: (*range.start(), *range.end()),
    }
}

/// The middle of where a shape is highest in a range; `None` if it does not reach it.
pub fn middle(shape: &Shape, range: &RangeInclusive<f64>) -> Option<f64> {
    let mut places = shape.knots();
    places.retain(|x| range.contains(x));
    places.extend([*range.start(), *range.end()]);
    let highest = places.iter().map(|&x| shape.degree(x)).fold(0.0, f64::max);
    places.retain(|&x| shape.degree(x) >= highest - 1e-9);
    let least = places.iter().copied().fold(f64::INFINITY, f64::min);
    let most = places.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    (highest > 0.0).then_some(least + (most - least) / 2.0)
}

/// Every variable with its terms: inputs, then outputs.
pub fn variables(system: &System) -> Vec<Variable> {
    let inputs = system.inputs.iter().map(|input| Variable {
        axis: input_axis(input),
        kind: "membership".to_owned(),
        terms: (input.terms.iter())
            .map(|term| TermCurve {
                name: term.name.clone(),
                form: form(&term.shape, &input.range),
            })
            .collect(),
    });
    let outputs = system.outputs.iter().map(|output| Variable {
        axis: output_axis(output),
        kind: kind(output).to_owned(),
        terms: (output.terms.iter())
            .map(|term| TermCurve {
                name: term.name.clone(),
                form: match &term.conclusion {
                    Conclusion::Constant(value) => Form::Stem(*value),
                    Conclusion::Set(shape) => form(shape, &output.range),
                    Conclusion::Linear {
                        coefficients,
                        constant,
                    } => Form::Text(formula(system, output, coefficients, *constant)),
                },
            })
            .collect(),
    });
    inputs.chain(outputs).collect()
}

fn kind(output: &Output) -> &'static str {
    let terms = || output.terms.iter().map(|term| &term.conclusion);
    if terms().all(|c| matches!(c, Conclusion::Set(_))) {
        "membership"
    } else if terms().any(|c| matches!(c, Conclusion::Linear { .. })) {
        "conclusions"
    } else {
        "singletons"
    }
}

/// `0.5·error − 2·rate + 1`, every number so that it tells a ten thousandth of the output's range.
fn formula(system: &System, output: &Output, coefficients: &[f64], constant: f64) -> String {
    let span = |range: &RangeInclusive<f64>| range.end() - range.start();
    let resolution = 1e-4 * span(&output.range);
    let mut parts: Vec<(f64, String)> = coefficients
        .iter()
        .zip(&system.inputs)
        .filter(|(c, _)| **c != 0.0)
        .map(|(&c, input)| {
            let factor = describe::number_to(c.abs(), resolution / span(&input.range));
            (c, format!("{factor}·{}", input.name))
        })
        .collect();
    if constant != 0.0 || parts.is_empty() {
        parts.push((constant, describe::number_to(constant.abs(), resolution)));
    }
    let mut text = String::new();
    for (index, (sign, part)) in parts.iter().enumerate() {
        text += match (index, *sign < 0.0) {
            (0, false) => "",
            (0, true) => "−",
            (_, false) => " + ",
            (_, true) => " − ",
        };
        text += part;
    }
    text
}

fn form(shape: &Shape, range: &RangeInclusive<f64>) -> Form {
    if let Shape::Singleton(at) = shape {
        return Form::Stem(*at);
    }
    let (start, end) = (*range.start(), *range.end());
    let fine = (end - start) * 1e-9;
    let mut at: Vec<f64> = (0..=CURVE)
        .map(|i| start + (end - start) * (i as f64 / CURVE as f64))
        .collect();
    // Both sides of a knot: it may be a step.
    at.extend(
        shape
            .knots()
            .into_iter()
            .flat_map(|x| [x - fine, x, x + fine]),
    );
    at.retain(|x| range.contains(x));
    at.sort_by(f64::total_cmp);
    Form::Line(at.into_iter().map(|x| (x, shape.degree(x))).collect())
}

/// What a surface's note says of the inputs that it is not drawn over.
pub fn held(system: &System, values: &[f64], axes: &[usize]) -> String {
    let others: Vec<String> = (system.inputs.iter().zip(values).enumerate())
        .filter(|(index, _)| !axes.contains(index))
        .map(|(_, (input, &x))| format!("{} = {}", input.name, describe::exact(x)))
        .collect();
    if others.is_empty() {
        String::new()
    } else {
        // As the axes have their minus.
        format!("held: {}", others.join(", ").replace("= -", "= −"))
    }
}

/// A name as part of a file's: letters, digits and underscores stay.
pub fn file_name(name: &str) -> String {
    let kept: String = name
        .chars()
        .map(|c| {
            if c.is_alphanumeric() || c == '_' {
                c
            } else {
                '-'
            }
        })
        .take(80)
        .collect();
    if kept.is_empty() {
        "system".to_owned()
    } else {
        kept
    }
}
