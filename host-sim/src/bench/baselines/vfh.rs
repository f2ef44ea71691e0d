//! VFH+: a polar histogram of certainty values, obstacles enlarged by the robot's radius, directions masked by its
//! turning circle, and the opening with the least cost.
//!
//! Source: I. Ulrich, J. Borenstein, *VFH+: Reliable Obstacle Avoidance for Fast Mobile Robots*, ICRA 1998; section and
//! equation numbers below are that paper's. Speed follows the first VFH (Borenstein, Koren 1991, section IV.D): slower
//! where the histogram ahead is high. The robot is a circle to it.

use super::certainty::{CELL, Certainty};
use super::destination::Destination;
use super::steer::{stopping_speed, towards};
use crate::bench::body::to_body;
use crate::bench::navigator::{Command, Inputs, Mission, Mode, Navigator};
use crate::world::wrap;
use std::f64::consts::TAU;

/// Sectors of the polar histogram (5° each, as in the paper).
const SECTORS: usize = 72;

/// Sectors of a valley from which on it is wide (the paper's s_max).
const WIDE: usize = 16;

/// What may be tuned.
#[derive(Clone, Copy, Debug)]
pub struct Parameters {
    /// Robot's radius with its safety distance, m (the paper's r_r+s).
    pub radius: f64,
    /// Radius of the active window, m.
    pub window: f64,
    /// Thresholds of the binary histogram, as shares of one full cell's magnitude at the robot (τ_low, τ_high).
    pub low: f64,
    /// See `low`.
    pub high: f64,
    /// Cost of leaving the target, the present and the last direction (μ1, μ2, μ3; the paper has 5, 2, 2).
    pub costs: [f64; 3],
    /// Distance of the carrot on a planned route, m.
    pub carrot: f64,
    /// Distance ahead at which an obstacle begins to slow the robot, m.
    pub slow_distance: f64,
    /// Least share of the top speed that remains.
    pub least_speed: f64,
}

impl Default for Parameters {
    fn default() -> Self {
        Self {
            radius: 0.223,
            window: 0.84,
            low: 0.232,
            high: 0.237,
            costs: [5.0, 2.06, 0.99],
            carrot: 1.54,
            slow_distance: 0.51,
            least_speed: 0.385,
        }
    }
}

/// See the module.
#[derive(Clone, Debug)]
pub struct Vfh {
    mission: Mission,
    destination: Destination,
    parameters: Parameters,
    grid: Certainty,
    /// Binary polar histogram, sector 0 along odometry's x.
    blocked: [bool; SECTORS],
    /// Direction chosen last, in odometry's frame, rad.
    last: f64,
}

impl Vfh {
    /// For a mission.
    pub fn new(mission: &Mission, parameters: Parameters) -> Self {
        Self {
            destination: Destination::new(mission, parameters.carrot),
            mission: mission.clone(),
            parameters,
            grid: Certainty::default(),
            blocked: [false; SECTORS],
            last: mission.start[2],
        }
    }

    /// Primary, binary and masked polar histograms (sections 3.1 to 3.3); true is blocked.
    fn masked(&mut self, inputs: &Inputs<'_>) -> [bool; SECTORS] {
        let p = self.parameters;
        let [x, y, heading] = inputs.pose;
        let mut histogram = [0.0_f64; SECTORS];
        // Bearings from the heading, rad, that the turning circles leave: right and left.
        let mut limits = [-TAU / 2.0, TAU / 2.0];
        let circle = inputs.twist[0].max(0.0) / self.mission.limits.yaw_rate;
        for ([dx, dy], certainty) in self.grid.occupied([x, y], p.window) {
            let away = libm::hypot(dx, dy).max(CELL / 2.0);
            let bearing = libm::atan2(dy, dx);
            let certainty = f64::from(certainty) / f64::from(super::certainty::MOST);
            // Equation 2 with a and b such that the magnitude is 1 at the robot and 0 at the window's rim.
            let magnitude = certainty * certainty * (1.0 - (away / p.window) * (away / p.window));
            // Equation 4: the enlargement angle.
            let half = if away > p.radius {
                libm::asin(p.radius / away)
            } else {
                TAU / 4.0
            };
            let first = ((bearing - half) / TAU * SECTORS as f64).ceil() as i64;
            let last = ((bearing + half) / TAU * SECTORS as f64).floor() as i64;
            for sector in first..=last {
                histogram[sector.rem_euclid(SECTORS as i64) as usize] += magnitude;
            }
            // Equations 8 to 10: a cell in a turning circle blocks all that lies beyond it on that side.
            if certainty * certainty >= p.high {
                let [u, v] = to_body([x, y, heading], [x + dx, y + dy]);
                let beside = wrap(bearing - heading);
                let side = usize::from(beside > 0.0);
                let centre = if side == 1 { circle } else { -circle };
                let reach = circle + p.radius;
                if u * u + (v - centre) * (v - centre) < reach * reach
                    && u > -self.mission.body.rear()
                {
                    limits[side] = if side == 1 {
                        limits[1].min(beside)
                    } else {
                        limits[0].max(beside)
                    };
                }
            }
        }
        std::array::from_fn(|sector| {
            // Section 3.2: in between the thresholds a sector stays as it was.
            let high = histogram[sector];
            self.blocked[sector] = high > p.high || (self.blocked[sector] && high >= p.low);
            let turn = wrap(centre_of(sector) - heading);
            self.blocked[sector] || (circle > 0.05 && (turn < limits[0] || turn > limits[1]))
        })
    }

