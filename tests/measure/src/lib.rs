//! Compares the tick on emulated microcontrollers with the desktop's byte by byte, and counts what it costs there.
//!
//! ```text
//! suite ──▶ tapes and the desktop's records ──▶ machine: QEMU plays them (tests/replica) ──▶ exact: compare
//!                                                                                       └──▶ counts ──▶ budgets
//! ```

pub mod budgets;
pub mod clock;
pub mod counts;
pub mod digests;
pub mod engine;
pub mod exact;
pub mod firmware;
pub mod footprint;
pub mod machine;
pub mod navigation;
pub mod page;
pub mod slack;
pub mod suite;
pub mod synthetic;
pub mod systems;
pub mod tape;

use std::path::PathBuf;

/// A file of the repository.
pub fn repository(path: &str) -> PathBuf {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    PathBuf::from(root).join(path)
}
