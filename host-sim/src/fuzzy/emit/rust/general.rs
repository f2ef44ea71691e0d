//! A module for `fuzzypilot::fuzzy::system`: any design, the same integers as [`Lowered`](crate::fuzzy::lower::Lowered).

use super::super::Design;
use super::super::beyond::beyond;
use super::super::literal::literal;
use super::super::names::{Identifiers, Taken, Variable};
use super::super::pieces::thinned;
use super::super::words::plain;
use super::head::{Signal, head, signals};
use super::shapes::{Argument, Call};
use super::{identifiers, shout};
use crate::fuzzy::check::STRENGTHS;
use crate::fuzzy::describe::{self, number};
use crate::fuzzy::evaluate::concluded;
use crate::fuzzy::lower::{self, Claims, Defuzzifier, Format, Number, Tables};
use crate::fuzzy::model::{Sampling, Shape};
use fuzzypilot::fuzzy::Grade;
use fuzzypilot::fuzzy::system::{Degree, LIMIT, Literal, Merge, Norm, Piece};
use std::collections::BTreeSet;
use std::fmt::Write;

/// The types that the module imports, beside those of variables.
const IMPORTED: [&str; 17] = [
    "Block",
    "Controller",
    "Defuzzifier",
    "Degree",
    "Evaluation",
    "Grade",
    "Input",
    "Linear",
    "Literal",
    "Merge",
    "Norm",
    "Number",
    "Output",
    "Rule",
    "Samples",
    "System",
    "Self",
];
/// More rules than this may take a compiler more steps than it takes without a question.
const MANY_RULES: usize = 300;

/// Writes the module; `why` it is not the fast route's.
pub fn module(design: &Design<'_>, why: Option<&str>) -> String {
    let names = identifiers(design);
    let mut writer = Writer {
        design,
        names: &names,
        imports: BTreeSet::new(),
        shapes: BTreeSet::new(),
        fractions: BTreeSet::new(),
        negates: false,
        unlimited: false,
        claims: design.lowered.tables().claims(),
    };
    let sets = writer.sets();
    let controller = writer.controller();
    let terms = writer.terms();
    let all = writer.signals();
    let mut text = head(design, &route(why), &all, &error(design));
    text += "\n// Not everything is needed everywhere.\n#![allow(dead_code)]\n";
    if writer
        .tables()
        .blocks
        .iter()
        .map(|block| block.rules.len())
        .sum::<usize>()
        > MANY_RULES
    {
        text +=
            "// All rules are checked while this compiles.\n#![allow(long_running_const_eval)]\n";
    }
    text.push('\n');
    if !sets.is_empty() {
        text += "use fuzzypilot::fuzzy::Grade;\n";
    }
    if !writer.shapes.is_empty() {
        import(
            &mut text,
            "fuzzypilot::fuzzy::system::shape",
            &writer.shapes,
        );
    }
    import(&mut text, "fuzzypilot::fuzzy::system", &writer.imports);
    signals(&mut text, &all, &mut Taken::of(&IMPORTED));
    text += &terms;
    text += &sets;
    text += &controller;
    if writer.unlimited {
        text += "\n/// The largest magnitude of a number, in steps.\n\
                 const LIMIT: i32 = fuzzypilot::fuzzy::system::LIMIT;\n";
    }
    if writer.negates {
        text += "\n/// What is not.\nconst fn not(literal: Literal) -> Literal {\n    match literal {\n        \
                 Literal::Is(input, term) => Literal::IsNot(input, term),\n        \
                 Literal::IsNot(input, term) => Literal::Is(input, term),\n    }\n}\n";
    }
    for fraction in &writer.fractions {
        let _ = write!(
            text,
            "\n/// A number in steps of 2^−{fraction}.\nconst fn q{fraction}(text: &str) -> i32 {{\n    \
             fixed::FixedI32::<fixed::types::extra::U{fraction}>::lit(text).to_bits()\n}}\n"
        );
    }
    text
}

fn route(why: Option<&str>) -> Vec<String> {
    let mut lines = vec![
        "Route: general, `fuzzypilot::fuzzy::system`. Every rule is evaluated; the work is the same for every input."
            .to_owned(),
    ];
    lines.extend(why.map(|why| format!("Not the fast one, for {}.", plain(why))));
    lines
}

