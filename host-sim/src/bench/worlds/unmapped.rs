//! Cylinders that the planner's path knows nothing of: from a CSV file with `world,x,y,r` a line, metres, or placed on
//! the path.

use super::error::WorldError;
use super::planner;
use crate::bench::arena::{Arena, Circle};
use crate::bench::baselines::route::{Route, distance};
use crate::bench::seeds::{Purpose, normal, stream};
use rand::RngExt;
use rayon::prelude::*;
use std::path::Path;

/// Cylinders that are placed on a path.
const PLACED: usize = 3;

/// Their radius, m: the benchmark's.
const RADIUS: f64 = 0.075;

/// Radius of the disc for which they leave a way, m.
const WAY: f64 = 0.3;

/// Standard deviation of their distance from the path, m.
const BESIDE: f64 = 0.1;

/// How far they stay from start and goal, m: there the robot could not but touch them, or need not pass them.
const FREE: f64 = 1.2;

/// Throws before a world is left with fewer.
const THROWS: usize = 200;

/// Adds the file's cylinders to their worlds. Lines of worlds that are not there are no error: a file serves any choice
/// of worlds.
pub fn add(file: &Path, arenas: &mut [Arena]) -> Result<(), WorldError> {
    let place = |line: u64| format!("{}:{line}", file.display());
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .flexible(true)
        .from_path(file)
        .map_err(|e| WorldError::Unreadable {
            file: file.display().to_string(),
            why: e.to_string(),
        })?;
    let mut any = false;
    for (index, record) in reader.records().enumerate() {
        let record = record.map_err(|e| WorldError::Unreadable {
            file: file.display().to_string(),
            why: e.to_string(),
        })?;
        let line = record.position().map_or(0, csv::Position::line);
        let fields: Vec<&str> = record.iter().collect();
        if index == 0 && fields == ["world", "x", "y", "r"] {
            continue;
        }
        let (number, circle) = cylinder(&fields).ok_or_else(|| {
            WorldError::wrong(
                place(line),
                format!("`{}`", fields.join(",")),
                "world,x,y,r: a world's number, a place within 1000 m, a radius above 0 and up to 10 m",
            )
        })?;
        any = true;
        if let Some(arena) = arenas.iter_mut().find(|a| a.number == number) {
            arena.circles.push(circle);
        }
    }
    if any {
        Ok(())
    } else {
        Err(WorldError::wrong(
            file.display().to_string(),
            "no cylinder",
            "world,x,y,r a line",
        ))
    }
}

/// Places three cylinders on every path, the same ones for the same world. Each is thrown anew until a disc of 0.3 m still
/// has a way from start to goal; a world without room for three gets fewer.
pub fn place(arenas: &mut [Arena]) {
    arenas.par_iter_mut().for_each(|arena| {
        let mut rng = stream(0, arena.number, Purpose::Unmapped);
        let route = Route::new(&arena.route);
        let start = [arena.start[0], arena.start[1]];
        let mut placed = 0;
        for _ in 0..THROWS {
            let along = route.length() * rng.random::<f64>();
            let on = route.point(along);
            let at = [
                on[0] + BESIDE * normal(&mut rng),
                on[1] + BESIDE * normal(&mut rng),
            ];
            if distance(at, start) < FREE || distance(at, arena.goal) < FREE + arena.goal_radius {
                continue;
            }
            arena.circles.push(Circle { at, radius: RADIUS });
            let way = planner::route(&arena.circles, WAY, start, arena.goal, arena.goal_radius);
            if way.is_none() {
                arena.circles.pop();
                continue;
            }
            placed += 1;
            if placed == PLACED {
                break;
            }
        }
    });
}

fn cylinder(fields: &[&str]) -> Option<(u32, Circle)> {
    let [world, x, y, r] = fields else {
        return None;
    };
    let number = |text: &str| text.parse::<f64>().ok().filter(|x| x.abs() <= 1000.0);
    let radius = number(r).filter(|r| *r > 0.0 && *r <= 10.0)?;
    Some((
        world.parse().ok()?,
        Circle {
            at: [number(x)?, number(y)?],
            radius,
        },
    ))
}
