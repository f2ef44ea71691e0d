//! A corridor that goes up, aside, up, aside, … between two walls.

use super::{Options, arena, between};
use crate::bench::arena::Arena;
use crate::bench::worlds::wall::{RADIUS, walls};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

pub fn make(rng: &mut Pcg64Mcg, options: &Options) -> Arena {
    // Walls' discs reach into the corridor.
    let half = options.radius + RADIUS + between(rng, 0.05, 0.3);
    let mut middle = vec![[0.0, -1.0], [0.0, between(rng, 1.5, 2.5)]];
    let mut side = if rng.random::<bool>() { 1.0 } else { -1.0 };
    for _ in 0..rng.random_range(1..=3) {
        let [x, y] = middle[middle.len() - 1];
        let aside = side * between(rng, 2.0, 3.5);
        middle.push([x + aside, y]);
        middle.push([x + aside, y + between(rng, 2.0, 3.0)]);
        if rng.random::<f64>() < 0.5 {
            side = -side;
        }
    }
    let [x, y] = middle[middle.len() - 1];
    let mut circles = Vec::new();
    for offset in [half, -half] {
        circles.extend(walls(&beside(&middle, offset)));
    }
    circles.extend(walls(&[[-half, -1.0], [half, -1.0]]));
    arena(circles, [0.0, 0.0], [x, y + 1.0], options.radius)
}

/// A polyline of right angles, shifted to its left.
fn beside(line: &[[f64; 2]], offset: f64) -> Vec<[f64; 2]> {
    let left = |from: [f64; 2], to: [f64; 2]| {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let length = libm::hypot(dx, dy);
        [-dy / length * offset, dx / length * offset]
    };
    (0..line.len())
        .map(|k| {
            let before = (k > 0).then(|| left(line[k - 1], line[k]));
            let after = (k + 1 < line.len()).then(|| left(line[k], line[k + 1]));
            let shift = match (before, after) {
                // At a right angle both shifts add up to the corner's.
                (Some(a), Some(b)) if a != b => [a[0] + b[0], a[1] + b[1]],
                (Some(a), _) | (None, Some(a)) => a,
                (None, None) => [0.0; 2],
            };
            [line[k][0] + shift[0], line[k][1] + shift[1]]
        })
        .collect()
}
