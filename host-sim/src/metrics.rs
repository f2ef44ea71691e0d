//! What a run amounts to: the summary that is printed, written and compared.

use crate::run::{Ending, Gap, Period, Step};
use crate::scenario::Scenario;
use crate::si;
use crate::world::wrap;
use fuzzypilot::signals::{Decision, Turn};
use serde::Serialize;

/// Within this cross-track error, and headed along the path within [`ALONG`], the path counts as regained, and a free
/// stretch begins, m.
pub const REGAINED: f64 = 0.05;

/// Largest angle to the tangent at which the path counts as regained and not merely crossed, radians.
pub const ALONG: f64 = 0.35;

/// One pass of an obstacle, from first entering avoidance to last leaving it before the path is regained or another
/// obstacle's turn comes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Avoidance {
    /// The obstacle.
    pub obstacle: String,
    /// `left` or `right`: where the robot turned.
    pub side: &'static str,
    /// Ticks in avoidance.
    pub steps: u64,
    /// First tick.
    pub first_tick: u64,
    /// Distance to the path when it ended, m.
    pub distance_at_end_m: f64,
    /// Ticks from its end until the path was regained; none if another avoidance or the end came first.
    pub regain_steps: Option<u64>,
}

/// The figures of one run.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// Scenario.
    pub scenario: String,
    /// `guided` or `paper`.
    pub law: String,
    /// Law, tables and variants.
    pub variant: String,
    /// Seed.
    pub seed: u64,
    /// Ticks run.
    pub ticks: u64,
    /// Simulated time, s.
    pub sim_time_s: f64,
    /// The path was driven to its end (or all laps), as the robot believes: see `odometry_error_m`.
    pub reached_end: bool,
    /// `path end`, `path missed` (over, but the robot elsewhere) or `time limit`; with hardware in the loop also
    /// `disarmed` or `link lost`.
    pub ended: &'static str,
    /// Times that the robot came into contact with an obstacle.
    pub collisions: u64,
    /// Least distance from the rim to an obstacle, m; null in an empty world.
    pub min_clearance_m: Option<f64>,
    /// Root mean square of the true cross-track error on free stretches, m; null if there was none.
    pub cross_track_rms_m: Option<f64>,
    /// Its maximum there, m.
    pub cross_track_max_m: Option<f64>,
    /// Ticks on free stretches: following, and the path regained (error at most 0.05 m
    /// and heading within 20° of the path, once) since the last avoidance.
    pub free_ticks: u64,
    /// Distance travelled until the path was first regained, m.
    pub first_regained_after_m: Option<f64>,
    /// Mean speed, m/s.
    pub mean_speed_mps: f64,
    /// Ticks in which the guard slowed the robot.
    pub guarded_ticks: u64,
    /// Distance between believed and true position at the end, m.
    pub odometry_error_m: f64,
    /// The passes.
    pub avoidances: Vec<Avoidance>,
}

/// Gathers a summary tick by tick.
#[derive(Clone, Debug)]
pub struct Metrics {
    summary: Summary,
    squares: f64,
    worst: f64,
    travelled: f64,
    last: Option<[f64; 2]>,
    touching: bool,
    avoiding: bool,
    regained: bool,
    left_at: Option<u64>,
    /// Control periods without a tick.
    gaps: u64,
    period: f64,
    names: Vec<(String, [f64; 2])>,
}

impl Metrics {
    /// For a run of `scenario`.
    pub fn new(scenario: &Scenario, seed: u64) -> Self {
        let law = match scenario.control.law {
            crate::control::LawName::Guided => "guided",
            crate::control::LawName::Paper => "paper",
        };
        Self {
            summary: Summary {
                scenario: scenario.name.clone(),
                law: law.to_owned(),
                variant: scenario.control.describe(scenario.robot.preset),
                seed,
                ticks: 0,
                sim_time_s: 0.0,
                reached_end: false,
                ended: "",
                collisions: 0,
                min_clearance_m: None,
                cross_track_rms_m: None,
                cross_track_max_m: None,
                free_ticks: 0,
                first_regained_after_m: None,
                mean_speed_mps: 0.0,
                guarded_ticks: 0,
                odometry_error_m: 0.0,
                avoidances: Vec::new(),
            },
            squares: 0.0,
            worst: 0.0,
            travelled: 0.0,
            last: None,
            touching: false,
            avoiding: false,
            regained: false,
            left_at: None,
            gaps: 0,
            period: scenario.robot.period,
            names: scenario
                .world
                .discs
                .iter()
                .map(|d| (d.name.clone(), [d.x, d.y]))
                .collect(),
        }
    }

