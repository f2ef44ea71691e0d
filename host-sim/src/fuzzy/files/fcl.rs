//! IEC 61131-7's fuzzy control language, `.fcl`, as jFuzzyLogic and FuzzyLite speak it: beside the norm's points and
//! singletons jFuzzyLogic's shapes (`TRIAN`, `GAUSS`…), and FuzzyLite's names for them, ranges of inputs, `LOCK : RANGE`
//! and rules without a semicolon.
//!
//! What the language leaves unsaid:
//!
//! * A variable without a `RANGE` spans its terms; curves have no end, so they need one.
//! * `METHOD : COG` is a centroid over 1000 samples in the middles of equal pieces; a comment on the same line says
//!   otherwise: `// samples: 101 ends`, or `middles`. Other tools pass over it.
//! * AND binds tighter than OR, as the norm has it. jFuzzyLogic takes them as they come: the writer puts parentheses.
//! * OR is what AND pairs with: without an `OR`, MAX if AND is MIN. With `AND : PROD` it must be said.
//! * Without an `ACT`, MIN. Without an `ACCU`, MAX for `COG`; for `COGS` tools disagree, so it must be said where a term
//!   is concluded twice.

mod write;

use super::checks;
use super::conditions::{Grammar, Names, WrittenRule, rule};
use super::cursor::{Cursor, Parameter};
use super::error::{ReadError, Source, one_of, quoted};
use super::lexer::{Dialect, Kind, Note, Token, lex};
use super::limits;
use super::norms::{Norm, Used};
use super::shapes::{Family, extent};
use crate::fuzzy::model::{
    Conclusion, Conjunction, Defuzzifier, Input, Merge, Output, OutputTerm, Place, RuleBlock,
    Sampling, Shape, System, Term,
};
use std::ops::RangeInclusive;
pub use write::write;

const DIALECT: Dialect = Dialect {
    signs: &[":=", "..", "(", ")", ",", ":", ";"],
    line_comments: &["//"],
    block_comments: &[("(*", "*)"), ("/*", "*/")],
    quotes: false,
};

const GRAMMAR: Grammar = Grammar {
    reserved: RESERVED,
    hedges: &[],
    leading_not: true,
    comma: true,
};

/// Words that no name may be.
const RESERVED: &[&str] = &[
    "if",
    "is",
    "and",
    "or",
    "then",
    "with",
    "not",
    "end_function_block",
    "end_fuzzify",
    "end_defuzzify",
    "end_ruleblock",
    "end_var",
    "rule",
    "term",
];

/// jFuzzyLogic's other words, which it takes for no name. Only the writer minds.
const WORDS: &[&str] = &[
    "abs",
    "accu",
    "act",
    "asum",
    "bdif",
    "bsum",
    "coa",
    "cog",
    "cogf",
    "cogs",
    "cos",
    "cosine",
    "default",
    "defuzzify",
    "dmax",
    "dmin",
    "dsigm",
    "einstein",
    "exp",
    "function",
    "function_block",
    "fuzzify",
    "gauss",
    "gauss2",
    "gbell",
    "hamacher",
    "lm",
    "ln",
    "lock",
    "log",
    "max",
    "method",
    "min",
    "mm",
    "nc",
    "nipmax",
    "nipmin",
    "nsum",
    "probor",
    "prod",
    "range",
    "real",
    "rm",
    "ruleblock",
    "sigm",
    "sin",
    "singletons",
    "sum",
    "tan",
    "trape",
    "trian",
    "var_input",
    "var_output",
];

/// What no name may be in a file that is written.
pub const RESERVED_NAMES: &[&[&str]] = &[RESERVED, WORDS];

/// Samples of a centroid of which nothing else is said.
pub const DEFAULT_SAMPLES: usize = 1000;
/// Begins the comment that says it.
const SAMPLES_NOTE: &str = "samples:";

