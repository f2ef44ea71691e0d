//! The fine controller: prepared once, evaluated in physical units; or its tables on their own axes.

use crate::pointer;
use crate::rule::{FpRule, fired};
use crate::status::FpStatus;
use crate::storage::{self, Storage};
use fixed::types::I16F16;
use fuzzypilot::behaviour::fine::FineController;
use fuzzypilot::params::{Follower, Limits, Params};
use fuzzypilot::presets;
use fuzzypilot::tables::fine::{FineSet, SpeedAxis};
use fuzzypilot::units::{Angle, Metres, MetresPerSecond};

/// Which fine tables.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FpFineTables {
    /// As the chapter prints them.
    Printed = 0,
    /// As printed, but one cell as the chapter's worked example has it in words.
    PrintedProse = 1,
    /// Tuned for the guided law.
    Tuned = 2,
}

/// How the speed axis of the fine tables, 0 to 3, becomes metres per second.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FpSpeedAxis {
    /// Its top is the robot's top speed.
    Scaled = 0,
    /// It is metres per second as it stands.
    Literal = 1,
}

/// What a fine controller is made of.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FpFineSettings {
    /// Rule tables: one of fp_fine_tables.
    pub tables: i32,
    /// Reading of the speed axis: one of fp_speed_axis.
    pub speed_axis: i32,
    /// Units of the d axis (0 to 4) a metre, 1/m / 2^16. Above 0.
    pub distance_scale: i32,
    /// Deflection to yaw rate, 1/s / 2^16. Above 0.
    pub deflection_rate: i32,
    /// Top speed, m/s / 2^16. Above 0.
    pub top_speed: i32,
}

/// Words of an fp_fine.
pub const FP_FINE_WORDS: usize = 4;

/// Memory for a fine controller. What is in it is the library's; it may be copied, and needs no end.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct FpFine {
    /// Not for use.
    pub opaque: [u64; FP_FINE_WORDS],
}

// SAFETY: integers; fits.
unsafe impl Storage for FpFine {
    type Tenant = FineController;
    const MARK: u32 = u32::from_le_bytes(*b"fpF1");
}
const _: () = assert!(storage::fits::<FpFine>(), "FP_FINE_WORDS is too small");

/// What a fine controller wants.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FpFineMotion {
    /// Forward speed, m/s / 2^16.
    pub speed: i32,
    /// Yaw rate towards the heading error, rad/s / 2^16, left positive.
    pub yaw_rate: i32,
}

/// Outputs of the fine tables on their own axes.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FpFineOutput {
    /// Speed on its axis, 0 to 3, 1 / 2^13.
    pub speed: i16,
    /// Deflection, unsigned, degrees / 2^8.
    pub deflection: i16,
    /// Rules that fired, in the tables' reading order: row phi, column d; both outputs share them.
    pub rules: [FpRule; 4],
    /// How many of them are used: 1, 2 or 4.
    pub rule_count: u8,
}

fn tables(choice: i32) -> Result<FineSet, FpStatus> {
    match choice {
        0 => Ok(FineSet::Printed),
        1 => Ok(FineSet::PrintedProse),
        2 => Ok(FineSet::Tuned),
        _ => Err(FpStatus::UnknownChoice),
    }
}

static SMALL: Params<1> = presets::small_robot();

fn controller(settings: &FpFineSettings) -> Result<FineController, FpStatus> {
    let speed_axis = match settings.speed_axis {
        0 => SpeedAxis::Scaled,
        1 => SpeedAxis::Literal,
        _ => return Err(FpStatus::UnknownChoice),
    };
    let follower = Follower {
        tables: tables(settings.tables)?,
        speed_axis,
        distance_scale: I16F16::from_bits(settings.distance_scale),
        deflection_rate: I16F16::from_bits(settings.deflection_rate),
        ..SMALL.follower
    };
    let limits = Limits {
        speed: MetresPerSecond::from_bits(settings.top_speed),
        ..SMALL.limits
    };
    let positive = [
        settings.distance_scale,
        settings.deflection_rate,
        settings.top_speed,
    ];
    match positive.iter().all(|&bits| bits > 0) {
        true => Ok(FineController::new(&follower, &limits)),
        false => Err(FpStatus::SettingNotAllowed),
    }
}

/// Prepares a fine controller in the caller's memory; `size` is sizeof(fp_fine).
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fp_fine_init(
    fine: *mut FpFine,
    size: usize,
    settings: *const FpFineSettings,
) -> FpStatus {
    // SAFETY: the contract of `pointer`; the tenant is written.
    let init = || unsafe {
        let controller = controller(pointer::read(settings)?)?;
        storage::move_in(fine, size, |place| {
            place.write(controller);
        })
    };
    init().into()
}

/// Evaluates a fine controller: speed and yaw rate for a distance to the path (m / 2^16; below 0 counts as 0, above the
/// d axis as its end) and a heading error (turn / 2^32, left positive). The same number of instructions for every
/// input.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fp_fine_evaluate(
    fine: *const FpFine,
    distance: i32,
    heading_error: i32,
    motion: *mut FpFineMotion,
) -> FpStatus {
    // SAFETY: the contract of `pointer`.
    let evaluate = || unsafe {
        let (fine, place) = (storage::tenant(fine)?, pointer::room(motion)?);
        let wanted = fine.evaluate(Metres::from_bits(distance), Angle::from_bits(heading_error));
        place.write(FpFineMotion {
            speed: wanted.speed.bits(),
            yaw_rate: wanted.yaw_rate.bits(),
        });
        Ok(())
    };
    evaluate().into()
}

/// Evaluates fine tables (one of fp_fine_tables) on their own axes, and tells the rules: d from 0 to 4, 1 / 2^16, phi
/// from 0 to 180 degrees, degrees / 2^16; both saturate at the ends.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fp_fine_tables_evaluate(
    tables: i32,
    d: i32,
    phi: i32,
    output: *mut FpFineOutput,
) -> FpStatus {
    // SAFETY: the contract of `pointer`.
    let evaluate = || unsafe {
        let (set, place) = (self::tables(tables)?, pointer::room(output)?);
        let found = set
            .tables()
            .evaluate(I16F16::from_bits(d), I16F16::from_bits(phi));
        let (rules, rule_count) = fired(found.activation.rules());
        place.write(FpFineOutput {
            speed: found.speed.to_bits(),
            deflection: found.deflection.to_bits(),
            rules,
            rule_count,
        });
        Ok(())
    };
    evaluate().into()
}
