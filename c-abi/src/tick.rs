//! A tick: encoder counts and readings in, the record out.

use crate::path::FpPath;
use crate::pointer;
use crate::robot::{FP_SENSORS_MAX, FpPose, FpRobot};
use crate::rule::FpRule;
use crate::status::FpStatus;
use crate::storage;
use core::convert::Infallible;
use fuzzypilot::link::record::{self, RECORD_BYTES};
use fuzzypilot::ports::{
    Fault, Ports, Range, RangeReading, RangeSensors, Side, WheelCounts, WheelDrive, WheelEncoders,
};
use fuzzypilot::units::{Metres, MetresPerSecond, Seconds};

/// Why encoders or a sensor have nothing usable to say.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FpFault {
    /// There is no fault.
    None = 0,
    /// Nothing was ever received.
    NeverSeen = 1,
    /// No answer in time.
    Timeout = 2,
    /// The bus, the pin or the sensor itself reported an error.
    Bus = 3,
    /// The value is outside what the sensor can measure.
    OutOfRange = 4,
    /// The last reading is older than allowed.
    Stale = 5,
}

/// What a range sensor saw. Zeroed memory says: nothing usable.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FpReadingKind {
    /// No usable reading; never taken for free space.
    Invalid = 0,
    /// Nothing up to the sensor's largest range.
    Clear = 1,
    /// An echo.
    Echo = 2,
}

/// A range sensor's latest reading.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FpReading {
    /// Distance of the echo from the sensor, m / 2^16. Read of an echo only.
    pub range: i32,
    /// Time since it was measured, s / 2^24.
    pub age: i32,
    /// One of fp_reading_kind.
    pub kind: u8,
    /// One of fp_fault. Read of an invalid one only; FP_FAULT_NONE then counts as FP_FAULT_NEVER_SEEN.
    pub fault: u8,
}

/// What a tick depends on.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FpInputs {
    /// Cumulative encoder counts of the left wheel, forward positive; they wrap, only differences matter.
    pub left: i32,
    /// Of the right wheel.
    pub right: i32,
    /// One of fp_fault: with any but FP_FAULT_NONE the counts are unknown in this tick, and the next good ones contain
    /// the travel in between.
    pub counts_fault: i32,
    /// The latest reading of every sensor, in the order of the mounts. Not kept.
    pub readings: *const FpReading,
    /// How many they are: as many as sensors are mounted.
    pub reading_count: usize,
}

/// What the higher level decided.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FpDecision {
    /// Follow the path.
    Follow = 0,
    /// Pass the obstacle held; fp_record.detail is one of fp_side.
    Avoid = 1,
    /// Stand still; fp_record.detail is one of fp_stop.
    Stop = 2,
}

/// Which way past an obstacle.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FpSide {
    /// It turns left: the obstacle stays on the right.
    Left = 0,
    /// It turns right.
    Right = 1,
}

/// Why the robot stands.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FpStop {
    /// No valid range reading for longer than allowed.
    NoRanges = 0,
    /// No encoder counts for longer than allowed.
    NoOdometry = 1,
    /// The path is driven to its end.
    PathEnd = 2,
    /// The path is over, and the robot is not at its end.
    PathMissed = 3,
}

/// Which controller's rules a record holds.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FpController {
    /// None ran.
    None = 0,
    /// The fine one: rows phi, columns d.
    Fine = 1,
    /// The coarse ones: rows s, columns an angle.
    Coarse = 2,
}

/// Flag of a record: the path's end is reached.
pub const FP_FLAG_AT_END: u8 = 1;
/// Flag of a record: the path is over, the robot is not at its end, and its law leads nowhere else.
pub const FP_FLAG_MISSED_END: u8 = 2;
/// Flag of a record: the guard had to slow or stop the robot.
pub const FP_FLAG_GUARDED: u8 = 4;
/// Flag of a record: a wheel could not be written. Never set here: the caller writes them, and knows.
pub const FP_FLAG_DRIVE_FAULT: u8 = 8;