/// Shapes, and where each of a [`Family`]'s numbers stands among theirs.
const SHAPES: &[(&str, Family, &[usize])] = &[
    ("TRIAN", Family::Triangle, &[]),
    ("TRAPE", Family::Trapezoid, &[]),
    ("GAUSS", Family::Gaussian, &[]),
    ("GAUSS2", Family::TwoSidedGaussian, &[]),
    ("GBELL", Family::Bell, &[2, 0, 1]),
    ("SIGM", Family::Sigmoid, &[1, 0]),
    // FuzzyLite's.
    ("Bell", Family::Bell, &[]),
    ("Gaussian", Family::Gaussian, &[]),
    ("GaussianProduct", Family::TwoSidedGaussian, &[]),
    ("Ramp", Family::Ramp, &[]),
    ("Rectangle", Family::Rectangle, &[]),
    ("SShape", Family::S, &[]),
    ("Sigmoid", Family::Sigmoid, &[]),
    ("Trapezoid", Family::Trapezoid, &[]),
    ("Triangle", Family::Triangle, &[]),
    ("ZShape", Family::Z, &[]),
];

/// Shapes that tools have and this project does not.
const OTHER_SHAPES: &[&str] = &[
    "COSINE",
    "DSIGM",
    "FUNCTION",
    "SINGLETONS",
    "Linear",
    "Concave",
    "PiShape",
    "SigmoidDifference",
    "SigmoidProduct",
    "Spike",
];

/// Reads a system.
pub fn read(source: Source<'_>) -> Result<System, ReadError> {
    let (tokens, notes) = lex(source.text, Place { line: 1, column: 1 }, &DIALECT);
    let cursor = Cursor::new(source, &tokens, "the file");
    let mut reader = Reader {
        source,
        cursor,
        notes: &notes,
        name: String::new(),
        declared: Vec::new(),
        fuzzified: Vec::new(),
        defuzzified: Vec::new(),
        blocks: Vec::new(),
    };
    reader.function_block()?;
    let end = reader.cursor.peek().place;
    reader.system(end)
}

/// A range that may be given.
type Range = Option<RangeInclusive<f64>>;

struct Declared<'s> {
    name: Token<'s>,
    output: bool,
    range: Range,
}

struct Fuzzified<'s> {
    name: Token<'s>,
    range: Range,
    clamp: bool,
    terms: Vec<(Token<'s>, Conclusion)>,
}

struct Defuzzified<'s> {
    variable: Fuzzified<'s>,
    method: Option<Defuzzifier>,
    merge: Option<Merge>,
    default: Option<f64>,
}

struct WrittenBlock<'s> {
    name: &'s str,
    enabled: bool,
    and: Norm<'s, Conjunction>,
    or: Norm<'s, ()>,
    implication: Conjunction,
    merge: Option<(Merge, Place)>,
    rules: Vec<WrittenRule<'s>>,
}

struct Reader<'s, 't> {
    source: Source<'s>,
    cursor: Cursor<'s, 't>,
    notes: &'t [Note<'s>],
    name: String,
    declared: Vec<Declared<'s>>,
    fuzzified: Vec<Fuzzified<'s>>,
    defuzzified: Vec<Defuzzified<'s>>,
    blocks: Vec<WrittenBlock<'s>>,
}

/// Parts of a function block.
const PARTS: [&str; 6] = [
    "VAR_INPUT",
    "VAR_OUTPUT",
    "FUZZIFY",
    "DEFUZZIFY",
    "RULEBLOCK",
    "END_FUNCTION_BLOCK",
];
/// Parts that the norm has and this project does not.
const OTHER_PARTS: [&str; 4] = ["VAR", "VAR_IN_OUT", "OPTION", "STRUCT"];
/// What a rule block says.
const BLOCK_ITEMS: [&str; 7] = [
    "AND",
    "OR",
    "ACT",
    "ACCU",
    "ENABLED",
    "RULE",
    "END_RULEBLOCK",
];

