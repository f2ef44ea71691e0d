//! `[Input…]` and `[Output…]`.

use super::settings::Settings;
use super::{Section, key, list, name, text, whole};
use crate::fuzzy::files::checks;
use crate::fuzzy::files::cursor::{Cursor, Parameter};
use crate::fuzzy::files::error::{ReadError, Source, counted, one_of, quoted};
use crate::fuzzy::files::lexer::{Kind, Token};
use crate::fuzzy::files::limits;
use crate::fuzzy::files::shapes::Family;
use crate::fuzzy::model::{Conclusion, Input, Output, OutputTerm, Term};
use std::ops::RangeInclusive;

/// Shapes, and where each of a [`Family`]'s numbers stands among theirs.
const SHAPES: &[(&str, Family, &[usize])] = &[
    ("trimf", Family::Triangle, &[]),
    ("trapmf", Family::Trapezoid, &[]),
    ("gaussmf", Family::Gaussian, &[1, 0]),
    ("gauss2mf", Family::TwoSidedGaussian, &[1, 0, 3, 2]),
    ("gbellmf", Family::Bell, &[2, 0, 1]),
    ("sigmf", Family::Sigmoid, &[1, 0]),
    ("smf", Family::S, &[]),
    ("zmf", Family::Z, &[]),
    ("linsmf", Family::Ramp, &[]),
    ("linzmf", Family::FallingRamp, &[]),
    // FuzzyLite's.
    ("rampmf", Family::Ramp, &[]),
    ("rectmf", Family::Rectangle, &[]),
    ("discretemf", Family::Points, &[]),
];

/// Shapes that tools know and this project does not.
const OTHER_SHAPES: &[&str] = &[
    "dsigmf",
    "psigmf",
    "pimf",
    "concavemf",
    "cosinemf",
    "spikemf",
    "functionmf",
];

/// Reads a section of a variable.
#[derive(Clone, Copy)]
pub(super) struct Variable<'s, 'f> {
    pub(super) source: Source<'s>,
    pub(super) section: &'f Section<'s>,
    pub(super) sugeno: bool,
}

/// What the sections of inputs and outputs have in common.
struct Common<'s> {
    name: Token<'s>,
    range: RangeInclusive<f64>,
    terms: Vec<(Token<'s>, Conclusion)>,
}

