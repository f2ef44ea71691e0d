//! Worlds: read from the benchmark's files or from one's own, or made.

pub mod barn;
pub mod check;
pub mod error;
pub mod file;
pub mod gazebo;
pub mod generate;
mod npy;
pub mod numbers;
pub mod planner;
mod text;
pub mod unmapped;
pub mod wall;

use super::arena::Arena;
use super::body::Body;
use error::WorldError;
use numbers::Numbers;
use std::path::Path;

/// Radius of the disc that a route is planned for where a world has none, m, and what is tried when it does not fit.
const PLANNED: [f64; 3] = [0.36, 0.3, 0.25];

/// What `load` takes, for messages.
pub const PLACES: &str =
    "generated:KIND, a folder with world_N.world, a .jsonl or .jsonl.gz file, a .toml file";

/// The worlds of a place that were asked for, in the order of their numbers. Whether a body gets through them is left to
/// [`check::check`].
pub fn load(place: &str, numbers: &Numbers, body: &Body) -> Result<Vec<Arena>, WorldError> {
    let path = Path::new(place);
    let mut arenas = if let Some(kind) = place.strip_prefix("generated:") {
        generate::make(kind, numbers)?
    } else if path.is_dir() {
        gazebo::read_folder(path, numbers)?
    } else if place.ends_with(".jsonl") || place.ends_with(".jsonl.gz") {
        barn::read_lines(path)?
    } else if place.ends_with(".toml") {
        vec![file::read(path)?]
    } else {
        return Err(WorldError::wrong("--worlds", format!("`{place}`"), PLACES));
    };
    arenas.retain(|a| numbers.holds(a.number));
    arenas.sort_by_key(|a| a.number);
    for arena in &mut arenas {
        if arena.route.len() < 2 {
            plan(arena, body);
        }
    }
    Ok(arenas)
}

/// The numbers of a place's worlds; none where every number is one.
pub fn numbers_in(place: &str) -> Result<Option<Vec<u32>>, WorldError> {
    let path = Path::new(place);
    if place.starts_with("generated:") {
        Ok(None)
    } else if path.is_dir() {
        let worlds = gazebo::all_worlds(path)?;
        Ok(Some(worlds.into_iter().map(|(number, _)| number).collect()))
    } else if place.ends_with(".toml") {
        Ok(Some(vec![0]))
    } else {
        let worlds = barn::read_lines(path)?;
        Ok(Some(worlds.iter().map(|a| a.number).collect()))
    }
}

/// Gives a world the shortest route that is not too tight; the straight line if there is none.
fn plan(arena: &mut Arena, body: &Body) {
    let start = [arena.start[0], arena.start[1]];
    let least = body.inner_radius();
    arena.route = PLANNED
        .into_iter()
        .filter(|r| *r > least)
        .chain([least])
        .find_map(|r| planner::route(&arena.circles, r, start, arena.goal, 0.0))
        .unwrap_or_else(|| vec![start, arena.goal]);
}