    /// Direction with the least cost (section 3.4), rad in odometry's frame; none if all is blocked.
    fn choose(&self, masked: &[bool; SECTORS], target: f64, heading: f64) -> Option<f64> {
        let cost = |direction: f64| {
            let [a, b, c] = self.parameters.costs;
            a * wrap(direction - target).abs()
                + b * wrap(direction - heading).abs()
                + c * wrap(direction - self.last).abs()
        };
        candidates(masked, target)
            .into_iter()
            .min_by(|a, b| cost(*a).total_cmp(&cost(*b)))
    }

    /// Free distance straight ahead of the body's circle, m.
    fn ahead(&self, inputs: &Inputs<'_>) -> f64 {
        let p = self.parameters;
        let [x, y, heading] = inputs.pose;
        self.grid
            .occupied([x, y], p.window)
            .filter(|(_, certainty)| *certainty >= 6)
            .map(|([dx, dy], _)| to_body([0.0, 0.0, heading], [dx, dy]))
            .filter(|[u, v]| *u > 0.0 && v.abs() < p.radius)
            .map(|[u, _]| u - self.mission.body.front())
            .fold(f64::INFINITY, f64::min)
    }
}

/// Direction of a sector's centre, rad.
fn centre_of(sector: usize) -> f64 {
    sector as f64 * TAU / SECTORS as f64
}

/// Candidate directions of all openings (section 3.4): the middle of a narrow one, both borders of a wide one and the
/// target if it lies in between.
fn candidates(masked: &[bool; SECTORS], target: f64) -> Vec<f64> {
    let Some(first) = masked.iter().position(|blocked| *blocked) else {
        return vec![target];
    };
    let mut found = Vec::new();
    let mut k = 0;
    while k < SECTORS {
        let open = (k..SECTORS)
            .take_while(|i| !masked[(first + i) % SECTORS])
            .count();
        if open == 0 {
            k += 1;
            continue;
        }
        let right = centre_of(first + k);
        let width = (open - 1) as f64 * TAU / SECTORS as f64;
        if open <= WIDE {
            found.push(right + width / 2.0);
        } else {
            let margin = centre_of(WIDE) / 2.0;
            found.push(right + margin);
            found.push(right + width - margin);
            let into = (target - right).rem_euclid(TAU);
            if into >= margin && into <= width - margin {
                found.push(target);
            }
        }
        k += open;
    }
    found
}

impl Navigator for Vfh {
    fn tick(&mut self, inputs: &Inputs<'_>) -> Command {
        let p = self.parameters;
        let limits = self.mission.limits;
        let [x, y, heading] = inputs.pose;
        let Some(target) = self.destination.from([x, y]) else {
            return Command::stop(Mode::Arrived);
        };
        self.grid.observe(&self.mission.sensors, inputs);
        let masked = self.masked(inputs);
        let Some(direction) = self.choose(&masked, target.bearing, heading) else {
            // Trapped: look around, towards the target.
            return Command {
                speed: 0.0,
                yaw_rate: 1.0_f64.copysign(wrap(target.bearing - heading)),
                mode: Mode::Escape,
            };
        };
        self.last = direction;
        let ahead = self.ahead(inputs);
        let slow = (ahead / p.slow_distance).clamp(p.least_speed, 1.0);
        let [speed, yaw_rate] = towards(direction - heading, limits.speed * slow, &limits);
        Command {
            speed: speed
                .min(stopping_speed(target.left, &limits))
                .min(stopping_speed(ahead - 0.05, &limits)),
            yaw_rate,
            mode: Mode::Avoid,
        }
    }
}
