//! Rules as text: `x is a and (y is not b or z is c)`, then what they conclude. FLL and FCL share this grammar; AND binds
//! tighter than OR.

use super::checks;
use super::cursor::{Cursor, Parameter};
use super::error::{ReadError, Source, one_of, quoted};
use super::lexer::Token;
use super::limits;
use crate::fuzzy::model::{Antecedent, Conjunction, Input, Output, Rule};

/// How a language writes rules.
#[derive(Debug)]
pub struct Grammar {
    /// Words that are no names.
    pub reserved: &'static [&'static str],
    /// Hedges: words that some tools allow before a term. They are named and refused.
    pub hedges: &'static [&'static str],
    /// Whether `not` may stand before a proposition or a parenthesis.
    pub leading_not: bool,
    /// Whether a comma separates conclusions, too.
    pub comma: bool,
}

/// A rule as it is written.
#[derive(Debug)]
pub struct WrittenRule<'s> {
    /// When it fires.
    pub condition: Condition<'s>,
    /// Output and term of each conclusion.
    pub conclusions: Vec<(Token<'s>, Token<'s>)>,
    /// Its weight, if it has one.
    pub weight: Option<Parameter>,
    /// Where it begins.
    pub start: Token<'s>,
    /// An OR that it uses.
    pub or: Option<Token<'s>>,
    /// An AND that it uses.
    pub and: Option<Token<'s>>,
}

/// A condition as it is written. It is nested no deeper than [`limits::DEPTH`] allows.
#[derive(Debug)]
pub enum Condition<'s> {
    /// `variable is term`, or `is not`.
    Is(Token<'s>, Token<'s>, bool),
    /// `not (…)`, with its `not`.
    Not(Token<'s>, Box<Condition<'s>>),
    /// All of them.
    And(Vec<Condition<'s>>),
    /// Any of them.
    Or(Vec<Condition<'s>>),
}

/// Reads `if … then … with …`.
pub fn rule<'s>(
    cursor: &mut Cursor<'s, '_>,
    source: Source<'s>,
    grammar: &Grammar,
) -> Result<WrittenRule<'s>, ReadError> {
    let start = cursor.word("if")?;
    let mut reader = Reader {
        cursor: *cursor,
        source,
        grammar,
        depth: 0,
        propositions: 0,
        or: None,
        and: None,
    };
    let condition = reader.any()?;
    if !reader.cursor.at_word("then") {
        return Err(reader.cursor.unexpected("`and`, `or` or `then`"));
    }
    reader.cursor.take();
    let conclusions = reader.conclusions()?;
    let Reader { or, and, .. } = reader;
    *cursor = reader.cursor;
    let weight = match cursor.eat_word("with") {
        true => Some(cursor.number("a weight from 0 to 1")?),
        false => None,
    };
    Ok(WrittenRule {
        condition,
        conclusions,
        weight,
        start,
        or,
        and,
    })
}

struct Reader<'s, 't, 'g> {
    cursor: Cursor<'s, 't>,
    source: Source<'s>,
    grammar: &'g Grammar,
    depth: usize,
    propositions: usize,
    or: Option<Token<'s>>,
    and: Option<Token<'s>>,
}

