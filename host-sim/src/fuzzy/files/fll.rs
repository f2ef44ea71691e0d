//! FuzzyLite's language, `.fll`: a property a line, `key: value`, as FuzzyLite 6 and later and pyfuzzylite 8 write it.
//!
//! Where its tools differ or are lenient: a `Centroid` without a number takes 1000 samples (pyfuzzylite's default);
//! parentheses in conditions are read as its tools do, although its documents do not mention them; names with other
//! characters than letters, digits and `_` are refused, not mended; a disabled rule block is left out, a disabled
//! variable refused.

mod rules;
mod terms;
mod variables;
mod write;

use super::checks;
use super::conditions::Grammar;
use super::cursor::Cursor;
use super::error::{ReadError, Source, lines, one_of, quoted};
use super::lexer::{Dialect, lex};
use super::limits;
use crate::fuzzy::model::{Place, System};
pub use write::write;

const DIALECT: Dialect = Dialect {
    signs: &["(", ")"],
    line_comments: &["#"],
    block_comments: &[],
    quotes: &[],
};

/// Words that no name may be.
pub const RESERVED: &[&str] = &["if", "is", "and", "or", "then", "with", "not"];
/// Hedges of FuzzyLite; `not` is the one that is supported.
pub const HEDGES: &[&str] = &["any", "extremely", "seldom", "somewhat", "very"];

/// Functions of FuzzyLite, which its tools would take for one where a rule names a variable or a term so. Only the writer
/// minds.
const FUNCTIONS: &[&str] = &[
    "abs", "acos", "acosh", "asin", "asinh", "atan", "atan2", "atanh", "ceil", "cos", "cosh", "eq",
    "exp", "fabs", "floor", "fmod", "ge", "gt", "le", "log", "log10", "log1p", "lt", "max", "min",
    "neq", "pi", "pow", "round", "sin", "sinh", "sqrt", "tan", "tanh",
];

/// FuzzyLite's other sums and maxima, as an OR or an aggregation.
const OTHER_DISJUNCTIONS: &[&str] = &[
    "AlgebraicSum",
    "BoundedSum",
    "DrasticSum",
    "EinsteinSum",
    "HamacherSum",
    "NilpotentMaximum",
    "NormalizedSum",
    "SNormFunction",
];

/// What no name may be in a file that is written.
pub const RESERVED_NAMES: &[&[&str]] = &[RESERVED, HEDGES, FUNCTIONS];

const GRAMMAR: Grammar = Grammar {
    reserved: RESERVED,
    hedges: HEDGES,
    leading_not: false,
    comma: false,
};

/// Samples of a `Centroid` that names no number.
pub const DEFAULT_SAMPLES: usize = 1000;

/// Reads a system.
pub fn read(source: Source<'_>) -> Result<System, ReadError> {
    let components = components(source)?;
    let mut system = System {
        name: String::new(),
        description: String::new(),
        inputs: Vec::new(),
        outputs: Vec::new(),
        blocks: Vec::new(),
    };
    let mut blocks = Vec::new();
    let mut names: Vec<(String, Place)> = Vec::new();
    for (i, component) in components.iter().enumerate() {
        let reader = Component { source, component };
        match component.kind {
            "Engine" if i == 0 => {
                reader.keys(&["description"])?;
                system.name = component.head.value.trim().to_owned();
                system.description = reader.description();
            }
            "Engine" => {
                let found = "a second `Engine`";
                return Err(source.error(component.head.place, found, "one engine a file"));
            }
            _ if i == 0 => {
                let found = format!("the file begins with {}", quoted(component.kind));
                return Err(source.error(component.head.place, found, "`Engine: name`"));
            }
            "InputVariable" => {
                let input = reader.input()?;
                unique_variable(source, &mut names, &input.name, input.place)?;
                system.inputs.push(input);
            }
            "OutputVariable" => {
                let output = reader.output()?;
                unique_variable(source, &mut names, &output.name, output.place)?;
                system.outputs.push(output);
            }
            _ => {
                blocks.extend(reader.block()?);
                let place = component.head.place;
                checks::count(source, place, "rule blocks", blocks.len(), limits::BLOCKS)?;
            }
        }
    }
    if components.is_empty() {
        return Err(source.error(source.end(), "the file ends here", "`Engine: name`"));
    }
    checks::variables(source, &system.inputs, &system.outputs, source.end())?;
    for block in blocks {
        let rules = block.resolve(source, &system)?;
        system.blocks.push(rules);
    }
    checks::rules(source, &system.blocks, source.end())?;
    Ok(system)
}

fn unique_variable(
    source: Source<'_>,
    names: &mut Vec<(String, Place)>,
    name: &str,
    place: Place,
) -> Result<(), ReadError> {
    checks::unique(
        source,
        "the variable",
        name,
        place,
        names.iter().map(|(n, p)| (n.as_str(), *p)),
    )?;
    names.push((name.to_owned(), place));
    checks::count(
        source,
        place,
        "variables",
        names.len(),
        limits::INPUTS + limits::OUTPUTS,
    )
}

