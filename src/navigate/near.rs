//! What stands near the robot in the frame of the predicted body: the list that the geometry of a tick works on.

use super::digest::Digest;
use super::footprint::Outline;
use super::steps::{Bearing, Steps, Vector};
use crate::geometry::{Point, Pose};
use crate::signals::Twist;
use crate::units::{Angle, Seconds};
use heapless::Vec;

/// The most points: as many as are remembered, so that none that is near is ever left out.
pub const MAX_NEAR: usize = super::memory::CAPACITY;

/// Points closer to the outline than this come first: they decide most questions.
const CLOSE: i16 = Steps::lit("0.15").bits() as i16;

/// A point near the robot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spot {
    x: i16,
    y: i16,
    clearance: i16,
}

impl Spot {
    /// Its place, body frame.
    pub fn at(&self) -> Vector {
        Vector::new(
            Steps::from_bits(self.x.into()),
            Steps::from_bits(self.y.into()),
        )
    }

    /// Its distance from the outline, or up to a hundredth less.
    pub fn clearance(&self) -> Steps {
        Steps::from_bits(self.clearance.into())
    }
}

/// The points near the robot.
#[derive(Clone, Debug, Default)]
pub struct Near {
    spots: Vec<Spot, MAX_NEAR>,
    least: Steps,
}

impl Near {
    /// None.
    pub const fn new() -> Self {
        Self {
            spots: Vec::new(),
            least: Steps::MAX,
        }
    }

    /// Of `places`, in the frame of the body and within ±8 m: the first [`MAX_NEAR`] of them.
    pub fn collect(&mut self, places: impl Iterator<Item = Vector>, outline: &Outline) {
        self.spots.clear();
        for place in places {
            let spot = Spot {
                x: place.x.bits() as i16,
                y: place.y.bits() as i16,
                clearance: 0,
            };
            // There is room for all that a memory holds.
            if self.spots.push(spot).is_err() {
                break;
            }
        }
        // Twice the same: the first one need not tell shapes apart for every point.
        self.least = match outline.rectangle() {
            Some(rectangle) => measure(&mut self.spots, |at| rectangle.clearance_at_least(at)),
            None => measure(&mut self.spots, |at| outline.clearance_at_least(at)),
        };
    }

    pub(super) fn digest(&self, digest: &mut Digest) {
        for spot in &self.spots {
            digest.pair(spot.x, spot.y);
            digest.word(spot.clearance().bits().cast_unsigned());
        }
    }

    pub(super) fn spots(&self) -> &[Spot] {
        &self.spots
    }

    /// Distance of the nearest point from the outline, or up to a hundredth less; 8 m if there is none.
    pub fn clearance(&self) -> Steps {
        self.least
    }

    /// Which of up to 32 places a point is nearer to than `reach`: a bit each, the first one the lowest.
    pub(super) fn touching(&self, places: &[Vector], reach: Steps) -> u32 {
        let mut touched = 0;
        let Some(first) = places.first() else {
            return touched;
        };
        // A box around them all: most points lie outside.
        let (mut least, mut most) = (*first, *first);
        for place in places {
            least = Vector::new(least.x.min(place.x), least.y.min(place.y));
            most = Vector::new(most.x.max(place.x), most.y.max(place.y));
        }
        let margin = Vector::new(reach, reach);
        let (least, most) = (least - margin, most + margin);
        let squared = reach.squared();
        for spot in &self.spots {
            let at = spot.at();
            if at.x <= least.x || at.x >= most.x || at.y <= least.y || at.y >= most.y {
                continue;
            }
            for (bit, place) in (0..32u32).zip(places) {
                if (at - *place).norm_squared() < squared {
                    touched |= 1u32.wrapping_shl(bit);
                }
            }
        }
        touched
    }

    /// How far a straight corridor of this half width is free from the middle of the body, in a direction: to the first
    /// point in it, `most` at most.
    pub fn corridor(&self, direction: Bearing, half_width: Steps, most: Steps) -> Steps {
        let ahead = |spot: &Spot| {
            let place = spot.at().in_frame(direction);
            (place.x > Steps::ZERO && place.y.abs() < half_width).then_some(place.x)
        };
        self.spots
            .iter()
            .filter_map(ahead)
            .min()
            .unwrap_or(most)
            .min(most)
    }
}

/// Works out the clearances and puts the close points first. Returns the least clearance.
#[inline(always)]
fn measure(spots: &mut [Spot], clearance: impl Fn(Vector) -> Steps) -> Steps {
    let mut least = Steps::MAX;
    let mut close = 0usize;
    for index in 0..spots.len() {
        let Some(spot) = spots.get_mut(index) else {
            break;
        };
        let room = clearance(spot.at());
        spot.clearance = room.bits() as i16;
        least = least.min(room);
        if spot.clearance < CLOSE {
            let spot = *spot;
            // In place of the first one that is not close.
            if let Some(earlier) = spots.get_mut(close) {
                let earlier = core::mem::replace(earlier, spot);
                if let Some(place) = spots.get_mut(index) {
                    *place = earlier;
                }
            }
            close = close.wrapping_add(1);
        }
    }
    least
}

/// How the body moves until what is decided now takes effect.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Motion {
    /// Where it will be, in its frame of now.
    pub by: Vector,
    /// How it will be turned.
    pub turn: Bearing,
    /// The same as an angle.
    pub angle: Angle,
}

impl Motion {
    /// Of a twist that is held for some time, along the mean heading.
    pub fn of(twist: Twist, time: Seconds) -> Self {
        let angle = twist.angular.over(time);
        let middle = Angle::from_bits(angle.bits() >> 1);
        Self {
            by: Bearing::of(middle).ahead(Steps::of(twist.linear.over(time))),
            turn: Bearing::of(angle),
            angle,
        }
    }

    /// A place of the body's frame, seen after the motion.
    pub fn sees(&self, place: Vector) -> Vector {
        (place - self.by).in_frame(self.turn)
    }

    /// A pose of the world after the motion.
    pub fn from(&self, pose: Pose) -> Pose {
        let by: Point = self.by.point();
        Pose::new(pose.to_world(by), pose.heading + self.angle)
    }
}
