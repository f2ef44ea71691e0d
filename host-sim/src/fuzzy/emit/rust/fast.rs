//! A module for the tables of `fuzzypilot::fuzzy`: the four rules around an input, whatever the table's size. Two outputs over
//! even peaks become a `TwinTable`, anything else a `RuleTable` an output.

use super::super::Design;
use super::super::literal::literal;
use super::super::names::{Identifiers, Taken, Variable};
use super::super::ruspini::{FRACTION, RuleBase, Table};
use super::super::words::plain;
use super::head::{Signal, head, signals};
use super::{identifiers, shout};
use crate::fuzzy::describe::{self, number};
use crate::fuzzy::evaluate::rules;
use heck::ToUpperCamelCase;
use std::fmt::Write;

const IMPORTED: [&str; 9] = [
    "Antecedents",
    "Consequents",
    "I16F16",
    "Partition",
    "Position",
    "RuleTable",
    "Self",
    "Term",
    "TwinTable",
];
/// What a twin table's outputs may be too small, of the greatest peak.
const TWIN_ERROR: f64 = 3e-5;

/// Writes the module.
pub fn module(design: &Design<'_>, base: &RuleBase) -> String {
    let names = identifiers(design);
    let writer = Writer {
        design,
        names: &names,
        base,
        twin: base.is_twin(),
    };
    let all = writer.signals();
    let mut text = head(design, &writer.route(), &all, &writer.error());
    text += "\n// Not everything is needed everywhere.\n#![allow(dead_code)]\n\nuse fixed::types::I16F16;\n";
    text += if writer.twin {
        "use fuzzypilot::fuzzy::{\n    Antecedents, Consequents, Partition, Position, RuleTable, Term, TwinTable,\n};\n"
    } else {
        "use fuzzypilot::fuzzy::{Antecedents, Consequents, Partition, RuleTable, Term};\n"
    };
    let mut types = Taken::of(&IMPORTED);
    signals(&mut text, &all, &mut types);
    writer.inputs(&mut text);
    for o in 0..base.tables.len() {
        writer.output(&mut text, o, &mut types);
    }
    if writer.twin {
        writer.twin(&mut text);
    } else {
        writer.evaluate(&mut text);
    }
    text
}

struct Writer<'a> {
    design: &'a Design<'a>,
    names: &'a Identifiers,
    base: &'a RuleBase,
    twin: bool,
}

impl<'a> Writer<'a> {
    fn route(&self) -> Vec<String> {
        let by = match self.twin {
            true => "`fuzzypilot::fuzzy::TwinTable`: two outputs over evenly spaced terms at once",
            false => "`fuzzypilot::fuzzy::RuleTable`, one an output",
        };
        vec![
            format!("Route: fast, {by}. Only the four"),
            "rules around an input are evaluated; the work is the same for every input.".to_owned(),
        ]
    }

