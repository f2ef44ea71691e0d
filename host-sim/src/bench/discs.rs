//! Circles binned in a grid, so that a tick looks only at those nearby.

use super::arena::Circle;

/// Edge of a cell, m: a quarter of the usual sensor's reach.
const CELL: f64 = 1.0;

/// Most cells along an edge; larger worlds get larger cells.
const MOST_CELLS: f64 = 256.0;

/// Circles that stand still, found by place.
#[derive(Clone, Debug)]
pub struct Discs {
    circles: Vec<Circle>,
    /// Lower left corner of the grid, m.
    origin: [f64; 2],
    cell: f64,
    columns: usize,
    rows: usize,
    /// `circles[starts[c]..starts[c + 1]]` have their centre in cell `c`, row by row.
    starts: Vec<usize>,
    largest: f64,
}

impl Discs {
    /// Bins circles by their centres.
    pub fn new(circles: &[Circle]) -> Self {
        let least = |k: usize| {
            circles
                .iter()
                .map(|c| c.at[k])
                .fold(f64::INFINITY, f64::min)
        };
        let most = |k: usize| {
            circles
                .iter()
                .map(|c| c.at[k])
                .fold(f64::NEG_INFINITY, f64::max)
        };
        let (origin, far) = if circles.is_empty() {
            ([0.0; 2], [0.0; 2])
        } else {
            ([least(0), least(1)], [most(0), most(1)])
        };
        let span = (far[0] - origin[0]).max(far[1] - origin[1]);
        let cell = CELL.max(span / MOST_CELLS);
        let columns = ((far[0] - origin[0]) / cell) as usize + 1;
        let rows = ((far[1] - origin[1]) / cell) as usize + 1;
        let cell_of = |c: &Circle| {
            let column = ((c.at[0] - origin[0]) / cell) as usize;
            let row = ((c.at[1] - origin[1]) / cell) as usize;
            row.min(rows - 1) * columns + column.min(columns - 1)
        };
        let mut sorted: Vec<(usize, Circle)> = circles.iter().map(|c| (cell_of(c), *c)).collect();
        sorted.sort_by_key(|(cell, _)| *cell);
        let mut starts = vec![0; columns * rows + 1];
        for (cell, _) in &sorted {
            starts[cell + 1] += 1;
        }
        for cell in 0..columns * rows {
            starts[cell + 1] += starts[cell];
        }
        Self {
            largest: circles.iter().map(|c| c.radius).fold(0.0, f64::max),
            circles: sorted.into_iter().map(|(_, c)| c).collect(),
            origin,
            cell,
            columns,
            rows,
            starts,
        }
    }

    /// Appends every circle that comes within `reach` of a point to `found`, and perhaps a few more.
    pub fn near(&self, at: [f64; 2], reach: f64, found: &mut Vec<Circle>) {
        let reach = reach + self.largest;
        let range = |k: usize, cells: usize| {
            let first = (at[k] - reach - self.origin[k]) / self.cell;
            let last = (at[k] + reach - self.origin[k]) / self.cell;
            // A cast saturates, so a query from far outside gives an empty or a bordering range.
            (last >= 0.0).then(|| (first.max(0.0) as usize)..=(last as usize).min(cells - 1))
        };
        let (Some(columns), Some(rows)) = (range(0, self.columns), range(1, self.rows)) else {
            return;
        };
        if columns.is_empty() {
            return;
        }
        for row in rows {
            let first = self.starts[row * self.columns + columns.start()];
            let last = self.starts[row * self.columns + columns.end() + 1];
            found.extend(self.circles[first..last].iter().filter(|c| {
                let (dx, dy) = (c.at[0] - at[0], c.at[1] - at[1]);
                dx * dx + dy * dy <= reach * reach
            }));
        }
    }
}
