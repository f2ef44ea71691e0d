//! The readers and writers of design files, compiled alone: a fuzz target is built with instruments, and the simulator's
//! plots and fonts would take most of an hour. `src/fuzzy` is a link to the simulator's folder of that name.

extern crate self as host_sim;

/// The simulator's module, as far as it is needed.
pub mod fuzzy {
    pub mod files;
    pub mod model;
}

mod check;

pub use check::check;
