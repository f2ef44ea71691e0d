//! Fine-grained path following: (d, φ) through the fine tables to speed and deflection.

use super::fine::FineController;
use crate::params::{Follower, Law, Limits};
use crate::signals::{Behaviour, Guidance, Twist};
use crate::units::{Angle, MetresPerSecond, RadiansPerSecond, Seconds};
use fixed::types::I16F16;

/// Desired motion while following.
///
/// `fine` is made of the same settings. Its yaw rate has the heading error's sign. The `guided` law adds the yaw rate of
/// the path's own curvature at the speed driven, so a bend needs no standing error.
pub fn follow(
    fine: &FineController,
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
    let motion = fine.evaluate(distance, guidance.heading_error);
    let speed = motion.speed.min(limits.speed).min(guidance.speed_limit);
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
            angular: motion.yaw_rate + feed_forward,
        },
        trace: motion.trace(),
    }
}

/// Yaw rate that turns `deflection` at `rate` 1/s.
pub(crate) fn rate_of(deflection: Angle, rate: I16F16) -> RadiansPerSecond {
    RadiansPerSecond::new(deflection.radians()).scale(rate)
}
