//! What a cell costs: dear near a remembered point, dearer where the robot got stuck, never forbidden.

use super::FieldParams;
use super::grid::{
    CELL, COLUMNS, Cell, Frame, Ground, INNER, LEVELS, OUTER, ROWS, Row, WALL, cell_of, middle,
    quarters_of,
};
use crate::geometry::{Point, square};
use crate::navigate::steps::{Steps, Vector, retain};
use crate::units::Metres;
use heapless::Vec;

/// Cells around a point's own that it may make dear, to either side.
const AROUND: i32 = 1;
/// And in a row.
const WIDTH: u32 = 3;
/// Farther from a point than this no cell is reached that is not beside its own, wherever in that the point lies.
pub(super) const MOST_REACH: Metres = Metres::lit("0.29");

/// Places in a cell that are told apart: quarters along both axes.
const PLACES: usize = 16;

/// Which cells a point makes dear.
#[derive(Clone, Debug)]
pub struct Costs {
    /// By the place in its own cell that a point lies in: the cells around it of the halo and of the wall, [`WIDTH`] bits a
    /// row, the lowest row first.
    patterns: [u32; PLACES],
    /// Cost of a wall's cell.
    pub(super) wall: u8,
}

/// Bits of a level in a pattern.
const BITS: u32 = WIDTH * WIDTH;

impl Costs {
    pub(in crate::navigate) fn new(params: &FieldParams) -> Self {
        // Within these distances of a point.
        let reaches = [
            params.wall_distance + params.halo_distance,
            params.wall_distance,
        ]
        .map(|reach| Steps::of(reach).squared());
        let mut patterns = [0; PLACES];
        for (place, pattern) in (0..PLACES as i32).zip(&mut patterns) {
            let eighths = |quarter: i32| {
                CELL.bits()
                    .wrapping_mul(quarter.wrapping_mul(2).wrapping_add(1))
                    >> 3
            };
            let at = Vector::new(
                Steps::from_bits(eighths(place & 3)),
                Steps::from_bits(eighths(place >> 2)),
            );
            let mut bit = 1u32;
            for reach in reaches {
                for row in -AROUND..=AROUND {
                    for column in -AROUND..=AROUND {
                        if (middle(column, row) - at).norm_squared() < reach {
                            *pattern |= bit;
                        }
                        bit = bit.wrapping_shl(1);
                    }
                }
            }
        }
        let wall = params.wall.round().to_num::<i32>().clamp(1, 255) as u8;
        Self { patterns, wall }
    }

    /// Enters a point, seen from the grid's corner. Beside the border it makes nothing dear.
    pub(super) fn stamp(&self, ground: &mut Ground, place: Vector) {
        let (x, y) = quarters_of(place);
        let before = |quarters: i32| (quarters >> 2).wrapping_sub(AROUND).cast_unsigned();
        let (left, below) = (before(x), before(y));
        if left > COLUMNS as u32 - WIDTH {
            return;
        }
        let [x, y] = [x, y].map(|quarters| quarters as usize & 3);
        let rows = ground.get_mut(below as usize..);
        let Some(rows) = rows.and_then(<[Row]>::first_chunk_mut::<{ WIDTH as usize }>) else {
            return;
        };
        let pattern = self.patterns[y << 2 | x];
        // Spelled out: a loop would cost half as much again.
        put(&mut rows[0], pattern, left);
        put(&mut rows[1], pattern >> WIDTH, left);
        put(&mut rows[2], pattern >> (2 * WIDTH), left);
    }
}

/// Enters a pattern's lowest row, from this column on.
#[inline(always)]
fn put(row: &mut Row, pattern: u32, left: u32) {
    const ROW: u32 = (1 << WIDTH) - 1;
    row[INNER] |= (pattern & ROW).wrapping_shl(left);
    row[WALL] |= (pattern >> BITS & ROW).wrapping_shl(left);
}

/// Puts the halo's outer part beside the cells of its inner one, and makes every level hold the dearer ones, too.
pub(super) fn nest(ground: &mut Ground) {
    let mut below = 0;
    for index in 0..ROWS {
        let above = ground.get(index.wrapping_add(1)).map_or(0, inner);
        let Some(row) = ground.get_mut(index) else {
            break;
        };
        let here = inner(row);
        row[OUTER] |= below | above | here << 1 | here >> 1;
        below = here;
        let mut dearer = 0;
        for level in row.iter_mut().rev() {
            *level |= dearer;
            dearer = *level;
        }
    }
}

