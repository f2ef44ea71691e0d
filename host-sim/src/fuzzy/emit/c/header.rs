//! The header: what a program may name.

use super::super::Design;
use super::super::beyond::beyond;
use super::super::words::{count, plain};
use super::{Names, source};
use crate::fuzzy::check::STRENGTHS;
use crate::fuzzy::describe::{exact, number};
use crate::fuzzy::evaluate::concluded;
use crate::fuzzy::lower::Format;
use fuzzypilot::fuzzy::system::LIMIT;
use std::fmt::Write;

pub fn text(design: &Design<'_>, names: &Names) -> String {
    let tables = design.lowered.tables();
    let mut text = source::head(design);
    // Writing to a text cannot fail.
    let guard = names.shout("h");
    let _ = write!(
        text,
        "\n#ifndef {guard}\n#define {guard}\n\n#include <stddef.h>\n#include <stdint.h>\n\n\
         #ifdef __cplusplus\nextern \"C\" {{\n#endif\n"
    );
    let terms: usize = tables.inputs.iter().map(|input| input.terms.len()).sum();
    let rules: usize = tables.blocks.iter().map(|block| block.rules.len()).sum();
    text.push_str("\n/* How many. */\n");
    for (name, number) in [
        ("inputs", tables.inputs.len()),
        ("outputs", tables.outputs.len()),
        ("terms", terms),
        ("rules", rules),
    ] {
        let _ = writeln!(text, "#define {} {number}U", names.shout(name));
    }
    let _ = write!(
        text,
        "/* A full degree; 0 is none. */\n#define {} UINT32_C(0x1000000)\n",
        names.shout("full")
    );
    let inputs: Vec<String> = names
        .all
        .inputs
        .iter()
        .map(|v| names.shout(&v.name))
        .collect();
    let outputs: Vec<String> = names
        .all
        .outputs
        .iter()
        .map(|v| names.shout(&v.name))
        .collect();
    list(&mut text, "Places of the inputs.", &inputs);
    list(&mut text, "Places of the outputs.", &outputs);
    let all: Vec<String> = names
        .all
        .inputs
        .iter()
        .flat_map(|v| &v.terms)
        .map(|t| names.shout(t))
        .collect();
    list(
        &mut text,
        "Places of the inputs' terms, among those of all inputs.",
        &all,
    );
    for variable in &names.all.outputs {
        let all: Vec<String> = variable.terms.iter().map(|t| names.shout(t)).collect();
        list(&mut text, "Places of the output's terms.", &all);
    }
    for (input, variable) in tables.inputs.iter().zip(&names.all.inputs) {
        let beyond = match input.clamp {
            true => "values beyond the range count as its nearer end".to_owned(),
            false => format!("values beyond the range count as they are, up to {LIMIT} steps"),
        };
        let what = format!(
            "input \"{}\": {}; {beyond}",
            plain(&input.name),
            range(input.range, input.format)
        );
        format_of(
            &mut text,
            names,
            &variable.name,
            &what,
            input.format,
            input.range,
        );
    }
    let models = design.system.outputs.iter().enumerate();
    for ((output, variable), (o, model)) in
        tables.outputs.iter().zip(&names.all.outputs).zip(models)
    {
        let beyond = match beyond(design, o) {
            None => "no value is beyond".to_owned(),
            Some(terms) => format!("values may be beyond by {terms}"),
        };
        let ends = [model.range.start(), model.range.end()];
        let ends = ends.map(|&end| output.format.nearest(end));
        let what = format!(
            "output \"{}\": {}; {beyond}",
            plain(&output.name),
            range(ends, output.format)
        );
        format_of(&mut text, names, &variable.name, &what, output.format, ends);
        let _ = writeln!(
            text,
            "/* Where no rule fires: {}. */\n#define {} {}",
            exact(output.format.value(output.default)),
            names.shout(&format!("{}_default", variable.name)),
            source::constant(output.default)
        );
    }
    let _ = write!(
        text,
        "\n/* From inputs to outputs, each in steps of its variable; every number is allowed.\n   \
         Every rule's degree goes to `degrees`, {} of them, unless it is NULL. */\n\
         void {}_evaluate(const int32_t in[{}], int32_t out[{}], uint32_t *degrees);\n",
        rules,
        names.prefix,
        names.shout("inputs"),
        names.shout("outputs"),
    );
    let _ = write!(
        text,
        "\n#ifdef __cplusplus\n}}\n#endif\n\n#endif /* {guard} */\n"
    );
    text
}

/// What fixed point may be off, for the head.
pub fn error(design: &Design<'_>) -> String {
    let mut text = String::new();
    let Some(bounds) = design.bounds else {
        return text;
    };
    text.push_str("\n   It is off the same design in exact arithmetic by at most, where some rule has a degree of\n");
    let degrees = STRENGTHS.map(|least| match least {
        0.0 => "any".to_owned(),
        least => format!("1/{}", 1.0 / least),
    });
    let outputs = design.lowered.tables().outputs.iter().enumerate();
    for ((o, output), bounds) in outputs.zip(bounds) {
        if !concluded(design.system, o, None) {
            let _ = writeln!(text, "   - {}: no rule concludes it", plain(&output.name));
            continue;
        }
        let each: Vec<String> = degrees
            .iter()
            .zip(bounds)
            .map(|(degree, &bound)| match bound.is_finite() {
                true => format!("{degree}: {}", number(bound)),
                false => format!("{degree}: not bounded"),
            })
            .collect();
        let _ = writeln!(text, "   - {}: {}", plain(&output.name), each.join(", "));
    }
    text
}

fn range([low, high]: [i32; 2], format: Format) -> String {
    format!(
        "{} to {}",
        exact(format.value(low)),
        exact(format.value(high))
    )
}

fn format_of(
    text: &mut String,
    names: &Names,
    name: &str,
    what: &str,
    format: Format,
    [low, high]: [i32; 2],
) {
    let macros = ["fraction", "least", "most"].map(|of| names.shout(&format!("{name}_{of}")));
    let [fraction, least, most] = macros;
    let _ = write!(
        text,
        "\n/* The {what}.\n   A step is 2^-{fraction}. */\n#define {fraction} ({})\n#define {least} {}\n#define {most} {}\n",
        format.fraction,
        source::constant(low),
        source::constant(high),
    );
}

fn list(text: &mut String, what: &str, names: &[String]) {
    let _ = write!(text, "\n/* {what} */\nenum\n{{\n");
    for (place, name) in names.iter().enumerate() {
        let comma = if place + 1 < names.len() { "," } else { "" };
        let _ = writeln!(text, "    {name} = {place}{comma}");
    }
    text.push_str("};\n");
}

/// `2 inputs, 1 output, 6 rules`.
pub fn sizes(design: &Design<'_>) -> String {
    let tables = design.lowered.tables();
    let rules = tables.blocks.iter().map(|block| block.rules.len()).sum();
    [
        count(tables.inputs.len(), "input"),
        count(tables.outputs.len(), "output"),
        count(rules, "rule"),
    ]
    .join(", ")
}
