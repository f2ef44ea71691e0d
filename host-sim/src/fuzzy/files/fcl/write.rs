//! A system as FCL. Piecewise linear terms become points, which every tool reads; curves get jFuzzyLogic's names, or, S and Z
//! which it has not, FuzzyLite's.

use super::{DEFAULT_SAMPLES, RESERVED_NAMES, SAMPLES_NOTE};
use crate::fuzzy::files::writing::{
    RuleStyle, WriteError, check, is_name, number, numbers, refuse, refuse_adaptable, rule,
};
use crate::fuzzy::model::{
    Conclusion, Conjunction, Defuzzifier, Merge, Output, Place, RuleBlock, Sampling, Shape, System,
};
use std::ops::RangeInclusive;

const STYLE: RuleStyle = RuleStyle {
    conclusions: ", ",
    mark_and: true,
};

/// Writes a system, which keeps the model's promises. Descriptions, which the language has not, stand as comments.
pub fn write(system: &System) -> Result<String, WriteError> {
    check(system, "FCL", RESERVED_NAMES)?;
    word(&system.name, "function block")?;
    let mut text = Lines::default();
    text.head("FUNCTION_BLOCK", &system.name);
    text.comment(&system.description);
    text.head("VAR_INPUT", "");
    for input in &system.inputs {
        text.line(
            1,
            &format!("{} : REAL; {}", input.name, range(&input.range)),
        );
    }
    text.line(0, "END_VAR");
    text.head("VAR_OUTPUT", "");
    for output in &system.outputs {
        text.line(1, &format!("{} : REAL;", output.name));
    }
    text.line(0, "END_VAR");
    for input in &system.inputs {
        text.head("FUZZIFY", &input.name);
        text.comment(&input.description);
        if input.clamp {
            text.line(1, "LOCK : RANGE;");
        }
        for term in &input.terms {
            text.line(
                1,
                &format!("TERM {} := {};", term.name, shape(&term.shape, term.place)?),
            );
        }
        text.line(0, "END_FUZZIFY");
    }
    let together = accumulations(system);
    for output in &system.outputs {
        defuzzify(&mut text, output, together.is_none())?;
    }
    for (i, block) in system.blocks.iter().enumerate() {
        let merge = together.as_ref().and_then(|m| m.get(i).copied().flatten());
        rule_block(&mut text, system, block, merge)?;
    }
    text.head("END_FUNCTION_BLOCK", "");
    Ok(text.0)
}

fn rule_block(
    text: &mut Lines,
    system: &System,
    block: &RuleBlock,
    merge: Option<Merge>,
) -> Result<(), WriteError> {
    word(&block.name, "rule block")?;
    text.head("RULEBLOCK", &block.name);
    text.comment(&block.description);
    text.line(1, &format!("AND : {};", conjunction(block.and)));
    text.line(1, "OR : MAX;");
    text.line(1, &format!("ACT : {};", conjunction(block.implication)));
    if let Some(merge) = merge {
        text.line(1, accumulation(merge));
    }
    for (i, one) in block.rules.iter().enumerate() {
        text.line(
            1,
            &format!("RULE {} : {};", i + 1, rule(system, one, STYLE)?),
        );
    }
    text.line(0, "END_RULEBLOCK");
    Ok(())
}

fn defuzzify(text: &mut Lines, output: &Output, merge: bool) -> Result<(), WriteError> {
    text.head("DEFUZZIFY", &output.name);
    text.comment(&output.description);
    text.line(1, &range(&output.range));
    if output.clamp {
        text.line(1, "LOCK : RANGE;");
    }
    for term in &output.terms {
        let said = match &term.conclusion {
            Conclusion::Constant(value) => number(*value),
            Conclusion::Set(set) => shape(set, term.place)?,
            Conclusion::Linear { .. } => {
                let found = format!(
                    "FCL has no linear terms: `{}` of `{}`",
                    term.name, output.name
                );
                return refuse(term.place, found, "a constant, or another format");
            }
        };
        text.line(1, &format!("TERM {} := {said};", term.name));
    }
    text.line(1, &method(output.defuzzifier));
    if merge {
        text.line(1, accumulation(output.merge));
    }
    if let Some(default) = output.default {
        text.line(1, &format!("DEFAULT := {};", number(default)));
    }
    text.line(0, "END_DEFUZZIFY");
    Ok(())
}

/// A text in the making.
#[derive(Default)]
struct Lines(String);

impl Lines {
    fn line(&mut self, indent: usize, text: &str) {
        self.0 += &"  ".repeat(indent);
        self.0 += text;
        self.0.push('\n');
    }

    /// A description, if there is one, on a line of its own.
    fn comment(&mut self, description: &str) {
        let plain = description.replace(char::is_control, " ");
        if !plain.trim().is_empty() {
            self.line(1, &format!("// {}", plain.trim()));
        }
    }

    /// The first line of a part, with a name that may be empty; a blank line before it.
    fn head(&mut self, word: &str, name: &str) {
        if !self.0.is_empty() {
            self.0.push('\n');
        }
        match name {
            "" => self.line(0, word),
            name => self.line(0, &format!("{word} {name}")),
        }
    }
}

