//! Local memory: recent echoes as points, carried along by odometry, so that flanks and the blind rear stay known.
//!
//! A cone's echo says "something stands somewhere on this arc". It first fills the arc with points. As the robot turns and
//! drives, the cones' edges move over the arc: what stands closer than the echo of a cone that surely sees it is disproved,
//! what agrees with an echo is supported, and an echo that is explained by a point adds no other. So the wrong part of the
//! arc is carved away and the right part stays. A silent sensor neither disproves nor supports: if it is dead, nothing is
//! lost.
//!
//! Cost: one pass over the points, each in the view of one to three sensors (of all, if they do not share a place), and at
//! most five new points a sensor. What is far is looked at in every fourth tick only, what no sensor saw in every eighth. A new
//! point takes the place of one a little behind it, so that an obstacle which is neared does not fill the memory; when that
//! is full, the place of one that is farther away, of eight that are looked at. Where an echo's direction is known, as a lidar's
//! is, the new point takes the place of any within 4.5 cm: it is compared with all of them, which no cone's is.

mod judge;

use super::digest::Digest;
use super::footprint::Outline;
use super::near::Motion;
use super::sensors::{Echo, Echoes, Eye, Eyes, View};
use super::steps::{Bearing, Steps, Vector, retain};
use crate::geometry::{Point, Pose};
use crate::units::{Metres, MetresPerSecond};
use fixed::types::I16F16;
use heapless::Vec;
use judge::{FAR, Judge, SENSOR, UNSEEN};

/// The most points.
pub const CAPACITY: usize = 96;

/// The memory's settings.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MemoryParams {
    /// Echoes farther away than this add no points, unless the speed asks for a farther look.
    pub insert: Metres,
    /// Share of a cone's arc that an echo fills, 0 to 1.
    pub arc: I16F16,
    /// A point nearer than its cone's echo by more than this is disproved.
    pub disproof: Metres,
    /// A point within this of its cone's echo is supported.
    pub support: Metres,
    /// An echo nearer than all of its cone's points by more than this is explained by none of them.
    pub nearer: Metres,
    /// Whether supported points are drawn half the way to a nearer echo.
    pub snap: bool,
    /// Points farther away than this are dropped; at most 3.5 m.
    pub keep: Metres,
    /// Ticks without support after which a point is dropped; up to 3200.
    pub lifetime: u16,
}

/// A point of the memory.
#[derive(Clone, Copy, Debug)]
struct Record {
    // Steps from the rolling origin.
    x: i16,
    y: i16,
    /// When it was last supported, in units of [`UNIT`] ticks; wraps.
    seen: u8,
    confidence: u8,
    /// The sensor that it was last seen by, and how it was when it was last looked at ([`UNSEEN`], [`FAR`]).
    eye: u8,
}

/// Points behind the robot matter less: by so much the circle that is looked at lies ahead.
const AHEAD: Steps = Steps::lit("0.35");

/// Ticks in a unit of a record's time, as a power of two: 256 units are more than any lifetime.
const UNIT: u32 = 4;

/// The most points a little behind their echoes that are kept in mind.
const BEHIND: usize = 16;

/// A new point takes the place of one this near to it that is a little behind the echo: it is the same obstacle.
const SAME: Steps = Steps::lit("0.07");

/// A new point of an echo whose direction is known takes the place of any point this near to it: a lidar sees a little
/// farther round every obstacle with each tick, and would fill the memory with one of them.
const APART: Steps = Steps::lit("0.045");

/// Disproofs that a supported point survives, and one.
const SURE: u8 = 2;

/// The points, and the place that they are counted from.
#[derive(Clone, Debug)]
pub struct Memory {
    records: Vec<Record, CAPACITY>,
    origin: Point,
    tick: u32,
    /// The point that was last looked at for its place.
    looked: u8,
    /// Points that were a little behind their sensor's echo in the last update.
    behind: Vec<u8, BEHIND>,
    /// Points that were looked at in the last update.
    judged: u8,
    /// Of the last update: the body in the frame of the points.
    body: Vector,
    forward: Bearing,
}

impl Default for Memory {
    fn default() -> Self {
        Self::new()
    }
}

