//! The source: tables, and an evaluation in which every rule can be read.

use super::super::Design;
use super::super::pieces::thinned;
use super::super::words::plain;
use super::{Names, header, runtime};
use crate::fuzzy::describe;
use crate::fuzzy::evaluate::rules;
use crate::fuzzy::lower::{Defuzzifier, Number, Output};
use fuzzypilot::fuzzy::system::{Degree, LIMIT, Literal, Merge, Norm, Samples};
use std::fmt::Write;

/// What both files begin with.
pub fn head(design: &Design<'_>) -> String {
    format!(
        "/* The fuzzy controller \"{}\": {}.\n\n   Made by `{}`:\n   change the design and make it again rather than this file.\n{}*/\n",
        plain(design.name),
        header::sizes(design),
        plain(design.command),
        header::error(design),
    )
}

pub fn text(design: &Design<'_>, names: &Names, header: &str) -> String {
    let writer = Writer { design, names };
    let mut tables = String::new();
    writer.pieces(&mut tables);
    writer.conclusions(&mut tables);
    let body = writer.evaluation();
    let functions = runtime::called_by(&body);
    let mut text = format!("{}\n#include \"{header}\"\n", head(design));
    for (name, value) in [("FULL", names.shout("full")), ("LIMIT", constant(LIMIT))] {
        if uses(&functions, name) || uses(&body, name) {
            if name == "LIMIT" {
                text.push_str("\n/* The largest magnitude of a number, in steps. */");
            }
            let _ = write!(text, "\n#define {name} {value}\n");
        }
    }
    text + &functions + &tables + &body
}

/// Whether it stands there as a word.
fn uses(text: &str, name: &str) -> bool {
    text.split(|c: char| !c.is_alphanumeric() && c != '_')
        .any(|word| word == name)
}

/// A number of 32 bits with its sign. The least of all has no literal.
pub fn constant(x: i32) -> String {
    match x {
        i32::MIN => "(-INT32_C(2147483647) - 1)".to_owned(),
        x if x < 0 => format!("(-INT32_C({}))", x.unsigned_abs()),
        x => format!("INT32_C({x})"),
    }
}

struct Writer<'a> {
    design: &'a Design<'a>,
    names: &'a Names,
}

