//! What `host-sim fuzzy convert` writes as code is compiled, run and compared, integer by integer: the general Rust modules and
//! the C sources with the simulator's fixed point, the fast Rust modules with the library's tables.
//!
//! `EMITTED_SYSTEMS=1000` makes it a long campaign: so many random systems instead of a few dozen, with clippy.

mod c;
mod cases;
mod fast;
mod golden;
mod rust;
mod systems;

use std::path::PathBuf;

/// How many random systems, and whether that is many.
fn campaign() -> (usize, bool) {
    match std::env::var("EMITTED_SYSTEMS") {
        Ok(number) => (number.parse().expect("EMITTED_SYSTEMS is a number"), true),
        Err(_) => (50, false),
    }
}

/// A folder that stays from run to run, so that what did not change is not built again.
fn folder(name: &str) -> PathBuf {
    let folder = PathBuf::from(env!("CARGO_TARGET_TMPDIR"))
        .join("emitted")
        .join(name);
    std::fs::create_dir_all(&folder).unwrap();
    folder
}

/// Writes a file if it says something else.
fn put(file: PathBuf, text: &str) {
    if std::fs::read_to_string(&file).ok().as_deref() != Some(text) {
        std::fs::write(file, text).unwrap();
    }
}
