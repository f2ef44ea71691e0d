//! Out of a place where no heading is admissible, or only what leads into a dead end: back the way that it came, or the best of six short arcs, three of them
//! backward, or a turn in place.

use super::barrier::BarrierParams;
use super::footprint::Outline;
use super::known::KnownGround;
use super::near::{Motion, Near};
use super::polar::PolarMap;
use super::sensors::Eyes;
use super::steps::Steps;
use super::trajectory::Trajectory;
use super::way_back::{Retreat, WayBack};
use crate::geometry::Pose;
use crate::signals::Twist;
use crate::units::{Angle, MetresPerSecond, PerMetre, RadiansPerSecond, Seconds};

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
/// And what it costs to ask whether the ground is known.
const GROUND: u32 = 30;
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

/// What is known of the ground behind the robot.
pub(super) struct Behind<'a, const N: usize> {
    /// Where the robot will be when a choice takes effect.
    pub pose: Pose,
    pub way_back: &'a WayBack,
    pub ground: &'a KnownGround,
    pub eyes: &'a Eyes<N>,
    /// Sensors that see nothing, a bit each.
    pub dead: u32,
}

impl<const N: usize> Behind<'_, N> {
    fn retreat(&self) -> Option<Retreat> {
        self.way_back.retreat(self.pose)
    }

    /// Whether the ground is known that a motion leads to by the time when another one is chosen.
    fn is_known(&self, outline: &Outline, twist: Twist) -> bool {
        /// 16 periods of 50 ms, 0.22 m: longer than a choice is kept and the next one thought about. With longer periods a
        /// choice may lead farther than was asked about.
        const AHEAD: Seconds = Seconds::lit("0.8");
        let there = Motion::of(twist, AHEAD).from(self.pose);
        self.ground.has_rear(self.eyes, self.dead, outline, there)
    }
}

/// What one of the [arcs](ARCS) is worth; nothing if it cannot be driven.
#[derive(Clone, Copy, Debug, Default)]
struct Choice {
    worth: i32,
    arc: u8,
}

impl Choice {
    const NONE: Self = Self { worth: 0, arc: 0 };

    fn or_better(self, other: Self) -> Self {
        if other.worth > self.worth {
            other
        } else {
            self
        }
    }

    /// Its motion, if there is one.
    fn twist(self) -> Option<Twist> {
        let (backward, curvature) = *ARCS.get(usize::from(self.arc))?;
        (self.worth > 0).then(|| along(backward, curvature))
    }
}

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
            best: Choice::NONE,
            on: Choice::NONE,
            looked_at: 0,
        }
    }

    /// The motion to escape by; chosen anew every few ticks: the way back as far as there is one and it is free, else the
    /// best arc, backward over known ground only. `direction` is the one to get to, body frame. The first choice is thought
    /// about at rest, others while the last one is driven.
    pub fn drive<const N: usize>(
        &mut self,
        near: &Near,
        outline: &Outline,
        map: &PolarMap,
        barrier: &BarrierParams,
        direction: Angle,
        behind: &Behind<'_, N>,
    ) -> Twist {
        self.looked_at = 0;
        if let Some(left) = self.left.checked_sub(1) {
            self.left = left;
            return self.twist;
        }
        // One a tick: it costs as much as half a guard.
        if self.looked == 0 {
            self.looked = 1;
            if let Some(retreat) = behind.retreat() {
                let (free, looked_at) = retreat.free(near, outline);
                self.looked_at = looked_at.wrapping_add(ARC);
                if free >= LEAST {
                    self.keep(along(true, retreat.curvature));
                }
                return self.twist;
            }
        }
        let arc = self.looked.wrapping_sub(1);
        if let Some(&(backward, curvature)) = ARCS.get(usize::from(arc)) {
            self.looked = self.looked.wrapping_add(1);
            if backward {
                self.looked_at = GROUND;
            }
            if !backward || behind.is_known(outline, along(backward, curvature)) {
                let margin = barrier.arc_margin(backward);
                let (worth, looked_at) =
                    worth(near, outline, margin, direction, (backward, curvature));
                self.looked_at = self.looked_at.wrapping_add(looked_at).wrapping_add(ARC);
                let choice = Choice { worth, arc };
                self.best = self.best.or_better(choice);
                // On the way of the last choice as long as it goes on: a robot that goes to and fro leaves nothing.
                let goes_on = match self.twist.linear {
                    speed if speed < MetresPerSecond::ZERO => backward,
                    speed => speed > MetresPerSecond::ZERO && !backward,
                };
                if goes_on {
                    self.on = self.on.or_better(choice);
                }
            }
        }
        if usize::from(self.looked) > ARCS.len() {
            let twist = self.on.twist().or_else(|| self.best.twist());
            self.keep(twist.unwrap_or_else(|| turn(map)));
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

/// What an arc is worth: the length that is free of it, up to three times if it leads towards the direction; 0 if it is
/// blocked at once. And how often a point was looked at.
fn worth(
    near: &Near,
    outline: &Outline,
    margin: Steps,
    direction: Angle,
    (backward, curvature): (bool, PerMetre),
) -> (i32, u32) {
    let mut way = Trajectory::new();
    let step = way.bend(curvature, backward, LOOK);
    let free = way.free(near, outline, margin, step);
    let looked_at = way.looked;
    if free < LEAST {
        return (0, looked_at);
    }
    way.bend(curvature, backward, free);
    let (cos, _) = (way.end().direction() - direction).cos_sin();
    // 2 to 6 quarters.
    let toward = 4i32.wrapping_add(cos.to_bits() >> 29);
    (free.bits().wrapping_mul(toward), looked_at)
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
