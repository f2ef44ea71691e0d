//! The simulated robot's body and sensors, and the presets that they start from.

use crate::recording::BeamView;
use crate::si;
use fuzzypilot::params::Params;
use fuzzypilot::presets;
use serde::Deserialize;
use std::f64::consts::TAU;

/// A robot to start from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Preset {
    /// The chapter's: radius 0.2, 0.3 a step, one step a second, 64 beams all round.
    #[default]
    Chapter,
    /// A small robot: 1 m/s, 20 Hz, 50 ms latency.
    Small,
}

/// Body, limits and timing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RobotSpec {
    /// Where the values not given come from.
    pub preset: Preset,
    /// Radius of the disc, m.
    pub radius: f64,
    /// Track width, m.
    pub track: f64,
    /// Top speed, m/s.
    pub speed: f64,
    /// Top yaw rate, rad/s.
    pub yaw_rate: f64,
    /// Acceleration limit, m/s².
    pub acceleration: f64,
    /// Yaw acceleration limit, rad/s².
    pub yaw_acceleration: f64,
    /// Rim speed limit of a wheel, m/s.
    pub wheel_speed: f64,
    /// Control period, s.
    pub period: f64,
    /// Command latency, s.
    pub latency: f64,
    /// Wheel loop time constant, s.
    pub lag: f64,
}

/// The sensor ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SensorSpec {
    /// Number of sensors: one of [`RING_SIZES`].
    pub count: usize,
    /// Field of view, radians; a full turn closes the ring.
    pub field_of_view: f64,
    /// Largest range, m.
    pub range: f64,
    /// Opening angle of each, radians; 0 for beams.
    pub width: f64,
    /// Distance from the robot's centre at which each sits, looking outwards, m.
    pub mount_radius: f64,
}

/// Ring sizes that the simulator is built for.
pub const RING_SIZES: [usize; 4] = [8, 16, 32, 64];

impl Preset {
    /// The library's settings behind the preset.
    pub fn base<const N: usize>(self) -> Params<N> {
        match self {
            Self::Chapter => presets::chapter_robot(),
            Self::Small => presets::small_robot(),
        }
    }

    /// Body, limits and timing.
    pub fn robot(self) -> RobotSpec {
        let base = self.base::<8>();
        let number = |x: fixed::types::I16F16| tidy(x.to_num());
        RobotSpec {
            preset: self,
            radius: tidy(si::from_metres(base.body.radius)),
            track: tidy(si::from_metres(base.body.track)),
            speed: tidy(si::from_speed(base.limits.speed)),
            yaw_rate: number(base.limits.yaw_rate),
            acceleration: number(base.limits.acceleration),
            yaw_acceleration: number(base.limits.yaw_acceleration),
            wheel_speed: tidy(si::from_speed(base.limits.wheel_speed)),
            period: tidy(base.period.get().to_num()),
            latency: tidy(base.latency.get().to_num()),
            lag: 0.0,
        }
    }

    /// The sensor ring: beams all round.
    pub fn sensors(self) -> SensorSpec {
        SensorSpec {
            count: match self {
                Self::Chapter => 64,
                Self::Small => 32,
            },
            field_of_view: TAU,
            range: tidy(si::from_metres(self.base::<8>().ring.max_range)),
            width: 0.0,
            mount_radius: 0.0,
        }
    }
}

/// The decimal number that a fixed-point setting was written as.
fn tidy(x: f64) -> f64 {
    (x * 1e4).round() / 1e4
}

/// Sensors spread evenly over the field of view, counter-clockwise, looking outwards.
pub fn beams(sensors: &SensorSpec) -> Vec<BeamView> {
    let closed = sensors.field_of_view >= TAU - 1e-9;
    let spaces = if closed {
        sensors.count
    } else {
        sensors.count - 1
    };
    (0..sensors.count)
        .map(|i| {
            let heading = sensors.field_of_view * (i as f64 / spaces as f64 - 0.5);
            BeamView {
                x: sensors.mount_radius * libm::cos(heading),
                y: sensors.mount_radius * libm::sin(heading),
                heading,
                width: sensors.width,
                max_range: sensors.range,
            }
        })
        .collect()
}
