//! Independent random streams: one a world, seed and purpose, whatever runs before it or beside it.

use rand::SeedableRng;
use rand_distr::{Distribution, StandardNormal};
use rand_pcg::Pcg64Mcg;

/// What a stream is drawn for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Purpose {
    /// Range sensors.
    Ranges = 1,
    /// Odometry.
    Odometry = 2,
    /// A generated world.
    World = 3,
    /// Resampling for confidence intervals.
    Bootstrap = 4,
}

/// The stream of a seed in a world for a purpose.
pub fn stream(seed: u64, world: u32, purpose: Purpose) -> Pcg64Mcg {
    let mixed = scramble(scramble(seed) ^ (u64::from(world) << 8 | purpose as u64));
    Pcg64Mcg::seed_from_u64(mixed)
}

/// A standard normal number.
pub fn normal(rng: &mut Pcg64Mcg) -> f64 {
    StandardNormal.sample(rng)
}

/// SplitMix64's output function (Steele, Lea, Flood 2014): neighbouring seeds end far apart.
fn scramble(x: u64) -> u64 {
    let x = x.wrapping_add(0x9e37_79b9_7f4a_7c15);
    let x = (x ^ (x >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
    let x = (x ^ (x >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
    x ^ (x >> 31)
}
