//! Outputs: what rules conclude, and how that becomes a number.

use super::arithmetic::limited;
use super::piece::membership;
use super::{LIMIT, Term};
use crate::fuzzy::Grade;

/// An output variable. Numbers are in its own steps.
#[derive(Clone, Copy, Debug)]
pub struct Output<'a> {
    /// Its range, both ends included, ascending, within [`LIMIT`]: no value is ever beyond it.
    pub range: [i32; 2],
    /// Whether conclusions may lie beyond the range, values then being limited to it. If not, that they lie within is
    /// proven when the system is made.
    pub clamp: bool,
    /// Its value where no rule fires; within the range.
    pub default: i32,
    /// Whether every combination of the inputs' terms has a rule for this output: a claim, proven when the system is made.
    pub complete: bool,
    /// How conclusions become a number, and the terms to conclude.
    pub defuzzifier: Defuzzifier<'a>,
}

/// How conclusions become a number.
#[derive(Clone, Copy, Debug)]
pub enum Defuzzifier<'a> {
    /// The height method, Takagi–Sugeno: Σ w·z / Σ w, rounded to nearest.
    WeightedAverage {
        /// What becomes of several rules that conclude the same term.
        merge: Merge,
        /// 1 to 255.
        terms: &'a [Number<'a>],
    },
    /// The centroid of the merged sets. With [`Merge::Sum`] it is the centre of sums.
    Centroid {
        /// What becomes of several rules at one place.
        merge: Merge,
        /// Where the sets are sampled.
        samples: Samples,
        /// 1 to 255.
        terms: &'a [Set<'a>],
    },
}

/// How several conclusions are put together.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Merge {
    /// Added.
    Sum,
    /// The largest counts.
    Max,
}

/// A number that rules conclude.
#[derive(Clone, Copy, Debug)]
pub enum Number<'a> {
    /// A singleton: Takagi–Sugeno of order 0.
    Constant(i32),
    /// Takagi–Sugeno of order 1.
    Linear(Linear<'a>),
}

/// `constant + Σ coefficient · input / 2^shift`, rounded to nearest, at most [`LIMIT`] in magnitude.
///
/// With inputs, output and coefficients in `I16F16`, `shift` is 16.
#[derive(Clone, Copy, Debug)]
pub struct Linear<'a> {
    /// One an input, up to 2³⁰ in magnitude.
    pub coefficients: &'a [i32],
    /// 0 to 60.
    pub shift: u32,
    /// In steps of the output.
    pub constant: i32,
}

impl Linear<'_> {
    /// For inputs that are limited already.
    #[inline]
    pub(super) const fn at(&self, inputs: &[i32]) -> i32 {
        let mut sum = 0i64;
        let mut i = 0;
        while i < self.coefficients.len() && i < inputs.len() {
            // Four products below 2^60.
            let product = (self.coefficients[i] as i64).wrapping_mul(inputs[i] as i64);
            sum = sum.wrapping_add(product);
            i = usize::wrapping_add(i, 1);
        }
        let half = 1i64.wrapping_shl(self.shift) >> 1;
        let scaled = sum.wrapping_add(half).wrapping_shr(self.shift);
        limited(scaled.wrapping_add(self.constant as i64), [-LIMIT, LIMIT])
    }
}

/// A fuzzy set of an output: its degree at each of the output's samples.
pub type Set<'a> = &'a [Grade];

/// Where a centroid's samples lie.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Samples {
    count: u32,
    low: i32,
    high: i32,
    /// In sample places, [`Samples::FRACTION`] fractional bits: what comes before the first.
    offset: u32,
    /// From one to the next, `step · 2^−shift` with [`Samples::FRACTION`] taken off.
    step: u32,
    shift: u32,
}

impl Samples {
    /// Fractional bits of a place among the samples.
    pub(super) const FRACTION: u32 = 21;
    /// The most samples.
    pub const MOST: usize = 1024;

    /// `count` samples from end to end, both included: 2 to [`Samples::MOST`].
    pub const fn ends(range: [i32; 2], count: usize) -> Self {
        assert!(
            count >= 2 && count <= Self::MOST,
            "a centroid takes 2 to 1024 samples"
        );
        Self::spread(range, count, count as u64 - 1, 0)
    }

    /// `count` samples in the middles of as many equal parts: 2 to [`Samples::MOST`].
    pub const fn middles(range: [i32; 2], count: usize) -> Self {
        assert!(
            count >= 2 && count <= Self::MOST,
            "a centroid takes 2 to 1024 samples"
        );
        Self::spread(range, count, count as u64, 1 << (Self::FRACTION - 1))
    }

    const fn spread([low, high]: [i32; 2], count: usize, parts: u64, offset: u32) -> Self {
        assert!(
            low < high && low >= -LIMIT && high <= LIMIT,
            "the range of a centroid ascends, within ±(2^30 − 2)"
        );
        let span = (high as i64 - low as i64) as u64;
        // The step's mantissa with all of 32 bits; a step below one keeps 32 fractional bits.
        let mut shift = 32;
        while shift > 0 && ((span << shift) / parts) >> 32 != 0 {
            shift -= 1;
        }
        Self {
            count: count as u32,
            low,
            high,
            offset,
            step: (((span << shift) + parts / 2) / parts) as u32,
            shift: shift + Self::FRACTION,
        }
    }

    /// How many.
    pub const fn count(&self) -> usize {
        self.count as usize
    }

    /// The range that they are spread over.
    pub const fn range(&self) -> [i32; 2] {
        [self.low, self.high]
    }

    /// How they lie, `(offset, step, shift)`: with `p` places from the first one, in 2⁻²¹ of a place, the output is
    /// `low + ((p + offset) · step + 2^(shift − 1)) >> shift`, for who writes the same in another language.
    pub const fn spacing(&self) -> (u32, u32, u32) {
        (self.offset, self.step, self.shift)
    }

    /// The output at a place among the samples: 0 is the first, with [`Samples::FRACTION`] fractional bits.
    #[inline]
    pub(super) const fn at(&self, place: u32) -> i32 {
        let place = place.wrapping_add(self.offset);
        let wide = (place as u64).wrapping_mul(self.step as u64);
        let half = 1u64.wrapping_shl(self.shift) >> 1;
        let distance = wide.wrapping_add(half).wrapping_shr(self.shift);
        self.low.wrapping_add(distance as i32)
    }

    /// A membership function at the samples, `N` as many as there are: for tables that are made while the program
    /// compiles. A sample between two steps of the output takes the nearer one's degree.
    pub const fn of<const N: usize>(&self, term: Term<'_>) -> [Grade; N] {
        assert!(N == self.count(), "a set has a degree for every sample");
        let mut set = [Grade::ZERO; N];
        let mut i = 0;
        while i < N {
            let x = self.at((i as u32) << Self::FRACTION);
            set[i] = Grade::from_bits(((membership(term, x).bits() + (1 << 8)) >> 9) as u16);
            i += 1;
        }
        set
    }
}
