//! The last barrier before the wheels: no command passes after which braking could touch a point that is known.
//!
//! It knows the outline, the points near it and what the brakes can do; it knows nothing of paths, maps, rules or modes.
//!
//! 1. **Arc barrier.** Along the arc of the wanted twist, and along the arc being driven, the free length s allows a speed
//!    of √(2·a·s) with a gentle deceleration a: the robot slows early and smoothly. Backward it has a margin of its own.
//! 2. **Brake gate.** The wanted twist for one period, then both brakes in full: if on that way a point comes closer than
//!    the margin while it comes closer still, gentler twists are tried in turn, and braking in full is the last of them.
//!
//! What it promises, and when: [`BarrierParams`].

use super::footprint::Outline;
use super::near::Near;
use super::steps::Steps;
use super::trajectory::{Brakes, Trajectory, as_metres, curvature};
use crate::geometry::root;
use crate::integer::ratio;
use crate::signals::Twist;
use crate::units::{Angle, Metres, MetresPerSecond, PerMetre, RadiansPerSecond};
use fixed::types::I16F16;

/// The barrier's settings: of the last stage before the wheels, which knows nothing of paths, maps, rules or modes.
///
/// Its arc barrier slows early and smoothly by what stands along the arc that is wanted and along the one that is driven. Its
/// brake gate lets no twist pass after which a known point could not be avoided by braking in full.
///
/// # What it promises
///
/// Suppose that
/// * the robot moves as commanded: within a period it is at the commanded twist, and both brakes decelerate at least as
///   [`Brakes`] says;
/// * what is commanded now begins to act after the latency, and until then the last two commands act;
/// * obstacles stand still, and each has a point in memory that is nearer than the gate's margin to the place of its surface
///   that is touched first;
/// * the first such point is known while full braking still stays clear of it, which at speed v is v·(period + latency) +
///   v²/2a and the margin ahead of it;
/// * the settings are such as [`NavigatorParams::setup`](super::NavigatorParams::setup) takes: both brakes stop the robot
///   within 23 periods, the latency is two periods at most, no period is longer than 0.1 s or drives farther than 0.15 m, the
///   gate's margin is no less than [`NavigatorParams::least_gate`](super::NavigatorParams::least_gate);
/// * the outline is wider than what two periods drive: a smaller one may pass a point between two places of a way.
///
/// Then no known point is touched: if the command passed last period, braking in full now is the tail of the way that was
/// found clear then. It is found again in other steps of half a period and of 0.24 mm and may then not seem clear; where
/// nothing else passes it is taken all the same. That what is rounded stays within the margin is tested, not derived: a
/// reckless driver among up to 30 random points within 2 m, with three kinds of outlines and the settings at their limits
/// (`tests/navigate_barrier.rs`), touched none in 60,000 runs of 5 s; the test repeats 3,800 of them.
///
/// **Outside of it**: moving obstacles, what no sensor has seen, wheels that slip, and a cone whose echo was explained by a
/// neighbouring point (its obstacle may stand up to half the cone's arc beside the point); and of what a lidar saw, places
/// within 4.5 cm of a later one, which is remembered instead.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BarrierParams {
    /// Margin of the arc barrier.
    pub margin: Metres,
    /// Margin of the arc barrier backward, larger because nothing is seen there: what is remembered may be the near end of
    /// something.
    pub behind: Metres,
    /// Deceleration that the arc barrier plans with, m/s².
    pub braking: I16F16,
    /// Share of the planned speed that is used, 0 to 1.
    pub share: I16F16,
    /// Margin of the brake gate, 1 cm or more.
    pub gate: Metres,
}

impl BarrierParams {
    /// Margin of an arc in this direction.
    pub(super) fn arc_margin(&self, backward: bool) -> Steps {
        Steps::of(if backward { self.behind } else { self.margin })
    }
}

/// What the barrier made of a wanted twist.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Guarded {
    /// The twist that passes.
    pub twist: Twist,
    /// The arc barrier slowed it or its turn, as far as the next period can tell.
    pub slowed: bool,
    /// The brake gate changed it.
    pub gated: bool,
    /// No twist was found that stays clear, and it brakes in full: not even that does, as a point was seen too late, or it was
    /// not asked, as the gate had looked at so many points.
    pub trapped: bool,
    /// How often a point was looked at from a place on the way.
    pub looked: u32,
}

/// No arc is followed that is tighter than this.
const TIGHTEST: PerMetre = PerMetre::lit("6");

