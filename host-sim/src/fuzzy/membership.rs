//! Membership functions in `f64`: the degree at a value, and the values between which it only rises or only falls.

use super::model::Shape;

/// What is left of a smooth shape's tail below this counts as nothing where [`Shape::reaches`] is asked: half a step of
/// a 24-bit degree, so that nothing of it is left in fixed point.
pub const TAIL: f64 = 1.0 / 33_554_432.0;

impl Shape {
    /// The degree at `x`, 0 to 1. At a step of [`Shape::Points`] the later point counts, at the foot of an upright flank
    /// the top. NaN has the degree NaN.
    pub fn degree(&self, x: f64) -> f64 {
        if x.is_nan() {
            return f64::NAN;
        }
        match *self {
            Self::Triangle { left, peak, right } => trapezoid([left, peak, peak, right], x),
            Self::Trapezoid {
                left,
                rise,
                fall,
                right,
            } => trapezoid([left, rise, fall, right], x),
            Self::Ramp { from, to } => progress(from, to, x),
            Self::Singleton(at) => f64::from(u8::from(x == at)),
            Self::Points(ref points) => interpolated(points, x),
            Self::Gaussian { mean, deviation } => gaussian(mean, deviation, x),
            Self::TwoSidedGaussian { left, right } => {
                if x < left.0 {
                    gaussian(left.0, left.1, x)
                } else if x > right.0 {
                    gaussian(right.0, right.1, x)
                } else {
                    1.0
                }
            }
            Self::Bell {
                centre,
                width,
                slope,
            } => 1.0 / (1.0 + ((x - centre) / width).abs().powf(2.0 * slope)),
            Self::Sigmoid { inflection, slope } => 1.0 / (1.0 + (-slope * (x - inflection)).exp()),
            Self::Spline { from, to } => {
                let t = progress(from, to, x);
                if t <= 0.5 {
                    2.0 * t * t
                } else {
                    1.0 - 2.0 * (1.0 - t) * (1.0 - t)
                }
            }
        }
    }

    /// Whether more than a negligible degree is left at `x`: any at all of a shape that ends, above [`TAIL`] of one whose
    /// tails never do.
    pub fn reaches(&self, x: f64) -> bool {
        self.degree(x) > self.tail()
    }

    /// Whether a negligible degree is missing to one at `x`, or none: there "is not" does not hold.
    pub fn fills(&self, x: f64) -> bool {
        self.degree(x) >= 1.0 - self.tail()
    }

    fn tail(&self) -> f64 {
        match self {
            Self::Gaussian { .. }
            | Self::TwoSidedGaussian { .. }
            | Self::Bell { .. }
            | Self::Sigmoid { .. } => TAIL,
            _ => 0.0,
        }
    }

    /// The degrees just before `x` and just behind it: where the shape jumps, other ones than at `x` itself.
    pub fn beside(&self, x: f64) -> [f64; 2] {
        let at = self.degree(x);
        match *self {
            Self::Singleton(only) if x == only => [0.0; 2],
            Self::Triangle { left, right, .. } | Self::Trapezoid { left, right, .. } => {
                // A foot is where the flank ends, however steep it is.
                let foot = |is_foot: bool| if is_foot { 0.0 } else { at };
                [foot(x == left), foot(x == right)]
            }
            Self::Points(ref points) => {
                let same = || points.iter().filter(|point| point.0 == x);
                [same().next(), same().next_back()].map(|point| point.map_or(at, |point| point.1))
            }
            _ => [at; 2],
        }
    }

    /// Where the degree jumps, or is one at a single value.
    pub fn jumps(&self) -> Vec<f64> {
        let ends = match *self {
            Self::Triangle { left, peak, right } => vec![(left, peak), (peak, right)],
            Self::Trapezoid {
                left,
                rise,
                fall,
                right,
            } => vec![(left, rise), (fall, right)],
            Self::Singleton(at) => vec![(at, at)],
            Self::Points(ref points) => points.windows(2).map(|two| (two[0].0, two[1].0)).collect(),
            _ => Vec::new(),
        };
        let upright = ends.into_iter().filter(|(a, b)| a == b && a.is_finite());
        upright.map(|(at, _)| at).collect()
    }

