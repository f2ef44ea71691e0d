//! A world to get through: discs, some of them moving, a start, a goal, and what is known of the way.

use crate::track::Piece;
use std::ops::Range;

/// A circle.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Circle {
    /// Centre, m.
    pub at: [f64; 2],
    /// Radius, m, positive.
    pub radius: f64,
}

/// A circle that goes to and fro between two points at a constant speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mover {
    /// Where it is at time zero, m.
    pub from: [f64; 2],
    /// Where it turns back, m.
    pub to: [f64; 2],
    /// Its speed, m/s, not negative.
    pub speed: f64,
    /// Radius, m, positive.
    pub radius: f64,
}

impl Mover {
    /// Where it is.
    pub fn at(&self, time: f64) -> Circle {
        let (dx, dy) = (self.to[0] - self.from[0], self.to[1] - self.from[1]);
        let length = libm::hypot(dx, dy);
        let share = if length > 0.0 {
            let there_and_back = (self.speed * time / length).rem_euclid(2.0);
            1.0 - (there_and_back - 1.0).abs()
        } else {
            0.0
        };
        Circle {
            at: [self.from[0] + share * dx, self.from[1] + share * dy],
            radius: self.radius,
        }
    }
}

/// A route of a known shape, on which the distance from it says something.
#[derive(Clone, Debug, PartialEq)]
pub struct Course {
    /// Name, such as `arc-r2`.
    pub name: String,
    /// Lines and arcs, one after the other.
    pub pieces: Vec<Piece>,
    /// Parts that are looked at by themselves.
    pub stretches: Vec<Stretch>,
    /// Where the far edge of an obstacle on it is, m along the route.
    pub passed: Option<f64>,
}

/// A part of a route.
#[derive(Clone, Debug, PartialEq)]
pub struct Stretch {
    /// Name, such as `approach`.
    pub name: String,
    /// m along the route.
    pub along: Range<f64>,
}

/// A world to get through.
#[derive(Clone, Debug, PartialEq)]
pub struct Arena {
    /// The benchmark's number, or the generator's seed.
    pub number: u32,
    /// What stands still.
    pub circles: Vec<Circle>,
    /// How many of these, the last ones, the route knows nothing of.
    pub unmapped: usize,
    /// What moves.
    pub movers: Vec<Mover>,
    /// x, y (m), heading (rad).
    pub start: [f64; 3],
    /// m.
    pub goal: [f64; 2],
    /// How near counts as there, m.
    pub goal_radius: f64,
    /// Whether there is no way to the goal, and a robot ought to say so.
    pub sealed: bool,
    /// The planner's path from start to goal, both included, m.
    pub route: Vec<[f64; 2]>,
    /// What the route is, if it is more than a planner's path; then `route` is the same as points.
    pub course: Option<Course>,
}

impl Arena {
    /// Length of the route, m: what the score's optimal time is made of.
    pub fn route_length(&self) -> f64 {
        length(&self.route)
    }
}

/// Length of a polyline, m.
pub fn length(line: &[[f64; 2]]) -> f64 {
    line.windows(2)
        .map(|w| libm::hypot(w[1][0] - w[0][0], w[1][1] - w[0][1]))
        .sum()
}
