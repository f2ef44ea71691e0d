//! Findings as they are printed.

use super::findings::{Findings, Gap, NonMonotone, Search, Side, rounded};
use crate::cli::fuzzy::table::{right, table};
use comfy_table::{Cell, ContentArrangement, Table};
use host_sim::fuzzy::check::{LEAST_TURN, STRENGTHS};
use host_sim::fuzzy::describe::{number, percent};

/// [`STRENGTHS`] as they are printed.
pub const SHOWN_STRENGTHS: [&str; STRENGTHS.len()] = ["≥ 1/2", "≥ 1/8", "≥ 1/64", "> 0"];
/// The line of the fast route.
pub const FAST: &str = "fast route";
/// Most lines of a list.
const MOST_LINES: usize = 20;

/// All of them, one after the other.
pub fn all(findings: &Findings) -> String {
    let parts = [
        format!(
            "{}: inputs: {}, outputs: {}, rules: {}\n",
            findings.design, findings.inputs, findings.outputs, findings.rules
        ),
        gaps(findings),
        dead_rules(findings),
        unreachable_terms(findings),
        beyond_range(findings),
        non_monotone(findings),
        errors(findings),
        match &findings.no_fixed_point {
            Some(why) => format!("no fixed point: {why}\n"),
            None => String::new(),
        },
    ];
    parts.concat()
}

/// A line that says what was looked for and the table of what was found; more than fits is counted.
fn section(title: &str, rows: usize, mut table: Table) -> String {
    if rows == 0 {
        return format!("{title}: none\n");
    }
    let more = match rows.saturating_sub(MOST_LINES) {
        0 => String::new(),
        rest => format!("… and {rest} more; --json FILE writes all\n"),
    };
    table.set_content_arrangement(ContentArrangement::Dynamic);
    format!("{title}: {rows}\n{table}\n{more}")
}

fn gaps(findings: &Findings) -> String {
    let mut text = table(["output", "where", "share", "for example"]);
    for gap in findings.gaps.iter().take(MOST_LINES) {
        text.add_row([
            Cell::new(outputs(findings, gap)),
            Cell::new(region(gap)),
            right(percent(gap.share)),
            Cell::new(&gap.example_text),
        ]);
    }
    let title = match findings.search {
        Search::Exact => "gaps, where no rule fires".to_owned(),
        _ => format!(
            "gaps, where no rule fires, as {} points of {} show them (too many pieces for the exact search)",
            findings.points, findings.points_asked
        ),
    };
    let mut text = section(&title, findings.gaps.len(), text);
    for side in findings.without_terms.iter().take(MOST_LINES) {
        text += &format!("no term of {} at {}\n", side.input, side.text);
    }
    text
}

fn outputs(findings: &Findings, gap: &Gap) -> String {
    if gap.outputs.len() == findings.outputs && gap.outputs.len() > 1 {
        return "all".to_owned();
    }
    gap.outputs.join(", ")
}

/// A line an input that is not of any value.
fn region(gap: &Gap) -> String {
    let side = |side: &Side| format!("{}: {}", side.input, side.text);
    let partial = gap.region.iter().filter(|side| side.is_part);
    let lines: Vec<String> = partial.map(side).collect();
    match (gap.region.is_empty(), lines.is_empty()) {
        (true, _) => "somewhere".to_owned(),
        (false, true) => "everywhere".to_owned(),
        (false, false) => lines.join("\n"),
    }
}

fn dead_rules(findings: &Findings) -> String {
    let mut text = table(["rule", "why", "reads"]);
    for dead in findings.dead_rules.iter().take(MOST_LINES) {
        text.add_row([
            right(dead.rule),
            Cell::new(&dead.why),
            Cell::new(at_line(dead.line, &dead.reads)),
        ]);
    }
    section("dead rules", findings.dead_rules.len(), text)
}

fn unreachable_terms(findings: &Findings) -> String {
    let mut text = table(["term", "why"]);
    for term in findings.unreachable_terms.iter().take(MOST_LINES) {
        text.add_row([at_line(term.line, &term.term), term.why.to_owned()]);
    }
    section("unreachable terms", findings.unreachable_terms.len(), text)
}

fn beyond_range(findings: &Findings) -> String {
    let mut text = table(["term", "concludes", "range", "what becomes of it"]);
    for beyond in findings.beyond_range.iter().take(MOST_LINES) {
        let values = match beyond.least == beyond.most {
            true => number(beyond.least),
            false => format!("{} to {}", number(beyond.least), number(beyond.most)),
        };
        let [from, to] = beyond.range.map(number);
        let becomes = match beyond.limited {
            true => "the output is limited to its range",
            false => "the output leaves its range",
        };
        text.add_row([
            at_line(beyond.line, &beyond.term),
            values,
            format!("{from} to {to}"),
            becomes.to_owned(),
        ]);
    }
    let title = "conclusions beyond the range";
    section(title, findings.beyond_range.len(), text)
}

