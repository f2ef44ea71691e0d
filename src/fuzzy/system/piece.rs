//! Membership functions as straight pieces.

use super::Degree;
use super::arithmetic::mask;
use core::hint::black_box;

/// The largest magnitude of a number of a system, in its own steps; inputs beyond it count as it.
///
/// Two below 2³⁰, so that differences of two numbers, and of points beside them, fit 32 bits with their sign.
pub const LIMIT: i32 = (1 << 30) - 2;

/// A term of an input: its membership function, piece by piece in ascending order, flat before the first and behind the
/// last. The functions of [`shape`](super::shape) make them.
pub type Term<'a> = &'a [Piece];

/// A straight piece of a membership function: from a point on to the next piece's.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Piece {
    from: i32,
    start: u32,
    /// With `d` steps from `from` the degree is `start + (d << shift) · slope / 2³²`.
    slope: i32,
    shift: u32,
}

impl Piece {
    /// From one point to the next, both within [`LIMIT`] but for one step, in ascending order. The degree in between is
    /// right to three quarters of a step of [`Degree`].
    pub(super) const fn between(from: (i32, Degree), to: (i32, Degree)) -> Self {
        let gap = to.0.wrapping_sub(from.0);
        if gap <= 0 {
            return Self::flat(from);
        }
        // The top bit below the sign's.
        let shift = gap.leading_zeros() - 1;
        let rise = (to.1.bits() as i64) - (from.1.bits() as i64);
        let width = (gap as i64) << shift;
        // Rounded to nearest: |slope| ≤ 2^26.
        let slope = ((rise << 33) + width).div_euclid(2 * width);
        Self {
            from: from.0,
            start: from.1.bits(),
            slope: slope as i32,
            shift,
        }
    }

    /// The last piece, or one without a width.
    pub(super) const fn flat(from: (i32, Degree)) -> Self {
        Self {
            from: from.0,
            start: from.1.bits(),
            slope: 0,
            shift: 0,
        }
    }

    /// Where it begins.
    pub const fn from(&self) -> i32 {
        self.from
    }

    /// The degree there.
    pub const fn start(&self) -> Degree {
        Degree::from_bits(self.start)
    }

    /// How it goes on: `d` steps further the degree is `start + ((d << shift) · slope + 2³¹) >> 32`, in its bits.
    pub const fn slope(&self) -> (i32, u32) {
        (self.slope, self.shift)
    }

    /// The degree's bits that it arrives at, wherever that is.
    pub(super) const fn end(&self, x: i32) -> u32 {
        let scaled = (x as i64 - self.from as i64) << self.shift;
        let rise = (scaled as i128 * self.slope as i128 + (1 << 31)) >> 32;
        self.start.wrapping_add(rise as u32)
    }

    #[inline]
    const fn at(&self, x: i32) -> Degree {
        let distance = x.wrapping_sub(self.from);
        let distance = distance & !(mask(distance) as i32);
        let scaled = distance.wrapping_shl(self.shift) as i64;
        let rise = scaled.wrapping_mul(self.slope as i64).wrapping_add(1 << 31) >> 32;
        Degree::known(self.start.wrapping_add(rise as u32))
    }
}

/// The degree to which `x`, within [`LIMIT`], is `term`. The work depends on the number of pieces alone: it halves them
/// until one is left. A term without a piece is nothing.
#[inline]
pub(super) const fn membership(term: Term<'_>, x: i32) -> Degree {
    let Some(mut power) = term.len().checked_ilog2() else {
        return Degree::ZERO;
    };
    // Either the first 2^power pieces or the last as many.
    let rest = term.len().wrapping_sub(1usize.wrapping_shl(power));
    // The optimiser would make a comparison of it, and a branch of that.
    let mut first = rest.wrapping_mul(black_box(is_from(term, rest, x)));
    while power > 0 {
        power = power.wrapping_sub(1);
        let middle = first.wrapping_add(1usize.wrapping_shl(power));
        first = first.wrapping_add(is_from(term, middle, x).wrapping_shl(power));
    }
    if first < term.len() {
        term[first].at(x)
    } else {
        Degree::ZERO
    }
}

/// 1 if piece `i` begins at `x` or before it, else 0; a piece that there is not begins nowhere.
#[inline]
const fn is_from(term: Term<'_>, i: usize, x: i32) -> usize {
    if i < term.len() {
        (x.wrapping_sub(term[i].from) as u32 >> 31 ^ 1) as usize
    } else {
        0
    }
}
