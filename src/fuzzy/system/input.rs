//! Inputs: a range and terms on it.

use super::arithmetic::limited;
use super::{LIMIT, Term};

/// An input variable. Numbers are in its own steps: of `fixed`'s `I16F16`, of millimetres, whatever is wanted.
#[derive(Clone, Copy, Debug)]
pub struct Input<'a> {
    /// The range that it is designed for, both ends included, ascending, within [`LIMIT`].
    pub range: [i32; 2],
    /// Whether values beyond the range count as its nearer end. If not, they count as they are, up to [`LIMIT`].
    pub clamp: bool,
    /// Whether every value of the range has a term with a degree above zero: a claim, proven when the system is made.
    pub complete: bool,
    /// Its terms, 1 to 255.
    pub terms: &'a [Term<'a>],
}

impl<'a> Input<'a> {
    /// An input whose values are limited to its range, and that claims to be complete.
    pub const fn new(range: [i32; 2], terms: &'a [Term<'a>]) -> Self {
        Self {
            range,
            clamp: true,
            complete: true,
            terms,
        }
    }

    /// The same, but some values may have no term.
    pub const fn with_gaps(self) -> Self {
        Self {
            complete: false,
            ..self
        }
    }

    /// The same, but values beyond the range count as they are.
    pub const fn unlimited(self) -> Self {
        Self {
            clamp: false,
            ..self
        }
    }

    /// What values are limited to.
    pub(super) const fn limits(&self) -> [i32; 2] {
        if self.clamp {
            self.range
        } else {
            [-LIMIT, LIMIT]
        }
    }

    #[inline]
    pub(super) const fn limited(&self, x: i32) -> i32 {
        limited(x as i64, self.limits())
    }
}