    /// Finite values, ascending, between which the degree only rises or only falls, and [`Shape::reaches`] and
    /// [`Shape::fills`] do not change.
    pub fn knots(&self) -> Vec<f64> {
        let mut knots = match *self {
            Self::Triangle { left, peak, right } => vec![left, peak, right],
            Self::Trapezoid {
                left,
                rise,
                fall,
                right,
            } => vec![left, rise, fall, right],
            Self::Ramp { from, to } | Self::Spline { from, to } => vec![from, to],
            Self::Singleton(at) => vec![at],
            Self::Points(ref points) => points.iter().map(|point| point.0).collect(),
            Self::Gaussian { mean, deviation } => {
                let far = deviation * gaussian_reach(TAIL);
                let near = deviation * gaussian_reach(1.0 - TAIL);
                vec![mean - far, mean - near, mean, mean + near, mean + far]
            }
            Self::TwoSidedGaussian { left, right } => {
                let (far, near) = (gaussian_reach(TAIL), gaussian_reach(1.0 - TAIL));
                vec![
                    left.0 - left.1 * far,
                    left.0 - left.1 * near,
                    left.0,
                    right.0,
                    right.0 + right.1 * near,
                    right.0 + right.1 * far,
                ]
            }
            Self::Bell {
                centre,
                width,
                slope,
            } => {
                // Where u = |(x − centre) / width|^(2 · slope) leaves `TAIL`, and where it takes all but `TAIL`.
                let far = width * (1.0 / TAIL - 1.0).powf(0.5 / slope);
                let near = width * (1.0 / (1.0 - TAIL) - 1.0).powf(0.5 / slope);
                vec![
                    centre - far,
                    centre - near,
                    centre,
                    centre + near,
                    centre + far,
                ]
            }
            Self::Sigmoid { inflection, slope } => {
                let far = (1.0 / TAIL - 1.0).ln() / slope.abs();
                vec![inflection - far, inflection + far]
            }
        };
        knots.retain(|x| x.is_finite());
        knots.sort_by(f64::total_cmp);
        knots.dedup();
        knots
    }
}

/// Open ends are at infinity: there the flank is up already.
fn trapezoid([left, rise, fall, right]: [f64; 4], x: f64) -> f64 {
    if x < left || x > right {
        0.0
    } else if x < rise {
        if left == f64::NEG_INFINITY {
            1.0
        } else {
            (x - left) / (rise - left)
        }
    } else if x <= fall || right == f64::INFINITY {
        1.0
    } else {
        (right - x) / (right - fall)
    }
}

/// 0 at `from` and before it, 1 at `to` and behind it.
fn progress(from: f64, to: f64, x: f64) -> f64 {
    let t = (x - from) / (to - from);
    // Both ends exactly, whatever the division rounds to; an infinite x needs no other care.
    t.clamp(0.0, 1.0)
}

fn interpolated(points: &[(f64, f64)], x: f64) -> f64 {
    let behind = points.partition_point(|point| point.0 <= x);
    match (
        behind.checked_sub(1).and_then(|i| points.get(i)),
        points.get(behind),
    ) {
        (Some(&(x0, y0)), Some(&(x1, y1))) => y0 + (y1 - y0) * ((x - x0) / (x1 - x0)),
        (Some(&(_, last)), None) => last,
        (None, Some(&(_, first))) => first,
        (None, None) => 0.0,
    }
}

fn gaussian(mean: f64, deviation: f64, x: f64) -> f64 {
    (-(x - mean) * (x - mean) / (2.0 * deviation * deviation)).exp()
}

