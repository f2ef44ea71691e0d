//! The cheapest way from the middle of the grid to the carrot: A* over the cells.
//!
//! The way that is left is never shorter than its part in the carrot's direction: that is what a cell's key adds to the way
//! to it, and cells are settled in the order of their keys, a bucket at a time as in Dial's algorithm and Δ-stepping. From a
//! border cell, and from the carrot's own, the rest of the way is straight; when no key is smaller than the
//! cheapest whole way found, that is the answer.

use super::grid::{CELLS, FREE, MIDDLE, MIDDLE_CELL, NEIGHBOURS, SIDE, cell, index, step_cost};
use crate::integer::{ratio, square_root_of_word};

/// Keys that are settled together, beyond the smallest one: three steps between free cells, so that neither many cells are
/// settled twice nor many rounds find few.
const BUCKET: u16 = 47;

/// Key of the middle cell: more than the part of any cell in any direction.
const OFFSET: i32 = 400;

/// Fractional bits of [`Search::slope`].
const SLOPE_BITS: u32 = 8;

/// Cells from a cell's first neighbour to its last, in a row.
const AROUND: usize = 2 * SIDE + 3;

/// A search, done in slices.
#[derive(Clone, Debug)]
pub(super) struct Search {
    way: [u16; CELLS],
    /// Cells whose neighbours are to be looked at, a row an entry.
    active: [u32; SIDE],
    /// No key of these is smaller, in each row.
    least: [u16; SIDE],
    /// Rows whose `least` is not above the limit.
    ready: u32,
    /// Cells up to this key are being settled.
    limit: u16,
    row: u8,
    /// What a step along the columns and one along the rows takes off the way that is left.
    slope: (i32, i32),
    /// From the corner of the first cell, in sixteenths of a cell, as costs are.
    carrot: (i32, i32),
    /// The carrot's cell, if it has one.
    exit: Option<usize>,
    /// From the middle to the carrot.
    straight: i32,
    /// The cheapest whole way, as a key, and the cell that it leaves the grid by.
    best: (u16, Option<u16>),
}

impl Search {
    pub const fn new() -> Self {
        Self {
            way: [u16::MAX; CELLS],
            active: [0; SIDE],
            least: [u16::MAX; SIDE],
            ready: 0,
            limit: 0,
            row: 0,
            slope: (0, 0),
            carrot: (0, 0),
            exit: None,
            straight: 0,
            best: (u16::MAX, None),
        }
    }

    /// From the middle to a place, sixteenths of a cell from the corner of the first cell.
    pub fn begin(&mut self, carrot: (i32, i32)) {
        self.way = [u16::MAX; CELLS];
        self.active = [0; SIDE];
        self.least = [u16::MAX; SIDE];
        self.carrot = carrot;
        self.exit = index(carrot.0 >> 4, carrot.1 >> 4);
        self.straight = self.rest(MIDDLE, MIDDLE);
        let part = |carrot: i32| {
            let off = carrot.wrapping_sub(MIDDLE as i32 * 16 + 8);
            ratio(16 << SLOPE_BITS, off, self.straight.max(1))
                .clamp(-16 << SLOPE_BITS, 16 << SLOPE_BITS)
        };
        self.slope = (part(carrot.0), part(carrot.1));
        self.best = (u16::MAX, None);
        self.limit = OFFSET as u16 + BUCKET;
        self.row = MIDDLE as u8;
        self.ready = 0;
        self.way[cell(MIDDLE, MIDDLE)] = 0;
        self.wait(MIDDLE, 1 << MIDDLE, OFFSET as u16);
    }

    pub fn ways(&self) -> &[u16; CELLS] {
        &self.way
    }

    /// The straight way from a cell's middle to the carrot.
    fn rest(&self, column: usize, row: usize) -> i32 {
        let off = |cell: usize, carrot: i32| {
            let middle = (cell as i32).wrapping_mul(16).wrapping_add(8);
            carrot.wrapping_sub(middle).unsigned_abs().min(1 << 15)
        };
        let (x, y) = (off(column, self.carrot.0), off(row, self.carrot.1));
        let squared = x.wrapping_mul(x).wrapping_add(y.wrapping_mul(y));
        square_root_of_word(squared) as i32
    }

