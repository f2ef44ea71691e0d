//! FuzzyLite's language, `.fll`: a property a line, `key: value`, as FuzzyLite 6 and later and pyfuzzylite 8 write it.
//!
//! Where its tools differ or are lenient: a `Centroid` without a number takes 1000 samples (pyfuzzylite's default);
//! parentheses in conditions are read as its tools do, although its documents do not mention them; names with other
//! characters than letters, digits and `_` are refused, not mended; a disabled rule block is left out, a disabled
//! variable refused.

mod write;

use super::checks;
use super::conditions::{Grammar, Names, WrittenRule, rule};
use super::cursor::{Cursor, Parameter};
use super::error::{ReadError, Source, counted, lines, one_of, quoted};
use super::lexer::{Dialect, Kind, Token, lex};
use super::limits;
use super::norms::{ALLOWED_AND, ALLOWED_OR, Norm, Used, concludes_set};
use super::shapes::Family;
use crate::fuzzy::model::{
    Conclusion, Conjunction, Defuzzifier, Input, Merge, Output, OutputTerm, Place, RuleBlock,
    Sampling, Shape, System, Term,
};
pub use write::write;

const DIALECT: Dialect = Dialect {
    signs: &["(", ")"],
    line_comments: &["#"],
    block_comments: &[],
    quotes: false,
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

/// Shapes of terms.
const SHAPES: &[(&str, Family)] = &[
    ("Bell", Family::Bell),
    ("Discrete", Family::Points),
    ("Gaussian", Family::Gaussian),
    ("GaussianProduct", Family::TwoSidedGaussian),
    ("Ramp", Family::Ramp),
    ("Rectangle", Family::Rectangle),
    ("SShape", Family::S),
    ("Sigmoid", Family::Sigmoid),
    ("Trapezoid", Family::Trapezoid),
    ("Triangle", Family::Triangle),
    ("ZShape", Family::Z),
];

/// Shapes that FuzzyLite has and this project does not.
const OTHER_SHAPES: &[&str] = &[
    "Arc",
    "Binary",
    "Concave",
    "Cosine",
    "Function",
    "PiShape",
    "SemiEllipse",
    "SigmoidDifference",
    "SigmoidProduct",
    "Spike",
];
const OTHER_CONJUNCTIONS: &[&str] = &[
    "BoundedDifference",
    "DrasticProduct",
    "EinsteinProduct",
    "HamacherProduct",
    "NilpotentMinimum",
    "TNormFunction",
];
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
const OTHER_ACTIVATIONS: &[&str] = &[
    "First",
    "Highest",
    "Last",
    "Lowest",
    "Proportional",
    "Threshold",
];
const OTHER_DEFUZZIFIERS: &[&str] = &[
    "Bisector",
    "LargestOfMaximum",
    "MeanOfMaximum",
    "SmallestOfMaximum",
    "WeightedSum",
];

/// Reads a system.
pub fn read(source: Source<'_>) -> Result<System, ReadError> {
    let components = components(source)?;
    let mut system = System {
        name: String::new(),
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

    /// The component's name, which must be one.
    fn name(self) -> Result<Token<'s>, ReadError> {
        self.value(
            self.component.head,
            "the end of the line: a name is one word",
            |cursor| cursor.name("a name", RESERVED),
        )
    }

    fn enabled(self) -> Result<(), ReadError> {
        if self.flag("enabled", true)? {
            return Ok(());
        }
        let place = self
            .property("enabled")
            .map_or(self.component.head.place, |p| p.value_place);
        let found = "a disabled variable is not supported";
        Err(self.source.error(
            place,
            found,
            "`enabled: true`, or the file without the variable",
        ))
    }

    fn range(self) -> Result<std::ops::RangeInclusive<f64>, ReadError> {
        let Some(property) = self.property("range") else {
            let found = format!("{} has no range", quoted(self.component.head.value));
            return Err(self
                .source
                .error(self.component.head.place, found, "`range: start end`"));
        };
        let (start, end) = self.value(
            property,
            "the end of the line: a range has two numbers",
            |cursor| {
                Ok((
                    cursor.number("the range's start")?,
                    cursor.number("the range's end")?,
                ))
            },
        )?;
        checks::range(self.source, start, end)
    }

    fn input(self) -> Result<Input, ReadError> {
        self.keys(&["description", "enabled", "range", "lock-range", "term"])?;
        let name = self.name()?;
        self.enabled()?;
        let mut terms: Vec<Term> = Vec::new();
        for (name, conclusion) in self.terms(false)? {
            let Conclusion::Set(shape) = conclusion else {
                continue;
            };
            terms.push(Term {
                name: name.text.to_owned(),
                shape,
                place: name.place,
            });
        }
        Ok(Input {
            name: name.text.to_owned(),
            range: self.range()?,
            clamp: self.flag("lock-range", false)?,
            terms,
            place: name.place,
        })
    }

    fn output(self) -> Result<Output, ReadError> {
        self.keys(&[
            "description",
            "enabled",
            "range",
            "lock-range",
            "aggregation",
            "defuzzifier",
            "default",
            "lock-previous",
            "term",
        ])?;
        let name = self.name()?;
        self.enabled()?;
        if self.flag("lock-previous", false)? {
            let place = self
                .property("lock-previous")
                .map_or(name.place, |p| p.value_place);
            let found = "keeping the previous value is not supported";
            return Err(self.source.error(place, found, "`lock-previous: false`"));
        }
        let defuzzifier = self.defuzzifier()?;
        let default = match self.property("default") {
            None => None,
            Some(property) => {
                let default = self.value(property, "the end of the line", |c| {
                    c.number("a number, or `nan` for none")
                })?;
                if default.value.is_infinite() {
                    let found = format!("the default is {}", default.value);
                    return Err(self.source.error(
                        default.place,
                        found,
                        "a finite number, or `nan` for none",
                    ));
                }
                Some(default.value).filter(|v| !v.is_nan())
            }
        };
        let terms = self.terms(true)?;
        Ok(Output {
            name: name.text.to_owned(),
            range: self.range()?,
            clamp: self.flag("lock-range", false)?,
            default,
            defuzzifier,
            merge: self.merge(defuzzifier)?,
            terms: terms
                .into_iter()
                .map(|(name, conclusion)| OutputTerm {
                    name: name.text.to_owned(),
                    conclusion,
                    place: name.place,
                })
                .collect(),
            place: name.place,
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

    fn merge(self, defuzzifier: Defuzzifier) -> Result<Merge, ReadError> {
        let known = [
            ("Maximum", Some(Merge::Max)),
            ("UnboundedSum", Some(Merge::Sum)),
            ("none", None),
        ];
        let property = self.property("aggregation").filter(|p| !p.value.is_empty());
        let merge = match property {
            None => None,
            Some(property) => self.value(property, "the end of the line", |cursor| {
                self.operator(cursor, "aggregation", &known, OTHER_DISJUNCTIONS)
            })?,
        };
        match (merge, defuzzifier) {
            (Some(merge), _) => Ok(merge),
            // FuzzyLite adds the degrees then.
            (None, Defuzzifier::WeightedAverage) => Ok(Merge::Sum),
            (None, Defuzzifier::Centroid { .. }) => {
                let place = property.map_or(self.component.head.place, |p| p.value_place);
                let found = "a centroid without an aggregation";
                Err(self.source.error(place, found, "Maximum or UnboundedSum"))
            }
        }
    }

    fn defuzzifier(self) -> Result<Defuzzifier, ReadError> {
        let property = self
            .property("defuzzifier")
            .filter(|p| !matches!(p.value, "" | "none"));
        let Some(property) = property else {
            let place = self
                .property("defuzzifier")
                .map_or(self.component.head.place, |p| p.place);
            let found = format!("{} has no defuzzifier", quoted(self.component.head.value));
            let allowed = "`defuzzifier: Centroid samples` or `defuzzifier: WeightedAverage`";
            return Err(self.source.error(place, found, allowed));
        };
        self.value(property, "the end of the line", |cursor| {
            let known = [("Centroid", true), ("WeightedAverage", false)];
            if !self.operator(cursor, "defuzzifier", &known, OTHER_DEFUZZIFIERS)? {
                if cursor.peek().kind != Kind::End {
                    let kinds = [("TakagiSugeno", true), ("Automatic", true)];
                    self.operator(cursor, "kind of weighted average", &kinds, &["Tsukamoto"])?;
                }
                return Ok(Defuzzifier::WeightedAverage);
            }
            let points = match cursor.at_number() {
                false => DEFAULT_SAMPLES,
                true => {
                    let number = cursor.number("a number of samples")?;
                    checks::samples(self.source, number)?
                }
            };
            Ok(Defuzzifier::Centroid {
                points,
                sampling: Sampling::Middles,
            })
        })
    }

    fn terms(self, output: bool) -> Result<Vec<(Token<'s>, Conclusion)>, ReadError> {
        let mut all: Vec<(Token<'s>, Conclusion)> = Vec::new();
        for property in self.component.properties.iter().filter(|p| p.key == "term") {
            let (name, conclusion) =
                self.value(*property, "a number, or the end of the line", |c| {
                    self.term(c, output)
                })?;
            let earlier = all.iter().map(|(n, _)| (n.text, n.place));
            checks::unique(self.source, "the term", name.text, name.place, earlier)?;
            all.push((name, conclusion));
            checks::count(self.source, name.place, "terms", all.len(), limits::TERMS)?;
        }
        Ok(all)
    }

    fn term(
        self,
        cursor: &mut Cursor<'s, '_>,
        output: bool,
    ) -> Result<(Token<'s>, Conclusion), ReadError> {
        let mut words = RESERVED.to_vec();
        words.extend(HEDGES);
        let name = cursor.name("a term's name", &words)?;
        let shape = cursor.peek();
        let (constant, linear) = (shape.text == "Constant", shape.text == "Linear");
        if !output && (constant || linear) {
            let found = format!("{} is for outputs", quoted(shape.text));
            return Err(self.source.error(shape.place, found, shapes_allowed(false)));
        }
        if OTHER_SHAPES.contains(&shape.text) {
            let found = format!("the shape {} is not supported", quoted(shape.text));
            return Err(self
                .source
                .error(shape.place, found, shapes_allowed(output)));
        }
        let family = SHAPES
            .iter()
            .find(|(name, _)| *name == shape.text)
            .map(|s| s.1);
        if family.is_none() && !constant && !linear {
            return Err(cursor.unexpected(shapes_allowed(output)));
        }
        cursor.take();
        let mut numbers = Vec::new();
        while cursor.at_number() {
            numbers.push(cursor.number("a number")?);
            checks::count(
                self.source,
                shape.place,
                "numbers",
                numbers.len(),
                2 * limits::POINTS + 1,
            )?;
        }
        // What stops the numbers is named before their count is.
        cursor.end("a number, or the end of the line")?;
        let conclusion = match family {
            Some(family) => {
                self.height(family, &mut numbers)?;
                Conclusion::Set(family.shape(self.source, shape, &numbers, &[])?)
            }
            None => self.number_conclusion(shape, constant, &numbers)?,
        };
        Ok((name, conclusion))
    }

    /// Takes a height, which may follow the numbers of a shape, away if it is one.
    fn height(self, family: Family, numbers: &mut Vec<Parameter>) -> Result<(), ReadError> {
        let extra = match family {
            Family::Points => numbers.len() % 2 == 1,
            _ => numbers.len() == family.numbers().len() + 1,
        };
        let Some(height) = numbers.last().filter(|_| extra) else {
            return Ok(());
        };
        if height.value == 1.0 {
            numbers.pop();
            return Ok(());
        }
        let found = format!("a term with the height {} is not supported", height.value);
        Err(self
            .source
            .error(height.place, found, "the height 1, or none"))
    }

    fn number_conclusion(
        self,
        name: Token<'s>,
        constant: bool,
        numbers: &[Parameter],
    ) -> Result<Conclusion, ReadError> {
        if let Some(bad) = numbers.iter().find(|p| !p.value.is_finite()) {
            let found = format!("{} is not finite", bad.value);
            return Err(self.source.error(bad.place, found, "a finite number"));
        }
        match (constant, numbers) {
            (true, [value]) => Ok(Conclusion::Constant(value.value)),
            (false, [coefficients @ .., constant]) => Ok(Conclusion::Linear {
                coefficients: coefficients.iter().map(|p| p.value).collect(),
                constant: constant.value,
            }),
            _ => {
                let found = format!(
                    "{} has {}",
                    quoted(name.text),
                    counted(numbers.len(), "number")
                );
                let allowed = match constant {
                    true => "1: the value",
                    false => "a number for each input, and the constant",
                };
                Err(self.source.error(name.place, found, allowed))
            }
        }
    }

    /// A rule block, if it is enabled.
    fn block(self) -> Result<Option<WrittenBlock<'s>>, ReadError> {
        self.keys(&[
            "description",
            "enabled",
            "conjunction",
            "disjunction",
            "implication",
            "activation",
            "rule",
        ])?;
        let enabled = self.flag("enabled", true)?;
        if let Some(property) = self.property("activation").filter(|p| !p.value.is_empty()) {
            self.value(property, "the end of the line", |cursor| {
                let known = [("General", ()), ("none", ())];
                self.operator(cursor, "activation", &known, OTHER_ACTIVATIONS)
            })?;
        }
        let mut rules = Vec::new();
        for property in self.component.properties.iter().filter(|p| p.key == "rule") {
            rules.push(self.value(*property, "", |cursor| {
                let rule = rule(cursor, self.source, &GRAMMAR)?;
                cursor.end(match rule.weight {
                    Some(_) => "the end of the line",
                    None => "`and`, `with` or the end of the line",
                })?;
                Ok(rule)
            })?);
            checks::count(
                self.source,
                property.place,
                "rules",
                rules.len(),
                limits::RULES,
            )?;
        }
        let block = WrittenBlock {
            name: self.component.head.value,
            and: self.norm("conjunction", CONJUNCTIONS, OTHER_CONJUNCTIONS)?,
            or: self.norm("disjunction", &[("Maximum", ())], OTHER_DISJUNCTIONS)?,
            implication: self.norm("implication", CONJUNCTIONS, OTHER_CONJUNCTIONS)?,
            rules,
        };
        Ok(enabled.then_some(block))
    }

    /// An operator that may be none. One that is not supported matters only where it is used.
    fn norm<T: Copy>(
        self,
        key: &'static str,
        known: &[(&str, T)],
        others: &[&str],
    ) -> Result<Norm<'s, T>, ReadError> {
        let Some(property) = self.property(key).filter(|p| !p.value.is_empty()) else {
            return Ok(Norm::None);
        };
        self.value(property, "the end of the line", |cursor| {
            let token = cursor.peek();
            if cursor.eat_word("none") {
                return Ok(Norm::None);
            }
            if others.contains(&token.text) {
                cursor.take();
                return Ok(Norm::Other(token));
            }
            let mut allowed: Vec<&str> = known.iter().map(|(k, _)| *k).collect();
            allowed.push("none");
            match cursor.choice("", known) {
                Ok((_, norm)) => Ok(Norm::Known(norm)),
                Err(_) => Err(cursor.unexpected(one_of(allowed))),
            }
        })
    }
}

const CONJUNCTIONS: &[(&str, Conjunction)] = &[
    ("Minimum", Conjunction::Min),
    ("AlgebraicProduct", Conjunction::Product),
];

struct WrittenBlock<'s> {
    name: &'s str,
    and: Norm<'s, Conjunction>,
    or: Norm<'s, ()>,
    implication: Norm<'s, Conjunction>,
    rules: Vec<WrittenRule<'s>>,
}

impl WrittenBlock<'_> {
    fn resolve(&self, source: Source<'_>, system: &System) -> Result<RuleBlock, ReadError> {
        let used = Used::by(&self.rules);
        let and = self
            .and
            .used(source, "conjunction", used.and, ALLOWED_AND)?;
        self.or.used(source, "disjunction", used.or, ALLOWED_OR)?;
        let and = and.unwrap_or(Conjunction::Min);
        let names = Names {
            inputs: &system.inputs,
            outputs: &system.outputs,
        };
        let rules = self
            .rules
            .iter()
            .map(|rule| rule.resolve(source, names, and))
            .collect::<Result<Vec<_>, _>>()?;
        let set = concludes_set(&rules, &system.outputs);
        let implication = self
            .implication
            .used(source, "implication", set, ALLOWED_AND)?;
        Ok(RuleBlock {
            name: self.name.to_owned(),
            and,
            implication: implication.unwrap_or(Conjunction::Min),
            rules,
        })
    }
}

fn shapes_allowed(output: bool) -> String {
    let names = SHAPES.iter().map(|(name, _)| *name);
    let more: &[&str] = if output { &["Constant", "Linear"] } else { &[] };
    one_of(names.chain(more.iter().copied()))
}

/// FLL's name of a shape and its numbers.
fn written(shape: &Shape) -> (&'static str, Vec<f64>) {
    match *shape {
        Shape::Triangle { left, peak, right } => ("Triangle", vec![left, peak, right]),
        Shape::Trapezoid {
            left,
            rise,
            fall,
            right,
        } => ("Trapezoid", vec![left, rise, fall, right]),
        Shape::Ramp { from, to } => ("Ramp", vec![from, to]),
        Shape::Singleton(x) => ("Rectangle", vec![x, x]),
        Shape::Points(ref points) => (
            "Discrete",
            points.iter().flat_map(|&(x, y)| [x, y]).collect(),
        ),
        Shape::Gaussian { mean, deviation } => ("Gaussian", vec![mean, deviation]),
        Shape::TwoSidedGaussian { left, right } => {
            ("GaussianProduct", vec![left.0, left.1, right.0, right.1])
        }
        Shape::Bell {
            centre,
            width,
            slope,
        } => ("Bell", vec![centre, width, slope]),
        Shape::Sigmoid { inflection, slope } => ("Sigmoid", vec![inflection, slope]),
        Shape::Spline { from, to } if from < to => ("SShape", vec![from, to]),
        Shape::Spline { from, to } => ("ZShape", vec![to, from]),
    }
}
