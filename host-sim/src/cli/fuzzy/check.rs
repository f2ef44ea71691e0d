//! `host-sim fuzzy check`

use super::convert::Route;
use super::design::Design;
use super::table::{right, table};
use crate::cli::{BadInput, number as between, print, whole};
use anyhow::bail;
use clap::{Args, ValueEnum};
use comfy_table::{Cell, Table};
use host_sim::fuzzy::check::{
    Class, Coverage, Errors, Gap, POINTS, Report, STRENGTHS, Turn, check,
};
use host_sim::fuzzy::describe::{self, number, percent};
use host_sim::fuzzy::emit::{self, rust};
use host_sim::fuzzy::evaluate::rules;
use host_sim::fuzzy::model::System;
use std::collections::BTreeSet;

#[derive(Args)]
#[command(
    after_help = "Exit code: 0, whatever is found; 1 if something is found that --deny names, or an error above \
--max-error; 2 if the file is no design."
)]
pub struct CheckArguments {
    #[command(flatten)]
    design: super::DesignArguments,
    /// Findings that make the command fail, separated by commas.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "FINDING,…")]
    deny: Vec<Finding>,
    /// Fail if fixed point may be off by more than this, in per cent of an output's range: the largest of what is printed as
    /// "nowhere above".
    #[arg(long, value_parser = between(1e-9, 100.0), value_name = "PERCENT", allow_hyphen_values = true)]
    max_error: Option<f64>,
    /// Which part of the library is to evaluate the design as a Rust module, see `convert`: the fast one has an error of its own.
    #[arg(long, value_enum, default_value_t = Route::Auto)]
    route: Route,
    /// Points of the grid on which fixed point is compared with f64 and rules with each other.
    #[arg(long, default_value_t = POINTS as u64, value_parser = whole(16, 10_000_000), allow_hyphen_values = true)]
    points: u64,
}

/// What can be found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
enum Finding {
    /// Regions where no rule about an output fires.
    Gaps,
    /// Rules that never fire, or are always outdone.
    DeadRules,
    /// Terms out of range, never asked about or never concluded.
    UnreachableTerms,
    /// Tables whose conclusions rise and fall along a row or a column.
    NonMonotone,
    /// A design that fixed point cannot hold.
    NoFixedPoint,
}

/// [`STRENGTHS`] as they are printed.
const SHOWN_STRENGTHS: [&str; STRENGTHS.len()] = ["≥ 1/2", "≥ 1/8", "≥ 1/64", "> 0"];

/// The line of the fast route.
const FAST: &str = "fast route";

/// Most lines of a list.
const MOST_LINES: usize = 20;

pub fn execute(arguments: &CheckArguments) -> anyhow::Result<()> {
    let design = Design::load(&arguments.design)?;
    let report = check(
        &design.system,
        design.fixed.as_ref().ok(),
        arguments.points as usize,
    );
    let shown = Shown {
        system: &design.system,
        report: &report,
        fast: fast(&design, arguments)?,
    };
    print(format_args!("{}\n", shown.heading(&design.title())))?;
    let mut found = BTreeSet::new();
    for section in [
        shown.gaps(),
        shown.dead_rules(),
        shown.unreachable_terms(),
        shown.turns(),
    ] {
        print(&section.text)?;
        found.extend(section.finding);
    }
    print(shown.errors())?;
    print(design.note())?;
    if design.fixed.is_err() {
        found.insert(Finding::NoFixedPoint);
    }
    let denied: Vec<String> = arguments
        .deny
        .iter()
        .filter(|finding| found.contains(finding))
        .filter_map(|finding| Some(finding.to_possible_value()?.get_name().to_owned()))
        .collect();
    let mut failed = Vec::new();
    if !denied.is_empty() {
        failed.push(format!(
            "{}: found, and denied by --deny",
            denied.join(", ")
        ));
    }
    if let Some(limit) = arguments.max_error {
        failed.extend(shown.beyond(limit));
    }
    if !failed.is_empty() {
        bail!(failed.join("; "));
    }
    Ok(())
}

