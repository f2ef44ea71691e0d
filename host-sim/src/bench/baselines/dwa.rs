//! The dynamic window approach: of the twists that can be reached within a tick and from which the robot can still
//! stop, the one with the best heading, clearance and speed.
//!
//! Source: D. Fox, W. Burgard, S. Thrun, *The Dynamic Window Approach to Collision Avoidance*, IEEE Robotics &
//! Automation Magazine 4(1), 1997; equations 11 to 16. Obstacles are the echoes of the last moments, as there; the body
//! is the footprint.

use super::destination::Destination;
use super::echoes::Memory;
use crate::bench::body::BodyFrame;
use crate::bench::navigator::{Command, Inputs, Mission, Mode, Navigator};
use crate::bench::vehicle::along;
use crate::world::wrap;

/// What may be tuned.
#[derive(Clone, Copy, Debug)]
pub struct Parameters {
    /// Weights of heading, distance and velocity (α, β, γ; the paper has 2, 0.2, 0.2 before its smoothing).
    pub weights: [f64; 3],
    /// How far an arc is looked along, m.
    pub look: f64,
    /// Distance that is kept to every point, m.
    pub margin: f64,
    /// How long echoes are kept, s.
    pub keep: f64,
    /// Distance of the carrot on a planned route, m.
    pub carrot: f64,
    /// Share of the braking that admissible speeds count on.
    pub braking: f64,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            weights: [2.0, 0.4, 1.99],
            look: 1.5,
            margin: 0.054,
            keep: 1.53,
            carrot: 1.17,
            braking: 0.32,
        }
    }
}

/// Twists tried: speeds times yaw rates of the window.
const SPEEDS: usize = 6;
const YAW_RATES: usize = 15;

/// The window's length, s: several ticks, or a grid of a few samples would not reach from turning to driving.
const WINDOW: f64 = 0.25;

/// Steps along an arc, m.
const STEP: f64 = 0.1;

/// See the module.
#[derive(Clone, Debug)]
pub struct Dwa {
    mission: Mission,
    destination: Destination,
    parameters: Parameters,
    memory: Memory,
    /// Points in the body's frame, with their distance from the body.
    points: Vec<([f64; 2], f64)>,
}

impl Dwa {
    /// For a mission.
    pub fn new(mission: &Mission, parameters: Parameters) -> Self {
        Self {
            destination: Destination::new(mission, parameters.carrot),
            mission: mission.clone(),
            parameters,
            memory: Memory::new(parameters.keep, 2.5, 0.05),
            points: Vec::new(),
        }
    }

    /// Free length of the arc of a twist, m, at most `look`; for turning in place the free angle times the outer radius.
    fn free(&self, [v, w]: [f64; 2]) -> f64 {
        let p = self.parameters;
        let body = &self.mission.body;
        // Time for a step of the outermost point.
        let rate = v.abs().max(w.abs() * body.outer_radius());
        if rate < 1e-6 {
            return p.look;
        }
        let dt = STEP / rate;
        let steps = (p.look / STEP) as usize;
        for k in 1..=steps {
            let frame = BodyFrame::new(along([0.0; 3], [v, w], k as f64 * dt));
            let hit = self.points.iter().any(|(q, now)| {
                let p2 = frame.see(*q);
                // What is too near already may be left behind.
                body.distance_squared(p2) < p.margin * p.margin && body.distance(p2) < now - 1e-6
            });
            if hit {
                return (k - 1) as f64 * STEP;
            }
        }
        p.look
    }
}

impl Navigator for Dwa {
    fn tick(&mut self, inputs: &Inputs<'_>) -> Command {
        let p = self.parameters;
        let limits = self.mission.limits;
        let [x, y, heading] = inputs.pose;
        let Some(target) = self.destination.from([x, y]) else {
            return Command::stop(Mode::Arrived);
        };
        self.memory.observe(&self.mission.sensors, inputs);
        let reach = p.look + self.mission.body.outer_radius() + p.margin;
        let (frame, body) = (BodyFrame::new(inputs.pose), &self.mission.body);
        self.points.clear();
        self.points.extend(
            self.memory
                .points
                .iter()
                .map(|seen| frame.see(seen.at))
                .filter(|[u, v]| u * u + v * v < reach * reach)
                .map(|point| (point, body.distance(point))),
        );
        let [v0, w0] = inputs.twist;
        let braking = p.braking * limits.acceleration;
        let slowest = (v0 - limits.acceleration * WINDOW).max(0.0);
        let fastest = (v0 + limits.acceleration * WINDOW)
            .min(limits.speed)
            .min((2.0 * braking * target.left).sqrt().max(0.1));
        let turn = limits.yaw_acceleration * WINDOW;
        let mut best: Option<(f64, [f64; 2])> = None;
        for i in 0..SPEEDS {
            let v = slowest + (fastest - slowest).max(0.0) * i as f64 / (SPEEDS - 1) as f64;
            for k in 0..YAW_RATES {
                let share = 2.0 * k as f64 / (YAW_RATES - 1) as f64 - 1.0;
                let w = (w0 + share * turn).clamp(-limits.yaw_rate, limits.yaw_rate);
                let free = self.free([v, w]);
                // Equation 14: admissible if it can stop before the obstacle.
                if v > (2.0 * braking * free).sqrt() {
                    continue;
                }
                // Section 4.2: the heading that the robot would have after braking its turn.
                let settled = heading + w * WINDOW + w * w.abs() / (2.0 * limits.yaw_acceleration);
                let aligned = 1.0 - wrap(target.bearing - settled).abs() / std::f64::consts::PI;
                let [a, b, c] = p.weights;
                let value = a * aligned + b * free / p.look + c * v / limits.speed;
                if best.is_none_or(|(most, _)| value > most) {
                    best = Some((value, [v, w]));
                }
            }
        }
        match best {
            Some((_, [speed, yaw_rate])) if speed > 0.02 || yaw_rate.abs() > 0.02 => Command {
                speed,
                yaw_rate,
                mode: Mode::Avoid,
            },
            // Section 5.3 of the paper: nothing admissible, so turn away until something is.
            _ => Command {
                speed: 0.0,
                yaw_rate: 0.8_f64.copysign(wrap(target.bearing - heading)),
                mode: Mode::Escape,
            },
        }
    }
}