impl<'s> Variable<'s, '_> {
    pub(super) fn input(self) -> Result<Input, ReadError> {
        let common = self.common(false)?;
        let terms = common
            .terms
            .into_iter()
            .filter_map(|(name, conclusion)| match conclusion {
                Conclusion::Set(shape) => Some(Term {
                    name: name.text.to_owned(),
                    shape,
                    place: name.place,
                }),
                _ => None,
            });
        Ok(Input {
            name: common.name.text.to_owned(),
            description: String::new(),
            range: common.range,
            clamp: false,
            terms: terms.collect(),
            place: common.name.place,
        })
    }

    pub(super) fn output(self, settings: &Settings<'s>) -> Result<Output, ReadError> {
        let common = self.common(true)?;
        let terms = common
            .terms
            .into_iter()
            .map(|(name, conclusion)| OutputTerm {
                name: name.text.to_owned(),
                conclusion,
                place: name.place,
            });
        Ok(Output {
            name: common.name.text.to_owned(),
            description: String::new(),
            default: Some(common.range.start() + (common.range.end() - common.range.start()) / 2.0),
            range: common.range,
            clamp: false,
            defuzzifier: settings.defuzzifier(self.source)?,
            merge: settings.merge(self.source)?,
            terms: terms.collect(),
            place: common.name.place,
        })
    }

    fn common(self, output: bool) -> Result<Common<'s>, ReadError> {
        let source = self.source;
        let (mut variable, mut range, mut said) = (None, None, None);
        let mut terms: Vec<(Token<'s>, Conclusion)> = Vec::new();
        let mut keys = Vec::new();
        for line in &self.section.lines {
            line.read(source, "the end of the line", |cursor| {
                let token = cursor.peek();
                // `MF1`, `MF2` and so on.
                let term = token
                    .text
                    .strip_prefix("MF")
                    .and_then(|n| n.parse::<usize>().ok());
                if let (Kind::Word, Some(number)) = (token.kind, term) {
                    if number != terms.len() + 1 {
                        let found = format!("{} comes here", quoted(token.text));
                        let allowed = format!("`MF{}`", terms.len() + 1);
                        return Err(source.error(token.place, found, allowed));
                    }
                    cursor.take();
                    cursor.sign("=")?;
                    let (name, conclusion) = self.term(cursor, output)?;
                    let earlier = terms.iter().map(|(n, _)| (n.text, n.place));
                    checks::unique(source, "the term", name.text, name.place, earlier)?;
                    terms.push((name, conclusion));
                    return checks::count(source, name.place, "terms", terms.len(), limits::TERMS);
                }
                match key(
                    source,
                    cursor,
                    &mut keys,
                    &["Name", "Range", "NumMFs", "MF1…"],
                )? {
                    "Name" => variable = Some(name(source, cursor, "a name")?),
                    "Range" => {
                        let place = cursor.peek().place;
                        let numbers = list(source, cursor)?;
                        let [start, end] = numbers[..] else {
                            let found =
                                format!("the range has {}", counted(numbers.len(), "number"));
                            return Err(source.error(place, found, "`[start end]`"));
                        };
                        range = Some(checks::range(source, start, end)?);
                    }
                    _ => said = Some(whole(source, cursor)?),
                }
                Ok(())
            })?;
        }
        let place = self.section.name.place;
        let section = quoted(self.section.name.text);
        if let Some((number, at)) = said
            && number != terms.len()
        {
            let terms = counted(terms.len(), "term");
            let found = format!("NumMFs is {number}, but the section has {terms}");
            return Err(source.error(at, found, "as many as there are"));
        }
        let Some(name) = variable else {
            return Err(source.error(place, format!("{section} has no name"), "`Name='…'`"));
        };
        let Some(range) = range else {
            return Err(source.error(
                place,
                format!("{section} has no range"),
                "`Range=[start end]`",
            ));
        };
        Ok(Common { name, range, terms })
    }

    /// `'name':'shape',[numbers]`
    fn term(
        self,
        cursor: &mut Cursor<'s, '_>,
        output: bool,
    ) -> Result<(Token<'s>, Conclusion), ReadError> {
        let source = self.source;
        let name = name(source, cursor, "a term's name")?;
        cursor.sign(":")?;
        let shape = text(cursor, "a shape")?;
        cursor.sign(",")?;
        let numbers = list(source, cursor)?;
        let sugeno = output && self.sugeno;
        let names: Vec<String> = match sugeno {
            true => ["constant", "linear"].map(|n| format!("'{n}'")).to_vec(),
            false => SHAPES.iter().map(|(n, ..)| format!("'{n}'")).collect(),
        };
        let family = SHAPES.iter().find(|(n, ..)| *n == shape.text);
        let conclusion = match (family, shape.text) {
            (Some((_, family, order)), _) if !sugeno => {
                Conclusion::Set(family.shape(source, shape, &numbers, order)?)
            }
            (_, "constant" | "linear") if sugeno => self.constant(shape, &numbers)?,
            (_, other) => {
                let found = match family.is_some() || matches!(other, "constant" | "linear") {
                    true => format!("the shape {} does not belong here", quoted(other)),
                    false if OTHER_SHAPES.contains(&other) => {
                        format!("the shape {} is not supported", quoted(other))
                    }
                    false => format!("{} is no shape", quoted(other)),
                };
                return Err(source.error(shape.place, found, one_of(names)));
            }
        };
        Ok((name, conclusion))
    }

    fn constant(self, shape: Token<'_>, numbers: &[Parameter]) -> Result<Conclusion, ReadError> {
        if let Some(bad) = numbers.iter().find(|p| !p.value.is_finite()) {
            let found = format!("{} is not finite", bad.value);
            return Err(self.source.error(bad.place, found, "a finite number"));
        }
        match (shape.text, numbers) {
            ("constant", [value]) => Ok(Conclusion::Constant(value.value)),
            ("linear", [coefficients @ .., constant]) => Ok(Conclusion::Linear {
                coefficients: coefficients.iter().map(|p| p.value).collect(),
                constant: constant.value,
            }),
            (kind, _) => {
                let found = format!("{} has {}", quoted(kind), counted(numbers.len(), "number"));
                let allowed = match kind {
                    "constant" => "1: the value",
                    _ => "a number for each input, and the constant",
                };
                Err(self.source.error(shape.place, found, allowed))
            }
        }
    }
}