    /// Settles cells until none can lead to a cheaper way. Returns whether that is so.
    pub fn spread(&mut self, cost: &[u8; CELLS], budget: &mut i32) -> bool {
        while *budget > 0 {
            if self.ready != 0 {
                // Once round over the rows, upward.
                let above = self.ready & u32::MAX.wrapping_shl(self.row.into());
                let rows = if above == 0 { self.ready } else { above };
                let row = rows.trailing_zeros() as usize & (SIDE - 1);
                self.ready &= !(1u32.wrapping_shl(row as u32));
                self.row = (row as u8).wrapping_add(1) & (SIDE as u8 - 1);
                self.settle(cost, row, budget);
                continue;
            }
            // Both passes over the rows cost as much as three cells.
            *budget = budget.wrapping_sub(3);
            let next = self.least.iter().copied().min().unwrap_or(u16::MAX);
            if next >= self.best.0 {
                return true;
            }
            self.limit = next.saturating_add(BUCKET).min(self.best.0);
            for (row, least) in (0..32u32).zip(&self.least) {
                if *least <= self.limit {
                    self.ready |= 1u32.wrapping_shl(row);
                }
            }
        }
        false
    }

    /// Settles the cells of a row that are cheap enough.
    fn settle(&mut self, cost: &[u8; CELLS], row: usize, budget: &mut i32) {
        let mut waiting = core::mem::replace(&mut self.active[row & (SIDE - 1)], 0);
        // What waits on is looked at in vain.
        *budget = budget.wrapping_sub(1);
        self.least[row & (SIDE - 1)] = u16::MAX;
        let (mut later, mut least) = (0u32, u16::MAX);
        let part = self
            .slope
            .1
            .wrapping_mul((row as i32).wrapping_sub(MIDDLE as i32));
        // At most once a cell of the row.
        while waiting != 0 {
            let column = waiting.trailing_zeros() as usize & (SIDE - 1);
            let bit = waiting & waiting.wrapping_neg();
            waiting ^= bit;
            let way = self.way[cell(column, row)];
            let along = self
                .slope
                .0
                .wrapping_mul((column as i32).wrapping_sub(MIDDLE as i32));
            let ahead = part.wrapping_add(along) >> SLOPE_BITS;
            let key = i32::from(way)
                .wrapping_add(OFFSET)
                .wrapping_sub(ahead)
                .min(i32::from(u16::MAX)) as u16;
            if key <= self.limit {
                self.relax(cost, (column, row), way, key, bit);
                *budget = budget.wrapping_sub(1);
            } else {
                later |= bit;
                least = least.min(key);
            }
        }
        self.wait(row, later, least);
    }

    /// Notes that cells of a row wait, none of whose keys is less than `least`.
    #[inline(always)]
    fn wait(&mut self, row: usize, cells: u32, least: u16) {
        let row = row & (SIDE - 1);
        if cells != 0 {
            self.active[row] |= cells;
            if least < self.least[row] {
                self.least[row] = least;
            }
            if least <= self.limit {
                self.ready |= 1u32.wrapping_shl(row as u32);
            }
        }
    }

