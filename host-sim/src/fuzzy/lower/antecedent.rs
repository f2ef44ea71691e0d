//! Antecedents as the engine takes them: OR of ANDs.

use super::LowerError;
use crate::fuzzy::model::{Antecedent, Place};
use fuzzypilot::fuzzy::system::Literal;

/// The most literals of a rule: a nested OR multiplies them.
const MOST: usize = 4096;

/// The rule's conjunctions. That AND distributes over OR holds exactly: OR is max, and minimum and product only rise with
/// their operands.
pub fn conjunctions(
    antecedent: &Antecedent,
    place: Place,
) -> Result<Vec<Vec<Literal>>, LowerError> {
    let all = match antecedent {
        Antecedent::Is {
            input,
            term,
            negated,
        } => vec![vec![literal(*input, *term, *negated, place)?]],
        Antecedent::Or(parts) => {
            let mut any = Vec::new();
            for part in parts {
                any.extend(conjunctions(part, place)?);
                bounded(&any, place)?;
            }
            any
        }
        Antecedent::And(parts) => {
            let mut all = vec![Vec::new()];
            for part in parts {
                let next = conjunctions(part, place)?;
                // The product's size, before it is made.
                let literals: usize = next.iter().map(Vec::len).sum::<usize>() * all.len()
                    + all.iter().map(Vec::len).sum::<usize>() * next.len();
                sized(literals, place)?;
                all = all
                    .iter()
                    .flat_map(|left| next.iter().map(move |right| [&left[..], right].concat()))
                    .collect();
            }
            all
        }
    };
    Ok(all)
}

fn literal(input: usize, term: usize, negated: bool, place: Place) -> Result<Literal, LowerError> {
    let (Ok(input), Ok(term)) = (u8::try_from(input), u8::try_from(term)) else {
        return Err(LowerError::TooMany {
            place,
            what: format!("the rule asks for term {} of input {}", term + 1, input + 1),
            limit: "4 inputs with 255 terms are possible".into(),
        });
    };
    Ok(if negated {
        Literal::IsNot(input, term)
    } else {
        Literal::Is(input, term)
    })
}

fn bounded(conjunctions: &[Vec<Literal>], place: Place) -> Result<(), LowerError> {
    sized(conjunctions.iter().map(Vec::len).sum(), place)
}

fn sized(literals: usize, place: Place) -> Result<(), LowerError> {
    if literals <= MOST {
        return Ok(());
    }
    Err(LowerError::TooMany {
        place,
        what: format!("the rule, written as OR of ANDs, asks {literals} times for a term"),
        limit: format!("{MOST} are possible"),
    })
}