/// Arcs along which the middle of the body ends no farther apart than this count as one. A corner's places may differ by more,
/// by the difference of the turns: that is left to the gate.
const SAME_ARC: Steps = Steps::lit("0.01");

/// Speed of the wanted twist limited by the free length of the arcs ahead, and how often a point was looked at for that.
/// `room` are the angles that the robot can turn in place to the left and right. Only what limits a speed that `brakes` allow
/// in the next period is looked for: a robot that is slow in a crowd looks along short arcs, however fast it wants to be. The next
/// twist is the one that a look as far as the wanted speed asks for would give; where the robot nearly stands it may turn
/// faster than with that, and above 1.2 m/s the look may be 2 mm short.
///
/// Works in `way`: one that is used again and again need not be cleared in every tick.
#[allow(clippy::too_many_arguments, reason = "a tick's inputs")]
pub fn slow(
    way: &mut Trajectory,
    params: &BarrierParams,
    near: &Near,
    outline: &Outline,
    room: (Angle, Angle),
    brakes: Brakes,
    driven: Twist,
    wanted: Twist,
) -> (Twist, u32) {
    let mut twist = wanted;
    let arcs = [curvature(wanted, TIGHTEST), curvature(driven, TIGHTEST)];
    let backward = wanted.linear < MetresPerSecond::ZERO;
    let speed = Steps::of(as_metres(wanted.linear.abs()));
    let fastest = Steps::of(as_metres(driven.linear.abs() + brakes.linear));
    let mut length = lookahead(params, speed).min(needed(params, fastest, speed));
    way.looked = 0;
    for (driving, arc) in [(false, arcs[0]), (true, arcs[1])] {
        // The arc being driven matters if it is another, and in the direction that is wanted.
        let same = driving
            && ((arc - arcs[0]).abs() < const { PerMetre::lit("0.05") }
                || apart(arc - arcs[0], length) < SAME_ARC
                || (driven.linear < MetresPerSecond::ZERO) != backward
                || driven.linear.abs() < const { MetresPerSecond::lit("0.15") });
        if same || speed == Steps::ZERO {
            continue;
        }
        let step = way.bend(arc, backward, length);
        let free = way.free(near, outline, params.arc_margin(backward), step);
        if free >= length {
            continue;
        }
        let allowed = allowed(params, free, speed);
        twist.linear = twist.linear.limit(allowed);
        length = free;
    }
    (limit_turning(twist, room), way.looked)
}

/// Distance at which a speed begins to be limited: 0.1 m + v²/2a + v/10.
fn lookahead(params: &BarrierParams, speed: Steps) -> Steps {
    let braking = Steps::of(Metres::new(params.braking)).max(Steps::from_bits(1));
    let way = (speed.squared() >> 1)
        .checked_div(braking.bits().unsigned_abs())
        .unwrap_or(0);
    Steps::from_bits(way as i32) + Steps::from_bits(speed.bits() / 10) + const { Steps::lit("0.1") }
}

/// Free length that [allows](allowed) `most` to a robot that wants `speed`, a little more:
/// (most/share)²/2a + 0.02 m + 0.03 s·speed.
fn needed(params: &BarrierParams, most: Steps, speed: Steps) -> Steps {
    const WIDEST: i32 = Steps::lit("8").bits();
    let share = params.share.to_bits().max(1);
    let planned = Steps::from_bits(ratio(1 << 16, most.bits(), share).min(WIDEST));
    let braking = Steps::of(Metres::new(params.braking)).max(Steps::from_bits(1));
    let way = (planned.squared() >> 1)
        .checked_div(braking.bits().unsigned_abs())
        .unwrap_or(0);
    Steps::from_bits(way.min(WIDEST.unsigned_abs()) as i32)
        + Steps::from_bits(speed.bits().wrapping_mul(3) / 100)
        + const { Steps::lit("0.021") }
}

/// How far the middle of the body ends apart on arcs whose curvatures differ by Δκ: Δκ·s²/2.
fn apart(difference: PerMetre, length: Steps) -> Steps {
    let squared = u64::from(length.squared() >> 12);
    let twice = u64::from(difference.bits().unsigned_abs()).wrapping_mul(squared) >> 16;
    Steps::from_bits((twice >> 1).min(1 << 15) as i32)
}

/// share · √(2·a·(free − 0.02 m − 0.03 s·v)).
fn allowed(params: &BarrierParams, free: Steps, speed: Steps) -> MetresPerSecond {
    let reacting = Steps::from_bits(speed.bits().wrapping_mul(3) / 100);
    let room = (free - const { Steps::lit("0.02") } - reacting).max(Steps::ZERO);
    let squared = u64::from(params.braking.to_bits().unsigned_abs())
        .saturating_mul(room.metres().bits().unsigned_abs().into())
        .saturating_mul(2);
    MetresPerSecond::from_bits(root(squared).bits()).scale(params.share)
}

