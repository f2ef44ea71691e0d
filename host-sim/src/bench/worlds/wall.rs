//! Walls as rows of discs, the only thing that arenas are made of.

use crate::bench::arena::Circle;

/// Radius of a wall's discs, m: the benchmark's cylinders.
pub const RADIUS: f64 = 0.075;

/// Discs side by side from one point to another, both included, at most a radius apart: bumps of a centimetre, no gaps.
pub fn row(from: [f64; 2], to: [f64; 2], radius: f64) -> Vec<Circle> {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let steps = (libm::hypot(dx, dy) / radius).ceil().max(1.0);
    (0..=steps as usize)
        .map(|k| {
            let share = k as f64 / steps;
            Circle {
                at: [from[0] + share * dx, from[1] + share * dy],
                radius,
            }
        })
        .collect()
}

/// A row with the usual radius.
pub fn wall(from: [f64; 2], to: [f64; 2]) -> Vec<Circle> {
    row(from, to, RADIUS)
}

/// Walls along a polyline.
pub fn walls(corners: &[[f64; 2]]) -> Vec<Circle> {
    corners.windows(2).flat_map(|w| wall(w[0], w[1])).collect()
}
