//! Just enough FuzzyLite Language to hand a model to fuzzylite.

use host_sim::fuzzy::model::{
    Antecedent, Conclusion, Conjunction, Defuzzifier, Merge, Shape, System,
};
use std::fmt::Write;

pub fn write(system: &System) -> String {
    let mut text = String::new();
    lines(system, &mut text).unwrap();
    text
}

fn lines(system: &System, out: &mut String) -> std::fmt::Result {
    writeln!(out, "Engine: {}", system.name)?;
    for input in &system.inputs {
        writeln!(out, "InputVariable: {}\n  enabled: true", input.name)?;
        writeln!(
            out,
            "  range: {} {}",
            input.range.start(),
            input.range.end()
        )?;
        writeln!(out, "  lock-range: {}", input.clamp)?;
        for term in &input.terms {
            writeln!(out, "  term: {} {}", term.name, shape(&term.shape))?;
        }
    }
    for output in &system.outputs {
        writeln!(out, "OutputVariable: {}\n  enabled: true", output.name)?;
        writeln!(
            out,
            "  range: {} {}",
            output.range.start(),
            output.range.end()
        )?;
        writeln!(out, "  lock-range: {}", output.clamp)?;
        let merge = match output.merge {
            Merge::Sum => "UnboundedSum",
            Merge::Max => "Maximum",
        };
        writeln!(out, "  aggregation: {merge}")?;
        match output.defuzzifier {
            Defuzzifier::WeightedAverage => {
                writeln!(out, "  defuzzifier: WeightedAverage TakagiSugeno")?
            }
            Defuzzifier::Centroid { points, .. } => {
                writeln!(out, "  defuzzifier: Centroid {points}")?
            }
        }
        match output.default {
            Some(default) => writeln!(out, "  default: {default}\n  lock-previous: false")?,
            None => writeln!(out, "  default: nan\n  lock-previous: false")?,
        }
        for term in &output.terms {
            match &term.conclusion {
                Conclusion::Constant(value) => {
                    writeln!(out, "  term: {} Constant {value}", term.name)?
                }
                Conclusion::Linear {
                    coefficients,
                    constant,
                } => {
                    let all: Vec<String> = coefficients
                        .iter()
                        .chain([constant])
                        .map(f64::to_string)
                        .collect();
                    writeln!(out, "  term: {} Linear {}", term.name, all.join(" "))?;
                }
                Conclusion::Set(set) => writeln!(out, "  term: {} {}", term.name, shape(set))?,
            }
        }
    }
    for block in &system.blocks {
        writeln!(out, "RuleBlock: {}\n  enabled: true", block.name)?;
        writeln!(
            out,
            "  conjunction: {}\n  disjunction: Maximum",
            norm(block.and)
        )?;
        writeln!(
            out,
            "  implication: {}\n  activation: General",
            norm(block.implication)
        )?;
        for rule in &block.rules {
            let conclusions: Vec<String> = rule
                .conclusions
                .iter()
                .map(|&(output, term)| {
                    let output = &system.outputs[output];
                    format!("{} is {}", output.name, output.terms[term].name)
                })
                .collect();
            let antecedent = antecedent(system, &rule.antecedent);
            let conclusions = conclusions.join(" and ");
            writeln!(
                out,
                "  rule: if {antecedent} then {conclusions} with {}",
                rule.weight
            )?;
        }
    }
    Ok(())
}

fn norm(conjunction: Conjunction) -> &'static str {
    match conjunction {
        Conjunction::Min => "Minimum",
        Conjunction::Product => "AlgebraicProduct",
    }
}

fn antecedent(system: &System, part: &Antecedent) -> String {
    let many = |parts: &[Antecedent], word: &str| {
        let parts: Vec<String> = parts.iter().map(|part| antecedent(system, part)).collect();
        format!("( {} )", parts.join(word))
    };
    match part {
        Antecedent::Is {
            input,
            term,
            negated,
        } => {
            let input = &system.inputs[*input];
            let not = if *negated { "not " } else { "" };
            format!("{} is {not}{}", input.name, input.terms[*term].name)
        }
        Antecedent::And(parts) => many(parts, " and "),
        Antecedent::Or(parts) => many(parts, " or "),
    }
}

fn shape(shape: &Shape) -> String {
    match shape {
        Shape::Triangle { left, peak, right } => format!("Triangle {left} {peak} {right}"),
        Shape::Trapezoid {
            left,
            rise,
            fall,
            right,
        } => format!("Trapezoid {left} {rise} {fall} {right}"),
        Shape::Ramp { from, to } => format!("Ramp {from} {to}"),
        Shape::Singleton(at) => format!("Rectangle {at} {at}"),
        Shape::Points(points) => {
            let points: Vec<String> = points.iter().map(|(x, y)| format!("{x} {y}")).collect();
            format!("Discrete {}", points.join(" "))
        }
        Shape::Gaussian { mean, deviation } => format!("Gaussian {mean} {deviation}"),
        Shape::TwoSidedGaussian { left, right } => {
            format!(
                "GaussianProduct {} {} {} {}",
                left.0, left.1, right.0, right.1
            )
        }
        Shape::Bell {
            centre,
            width,
            slope,
        } => format!("Bell {centre} {width} {slope}"),
        Shape::Sigmoid { inflection, slope } => format!("Sigmoid {inflection} {slope}"),
        Shape::Spline { from, to } if from < to => format!("SShape {from} {to}"),
        Shape::Spline { from, to } => format!("ZShape {to} {from}"),
    }
}
