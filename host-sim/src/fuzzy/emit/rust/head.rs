//! What every module begins with: where it is from, what its numbers mean, how far they may be off.

use super::super::words::{count, plain};
use super::super::{Design, names};
use super::{FRACTION, shout};
use crate::fuzzy::describe::exact;
use heck::ToUpperCamelCase;
use std::fmt::Write;

/// A variable as the module has it.
pub struct Signal<'a> {
    /// `input` or `output`.
    pub kind: &'a str,
    /// As the design calls it.
    pub name: &'a str,
    /// Its identifier.
    pub identifier: &'a str,
    /// Fractional bits.
    pub fraction: i32,
    /// Its range, in steps.
    pub range: [i32; 2],
    /// What becomes of values beyond the range.
    pub beyond: String,
}

/// The module's own documentation. `route` and `error` are whole lines.
pub fn head(
    design: &Design<'_>,
    route: &[String],
    signals: &[Signal<'_>],
    error: &[String],
) -> String {
    let tables = design.lowered.tables();
    let rules: usize = tables.blocks.iter().map(|block| block.rules.len()).sum();
    let mut text = format!(
        "//! The fuzzy controller `{}`: {}, {}, {}.\n//!\n//! Made by `{}`:\n\
         //! change the design and make it again rather than this file. It needs the crates `fuzzypilot` and `fixed`.\n//!\n",
        plain(design.name),
        count(tables.inputs.len(), "input"),
        count(tables.outputs.len(), "output"),
        count(rules, "rule"),
        plain(design.command),
    );
    lines(&mut text, route);
    text += "//!\n//! All numbers are whole steps, which each variable has for itself:\n//!\n\
             //! | variable | a step | from | to | beyond |\n//! |---|---|---|---|---|\n";
    for signal in signals {
        let value = |steps: i32| {
            let value = f64::from(steps) * f64::from(-signal.fraction).exp2();
            format!("{} = {}", steps, exact(value))
        };
        let [from, to] = signal.range;
        // Writing to a text cannot fail.
        let _ = writeln!(
            text,
            "//! | {} `{}` | 2^{} | {} | {} | {} |",
            signal.kind,
            plain(signal.name),
            -signal.fraction,
            value(from),
            value(to),
            signal.beyond
        );
    }
    if !error.is_empty() {
        text += "//!\n";
        lines(&mut text, error);
    }
    text
}

fn lines(text: &mut String, lines: &[String]) {
    for line in lines {
        let _ = writeln!(text, "{}", format!("//! {line}").trim_end());
    }
}

/// The constants that say a variable's place and format.
pub fn signals(text: &mut String, signals: &[Signal<'_>], types: &mut names::Taken) {
    let mut place = 0;
    for (i, signal) in signals.iter().enumerate() {
        place = match i.checked_sub(1).and_then(|before| signals.get(before)) {
            Some(before) if before.kind == signal.kind => place + 1,
            _ => 0,
        };
        let name = shout(signal.identifier);
        let (kind, of) = (signal.kind, plain(signal.name));
        let _ = write!(
            text,
            "\n/// Place of `{of}` among the {kind}s.\npub const {name}: usize = {place};\n\
             /// A step of `{of}` is 2^−this.\npub const {name}{}: i32 = {};\n",
            shout(FRACTION),
            signal.fraction
        );
        if (0..=31).contains(&signal.fraction) {
            let camel = types.claim_type(&signal.identifier.to_upper_camel_case());
            let _ = write!(
                text,
                "/// `{of}` as a number: `to_bits` gives its steps, `from_bits` takes them.\n\
                 pub type {camel} = fixed::FixedI32<fixed::types::extra::U{}>;\n",
                signal.fraction
            );
        }
    }
}
