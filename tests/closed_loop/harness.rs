//! Runs, and what the tests want to know of them.

use fuzzypilot::signals::{Decision, TickRecord, Turn};
use host_sim::metrics::{Metrics, Summary};
use host_sim::run::{Step, simulate};
use host_sim::scenario::{BUILT_IN, Scenario, load, parse};

/// A built-in scenario.
pub fn scenario(name: &str) -> Scenario {
    load(name).unwrap_or_else(|e| panic!("{e}"))
}

/// A built-in scenario with a table added to its text.
pub fn with(name: &str, addition: &str) -> Scenario {
    let text = BUILT_IN.iter().find(|(n, _)| *n == name).unwrap().1;
    parse(name, name, &format!("{text}\n{addition}")).unwrap_or_else(|e| panic!("{e}"))
}

/// Everything of one tick that the tests look at.
#[derive(Clone, Debug, PartialEq)]
pub struct Tick {
    pub record: TickRecord,
    pub truth: [f64; 3],
    pub wheels: [f64; 2],
    pub cross_track: f64,
    pub clearance: f64,
}

/// A run with all its ticks.
pub struct Run {
    pub summary: Summary,
    pub ticks: Vec<Tick>,
}

pub fn run(scenario: &Scenario, seed: u64) -> Run {
    let mut metrics = Metrics::new(scenario, seed);
    let mut ticks = Vec::new();
    let mut observe = |step: Step<'_>| {
        metrics.observe(&step);
        ticks.push(Tick {
            record: step.record.clone(),
            truth: step.truth,
            wheels: step.wheels,
            cross_track: step.cross_track,
            clearance: step.clearance.0,
        });
    };
    let ending = simulate(scenario, seed, &mut observe).unwrap_or_else(|e| panic!("{e}"));
    Run {
        summary: metrics.finish(ending),
        ticks,
    }
}

impl Run {
    /// RMS and maximum of the true cross-track error from this tick on.
    pub fn cross_track_from(&self, tick: usize) -> (f64, f64) {
        let errors = || self.ticks[tick..].iter().map(|t| t.cross_track);
        let n = errors().count() as f64;
        let rms = (errors().map(|e| e * e).sum::<f64>() / n).sqrt();
        (rms, errors().fold(0.0, |worst, e| e.abs().max(worst)))
    }

    /// True distance travelled up to each tick.
    pub fn travelled(&self) -> Vec<f64> {
        let mut sum = 0.0;
        let mut last = self.ticks[0].truth;
        self.ticks
            .iter()
            .map(|t| {
                sum += (t.truth[0] - last[0]).hypot(t.truth[1] - last[1]);
                last = t.truth;
                sum
            })
            .collect()
    }

    /// The first tick from which the error stays within `bound` to the end.
    pub fn settled(&self, bound: f64) -> Option<usize> {
        let outside = self
            .ticks
            .iter()
            .rposition(|t| t.cross_track.abs() > bound)
            .map_or(0, |i| i + 1);
        (outside < self.ticks.len()).then_some(outside)
    }

    /// Ticks at which an avoidance goes on with the other side than in the tick before.
    pub fn side_changes(&self) -> Vec<u32> {
        let side = |t: &Tick| match t.record.decision {
            Decision::Avoid { side, .. } => Some(side),
            _ => None,
        };
        self.ticks
            .windows(2)
            .filter(|w| matches!((side(&w[0]), side(&w[1])), (Some(a), Some(b)) if a != b))
            .map(|w| w[1].record.tick)
            .collect()
    }

    /// Obstacle and side of every avoidance, repeats in a row counted once.
    pub fn story(&self) -> Vec<(String, &'static str)> {
        let mut story: Vec<(String, &'static str)> = self
            .summary
            .avoidances
            .iter()
            .map(|a| (a.obstacle.clone(), a.side))
            .collect();
        story.dedup();
        story
    }

    pub fn avoids(&self) -> bool {
        self.ticks.iter().any(|t| {
            matches!(
                t.record.decision,
                Decision::Avoid {
                    side: Turn::Left | Turn::Right,
                    ..
                }
            )
        })
    }
}

/// Least and greatest of something over many runs.
pub fn ends(values: impl IntoIterator<Item = f64>) -> (f64, f64) {
    values
        .into_iter()
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(least, most), x| {
            (least.min(x), most.max(x))
        })
}