    fn signals(&self) -> Vec<Signal<'a>> {
        let tables = self.design.lowered.tables();
        let inputs = tables
            .inputs
            .iter()
            .zip(&self.names.inputs)
            .map(|(input, names)| Signal {
                kind: "input",
                name: &input.name,
                identifier: &names.name,
                fraction: FRACTION,
                range: input.range,
                beyond: "counts as the outermost term".to_owned(),
            });
        let outputs = tables
            .outputs
            .iter()
            .zip(&self.names.outputs)
            .zip(&self.base.tables);
        let outputs = outputs.map(|((output, names), table)| {
            let shift = self.base.fraction(table) - table.fraction;
            let ends = [table.peaks.first(), table.peaks.last()];
            Signal {
                kind: "output",
                name: &output.name,
                identifier: &names.name,
                fraction: self.base.fraction(table),
                range: ends.map(|end| end.copied().unwrap_or(0) << shift),
                beyond: "never".to_owned(),
            }
        });
        inputs.chain(outputs).collect()
    }

    fn error(&self) -> Vec<String> {
        let mut lines = vec![
            "It is off the same design in exact arithmetic by at most".to_owned(),
            String::new(),
        ];
        let outputs = &self.design.lowered.tables().outputs;
        for (o, output) in outputs.iter().enumerate() {
            lines.push(format!(
                "* {} of `{}`",
                number(output_error(self.base, o)),
                plain(&output.name)
            ));
        }
        lines
    }

    fn inputs(&self, text: &mut String) {
        let [rows, columns] = &self.base.axes;
        let kind = if self.twin { "const" } else { "pub static" };
        let _ = write!(
            text,
            "\n/// Where the inputs' terms have their peaks.\n#[rustfmt::skip]\n{kind} INPUTS: Antecedents<{}, {}> = Antecedents {{\n",
            rows.peaks.len(),
            columns.peaks.len()
        );
        let tables = self.design.lowered.tables();
        for ((axis, input), field) in self
            .base
            .axes
            .iter()
            .zip(&tables.inputs)
            .zip(["rows", "cols"])
        {
            let peaks: Vec<String> = axis
                .peaks
                .iter()
                .map(|&peak| number_of("I16F16", peak, FRACTION))
                .collect();
            let terms: Vec<String> = axis
                .terms
                .iter()
                .map(|&term| plain(&input.terms[term].0))
                .collect();
            let _ = write!(
                text,
                "    // {}: {}\n    {field}: Partition::new([{}]),\n",
                plain(&input.name),
                terms.join(", "),
                peaks.join(", ")
            );
        }
        text.push_str("};\n");
    }

    fn output(&self, text: &mut String, o: usize, types: &mut Taken) {
        let (table, names) = (&self.base.tables[o], &self.names.outputs[o]);
        let output = &self.design.lowered.tables().outputs[o];
        let of = plain(&output.name);
        text.push('\n');
        for ((term, name), place) in output
            .defuzzifier
            .names()
            .iter()
            .zip(&names.terms)
            .zip(&table.places)
        {
            let _ = write!(
                text,
                "/// `{of}` becomes `{}`.\nconst {}: Term = Term({place});\n",
                plain(term),
                shout(name)
            );
        }
        let format = types.claim_type(&format!("{}Table", names.name.to_upper_camel_case()));
        let _ = write!(
            text,
            "/// `{of}` in the table.\ntype {format} = fixed::FixedI16<fixed::types::extra::U{}>;\n\n",
            table.fraction
        );
        for (_, rule) in rules(self.design.system) {
            if rule.conclusions.iter().any(|&(output, _)| output == o) {
                let _ = writeln!(
                    text,
                    "// {}",
                    plain(&describe::rule(self.design.system, rule))
                );
            }
        }
        self.table(text, table, names, &format, &of);
    }

    fn table(&self, text: &mut String, table: &Table, names: &Variable, format: &str, of: &str) {
        let inputs = &self.design.lowered.tables().inputs;
        let [rows, columns] = &self.base.axes;
        let kind = if self.twin { "const" } else { "pub static" };
        let widest = names.terms.iter().map(String::len).max().unwrap_or(0);
        let _ = write!(
            text,
            "/// `{of}`: a row for each term of `{}`, a column for each of `{}`.\n#[rustfmt::skip]\n\
             {kind} {}_RULES: RuleTable<{}, {}, {format}> = RuleTable::new(\n",
            plain(&inputs[0].name),
            plain(&inputs[1].name),
            shout(&names.name),
            rows.peaks.len(),
            columns.peaks.len(),
        );
        let heads: Vec<String> = columns
            .terms
            .iter()
            .map(|&term| format!("{:<widest$}", plain(&inputs[1].terms[term].0)))
            .collect();
        let _ = writeln!(text, "    // {}", heads.join("  ").trim_end());
        for (r, (cells, &row)) in table.cells.iter().zip(&rows.terms).enumerate() {
            let cells: Vec<String> = cells
                .iter()
                .map(|&term| format!("{:<widest$}", shout(&names.terms[term])))
                .collect();
            let open = if r == 0 { "[[" } else { " [" };
            let close = if r + 1 == rows.terms.len() {
                "]],"
            } else {
                "], "
            };
            let _ = writeln!(
                text,
                "    {open}{}{close} // {}",
                cells.join(", "),
                plain(&inputs[0].terms[row].0)
            );
        }
        let number = |&raw: &i32| number_of(format, raw, table.fraction);
        let range: Vec<String> = table.range.iter().map(number).collect();
        let peaks: Vec<String> = table.peaks.iter().map(number).collect();
        let _ = write!(
            text,
            "    Consequents::new(\n        [{}],\n        [{}],\n    ),\n);\n",
            range.join(", "),
            peaks.join(", ")
        );
    }

    fn evaluate(&self, text: &mut String) {
        let count = self.base.tables.len();
        let _ = write!(
            text,
            "\n/// The outputs for inputs, each in steps of its variable.\n#[inline]\n\
             pub fn evaluate(inputs: [i32; 2]) -> [i32; {count}] {{\n    \
             let [row, column] = inputs.map(I16F16::from_bits);\n    \
             let activation = INPUTS.activate(row, column);\n"
        );
        let rules: Vec<String> = self
            .names
            .outputs
            .iter()
            .map(|output| {
                format!(
                    "i32::from({}_RULES.defuzzify(&activation).to_bits())",
                    shout(&output.name)
                )
            })
            .collect();
        match rules.as_slice() {
            [only] => {
                let _ = writeln!(text, "    [{only}]");
            }
            all => {
                let _ = writeln!(text, "    [\n        {},\n    ]", all.join(",\n        "));
            }
        }
        text.push_str("}\n");
    }

    fn twin(&self, text: &mut String) {
        let [rows, columns] = &self.base.axes;
        let (r, c) = (rows.peaks.len(), columns.peaks.len());
        let [first, second] = [0, 1].map(|o| shout(&self.names.outputs[o].name));
        let ends = |peaks: &[i32]| [peaks[0], peaks[peaks.len() - 1]];
        let [[row, last_row], [column, last_column]] = [ends(&rows.peaks), ends(&columns.peaks)];
        let _ = write!(
            text,
            "\n/// Both tables in one, which is all of them that is kept; for positions that are at hand, see `TwinTable::evaluate`.\n\
             #[rustfmt::skip]\n\
             pub static RULES: TwinTable<{r}, {c}, {}> = TwinTable::new(&INPUTS, &{first}_RULES, &{second}_RULES);\n",
            r - 1
        );
        let _ = write!(
            text,
            "\n/// The outputs for inputs, each in steps of its variable.\n#[inline]\n\
             pub fn evaluate(inputs: [i32; 2]) -> [i32; 2] {{\n    \
             let [row, column] = inputs;\n    \
             let row = position::<{}, {}>(row);\n    \
             let column = position::<{}, {}>(column);\n    \
             let twin = RULES.evaluate(row, column);\n    \
             [twin.first, twin.second]\n}}\n",
            row, last_row, column, last_column
        );
        *text += POSITION;
    }
}

