//! A design as code: a const Rust module for the library, or a C99 header and source that need nothing.
//!
//! ```text
//! model::System ──lower──▶ Lowered ─┬─▶ rust::general   fuzzypilot::fuzzy::system, the same integers as Lowered
//!        │                          └─▶ c               the same integers as Lowered
//!        └──ruspini──▶ RuleBase ──────▶ rust::fast      fuzzypilot::fuzzy's tables: four rules an evaluation
//! ```
//!
//! The text is the whole result: nothing is written anywhere here.

mod beyond;
pub mod c;
mod literal;
mod names;
mod pieces;
mod ruspini;
pub mod rust;
mod words;

use crate::fuzzy::check::Bounds;
use crate::fuzzy::lower::Lowered;
use crate::fuzzy::model::System;

pub use ruspini::{Axis, RuleBase, Table};

/// What is made into code.
#[derive(Clone, Copy, Debug)]
pub struct Design<'a> {
    /// What the design says.
    pub system: &'a System,
    /// Its fixed point.
    pub lowered: &'a Lowered,
    /// What the code is called; made into an identifier.
    pub name: &'a str,
    /// The command that makes the code, for its head.
    pub command: &'a str,
    /// What fixed point may be off, for its head.
    pub bounds: Option<&'a Bounds>,
}

impl Design<'_> {
    /// Two inputs that divide their axes between neighbouring peaks, a complete table of constants: the four rules around an
    /// input are all that fire.
    ///
    /// # Errors
    ///
    /// Why it is something else.
    pub fn rule_base(&self) -> Result<RuleBase, String> {
        ruspini::recognise(self.system, self.lowered)
    }
}
