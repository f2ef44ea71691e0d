//! The cheapest way from the carrot to the middle of the grid: a wave over the cells, a row of 32 of them at a time.
//!
//! A round of the wave lets every cell that it has reached pass it on. In two rounds of five it goes to all eight
//! neighbours, in the others to four: after n rounds it has come n cells along an axis or a diagonal, and up to 8 % farther
//! between. A dear cell takes part in a share of the rounds only, every third one for a cost of 3: it holds the wave up
//! as a detour of as many free cells would. Outside of the grid all is free: the wave comes in over the border as if
//! it had spread from the carrot there. It ends at the robot; the way is where it came from.
//!
//! Cost: a round is some fifteen instructions a row that the wave is in, whatever the number of cells. Searches that settle
//! one cell after the other (Dijkstra, A*) take about 200 for each.

use super::grid::{COLUMNS, Cell, Ground, INNER, LEVELS, MIDDLE, MIDDLE_CELL, OUTER, ROWS, WALL};

/// Sixteenths of a cell: the unit of places and ranges.
const SIXTEENTHS: i32 = 16;

/// Side of the square around the middle whose cells note when the wave reached them.
const NOTED: usize = 16;
/// Its first column and row.
const FIRST: (usize, usize) = (MIDDLE.0 - NOTED / 2, MIDDLE.1 - NOTED / 2);

/// The middle of the last cell of a row, and of the last row.
const LAST: (i32, i32) = (last(COLUMNS), last(ROWS));

const fn last(cells: usize) -> i32 {
    SIXTEENTHS * cells as i32 - SIXTEENTHS / 2
}

/// A wave, done in slices.
#[derive(Clone, Debug)]
pub(super) struct Wave {
    /// Cells reached, a row an entry, between an empty one below the first and one above the last.
    reached: [u32; ROWS + 2],
    /// Cells of the border that it has reached outside of the grid.
    entered: [u32; ROWS],
    /// The round in which cells near the middle were reached, from 1 on; 0: not yet.
    rounds: [[u8; NOTED]; NOTED],
    round: u8,
    clocks: Clocks,
    /// Rows that the wave is in, or may enter: the first, and the one after the last.
    rows: (u8, u8),
    sides: [Side; 4],
    /// How far it has come outside of the grid.
    range: i32,
    /// From the corner of the first cell.
    carrot: (i32, i32),
    /// The carrot's cell, if it has one.
    source: Option<Cell>,
}

/// Where in their turns the shares of the rounds are.
#[derive(Clone, Copy, Debug, Default)]
struct Clocks {
    three: u8,
    nine: u8,
    wall: u8,
    five: u8,
}

impl Clocks {
    /// On to the next round. The cells that stay closed in it: those of a level and above; none: no cell does. And whether
    /// it goes to eight neighbours.
    fn next(&mut self, wall: u8) -> (Option<usize>, bool) {
        let turn = |clock: &mut u8, of: u8| {
            *clock = clock.wrapping_add(1);
            let done = *clock >= of;
            if done {
                *clock = 0;
            }
            done
        };
        turn(&mut self.five, 5);
        let wide = self.five & 1 == 1;
        let (three, nine) = (turn(&mut self.three, 3), turn(&mut self.nine, 9));
        let closed = if turn(&mut self.wall, wall) {
            None
        } else if nine {
            Some(WALL)
        } else if three {
            Some(INNER + 1)
        } else if self.three == 1 {
            Some(INNER)
        } else {
            Some(OUTER)
        };
        (closed, wide)
    }
}

/// A side of the grid, as the wave comes to it from outside.
#[derive(Clone, Copy, Debug, Default)]
struct Side {
    /// The carrot's distance from the line of its cells' middles, and its place along it.
    away: i32,
    along: i32,
    /// Its cells.
    length: i32,
    /// Those that it has reached: the first, and the one after the last.
    cells: (i32, i32),
}

impl Side {
    const NONE: Self = Self {
        away: 0,
        along: 0,
        length: 0,
        cells: (0, 0),
    };

    fn new(away: i32, along: i32, length: usize) -> Self {
        let length = length as i32;
        let nearest = (along >> SIXTEENTHS.trailing_zeros())
            .min(length.wrapping_sub(1))
            .max(0);
        Self {
            away: away.saturating_abs(),
            along,
            length,
            cells: (nearest, nearest),
        }
    }