impl Memory {
    /// Nothing seen yet.
    pub const fn new() -> Self {
        Self {
            records: Vec::new(),
            origin: Point::new(Metres::ZERO, Metres::ZERO),
            tick: 0,
            looked: 0,
            behind: Vec::new(),
            judged: 0,
            body: Vector::new(Steps::ZERO, Steps::ZERO),
            forward: Bearing::AHEAD,
        }
    }

    /// Points remembered.
    pub fn len(&self) -> usize {
        self.records.len()
    }

    /// Whether nothing is remembered.
    pub fn is_empty(&self) -> bool {
        self.records.is_empty()
    }

    /// The points, body frame of the last update.
    pub fn points(&self) -> impl Iterator<Item = Vector> + '_ {
        self.records
            .iter()
            .map(|record| (record.at() - self.body).in_frame(self.forward))
    }

    /// The point with this index in the frame of [`Memory::to_local`].
    pub(super) fn local(&self, index: usize) -> Option<Vector> {
        self.records.get(index).map(Record::at)
    }

    /// A place of the world from the rolling origin; saturates at ±8 m.
    pub(super) fn to_local(&self, world: Point) -> Vector {
        Vector::of(world - self.origin)
    }

    /// A place seen from the rolling origin in the world.
    pub(super) fn to_world(&self, local: Vector) -> Point {
        self.origin + local.point()
    }

    pub(super) fn digest(&self, digest: &mut Digest) {
        for record in &self.records {
            digest.pair(record.x, record.y);
            digest.pair(record.seen.into(), record.confidence.into());
        }
        digest.point(self.origin);
        digest.word(self.tick);
        digest.word(self.looked.into());
    }

    /// The points up to `look` ahead of a body that has moved by `moved` since the last update, in its frame: those in the
    /// circle that ends there, [`AHEAD`] of its middle.
    pub(super) fn seen_from(
        &self,
        moved: Motion,
        look: Steps,
    ) -> impl Iterator<Item = Vector> + '_ {
        let body = self.body + moved.by.turned(self.forward);
        let turn = self.forward.turned(moved.turn);
        let middle = body + turn.ahead(AHEAD);
        let look = (look - AHEAD).squared();
        self.records.iter().filter_map(move |record| {
            let at = record.at();
            ((at - middle).norm_squared() < look).then(|| (at - body).in_frame(turn))
        })
    }

    /// Takes over a tick's echoes, seen from `pose`, and tells `new` of the places, world, where points are added.
    #[allow(clippy::too_many_arguments, reason = "a tick's inputs")]
    pub(super) fn update<const N: usize>(
        &mut self,
        params: &MemoryParams,
        outline: &Outline,
        eyes: &Eyes<N>,
        echoes: &Echoes<N>,
        pose: Pose,
        speed: MetresPerSecond,
        mut new: impl FnMut(Point),
    ) {
        self.tick = self.tick.wrapping_add(1);
        self.place(pose);
        let judge = Judge::new(params, outline, eyes, echoes, self);
        let explained = self.judge(&judge);
        let farthest = insertion_range(params, speed);
        let mut heard = judge.heard & !explained;
        while heard != 0 {
            let index = heard.trailing_zeros() as usize;
            heard &= heard.wrapping_sub(1);
            if let Some(eye) = eyes.as_slice().get(index)
                && let Some(echo) = echoes.as_slice().get(index)
                && echo.range().is_some_and(|range| range <= farthest)
                && let Some(at) = self.insert_arc(eye, index as u8, *echo)
            {
                new(at);
            }
        }
    }

    /// Assumes that something stands at a range across a sensor's cone, unless a point there says so already.
    pub(super) fn assume(&mut self, params: &MemoryParams, index: u8, eye: &Eye, range: Steps) {
        let support = Steps::of(params.support);
        let known = self.points().any(|place| {
            let from_eye = place - eye.at;
            let off = from_eye.norm() - range;
            eye.view(from_eye).0 != View::Outside && off.abs() < support
        });
        if !known {
            self.insert_arc(eye, index, Echo::Across(range));
        }
    }

    /// Forgets what can be seen again or is far: everything but the near points that no sensor looks at and those that the
    /// outline nearly touches (4 cm): of them a new echo would tell the distance, but not the place.
    pub fn forget_doubtful<const N: usize>(&mut self, eyes: &Eyes<N>, outline: &Outline) {
        const NEAR: Steps = Steps::lit("1");
        const NEARLY: Steps = Steps::lit("0.04");
        let (body, forward) = (self.body, self.forward);
        let near = (outline.reach + NEAR).squared();
        retain(&mut self.records, |record| {
            let away = record.at() - body;
            if away.norm_squared() > near {
                return false;
            }
            let place = away.in_frame(forward);
            let room = outline.clearance_at_least(place);
            room < NEARLY
                || (room < NEAR && eyes.seeing(place, &mut record.sensor(), |_, _, _, _| false))
        });
    }

    /// Moves the origin after the robot, so that sixteen bits stay enough.
    fn place(&mut self, pose: Pose) {
        const FAR: Steps = Steps::lit("4");
        let away = Vector::of(pose.at - self.origin);
        if away.x.abs() > FAR || away.y.abs() > FAR {
            // By whole steps, or the points would creep.
            let moved = if away.x.abs() < Steps::MAX && away.y.abs() < Steps::MAX {
                retain(&mut self.records, |record| record.shift(away));
                away.point()
            } else {
                self.records.clear();
                pose.at - self.origin
            };
            self.origin = self.origin + moved;
        }
        self.body = self.to_local(pose.at);
        self.forward = Bearing::of(pose.heading);
    }

    /// Supports, disproves and drops points. Returns the sensors whose echo they explain, a bit each.
    fn judge<const N: usize>(&mut self, judge: &Judge<'_, N>) -> u32 {
        /// What rests, by the tick and the number of a point: the far ones but in every fourth tick, those that no sensor
        /// saw but in every eighth.
        const RESTS: [u8; 8] = {
            let mut rests = [FAR | UNSEEN; 8];
            rests[0] = 0;
            rests[4] = UNSEEN;
            rests
        };
        let mut explained = 0;
        let mut index = 0usize;
        self.behind.clear();
        let mut judged = 0u8;
        let mut phase = self.tick as usize;
        while let Some(record) = self.records.get_mut(index) {
            phase = phase.wrapping_add(1);
            if record.eye & RESTS[phase & 7] != 0 {
                index = index.wrapping_add(1);
                continue;
            }
            judged = judged.wrapping_add(1);
            let mut behind = false;
            if judge.keeps(record, &mut explained, &mut behind) {
                if behind {
                    // If there are more, two points may stand for one place.
                    let _ = self.behind.push(index as u8);
                }
                index = index.wrapping_add(1);
                continue;
            }
            // The last one takes its place, and is next.
            let last = self.records.pop();
            if let (Some(place), Some(last)) = (self.records.get_mut(index), last) {
                *place = last;
            }
        }
        self.judged = judged;
        explained
    }

    /// Points that were looked at in the last update.
    pub(super) fn judged(&self) -> u32 {
        self.judged.into()
    }

    /// Fills the arc that an echo may come from. Returns its middle, world.
    fn insert_arc(&mut self, eye: &Eye, index: u8, echo: Echo) -> Option<Point> {
        /// Points are at most so far apart, but five are the most.
        const SPACED: i32 = Steps::lit("0.073").bits();
        let (range, axis, count) = match echo {
            Echo::Silent => return None,
            Echo::At(range, aside) => (range, Bearing::of(eye.heading + aside), 1),
            Echo::Across(range) => {
                let arc = range.share(eye.filled).bits();
                (range, eye.axis, arc.wrapping_add(SPACED) / SPACED)
            }
        };
        let (at, body, forward) = (eye.at, self.body, self.forward);
        let place = |turn: Bearing| body + (at + turn.ahead(range).turned(axis)).turned(forward);
        let middle = place(Bearing::AHEAD);
        let exact = matches!(echo, Echo::At(..));
        if count != 2 {
            self.insert(middle, index, exact);
        }
        if count >= 2 {
            self.insert(place(eye.flank), index, exact);
            self.insert(place(eye.flank.mirrored()), index, exact);
        }
        if count > 3 {
            self.insert(place(eye.inner), index, exact);
            self.insert(place(eye.inner.mirrored()), index, exact);
        }
        Some(self.to_world(middle))
    }

    fn insert(&mut self, place: Vector, eye: u8, exact: bool) {
        let seen = (self.tick >> UNIT) as u8;
        let Some(record) = Record::new(place, seen, eye) else {
            return;
        };
        let same = |known: &&mut Record| {
            known.sensor() == eye && (known.at() - place).norm_squared() < const { SAME.squared() }
        };
        for index in &self.behind {
            if let Some(known) = self.records.get_mut(usize::from(*index)).filter(same) {
                *known = record;
                return;
            }
        }
        let close =
            |known: &&mut Record| (known.at() - place).norm_squared() < const { APART.squared() };
        if exact && let Some(known) = self.records.iter_mut().find(close) {
            *known = record;
        } else if self.records.push(record).is_err() {
            self.replace(record);
        }
    }

    /// Puts a point in the place of one that is farther away: the farthest of a few, which are others the next time.
    fn replace(&mut self, record: Record) {
        const LOOKED: usize = 8;
        let away = |record: &Record| (record.at() - self.body).norm_squared();
        let mut farthest = (away(&record), None);
        for _ in 0..LOOKED {
            self.looked = self.looked.wrapping_add(1) % CAPACITY as u8;
            let known = self.records.get(usize::from(self.looked));
            let known = known.map_or(0, away);
            if known > farthest.0 {
                farthest = (known, Some(self.looked));
            }
        }
        if let Some(place) = farthest
            .1
            .and_then(|index| self.records.get_mut(usize::from(index)))
        {
            *place = record;
        }
    }
}

