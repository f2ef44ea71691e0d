//! What went over a link in a run.

use super::line::{Traffic, Welcome};
use fuzzypilot::link::frame::{Counters, VERSION};
use serde::Serialize;
use std::time::Duration;

/// How frames were received.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Received {
    /// Sound ones.
    pub good: u32,
    /// Overlong ones: a terminator was lost.
    pub overlong: u16,
    /// With bytes missing.
    pub truncated: u16,
    /// With a wrong CRC.
    pub corrupt: u16,
    /// Of another protocol version.
    pub other_version: u16,
}

impl From<Counters> for Received {
    fn from(counters: Counters) -> Self {
        Self {
            good: counters.good,
            overlong: counters.overlong,
            truncated: counters.truncated,
            corrupt: counters.corrupt,
            other_version: counters.version,
        }
    }
}

/// Something that happened to the robot.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Event {
    /// When, s of the run.
    pub time_s: f64,
    /// `answer lost`, `silent`, `disarmed: CAUSE`, `armed again`, `motors stopped by themselves`.
    pub what: String,
}

/// What went over a link in a run: `link.json`.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct LinkReport {
    /// What it led to.
    pub target: String,
    /// The robot's firmware.
    pub firmware: String,
    /// Version of the protocol.
    pub protocol: u8,
    /// Room for range sensors, segments and points.
    pub room: [usize; 3],
    /// Deepest stack of the robot, bytes; 0 if it does not know.
    pub stack_bytes: u32,
    /// Ticks that were answered.
    pub ticks: u64,
    /// Control periods whose tick was not.
    pub lost_ticks: u64,
    /// Control periods that the robot was disarmed.
    pub disarmed_ticks: u64,
    /// Simulated time, s.
    pub sim_time_s: f64,
    /// Time that the set-up took, s.
    pub setup_s: f64,
    /// Time that the run took, s.
    pub run_s: f64,
    /// Simulated time by the run's.
    pub times_real_time: f64,
    /// Questions answered in all.
    pub round_trips: u64,
    /// Of the run, a second.
    pub round_trips_per_s: f64,
    /// Frames sent.
    pub frames_sent: u64,
    /// Bytes sent.
    pub bytes_sent: u64,
    /// Bytes received.
    pub bytes_received: u64,
    /// Frames sent once more for want of an answer.
    pub retries: u64,
    /// Answers that came too late, or twice.
    pub late: u64,
    /// Frames that this end has received.
    pub received: Received,
    /// Frames that the robot has received, as it says.
    pub received_by_target: Received,
    /// Frames that were spoiled on purpose, by kind.
    pub faults: Vec<(String, u64)>,
    /// What happened, in the order of time; the first [`MAX_EVENTS`] of it.
    pub events: Vec<Event>,
    /// Longest time after their last command at which motors stopped by themselves, ms.
    pub motors_stopped_after_ms: Option<f64>,
}

/// More events are not kept.
pub const MAX_EVENTS: usize = 1000;

impl LinkReport {
    /// For a robot that has just been set up.
    pub fn new(target: String, welcome: &Welcome) -> Self {
        let [major, minor, patch] = welcome.firmware;
        Self {
            target,
            firmware: format!("{major}.{minor}.{patch}"),
            protocol: VERSION,
            room: [
                welcome.ranges.into(),
                welcome.segments.into(),
                welcome.points.into(),
            ],
            ..Self::default()
        }
    }

    /// Notes something.
    pub fn event(&mut self, time_s: f64, what: impl Into<String>) {
        if self.events.len() < MAX_EVENTS {
            let what = what.into();
            self.events.push(Event { time_s, what });
        }
    }

    /// Takes over when the motors stopped by themselves, and how long after their last command, s.
    pub fn motors(&mut self, stops: &[(f64, f64)]) {
        for (time, after) in stops {
            self.event(*time, "motors stopped by themselves");
            let worst = self.motors_stopped_after_ms.unwrap_or(0.0);
            self.motors_stopped_after_ms = Some(worst.max(after * 1e3));
        }
        self.events.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
    }

    /// Takes over what was counted.
    pub fn count(&mut self, traffic: &Traffic) {
        self.round_trips = traffic.round_trips;
        self.frames_sent = traffic.sent;
        self.bytes_sent = traffic.sent_bytes;
        self.bytes_received = traffic.received_bytes;
        self.retries = traffic.retries;
        self.late = traffic.late;
        self.received = traffic.received.into();
    }

    /// Takes over how long it took.
    pub fn time(&mut self, setup: Duration, run: Duration, trips: u64, sim_time_s: f64) {
        let seconds = run.as_secs_f64().max(f64::MIN_POSITIVE);
        self.setup_s = setup.as_secs_f64();
        self.run_s = run.as_secs_f64();
        self.sim_time_s = sim_time_s;
        self.times_real_time = sim_time_s / seconds;
        self.round_trips_per_s = trips as f64 / seconds;
    }
}
