//! Conclusions beyond their output's range.

use super::coverage::Axis;
use crate::fuzzy::evaluate::rules;
use crate::fuzzy::model::{Antecedent, Conclusion, System};
use std::collections::BTreeMap;
use std::ops::Range;

/// A term that can conclude what lies beyond the output's range.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beyond {
    /// Index of the output.
    pub output: usize,
    /// Index of its term.
    pub term: usize,
    /// The least and the greatest that it concludes, for inputs in their ranges.
    pub least: f64,
    /// See `least`.
    pub most: f64,
}

/// Numbers that rules conclude beyond the range, whether the output is limited to it or not. A linear term is looked at
/// where its rules can fire: between the outermost values of each input at which they may.
pub fn beyond(system: &System) -> Vec<Beyond> {
    let axes: Vec<Axis> = system.inputs.iter().map(Axis::new).collect();
    let mut found: BTreeMap<(usize, usize), (f64, f64)> = BTreeMap::new();
    for (_, rule) in rules(system).filter(|(_, rule)| rule.weight > 0.0) {
        let Some(pieces) = reach(&rule.antecedent, &axes) else {
            continue;
        };
        for &(output, term) in &rule.conclusions {
            let (least, most) = match &system.outputs[output].terms[term].conclusion {
                Conclusion::Constant(value) => (*value, *value),
                Conclusion::Linear {
                    coefficients,
                    constant,
                } => {
                    let (mut least, mut most) = (*constant, *constant);
                    for ((c, axis), pieces) in coefficients.iter().zip(&axes).zip(&pieces) {
                        let stretch = axis.stretch(pieces);
                        let ends = [c * stretch.from, c * stretch.to];
                        least += ends[0].min(ends[1]);
                        most += ends[0].max(ends[1]);
                    }
                    (least, most)
                }
                Conclusion::Set(_) => continue,
            };
            let all = found.entry((output, term)).or_insert((least, most));
            *all = (all.0.min(least), all.1.max(most));
        }
    }
    let beyond = |&((output, _), (least, most)): &((usize, usize), (f64, f64))| {
        let range = &system.outputs[output].range;
        // Sums of coefficients are rounded.
        let little = 1e-9 * (range.end() - range.start());
        least < range.start() - little || most > range.end() + little
    };
    let found = found.into_iter().filter(beyond);
    found
        .map(|((output, term), (least, most))| Beyond {
            output,
            term,
            least,
            most,
        })
        .collect()
}

/// From where to where of each input a rule may fire; `None`: nowhere.
fn reach(antecedent: &Antecedent, axes: &[Axis]) -> Option<Vec<Range<usize>>> {
    match antecedent {
        Antecedent::Is {
            input,
            term,
            negated,
        } => {
            let axis = &axes[*input];
            let holds = |piece: &usize| axis.holding(*term, *negated, &(*piece..piece + 1)) > 0;
            let first = (0..axis.len()).find(holds)?;
            let last = (0..axis.len()).rfind(holds)?;
            let mut all: Vec<Range<usize>> = axes.iter().map(|axis| 0..axis.len()).collect();
            all[*input] = first..last + 1;
            Some(all)
        }
        Antecedent::And(parts) => {
            let mut all: Vec<Range<usize>> = axes.iter().map(|axis| 0..axis.len()).collect();
            for part in parts {
                for (own, other) in all.iter_mut().zip(reach(part, axes)?) {
                    *own = own.start.max(other.start)..own.end.min(other.end);
                }
            }
            all.iter().all(|pieces| !pieces.is_empty()).then_some(all)
        }
        Antecedent::Or(parts) => {
            let parts = parts.iter().filter_map(|part| reach(part, axes));
            parts.reduce(|a, b| {
                let pairs = a.into_iter().zip(b);
                pairs
                    .map(|(a, b)| a.start.min(b.start)..a.end.max(b.end))
                    .collect()
            })
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::sample::fan;

    #[test]
    fn a_linear_term_counts_where_its_rules_fire() {
        let mut fan = fan();
        assert_eq!(beyond(&fan), []);
        // Off becomes 20 · temperature − 400, which is 80 at 24 °C, where low ends; and it is concluded at mid and low, too.
        fan.outputs[0].terms[0].conclusion = Conclusion::Linear {
            coefficients: vec![20.0, 0.0],
            constant: -400.0,
        };
        let expected = |least, most| {
            [Beyond {
                output: 0,
                term: 0,
                least,
                most,
            }]
        };
        assert_eq!(beyond(&fan), expected(-400.0, 240.0));
        fan.blocks[0].rules.remove(2);
        assert_eq!(beyond(&fan), expected(-400.0, 80.0));
        fan.outputs[0].range = -400.0..=100.0;
        assert_eq!(beyond(&fan), []);
    }
}
