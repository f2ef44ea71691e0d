//! Algebraic circle fit (Kåsa 1976): the circle that minimises Σ(x² + y² − 2ax − 2by − c)², in closed form.
//!
//! With centred moments it is a 2 × 2 linear system. On short arcs with noise it is known to estimate the radius too
//! small (Chernov, *Circular and Linear Regression*, 2010, §5.3); the caller bounds the radius and checks the
//! residual. Coordinates are scaled to 12 bits around their mean, so every moment fits 64-bit integers and the result
//! is bit-exact everywhere.

use crate::geometry::Point;
use crate::units::{Metres, saturate};

/// A fitted circle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CircleFit {
    /// Centre, in the points' frame.
    pub centre: Point,
    /// Radius.
    pub radius: Metres,
    /// RMS distance of the points from the circle.
    pub residual: Metres,
}

/// Fits a circle to 3 to 64 points; `None` for fewer, for more, and for points on a line or all in one place.
/// Exact circles come back within 0.1 % of their radius when the points span 30° or more of it
/// (`tests/numeric_bounds.rs`).
pub fn fit_circle(points: &[Point]) -> Option<CircleFit> {
    let n = i64::try_from(points.len())
        .ok()
        .filter(|n| (3..=64).contains(n))?;
    let sum =
        |of: fn(&Point) -> Metres| points.iter().map(|p| i64::from(of(p).bits())).sum::<i64>();
    let mean = Point::new(
        Metres::from_bits(saturate(sum(|p| p.x).checked_div(n)?)),
        Metres::from_bits(saturate(sum(|p| p.y).checked_div(n)?)),
    );
    // Block scaling: the largest offset gets SPAN bits, whatever the obstacle's size.
    const SPAN: u32 = 13;
    let largest = points
        .iter()
        .map(|p| {
            (*p - mean)
                .x
                .bits()
                .unsigned_abs()
                .max((*p - mean).y.bits().unsigned_abs())
        })
        .max()?;
    let bits = u32::BITS.saturating_sub(largest.leading_zeros());
    let (up, down) = (SPAN.saturating_sub(bits), bits.saturating_sub(SPAN));

    let (mut uu, mut vv, mut uv, mut uz, mut vz) = (0i64, 0i64, 0i64, 0i64, 0i64);
    for p in points {
        let offset = *p - mean;
        let u = (i64::from(offset.x.bits()) << up) >> down;
        let v = (i64::from(offset.y.bits()) << up) >> down;
        let z = u * u + v * v;
        uu += u * u;
        vv += v * v;
        uv += u * v;
        uz += u * z;
        vz += v * z;
    }
    // |u| < 2^13: means of squares < 2^26, of cubes < 2^40; determinant < 2^52, numerators < 2^67.
    let mean_of = |s: i64| s / n;
    let (uu, vv, uv, uz, vz) = (
        mean_of(uu),
        mean_of(vv),
        mean_of(uv),
        mean_of(uz),
        mean_of(vz),
    );
    let determinant = uu * vv - uv * uv;
    // On a line the determinant vanishes; below this share of its scale the radius is noise.
    if determinant <= ((uu + vv) * (uu + vv)) >> 20 {
        return None;
    }
    let numerator = |p: i64, q: i64, r: i64, s: i64| {
        i128::from(p) * i128::from(q) - i128::from(r) * i128::from(s)
    };
    let quotient =
        |num: i128| i64::try_from(num / (2 * i128::from(determinant))).unwrap_or(i64::MAX >> 16);
    let a = quotient(numerator(uz, vv, vz, uv));
    let b = quotient(numerator(vz, uu, uz, uv));
    // Farther than 2^20 steps away the circle is a line at this scale.
    if a.abs() >= 1 << 20 || b.abs() >= 1 << 20 {
        return None;
    }
    let squared = u64::try_from(a * a + b * b + uu + vv).ok()?;
    let radius = squared.isqrt();

    let unscale = |s: i64| Metres::from_bits(saturate((s << down) >> up));
    let centre = Point::new(unscale(a) + mean.x, unscale(b) + mean.y);
    let radius = unscale(i64::try_from(radius).ok()?);
    let misses = points.iter().map(|p| {
        let miss = u64::from(((*p - centre).norm() - radius).bits().unsigned_abs());
        miss * miss / points.len() as u64
    });
    let residual = misses.fold(0u64, u64::saturating_add).isqrt();
    Some(CircleFit {
        centre,
        radius,
        residual: Metres::from_bits(saturate(residual as i64)),
    })
}
