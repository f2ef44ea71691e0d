//! Numbers of steps as decimal fractions that are read back as the same steps.

/// The shortest decimal number whose nearest number of steps of 2^−`fraction` this is, and no other as near; `None` if there is
/// none of 14 places or the format has no such literals (0 to 31 fractional bits have).
pub fn literal(steps: i32, fraction: i32) -> Option<String> {
    let fraction = u32::try_from(fraction).ok().filter(|&bits| bits <= 31)?;
    let magnitude = u128::from(steps.unsigned_abs());
    (0..=14).find_map(|places| {
        let power = 10u128.pow(places);
        let digits = (magnitude * power + (1 << fraction >> 1)) >> fraction;
        // |digits / power − steps / 2^fraction| < half a step.
        let distance = (digits << fraction).abs_diff(magnitude * power);
        if 2 * distance >= power {
            return None;
        }
        let sign = if steps < 0 { "-" } else { "" };
        let (whole, rest) = (digits / power, digits % power);
        Some(match places {
            0 => format!("{sign}{whole}"),
            _ => format!("{sign}{whole}.{rest:0width$}", width = places as usize),
        })
    })
}

#[cfg(test)]
mod tests {
    use super::literal;
    use fixed::FixedI32;
    use fixed::types::extra::{U0, U16, U24, U31};

    #[test]
    fn they_are_short() {
        for (steps, fraction, text) in [
            (18 << 16, 16, "18"),
            (-(3 << 15), 16, "-1.5"),
            (6554, 16, "0.1"),
            (0, 16, "0"),
            (-1, 16, "-0.00002"),
            (7, 0, "7"),
        ] {
            assert_eq!(literal(steps, fraction).as_deref(), Some(text));
        }
        assert_eq!((literal(1, 32), literal(1, -1)), (None, None));
    }

    #[test]
    fn they_are_read_back() {
        let mut state = 1u32;
        for _ in 0..20_000 {
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let steps = (state as i32) >> (1 + state % 23);
            let text = |fraction| literal(steps, fraction).unwrap();
            assert_eq!(FixedI32::<U0>::lit(&text(0)).to_bits(), steps);
            assert_eq!(FixedI32::<U16>::lit(&text(16)).to_bits(), steps);
            assert_eq!(FixedI32::<U24>::lit(&text(24)).to_bits(), steps);
            assert_eq!(FixedI32::<U31>::lit(&text(31)).to_bits(), steps);
        }
    }
}
