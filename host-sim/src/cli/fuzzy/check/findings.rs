//! What a check found, with the design's own names: printed as tables and written as JSON.

use super::named::Named;
use host_sim::fuzzy::check::Report;
use host_sim::fuzzy::evaluate::rules;
use host_sim::fuzzy::model::System;
use serde::Serialize;
use std::collections::BTreeMap;

/// Everything.
#[derive(Serialize)]
pub struct Findings {
    pub design: String,
    pub inputs: usize,
    pub outputs: usize,
    pub rules: usize,
    /// How gaps and rules that never fire were looked for.
    pub search: Search,
    /// Points of the grid, and how many were asked for: costly designs get fewer.
    pub points: usize,
    pub points_asked: usize,
    /// Whether they are fewer for the work that each takes.
    pub points_limited: bool,
    /// Whether all corners of the inputs' terms are on the grid.
    pub corners: bool,
    pub gaps: Vec<Gap>,
    /// Where an input has no term.
    pub without_terms: Vec<Side>,
    pub dead_rules: Vec<DeadRule>,
    pub unreachable_terms: Vec<UnreachableTerm>,
    pub beyond_range: Vec<BeyondRange>,
    /// One an output.
    pub non_monotone: Vec<NonMonotone>,
    /// Empty without fixed point.
    pub errors: Vec<OutputError>,
    /// Why there is none.
    pub no_fixed_point: Option<String>,
}

#[derive(Clone, Copy, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Search {
    /// Everywhere in the ranges.
    Exact,
    /// At the grid's points only.
    Sampled,
    /// In a rule table.
    Table,
    /// Not at all.
    None,
}

/// A place: a value an input.
pub type Point = BTreeMap<String, f64>;

#[derive(Serialize)]
pub struct Gap {
    pub outputs: Vec<String>,
    /// One an input; of a sampled search none.
    pub region: Vec<Side>,
    /// Part of the whole, or of the grid's points.
    pub share: f64,
    pub example: Point,
    #[serde(skip)]
    pub example_text: String,
}

/// A part of an input's range.
#[derive(Serialize)]
pub struct Side {
    pub input: String,
    pub from: f64,
    pub to: f64,
    pub with_from: bool,
    pub with_to: bool,
    #[serde(skip)]
    pub text: String,
    /// Whether it is less than the range.
    #[serde(skip)]
    pub is_part: bool,
}

#[derive(PartialEq, Eq, PartialOrd, Ord, Serialize)]
pub struct DeadRule {
    /// From 1 on.
    pub rule: usize,
    pub why: String,
    /// 0 if it is unknown.
    pub line: usize,
    pub reads: String,
}

#[derive(Serialize)]
pub struct UnreachableTerm {
    pub term: String,
    pub line: usize,
    pub why: &'static str,
}

#[derive(Serialize)]
pub struct BeyondRange {
    pub term: String,
    pub line: usize,
    /// What it concludes.
    pub least: f64,
    pub most: f64,
    /// The output's range.
    pub range: [f64; 2],
    /// Whether the output is limited to it.
    pub limited: bool,
}

#[derive(Serialize)]
pub struct NonMonotone {
    pub output: String,
    pub search: Search,
    /// Whether it was looked for at the grid's points, too.
    pub sampled: bool,
    /// Why not in a table.
    pub why: Option<String>,
    pub cells: Vec<Cells>,
    pub ripples: Vec<Ripple>,
}

/// Three cells of a table.
#[derive(Serialize)]
pub struct Cells {
    pub along: String,
    /// The other input's term, if there is one.
    pub held: Option<String>,
    /// Terms, and what is concluded there.
    pub conclusions: [(String, f64); 3],
}

/// Lines of the grid with turns.
#[derive(Serialize)]
pub struct Ripple {
    pub along: String,
    pub lines: usize,
    pub turning: usize,
    /// Where the greatest turn is.
    pub at: Point,
    #[serde(skip)]
    pub at_text: String,
    /// The input's values and the output's before, at and behind it.
    pub values: [(f64, f64); 3],
}

#[derive(Serialize)]
pub struct OutputError {
    pub output: String,
    /// Whether any rule concludes something about it.
    pub concluded: bool,
    pub range: [f64; 2],
    pub classes: Vec<Class>,
    /// What a module of the fast route may be off, if the design takes that route.
    pub fast_route: Option<f64>,
}

impl OutputError {
    /// Each class that says something, with its place among all: one that adds no point to the one before and has, as far as
    /// it is printed, the same bound does not. Rules may be so weak between the grid's points alone.
    pub fn shown(&self) -> impl Iterator<Item = (usize, &Class)> {
        let mut seen = (0, rounded(0.0));
        self.classes.iter().enumerate().filter(move |(_, class)| {
            let this = (class.points, rounded(class.nowhere_above));
            let new = this != seen;
            seen = this;
            new
        })
    }
}

/// An error as it is printed.
pub fn rounded(error: f64) -> String {
    format!("{error:.1e}")
}

/// Where the strongest rule has this degree at least.
#[derive(Serialize)]
pub struct Class {
    pub strongest_rule: f64,
    pub points: usize,
    pub rms: f64,
    pub greatest: f64,
    pub at: Point,
    #[serde(skip)]
    pub at_text: String,
    pub nowhere_above: f64,
}

impl Findings {
    /// Of a report.
    pub fn new(system: &System, report: &Report, design: String, fixed: Option<String>) -> Self {
        let named = Named(system);
        Self {
            design,
            inputs: system.inputs.len(),
            outputs: system.outputs.len(),
            rules: rules(system).count(),
            search: match report.coverage {
                Ok(_) => Search::Exact,
                Err(_) => Search::Sampled,
            },
            points: report.points,
            points_asked: report.points,
            points_limited: report.is_limited,
            corners: report.has_corners,
            gaps: match &report.coverage {
                Ok(coverage) => coverage.gaps.iter().map(|gap| named.gap(gap)).collect(),
                Err(sampled) => named.sampled_gaps(sampled, report.points),
            },
            without_terms: (report.bare.iter())
                .map(|(input, stretch)| named.side(*input, stretch))
                .collect(),
            dead_rules: named.dead_rules(report),
            unreachable_terms: named.unreachable_terms(report),
            beyond_range: named.beyond_range(report),
            non_monotone: (report.turns.iter().enumerate())
                .map(|(output, turns)| named.non_monotone(output, turns))
                .collect(),
            errors: (report.errors.iter().flatten().enumerate())
                .map(|(output, errors)| named.errors(output, errors))
                .collect(),
            no_fixed_point: fixed,
        }
    }
}
