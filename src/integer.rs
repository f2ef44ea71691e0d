//! Integer routines of bounded, small cost: no Cortex-M divides 64 bits, so what must be 64 bits wide is put together from
//! 32-bit divisions. Every routine is total. The long ones are never inlined: they are called from many places, and an
//! image has them once.

/// Narrows to `i32`, saturating.
pub(crate) const fn saturate(wide: i64) -> i32 {
    let (upper, lower) = ((wide >> 32) as i32, wide as i32);
    // It fits if the upper half only repeats the sign.
    if upper == lower >> 31 {
        lower
    } else {
        (upper >> 31) ^ i32::MAX
    }
}

/// Magnitude; the largest number for the least one. Three instructions where a shift is free, and no branch.
#[inline(always)]
pub(crate) const fn magnitude(x: i32) -> i32 {
    let sign = x >> 31;
    let wrapped = (x ^ sign).wrapping_sub(sign);
    // The least number has wrapped to itself: one less is the largest.
    wrapped.wrapping_add(wrapped >> 31)
}

/// Quotient, rounded down; `None` for a divisor of 0.
///
/// Schoolbook division in digits of 16 bits (Knuth, *The Art of Computer Programming* 2, 4.3.1 D): at most three 32-bit
/// divisions.
#[inline(never)]
pub(crate) const fn divide(value: u64, divisor: u32) -> Option<u64> {
    let (upper, lower) = ((value >> 32) as u32, value as u32);
    let (Some(first), Some(rest)) = (upper.checked_div(divisor), upper.checked_rem(divisor)) else {
        return None;
    };
    if rest == 0 {
        let low = match lower.checked_div(divisor) {
            Some(low) => low,
            None => 0,
        };
        return Some(((first as u64) << 32) | low as u64);
    }
    // The divisor's top bit set, so that a digit's estimate from its upper half is at most two too large.
    let shift = divisor.leading_zeros();
    let divisor = divisor.wrapping_shl(shift);
    let value = (((rest as u64) << 32) | lower as u64).wrapping_shl(shift);
    let (rest, high) = digit((value >> 32) as u32, (value >> 16) as u32 & 0xffff, divisor);
    let (_, low) = digit(rest, value as u32 & 0xffff, divisor);
    Some(((first as u64) << 32) | ((high as u64) << 16) | low as u64)
}

/// One digit: (rest·2^16 + next) by `divisor`, whose top bit is set; `rest` is below it. New rest and quotient.
const fn digit(rest: u32, next: u32, divisor: u32) -> (u32, u32) {
    let mut quotient = match rest.checked_div(divisor >> 16) {
        Some(quotient) if quotient < 1 << 16 => quotient,
        _ => 0xffff,
    };
    let value = ((rest as u64) << 16) | next as u64;
    let mut rest = value.wrapping_sub((quotient as u64).wrapping_mul(divisor as u64)) as i64;
    let mut corrections = 0;
    while rest < 0 && corrections < 2 {
        rest = rest.wrapping_add(divisor as i64);
        quotient = quotient.wrapping_sub(1);
        corrections = u32::wrapping_add(corrections, 1);
    }
    (rest as u32, quotient)
}

/// `value · numerator / denominator`, rounded towards zero, saturating; 0 for a denominator of 0.
pub(crate) fn ratio(value: i32, numerator: i32, denominator: i32) -> i32 {
    let product = i64::from(value).wrapping_mul(numerator.into());
    quotient(product, denominator).map_or(0, saturate)
}

/// Quotient, rounded towards zero; `None` for a divisor of 0.
pub(crate) fn quotient(value: i64, divisor: i32) -> Option<i64> {
    let magnitude = divide(value.unsigned_abs(), divisor.unsigned_abs())? as i64;
    Some(if (value < 0) == (divisor < 0) {
        magnitude
    } else {
        magnitude.wrapping_neg()
    })
}

/// A number by which is divided again and again: worked out once, a quotient is a product.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Reciprocal {
    factor: u32,
    shift: u32,
}

impl Reciprocal {
    /// For quotients `numerator / divisor`, numerators from 2^29 to 2^30. A divisor of 0 counts as 1, one beyond 2^31 as
    /// that.
    pub(crate) const fn new(numerator: u32, divisor: u32) -> Self {
        let divisor = match divisor {
            0 => 1,
            1..=0x7fff_ffff => divisor,
            _ => 0x7fff_ffff,
        };
        // The divisor is from 2^shift to below twice that: the factor has 29 bits at least.
        let shift = 31u32.wrapping_sub(divisor.leading_zeros());
        let factor = match divide((numerator as u64).wrapping_shl(shift), divisor) {
            Some(factor) => factor as u32,
            None => 0,
        };
        Self { factor, shift }
    }

