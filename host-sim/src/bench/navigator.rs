//! What the bench asks of a navigator: a tick from what the robot senses to a twist.

use super::body::Body;
use super::vehicle::Limits;
use crate::recording::{BeamView, NavigatorView};
use crate::track::Piece;
use fuzzypilot::ports::RangeReading;
use std::fmt;

/// What a navigator is told before it sets off. It is made anew for every run.
#[derive(Clone, Debug)]
pub struct Mission {
    /// Where the robot stands: x, y (m), heading (rad).
    pub start: [f64; 3],
    /// Where it shall go, m.
    pub goal: [f64; 2],
    /// How near to the goal counts as there, m. Nothing stops a navigator from going on to the goal itself.
    pub goal_radius: f64,
    /// Polyline from start to goal, both included, m: a planner's path, or the straight line and no more.
    pub route: Vec<[f64; 2]>,
    /// The route as lines and arcs, where it is more than points; then `route` is the same as points, close together.
    pub pieces: Vec<Piece>,
    /// Whether the route is a planner's, which knew the mapped obstacles. False: only the straight line is given.
    pub planned: bool,
    /// The body.
    pub body: Body,
    /// What the body can do; `limits.speed` is also the run's speed cap.
    pub limits: Limits,
    /// The range sensors, in the order of [`Inputs::ranges`].
    pub sensors: Vec<BeamView>,
    /// Time between ticks, s.
    pub period: f64,
    /// Time from a command to its effect, s.
    pub latency: f64,
}

/// What a navigator gets in a tick.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a> {
    /// Since the start, s.
    pub time: f64,
    /// Pose as odometry has it: x, y (m), heading (rad, in (−π, π]).
    pub pose: [f64; 3],
    /// Speed (m/s) and yaw rate (rad/s) as odometry has them.
    pub twist: [f64; 2],
    /// One reading a sensor, all measured now, at the pose above.
    pub ranges: &'a [RangeReading],
}

/// What a navigator wants.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Command {
    /// Forward speed, m/s; the vehicle limits it to its own, and its backward speed to the limits' `reverse`.
    pub speed: f64,
    /// Yaw rate, rad/s, left positive; limited likewise.
    pub yaw_rate: f64,
    /// What it is doing.
    pub mode: Mode,
}

impl Command {
    /// Standing still.
    pub const fn stop(mode: Mode) -> Self {
        Self {
            speed: 0.0,
            yaw_rate: 0.0,
            mode,
        }
    }
}

/// What a navigator says it is doing. Only [`Mode::Blocked`] and [`Mode::Arrived`] matter to the bench: the first
/// excuses a robot that does not move, and ends the run when it lasts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// On its route.
    Follow,
    /// Around something.
    Avoid,
    /// Out of a place without a way ahead.
    Escape,
    /// Stopped: sees no way.
    Blocked,
    /// Stopped: believes it is at the goal.
    Arrived,
}

impl Mode {
    /// For reports and the replay.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Follow => "follow",
            Self::Avoid => "avoid",
            Self::Escape => "escape",
            Self::Blocked => "blocked",
            Self::Arrived => "arrived",
        }
    }
}

/// A controller under test.
pub trait Navigator {
    /// One tick. Called every [`Mission::period`]; what it returns acts [`Mission::latency`] later.
    fn tick(&mut self, inputs: &Inputs<'_>) -> Command;

    /// What it thought in the last tick, for the replay. Nothing is to be kept for this that costs a campaign time.
    fn view(&self) -> Option<NavigatorView> {
        None
    }
}

impl fmt::Debug for dyn Navigator + '_ {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("Navigator")
    }
}
