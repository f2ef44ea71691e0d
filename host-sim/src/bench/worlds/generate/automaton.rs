//! The benchmark's way of making worlds (Perille et al. 2020, section III): cells filled at random, smoothed by a
//! cellular automaton, every filled cell a cylinder. Where it leaves no way for the asked radius, the cells along the
//! way that costs the fewest of them are cleared.

use super::{Options, arena, between};
use crate::bench::arena::{Arena, Circle};
use crate::bench::worlds::wall::{RADIUS, row};
use rand::RngExt;
use rand_pcg::Pcg64Mcg;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Cells along the field's edge.
const CELLS: usize = 30;

/// Edge of a cell, m.
const CELL: f64 = 0.15;

/// Lower left corner of the field, m; the frame is the benchmark's.
const CORNER: [f64; 2] = [-4.5, 5.0];

type Field = [[bool; CELLS]; CELLS];

pub fn make(rng: &mut Pcg64Mcg, options: &Options) -> Arena {
    let drawn_fill = between(rng, 0.15, 0.3);
    let drawn_smooth = rng.random_range(2..=4);
    let fill = options.fill.unwrap_or(drawn_fill);
    let mut field: Field =
        std::array::from_fn(|_| std::array::from_fn(|_| rng.random::<f64>() < fill));
    for _ in 0..options.smooth.unwrap_or(drawn_smooth) {
        field = smoothed(&field);
    }
    clear_a_way(&mut field, options.radius);

    let mut circles = Vec::new();
    for (k, line) in field.iter().enumerate() {
        for (i, _) in line.iter().enumerate().filter(|(_, filled)| **filled) {
            circles.push(Circle {
                at: centre(k, i),
                radius: RADIUS,
            });
        }
    }
    // Behind and beside the robot, as in the benchmark.
    let (left, right, back, front) = (-4.425, -0.075, 0.075, 9.525);
    for [from, to] in [
        [[left, back], [left, front]],
        [[right, back], [right, front]],
        [[left, back], [right, back]],
    ] {
        circles.extend(row(from, to, RADIUS));
    }
    let mut arena = arena(circles, [-2.25, 3.0], [-2.25, 13.0], options.radius);
    arena.goal_radius = 1.0;
    arena
}

fn centre(row: usize, column: usize) -> [f64; 2] {
    [
        CORNER[0] + (column as f64 + 0.5) * CELL,
        CORNER[1] + (row as f64 + 0.5) * CELL,
    ]
}

/// A cell with five filled neighbours or more is filled, one with one or none is cleared; the rim counts as clear.
fn smoothed(field: &Field) -> Field {
    std::array::from_fn(|row| {
        std::array::from_fn(|column| {
            let filled = neighbours(row, column)
                .filter(|&(r, c)| field[r][c])
                .count();
            match filled {
                5.. => true,
                0..=1 => false,
                _ => field[row][column],
            }
        })
    })
}

fn neighbours(row: usize, column: usize) -> impl Iterator<Item = (usize, usize)> {
    (0..9)
        .filter(|k| *k != 4)
        .map(move |k| (row + k / 3, column + k % 3))
        .filter(|&(r, c)| (1..=CELLS).contains(&r) && (1..=CELLS).contains(&c))
        .map(|(r, c)| (r - 1, c - 1))
}

/// Clears what is within the radius of the way from the field's near edge to its far one that takes the least clearing
/// (Dijkstra; a step is one, every cell to clear a hundred).
fn clear_a_way(field: &mut Field, radius: f64) {
    let reach = radius + RADIUS + CELL / 2.0;
    let in_reach = |row: usize, column: usize| {
        let [x, y] = centre(row, column);
        (0..CELLS * CELLS)
            .map(|k| (k / CELLS, k % CELLS))
            .filter(move |&(r, c)| {
                let [u, v] = centre(r, c);
                (u - x) * (u - x) + (v - y) * (v - y) < reach * reach
            })
    };
    // The walls cannot be cleared: columns too near to them are no way.
    let margin = (reach / CELL).ceil() as usize;
    let usable = margin.min(CELLS / 2 - 1)..CELLS - margin.min(CELLS / 2 - 1);
    let price = |row: usize, column: usize| {
        1 + 100 * in_reach(row, column).filter(|&(r, c)| field[r][c]).count()
    };
    let mut cost = vec![usize::MAX; CELLS * CELLS];
    let mut from = vec![usize::MAX; CELLS * CELLS];
    let mut open = BinaryHeap::new();
    for column in usable.clone() {
        cost[column] = price(0, column);
        open.push(Reverse((cost[column], column)));
    }
    let mut last = usize::MAX;
    while let Some(Reverse((so_far, cell))) = open.pop() {
        let (row, column) = (cell / CELLS, cell % CELLS);
        if row == CELLS - 1 {
            last = cell;
            break;
        }
        for (r, c) in neighbours(row, column).filter(|(_, c)| usable.contains(c)) {
            let next = r * CELLS + c;
            let total = so_far + price(r, c);
            if total < cost[next] {
                (cost[next], from[next]) = (total, cell);
                open.push(Reverse((total, next)));
            }
        }
    }
    let mut way = Vec::new();
    while last != usize::MAX {
        way.push((last / CELLS, last % CELLS));
        last = from[last];
    }
    for (row, column) in way {
        let near: Vec<_> = in_reach(row, column).collect();
        for (r, c) in near {
            field[r][c] = false;
        }
    }
}
