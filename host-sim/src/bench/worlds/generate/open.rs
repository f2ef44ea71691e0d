//! Worlds without walls: gates, trunks, and what crosses.

use super::{Options, arena, between};
use crate::bench::arena::{Arena, Circle, Mover};
use crate::bench::worlds::wall::walls;
use rand::RngExt;
use rand_pcg::Pcg64Mcg;

/// Length of the way, m.
const LENGTH: f64 = 10.0;

/// Half the width of the ground, m.
const HALF: f64 = 2.5;

/// Walls from the left and the right in turn leave a gate at the other side.
pub fn slalom(rng: &mut Pcg64Mcg, options: &Options) -> Arena {
    let gate = 2.0 * options.radius + 0.3;
    let mut circles = walls(&[[-HALF, -1.0], [-HALF, LENGTH]]);
    circles.extend(walls(&[[HALF, -1.0], [HALF, LENGTH]]));
    let mut side = if rng.random::<bool>() { 1.0 } else { -1.0 };
    let mut y = between(rng, 1.2, 2.0);
    while y < LENGTH - 1.5 {
        let open = gate + between(rng, 0.0, 0.8);
        circles.extend(walls(&[[side * HALF, y], [side * (open - HALF), y]]));
        side = -side;
        y += gate + between(rng, 0.4, 1.0);
    }
    arena(circles, [0.0, 0.0], [0.0, LENGTH], options.radius)
}

/// Trunks so far apart that a disc of the radius passes between any two.
pub fn forest(rng: &mut Pcg64Mcg, options: &Options) -> Arena {
    let circles = trunks(rng, 400, 2.0 * options.radius);
    arena(circles, [0.0, 0.0], [0.0, LENGTH], options.radius)
}

/// A light forest, and five discs that go to and fro across the way.
pub fn moving(rng: &mut Pcg64Mcg, options: &Options) -> Arena {
    let circles = trunks(rng, 12, 4.0 * options.radius);
    let mut arena = arena(circles, [0.0, 0.0], [0.0, LENGTH], options.radius);
    arena.movers = (0..5)
        .map(|k| {
            let y = 2.0 + 1.4 * f64::from(k) + between(rng, -0.3, 0.3);
            let side = if rng.random::<bool>() { 1.0 } else { -1.0 };
            Mover {
                from: [side * between(rng, 1.0, HALF), y],
                to: [-side * between(rng, 1.0, HALF), y + between(rng, -0.5, 0.5)],
                speed: between(rng, 0.2, 0.6),
                radius: between(rng, 0.1, 0.25),
            }
        })
        .collect();
    arena
}

/// Thrown at random, kept where the gap to all others is wide enough and start and goal stay free.
fn trunks(rng: &mut Pcg64Mcg, throws: usize, gap: f64) -> Vec<Circle> {
    let mut kept: Vec<Circle> = Vec::new();
    for _ in 0..throws {
        let thrown = Circle {
            at: [between(rng, -HALF, HALF), between(rng, 0.0, LENGTH)],
            radius: between(rng, 0.05, 0.25),
        };
        let far = |at: [f64; 2], gap: f64| {
            libm::hypot(thrown.at[0] - at[0], thrown.at[1] - at[1]) - thrown.radius > gap
        };
        let free = far([0.0, 0.0], 0.8)
            && far([0.0, LENGTH], 0.8)
            && kept.iter().all(|c| far(c.at, gap + c.radius));
        if free {
            kept.push(thrown);
        }
    }
    kept
}
