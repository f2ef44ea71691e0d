//! The four rules around an input: their degrees, and the weighted sums of two outputs' peaks.
//!
//! Grades, degrees and peaks are all kept negated. As a factor of 16 bits −2¹⁵ is one and 2¹⁵ is none, and a product of
//! two negated factors is what it would be without.

use super::Grade;
use super::even::{FULL, Place};
use super::reciprocal::reciprocal;

/// Two rules one above the other: their peaks in both outputs, the upper row's in the lower half.
#[derive(Clone, Copy, Debug)]
#[repr(C)]
pub(super) struct Edge {
    pub first: u32,
    pub second: u32,
}

impl Edge {
    /// Two peaks of zero.
    pub const NONE: Self = Self {
        first: 0,
        second: 0,
    };
}

/// What the four rules weigh.
#[derive(Clone, Copy, Debug)]
pub(super) struct Weighed {
    /// Σ w·peak of both outputs. |Σ| ≤ 2^16 · 32 767 < 2^31 by the tables' own assertion.
    pub sums: [i32; 2],
    /// Their degrees, 0 to [`FULL`]: row by row, left before right.
    pub degrees: [i32; 4],
    /// [1/Σw](reciprocal).
    pub reciprocal: u32,
}

impl Weighed {
    #[inline(always)]
    pub fn grades(&self) -> [Grade; 4] {
        self.degrees
            .map(|degree| Grade::from_bits((degree as u16).wrapping_neg()))
    }
}

/// Weighs the rules around an input; `edges` are those between its two rows.
///
/// Two minima are enough: 1 − max(f, g) = 1 − f − g + min(f, g), and likewise with 1 − f for f.
#[inline(always)]
pub(super) fn weigh<const C: usize>(row: &Place, col: &Place, edges: &[Edge; C]) -> Weighed {
    // In range as it is: `min` lets the optimiser drop bounds checks.
    let gap = col.lower.min(C - 2);
    let [left, right] = [edges[gap], edges[gap + 1]];
    let (f, g) = (row.upper(), col.upper());
    let below_right = weaker(f, g);
    let above_right = weaker(FULL.wrapping_sub(f), g);
    let above_left = FULL
        .wrapping_sub(f)
        .wrapping_sub(g)
        .wrapping_add(below_right);
    let below_left = f.wrapping_sub(g).wrapping_add(above_right);
    // min(f, 1 − f, g, 1 − g): Σw is one and twice this.
    let excess = g.wrapping_sub(below_right).wrapping_sub(above_right);
    let degrees = [above_left, above_right, below_left, below_right];
    Weighed {
        sums: [
            sum(degrees, left.first, right.first),
            sum(degrees, left.second, right.second),
        ],
        degrees,
        reciprocal: reciprocal(excess as u32),
    }
}

/// The weaker of two negated grades, without a comparison: no compiler makes a branch of it.
#[inline(always)]
fn weaker(a: i32, b: i32) -> i32 {
    let stronger = a.wrapping_sub(b);
    b.wrapping_add(stronger & !(stronger >> 31))
}

#[inline(always)]
fn sum(degrees: [i32; 4], left: u32, right: u32) -> i32 {
    let [above_left, above_right, below_left, below_right] = degrees;
    let above = |peaks: u32| i32::from(peaks as i16);
    let below = |peaks: u32| peaks as i32 >> 16;
    product(above_left, above(left))
        .wrapping_add(product(below_left, below(left)))
        .wrapping_add(product(above_right, above(right)))
        .wrapping_add(product(below_right, below(right)))
}

#[inline(always)]
fn product(degree: i32, peak: i32) -> i32 {
    // It has 16 bits already. Where products of those cost less, the compiler must see it.
    #[cfg(dsp)]
    let degree = i32::from(degree as i16);
    degree.wrapping_mul(peak)
}
