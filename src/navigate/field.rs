//! Guide field: the cheapest way to the carrot over a small grid around the robot, so that dead ends are left and not only
//! met.
//!
//! 32 × 32 [cells](grid). A cell near a remembered point is [dear](costs), never forbidden: a gap that is closed only by
//! uncertainty stays possible at a price. What was never seen counts as free; beyond the grid the way is straight. The
//! [search] ends at the carrot or at the border; where its way passes a little ahead of the robot lies the guide point.
//!
//! The work is cut into slices: a tick does no more than its budget, and a new field is ready after a few ticks. A way is
//! kept until it is old, its end has moved, or a point appears near it; meanwhile the guide point runs along it
//! ahead of the robot.

mod costs;
mod grid;
mod search;
mod way;

pub use costs::Costs;

use super::digest::Digest;
use super::memory::Memory;
use super::steps::{Steps, Vector};
use crate::geometry::{Point, square};
use crate::params::ParamError;
use crate::units::{Angle, Metres};
use costs::Shunned;
use fixed::types::I16F16;
use grid::{CELL, CELL_METRES, CELLS, FREE, SIDE};
use heapless::Vec;
use search::Search;
use way::{KEPT, Way};

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
    /// Ticks after which a way is looked for anew, whatever happens.
    pub refresh: u8,
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

/// What the field is at.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Phase {
    /// Nothing is under way.
    Idle,
    /// Entering the points, from this one on.
    Stamp(u16),
    /// Searching.
    Search,
    /// Following the way found back to the robot, from this cell on.
    Trace(u16),
}

/// The field.
#[derive(Clone, Debug)]
pub struct Field {
    cost: [u8; CELLS],
    search: Search,
    /// World: the robot when the field was begun, the corner of the first cell, and the carrot.
    robot: Point,
    corner: Point,
    carrot: Point,
    phase: Phase,
    /// The cells that were passed last on the way back, and how many there were in all.
    traced: [u16; KEPT],
    passed: u16,
    /// The last field's answer.
    way: Option<Way>,
    /// Ticks since it was begun; saturates.
    age: u8,
    /// What was noticed since.
    noticed: Vec<Point, 4>,
    shunned: Shunned,
}

impl Default for Field {
    fn default() -> Self {
        Self::new()
    }
}

impl Field {
    /// No field yet.
    pub const fn new() -> Self {
        const ORIGIN: Point = Point::new(Metres::ZERO, Metres::ZERO);
        Self {
            cost: [FREE; CELLS],
            search: Search::new(),
            robot: ORIGIN,
            corner: ORIGIN,
            carrot: ORIGIN,
            phase: Phase::Idle,
            traced: [0; KEPT],
            passed: 0,
            way: None,
            age: u8::MAX,
            noticed: Vec::new(),
            shunned: Shunned::new(),
        }
    }

    /// Makes a place of the world dear for a while.
    pub fn shun(&mut self, params: &FieldParams, at: Point) {
        self.shunned.add(params.shun, at);
        self.age = u8::MAX;
    }

    /// Shuns no place any more.
    pub fn forgive(&mut self) {
        self.shunned.clear();
    }

    /// Forgets the way, and what is under way.
    pub fn reset(&mut self) {
        self.phase = Phase::Idle;
        self.way = None;
    }

    /// Tells of something new at a place, world.
    pub fn notice(&mut self, at: Point) {
        // What is under way does not know of it any more, and which way it will find is not known yet.
        let late = self.phase != Phase::Idle && self.noticed.push(at).is_err();
        if late || self.way.as_ref().is_some_and(|way| way.passes(at)) {
            self.age = u8::MAX;
        }
    }

    /// The point to head for, world; none before the first field is ready.
    pub fn guide(&self, params: &FieldParams, robot: Point) -> Option<Point> {
        self.way.as_ref().map(|way| way.along(params, robot))
    }

