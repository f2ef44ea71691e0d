//! `host-sim fuzzy check`

mod findings;
mod limit;
mod named;
mod progress;
mod text;

use super::convert::Route;
use super::design::Design;
use super::put_where_asked;
use crate::cli::run::json;
use crate::cli::{DESIGN, not_what_is_read, number as between, print, whole};
use anyhow::bail;
use clap::{Args, ValueEnum};
use findings::{Findings, Search};
use host_sim::fuzzy::check::{POINTS, check};
use progress::Progress;
use std::path::PathBuf;

#[derive(Args)]
#[command(
    after_help = "Exit code: 0, whatever is found; 1 if something is found that --deny names, or could not be looked for, \
or an error above --max-error; 2 if the file is no design, or --json cannot be written."
)]
pub struct CheckArguments {
    #[command(flatten)]
    design: super::DesignArguments,
    /// Findings that make the command fail, separated by commas.
    #[arg(long, value_enum, value_delimiter = ',', value_name = "FINDING,…")]
    deny: Vec<Finding>,
    /// Fail if fixed point may be off by more than this, in per cent of an output's range: the largest of what is printed as
    /// "nowhere above"; with `--route fast` that route's alone.
    #[arg(long, value_parser = between(1e-9, 100.0), value_name = "PERCENT", allow_hyphen_values = true)]
    max_error: Option<f64>,
    /// Which part of the library is to evaluate the design as a Rust module, see `convert`: the fast one has an error of its own;
    /// auto shows both.
    #[arg(long, value_enum, default_value_t = Route::General)]
    route: Route,
    /// Points of the grid on which fixed point is compared with f64 and rules with each other.
    #[arg(long, default_value_t = POINTS as u64, value_parser = whole(16, 10_000_000), allow_hyphen_values = true)]
    points: u64,
    /// Write all findings there as JSON; the printed lists are cut.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

/// What can be found.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, ValueEnum)]
enum Finding {
    /// Regions where no rule about an output fires.
    Gaps,
    /// Rules that never fire, or are always outdone.
    DeadRules,
    /// Terms out of range, never asked about or never concluded, or whose set meets no sample.
    UnreachableTerms,
    /// Conclusions beyond the output's range.
    BeyondRange,
    /// Tables whose conclusions rise and fall along a row or a column, and outputs that do on a grid.
    NonMonotone,
    /// A design that fixed point cannot hold.
    NoFixedPoint,
}

/// Whether something was found.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Verdict {
    Absent,
    Found,
    /// It is not known.
    Open(&'static str),
}

pub fn execute(arguments: &CheckArguments) -> anyhow::Result<()> {
    if let Some(file) = &arguments.json {
        not_what_is_read("--json", file, &[(DESIGN, &arguments.design.file)])?;
    }
    let design = Design::load(&arguments.design)?;
    let fast = limit::fast(&design, arguments)?;
    let (fixed, points) = (design.fixed.as_ref().ok(), arguments.points as usize);
    let progress = Progress::new();
    let report = check(&design.system, fixed, points, &progress);
    progress.clear();
    let why = design.fixed.as_ref().err().map(ToString::to_string);
    let mut findings = Findings::new(&design.system, &report, design.title(), why);
    findings.points_asked = points;
    for (errors, bound) in findings.errors.iter_mut().zip(fast.iter().flatten()) {
        errors.fast_route = Some(*bound);
    }
    if let Some(file) = &arguments.json {
        put_where_asked(&[(file, &json(&findings)?)])?;
    }
    print(text::all(&findings))?;
    let mut said = denied(&findings, &arguments.deny);
    said.extend(limit::broken(&design.system, &report));
    if let Some(most) = arguments.max_error {
        said.extend(limit::beyond(&findings, arguments.route, most));
    }
    if !said.is_empty() {
        bail!("{}", said.join("; "));
    }
    Ok(())
}

/// What is denied and was found, or may be there all the same.
fn denied(findings: &Findings, denied: &[Finding]) -> Vec<String> {
    let (mut found, mut open) = (Vec::new(), Vec::new());
    for finding in denied {
        let name = finding.to_possible_value().unwrap_or_default();
        let name = name.get_name().to_owned();
        match findings.verdict(*finding) {
            Verdict::Absent => {}
            Verdict::Found => found.push(name),
            Verdict::Open(why) => open.push(format!("{name} ({why})")),
        }
    }
    let mut said = Vec::new();
    if !found.is_empty() {
        said.push(format!("{}: found, and denied by --deny", found.join(", ")));
    }
    if !open.is_empty() {
        let open = open.join(", ");
        said.push(format!(
            "{open}: could not be checked, and denied by --deny"
        ));
    }
    said
}

impl Findings {
    fn verdict(&self, finding: Finding) -> Verdict {
        const ONLY_SAMPLED: &str = "looked for at the grid's points only";
        let among = |found: bool, open: bool, why| match (found, open) {
            (true, _) => Verdict::Found,
            (false, true) => Verdict::Open(why),
            (false, false) => Verdict::Absent,
        };
        let sampled = self.search != Search::Exact;
        match finding {
            Finding::Gaps => among(!self.gaps.is_empty(), sampled, ONLY_SAMPLED),
            Finding::DeadRules => among(!self.dead_rules.is_empty(), sampled, ONLY_SAMPLED),
            Finding::UnreachableTerms => {
                among(!self.unreachable_terms.is_empty(), sampled, ONLY_SAMPLED)
            }
            Finding::BeyondRange => among(!self.beyond_range.is_empty(), false, ""),
            Finding::NonMonotone => {
                let mut outputs = self.non_monotone.iter();
                let found = outputs.any(|o| !o.cells.is_empty() || !o.ripples.is_empty());
                let mut outputs = self.non_monotone.iter();
                let open = outputs.any(|output| !output.sampled);
                among(found, open, "the grid has too many points")
            }
            Finding::NoFixedPoint => among(self.no_fixed_point.is_some(), false, ""),
        }
    }
}