    /// Range at which the wave comes to its nearest cell.
    fn nearest(&self) -> i32 {
        let last = SIXTEENTHS
            .wrapping_mul(self.length)
            .wrapping_sub(SIXTEENTHS / 2);
        let nearest = self.along.min(last).max(SIXTEENTHS / 2);
        let beside = self.along.wrapping_sub(nearest);
        range(self.away, beside.saturating_abs())
    }

    /// The cells along it that the wave reaches with a range: the first, and the one after the last.
    fn within(&self, range: i32) -> (i32, i32) {
        if self.away > range {
            return self.cells;
        }
        // As [`range`] rounds.
        let both = range.wrapping_mul(7).wrapping_add(6) / 5;
        let half = range.min(both.wrapping_sub(self.away));
        let cell = |place: i32| {
            (place.wrapping_add(SIXTEENTHS / 2 - 1) >> SIXTEENTHS.trailing_zeros())
                .min(self.length)
                .max(0)
        };
        let first = cell(self.along.wrapping_sub(half));
        let end = cell(self.along.wrapping_add(half).wrapping_add(1));
        if first >= end {
            // So far it comes past the side's end.
            return self.cells;
        }
        (first.min(self.cells.0), end.max(self.cells.1))
    }
}

/// Range of a wave when it reaches a place that is so far away along one axis and the other.
fn range(x: i32, y: i32) -> i32 {
    let both = x.wrapping_add(y).wrapping_mul(5) / 7;
    x.max(y).max(both)
}

impl Wave {
    pub const fn new() -> Self {
        Self {
            reached: [0; ROWS + 2],
            entered: [0; ROWS],
            rounds: [[0; NOTED]; NOTED],
            round: 0,
            clocks: Clocks {
                three: 0,
                nine: 0,
                wall: 0,
                five: 0,
            },
            rows: (0, 0),
            sides: [Side::NONE; 4],
            range: 0,
            carrot: (0, 0),
            source: None,
        }
    }

    /// From a place, sixteenths of a cell from the corner of the first cell, up to ±2¹⁵.
    pub fn begin(&mut self, (x, y): (i32, i32)) {
        self.reached = [0; ROWS + 2];
        self.entered = [0; ROWS];
        self.rounds = [[0; NOTED]; NOTED];
        self.round = 0;
        self.clocks = Clocks::default();
        self.carrot = (x, y);
        let off = |at: i32, line: i32| at.wrapping_sub(line);
        // Bottom, top, left, right.
        self.sides = [
            Side::new(off(y, SIXTEENTHS / 2), x, COLUMNS),
            Side::new(off(y, LAST.1), x, COLUMNS),
            Side::new(off(x, SIXTEENTHS / 2), y, ROWS),
            Side::new(off(x, LAST.0), y, ROWS),
        ];
        self.source = Cell::within(x >> 4, y >> 4);
        self.rows = (ROWS as u8, 0);
        self.range = match self.source {
            Some(cell) => {
                self.enter(cell.row.into(), 1u32.wrapping_shl(cell.column.into()));
                0
            }
            None => self.sides.iter().map(Side::nearest).min().unwrap_or(0),
        };
    }

    pub(super) fn reached(&self) -> &[u32; ROWS + 2] {
        &self.reached
    }

    pub(super) fn round(&self) -> u8 {
        self.round
    }

    /// From outside into cells of a row.
    fn enter(&mut self, row: usize, cells: u32) {
        let Some(entered) = self.entered.get_mut(row) else {
            return;
        };
        *entered |= cells;
        let row = row as u8;
        self.rows = (self.rows.0.min(row), self.rows.1.max(row.wrapping_add(1)));
    }

    /// Comes nearer outside of the grid.
    fn approach(&mut self) {
        for side in 0..4usize {
            let Some(here) = self.sides.get_mut(side) else {
                break;
            };
            let (before, now) = (here.cells, here.within(self.range));
            if before == now {
                continue;
            }
            here.cells = now;
            if side < 2 {
                // A row: all at once.
                let upto = |end: i32| u32::MAX.checked_shl(end as u32).unwrap_or(0);
                self.enter(side.wrapping_mul(ROWS - 1), upto(now.0) & !upto(now.1));
                continue;
            }
            let bit = if side == 2 { 1 } else { 1 << (COLUMNS - 1) };
            for row in now.0..before.0 {
                self.enter(row as usize, bit);
            }
            for row in before.1..now.1 {
                self.enter(row as usize, bit);
            }
        }
        self.range = self.range.saturating_add(2 * SIXTEENTHS);
    }

