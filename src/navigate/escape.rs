//! Out of a place where no heading is admissible: back the way that it came, or the best of six short arcs, three of them
//! backward, or a turn in place.

use super::barrier::BarrierParams;
use super::footprint::Outline;
use super::near::Near;
use super::polar::PolarMap;
use super::steps::Steps;
use super::trajectory::Trajectory;
use super::way_back::Retreat;
use crate::signals::Twist;
use crate::units::{Angle, MetresPerSecond, PerMetre, RadiansPerSecond};

/// Speed of an arc.
const SPEED: MetresPerSecond = MetresPerSecond::lit("0.28");
/// Yaw rate in place.
const TURN: RadiansPerSecond = RadiansPerSecond::lit("1");
/// Ticks for which a choice is kept before the next one is thought about; that takes one more an arc.
const KEPT: u8 = 5;
/// How far an arc is looked along.
const LOOK: Steps = Steps::lit("0.35");
/// What an arc costs beside its looks at points, as looks.
const ARC: u32 = 15;
/// An arc that is free for less is none.
const LEAST: Steps = Steps::lit("0.05");

/// The arcs: backward or forward, and how they bend.
const ARCS: [(bool, PerMetre); 6] = {
    let bend = PerMetre::lit("2");
    let other = PerMetre::lit("-2");
    [
        (true, PerMetre::ZERO),
        (true, bend),
        (true, other),
        (false, PerMetre::ZERO),
        (false, bend),
        (false, other),
    ]
};

/// An arc that can be driven, and what it is worth.
type Choice = Option<(i32, Twist)>;

/// The choice that is being driven.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Escape {
    twist: Twist,
    left: u8,
    /// What was looked along for the next choice: the way back, then the arcs.
    looked: u8,
    /// The best of them, and of those that go on the way of the last choice.
    best: Choice,
    on: Choice,
    /// How often a point was looked at in this tick, and some more for an arc.
    pub looked_at: u32,
}

impl Escape {
    /// None chosen.
    pub const fn new() -> Self {
        Self {
            twist: Twist::REST,
            left: 0,
            looked: 0,
            best: None,
            on: None,
            looked_at: 0,
        }
    }

    /// The motion to escape by; chosen anew every few ticks: the way `back` as far as there is one and it is free, else the
    /// best arc. `direction` is the one to get to, body frame. The first choice is thought about at rest, others while the
    /// last one is driven.
    pub fn drive(
        &mut self,
        near: &Near,
        outline: &Outline,
        map: &PolarMap,
        barrier: &BarrierParams,
        direction: Angle,
        back: impl FnOnce() -> Option<Retreat>,
    ) -> Twist {
        self.looked_at = 0;
        if let Some(left) = self.left.checked_sub(1) {
            self.left = left;
            return self.twist;
        }
        // One a tick: it costs as much as half a guard.
        if self.looked == 0 {
            self.looked = 1;
            if let Some(retreat) = back() {
                let (free, looked_at) = retreat.free(near, outline);
                self.looked_at = looked_at.wrapping_add(ARC);
                if free >= LEAST {
                    self.keep(along(true, retreat.curvature));
                }
                return self.twist;
            }
        }
        if let Some(bent) = ARCS.get(usize::from(self.looked).wrapping_sub(1)) {
            self.looked = self.looked.wrapping_add(1);
            let margin = barrier.arc_margin(bent.0);
            let (choice, looked_at) = arc(near, outline, margin, direction, *bent);
            self.looked_at = looked_at.wrapping_add(ARC);
            let better = |known: Choice| match (known, choice) {
                (Some((known, _)), Some((worth, _))) => worth > known,
                (None, Some(_)) => true,
                _ => false,
            };
            if better(self.best) {
                self.best = choice;
            }
            // On the way of the last choice as long as it goes on: a robot that goes to and fro leaves nothing.
            let backward = bent.0;
            let goes_on = match self.twist.linear {
                speed if speed < MetresPerSecond::ZERO => backward,
                speed => speed > MetresPerSecond::ZERO && !backward,
            };
            if goes_on && better(self.on) {
                self.on = choice;
            }
        }
        if usize::from(self.looked) > ARCS.len() {
            let choice = self.on.or(self.best);
            self.keep(choice.map_or_else(|| turn(map), |(_, twist)| twist));
        }
        self.twist
    }

    /// Drives so for some ticks.
    fn keep(&mut self, twist: Twist) {
        *self = Self {
            twist,
            left: KEPT,
            looked_at: self.looked_at,
            ..Self::new()
        };
    }

    /// Begins anew.
    pub fn reset(&mut self) {
        *self = Self::new();
    }
}

/// An arc: worth the length that is free of it, up to three times if it leads towards the direction; none if it is blocked
/// at once. And how often a point was looked at.
fn arc(
    near: &Near,
    outline: &Outline,
    margin: Steps,
    direction: Angle,
    (backward, curvature): (bool, PerMetre),
) -> (Choice, u32) {
    let mut way = Trajectory::new();
    let step = way.bend(curvature, backward, LOOK);
    let free = way.free(near, outline, margin, step);
    let looked_at = way.looked;
    if free < LEAST {
        return (None, looked_at);
    }
    way.bend(curvature, backward, free);
    let (cos, _) = (way.end().direction() - direction).cos_sin();
    // 2 to 6 quarters.
    let toward = 4i32.wrapping_add(cos.to_bits() >> 29);
    let worth = free.bits().wrapping_mul(toward);
    (Some((worth, along(backward, curvature))), looked_at)
}

/// The motion along an arc.
fn along(backward: bool, curvature: PerMetre) -> Twist {
    let linear = if backward { -SPEED } else { SPEED };
    Twist {
        linear,
        angular: linear.on_arc(curvature),
    }
}

/// In place, to the side with more room.
fn turn(map: &PolarMap) -> Twist {
    let left = map.left.bits() >= map.right.bits();
    Twist {
        linear: MetresPerSecond::ZERO,
        angular: if left { TURN } else { -TURN },
    }
}
