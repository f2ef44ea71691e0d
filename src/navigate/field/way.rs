//! The way that a field found: its first cells, followed until a newer one is known.

use super::FieldParams;
use super::grid::{MIDDLE, MIDDLE_CELL, SIDE, length, middle};
use crate::geometry::Point;
use crate::navigate::steps::{Steps, Vector};

/// Cells of the way that are kept: 2 m and what is driven meanwhile are no more. A power of two.
pub(super) const KEPT: usize = 16;

/// A point this near to the way may change it: what makes a cell dear, and half a cell's diagonal.
const NEAR: Steps = Steps::lit("0.44");

/// Where the robot is to go on from where the field was begun.
#[derive(Clone, Debug)]
pub(super) struct Way {
    /// Its cells after the robot's.
    cells: [u16; KEPT],
    known: u8,
    /// World: the robot then, the corner of the first cell, and the carrot.
    pub robot: Point,
    pub corner: Point,
    pub carrot: Point,
    /// It leads to the carrot itself.
    pub arrives: bool,
}

impl Way {
    pub const fn new() -> Self {
        const ORIGIN: Point = Point::new(crate::units::Metres::ZERO, crate::units::Metres::ZERO);
        Self {
            cells: [0; KEPT],
            known: 0,
            robot: ORIGIN,
            corner: ORIGIN,
            carrot: ORIGIN,
            arrives: false,
        }
    }

    /// Takes over the cells passed on the way back: `traced` is a ring of the last of them, `passed` how many there were in
    /// all. `ends` tells whether a cell is the carrot's.
    pub fn take(&mut self, traced: &[u16; KEPT], passed: u16, ends: impl Fn(u16) -> bool) {
        let known = usize::from(passed).min(KEPT);
        self.known = known as u8;
        let mut last = MIDDLE_CELL;
        for (back, cell) in (1..=known).zip(&mut self.cells) {
            last = traced[usize::from(passed).wrapping_sub(back) & (KEPT - 1)];
            *cell = last;
        }
        self.arrives = usize::from(passed) == known && ends(last);
    }

    fn cells(&self) -> &[u16] {
        self.cells.get(..self.known.into()).unwrap_or(&[])
    }

    fn place(cell: u16) -> Vector {
        middle(
            i32::from(cell) & (SIDE as i32 - 1),
            i32::from(cell) >> SIDE.trailing_zeros(),
        )
    }

    /// The place, world, that it reaches after `ahead` from where the robot is now.
    pub fn along(&self, params: &FieldParams, robot: Point) -> Point {
        let driven = Vector::of(robot - self.robot).norm();
        let mut left = Steps::of(params.ahead) + driven;
        let mut place = MIDDLE_CELL;
        for next in self.cells() {
            left = left - length(place, *next);
            place = *next;
            if left <= Steps::ZERO {
                break;
            }
        }
        if left > Steps::ZERO && self.arrives {
            return self.carrot;
        }
        self.corner + Self::place(place).point()
    }

    /// Whether something at a place, world, may make another way the better one.
    pub fn passes(&self, at: Point) -> bool {
        let at = Vector::of(at - self.corner);
        let near = |place: Vector| (at - place).norm_squared() < const { NEAR.squared() };
        near(middle(MIDDLE as i32, MIDDLE as i32))
            || self.cells().iter().any(|cell| near(Self::place(*cell)))
    }
}

#[cfg(test)]
mod tests {
    use super::{KEPT, Way};
    use crate::geometry::Point;
    use crate::navigate::field::grid::{CELL, CELL_METRES, MIDDLE, SIDE};
    use crate::navigate::presets;
    use crate::navigate::steps::{Steps, Vector};
    use crate::units::Metres;
    use fixed::types::I16F16;

    /// Columns after which a way turns into the rows.
    const STRAIGHT: u16 = 12;

    /// A way straight along the columns, then along the rows, as a ring holds it, of so many cells.
    fn straight(cells: u16, ends: bool) -> Way {
        let mut traced = [0; KEPT];
        for back in 0..cells {
            // Gone back: the farthest first.
            let count = cells - back;
            let [column, row] =
                [count.min(STRAIGHT), count.saturating_sub(STRAIGHT)].map(|i| MIDDLE as u16 + i);
            traced[usize::from(back) & (KEPT - 1)] = row * SIDE as u16 + column;
        }
        let mut way = Way::new();
        way.carrot = Point::new(Metres::lit("9"), Metres::lit("9"));
        way.take(&traced, cells, |_| ends);
        way
    }

    /// How far ahead of the way's beginning the guide point lies, a robot having driven so far.
    fn ahead_of(way: &Way, driven: Metres) -> i32 {
        let params = presets::jackal::<16>().field;
        let robot = way.robot + Point::new(driven, Metres::ZERO);
        let place = Vector::of(way.along(&params, robot) - way.corner);
        let middle = CELL.bits() * MIDDLE as i32 + CELL.bits() / 2;
        place.x.bits() - middle
    }

    #[test]
    fn the_guide_point_runs_ahead_of_the_robot() {
        let params = presets::jackal::<16>().field;
        let way = straight(20, false);
        let ahead = Steps::of(params.ahead).bits();
        for driven in ["0", "0.2", "0.5", "1"].map(Metres::lit) {
            let got = ahead_of(&way, driven) - Steps::of(driven).bits();
            assert!(
                (ahead - 8..=ahead + CELL.bits() + 8).contains(&got),
                "{driven:?}: {got}"
            );
        }
        // It stays at the end of what is kept, and at the end of a way that arrives the carrot is next.
        let end = CELL.bits() * i32::from(STRAIGHT);
        assert!((ahead_of(&way, Metres::lit("4")) - end).abs() < 40);
        let arrives = straight(2, true);
        assert_eq!(arrives.along(&params, arrives.robot), arrives.carrot);
        assert!(!straight(20, true).arrives);
    }

    #[test]
    fn what_is_beside_a_way_may_change_it() {
        let way = straight(10, false);
        let middle = CELL_METRES.scale(const { I16F16::lit("0.5") });
        for (x, y, near) in [
            ("0", "0", true),
            ("1", "0.4", true),
            ("1", "-0.4", true),
            ("-0.3", "0", true),
            ("1", "0.5", false),
            ("-0.6", "0", false),
            ("2.4", "0", false),
        ] {
            let cells = Metres::from_bits(CELL_METRES.bits() * MIDDLE as i32) + middle;
            let place = Point::new(cells + Metres::lit(x), cells + Metres::lit(y));
            assert_eq!(way.passes(way.corner + place), near, "{x}, {y}");
        }
    }
}
