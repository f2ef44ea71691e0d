//! Guide field: the cost of the way to the carrot from every cell of a small grid around the robot, so that dead ends are
//! left and not only met.
//!
//! 32 × 32 cells. A cell near a remembered point is dear, never forbidden: a gap that is closed only by uncertainty stays
//! possible at a price. What was never seen counts as free. Border cells start with the straight way from there to the
//! carrot; from them the cheapest way is spread inward, always from the cheapest cells on (a bucket of three cells' cost at
//! a time, as in Dial's algorithm and Δ-stepping), until the robot's cell is settled. Descending from there gives the guide
//! point.
//!
//! The work is cut into slices: a tick does no more than its budget, and a new field is ready every few ticks. Between
//! two fields the guide point stays where it is in the world.

use super::digest::Digest;
use super::memory::Memory;
use super::steps::{Steps, Vector, retain};
use crate::geometry::{Point, square};
use crate::integer::square_root_of_word;
use crate::params::ParamError;
use crate::units::{Angle, Metres};
use fixed::types::I16F16;
use heapless::Vec;

/// Cells along a side.
const SIDE: usize = 32;
/// Cells in all.
const CELLS: usize = SIDE * SIDE;
/// A cell's side, 0.15 m.
const CELL: Steps = Steps::lit("0.15");
/// Steps to cells, 24 fractional bits.
const PER_CELL: i32 = ((1 << 24) + CELL.bits() - 1) / CELL.bits();
/// Costs that are settled together, beyond the cheapest one: three steps between free cells, so that neither many cells are
/// settled twice nor many rounds find few.
const BUCKET: u16 = 47;
/// Cost of a free cell, as a factor with two fractional bits.
const FREE: u8 = 4;

/// The field's settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldParams {
    /// Within this of a point a cell costs `wall` and more.
    pub wall_distance: Metres,
    /// Factor at the wall's edge, up to 31; at the point itself it is twice that.
    pub wall: I16F16,
    /// A halo this much farther out still costs more than a free cell; both together up to 0.45 m.
    pub halo_distance: Metres,
    /// Factor above one at the halo's inner edge.
    pub halo: I16F16,
    /// How far the field is descended to the guide point; up to 2 m.
    pub ahead: Metres,
    /// Where the straight way to the carrot is free and within this of the field's direction, it is taken instead.
    pub straight: Angle,
    /// Cost added to the cells of a place where the robot got stuck, in quarters of a free cell's; twice that the next time.
    pub shun: u8,
    /// Cells settled in a tick (or as much other work); 8 or more.
    pub budget: u16,
}

impl FieldParams {
    /// Whether the field can be computed with them.
    ///
    /// # Errors
    ///
    /// The first field that forbids it.
    pub fn check(&self) -> Result<(), ParamError> {
        let far = self.wall_distance + self.halo_distance;
        let checks = [
            (
                self.wall_distance > Metres::ZERO
                    && self.halo_distance > Metres::ZERO
                    && far <= const { Metres::lit("0.45") },
                "field.wall_distance, field.halo_distance",
                "above 0, together up to 0.45 m",
            ),
            (
                (1 << 16..=31 << 16).contains(&self.wall.to_bits()),
                "field.wall",
                "1 to 31",
            ),
            (
                (0..=31 << 16).contains(&self.halo.to_bits()),
                "field.halo",
                "0 to 31",
            ),
            (
                (const { Metres::lit("0.15") }..=const { Metres::lit("2") }).contains(&self.ahead),
                "field.ahead",
                "0.15 to 2 m",
            ),
            (self.budget >= 8, "field.budget", "8 or more"),
        ];
        match checks.into_iter().find(|(ok, ..)| !ok) {
            Some((_, field, allowed)) => Err(ParamError { field, allowed }),
            None => Ok(()),
        }
    }
}

