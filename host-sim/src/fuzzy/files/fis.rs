//! MATLAB's fuzzy inference systems, `.fis`: sections of `key=value` lines, and rules of numbers. Octave's and FuzzyLite's
//! files are read as well: texts may stand between double quotes, the type may be in capitals, a rule may end with `;`.
//!
//! What the format leaves unsaid and MATLAB does: a centroid takes 101 samples from end to end of the range; an output
//! that no rule reaches has the middle of its range; neither inputs nor outputs are limited to their ranges; a Sugeno
//! system adds the degrees of its rules whatever its `AggMethod` is.

mod rules;
mod settings;
mod variable;

use super::checks;
use super::cursor::{Cursor, Parameter};
use super::error::{ReadError, Source, lines, one_of, quoted};
use super::lexer::{Dialect, Kind, Token, lex};
use super::limits;
use super::norms::concludes_set;
use crate::fuzzy::model::{Conjunction, Place, RuleBlock, System};
use rules::Rules;
use settings::Settings;
use variable::Variable;

const DIALECT: Dialect = Dialect {
    signs: &["[", "]", "(", ")", ",", ":", "=", ";"],
    line_comments: &["%", "#"],
    block_comments: &[],
    quotes: &['\'', '"'],
};

/// Reads a system.
pub fn read(source: Source<'_>) -> Result<System, ReadError> {
    let sections = sections(source)?;
    let end = source.end();
    let Some(head) = sections.iter().find(|s| s.is("System")) else {
        return Err(source.error(
            end,
            "there is no section `[System]`",
            "`[System]`, the first section",
        ));
    };
    let settings = Settings::read(source, head)?;
    let (mut inputs, mut outputs, mut rules) = (Vec::new(), Vec::new(), None);
    let mut names: Vec<(String, Place)> = Vec::new();
    for section in &sections {
        let reader = Variable {
            source,
            section,
            sugeno: settings.sugeno,
        };
        let known = ["`[System]`", "`[Input1]`…", "`[Output1]`…", "`[Rules]`"];
        match (section.kind(), section.number()) {
            ("System", None) if std::ptr::eq(section, head) => {}
            ("Rules", None) if rules.is_none() => rules = Some(section),
            ("System" | "Rules", None) => {
                let found = format!("a second section {}", quoted(section.name.text));
                return Err(source.error(section.name.place, found, "one"));
            }
            (kind @ ("Input" | "Output"), Some(number)) => {
                let count = if kind == "Input" {
                    inputs.len()
                } else {
                    outputs.len()
                };
                if number != count + 1 {
                    let found = format!("the section {} comes here", quoted(section.name.text));
                    return Err(source.error(
                        section.name.place,
                        found,
                        format!("`{kind}{}`", count + 1),
                    ));
                }
                checks::count(
                    source,
                    section.name.place,
                    "variables",
                    count + 1,
                    limits::OUTPUTS,
                )?;
                let name = match kind {
                    "Input" => {
                        inputs.push(reader.input()?);
                        inputs.last().map(|i| (&i.name, i.place))
                    }
                    _ => {
                        outputs.push(reader.output(&settings)?);
                        outputs.last().map(|o| (&o.name, o.place))
                    }
                };
                if let Some((name, place)) = name {
                    let earlier = names.iter().map(|(n, p)| (n.as_str(), *p));
                    checks::unique(source, "the variable", name, place, earlier)?;
                    names.push((name.clone(), place));
                }
            }
            _ => {
                let found = format!("{} is no section", quoted(section.name.text));
                return Err(source.error(section.name.place, found, one_of(known)));
            }
        }
    }
    settings.counted(source, "NumInputs", settings.inputs, inputs.len(), "input")?;
    settings.counted(
        source,
        "NumOutputs",
        settings.outputs,
        outputs.len(),
        "output",
    )?;
    checks::variables(source, &inputs, &outputs, end)?;
    let Some(section) = rules else {
        return Err(source.error(
            end,
            "there is no section `[Rules]`",
            "`[Rules]`, the last section",
        ));
    };
    let mut reader = Rules {
        source,
        inputs: &inputs,
        outputs: &outputs,
        and: None,
        or: None,
    };
    let mut all = Vec::new();
    for line in &section.lines {
        all.push(reader.rule(line)?);
        checks::count(source, line.place, "rules", all.len(), limits::RULES)?;
    }
    settings.counted(source, "NumRules", settings.rules, all.len(), "rule")?;
    let (and, or) = (reader.and, reader.or);
    let and = settings
        .and
        .used(source, "AndMethod", and, "'min' or 'prod'")?;
    settings.or.used(source, "OrMethod", or, "'max'")?;
    let set = concludes_set(&all, &outputs);
    let implication = settings
        .implication
        .used(source, "ImpMethod", set, "'min' or 'prod'")?;
    let system = System {
        name: settings.name,
        description: String::new(),
        inputs,
        outputs,
        blocks: vec![RuleBlock {
            // The format has one block and no name for it; other formats ask for one.
            name: "rules".to_owned(),
            description: String::new(),
            and: and.unwrap_or(Conjunction::Min),
            implication: implication.unwrap_or(Conjunction::Min),
            rules: all,
        }],
    };
    checks::rules(source, &system.blocks, end)?;
    Ok(system)
}