/// What fixed point may be off.
fn error(design: &Design<'_>) -> Vec<String> {
    let Some(bounds) = design.bounds else {
        return Vec::new();
    };
    let mut lines = vec![
        "It is off the same design in exact arithmetic by at most, where some rule has a degree of"
            .to_owned(),
        String::new(),
        "| output | ≥ 1/2 | ≥ 1/8 | ≥ 1/64 | > 0 |".to_owned(),
        "|---|---|---|---|---|".to_owned(),
    ];
    let outputs = design.lowered.tables().outputs.iter().enumerate();
    for ((o, output), bounds) in outputs.zip(bounds) {
        let concluded = concluded(design.system, o, None);
        let each: [String; STRENGTHS.len()] = bounds.map(|bound| match bound.is_finite() {
            _ if !concluded => "no rule concludes it".to_owned(),
            true => number(bound),
            false => "not bounded".to_owned(),
        });
        lines.push(format!(
            "| `{}` | {} |",
            plain(&output.name),
            each.join(" | ")
        ));
    }
    lines
}

/// `use path::{A, B};` as rustfmt breaks it.
fn import(text: &mut String, path: &str, names: &BTreeSet<&'static str>) {
    /// Of a line, and of one of several.
    const WIDTH: usize = 98;
    const WIDTH_INSIDE: usize = 99;
    let names: Vec<&str> = names.iter().copied().collect();
    let list = names.join(", ");
    let line = match names.as_slice() {
        [only] => format!("use {path}::{only};\n"),
        _ => format!("use {path}::{{{list}}};\n"),
    };
    if line.len() <= WIDTH + 1 {
        *text += &line;
        return;
    }
    let _ = writeln!(text, "use {path}::{{");
    let mut line = "   ".to_owned();
    for name in names {
        if line.len() + name.len() + 2 > WIDTH_INSIDE {
            let _ = writeln!(text, "{line}");
            line = "   ".to_owned();
        }
        let _ = write!(line, " {name},");
    }
    let _ = writeln!(text, "{line}\n}};");
}

struct Writer<'a> {
    design: &'a Design<'a>,
    names: &'a Identifiers,
    imports: BTreeSet<&'static str>,
    shapes: BTreeSet<&'static str>,
    /// Of the numbers that are written as text.
    fractions: BTreeSet<i32>,
    /// Whether a rule asks for what is not.
    negates: bool,
    /// Whether an output is.
    unlimited: bool,
    /// What the compiler shall prove again.
    claims: Claims,
}

