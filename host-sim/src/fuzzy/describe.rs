//! Parts of a system in words.

use super::check::Stretch;
use super::model::{Antecedent, Place, Rule, System};

/// A number with six significant digits at most.
pub fn number(x: f64) -> String {
    if x == 0.0 || !x.is_finite() {
        return format!("{}", x + 0.0);
    }
    let size = x.abs().log10().floor();
    if !(-5.0..9.0).contains(&size) {
        let text = format!("{x:.5e}");
        let (digits, power) = text.split_once('e').unwrap_or((&text, "0"));
        return format!("{}e{power}", trimmed(digits));
    }
    let places = (5.0 - size).max(0.0) as usize;
    trimmed(&format!("{x:.places$}")).to_owned()
}

fn trimmed(digits: &str) -> &str {
    if digits.contains('.') {
        digits.trim_end_matches('0').trim_end_matches('.')
    } else {
        digits
    }
}

/// A share as a percentage.
pub fn percent(share: f64) -> String {
    let percent = 100.0 * share;
    match percent {
        p if p > 0.0 && p < 0.01 => "< 0.01 %".to_owned(),
        p if p > 99.99 && p < 100.0 => "> 99.99 %".to_owned(),
        p => format!("{} %", trimmed(&format!("{p:.2}"))),
    }
}

/// A point: `temperature = 36, humidity = 15`.
pub fn point(system: &System, values: &[f64]) -> String {
    let values = system.inputs.iter().zip(values);
    let each: Vec<String> = values
        .map(|(input, &x)| format!("{} = {}", input.name, number(x)))
        .collect();
    each.join(", ")
}

/// A stretch: `30 to 80`, without its ends where they do not belong to it; `exactly 24` for one value.
pub fn stretch(stretch: &Stretch) -> String {
    if stretch.from == stretch.to {
        return format!("exactly {}", number(stretch.from));
    }
    let above = if stretch.with_from { "" } else { "above " };
    let below = if stretch.with_to { "" } else { "below " };
    format!(
        "{above}{} to {below}{}",
        number(stretch.from),
        number(stretch.to)
    )
}

/// An input's term: `temperature is low`.
pub fn input_term(system: &System, input: usize, term: usize) -> String {
    let of = system.inputs.get(input);
    let term = of
        .and_then(|of| of.terms.get(term))
        .map_or("?", |term| &term.name);
    format!("{} is {term}", of.map_or("?", |of| &of.name))
}

/// An output's term: `speed is off`.
pub fn output_term(system: &System, output: usize, term: usize) -> String {
    let of = system.outputs.get(output);
    let term = of
        .and_then(|of| of.terms.get(term))
        .map_or("?", |term| &term.name);
    format!("{} is {term}", of.map_or("?", |of| &of.name))
}

/// A rule as it would be written.
pub fn rule(system: &System, rule: &Rule) -> String {
    let conclusions: Vec<String> = rule
        .conclusions
        .iter()
        .map(|&(output, term)| output_term(system, output, term))
        .collect();
    let weight = match rule.weight {
        1.0 => String::new(),
        weight => format!(" with {}", number(weight)),
    };
    let antecedent = antecedent(system, &rule.antecedent, false);
    format!("if {antecedent} then {}{weight}", conclusions.join(" and "))
}

/// In parentheses where it stands `inside` another operator and would read wrong without: AND binds tighter.
fn antecedent(system: &System, part: &Antecedent, inside: bool) -> String {
    let many = |parts: &[Antecedent], word: &str, inside: bool| {
        let parts: Vec<String> = parts
            .iter()
            .map(|part| antecedent(system, part, inside))
            .collect();
        parts.join(word)
    };
    match part {
        Antecedent::Is {
            input,
            term,
            negated: false,
        } => input_term(system, *input, *term),
        Antecedent::Is { input, term, .. } => {
            input_term(system, *input, *term).replacen(" is ", " is not ", 1)
        }
        Antecedent::And(parts) => many(parts, " and ", true),
        Antecedent::Or(parts) if inside => format!("({})", many(parts, " or ", false)),
        Antecedent::Or(parts) => many(parts, " or ", false),
    }
}

/// Where something was written: `line 12`; empty for a model that no file holds.
pub fn line(place: Place) -> String {
    match place.line {
        0 => String::new(),
        line => format!("line {line}"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::sample::fan;

    #[test]
    fn numbers_are_short() {
        for (x, text) in [
            (0.0, "0"),
            (-0.0, "0"),
            (1.0, "1"),
            (0.1 + 0.2, "0.3"),
            (-12345.678, "-12345.7"),
            (1234567.0, "1234567"),
            (1.25e-7, "1.25e-7"),
            (2e12, "2e12"),
        ] {
            assert_eq!(number(x), text);
        }
        assert_eq!(
            [0.0, 1e-6, 0.06, 0.999_999, 1.0].map(percent),
            ["0 %", "< 0.01 %", "6 %", "> 99.99 %", "100 %"]
        );
    }

    #[test]
    fn a_rule_reads_as_it_is_meant() {
        let fan = fan();
        let is = |input, term, negated| Antecedent::Is {
            input,
            term,
            negated,
        };
        let mut made = fan.blocks[0].rules[4].clone();
        assert_eq!(
            rule(&fan, &made),
            "if temperature is high and humidity is low then speed is half"
        );
        made.antecedent = Antecedent::And(vec![
            is(0, 0, true),
            Antecedent::Or(vec![is(1, 0, false), is(1, 1, false)]),
        ]);
        made.weight = 0.5;
        assert_eq!(
            rule(&fan, &made),
            "if temperature is not low and (humidity is low or humidity is high) then speed is half with 0.5"
        );
    }
}
