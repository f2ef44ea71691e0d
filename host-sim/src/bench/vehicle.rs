//! The vehicle: a unicycle with limited accelerations and a command that acts a while after it was given.

use super::navigator::Command;
use std::collections::VecDeque;

/// What the vehicle can do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Top speed forward, m/s.
    pub speed: f64,
    /// Top speed backward, m/s, positive.
    pub reverse: f64,
    /// Top yaw rate, rad/s.
    pub yaw_rate: f64,
    /// Acceleration and braking, m/s².
    pub acceleration: f64,
    /// Yaw acceleration, rad/s².
    pub yaw_acceleration: f64,
}

impl Limits {
    /// The command as far as the vehicle can follow it; what is not a number is zero.
    pub fn admit(&self, command: Command) -> Command {
        let number = |x: f64| if x.is_finite() { x } else { 0.0 };
        Command {
            speed: number(command.speed).clamp(-self.reverse, self.speed),
            yaw_rate: number(command.yaw_rate).clamp(-self.yaw_rate, self.yaw_rate),
            mode: command.mode,
        }
    }
}

/// The reference design's vehicle: 2.5 m/s², 8 rad/s², 3 rad/s, backward 0.3 m/s.
pub const fn limits(speed: f64) -> Limits {
    Limits {
        speed,
        reverse: 0.3,
        yaw_rate: 3.0,
        acceleration: 2.5,
        yaw_acceleration: 8.0,
    }
}

/// Steps that a tick is cut into. At 2 m/s and 20 Hz the body moves 2 cm between two looks for contact.
pub const STEPS: usize = 5;

/// State of the vehicle.
#[derive(Clone, Debug)]
pub struct Vehicle {
    limits: Limits,
    /// x, y (m), heading (rad).
    pub pose: [f64; 3],
    /// Speed (m/s), yaw rate (rad/s).
    pub twist: [f64; 2],
    /// Commands on their way, the oldest first; as many as the latency has ticks.
    pending: VecDeque<[f64; 2]>,
    target: [f64; 2],
}

impl Vehicle {
    /// At rest. The latency is a whole number of ticks.
    pub fn new(limits: Limits, pose: [f64; 3], latency_ticks: usize) -> Self {
        Self {
            limits,
            pose,
            twist: [0.0; 2],
            pending: std::iter::repeat_n([0.0; 2], latency_ticks).collect(),
            target: [0.0; 2],
        }
    }

    /// Takes a command over, limited, and puts the one into effect whose time has come.
    pub fn command(&mut self, command: Command) {
        let admitted = self.limits.admit(command);
        self.pending.push_back([admitted.speed, admitted.yaw_rate]);
        self.target = self.pending.pop_front().unwrap_or([0.0; 2]);
    }

    /// Lets `dt` seconds pass: the twist goes to its target as fast as it may, the pose follows the arc of the mean twist.
    pub fn advance(&mut self, dt: f64) {
        let step = |from: f64, to: f64, most: f64| from + (to - from).clamp(-most, most);
        let [v, w] = self.twist;
        let next = [
            step(v, self.target[0], self.limits.acceleration * dt),
            step(w, self.target[1], self.limits.yaw_acceleration * dt),
        ];
        self.pose = along(self.pose, [(v + next[0]) / 2.0, (w + next[1]) / 2.0], dt);
        self.twist = next;
    }
}

/// The pose after `dt` seconds of a constant twist.
pub fn along([x, y, heading]: [f64; 3], [v, w]: [f64; 2], dt: f64) -> [f64; 3] {
    let half = w * dt / 2.0;
    // The chord is shorter than the arc by sin(h)/h; the series is exact to 1e-12 where the quotient would be 0/0.
    let sinc = if half.abs() < 1e-3 {
        1.0 - half * half / 6.0
    } else {
        libm::sin(half) / half
    };
    let (sin, cos) = libm::sincos(heading + half);
    let chord = v * dt * sinc;
    [
        x + chord * cos,
        y + chord * sin,
        crate::world::wrap(heading + 2.0 * half),
    ]
}