/// The ACCU of each rule block, the norm's place for it; none if they cannot say what the outputs have.
fn accumulations(system: &System) -> Option<Vec<Option<Merge>>> {
    let mut said = vec![false; system.outputs.len()];
    let mut all = Vec::new();
    for block in &system.blocks {
        let mut merge = None;
        for &(output, _) in block.rules.iter().flat_map(|r| &r.conclusions) {
            let own = system.outputs.get(output)?.merge;
            if merge.is_some_and(|m| m != own) {
                return None;
            }
            merge = Some(own);
            said[output] = true;
        }
        all.push(merge);
    }
    said.into_iter().all(|s| s).then_some(all)
}

fn accumulation(merge: Merge) -> &'static str {
    match merge {
        Merge::Max => "ACCU : MAX;",
        Merge::Sum => "ACCU : SUM;",
    }
}

fn conjunction(conjunction: Conjunction) -> &'static str {
    match conjunction {
        Conjunction::Min => "MIN",
        Conjunction::Product => "PROD",
    }
}

fn method(defuzzifier: Defuzzifier) -> String {
    match defuzzifier {
        Defuzzifier::WeightedAverage => "METHOD : COGS;".to_owned(),
        Defuzzifier::Centroid {
            points: DEFAULT_SAMPLES,
            sampling: Sampling::Middles,
        } => "METHOD : COG;".to_owned(),
        Defuzzifier::Centroid { points, sampling } => {
            let sampling = match sampling {
                Sampling::Middles => "middles",
                Sampling::Ends => "ends",
            };
            format!("METHOD : COG; // {SAMPLES_NOTE} {points} {sampling}")
        }
    }
}

fn range(range: &RangeInclusive<f64>) -> String {
    format!(
        "RANGE := ({} .. {});",
        number(*range.start()),
        number(*range.end())
    )
}

fn points(all: &[(f64, f64)]) -> String {
    let all: Vec<String> = all
        .iter()
        .map(|&(x, y)| format!("({}, {})", number(x), number(y)))
        .collect();
    all.join(" ")
}

fn shape(shape: &Shape, place: Place) -> Result<String, WriteError> {
    let named = |name: &str, all: &[f64]| Ok(format!("{name} {}", numbers(all)));
    match *shape {
        // Of points at one value the last counts; of these two the peak does.
        Shape::Triangle { left, peak, right } if peak == right => {
            named("TRIAN", &[left, peak, right])
        }
        Shape::Trapezoid {
            left,
            rise,
            fall,
            right,
        } if fall == right && left.is_finite() && right.is_finite() => {
            named("TRAPE", &[left, rise, fall, right])
        }
        Shape::Triangle { left, peak, right } => {
            Ok(points(&[(left, 0.0), (peak, 1.0), (right, 0.0)]))
        }
        Shape::Trapezoid {
            left,
            rise,
            fall,
            right,
        } => {
            // Open sides are flat anyway.
            let all = [(left, 0.0), (rise, 1.0), (fall, 1.0), (right, 0.0)];
            let mut known: Vec<(f64, f64)> = all.into_iter().filter(|p| p.0.is_finite()).collect();
            let open_left = left == f64::NEG_INFINITY;
            let open_right = right == f64::INFINITY;
            match (open_left, open_right) {
                (false, false) => {}
                (true, true) => {
                    return refuse(
                        place,
                        "FCL has no term that is 1 everywhere",
                        "a term that ends",
                    );
                }
                (true, false) if fall < right => known = vec![(fall, 1.0), (right, 0.0)],
                (false, true) if left < rise => known = vec![(left, 0.0), (rise, 1.0)],
                _ => return refuse(place, "FCL has no step without an end", "a term that ends"),
            }
            Ok(points(&known))
        }
        Shape::Ramp { from, to } if from < to => Ok(points(&[(from, 0.0), (to, 1.0)])),
        Shape::Ramp { from, to } => Ok(points(&[(to, 1.0), (from, 0.0)])),
        Shape::Singleton(x) => Ok(number(x)),
        Shape::Points(ref all) => Ok(points(all)),
        Shape::Gaussian { mean, deviation } => named("GAUSS", &[mean, deviation]),
        Shape::TwoSidedGaussian { left, right } => {
            named("GAUSS2", &[left.0, left.1, right.0, right.1])
        }
        Shape::Bell {
            centre,
            width,
            slope,
        } => named("GBELL", &[width, slope, centre]),
        Shape::Sigmoid { inflection, slope } => named("SIGM", &[slope, inflection]),
        Shape::Spline { from, to } if from < to => named("SShape", &[from, to]),
        Shape::Spline { from, to } => named("ZShape", &[to, from]),
    }
}

/// A name that may be missing.
fn word(name: &str, what: &str) -> Result<(), WriteError> {
    if name.is_empty() || is_name(name, RESERVED_NAMES) {
        return Ok(());
    }
    refuse_adaptable(
        Place::default(),
        format!("FCL has no such name: the {what} `{}`", name.escape_debug()),
        "letters, digits and `_`, no digit first, no word of the language",
    )
}
