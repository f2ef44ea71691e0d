//! The four rules around an input: their degrees, and the weighted sums of two outputs' peaks.

use super::Grade;
use super::even::{FULL, Place};
use super::reciprocal::reciprocal;

/// Two rules one above the other: their [`factor`]s in both outputs, the upper row's in the lower half.
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

/// Degrees as they are shown.
#[inline(always)]
pub(super) fn grades(degrees: [i32; 4]) -> [Grade; 4] {
    degrees.map(Grade::of_degree)
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
    let below_right = lesser(f, g);
    let above_right = lesser(FULL.wrapping_sub(f), g);
    let above_left = FULL
        .wrapping_sub(f)
        .wrapping_sub(g)
        .wrapping_add(below_right);
    let below_left = f.wrapping_sub(g).wrapping_add(above_right);
    // min(f, 1 − f, g, 1 − g): Σw is one and twice this.
    let excess = below_right.wrapping_add(above_right).wrapping_sub(g);
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

/// The lesser of two grades, without a comparison: no compiler makes a branch of it.
#[inline(always)]
fn lesser(a: i32, b: i32) -> i32 {
    let difference = a.wrapping_sub(b);
    b.wrapping_add(difference & (difference >> 31))
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

/// What a degree is multiplied by for a peak.
///
/// Where processors multiply two 16-bit numbers, it is the peak negated, as the degrees are there: −2¹⁵ has 16 bits, and
/// 2¹⁵, a full degree, has not. No peak is −2¹⁵: see [`Consequents`](super::Consequents).
pub(super) const fn factor(peak: i16) -> i16 {
    if cfg!(dsp) { peak.wrapping_neg() } else { peak }
}

/// A degree's product with a peak, given as its [`factor`].
#[inline(always)]
fn product(degree: i32, factor: i32) -> i32 {
    #[cfg(dsp)]
    let degree = i32::from(degree.wrapping_neg() as i16);
    degree.wrapping_mul(factor)
}
