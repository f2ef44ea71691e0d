//! What trouble costs: a campaign beside the same one with a sound robot, and dead sensors one by one. A mean over the
//! sensors would hide the one that matters.

use super::attempt::{Ending, Outcome};
use super::results::{Figures, SeedResult, WorldResult};
use super::statistics::wilson;
use serde::{Deserialize, Serialize};

/// The same worlds and seeds with a sound robot: mild noise, all sensors alive, exact odometry.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Sound {
    /// Figures of its runs.
    #[serde(flatten)]
    pub figures: Figures,
    /// Share of success that the trouble costs; 0.02 are two points. Below zero it helps.
    pub lost_success: f64,
    /// Share of collisions that it adds.
    pub more_collision: f64,
    /// Mean score that it costs.
    pub lost_score: f64,
    /// Worlds, by number.
    pub per_world: Vec<WorldResult>,
}

impl Sound {
    /// Beside the figures with trouble.
    pub fn new(trouble: &Figures, per_world: Vec<WorldResult>) -> Self {
        let outcomes: Vec<Outcome> = per_world
            .iter()
            .flat_map(|w| w.attempts.iter().map(|a| a.outcome))
            .collect();
        let figures = Figures::of(&outcomes);
        Self {
            lost_success: figures.success - trouble.success,
            more_collision: trouble.collision - figures.collision,
            lost_score: figures.score - trouble.score,
            figures,
            per_world,
        }
    }
}

/// The runs with one sensor dead.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DeadSensor {
    /// Which, from 0 at the right.
    pub sensor: usize,
    /// Number of runs.
    pub runs: usize,
    /// Share that reached the goal.
    pub success: f64,
    /// Its 95 % interval, as if every run were a draw of its own (Wilson).
    pub success_95: [f64; 2],
    /// Share that touched something.
    pub collision: f64,
    /// Mean score.
    pub score: f64,
    /// Success that its death costs: less than all runs of the sound robot have.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lost_success: Option<f64>,
}

/// Sensors that were dead one at a time.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct DeadSensors {
    /// The one with the least success; of several, with the most collisions.
    pub worst: DeadSensor,
    /// All of them.
    pub sensors: Vec<DeadSensor>,
}

impl DeadSensors {
    /// Of runs in which different ones were dead; none if it never was more than one.
    pub fn of(per_world: &[WorldResult], sound: Option<&Sound>) -> Option<Self> {
        let attempts = || per_world.iter().flat_map(|w| &w.attempts);
        let mut numbers: Vec<usize> = attempts().filter_map(|a| a.dead_sensor).collect();
        numbers.sort_unstable();
        numbers.dedup();
        if numbers.len() < 2 {
            return None;
        }
        let sensors: Vec<DeadSensor> = numbers
            .into_iter()
            .map(|sensor| {
                let own = attempts().filter(|a| a.dead_sensor == Some(sensor));
                DeadSensor::of(sensor, own, sound)
            })
            .collect();
        let worst = sensors.iter().min_by(|a, b| {
            let by_success = a.success.total_cmp(&b.success);
            by_success.then(b.collision.total_cmp(&a.collision))
        });
        Some(Self {
            worst: worst?.clone(),
            sensors,
        })
    }
}

impl DeadSensor {
    fn of<'a>(
        sensor: usize,
        own: impl Iterator<Item = &'a SeedResult>,
        sound: Option<&Sound>,
    ) -> Self {
        let outcomes: Vec<Outcome> = own.map(|a| a.outcome).collect();
        let figures = Figures::of(&outcomes);
        let reached = outcomes.iter().filter(|o| o.ending == Ending::Reached);
        Self {
            sensor,
            runs: figures.runs,
            success: figures.success,
            success_95: wilson(reached.count(), outcomes.len()),
            collision: figures.collision,
            score: figures.score,
            lost_success: sound.map(|s| s.figures.success - figures.success),
        }
    }
}