impl<'s> Reader<'s, '_> {
    fn function_block(&mut self) -> Result<(), ReadError> {
        self.cursor.word("FUNCTION_BLOCK")?;
        let at_part = PARTS.iter().any(|p| self.cursor.at_word(p));
        if self.cursor.peek().kind == Kind::Word && !at_part {
            self.name = self.cursor.name("a name", RESERVED)?.text.to_owned();
        }
        loop {
            let token = self.cursor.peek();
            if OTHER_PARTS.iter().any(|p| self.cursor.at_word(p)) {
                let found = format!("{} is not supported", quoted(token.text));
                return Err(self.source.error(token.place, found, one_of(PARTS)));
            }
            let choices: Vec<(&str, usize)> = PARTS.iter().copied().zip(0..).collect();
            match self.cursor.choice("", &choices)?.1 {
                0 => self.declarations(false)?,
                1 => self.declarations(true)?,
                2 => self.fuzzify()?,
                3 => self.defuzzify()?,
                4 => self.rule_block()?,
                _ => break,
            }
        }
        if self.cursor.at_word("FUNCTION_BLOCK") {
            let place = self.cursor.peek().place;
            let found = "a second function block is not supported";
            return Err(self.source.error(place, found, "one a file"));
        }
        self.cursor.end("the end of the file")
    }

    fn declarations(&mut self, output: bool) -> Result<(), ReadError> {
        while !self.cursor.eat_word("END_VAR") {
            if self.cursor.at_word("RANGE")
                && let Some(last) = self.declared.last()
                && last.range.is_none()
            {
                let range = self.range()?;
                if let Some(last) = self.declared.last_mut() {
                    last.range = Some(range);
                }
                continue;
            }
            let name = self
                .cursor
                .name("a variable's name or `END_VAR`", RESERVED)?;
            let earlier = self.declared.iter().map(|d| (d.name.text, d.name.place));
            checks::unique(self.source, "the variable", name.text, name.place, earlier)?;
            self.cursor.sign(":")?;
            self.cursor.word("REAL")?;
            self.cursor.sign(";")?;
            self.declared.push(Declared {
                name,
                output,
                range: None,
            });
            let most = limits::INPUTS + limits::OUTPUTS;
            checks::count(
                self.source,
                name.place,
                "variables",
                self.declared.len(),
                most,
            )?;
        }
        Ok(())
    }

    /// `RANGE := (start .. end);`, the norm's without `:=`.
    fn range(&mut self) -> Result<RangeInclusive<f64>, ReadError> {
        self.cursor.word("RANGE")?;
        self.cursor.eat_sign(":=");
        self.cursor.sign("(")?;
        let start = self.cursor.number("the range's start")?;
        self.cursor.sign("..")?;
        let end = self.cursor.number("the range's end")?;
        self.cursor.sign(")")?;
        self.cursor.sign(";")?;
        checks::range(self.source, start, end)
    }

    /// The name of a declared variable, behind FUZZIFY or DEFUZZIFY.
    fn declared_name(&mut self, output: bool) -> Result<Token<'s>, ReadError> {
        let name = self.cursor.name("a variable's name", RESERVED)?;
        let what = if output { "output" } else { "input" };
        let known = self.declared.iter().filter(|d| d.output == output);
        if !known.clone().any(|d| d.name.text == name.text) {
            let found = format!("{} is no declared {what}", quoted(name.text));
            let allowed = one_of(known.map(|d| d.name.text));
            return Err(self.source.error(name.place, found, allowed));
        }
        Ok(name)
    }

    fn fuzzify(&mut self) -> Result<(), ReadError> {
        let name = self.declared_name(false)?;
        let earlier = self.fuzzified.iter().map(|f| (f.name.text, f.name.place));
        checks::unique(self.source, "FUZZIFY", name.text, name.place, earlier)?;
        let mut variable = Fuzzified::new(name);
        loop {
            let items = [
                ("TERM", 0),
                ("RANGE", 1),
                ("LOCK", 2),
                ("ENABLED", 3),
                ("END_FUZZIFY", 4),
            ];
            match self.item(&items)? {
                4 => break,
                item => self.variable_item(item, &mut variable, false)?,
            }
        }
        self.fuzzified.push(variable);
        Ok(())
    }

    /// Which item comes next; the cursor stays before it unless it is the last of the choices.
    fn item(&mut self, items: &[(&str, usize)]) -> Result<usize, ReadError> {
        let before = self.cursor;
        let (_, item) = self.cursor.choice("", items)?;
        if items.last().is_none_or(|last| last.1 != item) {
            self.cursor = before;
        }
        Ok(item)
    }

    /// What inputs and outputs have in common.
    fn variable_item(
        &mut self,
        item: usize,
        variable: &mut Fuzzified<'s>,
        output: bool,
    ) -> Result<(), ReadError> {
        let token = self.cursor.peek();
        match item {
            0 => {
                self.cursor.take();
                let (name, conclusion) = self.term(output)?;
                let earlier = variable.terms.iter().map(|(n, _)| (n.text, n.place));
                checks::unique(self.source, "the term", name.text, name.place, earlier)?;
                variable.terms.push((name, conclusion));
                checks::count(
                    self.source,
                    name.place,
                    "terms",
                    variable.terms.len(),
                    limits::TERMS,
                )
            }
            1 => {
                let range = self.range()?;
                self.once(token, variable.range.is_some())?;
                variable.range = Some(range);
                Ok(())
            }
            2 => {
                self.cursor.take();
                self.cursor.sign(":")?;
                let place = self.cursor.peek().place;
                if self.cursor.at_word("PREVIOUS") {
                    let found = "keeping the previous value is not supported";
                    return Err(self.source.error(place, found, "RANGE"));
                }
                self.cursor.word("RANGE")?;
                self.cursor.sign(";")?;
                variable.clamp = true;
                Ok(())
            }
            _ => {
                let place = self.cursor.peek().place;
                match self.enabled()? {
                    true => Ok(()),
                    false => Err(self.source.error(
                        place,
                        "a disabled variable is not supported",
                        "the file without the variable",
                    )),
                }
            }
        }
    }

    fn once(&self, token: Token<'s>, again: bool) -> Result<(), ReadError> {
        match again {
            false => Ok(()),
            true => {
                let found = format!("{} is given twice", quoted(token.text));
                Err(self.source.error(token.place, found, "each once"))
            }
        }
    }

    fn enabled(&mut self) -> Result<bool, ReadError> {
        self.cursor.word("ENABLED")?;
        self.cursor.sign(":")?;
        let (_, enabled) = self
            .cursor
            .choice("", &[("TRUE", true), ("FALSE", false)])?;
        self.cursor.sign(";")?;
        Ok(enabled)
    }

    /// `name := membership;`
    fn term(&mut self, output: bool) -> Result<(Token<'s>, Conclusion), ReadError> {
        let source = self.source;
        let name = self.cursor.name("a term's name", RESERVED)?;
        self.cursor.sign(":=")?;
        let token = self.cursor.peek();
        let conclusion = if self.cursor.at_sign("(") {
            let points = self.points()?;
            Conclusion::Set(Family::Points.shape(source, token, &points, &[])?)
        } else if self.cursor.at_number() {
            let value = self.cursor.finite("a finite number")?.value;
            match output {
                true => Conclusion::Constant(value),
                false => Conclusion::Set(Shape::Singleton(value)),
            }
        } else {
            let names = SHAPES.iter().map(|(name, ..)| *name);
            let allowed = format!("a number, points `(x, degree) …` or {}", one_of(names));
            if OTHER_SHAPES.iter().any(|s| self.cursor.at_word(s)) {
                let found = format!("the shape {} is not supported", quoted(token.text));
                return Err(source.error(token.place, found, allowed));
            }
            let Some((_, family, order)) = SHAPES.iter().find(|(n, ..)| self.cursor.at_word(n))
            else {
                return Err(self.cursor.unexpected(allowed));
            };
            self.cursor.take();
            let mut numbers = Vec::new();
            while self.cursor.at_number() {
                numbers.push(self.cursor.number("a number")?);
                checks::count(
                    source,
                    token.place,
                    "numbers",
                    numbers.len(),
                    limits::POINTS,
                )?;
            }
            if !self.cursor.at_sign(";") {
                return Err(self.cursor.unexpected("a number or `;`"));
            }
            Conclusion::Set(family.shape(source, token, &numbers, order)?)
        };
        if !self.cursor.at_sign(";") {
            let more = if token.text == "(" {
                "`(x, degree)` or `;`"
            } else {
                "`;`"
            };
            return Err(self.cursor.unexpected(more));
        }
        self.cursor.take();
        Ok((name, conclusion))
    }

    fn points(&mut self) -> Result<Vec<Parameter>, ReadError> {
        let mut all = Vec::new();
        while self.cursor.at_sign("(") {
            let place = self.cursor.take().place;
            all.push(self.cursor.number("a point's x")?);
            self.cursor.sign(",")?;
            all.push(self.cursor.number("a point's degree")?);
            self.cursor.sign(")")?;
            checks::count(self.source, place, "points", all.len() / 2, limits::POINTS)?;
        }
        Ok(all)
    }

    fn defuzzify(&mut self) -> Result<(), ReadError> {
        let name = self.declared_name(true)?;
        let earlier = self
            .defuzzified
            .iter()
            .map(|f| (f.variable.name.text, f.variable.name.place));
        checks::unique(self.source, "DEFUZZIFY", name.text, name.place, earlier)?;
        let mut output = Defuzzified {
            variable: Fuzzified::new(name),
            method: None,
            merge: None,
            default: None,
        };
        let mut defaulted = false;
        loop {
            let items = [
                ("TERM", 0),
                ("RANGE", 1),
                ("LOCK", 2),
                ("ENABLED", 3),
                ("METHOD", 4),
                ("ACCU", 5),
                ("DEFAULT", 6),
                ("END_DEFUZZIFY", 7),
            ];
            let token = self.cursor.peek();
            match self.item(&items)? {
                4 => {
                    let method = self.method()?;
                    self.once(token, output.method.is_some())?;
                    output.method = Some(method);
                }
                5 => {
                    let (merge, _) = self.accumulation()?;
                    self.once(token, output.merge.is_some())?;
                    output.merge = merge;
                }
                6 => {
                    self.once(token, defaulted)?;
                    defaulted = true;
                    output.default = self.default()?;
                }
                7 => break,
                item => self.variable_item(item, &mut output.variable, true)?,
            }
        }
        self.defuzzified.push(output);
        Ok(())
    }

    fn method(&mut self) -> Result<Defuzzifier, ReadError> {
        let line = self.cursor.word("METHOD")?.place.line;
        self.cursor.sign(":")?;
        let token = self.cursor.peek();
        if ["COA", "COGF", "COGSS", "LM", "MM", "RM"]
            .iter()
            .any(|m| self.cursor.at_word(m))
        {
            let found = format!("the method {} is not supported", quoted(token.text));
            return Err(self.source.error(token.place, found, "COG or COGS"));
        }
        let (_, centroid) = self.cursor.choice("", &[("COG", true), ("COGS", false)])?;
        self.cursor.sign(";")?;
        if !centroid {
            return Ok(Defuzzifier::WeightedAverage);
        }
        let (points, sampling) = self.samples(line)?;
        Ok(Defuzzifier::Centroid { points, sampling })
    }

    /// What a comment on the line says of a centroid's samples.
    fn samples(&self, line: usize) -> Result<(usize, Sampling), ReadError> {
        let begins = |text: &str| {
            text.trim_start_matches('/')
                .trim_start()
                .starts_with(SAMPLES_NOTE)
        };
        let note = self
            .notes
            .iter()
            .find(|(text, place)| place.line == line && begins(text));
        let Some(&(text, mut place)) = note else {
            return Ok((DEFAULT_SAMPLES, Sampling::Middles));
        };
        let skipped = text.find(SAMPLES_NOTE).unwrap_or_default() + SAMPLES_NOTE.len();
        place.column += text[..skipped].chars().count();
        let (tokens, _) = lex(&text[skipped..], place, &DIALECT);
        let mut cursor = Cursor::new(self.source, &tokens, "the comment");
        let points = checks::samples(self.source, cursor.number("a number of samples")?)?;
        let sampling = [("middles", Sampling::Middles), ("ends", Sampling::Ends)];
        let (_, sampling) = cursor.choice("", &sampling)?;
        cursor.end("the end of the comment")?;
        Ok((points, sampling))
    }

    /// None, FuzzyLite's word, says nothing.
    fn accumulation(&mut self) -> Result<(Option<Merge>, Place), ReadError> {
        self.cursor.word("ACCU")?;
        self.cursor.sign(":")?;
        let token = self.cursor.peek();
        let others = [
            "ASUM", "BSUM", "DSUM", "ESUM", "HSUM", "NMAX", "NSUM", "PROBOR",
        ];
        if others.iter().any(|m| self.cursor.at_word(m)) {
            let found = format!("the accumulation {} is not supported", quoted(token.text));
            return Err(self.source.error(token.place, found, "MAX or SUM"));
        }
        let known = [
            ("MAX", Some(Merge::Max)),
            ("SUM", Some(Merge::Sum)),
            ("UnboundedSum", Some(Merge::Sum)),
            ("NONE", None),
        ];
        let (token, merge) = self.cursor.choice("", &known)?;
        self.cursor.sign(";")?;
        Ok((merge, token.place))
    }

    fn default(&mut self) -> Result<Option<f64>, ReadError> {
        self.cursor.word("DEFAULT")?;
        self.cursor.sign(":=")?;
        let token = self.cursor.peek();
        if self.cursor.at_word("NC") {
            let found = "keeping the previous value, NC, is not supported";
            return Err(self
                .source
                .error(token.place, found, "a number, or no DEFAULT"));
        }
        let default = self.cursor.number("a number")?;
        if default.value.is_infinite() {
            let found = format!("the default is {}", default.value);
            return Err(self.source.error(default.place, found, "a finite number"));
        }
        if self.cursor.peek().text == "|" {
            let found = "keeping the previous value is not supported";
            return Err(self.source.error(self.cursor.peek().place, found, "`;`"));
        }
        self.cursor.sign(";")?;
        Ok(Some(default.value).filter(|v| !v.is_nan()))
    }

    fn rule_block(&mut self) -> Result<(), ReadError> {
        let start = self.cursor.peek().place;
        let at_item = BLOCK_ITEMS.iter().any(|i| self.cursor.at_word(i));
        let name = match self.cursor.peek().kind {
            Kind::Word if !at_item => self.cursor.name("a name", RESERVED)?.text,
            _ => "",
        };
        let mut block = WrittenBlock {
            name,
            enabled: true,
            and: Norm::None,
            or: Norm::None,
            implication: Conjunction::Min,
            merge: None,
            rules: Vec::new(),
        };
        let (mut and, mut or, mut act) = (false, false, false);
        loop {
            let items: Vec<(&str, usize)> = BLOCK_ITEMS.iter().copied().zip(0..).collect();
            let token = self.cursor.peek();
            match self.item(&items)? {
                0 => {
                    self.once(token, std::mem::replace(&mut and, true))?;
                    let others = [
                        "BDIF", "DMIN", "DPROD", "EPROD", "HAMACHER", "HPROD", "NIPMIN", "NMIN",
                    ];
                    block.and = self.norm(CONJUNCTIONS, &others)?;
                }
                1 => {
                    self.once(token, std::mem::replace(&mut or, true))?;
                    let others = [
                        "ASUM", "BSUM", "DMAX", "DSUM", "EINSTEIN", "ESUM", "HSUM", "NIPMAX",
                        "NMAX", "NSUM",
                    ];
                    block.or = self.norm(&[("MAX", ())], &others)?;
                }
                2 => {
                    self.once(token, std::mem::replace(&mut act, true))?;
                    self.cursor.take();
                    self.cursor.sign(":")?;
                    block.implication = self.cursor.choice("", CONJUNCTIONS)?.1;
                    self.cursor.sign(";")?;
                }
                3 => {
                    self.once(token, block.merge.is_some())?;
                    let (merge, place) = self.accumulation()?;
                    block.merge = merge.map(|m| (m, place));
                }
                4 => block.enabled = self.enabled()?,
                5 => {
                    block.rules.push(self.rule()?);
                    checks::count(
                        self.source,
                        token.place,
                        "rules",
                        block.rules.len(),
                        limits::RULES,
                    )?;
                }
                _ => break,
            }
        }
        self.blocks.push(block);
        checks::count(
            self.source,
            start,
            "rule blocks",
            self.blocks.len(),
            limits::BLOCKS,
        )
    }

    /// An operator that may be none.
    fn norm<T: Copy>(
        &mut self,
        known: &[(&str, T)],
        others: &[&str],
    ) -> Result<Norm<'s, T>, ReadError> {
        self.cursor.take();
        self.cursor.sign(":")?;
        let norm = if self.cursor.eat_word("NONE") {
            Norm::None
        } else if others.iter().any(|o| self.cursor.at_word(o)) {
            Norm::Other(self.cursor.take())
        } else {
            Norm::Known(self.cursor.choice("", known)?.1)
        };
        self.cursor.sign(";")?;
        Ok(norm)
    }

    fn rule(&mut self) -> Result<WrittenRule<'s>, ReadError> {
        self.cursor.word("RULE")?;
        match self.cursor.peek().kind {
            Kind::Word | Kind::Number(_) => {
                self.cursor.take();
            }
            _ => return Err(self.cursor.unexpected("a rule's number or name")),
        }
        self.cursor.sign(":")?;
        let rule = rule(&mut self.cursor, self.source, &GRAMMAR)?;
        // FuzzyLite ends rules with the line.
        let ends = self.cursor.at_word("RULE") || self.cursor.at_word("END_RULEBLOCK");
        if !self.cursor.eat_sign(";") && !ends {
            let allowed = match rule.weight {
                Some(_) => "`;`",
                None => "`,`, `with` or `;`",
            };
            return Err(self.cursor.unexpected(allowed));
        }
        Ok(rule)
    }

    /// Puts together what was read.
    fn system(self, end: Place) -> Result<System, ReadError> {
        let source = self.source;
        let (mut inputs, mut outputs) = (Vec::new(), Vec::new());
        let mut merges = Vec::new();
        let mut defuzzified = self.defuzzified;
        let mut fuzzified = self.fuzzified;
        for declared in self.declared {
            let name = declared.name;
            let part = if declared.output {
                "DEFUZZIFY"
            } else {
                "FUZZIFY"
            };
            let missing = || {
                let found = format!("{} has no {part} block", quoted(name.text));
                source.error(
                    name.place,
                    found,
                    format!("`{part} {}` … `END_{part}`", name.text),
                )
            };
            if declared.output {
                let at = defuzzified
                    .iter()
                    .position(|d| d.variable.name.text == name.text);
                let block = defuzzified.swap_remove(at.ok_or_else(missing)?);
                let Some(defuzzifier) = block.method else {
                    let found = format!("the output {} has no method", quoted(name.text));
                    return Err(source.error(
                        block.variable.name.place,
                        found,
                        "`METHOD : COG;` or `METHOD : COGS;`",
                    ));
                };
                let range = block.variable.range(source, declared.range)?;
                merges.push(block.merge);
                outputs.push(Output {
                    name: name.text.to_owned(),
                    range,
                    clamp: block.variable.clamp,
                    default: block.default,
                    defuzzifier,
                    merge: block.merge.unwrap_or(Merge::Max),
                    terms: block.variable.output_terms(),
                    place: name.place,
                });
            } else {
                let at = fuzzified.iter().position(|f| f.name.text == name.text);
                let block = fuzzified.swap_remove(at.ok_or_else(missing)?);
                inputs.push(Input {
                    name: name.text.to_owned(),
                    range: block.range(source, declared.range)?,
                    clamp: block.clamp,
                    terms: block.input_terms(),
                    place: name.place,
                });
            }
        }
        checks::variables(source, &inputs, &outputs, end)?;
        let mut blocks = Vec::new();
        for block in self.blocks.iter().filter(|b| b.enabled) {
            let rules = block.resolve(source, &inputs, &outputs)?;
            if let Some((merge, place)) = block.merge {
                accumulate(source, &rules, &outputs, &mut merges, merge, place)?;
            }
            blocks.push(rules);
        }
        for (i, output) in outputs.iter_mut().enumerate() {
            output.merge = match (merges[i], output.defuzzifier) {
                (Some(merge), _) => merge,
                (None, Defuzzifier::Centroid { .. }) => Merge::Max,
                (None, Defuzzifier::WeightedAverage) => {
                    twice(source, i, output, &blocks)?;
                    Merge::Sum
                }
            };
        }
        checks::rules(source, &blocks, end)?;
        Ok(System {
            name: self.name,
            inputs,
            outputs,
            blocks,
        })
    }
}

