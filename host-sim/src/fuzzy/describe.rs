//! Parts of a system in words.

use super::check::Stretch;
use super::model::{Antecedent, Place, Rule, System};

/// A number in full: as short as it can be without becoming another one.
pub use super::files::writing::number as exact;

/// A number with six significant digits at most: for what has no scale of its own, as an error. What lies in a range is
/// told to the range's or the step's resolution, see [`number_to`].
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

/// A number so that what matters of it is told: with six significant digits where they are right to a tenth of `resolution`,
/// else with as many as are. What is next to nothing beside it is what `f64` leaves of zero, and is told as that. A resolution that is
/// no positive number asks for nothing more.
pub fn number_to(x: f64, resolution: f64) -> String {
    if x.abs() < 1e-9 * resolution {
        return number(0.0);
    }
    let short = number(x);
    let off = short.parse().map_or(0.0, |short: f64| (short - x).abs());
    if !(resolution > 0.0 && off > 0.1 * resolution) {
        return short;
    }
    let places = (1.0 - resolution.log10().floor()).clamp(0.0, 17.0) as usize;
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

/// A point: `temperature = 36, humidity = 15`, to a ten thousandth of each range.
pub fn point(system: &System, values: &[f64]) -> String {
    values_of(system, values, |x, span| number_to(x, 1e-4 * span))
}

/// A point with every digit: as it was given, or where rounding could move it out of what it is an example of.
pub fn given_point(system: &System, values: &[f64]) -> String {
    values_of(system, values, |x, _| exact(x))
}

fn values_of(system: &System, values: &[f64], text: impl Fn(f64, f64) -> String) -> String {
    let values = system.inputs.iter().zip(values);
    let each: Vec<String> = values
        .map(|(input, &x)| {
            let span = input.range.end() - input.range.start();
            format!("{} = {}", input.name, text(x, span))
        })
        .collect();
    each.join(", ")
}

/// A stretch: `30 to 80`, without its ends where they do not belong to it; `exactly 24` for one value.
pub fn stretch(stretch: &Stretch) -> String {
    if stretch.from == stretch.to {
        return format!("exactly {}", exact(stretch.from));
    }
    let end = |x| number_to(x, 1e-4 * (stretch.to - stretch.from));
    let above = if stretch.with_from { "" } else { "above " };
    let below = if stretch.with_to { "" } else { "below " };
    format!("{above}{} to {below}{}", end(stretch.from), end(stretch.to))
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
        weight => format!(" with {}", exact(weight)),
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
    fn numbers_are_as_long_as_what_they_are_of_needs() {
        for (x, resolution, text) in [
            (1_000_000.512_345_6, 1e-4, "1000000.51235"),
            (1_000_000.512_345_6, 1000.0, "1000001"),
            (45.000_004, 1e-3, "45"),
            (45.000_04, 1e-4, "45.00004"),
            (1e12 + 0.5, 0.1, "1000000000000.5"),
            (1.0 / 3.0, 0.0, "0.333333"),
            (1.0 / 3.0, f64::NAN, "0.333333"),
            (f64::INFINITY, 1.0, "inf"),
            (1.4e-14, 1e-4, "0"),
            (-1.4e-14, 1e-4, "0"),
            (1.4e-14, 1e-6, "1.4e-14"),
        ] {
            assert_eq!(number_to(x, resolution), text, "{x} to {resolution}");
        }
        assert_eq!(exact(1_000_000.512_345_6), "1000000.5123456");
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
