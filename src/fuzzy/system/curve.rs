//! Curved membership functions, cut into straight pieces while the program compiles.
//!
//! A flank of a curve is sampled densely, and its knots are taken from these samples: as many as are wanted, with equal
//! shares of ∫ √|f″|, which makes the pieces' errors about equal.

use super::exponential::{decay, exponential};
use super::{Degree, LIMIT};

/// A falling flank in a coordinate of its own, 32 fractional bits.
#[derive(Clone, Copy)]
pub(super) enum Curve {
    /// exp(−t² / 2), t from 0.
    Gaussian,
    /// 1 / (1 + t^2b), t from 0; b with 16 fractional bits.
    Bell(i32),
    /// 1 / (1 + eᵗ), t from both sides.
    Sigmoid,
    /// From 1 at 0 to 0 at 1 in two parabolas.
    Spline,
}

/// Samples a flank, less one.
const SAMPLES: usize = 512;
const ONE: i64 = 1 << 32;
/// Where e^−x is half a step of a degree: 25 · ln 2.
const END: i64 = 74_425_881_946;

impl Curve {
    /// Sample `i` of 0 to [`SAMPLES`]: the coordinate, and the value with 30 fractional bits.
    const fn sample(self, i: usize) -> (i64, i64) {
        let i = i as i64;
        let n = SAMPLES as i64;
        match self {
            Self::Gaussian => {
                // 5.887 = √(2 · 25 ln 2).
                let t = 25_284_625_000 * i / n;
                let half_square = ((t as i128 * t as i128) >> 33) as i64;
                (t, (decay(half_square) >> 30) as i64)
            }
            Self::Sigmoid => {
                let t = END * (2 * i - n) / n;
                (t, logistic(t))
            }
            Self::Bell(slope) => {
                if i == 0 {
                    return (0, 1 << 30);
                }
                // 1 / (1 + eᵛ) with v = 2b · ln t: steps of equal v.
                let v = END * (2 * i - n) / n;
                let exponent = ((v as i128) << 15) / slope as i128;
                (bounded_exponential(exponent), logistic(v))
            }
            Self::Spline => {
                let t = ONE * i / n;
                let rest = if 2 * i > n { ONE - t } else { t };
                let parabola = ((rest as i128 * rest as i128) >> 33) as i64;
                (
                    t,
                    if 2 * i > n {
                        parabola
                    } else {
                        (1 << 30) - parabola
                    },
                )
            }
        }
    }
}

/// 1 / (1 + eᵗ) with 30 fractional bits.
const fn logistic(t: i64) -> i64 {
    let small = decay(if t < 0 { -t } else { t });
    let below_half = ((small as u128) << 30) / ((1 << 60) + small as u128);
    if t < 0 {
        (1 << 30) - below_half as i64
    } else {
        below_half as i64
    }
}

/// eˣ, both with 32 fractional bits; at most 2^61.
const fn bounded_exponential(x: i128) -> i64 {
    // ln 2^28.
    const MOST: i128 = 83_356_987_780;
    if x > MOST {
        return 1 << 61;
    }
    if x < -MOST {
        return 0;
    }
    let (mantissa, power) = exponential(x as i64);
    if power >= 28 {
        return 1 << 61;
    }
    (mantissa >> (28 - power)) as i64
}

