//! Cylinders that the planner's path knows nothing of: a CSV file with `world,x,y,r` a line, metres.

use super::error::WorldError;
use crate::bench::arena::{Arena, Circle};
use std::path::Path;

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