/// How many deviations from the mean the degree is `degree`.
fn gaussian_reach(degree: f64) -> f64 {
    (-2.0 * degree.ln()).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::random;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64Mcg;

    #[test]
    fn ends_steps_and_open_sides() {
        let upright = Shape::Triangle {
            left: 1.0,
            peak: 1.0,
            right: 3.0,
        };
        assert_eq!(
            [0.999, 1.0, 2.0, 3.0, 3.1].map(|x| upright.degree(x)),
            [0.0, 1.0, 0.5, 0.0, 0.0]
        );
        let open = Shape::Trapezoid {
            left: f64::NEG_INFINITY,
            rise: 0.0,
            fall: 1.0,
            right: 2.0,
        };
        assert_eq!(
            [-1e300, f64::NEG_INFINITY, 1.5, f64::INFINITY].map(|x| open.degree(x)),
            [1.0, 1.0, 0.5, 0.0]
        );
        let falling = Shape::Ramp { from: 4.0, to: 2.0 };
        assert_eq!(
            [1.0, 2.0, 3.0, 4.0, 5.0].map(|x| falling.degree(x)),
            [1.0, 1.0, 0.5, 0.0, 0.0]
        );
        let step = Shape::Points(vec![(0.0, 0.25), (1.0, 0.25), (1.0, 0.75), (2.0, 0.0)]);
        assert_eq!(
            [-9.0, 0.5, 1.0, 1.5, 9.0].map(|x| step.degree(x)),
            [0.25, 0.25, 0.75, 0.375, 0.0]
        );
        assert!(step.degree(f64::NAN).is_nan());
        assert_eq!(
            [0.9, 1.0].map(|x| Shape::Singleton(1.0).degree(x)),
            [0.0, 1.0]
        );
    }

    #[test]
    fn beside_a_jump_the_degree_is_another_on_each_side() {
        let points = |all: &[(f64, f64)]| Shape::Points(all.to_vec());
        let spike = points(&[(0.0, 0.25), (1.0, 0.25), (1.0, 1.0), (1.0, 0.5), (2.0, 0.0)]);
        assert_eq!(spike.beside(1.0), [0.25, 0.5]);
        assert_eq!(spike.beside(0.5), [0.25; 2]);
        let saw = points(&[(0.0, 0.0), (1.0, 1.0), (1.0, 0.0)]);
        assert_eq!((saw.degree(1.0), saw.beside(1.0)), (0.0, [1.0, 0.0]));
        let trapezoid = |left, rise, fall, right| Shape::Trapezoid {
            left,
            rise,
            fall,
            right,
        };
        assert_eq!(trapezoid(0.0, 0.0, 1.0, 1.0).beside(0.0), [0.0, 1.0]);
        assert_eq!(trapezoid(0.0, 0.0, 1.0, 1.0).beside(1.0), [1.0, 0.0]);
        assert_eq!(trapezoid(0.0, 1.0, 2.0, 4.0).beside(3.0), [0.5; 2]);
        assert_eq!(Shape::Singleton(1.0).beside(1.0), [0.0; 2]);
    }

    /// Between neighbouring knots every shape is monotone, and reach and fill stay as they are.
    #[test]
    fn nothing_turns_between_knots() {
        let mut rng = Pcg64Mcg::seed_from_u64(1);
        for _ in 0..400 {
            let shape = random::shape(&mut rng, &(-3.0..=5.0));
            let mut ends = shape.knots();
            ends.extend([-30.0, 50.0]);
            ends.sort_by(f64::total_cmp);
            for pair in ends.windows(2).filter(|pair| pair[1] - pair[0] > 1e-9) {
                let mut inside: Vec<f64> = (0..20)
                    .map(|_| pair[0] + (pair[1] - pair[0]) * rng.random_range(1e-6..1.0 - 1e-6))
                    .collect();
                inside.sort_by(f64::total_cmp);
                let degrees: Vec<f64> = inside.iter().map(|&x| shape.degree(x)).collect();
                assert!(degrees.iter().all(|d| (0.0..=1.0).contains(d)), "{shape:?}");
                assert!(
                    degrees.is_sorted_by(|a, b| *a <= *b + 1e-12)
                        || degrees.is_sorted_by(|a, b| *a >= *b - 1e-12),
                    "{shape:?} in {pair:?}: {degrees:?}"
                );
                for same in [Shape::reaches, Shape::fills] {
                    let first = same(&shape, inside[0]);
                    assert!(
                        inside.iter().all(|&x| same(&shape, x) == first),
                        "{shape:?} in {pair:?}"
                    );
                }
            }
        }
    }
}
