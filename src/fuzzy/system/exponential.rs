//! The exponential function in integers, for curves that are made while the program compiles.

/// ln 2 with 60 fractional bits.
const LN_2: i128 = 799_144_290_325_165_979;

/// e^`x` for `x` with 32 fractional bits: a mantissa with 60 fractional bits, in [1, 2), and the power of two that
/// multiplies it. Exact to 2⁻⁵⁵.
pub(super) const fn exponential(x: i64) -> (u64, i32) {
    let x = (x as i128) << 28;
    let power = x.div_euclid(LN_2);
    let rest = x.rem_euclid(LN_2) as i64;
    // Σ restⁿ / n!, until the terms vanish; rest is below 0.7.
    let (mut sum, mut term, mut n) = (1i64 << 60, 1i64 << 60, 1);
    while term > 0 {
        term = ((term as i128 * rest as i128) >> 60) as i64 / n;
        sum += term;
        n += 1;
    }
    (sum as u64, power as i32)
}

/// e^−`x` for `x` ≥ 0 with 32 fractional bits, with 60 fractional bits.
pub(super) const fn decay(x: i64) -> u64 {
    let (mantissa, power) = exponential(-x);
    if power < -63 { 0 } else { mantissa >> -power }
}

#[cfg(test)]
mod tests {
    use super::{decay, exponential};

    const ONE: i64 = 1 << 32;

    /// A mantissa is right to 2^-55, five of its last places and a bit.
    fn is(x: i64, mantissa: u64, power: i32) {
        let (found, of) = exponential(x);
        assert!(
            of == power && found.abs_diff(mantissa) <= 1 << 5,
            "{x}: {found} · 2^{of}, not {mantissa} · 2^{power}"
        );
    }

    #[test]
    fn powers_of_e_are_known() {
        // e^x / 2^power with 60 fractional bits.
        is(0, 1 << 60, 0);
        is(ONE, 1_566_982_787_806_226_771, 1);
        is(-ONE, 1_696_544_475_317_221_319, -2);
        is(ONE / 2, 1_900_846_208_092_904_393, 0);
        is(10 * ONE, 1_549_974_736_652_820_383, 14);
        is(-20 * ONE, 1_275_792_298_167_396_070, -29);
    }

    #[test]
    fn a_sum_makes_a_product() {
        for i in 0..200 {
            let (x, y) = (i * 61_000_003, i * 13_000_001 + 7);
            let product = ((u128::from(decay(x)) * u128::from(decay(y))) >> 60) as u64;
            assert!(decay(x + y).abs_diff(product) <= 64, "{x}, {y}");
            assert!(decay(x) > decay(x + 100_000_000), "{x}");
        }
        assert_eq!(decay(0), 1 << 60);
        assert_eq!(decay(100 * ONE), 0);
    }
}
