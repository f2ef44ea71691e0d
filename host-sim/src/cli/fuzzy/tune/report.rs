//! What tuning gave: for people as tables, for programs as JSON.

use super::goal::Goal;
use crate::cli::fuzzy::design::Design;
use crate::cli::fuzzy::table::{right, table};
use anyhow::Context;
use comfy_table::Cell;
use host_sim::driving::{Drive, Driving};
use host_sim::fuzzy::describe::{number, number_to};
use host_sim::fuzzy::lower::lower;
use host_sim::fuzzy::model::System;
use host_sim::fuzzy::tune::data::Data;
use host_sim::fuzzy::tune::{Change, Fit, Movable, Objective, Outcome, changes};
use host_sim::search::Stop;
use serde::Serialize;
use std::fmt::{self, Display, Formatter};

/// Everything.
#[derive(Serialize)]
pub struct Report {
    design: String,
    /// Numbers that could move.
    moving: usize,
    candidates: usize,
    /// Of them, known from a state.
    known: usize,
    refused: usize,
    stopped: String,
    cost: Pair<f64>,
    /// Empty for scenarios.
    fits: Vec<FitReport>,
    /// Empty for data.
    drives: Vec<Pair<Drive>>,
    changed: Vec<Change>,
}

#[derive(Serialize)]
struct Pair<T> {
    before: T,
    after: T,
}

/// Some rows.
#[derive(Serialize)]
struct FitReport {
    /// `train` or `validation`.
    rows: &'static str,
    count: usize,
    cost: Pair<f64>,
    outputs: Vec<OutputReport>,
}

#[derive(Serialize)]
struct OutputReport {
    name: String,
    /// In the output's unit.
    rms: Pair<f64>,
    worst: Pair<f64>,
}

impl Report {
    /// Judges start and result once more, on everything there is.
    pub fn new(
        design: &Design,
        goal: &Goal,
        movable: &Movable,
        outcome: &Outcome,
    ) -> anyhow::Result<Self> {
        let both = [&design.system, &outcome.best.system];
        let (mut fits, mut drives) = (Vec::new(), Vec::new());
        match goal {
            Goal::Data {
                train, validation, ..
            } => {
                for (rows, data) in [("train", train), ("validation", validation)] {
                    if !data.rows.is_empty() {
                        fits.push(FitReport::new(rows, data, both)?);
                    }
                }
            }
            Goal::Drive { scenarios, seeds } => {
                let driving = Driving {
                    scenarios,
                    seeds: *seeds,
                };
                let [before, after] = both.map(|system| driving.drive(system));
                let pairs = before?.into_iter().zip(after?);
                drives.extend(pairs.map(|(before, after)| Pair { before, after }));
            }
        }
        Ok(Self {
            design: design.title(),
            moving: movable.len(),
            candidates: outcome.evaluations,
            known: outcome.known,
            refused: outcome.refused,
            stopped: match &outcome.stop {
                Stop::Evaluations => "as many candidates as allowed".to_owned(),
                Stop::Converged(why) => format!("nothing more to gain ({why})"),
                Stop::Interrupted => "interrupted".to_owned(),
            },
            cost: Pair {
                before: outcome.start,
                after: outcome.best.cost,
            },
            fits,
            drives,
            changed: changes(both[0], both[1]),
        })
    }
}

impl FitReport {
    fn new(rows: &'static str, data: &Data, both: [&System; 2]) -> anyhow::Result<Self> {
        let fit = Fit(data);
        let mut judged = Vec::new();
        for system in both {
            let lowered = lower(system)?;
            let cost = fit
                .cost(system, &lowered)
                .context("its cost is no number")?;
            judged.push((cost, fit.outputs(&lowered)));
        }
        let [before, after] = [&judged[0], &judged[1]];
        let outputs = data.outputs.iter().zip(before.1.iter().zip(&after.1));
        let outputs = outputs.map(|(&output, (before, after))| OutputReport {
            name: both[0].outputs[output].name.clone(),
            rms: Pair {
                before: before.rms,
                after: after.rms,
            },
            worst: Pair {
                before: before.worst,
                after: after.worst,
            },
        });
        Ok(Self {
            rows,
            count: data.rows.len(),
            cost: Pair {
                before: before.0,
                after: after.0,
            },
            outputs: outputs.collect(),
        })
    }
}

impl Display for Report {
    fn fmt(&self, f: &mut Formatter<'_>) -> fmt::Result {
        writeln!(
            f,
            "{}: {} numbers that can move, {} candidates ({} known, {} refused), ended by: {}",
            self.design, self.moving, self.candidates, self.known, self.refused, self.stopped
        )?;
        let Pair { before, after } = &self.cost;
        writeln!(f, "cost: {before:.4e} before, {after:.4e} after")?;
        if !self.fits.is_empty() {
            writeln!(f, "{}", self.fit_table())?;
        }
        if !self.drives.is_empty() {
            writeln!(f, "{}", self.drive_table())?;
        }
        if self.changed.is_empty() {
            return writeln!(f, "no candidate was better: the design is as it was");
        }
        let mut changed = table(["changed", "before", "after"]);
        for change in &self.changed {
            let pairs = change.before.iter().zip(&change.after);
            let moved = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
            // So that both sides of a small step of a large number read differently.
            let list = |numbers: &[f64]| {
                let texts: Vec<String> = numbers
                    .iter()
                    .map(|x| number_to(*x, 0.01 * moved))
                    .collect();
                texts.join(" ")
            };
            changed.add_row([
                Cell::new(format!("{}.{}", change.variable, change.term)),
                right(list(&change.before)),
                right(list(&change.after)),
            ]);
        }
        writeln!(f, "{changed}")
    }
}

impl Report {
    fn fit_table(&self) -> comfy_table::Table {
        let mut fits = table([
            "rows",
            "output",
            "RMS before",
            "after",
            "worst before",
            "after",
        ]);
        for fit in &self.fits {
            for output in &fit.outputs {
                fits.add_row([
                    Cell::new(format!("{} {}", fit.count, fit.rows)),
                    Cell::new(&output.name),
                    right(number(output.rms.before)),
                    right(number(output.rms.after)),
                    right(number(output.worst.before)),
                    right(number(output.worst.after)),
                ]);
            }
        }
        fits
    }

    fn drive_table(&self) -> comfy_table::Table {
        let mut drives = table([
            "scenario",
            "",
            "cost",
            "RMS m",
            "time s",
            "yaw effort",
            "collisions",
            "end missed",
        ]);
        for pair in &self.drives {
            for (when, drive) in [("before", &pair.before), ("after", &pair.after)] {
                drives.add_row([
                    Cell::new(&drive.scenario),
                    Cell::new(when),
                    right(format!("{:.4}", drive.cost)),
                    right(format!("{:.4}", drive.cross_track_rms_m)),
                    right(format!("{:.2}", drive.time_s)),
                    right(format!("{:.3}", drive.yaw_effort)),
                    right(drive.collisions),
                    right(drive.missed),
                ]);
            }
        }
        drives
    }
}
