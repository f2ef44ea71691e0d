//! Motions of the body in small steps, and how far they stay clear of the points near it.
//!
//! Only points in the box that the body passes through are looked at. Their clearance changes by no more in a step than the
//! body's farthest point moves: where there is room, steps are skipped.

use super::footprint::Outline;
use super::near::{Near, Spot};
use super::steps::{Bearing, Steps, Vector};
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
    x: i32,
    y: i32,
    forward: Turn,
    /// The longest step, and the largest turn in one.
    advance: Steps,
    turn: Angle,
    /// The box of all its places, the first one's among them.
    least: Vector,
    most: Vector,
    /// Curvature of an arc, 12 fractional bits.
    arc: Option<i32>,
    /// How often a point was looked at from one of its places, of all that this has been.
    pub(super) looked: u32,
}

/// Fractional bits of [`Turn`].
const TURN_BITS: u32 = 15;

/// A turn as cosine and sine. Steps are turned by one after the other: each loses 2⁻¹⁶ of its length at most.
#[derive(Clone, Copy, Debug)]
struct Turn {
    cos: i32,
    sin: i32,
}

impl Turn {
    const NONE: Self = Self {
        cos: 1 << TURN_BITS,
        sin: 0,
    };

    fn of(angle: Angle) -> Self {
        if angle == Angle::ZERO {
            return Self::NONE;
        }
        let (cos, sin) = angle.cos_sin();
        let [cos, sin] = [cos, sin].map(|c| c.to_bits().wrapping_add(1 << 14) >> 15);
        Self { cos, sin }
    }

    fn turned(self, by: Self) -> Self {
        const HALF: i32 = 1 << (TURN_BITS - 1);
        let cos = (self.cos.wrapping_mul(by.cos)).wrapping_sub(self.sin.wrapping_mul(by.sin));
        let sin = (self.sin.wrapping_mul(by.cos)).wrapping_add(self.cos.wrapping_mul(by.sin));
        Self {
            cos: cos.wrapping_add(HALF) >> TURN_BITS,
            sin: sin.wrapping_add(HALF) >> TURN_BITS,
        }
    }

    /// With 14 fractional bits.
    fn bearing(self) -> Bearing {
        Bearing::from_bits((self.cos >> 1) as i16, (self.sin >> 1) as i16)
    }
}

/// What the body sweeps along an arc: between two circles around the point that it turns about. A place p lies
/// y − κ·|p|²/2 beside the arc, which is (R² − d²)/2R with its distance d from that point and R = 1/κ: h at most on the inner
/// side, h + (h² + l²)·κ/2 on the outer one, for a body of half width h and half length l.
#[derive(Clone, Copy, Debug)]
struct Band {
    /// 12 fractional bits.
    curvature: i32,
    right: Steps,
    left: Steps,
}

impl Band {
    /// Of no arc: everything.
    const ALL: Self = Self {
        curvature: 0,
        right: Steps::from_bits(i32::MIN),
        left: Steps::from_bits(i32::MAX),
    };

    /// Curvature, and square of a distance, both with 12 fractional bits, whose product still fits: 7.9/m and 16 m².
    const MOST: (i32, i32) = (32_358, 1 << 16);

    fn new(arc: Option<i32>, outline: &Outline, margin: Steps) -> Self {
        /// What poses and clearances are rounded by.
        const SLACK: Steps = Steps::lit("0.005");
        let Some(curvature) = arc.filter(|arc| arc.wrapping_abs() <= Self::MOST.0) else {
            return Self::ALL;
        };
        let wide = outline.half_width + margin + SLACK;
        let long = outline.reach + margin;
        let squared = wide.squared().wrapping_add(long.squared()) >> 12;
        let outer = curvature.wrapping_abs().wrapping_mul(squared as i32) >> 13;
        let outer = wide + Steps::from_bits(outer);
        let (right, left) = if curvature < 0 {
            (wide, outer)
        } else {
            (outer, wide)
        };
        Self {
            curvature,
            right: -right,
            left,
        }
    }

    /// Whether the body passes beside a place without touching it.
    fn passes_beside(&self, at: Vector) -> bool {
        let squared = (at.norm_squared() >> 12) as i32;
        if squared > Self::MOST.1 {
            return false;
        }
        let bent = self.curvature.wrapping_mul(squared) >> 13;
        let beside = at.y - Steps::from_bits(bent);
        beside < self.right || beside > self.left
    }
}

/// Where a trajectory meets a point.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Contact {
    /// Whole steps before it.
    pub step: usize,
    /// The part of the next step before it, 8 fractional bits.
    pub part: i32,
    /// Index of the point.
    pub spot: usize,
}

