//! 1 / Σw. Four rules of two Ruspini partitions weigh between one and two, so one reciprocal is all the division there
//! is, and every output shares it.

/// (2³² − 1) / Σw, rounded down, where Σw is 2¹⁵ + 2·`excess` and `excess` 0 to 2¹⁴: from just below 2¹⁶ to just below
/// 2¹⁷.
///
/// The same integer on every processor. One without a division approaches it by Newton's method.
#[inline(always)]
pub(super) fn reciprocal(excess: u32) -> u32 {
    #[cfg(not(narrow))]
    return by_division(excess);
    #[cfg(narrow)]
    return by_newton(excess);
}

#[cfg(any(not(narrow), test))]
#[inline(always)]
fn by_division(excess: u32) -> u32 {
    // The mask takes nothing away: it shows the compiler that the divisor is not zero.
    let weight = (1u32 << 15).wrapping_add((excess & 0x7fff) << 1);
    u32::MAX / weight
}

/// Two steps from a straight line. The constants are any of those for which the result is never too large and too small
/// by one at most; the remainder then tells which.
#[cfg(any(narrow, test))]
#[inline(always)]
fn by_newton(excess: u32) -> u32 {
    // Half of both, so that an error has its sign; Σw is even.
    const ONE: u32 = i32::MAX as u32;
    let half = (1u32 << 14).wrapping_add(excess);
    let error = |one: u32, r: u32| one.wrapping_sub(half.wrapping_mul(r)) as i32;
    // Parallel to the chord of the hyperbola: within 8 %.
    let guess = 126_000_u32.wrapping_sub(excess << 2);
    // A step takes the error's square, 0.6 %, always to the low side: towards a little more than one it ends around it.
    let more = ONE.wrapping_add(85 << 16);
    let near =
        guess.wrapping_add_signed((error(more, guess) >> 13).wrapping_mul(guess as i32) >> 18);
    // Now the error is small, and three bits of it more fit the product.
    let nearest =
        near.wrapping_add_signed((error(ONE, near) >> 10).wrapping_mul(near as i32) >> 21);
    let above = nearest.wrapping_add(1);
    above.wrapping_add_signed(error(ONE, above) >> 31)
}

#[cfg(test)]
mod tests {
    use super::{by_division, by_newton};

    #[test]
    fn both_ways_give_the_same_integer_for_every_weight() {
        for excess in 0..=1 << 14 {
            let exact = u32::MAX / ((1 << 15) + 2 * excess);
            assert_eq!(by_division(excess), exact, "{excess}");
            assert_eq!(by_newton(excess), exact, "{excess}");
        }
    }
}
