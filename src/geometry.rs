//! Points and poses in the plane, in fixed point. x forward (or east), y left (or north), counter-clockwise positive.

use crate::integer::{saturate, square_root};
use crate::units::{Angle, Metres};
use fixed::types::I2F30;

/// A point or a displacement, metres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Point {
    /// Forward or east.
    pub x: Metres,
    /// Left or north.
    pub y: Metres,
}

impl Point {
    /// From coordinates.
    pub const fn new(x: Metres, y: Metres) -> Self {
        Self { x, y }
    }

    /// The point at `distance` in direction `heading`.
    pub fn polar(distance: Metres, heading: Angle) -> Self {
        heading.rotation().ahead(distance)
    }

    /// Length; exact to one step, saturates.
    pub fn norm(self) -> Metres {
        root(self.norm_squared())
    }

    /// Square of the length, in squares of a step: 2^63 at most. For comparing lengths without a root.
    pub const fn norm_squared(self) -> u64 {
        square(self.x).wrapping_add(square(self.y))
    }

    /// Direction; 0 for the null vector.
    pub fn direction(self) -> Angle {
        Angle::of(self.x.bits(), self.y.bits())
    }

    /// Rotated counter-clockwise by `angle`.
    pub fn rotated(self, angle: Angle) -> Self {
        angle.rotation().forth(self)
    }
}

/// A turn, ready to be applied to many points: cosine and sine of its angle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Rotation {
    cos: I2F30,
    sin: I2F30,
}

impl Angle {
    /// The turn by this angle.
    pub fn rotation(self) -> Rotation {
        let (cos, sin) = self.cos_sin();
        Rotation { cos, sin }
    }
}

impl Rotation {
    /// No turn.
    pub const NONE: Self = Self {
        cos: I2F30::ONE,
        sin: I2F30::ZERO,
    };

    /// `point` turned counter-clockwise.
    pub fn forth(self, point: Point) -> Point {
        Point::new(
            times(point.x, self.cos) - times(point.y, self.sin),
            times(point.x, self.sin) + times(point.y, self.cos),
        )
    }

    /// `point` turned back, clockwise.
    pub fn back(self, point: Point) -> Point {
        Point::new(
            times(point.x, self.cos) + times(point.y, self.sin),
            times(point.y, self.cos) - times(point.x, self.sin),
        )
    }

    /// Fractional bits that [`along_and_beside`](Self::along_and_beside) has more than [`Metres`].
    pub const FRACTION: u32 = 30;

    /// From cosine and sine, 30 fractional bits each.
    pub(crate) const fn from_bits(cos: i32, sin: i32) -> Self {
        Self {
            cos: I2F30::from_bits(cos),
            sin: I2F30::from_bits(sin),
        }
    }

    /// How far `point` lies along this direction; rounded to nearest.
    pub fn along(self, point: Point) -> Metres {
        let (along, _) = self.along_and_beside(point);
        Metres::from_bits(saturate(along.wrapping_add(1 << 29) >> 30))
    }

    /// How far `point` lies along this direction, and to the left of it; unrounded. For comparisons.
    pub fn along_and_beside(self, point: Point) -> (i64, i64) {
        let (x, y) = (i64::from(point.x.bits()), i64::from(point.y.bits()));
        let (cos, sin) = (i64::from(self.cos.to_bits()), i64::from(self.sin.to_bits()));
        // Four products of 31 + 30 bits at most: two together fit.
        (
            x.wrapping_mul(cos).wrapping_add(y.wrapping_mul(sin)),
            y.wrapping_mul(cos).wrapping_sub(x.wrapping_mul(sin)),
        )
    }

    /// The point at `distance` in this direction.
    pub fn ahead(self, distance: Metres) -> Point {
        Point::new(times(distance, self.cos), times(distance, self.sin))
    }

    /// Of the direction (x, y), a vector about as long as `length`, which is from 1 to 2^30. The direction is exact; the
    /// result is as long as one within 2^-14 and what the vector is longer or shorter.
    pub(crate) const fn of_length(x: i32, y: i32, length: u32) -> Self {
        // The length's top bit goes to the third place; neither coordinate is much longer.
        let up = length.leading_zeros().saturating_sub(2);
        let divisor = length.wrapping_shl(up) >> 15;
        // 2^31 by the upper 15 bits of it: 2^46 by the length.
        let reciprocal = match (1u32 << 31).checked_div(divisor) {
            Some(reciprocal) => reciprocal as i32,
            None => 0,
        };
        let cos = (x.wrapping_shl(up) as i64).wrapping_mul(reciprocal as i64) >> 16;
        let sin = (y.wrapping_shl(up) as i64).wrapping_mul(reciprocal as i64) >> 16;
        Self::from_bits(cos as i32, sin as i32)
    }

