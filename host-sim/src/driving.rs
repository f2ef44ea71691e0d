//! How well a design drives: the follower's fine controller from a design file, in the closed loop.
//!
//! The robot's follower holds a `&'static` table, because on a microcontroller that is flash and nothing else may cost an
//! instruction there. A design's table is made while the program runs, so it is leaked: 160 bytes a candidate. The tick
//! around it is the robot's own, to the last bit.

mod tables;

pub use tables::{Fine, NotFine, SCALED, tables};

use crate::fuzzy::lower::Lowered;
use crate::fuzzy::model::System;
use crate::fuzzy::tune::Objective;
use crate::metrics::Metrics;
use crate::run::{RunError, simulate_with};
use crate::scenario::Scenario;
use crate::si;
use fuzzypilot::signals::Decision;
use serde::Serialize;

/// Scenarios that a follower's design drives, each with the seeds 1 to `seeds`.
pub struct Driving<'a> {
    /// Where.
    pub scenarios: &'a [Scenario],
    /// How often each.
    pub seeds: u64,
}

/// What came of a scenario, over all its seeds.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Drive {
    /// The scenario.
    pub scenario: String,
    /// The mean of the runs' costs: RMS cross-track error in robot radii + 0.1 · time in multiples of the path's length at
    /// top speed + yaw effort + 10 a collision + 10 if the end is not reached.
    pub cost: f64,
    /// Mean of the true cross-track error's root mean square over all ticks that follow the path, m.
    pub cross_track_rms_m: f64,
    /// Mean time, s.
    pub time_s: f64,
    /// Mean change of the yaw rate from tick to tick, as a share of what the robot can.
    pub yaw_effort: f64,
    /// Collisions of all runs.
    pub collisions: u64,
    /// Runs that did not reach the path's end.
    pub missed: u64,
}

/// Weight of the time, as a multiple of what the path takes at top speed, against a robot radius of error.
const TIME: f64 = 0.1;
/// Weight of the yaw effort: a robot that shakes at its limit is as bad as one a robot radius off the path. Without it a
/// search gladly turns small errors into hard switching.
const EFFORT: f64 = 1.0;
/// Weight of a collision, and of a run that does not reach the end.
const FAILURE: f64 = 10.0;

impl Drive {
    /// A run's cost, as [`Self::cost`] says.
    fn cost_of(run: &Run, scenario: &Scenario) -> f64 {
        let laps = if scenario.path.closed {
            f64::from(scenario.laps.max(1))
        } else {
            1.0
        };
        let quickest = laps * scenario.path.track().length() / scenario.robot.speed;
        let failures = run.collisions as f64 + f64::from(u8::from(run.missed));
        run.rms / scenario.robot.radius
            + TIME * run.time / quickest.max(scenario.robot.period)
            + EFFORT * run.effort
            + FAILURE * failures
    }
}

/// What one run gave.
#[derive(Clone, Copy, Debug, Default)]
struct Run {
    rms: f64,
    time: f64,
    effort: f64,
    collisions: u64,
    missed: bool,
}

impl Run {
    fn new(scenario: &Scenario, seed: u64, fine: Fine<'static>) -> Result<Self, RunError> {
        let mut metrics = Metrics::new(scenario, seed);
        let (mut squares, mut following) = (0.0, 0_u32);
        let (mut turned, mut last, mut ticks) = (0.0, 0.0, 0_u32);
        let ending = simulate_with(scenario, seed, fine, &mut |step| {
            metrics.observe(&step);
            let rate = si::from_rate(step.record.twist.angular);
            turned += (rate - last).abs();
            last = rate;
            ticks += 1;
            if step.record.decision == Decision::Follow {
                squares += step.cross_track * step.cross_track;
                following += 1;
            }
        })?;
        let summary = metrics.finish(ending);
        let most = scenario.robot.yaw_acceleration * scenario.robot.period;
        Ok(Self {
            rms: (squares / f64::from(following.max(1))).sqrt(),
            time: summary.sim_time_s,
            effort: turned / (most * f64::from(ticks.max(1))),
            collisions: summary.collisions,
            missed: !summary.reached_end,
        })
    }
}

impl Driving<'_> {
    /// Drives every scenario.
    ///
    /// # Errors
    ///
    /// The design is none of the follower's; or the library refuses a scenario.
    pub fn drive(&self, design: &System) -> Result<Vec<Drive>, DrivingError> {
        let (tables, apart) = tables(design)?;
        let fine = Fine {
            tables: Box::leak(Box::new(tables)),
            apart,
        };
        let drives = self.scenarios.iter().map(|scenario| {
            let runs: Vec<Run> = (1..=self.seeds)
                .map(|seed| Run::new(scenario, seed, fine))
                .collect::<Result<_, _>>()?;
            let mean = |of: &dyn Fn(&Run) -> f64| {
                runs.iter().map(of).sum::<f64>() / runs.len().max(1) as f64
            };
            Ok(Drive {
                scenario: scenario.name.clone(),
                cost: mean(&|run| Drive::cost_of(run, scenario)),
                cross_track_rms_m: mean(&|run| run.rms),
                time_s: mean(&|run| run.time),
                yaw_effort: mean(&|run| run.effort),
                collisions: runs.iter().map(|run| run.collisions).sum(),
                missed: runs.iter().map(|run| u64::from(run.missed)).sum(),
            })
        });
        drives.collect()
    }
}