    /// `numerator · value / divisor`, rounded down; off by no more than 2^-29 of itself, and one.
    pub(crate) const fn times(self, value: i32) -> i64 {
        (value as i64)
            .wrapping_mul(self.factor as i64)
            .wrapping_shr(self.shift)
    }
}

/// Square root, rounded down.
///
/// Zimmermann's Karatsuba square root with one level (*INRIA RR-3805*, 1999): the root of the upper half, then 16 more
/// bits by a division. Two 32-bit divisions in all, where `u64::isqrt` takes one of 64 bits.
#[inline(never)]
pub(crate) fn square_root(square: u64) -> u32 {
    if square == 0 {
        return 0;
    }
    // The upper half becomes at least 2^30, its root at least 2^15.
    let shift = square.leading_zeros() >> 1;
    let wide = square.wrapping_shl(shift.wrapping_mul(2));
    let upper = (wide >> 32) as u32;
    let root = root_of_upper(upper);
    let rest = upper.wrapping_sub(root.wrapping_mul(root));
    // (rest·2^16 + the next 16 bits) / (2·root), both halved. Rounding and the cap leave it one too large at most.
    let digits = (rest << 15) | ((wide as u32) >> 17);
    // (The root has that bit; so the compiler sees that it is not zero.)
    let digits = (digits / (root | 1 << 15)).min(0xffff);
    let root = (root << 16) | digits;
    let over = u64::from(root).wrapping_mul(root.into()) > wide;
    root.wrapping_sub(over.into()).wrapping_shr(shift)
}

/// Square root of a word, rounded down. No division, a third of what [`square_root`] costs.
pub(crate) fn square_root_of_word(square: u32) -> u32 {
    if square == 0 {
        return 0;
    }
    let shift = square.leading_zeros() >> 1;
    root_of_upper(square.wrapping_shl(shift.wrapping_mul(2))).wrapping_shr(shift)
}

/// Square root, rounded down, of a number from 2^30 on: a table's guess, and a step of Newton's with the guess's own
/// reciprocal from the table. No division: a Cortex-M0 has none.
#[inline(always)]
fn root_of_upper(upper: u32) -> u32 {
    let index = ((upper >> 24) as usize).wrapping_sub(FIRST_ROOT);
    let (root, reciprocal) = ROOTS.get(index).copied().unwrap_or((u16::MAX, 0));
    let guess = u32::from(root);
    let excess = upper.wrapping_sub(guess.wrapping_mul(guess)) as i32;
    // The guess is within 2^-8: |excess| < 2^24, what it corrects is < 2^8. The step leaves less than 0.7 either way; what
    // is taken off it makes the root too small, by one at most, and never too large.
    const LESS: i32 = 7 << 20;
    let correction = (excess >> 5).wrapping_mul(reciprocal.into());
    let root = guess.wrapping_add_signed(correction.wrapping_sub(LESS) >> 23);
    let left = upper.wrapping_sub(root.wrapping_mul(root));
    root.wrapping_add((left > root.wrapping_mul(2)).into())
}

/// Upper eight bits of the smallest number in [`ROOTS`].
const FIRST_ROOT: usize = 64;

/// For the upper eight bits i of 32, from 64: 2^12·√(i + ½), and 2^27 by that.
static ROOTS: [(u16, u16); 192] = {
    let mut table = [(0, 0); 192];
    let mut i = 0;
    while i < 192 {
        let root = (((i + FIRST_ROOT) as u64 * 2 + 1) << 23).isqrt() as u32;
        table[i] = (root as u16, ((1 << 27) / root) as u16);
        i += 1;
    }
    table
};