/// A motion.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FpTwist {
    /// Forward speed, m/s / 2^16.
    pub linear: i32,
    /// Yaw rate, rad/s / 2^16, counter-clockwise positive.
    pub angular: i32,
}

/// Wheel speeds.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FpWheels {
    /// Left wheel, m/s / 2^16, forward positive.
    pub left: i32,
    /// Right wheel, m/s / 2^16, forward positive.
    pub right: i32,
}

/// Everything that one tick decided. Its memory is the record's canonical form, byte by byte: what logs and frames hold,
/// and what is the same on every architecture. What a record does not have is zero.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FpRecord {
    /// Number of the tick, from 0; wraps.
    pub tick: u32,
    /// One of fp_decision.
    pub decision: u8,
    /// Side of the avoidance or reason of the stop.
    pub detail: u8,
    /// FP_FLAG_AT_END and its like.
    pub flags: u8,
    /// One of fp_controller.
    pub controller: u8,
    /// Centre of the obstacle that is passed, body frame (x forward, y left), m / 2^16.
    pub held_x: i32,
    /// Likewise.
    pub held_y: i32,
    /// Its radius, m / 2^16.
    pub held_radius: i32,
    /// RMS distance of its echoes from the circle, m / 2^16.
    pub held_residual: i32,
    /// Where the robot believes to be.
    pub pose: FpPose,
    /// Nearest place of the path, world, m / 2^16.
    pub foot_x: i32,
    /// Likewise.
    pub foot_y: i32,
    /// Signed cross-track error, left of the path positive, m / 2^16.
    pub cross_track: i32,
    /// Distance to the foot, m / 2^16.
    pub distance: i32,
    /// Tangent at the foot, world, turn / 2^32.
    pub tangent: i32,
    /// Curvature where the next command will act, 1/m / 2^16, left positive.
    pub curvature: i32,
    /// Direction to steer, body frame, turn / 2^32.
    pub heading_error: i32,
    /// Path length up to the foot, m / 2^16.
    pub progress: i32,
    /// Path length to go, m / 2^16; 2^31 - 1 on a closed path.
    pub remaining: i32,
    /// Speed that bends, corners and the end ahead allow, m/s / 2^16.
    pub speed_limit: i32,
    /// Times the start of a closed path was passed.
    pub laps: u16,
    /// Obstacles in sight.
    pub obstacles: u8,
    /// Sensors with a valid reading.
    pub valid_ranges: u8,
    /// Nearest echo from the robot's centre, m / 2^16; 2^31 - 1 without any.
    pub nearest: i32,
    /// Echoes behind the obstacle that is passed.
    pub held_echoes: u8,
    /// How many of rule are used.
    pub rule_count: u8,
    /// How many of speed_rule are used.
    pub speed_rule_count: u8,
    /// 0.
    pub reserved: u8,
    /// d on its axis (fine), or s as a share of the detection range (coarse), 1 / 2^16.
    pub distance_input: i32,
    /// phi (fine), or theta, clockwise positive (coarse), degrees / 2^16.
    pub angle_input: i32,
    /// Speed on its axis, 1 / 2^13 (fine), or as a share of the top speed, 1 / 2^14 (coarse).
    pub speed_output: i16,
    /// Deflection, degrees / 2^8: unsigned (fine), or clockwise positive (coarse).
    pub deflection_output: i16,
    /// Rules that fired; of the coarse ones, those of the deflection table.
    pub rule: [FpRule; 4],
    /// Rules of the coarse speed table.
    pub speed_rule: [FpRule; 4],
    /// What the lower level wanted.
    pub desired: FpTwist,
    /// What the guard let pass and the limits allow.
    pub twist: FpTwist,
    /// Wheel speeds to command now.
    pub wheels: FpWheels,
}

const _: () = assert!(size_of::<FpRecord>() == RECORD_BYTES);

