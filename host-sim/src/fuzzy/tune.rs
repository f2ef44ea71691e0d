//! Tuning: a design's own numbers, moved until it does best what an [`Objective`] asks for.
//!
//! ```text
//! vector ──Movable──▶ System ──lower──▶ proven tables ──Objective──▶ cost ──CMA-ES──▶ next vectors
//! ```
//!
//! Only numbers move: peaks, feet, widths, consequents. Terms, rules, weights and ranges stay. Numbers keep their order and
//! ties stay ties ([`Movable`]), so whatever partition the design has it keeps; a candidate that the library's own checks
//! refuse is never judged.

mod changes;
pub mod data;
mod fit;
mod ladder;
mod movable;
mod numbers;
mod search;

pub use changes::{Change, changes};
pub use fit::{Fit, OutputFit};
pub use movable::{Movable, Selection};
pub use numbers::Variable;
pub use search::{Best, Outcome, Search};

use super::lower::Lowered;
use super::model::System;

/// What a design should do well.
pub trait Objective: Sync {
    /// How badly it does: finite, zero or more, less is better; `None` if it cannot be judged. The same for the same design
    /// on whichever thread.
    fn cost(&self, system: &System, lowered: &Lowered) -> Option<f64>;
}
