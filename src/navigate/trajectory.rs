//! Motions of the body in small steps, and how far they stay clear of the points near it.
//!
//! Only points in the box that the body passes through are looked at. Their clearance changes by no more in a step than the
//! body's farthest point moves: where there is room, steps are skipped, and where a bound of the clearance shows
//! the room, no root is taken.

use super::footprint::Outline;
use super::near::Near;
use super::steps::{Bearing, Steps, Vector};
use crate::geometry::Point;
use crate::integer::{quotient, ratio, saturate};
use crate::signals::Twist;
use crate::units::{Angle, Metres, MetresPerSecond, PerMetre, RadiansPerSecond, Seconds};
use heapless::Vec;

/// The most steps of a trajectory.
pub const MAX_STEPS: usize = 48;

/// The most steps of an arc.
const ARC_STEPS: usize = 40;

/// A pose of the body, in its frame of the beginning.
#[derive(Clone, Copy, Debug)]
struct Placed {
    // Steps, which saturate where sixteen bits end.
    x: i16,
    y: i16,
    turn: Bearing,
}

/// Poses one after the other.
#[derive(Clone, Debug)]
pub struct Trajectory {
    poses: Vec<Placed, MAX_STEPS>,
    // Finer than the poses: what many steps lose by rounding is more than a margin has to spare.
    at: Point,
    heading: Angle,
    forward: Bearing,
    /// The longest step, and the largest turn in one.
    advance: Steps,
    turn: Angle,
    /// The box of all its places, the first one's among them.
    least: Vector,
    most: Vector,
}

/// Where a trajectory meets a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Contact {
    /// Whole steps before it.
    pub step: usize,
    /// The part of the next step before it, 8 fractional bits.
    pub part: i32,
}

impl Trajectory {
    /// Standing still.
    pub const fn new() -> Self {
        Self {
            poses: Vec::new(),
            at: Point::new(Metres::ZERO, Metres::ZERO),
            heading: Angle::ZERO,
            forward: Bearing::AHEAD,
            advance: Steps::ZERO,
            turn: Angle::ZERO,
            least: Vector::ZERO,
            most: Vector::ZERO,
        }
    }

    /// Length of a step of [`Trajectory::arc`]: 5/128 m.
    pub const STEP: Steps = Steps::from_bits(160);

    /// `length` metres along an arc, forward or backward, in steps of [`Trajectory::STEP`].
    pub fn arc(curvature: PerMetre, backward: bool, length: Steps) -> Self {
        let mut trajectory = Self::new();
        trajectory.bend(curvature, backward, length);
        trajectory
    }

    /// Becomes an [arc](Self::arc). In place: a copy of all poses costs as much as ten of them.
    pub(super) fn bend(&mut self, curvature: PerMetre, backward: bool, length: Steps) {
        self.clear();
        let step = if backward { -Self::STEP } else { Self::STEP };
        let turn = Angle::from_radians(curvature.get().saturating_mul(
            fixed::types::I16F16::from_bits(step.bits().wrapping_mul(16)),
        ));
        for _ in 0..ARC_STEPS {
            if Self::STEP.bits().wrapping_mul(self.poses.len() as i32) >= length.bits() {
                break;
            }
            self.go(step.metres(), turn);
        }
    }

    /// A period in which the twist goes from `driven` to `twist`, then both parts braked to rest, two steps a period: in a
    /// whole one a corner that turns at 3 rad/s goes 5 cm and may pass a point that neither end shows. What has not
    /// come to rest after [`MAX_STEPS`] ends there.
    pub fn braked(driven: Twist, twist: Twist, brakes: Brakes) -> Self {
        let mut trajectory = Self::new();
        trajectory.brake(driven, twist, brakes);
        trajectory
    }

    fn clear(&mut self) {
        self.poses.clear();
        self.at = Point::new(Metres::ZERO, Metres::ZERO);
        self.heading = Angle::ZERO;
        self.forward = Bearing::AHEAD;
        self.advance = Steps::ZERO;
        self.turn = Angle::ZERO;
        self.least = Vector::ZERO;
        self.most = Vector::ZERO;
    }

