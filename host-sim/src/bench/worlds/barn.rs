//! The worlds of the Benchmark for Autonomous Robot Navigation (Perille, Truong, Xiao, Stone 2020) as JSON lines: one
//! world a line with `w` its number, `cyl` its cylinders' x, y, and `path` the reference path's x, y, in metres. A file
//! `common.json` beside it holds what all worlds share.

use super::error::WorldError;
use crate::bench::arena::{Arena, Circle};
use flate2::read::MultiGzDecoder;
use serde::Deserialize;
use std::fs::File;
use std::io::Read;
use std::path::Path;

/// Longest text that is read, bytes: several times all 300 worlds.
const MOST_BYTES: u64 = 64 << 20;

#[derive(Deserialize)]
struct Line {
    w: u32,
    cyl: Vec<[f64; 2]>,
    path: Vec<[f64; 2]>,
}

/// What all worlds of a file share.
#[derive(Clone, Debug, Deserialize)]
struct Common {
    start: [f64; 3],
    goal: [f64; 2],
    goal_radius: f64,
    cyl_radius: f64,
    common_cylinders_xy: Vec<[f64; 2]>,
}

/// Reads `FILE.jsonl` or `FILE.jsonl.gz` and the `common.json` beside it.
pub fn read_lines(file: &Path) -> Result<Vec<Arena>, WorldError> {
    let beside = file.with_file_name("common.json");
    let common: Common = serde_json::from_str(&text(&beside)?)
        .map_err(|e| malformed(&beside, e.line(), &e, "the common part of the worlds"))?;
    check(&beside.display().to_string(), &common.common_cylinders_xy)?;
    let mut arenas: Vec<Arena> = Vec::new();
    for (index, line) in text(file)?.lines().enumerate() {
        if line.trim().is_empty() {
            continue;
        }
        let place = format!("{}:{}", file.display(), index + 1);
        let read: Line = serde_json::from_str(line).map_err(|e| {
            malformed(
                file,
                index + 1,
                &e,
                "a world: {\"w\":1,\"cyl\":[[x,y],…],\"path\":[[x,y],…]}",
            )
        })?;
        check(&place, &read.cyl)?;
        check(&place, &read.path)?;
        if arenas.iter().any(|a| a.number == read.w) {
            return Err(WorldError::wrong(
                place,
                format!("world {} a second time", read.w),
                "every world once",
            ));
        }
        arenas.push(common.arena(read.w, &read.cyl, &read.path));
    }
    if arenas.is_empty() {
        return Err(WorldError::wrong(
            file.display().to_string(),
            "no world",
            "a world a line",
        ));
    }
    Ok(arenas)
}

impl Common {
    fn arena(&self, number: u32, cylinders: &[[f64; 2]], path: &[[f64; 2]]) -> Arena {
        let mut route = vec![[self.start[0], self.start[1]]];
        route.extend(path);
        route.push(self.goal);
        Arena {
            number,
            circles: self
                .common_cylinders_xy
                .iter()
                .chain(cylinders)
                .map(|&at| Circle {
                    at,
                    radius: self.cyl_radius,
                })
                .collect(),
            movers: Vec::new(),
            start: self.start,
            goal: self.goal,
            goal_radius: self.goal_radius,
            sealed: false,
            route,
            course: None,
        }
    }
}

/// A file's text, unpacked if it is packed.
fn text(file: &Path) -> Result<String, WorldError> {
    let unreadable = |why: String| WorldError::Unreadable {
        file: file.display().to_string(),
        why,
    };
    let opened = File::open(file).map_err(|e| unreadable(e.to_string()))?;
    let mut bytes = Vec::new();
    let read = if file.extension().is_some_and(|e| e == "gz") {
        MultiGzDecoder::new(opened)
            .take(MOST_BYTES + 1)
            .read_to_end(&mut bytes)
    } else {
        opened.take(MOST_BYTES + 1).read_to_end(&mut bytes)
    };
    read.map_err(|e| unreadable(e.to_string()))?;
    if bytes.len() as u64 > MOST_BYTES {
        return Err(unreadable("it is longer than 64 MiB".to_owned()));
    }
    String::from_utf8(bytes).map_err(|_| unreadable("it is not UTF-8 text".to_owned()))
}

fn malformed(file: &Path, line: usize, error: &serde_json::Error, allowed: &str) -> WorldError {
    WorldError::wrong(
        format!("{}:{line}", file.display()),
        error.to_string(),
        allowed,
    )
}

/// Coordinates must be on the ground that the simulator is built for.
fn check(place: &str, points: &[[f64; 2]]) -> Result<(), WorldError> {
    match points.iter().find(|p| p.iter().any(|x| x.abs() > 1000.0)) {
        Some([x, y]) => Err(WorldError::wrong(
            place,
            format!("({x}, {y})"),
            "coordinates from -1000 to 1000 m",
        )),
        None => Ok(()),
    }
}
