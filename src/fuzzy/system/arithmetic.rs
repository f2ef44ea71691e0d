//! Integer routines without a branch on the data: a Cortex-M0 has no conditional move, so a comparison would cost one
//! instruction more or less by its outcome.

use core::hint::black_box;

/// All ones if negative, else zero.
pub(super) const fn mask(x: i32) -> u32 {
    (x >> 31) as u32
}

/// The smaller of two numbers below 2^31.
pub(super) const fn least(a: u32, b: u32) -> u32 {
    let over = b.wrapping_sub(a);
    a.wrapping_add(over & mask(over as i32))
}

/// The larger of two numbers below 2^31.
pub(super) const fn most(a: u32, b: u32) -> u32 {
    let over = b.wrapping_sub(a);
    a.wrapping_add(over & !mask(over as i32))
}

/// `x`, or the end of `[low, high]` that it is beyond; `x` within 2^62.
pub(super) const fn limited(x: i64, [low, high]: [i32; 2]) -> i32 {
    // What is missing to the low end and what is left to the high one: each counts where it is negative.
    let above = x.wrapping_sub(low as i64);
    let left = i64::wrapping_sub(high as i64, x);
    x.wrapping_sub(above & if_negative(above) as i64)
        .wrapping_add(left & if_negative(left) as i64) as i32
}

/// All ones if negative, else zero, and the optimiser does not know it: of some masks it would make comparisons, and
/// branches of these.
#[inline(always)]
pub(super) const fn if_negative(x: i64) -> i32 {
    black_box((x >> 63) as i32)
}

/// `value` and `divisor` halved as often as it takes to bring the divisor below 2^30. It is below 2^45, the value below
/// 2^63.
pub(super) const fn reduced(value: u64, divisor: u64) -> (u64, u32) {
    let (mut value, mut divisor) = (value, divisor);
    let mut step = 16;
    while step > 1 {
        step >>= 1;
        // `step` halvings if the divisor has that many bits too many.
        let over = (divisor >> 29) as u32 >> step;
        let shift = step & mask(over.wrapping_neg() as i32);
        value = wide_shift(value, shift);
        divisor = wide_shift(divisor, shift);
    }
    (value, divisor as u32)
}

/// `value >> shift` for a shift below 31: no library's routine, whose work depends on the shift.
const fn wide_shift(value: u64, shift: u32) -> u64 {
    let (high, low) = ((value >> 32) as u32, value as u32);
    let carried = high.wrapping_shl(1).wrapping_shl(31u32.wrapping_sub(shift));
    let low = low.wrapping_shr(shift) | carried;
    ((high.wrapping_shr(shift) as u64) << 32) | low as u64
}

/// `value / divisor`, rounded down, by 32 steps of long division. The divisor is below 2^30, the quotient below 2^32.
/// A divisor of zero gives a number without meaning.
pub(super) const fn quotient(value: u64, divisor: u32) -> u32 {
    let (mut rest, mut low) = ((value >> 32) as u32, value as u32);
    let mut quotient = 0u32;
    let mut bit = 0;
    while bit < 32 {
        rest = rest.wrapping_shl(1) | (low >> 31);
        low = low.wrapping_shl(1);
        // rest < 2 · divisor < 2^31.
        let left = rest.wrapping_sub(divisor);
        let short = mask(left as i32);
        rest = left.wrapping_add(divisor & short);
        quotient = quotient.wrapping_shl(1).wrapping_add(short).wrapping_add(1);
        bit = u32::wrapping_add(bit, 1);
    }
    quotient
}

/// `value / divisor`, rounded to nearest, ties away from zero, by way of [`reduced`]: exact for a divisor below 2^30. The
/// quotient is below 2^31 in magnitude, and so is the magnitude of the value below 2^63.
pub(super) const fn rounded(value: i64, divisor: u64) -> i32 {
    let sign = if_negative(value);
    let magnitude = (value ^ sign as i64).wrapping_sub(sign as i64) as u64;
    let (magnitude, divisor) = reduced(magnitude, divisor);
    let quotient = quotient(magnitude.wrapping_add((divisor >> 1) as u64), divisor) as i32;
    (quotient ^ sign).wrapping_sub(sign)
}

#[cfg(test)]
mod tests {
    use super::{least, limited, most, reduced, rounded, wide_shift};

    /// Numbers at and around every power of two, and pseudo-random ones of every size.
    fn numbers() -> impl Iterator<Item = u64> + Clone {
        let edges = (0..64).flat_map(|bit| {
            let power = 1u64 << bit;
            [power - 1, power, power.wrapping_add(1)]
        });
        let mut state = 7u64;
        let random = (0..1500).map(move |i| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            state.rotate_left(23) >> (i % 64)
        });
        edges.chain(random)
    }

    #[test]
    fn the_smaller_and_the_larger_are_found() {
        for a in numbers().map(|n| n as u32 >> 1) {
            for b in [0, 1, a, a.saturating_sub(1), u32::MAX >> 1, 1 << 24] {
                assert_eq!((least(a, b), most(a, b)), (a.min(b), a.max(b)));
            }
        }
    }

    #[test]
    fn limits_hold_for_all_numbers() {
        let ends = [i32::MIN, i32::MIN + 1, -7, 0, 9, i32::MAX - 1, i32::MAX];
        for x in numbers().map(|n| n as i32).chain(ends) {
            for low in ends {
                for high in ends.into_iter().filter(|&high| high >= low) {
                    assert_eq!(limited(x.into(), [low, high]), x.clamp(low, high));
                }
            }
        }
    }

    #[test]
    fn a_divisor_is_halved_just_as_often_as_needed() {
        for divisor in numbers().filter(|&n| n < 1 << 45) {
            let shift = (64 - divisor.leading_zeros()).saturating_sub(30);
            for value in numbers().filter(|&n| n < 1 << 63) {
                let wanted = (value >> shift, (divisor >> shift) as u32);
                assert_eq!(reduced(value, divisor), wanted, "{value} / {divisor}");
            }
        }
        assert_eq!(wide_shift(u64::MAX, 30), u64::MAX >> 30);
    }

    #[test]
    fn quotients_are_rounded_to_nearest() {
        for divisor in numbers().filter(|&n| n > 0 && n < 1 << 30) {
            for value in numbers() {
                let value = value % (divisor << 30);
                for value in [value as i64, -(value as i64)] {
                    let wide = i128::from(value);
                    let half = i128::from(divisor / 2) * wide.signum();
                    let wanted = (wide + half) / i128::from(divisor);
                    assert_eq!(
                        i128::from(rounded(value, divisor)),
                        wanted,
                        "{value} / {divisor}"
                    );
                }
            }
        }
        // A wide divisor costs at most the last places.
        let wide = rounded(-(12_345 * ((1 << 44) - 1)), (1 << 44) - 1);
        assert_eq!(wide, -12_345);
    }
}
