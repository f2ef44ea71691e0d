//! Twist to wheel speeds, within the robot's limits.

use crate::integer::{proper_fraction, quotient, saturate};
use crate::params::{Body, Limits};
use crate::signals::{Twist, WheelCommand};
use crate::units::{Metres, MetresPerSecond, RadiansPerSecond, Seconds};
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
/// 1. Speed, yaw-rate and wheel-speed limits scale both parts alike: the curvature ω/v stays, the speed gives way.
/// 2. Acceleration limits step from `last` towards the result. While the speed is still too low for the command, the
///    yaw rate is lowered with it, so the robot drives the commanded curve from the first metre.
/// 3. Where that step would saturate a wheel on the way (speed still high, yaw rate already rising), the yaw rate waits
///    for the speed; if it cannot fall fast enough, the speed waits for it. Neither exceeds its acceleration limit.
///
/// `last` is what this function returned in the tick before, or rest.
pub fn drive(body: &Body, limits: &Limits, period: Seconds, last: Twist, wanted: Twist) -> Driven {
    let arm = Metres::from_bits(body.track.bits() >> 1);
    let rim = |twist: Twist| twist.angular.at(arm);
    let wanted = shrink(wanted, wanted.linear.bits(), limits.speed.bits());
    let wanted = shrink(wanted, wanted.angular.bits(), limits.yaw_rate.to_bits());
    let fastest = wanted.linear.abs() + rim(wanted).abs();
    let wanted = shrink(wanted, fastest.bits(), limits.wheel_speed.bits());

    let step =
        |rate: I16F16| saturate(i64::from(rate.to_bits()).wrapping_mul(period.bits().into()) >> 24);
    let towards = |from: i32, to: i32, step: i32| {
        to.min(from.saturating_add(step))
            .max(from.saturating_sub(step))
    };
    let yaw_step = step(limits.yaw_acceleration);
    let linear = towards(
        last.linear.bits(),
        wanted.linear.bits(),
        step(limits.acceleration),
    );
    let lowered = linear.unsigned_abs() < wanted.linear.bits().unsigned_abs()
        && i64::from(linear).wrapping_mul(wanted.linear.bits().into()) >= 0;
    let angular = if lowered {
        share(
            wanted.angular.bits(),
            linear.unsigned_abs(),
            wanted.linear.bits().unsigned_abs(),
        )
    } else {
        wanted.angular.bits()
    };
    let angular = towards(last.angular.bits(), angular, yaw_step);

    let left_for =
        |used: MetresPerSecond| (limits.wheel_speed - used.abs()).max(MetresPerSecond::ZERO);
    let room = left_for(MetresPerSecond::from_bits(linear));
    let angular = RadiansPerSecond::from_bits(angular);
    let angular = if angular.at(arm).abs() <= room {
        angular
    } else {
        let most = quotient(i64::from(room.bits()) << 16, arm.bits()).map_or(i32::MAX, saturate);
        let held = angular.limit(RadiansPerSecond::from_bits(most));
        RadiansPerSecond::from_bits(towards(last.angular.bits(), held.bits(), yaw_step))
    };
    let twist = Twist {
        linear: MetresPerSecond::from_bits(linear).limit(left_for(angular.at(arm))),
        angular,
    };
    Driven {
        twist,
        wheels: WheelCommand {
            left: (twist.linear - rim(twist)).limit(limits.wheel_speed),
            right: (twist.linear + rim(twist)).limit(limits.wheel_speed),
        },
    }
}

/// Scales both parts of the twist alike when `value` is beyond `limit`.
fn shrink(twist: Twist, value: i32, limit: i32) -> Twist {
    let (value, limit) = (value.unsigned_abs(), limit.max(0).unsigned_abs());
    if value <= limit {
        return twist;
    }
    Twist {
        linear: MetresPerSecond::from_bits(share(twist.linear.bits(), limit, value)),
        angular: RadiansPerSecond::from_bits(share(twist.angular.bits(), limit, value)),
    }
}

/// `value · least / most` for `least` ≤ `most`, within a step as long as `value` has no more than 23 bits. Never more
/// than it should be, but for the rounding to nearest.
fn share(value: i32, least: u32, most: u32) -> i32 {
    let wide = i64::from(value).wrapping_mul(proper_fraction(least, most).into());
    (wide.wrapping_add(1 << 23) >> 24) as i32
}