    /// Offers the neighbours the way over a cell. Most of a search's work is done here: inside the border neighbours are
    /// spelled out, and the cell's own share of what they cost is worked out once. `bit` is its column's.
    fn relax(
        &mut self,
        costs: &[u8; CELLS],
        (column, row): (usize, usize),
        way: u16,
        key: u16,
        bit: u32,
    ) {
        let from = cell(column, row);
        if self.exit == Some(from) {
            self.leave(column, row, way);
        }
        let here = u32::from(costs[from]);
        let first = from.wrapping_sub(SIDE + 1);
        let inside = column.wrapping_sub(1) < SIDE - 2 && row.wrapping_sub(1) < SIDE - 2;
        let (Some(costs), Some(ways), true) = (
            costs.get(first..).and_then(<[u8]>::first_chunk::<AROUND>),
            self.way
                .get_mut(first..)
                .and_then(<[u16]>::first_chunk_mut::<AROUND>),
            inside,
        ) else {
            self.leave(column, row, way);
            self.relax_at_border(costs, column, row, way, key);
            return;
        };
        let own = (
            u32::from(way),
            u32::from(way).wrapping_add(here.wrapping_mul(2)),
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
        // No neighbour's key is smaller than the cell's own.
        self.wait(row.wrapping_sub(1), below, key);
        self.wait(row, beside, key);
        self.wait(row.wrapping_add(1), above, key);
    }

    /// From this cell the way may be straight.
    fn leave(&mut self, column: usize, row: usize, way: u16) {
        let rest = self.rest(column, row).wrapping_sub(self.straight);
        let whole = i32::from(way).wrapping_add(OFFSET).wrapping_add(rest);
        let whole = whole.clamp(0, i32::from(u16::MAX)) as u16;
        if whole < self.best.0 {
            self.best = (whole, Some(cell(column, row) as u16));
        }
    }

    fn relax_at_border(
        &mut self,
        costs: &[u8; CELLS],
        column: usize,
        row: usize,
        way: u16,
        key: u16,
    ) {
        let here = costs[cell(column, row)];
        for (c, r, diagonal) in &NEIGHBOURS {
            let (column, row) = (
                column.wrapping_add_signed(*c as isize),
                row.wrapping_add_signed(*r as isize),
            );
            if column >= SIDE || row >= SIDE {
                continue;
            }
            let to = cell(column, row);
            let offered = way.saturating_add(step_cost(here, costs[to], *diagonal));
            if offered < self.way[to] {
                self.way[to] = offered;
                self.wait(row, 1u32.wrapping_shl(column as u32), key);
            }
        }
    }

    /// The cell by which the cheapest way leaves the grid.
    pub fn end(&self) -> Option<u16> {
        self.best.1
    }

    /// Whether the carrot lies in this cell.
    pub fn is_exit(&self, cell: u16) -> bool {
        self.exit == Some(usize::from(cell))
    }

    /// The cell before one on the cheapest way; none before the middle.
    pub fn before(&self, costs: &[u8; CELLS], to: u16) -> Option<u16> {
        if to == MIDDLE_CELL {
            return None;
        }
        let (column, row) = (i32::from(to) & (SIDE as i32 - 1), i32::from(to) >> 5);
        let here = costs.get(usize::from(to)).copied().unwrap_or(FREE);
        // Of equal ways the one that stays nearest to the straight line.
        let aside = |column: i32, row: i32| {
            let [x, y] = [column, row].map(|cell| cell.wrapping_sub(MIDDLE as i32));
            let (along, up) = self.slope;
            x.wrapping_mul(up)
                .wrapping_sub(y.wrapping_mul(along))
                .unsigned_abs()
        };
        let mut best = ((u16::MAX, u32::MAX), None);
        for (c, r, diagonal) in &NEIGHBOURS {
            let (column, row) = (column.wrapping_add(*c), row.wrapping_add(*r));
            let Some(from) = index(column, row) else {
                continue;
            };
            let way = self.way.get(from).copied().unwrap_or(u16::MAX);
            let cost = costs.get(from).copied().unwrap_or(FREE);
            let through = way.saturating_add(step_cost(cost, here, *diagonal));
            if through <= best.0.0 {
                let rank = (through, aside(column, row));
                if rank < best.0 {
                    best = (rank, Some(from as u16));
                }
            }
        }
        best.1
    }
}

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

#[cfg(test)]
mod tests {
    use super::{CELLS, FREE, MIDDLE, MIDDLE_CELL, NEIGHBOURS, Search, cell, index, step_cost};