    /// Becomes the way of a [braked](Self::braked) twist, in place.
    pub(super) fn brake(&mut self, driven: Twist, twist: Twist, brakes: Brakes) {
        self.clear();
        let (mut before, mut now) = (driven, twist);
        for _ in 0..MAX_STEPS / 2 {
            let mean = brakes.mean(before, now);
            if mean == Twist::REST && now == Twist::REST {
                break;
            }
            let half = Seconds::from_bits(brakes.period.bits() >> 1);
            let (way, turn) = (mean.linear.over(half), mean.angular.over(half));
            self.go(way, turn);
            self.go(way, turn);
            (before, now) = (now, brakes.applied(now));
        }
    }

    fn go(&mut self, way: Metres, turn: Angle) {
        let before = self.forward;
        if turn != Angle::ZERO {
            self.heading = self.heading + turn;
            self.forward = Bearing::of(self.heading);
        }
        // Along the mean of both bearings, which is shorter than one by an eighth of the turn's square: less than a
        // thousandth at 3 rad/s.
        let along = |before: i16, after: i16| {
            let sum = i32::from(before).wrapping_add(after.into());
            Metres::from_bits(way.bits().wrapping_mul(sum) >> 15)
        };
        let [c, s] = before.bits();
        let [cos, sin] = self.forward.bits();
        self.at = self.at + Point::new(along(c, cos), along(s, sin));
        self.advance = self.advance.max(Steps::of(way.abs()) + Steps::from_bits(1));
        if turn.abs().bits() > self.turn.bits() {
            self.turn = turn.abs();
        }
        // The callers' loops end before it is full.
        let at = Vector::of(self.at);
        self.least = Vector::new(self.least.x.min(at.x), self.least.y.min(at.y));
        self.most = Vector::new(self.most.x.max(at.x), self.most.y.max(at.y));
        let _ = self.poses.push(Placed {
            x: at.x.bits() as i16,
            y: at.y.bits() as i16,
            turn: self.forward,
        });
    }

    /// Where it ends.
    pub fn end(&self) -> Vector {
        Vector::of(self.at)
    }

    /// Steps.
    pub fn len(&self) -> usize {
        self.poses.len()
    }

    /// Whether it stands still.
    pub fn is_empty(&self) -> bool {
        self.poses.is_empty()
    }

    /// The first place where a point comes closer to the outline than `margin` while it comes closer still. A point that
    /// is too close already and recedes does not count: else the robot could never leave it.
    pub(super) fn contact(&self, near: &Near, outline: &Outline, margin: Steps) -> Option<Contact> {
        // What the farthest point of the body moves in a step, rounded up.
        let turn = self.turn.radians().to_bits() >> 2;
        let swept = outline.reach.bits().wrapping_mul(turn.min(1 << 15)) >> 14;
        let pace = self.advance.bits().wrapping_add(swept).wrapping_add(2);
        // Whole steps that a room allows, by a product: room · 2^16/pace fits, and the quotient is never too large.
        let reciprocal = (1u32 << 16).checked_div(pace.unsigned_abs()).unwrap_or(0);
        let skipped = |room: Steps| {
            let room = room.bits().max(0).unsigned_abs();
            (room.wrapping_mul(reciprocal) >> 16) as usize
        };
        let mut first = None::<Contact>;
        let mut end = self.poses.len();
        // Farther away than this it is not reached: most points are.
        let reach = pace.wrapping_mul(end as i32);
        let wide = outline.reach + margin;
        let wide = Vector::new(wide, wide);
        let (least, most) = (self.least - wide, self.most + wide);
        for spot in near.spots() {
            let mut before = spot.clearance();
            if (before - margin).bits() >= reach {
                continue;
            }
            let at = spot.at();
            if at.x <= least.x || at.x >= most.x || at.y <= least.y || at.y >= most.y {
                continue;
            }
            let mut step = skipped(before - margin);
            let mut adjacent = step == 0;
            while step < end {
                let Some(pose) = self.poses.get(step) else {
                    break;
                };
                let [x, y] = [pose.x, pose.y].map(|steps| Steps::from_bits(steps.into()));
                let place = (at - Vector::new(x, y)).in_frame(pose.turn);
                let room = skipped(outline.clearance_at_least(place) - margin);
                if room > 0 {
                    adjacent = false;
                    step = step.saturating_add(1).saturating_add(room);
                    continue;
                }
                let here = outline.clearance(place);
                // Where steps were skipped there was room a step ago.
                if here < margin && (!adjacent || here < before) {
                    let part = if adjacent {
                        let room = (before - margin).bits().max(0) << 8;
                        let part = room.checked_div((before - here).bits()).unwrap_or(0);
                        part.clamp(0, 1 << 8)
                    } else {
                        0
                    };
                    first = Some(Contact { step, part });
                    end = step;
                    break;
                }
                before = here;
                let more = skipped(here - margin);
                adjacent = more == 0;
                step = step.saturating_add(1).saturating_add(more);
            }
        }
        first
    }

