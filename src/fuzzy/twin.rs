//! Two outputs of one rule base over evenly divided inputs, packed for one evaluation: the quickest route of the engine.
//!
//! ```text
//! two Positions ──▶ gap and share on each axis ──min──▶ four weights ─┬─▶ Σ w·peak of the first output  ─┬─▶ · 1/Σw
//!                                                                     └─▶ Σ w·peak of the second output ─┘
//! ```
//!
//! A [`TwinTable`] says what the same two [`RuleTable`]s say. It costs the same instructions for every input, divides
//! once or, on a processor that cannot, not at all, and gives the same integers everywhere.

use super::even::{FULL, Place, Position, are_even};
use super::product::mean;
use super::reciprocal::reciprocal;
use super::{Activation, Antecedents, Grade, RuleTable};

/// Two complete rule tables of `R × C` rules over even partitions. `GAPS` is `R − 1`.
#[derive(Clone, Debug)]
pub struct TwinTable<const R: usize, const C: usize, const GAPS: usize> {
    edges: [[Edge; C]; GAPS],
}

/// Two rules one above the other: their peaks in both outputs, negated, the upper row's in the lower half.
#[derive(Clone, Copy, Debug)]
struct Edge {
    first: u32,
    second: u32,
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
    /// [`EXTRA_BITS`], for who scales an output.
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
        let empty = Edge {
            first: 0,
            second: 0,
        };
        let mut edges = [[empty; C]; GAPS];
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
    /// A result lies between the least and the greatest peak of its four rules, at most 3 · 10⁻⁵ of them below the
    /// exact mean over the grades.
    #[inline(always)]
    pub fn evaluate(&self, rows: Position, cols: Position) -> Twin<R, C> {
        let (row, col) = (rows.place::<R>(), cols.place::<C>());
        let weights = Weights::new(&row, &col);
        let [left, right] = self.edges_at(row.lower, col.lower);
        let reciprocal = reciprocal(weights.excess);
        Twin {
            first: mean(weights.sum(left.first, right.first), reciprocal),
            second: mean(weights.sum(left.second, right.second), reciprocal),
            activation: Activation::at(row.lower, col.lower, weights.grades()),
        }
    }

    #[inline(always)]
    fn edges_at(&self, row: usize, col: usize) -> [Edge; 2] {
        let edges = &self.edges[row.min(GAPS - 1)];
        let col = col.min(C - 2);
        [edges[col], edges[col + 1]]
    }
}

const fn pair<const R: usize, const C: usize>(
    cells: &[[i16; C]; R],
    row: usize,
    col: usize,
) -> u32 {
    negated(cells[row][col]) | negated(cells[row + 1][col]) << 16
}

/// No peak is the least 16-bit number: see [`Consequents`](super::Consequents).
const fn negated(peak: i16) -> u32 {
    peak.wrapping_neg() as u16 as u32
}

/// The four rules' degrees, negated, 0 to [`FULL`]: row by row, left before right.
#[derive(Clone, Copy, Debug)]
struct Weights {
    degrees: [i32; 4],
    /// With f and g the two upper grades, min(f, 1 − f, g, 1 − g): Σw is one and twice this.
    excess: u32,
}

impl Weights {
    /// Two minima are enough: 1 − max(f, g) = 1 − f − g + min(f, g), and likewise with 1 − f for f.
    #[inline(always)]
    fn new(row: &Place, col: &Place) -> Self {
        let (f, g) = (row.upper, col.upper);
        let below_right = weaker(f, g);
        let above_right = weaker(FULL.wrapping_sub(f), g);
        let above_left = FULL
            .wrapping_sub(f)
            .wrapping_sub(g)
            .wrapping_add(below_right);
        let below_left = f.wrapping_sub(g).wrapping_add(above_right);
        Self {
            degrees: [above_left, above_right, below_left, below_right],
            excess: g.wrapping_sub(below_right).wrapping_sub(above_right) as u32,
        }
    }

    /// Σ w·peak, `left` and `right` as in an [`Edge`]: both factors negated, the product is not. |Σ| ≤ 2^16 · 32 767 <
    /// 2^31 by the tables' own assertion.
    #[inline(always)]
    fn sum(&self, left: u32, right: u32) -> i32 {
        let [above_left, above_right, below_left, below_right] = self.degrees;
        let above = |peaks: u32| i32::from(peaks as i16);
        let below = |peaks: u32| peaks as i32 >> 16;
        weigh(above_left, above(left))
            .wrapping_add(weigh(below_left, below(left)))
            .wrapping_add(weigh(above_right, above(right)))
            .wrapping_add(weigh(below_right, below(right)))
    }

    #[inline(always)]
    fn grades(&self) -> [Grade; 4] {
        self.degrees
            .map(|w| Grade::from_bits((w as u16).wrapping_neg()))
    }
}

/// The weaker of two negated grades, without a comparison: no compiler makes a branch of it.
#[inline(always)]
fn weaker(a: i32, b: i32) -> i32 {
    let stronger = a.wrapping_sub(b);
    b.wrapping_add(stronger & !(stronger >> 31))
}

#[inline(always)]
fn weigh(degree: i32, peak: i32) -> i32 {
    // It has 16 bits already. Where products of those cost less, the compiler must see it.
    #[cfg(dsp)]
    let degree = i32::from(degree as i16);
    degree.wrapping_mul(peak)
}
