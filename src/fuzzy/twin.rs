//! Two outputs of one rule base over evenly divided inputs, packed for one evaluation: the quickest route of the engine.
//!
//! ```text
//! two Positions ──▶ gap and share on each axis ──min──▶ four weights ─┬─▶ Σ w·peak of the first output  ─┬─▶ · 1/Σw
//!                                                                     └─▶ Σ w·peak of the second output ─┘
//! ```
//!
//! A [`TwinTable`] says what the same two [`RuleTable`]s say. It costs the same instructions for every input, divides
//! once or, on a processor that cannot, not at all, and gives the same integers everywhere.

use super::even::{Place, Position, are_even};
use super::product::mean;
use super::weigh::{Edge, Weighed, factor, grades, weigh};
use super::{Activation, Antecedents, RuleTable};

/// Two complete rule tables of `R × C` rules over even partitions. `GAPS` is `R − 1`.
#[derive(Clone, Debug)]
#[repr(transparent)]
pub struct TwinTable<const R: usize, const C: usize, const GAPS: usize> {
    edges: [[Edge; C]; GAPS],
}

/// What one evaluation gives.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Twin<const R: usize, const C: usize> {
    /// The first output in its table's format, with [`Self::EXTRA_BITS`] more behind the point.
    pub first: i32,
    /// The second output, likewise.
    pub second: i32,
    /// The rules behind both. Who does not look at them pays nothing for them.
    pub activation: Activation<R, C>,
}

/// Fractional bits that a [`Twin`] has more than its tables' formats.
const EXTRA_BITS: u32 = 12;

impl<const R: usize, const C: usize> Twin<R, C> {
    #[inline(always)]
    fn new(row: &Place, col: &Place, weighed: &Weighed) -> Self {
        let [first, second] = weighed.sums;
        Self {
            first: mean(first, weighed.reciprocal),
            second: mean(second, weighed.reciprocal),
            activation: Activation::at(row.lower, col.lower, grades(weighed.degrees)),
        }
    }

    /// Of what is computed already.
    #[cfg(dsp)]
    #[inline(always)]
    pub(super) fn of(row: Position, col: Position, means: [i32; 2], degrees: [i32; 4]) -> Self {
        let [first, second] = means;
        let (row, col) = (row.place::<R>(), col.place::<C>());
        Self {
            first,
            second,
            activation: Activation::at(row.lower, col.lower, grades(degrees)),
        }
    }

    /// Fractional bits that an output has more than its table's format.
    pub const EXTRA_BITS: u32 = EXTRA_BITS;

    /// Both outputs in their tables' own formats, rounded to nearest.
    pub const fn rounded(&self) -> [i16; 2] {
        [round(self.first), round(self.second)]
    }
}

/// |wide| is at most a peak's, with [`EXTRA_BITS`]: it fits again.
const fn round(wide: i32) -> i16 {
    (wide.wrapping_add(1 << (EXTRA_BITS - 1)) >> EXTRA_BITS) as i16
}

impl<const R: usize, const C: usize, const GAPS: usize> TwinTable<R, C, GAPS> {
    /// Bytes from one row of edges to the next.
    #[cfg(dsp)]
    pub(super) const STRIDE: u32 = size_of::<[Edge; C]>() as u32;

    /// From the inputs' partitions and the two outputs' tables.
    ///
    /// In a `const` or `static` these do not compile (at run time they panic, so keep it in one): peaks of an input that
    /// are not evenly spaced, `GAPS` that is not `R − 1`.
    pub const fn new<A, B>(
        antecedents: &Antecedents<R, C>,
        first: &RuleTable<R, C, A>,
        second: &RuleTable<R, C, B>,
    ) -> Self {
        assert!(
            R >= 2 && C >= 2 && GAPS + 1 == R,
            "a twin table has at least two rows and columns, and one gap less than rows"
        );
        assert!(
            are_even(antecedents.rows.raw_peaks()) && are_even(antecedents.cols.raw_peaks()),
            "a twin table needs evenly spaced peaks on both inputs"
        );
        let mut edges = [[Edge::NONE; C]; GAPS];
        let mut row = 0;
        while row < GAPS {
            let mut col = 0;
            while col < C {
                edges[row][col] = Edge {
                    first: pair(first.cells(), row, col),
                    second: pair(second.cells(), row, col),
                };
                col += 1;
            }
            row += 1;
        }
        Self { edges }
    }

    /// Both outputs at a row's and a column's position, by the height method over the four rules that fire.
    ///
    /// A result is nearer to zero than the exact mean over the grades by at most 1.53 · 10⁻⁵ of it, and at most one step
    /// below that. [Rounded](Twin::rounded) it lies between the least and the greatest peak of its four rules.
    #[inline(always)]
    pub fn evaluate(&self, rows: Position, cols: Position) -> Twin<R, C> {
        let (row, col) = (rows.place::<R>(), cols.place::<C>());
        #[cfg(dsp)]
        let weighed = super::dsp::weigh(&row, &col, self.edges_in(&row));
        #[cfg(not(dsp))]
        let weighed = weigh(&row, &col, self.edges_in(&row));
        Twin::new(&row, &col, &weighed)
    }

    /// [`evaluate`](Self::evaluate) without any processor's own instructions: the same result on every one.
    #[inline(always)]
    pub fn evaluate_plain(&self, rows: Position, cols: Position) -> Twin<R, C> {
        let (row, col) = (rows.place::<R>(), cols.place::<C>());
        let weighed = weigh(&row, &col, self.edges_in(&row));
        Twin::new(&row, &col, &weighed)
    }

    #[inline(always)]
    fn edges_in(&self, row: &Place) -> &[Edge; C] {
        // In range as it is: `min` lets the optimiser drop the bounds check.
        &self.edges[row.lower.min(GAPS - 1)]
    }
}

const fn pair<const R: usize, const C: usize>(
    cells: &[[i16; C]; R],
    row: usize,
    col: usize,
) -> u32 {
    factor(cells[row][col]) as u16 as u32 | (factor(cells[row + 1][col]) as u16 as u32) << 16
}
