//! The benchmark's own files: `world_N.world`, an SDF 1.6 world of static cylinders, and `path_files/path_N.npy`, the
//! reference path in grid cells. Either folder layout of the benchmark is found: worlds in the folder itself or in its
//! `world_files`.

use super::error::WorldError;
use super::npy;
use super::numbers::Numbers;
use super::text;
use crate::bench::arena::{Arena, Circle};
use roxmltree::{Document, Node};
use std::fs::File;
use std::io::Read;
use std::path::{Path, PathBuf};

/// The task that goes with the worlds: start, goal and its radius.
const START: [f64; 3] = [-2.25, 3.0, 1.57];
const GOAL: [f64; 2] = [-2.25, 13.0];
const GOAL_RADIUS: f64 = 1.0;

/// Edge of a grid cell of the path, and where cell (0, 0) lies, m.
const CELL: f64 = 0.15;
const ORIGIN: [f64; 2] = [-4.575, 5.075];

/// Longest path that is read, bytes.
const MOST_BYTES: u64 = 64 << 20;

/// Reads the worlds of a folder that were asked for.
pub fn read_folder(folder: &Path, numbers: &Numbers) -> Result<Vec<Arena>, WorldError> {
    all_worlds(folder)?
        .into_iter()
        .filter(|(number, _)| numbers.holds(*number))
        .map(|(number, file)| {
            let path = folder.join("path_files").join(format!("path_{number}.npy"));
            let mut route = vec![[START[0], START[1]]];
            route.extend(read_path(&path)?);
            route.push(GOAL);
            Ok(Arena {
                number,
                circles: read_cylinders(&file)?,
                unmapped: 0,
                movers: Vec::new(),
                start: START,
                goal: GOAL,
                goal_radius: GOAL_RADIUS,
                sealed: false,
                route,
                course: None,
            })
        })
        .collect()
}

/// Numbers and files of a folder's worlds, of which there is one at least.
pub fn all_worlds(folder: &Path) -> Result<Vec<(u32, PathBuf)>, WorldError> {
    let mut found = worlds_in(folder)?;
    found.extend(worlds_in(&folder.join("world_files")).unwrap_or_default());
    found.sort();
    let twice = found.windows(2).find(|pair| pair[0].0 == pair[1].0);
    if let Some([(number, first), (_, second)]) = twice {
        return Err(WorldError::wrong(
            folder.display().to_string(),
            format!(
                "world {number} in {} and in {}",
                first.display(),
                second.display()
            ),
            "every world once",
        ));
    }
    if !found.is_empty() {
        return Ok(found);
    }
    const ALLOWED: &str = "a folder with world_N.world and path_files/path_N.npy";
    let lines = lines_in(folder);
    let place = folder.display().to_string();
    Err(if lines.is_empty() {
        WorldError::wrong(place, "no world_N.world", ALLOWED)
    } else {
        let found = format!("no world_N.world, but {}", lines.join(", "));
        let file = folder.join(&lines[0]);
        let allowed = format!("{ALLOWED}, or a file of lines: {}", file.display());
        WorldError::wrong(place, found, allowed)
    })
}

/// Names of a folder's files of JSON lines.
fn lines_in(folder: &Path) -> Vec<String> {
    let entries = std::fs::read_dir(folder).into_iter().flatten().flatten();
    let mut names: Vec<String> = entries
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .filter(|name| name.ends_with(".jsonl") || name.ends_with(".jsonl.gz"))
        .collect();
    names.sort();
    names
}

fn worlds_in(folder: &Path) -> Result<Vec<(u32, PathBuf)>, WorldError> {
    let unreadable = |e: std::io::Error| WorldError::Unreadable {
        file: folder.display().to_string(),
        why: e.to_string(),
    };
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(unreadable)? {
        let file = entry.map_err(unreadable)?.path();
        let name = file.file_name().unwrap_or_default().to_string_lossy();
        let number = name
            .strip_prefix("world_")
            .and_then(|rest| rest.strip_suffix(".world"))
            .and_then(|digits| digits.parse().ok());
        if let Some(number) = number {
            found.push((number, file));
        }
    }
    Ok(found)
}

