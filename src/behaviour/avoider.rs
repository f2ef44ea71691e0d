//! Coarse-grained avoidance: (s, θ) through two nested controllers to deflection and speed, then the check that no
//! rule table can give.
//!
//! **Signs.** The tables speak the chapter's language: θ > 0 when the obstacle is on the left, Δθ > 0 clockwise. θ
//! equals the obstacle's bearing; Δθ is minus the turn. That conversion happens here and nowhere else.
//!
//! **Side.** Table 7.3 alone turns right for every θ above about −45° (its column Z is R throughout). The text's rule
//! "obstacle on the right: turn left" therefore evaluates the tables mirrored when the committed side is left: θ and
//! Δθ change their sign, the rest stands.
//!
//! **Unfeasible region.** After the tables the deflection is raised until |θ + Δθ| > β/2 on the committed side, for
//! the held obstacle and then for every other one near. It is also bounded: beyond β/2 + `overshoot` the tables would
//! only lead away (column R, row M turns on until θ = 90°), so there the deflection ends, and the robot keeps along the
//! edge of the region.

use super::follower::rate_of;
use crate::fuzzy::{Position, Twin};
use crate::geometry::square;
use crate::integer::proper_fraction;
use crate::params::{Avoider, Limits};
use crate::signals::{
    Behaviour, Controller, MAX_OBSTACLES, Obstacle, RuleTrace, Sensed, Sight, Turn, Twist,
};
use crate::tables::coarse::{Nested, SpeedShare, nested};
use crate::units::{Angle, Metres, MetresPerSecond};

/// Least angle by which a heading must clear the unfeasible region: keeps the strict ">" of the chapter after rounding.
const EDGE: Angle = Angle::deg("0.5");

/// Its tangent, 32 fractional bits.
const EDGE_TANGENT: i32 = 37_481_612;

/// Desired motion while passing `held` on its committed side. `sight` is that of `held`, grown by the robot's radius and
/// the margin.
pub fn avoid(
    avoider: &Avoider,
    limits: &Limits,
    robot_radius: Metres,
    sensed: &Sensed,
    side: Turn,
    held: &Obstacle,
    sight: Sight,
) -> Behaviour {
    // In the mirrored frame the committed turn is always to the right: positive Δθ.
    let mirror = |angle: Angle| match side {
        Turn::Right => angle,
        Turn::Left => -angle,
    };
    let grown = robot_radius + avoider.margin;
    let theta = mirror(sight.bearing);
    let distance = sight.distance;
    let free = (distance - held.radius - robot_radius).max(Metres::ZERO);
    // Beyond the range the tables see no difference.
    let near = free.min(avoider.range).bits().unsigned_abs();
    let share = proper_fraction(near, avoider.range.bits().unsigned_abs());
    let s = Position::from_bits(share.min(0xff_ffff) << 8);
    let twin = avoider.tables.twin();
    let Nested { turn, pace } = nested(twin, s, on_axis(theta), avoider.speed_input);

    // Wanted bearing of the obstacle in the next tick, mirrored frame: θ + Δθ.
    let half = sight.half_angle;
    // Past half a turn the sum stays there: wrapped, an obstacle behind would seem to be on the other side.
    let fuzzy = Angle::from_bits(theta.bits().saturating_add(deflected(turn.first).bits()));
    let edge = half + EDGE;
    let wanted = if fuzzy.bits() < edge.bits() {
        edge
    } else {
        fuzzy.limit(Angle::from_bits(
            edge.bits().saturating_add(avoider.overshoot.bits()),
        ))
    };
    // A right turn by wanted − θ in the mirrored frame.
    let mut turned = mirror(theta - wanted);
    let mut way = turned.rotation();
    let behind = distance + held.radius;
    let matters = |other: &Obstacle| {
        let distance = other.centre.norm_squared();
        // What stands behind the held one does not matter yet.
        let sooner = distance < square(behind + other.radius);
        sooner && other.is_nearer(robot_radius, avoider.range)
    };
    // Every push goes to the committed side, past one obstacle for good.
    let mut passed = [false; MAX_OBSTACLES];
    let mut pushed = false;
    for _ in 0..sensed.obstacles.len() {
        let blocking = |(other, passed): &(&Obstacle, &mut bool)| {
            !**passed && other.covers(way, grown) && matters(other)
        };
        let Some((other, passed)) = sensed.obstacles.iter().zip(&mut passed).find(blocking) else {
            break;
        };
        let edge = other.unfeasible_edge(grown, side);
        way = match side {
            Turn::Left => edge.nudged(EDGE_TANGENT),
            Turn::Right => edge.nudged_back(EDGE_TANGENT),
        };
        (*passed, pushed) = (true, true);
    }
    if pushed {
        turned = way.angle();
    }
    // A share of 14 fractional bits and the engine's more, at most one.
    let speed = i64::from(limits.speed.bits()).wrapping_mul(pace.second.into())
        >> (SpeedShare::FRAC_NBITS + Twin::<3, 3>::EXTRA_BITS);
    let ([deflection_output, _], [_, speed_output]) = (turn.rounded(), pace.rounded());
    Behaviour {
        twist: Twist {
            linear: MetresPerSecond::from_bits(speed as i32),
            angular: rate_of(turned, avoider.deflection_rate),
        },
        trace: RuleTrace {
            controller: Controller::Coarse,
            // 24 fractional bits to 16, rounded.
            distance_input: (share.wrapping_add(1 << 7) >> 8) as i32,
            angle_input: theta.degrees().to_bits(),
            speed_output,
            deflection_output,
            rules: turn.activation.rules(),
            speed_rules: pace.activation.rules(),
        },
    }
}

/// The position of θ on its axis: a quarter turn to either side.
fn on_axis(theta: Angle) -> Position {
    let quarter = Angle::QUARTER.bits();
    let limited = theta.bits().clamp(-quarter, quarter - 1);
    Position::from_bits(limited.wrapping_add(quarter).cast_unsigned() << 1)
}

/// Δθ as the tables give it, 2^-20° a step, as an angle: 512 / 45 times as many, here with 27 fractional bits.
fn deflected(wide: i32) -> Angle {
    const GAIN: i64 = ((512 << 28) / 45 + 1) / 2;
    Angle::from_bits((i64::from(wide).wrapping_mul(GAIN) >> 27) as i32)
}
