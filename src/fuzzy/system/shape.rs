//! Membership functions by name. All numbers are in the variable's own steps, at most [`LIMIT`] in magnitude.
//!
//! Exact, to half a step of [`Degree`] at every input: [`triangle`], [`trapezoid`], [`ramp`], [`singleton`] and [`points`].
//! A vertical edge that falls takes one step of the variable, just outside of where the term holds.
//!
//! Curved ones are made of straight pieces between `N` points, more of them where they bend more. Their worst errors, of 1:
//!
//! | points a flank | 9 | 17 | 33 |
//! |---|---|---|---|
//! | [`gaussian`], [`two_sided_gaussian`] | 0.0080 | 0.0020 | 0.0005 |
//! | [`bell`], slopes 0.5 to 12 | 0.0140 | 0.0031 | 0.0011 |
//! | [`sigmoid`] | 0.0140 | 0.0038 | 0.0010 |
//! | [`spline`] | 0.0075 | 0.0019 | 0.0005 |
//!
//! A piece takes 16 bytes. Where a curve is below half a step of [`Degree`] it ends.

use super::curve::{Curve, flank};
use super::{Degree, LIMIT, Piece};
use fixed::types::I16F16;

/// Zero up to `left`, one at `peak`, zero from `right`; ascending, two of them may be equal.
pub const fn triangle(left: i32, peak: i32, right: i32) -> [Piece; 3] {
    points([
        (left, Degree::ZERO),
        (peak, Degree::ONE),
        (edge(peak, right), Degree::ZERO),
    ])
}

/// Zero up to `left`, one from `rise` to `fall`, zero from `right`; ascending, any of them may be equal.
pub const fn trapezoid(left: i32, rise: i32, fall: i32, right: i32) -> [Piece; 4] {
    points([
        (left, Degree::ZERO),
        (rise, Degree::ONE),
        (fall, Degree::ONE),
        (edge(fall, right), Degree::ZERO),
    ])
}

/// A shoulder: zero at `from` and before it, one at `to` and behind it; descending when `to < from`.
pub const fn ramp(from: i32, to: i32) -> [Piece; 2] {
    if from <= to {
        points([(from, Degree::ZERO), (to, Degree::ONE)])
    } else {
        points([(to, Degree::ONE), (from, Degree::ZERO)])
    }
}

/// One at this step, zero elsewhere.
pub const fn singleton(at: i32) -> [Piece; 3] {
    triangle(at, at, at)
}

/// Where a term ends that holds fully at `fall`: an upright flank is a step away.
const fn edge(fall: i32, right: i32) -> i32 {
    if right == fall { right + 1 } else { right }
}

/// Straight between points, flat before the first and behind the last. Of two at one place the later counts there.
///
/// Points that descend or lie beyond [`LIMIT`] do not compile in a `const` (at run time they panic, so keep them in one,
/// or in order).
pub const fn points<const N: usize>(points: [(i32, Degree); N]) -> [Piece; N] {
    assert!(N >= 1, "a term has at least one point");
    let mut pieces = [Piece::flat((0, Degree::ZERO)); N];
    fill(&points, &mut pieces);
    pieces
}

/// Like [`points`] for as many as there are: the pieces that fit.
pub const fn fill(points: &[(i32, Degree)], pieces: &mut [Piece]) {
    let mut i = 0;
    while i < points.len() && i < pieces.len() {
        let (x, _) = points[i];
        assert!(
            x >= -LIMIT && x <= LIMIT + 1,
            "a number of a term is beyond ±(2^30 - 2)"
        );
        if i > 0 {
            assert!(
                x >= points[i - 1].0,
                "the points of a term must ascend: one lies left of the one before it"
            );
            pieces[i - 1] = Piece::between(points[i - 1], points[i]);
        }
        pieces[i] = Piece::flat(points[i]);
        i += 1;
    }
}

/// exp(−(x − mean)² / 2·deviation²) in `N` points: (N + 1) / 2 a flank, the peak shared.
///
/// `N` is odd, 5 to 129; the deviation above zero, up to 2⁴⁰ steps. It ends 5.9 deviations away.
pub const fn gaussian<const N: usize>(mean: i32, deviation: i64) -> [Piece; N] {
    symmetric(Curve::Gaussian, mean, deviation)
}

/// Two Gaussian flanks, each with its mean and deviation, one between the means: N / 2 points a flank. `N` is even, 6 to
/// 128.
pub const fn two_sided_gaussian<const N: usize>(left: (i32, i64), right: (i32, i64)) -> [Piece; N] {
    assert!(
        N.is_multiple_of(2) && N >= 6 && N <= 128,
        "a two-sided curve has an even number of points, 6 to 128"
    );
    assert!(
        left.0 <= right.0,
        "the left mean of a two-sided curve lies right of the right one"
    );
    let mut all = [(0, Degree::ZERO); N];
    let half = N / 2;
    flank(Curve::Gaussian, left.0, -left.1, half, &mut all, 0);
    flank(Curve::Gaussian, right.0, right.1, half, &mut all, half);
    points(all)
}

/// 1 / (1 + |(x − centre) / width|^(2·slope)) in `N` points: (N + 1) / 2 a flank, the peak shared.
///
/// `N` is odd, 5 to 129; the width above zero, up to 2⁴⁰ steps; the slope above zero.
pub const fn bell<const N: usize>(centre: i32, width: i64, slope: I16F16) -> [Piece; N] {
    assert!(slope.to_bits() > 0, "a bell's slope is above zero");
    symmetric(Curve::Bell(slope.to_bits()), centre, width)
}

/// 1 / (1 + exp(−(x − inflection) / width)) in `N` points, 3 to 64; descending for a negative width. The width is one by
/// the usual slope; not zero, up to 2⁴⁰ steps. It ends 17.3 widths away.
pub const fn sigmoid<const N: usize>(inflection: i32, width: i64) -> [Piece; N] {
    one_sided(Curve::Sigmoid, inflection, -width)
}

/// A quadratic S from 0 at `from` to 1 at `to` in `N` points, 3 to 64; a Z when `to < from`.
pub const fn spline<const N: usize>(from: i32, to: i32) -> [Piece; N] {
    one_sided(Curve::Spline, to, from as i64 - to as i64)
}

const fn symmetric<const N: usize>(curve: Curve, centre: i32, scale: i64) -> [Piece; N] {
    assert!(
        N % 2 == 1 && N >= 5 && N <= 129,
        "a symmetric curve has an odd number of points, 5 to 129"
    );
    assert!(scale > 0, "a curve's width is above zero");
    let mut all = [(0, Degree::ZERO); N];
    let half = N / 2;
    flank(curve, centre, -scale, half + 1, &mut all, 0);
    flank(curve, centre, scale, half + 1, &mut all, half);
    points(all)
}

const fn one_sided<const N: usize>(curve: Curve, origin: i32, scale: i64) -> [Piece; N] {
    assert!(N >= 3 && N <= 64, "a one-sided curve has 3 to 64 points");
    assert!(scale != 0, "a curve's width is not zero");
    let mut all = [(0, Degree::ZERO); N];
    flank(curve, origin, scale, N, &mut all, 0);
    points(all)
}
