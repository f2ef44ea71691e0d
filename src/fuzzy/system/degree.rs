//! Degrees: of membership, of activation, and the weights of rules.

use super::arithmetic::{least, most};
use fixed::FixedU32;
use fixed::types::extra::U24;

/// A degree of membership or activation: 0 is none, [`Degree::ONE`] (2²⁴) is full.
///
/// It is finer than a [`Grade`](crate::fuzzy::Grade): where memberships are multiplied, or where the tails of Gaussians
/// alone fire, a height method divides by small degrees.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Degree(u32);

impl Degree {
    /// None.
    pub const ZERO: Self = Self(0);
    /// Full.
    pub const ONE: Self = Self(1 << 24);

    /// From 0 to 2²⁴; anything above saturates at full.
    pub const fn from_bits(bits: u32) -> Self {
        if bits > Self::ONE.0 {
            Self::ONE
        } else {
            Self(bits)
        }
    }

    /// From a decimal number, rounded to the format; 1 and anything above is full. Text that is no such number does not
    /// compile in a `const` (at run time it panics, so keep it in one).
    pub const fn lit(text: &str) -> Self {
        Self::from_bits(FixedU32::<U24>::lit(text).to_bits())
    }

    /// From bits that are known to be in range.
    #[inline]
    pub(super) const fn known(bits: u32) -> Self {
        Self(bits)
    }

    /// 0 to 2²⁴.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// `1 − self`: NOT.
    #[inline]
    pub const fn complement(self) -> Self {
        Self(Self::ONE.0.wrapping_sub(self.0))
    }

    /// The smaller.
    #[inline]
    pub(super) const fn least(self, other: Self) -> Self {
        Self(least(self.0, other.0))
    }

    /// The larger.
    #[inline]
    pub(super) const fn most(self, other: Self) -> Self {
        Self(most(self.0, other.0))
    }

    /// The product, rounded to nearest.
    #[inline]
    pub(super) const fn product(self, other: Self) -> Self {
        let wide = (self.0 as u64).wrapping_mul(other.0 as u64);
        Self((wide.wrapping_add(1 << 23) >> 24) as u32)
    }
}
