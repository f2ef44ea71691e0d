//! Guide field: the cheapest way to the carrot over a small grid around the robot, so that dead ends are left and not only
//! met.
//!
//! 32 × 32 [cells](grid). A cell near a remembered point is [dear](costs), never forbidden: a gap that is closed only by
//! uncertainty stays possible at a price. What was never seen counts as free; beyond the grid the way is straight. The
//! [search] ends at the carrot or at the border; where its way passes a little ahead of the robot lies the guide point.
//!
//! The work is cut into slices: a tick does no more than its budget, and a new field is ready every few ticks. Between
//! two fields the guide point stays where it is in the world.

mod costs;
mod grid;
mod search;

pub use costs::Costs;

use super::digest::Digest;
use super::memory::Memory;
use super::steps::{Steps, Vector};
use crate::geometry::Point;
use crate::params::ParamError;
use crate::units::{Angle, Metres};
use costs::Shunned;
use fixed::types::I16F16;
use grid::{CELL, CELLS, FREE, SIDE, middle};
use search::Search;

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
    traced: [u16; TRACED],
    passed: u16,
    /// The last field's answer.
    guide: Option<Point>,
    shunned: Shunned,
}

/// Cells of the way that are kept: 2 m and what is driven meanwhile are no more. A power of two.
const TRACED: usize = 16;

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
            traced: [0; TRACED],
            passed: 0,
            guide: None,
            shunned: Shunned::new(),
        }
    }

    /// Makes a place of the world dear for a while.
    pub fn shun(&mut self, params: &FieldParams, at: Point) {
        self.shunned.add(params.shun, at);
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
        for (cost, way) in self.cost.iter().zip(self.search.ways()) {
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
                Phase::Search => {
                    if self.search.spread(&self.cost, &mut budget) {
                        self.passed = 0;
                        self.phase = self.search.end().map_or(Phase::Idle, Phase::Trace);
                    }
                }
                Phase::Trace(cell) => {
                    if self.trace(cell, &mut budget) {
                        self.guide = Some(self.along(params, robot));
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
        let half = Steps::from_bits(CELL.bits().wrapping_mul(SIDE as i32 / 2)) + CELL.half();
        let half = half.metres();
        self.cost = [FREE; CELLS];
        self.robot = robot;
        self.corner = robot - Point::new(half, half);
        self.carrot = carrot;
        let off = carrot - self.corner;
        // 2^16 a metre to sixteenths of a cell: by 614.4.
        self.search.begin((off.x.bits() / 614, off.y.bits() / 614));
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
            self.traced[usize::from(self.passed) & (TRACED - 1)] = cell;
            self.passed = self.passed.wrapping_add(1);
            cell = before;
            *budget = budget.wrapping_sub(2);
        }
        self.phase = Phase::Trace(cell);
        false
    }

    /// The place that the way reaches after `ahead` from where the robot is now.
    fn along(&self, params: &FieldParams, robot: Point) -> Point {
        let driven = Vector::of(robot - self.robot).norm();
        let mut left = Steps::of(params.ahead) + driven;
        let mut place = grid::MIDDLE_CELL;
        let known = usize::from(self.passed).min(TRACED);
        for back in 1..=known {
            let next = self.traced[usize::from(self.passed).wrapping_sub(back) & (TRACED - 1)];
            left = left - grid::length(place, next);
            place = next;
            if left <= Steps::ZERO {
                break;
            }
        }
        let whole = usize::from(self.passed) == known;
        if left > Steps::ZERO && whole && self.search.is_exit(place) {
            return self.carrot;
        }
        self.corner + middle(i32::from(place) & (SIDE as i32 - 1), i32::from(place) >> 5).point()
    }
}