const CONJUNCTIONS: &[(&str, Conjunction)] =
    &[("MIN", Conjunction::Min), ("PROD", Conjunction::Product)];

/// A rule block's ACCU is that of the outputs which it concludes and which have none of their own.
fn accumulate(
    source: Source<'_>,
    block: &RuleBlock,
    outputs: &[Output],
    merges: &mut [Option<Merge>],
    merge: Merge,
    place: Place,
) -> Result<(), ReadError> {
    for &(output, _) in block.rules.iter().flat_map(|r| &r.conclusions) {
        match merges[output] {
            Some(other) if other != merge => {
                let name = quoted(&outputs[output].name);
                let found = format!("the output {name} has another ACCU already");
                return Err(source.error(place, found, "the same one"));
            }
            _ => merges[output] = Some(merge),
        }
    }
    Ok(())
}

/// Without an ACCU a weighted average is clear only as long as no term is concluded twice.
fn twice(
    source: Source<'_>,
    index: usize,
    output: &Output,
    blocks: &[RuleBlock],
) -> Result<(), ReadError> {
    let mut concluded = vec![None; output.terms.len()];
    for rule in blocks.iter().flat_map(|b| &b.rules) {
        for &(_, term) in rule.conclusions.iter().filter(|c| c.0 == index) {
            if concluded[term].replace(rule.place).is_some() {
                let found = format!(
                    "another rule concludes {} of {} already, and there is no ACCU to say what becomes of both",
                    quoted(&output.terms[term].name),
                    quoted(&output.name)
                );
                let allowed = "`ACCU : MAX;` or `ACCU : SUM;` in the rule block";
                return Err(source.error(rule.place, found, allowed));
            }
        }
    }
    Ok(())
}