impl<'a> Writer<'a> {
    fn tables(&self) -> &'a Tables {
        self.design.lowered.tables()
    }

    fn signals(&self) -> Vec<Signal<'a>> {
        let tables = self.tables();
        let inputs = tables.inputs.iter().zip(&self.names.inputs);
        let inputs = inputs.map(|(input, names)| Signal {
            kind: "input",
            name: &input.name,
            identifier: &names.name,
            fraction: input.format.fraction,
            range: input.range,
            beyond: match input.clamp {
                true => "counts as the end".to_owned(),
                false => "counts as it is".to_owned(),
            },
        });
        let outputs = tables.outputs.iter().zip(&self.names.outputs);
        let models = self.design.system.outputs.iter().enumerate();
        let outputs = outputs
            .zip(models)
            .map(|((output, names), (o, model))| Signal {
                kind: "output",
                name: &output.name,
                identifier: &names.name,
                fraction: output.format.fraction,
                range: [model.range.start(), model.range.end()]
                    .map(|&end| output.format.nearest(end)),
                beyond: beyond(self.design, o)
                    .map_or_else(|| "never".to_owned(), |terms| format!("by {terms}")),
            });
        inputs.chain(outputs).collect()
    }

    /// A number of steps, as text where it has one.
    fn steps(&mut self, steps: i32, format: Format) -> String {
        match literal(steps, format.fraction) {
            Some(text) => {
                self.fractions.insert(format.fraction);
                format!("q{}(\"{text}\")", format.fraction)
            }
            None => steps.to_string(),
        }
    }

    fn degree(&mut self, degree: Degree) -> String {
        self.imports.insert("Degree");
        match degree {
            Degree::ZERO => "Degree::ZERO".to_owned(),
            Degree::ONE => "Degree::ONE".to_owned(),
            _ => match literal(degree.bits() as i32, 24) {
                Some(text) => format!("Degree::lit(\"{text}\")"),
                None => format!("Degree::from_bits({})", degree.bits()),
            },
        }
    }

    /// The constants that rules are made of.
    fn terms(&mut self) -> String {
        let mut text = String::new();
        let pairs = self
            .tables()
            .inputs
            .iter()
            .zip(&self.names.inputs)
            .enumerate();
        for (i, (input, names)) in pairs {
            self.imports.insert("Literal");
            text.push('\n');
            for (t, ((term, _), name)) in input.terms.iter().zip(&names.terms).enumerate() {
                let (of, term) = (plain(&input.name), plain(term));
                let name = shout(name);
                let _ = write!(
                    text,
                    "/// `{of}` is `{term}`.\npub const {name}: Literal = Literal::Is({i}, {t});\n"
                );
            }
        }
        let pairs = self
            .tables()
            .outputs
            .iter()
            .zip(&self.names.outputs)
            .enumerate();
        for (o, (output, names)) in pairs {
            text.push('\n');
            for (t, (term, name)) in output
                .defuzzifier
                .names()
                .iter()
                .zip(&names.terms)
                .enumerate()
            {
                let (of, term) = (plain(&output.name), plain(term));
                let name = shout(name);
                let _ = write!(
                    text,
                    "/// `{of}` becomes `{term}`.\npub const {name}: (u8, u8) = ({o}, {t});\n"
                );
            }
        }
        text
    }

    /// Sampled sets, which are long.
    fn sets(&mut self) -> String {
        let mut text = String::new();
        for (output, names) in self.tables().outputs.iter().zip(&self.names.outputs) {
            let Defuzzifier::Centroid { terms, .. } = &output.defuzzifier else {
                continue;
            };
            for ((term, grades), name) in terms.iter().zip(&names.terms) {
                set(&mut text, [&output.name, term], name, grades);
            }
        }
        if !text.is_empty() {
            text += "\n/// Degrees in steps of 2^−15.\nconst fn set<const N: usize>(bits: [u16; N]) -> [Grade; N] {\n    \
                     let mut grades = [Grade::ZERO; N];\n    let mut i = 0;\n    while i < N {\n        \
                     grades[i] = Grade::from_bits(bits[i]);\n        i += 1;\n    }\n    grades\n}\n";
        }
        text
    }

    fn controller(&mut self) -> String {
        let tables = self.tables();
        let (inputs, outputs) = (tables.inputs.len(), tables.outputs.len());
        let terms: usize = tables.inputs.iter().map(|input| input.terms.len()).sum();
        let rules: usize = tables.blocks.iter().map(|block| block.rules.len()).sum();
        self.imports.extend(["Controller", "System"]);
        let mut text = format!(
            "\n/// The outputs for inputs, and every rule's degree: see `Controller::evaluate`.\n#[rustfmt::skip]\n\
             pub static CONTROLLER: Controller<{inputs}, {terms}, {rules}, {outputs}> = Controller::new(System::new(\n"
        );
        text += "    &[\n";
        for i in 0..inputs {
            self.input(&mut text, i);
        }
        text += "    ],\n    &[\n";
        for b in 0..tables.blocks.len() {
            self.block(&mut text, b);
        }
        text += "    ],\n    &[\n";
        for o in 0..outputs {
            self.output(&mut text, o);
        }
        text += "    ],\n));\n";
        let _ = write!(
            text,
            "\n/// The outputs for inputs, each in steps of its variable.\n#[inline]\n\
             pub fn evaluate(inputs: [i32; {inputs}]) -> [i32; {outputs}] {{\n    \
             CONTROLLER.evaluate(inputs).outputs\n}}\n"
        );
        text
    }

    fn input(&mut self, text: &mut String, i: usize) {
        let (Some(input), Some(model)) = (
            self.tables().inputs.get(i),
            self.design.system.inputs.get(i),
        ) else {
            return;
        };
        self.imports.insert("Input");
        let [low, high] = input.range.map(|end| self.steps(end, input.format));
        let _ = writeln!(
            text,
            "        // {}\n        Input::new([{low}, {high}], &[",
            plain(&input.name)
        );
        for ((name, pieces), term) in input.terms.iter().zip(&model.terms) {
            let drawn = self.term(&term.shape, pieces, input.format);
            let _ = writeln!(text, "            &{drawn}, // {}", plain(name));
        }
        let complete = self.claims.inputs.get(i).copied().unwrap_or(false);
        text.push_str("        ])");
        text.push_str(if complete { "" } else { ".with_gaps()" });
        text.push_str(if input.clamp {
            ",\n"
        } else {
            ".unlimited(),\n"
        });
    }

    /// A term by its shape's name if that gives the same pieces, else by its points.
    fn term(&mut self, shape: &Shape, pieces: &[Piece], format: Format) -> String {
        if let Some(call) =
            Call::of(shape, format).filter(|call| thinned(&call.pieces) == thinned(pieces))
        {
            self.shapes.insert(call.name);
            let numbers: Vec<String> = call
                .arguments
                .iter()
                .map(|argument| match argument {
                    Argument::Steps(steps) => self.steps(*steps, format),
                    Argument::Flank(mean, width) => {
                        format!("({}, {width})", self.steps(*mean, format))
                    }
                    Argument::Text(text) => text.clone(),
                })
                .collect();
            return format!("{}{}({})", call.name, call.points, numbers.join(", "));
        }
        self.shapes.insert("points");
        let points: Vec<String> = pieces
            .iter()
            .map(|piece| {
                let x = self.steps(piece.from(), format);
                format!("({x}, {})", self.degree(piece.start()))
            })
            .collect();
        format!("points([{}])", points.join(", "))
    }

    fn block(&mut self, text: &mut String, b: usize) {
        let Some(block) = self.tables().blocks.get(b) else {
            return;
        };
        let rules = self
            .design
            .system
            .blocks
            .get(b)
            .map_or(&[][..], |block| &block.rules);
        self.imports.extend(["Block", "Rule"]);
        if !block.name.is_empty() {
            let _ = writeln!(text, "        // {}", plain(&block.name));
        }
        text.push_str(match (block.and, block.implication) {
            (Norm::Min, Norm::Min) => "        Block::min(&[\n",
            (Norm::Product, Norm::Product) => "        Block::product(&[\n",
            (Norm::Min, Norm::Product) => {
                self.imports.insert("Norm");
                "        Block { and: Norm::Min, implication: Norm::Product, rules: &[\n"
            }
            (Norm::Product, Norm::Min) => {
                self.imports.insert("Norm");
                "        Block { and: Norm::Product, implication: Norm::Min, rules: &[\n"
            }
        });
        for (rule, said) in block.rules.iter().zip(rules) {
            let _ = writeln!(
                text,
                "            // {}",
                plain(&describe::rule(self.design.system, said))
            );
            let _ = writeln!(text, "            {},", self.rule(rule));
        }
        text.push_str(if block.and == block.implication {
            "        ]),\n"
        } else {
            "        ] },\n"
        });
    }

    fn rule(&mut self, rule: &lower::Rule) -> String {
        let when: Vec<String> = rule
            .when
            .iter()
            .map(|all| {
                let all: Vec<String> = all.iter().map(|&literal| self.literal(literal)).collect();
                format!("&[{}]", all.join(", "))
            })
            .collect();
        let then: Vec<String> = rule
            .then
            .iter()
            .map(|&(output, term)| term_of(&self.names.outputs, output, term))
            .collect();
        let weight = match rule.weight {
            Degree::ONE => String::new(),
            weight => format!(".weighted({})", self.degree(weight)),
        };
        format!(
            "Rule::new(&[{}], &[{}]){weight}",
            when.join(", "),
            then.join(", ")
        )
    }

    fn literal(&mut self, literal: Literal) -> String {
        match literal {
            Literal::Is(input, term) => term_of(&self.names.inputs, input, term),
            Literal::IsNot(input, term) => {
                self.negates = true;
                format!("not({})", term_of(&self.names.inputs, input, term))
            }
        }
    }

    fn output(&mut self, text: &mut String, o: usize) {
        let (Some(output), Some(names)) = (self.tables().outputs.get(o), self.names.outputs.get(o))
        else {
            return;
        };
        self.imports.extend(["Output", "Defuzzifier", "Merge"]);
        let format = output.format;
        let [low, high] = match output.range {
            limits if limits == [-LIMIT, LIMIT] => {
                self.unlimited = true;
                ["-LIMIT".to_owned(), "LIMIT".to_owned()]
            }
            range => range.map(|end| self.steps(end, format)),
        };
        let default = self.steps(output.default, format);
        let complete = self.claims.outputs.get(o).copied().unwrap_or(false);
        let clamp = output.clamp;
        let _ = write!(
            text,
            "        // {}\n        Output {{\n            range: [{low}, {high}],\n            clamp: {clamp},\n            \
             default: {default},\n            complete: {complete},\n            defuzzifier: Defuzzifier::",
            plain(&output.name)
        );
        match &output.defuzzifier {
            Defuzzifier::WeightedAverage { merge, terms } => {
                self.imports.insert("Number");
                let _ = writeln!(
                    text,
                    "WeightedAverage {{\n                merge: {},\n                terms: &[",
                    self::merge(*merge)
                );
                for (name, number) in terms {
                    let number = self.number(number, format);
                    let _ = writeln!(text, "                    {number}, // {}", plain(name));
                }
            }
            Defuzzifier::Centroid {
                merge,
                samples,
                sampling,
                terms,
            } => {
                self.imports.insert("Samples");
                let [low, high] = samples.range().map(|end| self.steps(end, format));
                let spread = match sampling {
                    Sampling::Middles => "middles",
                    Sampling::Ends => "ends",
                };
                let _ = writeln!(
                    text,
                    "Centroid {{\n                merge: {},\n                \
                     samples: Samples::{spread}([{low}, {high}], {}),\n                terms: &[",
                    self::merge(*merge),
                    samples.count()
                );
                for ((name, _), identifier) in terms.iter().zip(&names.terms) {
                    let _ = writeln!(
                        text,
                        "                    &{}, // {}",
                        set_name(identifier),
                        plain(name)
                    );
                }
            }
        }
        text.push_str("                ],\n            },\n        },\n");
    }

    fn number(&mut self, number: &Number, format: Format) -> String {
        match number {
            Number::Constant(value) => format!("Number::Constant({})", self.steps(*value, format)),
            Number::Linear {
                coefficients,
                shift,
                constant,
            } => {
                self.imports.insert("Linear");
                let coefficients: Vec<String> =
                    coefficients.iter().map(ToString::to_string).collect();
                format!(
                    "Number::Linear(Linear {{ coefficients: &[{}], shift: {shift}, constant: {} }})",
                    coefficients.join(", "),
                    self.steps(*constant, format)
                )
            }
        }
    }
}

fn merge(merge: Merge) -> &'static str {
    match merge {
        Merge::Sum => "Merge::Sum",
        Merge::Max => "Merge::Max",
    }
}

fn term_of(of: &[Variable], variable: u8, term: u8) -> String {
    let names = of
        .get(usize::from(variable))
        .map_or(&[][..], |of| &of.terms);
    names
        .get(usize::from(term))
        .map_or_else(String::new, |name| shout(name))
}

fn set_name(term: &str) -> String {
    format!("{}_SET", shout(term))
}

fn set(text: &mut String, [output, term]: [&str; 2], name: &str, grades: &[Grade]) {
    let _ = write!(
        text,
        "\n/// The set `{}` of `{}`, sample by sample.\n#[rustfmt::skip]\nstatic {}: [Grade; {}] = set([\n",
        plain(term),
        plain(output),
        set_name(name),
        grades.len()
    );
    for line in grades.chunks(16) {
        let line: Vec<String> = line
            .iter()
            .map(|grade| format!("{:>5}", grade.bits()))
            .collect();
        let _ = writeln!(text, "    {},", line.join(", "));
    }
    text.push_str("]);\n");
}