/// How far echoes matter at a speed: what reacting and braking take, v/5 + v²/3, and 0.4 m.
pub(super) fn insertion_range(params: &MemoryParams, speed: MetresPerSecond) -> Steps {
    let speed = Steps::of(Metres::from_bits(speed.abs().bits()));
    let braking = Steps::from_bits((speed.squared() / (3 << 12)) as i32);
    let fifth = Steps::from_bits(speed.bits() / 5);
    Steps::of(params.insert).max(const { Steps::lit("0.4") } + fifth + braking)
}

impl Record {
    fn new(place: Vector, seen: u8, eye: u8) -> Option<Self> {
        let [x, y] = narrow(place)?;
        Some(Self {
            x,
            y,
            seen,
            confidence: SURE,
            eye,
        })
    }

    fn at(&self) -> Vector {
        Vector::new(
            Steps::from_bits(self.x.into()),
            Steps::from_bits(self.y.into()),
        )
    }

    /// Index of the sensor that it was last seen by.
    fn sensor(&self) -> u8 {
        self.eye & SENSOR
    }

    /// Puts it elsewhere, if that fits; whether it does.
    fn move_to(&mut self, place: Vector) -> bool {
        narrow(place)
            .map(|[x, y]| (self.x, self.y) = (x, y))
            .is_some()
    }