    /// Takes one tick in.
    pub fn observe(&mut self, step: &Step<'_>) {
        let tick = self.summary.ticks;
        self.summary.ticks += 1;
        let at = self.go_on(step.truth, step.clearance.0);
        self.summary.guarded_ticks += u64::from(step.record.guarded);
        let believed = si::from_pose(step.record.pose);
        self.summary.odometry_error_m = (believed[0] - at[0]).hypot(believed[1] - at[1]);

        match step.record.decision {
            Decision::Avoid { side, obstacle } => {
                self.regained = false;
                let centre = step.record.pose.to_world(obstacle.centre);
                let estimate = [si::from_metres(centre.x), si::from_metres(centre.y)];
                self.avoid(tick, side, estimate);
            }
            Decision::Follow => {
                let tangent = si::from_angle(step.record.guidance.tangent);
                let along = wrap(step.truth[2] - tangent).abs() <= ALONG;
                self.follow(tick, step.cross_track, along);
            }
            Decision::Stop(_) => self.leave(tick, step.cross_track),
        }
    }

    /// Takes a control period in, with a tick or without.
    pub fn period(&mut self, period: &Period<'_>) {
        match period {
            Period::Tick(step) => self.observe(step),
            Period::Gap(gap) => self.gap(gap),
        }
    }

    fn gap(&mut self, gap: &Gap) {
        self.gaps += 1;
        self.go_on(gap.truth, gap.clearance.0);
    }

    /// Where the robot truly is; returned once more.
    fn go_on(&mut self, truth: [f64; 3], clearance: f64) -> [f64; 2] {
        let at = [truth[0], truth[1]];
        if let Some(last) = self.last.replace(at) {
            self.travelled += (at[0] - last[0]).hypot(at[1] - last[1]);
        }
        if clearance.is_finite() {
            let least = self.summary.min_clearance_m.unwrap_or(f64::INFINITY);
            self.summary.min_clearance_m = Some(least.min(clearance));
        }
        let touching = clearance < 0.0;
        if touching && !self.touching {
            self.summary.collisions += 1;
        }
        self.touching = touching;
        at
    }

    fn avoid(&mut self, tick: u64, side: Turn, estimate: [f64; 2]) {
        let name = self
            .names
            .iter()
            .min_by(|a, b| apart(a.1, estimate).total_cmp(&apart(b.1, estimate)))
            .map_or_else(|| "none".to_owned(), |(name, _)| name.clone());
        let side = match side {
            Turn::Left => "left",
            Turn::Right => "right",
        };
        let pending = self.avoiding || self.left_at.is_some();
        match self.summary.avoidances.last_mut() {
            Some(last) if pending && last.obstacle == name && last.side == side => {
                last.steps += 1;
            }
            _ => self.summary.avoidances.push(Avoidance {
                obstacle: name,
                side,
                steps: 1,
                first_tick: tick,
                distance_at_end_m: 0.0,
                regain_steps: None,
            }),
        }
        self.avoiding = true;
        self.left_at = None;
    }

    fn follow(&mut self, tick: u64, cross_track: f64, along: bool) {
        self.leave(tick, cross_track);
        if !self.regained && along && cross_track.abs() <= REGAINED {
            self.regained = true;
            self.summary
                .first_regained_after_m
                .get_or_insert(self.travelled);
            if let (Some(left), Some(last)) =
                (self.left_at.take(), self.summary.avoidances.last_mut())
            {
                last.regain_steps = Some(tick - left);
            }
        }
        if self.regained {
            self.summary.free_ticks += 1;
            self.squares += cross_track * cross_track;
            self.worst = self.worst.max(cross_track.abs());
        }
    }

    fn leave(&mut self, tick: u64, cross_track: f64) {
        if self.avoiding {
            self.avoiding = false;
            self.left_at = Some(tick);
            if let Some(last) = self.summary.avoidances.last_mut() {
                last.distance_at_end_m = cross_track.abs();
            }
        }
    }

    /// The summary of a run that ended so.
    pub fn finish(mut self, ending: Ending) -> Summary {
        let s = &mut self.summary;
        s.sim_time_s = (s.ticks + self.gaps) as f64 * self.period;
        s.reached_end = ending == Ending::PathEnd;
        s.ended = match ending {
            Ending::PathEnd => "path end",
            Ending::PathMissed => "path missed",
            Ending::TimeLimit => "time limit",
            Ending::Disarmed => "disarmed",
            Ending::LinkLost => "link lost",
        };
        s.mean_speed_mps = self.travelled / s.sim_time_s.max(f64::MIN_POSITIVE);
        if s.free_ticks > 0 {
            s.cross_track_rms_m = Some((self.squares / s.free_ticks as f64).sqrt());
            s.cross_track_max_m = Some(self.worst);
        }
        self.summary
    }
}

fn apart(a: [f64; 2], b: [f64; 2]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}