/// A line `key: value`.
#[derive(Clone, Copy)]
struct Property<'s> {
    key: &'s str,
    /// Of the key.
    place: Place,
    value: &'s str,
    /// Of the value's first character.
    value_place: Place,
}

/// What begins with one of [`KINDS`], and the properties below it.
struct Written<'s> {
    kind: &'s str,
    head: Property<'s>,
    properties: Vec<Property<'s>>,
}

const KINDS: [&str; 4] = ["Engine", "InputVariable", "OutputVariable", "RuleBlock"];

fn components(source: Source<'_>) -> Result<Vec<Written<'_>>, ReadError> {
    let mut all: Vec<Written<'_>> = Vec::new();
    for (i, line) in lines(source.text).enumerate() {
        let content = line.split('#').next().unwrap_or_default();
        let trimmed = content.trim_start();
        if trimmed.is_empty() {
            continue;
        }
        let indent = content.len() - trimmed.len();
        let column = |bytes: usize| content[..bytes].chars().count() + 1;
        let place = Place {
            line: i + 1,
            column: column(indent),
        };
        let Some((key, value)) = trimmed.split_once(':') else {
            let found = format!("{} has no `:`", quoted(trimmed.trim_end()));
            return Err(source.error(place, found, "`key: value`"));
        };
        let blank = value.len() - value.trim_start().len();
        let property = Property {
            key: key.trim_end(),
            place,
            value: value.trim(),
            value_place: Place {
                line: i + 1,
                column: column(indent + key.len() + 1 + blank),
            },
        };
        match (KINDS.iter().find(|k| **k == property.key), all.last_mut()) {
            (Some(_), _) => all.push(Written {
                kind: property.key,
                head: property,
                properties: Vec::new(),
            }),
            (None, Some(component)) => component.properties.push(property),
            (None, None) => {
                let found = format!("the file begins with {}", quoted(property.key));
                return Err(source.error(place, found, "`Engine: name`"));
            }
        }
    }
    Ok(all)
}

/// Reads one component.
#[derive(Clone, Copy)]
struct Component<'s, 'c> {
    source: Source<'s>,
    component: &'c Written<'s>,
}

impl<'s> Component<'s, '_> {
    /// That every key is known and, `term` and `rule` aside, there once.
    fn keys(self, known: &[&str]) -> Result<(), ReadError> {
        for (i, property) in self.component.properties.iter().enumerate() {
            let key = property.key;
            if !known.contains(&key) {
                // Components are written with a capital.
                if key.starts_with(char::is_uppercase) {
                    let found = format!("{} is no component", quoted(key));
                    return Err(self.source.error(property.place, found, one_of(KINDS)));
                }
                let found = format!("{} is no property of {}", quoted(key), self.component.kind);
                return Err(self.source.error(property.place, found, one_of(known)));
            }
            if matches!(key, "term" | "rule") {
                continue;
            }
            let earlier = &self.component.properties[..i];
            if let Some(first) = earlier.iter().find(|p| p.key == key) {
                let found = format!(
                    "{} is given already, in line {}",
                    quoted(key),
                    first.place.line
                );
                return Err(self.source.error(property.place, found, "each once"));
            }
        }
        Ok(())
    }

    fn description(self) -> String {
        self.property("description")
            .map_or_else(String::new, |property| property.value.to_owned())
    }

    fn property(self, key: &str) -> Option<Property<'s>> {
        self.component
            .properties
            .iter()
            .find(|p| p.key == key)
            .copied()
    }

    /// Reads a property's value with `read`, all of it.
    fn value<T>(
        self,
        property: Property<'s>,
        rest: &str,
        read: impl FnOnce(&mut Cursor<'s, '_>) -> Result<T, ReadError>,
    ) -> Result<T, ReadError> {
        let (tokens, _) = lex(property.value, property.value_place, &DIALECT);
        let mut cursor = Cursor::new(self.source, &tokens, "the line");
        let value = read(&mut cursor)?;
        cursor.end(rest)?;
        Ok(value)
    }

    fn flag(self, key: &str, default: bool) -> Result<bool, ReadError> {
        let Some(property) = self.property(key) else {
            return Ok(default);
        };
        self.value(property, "the end of the line", |cursor| {
            Ok(cursor.choice("", &[("true", true), ("false", false)])?.1)
        })
    }

    /// A word of a list; others that FuzzyLite knows are named as not supported.
    fn operator<T: Copy>(
        self,
        cursor: &mut Cursor<'s, '_>,
        what: &str,
        known: &[(&str, T)],
        others: &[&str],
    ) -> Result<T, ReadError> {
        let token = cursor.peek();
        if others.contains(&token.text) {
            let found = format!("the {what} {} is not supported", quoted(token.text));
            let allowed = one_of(known.iter().map(|(k, _)| k));
            return Err(self.source.error(token.place, found, allowed));
        }
        Ok(cursor.choice("", known)?.1)
    }
}
