//! What both writers share: numbers, names, rules, and how they refuse what their language cannot say.

use super::limits;
use crate::fuzzy::model::{Antecedent, Conclusion, Place, Rule, Shape, System};
use std::fmt::{self, Display, Formatter};

/// Why a system was not written: its language cannot say something.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WriteError {
    /// Where the design that was read says it; line 0 if it was made otherwise.
    pub place: Place,
    /// What cannot be said.
    pub found: String,
    /// What can.
    pub allowed: String,
    /// Whether [`super::adapt`] knows a near thing that can be said.
    pub adaptable: bool,
}

impl std::error::Error for WriteError {}

impl Display for WriteError {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        write!(f, "{}", self.found)?;
        match self.allowed.as_str() {
            "" => Ok(()),
            allowed => write!(f, "; allowed is {allowed}"),
        }
    }
}

/// Refuses something.
pub fn refuse<T>(
    place: Place,
    found: impl Into<String>,
    allowed: impl Into<String>,
) -> Result<T, WriteError> {
    Err(WriteError {
        place,
        found: found.into(),
        allowed: allowed.into(),
        adaptable: false,
    })
}

/// Refuses something that [`super::adapt`] can change.
pub fn refuse_adaptable<T>(
    place: Place,
    found: impl Into<String>,
    allowed: impl Into<String>,
) -> Result<T, WriteError> {
    refuse(place, found, allowed).map_err(|error| WriteError {
        adaptable: true,
        ..error
    })
}

/// A number, as short as it can be without becoming another one.
pub fn number(x: f64) -> String {
    let text = format!("{x:?}").to_ascii_lowercase();
    text.strip_suffix(".0").unwrap_or(&text).to_owned()
}

/// Numbers with blanks between them.
pub fn numbers(all: &[f64]) -> String {
    let all: Vec<String> = all.iter().copied().map(number).collect();
    all.join(" ")
}

/// Whether a name is letters, digits and `_`, no digit first, not too long, and none of the reserved words.
pub fn is_name(name: &str, reserved: &[&[&str]]) -> bool {
    let first = name.chars().next();
    first.is_some_and(|c| !c.is_numeric())
        && name.chars().all(|c| c.is_alphanumeric() || c == '_')
        && name.chars().count() <= limits::NAME
        && !reserved
            .iter()
            .copied()
            .flatten()
            .any(|r| r.eq_ignore_ascii_case(name))
}

/// Refuses what no reader would take back: names that the language cannot hold, sets without a width.
pub fn check(system: &System, language: &str, reserved: &[&[&str]]) -> Result<(), WriteError> {
    let check = |what: &str, name: &str, place: Place| match is_name(name, reserved) {
        true => Ok(()),
        false => refuse_adaptable(
            place,
            format!("{language} has no such name: the {what} `{name}`"),
            "letters, digits and `_`, no digit first, no word of the language",
        ),
    };
    for input in &system.inputs {
        check("input", &input.name, input.place)?;
        for term in &input.terms {
            check("term", &term.name, term.place)?;
        }
    }
    for output in &system.outputs {
        check("output", &output.name, output.place)?;
        for term in &output.terms {
            if matches!(term.conclusion, Conclusion::Set(Shape::Singleton(_))) {
                let found = format!("the term `{}` of `{}` has no width", term.name, output.name);
                return refuse(term.place, found, "a set that has one, or a constant");
            }
            check("term", &term.name, term.place)?;
        }
    }
    Ok(())
}

/// How a language writes rules.
#[derive(Clone, Copy, Debug)]
pub struct RuleStyle {
    /// Between two conclusions.
    pub conclusions: &'static str,
    /// Whether an AND within an OR stands in parentheses, as an OR within an AND always does.
    pub mark_and: bool,
}

/// `if … then … with …`.
pub fn rule(system: &System, rule: &Rule, style: RuleStyle) -> Result<String, WriteError> {
    let writer = Rules { system, style };
    let levels = writer.levels(&rule.antecedent, true);
    if levels > limits::DEPTH {
        let found = format!("the rule needs {levels} levels of parentheses");
        return refuse(rule.place, found, format!("at most {}", limits::DEPTH));
    }
    let conclusions: Vec<String> = rule
        .conclusions
        .iter()
        .filter_map(|&(output, term)| {
            let output = system.outputs.get(output)?;
            Some(format!(
                "{} is {}",
                output.name,
                output.terms.get(term)?.name
            ))
        })
        .collect();
    let mut text = format!(
        "if {} then {}",
        writer.condition(&rule.antecedent, true),
        conclusions.join(style.conclusions)
    );
    if rule.weight != 1.0 {
        text += &format!(" with {}", number(rule.weight));
    }
    Ok(text)
}

struct Rules<'s> {
    system: &'s System,
    style: RuleStyle,
}

impl Rules<'_> {
    /// How deep parentheses are nested.
    fn levels(&self, antecedent: &Antecedent, outermost: bool) -> usize {
        let (all, marked) = match antecedent {
            Antecedent::Is { .. } => return 0,
            Antecedent::And(all) => (all, self.style.mark_and),
            Antecedent::Or(all) => (all, true),
        };
        let inner = all.iter().map(|a| self.levels(a, false)).max();
        inner.unwrap_or(0) + usize::from(marked && !outermost)
    }

    fn condition(&self, antecedent: &Antecedent, outermost: bool) -> String {
        let (all, word, mark) = match antecedent {
            Antecedent::Is {
                input,
                term,
                negated,
            } => {
                let not = if *negated { "not " } else { "" };
                let input = &self.system.inputs[*input];
                return format!("{} is {not}{}", input.name, input.terms[*term].name);
            }
            Antecedent::And(all) => (all, " and ", self.style.mark_and),
            Antecedent::Or(all) => (all, " or ", true),
        };
        let parts: Vec<String> = all.iter().map(|a| self.condition(a, false)).collect();
        match mark && !outermost {
            true => format!("({})", parts.join(word)),
            false => parts.join(word),
        }
    }
}