/// A line's text and where it begins.
#[derive(Clone, Copy)]
struct Line<'s> {
    text: &'s str,
    place: Place,
}

struct Section<'s> {
    name: Token<'s>,
    lines: Vec<Line<'s>>,
}

impl<'s> Section<'s> {
    fn kind(&self) -> &'s str {
        self.name
            .text
            .trim_end_matches(|c: char| c.is_ascii_digit())
    }

    fn number(&self) -> Option<usize> {
        self.name.text[self.kind().len()..].parse().ok()
    }

    fn is(&self, name: &str) -> bool {
        self.name.text == name
    }
}

fn sections(source: Source<'_>) -> Result<Vec<Section<'_>>, ReadError> {
    let mut all: Vec<Section<'_>> = Vec::new();
    for (i, text) in lines(source.text).enumerate() {
        let place = Place {
            line: i + 1,
            column: 1,
        };
        let line = Line { text, place };
        if text.trim_start().starts_with(['%', '#']) || text.trim().is_empty() {
            continue;
        }
        if !text.trim_start().starts_with('[') {
            match all.last_mut() {
                Some(section) => section.lines.push(line),
                None => {
                    let found = format!("the file begins with {}", quoted(text.trim()));
                    return Err(source.error(place, found, "`[System]`"));
                }
            }
            continue;
        }
        let name = line.read(source, "the end of the line", |cursor| {
            cursor.sign("[")?;
            let name = cursor.name("a section's name", &[])?;
            cursor.sign("]")?;
            Ok(name)
        })?;
        all.push(Section {
            name,
            lines: Vec::new(),
        });
    }
    Ok(all)
}

impl<'s> Line<'s> {
    /// Reads all of it.
    fn read<T>(
        self,
        source: Source<'s>,
        rest: &str,
        read: impl FnOnce(&mut Cursor<'s, '_>) -> Result<T, ReadError>,
    ) -> Result<T, ReadError> {
        let (tokens, _) = lex(self.text, self.place, &DIALECT);
        let mut cursor = Cursor::new(source, &tokens, "the line");
        let value = read(&mut cursor)?;
        cursor.end(rest)?;
        Ok(value)
    }
}

/// A text between quotes.
fn text<'s>(cursor: &mut Cursor<'s, '_>, what: &str) -> Result<Token<'s>, ReadError> {
    match cursor.peek().kind {
        Kind::Text => Ok(cursor.take()),
        _ => Err(cursor.unexpected(format!("{what} between single quotes"))),
    }
}

/// A name: not empty, not too long.
fn name<'s>(
    source: Source<'_>,
    cursor: &mut Cursor<'s, '_>,
    what: &str,
) -> Result<Token<'s>, ReadError> {
    let token = text(cursor, what)?;
    let length = token.text.chars().count();
    if token.text.trim().is_empty() || length > limits::NAME {
        let found = format!("a name of {length} characters");
        let allowed = format!("1 to {} characters, not blanks alone", limits::NAME);
        return Err(source.error(token.place, found, allowed));
    }
    Ok(token)
}

/// `[1 2 3]`, with commas or without.
fn list(source: Source<'_>, cursor: &mut Cursor<'_, '_>) -> Result<Vec<Parameter>, ReadError> {
    cursor.sign("[")?;
    let mut all = Vec::new();
    while !cursor.eat_sign("]") {
        if !all.is_empty() {
            cursor.eat_sign(",");
        }
        let number = cursor.number("a number or `]`")?;
        all.push(number);
        checks::count(
            source,
            number.place,
            "numbers",
            all.len(),
            2 * limits::POINTS,
        )?;
    }
    Ok(all)
}

fn whole(source: Source<'_>, cursor: &mut Cursor<'_, '_>) -> Result<(usize, Place), ReadError> {
    let number = cursor.number("a whole number")?;
    let value = number.value;
    match value.fract() == 0.0 && (0.0..=1e6).contains(&value) {
        true => Ok((value as usize, number.place)),
        false => Err(source.error(number.place, format!("found {value}"), "a whole number")),
    }
}

/// `Key=`, which is known and new; gives the key.
fn key<'s, 'k>(
    source: Source<'_>,
    cursor: &mut Cursor<'s, '_>,
    keys: &mut Vec<Token<'s>>,
    known: &[&'k str],
) -> Result<&'k str, ReadError> {
    let token = cursor.name("`Key=value`", &[])?;
    let Some(&key) = known.iter().find(|k| **k == token.text) else {
        let found = format!("{} is no key here", quoted(token.text));
        return Err(source.error(token.place, found, one_of(known)));
    };
    checks::unique(
        source,
        "the key",
        key,
        token.place,
        keys.iter().map(|k| (k.text, k.place)),
    )?;
    keys.push(token);
    cursor.sign("=")?;
    Ok(key)
}
