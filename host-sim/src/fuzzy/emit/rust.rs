//! A design as a module of Rust for the library: `#![no_std]`, nothing but constants.

mod fast;
mod general;
mod head;
mod shapes;

pub use fast::output_error;

use super::Design;
use super::names::{Identifiers, Taken};

/// Which part of the library evaluates it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Route {
    /// `fuzzypilot::fuzzy::system`: every rule, the same integers as the simulator's fixed point and as C.
    #[default]
    General,
    /// The tables of `fuzzypilot::fuzzy`: four rules an evaluation, and integers of their own.
    Fast,
    /// [`Route::Fast`] where the design is what it takes, else [`Route::General`].
    Auto,
}

/// Writes the module.
///
/// # Errors
///
/// Why the design cannot take the route.
pub fn write(design: &Design<'_>, route: Route) -> Result<String, String> {
    match (route, design.rule_base()) {
        (Route::Fast | Route::Auto, Ok(base)) => Ok(fast::module(design, &base)),
        (Route::Fast, Err(why)) => Err(why),
        (Route::General, Ok(_)) => Ok(general::module(design, None)),
        (Route::General | Route::Auto, Err(why)) => Ok(general::module(design, Some(&why))),
    }
}

/// Constants that every module has, in small letters.
const OWN: [&str; 6] = [
    "controller",
    "inputs",
    "outputs",
    "rules",
    "rows",
    "columns",
];

/// What is said of every variable.
const FRACTION: &str = "_fraction";

fn identifiers(design: &Design<'_>) -> Identifiers {
    let derived = [FRACTION, "_rules", "_consequents", "_set"];
    Identifiers::new(design.lowered.tables(), Taken::of(&OWN), &derived)
}

/// As a constant.
fn shout(name: &str) -> String {
    name.to_ascii_uppercase()
}
