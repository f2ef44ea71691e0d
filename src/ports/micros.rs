//! The drivers' clock: microseconds in 32 bits, wrapping.

use crate::units::Seconds;

/// Microseconds from `then` to `now`.
pub(super) const fn since(now_us: u32, then_us: u32) -> u32 {
    now_us.wrapping_sub(then_us)
}

/// Longest [`Seconds`]: 127.999 999 94 s.
const LONGEST_US: u32 = 127_999_999;

/// To [`Seconds`], rounded to its step; saturates at 128 s.
pub(super) const fn seconds(us: u32) -> Seconds {
    // 2^24 / 10^6 with 24 more fractional bits: a multiplication instead of a 64-bit division, 1e-9 too large.
    const PER_MICRO: u64 = 281_474_977;
    let us = if us > LONGEST_US { LONGEST_US } else { us };
    Seconds::from_bits((((us as u64).wrapping_mul(PER_MICRO).wrapping_add(1 << 23)) >> 24) as i32)
}

/// From [`Seconds`], rounded; negative counts as zero.
pub(crate) const fn micros(time: Seconds) -> u32 {
    let bits = time.bits();
    if bits <= 0 {
        return 0;
    }
    ((bits as u64).wrapping_mul(1_000_000).wrapping_add(1 << 23) >> 24) as u32
}
