//! What a campaign came to, as it is written to JSON and read back.

use super::attempt::{Ending, Outcome};
use super::campaign::Run;
use super::cost::{DeadSensors, Sound};
use super::statistics::{Resampling, median, wilson};
use super::tracking::{Tracked, pooled};
use serde::{Deserialize, Serialize};

/// What was run: the same for all of a campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Conditions {
    /// Name of the navigator.
    pub controller: String,
    /// `path`, `goal` or `unmapped`.
    pub task: String,
    /// Name of the sensors.
    pub sensors: String,
    /// Where the worlds come from.
    pub worlds: String,
    /// Which of them.
    pub numbers: String,
    /// Where the cylinders come from that the path knows nothing of.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub unmapped: Option<String>,
    /// The robot's footprint.
    #[serde(default = "jackal")]
    pub body: String,
    /// Speed cap, m/s.
    pub speed: f64,
    /// First seed.
    pub first_seed: u64,
    /// Seeds a world.
    pub seeds: u64,
    /// What is not ideal about sensors and odometry, in words.
    pub disturbance: String,
}

/// The body of results that name none.
fn jackal() -> String {
    "jackal".to_owned()
}

/// The figures of a set of runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Figures {
    /// Number of runs.
    pub runs: usize,
    /// Share that reached the goal, 0 to 1.
    pub success: f64,
    /// Share that touched something.
    pub collision: f64,
    /// Share that ran out of time or stopped elsewhere.
    pub timeout: f64,
    /// Share that reported to be blocked and kept to it.
    pub blocked: f64,
    /// Share that ended at the goal or reported to be blocked: what a trap leaves to wish for.
    #[serde(default)]
    pub out_or_blocked: f64,
    /// Mean of the benchmark's score, 0 to 0.5.
    pub score: f64,
    /// Mean time of the successful runs, s; none if there are none.
    pub mean_time_s: Option<f64>,
    /// Median over the runs of the least distance from anything, m.
    pub median_min_clearance_m: f64,
    /// RMS over the runs of each run's RMS distance from the given route, m.
    pub cross_track_rms_m: f64,
    /// Largest distance from the given route in any run, m.
    #[serde(default)]
    pub cross_track_max_m: f64,
    /// RMS over the runs of the change of the commanded yaw rate, rad/s².
    pub omega_rate_rms: f64,
    /// Longest time without progress in any run, s.
    pub longest_stall_s: f64,
    /// How often, in all runs together, there was none for more than 5 s without a report.
    #[serde(default)]
    pub stalls: u32,
}

/// 95 % intervals, low and high.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Intervals {
    /// Of `success`, as if every run were a draw of its own (Wilson).
    pub success: [f64; 2],
    /// Of `collision`, likewise.
    pub collision: [f64; 2],
    /// Of `success`, worlds resampled (bootstrap).
    pub success_worlds: [f64; 2],
    /// Of `collision`, likewise.
    pub collision_worlds: [f64; 2],
    /// Of `score`, likewise.
    pub score_worlds: [f64; 2],
    /// Of `mean_time_s`, likewise; none if no run arrived.
    #[serde(default)]
    pub mean_time_s_worlds: Option<[f64; 2]>,
    /// Of `median_min_clearance_m`, likewise.
    #[serde(default)]
    pub median_min_clearance_m_worlds: [f64; 2],
    /// Of `cross_track_rms_m`, likewise.
    #[serde(default)]
    pub cross_track_rms_m_worlds: [f64; 2],
    /// Of `omega_rate_rms`, likewise.
    #[serde(default)]
    pub omega_rate_rms_worlds: [f64; 2],
}

/// A run in a world's list.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct SeedResult {
    /// Seed.
    pub seed: u64,
    /// The sensor that was dead, if one was.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dead_sensor: Option<usize>,
    /// How far from a route of known shape it was.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tracking: Vec<Tracked>,
    /// What came out.
    #[serde(flatten)]
    pub outcome: Outcome,
}

/// A world's runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct WorldResult {
    /// Number.
    pub world: u32,
    /// Name of its route, if that has a known shape.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub route: Option<String>,
    /// How far from it the runs were, RMS over them and the largest of any.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub tracking: Vec<Tracked>,
    /// Figures of its runs.
    #[serde(flatten)]
    pub figures: Figures,
    /// Its runs, by seed.
    pub attempts: Vec<SeedResult>,
}

/// A controller's campaign.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Results {
    /// What was run.
    #[serde(flatten)]
    pub conditions: Conditions,
    /// Which part of it this is, and of how many; none if it is all.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub shard: Option<[u32; 2]>,
    /// Figures of all its runs.
    #[serde(flatten)]
    pub figures: Figures,
    /// Their 95 % intervals.
    pub intervals_95: Intervals,
    /// Sensors that were dead one at a time.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub dead_sensors: Option<DeadSensors>,
    /// The same worlds and seeds with a sound robot.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sound: Option<Sound>,
    /// Worlds, by number.
    pub per_world: Vec<WorldResult>,
}

