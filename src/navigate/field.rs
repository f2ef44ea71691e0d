//! Guide field: the cheapest way to the carrot over a small grid around the robot, so that dead ends are left and not only
//! met.
//!
//! 32 × 32 [cells](grid). A cell near a remembered point is [dear](costs), never forbidden: a gap that is closed only by
//! uncertainty stays possible at a price. What was never seen counts as free; beyond the grid the way is straight. A
//! [wave] spreads from the carrot to the robot; where the way that it came passes a little ahead of the robot lies the
//! guide point.
//!
//! The work is cut into slices: it is the last part of a tick, of up to its budget and what the other parts left, and a new
//! field is ready for the next tick, or for one of the two after it. A way is kept until it is old, its end has moved, or a point appears near it;
//! meanwhile the guide point runs along it ahead of the robot.

mod costs;
mod grid;
mod wave;
mod way;

pub use costs::Costs;

use super::digest::Digest;
use super::memory::Memory;
use super::steps::Vector;
use crate::geometry::{Point, square};
use crate::params::ParamError;
use crate::units::{Angle, Metres};
use costs::{Shunned, nest};
use fixed::types::I16F16;
use grid::{CELL_METRES, Frame, Ground, LEVELS, ROWS};
use heapless::Vec;
use wave::Wave;
use way::Way;

/// The field's settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FieldParams {
    /// Within this of a point a cell costs `wall` and more.
    pub wall_distance: Metres,
    /// Factor of a wall's cell, rounded; 1 to 120.
    pub wall: I16F16,
    /// This much farther out, in the halo, a cell costs three free ones, and those beside it one and a half; both distances
    /// together up to 0.29 m.
    pub halo_distance: Metres,
    /// How far along the way the guide point lies; up to 1.2 m.
    pub ahead: Metres,
    /// Where the straight way to the carrot is free and within this of the field's direction, it is taken instead.
    pub straight: Angle,
    /// Cost added to the cells of a place where the robot got stuck, in quarters of a free cell's; twice that the next time.
    pub shun: u8,
    /// Work in a tick, in units of about 100 instructions on a Cortex-M4; 8 or more. A whole field takes some 170.
    pub budget: u16,
    /// What a tick may cost in all, in the same units, before the field has to wait for the next one; up to 30,000.
    pub tick: u16,
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
                    && far <= costs::MOST_REACH,
                "field.wall_distance, field.halo_distance",
                "above 0, together up to 0.29 m",
            ),
            (
                (1 << 16..=120 << 16).contains(&self.wall.to_bits()),
                "field.wall",
                "1 to 120",
            ),
            (
                (const { Metres::lit("0.15") }..=const { Metres::lit("1.2") })
                    .contains(&self.ahead),
                "field.ahead",
                "0.15 to 1.2 m",
            ),
            (self.budget >= 8, "field.budget", "8 or more"),
            (self.tick <= 30_000, "field.tick", "up to 30000"),
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
    /// Spreading the wave.
    Spread,
}

