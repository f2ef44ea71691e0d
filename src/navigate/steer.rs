//! From the chosen heading to a twist: the coarse tables give deflection and speed, and the yaw rate is one that can be
//! stopped in time.

use super::heading::Heading;
use super::steps::Steps;
use crate::fuzzy::{Position, Twin};
use crate::geometry::root;
use crate::integer::proper_fraction;
use crate::params::Limits;
use crate::signals::Twist;
use crate::tables::coarse::{CoarseTwin, SpeedShare};
use crate::units::{Angle, Metres, MetresPerSecond, RadiansPerSecond};
use fixed::types::I16F16;

/// Settings.
#[derive(Clone, Copy, Debug)]
pub struct SteerParams {
    /// Deflection and speed.
    pub tables: &'static CoarseTwin,
    /// Free travel at which the tables' first row is fully true…
    pub near: Metres,
    /// …and their last; farther.
    pub far: Metres,
    /// What the soft free travel counts more than it is, beside the hard one.
    pub soft_bonus: Metres,
    /// Deflection to yaw rate, 1/s.
    pub rate: I16F16,
    /// Yaw acceleration that a turn is planned with, rad/s²: at most the limit.
    pub yaw_acceleration: I16F16,
    /// Distance to the outline below which the speed shrinks, to a quarter at contact.
    pub flank: Metres,
}

/// The twist that turns into `heading` and drives there.
pub fn steer(params: &SteerParams, limits: &Limits, heading: &Heading, clearance: Steps) -> Twist {
    let free = heading
        .hard
        .min(heading.soft + Steps::of(params.soft_bonus));
    let (deflection, share) = infer(params, free, heading.angle.abs());
    let speed = (i64::from(limits.speed.bits()).wrapping_mul(share.into()) >> SHARE_BITS) as i32;
    let speed = MetresPerSecond::from_bits(speed).scale(flank(params, clearance));
    let rate = yaw_rate(params, deflection).min(RadiansPerSecond::new(limits.yaw_rate));
    Twist {
        linear: speed,
        angular: if heading.angle.bits() < 0 {
            -rate
        } else {
            rate
        },
    }
}

/// Fractional bits of a speed share of the tables.
const SHARE_BITS: u32 = SpeedShare::FRAC_NBITS + Twin::<3, 3>::EXTRA_BITS;

/// Both tables: deflection as a positive angle, share of the top speed.
fn infer(params: &SteerParams, free: Steps, angle: Angle) -> (Angle, i32) {
    let (near, far) = (Steps::of(params.near), Steps::of(params.far));
    let span = (far - near).max(Steps::from_bits(1));
    let into = (free - near).max(Steps::ZERO).min(span);
    let share = proper_fraction(into.bits().unsigned_abs(), span.bits().unsigned_abs());
    let row = Position::from_bits(share.min(0xff_ffff) << 8);
    // A quarter turn is the axis.
    let column = Position::from_bits(angle.bits().clamp(0, (1 << 30) - 1).cast_unsigned() << 2);
    let twin = params.tables.evaluate(row, column);
    // 2^-20 degrees to binary angles: 2^32 / 360 / 2^20 = 11.3778.
    let deflection = (i64::from(twin.first).wrapping_mul(11_930_465) >> 20) as i32;
    (Angle::from_bits(deflection.max(0)), twin.second.max(0))
}

/// min(rate · δ, √(2·a·δ)): no faster than it can be stopped within the deflection.
fn yaw_rate(params: &SteerParams, deflection: Angle) -> RadiansPerSecond {
    let radians = deflection.radians();
    let linear = RadiansPerSecond::new(radians).scale(params.rate);
    let squared = u64::from(params.yaw_acceleration.to_bits().unsigned_abs())
        .saturating_mul(radians.to_bits().unsigned_abs().into())
        .saturating_mul(2);
    linear.min(RadiansPerSecond::from_bits(root(squared).bits()))
}

/// 1, and from `flank` on down to ¼ at contact.
fn flank(params: &SteerParams, clearance: Steps) -> I16F16 {
    let flank = Steps::of(params.flank);
    if clearance >= flank {
        return I16F16::ONE;
    }
    let left = clearance.max(Steps::ZERO).bits().unsigned_abs();
    let share = proper_fraction(left, flank.bits().unsigned_abs().max(1));
    // From 24 fractional bits.
    let share = I16F16::from_bits((share >> 8) as i32);
    share
        .saturating_mul(const { I16F16::lit("0.75") })
        .saturating_add(const { I16F16::lit("0.25") })
}
