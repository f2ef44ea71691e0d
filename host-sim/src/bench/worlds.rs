//! Worlds: read from the benchmark's files, or made.

pub mod barn;
pub mod error;
pub mod numbers;
pub mod unmapped;

use super::arena::Arena;
use error::WorldError;
use std::path::Path;

/// Worlds from where `place` says; all of them, in the order of their numbers.
pub fn load(place: &str) -> Result<Vec<Arena>, WorldError> {
    let mut arenas = barn::read_lines(Path::new(place))?;
    arenas.sort_by_key(|a| a.number);
    Ok(arenas)
}
