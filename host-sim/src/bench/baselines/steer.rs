//! From a wanted heading to a twist: what heading planners leave to the vehicle.

use crate::bench::vehicle::Limits;
use crate::world::wrap;

/// Yaw rate per radian of heading error, 1/s.
const GAIN: f64 = 3.0;

/// Heading error at which the robot only turns, rad.
const TURN_ONLY: f64 = 1.2;

/// Turns towards `heading` (rad, in the body's frame) and drives at up to `speed`, the slower the more is to be turned.
pub fn towards(heading: f64, speed: f64, limits: &Limits) -> [f64; 2] {
    let error = wrap(heading);
    let share = (1.0 - error.abs() / TURN_ONLY).max(0.0);
    [
        speed * share,
        (GAIN * error).clamp(-limits.yaw_rate, limits.yaw_rate),
    ]
}

/// Speed from which the robot can stop within `distance`, with half its braking, m/s.
pub fn stopping_speed(distance: f64, limits: &Limits) -> f64 {
    (limits.acceleration * distance.max(0.0)).sqrt()
}