impl Trajectory {
    /// Standing still.
    pub const fn new() -> Self {
        Self {
            poses: Vec::new(),
            x: 0,
            y: 0,
            forward: Turn::NONE,
            advance: Steps::ZERO,
            turn: Angle::ZERO,
            least: Vector::ZERO,
            most: Vector::ZERO,
            arc: None,
            looked: 0,
        }
    }

    /// Length of a step along an [arc](Trajectory::arc), 10/128 m, or half of that where it bends by [`Trajectory::BENT`] or
    /// more.
    pub const STEP: Steps = Steps::from_bits(320);

    /// In longer steps a corner would cut too much of the way between them.
    pub const BENT: PerMetre = PerMetre::lit("1.5");

    /// `length` metres along an arc, forward or backward.
    pub fn arc(curvature: PerMetre, backward: bool, length: Steps) -> Self {
        let mut trajectory = Self::new();
        trajectory.bend(curvature, backward, length);
        trajectory
    }

    /// Becomes an [arc](Self::arc), in place: a copy of all poses costs as much as ten of them. Returns the length of its
    /// steps.
    pub(super) fn bend(&mut self, curvature: PerMetre, backward: bool, length: Steps) -> Steps {
        self.clear();
        let step = if curvature.abs() < Self::BENT {
            Self::STEP
        } else {
            Self::STEP.half()
        };
        let forth = if backward { -step } else { step }.metres();
        let turn = Angle::from_radians(
            curvature
                .get()
                .saturating_mul(fixed::types::I16F16::from_bits(forth.bits())),
        );
        self.steps_are(forth, turn);
        self.arc = Some(curvature.bits() >> 4);
        let turn = Turn::of(turn);
        for _ in 0..ARC_STEPS {
            if step.bits().wrapping_mul(self.poses.len() as i32) >= length.bits() {
                break;
            }
            self.go(forth, turn);
        }
        step
    }

    /// A period in which the twist goes from `driven` to `twist`, then both parts braked to rest. In a period that turns by
    /// more than 3° two steps: in a whole one a corner that turns at 3 rad/s goes 5 cm and may pass a point that neither
    /// end shows. What has not come to rest after half of [`MAX_STEPS`] periods ends there.
    pub fn braked(driven: Twist, twist: Twist, brakes: Brakes) -> Self {
        let mut trajectory = Self::new();
        trajectory.brake(driven, twist, brakes);
        trajectory
    }

    fn clear(&mut self) {
        self.poses.clear();
        (self.x, self.y) = (0, 0);
        self.forward = Turn::NONE;
        self.advance = Steps::ZERO;
        self.turn = Angle::ZERO;
        self.least = Vector::ZERO;
        self.most = Vector::ZERO;
        self.arc = None;
    }

    /// Becomes the way of a [braked](Self::braked) twist, in place.
    pub(super) fn brake(&mut self, driven: Twist, twist: Twist, brakes: Brakes) {
        const MUCH: Angle = Angle::deg("3");
        self.clear();
        let (mut before, mut now) = (driven, twist);
        for _ in 0..MAX_STEPS / 2 {
            let mean = brakes.mean(before, now);
            if mean == Twist::REST && now == Twist::REST {
                break;
            }
            let (mut way, mut turn) = (
                mean.linear.over(brakes.period),
                mean.angular.over(brakes.period),
            );
            let twice = turn.abs().bits() > MUCH.bits();
            if twice {
                way = Metres::from_bits(way.bits() >> 1);
                turn = Angle::from_bits(turn.bits() >> 1);
            }
            self.steps_are(way, turn);
            let turn = Turn::of(turn);
            self.go(way, turn);
            if twice {
                self.go(way, turn);
            }
            (before, now) = (now, brakes.applied(now));
        }
    }

    /// Notes how long the next steps are.
    fn steps_are(&mut self, way: Metres, turn: Angle) {
        self.advance = self.advance.max(Steps::of(way.abs()) + Steps::from_bits(1));
        if turn.abs().bits() > self.turn.bits() {
            self.turn = turn.abs();
        }
    }