/// Places where the robot got stuck: dear for a while, so that another way is tried, and the dearer the more often.
#[derive(Clone, Copy, Debug)]
struct Shunned {
    at: Point,
    cost: u8,
    /// Fields until it is forgotten.
    left: u8,
}

/// The most places shunned.
const SHUNNED: usize = 8;
/// A place within this of a shunned one is the same, and cells within it are dear.
const SHUNNED_RADIUS: Metres = Metres::lit("0.4");
/// Fields for which a place is shunned.
const SHUNNED_FIELDS: u8 = 80;

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
    pub(super) fn new(params: &FieldParams) -> Self {
        let mut by_square = [FREE; 64];
        let far = params.wall_distance + params.halo_distance;
        for (i, cost) in (0..64u32).zip(&mut by_square) {
            let middle = (i << SQUARES).wrapping_add(1 << (SQUARES - 1));
            let distance = super::steps::root(middle).metres();
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
}

/// What the field is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// Nothing is under way.
    Idle,
    /// Entering the points, from this one on.
    Stamp(u16),
    /// Starting from the border cells, from this one on.
    Seed(u16),
    /// Spreading.
    Spread,
}

/// The field.
#[derive(Clone, Debug)]
pub struct Field {
    cost: [u8; CELLS],
    way: [u16; CELLS],
    /// Cells whose neighbours are to be looked at, a row an entry.
    active: [u32; SIDE],
    /// The cheapest of them in each row.
    least: [u16; SIDE],
    /// World: the corner of the first cell.
    corner: Point,
    carrot: Point,
    phase: Phase,
    /// Cells up to this cost are being settled.
    limit: u16,
    row: u8,
    /// The last field's answer.
    guide: Option<Point>,
    shunned: Vec<Shunned, SHUNNED>,
}

impl Default for Field {
    fn default() -> Self {
        Self::new()
    }
}

impl Field {
    /// No field yet.
    pub const fn new() -> Self {
        Self {
            cost: [FREE; CELLS],
            way: [u16::MAX; CELLS],
            active: [0; SIDE],
            least: [u16::MAX; SIDE],
            corner: Point::new(Metres::ZERO, Metres::ZERO),
            carrot: Point::new(Metres::ZERO, Metres::ZERO),
            phase: Phase::Idle,
            limit: 0,
            row: 0,
            guide: None,
            shunned: Vec::new(),
        }
    }

    /// Makes a place of the world dear for a while.
    pub fn shun(&mut self, params: &FieldParams, at: Point) {
        let near = |known: &&mut Shunned| (known.at - at).norm_squared() < square(SHUNNED_RADIUS);
        if let Some(known) = self.shunned.iter_mut().find(near) {
            known.cost = known.cost.saturating_mul(2);
            known.left = SHUNNED_FIELDS;
            return;
        }
        let new = Shunned {
            at,
            cost: params.shun,
            left: SHUNNED_FIELDS,
        };
        if self.shunned.push(new).is_err()
            && let Some(oldest) = self.shunned.iter_mut().min_by_key(|known| known.left)
        {
            *oldest = new;
        }
    }

    /// Shuns no place any more.
    pub fn forgive(&mut self) {
        self.shunned.clear();
    }

    /// Forgets the guide point, and what is under way.
    pub fn reset(&mut self) {
        self.phase = Phase::Idle;
        self.guide = None;
    }

    /// The point to head for, world; none before the first field is ready.
    pub fn guide(&self) -> Option<Point> {
        self.guide
    }

    pub(super) fn digest(&self, digest: &mut Digest) {
        for (cost, way) in self.cost.iter().zip(&self.way) {
            digest.word(u32::from(*cost) << 16 | u32::from(*way));
        }
        digest.point(self.guide.unwrap_or_default());
        digest.word(self.shunned.len() as u32);
    }

