//! The field's grid: 32 rows of 32 square cells around the place of the robot when the field was begun, a word a row, and
//! what its cells cost.

use crate::geometry::Point;
use crate::navigate::steps::{Steps, Vector};
use crate::units::Metres;

/// Cells in a row: the bits of a word.
pub(super) const COLUMNS: usize = 32;
/// Rows. 24 are enough for what lies ahead, but with them the robot gets out of half as many traps.
pub(super) const ROWS: usize = 32;
/// Column and row of the robot's cell.
pub(super) const MIDDLE: (usize, usize) = (COLUMNS / 2, ROWS / 2);
/// A cell's side.
pub(super) const CELL: Steps = Steps::lit("0.18");
/// The same in metres.
pub(super) const CELL_METRES: Metres = Metres::lit("0.18");
/// Steps to cells, 24 fractional bits.
const PER_CELL: i32 = ((1 << 24) + CELL.bits() - 1) / CELL.bits();

/// What a cell may cost, beside a free one: 1½, 3, 9, and what the settings say of a wall.
pub(super) const LEVELS: usize = 4;
/// The levels of a halo's outer and inner part, and of a wall.
pub(super) const OUTER: usize = 0;
pub(super) const INNER: usize = 1;
pub(super) const WALL: usize = 3;

/// The cells of a row that cost as much as a level says, or more.
pub(super) type Row = [u32; LEVELS];

/// What the cells cost.
pub(super) type Ground = [Row; ROWS];

/// Where the grid lies in the world.
#[derive(Clone, Copy, Debug)]
pub(super) struct Frame {
    /// Corner of the first cell.
    corner: Point,
    /// Columns run along y and rows along x, else the other way round.
    swapped: bool,
}

impl Frame {
    pub const NONE: Self = Self {
        corner: Point::new(Metres::ZERO, Metres::ZERO),
        swapped: false,
    };

    /// Around the robot, with its rows in the order in which a wave from the carrot comes to them: in few of them at once.
    pub fn around(robot: Point, carrot: Point) -> Self {
        const fn half(cells: usize) -> Steps {
            Steps::from_bits(CELL.bits() * cells as i32 + CELL.bits() / 2)
        }
        let off = carrot - robot;
        let frame = Self {
            corner: robot,
            swapped: off.x.abs() > off.y.abs(),
        };
        let back = const { Vector::new(half(MIDDLE.0), half(MIDDLE.1)) };
        Self {
            corner: frame.to_world(Vector::ZERO - back),
            ..frame
        }
    }

    /// Axes of the world to those of the grid, and back.
    pub fn axes<T>(&self, x: T, y: T) -> (T, T) {
        if self.swapped { (y, x) } else { (x, y) }
    }

    /// A place seen from the first cell's corner: columns, rows.
    pub fn to_grid(self, world: Point) -> Vector {
        let off = Vector::of(world - self.corner);
        let (x, y) = self.axes(off.x, off.y);
        Vector::new(x, y)
    }

    pub fn to_world(self, place: Vector) -> Point {
        let (x, y) = self.axes(place.x, place.y);
        self.corner + Vector::new(x, y).point()
    }
}

/// A cell, column and row.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Cell {
    pub column: u8,
    pub row: u8,
}

/// The robot's.
pub(super) const MIDDLE_CELL: Cell = Cell {
    column: MIDDLE.0 as u8,
    row: MIDDLE.1 as u8,
};

impl Cell {
    /// Column and row, if the grid has them.
    pub fn within(column: i32, row: i32) -> Option<Self> {
        let inside = |i: i32, end: usize| (0..end as i32).contains(&i);
        (inside(column, COLUMNS) && inside(row, ROWS)).then_some(Self {
            column: column as u8,
            row: row as u8,
        })
    }

    /// Its middle from the first cell's corner.
    pub fn middle(self) -> Vector {
        middle(self.column.into(), self.row.into())
    }

    /// From its middle to a neighbour's.
    pub fn length_to(self, next: Self) -> Steps {
        if self.column != next.column && self.row != next.row {
            const { Steps::from_bits((CELL.bits() * 1448) >> 10) }
        } else {
            CELL
        }
    }
}

/// Column and row of a place seen from the first cell's corner; they may lie outside.
pub(super) fn cell_of(place: Vector) -> (i32, i32) {
    let (column, row) = quarters_of(place);
    (column >> 2, row >> 2)
}

/// The same in quarters of a cell.
pub(super) fn quarters_of(place: Vector) -> (i32, i32) {
    // ±2^15 steps by 2^15: it fits.
    let quarters = |steps: Steps| steps.bits().wrapping_mul(PER_CELL) >> 22;
    (quarters(place.x), quarters(place.y))
}

/// A cell's middle from the corner.
pub(super) fn middle(column: i32, row: i32) -> Vector {
    let along = |i: i32| Steps::from_bits(CELL.bits().wrapping_mul(i)) + CELL.half();
    Vector::new(along(column), along(row))
}
