//! Lengths and vectors of the navigator's own geometry, in 32 bits: a step is 2⁻¹² m, 0.24 mm. Hundreds of points are
//! turned and compared in a tick, and no product here needs 64 bits.
//!
//! Within ±8 m, 2¹⁵ steps, nothing can overflow; what comes from outside saturates there. Sums wrap, so no operation can
//! panic.

use crate::geometry::Point;
use crate::integer::square_root_of_word;
use crate::units::{Angle, Metres};
use core::ops::{Add, Neg, Sub};

/// A length in steps of 2⁻¹² m.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Steps(i32);

impl Steps {
    /// No length.
    pub const ZERO: Self = Self(0);
    /// 8 m, where lengths from outside saturate.
    pub const MAX: Self = Self((1 << 15) - 1);
    /// Fractional bits that [`Metres`] have more.
    const FINER: u32 = 4;

    /// Of a length, rounded down; saturates at ±8 m.
    pub const fn of(metres: Metres) -> Self {
        let steps = metres.bits() >> Self::FINER;
        if steps > Self::MAX.0 {
            Self::MAX
        } else if steps < -Self::MAX.0 {
            Self(-Self::MAX.0)
        } else {
            Self(steps)
        }
    }

    /// Parses metres written as a decimal literal.
    pub const fn lit(text: &str) -> Self {
        Self::of(Metres::lit(text))
    }

    /// From the raw number of steps.
    pub const fn from_bits(steps: i32) -> Self {
        Self(steps)
    }

    /// The raw number of steps.
    pub const fn bits(self) -> i32 {
        self.0
    }

    /// The same length as a public quantity.
    pub const fn metres(self) -> Metres {
        Metres::from_bits(self.0.wrapping_shl(Self::FINER))
    }

    /// Magnitude.
    pub const fn abs(self) -> Self {
        Self(self.0.wrapping_abs())
    }

    /// Square; 2³⁰ at most within ±8 m.
    pub const fn squared(self) -> u32 {
        self.0.wrapping_mul(self.0) as u32
    }

    /// Product with a share of 14 fractional bits, at most one either way.
    pub const fn share(self, q14: i32) -> Self {
        Self(self.0.wrapping_mul(q14) >> 14)
    }

    /// Half of it.
    pub const fn half(self) -> Self {
        Self(self.0 >> 1)
    }
}

impl Add for Steps {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self(self.0.wrapping_add(other.0))
    }
}

impl Sub for Steps {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self(self.0.wrapping_sub(other.0))
    }
}

impl Neg for Steps {
    type Output = Self;
    fn neg(self) -> Self {
        Self(self.0.wrapping_neg())
    }
}

/// A place or a displacement, x forward, y left.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Vector {
    /// Forward, or east.
    pub x: Steps,
    /// Left, or north.
    pub y: Steps,
}

impl Vector {
    /// The null vector.
    pub const ZERO: Self = Self::new(Steps::ZERO, Steps::ZERO);

    /// From coordinates.
    pub const fn new(x: Steps, y: Steps) -> Self {
        Self { x, y }
    }

    /// Of a point; each coordinate saturates at ±8 m.
    pub const fn of(point: Point) -> Self {
        Self::new(Steps::of(point.x), Steps::of(point.y))
    }

    /// The same place as a public point.
    pub const fn point(self) -> Point {
        Point::new(self.x.metres(), self.y.metres())
    }

    /// Square of the length: 2³¹ at most within ±8 m.
    pub const fn norm_squared(self) -> u32 {
        self.x.squared().wrapping_add(self.y.squared())
    }

    /// Length, rounded down.
    pub fn norm(self) -> Steps {
        root(self.norm_squared())
    }

    /// No longer than the length, and at least 0.991 of it: without a root. The longest of its shadows on three directions.
    #[inline(always)]
    pub fn norm_at_least(self) -> Steps {
        let (x, y) = (self.x.abs(), self.y.abs());
        let (most, least) = (x.max(y).0, x.min(y).0);
        // Cosines and sines of 7.5°, 22.5° and 37.5°, 14 fractional bits, rounded down.
        let shadow =
            |cos: i32, sin: i32| most.wrapping_mul(cos).wrapping_add(least.wrapping_mul(sin));
        let longest = shadow(16_243, 2138)
            .max(shadow(15_136, 6269))
            .max(shadow(12_998, 9973));
        Steps(longest >> 14)
    }

    /// Direction; 0 for the null vector.
    pub fn direction(self) -> Angle {
        Angle::of(self.x.0, self.y.0)
    }

    /// Turned counter-clockwise.
    pub const fn turned(self, turn: Bearing) -> Self {
        let (x, y) = (self.x.0, self.y.0);
        let (cos, sin) = (turn.cos as i32, turn.sin as i32);
        Self::new(
            Steps(x.wrapping_mul(cos).wrapping_sub(y.wrapping_mul(sin)) >> 14),
            Steps(x.wrapping_mul(sin).wrapping_add(y.wrapping_mul(cos)) >> 14),
        )
    }