/// What a module of the fast route may be off, an entry an output; `None` if the design is evaluated by the general one.
fn fast(design: &Design, arguments: &CheckArguments) -> anyhow::Result<Option<Vec<f64>>> {
    let (Ok(lowered), Route::Auto | Route::Fast) = (&design.fixed, arguments.route) else {
        return Ok(None);
    };
    let emitted = emit::Design {
        system: &design.system,
        lowered,
        name: &design.stem,
        command: "",
        bounds: None,
    };
    match (emitted.rule_base(), arguments.route) {
        (Ok(base), _) => {
            let outputs = 0..base.tables.len();
            Ok(Some(
                outputs.map(|o| rust::output_error(&base, o)).collect(),
            ))
        }
        (Err(why), Route::Fast) => {
            let file = arguments.design.file.display();
            Err(BadInput(super::convert::unfit(&file, &why)).into())
        }
        (Err(_), _) => Ok(None),
    }
}

/// A part of the report, and what it found, if anything.
struct Section {
    text: String,
    finding: Option<Finding>,
}

impl Section {
    /// A line that says what was looked for and the table of what was found; more than fits is counted.
    fn new(title: &str, finding: Finding, rows: usize, mut table: Table) -> Self {
        if rows == 0 {
            return Self::none(title);
        }
        let rest = rows.saturating_sub(MOST_LINES);
        let more = if rest > 0 {
            format!("… and {rest} more\n")
        } else {
            String::new()
        };
        table.set_content_arrangement(comfy_table::ContentArrangement::Dynamic);
        Self {
            text: format!("{title}: {rows}\n{table}\n{more}"),
            finding: Some(finding),
        }
    }

    fn none(title: &str) -> Self {
        Self {
            text: format!("{title}: none\n"),
            finding: None,
        }
    }
}

struct Shown<'a> {
    system: &'a System,
    report: &'a Report,
    /// See [`fast`].
    fast: Option<Vec<f64>>,
}

/// A class of points that says something: its [`SHOWN_STRENGTHS`], what was measured and what it is nowhere above.
type Line<'a> = (&'static str, &'a Class, f64);

/// The classes of an output, without those that add no point to the one before.
fn lines(errors: &Errors) -> Vec<Line<'_>> {
    let all = SHOWN_STRENGTHS
        .into_iter()
        .zip(&errors.measured.classes)
        .zip(errors.bounds);
    let mut seen = 0;
    all.filter_map(|((strength, class), bound)| {
        let new = class.points != seen;
        seen = class.points;
        new.then_some((strength, class, bound))
    })
    .collect()
}

