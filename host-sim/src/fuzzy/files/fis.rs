//! MATLAB's fuzzy inference systems, `.fis`: sections of `key=value` lines, and rules of numbers. Octave's and FuzzyLite's
//! files are read as well.
//!
//! What the format leaves unsaid and MATLAB does: a centroid takes 101 samples from end to end of the range; an output
//! that no rule reaches has the middle of its range; neither inputs nor outputs are limited to their ranges; a Sugeno
//! system adds the degrees of its rules whatever its `AggMethod` is.

use super::checks;
use super::cursor::{Cursor, Parameter};
use super::error::{ReadError, Source, counted, lines, one_of, quoted};
use super::lexer::{Dialect, Kind, Token, lex};
use super::limits;
use super::norms::{Norm, concludes_set};
use super::shapes::Family;
use crate::fuzzy::model::{
    Antecedent, Conclusion, Conjunction, Defuzzifier, Input, Merge, Output, OutputTerm, Place,
    Rule, RuleBlock, Sampling, System, Term,
};
use std::ops::RangeInclusive;

const DIALECT: Dialect = Dialect {
    signs: &["[", "]", "(", ")", ",", ":", "="],
    line_comments: &["%", "#"],
    block_comments: &[],
    quotes: true,
};

/// Samples of MATLAB's centroid.
const SAMPLES: usize = 101;

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
        inputs,
        outputs,
        blocks: vec![RuleBlock {
            // The format has one block and no name for it; other formats ask for one.
            name: "rules".to_owned(),
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

/// What `[System]` says.
struct Settings<'s> {
    place: Place,
    name: String,
    sugeno: bool,
    inputs: Option<(usize, Place)>,
    outputs: Option<(usize, Place)>,
    rules: Option<(usize, Place)>,
    and: Norm<'s, Conjunction>,
    or: Norm<'s, ()>,
    implication: Norm<'s, Conjunction>,
    aggregation: Option<Token<'s>>,
    defuzzifier: Option<Token<'s>>,
}

const SYSTEM_KEYS: [&str; 11] = [
    "Name",
    "Type",
    "Version",
    "NumInputs",
    "NumOutputs",
    "NumRules",
    "AndMethod",
    "OrMethod",
    "ImpMethod",
    "AggMethod",
    "DefuzzMethod",
];

impl<'s> Settings<'s> {
    fn read(source: Source<'s>, section: &Section<'s>) -> Result<Self, ReadError> {
        let mut settings = Self {
            place: section.name.place,
            name: String::new(),
            sugeno: false,
            inputs: None,
            outputs: None,
            rules: None,
            and: Norm::None,
            or: Norm::None,
            implication: Norm::None,
            aggregation: None,
            defuzzifier: None,
        };
        let mut typed = false;
        let mut keys: Vec<Token<'s>> = Vec::new();
        for line in &section.lines {
            line.read(source, "the end of the line", |cursor| {
                let key = key(source, cursor, &mut keys, &SYSTEM_KEYS)?;
                match key {
                    "Name" => settings.name = text(cursor, "a name")?.text.to_owned(),
                    "Type" => {
                        let kind = text(cursor, "a type")?;
                        settings.sugeno = match kind.text {
                            "mamdani" => false,
                            "sugeno" | "takagi-sugeno" => true,
                            other => {
                                let found = format!("the type {} is not supported", quoted(other));
                                return Err(source.error(
                                    kind.place,
                                    found,
                                    "'mamdani' or 'sugeno'",
                                ));
                            }
                        };
                        typed = true;
                    }
                    "NumInputs" => settings.inputs = Some(whole(source, cursor)?),
                    "NumOutputs" => settings.outputs = Some(whole(source, cursor)?),
                    "NumRules" => settings.rules = Some(whole(source, cursor)?),
                    "AndMethod" => settings.and = conjunction(text(cursor, "a method")?),
                    "ImpMethod" => settings.implication = conjunction(text(cursor, "a method")?),
                    "OrMethod" => {
                        let method = text(cursor, "a method")?;
                        settings.or = match method.text {
                            "max" => Norm::Known(()),
                            _ => Norm::Other(method),
                        };
                    }
                    "AggMethod" => settings.aggregation = Some(text(cursor, "a method")?),
                    "DefuzzMethod" => settings.defuzzifier = Some(text(cursor, "a method")?),
                    // A version says nothing about the system.
                    _ => {
                        cursor.number("a number")?;
                    }
                }
                Ok(())
            })?;
        }
        if !typed {
            let found = "the system has no type";
            return Err(source.error(settings.place, found, "`Type='mamdani'` or `Type='sugeno'`"));
        }
        Ok(settings)
    }

    /// That there is as much of something as was said.
    fn counted(
        &self,
        source: Source<'_>,
        key: &str,
        said: Option<(usize, Place)>,
        found: usize,
        what: &str,
    ) -> Result<(), ReadError> {
        match said {
            Some((number, place)) if number != found => {
                let message = format!(
                    "{key} is {number}, but the file has {}",
                    counted(found, what)
                );
                Err(source.error(place, message, "as many as there are"))
            }
            _ => Ok(()),
        }
    }

    fn defuzzifier(&self, source: Source<'_>) -> Result<Defuzzifier, ReadError> {
        let allowed = if self.sugeno { "wtaver" } else { "centroid" };
        let Some(method) = self.defuzzifier else {
            let found = "the system has no DefuzzMethod";
            return Err(source.error(self.place, found, format!("`DefuzzMethod='{allowed}'`")));
        };
        if method.text != allowed {
            let kind = if self.sugeno { "sugeno" } else { "mamdani" };
            let found = format!(
                "the DefuzzMethod {} is not supported in a {kind} system",
                quoted(method.text)
            );
            return Err(source.error(method.place, found, format!("'{allowed}'")));
        }
        Ok(match self.sugeno {
            true => Defuzzifier::WeightedAverage,
            false => Defuzzifier::Centroid {
                points: SAMPLES,
                sampling: Sampling::Ends,
            },
        })
    }

    fn merge(&self, source: Source<'_>) -> Result<Merge, ReadError> {
        match self.aggregation {
            _ if self.sugeno => Ok(Merge::Sum),
            Some(method) => match method.text {
                "max" => Ok(Merge::Max),
                "sum" => Ok(Merge::Sum),
                other => {
                    let found = format!("the AggMethod {} is not supported", quoted(other));
                    Err(source.error(method.place, found, "'max' or 'sum'"))
                }
            },
            None => {
                let found = "the system has no AggMethod";
                Err(source.error(self.place, found, "`AggMethod='max'` or `AggMethod='sum'`"))
            }
        }
    }
}

fn conjunction(method: Token<'_>) -> Norm<'_, Conjunction> {
    match method.text {
        "min" => Norm::Known(Conjunction::Min),
        "prod" => Norm::Known(Conjunction::Product),
        _ => Norm::Other(method),
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

/// Reads a section of a variable.
#[derive(Clone, Copy)]
struct Variable<'s, 'f> {
    source: Source<'s>,
    section: &'f Section<'s>,
    sugeno: bool,
}

/// What the sections of inputs and outputs have in common.
struct Common<'s> {
    name: Token<'s>,
    range: RangeInclusive<f64>,
    terms: Vec<(Token<'s>, Conclusion)>,
}

impl<'s> Variable<'s, '_> {
    fn input(self) -> Result<Input, ReadError> {
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
            range: common.range,
            clamp: false,
            terms: terms.collect(),
            place: common.name.place,
        })
    }

    fn output(self, settings: &Settings<'s>) -> Result<Output, ReadError> {
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

/// Reads rules; notes where AND and OR are first used.
struct Rules<'s, 'v> {
    source: Source<'s>,
    inputs: &'v [Input],
    outputs: &'v [Output],
    and: Option<Place>,
    or: Option<Place>,
}

impl<'s> Rules<'s, '_> {
    /// `1 -2, 1 0 (0.5) : 1`: terms of the inputs, terms of the outputs (0: none; negative: not), the weight, and 1 for
    /// AND or 2 for OR.
    fn rule(&mut self, line: &Line<'s>) -> Result<Rule, ReadError> {
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