    /// Rounds until the robot is reached or the budget is spent; `wall` is the cost of a wall's cell. Returns whether it is.
    pub fn spread(&mut self, ground: &Ground, wall: u8, budget: &mut i32) -> bool {
        while *budget > 0 {
            if self.reached[MIDDLE.1 + 1] >> MIDDLE.0 & 1 == 1 || self.round == u8::MAX {
                return true;
            }
            // Every other round is often enough.
            if self.round & 1 == 0 {
                self.approach();
            }
            let rows = self.rows.1.wrapping_sub(self.rows.0);
            *budget = budget.wrapping_sub(1).wrapping_sub(i32::from(rows) / 2);
            self.pass_on(ground, wall);
        }
        false
    }

    /// A round.
    fn pass_on(&mut self, ground: &Ground, wall: u8) {
        self.round = self.round.saturating_add(1);
        let (closed, wide) = self.clocks.next(wall);
        let level = closed.unwrap_or(0) & (LEVELS - 1);
        let shut = if closed.is_some() { u32::MAX } else { 0 };
        let wide = if wide { u32::MAX } else { 0 };
        let (first, end) = self.rows;
        let start = usize::from(first).min(ROWS);
        let rows = start..usize::from(end).min(ROWS).max(start);
        let (mut lowest, mut highest) = (0, 0);
        let last = rows.end.wrapping_add(2);
        let (Some(ground), Some(entered), Some(reached)) = (
            ground.get(rows.clone()),
            self.entered.get(rows.clone()),
            self.reached.get_mut(rows.start..last),
        ) else {
            return;
        };
        let [below, here, reached @ ..] = reached else {
            return;
        };
        let (mut below, mut place) = (*below, here);
        for (row, ((above, ground), entered)) in
            (rows.start..).zip(reached.iter_mut().zip(ground).zip(entered))
        {
            let here = *place;
            let column = below | *above;
            let aside = here | column & wide;
            let fresh = column | aside << 1 | aside >> 1 | *entered;
            let fresh = fresh & !(ground[level] & shut) & !here;
            *place = here | fresh;
            (below, place) = (here, above);
            highest = fresh;
            if row == start {
                lowest = fresh;
            }
            if fresh == 0 {
                continue;
            }
            if let Some(rounds) = self.rounds.get_mut(row.wrapping_sub(FIRST.1)) {
                let mut fresh = fresh >> FIRST.0 & ((1 << NOTED) - 1);
                while fresh != 0 {
                    rounds[fresh.trailing_zeros() as usize & (NOTED - 1)] = self.round;
                    fresh &= fresh.wrapping_sub(1);
                }
            }
        }
        // It may go on to the rows beside those that it is in.
        if lowest != 0 {
            self.rows.0 = first.saturating_sub(1);
        }
        if highest != 0 {
            self.rows.1 = end.saturating_add(1).min(ROWS as u8);
        }
    }

    /// The round in which a cell was reached, if it was, and is near enough to the middle to have been noted.
    fn reached_in(&self, column: i32, row: i32) -> Option<u8> {
        let inner = |at: i32, first: usize| at.wrapping_sub(first as i32) as usize;
        let rounds = self.rounds.get(inner(row, FIRST.1))?;
        rounds
            .get(inner(column, FIRST.0))
            .copied()
            .filter(|n| *n > 0)
    }

    /// The cell that the wave reached this one from, on the way to the carrot; none at its end.
    pub fn next(&self, from: Cell) -> Option<Cell> {
        let (column, row) = (i32::from(from.column), i32::from(from.row));
        let own = self.reached_in(column, row)?;
        // Of those reached equally early the one that is nearest to the straight way.
        let middle = |cell: usize| SIXTEENTHS * cell as i32 + SIXTEENTHS / 2;
        let (x, y) = (
            self.carrot.0.wrapping_sub(middle(MIDDLE.0)),
            self.carrot.1.wrapping_sub(middle(MIDDLE.1)),
        );
        let aside = |column: i32, row: i32| {
            let (c, r) = (
                column.wrapping_sub(MIDDLE.0 as i32),
                row.wrapping_sub(MIDDLE.1 as i32),
            );
            c.wrapping_mul(y)
                .wrapping_sub(r.wrapping_mul(x))
                .unsigned_abs()
        };
        let mut best = ((own, 0), None);
        for r in row.wrapping_sub(1)..=row.wrapping_add(1) {
            for c in column.wrapping_sub(1)..=column.wrapping_add(1) {
                let Some(reached) = self.reached_in(c, r) else {
                    continue;
                };
                if reached > best.0.0 || reached >= own {
                    continue;
                }
                let rank = (reached, aside(c, r));
                if rank < best.0 {
                    best = (rank, Cell::within(c, r));
                }
            }
        }
        best.1
    }