/// Direction of the vector (x, y) as a binary angle, a full turn 2^32; 0 for the null vector. Within 1.3e-6 rad.
///
/// The smaller coordinate by the larger, in two digits of 32-bit divisions; the arctangent of that from a table of 257,
/// linear in between.
#[inline(never)]
pub(crate) const fn arctangent(x: i32, y: i32) -> i32 {
    let (ax, ay) = (x.unsigned_abs(), y.unsigned_abs());
    let (steep, most, least) = if ay > ax {
        (true, ay, ax)
    } else {
        (false, ax, ay)
    };
    let octant = octant(fraction(least, most));
    let quadrant = if steep {
        (1u32 << 30).wrapping_sub(octant)
    } else {
        octant
    };
    let half = if x < 0 {
        (1u32 << 31).wrapping_sub(quadrant)
    } else {
        quadrant
    };
    let whole = half as i32;
    if y < 0 { whole.wrapping_neg() } else { whole }
}

/// Arctangent of a number, 16 fractional bits, as a binary angle. Within 1.3e-6 rad, and without a division up to one.
pub(crate) fn arctangent_of(tangent: i32) -> i32 {
    const ONE: u32 = 1 << 16;
    let magnitude = tangent.unsigned_abs();
    let angle = if magnitude <= ONE {
        octant(magnitude << 8)
    } else {
        (1u32 << 30).wrapping_sub(octant(fraction(ONE, magnitude)))
    } as i32;
    if tangent < 0 {
        angle.wrapping_neg()
    } else {
        angle
    }
}

/// Arctangent of a number from 0 to 1, 24 fractional bits; a little more counts as one.
#[inline(always)]
const fn octant(ratio: u32) -> u32 {
    let (place, rest) = ((ratio >> 16) as usize, ratio & 0xffff);
    // From one, 2^24, on: place 256 and no slope.
    let [from, to] = match place {
        0..256 => [ARCTANGENTS[place], ARCTANGENTS[place + 1]],
        _ => [ARCTANGENTS[256]; 2],
    };
    // Neighbours differ by less than 2^22.
    let between = ((to.wrapping_sub(from) as u64).wrapping_mul(rest as u64) >> 16) as u32;
    from.wrapping_add(between)
}

/// `least / most` with 24 fractional bits, for `least` ≤ `most`, short by 2 steps at most; 0 if both are.
#[inline(always)]
pub(crate) const fn proper_fraction(least: u32, most: u32) -> u32 {
    let ratio = fraction(least, most);
    if ratio > 1 << 24 { 1 << 24 } else { ratio }
}

/// [`proper_fraction`], and more than one by a few steps where it is one.
#[inline(always)]
const fn fraction(least: u32, most: u32) -> u32 {
    let shift = most.leading_zeros();
    let (least, most) = (least.wrapping_shl(shift), most.wrapping_shl(shift));
    // By the divisor's upper half, plus one so that nothing comes out too large: the first digit is short by 2 at most.
    let upper = (most >> 16).wrapping_add(1);
    let first = match least.checked_div(upper) {
        Some(digit) => digit,
        None => 0,
    };
    let rest = ((least as u64) << 16).wrapping_sub((first as u64).wrapping_mul(most as u64));
    let second = match ((rest >> 8) as u32).checked_div(upper) {
        Some(digit) => digit,
        None => 0,
    };
    (first << 8).wrapping_add(second)
}

/// atan(i / 256) as binary angles, 2^32 a turn.
static ARCTANGENTS: [u32; 257] = arctangents();

const fn arctangents() -> [u32; 257] {
    let mut table = [0; 257];
    let mut i = 1;
    while i <= 256 {
        table[i] = arctangent_of_share(i as i64);
        i += 1;
    }
    table
}

/// atan(i / 256) by Euler's series, Σ 2^2k (k!)² / (2k+1)! · x^(2k+1) / (1 + x²)^(k+1), in 60 fractional bits.
const fn arctangent_of_share(i: i64) -> u32 {
    const ONE: i128 = 1 << 60;
    let x = (i as i128) << 52;
    let squared = (x * x) >> 60;
    let step = (squared << 60) / (ONE + squared);
    let mut term = (x << 60) / (ONE + squared);
    let mut sum = 0;
    let mut k = 0;
    while k < 80 {
        sum += term;
        k += 1;
        // The next term: times 2k / (2k + 1) · x² / (1 + x²).
        term = ((term * step) >> 60) * (2 * k) / (2 * k + 1);
    }
    // Radians to turns: 2^32 / 2π = 683 565 275.576…, here with 30 fractional bits.
    const TURN: i128 = 733_972_625_820_500_307;
    ((sum * TURN + (1 << 89)) >> 90) as u32
}

#[cfg(test)]
mod tests {
    use crate::integer::{
        Reciprocal, divide, proper_fraction, quotient, ratio, saturate, square_root,
        square_root_of_word,
    };