    /// Turned back, clockwise: how far it lies along the bearing, and how far to the left of it.
    pub const fn in_frame(self, turn: Bearing) -> Self {
        let (x, y) = (self.x.0, self.y.0);
        let (cos, sin) = (turn.cos as i32, turn.sin as i32);
        Self::new(
            Steps(x.wrapping_mul(cos).wrapping_add(y.wrapping_mul(sin)) >> 14),
            Steps(y.wrapping_mul(cos).wrapping_sub(x.wrapping_mul(sin)) >> 14),
        )
    }
}

impl Add for Vector {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y)
    }
}

impl Sub for Vector {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y)
    }
}

/// A direction as cosine and sine with 14 fractional bits.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Bearing {
    cos: i16,
    sin: i16,
}

impl Default for Bearing {
    fn default() -> Self {
        Self::AHEAD
    }
}

impl Bearing {
    /// Straight ahead.
    pub const AHEAD: Self = Self {
        cos: 1 << 14,
        sin: 0,
    };

    /// Of an angle, rounded to nearest.
    pub fn of(angle: Angle) -> Self {
        let (cos, sin) = angle.cos_sin();
        let narrow = |bits: i32| (bits.wrapping_add(1 << 15) >> 16) as i16;
        Self {
            cos: narrow(cos.to_bits()),
            sin: narrow(sin.to_bits()),
        }
    }

    /// Cosine and sine with 14 fractional bits.
    pub const fn bits(self) -> [i16; 2] {
        [self.cos, self.sin]
    }

    /// From cosine and sine with 14 fractional bits.
    pub const fn from_bits(cos: i16, sin: i16) -> Self {
        Self { cos, sin }
    }

    /// The vector of this length.
    pub const fn ahead(self, length: Steps) -> Vector {
        Vector::new(length.share(self.cos as i32), length.share(self.sin as i32))
    }

    /// This turn and then another.
    pub const fn turned(self, other: Self) -> Self {
        const HALF: i32 = 1 << 13;
        let [cos, sin] = [self.cos as i32, self.sin as i32];
        let [c, s] = [other.cos as i32, other.sin as i32];
        Self {
            cos: (cos
                .wrapping_mul(c)
                .wrapping_sub(sin.wrapping_mul(s))
                .wrapping_add(HALF)
                >> 14) as i16,
            sin: (sin
                .wrapping_mul(c)
                .wrapping_add(cos.wrapping_mul(s))
                .wrapping_add(HALF)
                >> 14) as i16,
        }
    }

    /// The opposite turn.
    pub const fn mirrored(self) -> Self {
        Self {
            cos: self.cos,
            sin: self.sin.wrapping_neg(),
        }
    }
}

/// Root of a square, rounded down.
pub(super) fn root(square: u32) -> Steps {
    Steps(square_root_of_word(square) as i32)
}

/// Keeps what `keep` says, in order. The list's own `retain` counts with checks that stay in an image as panics.
pub(super) fn retain<T: Copy, const N: usize>(
    list: &mut heapless::Vec<T, N>,
    mut keep: impl FnMut(&mut T) -> bool,
) {
    let mut kept = 0usize;
    let items = list.as_mut_slice();
    for index in 0..items.len() {
        let Some(item) = items.get_mut(index) else {
            break;
        };
        if !keep(item) {
            continue;
        }
        // All before the first one that goes stay where they are.
        if kept != index {
            let item = *item;
            if let Some(place) = items.get_mut(kept) {
                *place = item;
            }
        }
        kept = kept.wrapping_add(1);
    }
    list.truncate(kept);
}

#[cfg(test)]
mod tests {
    use super::{Steps, Vector};

    #[test]
    fn the_bound_of_a_length_is_below_it_and_not_far() {
        for x in (-30_000..=30_000).step_by(991) {
            for y in (-30_000..=30_000).step_by(787) {
                let vector = Vector::new(Steps::from_bits(x), Steps::from_bits(y));
                let exact = i64::from(x).pow(2) + i64::from(y).pow(2);
                let bound = i64::from(vector.norm_at_least().bits());
                assert!(bound.pow(2) <= exact, "{x}, {y}: {bound}");
                assert!(
                    (1000 * (bound + 2)).pow(2) > 991 * 991 * exact,
                    "{x}, {y}: {bound}"
                );
            }
        }
    }

    #[test]
    fn what_is_kept_stays_in_order() {
        let mut list: heapless::Vec<u8, 16> = (0..16).collect();
        super::retain(&mut list, |n| {
            *n += 100;
            *n % 3 != 0
        });
        let kept: heapless::Vec<u8, 16> = (100..116).filter(|n| n % 3 != 0).collect();
        assert_eq!(list, kept);
        super::retain(&mut list, |_| false);
        assert!(list.is_empty());
    }
}