    #[inline(always)]
    fn go(&mut self, way: Metres, turn: Turn) {
        let before = self.forward;
        let after = before.turned(turn);
        self.forward = after;
        // Along the mean of both bearings, which is shorter than one by an eighth of the turn's square: less than a
        // thousandth at 3 rad/s. A step is less than half a metre: the product fits.
        let along = |before: i32, after: i32| {
            way.bits().wrapping_mul(before.wrapping_add(after) >> 1) >> TURN_BITS
        };
        self.x = self.x.wrapping_add(along(before.cos, after.cos));
        self.y = self.y.wrapping_add(along(before.sin, after.sin));
        let steps = |bits: i32| (bits >> 4).clamp(i16::MIN.into(), i16::MAX.into());
        let (x, y) = (steps(self.x), steps(self.y));
        let at = Vector::new(Steps::from_bits(x), Steps::from_bits(y));
        self.least = Vector::new(self.least.x.min(at.x), self.least.y.min(at.y));
        self.most = Vector::new(self.most.x.max(at.x), self.most.y.max(at.y));
        // The callers' loops end before it is full.
        let _ = self.poses.push(Placed {
            x: x as i16,
            y: y as i16,
            turn: after.bearing(),
        });
    }

    /// Where it ends.
    pub fn end(&self) -> Vector {
        let [x, y] = [self.x, self.y].map(|bits| Steps::of(Metres::from_bits(bits)));
        Vector::new(x, y)
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
    pub(super) fn contact(
        &mut self,
        near: &Near,
        outline: &Outline,
        margin: Steps,
    ) -> Option<Contact> {
        self.search::<false>(near.spots(), outline, margin)
    }

    /// The index of a point that has such a place: the first one found is enough. That of `suspect` is looked at before all
    /// others: what one motion meets the next one like it often meets, too.
    pub(super) fn touches(
        &mut self,
        near: &Near,
        outline: &Outline,
        margin: Steps,
        suspect: Option<usize>,
    ) -> Option<usize> {
        let mut meets = |spots: &[Spot]| Some(self.search::<true>(spots, outline, margin)?.spot);
        let first = suspect.and_then(|index| near.spots().get(index..=index));
        if first.is_some_and(|spot| meets(spot).is_some()) {
            return suspect;
        }
        meets(near.spots())
    }

    /// The first place of all, or of the first point that has one.
    fn search<const ANY: bool>(
        &mut self,
        spots: &[Spot],
        outline: &Outline,
        margin: Steps,
    ) -> Option<Contact> {
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
        let band = Band::new(self.arc, outline, margin);
        let mut looked = 0u32;
        let mut later = spots;
        while let [spot, others @ ..] = later {
            later = others;
            let mut before = spot.clearance();
            if (before - margin).bits() >= reach {
                continue;
            }
            let at = spot.at();
            if at.x <= least.x || at.x >= most.x || at.y <= least.y || at.y >= most.y {
                continue;
            }
            if band.passes_beside(at) {
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
                let here = outline.clearance_at_least(place);
                looked = looked.wrapping_add(1);
                // Where steps were skipped there was room a step ago.
                if here < margin && (!adjacent || here < before) {
                    let part = if adjacent {
                        let room = (before - margin).bits().max(0) << 8;
                        let part = room.checked_div((before - here).bits()).unwrap_or(0);
                        part.clamp(0, 1 << 8)
                    } else {
                        0
                    };
                    let spot = spots.len().wrapping_sub(later.len()).wrapping_sub(1);
                    first = Some(Contact { step, part, spot });
                    if ANY {
                        later = &[];
                    }
                    end = step;
                    break;
                }
                before = here;
                let more = skipped(here - margin);
                adjacent = more == 0;
                step = step.saturating_add(1).saturating_add(more);
            }
        }
        self.looked = self.looked.wrapping_add(looked);
        first
    }

    /// How far along an [arc](Self::arc) in such steps the robot stays clear: all of it at most.
    pub(super) fn free(
        &mut self,
        near: &Near,
        outline: &Outline,
        margin: Steps,
        step: Steps,
    ) -> Steps {
        let (steps, part) = match self.contact(near, outline, margin) {
            Some(contact) => (contact.step as i32, contact.part),
            None => (self.poses.len() as i32, 0),
        };
        Steps::from_bits(
            step.bits()
                .wrapping_mul(steps)
                .wrapping_add(step.bits().wrapping_mul(part) >> 8),
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
            // Twists that are driven: a division of 32 bits.
            let size = change.unsigned_abs();
            let mean = size
                .checked_mul(size >> 1)
                .and_then(|product| product.checked_div(u32::try_from(most).ok()?));
            let part = match mean {
                Some(part) if change < 0 => (part as i32).wrapping_neg(),
                Some(part) => part as i32,
                None => ratio(change, change.saturating_abs() >> 1, most),
            };
            to.saturating_sub(part)
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

#[cfg(test)]
mod tests {
    use super::{Band, Brakes, Trajectory};
    use crate::geometry::Point;
    use crate::navigate::footprint::{Footprint, Outline};
    use crate::navigate::near::Near;
    use crate::navigate::steps::{Steps, Vector};
    use crate::signals::Twist;
    use crate::units::{Metres, MetresPerSecond, PerMetre, RadiansPerSecond, Seconds};

    /// Numbers that look random, 0 to `end` − 1.
    fn random(state: &mut u64, end: i32) -> i32 {
        *state = state
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1);
        ((*state >> 33) % end as u64) as i32
    }

    fn outlines() -> [Outline; 3] {
        let at = |x: &str, y: &str| Point::new(Metres::lit(x), Metres::lit(y));
        let rectangle = Footprint::Rectangle {
            front: Metres::lit("0.254"),
            rear: Metres::lit("0.2"),
            half_width: Metres::lit("0.215"),
        };
        let vertices = [
            at("0.3", "0"),
            at("0.1", "0.2"),
            at("-0.3", "0.15"),
            at("-0.2", "-0.1"),
        ];
        let polygon = Footprint::Polygon(heapless::Vec::from_slice(&vertices).unwrap());
        let disc = Footprint::Disc {
            radius: Metres::lit("0.2"),
        };
        [rectangle, polygon, disc].map(|footprint| {
            footprint.check().unwrap();
            footprint.outline()
        })
    }

    fn places<const N: usize>(state: &mut u64) -> [Vector; N] {
        let mut along = || Steps::from_bits(random(state, 16_000) - 8000);
        core::array::from_fn(|_| Vector::new(along(), along()))
    }

    #[test]
    fn what_an_arc_passes_beside_is_what_it_does_not_meet() {
        let mut state = 3;
        let (mut met, mut beside) = (0, 0);
        for outline in &outlines() {
            for _ in 0..4000 {
                let curvature = match random(&mut state, 4) {
                    0 => PerMetre::ZERO,
                    1 => PerMetre::from_bits(random(&mut state, 24 << 16) - (12 << 16)),
                    _ => PerMetre::from_bits(random(&mut state, 4 << 16) - (2 << 16)),
                };
                let backward = random(&mut state, 2) == 0;
                let length = Steps::from_bits(random(&mut state, 10_000));
                let margin = Steps::from_bits(random(&mut state, 400));
                let mut near = Near::new();
                let found: [Vector; 6] = places(&mut state);
                near.collect(found.into_iter(), outline);
                let mut arc = Trajectory::arc(curvature, backward, length);
                let contact = arc.contact(&near, outline, margin);
                let band = Band::new(arc.arc, outline, margin);
                beside += found.iter().filter(|at| band.passes_beside(**at)).count();
                // The same poses, of which it is not known that they are an arc.
                arc.arc = None;
                assert_eq!(
                    arc.contact(&near, outline, margin),
                    contact,
                    "{curvature:?}"
                );
                met += u32::from(contact.is_some());
            }
        }
        assert!(met > 2000 && beside > 20_000, "{met}, {beside}");
    }

    #[test]
    fn who_is_suspected_changes_no_answer() {
        let mut state = 5;
        let brakes = Brakes {
            period: Seconds::lit("0.05"),
            linear: MetresPerSecond::lit("0.125"),
            angular: RadiansPerSecond::lit("0.4"),
        };
        let (mut met, mut other) = (0, 0);
        for outline in &outlines() {
            for _ in 0..4000 {
                let twist = Twist {
                    linear: MetresPerSecond::from_bits(random(&mut state, 1 << 17) - (1 << 15)),
                    angular: RadiansPerSecond::from_bits(random(&mut state, 6 << 16) - (3 << 16)),
                };
                let margin = Steps::from_bits(random(&mut state, 400));
                let mut near = Near::new();
                near.collect(places::<30>(&mut state).into_iter(), outline);
                let mut way = Trajectory::braked(twist, twist, brakes);
                let found = way.touches(&near, outline, margin, None);
                let suspect = random(&mut state, 40) as usize;
                let again = way.touches(&near, outline, margin, Some(suspect));
                assert_eq!(found.is_some(), again.is_some(), "{twist:?}");
                met += u32::from(found.is_some());
                other += u32::from(again == Some(suspect) && again != found);
                // Who was found is found again.
                if let Some(index) = found {
                    assert_eq!(way.touches(&near, outline, margin, found), Some(index));
                }
            }
        }
        assert!(met > 2000 && other > 10, "{met}, {other}");
    }
}
