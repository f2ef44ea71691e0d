//! Rule tables: a consequent for every pair of input terms, and the height method over the four that fire.

use super::{Activation, Grade};
use core::marker::PhantomData;
use fixed::FixedI16;
use fixed::types::I16F16;
use fixed::types::extra::{LeEqU16, Unsigned};

/// The most terms that a partition or a set of consequents may have.
pub const MAX_TERMS: usize = 7;

/// A consequent term by its place among [`Consequents`], 0 first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Term(pub u8);

impl Term {
    /// A cell without a rule. A table that holds one does not compile: write it where a rule is still to be found.
    pub const HOLE: Self = Self(u8::MAX);
}

/// A 16-bit output format: `I8F8`, `I3F13` and so on. Sealed in effect: [`FixedI16`] alone implements it.
pub trait FixedOutput: Copy {
    /// Fractional bits.
    const FRACTION: u32;
    /// From the raw integer.
    fn from_raw(bits: i16) -> Self;
}

impl<Frac: Unsigned + LeEqU16 + Copy> FixedOutput for FixedI16<Frac> {
    const FRACTION: u32 = Frac::U32;
    fn from_raw(bits: i16) -> Self {
        Self::from_bits(bits)
    }
}

/// The singleton peaks of one output's terms, in that output's format `O` (a [`FixedI16`]).
#[derive(Clone, Copy, Debug)]
pub struct Consequents<const K: usize, O> {
    peaks: [i16; K],
    format: PhantomData<O>,
}

impl<const K: usize, Frac: Unsigned + LeEqU16> Consequents<K, FixedI16<Frac>> {
    /// From the output's allowed range `[least, greatest]` and the peaks in ascending order, all in the output's own
    /// format.
    ///
    /// In a `const` or `static` these do not compile (at run time they panic, so keep it in one): no term or more than
    /// [`MAX_TERMS`]; a peak outside the range; peaks that are equal or out of order; a peak whose weighted sum could
    /// overflow the accumulator.
    pub const fn new(range: [FixedI16<Frac>; 2], peaks: [FixedI16<Frac>; K]) -> Self {
        let mut wide = [0; K];
        let mut i = 0;
        while i < K {
            wide[i] = widen(peaks[i]);
            i += 1;
        }
        Self::from_bits([widen(range[0]), widen(range[1])], wide, 1 << 16)
    }

    /// Like [`Consequents::new`] from numbers on an axis of their own, each multiplied by `scale` and rounded to the
    /// output's format. A scale that carries a peak out of the 16-bit output, or its weighted sum out of the 32-bit
    /// accumulator, does not compile.
    pub const fn scaled(range: [I16F16; 2], axis_peaks: [I16F16; K], scale: I16F16) -> Self {
        let mut wide = [0; K];
        let mut i = 0;
        while i < K {
            wide[i] = axis_peaks[i].to_bits();
            i += 1;
        }
        Self::from_bits(
            [range[0].to_bits(), range[1].to_bits()],
            wide,
            scale.to_bits(),
        )
    }

    const fn from_bits(range: [i32; 2], axis: [i32; K], scale: i32) -> Self {
        assert!(K >= 1, "an output needs at least one term");
        assert!(K <= MAX_TERMS, "an output has at most seven terms");
        let mut peaks = [0i16; K];
        let mut i = 0;
        while i < K {
            assert!(
                axis[i] >= range[0] && axis[i] <= range[1],
                "a consequent's peak lies outside the output's range"
            );
            assert!(
                i == 0 || axis[i] > axis[i - 1],
                "the peaks of an output must ascend: one is equal to or below its left neighbour"
            );
            // Q16 · Q16 = Q32, rounded to Frac bits.
            let shift = 32 - Frac::U32;
            let raw = (axis[i] as i64 * scale as i64 + (1 << (shift - 1))) >> shift;
            // Σ w ≤ 2·2^15, plus half of it for rounding: |peak| ≤ 32 767 is what an i32 accumulator holds.
            assert!(
                raw.abs() <= i16::MAX as i64,
                "the scale overflows: a consequent's peak does not fit the 16-bit output, nor its weighted sum the accumulator"
            );
            peaks[i] = raw as i16;
            i += 1;
        }
        Self {
            peaks,
            format: PhantomData,
        }
    }
}

