//! The readers and writers of design files, compiled alone: a fuzz target is built with instruments, and the simulator's
//! plots and fonts would take most of an hour.

extern crate self as host_sim;

/// The simulator's modules of that name, as far as they are needed.
#[allow(missing_docs)]
pub mod fuzzy {
    #[path = "../../../host-sim/src/fuzzy/files.rs"]
    pub mod files;
    #[path = "../../../host-sim/src/fuzzy/model.rs"]
    pub mod model;
}

mod check;

pub use check::check;
