//! From two crisp inputs to the four rules that fire.

use super::{Grade, Membership, Partition};
use core::num::NonZeroU32;
use fixed::types::I16F16;
use heapless::Vec;

/// The two partitioned inputs of a rule base; rows and columns as its tables are printed.
#[derive(Clone, Debug)]
pub struct Antecedents<const R: usize, const C: usize> {
    /// The input whose terms head the rows.
    pub rows: Partition<R>,
    /// The input whose terms head the columns.
    pub cols: Partition<C>,
}

impl<const R: usize, const C: usize> Antecedents<R, C> {
    /// Evaluates the antecedents once, for every output table to use.
    #[inline]
    pub fn activate(&self, row_input: I16F16, col_input: I16F16) -> Activation<R, C> {
        Activation::new(self.rows.fuzzify(row_input), self.cols.fuzzify(col_input))
    }
}

/// The activation of a base of `R × C` rules: the four around an input; all others are zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Activation<const R: usize, const C: usize>(ActiveRules);

/// The four rules around an input, rows `row`, `row + 1`, columns `col`, `col + 1`, and their degrees, whatever the size
/// of their base. By default none fires.
///
/// Two are equal if the same rules fire with the same degrees: where one alone does, it is not told which of the four
/// it was.
#[derive(Clone, Copy, Debug, Default)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct ActiveRules {
    row: u8,
    col: u8,
    degrees: [Grade; 4],
}

/// A rule that fired.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct FiredRule {
    /// Row of the table.
    pub row: u8,
    /// Column of the table.
    pub col: u8,
    /// How strongly, above zero.
    pub degree: Grade,
}

impl<const R: usize, const C: usize> Activation<R, C> {
    fn new(row: Membership, col: Membership) -> Self {
        let (r1, c1) = (row.upper_grade, col.upper_grade);
        let (r0, c0) = (r1.complement(), c1.complement());
        Self(ActiveRules {
            row: row.lower,
            col: col.lower,
            degrees: [r0.min(c0), r0.min(c1), r1.min(c0), r1.min(c1)],
        })
    }

    /// Of degrees that the two grades' minima are.
    #[inline(always)]
    pub(super) fn at(row: usize, col: usize, degrees: [Grade; 4]) -> Self {
        Self(ActiveRules {
            row: row as u8,
            col: col as u8,
            degrees,
        })
    }

    /// Upper row of the four, 0 to R − 2.
    pub const fn row(&self) -> u8 {
        self.0.row
    }

    /// Left column of the four, 0 to C − 2.
    pub const fn col(&self) -> u8 {
        self.0.col
    }

    /// Degrees of (row, col), (row, col + 1), (row + 1, col), (row + 1, col + 1).
    pub const fn degrees(&self) -> [Grade; 4] {
        self.0.degrees
    }

    /// Σ w. With f and g the two upper grades it is 1 + 2·min(f, 1 − f, g, 1 − g): 2¹⁵ to 2¹⁶, never zero.
    #[inline]
    pub fn weight(&self) -> NonZeroU32 {
        let [a, b, c, d] = self.0.degrees.map(|g| u32::from(g.bits()));
        let sum = a.wrapping_add(b).wrapping_add(c).wrapping_add(d);
        NonZeroU32::new(sum).unwrap_or(NonZeroU32::MIN)
    }

    /// The four, for a record that holds rules of any base.
    pub const fn rules(&self) -> ActiveRules {
        self.0
    }

    /// The rules with a degree above zero, in the table's reading order: one, two or four.
    pub fn fired(&self) -> Vec<FiredRule, 4> {
        self.0.fired()
    }
}

/// Down and to the right, in reading order.
const CELLS: [(u8, u8); 4] = [(0, 0), (0, 1), (1, 0), (1, 1)];

impl ActiveRules {
    /// The rules with a degree above zero, in the table's reading order: one, two or four of an [`Activation`].
    pub fn fired(&self) -> Vec<FiredRule, 4> {
        let mut fired = Vec::new();
        for ((down, right), degree) in CELLS.into_iter().zip(self.degrees) {
            if degree > Grade::ZERO {
                // There is room for four.
                let _ = fired.push(FiredRule {
                    row: self.row.saturating_add(down),
                    col: self.col.saturating_add(right),
                    degree,
                });
            }
        }
        fired
    }

    /// From rules that fired; `None` for what [`fired`](Self::fired) never answers: rules that are no neighbours, out of
    /// reading order, twice there or of degree zero.
    pub fn of_fired(fired: &[FiredRule]) -> Option<Self> {
        let row = fired.iter().map(|rule| rule.row).min().unwrap_or(0);
        let col = fired.iter().map(|rule| rule.col).min().unwrap_or(0);
        let degrees = CELLS.map(|(down, right)| {
            let here = |rule: &&FiredRule| {
                rule.row.wrapping_sub(row) == down && rule.col.wrapping_sub(col) == right
            };
            fired
                .iter()
                .find(here)
                .map_or(Grade::ZERO, |rule| rule.degree)
        });
        let rules = Self { row, col, degrees };
        (rules.fired() == fired).then_some(rules)
    }
}

impl PartialEq for ActiveRules {
    fn eq(&self, other: &Self) -> bool {
        self.fired() == other.fired()
    }
}

impl Eq for ActiveRules {}
