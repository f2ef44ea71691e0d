//! The field's grid: 32 × 32 square cells around the place of the robot when the field was begun.

use crate::navigate::steps::{Steps, Vector};
use crate::units::Metres;

/// Cells along a side.
pub(super) const SIDE: usize = 32;
/// Column and row of the robot's cell.
pub(super) const MIDDLE: usize = SIDE / 2;
/// The same as one number.
pub(super) const MIDDLE_CELL: u16 = cell(MIDDLE, MIDDLE) as u16;
/// Cells in all.
pub(super) const CELLS: usize = SIDE * SIDE;
/// A cell's side.
pub(super) const CELL: Steps = Steps::lit("0.18");
/// The same in metres.
pub(super) const CELL_METRES: Metres = Metres::lit("0.18");
/// Steps to cells, 24 fractional bits.
const PER_CELL: i32 = ((1 << 24) + CELL.bits() - 1) / CELL.bits();
/// Cost of a free cell, as a factor with two fractional bits.
pub(super) const FREE: u8 = 4;

/// Column, row, diagonal.
pub(super) static NEIGHBOURS: [(i32, i32, bool); 8] = [
    (1, 0, false),
    (0, 1, false),
    (-1, 0, false),
    (0, -1, false),
    (1, 1, true),
    (-1, 1, true),
    (-1, -1, true),
    (1, -1, true),
];

/// Cost of a step: its length, times the mean of both cells' factors.
pub(super) fn step_cost(here: u8, there: u8, diagonal: bool) -> u16 {
    let sum = u16::from(here).wrapping_add(there.into());
    // Two fractional bits each: a free step is 16, a diagonal one 23.
    if diagonal {
        sum.wrapping_mul(45).wrapping_add(8) >> 4
    } else {
        sum.wrapping_mul(2)
    }
}

/// A cell of the grid by its column and row: always one.
pub(super) const fn cell(column: usize, row: usize) -> usize {
    (row & (SIDE - 1)) << 5 | (column & (SIDE - 1))
}

/// A cell by its column and row, if there is one.
pub(super) fn index(column: i32, row: i32) -> Option<usize> {
    let inside = |i: i32| (0..SIDE as i32).contains(&i);
    (inside(column) && inside(row)).then_some((row as usize) << 5 | column as usize)
}

/// Column and row of a place seen from the first cell's corner; they may lie outside.
pub(super) fn cell_of(place: Vector) -> (i32, i32) {
    // ±2^15 steps by 2^15: it fits.
    let cell = |steps: Steps| steps.bits().wrapping_mul(PER_CELL) >> 24;
    (cell(place.x), cell(place.y))
}

/// A cell's middle from the corner.
pub(super) fn middle(column: i32, row: i32) -> Vector {
    let along = |i: i32| Steps::from_bits(CELL.bits().wrapping_mul(i)) + CELL.half();
    Vector::new(along(column), along(row))
}

/// From a cell's middle to a neighbour's.
pub(super) fn length(from: u16, to: u16) -> Steps {
    let apart = from ^ to;
    let aslant = apart & (SIDE as u16 - 1) != 0 && apart >> 5 != 0;
    Steps::from_bits(if aslant {
        CELL.bits().wrapping_mul(1448) >> 10
    } else {
        CELL.bits()
    })
}