impl Writer<'_> {
    fn pieces(&self, text: &mut String) {
        let inputs = self
            .design
            .lowered
            .tables()
            .inputs
            .iter()
            .zip(&self.names.all.inputs);
        for (input, variable) in inputs {
            for ((term, pieces), name) in input.terms.iter().zip(&variable.terms) {
                let pieces = thinned(pieces);
                let _ = write!(
                    text,
                    "\n/* {} is {}. */\nstatic const piece_t pieces_{name}[{}] =\n{{\n",
                    plain(&input.name),
                    plain(term),
                    pieces.len()
                );
                for piece in &pieces {
                    let (slope, shift) = piece.slope();
                    let _ = writeln!(
                        text,
                        "    {{ {}, UINT32_C({}), {}, {shift}U }},",
                        constant(piece.from()),
                        piece.start().bits(),
                        constant(slope),
                    );
                }
                text.push_str("};\n");
            }
        }
    }

    /// Coefficients and sets; constants stand where they are used.
    fn conclusions(&self, text: &mut String) {
        let outputs = self
            .design
            .lowered
            .tables()
            .outputs
            .iter()
            .zip(&self.names.all.outputs);
        for (o, (output, variable)) in outputs.enumerate() {
            let of = plain(&output.name);
            for (t, (term, name)) in output
                .defuzzifier
                .names()
                .iter()
                .zip(&variable.terms)
                .enumerate()
            {
                if !self.is_concluded(o, t) {
                    continue;
                }
                let term = plain(term);
                match &output.defuzzifier {
                    Defuzzifier::WeightedAverage { terms, .. } => {
                        if let Some((_, Number::Linear { coefficients, .. })) = terms.get(t) {
                            let all: Vec<String> =
                                coefficients.iter().map(|&c| constant(c)).collect();
                            let _ = write!(
                                text,
                                "\n/* {of} becomes {term}. */\nstatic const int32_t coefficients_{name}[{}] =\n{{\n    {}\n}};\n",
                                all.len(),
                                all.join(", ")
                            );
                        }
                    }
                    Defuzzifier::Centroid { terms, .. } => {
                        let Some((_, grades)) = terms.get(t) else {
                            continue;
                        };
                        let _ = write!(
                            text,
                            "\n/* {of} becomes {term}, sample by sample, in 2^-15. */\nstatic const uint16_t set_{name}[{}] =\n{{\n",
                            grades.len()
                        );
                        for line in grades.chunks(12) {
                            let line: Vec<String> = line
                                .iter()
                                .map(|grade| format!("{:>5}U", grade.bits()))
                                .collect();
                            let _ = writeln!(text, "    {},", line.join(", "));
                        }
                        text.push_str("};\n");
                    }
                }
            }
        }
    }

    fn evaluation(&self) -> String {
        let tables = self.design.lowered.tables();
        let [inputs, outputs, terms, rules] =
            ["inputs", "outputs", "terms", "rules"].map(|name| self.names.shout(name));
        let mut text = format!(
            "\nvoid {}_evaluate(const int32_t in[{inputs}], int32_t out[{outputs}], uint32_t *degrees)\n{{\n    \
             int32_t x[{inputs}];\n    uint32_t terms[{terms}];\n    uint32_t own[{rules}];\n    \
             uint32_t *const rules = (degrees != NULL) ? degrees : own;\n",
            self.names.prefix
        );
        for (input, variable) in tables.inputs.iter().zip(&self.names.all.inputs) {
            let name = self.names.shout(&variable.name);
            let [low, high] = match input.clamp {
                true => ["least", "most"]
                    .map(|end| self.names.shout(&format!("{}_{end}", variable.name))),
                false => ["-LIMIT".to_owned(), "LIMIT".to_owned()],
            };
            let _ = writeln!(
                text,
                "\n    x[{name}] = limited(in[{name}], {low}, {high});"
            );
            for ((_, pieces), term) in input.terms.iter().zip(&variable.terms) {
                let _ = writeln!(
                    text,
                    "    terms[{}] = membership(pieces_{term}, {}U, x[{name}]);",
                    self.names.shout(term),
                    thinned(pieces).len()
                );
            }
        }
        text.push('\n');
        let mut said = self::rules(self.design.system);
        let mut number = 0;
        for block in &tables.blocks {
            for rule in &block.rules {
                if let Some((_, said)) = said.next() {
                    let said = plain(&describe::rule(self.design.system, said));
                    let _ = writeln!(text, "    /* {said} */");
                }
                let _ = writeln!(
                    text,
                    "    rules[{number}] = {};",
                    self.degree(rule, block.and)
                );
                number += 1;
            }
        }
        for (o, output) in tables.outputs.iter().enumerate() {
            self.output(&mut text, o, output);
        }
        text.push_str("}\n");
        text
    }

    fn degree(&self, rule: &crate::fuzzy::lower::Rule, and: Norm) -> String {
        let and = match and {
            Norm::Min => "least",
            Norm::Product => "product",
        };
        let any = rule.when.iter().map(|all| {
            let all = all.iter().map(|&literal| self.literal(literal));
            joined(all, and)
        });
        let any = joined(any, "most");
        match rule.weight {
            Degree::ONE => any,
            weight => format!("product({any}, UINT32_C({}))", weight.bits()),
        }
    }

    fn literal(&self, literal: Literal) -> String {
        let (Literal::Is(input, term) | Literal::IsNot(input, term)) = literal;
        let name = &self.names.all.inputs[usize::from(input)].terms[usize::from(term)];
        let degree = format!("terms[{}]", self.names.shout(name));
        match literal {
            Literal::Is(..) => degree,
            Literal::IsNot(..) => format!("complement({degree})"),
        }
    }

    fn output(&self, text: &mut String, o: usize, output: &Output) {
        let name = &self.names.all.outputs[o].name;
        let macros = ["least", "most", "default"];
        let [least, most, default] = macros.map(|of| self.names.shout(&format!("{name}_{of}")));
        let [least, most] = match output.range {
            limits if limits == [-LIMIT, LIMIT] => ["-LIMIT".to_owned(), "LIMIT".to_owned()],
            _ => [least, most],
        };
        let _ = writeln!(text, "\n    /* {} */\n    {{", plain(&output.name));
        match &output.defuzzifier {
            Defuzzifier::WeightedAverage { merge, terms } => self.average(text, o, *merge, terms),
            Defuzzifier::Centroid { merge, samples, .. } => {
                self.centroid(text, o, *merge, *samples);
            }
        }
        let _ = write!(
            text,
            "        out[{}] = (weight == 0U) ? {default} : limited(value, {least}, {most});\n    }}\n",
            self.names.shout(name)
        );
    }

    /// Every conclusion about a term of an output: the rule, and the implication.
    fn about(&self, o: usize, t: usize) -> impl Iterator<Item = (usize, Norm)> + '_ {
        let blocks = &self.design.lowered.tables().blocks;
        let rules = blocks
            .iter()
            .flat_map(|block| block.rules.iter().map(|rule| (block.implication, rule)));
        rules
            .enumerate()
            .filter_map(move |(number, (implication, rule))| {
                let concludes = rule
                    .then
                    .iter()
                    .any(|&(output, term)| (usize::from(output), usize::from(term)) == (o, t));
                concludes.then_some((number, implication))
            })
    }

    fn is_concluded(&self, o: usize, t: usize) -> bool {
        self.about(o, t).next().is_some()
    }

    fn average(&self, text: &mut String, o: usize, merge: Merge, terms: &[(String, Number)]) {
        text.push_str(
            "        int64_t sum = 0;\n        uint64_t weight = 0U;\n        int32_t value;\n",
        );
        for (t, (_, number)) in terms.iter().enumerate() {
            if !self.is_concluded(o, t) {
                continue;
            }
            let name = &self.names.all.outputs[o].terms[t];
            let value = match number {
                Number::Constant(value) => constant(*value),
                Number::Linear {
                    shift, constant, ..
                } => format!(
                    "linear(coefficients_{name}, x, {}, {shift}U, {})",
                    self.names.shout("inputs"),
                    self::constant(*constant)
                ),
            };
            let _ = writeln!(
                text,
                "        value = {value}; /* {} */",
                plain(&terms[t].0)
            );
            let rules = self.about(o, t).map(|(rule, _)| format!("rules[{rule}]"));
            match merge {
                Merge::Sum => {
                    for rule in rules {
                        let _ = writeln!(text, "        add(&sum, &weight, {rule}, value);");
                    }
                }
                Merge::Max => {
                    let _ = writeln!(
                        text,
                        "        add(&sum, &weight, {}, value);",
                        joined(rules, "most")
                    );
                }
            }
        }
        text.push_str("        value = rounded(sum, weight);\n");
    }

    fn centroid(&self, text: &mut String, o: usize, merge: Merge, samples: Samples) {
        let _ = write!(
            text,
            "        uint64_t moment = 0U;\n        uint64_t weight = 0U;\n        int32_t value;\n        uint32_t at;\n        \
             for (at = 0U; at < {}U; at++)\n        {{\n            {} merged = 0U;\n",
            samples.count(),
            match merge {
                // Of hundreds of rules it has more than 32 bits.
                Merge::Sum => "uint64_t",
                Merge::Max => "uint32_t",
            }
        );
        for (t, name) in self.names.all.outputs[o].terms.iter().enumerate() {
            for (rule, implication) in self.about(o, t) {
                let implied = match implication {
                    Norm::Min => "least",
                    Norm::Product => "product",
                };
                // A grade is a degree with nine bits less.
                let implied = format!("{implied}(rules[{rule}], (uint32_t)set_{name}[at] << 9)");
                let _ = match merge {
                    Merge::Sum => writeln!(text, "            merged += {implied};"),
                    Merge::Max => writeln!(text, "            merged = most(merged, {implied});"),
                };
            }
        }
        let (offset, step, shift) = samples.spacing();
        let _ = write!(
            text,
            "            weight += merged;\n            moment += (uint64_t)merged * at;\n        }}\n        \
             value = sample(place(moment, weight), {}, {offset}U, UINT32_C({step}), {shift}U);\n",
            constant(samples.range()[0])
        );
    }
}

/// `f(f(a, b), c)`; an operand alone as it is.
fn joined(operands: impl Iterator<Item = String>, function: &str) -> String {
    let joined = operands.reduce(|all, next| format!("{function}({all}, {next})"));
    joined.unwrap_or_else(|| "0U".to_owned())
}
