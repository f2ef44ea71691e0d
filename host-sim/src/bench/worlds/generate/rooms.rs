//! Rooms in a row; the doors lie anywhere in the walls between them.

use super::{Options, arena, between};
use crate::bench::arena::{Arena, Circle};
use crate::bench::worlds::wall::{RADIUS, wall, walls};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

const ROOMS: usize = 4;

pub fn make(rng: &mut Pcg64Mcg, options: &Options) -> Arena {
    let half = between(rng, 2.0, 3.0);
    let depths: [f64; ROOMS] = std::array::from_fn(|_| between(rng, 2.5, 3.5));
    let length: f64 = depths.iter().sum();
    let mut circles = walls(&[
        [-half, 0.0],
        [half, 0.0],
        [half, length],
        [-half, length],
        [-half, 0.0],
    ]);
    let door = options.radius + RADIUS + 0.05;
    let mut y = 0.0;
    for depth in &depths[..ROOMS - 1] {
        y += depth;
        let opening = door + between(rng, 0.0, 0.15);
        let at = between(rng, -half + 0.3 + opening, half - 0.3 - opening);
        circles.extend(wall([-half, y], [at - opening, y]));
        circles.extend(wall([at + opening, y], [half, y]));
    }
    // Furniture in the middle of the inner rooms, where it leaves a way all around; the others hold start and goal.
    let mut y = depths[0];
    for depth in &depths[1..ROOMS - 1] {
        let radius = between(rng, 0.1, 0.3);
        let at = [between(rng, -0.3, 0.3), y + depth / 2.0];
        let fits = depth / 2.0 - radius > 2.0 * options.radius + RADIUS;
        if fits && rng.random::<f64>() < 0.6 {
            circles.push(Circle { at, radius });
        }
        y += depth;
    }
    arena(circles, [0.0, 1.0], [0.0, length - 1.0], options.radius)
}
