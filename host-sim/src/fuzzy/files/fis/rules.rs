//! `[Rules]`

use super::Line;
use crate::fuzzy::files::checks;
use crate::fuzzy::files::cursor::Cursor;
use crate::fuzzy::files::error::{ReadError, Source, counted, quoted};
use crate::fuzzy::model::{Antecedent, Input, Output, Place, Rule};

/// Reads rules; notes where AND and OR are first used.
pub(super) struct Rules<'s, 'v> {
    pub(super) source: Source<'s>,
    pub(super) inputs: &'v [Input],
    pub(super) outputs: &'v [Output],
    pub(super) and: Option<Place>,
    pub(super) or: Option<Place>,
}

impl<'s> Rules<'s, '_> {
    /// `1 -2, 1 0 (0.5) : 1`: terms of the inputs, terms of the outputs (0: none; negative: not), the weight, and 1 for
    /// AND or 2 for OR.
    pub(super) fn rule(&mut self, line: &Line<'s>) -> Result<Rule, ReadError> {
        let source = self.source;
        line.read(source, "the end of the line", |cursor| {
            let place = cursor.peek().place;
            let mut propositions = Vec::new();
            for (input, variable) in self.inputs.iter().enumerate() {
                let what = format!("a number for the input {}", quoted(&variable.name));
                let index = index(source, cursor, &what, variable.terms.len(), &variable.name)?;
                if let Some((term, negated, _)) = index {
                    propositions.push(Antecedent::Is {
                        input,
                        term,
                        negated,
                    });
                }
            }
            if !cursor.eat_sign(",") {
                let allowed = format!(
                    "`,` behind {}, one for each input",
                    counted(self.inputs.len(), "number")
                );
                return Err(cursor.unexpected(allowed));
            }
            let mut conclusions = Vec::new();
            for (output, variable) in self.outputs.iter().enumerate() {
                let what = format!("a number for the output {}", quoted(&variable.name));
                let index = index(source, cursor, &what, variable.terms.len(), &variable.name)?;
                match index {
                    None => {}
                    Some((term, false, _)) => conclusions.push((output, term)),
                    Some((_, true, at)) => {
                        let found = "a negative number, NOT, in a conclusion is not supported";
                        return Err(source.error(at, found, "0 or a term's number"));
                    }
                }
            }
            if !cursor.eat_sign("(") {
                let allowed = format!(
                    "`(weight)` behind {}, one for each output",
                    counted(self.outputs.len(), "number")
                );
                return Err(cursor.unexpected(allowed));
            }
            let weight = checks::weight(source, cursor.number("a weight from 0 to 1")?)?;
            cursor.sign(")")?;
            cursor.sign(":")?;
            let connection = cursor.number("1 (AND) or 2 (OR)")?;
            let and = match connection.value {
                1.0 => true,
                2.0 => false,
                other => {
                    let found = format!("the connection is {other}");
                    return Err(source.error(connection.place, found, "1 (AND) or 2 (OR)"));
                }
            };
            cursor.eat_sign(";");
            let antecedent = match (propositions.len(), and) {
                (0, _) => {
                    let found = "this rule asks no input";
                    return Err(source.error(
                        place,
                        found,
                        "one number other than 0, or more, before the `,`",
                    ));
                }
                (1, _) => propositions.remove(0),
                (_, true) => {
                    self.and.get_or_insert(place);
                    Antecedent::And(propositions)
                }
                (_, false) => {
                    self.or.get_or_insert(place);
                    Antecedent::Or(propositions)
                }
            };
            if conclusions.is_empty() {
                let found = "this rule concludes nothing";
                return Err(source.error(
                    place,
                    found,
                    "one number other than 0, or more, behind the `,`",
                ));
            }
            Ok(Rule {
                antecedent,
                conclusions,
                weight,
                place,
            })
        })
    }
}

/// A term's number: its index, whether it is negated, and where that stands; none for 0.
fn index(
    source: Source<'_>,
    cursor: &mut Cursor<'_, '_>,
    what: &str,
    terms: usize,
    variable: &str,
) -> Result<Option<(usize, bool, Place)>, ReadError> {
    let number = cursor.number(what)?;
    let size = number.value.abs();
    if size.is_finite() && size.fract() != 0.0 {
        let found = format!("{}: hedges are not supported", number.value);
        return Err(source.error(number.place, found, "a whole number"));
    }
    // NaN and infinities are no number of a term either.
    match size >= 0.0 && size <= terms as f64 {
        false => {
            let found = format!("{} has no term {}", quoted(variable), number.value);
            Err(source.error(number.place, found, format!("0 to {terms}")))
        }
        true if size == 0.0 => Ok(None),
        true => Ok(Some((size as usize - 1, number.value < 0.0, number.place))),
    }
}