    /// A slice of work. Returns whether a field was finished.
    pub fn work(
        &mut self,
        params: &FieldParams,
        costs: &Costs,
        memory: &Memory,
        robot: Point,
        carrot: Point,
    ) -> bool {
        let mut budget = i32::from(params.budget);
        // Every pass spends budget or moves on to the next of four phases.
        for _ in 0..4 {
            match self.phase {
                Phase::Idle => {
                    self.begin(robot, carrot);
                    self.phase = Phase::Stamp(0);
                    // As much as filling the arrays takes.
                    budget = budget.wrapping_sub(16);
                }
                Phase::Stamp(first) => self.stamp(costs, memory, first, &mut budget),
                Phase::Seed(first) => self.seed(first, &mut budget),
                Phase::Spread => {
                    if self.spread(robot, &mut budget) {
                        self.guide = Some(self.descend(params, robot));
                        self.phase = Phase::Idle;
                        return true;
                    }
                }
            }
            if budget <= 0 {
                break;
            }
        }
        false
    }

    fn begin(&mut self, robot: Point, carrot: Point) {
        self.cost = [FREE; CELLS];
        self.way = [u16::MAX; CELLS];
        self.active = [0; SIDE];
        self.least = [u16::MAX; SIDE];
        let half = Steps::from_bits(CELL.bits().wrapping_mul(SIDE as i32 / 2)).metres();
        self.corner = robot - Point::new(half, half);
        self.carrot = carrot;
        self.limit = u16::MAX;
        self.row = 0;
    }

    /// Column and row of a place of the world; they may lie outside.
    fn cell_of(&self, world: Point) -> (i32, i32) {
        cell_of(Vector::of(world - self.corner))
    }

    /// A cell's middle from the corner.
    fn middle(column: i32, row: i32) -> Vector {
        let along = |i: i32| Steps::from_bits(CELL.bits().wrapping_mul(i)) + CELL.half();
        Vector::new(along(column), along(row))
    }

    fn stamp(&mut self, costs: &Costs, memory: &Memory, first: u16, budget: &mut i32) {
        let mut index = first;
        while *budget > 0 {
            let Some(point) = memory.local(index.into()) else {
                self.stamp_shunned();
                *budget = budget.wrapping_sub((self.shunned.len() as i32).wrapping_mul(4));
                self.phase = Phase::Seed(0);
                return;
            };
            self.stamp_point(costs, memory.to_world(point));
            index = index.wrapping_add(1);
            *budget = budget.wrapping_sub(4);
        }
        self.phase = Phase::Stamp(index);
    }

