//! Ruspini partitions: where between two neighbouring peaks a crisp input lies.

use super::MAX_TERMS;
use fixed::types::I16F16;

/// A membership or activation degree: 0 is none, [`Grade::ONE`] (2¹⁵ = 32 768) is full.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Grade(u16);

impl Grade {
    /// No membership.
    pub const ZERO: Self = Self(0);
    /// Full membership.
    pub const ONE: Self = Self(1 << 15);

    /// From 0 to 32 768; anything above saturates at full membership.
    pub const fn from_bits(bits: u16) -> Self {
        if bits > Self::ONE.0 {
            Self::ONE
        } else {
            Self(bits)
        }
    }

    /// From a degree that is known to be one, 0 to 32 768.
    pub(super) const fn of_degree(degree: i32) -> Self {
        Self(degree as u16)
    }

    /// 0 to 32 768.
    pub const fn bits(self) -> u16 {
        self.0
    }

    /// `1 − self`.
    pub const fn complement(self) -> Self {
        Self(Self::ONE.0.saturating_sub(self.0))
    }
}

/// A fuzzified input: it lies between term `lower` and its upper neighbour, and nowhere else.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Membership {
    /// The lower of the two terms, 0 to N − 2.
    pub lower: u8,
    /// Degree of the upper term; the lower one has the complement.
    pub upper_grade: Grade,
}

/// How one interval between two peaks divides: `(dx << shift) · reciprocal >> 46` is the Q15 fraction.
#[derive(Clone, Copy, Debug)]
struct Interval {
    gap: u32,
    shift: u32,
    reciprocal: u32,
}

/// A Ruspini partition of one input axis into `N` triangular terms with shoulders at both ends.
///
/// Inputs below the first peak or above the last belong fully to that term (they saturate; nothing wraps).
#[derive(Clone, Debug)]
pub struct Partition<const N: usize> {
    peaks: [i32; N],
    /// One an interval; the last entry is a copy that keeps the array's length `N`.
    intervals: [Interval; N],
}

impl<const N: usize> Partition<N> {
    /// From the peaks in ascending order; spacing is free.
    ///
    /// In a `const` or `static` these do not compile (at run time they panic, so keep it in a `const`): fewer than two
    /// or more than [`MAX_TERMS`] terms; peaks that are equal or out of order.
    pub const fn new(peaks: [I16F16; N]) -> Self {
        assert!(N >= 2, "a partition needs at least two terms");
        assert!(N <= MAX_TERMS, "a partition has at most seven terms");
        let mut bits = [0; N];
        let mut intervals = [Interval {
            gap: 1,
            shift: 31,
            reciprocal: 1 << 30,
        }; N];
        let mut i = 0;
        while i < N {
            bits[i] = peaks[i].to_bits();
            if i > 0 {
                assert!(
                    bits[i] > bits[i - 1],
                    "the peaks of a partition must ascend: one is equal to or below its left neighbour"
                );
                let gap = (bits[i] as i64 - bits[i - 1] as i64) as u32;
                let shift = gap.leading_zeros();
                // Rounded up, so that dx = gap gives exactly one.
                let reciprocal = (1u64 << 61).div_ceil((gap as u64) << shift) as u32;
                intervals[i - 1] = Interval {
                    gap,
                    shift,
                    reciprocal,
                };
                intervals[i] = intervals[i - 1];
            }
            i += 1;
        }
        Self {
            peaks: bits,
            intervals,
        }
    }

    /// Fuzzifies a crisp input: `N − 2` comparisons, one multiplication; the same work for every input.
    /// The degree is exact to half a step of [`Grade`].
    #[inline]
    pub fn fuzzify(&self, x: I16F16) -> Membership {
        let x = x.to_bits();
        let mut lower = 0;
        // By hand: optimised for size, an iterator's adapters cost more than the comparisons.
        let mut inner = 1;
        while inner < N - 1 {
            lower = usize::wrapping_add(lower, usize::from(x >= self.peaks[inner]));
            inner = usize::wrapping_add(inner, 1);
        }
        // N ≥ 2 by construction, so this only tells the optimiser that no bound can be missed.
        let lower = lower.min(N - 2);
        let interval = self.intervals[lower];
        let dx = if x > self.peaks[lower] {
            (x.wrapping_sub(self.peaks[lower]) as u32).min(interval.gap)
        } else {
            0
        };
        let product =
            u64::from(dx.wrapping_shl(interval.shift)).wrapping_mul(u64::from(interval.reciprocal));
        Membership {
            lower: lower as u8,
            upper_grade: Grade((product.wrapping_add(1 << 45) >> 46) as u16),
        }
    }

    /// The peaks' raw integers, ascending.
    pub(super) const fn raw_peaks(&self) -> &[i32; N] {
        &self.peaks
    }

    /// The peaks, ascending.
    pub fn peaks(&self) -> [I16F16; N] {
        self.peaks.map(I16F16::from_bits)
    }
}
