//! Products wider than 32 bits, rounded down to 32. A processor that has no upper half of a product puts it together from
//! two of 16 bits; the results are the same.

/// `sum · reciprocal / 2²⁰` for a `reciprocal` from 2¹⁶ to 2¹⁷ and a result below 2²⁷.
#[inline(always)]
pub(super) const fn mean(sum: i32, reciprocal: u32) -> i32 {
    #[cfg(not(narrow))]
    return wide::mean(sum, reciprocal);
    #[cfg(narrow)]
    return narrow::mean(sum, reciprocal);
}

/// A fraction to multiply by, `factor / 2¹⁶⁺ˢʰⁱᶠᵗ`, `shift` from 1 to 16, as the processor wants it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(not(narrow), repr(transparent))]
pub(super) struct Fraction {
    #[cfg(not(narrow))]
    ready: wide::Fraction,
    #[cfg(narrow)]
    ready: narrow::Fraction,
}

impl Fraction {
    pub const fn new(factor: u16, shift: u8) -> Self {
        Self {
            #[cfg(not(narrow))]
            ready: wide::Fraction::new(factor, shift),
            #[cfg(narrow)]
            ready: narrow::Fraction::new(factor, shift),
        }
    }

    /// Times `value`.
    #[inline(always)]
    pub const fn of(self, value: i32) -> i32 {
        self.ready.of(value)
    }
}

/// Of the 64-bit product the upper half, which is an instruction of its own nearly everywhere.
#[cfg(any(not(narrow), test))]
mod wide {
    #[inline(always)]
    pub const fn mean(sum: i32, reciprocal: u32) -> i32 {
        upper_half(sum, reciprocal.wrapping_shl(12) as i32)
    }

    /// At the top of 32 bits, so that the product's upper half is the result.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    #[repr(transparent)]
    pub struct Fraction(i32);

    impl Fraction {
        pub const fn new(factor: u16, shift: u8) -> Self {
            Self((factor as i32).wrapping_shl(16u32.wrapping_sub(shift as u32)))
        }

        #[inline(always)]
        pub const fn of(self, value: i32) -> i32 {
            upper_half(value, self.0)
        }
    }

    #[inline(always)]
    const fn upper_half(a: i32, b: i32) -> i32 {
        ((a as i64).wrapping_mul(b as i64) >> 32) as i32
    }
}

#[cfg(any(narrow, test))]
mod narrow {
    #[inline(always)]
    pub const fn mean(sum: i32, reciprocal: u32) -> i32 {
        let beyond_one = times(sum, reciprocal.wrapping_sub(1 << 16));
        sum.wrapping_add(beyond_one) >> 4
    }

    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub struct Fraction {
        factor: u16,
        shift: Shift,
    }

    impl Fraction {
        pub const fn new(factor: u16, shift: u8) -> Self {
            Self {
                factor,
                shift: SHIFTS[shift.wrapping_sub(1) as usize & 15],
            }
        }

        #[inline(always)]
        pub const fn of(self, value: i32) -> i32 {
            times(value, self.factor as u32).wrapping_shr(self.shift as u32)
        }
    }

    /// 1 to 16, and the compiler knows: of a shift below 32 it masks nothing out.
    #[rustfmt::skip]
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    #[repr(u8)]
    enum Shift { N1 = 1, N2, N3, N4, N5, N6, N7, N8, N9, N10, N11, N12, N13, N14, N15, N16 }

    #[rustfmt::skip]
    const SHIFTS: [Shift; 16] = {
        use Shift::*;
        [N1, N2, N3, N4, N5, N6, N7, N8, N9, N10, N11, N12, N13, N14, N15, N16]
    };

    /// `value · factor / 2^16`, rounded down, for a factor up to 2^16.
    #[inline(always)]
    const fn times(value: i32, factor: u32) -> i32 {
        let upper = (value >> 16).wrapping_mul(factor as i32);
        let lower = (value as u32 & 0xffff).wrapping_mul(factor) >> 16;
        upper.wrapping_add(lower as i32)
    }
}

#[cfg(test)]
mod tests {
    use super::{narrow, wide};

    /// Numbers at and around every power of two, of both signs.
    fn numbers() -> impl Iterator<Item = i32> {
        (0..31).flat_map(|bit| {
            let power = 1i32 << bit;
            [power - 1, power, power / 3 * 2, -power, 1 - power]
        })
    }

    #[test]
    fn both_ways_give_the_same_integer() {
        for sum in numbers() {
            for reciprocal in (1 << 16..=1 << 17).step_by(13).chain([1 << 17]) {
                let exact = (i64::from(sum) * i64::from(reciprocal)) >> 20;
                if exact.abs() >= 1 << 27 {
                    continue;
                }
                assert_eq!(i64::from(wide::mean(sum, reciprocal)), exact);
                assert_eq!(i64::from(narrow::mean(sum, reciprocal)), exact);
            }
        }
        for value in numbers() {
            for factor in (0..=u16::MAX).step_by(127).chain([1, u16::MAX]) {
                for shift in 1..=16 {
                    let exact = (i64::from(value) * i64::from(factor)) >> (16 + shift);
                    assert_eq!(
                        i64::from(wide::Fraction::new(factor, shift).of(value)),
                        exact
                    );
                    assert_eq!(
                        i64::from(narrow::Fraction::new(factor, shift).of(value)),
                        exact
                    );
                }
            }
        }
    }
}
