//! A window of certainty values around the robot, filled from range readings.
//!
//! Source: J. Borenstein, Y. Koren, *Histogramic In-Motion Mapping for Mobile Robot Obstacle Avoidance*, IEEE
//! Transactions on Robotics and Automation 7(4), 1991: an echo raises the cell on the sensor's axis by 3, the cells
//! before it fall by 1, values stay between 0 and 15.

use crate::bench::navigator::Inputs;
use crate::recording::BeamView;
use crate::si;
use fuzzypilot::ports::Range;

/// Edge of a cell, m.
pub const CELL: f64 = 0.1;

/// Cells along the window's edge.
pub const CELLS: i32 = 64;

/// Highest certainty.
pub const MOST: u8 = 15;

const RISE: u8 = 3;

#[derive(Clone, Copy, Debug, Default)]
struct Cell {
    /// The cell of the plane that this one stands for.
    column: i32,
    row: i32,
    certainty: u8,
}

/// The window; what leaves it is forgotten.
#[derive(Clone, Debug)]
pub struct Certainty {
    cells: Vec<Cell>,
}

impl Default for Certainty {
    fn default() -> Self {
        Self {
            cells: vec![Cell::default(); (CELLS * CELLS) as usize],
        }
    }
}

impl Certainty {
    /// Takes a tick's readings in.
    pub fn observe(&mut self, sensors: &[BeamView], inputs: &Inputs<'_>) {
        let [x, y, heading] = inputs.pose;
        let (sin, cos) = libm::sincos(heading);
        let window = f64::from(CELLS) * CELL / 2.0 - CELL;
        for (sensor, reading) in sensors.iter().zip(inputs.ranges) {
            let (range, hit) = match reading.range {
                Range::Echo(range) => (si::from_metres(range), true),
                Range::Clear => (sensor.max_range, false),
                Range::Invalid(_) => continue,
            };
            let at = [
                x + sensor.x * cos - sensor.y * sin,
                y + sensor.x * sin + sensor.y * cos,
            ];
            let (s, c) = libm::sincos(heading + sensor.heading);
            let end = (range - CELL).min(window);
            let steps = (end / CELL).max(0.0) as i32;
            for k in 0..steps {
                let far = f64::from(k) * CELL;
                let cell = self.cell([at[0] + far * c, at[1] + far * s]);
                cell.certainty = cell.certainty.saturating_sub(1);
            }
            if hit && range < window {
                let cell = self.cell([at[0] + range * c, at[1] + range * s]);
                cell.certainty = (cell.certainty + RISE).min(MOST);
            }
        }
    }

    fn cell(&mut self, at: [f64; 2]) -> &mut Cell {
        let column = (at[0] / CELL).floor() as i32;
        let row = (at[1] / CELL).floor() as i32;
        let index = row.rem_euclid(CELLS) * CELLS + column.rem_euclid(CELLS);
        let cell = &mut self.cells[index as usize];
        if (cell.column, cell.row) != (column, row) {
            *cell = Cell {
                column,
                row,
                certainty: 0,
            };
        }
        cell
    }

    /// Cells above zero within `reach` of a place: offset from there in odometry's axes, m, and certainty.
    pub fn occupied(&self, [x, y]: [f64; 2], reach: f64) -> impl Iterator<Item = ([f64; 2], u8)> {
        self.cells.iter().filter_map(move |cell| {
            if cell.certainty == 0 {
                return None;
            }
            let middle = |k: i32| (f64::from(k) + 0.5) * CELL;
            let (dx, dy) = (middle(cell.column) - x, middle(cell.row) - y);
            (dx * dx + dy * dy <= reach * reach).then_some(([dx, dy], cell.certainty))
        })
    }
}