/// The cells of a halo's inner part, before or after the levels are nested.
fn inner(row: &Row) -> u32 {
    row[INNER] | row[WALL]
}

/// The level that comes nearest to a cost added to a free cell's, in quarters of that.
fn level(added: u8) -> usize {
    match added {
        0..5 => OUTER,
        5..20 => INNER,
        20..68 => INNER + 1,
        68.. => WALL,
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
    pub fn stamp(&mut self, ground: &mut Ground, frame: Frame) {
        retain(&mut self.places, |place| {
            place.left = place.left.saturating_sub(1);
            place.left > 0
        });
        let radius = Steps::of(RADIUS);
        for place in &self.places {
            let level = level(place.cost) & (LEVELS - 1);
            let at = frame.to_grid(place.at);
            let (column, row) = cell_of(at);
            for r in row.wrapping_sub(3)..=row.wrapping_add(3) {
                for c in column.wrapping_sub(3)..=column.wrapping_add(3) {
                    let within = (middle(c, r) - at).norm_squared() < radius.squared();
                    let Some(cell) = Cell::within(c, r).filter(|_| within) else {
                        continue;
                    };
                    if let Some(levels) = ground.get_mut(usize::from(cell.row)) {
                        levels[level] |= 1u32.wrapping_shl(cell.column.into());
                    }
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Costs, nest};
    use crate::navigate::field::grid::{COLUMNS, Ground, INNER, LEVELS, OUTER, ROWS, WALL, middle};
    use crate::navigate::presets;
    use crate::navigate::steps::{Steps, Vector};
    use crate::units::Metres;

    #[test]
    fn a_cell_is_dear_by_its_distance_from_a_point() {
        let mut params = presets::jackal::<16>().field;
        params.wall_distance = Metres::lit("0.17");
        params.halo_distance = Metres::lit("0.09");
        let costs = Costs::new(&params);
        let reaches = [(INNER, "0.26"), (WALL, "0.17")];
        // A point is moved to the middle of its quarter of a cell.
        let moved = Steps::lit("0.033");
        for x in (2300..2300 + 737).step_by(61) {
            for y in (11_000..11_000 + 737).step_by(67) {
                let point = Vector::new(Steps::from_bits(x), Steps::from_bits(y));
                let mut ground: Ground = [[0; LEVELS]; ROWS];
                costs.stamp(&mut ground, point);
                nest(&mut ground);
                // The outer part of the halo are the cells beside its inner one.
                let inner = |row: usize| ground.get(row).map_or(0, |levels| levels[INNER]);
                for (row, levels) in ground.iter().enumerate() {
                    let here = inner(row);
                    let beside =
                        inner(row.wrapping_sub(1)) | inner(row + 1) | here << 1 | here >> 1;
                    assert_eq!(levels[OUTER], here | beside, "{x}, {y}: {row}");
                }
                for (level, reach) in reaches {
                    let reach = Steps::lit(reach);
                    for (row, levels) in (0..).zip(&ground) {
                        for column in 0..COLUMNS as i32 {
                            let dear = levels[level] >> column & 1 == 1;
                            let away = (middle(column, row) - point).norm();
                            if away < reach - moved {
                                assert!(dear, "{x}, {y}: {column}, {row}");
                            } else if away > reach + moved {
                                assert!(!dear, "{x}, {y}: {column}, {row}");
                            }
                        }
                    }
                }
            }
        }
    }

    #[test]
    fn a_point_beside_the_border_makes_nothing_dear() {
        let costs = Costs::new(&presets::jackal::<16>().field);
        for (x, y) in [(-5000, 9000), (9000, -1), (100, 9000), (32_000, 9000)] {
            let mut ground: Ground = [[0; LEVELS]; ROWS];
            let place = Vector::new(Steps::from_bits(x), Steps::from_bits(y));
            costs.stamp(&mut ground, place);
            assert_eq!(ground, [[0; LEVELS]; ROWS], "{x}, {y}");
        }
    }
}
