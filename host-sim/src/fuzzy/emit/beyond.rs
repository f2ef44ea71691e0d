//! What can take an output beyond its range, in words: for the head of what is made.

use super::Design;
use super::words::plain;
use crate::fuzzy::describe::number;
use crate::fuzzy::model::{Conclusion, Input};

/// The terms of an output that lie beyond its range, and its default if that does; `None` if no value can be beyond: it is
/// limited, or the library proves it.
pub fn beyond(design: &Design<'_>, output: usize) -> Option<String> {
    let (model, table) = (
        design.system.outputs.get(output)?,
        design.lowered.tables().outputs.get(output)?,
    );
    if model.clamp || !table.clamp {
        return None;
    }
    let terms = model.terms.iter().filter_map(|term| {
        let values = values(&term.conclusion, &design.system.inputs)?;
        let inside = values.iter().all(|value| model.range.contains(value));
        let said = match values {
            [low, high] if low == high => number(low),
            [low, high] if low.is_finite() && high.is_finite() => {
                format!("{} to {}", number(low), number(high))
            }
            _ => "as far as the inputs go".to_owned(),
        };
        (!inside).then(|| format!("`{}` ({said})", plain(&term.name)))
    });
    let default = model.default.filter(|value| !model.range.contains(value));
    let default = default.map(|value| format!("the default ({})", number(value)));
    let all: Vec<String> = terms.chain(default).collect();
    Some(match all.as_slice() {
        [] => "a step of rounding".to_owned(),
        all => all.join(", "),
    })
}

/// The least and the greatest value of a number, for all that the inputs take.
fn values(conclusion: &Conclusion, inputs: &[Input]) -> Option<[f64; 2]> {
    match conclusion {
        Conclusion::Constant(value) => Some([*value; 2]),
        Conclusion::Linear {
            coefficients,
            constant,
        } => {
            let mut values = [*constant; 2];
            let all = coefficients.iter().zip(inputs).filter(|(c, _)| **c != 0.0);
            for (coefficient, input) in all {
                let ends = match input.clamp {
                    true => [*input.range.start(), *input.range.end()],
                    false => [f64::NEG_INFINITY, f64::INFINITY],
                };
                let ends = ends.map(|end| end * coefficient);
                values[0] += ends[0].min(ends[1]);
                values[1] += ends[0].max(ends[1]);
            }
            Some(values)
        }
        Conclusion::Set(_) => None,
    }
}
