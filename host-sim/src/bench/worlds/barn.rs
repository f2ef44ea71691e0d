//! The worlds of the Benchmark for Autonomous Robot Navigation (Perille, Truong, Xiao, Stone 2020) as JSON lines: one
//! world a line with `w` its number, `cyl` its cylinders' x, y, and `path` the reference path's x, y, in metres. A file
//! `common.json` beside it holds what all worlds share.

use super::error::{WorldError, of_json};
use super::text;
use crate::bench::arena::{Arena, Circle};
use serde::Deserialize;
use std::path::Path;

/// What its files hold, for messages.
const WORLD: &str = "a world: {\"w\":1,\"cyl\":[[x,y],…],\"path\":[[x,y],…]}";
const COMMON: &str = "the common part of the worlds";

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
    let common: Common = serde_json::from_str(&text::read(&beside, COMMON)?)
        .map_err(|e| malformed(&beside, e.line(), &e, COMMON))?;
    common.check(&beside.display().to_string())?;
    let mut arenas: Vec<Arena> = Vec::new();
    for (index, line) in text::read(file, "JSON lines")?.lines().enumerate() {
        if line.trim().is_empty() {
            continue;
        }
        let place = format!("{}:{}", file.display(), index + 1);
        let read: Line =
            serde_json::from_str(line).map_err(|e| malformed(file, index + 1, &e, WORLD))?;
        check(&place, &read.cyl)?;
        check(&place, &read.path)?;
        if read.path.is_empty() {
            return Err(WorldError::wrong(
                place,
                "a path without a point",
                "one point or more, between start and goal",
            ));
        }
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
    fn check(&self, place: &str) -> Result<(), WorldError> {
        let [x, y, _] = self.start;
        check(place, &self.common_cylinders_xy)?;
        check(place, &[[x, y], self.goal])?;
        for (name, radius) in [
            ("goal_radius", self.goal_radius),
            ("cyl_radius", self.cyl_radius),
        ] {
            if !(radius > 0.0 && radius <= 100.0) {
                let found = format!("the {name} {radius}");
                return Err(WorldError::wrong(place, found, "above 0 and up to 100 m"));
            }
        }
        Ok(())
    }

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
            unmapped: 0,
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

fn malformed(file: &Path, line: usize, error: &serde_json::Error, allowed: &str) -> WorldError {
    let place = format!("{}:{line}", file.display());
    WorldError::wrong(place, of_json(error), allowed)
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
