//! Physical units in and out: a raw number to a [`Position`] on an axis, a defuzzified number to a raw one.
//!
//! Both are prepared once, best in a `const`, and cost a product each. None needs more than 32 bits on a processor that
//! multiplies no wider.

use super::Position;
use super::product::Fraction;

/// From a raw fixed-point number, 0 at an axis' first peak, to a position on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(C)]
pub struct InputScale {
    /// Steps of 2⁻³² of the axis for one count.
    gain: u32,
    /// What must be added to the last count on the axis to reach the largest `i32`.
    headroom: i32,
}

impl InputScale {
    /// An axis of which one count of the raw number is `gain` steps of 2⁻³². A `gain` of 0 counts as 1.
    pub const fn new(gain: u32) -> Self {
        let gain = if gain == 0 { 1 } else { gain };
        let last = u32::MAX / gain;
        Self {
            gain,
            headroom: if last < i32::MAX as u32 {
                i32::MAX - last as i32
            } else {
                0
            },
        }
    }

    /// The position of `raw`; what is negative or beyond the axis saturates at its ends.
    #[inline(always)]
    pub const fn position(&self, raw: i32) -> Position {
        // Masks, not comparisons, so that no compiler makes branches of them.
        let raw = raw & !(raw >> 31);
        let beyond = raw.wrapping_add(self.headroom) >> 31;
        Position::from_bits((raw as u32).wrapping_mul(self.gain) | beyond as u32)
    }
}

/// From a defuzzified number to a raw fixed-point one: a fraction of 16 significant bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(transparent)]
pub struct OutputScale(Fraction);

impl OutputScale {
    /// Times `numerator / denominator`, to the nearest of 16 significant bits; below 2⁻¹⁷ fewer of them. Saturates at
    /// just below ½, also for a denominator of 0.
    pub const fn new(numerator: u64, denominator: u64) -> Self {
        // Twice the rest of the division must fit.
        let (numerator, denominator) = match denominator >> 63 {
            0 => (numerator, denominator),
            _ => (numerator >> 1, denominator >> 1),
        };
        if numerator < denominator.div_ceil(2) {
            let wide = quotient(numerator, denominator);
            // The largest shift whose factor still has 16 bits.
            let mut shift = 16u8;
            while shift > 0 {
                let beyond = 17u32.wrapping_sub(shift as u32);
                let half = 1u64.wrapping_shl(beyond.wrapping_sub(1));
                let factor = wide.wrapping_add(half).wrapping_shr(beyond);
                if factor <= u16::MAX as u64 {
                    return Self(Fraction::new(factor as u16, shift));
                }
                shift = shift.wrapping_sub(1);
            }
        }
        Self(Fraction::new(u16::MAX, 1))
    }

    /// Scales; rounds towards minus infinity.
    #[inline(always)]
    pub const fn apply(self, wide: i32) -> i32 {
        self.0.of(wide)
    }
}

/// `numerator / denominator`, below one, with 33 fractional bits, rounded down: bit by bit, a division of this width would be
/// 2 KiB on a microcontroller. The denominator is below 2^63.
#[inline(never)]
const fn quotient(numerator: u64, denominator: u64) -> u64 {
    let (mut rest, mut quotient, mut bit) = (numerator, 0u64, 0);
    while bit < 33 {
        rest = rest.wrapping_shl(1);
        quotient = quotient.wrapping_shl(1);
        if rest >= denominator {
            rest = rest.wrapping_sub(denominator);
            quotient = quotient.wrapping_add(1);
        }
        bit = u32::wrapping_add(bit, 1);
    }
    quotient
}