    /// Counted from an origin that moved; whether it still fits.
    fn shift(&mut self, moved: Vector) -> bool {
        self.move_to(self.at() - moved)
    }
}

/// A place in sixteen bits, if they are enough.
fn narrow(place: Vector) -> Option<[i16; 2]> {
    let narrow = |steps: Steps| i16::try_from(steps.bits()).ok();
    Some([narrow(place.x)?, narrow(place.y)?])
}

#[cfg(test)]
mod tests {
    use super::super::presets;
    use super::{Echoes, Memory};
    use crate::geometry::Pose;
    use crate::ports::{Range, RangeReading};
    use crate::units::{Metres, MetresPerSecond};

    #[test]
    fn what_is_nearly_touched_is_not_forgotten() {
        let setup = presets::jackal::<16>().setup().unwrap();
        let kept = |ranges: [&str; 2]| {
            let mut readings = [RangeReading::fresh(Range::Clear); 16];
            for (reading, range) in readings[7..].iter_mut().zip(ranges) {
                *reading = RangeReading::fresh(Range::Echo(Metres::lit(range)));
            }
            let mut echoes = Echoes::<16>::new();
            echoes.take(&setup.eyes, &readings, MetresPerSecond::ZERO);
            let mut memory = Memory::new();
            let params = &setup.params.memory;
            memory.update(
                params,
                &setup.outline,
                &setup.eyes,
                &echoes,
                Pose::default(),
                MetresPerSecond::ZERO,
                |_| (),
            );
            let known = memory.len();
            memory.forget_doubtful(&setup.eyes, &setup.outline);
            (known, memory.len())
        };
        // The outline's front is 0.254 m ahead of the sensors.
        assert_eq!(kept(["0.28", "0.8"]), (2, 1));
        assert_eq!(kept(["0.28", "0.28"]), (2, 2));
        assert_eq!(kept(["0.8", "0.8"]), (2, 0));
    }
}
