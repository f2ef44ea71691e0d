//! A log's messages on a clock: where the robot is at any time, and when a scan comes.

use super::log::{Event, Log, Scan};
use crate::world::wrap;
use serde::Serialize;

/// Turning speed that goes with a pace, rad/s.
const TURNING: f64 = 1.0;

/// Longest recording, s: six hours.
pub const LONGEST: f64 = 21_600.0;

/// Where the times come from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Clock {
    /// The messages' own times.
    Messages,
    /// The logger's times: the messages' own run backward or are missing.
    Logger,
    /// None is usable: the robot is taken to drive from pose to pose at a constant pace.
    Pace,
}

/// A moment of the log.
#[derive(Clone, Copy, Debug)]
pub struct Moment<'a> {
    /// Since the first one, s.
    pub time: f64,
    /// Way driven since the first one, m.
    pub way: f64,
    /// x, y (m), heading (rad).
    pub pose: [f64; 3],
    /// What the laser saw.
    pub scan: Option<&'a Scan>,
}

/// The moments in the order of their times; never empty.
#[derive(Clone, Debug)]
pub struct Timeline<'a> {
    /// See above.
    pub moments: Vec<Moment<'a>>,
    /// Where their times come from.
    pub clock: Clock,
}

impl<'a> Timeline<'a> {
    /// Of a log; `pace` in m/s counts where it has no usable times.
    pub fn new(log: &'a Log, pace: f64) -> Self {
        let (clock, times) = [(Clock::Messages, 0), (Clock::Logger, 1)]
            .into_iter()
            .find_map(|(clock, which)| Some((clock, own_times(&log.events, which)?)))
            .unwrap_or_else(|| (Clock::Pace, paced(&log.events, pace)));
        let mut events: Vec<(f64, &Event)> = times.into_iter().zip(&log.events).collect();
        events.sort_by(|a, b| a.0.total_cmp(&b.0));
        let begin = events.first().map_or(0.0, |(time, _)| *time);
        let mut way = 0.0;
        let mut last: Option<[f64; 3]> = None;
        let moments = events
            .into_iter()
            .map(|(time, event)| {
                way += last.map_or(0.0, |before| distance(before, event.pose));
                last = Some(event.pose);
                Moment {
                    time: time - begin,
                    way,
                    pose: event.pose,
                    scan: event.scan.as_ref(),
                }
            })
            .collect();
        Self { moments, clock }
    }

    /// How long it takes, s.
    pub fn duration(&self) -> f64 {
        self.moments.last().map_or(0.0, |m| m.time)
    }

    /// Way driven in all, m.
    pub fn length(&self) -> f64 {
        self.moments.last().map_or(0.0, |m| m.way)
    }

    /// Pose and way at a time.
    pub fn at_time(&self, time: f64) -> ([f64; 3], f64) {
        self.between(time, |m| m.time)
    }

    /// Pose after a way.
    pub fn at_way(&self, way: f64) -> [f64; 3] {
        self.between(way, |m| m.way).0
    }

    fn between(&self, value: f64, of: fn(&Moment<'_>) -> f64) -> ([f64; 3], f64) {
        let next = self.moments.partition_point(|m| of(m) < value);
        let Some(to) = self.moments.get(next).or(self.moments.last()) else {
            return ([0.0; 3], 0.0);
        };
        let from = &self.moments[next.saturating_sub(1).min(self.moments.len() - 1)];
        let span = of(to) - of(from);
        let share = if span > 0.0 {
            ((value - of(from)) / span).clamp(0.0, 1.0)
        } else {
            1.0
        };
        let mix = |a: f64, b: f64| a + (b - a) * share;
        let turn = wrap(to.pose[2] - from.pose[2]);
        (
            [
                mix(from.pose[0], to.pose[0]),
                mix(from.pose[1], to.pose[1]),
                wrap(from.pose[2] + turn * share),
            ],
            mix(from.way, to.way),
        )
    }
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    libm::hypot(b[0] - a[0], b[1] - a[1])
}

/// The messages' times if all have one, they grow, and, each kind by itself, never go back.
fn own_times(events: &[Event], which: usize) -> Option<Vec<f64>> {
    let times: Vec<f64> = events
        .iter()
        .map(|e| e.times[which])
        .collect::<Option<_>>()?;
    let kind = |scans: bool| {
        let of_kind = events.iter().zip(&times);
        of_kind
            .filter(|(e, _)| e.scan.is_some() == scans)
            .map(|(_, t)| *t)
            .collect::<Vec<f64>>()
    };
    let forward = |times: &[f64]| times.is_sorted();
    let least = times.iter().copied().fold(f64::INFINITY, f64::min);
    let most = times.iter().copied().fold(f64::NEG_INFINITY, f64::max);
    let scans = kind(true);
    let grows = scans.len() < 2 || scans[0] < scans[scans.len() - 1];
    (grows && most > least && forward(&scans) && forward(&kind(false))).then_some(times)
}

/// Times of a robot that goes from pose to pose at `pace` m/s, or turns at 1 rad/s where that takes longer.
fn paced(events: &[Event], pace: f64) -> Vec<f64> {
    let mut time = 0.0;
    let mut last: Option<[f64; 3]> = None;
    events
        .iter()
        .map(|event| {
            if let Some(before) = last {
                let turn = wrap(event.pose[2] - before[2]).abs();
                time += (distance(before, event.pose) / pace).max(turn / TURNING);
            }
            last = Some(event.pose);
            time
        })
        .collect()
}
