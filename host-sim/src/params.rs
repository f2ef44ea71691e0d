//! From a scenario to the library's settings: presets, variants, and where each tuning value comes from.

use crate::recording::BeamView;
use crate::scenario::{RobotSpec, Scenario, SensorSpec};
use crate::si;
use clap::ValueEnum;
use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::params as lib;
use fuzzypilot::params::{Body, Follower, Guard, Limits, Mount, Params, RingGeometry, Supervisor};
use fuzzypilot::tables::coarse::{CoarseSet, SpeedInput};
use fuzzypilot::tables::fine::{FineSet, SpeedAxis};
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

/// Encoder resolution of exact odometry, m: what wheel travel loses by it is below a micrometre.
const METRES_PER_COUNT: f64 = 1.0 / 1_048_576.0;

impl Preset {
    /// Body, limits and timing.
    pub fn robot(self) -> RobotSpec {
        match self {
            // Radius and top speed given; one step a second, so that "0.3" is both speed and step (assumed); yaw and
            // acceleration limits let a step do all that equation 7.1 asks for.
            Self::Chapter => RobotSpec {
                preset: self,
                radius: 0.2,
                track: 0.3,
                speed: 0.3,
                yaw_rate: 1.6,
                acceleration: 0.3,
                yaw_acceleration: 3.2,
                wheel_speed: 0.6,
                period: 1.0,
                latency: 0.0,
                lag: 0.0,
            },
            Self::Small => RobotSpec {
                preset: self,
                radius: 0.10,
                track: 0.16,
                speed: 1.0,
                yaw_rate: 4.0,
                acceleration: 2.5,
                yaw_acceleration: 8.0,
                wheel_speed: 1.3,
                period: 0.05,
                latency: 0.05,
                lag: 0.0,
            },
        }
    }

    /// The sensor ring.
    pub fn sensors(self) -> SensorSpec {
        match self {
            // D = 4: the chapter's D̄, and the distance at which the story lets the robot return.
            Self::Chapter => SensorSpec {
                count: 64,
                field_of_view: TAU,
                range: 4.0,
                width: 0.0,
            },
            Self::Small => SensorSpec {
                count: 32,
                field_of_view: TAU,
                range: 2.0,
                width: 0.0,
            },
        }
    }
}

/// Sensors spread evenly over the field of view, counter-clockwise, mounted at the robot's centre.
pub fn beams(sensors: &SensorSpec) -> Vec<BeamView> {
    let closed = sensors.field_of_view >= TAU - 1e-9;
    let spaces = if closed {
        sensors.count
    } else {
        sensors.count - 1
    };
    (0..sensors.count)
        .map(|i| BeamView {
            x: 0.0,
            y: 0.0,
            heading: sensors.field_of_view * (i as f64 / spaces as f64 - 0.5),
            width: sensors.width,
            max_range: sensors.range,
        })
        .collect()
}

/// The library's settings for a scenario.
pub fn params<const N: usize>(scenario: &Scenario) -> Result<Params<N>, lib::ParamError> {
    let robot = &scenario.robot;
    let sensors = &scenario.sensors;
    let control = &scenario.control;
    let beams = beams(sensors);
    let chapter = robot.preset == Preset::Chapter;
    let pick = |for_chapter: f64, for_small: f64| if chapter { for_chapter } else { for_small };
    Params {
        body: Body {
            radius: si::metres(robot.radius),
            track: si::metres(robot.track),
            metres_per_count: si::fine_metres(METRES_PER_COUNT),
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
            gap: si::metres(pick(0.8, 0.35)),
            radius: [si::metres(0.05), si::metres(pick(4.0, 2.0))],
            residual: si::metres(pick(0.05, 0.03)),
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
            distance_scale: si::number(pick(1.0, 10.0)),
            // Equation 7.1 turns the whole deflection in one step.
            deflection_rate: si::number(pick(1.0 / robot.period, 4.952)),
            approach_gain: si::per_metre(2.0),
            approach_angle: si::angle(1.2),
            feed_forward_band: si::metres(0.3),
            lateral_acceleration: si::number(3.0),
            corner_speed: si::speed(0.3_f64.min(robot.speed)),
            reach: si::metres(pick(4.0, 0.5)),
            arrival: si::metres(pick(0.1, 0.02)),
        },
        avoider: lib::Avoider {
            tables: control.coarse_set(),
            speed_input: control.speed_input(),
            range: si::metres(sensors.range),
            margin: si::metres(pick(0.2, 0.08)),
            deflection_rate: si::number(pick(1.0 / robot.period, 2.5)),
            overshoot: si::angle(0.35),
        },
        supervisor: Supervisor {
            enter: si::metres(sensors.range * pick(0.6, 0.4)),
            exit: si::metres(sensors.range * pick(0.9, 0.7)),
            dwell: 3,
            clear: si::angle(0.1),
            tie: si::angle(0.02),
            same: si::metres(pick(1.0, 0.3)),
            patience: (0.3 / robot.period).ceil().max(3.0) as u16,
        },
        guard: Guard {
            margin: si::metres(pick(0.05, 0.03)),
            braking: si::number(robot.acceleration),
        },
    }
    .checked()
}
