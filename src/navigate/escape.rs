//! Out of a place where no heading is admissible: the best of six short arcs, three of them backward, or a turn in place.

use super::footprint::Outline;
use super::near::Near;
use super::polar::PolarMap;
use super::steps::Steps;
use super::trajectory::Trajectory;
use crate::signals::Twist;
use crate::units::{Angle, Metres, MetresPerSecond, PerMetre, RadiansPerSecond};

/// Speed of an arc.
const SPEED: MetresPerSecond = MetresPerSecond::lit("0.28");
/// Yaw rate in place.
const TURN: RadiansPerSecond = RadiansPerSecond::lit("1");
/// Ticks for which a choice is kept.
const KEPT: u8 = 8;
/// How far an arc is looked along.
const LOOK: Steps = Steps::lit("0.35");
/// An arc that is free for less is none.
const LEAST: Steps = Steps::lit("0.05");

/// The choice that is being driven.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Escape {
    twist: Twist,
    left: u8,
}

impl Escape {
    /// None chosen.
    pub const fn new() -> Self {
        Self {
            twist: Twist::REST,
            left: 0,
        }
    }

    /// The motion to escape by; chosen anew every few ticks. `direction` is the one to get to, body frame.
    pub fn drive(
        &mut self,
        near: &Near,
        outline: &Outline,
        map: &PolarMap,
        margin: Metres,
        direction: Angle,
    ) -> Twist {
        if let Some(left) = self.left.checked_sub(1) {
            self.left = left;
            return self.twist;
        }
        self.left = KEPT.saturating_sub(1);
        let backward = self.twist.linear < MetresPerSecond::ZERO;
        let forward = self.twist.linear > MetresPerSecond::ZERO;
        let margin = Steps::of(margin);
        let best =
            |backward, forward| best_arc(near, outline, margin, direction, (backward, forward));
        // On the way of the last choice as long as it goes on: a robot that goes to and fro leaves nothing.
        let on = if backward || forward {
            best(backward, forward)
        } else {
            None
        };
        self.twist = on.or_else(|| best(true, true)).unwrap_or_else(|| turn(map));
        self.twist
    }

    /// Begins anew.
    pub fn reset(&mut self) {
        *self = Self::new();
    }
}

/// The arc that is free longest, one that leads towards the direction counting up to three times; none if all that may be
/// driven are blocked at once.
fn best_arc(
    near: &Near,
    outline: &Outline,
    margin: Steps,
    direction: Angle,
    (may_backward, may_forward): (bool, bool),
) -> Option<Twist> {
    let bend = const { PerMetre::lit("2") };
    let mut best = None::<(i32, Twist)>;
    let mut way = Trajectory::new();
    for (backward, curvature) in [
        (true, PerMetre::ZERO),
        (true, bend),
        (true, -bend),
        (false, PerMetre::ZERO),
        (false, bend),
        (false, -bend),
    ] {
        if !(if backward { may_backward } else { may_forward }) {
            continue;
        }
        way.bend(curvature, backward, LOOK);
        let free = way.free(near, outline, margin);
        if free < LEAST {
            continue;
        }
        way.bend(curvature, backward, free);
        let (cos, _) = (way.end().direction() - direction).cos_sin();
        // 2 to 6 quarters.
        let toward = 4i32.wrapping_add(cos.to_bits() >> 29);
        let worth = free.bits().wrapping_mul(toward);
        if best.is_none_or(|(known, _)| worth > known) {
            let linear = if backward { -SPEED } else { SPEED };
            best = Some((
                worth,
                Twist {
                    linear,
                    angular: linear.on_arc(curvature),
                },
            ));
        }
    }
    best.map(|(_, twist)| twist)
}

/// In place, to the side with more room.
fn turn(map: &PolarMap) -> Twist {
    let left = map.left.bits() >= map.right.bits();
    Twist {
        linear: MetresPerSecond::ZERO,
        angular: if left { TURN } else { -TURN },
    }
}