impl<'s> Reader<'s, '_, '_> {
    fn any(&mut self) -> Result<Condition<'s>, ReadError> {
        let mut all = vec![self.all()?];
        while self.cursor.at_word("or") {
            self.or = Some(self.cursor.take());
            all.push(self.all()?);
        }
        Ok(match all.len() {
            1 => all.remove(0),
            _ => Condition::Or(all),
        })
    }

    fn all(&mut self) -> Result<Condition<'s>, ReadError> {
        let mut all = vec![self.one()?];
        while self.cursor.at_word("and") {
            self.and = Some(self.cursor.take());
            all.push(self.one()?);
        }
        Ok(match all.len() {
            1 => all.remove(0),
            _ => Condition::And(all),
        })
    }

    fn one(&mut self) -> Result<Condition<'s>, ReadError> {
        let token = self.cursor.peek();
        if self.grammar.leading_not && self.cursor.eat_word("not") {
            let inner = self.deeper(token, Self::one)?;
            return Ok(Condition::Not(token, Box::new(inner)));
        }
        if self.cursor.eat_sign("(") {
            let inner = self.deeper(token, Self::any)?;
            if !self.cursor.at_sign(")") {
                return Err(self.cursor.unexpected("`and`, `or` or `)`"));
            }
            self.cursor.take();
            return Ok(inner);
        }
        self.propositions += 1;
        if self.propositions > limits::PROPOSITIONS {
            let found = "too many propositions in a rule";
            let allowed = limits::PROPOSITIONS.to_string();
            return Err(self.source.error(token.place, found, allowed));
        }
        let what = match self.grammar.leading_not {
            true => "an input's name, `not` or `(`",
            false => "an input's name or `(`",
        };
        let variable = self.cursor.name(what, self.grammar.reserved)?;
        self.cursor.word("is")?;
        let mut negated = false;
        while self.cursor.eat_word("not") {
            negated = !negated;
        }
        let term = self.term(true)?;
        Ok(Condition::Is(variable, term, negated))
    }

    fn deeper(
        &mut self,
        opening: Token<'s>,
        inner: fn(&mut Self) -> Result<Condition<'s>, ReadError>,
    ) -> Result<Condition<'s>, ReadError> {
        if self.depth == limits::DEPTH {
            let found = "the condition is nested too deeply";
            let allowed = format!("{} levels", limits::DEPTH);
            return Err(self.source.error(opening.place, found, allowed));
        }
        self.depth += 1;
        let condition = inner(self)?;
        self.depth -= 1;
        Ok(condition)
    }

    fn term(&mut self, not: bool) -> Result<Token<'s>, ReadError> {
        let token = self.cursor.peek();
        if self.grammar.hedges.contains(&token.text) {
            let found = format!("the hedge {} is not supported", quoted(token.text));
            let allowed = match not {
                true => "a term's name, or `not` and one",
                false => "a term's name",
            };
            return Err(self.source.error(token.place, found, allowed));
        }
        self.cursor.name("a term's name", self.grammar.reserved)
    }

    fn conclusions(&mut self) -> Result<Vec<(Token<'s>, Token<'s>)>, ReadError> {
        let mut all = Vec::new();
        loop {
            let output = self
                .cursor
                .name("an output's name", self.grammar.reserved)?;
            self.cursor.word("is")?;
            let token = self.cursor.peek();
            if self.cursor.at_word("not") {
                let found = "`not` in a conclusion is not supported";
                return Err(self.source.error(token.place, found, "a term's name"));
            }
            let term = self.term(false)?;
            if all
                .iter()
                .any(|(o, _): &(Token<'_>, _)| o.text == output.text)
            {
                let found = format!("this rule concludes {} twice", quoted(output.text));
                return Err(self.source.error(output.place, found, "each output once"));
            }
            all.push((output, term));
            checks::count(
                self.source,
                output.place,
                "conclusions",
                all.len(),
                limits::OUTPUTS,
            )?;
            if self.cursor.at_word("or") {
                let found = "`or` in a conclusion is not supported";
                let place = self.cursor.peek().place;
                return Err(self.source.error(place, found, "`and`"));
            }
            let more =
                self.cursor.eat_word("and") || (self.grammar.comma && self.cursor.eat_sign(","));
            if !more {
                return Ok(all);
            }
        }
    }
}

/// The variables that rules speak of.
#[derive(Clone, Copy, Debug)]
pub struct Names<'v> {
    /// The system's.
    pub inputs: &'v [Input],
    /// The system's.
    pub outputs: &'v [Output],
}

impl WrittenRule<'_> {
    /// The rule, its names looked up.
    pub fn resolve(
        &self,
        source: Source<'_>,
        names: Names<'_>,
        and: Conjunction,
    ) -> Result<Rule, ReadError> {
        let resolver = Resolver { source, names, and };
        let antecedent = resolver.antecedent(&self.condition, false)?;
        let conclusions = self
            .conclusions
            .iter()
            .map(|&(output, term)| resolver.conclusion(output, term))
            .collect::<Result<_, _>>()?;
        let weight = match self.weight {
            None => 1.0,
            Some(weight) => checks::weight(source, weight)?,
        };
        Ok(Rule {
            antecedent,
            conclusions,
            weight,
            place: self.start.place,
        })
    }
}

