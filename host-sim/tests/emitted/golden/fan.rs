//! The fuzzy controller `fan`: 2 inputs, 1 output, 6 rules.
//!
//! Made by `host-sim fuzzy convert fan.fll --to rust`:
//! change the design and make it again rather than this file. It needs the crates `fuzzypilot` and `fixed`.
//!
//! Route: general, `fuzzypilot::fuzzy::system`. Every rule is evaluated; the work is the same for every input.
//!
//! All numbers are whole steps, which each variable has for itself:
//!
//! | variable | a step | from | to | beyond |
//! |---|---|---|---|---|
//! | input `temperature` | 2^-16 | 1179648 = 18 | 2097152 = 32 | counts as the end |
//! | input `humidity` | 2^-16 | 1966080 = 30 | 5242880 = 80 | counts as the end |
//! | output `fan` | 2^-16 | 0 = 0 | 6553600 = 100 | never |
//!
//! It is off the same design in exact arithmetic by at most, where some rule has a degree of
//!
//! | output | ≥ 1/2 | ≥ 1/8 | ≥ 1/64 | > 0 |
//! |---|---|---|---|---|
//! | `fan` | 0.000835779 | 0.000835779 | 0.000835779 | 0.000835779 |

// Not everything is needed everywhere.
#![allow(dead_code)]

use fuzzypilot::fuzzy::system::shape::{ramp, triangle};
use fuzzypilot::fuzzy::system::{
    Block, Controller, Defuzzifier, Input, Literal, Merge, Norm, Number, Output, Rule, System,
};

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
pub const FAN_FRACTION: i32 = 16;
/// `fan` as a number: `to_bits` gives its steps, `from_bits` takes them.
pub type Fan = fixed::FixedI32<fixed::types::extra::U16>;

/// `temperature` is `cool`.
pub const TEMPERATURE_COOL: Literal = Literal::Is(0, 0);
/// `temperature` is `warm`.
pub const TEMPERATURE_WARM: Literal = Literal::Is(0, 1);
/// `temperature` is `hot`.
pub const TEMPERATURE_HOT: Literal = Literal::Is(0, 2);

/// `humidity` is `dry`.
pub const HUMIDITY_DRY: Literal = Literal::Is(1, 0);
/// `humidity` is `damp`.
pub const HUMIDITY_DAMP: Literal = Literal::Is(1, 1);

/// `fan` becomes `low`.
pub const FAN_LOW: (u8, u8) = (0, 0);
/// `fan` becomes `mid`.
pub const FAN_MID: (u8, u8) = (0, 1);
/// `fan` becomes `high`.
pub const FAN_HIGH: (u8, u8) = (0, 2);

/// The outputs for inputs, and every rule's degree: see `Controller::evaluate`.
#[rustfmt::skip]
pub static CONTROLLER: Controller<2, 5, 6, 1> = Controller::new(System::new(
    &[
        // temperature
        Input::new([q16("18"), q16("32")], &[
            &ramp(q16("24"), q16("18")), // cool
            &triangle(q16("18"), q16("24"), q16("32")), // warm
            &ramp(q16("24"), q16("32")), // hot
        ]),
        // humidity
        Input::new([q16("30"), q16("80")], &[
            &ramp(q16("80"), q16("30")), // dry
            &ramp(q16("30"), q16("80")), // damp
        ]),
    ],
    &[
        // rules
        Block { and: Norm::Min, implication: Norm::Product, rules: &[
            // if temperature is cool and humidity is dry then fan is low
            Rule::new(&[&[TEMPERATURE_COOL, HUMIDITY_DRY]], &[FAN_LOW]),
            // if temperature is cool and humidity is damp then fan is low
            Rule::new(&[&[TEMPERATURE_COOL, HUMIDITY_DAMP]], &[FAN_LOW]),
            // if temperature is warm and humidity is dry then fan is low
            Rule::new(&[&[TEMPERATURE_WARM, HUMIDITY_DRY]], &[FAN_LOW]),
            // if temperature is warm and humidity is damp then fan is mid
            Rule::new(&[&[TEMPERATURE_WARM, HUMIDITY_DAMP]], &[FAN_MID]),
            // if temperature is hot and humidity is dry then fan is mid
            Rule::new(&[&[TEMPERATURE_HOT, HUMIDITY_DRY]], &[FAN_MID]),
            // if temperature is hot and humidity is damp then fan is high
            Rule::new(&[&[TEMPERATURE_HOT, HUMIDITY_DAMP]], &[FAN_HIGH]),
        ] },
    ],
    &[
        // fan
        Output {
            range: [q16("0"), q16("100")],
            clamp: false,
            default: q16("0"),
            complete: true,
            defuzzifier: Defuzzifier::WeightedAverage {
                merge: Merge::Sum,
                terms: &[
                    Number::Constant(q16("0")), // low
                    Number::Constant(q16("40")), // mid
                    Number::Constant(q16("100")), // high
                ],
            },
        },
    ],
));

/// The outputs for inputs, each in steps of its variable.
#[inline]
pub fn evaluate(inputs: [i32; 2]) -> [i32; 1] {
    CONTROLLER.evaluate(inputs).outputs
}

/// A number in steps of 2^−16.
const fn q16(text: &str) -> i32 {
    fixed::FixedI32::<fixed::types::extra::U16>::lit(text).to_bits()
}
