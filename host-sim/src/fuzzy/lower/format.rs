//! The number format of a variable: how many fractional bits.

use fuzzypilot::fuzzy::system::LIMIT;

/// A binary number format: a step is 2^−`fraction`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Format {
    /// Fractional bits; negative for steps above one.
    pub fraction: i32,
}

/// `fixed`'s `I16F16`, wherever it does.
const USUAL: i32 = 16;
/// A range is at least so many steps wide, or gets finer ones.
const WIDTH: f64 = 65_536.0;
/// The largest number has at most so many steps. The engine's limit leaves room beyond.
const MOST: f64 = 536_870_912.0;

impl Format {
    /// No range has fewer steps.
    pub const LEAST_WIDTH: f64 = 256.0;

    /// For a range of this width, whose variable has numbers up to `magnitude`: 16 fractional bits, unless the range is then
    /// less than 2¹⁶ steps wide or a number more than 2²⁹ steps large. `None` if no format has room for both.
    pub fn of(width: f64, magnitude: f64) -> Option<Self> {
        let scaled = |value: f64, fraction: i32| value * f64::from(fraction).exp2();
        if !(width.is_finite() && magnitude.is_finite() && width > 0.0) {
            return None;
        }
        let mut fraction = USUAL;
        while scaled(width, fraction) < WIDTH && fraction < 1000 {
            fraction += 1;
        }
        while scaled(magnitude, fraction) > MOST && fraction > -1000 {
            fraction -= 1;
        }
        (scaled(width, fraction) >= Self::LEAST_WIDTH).then_some(Self { fraction })
    }

    /// A value in steps, unrounded.
    pub fn steps(self, value: f64) -> f64 {
        value * f64::from(self.fraction).exp2()
    }

    /// The nearest step, limited to the engine's numbers; NaN is 0.
    pub fn nearest(self, value: f64) -> i32 {
        let limit = f64::from(LIMIT);
        self.steps(value).round().clamp(-limit, limit) as i32
    }

    /// The value of a step.
    pub fn value(self, steps: i32) -> f64 {
        f64::from(steps) * f64::from(-self.fraction).exp2()
    }
}
