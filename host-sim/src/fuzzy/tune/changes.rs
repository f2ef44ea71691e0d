//! What tuning changed, term by term.

use super::numbers::{Variable, visit};
use crate::fuzzy::model::System;
use serde::Serialize;

/// A term whose numbers are others now.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Change {
    /// The variable.
    pub variable: String,
    /// Its term.
    pub term: String,
    /// Its numbers as they were: knots as the shape names them, then widths; or what it concludes.
    pub before: Vec<f64>,
    /// As they are.
    pub after: Vec<f64>,
}

/// Every term that differs between two forms of the same design.
pub fn changes(before: &System, after: &System) -> Vec<Change> {
    let mut terms = numbers(before);
    for (term, numbers) in terms.iter_mut().zip(numbers(after)) {
        term.after = numbers.before;
    }
    terms.retain(|term| term.before != term.after);
    terms
}

/// Every term, its numbers under `before`.
fn numbers(system: &System) -> Vec<Change> {
    let mut terms: Vec<((Variable, usize), Change)> = Vec::new();
    visit(&mut system.clone(), &mut |slot, x| {
        let owner = (slot.variable, slot.term);
        match terms.last_mut() {
            Some((last, of)) if *last == owner => of.before.push(*x),
            _ => {
                let (variable, term) = names(system, owner);
                let change = Change {
                    variable,
                    term,
                    before: vec![*x],
                    after: Vec::new(),
                };
                terms.push((owner, change));
            }
        }
    });
    terms.into_iter().map(|(_, change)| change).collect()
}

fn names(system: &System, (variable, term): (Variable, usize)) -> (String, String) {
    match variable {
        Variable::Input(index) => {
            let input = &system.inputs[index];
            (input.name.clone(), input.terms[term].name.clone())
        }
        Variable::Output(index) => {
            let output = &system.outputs[index];
            (output.name.clone(), output.terms[term].name.clone())
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::model::Conclusion;
    use crate::fuzzy::sample::fan;

    #[test]
    fn only_what_differs_is_told() {
        let mut after = fan();
        assert_eq!(changes(&fan(), &after), []);
        after.outputs[0].terms[1].conclusion = Conclusion::Constant(42.0);
        let change = Change {
            variable: "speed".to_owned(),
            term: "half".to_owned(),
            before: vec![40.0],
            after: vec![42.0],
        };
        assert_eq!(changes(&fan(), &after), [change]);
    }
}