    /// Numbers at and around every power of two, and pseudo-random ones.
    fn numbers() -> impl Iterator<Item = u64> + Clone {
        let edges = (0..64).flat_map(|bit| {
            let power = 1u64 << bit;
            [
                power.wrapping_sub(1),
                power,
                power.wrapping_add(1),
                u64::MAX - power,
            ]
        });
        let mut state = 1u64;
        let random = (0..2000).map(move |i| {
            state = state
                .wrapping_mul(6_364_136_223_846_793_005)
                .wrapping_add(1);
            state.rotate_left(17) >> (i % 64)
        });
        edges.chain(random)
    }

    #[test]
    fn roots_are_rounded_down() {
        for n in numbers() {
            assert_eq!(u64::from(square_root(n)), n.isqrt(), "{n}");
        }
        // Every root of 16 bits, at both ends of what has it.
        for root in 1u64 << 15..1 << 16 {
            let next = (root + 1) * (root + 1);
            for n in [root * root, next - 1] {
                assert_eq!(u64::from(square_root(n)), root);
                assert_eq!(u64::from(square_root(n << 32) >> 16), root);
            }
        }
        for root in numbers().map(|n| n >> 32) {
            assert_eq!(u64::from(square_root(root * root)), root);
            assert_eq!(
                u64::from(square_root((root * root).saturating_sub(1))),
                root.saturating_sub(1)
            );
        }
    }

    #[test]
    fn roots_of_words_are_those_of_longer_ones() {
        for n in numbers().flat_map(|n| [n as u32, (n >> 32) as u32]) {
            assert_eq!(square_root_of_word(n), n.isqrt(), "{n}");
        }
        for root in 0u32..1 << 16 {
            for n in [root * root, (root * root).saturating_add(2 * root)] {
                assert_eq!(square_root_of_word(n), root);
            }
        }
    }

    #[test]
    fn quotients_are_the_processors() {
        for n in numbers() {
            for d in numbers().map(|d| d as u32) {
                assert_eq!(divide(n, d), n.checked_div(d.into()), "{n} / {d}");
            }
        }
        for n in numbers() {
            for d in [1, -1, 2, -3, 7, i32::MAX, i32::MIN, 0] {
                let wanted = i128::from(n as i64).checked_div(d.into());
                assert_eq!(
                    quotient(n as i64, d).map(|q| q as u64),
                    wanted.map(|q| q as u64)
                );
            }
        }
    }

    #[test]
    fn ratios_are_rounded_towards_zero() {
        assert_eq!(ratio(i32::MIN, i32::MIN, 1), i32::MAX);
        assert_eq!(ratio(-7, 3, 2), -10);
        assert_eq!(ratio(5, 5, 0), 0);
    }

    #[test]
    fn narrowing_saturates() {
        for n in numbers().map(|n| n as i64) {
            let wanted = n.clamp(i32::MIN.into(), i32::MAX.into());
            assert_eq!(i64::from(saturate(n)), wanted, "{n}");
        }
    }

    #[test]
    fn fractions_are_short_by_two_steps_at_most() {
        for most in numbers().map(|n| n as u32).filter(|most| *most > 0) {
            for least in numbers().map(|n| n as u32).filter(|least| *least <= most) {
                let exact = (u64::from(least) << 24) / u64::from(most);
                let fraction = u64::from(proper_fraction(least, most));
                assert!(
                    fraction <= exact && exact <= fraction + 2,
                    "{least} / {most}"
                );
            }
        }
        assert_eq!(proper_fraction(0, 0), 0);
    }

    #[test]
    fn a_reciprocal_divides() {
        for numerator in [1 << 29, 683_565_276, 1 << 30] {
            for divisor in numbers().map(|d| d as u32) {
                let reciprocal = Reciprocal::new(numerator, divisor);
                let by = i128::from(divisor.clamp(1, 0x7fff_ffff));
                for value in numbers().map(|v| v as i32) {
                    let exact = i128::from(numerator) * i128::from(value) / by;
                    let quotient = i128::from(reciprocal.times(value));
                    let allowed = (exact.abs() >> 28) + 1;
                    assert!(
                        (quotient - exact).abs() <= allowed,
                        "{numerator} · {value} / {divisor}: {quotient}, not {exact}"
                    );
                }
            }
        }
    }
}
