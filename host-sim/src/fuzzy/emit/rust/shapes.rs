//! Terms as calls of `fuzzypilot::fuzzy::system::shape`.

use crate::fuzzy::lower::{Format, ONE_FLANK, TWO_FLANKS, TWO_SIDES, width};
use crate::fuzzy::model::Shape;
use fixed::types::I16F16;
use fuzzypilot::fuzzy::system::{Piece, shape};

/// A call, and the pieces that it gives.
pub struct Call {
    /// The function.
    pub name: &'static str,
    /// The number of points, as it stands behind the name; empty for straight shapes.
    pub points: String,
    /// What is in parentheses.
    pub arguments: Vec<Argument>,
    /// What comes out.
    pub pieces: Vec<Piece>,
}

/// An argument.
pub enum Argument {
    /// A number of steps of the variable.
    Steps(i32),
    /// A flank of two: mean and width.
    Flank(i32, i64),
    /// Anything else.
    Text(String),
}

use Argument::{Flank, Steps, Text};

impl Call {
    /// The one that looks most like the shape. It may give other pieces than the design's, so compare.
    pub fn of(shape: &Shape, format: Format) -> Option<Self> {
        let at = |x: f64| format.nearest(x);
        let straight = |name, numbers: &[i32], pieces: Vec<Piece>| Self {
            name,
            points: String::new(),
            arguments: numbers.iter().map(|&steps| Steps(steps)).collect(),
            pieces,
        };
        let curve = |name, points: usize, arguments, pieces: Vec<Piece>| Self {
            name,
            points: format!("::<{points}>"),
            arguments,
            pieces,
        };
        Some(match *shape {
            Shape::Triangle { left, peak, right } => {
                let [l, p, r] = [left, peak, right].map(at);
                straight("triangle", &[l, p, r], shape::triangle(l, p, r).to_vec())
            }
            Shape::Trapezoid {
                left, fall, right, ..
            } if left == f64::NEG_INFINITY && right.is_finite() => {
                let [f, r] = [fall, right].map(at);
                straight("ramp", &[r, f], shape::ramp(r, f).to_vec())
            }
            Shape::Trapezoid {
                left, rise, right, ..
            } if right == f64::INFINITY && left.is_finite() => {
                let [l, r] = [left, rise].map(at);
                straight("ramp", &[l, r], shape::ramp(l, r).to_vec())
            }
            Shape::Trapezoid {
                left,
                rise,
                fall,
                right,
            } => {
                let [l, u, d, r] = [left, rise, fall, right].map(at);
                let pieces = shape::trapezoid(l, u, d, r).to_vec();
                straight("trapezoid", &[l, u, d, r], pieces)
            }
            Shape::Ramp { from, to } => {
                let [f, t] = [from, to].map(at);
                straight("ramp", &[f, t], shape::ramp(f, t).to_vec())
            }
            Shape::Singleton(x) => {
                straight("singleton", &[at(x)], shape::singleton(at(x)).to_vec())
            }
            Shape::Points(_) => return None,
            Shape::Gaussian { mean, deviation } => {
                let (mean, width) = (at(mean), width(deviation, format));
                curve(
                    "gaussian",
                    TWO_FLANKS,
                    vec![Steps(mean), Text(width.to_string())],
                    shape::gaussian::<TWO_FLANKS>(mean, width).to_vec(),
                )
            }
            Shape::TwoSidedGaussian { left, right } => {
                let [left, right] = [left, right].map(|(mean, s)| (at(mean), width(s, format)));
                curve(
                    "two_sided_gaussian",
                    TWO_SIDES,
                    vec![Flank(left.0, left.1), Flank(right.0, right.1)],
                    shape::two_sided_gaussian::<TWO_SIDES>(left, right).to_vec(),
                )
            }
            Shape::Bell {
                centre,
                width: half,
                slope,
            } => {
                let (centre, half) = (at(centre), width(half, format));
                let slope = I16F16::saturating_from_num(slope).max(I16F16::DELTA);
                curve(
                    "bell",
                    TWO_FLANKS,
                    vec![
                        Steps(centre),
                        Text(half.to_string()),
                        Text(format!(
                            "fixed::types::I16F16::from_bits({})",
                            slope.to_bits()
                        )),
                    ],
                    shape::bell::<TWO_FLANKS>(centre, half, slope).to_vec(),
                )
            }
            Shape::Sigmoid { inflection, slope } => {
                let (inflection, width) = (at(inflection), width(1.0 / slope, format));
                curve(
                    "sigmoid",
                    ONE_FLANK,
                    vec![Steps(inflection), Text(width.to_string())],
                    shape::sigmoid::<ONE_FLANK>(inflection, width).to_vec(),
                )
            }
            Shape::Spline { from, to } if at(from) != at(to) => {
                let [f, t] = [from, to].map(at);
                curve(
                    "spline",
                    ONE_FLANK,
                    vec![Steps(f), Steps(t)],
                    shape::spline::<ONE_FLANK>(f, t).to_vec(),
                )
            }
            Shape::Spline { .. } => return None,
        })
    }
}
