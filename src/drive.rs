//! Twist to wheel speeds, within the robot's limits.

use crate::params::{Body, Limits};
use crate::signals::{Twist, WheelCommand};
use crate::units::{Metres, MetresPerSecond, RadiansPerSecond, Seconds, saturate};
use fixed::types::I16F16;

/// What the limits make of a wanted twist.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Driven {
    /// The twist that the wheels are asked for.
    pub twist: Twist,
    /// The wheel speeds.
    pub wheels: WheelCommand,
}

/// Limits `wanted` and converts it: v ± ω·b/2.
///
/// 1. Speed and yaw-rate limits scale both parts alike: the curvature ω/v stays.
/// 2. Acceleration limits step from `last` towards it. While the speed is still too low for the command, the yaw rate
///    is lowered with it, so the robot drives the commanded curve from the first metre.
/// 3. When a wheel saturates, both wheels are scaled alike: the curvature stays, the speed gives way.
pub fn drive(body: &Body, limits: &Limits, period: Seconds, last: Twist, wanted: Twist) -> Driven {
    let wanted = shrink(wanted, wanted.linear.bits(), limits.speed.bits());
    let wanted = shrink(wanted, wanted.angular.bits(), limits.yaw_rate.to_bits());

    let step =
        |rate: I16F16| saturate(i64::from(rate.to_bits()).wrapping_mul(period.bits().into()) >> 24);
    let towards = |from: i32, to: i32, step: i32| {
        to.min(from.saturating_add(step))
            .max(from.saturating_sub(step))
    };
    let linear = towards(
        last.linear.bits(),
        wanted.linear.bits(),
        step(limits.acceleration),
    );
    let lowered = linear.unsigned_abs() < wanted.linear.bits().unsigned_abs()
        && i64::from(linear).wrapping_mul(wanted.linear.bits().into()) >= 0;
    let angular = if lowered {
        ratio(wanted.angular.bits(), linear, wanted.linear.bits())
    } else {
        wanted.angular.bits()
    };
    let angular = towards(last.angular.bits(), angular, step(limits.yaw_acceleration));
    let slewed = Twist {
        linear: MetresPerSecond::from_bits(linear),
        angular: RadiansPerSecond::from_bits(angular),
    };

    let rim = slewed.angular.at(Metres::from_bits(body.track.bits() >> 1));
    let fastest = slewed.linear.abs() + rim.abs();
    let twist = shrink(slewed, fastest.bits(), limits.wheel_speed.bits());
    let rim = twist.angular.at(Metres::from_bits(body.track.bits() >> 1));
    Driven {
        twist,
        wheels: WheelCommand {
            left: (twist.linear - rim).limit(limits.wheel_speed),
            right: (twist.linear + rim).limit(limits.wheel_speed),
        },
    }
}

/// Scales both parts of the twist alike when `value` is beyond `limit`.
fn shrink(twist: Twist, value: i32, limit: i32) -> Twist {
    let value = value.saturating_abs();
    if value <= limit {
        return twist;
    }
    Twist {
        linear: MetresPerSecond::from_bits(ratio(twist.linear.bits(), limit, value)),
        angular: RadiansPerSecond::from_bits(ratio(twist.angular.bits(), limit, value)),
    }
}

/// value · numerator / denominator.
fn ratio(value: i32, numerator: i32, denominator: i32) -> i32 {
    i64::from(value)
        .wrapping_mul(numerator.into())
        .checked_div(denominator.into())
        .map_or(0, saturate)
}
