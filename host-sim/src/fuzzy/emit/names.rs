//! Names of designs as identifiers of a programming language.
//!
//! `Größe` becomes `grosse`, `fan speed` and `fanSpeed` both `fan_speed`: the second of them then `fan_speed_2`.

use crate::fuzzy::lower::Tables;
use heck::ToSnakeCase;
use std::collections::HashSet;

/// Longest part of an identifier. A controller's and its variable's and term's with a number fit the 63 characters that C99
/// tells apart, and a function's name the 31 of a linker.
const LONGEST: usize = 18;

/// Names that are taken.
#[derive(Clone, Debug, Default)]
pub struct Taken(HashSet<String>);

impl Taken {
    /// These are.
    pub fn of(words: &[&str]) -> Self {
        Self(words.iter().map(|&word| word.to_owned()).collect())
    }

    /// The name, or the first free one with a number behind it. `derived` are endings with which it must be free, too.
    pub fn claim(&mut self, wanted: &str, derived: &[&str]) -> String {
        self.numbered(wanted, "_", derived)
    }

    /// The same for a type of Rust, whose name has no underscore.
    pub fn claim_type(&mut self, wanted: &str) -> String {
        self.numbered(wanted, "", &[])
    }

    fn numbered(&mut self, wanted: &str, joint: &str, derived: &[&str]) -> String {
        let free = |name: &String| {
            !self.0.contains(name)
                && derived
                    .iter()
                    .all(|ending| !self.0.contains(&format!("{name}{ending}")))
        };
        let numbered = (2..).map(|n| format!("{wanted}{joint}{n}"));
        let name = std::iter::once(wanted.to_owned())
            .chain(numbered)
            .find(free)
            .expect("numbers do not end");
        let with_endings = derived.iter().map(|ending| format!("{name}{ending}"));
        self.0.extend(with_endings);
        self.0.insert(name.clone());
        name
    }
}

/// All identifiers of a design in small letters; no two are the same, in capitals neither.
#[derive(Clone, Debug)]
pub struct Identifiers {
    /// Of the inputs.
    pub inputs: Vec<Variable>,
    /// Of the outputs.
    pub outputs: Vec<Variable>,
}

/// The identifiers of a variable.
#[derive(Clone, Debug)]
pub struct Variable {
    /// Its own.
    pub name: String,
    /// Its terms', the variable's first.
    pub terms: Vec<String>,
}

impl Identifiers {
    /// For all that tables name. `derived` are endings that a variable's identifier takes.
    pub fn new(tables: &Tables, mut taken: Taken, derived: &[&str]) -> Self {
        let inputs = tables.inputs.iter().map(|input| {
            let terms = input.terms.iter().map(|(name, _)| name.as_str());
            (input.name.as_str(), terms.collect())
        });
        let inputs = variables(inputs.collect(), "input", &mut taken, derived);
        let outputs = tables
            .outputs
            .iter()
            .map(|output| (output.name.as_str(), output.defuzzifier.names()));
        let outputs = variables(outputs.collect(), "output", &mut taken, derived);
        Self { inputs, outputs }
    }
}

fn variables(
    all: Vec<(&str, Vec<&str>)>,
    kind: &str,
    taken: &mut Taken,
    derived: &[&str],
) -> Vec<Variable> {
    let mut variables = Vec::new();
    for (place, (name, terms)) in all.into_iter().enumerate() {
        let name = taken.claim(&identifier(name, kind, place), derived);
        let terms = terms.into_iter().enumerate().map(|(place, term)| {
            let term = part(term).unwrap_or_else(|| format!("term_{}", place + 1));
            taken.claim(&format!("{name}_{term}"), &[])
        });
        variables.push(Variable {
            terms: terms.collect(),
            name,
        });
    }
    variables
}

/// A name as an identifier in small letters: `kind` and `place`, from 0, where nothing of it is left; `kind` in front where it
/// begins with a digit.
pub fn identifier(name: &str, kind: &str, place: usize) -> String {
    match part(name) {
        None => format!("{kind}_{}", place + 1),
        Some(part) if part.starts_with(|c: char| c.is_ascii_digit()) => format!("{kind}_{part}"),
        Some(part) => part,
    }
}

/// The letters and digits of a name, spelt in ASCII, `_` between words; `None` without any.
fn part(name: &str) -> Option<String> {
    let ascii = deunicode::deunicode_with_tofu(name, " ");
    let snake: String = ascii.to_snake_case().chars().take(LONGEST).collect();
    let snake = snake.trim_matches('_');
    (!snake.is_empty()).then(|| snake.to_owned())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn any_name_becomes_an_identifier() {
        for (name, expected) in [
            ("temperature", "temperature"),
            ("fanSpeed", "fan_speed"),
            ("fan speed (rpm)", "fan_speed_rpm"),
            ("VS", "vs"),
            ("Größe", "grosse"),
            ("温度", "wen_du"),
            ("1st", "input_1st"),
            ("", "input_3"),
            ("+-*/", "input_3"),
            ("\u{202e}x\u{0}", "x"),
            ("a_very_long_name_without_any_end", "a_very_long_name_w"),
        ] {
            let found = identifier(name, "input", 2);
            assert_eq!(found, expected);
            assert!(found.chars().all(|c| c.is_ascii_alphanumeric() || c == '_'));
        }
    }

    #[test]
    fn no_two_are_the_same() {
        let mut taken = Taken::of(&["inputs"]);
        let claimed: Vec<String> = ["low", "low", "low_2", "inputs", "low"]
            .map(|name| taken.claim(name, &[]))
            .into();
        assert_eq!(claimed, ["low", "low_2", "low_2_2", "inputs_2", "low_3"]);
        // Not even with an ending.
        assert_eq!(taken.claim("x", &["_fraction"]), "x");
        assert_eq!(taken.claim("x_fraction", &[]), "x_fraction_2");
        taken.claim("y_fraction", &[]);
        assert_eq!(taken.claim("y", &["_fraction"]), "y_2");
    }
}