/// A robot that nearly stands turns no faster than it can stop within its room: 0.7·√(2·4 rad/s²·room).
fn limit_turning(twist: Twist, room: (Angle, Angle)) -> Twist {
    const SLOW: MetresPerSecond = MetresPerSecond::lit("0.15");
    let room = if twist.angular >= RadiansPerSecond::ZERO {
        room.0
    } else {
        room.1
    };
    let radians = room.radians();
    if twist.linear.abs() >= SLOW || radians >= 1 {
        return twist;
    }
    let left = (radians - const { I16F16::lit("0.02") }).max(I16F16::ZERO);
    // 0.7² · 8 = 3.92.
    let squared = u64::from(left.to_bits().unsigned_abs()).wrapping_mul(256_901);
    let most = RadiansPerSecond::from_bits(root(squared).bits());
    Twist {
        angular: twist.angular.limit(most),
        ..twist
    }
}

/// A twist that moves the outline by less than half a millimetre in a period, made so much faster that it does: poses are told
/// apart by half of that.
fn felt(brakes: Brakes, outline: &Outline, twist: Twist) -> Twist {
    const LEAST: Steps = Steps::from_bits(2);
    let forth = Steps::of(twist.linear.over(brakes.period).abs());
    let turn = twist.angular.over(brakes.period).abs().radians();
    let swept = Steps::of(outline.reach.metres().scale(turn));
    if forth >= LEAST || swept >= LEAST {
        return twist;
    }
    let linear = ratio(LEAST.metres().bits(), 1 << 24, brakes.period.bits());
    let angular = ratio(linear, 1 << 12, outline.reach.bits());
    let faster = |part: i32, least: i32| part.signum().wrapping_mul(least.saturating_add(1));
    Twist {
        linear: MetresPerSecond::from_bits(faster(twist.linear.bits(), linear)),
        angular: RadiansPerSecond::from_bits(faster(twist.angular.bits(), angular)),
    }
}

/// The first of the wanted twist and gentler ones after which braking in full stays clear of every point near; if none does,
/// braking in full. `driven` is the twist when the command begins to act, and what is returned lies within one
/// period's brakes of it or is the wanted one. Works in `way`, as [`slow`] does.
pub fn gate(
    way: &mut Trajectory,
    params: &BarrierParams,
    near: &Near,
    outline: &Outline,
    brakes: Brakes,
    driven: Twist,
    wanted: Twist,
) -> Guarded {
    /// After so many looks at points whether full braking stays clear is not asked: that bounds a tick.
    const MANY: u32 = 80;
    let margin = Steps::of(params.gate);
    let rest = Twist::REST;
    let halved = MetresPerSecond::from_bits(wanted.linear.bits() >> 1);
    // Slower, still, straighter, at rest.
    let gentler = |index: usize| match index {
        0 => (halved, wanted.angular),
        1 => (MetresPerSecond::ZERO, wanted.angular),
        2 => (
            halved,
            RadiansPerSecond::from_bits(driven.angular.bits() >> 1),
        ),
        _ => (MetresPerSecond::ZERO, RadiansPerSecond::ZERO),
    };
    way.looked = 0;
    let mut met = None;
    let close = near.clearance() < margin;
    let mut passes = |way: &mut Trajectory, mut twist: Twist| {
        // What is lost in rounding would creep up to a point, period after period.
        if close {
            twist = felt(brakes, outline, twist);
        }
        way.brake(driven, twist, brakes);
        met = way.touches(near, outline, margin, met);
        met.is_none()
    };
    if passes(way, wanted) {
        return Guarded {
            twist: wanted,
            looked: way.looked,
            ..Guarded::default()
        };
    }
    for index in 0..4 {
        // It would be driven anyway: only whether it stays clear is not found out.
        if index == 3 && way.looked >= MANY {
            break;
        }
        let (linear, angular) = gentler(index);
        let twist = brakes.toward(driven, Twist { linear, angular });
        if passes(way, twist) {
            return Guarded {
                twist,
                gated: twist != wanted,
                looked: way.looked,
                ..Guarded::default()
            };
        }
    }
    // The way that was found clear last time ends in full braking: found again in other steps it may not seem clear.
    Guarded {
        twist: brakes.toward(driven, rest),
        gated: true,
        trapped: true,
        looked: way.looked,
        ..Guarded::default()
    }
}
