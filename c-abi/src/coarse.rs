//! The coarse controllers: deflection and speed past an obstacle.

use crate::pointer;
use crate::rule::{FpRule, fired};
use crate::status::FpStatus;
use fixed::types::I16F16;
use fuzzypilot::tables::coarse::{CoarseSet, SpeedInput};

/// Which coarse tables.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FpCoarseTables {
    /// The misprinted cell corrected.
    Corrected = 0,
    /// As the chapter prints them.
    Printed = 1,
}

/// What the coarse speed table reads along its columns.
#[repr(i32)]
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FpSpeedInput {
    /// The deflection just decided.
    Deflection = 0,
    /// The bearing theta.
    Bearing = 1,
}

/// Outputs of the coarse controllers.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FpCoarseOutput {
    /// Deflection, clockwise positive, degrees / 2^8.
    pub deflection: i16,
    /// Share of the top speed, 1 / 2^14.
    pub speed: i16,
    /// Rules of the deflection table that fired, in its reading order: row s, column theta.
    pub deflection_rules: [FpRule; 4],
    /// Rules of the speed table.
    pub speed_rules: [FpRule; 4],
    /// How many of deflection_rules are used: 1, 2 or 4.
    pub deflection_rule_count: u8,
    /// How many of speed_rules are used: 1, 2 or 4.
    pub speed_rule_count: u8,
}

/// Evaluates coarse tables (one of fp_coarse_tables, read by one of fp_speed_input): s is the free distance to the
/// obstacle as a share of the detection range, from 0 to 1, 1 / 2^16; theta the obstacle's bearing in the chapter's
/// sign, from -90 to 90, left positive, degrees / 2^16. Both saturate at the ends.
#[unsafe(no_mangle)]
pub unsafe extern "C" fn fp_coarse_evaluate(
    tables: i32,
    speed_input: i32,
    s: i32,
    theta: i32,
    output: *mut FpCoarseOutput,
) -> FpStatus {
    let set = match tables {
        0 => CoarseSet::Corrected,
        1 => CoarseSet::Printed,
        _ => return FpStatus::UnknownChoice,
    };
    let input = match speed_input {
        0 => SpeedInput::Deflection,
        1 => SpeedInput::Bearing,
        _ => return FpStatus::UnknownChoice,
    };
    // SAFETY: the contract of `pointer`.
    let place = match unsafe { pointer::room(output) } {
        Ok(place) => place,
        Err(status) => return status,
    };
    let (s, theta) = (I16F16::from_bits(s), I16F16::from_bits(theta));
    let found = set.tables().evaluate(s, theta, input);
    let (deflection_rules, deflection_rule_count) = fired(found.deflection_rules.rules());
    let (speed_rules, speed_rule_count) = fired(found.speed_rules.rules());
    place.write(FpCoarseOutput {
        deflection: found.deflection.to_bits(),
        speed: found.speed.to_bits(),
        deflection_rules,
        speed_rules,
        deflection_rule_count,
        speed_rule_count,
    });
    FpStatus::Ok
}
