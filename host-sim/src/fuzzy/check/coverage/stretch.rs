//! A part of an input's range.

use crate::fuzzy::model::Input;
use std::fmt;

/// A part of an input's range: an interval, each end inside it or not, or one value.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stretch {
    /// Least value.
    pub from: f64,
    /// Greatest value.
    pub to: f64,
    /// Whether `from` belongs to it.
    pub with_from: bool,
    /// Whether `to` belongs to it.
    pub with_to: bool,
}

impl Stretch {
    pub(super) fn point(x: f64) -> Self {
        Self {
            from: x,
            to: x,
            with_from: true,
            with_to: true,
        }
    }

    pub(super) fn between(from: f64, to: f64) -> Self {
        Self {
            from,
            to,
            with_from: false,
            with_to: false,
        }
    }

    /// This stretch and the one that follows it without a gap, as one.
    pub(super) fn joined(self, next: Self) -> Self {
        Self {
            to: next.to,
            with_to: next.with_to,
            ..self
        }
    }

    /// A value inside: the middle.
    pub fn example(&self) -> f64 {
        self.from + (self.to - self.from) / 2.0
    }

    /// Its part of a range, 0 to 1; 0 for one value.
    pub fn share(&self, input: &Input) -> f64 {
        (self.to - self.from) / (input.range.end() - input.range.start())
    }

    /// Whether `x` lies in it.
    pub fn contains(&self, x: f64) -> bool {
        let after = x > self.from || (x == self.from && self.with_from);
        let before = x < self.to || (x == self.to && self.with_to);
        after && before
    }
}

/// As an interval, `(1.5, 2]`, or the one value.
impl fmt::Display for Stretch {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.from == self.to {
            return write!(f, "exactly {}", self.from);
        }
        let open = if self.with_from { '[' } else { '(' };
        let close = if self.with_to { ']' } else { ')' };
        write!(f, "{open}{}, {}{close}", self.from, self.to)
    }
}