/// Cylinders that stand in a world, at their collision shapes' places.
pub fn read_cylinders(file: &Path) -> Result<Vec<Circle>, WorldError> {
    let name = file.display().to_string();
    let text = text::read(file, "an SDF world")?;
    let document = Document::parse(&text)
        .map_err(|e| WorldError::wrong(name.clone(), e.to_string(), "an SDF world, whole"))?;
    let mut circles = Vec::new();
    let models = document
        .root_element()
        .children()
        .filter(|n| n.has_tag_name("world"))
        .flat_map(|world| world.children().filter(|n| n.has_tag_name("model")));
    for model in models {
        for link in model.children().filter(|n| n.has_tag_name("link")) {
            for collision in link.children().filter(|n| n.has_tag_name("collision")) {
                let Some(cylinder) = collision.descendants().find(|n| n.has_tag_name("cylinder"))
                else {
                    continue;
                };
                let wrong = |node: Node<'_, '_>, found: &str, allowed: &str| {
                    let line = document.text_pos_at(node.range().start).row;
                    WorldError::wrong(format!("{name}:{line}"), found, allowed)
                };
                let radius = cylinder
                    .children()
                    .find(|n| n.has_tag_name("radius"))
                    .and_then(|n| n.text())
                    .and_then(|t| t.trim().parse::<f64>().ok())
                    .filter(|r| *r > 0.0 && *r <= 100.0)
                    .ok_or_else(|| {
                        wrong(
                            cylinder,
                            "a cylinder without a radius",
                            "one above 0 and up to 100 m",
                        )
                    })?;
                // From the shape out to the world.
                let mut at = [0.0; 2];
                for node in [collision, link, model] {
                    let [x, y, yaw] = pose(node).ok_or_else(|| {
                        let allowed = "six numbers, x and y from -1000 to 1000 m";
                        wrong(node, "a pose of another kind", allowed)
                    })?;
                    let (sin, cos) = libm::sincos(yaw);
                    at = [x + at[0] * cos - at[1] * sin, y + at[0] * sin + at[1] * cos];
                }
                circles.push(Circle { at, radius });
            }
        }
    }
    if circles.is_empty() {
        return Err(WorldError::wrong(
            name,
            "no cylinder",
            "an SDF world with static cylinders",
        ));
    }
    Ok(circles)
}

/// x, y and yaw of an element's pose; zero if it has none.
fn pose(node: Node<'_, '_>) -> Option<[f64; 3]> {
    let Some(text) = node
        .children()
        .find(|n| n.has_tag_name("pose"))
        .and_then(|n| n.text())
    else {
        return Some([0.0; 3]);
    };
    let numbers: Vec<f64> = text
        .split_whitespace()
        .map(|t| t.parse().ok())
        .collect::<Option<_>>()?;
    match numbers[..] {
        [x, y, _, _, _, yaw] if x.abs() <= 1000.0 && y.abs() <= 1000.0 => Some([x, y, yaw]),
        _ => None,
    }
}

/// A reference path in metres.
fn read_path(file: &Path) -> Result<Vec<[f64; 2]>, WorldError> {
    let name = file.display().to_string();
    let mut bytes = Vec::new();
    File::open(file)
        .and_then(|f| f.take(MOST_BYTES).read_to_end(&mut bytes))
        .map_err(|e| WorldError::Unreadable {
            file: name.clone(),
            why: e.to_string(),
        })?;
    let allowed = "a NumPy array of n × 2 grid cells, whole";
    let cells = npy::pairs(&bytes).map_err(|found| WorldError::wrong(&name, found, allowed))?;
    if let Some(cell) = cells
        .iter()
        .flatten()
        .find(|x| !x.is_finite() || x.abs() > 1000.0)
    {
        return Err(WorldError::wrong(
            &name,
            format!("the cell {cell}"),
            allowed,
        ));
    }
    Ok(cells
        .into_iter()
        .map(|cell| [0, 1].map(|k| cell[k] * CELL + ORIGIN[k]))
        .collect())
}