/// The field.
#[derive(Clone, Debug)]
pub struct Field {
    ground: Ground,
    wave: Wave,
    /// The robot when the field was begun, where the grid lies, and the carrot.
    robot: Point,
    frame: Frame,
    carrot: Point,
    phase: Phase,
    /// The last field's answer.
    way: Option<Way>,
    /// Ticks since it was begun; saturates.
    age: u8,
    /// The way may have become another.
    doubtful: bool,
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
            ground: [[0; LEVELS]; ROWS],
            wave: Wave::new(),
            robot: ORIGIN,
            frame: Frame::NONE,
            carrot: ORIGIN,
            phase: Phase::Idle,
            way: None,
            age: u8::MAX,
            doubtful: false,
            noticed: Vec::new(),
            shunned: Shunned::new(),
        }
    }

    /// Makes a place of the world dear for a while.
    pub fn shun(&mut self, params: &FieldParams, at: Point) {
        self.shunned.add(params.shun, at);
        self.doubtful = true;
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
        self.doubtful |= late || self.way.as_ref().is_some_and(|way| way.passes(at));
    }

    /// The point to head for, world; none before the first field is ready.
    pub fn guide(&self, params: &FieldParams, robot: Point) -> Option<Point> {
        self.way.as_ref().map(|way| way.along(params, robot))
    }

    pub(super) fn digest(&self, digest: &mut Digest) {
        for (levels, reached) in self.ground.iter().zip(self.wave.reached()) {
            for level in levels {
                digest.word(*level);
            }
            digest.word(*reached);
        }
        digest.word(self.wave.round().into());
        if let Some(way) = &self.way {
            digest.point(way.robot);
            digest.point(way.carrot);
        }
        digest.word(u32::from(self.age) << 16 | self.shunned.len() as u32);
    }

    /// A slice of work, of up to so many [units](FieldParams::budget). Returns whether a field was finished.
    pub fn work(
        &mut self,
        params: &FieldParams,
        left: i32,
        costs: &Costs,
        memory: &Memory,
        robot: Point,
        carrot: Point,
    ) -> bool {
        let mut budget = left.min(params.budget.into());
        self.age = self.age.saturating_add(1);
        if self.phase == Phase::Idle && !self.is_stale(params, carrot) {
            return false;
        }
        // Every pass spends budget or moves on to the next of three phases.
        for _ in 0..3 {
            match self.phase {
                Phase::Idle => {
                    self.age = 0;
                    self.doubtful = false;
                    self.noticed.clear();
                    self.begin(robot, carrot);
                    self.phase = Phase::Stamp(0);
                    budget = budget.wrapping_sub(6);
                }
                Phase::Stamp(first) => self.stamp(costs, memory, first, &mut budget),
                Phase::Spread => {
                    if self.wave.spread(&self.ground, costs.wall, &mut budget) {
                        self.arrive(params);
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
        /// Ticks from one field to the next that are enough for what is noticed: it comes in bursts.
        const SOON: u8 = 3;
        let moved = |way: &Way| (way.carrot - carrot).norm_squared() > square(MOVED);
        self.age >= params.refresh
            || self.way.as_ref().is_none_or(moved)
            || (self.doubtful && self.age >= SOON)
    }

    fn begin(&mut self, robot: Point, carrot: Point) {
        self.ground = [[0; LEVELS]; ROWS];
        self.robot = robot;
        self.frame = Frame::around(robot, carrot);
        self.carrot = carrot;
        const SIXTEENTH: i32 = CELL_METRES.bits() / 16;
        let off = carrot - self.frame.to_world(Vector::ZERO);
        let sixteenths = |off: Metres| (off.bits() / SIXTEENTH).clamp(-1 << 15, 1 << 15);
        self.wave
            .begin(self.frame.axes(sixteenths(off.x), sixteenths(off.y)));
    }

    fn stamp(&mut self, costs: &Costs, memory: &Memory, first: u16, budget: &mut i32) {
        // Points change places in their list from tick to tick: one may be missed, until the next field.
        let origin = self.frame.to_grid(memory.to_world(Vector::ZERO));
        let mut index = first;
        while *budget > 0 {
            let Some(point) = memory.local(index.into()) else {
                self.shunned.stamp(&mut self.ground, self.frame);
                nest(&mut self.ground);
                let shunned = self.shunned.len() as i32;
                *budget = budget.wrapping_sub(shunned.wrapping_mul(8).wrapping_add(4));
                self.phase = Phase::Spread;
                return;
            };
            let (x, y) = self.frame.axes(point.x, point.y);
            costs.stamp(&mut self.ground, Vector::new(x, y) + origin);
            index = index.wrapping_add(1);
            *budget = budget.wrapping_sub(1);
        }
        self.phase = Phase::Stamp(index);
    }

    /// Takes over the way found.
    fn arrive(&mut self, params: &FieldParams) {
        let way = self.way.get_or_insert(const { Way::new() });
        way.robot = self.robot;
        way.frame = self.frame;
        way.carrot = self.carrot;
        way.take(params, self.wave.way(), |cell| self.wave.is_source(cell));
        self.doubtful |= self.noticed.iter().any(|at| way.passes(*at));
    }
}
