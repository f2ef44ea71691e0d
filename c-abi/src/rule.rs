//! Rules that fired, as C sees them.

use fuzzypilot::fuzzy::ActiveRules;

/// A rule that fired.
#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct FpRule {
    /// Row of its cell in the rule table, from 0.
    pub row: u8,
    /// Column of its cell, from 0.
    pub col: u8,
    /// Activation degree, 1 / 2^15: 32768 is 1.
    pub degree: u16,
}

/// Those that fired in the table's reading order, and how many; the rest is zero.
pub(crate) fn fired(rules: ActiveRules) -> ([FpRule; 4], u8) {
    let fired = rules.fired();
    let mut list = [FpRule::default(); 4];
    for (place, rule) in list.iter_mut().zip(&fired) {
        *place = FpRule {
            row: rule.row,
            col: rule.col,
            degree: rule.degree.bits(),
        };
    }
    (list, fired.len() as u8)
}