impl Figures {
    /// Of some runs.
    pub fn of(outcomes: &[Outcome]) -> Self {
        let runs = outcomes.len();
        let n = runs.max(1) as f64;
        let share = |ending| outcomes.iter().filter(|o| o.ending == ending).count() as f64 / n;
        let mean =
            |of: fn(&Outcome) -> f64| outcomes.iter().map(of).fold(0.0, |sum, x| sum + x) / n;
        let reached: Vec<f64> = outcomes
            .iter()
            .filter(|o| o.ending == Ending::Reached)
            .map(|o| o.time_s)
            .collect();
        let mut clearances: Vec<f64> = outcomes.iter().map(|o| o.min_clearance_m).collect();
        Self {
            runs,
            success: share(Ending::Reached),
            collision: share(Ending::Collision),
            timeout: share(Ending::Timeout),
            blocked: share(Ending::Blocked),
            out_or_blocked: share(Ending::Reached) + share(Ending::Blocked),
            score: mean(|o| o.score),
            mean_time_s: (!reached.is_empty())
                .then(|| reached.iter().fold(0.0, |sum, t| sum + t) / reached.len() as f64),
            median_min_clearance_m: median(&mut clearances),
            cross_track_rms_m: mean(|o| o.cross_track_rms_m * o.cross_track_rms_m).sqrt(),
            cross_track_max_m: outcomes
                .iter()
                .map(|o| o.cross_track_max_m)
                .fold(0.0, f64::max),
            omega_rate_rms: mean(|o| o.omega_rate_rms * o.omega_rate_rms).sqrt(),
            longest_stall_s: outcomes
                .iter()
                .map(|o| o.longest_stall_s)
                .fold(0.0, f64::max),
            stalls: outcomes.iter().map(|o| o.stalls).sum(),
        }
    }
}

/// Runs whose worlds come one after the other, by world.
pub fn by_world(runs: &[Run]) -> Vec<WorldResult> {
    let worlds = runs.chunk_by(|a, b| a.world == b.world);
    worlds
        .map(|runs| {
            let outcomes: Vec<Outcome> = runs.iter().map(|r| r.outcome).collect();
            let tracked: Vec<&[Tracked]> = runs
                .iter()
                .filter_map(|r| r.course.as_ref())
                .map(|(_, tracked)| tracked.as_slice())
                .collect();
            WorldResult {
                world: runs[0].world,
                route: runs[0].course.as_ref().map(|(name, _)| name.clone()),
                tracking: pooled(&tracked),
                figures: Figures::of(&outcomes),
                attempts: runs
                    .iter()
                    .map(|r| SeedResult {
                        seed: r.seed,
                        dead_sensor: r.dead,
                        tracking: r
                            .course
                            .as_ref()
                            .map(|(_, tracked)| tracked.clone())
                            .unwrap_or_default(),
                        outcome: r.outcome,
                    })
                    .collect(),
            }
        })
        .collect()
}

impl Intervals {
    fn of(outcomes: &[Outcome], per_world: &[WorldResult]) -> Self {
        let resampling = Resampling::new(per_world.len());
        let mean = |of: fn(&Outcome) -> f64, among: fn(&Outcome) -> bool| {
            let sums: Vec<(f64, usize)> = per_world
                .iter()
                .map(|world| {
                    let runs = world.attempts.iter().map(|a| &a.outcome);
                    let runs = runs.filter(|o| among(o));
                    runs.fold((0.0, 0), |(sum, n), o| (sum + of(o), n + 1))
                })
                .collect();
            resampling.mean(&sums)
        };
        let share = |of: fn(&Outcome) -> bool| {
            let hits: Vec<(f64, usize)> = per_world
                .iter()
                .map(|world| {
                    let hits = world.attempts.iter().filter(|a| of(&a.outcome)).count();
                    (hits as f64, world.attempts.len())
                })
                .collect();
            resampling.mean(&hits)
        };
        let reached = |o: &Outcome| o.ending == Ending::Reached;
        let touched = |o: &Outcome| o.ending == Ending::Collision;
        let count = |of: fn(&Outcome) -> bool| outcomes.iter().filter(|o| of(o)).count();
        let clearances = per_world.iter().enumerate().flat_map(|(place, world)| {
            let runs = world.attempts.iter();
            runs.map(move |a| (a.outcome.min_clearance_m, place))
        });
        // A root keeps the order.
        let root = |interval: [f64; 2]| interval.map(f64::sqrt);
        Self {
            success: wilson(count(reached), outcomes.len()),
            collision: wilson(count(touched), outcomes.len()),
            success_worlds: share(reached),
            collision_worlds: share(touched),
            score_worlds: mean(|o| o.score, |_| true),
            mean_time_s_worlds: (count(reached) > 0).then(|| mean(|o| o.time_s, reached)),
            median_min_clearance_m_worlds: resampling.median(clearances.collect()),
            cross_track_rms_m_worlds: root(mean(|o| o.cross_track_rms_m.powi(2), |_| true)),
            omega_rate_rms_worlds: root(mean(|o| o.omega_rate_rms.powi(2), |_| true)),
        }
    }
}

impl Results {
    /// Of worlds' results, and of the same worlds' with a sound robot if they were driven, too.
    pub fn of(
        conditions: Conditions,
        shard: Option<[u32; 2]>,
        per_world: Vec<WorldResult>,
        sound: Option<Vec<WorldResult>>,
    ) -> Self {
        let outcomes: Vec<Outcome> = per_world
            .iter()
            .flat_map(|w| w.attempts.iter().map(|a| a.outcome))
            .collect();
        let intervals_95 = Intervals::of(&outcomes, &per_world);
        let figures = Figures::of(&outcomes);
        let sound = sound.map(|worlds| Sound::new(&figures, worlds));
        Self {
            conditions,
            shard,
            figures,
            intervals_95,
            dead_sensors: DeadSensors::of(&per_world, sound.as_ref()),
            sound,
            per_world,
        }
    }
}