impl<'s> Fuzzified<'s> {
    fn new(name: Token<'s>) -> Self {
        Self {
            name,
            range: None,
            clamp: false,
            terms: Vec::new(),
        }
    }

    /// The range that is given here or where the variable is declared, else that of the terms.
    fn range(&self, source: Source<'_>, declared: Range) -> Result<RangeInclusive<f64>, ReadError> {
        if let Some(range) = self.range.clone().or(declared) {
            return Ok(range);
        }
        let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
        const ALLOWED: &str = "`RANGE := (start .. end);`";
        for (name, conclusion) in &self.terms {
            let extent = match conclusion {
                Conclusion::Set(shape) => extent(shape),
                Conclusion::Constant(x) => Some((*x, *x)),
                Conclusion::Linear { .. } => None,
            };
            let Some((a, b)) = extent else {
                let found = format!(
                    "{} has no range, and its term {} has no end",
                    quoted(self.name.text),
                    quoted(name.text)
                );
                return Err(source.error(self.name.place, found, ALLOWED));
            };
            (least, most) = (least.min(a), most.max(b));
        }
        match least < most && (most - least).is_finite() {
            true => Ok(least..=most),
            false => {
                let found = format!(
                    "{} has no range, and its terms span none",
                    quoted(self.name.text)
                );
                Err(source.error(self.name.place, found, ALLOWED))
            }
        }
    }

