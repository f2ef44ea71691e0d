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
    extern crate std;
    use super::{decay, exponential};

    #[test]
    fn it_is_the_exponential_function() {
        for i in -4000..4000 {
            let x = i * 37_000_001;
            let real = x as f64 / 4_294_967_296.0;
            let (mantissa, power) = exponential(x);
            let got = mantissa as f64 / (1u64 << 60) as f64 * f64::powi(2.0, power);
            assert!((got / real.exp() - 1.0).abs() < 1e-13, "{real}");
            if x >= 0 {
                let got = decay(x) as f64 / (1u64 << 60) as f64;
                assert!((got - (-real).exp()).abs() < 1e-15, "{real}");
            }
        }
        assert_eq!(exponential(0), (1 << 60, 0));
        assert_eq!(decay(0), 1 << 60);
        assert_eq!(decay(100 << 32), 0);
    }
}
