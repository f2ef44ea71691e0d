//! Design files: the checked-in designs, round trips of random systems, bad files with their messages, mutated files.

mod arbitrary;
mod bad;
mod dialects;
mod good;
mod mutate;
mod round_trip;

/// The check that the fuzz targets make of every file.
#[path = "../../../fuzz/src/check.rs"]
mod fuzz;

use host_sim::fuzzy::files::{Format, load, parse};
use host_sim::fuzzy::model::System;
use std::fs;
use std::path::{Path, PathBuf};

/// Files of a folder of this package, in the order of their names.
fn files(folder: &str) -> Vec<PathBuf> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join(folder);
    let mut files: Vec<PathBuf> = fs::read_dir(&folder)
        .unwrap_or_else(|e| panic!("{}: {e}", folder.display()))
        .map(|entry| entry.unwrap().path())
        .collect();
    files.sort();
    files
}

fn designs() -> Vec<PathBuf> {
    files("designs")
}

fn design(name: &str) -> System {
    let file = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("designs")
        .join(name);
    load(&file, None).unwrap_or_else(|e| panic!("{e}"))
}

fn read(text: &str, format: Format) -> System {
    parse("test", text.as_bytes(), format).unwrap_or_else(|e| panic!("{e}\n{text}"))
}