    /// Ways from the middle to every cell by going over all cells until nothing changes.
    fn ways(costs: &[u8; CELLS]) -> [u32; CELLS] {
        let mut ways = [u32::MAX; CELLS];
        ways[cell(MIDDLE, MIDDLE)] = 0;
        let mut changed = true;
        while changed {
            changed = false;
            for from in 0..CELLS {
                for (c, r, diagonal) in NEIGHBOURS {
                    let next = index((from & 31) as i32 + c, (from >> 5) as i32 + r);
                    let Some(to) = next.filter(|_| ways[from] != u32::MAX) else {
                        continue;
                    };
                    let step = step_cost(costs[from], costs[to], diagonal);
                    let offered = ways[from] + u32::from(step);
                    if offered < ways[to] {
                        ways[to] = offered;
                        changed = true;
                    }
                }
            }
        }
        ways
    }

    /// Numbers that look random.
    fn random(state: &mut u64) -> u32 {
        *state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (*state >> 33) as u32
    }

    #[test]
    fn the_way_found_is_the_cheapest_one() {
        let mut state = 1;
        for round in 0..200 {
            let mut costs = [FREE; CELLS];
            for _ in 0..random(&mut state) % 300 {
                let at = random(&mut state) as usize % CELLS;
                costs[at] = FREE + (random(&mut state) % 200) as u8;
            }
            // Inside the grid, near it, and far away.
            let spread = [512, 2000, 30_000][round % 3];
            let mut along = || (random(&mut state) % spread) as i32 - spread as i32 / 2 + 256;
            let carrot = (along(), along());
            let mut search = Search::new();
            search.begin(carrot);
            let budget = 1 + random(&mut state) as i32 % 500;
            let mut slices = 0;
            while !search.spread(&costs, &mut { budget }) {
                slices += 1;
                assert!(slices < 10_000);
            }

            let known = ways(&costs);
            let border = |i: usize| [i & 31, i >> 5].iter().any(|at| matches!(at, 0 | 31));
            let exit = |i: usize| border(i) || search.is_exit(i as u16);
            let whole = |i: usize| known[i] as i32 + search.rest(i & 31, i >> 5);
            let least = (0..CELLS).filter(|i| exit(*i)).map(whole).min().unwrap();
            let end = search.end().unwrap();
            assert!(exit(end.into()));
            // A key is rounded.
            assert!(whole(end.into()) <= least + 1, "{round}: {carrot:?}");

            let (mut at, mut way, mut cells) = (end, 0, 0);
            while let Some(before) = search.before(&costs, at) {
                let apart = (before & 31 != at & 31) && (before >> 5 != at >> 5);
                let step = step_cost(costs[usize::from(before)], costs[usize::from(at)], apart);
                way += u32::from(step);
                at = before;
                cells += 1;
                assert!(cells < CELLS);
            }
            assert_eq!(at, MIDDLE_CELL);
            assert_eq!(way, known[usize::from(end)]);
        }
    }

    #[test]
    fn where_nothing_is_dear_few_cells_are_looked_at() {
        let mut search = Search::new();
        search.begin((256 + 1000, 264));
        let mut budget = 1000;
        assert!(search.spread(&[FREE; CELLS], &mut budget));
        // Without the direction it takes them all.
        assert!(budget > 650, "{budget} left");
    }

    #[test]
    fn of_equal_ways_the_straight_one_is_taken() {
        // Ten columns and four rows away: a diagonal step can be made anywhere on the way.
        let mut search = Search::new();
        search.begin(((MIDDLE as i32 + 10) * 16 + 8, (MIDDLE as i32 + 4) * 16 + 8));
        assert!(search.spread(&[FREE; CELLS], &mut 1000));
        let mut at = search.end().unwrap();
        while let Some(before) = search.before(&[FREE; CELLS], at) {
            let [x, y] = [before & 31, before >> 5].map(|i| i32::from(i) - MIDDLE as i32);
            assert!((10 * y - 4 * x).abs() <= 10, "{x}, {y}");
            at = before;
        }
    }
}
