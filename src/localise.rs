//! Wheel travel to pose.
//!
//! Sums of integer products in 64 bits. The heading depends on the total counts alone, so its quantisation never adds
//! up; the place is rounded to 60 nm a tick, without bias.

use crate::geometry::{Point, Pose};
use crate::integer::{divide, saturate};
use crate::params::{Body, Integrator};
use crate::signals::Travel;
use crate::units::{Angle, Metres};

/// Dead reckoning from wheel counts.
#[derive(Clone, Copy, Debug)]
pub struct Localiser {
    /// World position, metres with 32 fractional bits.
    x: i64,
    y: i64,
    /// Heading in turns with 48 fractional bits; wraps.
    heading: i64,
    /// Turn a count of wheel difference, same scale.
    turn_per_count: i64,
}

impl Localiser {
    /// Starts at `pose`.
    pub const fn new(body: &Body, pose: Pose) -> Self {
        // metres_per_count / (2π · track) turns a count; × 2^48. Numerator m·2^32 · 2^32, below 2^62; denominator m·2^16.
        const TURN: u64 = 683_565_276; // 2^32 / 2π
        let numerator = (body.metres_per_count.to_bits() as u64).wrapping_mul(TURN);
        let track = match body.track.bits() {
            1.. => body.track.bits().unsigned_abs(),
            _ => 1,
        };
        let turn_per_count = match divide(numerator, track) {
            Some(turn) => turn as i64,
            None => 0,
        };
        Self {
            x: (pose.at.x.bits() as i64) << 16,
            y: (pose.at.y.bits() as i64) << 16,
            heading: (pose.heading.bits() as i64) << 16,
            turn_per_count,
        }
    }

    /// Believed pose.
    pub fn pose(&self) -> Pose {
        Pose::new(
            Point::new(narrow(self.x), narrow(self.y)),
            Angle::from_bits((self.heading >> 16) as i32),
        )
    }

    /// Takes over the travel of one tick; unknown travel leaves the pose as it is.
    pub fn advance(&mut self, body: &Body, rule: Integrator, travel: Travel) -> Pose {
        if let Travel::Counts { left, right } = travel {
            // More counts than this in one tick are no wheel's; bounded, the products below fit 64 bits.
            const MOST: i64 = 1 << 28;
            let bounded = |counts: i32| i64::from(counts).clamp(-MOST, MOST);
            let (left, right) = (bounded(left), bounded(right));
            let turned = right.wrapping_sub(left).wrapping_mul(self.turn_per_count);
            // Mean travel, m·2^32 → m·2^24 (60 nm): the product with a cosine then fits 64 bits.
            let per_count = i64::from(body.metres_per_count.to_bits());
            let sum = left.wrapping_add(right).wrapping_mul(per_count);
            let travelled = i64::from(saturate(sum.wrapping_add(1 << 8) >> 9));
            let turned_bits = (turned >> 16) as i32;
            let (heading, travelled) = match rule {
                Integrator::Euler => (self.heading, travelled),
                Integrator::Arc => (
                    self.heading.wrapping_add(turned >> 1),
                    chord(travelled, turned_bits),
                ),
            };
            let (cos, sin) = Angle::from_bits((heading >> 16) as i32).cos_sin();
            // m·2^24 × 2^30 → m·2^32.
            let project =
                |ratio: i32| travelled.wrapping_mul(ratio.into()).wrapping_add(1 << 21) >> 22;
            self.x = self.x.saturating_add(project(cos.to_bits()));
            self.y = self.y.saturating_add(project(sin.to_bits()));
            self.heading = self.heading.wrapping_add(turned);
        }
        self.pose()
    }
}

/// Chord of an arc of length `arc` that turns by `turned`: arc·(1 − t²/24 + t⁴/1920), good to 4e-6 up to a radian;
/// beyond two radians in one tick the series is held.
fn chord(arc: i64, turned: i32) -> i64 {
    let radians = Angle::from_bits(turned).radians().to_bits();
    let radians = radians.unsigned_abs().min(2 << 16);
    // 16 fractional bits, at most 4 and 16; the shortening has 32, and is below 2^30.
    let square = ((u64::from(radians)).wrapping_mul(radians.into()) >> 16) as u32;
    let fourth = ((u64::from(square)).wrapping_mul(square.into()) >> 16) as u32;
    // 2^32/24 and 2^32/1920.
    let share = |part: u32, of: u32| (u64::from(part).wrapping_mul(of.into()) >> 16) as u32;
    let shortening = share(square, 178_956_971).wrapping_sub(share(fourth, 2_236_962));
    arc.wrapping_sub(arc.wrapping_mul(shortening.into()) >> 32)
}

fn narrow(wide: i64) -> Metres {
    Metres::from_bits(saturate((wide >> 15).wrapping_add(1) >> 1))
}