    pub(super) fn digest(&self, digest: &mut Digest) {
        for (cost, way) in self.cost.iter().zip(self.search.ways()) {
            digest.word(u32::from(*cost) << 16 | u32::from(*way));
        }
        if let Some(way) = &self.way {
            digest.point(way.robot);
            digest.point(way.carrot);
        }
        digest.word(u32::from(self.age) << 16 | self.shunned.len() as u32);
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
        self.age = self.age.saturating_add(1);
        if self.phase == Phase::Idle && !self.is_stale(params, carrot) {
            return false;
        }
        // Every pass spends budget or moves on to the next of four phases.
        for _ in 0..4 {
            match self.phase {
                Phase::Idle => {
                    self.age = 0;
                    self.noticed.clear();
                    self.begin(robot, carrot);
                    self.phase = Phase::Stamp(0);
                    // As much as filling the arrays takes.
                    budget = budget.wrapping_sub(16);
                }
                Phase::Stamp(first) => self.stamp(costs, memory, first, &mut budget),
                Phase::Search => {
                    if self.search.spread(&self.cost, &mut budget) {
                        self.passed = 0;
                        self.phase = self.search.end().map_or(Phase::Idle, Phase::Trace);
                    }
                }
                Phase::Trace(cell) => {
                    if self.trace(cell, &mut budget) {
                        self.arrive();
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

    /// Whether a new way is to be looked for.
    fn is_stale(&self, params: &FieldParams, carrot: Point) -> bool {
        const MOVED: Metres = Metres::lit("0.25");
        self.age >= params.refresh
            || self
                .way
                .as_ref()
                .is_none_or(|way| (way.carrot - carrot).norm_squared() > square(MOVED))
    }

    fn begin(&mut self, robot: Point, carrot: Point) {
        let half = Steps::from_bits(CELL.bits().wrapping_mul(SIDE as i32 / 2)) + CELL.half();
        let half = half.metres();
        self.cost = [FREE; CELLS];
        self.robot = robot;
        self.corner = robot - Point::new(half, half);
        self.carrot = carrot;
        let off = carrot - self.corner;
        const SIXTEENTH: i32 = CELL_METRES.bits() / 16;
        self.search
            .begin((off.x.bits() / SIXTEENTH, off.y.bits() / SIXTEENTH));
    }

    fn stamp(&mut self, costs: &Costs, memory: &Memory, first: u16, budget: &mut i32) {
        let mut index = first;
        while *budget > 0 {
            let Some(point) = memory.local(index.into()) else {
                self.shunned.stamp(&mut self.cost, self.corner);
                *budget = budget.wrapping_sub((self.shunned.len() as i32).wrapping_mul(9));
                self.phase = Phase::Search;
                return;
            };
            let place = Vector::of(memory.to_world(point) - self.corner);
            costs.stamp(&mut self.cost, place);
            index = index.wrapping_add(1);
            *budget = budget.wrapping_sub(3);
        }
        self.phase = Phase::Stamp(index);
    }

    /// Goes back along the way found. Returns whether the robot is reached.
    fn trace(&mut self, from: u16, budget: &mut i32) -> bool {
        let mut cell = from;
        while *budget > 0 {
            let Some(before) = self.search.before(&self.cost, cell) else {
                return true;
            };
            self.traced[usize::from(self.passed) & (KEPT - 1)] = cell;
            self.passed = self.passed.wrapping_add(1);
            cell = before;
            *budget = budget.wrapping_sub(2);
        }
        self.phase = Phase::Trace(cell);
        false
    }

    /// Takes over the way that was gone back.
    fn arrive(&mut self) {
        let way = self.way.get_or_insert(const { Way::new() });
        way.robot = self.robot;
        way.corner = self.corner;
        way.carrot = self.carrot;
        way.take(&self.traced, self.passed, |cell| self.search.is_exit(cell));
        if self.noticed.iter().any(|at| way.passes(*at)) {
            self.age = u8::MAX;
        }
    }
}
