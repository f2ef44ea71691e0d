//! BendyRuler: of the bearings around the one to the destination the first whose way ahead, and a way on from its end,
//! keep the margin; it does not change sides without a reason.
//!
//! Source: ArduPilot's BendyRuler as documented for Rover (R. Mackay's talk "Object avoidance path planning", and the
//! parameters `OA_BR_LOOKAHEAD`, `OA_BR_CONT_RATIO`, `OA_BR_CONT_ANGLE`, `OA_MARGIN_MAX`, `OA_DB_EXPIRE`). Written from
//! the description, scaled from boats to a robot of half a metre.

use super::destination::Destination;
use super::echoes::Memory;
use super::route::distance;
use super::steer::{stopping_speed, towards};
use crate::bench::navigator::{Command, Inputs, Mission, Mode, Navigator};
use crate::world::wrap;

/// What may be tuned.
#[derive(Clone, Copy, Debug)]
pub struct Parameters {
    /// Length of the first look, m (`OA_BR_LOOKAHEAD`).
    pub lookahead: f64,
    /// Length of the look from its end on, m.
    pub onward: f64,
    /// Distance of the robot's centre from every obstacle, m (`OA_MARGIN_MAX`).
    pub margin: f64,
    /// How long obstacles are kept, s (`OA_DB_EXPIRE`).
    pub keep: f64,
    /// Share of a cone's half width that an obstacle is thick.
    pub thickness: f64,
    /// Change of bearing above which a better margin is asked for, rad (`OA_BR_CONT_ANGLE`, 75°).
    pub change: f64,
    /// How much better it must be (`OA_BR_CONT_RATIO`, 1.5).
    pub ratio: f64,
    /// Distance of the carrot on a planned route, m.
    pub carrot: f64,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            lookahead: 1.52,
            onward: 0.2,
            margin: 0.3,
            keep: 1.0,
            thickness: 0.0,
            change: 1.309,
            ratio: 1.69,
            carrot: 0.67,
        }
    }
}

/// Step of the bearings, degrees, and their last.
const STEP: f64 = 5.0;
const LAST: f64 = 170.0;

/// See the module.
#[derive(Clone, Debug)]
pub struct Bendy {
    mission: Mission,
    destination: Destination,
    parameters: Parameters,
    memory: Memory,
    /// Bearing chosen last, rad in odometry's frame.
    last: Option<f64>,
}

impl Bendy {
    /// For a mission.
    pub fn new(mission: &Mission, parameters: Parameters) -> Self {
        Self {
            destination: Destination::new(mission, parameters.carrot),
            mission: mission.clone(),
            parameters,
            memory: Memory::new(parameters.keep, 2.5, 0.08),
            last: None,
        }
    }

    /// Least distance of the obstacles from a stretch, m.
    fn margin(&self, from: [f64; 2], bearing: f64, length: f64) -> f64 {
        let (sin, cos) = libm::sincos(bearing);
        self.memory
            .points
            .iter()
            .map(|p| {
                let (dx, dy) = (p.at[0] - from[0], p.at[1] - from[1]);
                let along = (dx * cos + dy * sin).clamp(0.0, length);
                libm::hypot(dx - along * cos, dy - along * sin)
                    - self.parameters.thickness * p.radius
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// The bearing to drive, and the margin that it has.
    fn bearing(&mut self, from: [f64; 2], destination: [f64; 2]) -> (f64, f64) {
        let p = self.parameters;
        let wanted = libm::atan2(destination[1] - from[1], destination[0] - from[0]);
        let look = p.lookahead.min(distance(from, destination));
        let mut best = (wanted, f64::NEG_INFINITY);
        let mut chosen = None;
        let mut offset: f64 = 0.0;
        'bearings: while offset <= LAST {
            for side in [1.0, -1.0] {
                if offset == 0.0 && side < 0.0 {
                    continue;
                }
                let bearing = wanted + side * offset.to_radians();
                let margin = self.margin(from, bearing, look);
                if margin > best.1 {
                    best = (bearing, margin);
                }
                if margin < p.margin {
                    continue;
                }
                let (sin, cos) = libm::sincos(bearing);
                let end = [from[0] + look * cos, from[1] + look * sin];
                let then = libm::atan2(destination[1] - end[1], destination[0] - end[0]);
                let onward = p.onward.min(distance(end, destination));
                let goes_on = [0.0, 45.0_f64, -45.0]
                    .iter()
                    .any(|turn| self.margin(end, then + turn.to_radians(), onward) >= p.margin);
                if goes_on {
                    chosen = Some((bearing, margin));
                    break 'bearings;
                }
            }
            offset += STEP;
        }
        let (mut bearing, mut margin) = chosen.unwrap_or(best);
        // Resistance to a change of sides.
        if let Some(last) = self.last
            && wrap(bearing - last).abs() > p.change
        {
            let kept = self.margin(from, last, look);
            if margin < p.ratio * kept {
                (bearing, margin) = (last, kept);
            }
        }
        self.last = Some(bearing);
        (bearing, margin)
    }
}

impl Navigator for Bendy {
    fn tick(&mut self, inputs: &Inputs<'_>) -> Command {
        let limits = self.mission.limits;
        let [x, y, heading] = inputs.pose;
        let Some(target) = self.destination.from([x, y]) else {
            return Command::stop(Mode::Arrived);
        };
        self.memory.observe(&self.mission.sensors, inputs);
        let (bearing, margin) = self.bearing([x, y], target.at);
        // Without the margin it goes on at half speed, as a rover does that ArduPilot's simple avoidance slows.
        let speed = if margin < self.parameters.margin {
            limits.speed * 0.5
        } else {
            limits.speed
        };
        let [speed, yaw_rate] = towards(bearing - heading, speed, &limits);
        Command {
            speed: speed.min(stopping_speed(target.left, &limits)),
            yaw_rate,
            mode: Mode::Avoid,
        }
    }
}
