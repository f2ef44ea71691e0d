//! A way through discs for a disc: shortest on a grid (Dijkstra), then pulled straight.

use crate::bench::arena::Circle;
use crate::bench::discs::Discs;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Edge of a cell, m.
const CELL: f64 = 0.1;

/// Room around everything that a way may use, m.
const MARGIN: f64 = 2.0;

/// Most cells of a grid; larger worlds get larger cells.
const MOST_CELLS: f64 = 1.0e6;

/// Free and taken cells for a disc of some radius.
struct Grid {
    origin: [f64; 2],
    cell: f64,
    columns: usize,
    rows: usize,
    free: Vec<bool>,
}

/// The way of a disc's centre from `start` to within `near` of `goal`, and on to the goal; none if there is none. The
/// start counts as free.
pub fn route(
    circles: &[Circle],
    radius: f64,
    start: [f64; 2],
    goal: [f64; 2],
    near: f64,
) -> Option<Vec<[f64; 2]>> {
    let grid = Grid::new(circles, radius, [start, goal]);
    let cells = grid.shortest(start, goal, near)?;
    let mut points = vec![start];
    points.extend(cells.into_iter().map(|cell| grid.centre(cell)));
    points.push(goal);
    Some(straightened(&points, circles, radius))
}

impl Grid {
    fn new(circles: &[Circle], radius: f64, ends: [[f64; 2]; 2]) -> Self {
        let places = || circles.iter().map(|c| c.at).chain(ends);
        let least = |k: usize| places().map(|p| p[k]).fold(f64::INFINITY, f64::min) - MARGIN;
        let most = |k: usize| places().map(|p| p[k]).fold(f64::NEG_INFINITY, f64::max) + MARGIN;
        let origin = [least(0), least(1)];
        let span = [most(0) - origin[0], most(1) - origin[1]];
        let cell = CELL.max((span[0] * span[1] / MOST_CELLS).sqrt());
        let columns = (span[0] / cell) as usize + 1;
        let rows = (span[1] / cell) as usize + 1;
        let mut grid = Self {
            origin,
            cell,
            columns,
            rows,
            free: vec![true; columns * rows],
        };
        for circle in circles {
            grid.take(circle, radius);
        }
        grid
    }

    /// Marks the cells whose centre a disc of `radius` cannot be at.
    fn take(&mut self, circle: &Circle, radius: f64) {
        let reach = circle.radius + radius;
        let range = |k: usize, cells: usize| {
            let first = ((circle.at[k] - reach - self.origin[k]) / self.cell).max(0.0) as usize;
            let last = ((circle.at[k] + reach - self.origin[k]) / self.cell) as usize;
            first..=last.min(cells - 1)
        };
        for row in range(1, self.rows) {
            for column in range(0, self.columns) {
                let cell = row * self.columns + column;
                let [x, y] = self.centre(cell);
                let (dx, dy) = (x - circle.at[0], y - circle.at[1]);
                if dx * dx + dy * dy < reach * reach {
                    self.free[cell] = false;
                }
            }
        }
    }

    fn centre(&self, cell: usize) -> [f64; 2] {
        let (row, column) = (cell / self.columns, cell % self.columns);
        [
            self.origin[0] + (column as f64 + 0.5) * self.cell,
            self.origin[1] + (row as f64 + 0.5) * self.cell,
        ]
    }

    fn cell_of(&self, at: [f64; 2]) -> usize {
        let index = |k: usize, cells: usize| {
            (((at[k] - self.origin[k]) / self.cell).max(0.0) as usize).min(cells - 1)
        };
        index(1, self.rows) * self.columns + index(0, self.columns)
    }

    /// Dijkstra over eight neighbours, in whole steps of a thousandth of a cell: ties are broken the same everywhere.
    fn shortest(&self, start: [f64; 2], goal: [f64; 2], near: f64) -> Option<Vec<usize>> {
        const STRAIGHT: u64 = 1000;
        const DIAGONAL: u64 = 1414;
        let first = self.cell_of(start);
        let at_goal = |cell: usize| {
            let [x, y] = self.centre(cell);
            let (dx, dy) = (x - goal[0], y - goal[1]);
            dx * dx + dy * dy <= near * near || cell == self.cell_of(goal)
        };
        let mut cost = vec![u64::MAX; self.free.len()];
        let mut from = vec![usize::MAX; self.free.len()];
        let mut open = BinaryHeap::from([Reverse((0, first))]);
        cost[first] = 0;
        while let Some(Reverse((so_far, cell))) = open.pop() {
            if so_far > cost[cell] {
                continue;
            }
            if at_goal(cell) {
                let mut way = vec![cell];
                let mut back = cell;
                while from[back] != usize::MAX {
                    back = from[back];
                    way.push(back);
                }
                way.reverse();
                return Some(way);
            }
            let (row, column) = (cell / self.columns, cell % self.columns);
            for (down, left) in (0..9).map(|k| (k / 3, k % 3)).filter(|d| *d != (1, 1)) {
                let (next_row, next_column) = (row + down, column + left);
                if next_row == 0
                    || next_column == 0
                    || next_row > self.rows
                    || next_column > self.columns
                {
                    continue;
                }
                let next = (next_row - 1) * self.columns + next_column - 1;
                let step = if down == 1 || left == 1 {
                    STRAIGHT
                } else {
                    DIAGONAL
                };
                if self.free[next] && so_far + step < cost[next] {
                    cost[next] = so_far + step;
                    from[next] = cell;
                    open.push(Reverse((so_far + step, next)));
                }
            }
        }
        None
    }
}

/// Leaves out points between which the straight line is as free.
fn straightened(points: &[[f64; 2]], circles: &[Circle], radius: f64) -> Vec<[f64; 2]> {
    let discs = Discs::new(circles);
    let mut kept = vec![points[0]];
    let mut from = 0;
    while from + 1 < points.len() {
        let mut to = from + 1;
        while to + 1 < points.len() && sees(&discs, radius, points[from], points[to + 1]) {
            to += 1;
        }
        kept.push(points[to]);
        from = to;
    }
    kept
}

/// Whether a disc of `radius` can go straight from one point to another.
fn sees(discs: &Discs, radius: f64, from: [f64; 2], to: [f64; 2]) -> bool {
    let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
    let length = libm::hypot(dx, dy);
    let steps = (length / (CELL / 2.0)).ceil().max(1.0);
    let mut near = Vec::new();
    (0..=steps as usize).all(|k| {
        let share = k as f64 / steps;
        let at = [from[0] + share * dx, from[1] + share * dy];
        near.clear();
        discs.near(at, radius, &mut near);
        near.iter().all(|c| {
            let (cx, cy) = (c.at[0] - at[0], c.at[1] - at[1]);
            let reach = c.radius + radius;
            cx * cx + cy * cy >= reach * reach
        })
    })
}