    /// Whether the carrot lies in a cell.
    pub fn is_source(&self, cell: Cell) -> bool {
        self.source == Some(cell)
    }

    /// The cells of the way from the robot's on.
    pub fn way(&self) -> impl Iterator<Item = Cell> + '_ {
        core::iter::successors(Some(MIDDLE_CELL), |cell| self.next(*cell)).skip(1)
    }
}

#[cfg(test)]
mod tests {
    use super::{SIXTEENTHS, Wave, range};
    use crate::navigate::field::costs::nest;
    use crate::navigate::field::grid::{COLUMNS, Ground, LEVELS, MIDDLE, MIDDLE_CELL, ROWS};

    type Cells = [[bool; COLUMNS]; ROWS];

    const CENTRE: (i32, i32) = (
        MIDDLE.0 as i32 * SIXTEENTHS + SIXTEENTHS / 2,
        MIDDLE.1 as i32 * SIXTEENTHS + SIXTEENTHS / 2,
    );

    /// Numbers that look random.
    fn random(state: &mut u64) -> u32 {
        *state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        (*state >> 33) as u32
    }

    fn is_on_border(column: usize, row: usize) -> bool {
        matches!(column, 0 | 31) || matches!(row, 0 | 31)
    }

    /// How far a cell's middle is from the carrot, as waves count.
    fn away(column: usize, row: usize, carrot: (i32, i32)) -> i32 {
        let off = |cell: usize, at: i32| (cell as i32 * SIXTEENTHS + SIXTEENTHS / 2 - at).abs();
        range(off(column, carrot.0), off(row, carrot.1))
    }

    /// A round by the rule of it, cell by cell: `before` are the cells reached, `come` is how far it has come outside.
    fn passed_on(
        before: &Cells,
        ground: &Ground,
        wall: u32,
        round: u32,
        carrot: (i32, i32),
        come: i32,
    ) -> Cells {
        let closed = match round {
            n if n % wall == 0 => None,
            n if n % 9 == 0 => Some(3),
            n if n % 3 == 0 => Some(2),
            n if n % 3 == 1 => Some(1),
            _ => Some(0),
        };
        let wide = matches!(round % 5, 1 | 3);
        let reached = |column: i32, row: i32| {
            let inside = |at: i32, end: usize| (0..end as i32).contains(&at);
            inside(column, COLUMNS) && inside(row, ROWS) && before[row as usize][column as usize]
        };
        let mut after = *before;
        for (row, cells) in after.iter_mut().enumerate() {
            for (column, cell) in cells.iter_mut().enumerate() {
                let open = closed.is_none_or(|level: usize| ground[row][level] >> column & 1 == 0);
                let (c, r) = (column as i32, row as i32);
                let beside = (-1..=1)
                    .any(|x| (-1..=1).any(|y| (wide || x == 0 || y == 0) && reached(c + x, r + y)));
                let outside = is_on_border(column, row) && away(column, row, carrot) <= come;
                let source = carrot.0 >> 4 == c && carrot.1 >> 4 == r;
                *cell |= open && (beside || outside || source);
            }
        }
        after
    }

