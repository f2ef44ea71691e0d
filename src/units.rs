//! Quantities with their unit in the type, over [`fixed`].
//!
//! | type | unit | stored as | step | range |
//! |---|---|---|---|---|
//! | [`Metres`] | m | `I16F16` | 15.3 µm | ±32 768 m |
//! | [`MetresPerSecond`] | m/s | `I16F16` | 15.3 µm/s | ±32 768 m/s |
//! | [`RadiansPerSecond`] | rad/s | `I16F16` | 15.3 µrad/s | ±32 768 rad/s |
//! | [`PerMetre`] | 1/m | `I16F16` | 1.53e-5 /m | ±32 768 /m |
//! | [`Seconds`] | s | `I8F24` | 59.6 ns | ±128 s |
//! | [`Angle`] | turn | `i32`, a full turn is 2³² | 1.46 nrad | wraps |
//!
//! Linear quantities **saturate** at the ends of their range; angles **wrap**, on purpose and for free. No
//! operation here can panic.

use crate::integer::{arctangent, arctangent_of, magnitude, saturate};
use core::ops::{Add, Neg, Sub};
use fixed::types::{I2F30, I8F24, I16F16};

macro_rules! quantity {
    ($(#[$doc:meta])* $name:ident, $repr:ty) => {
        $(#[$doc])*
        #[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
        pub struct $name($repr);

        impl $name {
            /// Zero.
            pub const ZERO: Self = Self(<$repr>::ZERO);
            /// The largest value; sums saturate here.
            pub const MAX: Self = Self(<$repr>::MAX);

            /// Wraps a number that is already in this unit.
            pub const fn new(value: $repr) -> Self {
                Self(value)
            }

            /// Parses a decimal literal; in a `const` a malformed or too large one does not compile.
            pub const fn lit(text: &str) -> Self {
                Self(<$repr>::lit(text))
            }

            /// The number in this unit.
            pub const fn get(self) -> $repr {
                self.0
            }

            /// The raw integer; one count is one step of the table in [the module's page](self).
            pub const fn bits(self) -> i32 {
                self.0.to_bits()
            }

            /// From the raw integer.
            pub const fn from_bits(bits: i32) -> Self {
                Self(<$repr>::from_bits(bits))
            }

            /// Magnitude; saturates.
            pub const fn abs(self) -> Self {
                Self::from_bits(magnitude(self.bits()))
            }

            /// Product with a plain number; rounds towards minus infinity, saturates.
            pub const fn scale(self, factor: I16F16) -> Self {
                let wide = (self.0.to_bits() as i64 * factor.to_bits() as i64) >> 16;
                Self(<$repr>::from_bits(saturate(wide)))
            }

            /// `self` limited to `[-limit, limit]`; a negative limit counts as zero.
            pub fn limit(self, limit: Self) -> Self {
                let limit = limit.max(Self::ZERO);
                self.min(limit).max(-limit)
            }
        }

        impl Add for $name {
            type Output = Self;
            fn add(self, other: Self) -> Self {
                Self(self.0.saturating_add(other.0))
            }
        }

        impl Sub for $name {
            type Output = Self;
            fn sub(self, other: Self) -> Self {
                Self(self.0.saturating_sub(other.0))
            }
        }

        impl Neg for $name {
            type Output = Self;
            fn neg(self) -> Self {
                Self(self.0.saturating_neg())
            }
        }

        #[cfg(feature = "defmt")]
        impl defmt::Format for $name {
            fn format(&self, f: defmt::Formatter<'_>) {
                // Milli-units: exact enough to read, and no float formatting on the target.
                let milli = (i64::from(self.0.to_bits()) * 1000) >> <$repr>::FRAC_NBITS;
                defmt::write!(f, "{}e-3", milli);
            }
        }
    };
}

quantity!(
    /// A length or a coordinate.
    Metres, I16F16
);
quantity!(
    /// A linear speed; forward positive.
    MetresPerSecond, I16F16
);
quantity!(
    /// A yaw rate; counter-clockwise positive.
    RadiansPerSecond, I16F16
);
quantity!(
    /// A curvature; left (counter-clockwise) positive.
    PerMetre, I16F16
);
quantity!(
    /// A duration.
    Seconds, I8F24
);

impl MetresPerSecond {
    /// Distance covered in `time`.
    pub const fn over(self, time: Seconds) -> Metres {
        Metres::from_bits(saturate((self.bits() as i64 * time.bits() as i64) >> 24))
    }

    /// Yaw rate on an arc of `curvature`.
    pub const fn on_arc(self, curvature: PerMetre) -> RadiansPerSecond {
        RadiansPerSecond::from_bits(saturate(
            (self.bits() as i64 * curvature.bits() as i64) >> 16,
        ))
    }
}

impl RadiansPerSecond {
    /// Angle turned in `time`; wraps after half a turn as every [`Angle`] does.
    pub const fn over(self, time: Seconds) -> Angle {
        // rad·2^16 × s·2^24 = rad·2^40; to rad·2^28, then radians to binary angle.
        let radians = (self.bits() as i64 * time.bits() as i64) >> 12;
        Angle::from_radians_q28(radians)
    }

    /// Rim speed at `arm` metres from the centre of rotation.
    pub const fn at(self, arm: Metres) -> MetresPerSecond {
        MetresPerSecond::from_bits(saturate((self.bits() as i64 * arm.bits() as i64) >> 16))
    }
}

/// A binary angle: `i32::MIN` is minus half a turn, 0 straight ahead, `i32::MAX` one step short of plus half a turn;
/// counter-clockwise positive. Sums and differences wrap at half a turn, so the difference of two headings is always
/// the short way round.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Angle(i32);

impl Angle {
    /// Straight ahead.
    pub const ZERO: Self = Self(0);
    /// A quarter turn to the left.
    pub const QUARTER: Self = Self(1 << 30);
    /// Half a turn; its own negative.
    pub const HALF: Self = Self(i32::MIN);

    /// From the raw binary angle.
    pub const fn from_bits(bits: i32) -> Self {
        Self(bits)
    }

    /// The raw binary angle.
    pub const fn bits(self) -> i32 {
        self.0
    }

    /// From degrees; any number of turns, wrapped; rounded to the binary angle's step of 8.4e-8°.
    pub const fn from_degrees(degrees: I16F16) -> Self {
        // 2^32 / 360 / 2^16 = 8192 / 45 a raw degree step: whole 45ths first, so that 32 bits are enough.
        let raw = degrees.to_bits();
        let (whole, rest) = (raw.div_euclid(45), raw.rem_euclid(45));
        Self(
            whole
                .wrapping_mul(8192)
                .wrapping_add((rest * 8192 + 22) / 45),
        )
    }

    /// Parses degrees written as a decimal literal; in a `const` a malformed one does not compile.
    pub const fn deg(text: &str) -> Self {
        Self::from_degrees(I16F16::lit(text))
    }

    /// From radians with 28 fractional bits, any number of turns, wrapped.
    const fn from_radians_q28(radians: i64) -> Self {
        // 2^32 / 2π = 683 565 275.6; times 2^4 to keep the remainder, then >> (28 + 4).
        const TURN: i64 = 10_937_044_409;
        // What wraps out of 64 bits are whole turns.
        Self((radians.wrapping_mul(TURN) >> 32) as i32)
    }

    /// From radians; any number of turns, wrapped.
    pub const fn from_radians(radians: I16F16) -> Self {
        Self::from_radians_q28((radians.to_bits() as i64) << 12)
    }

    /// Degrees in `[-180, 180]`: the last half step below half a turn rounds to 180.
    pub const fn degrees(self) -> I16F16 {
        I16F16::from_bits(((self.0 as i64 * 360 + (1 << 15)) >> 16) as i32)
    }

    /// Radians in `[-π, π)`.
    pub const fn radians(self) -> I16F16 {
        // 2π · 2^16 = 411 774.8; 2π in Q28 is 1 686 629 713.
        I16F16::from_bits(((self.0 as i64 * 1_686_629_713 + (1 << 43)) >> 44) as i32)
    }

    /// Magnitude in degrees, `[0, 180]`.
    pub const fn abs_degrees(self) -> I16F16 {
        I16F16::from_bits(((self.0.unsigned_abs() as i64 * 360 + (1 << 15)) >> 16) as i32)
    }

    /// Magnitude; half a turn becomes one step less.
    pub const fn abs(self) -> Self {
        Self(magnitude(self.0))
    }

    /// Whether the angle points to the left (half a turn does not).
    pub const fn is_left(self) -> bool {
        self.0 > 0
    }

    /// Product with a plain number, saturating at half a turn instead of wrapping.
    pub const fn scale(self, factor: I16F16) -> Self {
        Self(saturate((self.0 as i64 * factor.to_bits() as i64) >> 16))
    }

    /// Limited to `[-limit, limit]`; a negative limit counts as zero.
    pub const fn limit(self, limit: Self) -> Self {
        let limit = if limit.0 > 0 { limit.0 } else { 0 };
        if self.0 > limit {
            Self(limit)
        } else if self.0 < -limit {
            Self(-limit)
        } else {
            self
        }
    }

    /// Cosine and sine, each with an error below 2e-5; together up to 2.3e-5 short of length one (measured in
    /// `tests/numeric_bounds.rs`).
    #[inline(never)]
    pub fn cos_sin(self) -> (I2F30, I2F30) {
        let (cos, sin) = idsp::cossin(self.0);
        (I2F30::from_bits(cos >> 1), I2F30::from_bits(sin >> 1))
    }

    /// Arctangent of a number. Within 1.3e-6 rad.
    pub fn of_tangent(tangent: I16F16) -> Self {
        Self(arctangent_of(tangent.to_bits()))
    }

    /// Direction of the vector (x, y): its scale does not matter, (0, 0) gives 0. Within 1.3e-6 rad.
    pub fn of(x: i32, y: i32) -> Self {
        Self(arctangent(x, y))
    }
}

impl Add for Angle {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0.wrapping_add(other.0))
    }
}

impl Sub for Angle {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0.wrapping_sub(other.0))
    }
}

impl Neg for Angle {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.wrapping_neg())
    }
}

#[cfg(feature = "defmt")]
impl defmt::Format for Angle {
    fn format(&self, f: defmt::Formatter<'_>) {
        let centi = (i64::from(self.0) * 36_000) >> 32;
        defmt::write!(f, "{}e-2 deg", centi);
    }
}
