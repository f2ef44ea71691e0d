//! The way that a field found: its first cells, followed until a newer one is known.

use super::FieldParams;
use super::grid::{Cell, Frame, MIDDLE_CELL};
use crate::geometry::Point;
use crate::navigate::steps::{Steps, Vector};
use heapless::Vec;

/// The most cells of a way that are kept.
const KEPT: usize = 9;

/// What a way is longer than the guide point is ahead: so much is driven until the next one is known, or it is the end of
/// this one.
const SPARE: Steps = Steps::lit("0.35");

/// A point this near to the way may change it: what makes a cell dear, and half a cell's diagonal.
const NEAR: Steps = Steps::lit("0.44");

/// Where the robot is to go on from where the field was begun.
#[derive(Clone, Debug)]
pub(super) struct Way {
    /// Its cells after the robot's.
    cells: Vec<Cell, KEPT>,
    /// The robot then, where the grid lay, and the carrot.
    pub robot: Point,
    pub frame: Frame,
    pub carrot: Point,
    /// It leads to the carrot itself.
    pub arrives: bool,
}

impl Way {
    pub const fn new() -> Self {
        const ORIGIN: Point = Point::new(crate::units::Metres::ZERO, crate::units::Metres::ZERO);
        Self {
            cells: Vec::new(),
            robot: ORIGIN,
            frame: Frame::NONE,
            carrot: ORIGIN,
            arrives: false,
        }
    }

    /// Takes over its first cells after the robot's; `ends` tells whether a cell is the carrot's.
    pub fn take(
        &mut self,
        params: &FieldParams,
        cells: impl Iterator<Item = Cell>,
        ends: impl Fn(Cell) -> bool,
    ) {
        let mut left = Steps::of(params.ahead) + SPARE;
        let mut last = MIDDLE_CELL;
        self.cells.clear();
        for cell in cells {
            if left <= Steps::ZERO || self.cells.push(cell).is_err() {
                break;
            }
            left = left - last.length_to(cell);
            last = cell;
        }
        self.arrives = ends(last);
    }

    /// The place, world, that it reaches after `ahead` from where the robot is now.
    pub fn along(&self, params: &FieldParams, robot: Point) -> Point {
        let driven = Vector::of(robot - self.robot).norm();
        let mut left = Steps::of(params.ahead) + driven;
        let mut place = MIDDLE_CELL;
        for next in &self.cells {
            left = left - place.length_to(*next);
            place = *next;
            if left <= Steps::ZERO {
                break;
            }
        }
        if left > Steps::ZERO && self.arrives {
            return self.carrot;
        }
        self.frame.to_world(place.middle())
    }

    /// Whether something at a place, world, may make another way the better one.
    pub fn passes(&self, at: Point) -> bool {
        let at = self.frame.to_grid(at);
        let near = |cell: &Cell| (at - cell.middle()).norm_squared() < const { NEAR.squared() };
        near(&MIDDLE_CELL) || self.cells.iter().any(near)
    }
}

#[cfg(test)]
mod tests {
    use super::{KEPT, Way};
    use crate::geometry::Point;
    use crate::navigate::field::grid::{CELL, Cell, Frame, MIDDLE, MIDDLE_CELL};
    use crate::navigate::presets;
    use crate::navigate::steps::Steps;
    use crate::units::Metres;

    /// A way straight ahead, towards a carrot far ahead, of so many cells.
    fn straight(cells: u8, ends: bool) -> Way {
        let mut way = Way::new();
        way.carrot = Point::new(Metres::lit("9"), Metres::ZERO);
        way.frame = Frame::around(way.robot, way.carrot);
        // Rows lie along x then.
        let row = |count: u8| Cell {
            column: MIDDLE.0 as u8,
            row: MIDDLE.1 as u8 + count,
        };
        let params = presets::jackal::<16>().field;
        way.take(&params, (1..=cells).map(row), |_| ends);
        way
    }

    #[test]
    fn the_guide_point_runs_ahead_of_the_robot() {
        let params = presets::jackal::<16>().field;
        let way = straight(12, false);
        let ahead = Steps::of(params.ahead).bits();
        for driven in ["0", "0.1", "0.2", "0.3"].map(Metres::lit) {
            let robot = way.robot + Point::new(driven, Metres::ZERO);
            let got = Steps::of(way.along(&params, robot).x - driven).bits();
            assert!(
                (ahead - 8..=ahead + CELL.bits() + 8).contains(&got),
                "{driven:?}: {got}"
            );
        }
        // It stays at the end of what is kept, and at the end of a way that arrives the carrot is next.
        let far = Point::new(Metres::lit("4"), Metres::ZERO);
        let end = CELL.bits() * way.cells.len() as i32;
        assert!(way.cells.len() <= KEPT);
        assert!((Steps::of(way.along(&params, far).x).bits() - end).abs() < 40);
        let arrives = straight(2, true);
        assert_eq!(arrives.along(&params, arrives.robot), arrives.carrot);
        assert!(!straight(12, false).arrives);
    }

    #[test]
    fn what_is_beside_a_way_may_change_it() {
        let way = straight(5, false);
        assert_eq!(way.frame.to_world(MIDDLE_CELL.middle()), way.robot);
        for (x, y, near) in [
            ("0", "0", true),
            ("0.8", "0.4", true),
            ("0.8", "-0.4", true),
            ("-0.3", "0", true),
            ("0.8", "0.5", false),
            ("-0.6", "0", false),
            ("1.5", "0", false),
        ] {
            let place = Point::new(Metres::lit(x), Metres::lit(y));
            assert_eq!(way.passes(place), near, "{x}, {y}");
        }
    }
}
