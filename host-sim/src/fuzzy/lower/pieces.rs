//! Shapes as straight pieces.

use super::Format;
use crate::fuzzy::model::Shape;
use fixed::types::I16F16;
use fuzzypilot::fuzzy::system::shape::{bell, fill, gaussian, sigmoid, spline, two_sided_gaussian};
use fuzzypilot::fuzzy::system::{Degree, LIMIT, Piece};

/// Points of a curve with two flanks, and of one with one.
pub const TWO_FLANKS: usize = 65;
/// Of a two-sided curve: its peak has two ends.
pub const TWO_SIDES: usize = 66;
/// Of a curve with one flank.
pub const ONE_FLANK: usize = 49;

/// The finite numbers that a curved shape needs in its variable's format. Straight ones are cut where the format ends.
pub fn anchors(shape: &Shape) -> Vec<f64> {
    match *shape {
        Shape::Gaussian { mean, .. } => vec![mean],
        Shape::TwoSidedGaussian { left, right } => vec![left.0, right.0],
        Shape::Bell { centre, .. } => vec![centre],
        Shape::Sigmoid { inflection, .. } => vec![inflection],
        Shape::Spline { from, to } => vec![from, to],
        _ => Vec::new(),
    }
}

/// A shape's pieces.
pub fn pieces(shape: &Shape, format: Format) -> Vec<Piece> {
    let at = |x: f64| format.nearest(x);
    match *shape {
        Shape::Gaussian { mean, deviation } => {
            gaussian::<TWO_FLANKS>(at(mean), width(deviation, format)).to_vec()
        }
        Shape::TwoSidedGaussian { left, right } => two_sided_gaussian::<TWO_SIDES>(
            (at(left.0), width(left.1, format)),
            (at(right.0), width(right.1, format)),
        )
        .to_vec(),
        Shape::Bell {
            centre,
            width: half,
            slope,
        } => {
            let slope = I16F16::saturating_from_num(slope).max(I16F16::DELTA);
            bell::<TWO_FLANKS>(at(centre), width(half, format), slope).to_vec()
        }
        Shape::Sigmoid { inflection, slope } => {
            sigmoid::<ONE_FLANK>(at(inflection), width(1.0 / slope, format)).to_vec()
        }
        Shape::Spline { from, to } if at(from) != at(to) => {
            spline::<ONE_FLANK>(at(from), at(to)).to_vec()
        }
        _ => straight(&corners(shape), format),
    }
}

/// A width in steps, not zero, as the engine's curves take it.
fn width(width: f64, format: Format) -> i64 {
    const MOST: f64 = 1_099_511_627_776.0;
    let steps = format.steps(width).round().clamp(-MOST, MOST) as i64;
    match steps {
        0 if width < 0.0 => -1,
        0 => 1,
        steps => steps,
    }
}

/// A corner of a straight shape: where, how high, and whether it stands a step beside that place.
struct Corner {
    x: f64,
    degree: f64,
    beside: bool,
}

fn corner(x: f64, degree: f64) -> Corner {
    Corner {
        x,
        degree,
        beside: false,
    }
}

/// The corners of a straight shape, ascending.
fn corners(shape: &Shape) -> Vec<Corner> {
    match *shape {
        Shape::Triangle { left, peak, right } => trapezoid([left, peak, peak, right]),
        Shape::Trapezoid {
            left,
            rise,
            fall,
            right,
        } => trapezoid([left, rise, fall, right]),
        Shape::Ramp { from, to } | Shape::Spline { from, to } => {
            if from <= to {
                vec![corner(from, 0.0), corner(to, 1.0)]
            } else {
                vec![corner(to, 1.0), corner(from, 0.0)]
            }
        }
        Shape::Singleton(at) => trapezoid([at; 4]),
        Shape::Points(ref points) => points.iter().map(|&(x, d)| corner(x, d)).collect(),
        // Curved ones have none.
        _ => Vec::new(),
    }
}

/// A flank at infinity is none.
fn trapezoid([left, rise, fall, right]: [f64; 4]) -> Vec<Corner> {
    let mut corners = Vec::new();
    if left.is_finite() && rise.is_finite() {
        corners.extend([corner(left, 0.0), corner(rise, 1.0)]);
    }
    if right.is_finite() && fall.is_finite() {
        let beside = fall == right;
        corners.push(corner(fall, 1.0));
        corners.push(Corner {
            beside,
            ..corner(right, 0.0)
        });
    }
    if corners.is_empty() {
        corners.push(corner(0.0, 1.0));
    }
    corners
}

/// Rounded to steps, and cut where the format ends.
fn straight(corners: &[Corner], format: Format) -> Vec<Piece> {
    let limit = f64::from(LIMIT);
    let steps: Vec<(f64, f64)> = corners
        .iter()
        .map(|corner| {
            let x = format.steps(corner.x).round() + f64::from(u8::from(corner.beside));
            (x, corner.degree)
        })
        .collect();
    let mut inside: Vec<(i32, Degree)> = Vec::new();
    for (i, &(x, degree)) in steps.iter().enumerate() {
        if -limit <= x && x <= limit + 1.0 {
            inside.push((x as i32, self::degree(degree)));
        }
        // Where the line to the next one crosses an end.
        if let Some(&(next, then)) = steps.get(i + 1) {
            for end in [-limit, limit] {
                if x < end && end < next {
                    let share = (end - x) / (next - x);
                    inside.push((end as i32, self::degree(degree + share * (then - degree))));
                }
            }
        }
    }
    if inside.is_empty() {
        // All of it lies to one side.
        let last = steps.iter().rev().find(|(x, _)| *x < 0.0);
        let (_, flat) = last.or(steps.first()).copied().unwrap_or((0.0, 0.0));
        inside.push((0, degree(flat)));
    }
    let mut pieces = vec![Piece::default(); inside.len()];
    fill(&inside, &mut pieces);
    pieces
}

/// Rounded to nearest.
pub fn degree(degree: f64) -> Degree {
    Degree::from_bits((degree * f64::from(Degree::ONE.bits())).round() as u32)
}
