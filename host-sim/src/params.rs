//! From a scenario to the library's settings: presets, variants, and where each tuning value comes from.

use crate::recording::BeamView;
use crate::scenario::{RobotSpec, Scenario, SensorSpec};
use crate::si;
use clap::ValueEnum;
use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::params as lib;
use fuzzypilot::params::{Body, Follower, Guard, Limits, Mount, Params, RingGeometry, Supervisor};
use fuzzypilot::presets;
use fuzzypilot::tables::coarse::{CoarseSet, SpeedInput};
use fuzzypilot::tables::fine::{FineSet, SpeedAxis};
use fuzzypilot::units::Metres;
use serde::{Deserialize, Serialize};
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

/// Guidance law.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum LawName {
    /// Vector field with curvature feed-forward.
    #[default]
    Guided,
    /// As printed.
    Paper,
}

/// Fine tables.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum TablesName {
    /// Tables 7.1 and 7.2.
    Printed,
    /// The tuned set.
    Tuned,
}

/// Cell (d = N, phi = N) of Table 7.2.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum FineNn {
    /// N, as the table and the printed peak have it.
    #[default]
    Table,
    /// B, as the worked example's prose has it.
    Prose,
}

/// Reading of the speed axis.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum AxisName {
    /// Its top, 3.0, is the robot's top speed.
    #[default]
    Scaled,
    /// Metres per second as it stands.
    Literal,
}

/// Cell (s = N, theta = R) of Table 7.3.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum CoarseName {
    /// R, as text and symmetry demand.
    #[default]
    Corrected,
    /// L, as printed.
    Printed,
}

/// What Table 7.4 reads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Deserialize, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum InputName {
    /// The deflection, equation 7.5.
    #[default]
    Deflection,
    /// The bearing theta, the table's heading.
    Bearing,
}

/// Integration rule of plant and odometry.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize, Serialize, ValueEnum)]
#[serde(rename_all = "kebab-case")]
pub enum IntegratorName {
    /// Exact arcs, wheel dynamics.
    Arc,
    /// Equation 7.1.
    Euler,
}

/// Law and variants; what is not given follows the preset.
#[derive(Clone, Copy, Debug, Default, PartialEq, Deserialize, Serialize)]
#[serde(deny_unknown_fields, rename_all = "kebab-case")]
pub struct Control {
    /// Guidance law.
    #[serde(default)]
    pub law: LawName,
    /// Fine tables.
    pub tables: Option<TablesName>,
    /// Erratum of the worked example.
    #[serde(default)]
    pub fine_nn: FineNn,
    /// Erratum of the speed axis.
    #[serde(default)]
    pub speed_axis: AxisName,
    /// Erratum of Table 7.3.
    #[serde(default, rename = "table-7-3")]
    pub table_7_3: CoarseName,
    /// Erratum of Table 7.4.
    #[serde(default, rename = "table-7-4-input")]
    pub table_7_4_input: InputName,
    /// Integration rule.
    pub integrator: Option<IntegratorName>,
}

impl Control {
    /// The fine tables in force.
    pub fn fine_set(&self, preset: Preset) -> FineSet {
        let tables = self.tables.unwrap_or(match preset {
            Preset::Chapter => TablesName::Printed,
            Preset::Small => TablesName::Tuned,
        });
        match (tables, self.fine_nn) {
            (TablesName::Tuned, _) => FineSet::Tuned,
            (TablesName::Printed, FineNn::Table) => FineSet::Printed,
            (TablesName::Printed, FineNn::Prose) => FineSet::PrintedProse,
        }
    }

    /// The Table 7.3 in force.
    pub fn coarse_set(&self) -> CoarseSet {
        match self.table_7_3 {
            CoarseName::Corrected => CoarseSet::Corrected,
            CoarseName::Printed => CoarseSet::Printed,
        }
    }

    /// What Table 7.4 reads.
    pub fn speed_input(&self) -> SpeedInput {
        match self.table_7_4_input {
            InputName::Deflection => SpeedInput::Deflection,
            InputName::Bearing => SpeedInput::Bearing,
        }
    }

    /// The integration rule in force: equation 7.1 in the chapter's world.
    pub fn integrator(&self, preset: Preset) -> lib::Integrator {
        match (self.integrator, preset) {
            (Some(IntegratorName::Euler), _) | (None, Preset::Chapter) => lib::Integrator::Euler,
            (Some(IntegratorName::Arc), _) | (None, Preset::Small) => lib::Integrator::Arc,
        }
    }

    /// One line for titles and tables.
    pub fn describe(&self, preset: Preset) -> String {
        let law = match self.law {
            LawName::Guided => "guided",
            LawName::Paper => "paper",
        };
        let tables = match self.fine_set(preset) {
            FineSet::Printed => "printed tables",
            FineSet::PrintedProse => "printed tables (7.2 by prose)",
            FineSet::Tuned => "tuned tables",
        };
        let mut line = format!("law {law}, {tables}");
        if self.speed_axis == AxisName::Literal {
            line += ", literal speed axis";
        }
        if self.table_7_3 == CoarseName::Printed {
            line += ", Table 7.3 as printed";
        }
        if self.table_7_4_input == InputName::Bearing {
            line += ", Table 7.4 reads the bearing";
        }
        line
    }
}

impl Preset {
    /// The library's settings behind the preset.
    fn base<const N: usize>(self) -> Params<N> {
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
                x: sensors.mount_radius * heading.cos(),
                y: sensors.mount_radius * heading.sin(),
                heading,
                width: sensors.width,
                max_range: sensors.range,
            }
        })
        .collect()
}

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
            mounts: std::array::from_fn(|i| {
                let beam = beams.get(i).copied().unwrap_or(beams[0]);
                Mount {
                    pose: Pose::new(
                        Point::new(si::metres(beam.x), si::metres(beam.y)),
                        si::angle(beam.heading),
                    ),
                    width: si::angle(beam.width),
                }
            }),
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
