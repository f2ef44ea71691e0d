//! Changes to a system that make it one that a format can say: names, and where centroids take their samples. Each change
//! is named, for none of them is nothing.

use super::writing::is_name;
use super::{fcl, fll, limits};
use crate::fuzzy::model::{Defuzzifier, Sampling, System};
use std::collections::HashSet;

/// For [`fll::write`]; gives what was changed.
pub fn to_fll(system: &mut System) -> Vec<String> {
    let mut changes = names_to_fll(system);
    middles(system, &mut changes);
    changes
}

/// The names alone, for [`fll::write`]: what the system computes stays. Gives what was changed.
pub fn names_to_fll(system: &mut System) -> Vec<String> {
    let mut changes = names(system, fll::RESERVED_NAMES);
    one_line(&mut system.name, "engine", &mut changes);
    for block in &mut system.blocks {
        one_line(&mut block.name, "rule block", &mut changes);
    }
    changes
}

/// For [`fcl::write`]; names are all that it changes. Gives what was changed.
pub fn to_fcl(system: &mut System) -> Vec<String> {
    let mut changes = names(system, fcl::RESERVED_NAMES);
    let mut word = |name: &mut String, what: &str| {
        if !name.is_empty() && !is_name(name, fcl::RESERVED_NAMES) {
            rename(
                name,
                what,
                fcl::RESERVED_NAMES,
                &mut HashSet::new(),
                &mut changes,
            );
        }
    };
    word(&mut system.name, "function block");
    for block in &mut system.blocks {
        word(&mut block.name, "rule block");
    }
    // The norm and jFuzzyLogic want one; FuzzyLite does not.
    for (i, block) in system.blocks.iter_mut().enumerate() {
        if block.name.is_empty() {
            block.name = format!("rules_{}", i + 1);
            changes.push(format!(
                "the rule block {} without a name is now `{}`",
                i + 1,
                block.name
            ));
        }
    }
    changes
}

fn middles(system: &mut System, changes: &mut Vec<String>) {
    for output in &mut system.outputs {
        if let Defuzzifier::Centroid { points, sampling } = &mut output.defuzzifier
            && *sampling == Sampling::Ends
        {
            *sampling = Sampling::Middles;
            changes.push(format!(
                "the centroid of `{}` takes its {points} samples in the middles of equal pieces, no longer from end to end: \
                 its value changes a little",
                output.name
            ));
        }
    }
}

fn one_line(name: &mut String, what: &str, changes: &mut Vec<String>) {
    let mended = name.replace(|c: char| c == '#' || c.is_control(), " ");
    let mended = mended.trim();
    if mended != name {
        changes.push(format!(
            "the {what} `{}` is now `{mended}`",
            name.escape_debug()
        ));
        *name = mended.to_owned();
    }
}

fn names(system: &mut System, reserved: &[&[&str]]) -> Vec<String> {
    let mut changes = Vec::new();
    let inputs = system.inputs.iter_mut().map(|i| &mut i.name);
    let outputs = system.outputs.iter_mut().map(|o| &mut o.name);
    group(
        "variable",
        inputs.chain(outputs).collect(),
        reserved,
        &mut changes,
    );
    for input in &mut system.inputs {
        let what = format!("term of `{}`", input.name);
        let terms = input.terms.iter_mut().map(|t| &mut t.name).collect();
        group(&what, terms, reserved, &mut changes);
    }
    for output in &mut system.outputs {
        let what = format!("term of `{}`", output.name);
        let terms = output.terms.iter_mut().map(|t| &mut t.name).collect();
        group(&what, terms, reserved, &mut changes);
    }
    changes
}

/// Names that must differ from each other. Good ones stay.
fn group(what: &str, all: Vec<&mut String>, reserved: &[&[&str]], changes: &mut Vec<String>) {
    let mut taken: HashSet<String> = HashSet::new();
    let (good, bad): (Vec<_>, Vec<_>) = all.into_iter().partition(|n| is_name(n, reserved));
    taken.extend(good.into_iter().map(|n| n.clone()));
    for name in bad {
        rename(name, what, reserved, &mut taken, changes);
    }
}

/// The nearest free name: `_` for what is no letter, digit or `_`; then a number, if need be.
fn rename(
    name: &mut String,
    what: &str,
    reserved: &[&[&str]],
    taken: &mut HashSet<String>,
    changes: &mut Vec<String>,
) {
    /// Leaves room for a number.
    const LONGEST: usize = limits::NAME - 8;
    let mut stem: String = name
        .chars()
        .map(|c| if c.is_alphanumeric() { c } else { '_' })
        .take(LONGEST)
        .collect();
    if stem.chars().next().is_none_or(char::is_numeric) {
        stem.insert(0, '_');
    }
    let new = std::iter::once(stem.clone())
        .chain((2..).map(|n| format!("{stem}_{n}")))
        .find(|n| is_name(n, reserved) && !taken.contains(n))
        .unwrap_or(stem);
    changes.push(format!(
        "the {what} `{}` is now `{new}`",
        name.escape_debug()
    ));
    taken.insert(new.clone());
    *name = new;
}
