//! The guidance laws: from pose and path to the direction to steer.
//!
//! * [`Law::Paper`]: the direction is the tangent ζ, as printed. φ = |ζ − ψ|.
//! * [`Law::Guided`]: the direction is χ = ζ − χ∞ · (2/π) · atan(k · e), the vector field of Nelson, Barber, McLain
//!   and Beard, *Vector field path following for miniature air vehicles*, IEEE T-RO 23(3), 2007, eq. 8 (for lines; used
//!   with the signed cross-track error e of any path). Far from the path it points at it at χ∞, on it along it.
//!
//! Both act on the pose predicted over the command's latency.

use super::cursor::Cursor;
use super::path::Path;
use crate::geometry::{Point, Pose, root, square};
use crate::integer::saturate;
use crate::params::{Follower, Law, Limits};
use crate::signals::{Guidance, Twist};
use crate::units::{Angle, Metres, MetresPerSecond, PerMetre, Seconds};
use fixed::types::I16F16;

/// What the cursor may advance in a tick although the robot stands: a pivot at a corner moves it this little.
const SLACK: Metres = Metres::lit("0.01");

/// Moves the cursor and answers where to head; how fast is asked of [`pace`]. `last` is the twist commanded in the tick
/// before.
pub fn guide(
    follower: &Follower,
    limits: &Limits,
    timing: (Seconds, Seconds),
    path: &Path<'_>,
    cursor: &mut Cursor,
    pose: Pose,
    last: Twist,
) -> Guidance {
    let (period, latency) = timing;
    let pose = predict(pose, last, latency);
    // From a standing start the whole reach may be used to find the path. Later the nearest place runs ahead of the
    // robot only where that is far inside a bend, and there it must not run through the path.
    let travelled = last.linear.over(period);
    let driven = travelled.abs();
    let reach = if cursor.is_at_start() {
        follower.reach
    } else {
        follower
            .reach
            .min(driven + driven + driven + driven + SLACK)
    };
    let fix = cursor.advance(path, pose.at, reach);
    let ends = fix.remaining <= follower.arrival;
    let elsewhere = is_elsewhere(follower, fix.remaining, fix.distance);
    let toward = match follower.law {
        Law::Paper => fix.foot.heading,
        // No tangent leads back to an end that was passed by: head for the place itself.
        Law::Guided if elsewhere => (fix.foot.at - pose.at).direction(),
        Law::Guided => fix.foot.heading - approach(follower, fix.cross_track),
    };
    // The command covers one period of travel: the curvature at its middle stands for it.
    let lead = Metres::from_bits(travelled.bits() >> 1);
    Guidance {
        foot: fix.foot.at,
        cross_track: fix.cross_track,
        distance: fix.distance,
        tangent: fix.foot.heading,
        curvature: if elsewhere {
            PerMetre::ZERO
        } else {
            cursor.curvature_ahead(path, lead)
        },
        heading_error: toward - pose.heading,
        progress: fix.progress,
        remaining: fix.remaining,
        laps: fix.laps,
        speed_limit: limits.speed,
        at_end: ends && !elsewhere,
        missed_end: elsewhere && follower.law == Law::Paper,
    }
}

/// The speed that the path ahead allows to who follows it, the robot's top speed at most. Nobody else asks: a tick that
/// does not follow looks at nothing.
pub fn pace(
    follower: &Follower,
    limits: &Limits,
    path: &Path<'_>,
    cursor: &mut Cursor,
    guidance: &Guidance,
) -> MetresPerSecond {
    let squared = if is_elsewhere(follower, guidance.remaining, guidance.distance) {
        // The way to a missed end is straight, and ends there.
        let gain =
            i64::from(limits.acceleration.to_bits()).wrapping_mul(guidance.distance.bits().into());
        gain.unsigned_abs().saturating_mul(2)
    } else {
        cursor.speed_limit_squared(
            path,
            limits.speed,
            limits.acceleration,
            follower.lateral_acceleration,
            Metres::from_bits(follower.corner_speed.bits()),
        )
    };
    // Most of the way the robot's own top speed is allowed: then there is no root.
    if squared >= square(Metres::from_bits(limits.speed.bits())) {
        limits.speed
    } else {
        MetresPerSecond::from_bits(root(squared).bits())
    }
}

/// Whether the path is over and the robot is not at its end. A closed path has no length left: it is never over.
fn is_elsewhere(follower: &Follower, remaining: Metres, distance: Metres) -> bool {
    remaining <= follower.arrival && distance > follower.end_radius
}

/// χ∞ · (2/π) · atan(k · e).
fn approach(follower: &Follower, cross_track: Metres) -> Angle {
    let gained = saturate(
        i64::from(follower.approach_gain.bits()).wrapping_mul(cross_track.bits().into()) >> 16,
    );
    let atan = Angle::of_tangent(I16F16::from_bits(gained));
    // A quarter turn of atan, 2^30, is the whole of χ∞: the factor 2/π is in the binary angle already.
    Angle::from_bits(saturate(
        i64::from(follower.approach_angle.bits()).wrapping_mul(atan.bits().into()) >> 30,
    ))
}

/// Pose after `time` of `twist`, along the mean heading.
fn predict(pose: Pose, twist: Twist, time: Seconds) -> Pose {
    let turned = twist.angular.over(time);
    let middle = pose.heading + Angle::from_bits(turned.bits() >> 1);
    let moved: Point = Point::polar(twist.linear.over(time), middle);
    Pose::new(pose.at + moved, pose.heading + turned)
}
