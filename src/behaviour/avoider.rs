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
use crate::geometry::square;
use crate::integer::{proper_fraction, saturate};
use crate::params::{Avoider, Limits};
use crate::signals::{
    Behaviour, Controller, Obstacle, RuleTrace, Sensed, Sight, Turn, Twist,
};
use crate::units::{Angle, Metres, MetresPerSecond};
use fixed::types::I16F16;

/// Least angle by which a heading must clear the unfeasible region: keeps the strict ">" of the chapter after rounding.
const EDGE: Angle = Angle::deg("0.5");

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
    // Beyond the range the tables see no difference. 24 fractional bits to 16, rounded.
    let near = free.min(avoider.range).bits().unsigned_abs();
    let share = proper_fraction(near, avoider.range.bits().unsigned_abs());
    let share = (share.wrapping_add(1 << 7) >> 8) as i32;
    let (s, theta_degrees) = (I16F16::from_bits(share), theta.degrees());
    let out = avoider
        .tables
        .tables()
        .evaluate(s, theta_degrees, avoider.speed_input);

    // Wanted bearing of the obstacle in the next tick, mirrored frame: θ + Δθ.
    let half = sight.half_angle;
    let deflection = Angle::from_degrees(I16F16::from_num(out.deflection));
    // Past half a turn the sum stays there: wrapped, an obstacle behind would seem to be on the other side.
    let fuzzy = Angle::from_bits(theta.bits().saturating_add(deflection.bits()));
    let edge = half + EDGE;
    let wanted = if fuzzy.bits() < edge.bits() {
        edge
    } else {
        fuzzy.limit(Angle::from_bits(
            edge.bits().saturating_add(avoider.overshoot.bits()),
        ))
    };
    // A right turn by wanted − θ, as a direction in the mirrored body frame (left positive there, too).
    let mut direction = theta - wanted;
    let behind = distance + held.radius;
    let matters = |other: &Obstacle| {
        let distance = other.centre.norm_squared();
        // What stands behind the held one does not matter yet.
        let sooner = distance < square(behind + other.radius);
        sooner && other.is_nearer(robot_radius, avoider.range)
    };
    // Every push goes to the right, past one obstacle for good: as many pushes as obstacles reach the end.
    for _ in 0..sensed.obstacles.len() {
        let way = mirror(direction).rotation();
        let blocks = |other: &&Obstacle| other.covers(way, grown) && matters(other);
        let Some(other) = sensed.obstacles.iter().find(blocks) else {
            break;
        };
        direction = mirror(other.unfeasible_edge(grown, side)) - EDGE;
    }
    let turn = mirror(direction);
    let speed = i64::from(limits.speed.bits()).wrapping_mul(out.speed.to_bits().into()) >> 14;
    Behaviour {
        twist: Twist {
            linear: MetresPerSecond::from_bits(saturate(speed)),
            angular: rate_of(turn, avoider.deflection_rate),
        },
        trace: RuleTrace {
            controller: Controller::Coarse,
            distance_input: s.to_bits(),
            angle_input: theta_degrees.to_bits(),
            speed_output: out.speed.to_bits(),
            deflection_output: out.deflection.to_bits(),
            rules: out.deflection_rules.rules(),
            speed_rules: out.speed_rules.rules(),
        },
    }
}