fn non_monotone(findings: &Findings) -> String {
    let (title, on_grid) = ("non-monotone cells", "turns on the grid");
    let mut cells = table(["output", "along", "where", "conclusions"]);
    let all = findings.non_monotone.iter();
    let all = all.flat_map(|of| of.cells.iter().map(|cells| (&of.output, cells)));
    for (output, turn) in all.clone().take(MOST_LINES) {
        let each = turn.conclusions.each_ref();
        let each = each.map(|(term, value)| format!("{term} {}", number(*value)));
        text_row(
            &mut cells,
            [
                output,
                &turn.along,
                turn.held.as_deref().unwrap_or_default(),
                &each.join(" → "),
            ],
        );
    }
    let rows = all.count();
    let is_table = |of: &NonMonotone| of.search == Search::Table;
    let mut text = match findings.non_monotone.iter().any(is_table) {
        true => section(title, rows, cells),
        // Not "none" where nothing could be.
        false => format!("{title}: no output has a table\n"),
    };
    let mut ripples = table(["output", "along", "lines", "the greatest, at", "values"]);
    let mut rows = 0;
    for of in &findings.non_monotone {
        for ripple in &of.ripples {
            rows += 1;
            if rows > MOST_LINES {
                continue;
            }
            let values = ripple.values;
            let each = values.map(|(x, y)| format!("{}: {}", number(x), number(y)));
            text_row(
                &mut ripples,
                [
                    &of.output,
                    &ripple.along,
                    &format!("{} of {}", ripple.turning, ripple.lines),
                    &ripple.at_text.replace(", ", "\n"),
                    &each.join(" → "),
                ],
            );
        }
    }
    if findings.non_monotone.iter().any(|of| of.sampled) {
        let title = format!(
            "{on_grid} of {} points of {}, by more than {} % of the range, sampled",
            findings.points,
            findings.points_asked,
            100.0 * LEAST_TURN
        );
        text += &section(&title, rows, ripples);
    } else if !findings.non_monotone.is_empty() {
        text += &format!("{on_grid}: not looked for, it has too many points\n");
    }
    for of in &findings.non_monotone {
        if let Some(why) = &of.why {
            text += &format!("{}: no table: {why}\n", of.output);
        }
    }
    text
}

fn text_row<const N: usize>(table: &mut Table, cells: [&str; N]) {
    table.add_row(cells);
}

fn errors(findings: &Findings) -> String {
    if findings.errors.is_empty() {
        return String::new();
    }
    let mut text = table([
        "output",
        "strongest rule",
        "points",
        "RMS",
        "greatest",
        "of its range",
        "at",
        "nowhere above",
        "of its range",
    ]);
    for errors in &findings.errors {
        let span = errors.range[1] - errors.range[0];
        if !errors.concluded {
            text.add_row([errors.output.as_str(), "no rule concludes it"]);
            continue;
        }
        for (i, (place, class)) in errors.shown().enumerate() {
            let measured = |text: String| match class.points {
                0 => "–".to_owned(),
                _ => text,
            };
            text.add_row([
                Cell::new(if i == 0 { errors.output.as_str() } else { "" }),
                right(SHOWN_STRENGTHS[place]),
                right(class.points),
                right(measured(rounded(class.rms))),
                right(measured(rounded(class.greatest))),
                right(measured(share(class.greatest / span))),
                Cell::new(measured(class.at_text.replace(", ", "\n"))),
                right(rounded(class.nowhere_above)),
                right(share(class.nowhere_above / span)),
            ]);
        }
        if let Some(bound) = errors.fast_route {
            let mut row = ["", FAST, "", "", "", "", ""].map(Cell::new).to_vec();
            row.push(right(rounded(bound)));
            row.push(right(share(bound / span)));
            text.add_row(row);
        }
    }
    let fast = match findings
        .errors
        .iter()
        .any(|errors| errors.fast_route.is_some())
    {
        true => {
            "\"fast route\" is what a Rust module may be off that the library's tables of four rules evaluate, as `convert \
             --to rust\n--route fast` makes it of this design.\n"
        }
        false => "",
    };
    format!(
        "fixed point against f64, on {}:\n{text}\n\
         \"nowhere above\" holds between the points too: it is found from the terms' errors and the least weight, box by \
         box.\n{fast}",
        grid(findings)
    )
}

/// How many points were looked at, of how many; why not more, and what is not among them.
fn grid(findings: &Findings) -> String {
    let (points, asked) = (findings.points, findings.points_asked);
    let thinner = match findings.points_limited {
        true => "; each takes long, with so many rules and samples",
        false => "",
    };
    let corners = match (findings.corners, findings.points_limited) {
        (true, _) => "",
        (false, true) => "; too few for the terms' corners, which are left out",
        (false, false) => "; too few for the terms' corners, which are left out: --points for more",
    };
    format!("a grid of {points} points (of {asked} that were asked for{thinner}{corners})")
}

fn at_line(line: usize, text: &str) -> String {
    match line {
        0 => text.to_owned(),
        line => format!("line {line}: {text}"),
    }
}

/// A small share as a percentage, to two digits.
pub fn share(share: f64) -> String {
    let percent = 100.0 * share;
    if percent == 0.0 {
        return "0 %".to_owned();
    }
    let places = (1.0 - percent.log10().floor()).clamp(0.0, 8.0) as usize;
    format!("{percent:.places$} %")
}
