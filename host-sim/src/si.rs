//! Between the simulator's `f64` and the library's fixed-point quantities. Saturates; NaN becomes zero, but no caller
//! lets one get this far.

use fixed::types::{I8F24, I16F16};
use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::units::{Angle, Metres, MetresPerSecond, RadiansPerSecond, Seconds};
use std::f64::consts::TAU;

/// A plain number.
pub fn number(x: f64) -> I16F16 {
    I16F16::saturating_from_num(if x.is_nan() { 0.0 } else { x })
}

/// A length.
pub fn metres(x: f64) -> Metres {
    Metres::new(number(x))
}

/// A speed.
pub fn speed(x: f64) -> MetresPerSecond {
    MetresPerSecond::new(number(x))
}

/// A duration.
pub fn seconds(x: f64) -> Seconds {
    Seconds::new(I8F24::saturating_from_num(if x.is_nan() { 0.0 } else { x }))
}

/// An angle from radians, wrapped; good to the binary angle's own step.
pub fn angle(radians: f64) -> Angle {
    let turns = (radians / TAU).rem_euclid(1.0);
    Angle::from_bits((turns * 4_294_967_296.0).round() as i64 as u32 as i32)
}

/// A pose.
pub fn pose([x, y, heading]: [f64; 3]) -> Pose {
    Pose::new(Point::new(metres(x), metres(y)), angle(heading))
}

/// Back from a plain number.
pub fn from_number(x: I16F16) -> f64 {
    x.to_num()
}

/// Back to metres.
pub fn from_metres(x: Metres) -> f64 {
    f64::from(x.bits()) / 65_536.0
}

/// Back to m/s.
pub fn from_speed(x: MetresPerSecond) -> f64 {
    f64::from(x.bits()) / 65_536.0
}

/// Back to seconds.
pub fn from_seconds(x: Seconds) -> f64 {
    x.get().to_num()
}

/// Back to rad/s.
pub fn from_rate(x: RadiansPerSecond) -> f64 {
    f64::from(x.bits()) / 65_536.0
}

/// Back to radians, (−π, π].
pub fn from_angle(x: Angle) -> f64 {
    f64::from(x.bits()) / 4_294_967_296.0 * TAU
}

/// Back to x, y, heading.
pub fn from_pose(p: Pose) -> [f64; 3] {
    [
        from_metres(p.at.x),
        from_metres(p.at.y),
        from_angle(p.heading),
    ]
}