/// Of the module: a product, as a controller without a divider has it.
const POSITION: &str = "
/// Where `x` lies between two numbers of steps; what is beyond counts as the nearer one.
#[inline]
fn position<const FIRST: i32, const LAST: i32>(x: i32) -> Position {
    let (reciprocal, shift) = const {
        let span = LAST.wrapping_sub(FIRST) as u32;
        let shift = span.leading_zeros();
        (((1u64 << 62) / ((span as u64) << shift)) as u32, shift)
    };
    let distance = x.clamp(FIRST, LAST).wrapping_sub(FIRST) as u32;
    let wide = u64::from(distance.wrapping_shl(shift)).wrapping_mul(u64::from(reciprocal)) >> 30;
    Position::from_bits(wide.min(u64::from(u32::MAX)) as u32)
}
";

/// What an output may be off, in its unit.
pub fn output_error(base: &RuleBase, output: usize) -> f64 {
    let table = &base.tables[output];
    match base.is_twin() {
        true => table.error + TWIN_ERROR * table.greatest(),
        // Rounded to half a step.
        false => table.error + 0.5 * table.step(),
    }
}

fn number_of(format: &str, raw: i32, fraction: i32) -> String {
    match literal(raw, fraction) {
        Some(text) => format!("{format}::lit(\"{text}\")"),
        None => format!("{format}::from_bits({raw})"),
    }
}
