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
    /// How far a point reaches.
    far: Steps,
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
        let far = Steps::of(far);
        Self { by_square, far }
    }

    /// Enters a point, seen from the grid's corner.
    pub(super) fn stamp(&self, grid: &mut [u8; CELLS], place: Vector) {
        // The cells whose middles are within reach along both axes.
        let far = Vector::new(self.far, self.far);
        let half = Vector::new(CELL.half(), CELL.half());
        let (before, last) = (cell_of(place - far - half), cell_of(place + far - half));
        let within = |before: i32, last: i32| {
            let first = before.wrapping_add(1).max(0);
            (first, last.min(SIDE as i32 - 1))
        };
        let ((left, right), (bottom, top)) = (within(before.0, last.0), within(before.1, last.1));
        let corner = middle(left, bottom) - place;
        let width = right.wrapping_sub(left).wrapping_add(1).max(0) as usize;
        // (x + c)² − x² = 2·c·x + c², which itself grows by 2·c² a cell.
        const ON: u32 = 2 * CELL.squared();
        let ahead = |x: Steps| {
            (CELL.bits().wrapping_mul(x.bits()) as u32)
                .wrapping_mul(2)
                .wrapping_add(CELL.squared())
        };
        let (mut square, mut up) = (corner.norm_squared(), ahead(corner.y));
        let along = ahead(corner.x);
        let mut first = cell(left as usize, bottom as usize);
        for _ in bottom..=top {
            let (mut here, mut on) = (square, along);
            let row = grid
                .get_mut(first..first.wrapping_add(width))
                .unwrap_or_default();
            for cost in row {
                if let Some(dear) = self.by_square.get((here >> SQUARES) as usize)
                    && *cost < *dear
                {
                    *cost = *dear;
                }
                here = here.wrapping_add(on);
                on = on.wrapping_add(ON);
            }
            square = square.wrapping_add(up);
            up = up.wrapping_add(ON);
            first = first.wrapping_add(SIDE);
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
