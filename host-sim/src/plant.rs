//! The robot's body as it truly moves: a unicycle with two wheels that lag and saturate, or equation 7.1 as printed.

use fuzzypilot::params::Integrator;
use std::collections::VecDeque;

/// What the body can do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantSettings {
    /// Track width, m.
    pub track: f64,
    /// Rim speed limit of a wheel, m/s.
    pub wheel_speed: f64,
    /// Linear acceleration limit, m/s².
    pub acceleration: f64,
    /// Yaw acceleration limit, rad/s².
    pub yaw_acceleration: f64,
    /// Time constant of the wheel speed loop, s; 0 is immediate.
    pub lag: f64,
    /// Time from a command to its effect, s.
    pub latency: f64,
    /// How a step is integrated.
    pub integrator: Integrator,
}

/// State of the body.
#[derive(Clone, Debug)]
pub struct Plant {
    settings: PlantSettings,
    /// x, y, heading.
    pub pose: [f64; 3],
    /// Wheel speeds left, right, m/s.
    pub wheels: [f64; 2],
    /// Rim travel left, right since the start, m.
    pub travel: [f64; 2],
    /// Commands on their way: time of effect, wheel speeds.
    pending: VecDeque<(f64, [f64; 2])>,
    command: [f64; 2],
    /// When the last command was taken over, s.
    commanded: f64,
    /// When the motors stop by themselves, s.
    timeout: f64,
    /// When they last did so while they were driven, s, and how long after their last command.
    pub timed_out: Option<(f64, f64)>,
    time: f64,
}

/// The motors stop by themselves so long after their last command, s: what the drive port's contract asks for, and
/// what the firmware's wheel loop does.
const COMMAND_TIMEOUT: f64 = 0.2;

/// How long the motors go on with a command, s, when commands are due every `period`, s: one that is not shorter than the
/// timeout leaves the motors alone for as long, and they stop when the next command is late by the timeout.
pub fn command_timeout(period: f64) -> f64 {
    if period < COMMAND_TIMEOUT {
        COMMAND_TIMEOUT
    } else {
        period + COMMAND_TIMEOUT
    }
}

/// Integration step within a control period, s.
const SUBSTEP: f64 = 0.005;

impl Plant {
    /// At rest at `pose`.
    pub fn new(settings: PlantSettings, pose: [f64; 3]) -> Self {
        Self {
            settings,
            pose,
            wheels: [0.0; 2],
            travel: [0.0; 2],
            pending: VecDeque::new(),
            command: [0.0; 2],
            commanded: 0.0,
            timeout: f64::INFINITY,
            timed_out: None,
            time: 0.0,
        }
    }

    /// Takes a wheel command over, to act after the latency. Without another one within `timeout`, s, the motors stop.
    pub fn command(&mut self, wheels: [f64; 2], timeout: f64) {
        self.pending
            .push_back((self.time + self.settings.latency, wheels));
        self.commanded = self.time;
        self.timeout = self.time + timeout;
    }

    /// Whether it stands, and no command will change that.
    pub fn stands(&self) -> bool {
        self.pending.is_empty() && [self.command, self.wheels] == [[0.0; 2]; 2]
    }

    /// Lets one control period pass.
    pub fn advance(&mut self, period: f64) {
        match self.settings.integrator {
            Integrator::Euler => {
                // One step as printed, unless the motors stop within it.
                let before = (self.timeout - self.time).clamp(0.0, period);
                for dt in [before, period - before] {
                    if dt > 0.0 {
                        self.receive(dt);
                        self.wheels = self.command.map(|w| self.saturate(w));
                        self.travel_by(dt);
                    }
                }
            }
            Integrator::Arc => {
                let steps = (period / SUBSTEP).ceil().max(1.0);
                let dt = period / steps;
                for _ in 0..steps as usize {
                    self.receive(dt);
                    self.accelerate(dt);
                    self.travel_by(dt);
                }
            }
        }
    }

    fn saturate(&self, wheel: f64) -> f64 {
        wheel.clamp(-self.settings.wheel_speed, self.settings.wheel_speed)
    }

    /// The newest command whose time has come; none of them in a step in which the motors stop by themselves.
    fn receive(&mut self, dt: f64) {
        while let Some((due, wheels)) = self.pending.front().copied() {
            if due > self.time + 1e-9 {
                break;
            }
            self.command = wheels;
            self.pending.pop_front();
        }
        if self.time + dt > self.timeout + 1e-9 {
            let driven = self.command != [0.0; 2] || !self.pending.is_empty();
            if driven {
                self.timed_out = Some((self.time, self.time - self.commanded));
            }
            self.timeout = f64::INFINITY;
            self.command = [0.0; 2];
            self.pending.clear();
        }
    }

    fn accelerate(&mut self, dt: f64) {
        let share = if self.settings.lag > 0.0 {
            1.0 - libm::exp(-dt / self.settings.lag)
        } else {
            1.0
        };
        let target: [f64; 2] = std::array::from_fn(|i| {
            let goal = self.saturate(self.command[i]);
            self.wheels[i] + (goal - self.wheels[i]) * share
        });
        let (v, w) = self.twist_of(self.wheels);
        let (goal_v, goal_w) = self.twist_of(target);
        let step = |from: f64, to: f64, most: f64| from + (to - from).clamp(-most, most);
        let v = step(v, goal_v, self.settings.acceleration * dt);
        let w = step(w, goal_w, self.settings.yaw_acceleration * dt);
        let rim = w * self.settings.track / 2.0;
        self.wheels = [v - rim, v + rim];
    }

    fn twist_of(&self, [left, right]: [f64; 2]) -> (f64, f64) {
        ((left + right) / 2.0, (right - left) / self.settings.track)
    }

    fn travel_by(&mut self, dt: f64) {
        let (v, w) = self.twist_of(self.wheels);
        let [x, y, heading] = self.pose;
        let turned = w * dt;
        let (along, chord) = match self.settings.integrator {
            // Equation 7.1: along the old heading, then turn.
            Integrator::Euler => (heading, v * dt),
            // The exact arc.
            Integrator::Arc => {
                let half = turned / 2.0;
                let sinc = if half.abs() < 1e-9 {
                    1.0
                } else {
                    libm::sin(half) / half
                };
                (heading + half, v * dt * sinc)
            }
        };
        self.pose = [
            x + chord * libm::cos(along),
            y + chord * libm::sin(along),
            crate::world::wrap(heading + turned),
        ];
        for (travel, wheel) in self.travel.iter_mut().zip(self.wheels) {
            *travel += wheel * dt;
        }
        self.time += dt;
    }
}
