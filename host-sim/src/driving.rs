//! How well a design drives: the follower's fine controller from a design file, in the closed loop.
//!
//! The robot's follower holds a `&'static` table, because on a microcontroller that is flash and nothing else may cost an
//! instruction there. A design's table is made while the program runs, so it is leaked: 160 bytes a candidate. The tick
//! around it is the robot's own, to the last bit.

mod tables;

pub use tables::{NotFine, tables};

use crate::fuzzy::lower::Lowered;
use crate::fuzzy::model::System;
use crate::fuzzy::tune::Objective;
use crate::metrics::Metrics;
use crate::run::{RunError, simulate_with};
use crate::scenario::Scenario;
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
    /// The mean of the runs' [costs](Self::cost_of).
    pub cost: f64,
    /// Mean of the true cross-track error's root mean square over all ticks that follow the path, m.
    pub cross_track_rms_m: f64,
    /// Mean time, s.
    pub time_s: f64,
    /// Collisions of all runs.
    pub collisions: u64,
    /// Runs that did not reach the path's end.
    pub missed: u64,
}

/// Weight of the time, as a multiple of what the path takes at top speed, against a robot radius of error.
const TIME: f64 = 0.1;
/// Weight of a collision, and of a run that does not reach the end.
const FAILURE: f64 = 10.0;

impl Drive {
    /// A run's cost: RMS cross-track error in robot radii + 0.1 · time in multiples of the path's length at top speed
    /// + 10 a collision + 10 if the end is not reached.
    fn cost_of(scenario: &Scenario, rms: f64, time: f64, collisions: u64, missed: bool) -> f64 {
        let laps = if scenario.path.closed {
            f64::from(scenario.laps.max(1))
        } else {
            1.0
        };
        let quickest = laps * scenario.path.track().length() / scenario.robot.speed;
        rms / scenario.robot.radius
            + TIME * time / quickest.max(scenario.robot.period)
            + FAILURE * (collisions as f64 + f64::from(u8::from(missed)))
    }
}

impl Driving<'_> {
    /// Drives every scenario.
    ///
    /// # Errors
    ///
    /// The design is none of the follower's; or the library refuses a scenario.
    pub fn drive(&self, design: &System) -> Result<Vec<Drive>, DrivingError> {
        let tables = Box::leak(Box::new(tables(design)?));
        let drives = self.scenarios.iter().map(|scenario| {
            let mut all = Drive {
                scenario: scenario.name.clone(),
                cost: 0.0,
                cross_track_rms_m: 0.0,
                time_s: 0.0,
                collisions: 0,
                missed: 0,
            };
            for seed in 1..=self.seeds {
                let mut metrics = Metrics::new(scenario, seed);
                let (mut squares, mut ticks) = (0.0, 0_u32);
                let ending = simulate_with(scenario, seed, tables, &mut |step| {
                    metrics.observe(&step);
                    if step.record.decision == Decision::Follow {
                        squares += step.cross_track * step.cross_track;
                        ticks += 1;
                    }
                })?;
                let summary = metrics.finish(ending);
                let rms = (squares / f64::from(ticks.max(1))).sqrt();
                let (time, collisions) = (summary.sim_time_s, summary.collisions);
                let missed = !summary.reached_end;
                all.cost += Drive::cost_of(scenario, rms, time, collisions, missed);
                all.cross_track_rms_m += rms;
                all.time_s += time;
                all.collisions += collisions;
                all.missed += u64::from(missed);
            }
            let runs = self.seeds.max(1) as f64;
            all.cost /= runs;
            all.cross_track_rms_m /= runs;
            all.time_s /= runs;
            Ok(all)
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
        let twin = Box::leak(Box::new(tables(&fine()).unwrap()));
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

    #[test]
    fn a_failure_costs_more_than_any_error_on_the_path() {
        let scenario = load("line").unwrap();
        let cost =
            |rms, collisions, missed| Drive::cost_of(&scenario, rms, 60.0, collisions, missed);
        assert!(cost(0.0, 1, false) > cost(5.0 * scenario.robot.radius, 0, false));
        assert!(cost(0.0, 0, true) > cost(0.0, 0, false) + 9.0);
    }
}
