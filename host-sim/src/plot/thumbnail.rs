//! A run in little: the world, the route, the way in the modes' colours and the outline where it ended. For pages with
//! many runs.

use super::palette::{STOP, hex};
use super::run::{OBSTACLE, PATH, drawable, thinned, trajectory};
use super::{INK, Panel, Placer, Point, Rect, document, extent, unit, units};
use crate::recording::{Frame, Recording};
use anyhow::{Context, Result, ensure};
use plotters::style::{Color, WHITE};
use std::collections::BTreeMap;
use std::fmt::Write;

/// Height of the picture, pixels, and its widest.
const HEIGHT: f64 = 320.0;
const WIDEST: f64 = 380.0;

/// Room around everything, m.
const ROOM: f64 = 0.3;

/// Radius of the dot where the run began, pixels.
const START: f64 = 3.5;

/// Half the side of the cross on what was touched, pixels.
const CROSS: f64 = 4.0;

/// What a thumbnail shows beside the run.
#[derive(Clone, Copy, Debug)]
pub struct Place<'a> {
    /// Centre (m) and radius (m) of the goal.
    pub goal: [f64; 3],
    /// Corners of the robot where the run ended, m.
    pub outline: &'a [[f64; 2]],
    /// Whether it touched something there.
    pub touched: bool,
}

/// Draws it.
///
/// # Errors
/// When the run has no frame.
pub fn thumbnail_svg(rec: &Recording, place: &Place<'_>) -> Result<String> {
    let frames: Vec<&Frame> = rec.frames.iter().collect();
    ensure!(!frames.is_empty(), "a run without a frame");
    let [goal_x, goal_y, goal_radius] = place.goal;
    // What moves is where it was when the run ended.
    let places = frames.last().map_or(&[][..], |last| &last.movers);
    // What the path knows nothing of is hollow.
    let hollow = || rec.unmapped.iter().map(|d| (d.x, d.y, d.radius));
    let moved = || {
        let of = |(place, radius): (&[f64; 2], &f64)| (place[0], place[1], *radius);
        places.iter().zip(&rec.movers).map(of)
    };
    let along = |k: usize| {
        let track = frames.iter().map(|f| f.truth[k]);
        let route = rec.path.iter().flatten().map(|p| p[k]);
        let outline = place.outline.iter().map(|p| p[k]);
        let discs = drawable(rec).map(|d| (d.x, d.y, d.radius));
        let discs = discs.chain(hollow()).chain(moved());
        let discs = discs.flat_map(|(x, y, radius)| [[x, y][k] - radius, [x, y][k] + radius]);
        let goal = [goal_x, goal_y][k];
        let goal = [goal - goal_radius, goal + goal_radius];
        let (low, high) = extent(track.chain(route).chain(outline).chain(discs).chain(goal))
            .unwrap_or((0.0, 1.0));
        low - ROOM..high + ROOM
    };
    let (x, y) = (along(0), along(1));
    let (across, up) = (x.end - x.start, y.end - y.start);
    let scale = (HEIGHT / up).min(WIDEST / across);
    let (width, height) = ((across * scale).ceil(), (up * scale).ceil());
    let map = Panel {
        rect: Rect::new(0.0, 0.0, width, height),
        x,
        y,
        x_ticks: Vec::new(),
        y_ticks: Vec::new(),
        x_name: String::new(),
        y_name: String::new(),
        x_numbers: false,
    };
    let mut svg = document(width, height, |canvas| {
        canvas.ring(
            map.at(goal_x, goal_y),
            goal_radius * scale,
            1.2,
            PATH.to_rgba(),
        )?;
        for (x, y, radius) in hollow() {
            canvas.disc(map.at(x, y), radius * scale, WHITE.to_rgba())?;
            canvas.ring(map.at(x, y), radius * scale, 1.6, INK.to_rgba())?;
        }
        for (x, y, radius) in moved() {
            canvas.disc(map.at(x, y), radius * scale, OBSTACLE.mix(0.45))?;
            canvas.ring(map.at(x, y), radius * scale, 1.0, OBSTACLE.to_rgba())?;
        }
        for route in &rec.path {
            let points: Vec<Point> = route.iter().map(|p| map.at(p[0], p[1])).collect();
            canvas.dashes(&thinned(&points, 0.5), (5.0, 4.0), 1.2, PATH.to_rgba())?;
        }
        let mut nowhere = Placer {
            bounds: map.rect,
            taken: Vec::new(),
            points: Vec::new(),
        };
        let [x, y, _] = frames[0].truth;
        canvas.disc(map.at(x, y), START, INK.to_rgba())?;
        trajectory(canvas, &frames, &map, &mut nowhere)?;
        let mut outline: Vec<Point> = place.outline.iter().map(|p| map.at(p[0], p[1])).collect();
        outline.extend(outline.first().copied());
        let colour = if place.touched { STOP } else { INK };
        canvas.polygon(&outline, colour.mix(0.18))?;
        canvas.line(&outline, 1.4, colour.to_rgba())?;
        if let Some([x, y]) = rec.contact {
            let (x, y) = map.at(x, y);
            for side in [CROSS, -CROSS] {
                let arm = [(x - CROSS, y - side), (x + CROSS, y + side)];
                canvas.line(&arm, 1.6, STOP.to_rgba())?;
            }
        }
        Ok(())
    })?;
    let ground = svg.find("/>").context("a picture without a ground")? + "/>".len();
    svg.insert_str(ground, &dots(rec, &map, scale));
    Ok(svg.replace(" opacity=\"1\"", ""))
}

/// What stands still and is mapped, one path for all discs of a size: a world has hundreds of them, and so has every picture. A
/// line of no length with round ends is a disc.
fn dots(rec: &Recording, map: &Panel, scale: f64) -> String {
    let mut sizes: BTreeMap<i32, (String, (i32, i32))> = BTreeMap::new();
    for disc in drawable(rec) {
        let at = units(map.at(disc.x, disc.y));
        let (path, last) = sizes.entry(unit(disc.radius * scale)).or_default();
        // Short, as from the one before.
        let _ = write!(path, "m{} {}h0", at.0 - last.0, at.1 - last.1);
        *last = at;
    }
    let paths = sizes.into_iter().map(|(radius, (path, _))| {
        format!(
            "\n<path fill=\"none\" stroke=\"{}\" stroke-width=\"{}\" stroke-linecap=\"round\" d=\"{path}\"/>",
            hex(OBSTACLE).to_uppercase(),
            2 * radius,
        )
    });
    paths.collect()
}
