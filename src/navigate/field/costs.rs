//! What a cell costs: dear near a remembered point, dearer where the robot got stuck, never forbidden.

use super::FieldParams;
use super::grid::{CELL, CELLS, FREE, SIDE, cell, cell_of, index, middle};
use crate::geometry::{Point, square};
use crate::navigate::steps::{Steps, Vector, retain};
use crate::units::Metres;
use fixed::types::I16F16;
use heapless::Vec;

/// Cell costs by the square of the distance to a point, 2¹⁶ squares of a step an entry.
#[derive(Clone, Debug)]
pub struct Costs {
    by_square: [u8; 64],
    /// Cells that a point can reach to either side.
    cells: i32,
}

/// Squares of a step in an entry, as a power of two: 64 entries are 0.5 m.
const SQUARES: u32 = 16;

impl Costs {
    pub(in crate::navigate) fn new(params: &FieldParams) -> Self {
        let mut by_square = [FREE; 64];
        let far = params.wall_distance + params.halo_distance;
        for (i, cost) in (0..64u32).zip(&mut by_square) {
            let middle = (i << SQUARES).wrapping_add(1 << (SQUARES - 1));
            let distance = crate::navigate::steps::root(middle).metres();
            let share = |part: Metres, whole: Metres| {
                I16F16::from_bits(crate::integer::ratio(1 << 16, part.bits(), whole.bits()))
            };
            let factor = if distance < params.wall_distance {
                let into = share(params.wall_distance - distance, params.wall_distance);
                params.wall.saturating_mul(I16F16::ONE.saturating_add(into))
            } else if distance < far {
                let into = share(far - distance, params.halo_distance);
                I16F16::ONE.saturating_add(params.halo.saturating_mul(into))
            } else {
                continue;
            };
            *cost = (factor.to_bits() >> 14).clamp(FREE.into(), u8::MAX.into()) as u8;
        }
        // A point lies at most half a cell beside its own cell's middle.
        let beyond = Steps::of(far) - CELL.half();
        let cells = beyond.bits().max(0).wrapping_add(CELL.bits() - 1) / CELL.bits();
        Self { by_square, cells }
    }

    /// Enters a point, seen from the grid's corner.
    pub(super) fn stamp(&self, grid: &mut [u8; CELLS], place: Vector) {
        let (column, row) = cell_of(place);
        let last = SIDE as i32 - 1;
        let last = last as u32;
        let within = |i: i32| {
            let [first, end] = [i.wrapping_sub(self.cells), i.wrapping_add(self.cells)];
            (first.max(0) as u32, end.min(last as i32))
        };
        let ((left, right), (bottom, top)) = (within(column), within(row));
        let corner = middle(left as i32, bottom as i32) - place;
        let (mut beside, mut r) = (corner.y, bottom);
        while r as i32 <= top {
            let across = beside.squared();
            let (mut along, mut c) = (corner.x, left);
            while c as i32 <= right {
                let square = along.squared().wrapping_add(across) >> SQUARES;
                if let Some(dear) = self.by_square.get(square as usize) {
                    let cost = &mut grid[cell(c as usize, r as usize)];
                    if *cost < *dear {
                        *cost = *dear;
                    }
                }
                along = along + CELL;
                c = c.wrapping_add(1);
            }
            beside = beside + CELL;
            r = r.wrapping_add(1);
        }
    }
}

/// A place where the robot got stuck: dear for a while, so that another way is tried, and the dearer the more often.
#[derive(Clone, Copy, Debug)]
struct Place {
    at: Point,
    cost: u8,
    /// Fields until it is forgotten.
    left: u8,
}

/// The most places shunned.
const MOST: usize = 8;
/// A place within this of a shunned one is the same, and cells within it are dear.
const RADIUS: Metres = Metres::lit("0.4");
/// Fields for which a place is shunned.
const FIELDS: u8 = 80;

/// The places where the robot got stuck.
#[derive(Clone, Debug)]
pub(super) struct Shunned {
    places: Vec<Place, MOST>,
}

impl Shunned {
    pub const fn new() -> Self {
        Self { places: Vec::new() }
    }

    /// Adds a place, or makes a known one twice as dear.
    pub fn add(&mut self, cost: u8, at: Point) {
        let near = |known: &&mut Place| (known.at - at).norm_squared() < square(RADIUS);
        if let Some(known) = self.places.iter_mut().find(near) {
            known.cost = known.cost.saturating_mul(2);
            known.left = FIELDS;
            return;
        }
        let left = FIELDS;
        let new = Place { at, cost, left };
        if self.places.push(new).is_err()
            && let Some(oldest) = self.places.iter_mut().min_by_key(|known| known.left)
        {
            *oldest = new;
        }
    }

    pub fn clear(&mut self) {
        self.places.clear();
    }

    pub fn len(&self) -> usize {
        self.places.len()
    }

    /// Enters the places into a new field's grid.
    pub fn stamp(&mut self, grid: &mut [u8; CELLS], corner: Point) {
        retain(&mut self.places, |place| {
            place.left = place.left.saturating_sub(1);
            place.left > 0
        });
        let radius = Steps::of(RADIUS);
        for place in &self.places {
            let at = Vector::of(place.at - corner);
            let (column, row) = cell_of(at);
            for r in row.wrapping_sub(3)..=row.wrapping_add(3) {
                for c in column.wrapping_sub(3)..=column.wrapping_add(3) {
                    let within = (middle(c, r) - at).norm_squared() < radius.squared();
                    if let Some(cost) = index(c, r).filter(|_| within).and_then(|i| grid.get_mut(i))
                    {
                        *cost = cost.saturating_add(place.cost);
                    }
                }
            }
        }
    }
}
