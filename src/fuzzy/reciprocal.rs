//! 1 / Σw. Four rules of two Ruspini partitions weigh between one and two, so one reciprocal is all the division there
//! is, and every output shares it.

/// 2³² / Σw, rounded down, where Σw is 2¹⁵ + 2·`excess` and `excess` 0 to 2¹⁴: 2¹⁶ to 2¹⁷.
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
    // Half of both, and the same result. The mask takes nothing away: it shows the compiler that this is not zero.
    let half = (1u32 << 14).wrapping_add(excess & 0x7fff);
    (1 << 31) / half
}

/// Two steps from a straight line. The constants are any of those for which the result is never too large and too small
/// by one at most; the remainder then tells which.
#[cfg(any(narrow, test))]
#[inline(always)]
fn by_newton(excess: u32) -> u32 {
    // Half of both, so that an error has its sign; Σw is even.
    const ONE: u32 = 1 << 31;
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
            let exact = ((1u64 << 32) / u64::from((1 << 15) + 2 * excess)) as u32;
            // What `product::mean` takes; one less, and half a product would be wrong.
            assert!((1 << 16..=1 << 17).contains(&exact));
            assert_eq!(by_division(excess), exact, "{excess}");
            assert_eq!(by_newton(excess), exact, "{excess}");
        }
    }
}
