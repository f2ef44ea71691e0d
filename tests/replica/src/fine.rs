//! What is counted and compared of the fine controller: one with a small robot's scales, and a grid of inputs.

use fuzzypilot::behaviour::fine::FineController;
use fuzzypilot::params::Params;
use fuzzypilot::presets;
use fuzzypilot::units::{Angle, Metres};

/// The small robot's, prepared while this compiles.
pub static CONTROLLER: FineController = {
    static SETTINGS: Params<1> = presets::small_robot();
    FineController::new(&SETTINGS.follower, &SETTINGS.limits)
};

/// Speed and yaw rate, raw.
pub type Bits = (i32, i32);

/// From beyond one end of d's axis to beyond the other, and all the way round, in steps without a common divisor with
/// the terms; the ends of the formats, too.
pub fn grid() -> impl Iterator<Item = (Metres, Angle)> {
    let distances = (-3..80)
        .map(|i| i * 389)
        .chain([i32::MIN, i32::MAX, 26_214, 26_215]);
    distances.flat_map(|d| {
        (0..96)
            .map(|i: i32| i.wrapping_mul(0x02B3_C4D5))
            .chain([0, 1, -1, i32::MIN, i32::MAX, 1 << 29, 1 << 30])
            .map(move |angle| (Metres::from_bits(d), Angle::from_bits(angle)))
    })
}

/// One more output into a checksum.
pub fn mix(sum: u32, bits: Bits) -> u32 {
    (sum.rotate_left(5) ^ bits.0 as u32)
        .wrapping_mul(0x9E37_79B9)
        .wrapping_add(bits.1 as u32)
}