    fn stamp_point(&mut self, costs: &Costs, world: Point) {
        let place = Vector::of(world - self.corner);
        let (column, row) = cell_of(place);
        let last = SIDE as i32 - 1;
        let last = last as u32;
        let within = |i: i32| {
            let [first, end] = [i.wrapping_sub(costs.cells), i.wrapping_add(costs.cells)];
            (first.max(0) as u32, end.min(last as i32))
        };
        let ((left, right), (bottom, top)) = (within(column), within(row));
        let corner = Self::middle(left as i32, bottom as i32) - place;
        let (mut beside, mut r) = (corner.y, bottom);
        while r as i32 <= top {
            let across = beside.squared();
            let (mut along, mut c) = (corner.x, left);
            while c as i32 <= right {
                let square = along.squared().wrapping_add(across) >> SQUARES;
                if let Some(dear) = costs.by_square.get(square as usize) {
                    let cost = &mut self.cost[cell(c as usize, r as usize)];
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

    fn stamp_shunned(&mut self) {
        retain(&mut self.shunned, |place| {
            place.left = place.left.saturating_sub(1);
            place.left > 0
        });
        let radius = Steps::of(SHUNNED_RADIUS);
        for place in &self.shunned {
            let at = Vector::of(place.at - self.corner);
            let (column, row) = cell_of(at);
            for r in row.wrapping_sub(3)..=row.wrapping_add(3) {
                for c in column.wrapping_sub(3)..=column.wrapping_add(3) {
                    let within = (Self::middle(c, r) - at).norm_squared() < radius.squared();
                    if let Some(cost) = index(c, r)
                        .filter(|_| within)
                        .and_then(|i| self.cost.get_mut(i))
                    {
                        *cost = cost.saturating_add(place.cost);
                    }
                }
            }
        }
    }

    /// Border cells, and the carrot's own cell, get their straight way.
    fn seed(&mut self, first: u16, budget: &mut i32) {
        const BORDER: u16 = 4 * (SIDE as u16 - 1);
        let mut next = first;
        let off = self.carrot - self.corner;
        // 2^16 a metre to sixteenths of a cell: by 614.4.
        let carrot = (off.x.bits() / 614, off.y.bits() / 614);
        while *budget > 0 && next <= BORDER {
            let last = SIDE as i32 - 1;
            let along = i32::from(next) % last;
            let (column, row) = match i32::from(next) / last {
                0 => (along, 0),
                1 => (last, along),
                2 => (last.wrapping_sub(along), last),
                3 => (0, last.wrapping_sub(along)),
                _ => self.cell_of(self.carrot),
            };
            self.start(column, row, carrot);
            next = next.wrapping_add(1);
            *budget = budget.wrapping_sub(1);
        }
        self.phase = if next > BORDER {
            Phase::Spread
        } else {
            Phase::Seed(next)
        };
    }

    fn start(&mut self, column: i32, row: i32, carrot: (i32, i32)) {
        let Some(index) = index(column, row) else {
            return;
        };
        // In sixteenths of a cell, as costs are.
        let off = |cell: i32, carrot: i32| {
            let middle = cell.wrapping_mul(16).wrapping_add(8);
            carrot.wrapping_sub(middle).unsigned_abs().min(1 << 15)
        };
        let (x, y) = (off(column, carrot.0), off(row, carrot.1));
        let squared = x.wrapping_mul(x).wrapping_add(y.wrapping_mul(y));
        let way = square_root_of_word(squared).min(40_000) as u16;
        if way < self.way[index & (CELLS - 1)] {
            self.way[index & (CELLS - 1)] = way;
            self.wait(row as usize, 1u32.wrapping_shl(column as u32), way);
        }
        self.limit = self.limit.min(way);
    }

    /// Settles cells, cheapest first. Returns whether the robot's cell is settled.
    fn spread(&mut self, robot: Point, budget: &mut i32) -> bool {
        let (column, row) = self.cell_of(robot);
        let middle = SIDE / 2 * SIDE + SIDE / 2;
        let goal = index(column, row).unwrap_or(middle);
        while *budget > 0 {
            let row = usize::from(self.row) & (SIDE - 1);
            if self.least[row] <= self.limit {
                self.settle(row, budget);
            }
            self.row = self.row.wrapping_add(1);
            if usize::from(self.row) < SIDE {
                continue;
            }
            // Once round costs as much as three cells.
            *budget = budget.wrapping_sub(3);
            self.row = 0;
            let next = self.least.iter().copied().min().unwrap_or(u16::MAX);
            if next <= self.limit {
                continue;
            }
            if self.way[goal & (CELLS - 1)] <= self.limit || next == u16::MAX {
                return true;
            }
            self.limit = next.saturating_add(BUCKET);
        }
        false
    }

    /// Settles the cells of a row that are cheap enough.
    fn settle(&mut self, row: usize, budget: &mut i32) {
        let mut waiting = core::mem::replace(&mut self.active[row & (SIDE - 1)], 0);
        self.least[row & (SIDE - 1)] = u16::MAX;
        let (mut later, mut least) = (0u32, u16::MAX);
        // At most once a cell of the row.
        while waiting != 0 {
            let column = waiting.trailing_zeros() as usize & (SIDE - 1);
            let bit = waiting & waiting.wrapping_neg();
            waiting ^= bit;
            let way = self.way[cell(column, row)];
            if way <= self.limit {
                self.relax(column, row, way, bit);
                *budget = budget.wrapping_sub(1);
            } else {
                later |= bit;
                least = least.min(way);
            }
        }
        self.wait(row, later, least);
    }

    /// Notes that cells of a row wait, none of which costs less than `least`.
    #[inline(always)]
    fn wait(&mut self, row: usize, cells: u32, least: u16) {
        let row = row & (SIDE - 1);
        if cells != 0 {
            self.active[row] |= cells;
            if least < self.least[row] {
                self.least[row] = least;
            }
        }
    }

    /// Offers the neighbours the way over a cell. Most of a field's work is done here: inside the border neighbours are
    /// spelled out, and the cell's own share of what they cost is worked out once. `bit` is its column's.
    fn relax(&mut self, column: usize, row: usize, way: u16, bit: u32) {
        let from = cell(column, row);
        let here = u32::from(self.cost[from]);
        let straight = u32::from(way).wrapping_add(here.wrapping_mul(2));
        let least = straight.wrapping_add(u32::from(FREE) * 2).min(65_535) as u16;
        let first = from.wrapping_sub(SIDE + 1);
        let inside = column.wrapping_sub(1) < SIDE - 2 && row.wrapping_sub(1) < SIDE - 2;
        let (Some(costs), Some(ways), true) = (
            self.cost
                .get(first..)
                .and_then(<[u8]>::first_chunk::<AROUND>),
            self.way
                .get_mut(first..)
                .and_then(<[u16]>::first_chunk_mut::<AROUND>),
            inside,
        ) else {
            self.relax_at_border(column, row, way, least);
            return;
        };
        let own = (
            u32::from(way),
            straight,
            here.wrapping_mul(45).wrapping_add(8),
        );
        let mut below = 0;
        let mut beside = 0;
        let mut above = 0;
        if slant::<0>(costs, ways, own) {
            below |= bit >> 1;
        }
        if straight_on::<1>(costs, ways, own) {
            below |= bit;
        }
        if slant::<2>(costs, ways, own) {
            below |= bit << 1;
        }
        if straight_on::<SIDE>(costs, ways, own) {
            beside |= bit >> 1;
        }
        if straight_on::<{ SIDE + 2 }>(costs, ways, own) {
            beside |= bit << 1;
        }
        if slant::<{ 2 * SIDE }>(costs, ways, own) {
            above |= bit >> 1;
        }
        if straight_on::<{ 2 * SIDE + 1 }>(costs, ways, own) {
            above |= bit;
        }
        if slant::<{ 2 * SIDE + 2 }>(costs, ways, own) {
            above |= bit << 1;
        }
        self.wait(row.wrapping_sub(1), below, least);
        self.wait(row, beside, least);
        self.wait(row.wrapping_add(1), above, least);
    }

    fn relax_at_border(&mut self, column: usize, row: usize, way: u16, least: u16) {
        let here = self.cost[cell(column, row)];
        for (c, r, diagonal) in &NEIGHBOURS {
            let (column, row) = (
                column.wrapping_add_signed(*c as isize),
                row.wrapping_add_signed(*r as isize),
            );
            if column >= SIDE || row >= SIDE {
                continue;
            }
            let to = cell(column, row);
            let offered = way.saturating_add(step_cost(here, self.cost[to], *diagonal));
            if offered < self.way[to] {
                self.way[to] = offered;
                self.wait(row, 1u32.wrapping_shl(column as u32), least);
            }
        }
    }

    fn cost_at(&self, column: i32, row: i32) -> u8 {
        index(column, row)
            .and_then(|i| self.cost.get(i))
            .copied()
            .unwrap_or(FREE)
    }

    /// From the robot down the field: the place that the cheapest way reaches after `ahead`.
    fn descend(&self, params: &FieldParams, robot: Point) -> Point {
        let (mut column, mut row) = self.cell_of(robot);
        let mut left = Steps::of(params.ahead).bits();
        // 2 m are fewer than 14 cells.
        for _ in 0..14 {
            let here = self.cost_at(column, row);
            let mut best = None::<(u16, i32, i32, bool)>;
            for (c, r, diagonal) in &NEIGHBOURS {
                let (c, r) = (column.wrapping_add(*c), row.wrapping_add(*r));
                let diagonal = *diagonal;
                let Some(next) = index(c, r) else {
                    continue;
                };
                let there = self.cost.get(next).copied().unwrap_or(FREE);
                let way = self.way.get(next).copied().unwrap_or(u16::MAX);
                let through = way.saturating_add(step_cost(here, there, diagonal));
                if best.is_none_or(|(known, ..)| through < known) {
                    best = Some((through, c, r, diagonal));
                }
            }
            let own = index(column, row)
                .and_then(|i| self.way.get(i))
                .copied()
                .unwrap_or(u16::MAX);
            let Some((through, c, r, diagonal)) = best else {
                break;
            };
            // A seed: from here the way is straight.
            if own < through {
                if self.cell_of(self.carrot) == (column, row) {
                    return self.carrot;
                }
                break;
            }
            (column, row) = (c, r);
            let step = if diagonal { 1448 } else { 1024 };
            left = left.wrapping_sub(CELL.bits().wrapping_mul(step) >> 10);
            if left <= 0 {
                break;
            }
        }
        self.corner + Self::middle(column, row).point()
    }
}

/// Column and row of a place seen from the first cell's corner.
fn cell_of(place: Vector) -> (i32, i32) {
    // ±2^15 steps by 2^15: it fits.
    let cell = |steps: Steps| steps.bits().wrapping_mul(PER_CELL) >> 24;
    (cell(place.x), cell(place.y))
}

/// Cells from a cell's first neighbour to its last, in a row.
const AROUND: usize = 2 * SIDE + 3;

/// The way to the cell being settled, that with its share of a straight step, and its share of one across a corner.
type Own = (u32, u32, u32);

/// Offers a neighbour beside the cell the way over it; whether it is better than the one known.
#[inline(always)]
fn straight_on<const I: usize>(
    costs: &[u8; AROUND],
    ways: &mut [u16; AROUND],
    (_, straight, _): Own,
) -> bool {
    let offered = straight.wrapping_add(u32::from(costs[I]).wrapping_mul(2));
    let better = offered < u32::from(ways[I]);
    if better {
        // It is less than what fits.
        ways[I] = offered as u16;
    }
    better
}

/// The same across a corner: [`step_cost`], worked out in part.
#[inline(always)]
fn slant<const I: usize>(
    costs: &[u8; AROUND],
    ways: &mut [u16; AROUND],
    (way, _, aslant): Own,
) -> bool {
    let step = u32::from(costs[I]).wrapping_mul(45).wrapping_add(aslant) >> 4;
    let offered = way.wrapping_add(step);
    let better = offered < u32::from(ways[I]);
    if better {
        ways[I] = offered as u16;
    }
    better
}

/// Column, row, diagonal.
static NEIGHBOURS: [(i32, i32, bool); 8] = [
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
fn step_cost(here: u8, there: u8, diagonal: bool) -> u16 {
    let sum = u16::from(here).wrapping_add(there.into());
    // Two fractional bits each: a free step is 16, a diagonal one 23.
    if diagonal {
        sum.wrapping_mul(45).wrapping_add(8) >> 4
    } else {
        sum.wrapping_mul(2)
    }
}

/// A cell of the grid by its column and row: always one.
const fn cell(column: usize, row: usize) -> usize {
    (row & (SIDE - 1)) << 5 | (column & (SIDE - 1))
}

fn index(column: i32, row: i32) -> Option<usize> {
    let inside = |i: i32| (0..SIDE as i32).contains(&i);
    (inside(column) && inside(row)).then_some((row as usize) << 5 | column as usize)
}
