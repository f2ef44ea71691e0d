//! From a scenario to the library's settings: its preset, its variants, and what follows from them.

use crate::control::{AxisName, LawName};
use crate::robot::{Preset, beams};
use crate::scenario::Scenario;
use crate::si;
use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::params as lib;
use fuzzypilot::params::{Body, Follower, Guard, Limits, Mount, Params, RingGeometry, Supervisor};
use fuzzypilot::tables::fine::SpeedAxis;
use fuzzypilot::units::Metres;
use std::f64::consts::TAU;

/// The library's settings for a scenario: its preset, with what the scenario says and what follows from that.
pub fn params<const N: usize>(scenario: &Scenario) -> Result<Params<N>, lib::ParamError> {
    let robot = &scenario.robot;
    let sensors = &scenario.sensors;
    let control = &scenario.control;
    let beams = beams(sensors);
    let base: Params<N> = robot.preset.base();
    // Thresholds that are shares of the range keep their share.
    let share = sensors.range / si::from_metres(base.ring.max_range);
    let stretched = |x: Metres| si::metres(si::from_metres(x) * share);
    let per_tick =
        si::from_number(base.follower.deflection_rate) * base.period.get().to_num::<f64>();
    let chapter = robot.preset == Preset::Chapter;
    Params {
        body: Body {
            radius: si::metres(robot.radius),
            track: si::metres(robot.track),
            ..base.body
        },
        limits: Limits {
            speed: si::speed(robot.speed),
            yaw_rate: si::number(robot.yaw_rate),
            acceleration: si::number(robot.acceleration),
            yaw_acceleration: si::number(robot.yaw_acceleration),
            wheel_speed: si::speed(robot.wheel_speed),
        },
        period: si::seconds(robot.period),
        latency: si::seconds(robot.latency),
        integrator: control.integrator(robot.preset),
        ring: RingGeometry {
            mounts: beams
                .iter()
                .take(N)
                .map(|beam| Mount {
                    pose: Pose::new(
                        Point::new(si::metres(beam.x), si::metres(beam.y)),
                        si::angle(beam.heading),
                    ),
                    width: si::angle(beam.width),
                })
                .collect(),
            closed: sensors.field_of_view >= TAU - 1e-9,
            max_range: si::metres(sensors.range),
            max_age: si::seconds((3.0 * robot.period).max(0.2)),
            ..base.ring
        },
        follower: Follower {
            law: match control.law {
                LawName::Guided => lib::Law::Guided,
                LawName::Paper => lib::Law::Paper,
            },
            tables: control.fine_set(robot.preset),
            speed_axis: match control.speed_axis {
                AxisName::Scaled => SpeedAxis::Scaled,
                AxisName::Literal => SpeedAxis::Literal,
            },
            // Equation 7.1 turns the whole deflection in one step, whatever the step.
            deflection_rate: if chapter {
                si::number(per_tick / robot.period)
            } else {
                base.follower.deflection_rate
            },
            corner_speed: base.follower.corner_speed.min(si::speed(robot.speed)),
            ..base.follower
        },
        avoider: lib::Avoider {
            tables: control.coarse_set(),
            speed_input: control.speed_input(),
            range: si::metres(sensors.range),
            deflection_rate: if chapter {
                si::number(per_tick / robot.period)
            } else {
                base.avoider.deflection_rate
            },
            ..base.avoider
        },
        supervisor: Supervisor {
            enter: stretched(base.supervisor.enter),
            exit: stretched(base.supervisor.exit),
            patience: (0.3 / robot.period).ceil().max(3.0) as u16,
            ..base.supervisor
        },
        guard: Guard {
            braking: si::number(robot.acceleration),
            ..base.guard
        },
    }
    .checked()
}
