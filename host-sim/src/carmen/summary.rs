//! What a replay came to: the figures, and a row a tick.

use super::log::Log;
use super::replay::{Decision, Replay, name};
use super::timeline::{Clock, Timeline};
use crate::si;
use fuzzypilot::navigate::Manoeuvre;
use serde::Serialize;
use std::collections::BTreeMap;

/// Nothing was near: the library's "as far as it counts", m.
const FAR: f64 = 7.9;

/// The figures.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Summary {
    /// The log.
    pub source: String,
    /// Laser scans in it.
    pub scans: usize,
    /// Messages with a pose, scans included.
    pub messages: usize,
    /// Where the times come from.
    pub clock: Clock,
    /// Whether the poses are the lasers', corrected after the drive.
    pub corrected: bool,
    /// s.
    pub duration_s: f64,
    /// Way of the recorded robot, m.
    pub driven_m: f64,
    /// Periods of the navigator.
    pub ticks: usize,
    /// Share of the ticks that each manoeuvre had, 0 to 1, all five of them.
    pub manoeuvres: BTreeMap<&'static str, f64>,
    /// Share of the ticks in which the arc barrier slowed the command.
    pub slowed: f64,
    /// Share in which the brake gate changed it.
    pub gated: f64,
    /// Share in which no twist was found that stays clear of every known point.
    pub trapped: f64,
    /// Mean of the speed that was decided, m/s.
    pub mean_speed_mps: f64,
    /// Least distance of a remembered point from the outline; none if nothing was ever within 2 m.
    pub least_clearance_m: Option<f64>,
    /// When that was, s.
    pub least_clearance_at_s: Option<f64>,
    /// Least distance of a beam's end from the outline, m: below zero the outline is larger than the recorded robot's.
    pub least_beam_m: Option<f64>,
    /// Most points that were remembered at once.
    pub most_points: u16,
}

impl Summary {
    /// Of a replay.
    pub fn of(source: &str, log: &Log, timeline: &Timeline<'_>, replay: &Replay) -> Self {
        let decisions = &replay.decisions;
        let n = decisions.len().max(1) as f64;
        let share =
            |of: &dyn Fn(&Decision) -> bool| decisions.iter().filter(|d| of(d)).count() as f64 / n;
        let manoeuvres = [
            Manoeuvre::Follow,
            Manoeuvre::Avoid,
            Manoeuvre::Escape,
            Manoeuvre::Blocked,
            Manoeuvre::Arrived,
        ]
        .map(|m| (name(m), share(&|d| d.record.manoeuvre == m)));
        let nearest = decisions
            .iter()
            .filter(|d| clearance(d).is_finite())
            .min_by(|a, b| clearance(a).total_cmp(&clearance(b)));
        let beam = decisions
            .iter()
            .map(|d| d.nearest_beam)
            .fold(f64::INFINITY, f64::min);
        let speeds = decisions
            .iter()
            .map(|d| si::from_speed(d.record.twist.linear));
        Self {
            source: source.to_owned(),
            scans: log.events.iter().filter(|e| e.scan.is_some()).count(),
            messages: log.events.len(),
            clock: timeline.clock,
            corrected: log.corrected,
            duration_s: timeline.duration(),
            driven_m: timeline.length(),
            ticks: decisions.len(),
            manoeuvres: manoeuvres.into_iter().collect(),
            slowed: share(&|d| d.record.guarded.slowed),
            gated: share(&|d| d.record.guarded.gated),
            trapped: share(&|d| d.record.guarded.trapped),
            mean_speed_mps: speeds.sum::<f64>() / n,
            least_clearance_m: nearest.map(clearance),
            least_clearance_at_s: nearest.map(|d| d.time),
            least_beam_m: beam.is_finite().then_some(beam),
            most_points: decisions.iter().map(|d| d.record.points).max().unwrap_or(0),
        }
    }
}

/// Distance of the nearest remembered point from the outline, m; infinite if none is within 2 m.
pub fn clearance(decision: &Decision) -> f64 {
    let clearance = si::from_metres(decision.record.clearance);
    if clearance < FAR {
        clearance
    } else {
        f64::INFINITY
    }
}

/// The header of [`csv()`].
pub const COLUMNS: [&str; 18] = [
    "tick",
    "t_s",
    "x_m",
    "y_m",
    "heading_rad",
    "scan",
    "goal_x_m",
    "goal_y_m",
    "manoeuvre",
    "wanted_v_mps",
    "wanted_w_radps",
    "v_mps",
    "w_radps",
    "slowed",
    "gated",
    "trapped",
    "points",
    "clearance_m",
];

/// A row a tick. Clearance is empty where nothing is near.
///
/// # Errors
///
/// When the table cannot be written.
pub fn csv(replay: &Replay) -> anyhow::Result<Vec<u8>> {
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(COLUMNS)?;
    for (tick, decision) in replay.decisions.iter().enumerate() {
        let record = &decision.record;
        let flag = |on: bool| u8::from(on).to_string();
        let number = |x: f64| format!("{x:.4}");
        let [x, y, heading] = decision.pose;
        let room = clearance(decision);
        writer.write_record([
            tick.to_string(),
            format!("{:.2}", decision.time),
            number(x),
            number(y),
            number(heading),
            flag(decision.scanned),
            number(decision.goal[0]),
            number(decision.goal[1]),
            name(record.manoeuvre).to_owned(),
            number(si::from_speed(record.wanted.linear)),
            number(si::from_rate(record.wanted.angular)),
            number(si::from_speed(record.twist.linear)),
            number(si::from_rate(record.twist.angular)),
            flag(record.guarded.slowed),
            flag(record.guarded.gated),
            flag(record.guarded.trapped),
            record.points.to_string(),
            if room.is_finite() {
                number(room)
            } else {
                String::new()
            },
        ])?;
    }
    Ok(writer.into_inner()?)
}
