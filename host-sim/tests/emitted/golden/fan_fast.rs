//! The fuzzy controller `fan`: 2 inputs, 1 output, 6 rules.
//!
//! Made by `host-sim fuzzy convert fan.fll --to rust --route fast`:
//! change the design and make it again rather than this file. It needs the crates `fuzzypilot` and `fixed`.
//!
//! Route: fast, `fuzzypilot::fuzzy::RuleTable`, one an output. Only the four
//! rules around an input are evaluated; the work is the same for every input.
//!
//! All numbers are whole steps, which each variable has for itself:
//!
//! | variable | a step | from | to | beyond |
//! |---|---|---|---|---|
//! | input `temperature` | 2^-16 | 1179648 = 18 | 2097152 = 32 | counts as the outermost term |
//! | input `humidity` | 2^-16 | 1966080 = 30 | 5242880 = 80 | counts as the outermost term |
//! | output `fan` | 2^-8 | 0 = 0 | 25600 = 100 | never |
//!
//! It is off the same design in exact arithmetic by at most
//!
//! * 0.0108643 of `fan`

// Not everything is needed everywhere.
#![allow(dead_code)]

use fixed::types::I16F16;
use fuzzypilot::fuzzy::{Antecedents, Consequents, Partition, RuleTable, Term};

/// Place of `temperature` among the inputs.
pub const TEMPERATURE: usize = 0;
/// A step of `temperature` is 2^−this.
pub const TEMPERATURE_FRACTION: i32 = 16;
/// `temperature` as a number: `to_bits` gives its steps, `from_bits` takes them.
pub type Temperature = fixed::FixedI32<fixed::types::extra::U16>;

/// Place of `humidity` among the inputs.
pub const HUMIDITY: usize = 1;
/// A step of `humidity` is 2^−this.
pub const HUMIDITY_FRACTION: i32 = 16;
/// `humidity` as a number: `to_bits` gives its steps, `from_bits` takes them.
pub type Humidity = fixed::FixedI32<fixed::types::extra::U16>;

/// Place of `fan` among the outputs.
pub const FAN: usize = 0;
/// A step of `fan` is 2^−this.
pub const FAN_FRACTION: i32 = 8;
/// `fan` as a number: `to_bits` gives its steps, `from_bits` takes them.
pub type Fan = fixed::FixedI32<fixed::types::extra::U8>;

/// Where the inputs' terms have their peaks.
#[rustfmt::skip]
pub static INPUTS: Antecedents<3, 2> = Antecedents {
    // temperature: cool, warm, hot
    rows: Partition::new([I16F16::lit("18"), I16F16::lit("24"), I16F16::lit("32")]),
    // humidity: dry, damp
    cols: Partition::new([I16F16::lit("30"), I16F16::lit("80")]),
};

/// `fan` becomes `low`.
const FAN_LOW: Term = Term(0);
/// `fan` becomes `mid`.
const FAN_MID: Term = Term(1);
/// `fan` becomes `high`.
const FAN_HIGH: Term = Term(2);
/// `fan` in the table.
type FanTable = fixed::FixedI16<fixed::types::extra::U8>;

// if temperature is cool and humidity is dry then fan is low
// if temperature is cool and humidity is damp then fan is low
// if temperature is warm and humidity is dry then fan is low
// if temperature is warm and humidity is damp then fan is mid
// if temperature is hot and humidity is dry then fan is mid
// if temperature is hot and humidity is damp then fan is high
/// `fan`: a row for each term of `temperature`, a column for each of `humidity`.
#[rustfmt::skip]
pub static FAN_RULES: RuleTable<3, 2, FanTable> = RuleTable::new(
    // dry       damp
    [[FAN_LOW , FAN_LOW ],  // cool
     [FAN_LOW , FAN_MID ],  // warm
     [FAN_MID , FAN_HIGH]], // hot
    Consequents::new(
        [FanTable::lit("0"), FanTable::lit("100")],
        [FanTable::lit("0"), FanTable::lit("40"), FanTable::lit("100")],
    ),
);

/// The outputs for inputs, each in steps of its variable.
#[inline]
pub fn evaluate(inputs: [i32; 2]) -> [i32; 1] {
    let [row, column] = inputs.map(I16F16::from_bits);
    let activation = INPUTS.activate(row, column);
    [i32::from(FAN_RULES.defuzzify(&activation).to_bits())]
}
