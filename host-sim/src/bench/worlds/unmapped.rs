//! Cylinders that the planner's path knows nothing of: from a CSV file with `world,x,y,r` a line, metres, or placed on
//! the path.

use super::error::{WorldError, short};
use super::{check, planner, text};
use crate::bench::arena::{Arena, Circle};
use crate::bench::baselines::route::{Route, distance};
use crate::bench::body::Body;
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

/// Adds the file's cylinders to their worlds, which come from `place` and are fit for `body` without them. Every world must
/// get some, so that none is driven as if it were mapped; lines of others are for other choices. Returns what is odd about
/// them: a world that is not in that place, if one is meant.
pub fn add(
    file: &Path,
    place: &str,
    arenas: &mut [Arena],
    body: &Body,
) -> Result<Option<String>, WorldError> {
    let cylinders = read(file)?;
    let at = |line: u64| format!("{}:{line}", file.display());
    let there = super::numbers_in(place)?;
    let stray = cylinders
        .iter()
        .find(|(_, world, _)| there.as_ref().is_some_and(|there| !there.contains(world)))
        .map(|(line, world, _)| {
            format!(
                "{}: world {world} is not in {place}; its lines are not used",
                at(*line)
            )
        });
    let own = |number: u32| {
        cylinders
            .iter()
            .filter(move |(_, world, _)| *world == number)
    };
    let without: Vec<u32> = arenas.iter().map(|a| a.number).collect();
    let without: Vec<u32> = without
        .into_iter()
        .filter(|n| own(*n).next().is_none())
        .collect();
    if let Some(first) = without.first() {
        let found = match without.len() {
            1 => format!("no cylinder for world {first}"),
            n => format!("no cylinder for world {first} and {} more", n - 1),
        };
        return Err(WorldError::wrong(
            file.display().to_string(),
            found,
            "a line or more for every world that is chosen; --numbers chooses those that have one",
        ));
    }
    arenas.par_iter_mut().try_for_each(|arena| {
        let mapped = arena.circles.len();
        arena
            .circles
            .extend(own(arena.number).map(|(.., circle)| *circle));
        arena.unmapped = arena.circles.len() - mapped;
        if check::fault(arena, body).is_none() {
            return Ok(());
        }
        // Which line is it? The first with which the world is unfit.
        arena.circles.truncate(mapped);
        for (line, number, circle) in own(arena.number) {
            arena.circles.push(*circle);
            if let Some(why) = check::fault(arena, body) {
                return Err(WorldError::Unusable {
                    place: at(*line),
                    number: *number,
                    why: short(&format!("with this cylinder {why}")),
                });
            }
        }
        Ok(())
    })?;
    Ok(stray)
}

/// A file's cylinders, each with its line and its world.
fn read(file: &Path) -> Result<Vec<(u64, u32, Circle)>, WorldError> {
    const LINES: &str = "world,x,y,r a line";
    let name = file.display().to_string();
    let text = text::read(file, LINES)?;
    let mut reader = csv::ReaderBuilder::new()
        .has_headers(false)
        .comment(Some(b'#'))
        .trim(csv::Trim::All)
        .flexible(true)
        .from_reader(text.as_bytes());
    let mut cylinders = Vec::new();
    for (index, record) in reader.records().enumerate() {
        let record = record.map_err(|e| WorldError::wrong(&name, e.to_string(), LINES))?;
        let line = record.position().map_or(0, csv::Position::line);
        let fields: Vec<&str> = record.iter().collect();
        if index == 0 && fields == ["world", "x", "y", "r"] {
            continue;
        }
        let (number, circle) = cylinder(&fields).ok_or_else(|| {
            WorldError::wrong(
                format!("{name}:{line}"),
                format!("`{}`", fields.join(",")),
                "world,x,y,r: a world's number, a place within 1000 m, a radius above 0 and up to 10 m",
            )
        })?;
        cylinders.push((line, number, circle));
    }
    if cylinders.is_empty() {
        return Err(WorldError::wrong(name, "no cylinder", LINES));
    }
    Ok(cylinders)
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
            arena.unmapped += 1;
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