impl Shown<'_> {
    fn heading(&self, title: &str) -> String {
        format!(
            "{title}: inputs: {}, outputs: {}, rules: {}",
            self.system.inputs.len(),
            self.system.outputs.len(),
            rules(self.system).count()
        )
    }

    fn gaps(&self) -> Section {
        let title = "gaps, where no rule fires";
        let Some(Coverage { gaps, bare, .. }) = &self.report.coverage else {
            return Section {
                text: format!("{title}: not looked for: too many pieces\n"),
                finding: None,
            };
        };
        let mut text = table(["output", "where", "share", "for example"]);
        for gap in gaps.iter().take(MOST_LINES) {
            text.add_row([
                Cell::new(self.outputs(gap)),
                Cell::new(self.region(gap)),
                right(percent(gap.share)),
                Cell::new(describe::point(self.system, &gap.example())),
            ]);
        }
        let mut section = Section::new(title, Finding::Gaps, gaps.len(), text);
        for (input, stretch) in bare.iter().take(MOST_LINES) {
            let name = &self.system.inputs[*input].name;
            let place = describe::stretch(stretch);
            section.text += &format!("no term of {name} at {place}\n");
        }
        section
    }

    fn outputs(&self, gap: &Gap) -> String {
        if gap.outputs.len() == self.system.outputs.len() && gap.outputs.len() > 1 {
            return "all".to_owned();
        }
        let names = gap
            .outputs
            .iter()
            .map(|&output| self.system.outputs[output].name.as_str());
        names.collect::<Vec<_>>().join(", ")
    }

    /// A line an input that is not of any value.
    fn region(&self, gap: &Gap) -> String {
        let inputs = self.system.inputs.iter().zip(&gap.region);
        let partial = inputs.filter(|(input, stretch)| stretch.share(input) < 1.0);
        let lines: Vec<String> = partial
            .map(|(input, stretch)| format!("{}: {}", input.name, describe::stretch(stretch)))
            .collect();
        if lines.is_empty() {
            "everywhere".to_owned()
        } else {
            lines.join("\n")
        }
    }

    fn dead_rules(&self) -> Section {
        let coverage = self.report.coverage.as_ref();
        let never: Vec<usize> = coverage.map_or_else(Vec::new, |coverage| {
            let rules = coverage.fires.iter().enumerate();
            rules
                .filter(|(_, fires)| !**fires)
                .map(|(rule, _)| rule)
                .collect()
        });
        let reason = |rule: usize| match rules(self.system).nth(rule) {
            Some((_, rule)) if rule.weight <= 0.0 => "its weight is zero".to_owned(),
            _ => "never fires in the ranges".to_owned(),
        };
        let never = never.into_iter().map(|rule| (rule, reason(rule)));
        let outdone = self.report.dominated.iter().map(|&(rule, by)| {
            let by = format!(
                "on the grid never above rule {}, which concludes the same",
                by + 1
            );
            (rule, by)
        });
        let mut dead: Vec<(usize, String)> = never.chain(outdone).collect();
        dead.sort();
        let mut text = table(["rule", "why", "reads"]);
        for (index, why) in dead.iter().take(MOST_LINES) {
            text.add_row([
                right(index + 1),
                Cell::new(why),
                Cell::new(self.rule(*index)),
            ]);
        }
        Section::new("dead rules", Finding::DeadRules, dead.len(), text)
    }

    /// A rule, with its line in the file.
    fn rule(&self, index: usize) -> String {
        let Some((_, rule)) = rules(self.system).nth(index) else {
            return String::new();
        };
        let text = describe::rule(self.system, rule);
        match describe::line(rule.place).as_str() {
            "" => text,
            line => format!("{line}: {text}"),
        }
    }

    fn unreachable_terms(&self) -> Section {
        let outside = self
            .report
            .coverage
            .iter()
            .flat_map(|coverage| &coverage.outside);
        let mut terms: Vec<(String, &str)> = outside
            .map(|&(input, term)| {
                (
                    self.input_term(input, term),
                    "reaches nothing of its input's range",
                )
            })
            .collect();
        let unasked = self.report.unasked.iter();
        terms.extend(
            unasked.map(|&(input, term)| (self.input_term(input, term), "no rule asks about it")),
        );
        terms.extend(self.report.unconcluded.iter().map(|&(output, term)| {
            let text = describe::output_term(self.system, output, term);
            let place = self.system.outputs[output].terms[term].place;
            (
                with_line(text, &describe::line(place)),
                "no rule that can fire concludes it",
            )
        }));
        let mut text = table(["term", "why"]);
        for (term, why) in terms.iter().take(MOST_LINES) {
            text.add_row([term, *why]);
        }
        Section::new(
            "unreachable terms",
            Finding::UnreachableTerms,
            terms.len(),
            text,
        )
    }

    fn input_term(&self, input: usize, term: usize) -> String {
        let text = describe::input_term(self.system, input, term);
        let place = self.system.inputs[input].terms[term].place;
        with_line(text, &describe::line(place))
    }

    fn turns(&self) -> Section {
        let title = "non-monotone cells";
        let turns: Vec<&Turn> = self.report.turns.iter().flatten().flatten().collect();
        let mut text = table(["output", "along", "where", "conclusions"]);
        for turn in turns.iter().take(MOST_LINES) {
            let along = &self.system.inputs[turn.along];
            let cells = turn
                .cells
                .map(|(term, value)| format!("{} {}", along.terms[term].name, number(value)));
            let held = turn
                .held
                .map(|(input, term)| describe::input_term(self.system, input, term));
            text.add_row([
                self.system.outputs[turn.output].name.clone(),
                along.name.clone(),
                held.unwrap_or_default(),
                cells.join(" → "),
            ]);
        }
        let mut section = Section::new(title, Finding::NonMonotone, turns.len(), text);
        let without = self.system.outputs.iter().zip(&self.report.turns);
        let without: Vec<&str> = without
            .filter(|(_, turns)| turns.is_none())
            .map(|(output, _)| output.name.as_str())
            .collect();
        if !without.is_empty() {
            // Not "none" where nothing could be.
            if without.len() == self.system.outputs.len() {
                section.text = format!("{title}: not looked for\n");
            }
            section.text += &format!(
                "no table of one or two inputs whose conclusions are numbers or sets: {}\n",
                without.join(", ")
            );
        }
        section
    }

    fn errors(&self) -> String {
        let Some(errors) = &self.report.errors else {
            return String::new();
        };
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
        for (o, (output, errors)) in self.system.outputs.iter().zip(errors).enumerate() {
            let span = output.range.end() - output.range.start();
            for (i, (strength, class, bound)) in lines(errors).into_iter().enumerate() {
                text.add_row([
                    Cell::new(if i == 0 { output.name.as_str() } else { "" }),
                    right(strength),
                    right(class.points),
                    right(format!("{:.1e}", class.rms())),
                    right(format!("{:.1e}", class.worst)),
                    right(share(class.worst / span)),
                    Cell::new(describe::point(self.system, &class.at).replace(", ", "\n")),
                    right(format!("{bound:.1e}")),
                    right(share(bound / span)),
                ]);
            }
            if let Some(bound) = self.fast.as_ref().and_then(|fast| fast.get(o)) {
                let mut row = ["", FAST, "", "", "", "", ""].map(Cell::new).to_vec();
                row.push(right(format!("{bound:.1e}")));
                row.push(right(share(bound / span)));
                text.add_row(row);
            }
        }
        let fast = match &self.fast {
            Some(_) => {
                "\"fast route\" is what a Rust module may be off that the library's tables of four rules evaluate, as `convert \
                 --to rust`\nmakes it of this design; --route general is for the other one.\n"
            }
            None => "",
        };
        format!(
            "fixed point against f64, on a grid of {} points:\n{text}\n\
             \"nowhere above\" holds between the points too: it is found from the terms' errors and the least weight, box by \
             box.\n{fast}",
            self.report.points
        )
    }

    /// What may be off by more than `limit` per cent of its output's range.
    fn beyond(&self, limit: f64) -> Option<String> {
        let Some(errors) = &self.report.errors else {
            return Some("no fixed point, and --max-error asks how far it is off".to_owned());
        };
        let mut beyond = Vec::new();
        for (o, (output, errors)) in self.system.outputs.iter().zip(errors).enumerate() {
            let span = output.range.end() - output.range.start();
            let fast = self.fast.as_ref().and_then(|fast| fast.get(o));
            let bounds = lines(errors)
                .into_iter()
                .map(|(strength, _, bound)| (strength, bound))
                .chain(fast.map(|bound| (FAST, *bound)));
            let Some((which, worst)) = bounds.max_by(|a, b| a.1.total_cmp(&b.1)) else {
                continue;
            };
            if 100.0 * worst / span > limit {
                let name = &output.name;
                beyond.push(format!("{name} {} ({which})", share(worst / span)));
            }
        }
        (!beyond.is_empty()).then(|| {
            format!(
                "off by up to {}, and --max-error allows {} %",
                beyond.join(", "),
                number(limit)
            )
        })
    }
}

fn with_line(text: String, line: &str) -> String {
    if line.is_empty() {
        text
    } else {
        format!("{line}: {text}")
    }
}

/// A small share as a percentage, to two digits.
fn share(share: f64) -> String {
    let percent = 100.0 * share;
    if percent == 0.0 {
        return "0 %".to_owned();
    }
    let places = (1.0 - percent.log10().floor()).clamp(0.0, 8.0) as usize;
    format!("{percent:.places$} %")
}