const fn widen<Frac: Unsigned + LeEqU16>(x: FixedI16<Frac>) -> i32 {
    (x.to_bits() as i32) << (16 - Frac::U32)
}

/// A complete rule table of `R × C` rules with an output of format `O` (a [`FixedI16`]).
///
/// Each cell holds its consequent's peak itself, so a rule costs one load.
#[derive(Clone, Debug)]
pub struct RuleTable<const R: usize, const C: usize, O> {
    cells: [[i16; C]; R],
    terms: [[Term; C]; R],
    format: PhantomData<O>,
}

impl<const R: usize, const C: usize, O> RuleTable<R, C, O> {
    /// The peaks that the rules conclude, raw.
    pub(super) const fn cells(&self) -> &[[i16; C]; R] {
        &self.cells
    }
}

impl<const R: usize, const C: usize, O: FixedOutput> RuleTable<R, C, O> {
    /// From the consequent term of every cell, a row of the source a row of the table, and the terms' peaks.
    ///
    /// In a `const` or `static` these do not compile (at run time they panic, so keep it in one): a missing cell (the
    /// array's type), a [`Term::HOLE`], a term that the consequents do not have, fewer than two or more than
    /// [`MAX_TERMS`] rows or columns, consequents of another output format.
    pub const fn new<const K: usize>(
        terms: [[Term; C]; R],
        consequents: Consequents<K, O>,
    ) -> Self {
        assert!(
            R >= 2 && C >= 2 && R <= MAX_TERMS && C <= MAX_TERMS,
            "a rule table has two to seven rows and columns"
        );
        let mut cells = [[0; C]; R];
        let mut row = 0;
        while row < R {
            let mut col = 0;
            while col < C {
                let term = terms[row][col];
                assert!(
                    term.0 != Term::HOLE.0,
                    "the rule table has a hole: every pair of input terms needs a rule"
                );
                assert!(
                    (term.0 as usize) < K,
                    "a rule names a term that the output does not have"
                );
                cells[row][col] = consequents.peaks[term.0 as usize];
                col += 1;
            }
            row += 1;
        }
        Self {
            cells,
            terms,
            format: PhantomData,
        }
    }

    /// The consequent terms, as written.
    pub const fn terms(&self) -> &[[Term; C]; R] {
        &self.terms
    }

    /// The peak that the rule in `row` and `col` concludes; indices past the end count as the last.
    pub fn peak(&self, row: usize, col: usize) -> O {
        O::from_raw(self.cells[row.min(R - 1)][col.min(C - 1)])
    }

    /// Height defuzzification, Σ w·peak / Σ w over the four rules of `activation`, rounded to nearest (ties away
    /// from zero). The result lies between the least and the greatest peak.
    #[inline]
    pub fn defuzzify(&self, activation: &Activation<R, C>) -> O {
        // Both are in range by construction; `min` lets the optimiser drop the bounds checks.
        let row = usize::from(activation.row()).min(R - 2);
        let col = usize::from(activation.col()).min(C - 2);
        let [a, b, c, d] = activation.degrees();
        // |Σ| ≤ 2^16 · 32 767 < 2^31 by the assertion in `Consequents`: the sums cannot wrap.
        let sum = weigh(a, self.cells[row][col])
            .wrapping_add(weigh(b, self.cells[row][col + 1]))
            .wrapping_add(weigh(c, self.cells[row + 1][col]))
            .wrapping_add(weigh(d, self.cells[row + 1][col + 1]));
        let weight = activation.weight();
        let magnitude = sum.unsigned_abs().wrapping_add(weight.get() >> 1) / weight;
        let magnitude = magnitude as i16;
        O::from_raw(if sum < 0 {
            magnitude.wrapping_neg()
        } else {
            magnitude
        })
    }
}

fn weigh(degree: Grade, peak: i16) -> i32 {
    i32::from(degree.bits()).wrapping_mul(i32::from(peak))
}
