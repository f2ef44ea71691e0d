//! The blocks of an FCL file, as they are written.

use super::{
    DEFAULT_SAMPLES, DIALECT, Declared, Defuzzified, Fuzzified, GRAMMAR, OTHER_SHAPES, RESERVED,
    Reader, SAMPLES_NOTE, SHAPES, WrittenBlock,
};
use crate::fuzzy::files::checks;
use crate::fuzzy::files::conditions::{WrittenRule, rule};
use crate::fuzzy::files::cursor::{Cursor, Parameter};
use crate::fuzzy::files::error::{ReadError, one_of, quoted};
use crate::fuzzy::files::lexer::{Kind, Token, lex};
use crate::fuzzy::files::limits;
use crate::fuzzy::files::norms::Norm;
use crate::fuzzy::files::shapes::Family;
use crate::fuzzy::model::{Conclusion, Conjunction, Defuzzifier, Merge, Place, Sampling, Shape};
use std::ops::RangeInclusive;

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

const CONJUNCTIONS: &[(&str, Conjunction)] =
    &[("MIN", Conjunction::Min), ("PROD", Conjunction::Product)];

impl<'s> Reader<'s, '_> {
    pub(super) fn function_block(&mut self) -> Result<(), ReadError> {
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
}
