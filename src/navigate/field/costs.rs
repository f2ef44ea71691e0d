//! What a cell costs: dear near a remembered point, dearer where the robot got stuck, never forbidden.

use super::FieldParams;
use super::grid::{
    CELL, COLUMNS, Cell, Frame, Ground, INNER, LEVELS, OUTER, ROWS, Row, WALL, cell_of, middle,
    quarters_of,
};
use crate::geometry::{Point, square};
use crate::navigate::steps::{Steps, Vector, retain};
use crate::units::Metres;
use fixed::types::I16F16;
use heapless::Vec;

/// Cells around a point's own that it may make dear, to either side.
const AROUND: i32 = 2;
/// And in a row.
const WIDTH: u32 = 5;

/// Places in a cell that are told apart: quarters along both axes.
const PLACES: usize = 16;

/// Which cells a point makes dear.
#[derive(Clone, Debug)]
pub struct Costs {
    /// By the place in its own cell that a point lies in: for each of the rows around it, the cells of the halo, of its
    /// inner part and of the wall, [`WIDTH`] bits each.
    patterns: [[u16; WIDTH as usize]; PLACES],
    /// Cost of a wall's cell.
    pub(super) wall: u8,
}

impl Costs {
    pub(in crate::navigate) fn new(params: &FieldParams) -> Self {
        // Within these distances of a point: a halo's factor is rounded to 1, 1½ or 3.
        let halo = |factor: I16F16| {
            let part = params.halo_distance.bits();
            let beyond =
                crate::integer::ratio(part, factor.to_bits(), params.halo.to_bits().max(1));
            let least = part.saturating_sub(beyond).max(0);
            Steps::of(params.wall_distance + Metres::from_bits(least))
        };
        let reaches = [
            halo(const { I16F16::lit("0.25") }),
            halo(const { I16F16::lit("1.25") }),
            Steps::of(params.wall_distance),
        ]
        .map(Steps::squared);
        let mut patterns = [[0; WIDTH as usize]; PLACES];
        for (place, rows) in (0..PLACES as i32).zip(&mut patterns) {
            let eighths = |quarter: i32| {
                CELL.bits()
                    .wrapping_mul(quarter.wrapping_mul(2).wrapping_add(1))
                    >> 3
            };
            let at = Vector::new(
                Steps::from_bits(eighths(place & 3)),
                Steps::from_bits(eighths(place >> 2)),
            );
            for (row, cells) in (-AROUND..=AROUND).zip(rows) {
                for (bit, column) in (0..WIDTH).zip(-AROUND..=AROUND) {
                    let away = (middle(column, row) - at).norm_squared();
                    for (level, reach) in (0u32..).zip(&reaches) {
                        if away < *reach {
                            *cells |=
                                1u16.wrapping_shl(level.wrapping_mul(WIDTH).wrapping_add(bit));
                        }
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
        if left > COLUMNS as u32 - WIDTH || below > ROWS as u32 - WIDTH {
            return;
        }
        let [x, y] = [x, y].map(|quarters| quarters as usize & 3);
        let rows = ground.get_mut(below as usize..);
        let Some(rows) = rows.and_then(<[Row]>::first_chunk_mut::<{ WIDTH as usize }>) else {
            return;
        };
        let pattern = &self.patterns[y << 2 | x];
        // Spelled out: a loop would cost half as much again.
        put(&mut rows[0], pattern[0], left);
        put(&mut rows[1], pattern[1], left);
        put(&mut rows[2], pattern[2], left);
        put(&mut rows[3], pattern[3], left);
        put(&mut rows[4], pattern[4], left);
    }
}

/// Enters a row of a pattern, from this column on.
#[inline(always)]
fn put(row: &mut Row, pattern: u16, left: u32) {
    let level = |level: u32| {
        let cells = u32::from(pattern) >> (level * WIDTH) & ((1 << WIDTH) - 1);
        cells.wrapping_shl(left)
    };
    row[OUTER] |= level(0);
    row[INNER] |= level(1);
    row[WALL] |= level(2);
}

/// Makes every level hold the dearer ones, too.
pub(super) fn nest(ground: &mut Ground) {
    for row in ground {
        let mut above = 0;
        for level in row.iter_mut().rev() {
            *level |= above;
            above = *level;
        }
    }
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
        params.halo_distance = Metres::lit("0.2");
        params.halo = fixed::types::I16F16::lit("2");
        let costs = Costs::new(&params);
        // Factors of 1¼ and 2¼ are an eighth and five eighths of the way through the halo.
        let reaches = [(OUTER, "0.345"), (INNER, "0.245"), (WALL, "0.17")];
        // A point is moved to the middle of its quarter of a cell.
        let moved = Steps::lit("0.033");
        for x in (2300..2300 + 737).step_by(61) {
            for y in (11_000..11_000 + 737).step_by(67) {
                let point = Vector::new(Steps::from_bits(x), Steps::from_bits(y));
                let mut ground: Ground = [[0; LEVELS]; ROWS];
                costs.stamp(&mut ground, point);
                nest(&mut ground);
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
