//! What `examples/c/main.c` does, with the library itself instead of its face for C. The world is the same one, line by
//! line; the settings, the path and the records come from the library's own types.

use fixed::types::{I16F16, U0F32};
use fuzzypilot::behaviour::fine::FineController;
use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::guide::{Path, Segment};
use fuzzypilot::link::record::encode;
use fuzzypilot::params::{Follower, Limits, Params};
use fuzzypilot::ports::{
    Fault, Ports, Range, RangeReading, RangeSensors, Side, WheelCounts, WheelDrive, WheelEncoders,
};
use fuzzypilot::presets;
use fuzzypilot::signals::Decision;
use fuzzypilot::tables::coarse::{CoarseSet, SpeedInput};
use fuzzypilot::tables::fine::FineSet;
use fuzzypilot::tick::Robot;
use fuzzypilot::units::{Angle, Metres, MetresPerSecond};
use std::convert::Infallible;
use std::fmt::Write;

const SENSORS: usize = 16;
const TICKS: usize = 100;

/// FNV-1a.
struct Digest(u64);

impl Digest {
    fn add(&mut self, bytes: &[u8]) {
        for byte in bytes {
            self.0 = (self.0 ^ u64::from(*byte)).wrapping_mul(1_099_511_628_211);
        }
    }
}

fn times(a: i32, b: i32) -> i32 {
    ((i64::from(a) * i64::from(b)) >> 30) as i32
}

fn turned(v: [i32; 2], by: [i32; 2]) -> [i32; 2] {
    [
        times(v[0], by[0]) - times(v[1], by[1]),
        times(v[0], by[1]) + times(v[1], by[0]),
    ]
}

const DISC: [Metres; 2] = [Metres::lit("1.4"), Metres::lit("0.03")];
const RADIUS: Metres = Metres::lit("0.12");

/// The robot's truth, and what its ports read of it.
struct World {
    at: [i32; 2],
    ahead: [i32; 2],
    counts: WheelCounts,
}

impl World {
    fn drive(&mut self, left: i32, right: i32) {
        self.counts.left += left * 4 / 5;
        self.counts.right += right * 4 / 5;
        let way = (left + right) / 40;
        self.at[0] += times(way, self.ahead[0]);
        self.at[1] += times(way, self.ahead[1]);
        self.ahead = turned(self.ahead, [1 << 30, (right - left) * 5120]);
        let [x, y] = self.ahead;
        let square = times(x, x) + times(y, y);
        let factor = ((3 * (1i64 << 30) - i64::from(square)) / 2) as i32;
        self.ahead = [times(x, factor), times(y, factor)];
    }
}

impl WheelEncoders for &World {
    fn counts(&mut self) -> Result<WheelCounts, Fault> {
        Ok(self.counts)
    }
}

impl RangeSensors for &World {
    fn read(&mut self, readings: &mut [RangeReading]) {
        let mut beam = self.ahead.map(|x| -x);
        let disc = [DISC[0].bits() - self.at[0], DISC[1].bits() - self.at[1]];
        let radius = RADIUS.bits();
        for reading in readings {
            let along = times(disc[0], beam[0]) + times(disc[1], beam[1]);
            let beside = times(disc[0], beam[1]) - times(disc[1], beam[0]);
            *reading = RangeReading::fresh(match along > 0 && beside.abs() < radius {
                true => {
                    let leg = (radius * radius - beside * beside).isqrt();
                    Range::Echo(Metres::from_bits(along - leg))
                }
                false => Range::Clear,
            });
            beam = turned(beam, [992_008_094, 410_903_207]);
        }
    }
}

/// Wheels whose command is in the record.
struct NoWheels;

impl WheelDrive for NoWheels {
    type Error = Infallible;

    fn set_speed(&mut self, _: Side, _: MetresPerSecond) -> Result<(), Infallible> {
        Ok(())
    }
}

fn fine(text: &mut String, digest: &mut Digest) {
    let preset: Params<1> = presets::small_robot();
    let follower = Follower {
        tables: FineSet::Printed,
        distance_scale: I16F16::ONE,
        deflection_rate: I16F16::ONE,
        ..preset.follower
    };
    let limits = Limits {
        speed: MetresPerSecond::lit("3"),
        ..preset.limits
    };
    let fine = FineController::new(&follower, &limits);
    let example = fine.evaluate(Metres::lit("1.2"), Angle::deg("100"));
    let [speed, yaw_rate] = [example.speed.bits(), example.yaw_rate.bits()];
    writeln!(text, "speed, m/s / 2^16: {speed}").unwrap();
    writeln!(text, "yaw rate, rad/s / 2^16: {yaw_rate}").unwrap();
    for d in 0..=5 {
        for step in -11..=11 {
            let error = Angle::from_bits(step * Angle::deg("15").bits());
            let motion = fine.evaluate(Metres::from_bits(d << 16), error);
            digest.add(&motion.speed.bits().to_le_bytes());
            digest.add(&motion.yaw_rate.bits().to_le_bytes());
        }
    }
    let coarse = CoarseSet::Corrected.tables();
    for s in 0..=8 {
        for step in -6..=6 {
            let output = coarse.evaluate(
                I16F16::from_num(s) / 8,
                I16F16::from_num(15 * step),
                SpeedInput::Deflection,
            );
            digest.add(&output.deflection.to_le_bytes());
            digest.add(&output.speed.to_le_bytes());
        }
    }
}

fn drive(text: &mut String, digest: &mut Digest) {
    let mut params = presets::small_robot::<SENSORS>();
    params.limits.speed = MetresPerSecond::lit("0.8");
    assert_eq!(params.body.metres_per_count, U0F32::from_bits(1 << 12));
    assert_eq!(params.body.track, Metres::lit("0.16"));
    let segments = [
        Segment::line(Pose::default(), Metres::lit("3")),
        Segment::arc(
            Point::new(Metres::lit("3"), Metres::lit("1")),
            Metres::lit("1"),
            Angle::deg("-90"),
            I16F16::lit("90"),
        ),
    ];
    let path = Path::segments(&segments, false).unwrap();
    let mut robot = Robot::new(params.checked().unwrap(), Pose::default());
    let mut world = World {
        at: [0; 2],
        ahead: [1 << 30, 0],
        counts: WheelCounts { left: 0, right: 0 },
    };
    let (mut avoided, mut pose) = (0, Pose::default());
    for _ in 0..TICKS {
        let mut ports = Ports {
            drive: NoWheels,
            encoders: &world,
            ranges: &world,
        };
        let record = robot.tick(&path, &mut ports);
        digest.add(&encode(&record));
        avoided += i32::from(matches!(record.decision, Decision::Avoid { .. }));
        pose = record.pose;
        world.drive(record.wheels.left.bits(), record.wheels.right.bits());
    }
    writeln!(text, "ticks: {TICKS}").unwrap();
    writeln!(text, "of these avoiding: {avoided}").unwrap();
    writeln!(text, "at x, m / 2^16: {}", pose.at.x.bits()).unwrap();
    writeln!(text, "at y, m / 2^16: {}", pose.at.y.bits()).unwrap();
}

/// What the example prints.
pub fn print() -> String {
    let (mut text, mut digest) = (String::new(), Digest(14_695_981_039_346_656_037));
    fine(&mut text, &mut digest);
    drive(&mut text, &mut digest);
    writeln!(text, "digest: {:016x}", digest.0).unwrap();
    text
}