/// Puts `count` points of a flank into `all` from `at` on, in ascending order: from the origin to where it is zero in the
/// direction and by the scale of `scale`.
pub(super) const fn flank(
    curve: Curve,
    origin: i32,
    scale: i64,
    count: usize,
    all: &mut [(i32, Degree)],
    at: usize,
) {
    const FAR: i64 = 1 << 40;
    assert!(
        origin >= -LIMIT && origin <= LIMIT,
        "a term's number is too large"
    );
    assert!(
        scale != 0 && scale >= -FAR && scale <= FAR,
        "a curve's width is not zero, and at most 2^40 steps"
    );
    let mut xs = [0; SAMPLES + 1];
    let mut ys = [0; SAMPLES + 1];
    // Samples that are numbers of the system: one may be beyond it, at its edge.
    let mut last = 0;
    let mut i = 0;
    while i <= SAMPLES {
        let (t, y) = curve.sample(i);
        (xs[i], ys[i]) = (t, y);
        let x = place(origin, scale, t);
        if x >= -(LIMIT as i128) && x <= LIMIT as i128 {
            last = i;
        }
        i += 1;
    }
    let mut first = 0;
    while first < last && !is_near(place(origin, scale, xs[first])) {
        first += 1;
    }
    let knots = knots(&xs, &ys, first, last, count);
    let mut k = 0;
    while k < count {
        let knot = knots[k];
        let x = place(origin, scale, xs[knot]);
        let x = if x > LIMIT as i128 {
            LIMIT
        } else if x < -(LIMIT as i128) {
            -LIMIT
        } else {
            x as i32
        };
        let degree = match knot {
            SAMPLES => Degree::ZERO,
            0 => Degree::ONE,
            // Of a curve that is narrower than a step, all of the peak.
            _ if x == origin && !matches!(curve, Curve::Sigmoid) => Degree::ONE,
            // Halfway between the errors of the pieces that meet here; tails keep half their degree at least.
            _ if k > 0 && k + 1 < count => {
                let before = deviation(&xs, &ys, knots[k - 1], knot);
                let behind = deviation(&xs, &ys, knot, knots[k + 1]);
                let y = ys[knot] - (before + behind) / 4;
                let y = if y < ys[knot] / 2 { ys[knot] / 2 } else { y };
                rounded(y)
            }
            _ => rounded(ys[knot]),
        };
        let slot = if scale > 0 {
            at + k
        } else {
            at + count - 1 - k
        };
        all[slot] = (x, degree);
        k += 1;
    }
}

/// A value with 30 fractional bits.
const fn rounded(y: i64) -> Degree {
    let y = (y + 32) >> 6;
    if y < 0 {
        Degree::ZERO
    } else {
        Degree::from_bits(y as u32)
    }
}

/// What a straight line between two samples has too much, where it is worst; negative if it has too little.
const fn deviation(xs: &[i64], ys: &[i64], from: usize, to: usize) -> i64 {
    let mut worst = 0i64;
    let width = (xs[to] - xs[from]) as i128;
    let mut i = from + 1;
    while i < to && width > 0 {
        let rise = (ys[to] - ys[from]) as i128 * (xs[i] - xs[from]) as i128 / width;
        let over = ys[from] + rise as i64 - ys[i];
        if over.unsigned_abs() > worst.unsigned_abs() {
            worst = over;
        }
        i += 1;
    }
    worst
}

const fn is_near(x: i128) -> bool {
    x >= -(LIMIT as i128) && x <= LIMIT as i128
}

/// The number of the system at a coordinate, rounded to nearest.
const fn place(origin: i32, scale: i64, t: i64) -> i128 {
    origin as i128 + ((scale as i128 * t as i128 + (1 << 31)) >> 32)
}

/// The most points a flank has.
const MOST: usize = 65;

/// `count` samples from `first` to `last`, both included, with equal shares of the curve's bending between them.
const fn knots(xs: &[i64], ys: &[i64], first: usize, last: usize, count: usize) -> [usize; MOST] {
    let mut bending = [0u64; SAMPLES + 1];
    let mut i = first;
    while i < last {
        let share = if i > first { bend(xs, ys, i) } else { 0 };
        bending[i + 1] = bending[i] + share;
        i += 1;
    }
    let total = bending[last] as u128;
    let mut chosen = [last; MOST];
    chosen[0] = first;
    let mut at = first;
    let mut k = 1;
    while k + 1 < count {
        // The first and the last piece meet the curve at one end exactly, so their errors are not halved: they are
        // shorter by √½, in hundredths.
        let wanted = (total * (100 * k as u128 - 29) / (100 * count as u128 - 158)) as u64;
        // One further at least, and one left for each that follows.
        at += 1;
        while at + (count - 1 - k) < last && bending[at] < wanted {
            at += 1;
        }
        if at > last {
            at = last;
        }
        chosen[k] = at;
        k += 1;
    }
    chosen
}

/// √|f″|·dx around sample `i`, by its neighbours.
const fn bend(xs: &[i64], ys: &[i64], i: usize) -> u64 {
    let (left, right) = (xs[i] - xs[i - 1], xs[i + 1] - xs[i]);
    if left <= 0 || right <= 0 {
        return 0;
    }
    // Slopes with 32 fractional bits, the values' 30.
    let before = ((ys[i] - ys[i - 1]) as i128 * ONE as i128) / left as i128;
    let behind = ((ys[i + 1] - ys[i]) as i128 * ONE as i128) / right as i128;
    let turn = (behind - before).unsigned_abs();
    let product = (turn * ((left + right) / 2) as u128) >> 8;
    if product >> 64 != 0 {
        u32::MAX as u64
    } else {
        (product as u64).isqrt()
    }
}