    /// How far along an [arc](Self::arc) the robot stays clear: all of it at most.
    pub(super) fn free(&self, near: &Near, outline: &Outline, margin: Steps) -> Steps {
        let (steps, part) = match self.contact(near, outline, margin) {
            Some(contact) => (contact.step as i32, contact.part),
            None => (self.poses.len() as i32, 0),
        };
        let step = Self::STEP.bits();
        Steps::from_bits(
            step.wrapping_mul(steps)
                .wrapping_add(step.wrapping_mul(part) >> 8),
        )
    }
}

impl Default for Trajectory {
    fn default() -> Self {
        Self::new()
    }
}

/// What both parts of a twist can lose in a period.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Brakes {
    /// The period.
    pub period: Seconds,
    /// Speed lost in it.
    pub linear: MetresPerSecond,
    /// Yaw rate lost in it.
    pub angular: RadiansPerSecond,
}

impl Brakes {
    /// The twist after a period of full braking.
    pub fn applied(&self, twist: Twist) -> Twist {
        Twist {
            linear: twist.linear - twist.linear.limit(self.linear),
            angular: twist.angular - twist.angular.limit(self.angular),
        }
    }

    /// The mean twist of a period in which the twist goes from one to another as fast as it can, and then holds it:
    /// to − Δ·|Δ|/2b, Δ being the change and b the most that a period can change.
    pub fn mean(&self, from: Twist, to: Twist) -> Twist {
        let mean = |from: i32, to: i32, most: i32| {
            let change = to.saturating_sub(from).min(most).max(most.saturating_neg());
            // The usual cases, without a division: it stays, or changes all that it can.
            let half = most >> 1;
            if change == 0 {
                return to;
            }
            if change == most {
                return to.saturating_sub(half);
            }
            if change == most.saturating_neg() {
                return to.saturating_add(half);
            }
            to.saturating_sub(ratio(change, change.saturating_abs() >> 1, most))
        };
        Twist {
            linear: MetresPerSecond::from_bits(mean(
                from.linear.bits(),
                to.linear.bits(),
                self.linear.bits(),
            )),
            angular: RadiansPerSecond::from_bits(mean(
                from.angular.bits(),
                to.angular.bits(),
                self.angular.bits(),
            )),
        }
    }

    /// From one twist towards another, as far as a period allows.
    pub fn toward(&self, from: Twist, to: Twist) -> Twist {
        Twist {
            linear: from.linear + (to.linear - from.linear).limit(self.linear),
            angular: from.angular + (to.angular - from.angular).limit(self.angular),
        }
    }
}

/// Curvature of a twist, limited to ±`most`; that of turning in place is the limit.
pub(super) fn curvature(twist: Twist, most: PerMetre) -> PerMetre {
    let speed = twist.linear.abs().max(MetresPerSecond::from_bits(1));
    let wide = i64::from(twist.angular.bits()) << 16;
    let exact = quotient(wide, speed.bits()).map_or(0, saturate);
    let exact = PerMetre::from_bits(exact);
    // Driving backward the path bends the other way.
    let signed = if twist.linear < MetresPerSecond::ZERO {
        -exact
    } else {
        exact
    };
    signed.limit(most)
}

/// A length as a plain quantity of another unit with the same fractional bits.
pub(super) fn as_metres(speed: MetresPerSecond) -> Metres {
    Metres::from_bits(speed.bits())
}