/// The mean of some drives' costs.
pub fn mean_cost(drives: &[Drive]) -> f64 {
    drives.iter().map(|drive| drive.cost).sum::<f64>() / drives.len().max(1) as f64
}

impl Objective for Driving<'_> {
    fn cost(&self, system: &System, _: &Lowered) -> Option<f64> {
        self.drive(system).ok().map(|drives| mean_cost(&drives))
    }
}

/// Why a design cannot drive.
#[derive(Debug, thiserror::Error)]
pub enum DrivingError {
    /// It is no design for the follower.
    #[error(transparent)]
    Design(#[from] NotFine),
    /// The library refuses the scenario.
    #[error(transparent)]
    Run(#[from] RunError),
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::files::load as design;
    use crate::run::simulate;
    use crate::scenario::load;
    use std::path::Path;

    fn fine() -> System {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("designs/fine.fll");
        design(&file, None).unwrap()
    }

    #[test]
    fn a_design_of_the_printed_tables_drives_as_they_do() {
        let mut scenario = load("line-offset").unwrap();
        scenario.control.tables = Some(crate::control::TablesName::Printed);
        let (twin, apart) = tables(&fine()).unwrap();
        let twin = Fine {
            tables: Box::leak(Box::new(twin)),
            apart,
        };
        let (mut own, mut designed) = (Vec::new(), Vec::new());
        simulate(&scenario, 1, &mut |step| own.push(step.record.clone())).unwrap();
        simulate_with(&scenario, 1, twin, &mut |step| {
            designed.push(step.record.clone());
        })
        .unwrap();
        assert!(own.len() > 100 && own == designed);
        // Not for want of looking: the tuned tables drive otherwise.
        scenario.control.tables = Some(crate::control::TablesName::Tuned);
        simulate_with(&scenario, 1, twin, &mut |_| {}).unwrap();
        let mut tuned = Vec::new();
        simulate(&scenario, 1, &mut |step| tuned.push(step.record.clone())).unwrap();
        assert!(tuned != designed);
    }

    /// Terms of d half as far apart are the same as a robot that counts its distance in units half as long.
    #[test]
    fn the_distance_of_the_peaks_is_the_scale_of_the_distance() {
        let text =
            std::fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("designs/fine.fll"))
                .unwrap();
        let (before, after) = text.split_once("InputVariable: d").unwrap();
        let (of_d, rest) = after.split_once("OutputVariable").unwrap();
        let halved: Vec<String> = of_d
            .lines()
            .map(|line| match line.trim().starts_with("term:") {
                false => line.to_owned(),
                true => {
                    let half = |word: &str| {
                        word.parse()
                            .map_or(word.to_owned(), |x: f64| (x / 2.0).to_string())
                    };
                    format!(
                        "  {}",
                        line.split_whitespace()
                            .map(half)
                            .collect::<Vec<_>>()
                            .join(" ")
                    )
                }
            })
            .collect();
        let text = format!(
            "{before}InputVariable: d{}\nOutputVariable{rest}",
            halved.join("\n")
        );
        let narrow = crate::fuzzy::files::parse(
            "fine.fll",
            text.as_bytes(),
            crate::fuzzy::files::Format::Fll,
        )
        .unwrap();
        let drive = |design: &System, factor: f64| {
            let (twin, apart) = tables(design).unwrap();
            let fine = Fine {
                tables: Box::leak(Box::new(twin)),
                apart: apart * factor,
            };
            let mut seen = Vec::new();
            let scenario = load("line-offset").unwrap();
            simulate_with(&scenario, 1, fine, &mut |step| {
                seen.push(step.record.clone());
            })
            .unwrap();
            seen
        };
        let (wide, narrow_drive) = (drive(&fine(), 1.0), drive(&narrow, 1.0));
        assert!(wide != narrow_drive);
        assert!(narrow_drive == drive(&fine(), 0.5));
        assert!(wide == drive(&narrow, 2.0));
    }

    #[test]
    fn a_failure_costs_more_than_any_error_on_the_path() {
        let scenario = load("line").unwrap();
        let cost = |change: fn(&mut Run)| {
            let mut run = Run {
                time: 60.0,
                ..Run::default()
            };
            change(&mut run);
            Drive::cost_of(&run, &scenario)
        };
        let good = cost(|_| {});
        assert!(cost(|run| run.collisions = 1) > good + 9.0);
        assert!(cost(|run| run.missed = true) > good + 9.0);
        assert!(cost(|run| run.rms = 0.1) > good + 0.1);
        assert!(cost(|run| run.effort = 0.5) > good + 0.1);
        assert!(cost(|run| run.time = 120.0) > good + 0.1);
    }
}
