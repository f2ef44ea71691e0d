//! Where going straight ends: a U to back out of, a room without a door, and a corridor closed at both ends.

use super::{Options, arena, between};
use crate::bench::arena::Arena;
use crate::bench::worlds::wall::{RADIUS, walls};
use rand_pcg::Pcg64Mcg;

/// A U between start and goal, open towards the start.
pub fn u_trap(rng: &mut Pcg64Mcg, options: &Options) -> Arena {
    let half = options.radius + between(rng, 0.4, 1.2);
    let depth = between(rng, 1.0, 2.5);
    let back = between(rng, 4.5, 5.5);
    let aside = between(rng, -0.3, 0.3);
    let circles = walls(&[
        [aside - half, back - depth],
        [aside - half, back],
        [aside + half, back],
        [aside + half, back - depth],
    ]);
    arena(circles, [0.0, 0.0], [0.0, 8.0], options.radius)
}

/// Four walls around the start; the goal is outside.
pub fn sealed(rng: &mut Pcg64Mcg, options: &Options) -> Arena {
    let room = 2.0 * options.radius;
    let sides = std::array::from_fn(|_| room + between(rng, 0.2, 1.5));
    shut_in(sides, options)
}

/// A corridor around the start that is closed at both ends, 0.7 to 2 radii free to either side; the goal is outside.
pub fn closed(rng: &mut Pcg64Mcg, options: &Options) -> Arena {
    let half = RADIUS + options.radius * between(rng, 0.7, 2.0);
    let back = RADIUS + options.radius + between(rng, 0.0, 1.5);
    let front = RADIUS + options.radius + between(rng, 0.2, 3.5);
    shut_in([half, half, back, front], options)
}

/// Walls this far to the left, to the right, behind and ahead of the start.
fn shut_in([left, right, back, front]: [f64; 4], options: &Options) -> Arena {
    let circles = walls(&[
        [-left, -back],
        [right, -back],
        [right, front],
        [-left, front],
        [-left, -back],
    ]);
    let mut arena = arena(circles, [0.0, 0.0], [0.0, 8.0], options.radius);
    arena.sealed = true;
    arena
}