    /// A little further, counter-clockwise: by the angle with this tangent, 32 fractional bits. It gets longer by half the
    /// tangent's square.
    #[inline(always)]
    pub(crate) const fn nudged(self, tangent: i32) -> Self {
        let (along, beside) = self.shares(tangent);
        Self::from_bits(
            self.cos.to_bits().wrapping_sub(beside),
            self.sin.to_bits().wrapping_add(along),
        )
    }

    /// [`nudged`](Self::nudged) the other way.
    #[inline(always)]
    pub(crate) const fn nudged_back(self, tangent: i32) -> Self {
        let (along, beside) = self.shares(tangent);
        Self::from_bits(
            self.cos.to_bits().wrapping_add(beside),
            self.sin.to_bits().wrapping_sub(along),
        )
    }

    /// A share of cosine and sine, 32 fractional bits. A constant one makes each the upper half of a product, an
    /// instruction.
    #[inline(always)]
    const fn shares(self, share: i32) -> (i32, i32) {
        let (cos, sin) = (self.cos.to_bits() as i64, self.sin.to_bits() as i64);
        (
            (cos.wrapping_mul(share as i64) >> 32) as i32,
            (sin.wrapping_mul(share as i64) >> 32) as i32,
        )
    }

    /// The angle turned by.
    pub fn angle(self) -> Angle {
        Angle::of(self.cos.to_bits(), self.sin.to_bits())
    }

    /// A quarter turn further, counter-clockwise.
    pub fn left(self) -> Self {
        Self {
            cos: -self.sin,
            sin: self.cos,
        }
    }

    /// A quarter turn less.
    pub fn right(self) -> Self {
        Self {
            cos: self.sin,
            sin: -self.cos,
        }
    }
}

impl core::ops::Add for Point {
    type Output = Self;
    fn add(self, other: Self) -> Self {
        Self::new(self.x + other.x, self.y + other.y)
    }
}

impl core::ops::Sub for Point {
    type Output = Self;
    fn sub(self, other: Self) -> Self {
        Self::new(self.x - other.x, self.y - other.y)
    }
}

/// A place and a heading.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Pose {
    /// Place.
    pub at: Point,
    /// Heading, counter-clockwise from x.
    pub heading: Angle,
}

impl Pose {
    /// From parts.
    pub const fn new(at: Point, heading: Angle) -> Self {
        Self { at, heading }
    }

    /// Its frame, ready to carry many points over.
    pub fn frame(self) -> Frame {
        Frame {
            at: self.at,
            forward: self.heading.rotation(),
        }
    }

    /// A point of the world in this pose's frame.
    pub fn to_body(self, world: Point) -> Point {
        self.frame().to_body(world)
    }

    /// A point of this pose's frame in the world.
    pub fn to_world(self, body: Point) -> Point {
        self.frame().to_world(body)
    }
}

/// The frame of a pose: its place, and the rotation into its heading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    at: Point,
    forward: Rotation,
}

impl Frame {
    /// A point of the world in this frame.
    pub fn to_body(self, world: Point) -> Point {
        self.forward.back(world - self.at)
    }

    /// A point of this frame in the world.
    pub fn to_world(self, body: Point) -> Point {
        self.at + self.forward.forth(body)
    }
}

/// Length times a cosine or sine, at most one either way: the product, rounded to nearest, is a length again.
pub(crate) fn times(length: Metres, ratio: I2F30) -> Metres {
    let wide = i64::from(length.bits()).wrapping_mul(ratio.to_bits().into());
    Metres::from_bits((wide.wrapping_add(1 << 29) >> 30) as i32)
}

/// Square of a length, in squares of a step.
pub(crate) const fn square(m: Metres) -> u64 {
    let bits = m.bits() as i64;
    bits.wrapping_mul(bits) as u64
}

/// √(c² − a²) where it exists, else 0.
pub(crate) fn leg(c: Metres, a: Metres) -> Metres {
    root(square(c).saturating_sub(square(a)))
}

/// Root of a sum of squares, rounded down to a step; saturates.
pub(crate) fn root(square: u64) -> Metres {
    let root = square_root(square).cast_signed();
    // One with the sign's place taken is too long: then all ones but that.
    Metres::from_bits((root | root >> 31) & i32::MAX)
}