    fn input_terms(self) -> Vec<Term> {
        let terms = self
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
        terms.collect()
    }

    fn output_terms(self) -> Vec<OutputTerm> {
        let terms = self.terms.into_iter().map(|(name, conclusion)| OutputTerm {
            name: name.text.to_owned(),
            conclusion,
            place: name.place,
        });
        terms.collect()
    }
}

impl WrittenBlock<'_> {
    fn resolve(
        &self,
        source: Source<'_>,
        inputs: &[Input],
        outputs: &[Output],
    ) -> Result<RuleBlock, ReadError> {
        let used = Used::by(&self.rules);
        // What is not said follows from the other one.
        let and = match (self.and, self.or) {
            (Norm::None, Norm::None | Norm::Known(())) => Norm::Known(Conjunction::Min),
            (and, _) => and,
        };
        let or = match (and, self.or) {
            (Norm::Known(Conjunction::Min), Norm::None) => Norm::Known(()),
            (_, or) => or,
        };
        let and = and.used(source, "AND", used.and, "`AND : MIN;` or `AND : PROD;`")?;
        or.used(source, "OR", used.or, "`OR : MAX;`")?;
        let and = and.unwrap_or(Conjunction::Min);
        let names = Names { inputs, outputs };
        let rules = self
            .rules
            .iter()
            .map(|rule| rule.resolve(source, names, and));
        Ok(RuleBlock {
            name: self.name.to_owned(),
            and,
            implication: self.implication,
            rules: rules.collect::<Result<_, _>>()?,
        })
    }
}
