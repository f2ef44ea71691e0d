//! Even partitions: where all peaks of an axis are equally far apart, one multiplication finds the gap and the share in
//! it, and where the gaps are a power of two, a shift.

/// Full membership, negated as all grades are here: as factors of 16 bits −2¹⁵ is one, and 2¹⁵ is none.
pub(super) const FULL: i32 = -(1 << 15);

/// Where an input lies on an axis with evenly spaced terms: 0 is the first peak, 2³² would be the last.
///
/// [`LAST`](Self::LAST), one step before it, belongs to the last term fully. Where a position is made, what lies outside
/// the axis saturates: see [`InputScale`](super::InputScale).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
pub struct Position(u32);

/// A fuzzified position.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// The lower of the two terms around it, 0 to N − 2.
    pub lower: usize,
    /// Grade of the upper term, negated: 0 to [`FULL`]; the lower one has the complement.
    pub upper: i32,
}

impl Position {
    /// The first peak.
    pub const FIRST: Self = Self(0);
    /// The last peak.
    pub const LAST: Self = Self(u32::MAX);

    /// From steps of 2⁻³² of the axis.
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// Steps of 2⁻³² of the axis.
    pub const fn bits(self) -> u32 {
        self.0
    }

    /// Between which two of `N` terms. The grade is exact to half a step of 2⁻¹⁵.
    #[inline(always)]
    pub(super) fn place<const N: usize>(self) -> Place {
        // The gap above the point, the share in it below.
        let scaled = u64::from(self.0).wrapping_mul(N as u64 - 1);
        let share = scaled as u32;
        Place {
            // In range as it is: `min` lets the optimiser drop bounds checks where the gaps are no power of two.
            lower: ((scaled >> 32) as usize).min(N - 2),
            // Negated, half a step up becomes half a step down, as a shift does it.
            upper: ((share >> 16) as i32).wrapping_neg() >> 1,
        }
    }
}

/// Whether all neighbours are equally far apart.
pub(super) const fn are_even<const N: usize>(peaks: &[i32; N]) -> bool {
    let mut i = 2;
    while i < N {
        let left = peaks[i - 1] as i64 - peaks[i - 2] as i64;
        let right = peaks[i] as i64 - peaks[i - 1] as i64;
        if left != right {
            return false;
        }
        i += 1;
    }
    true
}