struct Resolver<'s, 'v> {
    source: Source<'s>,
    names: Names<'v>,
    and: Conjunction,
}

impl Resolver<'_, '_> {
    /// The model's form: negations at the propositions, no AND right in an AND, no OR right in an OR.
    fn antecedent(
        &self,
        condition: &Condition<'_>,
        negated: bool,
    ) -> Result<Antecedent, ReadError> {
        match condition {
            Condition::Is(variable, term, not) => {
                self.proposition(*variable, *term, *not != negated)
            }
            Condition::Not(not, inner) => {
                let simple = matches!(**inner, Condition::Is(..) | Condition::Not(..));
                if !simple && self.and == Conjunction::Product {
                    let found =
                        "`not` before a parenthesis is not supported where AND is the product";
                    let allowed = "`not` at each proposition, or AND as the minimum";
                    return Err(self.source.error(not.place, found, allowed));
                }
                self.antecedent(inner, !negated)
            }
            Condition::And(all) | Condition::Or(all) => {
                let and = matches!(condition, Condition::And(_)) != negated;
                let mut parts = Vec::with_capacity(all.len());
                for inner in all {
                    match (self.antecedent(inner, negated)?, and) {
                        (Antecedent::And(more), true) | (Antecedent::Or(more), false) => {
                            parts.extend(more);
                        }
                        (part, _) => parts.push(part),
                    }
                }
                Ok(match and {
                    true => Antecedent::And(parts),
                    false => Antecedent::Or(parts),
                })
            }
        }
    }

    fn proposition(
        &self,
        variable: Token<'_>,
        term: Token<'_>,
        negated: bool,
    ) -> Result<Antecedent, ReadError> {
        let Names { inputs, outputs } = self.names;
        let Some(input) = inputs.iter().position(|i| i.name == variable.text) else {
            let found = match outputs.iter().any(|o| o.name == variable.text) {
                true => format!(
                    "{} is an output; a condition that asks an output is not supported",
                    quoted(variable.text)
                ),
                false => format!("{} is no input", quoted(variable.text)),
            };
            let allowed = one_of(inputs.iter().map(|i| &i.name));
            return Err(self.source.error(variable.place, found, allowed));
        };
        let terms = &inputs[input].terms;
        match terms.iter().position(|t| t.name == term.text) {
            Some(term) => Ok(Antecedent::Is {
                input,
                term,
                negated,
            }),
            None => {
                let found = format!(
                    "{} is no term of the input {}",
                    quoted(term.text),
                    quoted(variable.text)
                );
                let allowed = one_of(terms.iter().map(|t| &t.name));
                Err(self.source.error(term.place, found, allowed))
            }
        }
    }

    fn conclusion(
        &self,
        variable: Token<'_>,
        term: Token<'_>,
    ) -> Result<(usize, usize), ReadError> {
        let outputs = self.names.outputs;
        let Some(output) = outputs.iter().position(|o| o.name == variable.text) else {
            let found = match self.names.inputs.iter().any(|i| i.name == variable.text) {
                true => format!(
                    "{} is an input; a rule concludes outputs",
                    quoted(variable.text)
                ),
                false => format!("{} is no output", quoted(variable.text)),
            };
            let allowed = one_of(outputs.iter().map(|o| &o.name));
            return Err(self.source.error(variable.place, found, allowed));
        };
        let terms = &outputs[output].terms;
        match terms.iter().position(|t| t.name == term.text) {
            Some(term) => Ok((output, term)),
            None => {
                let found = format!(
                    "{} is no term of the output {}",
                    quoted(term.text),
                    quoted(variable.text)
                );
                let allowed = one_of(terms.iter().map(|t| &t.name));
                Err(self.source.error(term.place, found, allowed))
            }
        }
    }
}
