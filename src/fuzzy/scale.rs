//! Physical units in and out: a raw number to a [`Position`] on an axis, a defuzzified number to a raw one.
//!
//! Both are prepared once, best in a `const`, and cost a product each. None needs more than 32 bits on a processor that
//! multiplies no wider.

use super::Position;
use super::product::scaled;

/// From a raw fixed-point number, 0 at an axis' first peak, to a position on it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
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

/// From a defuzzified number to a raw fixed-point one: a factor of 16 bits, and a shift.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OutputScale {
    factor: u16,
    /// 1 to 16, after 16 bits more.
    shift: u8,
}

impl OutputScale {
    /// Times `numerator / denominator`, to the nearest of 16 significant bits; below 2⁻¹⁷ fewer of them. Saturates at
    /// just below ½, also for a denominator of 0.
    pub const fn new(numerator: u64, denominator: u64) -> Self {
        let (numerator, denominator) = (numerator as u128, denominator as u128);
        let mut shift = 16;
        while shift > 0 {
            // factor / 2^(16 + shift) = numerator / denominator.
            let doubled = (numerator << (17 + shift)).wrapping_add(denominator);
            let factor = match doubled.checked_div(2 * denominator) {
                Some(factor) => factor,
                None => break,
            };
            if factor <= u16::MAX as u128 {
                return Self {
                    factor: factor as u16,
                    shift,
                };
            }
            shift -= 1;
        }
        Self {
            factor: u16::MAX,
            shift: 1,
        }
    }

    /// Scales; rounds towards minus infinity.
    #[inline(always)]
    pub const fn apply(self, wide: i32) -> i32 {
        scaled(wide, self.factor, self.shift)
    }
}
