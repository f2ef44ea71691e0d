//! Fine-grained path following: (d, φ) through the fine tables to speed and deflection.

use crate::integer::saturate;
use crate::params::{Follower, Law, Limits};
use crate::signals::{Behaviour, Controller, Guidance, RuleTrace, Twist};
use crate::tables::fine::{SPEED_AXIS, Speed, SpeedAxis};
use crate::units::{Angle, MetresPerSecond, RadiansPerSecond, Seconds};
use fixed::types::I16F16;
use heapless::Vec;

/// Desired motion while following.
///
/// The fuzzy deflection is unsigned; its sign is that of the heading error. The `guided` law adds the yaw rate of
/// the path's own curvature at the speed driven, so a bend needs no standing error.
pub fn follow(
    follower: &Follower,
    limits: &Limits,
    period: Seconds,
    guidance: &Guidance,
    last: Twist,
) -> Behaviour {
    let distance = match follower.law {
        Law::Paper => guidance.distance,
        Law::Guided => guidance.cross_track.abs(),
    };
    let d = I16F16::from_bits(distance.scale(follower.distance_scale).bits());
    let phi = guidance.heading_error.abs_degrees();
    let out = follower.tables.tables().evaluate(d, phi);

    let speed = speed_of(follower.speed_axis, out.speed, limits).min(guidance.speed_limit);
    let deflection = Angle::from_degrees(I16F16::from_num(out.deflection));
    let signed = if guidance.heading_error.bits() >= 0 {
        deflection
    } else {
        -deflection
    };
    let steer = rate_of(signed, follower.deflection_rate);
    let feed_forward = match follower.law {
        Law::Guided if guidance.cross_track.abs() <= follower.feed_forward_band => {
            // Braking takes time: until then the bend passes at the speed still there.
            let braked = MetresPerSecond::new(limits.acceleration).over(period);
            let slowest = last.linear - MetresPerSecond::from_bits(braked.bits());
            speed.max(slowest).on_arc(guidance.curvature)
        }
        _ => RadiansPerSecond::ZERO,
    };
    Behaviour {
        twist: Twist {
            linear: speed,
            angular: steer + feed_forward,
        },
        trace: RuleTrace {
            controller: Controller::Fine,
            distance_input: d.to_bits(),
            angle_input: phi.to_bits(),
            speed_output: out.speed.to_bits(),
            deflection_output: out.deflection.to_bits(),
            rules: out.activation.fired(),
            speed_rules: Vec::new(),
        },
    }
}

fn speed_of(axis: SpeedAxis, speed: Speed, limits: &Limits) -> MetresPerSecond {
    match axis {
        // limit · speed / 3.0; 3.0 is 3 · 2^13, and the 2^13 go first.
        SpeedAxis::Scaled => {
            const { assert!(SPEED_AXIS.to_bits() == 3 << 13) };
            let wide = i64::from(limits.speed.bits()).wrapping_mul(speed.to_bits().into());
            MetresPerSecond::from_bits(saturate(wide >> 13) / 3)
        }
        SpeedAxis::Literal => MetresPerSecond::new(I16F16::from_num(speed)).min(limits.speed),
    }
}

/// Yaw rate that turns `deflection` at `rate` 1/s.
pub(crate) fn rate_of(deflection: Angle, rate: I16F16) -> RadiansPerSecond {
    RadiansPerSecond::new(deflection.radians()).scale(rate)
}