fn fault(code: i32) -> Result<Option<Fault>, FpStatus> {
    Ok(Some(match code {
        0 => return Ok(None),
        1 => Fault::NeverSeen,
        2 => Fault::Timeout,
        3 => Fault::Bus,
        4 => Fault::OutOfRange,
        5 => Fault::Stale,
        _ => return Err(FpStatus::UnknownChoice),
    }))
}

fn reading(from: &FpReading) -> Result<RangeReading, FpStatus> {
    let range = match from.kind {
        0 => Range::Invalid(fault(from.fault.into())?.unwrap_or(Fault::NeverSeen)),
        1 => Range::Clear,
        2 => Range::Echo(Metres::from_bits(from.range)),
        _ => return Err(FpStatus::UnknownChoice),
    };
    let age = Seconds::from_bits(from.age);
    Ok(RangeReading { range, age })
}

fn counts(inputs: &FpInputs) -> Result<Result<WheelCounts, Fault>, FpStatus> {
    Ok(match fault(inputs.counts_fault)? {
        Some(fault) => Err(fault),
        None => Ok(WheelCounts {
            left: inputs.left,
            right: inputs.right,
        }),
    })
}

/// Encoders that have been read.
struct Counted(Result<WheelCounts, Fault>);

impl WheelEncoders for Counted {
    fn counts(&mut self) -> Result<WheelCounts, Fault> {
        self.0
    }
}

/// Readings that were checked.
struct Seen<'a>(&'a [FpReading]);

impl RangeSensors for Seen<'_> {
    fn read(&mut self, readings: &mut [RangeReading]) {
        for (place, from) in readings.iter_mut().zip(self.0) {
            *place = reading(from).unwrap_or(RangeReading::NEVER_SEEN);
        }
    }
}

/// Wheels whose command is in the record.
struct Told;

impl WheelDrive for Told {
    type Error = Infallible;

    fn set_speed(&mut self, _: Side, _: MetresPerSecond) -> Result<(), Self::Error> {
        Ok(())
    }
}

/// One control period: call it every FP_SETTING_PERIOD, then command both wheels as `record` says. If no call follows
/// within 200 ms of when it was due, the wheels are to be stopped.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fp_robot_tick(
    robot: *mut FpRobot,
    path: *const FpPath,
    inputs: *const FpInputs,
    record: *mut FpRecord,
) -> FpStatus {
    // SAFETY: the contract of `pointer`.
    let tick = || unsafe {
        let inputs = pointer::read(inputs)?;
        let seen = pointer::slice(inputs.readings, inputs.reading_count)?;
        let place = pointer::room(record)?;
        let path = storage::tenant(path)?;
        let state = storage::tenant_mut(robot)?;
        let path = path.path().ok_or(FpStatus::NoPath)?;
        if !state.started {
            return Err(FpStatus::NotStarted);
        }
        if seen.len() != state.robot.params().ring.mounts.len().min(FP_SENSORS_MAX) {
            return Err(FpStatus::WrongSize);
        }
        seen.iter().try_for_each(|from| reading(from).map(|_| ()))?;
        let mut ports = Ports {
            drive: Told,
            encoders: Counted(counts(inputs)?),
            ranges: Seen(seen),
        };
        let decided = state.robot.tick(&path, &mut ports);
        // The struct is laid over the bytes, and all of them are written.
        let bytes = place.write(FpRecord::default());
        record::encode_into(&decided, &mut *core::ptr::from_mut(bytes).cast());
        Ok(())
    };
    tick().into()
}

/// A control period without driving: both wheels are to stand, and dead reckoning goes on. Only the counts of `inputs`
/// are read.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fp_robot_rest(robot: *mut FpRobot, inputs: *const FpInputs) -> FpStatus {
    // SAFETY: the contract of `pointer`.
    let rest = || unsafe {
        let counts = counts(pointer::read(inputs)?)?;
        let state = storage::tenant_mut(robot)?;
        if !state.started {
            return Err(FpStatus::NotStarted);
        }
        let mut ports = Ports {
            drive: Told,
            encoders: Counted(counts),
            ranges: (),
        };
        let _ = state.robot.rest(&mut ports);
        Ok(())
    };
    rest().into()
}