    #[test]
    fn a_round_is_what_its_rule_says_of_every_cell() {
        let mut state = 1;
        for number in 0..120 {
            let mut ground: Ground = [[0; LEVELS]; ROWS];
            for _ in 0..random(&mut state) % 400 {
                let (at, level) = (random(&mut state) as usize, random(&mut state) as usize);
                ground[at % ROWS][level % LEVELS] |= 1 << (at >> 8 & 31);
            }
            nest(&mut ground);
            // Inside the grid, near it, and far away.
            let spread = [512, 2000, 30_000][number % 3];
            let mut along = || (random(&mut state) % spread) as i32 - spread as i32 / 2 + 256;
            let carrot = (along(), along());
            let wall = 9 + random(&mut state) as u8 % 40;

            let mut wave = Wave::new();
            wave.begin(carrot);
            let mut cells = [[false; COLUMNS]; ROWS];
            let border = |i: usize| is_on_border(i & 31, i >> 5);
            let nearest = (0..COLUMNS * ROWS)
                .filter(|i| border(*i))
                .map(|i| away(i & 31, i >> 5, carrot))
                .min()
                .unwrap();
            let mut come = if wave.source.is_some() { 0 } else { nearest };
            let mut round = 0;
            while round < 255 && !cells[MIDDLE.1][MIDDLE.0] {
                // One round, then the budget is spent.
                assert!(!wave.spread(&ground, wall, &mut 1), "{number}");
                round += 1;
                cells = passed_on(&cells, &ground, wall.into(), round, carrot, come);
                if round % 2 == 0 {
                    come += 2 * SIXTEENTHS;
                }
                for (row, cells) in cells.iter().enumerate() {
                    for (column, cell) in cells.iter().enumerate() {
                        let got = wave.reached()[row + 1] >> column & 1 == 1;
                        assert_eq!(got, *cell, "{number}, round {round}: {column}, {row}");
                    }
                }
            }
            assert!(wave.spread(&ground, wall, &mut 1));

            // The way goes back through rounds, from cell to neighbour.
            let mut at = MIDDLE_CELL;
            let reached = |at: super::Cell| wave.reached_in(at.column.into(), at.row.into());
            assert_eq!(reached(at).map(u32::from), Some(round));
            for next in wave.way() {
                assert!(reached(next) < reached(at));
                let apart = |a: u8, b: u8| a.abs_diff(b) <= 1;
                assert!(apart(next.column, at.column) && apart(next.row, at.row));
                at = next;
            }
        }
    }

    #[test]
    fn over_free_cells_a_wave_takes_as_many_rounds_as_cells() {
        let ground = [[0; LEVELS]; ROWS];
        for (columns, rows) in [(10, 0), (0, -10), (10, 10), (-10, 10), (10, 4), (-4, -10)] {
            let mut wave = Wave::new();
            wave.begin((
                CENTRE.0 + columns * SIXTEENTHS,
                CENTRE.1 + rows * SIXTEENTHS,
            ));
            assert!(wave.spread(&ground, 27, &mut 1000));
            let far = range(columns.abs(), rows.abs());
            // The carrot's own cell is the first round's.
            let round = i32::from(wave.round()) - 1;
            assert!(
                (far..=far + 4).contains(&round),
                "{columns}, {rows}: {round}"
            );
            // Of equally early cells those on the straight line are taken.
            for cell in wave.way() {
                let (x, y) = (i32::from(cell.column) - 16, i32::from(cell.row) - 16);
                assert!((columns * y - rows * x).abs() <= 10, "{x}, {y}");
            }
        }
    }

    #[test]
    fn a_dead_end_is_left_around_its_walls() {
        // Open behind the robot: walls ahead and to both sides, five cells away, the carrot beyond the one ahead.
        let mut ground: Ground = [[0; LEVELS]; ROWS];
        let wall = |row: &mut super::super::grid::Row, cells: u32| row[3] |= cells;
        wall(&mut ground[MIDDLE.1 + 5], 0x7ff << 11);
        for row in &mut ground[MIDDLE.1 - 2..MIDDLE.1 + 5] {
            wall(row, 1 << 11 | 1 << 21);
        }
        nest(&mut ground);
        let mut wave = Wave::new();
        wave.begin((CENTRE.0, CENTRE.1 + 10 * SIXTEENTHS));
        let mut budget = 1000;
        assert!(wave.spread(&ground, 60, &mut budget));
        let way: heapless::Vec<_, 16> = wave.way().take(5).collect();
        assert!(
            way.iter()
                .all(|cell| ground[usize::from(cell.row)][3] >> cell.column & 1 == 0)
        );
        assert!(usize::from(way[3].row) < MIDDLE.1, "{way:?}");
        // Through the wall where that costs less.
        let mut wave = Wave::new();
        wave.begin((CENTRE.0, CENTRE.1 + 10 * SIXTEENTHS));
        assert!(wave.spread(&ground, 9, &mut 1000));
        assert!(usize::from(wave.way().nth(2).unwrap().row) > MIDDLE.1);
    }
}
