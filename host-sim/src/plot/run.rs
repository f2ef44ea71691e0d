//! One run: the map on top, its signals over time below.

use std::f64::consts::TAU;
use std::ops::Range;

use anyhow::{Result, ensure};
use plotters::style::{Color, RGBColor};

use super::palette::{GRAVEST, Hue, MODES, OTHER, STOP, known};
use super::{
    CENTRED, Canvas, FRAME, FROM_LEFT, INK, MUTED, Panel, Placer, Point, Rect, WIDTH, document,
    extent, fitted, nice_step, text_width, tick_text, ticks, ticks_by,
};
use crate::recording::{BeamView, Disc, Frame, Recording};

const LEFT: f64 = 96.0;
const RIGHT: f64 = 1172.0;
const MAP_TOP: f64 = 104.0;
const STRIP_HEIGHT: f64 = 98.0;
const STRIP_GAP: f64 = 16.0;

const BEAM: RGBColor = RGBColor(0x00, 0x9E, 0x73);
pub(super) const OBSTACLE: RGBColor = RGBColor(0x59, 0x61, 0x6B);
pub(super) const PATH: RGBColor = RGBColor(0x9A, 0xA0, 0xA6);

/// Most vertices of the trajectory and of a signal: what keeps a run of hours a figure of readable size.
const MOST_VERTICES: usize = 4000;
const MOST_MOMENTS: usize = 6;

/// Height of the bar over a strip that says the mode, pixels, and how much of its colour the strip below takes.
const BAR: f64 = 5.0;
const TINT: f64 = 0.07;

/// Least radius of an obstacle, pixels.
const LEAST_RADIUS: f64 = 0.9;

/// Draws a run: the map with path, trajectory by mode, obstacles and what the sensors saw at a few moments, and
/// below it cross-track error, commanded speed and yaw rate, and clearance over time.
///
/// # Errors
/// When the run has no frame with a finite time and pose.
pub fn run_svg(rec: &Recording) -> Result<String> {
    svg(rec, &Extras::default())
}

/// What a figure may show beside the usual.
#[derive(Clone, Debug)]
pub struct Extras<'a> {
    /// Said under the title instead of the seed.
    pub facts: Option<String>,
    /// What the recording's obstacles are, in the legend.
    pub obstacles: &'a str,
    /// Lines on the map that end in a point: x, y in metres.
    pub arrows: &'a [Vec<[f64; 2]>],
    /// Way driven where it is known better than from the frames, m.
    pub driven: Option<f64>,
}

impl Default for Extras<'_> {
    fn default() -> Self {
        Self {
            facts: None,
            obstacles: "obstacle",
            arrows: &[],
            driven: None,
        }
    }
}

/// [`run_svg`] with something beside it. The strip of the cross-track error is left out where there is none.
///
/// # Errors
/// As [`run_svg`].
pub fn svg(rec: &Recording, extras: &Extras<'_>) -> Result<String> {
    let frames: Vec<&Frame> = rec
        .frames
        .iter()
        .filter(|frame| frame.t.is_finite() && frame.truth.iter().all(|v| v.is_finite()))
        .collect();
    ensure!(
        !frames.is_empty(),
        "the run of {:?} has no frame to draw",
        rec.scenario
    );
    let map = map_panel(rec, &frames);
    let moments = moments(rec, &frames);
    let strips_top = map.rect.bottom + 84.0;
    let strips = if on_path(&frames) { 4.0 } else { 3.0 };
    let height = strips_top + strips * STRIP_HEIGHT + (strips - 1.0) * STRIP_GAP + 58.0;
    document(WIDTH, height, |canvas| {
        heading(canvas, rec, &frames, extras)?;
        legend(canvas, rec, &frames, &moments, extras)?;
        draw_map(canvas, rec, &frames, &map, &moments, extras.arrows)?;
        draw_strips(canvas, rec, &frames, strips_top, &moments)
    })
}

fn mode_colour(mode: &str) -> RGBColor {
    known(mode).unwrap_or(&OTHER).light
}

/// How much a mode matters where several share a pixel.
fn rank(mode: &str) -> u8 {
    known(mode).unwrap_or(&OTHER).rank
}

/// Whether there is a path that a cross-track error was measured from.
fn on_path(frames: &[&Frame]) -> bool {
    frames.iter().any(|frame| frame.cross_track.is_finite())
}

fn heading(canvas: &Canvas, rec: &Recording, frames: &[&Frame], extras: &Extras<'_>) -> Result<()> {
    canvas.text(
        &fitted(&rec.scenario, 24.0, RIGHT - LEFT),
        (LEFT, 28.0),
        24.0,
        INK,
        FROM_LEFT,
    )?;
    let driven: f64 = frames
        .windows(2)
        .map(|pair| {
            (pair[1].truth[0] - pair[0].truth[0]).hypot(pair[1].truth[1] - pair[0].truth[1])
        })
        .sum();
    // An empty sum is a negative zero.
    let driven = extras.driven.unwrap_or(driven.abs());
    let lasted = frames[frames.len() - 1].t - frames[0].t;
    let first = match &extras.facts {
        Some(facts) => facts.clone(),
        None => format!("seed {}", rec.seed),
    };
    let facts = format!("{first}  ·  {lasted:.1} s  ·  {driven:.1} m driven");
    let line = if rec.variant.trim().is_empty() {
        facts
    } else {
        let room = RIGHT - LEFT - text_width(&facts, 15.0) - 30.0;
        format!("{}  ·  {facts}", fitted(&rec.variant, 15.0, room))
    };
    canvas.text(&line, (LEFT, 55.0), 15.0, MUTED, FROM_LEFT)
}

/// One entry a kind of thing that the map shows.
fn legend(
    canvas: &Canvas,
    rec: &Recording,
    frames: &[&Frame],
    moments: &[usize],
    extras: &Extras<'_>,
) -> Result<()> {
    let y = 82.0;
    let mut x = LEFT;
    let mut entry = |name: &str, symbol: &dyn Fn(f64) -> Result<()>| -> Result<()> {
        symbol(x)?;
        canvas.text(name, (x + 30.0, y), 13.5, INK, FROM_LEFT)?;
        x += 30.0 + text_width(name, 13.5) + 20.0;
        Ok(())
    };
    if rec.path.iter().any(|line| line.len() > 1) {
        entry("path", &|x| {
            canvas.dashes(&[(x, y), (x + 24.0, y)], (6.0, 4.0), 1.3, PATH.to_rgba())
        })?;
    }
    for Hue { mode, .. } in MODES {
        if frames.iter().any(|frame| frame.mode == mode) {
            entry(mode, &|x| {
                canvas.line(&[(x, y), (x + 24.0, y)], 3.0, mode_colour(mode).to_rgba())
            })?;
        }
    }
    if frames.iter().any(|frame| known(frame.mode).is_none()) {
        entry("other mode", &|x| {
            canvas.line(&[(x, y), (x + 24.0, y)], 3.0, OTHER.light.to_rgba())
        })?;
    }
    if !rec.obstacles.is_empty() {
        let small = drawable(rec).all(|disc| disc.radius < 0.05);
        entry(extras.obstacles, &|x| {
            let radius = if small { 2.0 } else { 7.0 };
            canvas.disc((x + 15.0, y), radius, OBSTACLE.to_rgba())
        })?;
    }
    if !extras.arrows.is_empty() {
        entry("decided twist", &|x| {
            arrow(canvas, &[(x + 2.0, y), (x + 24.0, y)])
        })?;
    }
    entry("robot at start", &|x| {
        robot(canvas, (x + 14.0, y), 7.0, 0.0, INK, true)
    })?;
    if frames.len() > 1 {
        entry("at end", &|x| {
            end_mark(
                canvas,
                (x + 15.0, y),
                7.0,
                0.0,
                mode_colour(frames[frames.len() - 1].mode),
            )
        })?;
    }
    if !moments.is_empty() {
        let name = match moments.len() {
            1 => "sensor hits at A".to_owned(),
            count => format!("sensor hits at A–{}", letter(count - 1)),
        };
        entry(&name, &|x| {
            canvas.line(&[(x, y), (x + 22.0, y)], 1.1, BEAM.mix(0.6))?;
            canvas.disc((x + 22.0, y), 2.6, BEAM.to_rgba())
        })?;
    }
    Ok(())
}

/// Bounds and size of the map: equal scales, a height that is neither a slit nor a tower.
fn map_panel(rec: &Recording, frames: &[&Frame]) -> Panel {
    let reach = finite_radius(rec.robot_radius) * 1.6;
    let route = || {
        rec.path
            .iter()
            .flatten()
            .filter(|point| point.iter().all(|v| v.is_finite()))
    };
    let along = |axis: usize| {
        let seen = frames
            .iter()
            .flat_map(|frame| [frame.truth[axis] - reach, frame.truth[axis] + reach]);
        extent(seen.chain(route().map(|point| point[axis]))).unwrap_or((0.0, 1.0))
    };
    let (track_x, track_y) = (along(0), along(1));
    // A remote or enormous obstacle must not shrink the run to a dot: only what lies around it counts.
    let around = 0.4
        * (track_x.1 - track_x.0)
            .max(track_y.1 - track_y.0)
            .max(4.0 * reach);
    let near = |(low, high): (f64, f64)| low - around..high + around;
    let (near_x, near_y) = (near(track_x), near(track_y));
    let (mut low, mut high) = ((track_x.0, track_y.0), (track_x.1, track_y.1));
    for disc in drawable(rec) {
        let (left, right) = (disc.x - disc.radius, disc.x + disc.radius);
        let (below, above) = (disc.y - disc.radius, disc.y + disc.radius);
        if right < near_x.start || left > near_x.end || above < near_y.start || below > near_y.end {
            continue;
        }
        let whole = left >= near_x.start
            && right <= near_x.end
            && below >= near_y.start
            && above <= near_y.end;
        if whole {
            low = (low.0.min(left), low.1.min(below));
            high = (high.0.max(right), high.1.max(above));
            continue;
        }
        // Of one that does not fit, a slice at its near side will do.
        let slice = 0.3 * around;
        let toward = |(from, to): (f64, f64), (start, end): (f64, f64)| {
            (
                if to < start { to - slice } else { start },
                if from > end { from + slice } else { end },
            )
        };
        let (across, up) = (
            toward((left, right), track_x),
            toward((below, above), track_y),
        );
        low = (low.0.min(across.0), low.1.min(up.0));
        high = (high.0.max(across.1), high.1.max(up.1));
    }
    let pad = (0.05 * (high.0 - low.0).max(high.1 - low.1))
        .max(reach)
        .max(0.05);
    let mut x = low.0 - pad..high.0 + pad;
    let mut y = low.1 - pad..high.1 + pad;

    let full = RIGHT - LEFT;
    let shape = (y.end - y.start) / (x.end - x.start);
    let height = (full * shape).clamp(230.0, 760.0);
    // A tall map gets a narrower panel before it gets empty sides.
    let width = (height / shape).clamp(560.0_f64.min(full), full);
    let scale = (width / (x.end - x.start)).min(height / (y.end - y.start));
    widen(&mut x, width / scale);
    widen(&mut y, height / scale);
    let left = LEFT + (full - width) / 2.0;
    // At least a few lines across the short side, as long as the numbers along the long one keep their distance.
    let step = nice_step(height / scale, 4.0).min(nice_step(width / scale, width / 90.0));
    let step = step.max(nice_step(width / scale, width / 55.0));
    Panel {
        rect: Rect::new(left, MAP_TOP, width, height),
        x_ticks: ticks_by(&x, step),
        y_ticks: ticks_by(&y, step),
        x,
        y,
        x_name: "x [m]".to_owned(),
        y_name: "y [m]".to_owned(),
        x_numbers: true,
    }
}

fn finite_radius(radius: f64) -> f64 {
    if radius.is_finite() {
        radius.max(0.0)
    } else {
        0.0
    }
}

pub(super) fn drawable(rec: &Recording) -> impl Iterator<Item = &Disc> {
    rec.obstacles.iter().filter(|disc| {
        [disc.x, disc.y, disc.radius]
            .into_iter()
            .all(f64::is_finite)
            && disc.radius > 0.0
    })
}

fn widen(range: &mut Range<f64>, span: f64) {
    let middle = (range.start + range.end) / 2.0;
    *range = middle - span / 2.0..middle + span / 2.0;
}

/// Indices of the frames whose sensor readings the map shows: the first tick of each avoidance, then the closest
/// one, then whatever fills the run evenly.
fn moments(rec: &Recording, frames: &[&Frame]) -> Vec<usize> {
    let sees = |index: usize| hits(rec, frames[index]).next().is_some();
    let (mut starts, mut closest) = (Vec::new(), Vec::new());
    let mut index = 0;
    for stretch in frames.chunk_by(|a, b| a.mode == b.mode) {
        let seeing = (index..index + stretch.len()).filter(|&index| sees(index));
        index += stretch.len();
        if stretch[0].mode == "avoid" {
            starts.extend(seeing.clone().next());
            closest.extend(
                seeing.min_by(|a, b| frames[*a].clearance.total_cmp(&frames[*b].clearance)),
            );
        }
    }
    let mut chosen: Vec<usize> = Vec::new();
    // Pictures of one place and time would only cover each other.
    let gap = frames.len() / 40;
    let mut take = |candidates: &[usize], most: usize| {
        let room = most.saturating_sub(chosen.len());
        for share in 0..room.min(candidates.len()) {
            let index = candidates[share * candidates.len() / room.min(candidates.len())];
            if sees(index) && chosen.iter().all(|&other| other.abs_diff(index) > gap) {
                chosen.push(index);
            }
        }
    };
    take(&starts, MOST_MOMENTS);
    take(&closest, MOST_MOMENTS - 1);
    let seeing: Vec<usize> = (0..frames.len()).filter(|&index| sees(index)).collect();
    take(&seeing, 4);
    chosen.sort_unstable();
    chosen
}

/// Mount, axis in the world, opening and range of each sensor that saw something.
fn hits<'a>(
    rec: &'a Recording,
    frame: &'a Frame,
) -> impl Iterator<Item = ([f64; 2], f64, &'a BeamView, f64)> {
    let [x, y, heading] = frame.truth;
    let (sin, cos) = heading.sin_cos();
    rec.beams
        .iter()
        .zip(&frame.ranges)
        .filter_map(move |(beam, range)| {
            let range = range.filter(|range| range.is_finite() && *range >= 0.0)?;
            let mount = [
                x + beam.x * cos - beam.y * sin,
                y + beam.x * sin + beam.y * cos,
            ];
            let axis = heading + beam.heading;
            (mount.iter().all(|v| v.is_finite()) && axis.is_finite())
                .then_some((mount, axis, beam, range))
        })
}

fn letter(index: usize) -> String {
    char::from(b'A' + (index % 26) as u8).to_string()
}

/// Robot's disc with its heading.
fn robot(
    canvas: &Canvas,
    at: Point,
    radius: f64,
    heading: f64,
    colour: RGBColor,
    filled: bool,
) -> Result<()> {
    let radius = radius.max(2.5);
    if filled {
        canvas.disc(at, radius, colour.mix(0.18))?;
    }
    canvas.ring(at, radius, 1.4, colour.to_rgba())?;
    let tip = (
        at.0 + 1.6 * radius * heading.cos(),
        at.1 - 1.6 * radius * heading.sin(),
    );
    canvas.line(&[at, tip], 1.6, colour.to_rgba())
}

/// The robot at the end, with the last mode as a dot.
fn end_mark(canvas: &Canvas, at: Point, radius: f64, heading: f64, mode: RGBColor) -> Result<()> {
    robot(canvas, at, radius, heading, INK, false)?;
    canvas.disc(at, (radius * 0.45).clamp(1.8, 3.5), mode.to_rgba())
}

fn draw_map(
    canvas: &Canvas,
    rec: &Recording,
    frames: &[&Frame],
    map: &Panel,
    moments: &[usize],
    arrows: &[Vec<[f64; 2]>],
) -> Result<()> {
    map.axes(canvas, true)?;
    let scale = map.rect.width() / (map.x.end - map.x.start);
    let view = map.rect;
    let mut placer = Placer {
        bounds: view,
        taken: Vec::new(),
        points: Vec::new(),
    };

    for line in &rec.path {
        // A break in the numbers is a break in the line.
        for piece in line.split(|point| !point.iter().all(|v| v.is_finite())) {
            let points: Vec<Point> = piece
                .iter()
                .map(|point| map.at(point[0], point[1]))
                .collect();
            canvas.dashes(&thinned(&points, 0.5), (6.0, 4.0), 1.3, PATH.to_rgba())?;
            placer.points.extend(thinned(&points, 4.0));
        }
    }
    let mut named = Vec::new();
    for disc in drawable(rec) {
        let centre = map.at(disc.x, disc.y);
        // On a large map a small thing is a dot, but never nothing.
        let radius = (disc.radius * scale).max(LEAST_RADIUS);
        let shape = Rect::around(centre, 2.0 * radius, 2.0 * radius);
        let mut name_at = centre;
        let mut room = 1.8 * radius;
        if view.encloses(&shape) {
            canvas.disc(centre, radius, OBSTACLE.to_rgba())?;
        } else {
            let rim: Vec<Point> = (0..720)
                .map(|step| {
                    let (sin, cos) = (f64::from(step) * TAU / 720.0).sin_cos();
                    (centre.0 + radius * cos, centre.1 + radius * sin)
                })
                .collect();
            let part = view.clip(&rim);
            canvas.polygon(&part, OBSTACLE.to_rgba())?;
            let across = extent(part.iter().map(|point| point.0));
            let down = extent(part.iter().map(|point| point.1));
            let (Some(across), Some(down)) = (across, down) else {
                continue;
            };
            name_at = ((across.0 + across.1) / 2.0, (down.0 + down.1) / 2.0);
            room = 0.7 * (across.1 - across.0).min(6.0 * (down.1 - down.0));
        }
        let inner = std::f64::consts::SQRT_2 * radius;
        placer.taken.push(Rect::around(centre, inner, inner));
        named.push((
            disc,
            name_at,
            if view.encloses(&shape) { radius } else { 0.0 },
            room,
        ));
    }

    for &moment in moments {
        for (mount, axis, beam, range) in hits(rec, frames[moment]) {
            let far = |turn: f64| {
                map.at(
                    mount[0] + range * (axis + turn).cos(),
                    mount[1] + range * (axis + turn).sin(),
                )
            };
            let from = map.at(mount[0], mount[1]);
            if beam.width > 0.0 && beam.width < TAU / 2.0 {
                let mut cone = vec![from];
                cone.extend((0..=12).map(|step| far(beam.width * (f64::from(step) / 12.0 - 0.5))));
                canvas.polygon(&view.clip(&cone), BEAM.mix(0.12))?;
            }
            let hit = far(0.0);
            if let Some((start, end)) = view.clip_line(from, hit) {
                canvas.line(&[start, end], 1.1, BEAM.mix(0.55))?;
            }
            if view.contains(hit) {
                canvas.disc(hit, 2.6, BEAM.to_rgba())?;
                placer.points.push(hit);
            }
        }
    }

    trajectory(canvas, frames, map, &mut placer)?;
    for line in arrows {
        let line: Vec<Point> = line
            .iter()
            .map(|point| map.at(point[0], point[1]))
            .collect();
        if line.iter().all(|point| view.contains(*point)) {
            arrow(canvas, &line)?;
        }
    }

    let radius = finite_radius(rec.robot_radius) * scale;
    let pose = |frame: &Frame| (map.at(frame.truth[0], frame.truth[1]), frame.truth[2]);
    for &moment in moments {
        let (at, heading) = pose(frames[moment]);
        robot(canvas, at, radius, heading, MUTED, false)?;
        placer
            .taken
            .push(Rect::around(at, 2.0 * radius, 2.0 * radius));
    }
    let (start, end) = (pose(frames[0]), pose(frames[frames.len() - 1]));
    robot(canvas, start.0, radius, start.1, INK, true)?;
    placer
        .taken
        .push(Rect::around(start.0, 2.4 * radius, 2.4 * radius));
    let mut ends = vec![(start.0, "start")];
    if frames.len() > 1 {
        end_mark(
            canvas,
            end.0,
            radius,
            end.1,
            mode_colour(frames[frames.len() - 1].mode),
        )?;
        placer
            .taken
            .push(Rect::around(end.0, 2.4 * radius, 2.4 * radius));
        ends.push((end.0, "end"));
    }

    for (disc, centre, reach, room) in named {
        let name = fitted(&disc.name, 13.0, 160.0);
        let width = text_width(&name, 13.0);
        if name.is_empty() {
            continue;
        }
        if width + 6.0 < room && room > 16.0 {
            canvas.text(&name, centre, 13.0, RGBColor(255, 255, 255), CENTRED)?;
            continue;
        }
        let at = placer.beside(centre, reach, width, 14.0);
        label(canvas, &name, at, width, INK)?;
    }
    for (at, name) in ends {
        let width = text_width(name, 13.0);
        let at = placer.beside(at, radius.max(2.5), width, 14.0);
        label(canvas, name, at, width, INK)?;
    }
    for (index, &moment) in moments.iter().enumerate() {
        let at = placer.beside(pose(frames[moment]).0, radius.max(2.5), 15.0, 15.0);
        badge(canvas, &letter(index), at)?;
    }
    map.frame(canvas)
}

fn label(canvas: &Canvas, text: &str, at: Point, width: f64, colour: RGBColor) -> Result<()> {
    canvas.block(
        &Rect::around(at, width + 2.0, 14.0),
        RGBColor(255, 255, 255).mix(0.75),
    )?;
    canvas.text(text, at, 13.0, colour, CENTRED)
}

/// A moment's letter, the same on the map and over the strips.
fn badge(canvas: &Canvas, text: &str, at: Point) -> Result<()> {
    canvas.disc(at, 8.0, BEAM.to_rgba())?;
    canvas.text(text, at, 11.5, RGBColor(255, 255, 255), CENTRED)
}

/// A line with a small head at its end.
fn arrow(canvas: &Canvas, line: &[Point]) -> Result<()> {
    let [.., before, tip] = line else {
        return Ok(());
    };
    canvas.line(line, 0.9, INK.to_rgba())?;
    let (dx, dy) = (tip.0 - before.0, tip.1 - before.1);
    let length = dx.hypot(dy);
    if length == 0.0 {
        return Ok(());
    }
    let (ux, uy) = (dx / length, dy / length);
    let head = |side: f64| {
        (
            tip.0 - 3.6 * ux - side * 1.6 * uy,
            tip.1 - 3.6 * uy + side * 1.6 * ux,
        )
    };
    let beyond = (tip.0 + ux, tip.1 + uy);
    canvas.polygon(&[beyond, head(1.0), head(-1.0)], INK.to_rgba())
}

/// The true pose's way, a line a stretch of one mode.
pub(super) fn trajectory(
    canvas: &Canvas,
    frames: &[&Frame],
    map: &Panel,
    placer: &mut Placer,
) -> Result<()> {
    let points: Vec<(Point, &str)> = frames
        .iter()
        .map(|frame| (map.at(frame.truth[0], frame.truth[1]), frame.mode))
        .collect();
    let mut stretches: Vec<(Vec<Point>, &str)> = Vec::new();
    for (point, mode) in spaced(&points) {
        match stretches.last_mut() {
            Some((stretch, of)) if *of == mode => stretch.push(point),
            Some((stretch, _)) => {
                // Neighbours share a point, so that the line has no gap where the mode changes.
                let joint = stretch[stretch.len() - 1];
                stretches.push((vec![joint, point], mode));
            }
            None => stretches.push((vec![point], mode)),
        }
    }
    for urgency in 0..=GRAVEST {
        // What matters more lies on top.
        for (stretch, mode) in stretches.iter().filter(|(_, mode)| rank(mode) == urgency) {
            canvas.line(stretch, 2.6, mode_colour(mode).to_rgba())?;
        }
    }
    placer.points.extend(thinned(
        &points.iter().map(|(point, _)| *point).collect::<Vec<_>>(),
        4.0,
    ));
    Ok(())
}

/// Trajectory without the points that no reader could tell apart.
fn spaced<'a>(points: &[(Point, &'a str)]) -> Vec<(Point, &'a str)> {
    let mut apart = 0.35;
    loop {
        let mut kept: Vec<(Point, &str)> = Vec::new();
        for (index, &(point, mode)) in points.iter().enumerate() {
            let last = kept.last();
            let far = last.is_none_or(|(last, _)| super::distance(*last, point) >= apart);
            // A mode's change counts by itself, as long as that leaves the figure a readable size.
            let turn = apart < 2.0 && last.is_some_and(|(_, of)| *of != mode);
            if far || turn || index + 1 == points.len() {
                kept.push((point, mode));
            }
        }
        if kept.len() <= MOST_VERTICES || apart > 200.0 {
            return kept;
        }
        apart *= 1.6;
    }
}

/// Points at least `apart` pixels from each other along the line, ends kept.
pub(super) fn thinned(points: &[Point], apart: f64) -> Vec<Point> {
    let mut apart = apart;
    loop {
        let mut kept: Vec<Point> = Vec::new();
        for (index, &point) in points.iter().enumerate() {
            if kept
                .last()
                .is_none_or(|&last| super::distance(last, point) >= apart)
                || index + 1 == points.len()
            {
                kept.push(point);
            }
        }
        if kept.len() <= MOST_VERTICES || apart > 200.0 {
            return kept;
        }
        apart *= 1.6;
    }
}

/// A signal's strip.
struct Strip<'a> {
    name: &'a str,
    value: &'a dyn Fn(&Frame) -> f64,
    y: Range<f64>,
}

fn draw_strips(
    canvas: &Canvas,
    rec: &Recording,
    frames: &[&Frame],
    top: f64,
    moments: &[usize],
) -> Result<()> {
    let first = frames[0].t;
    let period = if rec.period.is_finite() && rec.period > 0.0 {
        rec.period
    } else {
        1.0
    };
    let last = extent(frames.iter().map(|frame| frame.t))
        .map_or(first, |(_, last)| last)
        .max(first + period);
    let time = first..last;

    let clearances = extent(frames.iter().map(|frame| frame.clearance));
    let (nearest, farthest) = clearances.unwrap_or((0.0, 1.0));
    // Far away nobody cares how far: the interesting part is near contact.
    let roof = if nearest < 2.0 {
        farthest.min(5.0)
    } else {
        farthest.min(2.0 * nearest + 5.0)
    };
    let roof = roof.max(nearest + 0.1).max(0.2);
    let floor = nearest.min(0.0);
    let clipped = clearances.is_some() && frames.iter().any(|frame| frame.clearance > roof);
    let clearance_name = if clipped {
        format!("clearance\n≤ {} [m]", tick_text(roof, 1))
    } else {
        "clearance\n[m]".to_owned()
    };

    let spread = |value: &dyn Fn(&Frame) -> f64, least: f64| {
        let (low, high) = extent(frames.iter().map(|frame| value(frame))).unwrap_or((0.0, 0.0));
        let (low, high) = (low.min(0.0), high.max(0.0));
        let lack = (least - (high - low)).max(0.0) / 2.0;
        let pad = 0.09 * (high - low).max(least);
        low - lack - pad..high + lack + pad
    };
    let error = |frame: &Frame| frame.cross_track;
    let speed = |frame: &Frame| frame.twist[0];
    let turn = |frame: &Frame| frame.twist[1];
    // Without any obstacle there is no curve, rather than one along the roof.
    let room = |frame: &Frame| {
        if clearances.is_none() || frame.clearance.is_nan() {
            f64::NAN
        } else {
            frame.clearance.min(roof)
        }
    };
    let mut strips = Vec::new();
    if on_path(frames) {
        strips.push(Strip {
            name: "cross-track\nerror [m]",
            value: &error,
            y: spread(&error, 0.1),
        });
    }
    strips.extend([
        Strip {
            name: "speed\n[m/s]",
            value: &speed,
            y: spread(&speed, 0.05),
        },
        Strip {
            name: "yaw rate\n[rad/s]",
            value: &turn,
            y: spread(&turn, 0.05),
        },
        Strip {
            name: &clearance_name,
            value: &room,
            y: floor - 0.06 * (roof - floor)..roof + 0.08 * (roof - floor),
        },
    ]);
    let bands = bands(frames, &time);
    let count = strips.len();
    let mut top = top;
    for (index, strip) in strips.iter().enumerate() {
        let below = index + 1 == count;
        let panel = Panel {
            rect: Rect::new(LEFT, top, RIGHT - LEFT, STRIP_HEIGHT),
            x: time.clone(),
            y: strip.y.clone(),
            x_ticks: ticks(&time, 12.0),
            y_ticks: if below && clearances.is_none() {
                Vec::new()
            } else {
                ticks(&strip.y, 5.0)
            },
            x_name: if below {
                "time [s]".to_owned()
            } else {
                String::new()
            },
            y_name: strip.name.to_owned(),
            x_numbers: below,
        };
        for (from, to, mode) in &bands {
            // A lone tick of a mode deserves to be seen, the last one of a run above all.
            let right = panel.at(*to, 0.0).0;
            let left = panel.at(*from, 0.0).0.min(right - 2.0).max(panel.rect.left);
            // A pale tint of one colour may look like another: what says the mode is a bar in the legend's own.
            let tint = Rect {
                left,
                right,
                ..panel.rect
            };
            canvas.block(&tint, mode_colour(mode).mix(TINT))?;
            let bar = Rect {
                bottom: panel.rect.top + BAR,
                ..tint
            };
            canvas.block(&bar, mode_colour(mode).to_rgba())?;
        }
        panel.axes(canvas, true)?;
        if panel.y_ticks.contains(&0.0) {
            let zero = [panel.at(time.start, 0.0), panel.at(time.end, 0.0)];
            canvas.line(&zero, 1.0, FRAME.mix(0.9))?;
        }
        for &moment in moments {
            let x = panel.at(frames[moment].t, 0.0).0;
            canvas.dashes(
                &[(x, panel.rect.top), (x, panel.rect.bottom)],
                (2.0, 3.0),
                1.0,
                BEAM.to_rgba(),
            )?;
        }
        curve(canvas, frames, &panel, strip.value)?;
        if below {
            lowest(
                canvas,
                frames,
                &panel,
                clearances.map(|(nearest, _)| nearest),
            )?;
        }
        panel.frame(canvas)?;
        if index == 0 {
            let mut free = f64::NEG_INFINITY;
            for (index, &moment) in moments.iter().enumerate() {
                let x = panel.at(frames[moment].t, 0.0).0.max(free);
                badge(canvas, &letter(index), (x, panel.rect.top - 11.0))?;
                free = x + 17.0;
            }
        }
        top += STRIP_HEIGHT + STRIP_GAP;
    }
    Ok(())
}

/// Stretches of one mode, no finer than a pixel or two; where several meet, the gravest shows.
fn bands<'a>(frames: &[&'a Frame], time: &Range<f64>) -> Vec<(f64, f64, &'a str)> {
    let columns = 540.0;
    let column = |t: f64| ((t - time.start) / (time.end - time.start) * columns).floor();
    let mut cells: Vec<(f64, f64, &str)> = Vec::new();
    for frame in frames {
        match cells.last_mut() {
            Some(last) if last.0 == column(frame.t) => {
                if rank(frame.mode) > rank(last.2) {
                    last.2 = frame.mode;
                }
            }
            _ => cells.push((column(frame.t), frame.t, frame.mode)),
        }
    }
    let mut bands: Vec<(f64, f64, &str)> = Vec::new();
    for (_, t, mode) in cells {
        if let Some(last) = bands.last_mut() {
            last.1 = t;
            if last.2 == mode {
                continue;
            }
        }
        bands.push((t, time.end, mode));
    }
    if let Some(last) = bands.last_mut() {
        last.1 = time.end;
    }
    bands
}

/// The signal, each couple of pixels by its first, least, greatest and last value: spikes survive.
fn curve(
    canvas: &Canvas,
    frames: &[&Frame],
    panel: &Panel,
    value: &dyn Fn(&Frame) -> f64,
) -> Result<()> {
    let samples: Vec<(f64, f64)> = frames.iter().map(|frame| (frame.t, value(frame))).collect();
    for piece in samples.split(|(_, value)| !value.is_finite()) {
        if let [(t, value)] = piece {
            canvas.disc(panel.at(*t, *value), 2.4, INK.to_rgba())?;
            continue;
        }
        let points: Vec<Point> = piece.iter().map(|&(t, value)| panel.at(t, value)).collect();
        let mut kept: Vec<Point> = Vec::new();
        for bucket in points.chunk_by(|a, b| (a.0 / 2.0).floor() == (b.0 / 2.0).floor()) {
            let end = bucket.len() - 1;
            let by = |a: &usize, b: &usize| bucket[*a].1.total_cmp(&bucket[*b].1);
            let mut picked = [
                0,
                (0..=end).min_by(by).unwrap_or(0),
                (0..=end).max_by(by).unwrap_or(end),
                end,
            ];
            picked.sort_unstable();
            kept.extend(picked.map(|index| bucket[index]));
        }
        kept.dedup();
        canvas.line(&kept, 1.5, INK.to_rgba())?;
    }
    Ok(())
}

/// Names the least clearance, or says that there was nothing to keep clear of.
fn lowest(canvas: &Canvas, frames: &[&Frame], panel: &Panel, least: Option<f64>) -> Result<()> {
    let Some(least) = least else {
        return canvas.text(
            "no obstacle in reach",
            panel.rect.centre(),
            13.0,
            MUTED,
            CENTRED,
        );
    };
    let Some(frame) = frames.iter().find(|frame| frame.clearance == least) else {
        return Ok(());
    };
    let at = panel.at(frame.t, least);
    canvas.disc(at, 3.2, STOP.to_rgba())?;
    let text = format!("least {} m", tick_text(least, 2));
    let width = text_width(&text, 12.5);
    let mut placer = Placer {
        bounds: panel.rect,
        taken: Vec::new(),
        points: frames
            .iter()
            .filter(|f| f.clearance.is_finite())
            .map(|f| panel.at(f.t, f.clearance))
            .collect(),
    };
    placer.points = thinned(&placer.points, 2.0);
    let place = placer.beside(at, 2.0, width, 14.0);
    label(canvas, &text, place, width, STOP)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::png;

    const NOTHING: Frame = Frame {
        t: 0.0,
        truth: [0.0; 3],
        believed: [0.0; 3],
        mode: "follow",
        note: "",
        cross_track: 0.0,
        clearance: f64::INFINITY,
        twist: [0.0; 2],
        wheels: [0.0; 2],
        ranges: Vec::new(),
        estimate: None,
        signals: Vec::new(),
        fired: Vec::new(),
        movers: Vec::new(),
        view: None,
    };

    /// An S of two half circles, an obstacle on the first that is driven around, two beside the second.
    fn winding(count: usize) -> Recording {
        let half = TAU / 2.0;
        let place = |share: f64, offset: f64| {
            let angle = 2.0 * half * share;
            if angle < half {
                let (sin, cos) = (half - angle).sin_cos();
                [
                    16.0 + (8.0 - offset) * cos,
                    16.0 + (8.0 - offset) * sin,
                    half / 2.0 - angle,
                ]
            } else {
                let (sin, cos) = angle.sin_cos();
                [
                    32.0 + (8.0 + offset) * cos,
                    16.0 + (8.0 + offset) * sin,
                    angle - half * 1.5,
                ]
            }
        };
        let disc = |name: &str, x, y, radius| Disc {
            name: name.to_owned(),
            x,
            y,
            radius,
        };
        let obstacles = vec![
            disc("Obs1", 16.3, 24.1, 0.8),
            disc("Obs2", 31.6, 12.0, 1.5),
            disc("Obs3", 36.5, 5.4, 0.4),
        ];
        let frames = (0..count)
            .map(|tick| {
                let share = tick as f64 / count.max(2) as f64;
                let offset = 1.8 * (-((share - 0.25) / 0.05).powi(2)).exp();
                let truth = place(share, offset);
                let gap =
                    |disc: &Disc| (disc.x - truth[0]).hypot(disc.y - truth[1]) - disc.radius - 0.3;
                let clearance = obstacles.iter().map(gap).fold(f64::INFINITY, f64::min);
                let mode = if offset > 0.1 { "avoid" } else { "follow" };
                Frame {
                    t: tick as f64 * 0.1,
                    truth,
                    believed: truth,
                    mode,
                    cross_track: -offset,
                    clearance,
                    twist: [0.8, 0.1 * (share * 40.0).sin()],
                    ranges: vec![(clearance < 2.0).then_some(clearance), None],
                    ..NOTHING
                }
            })
            .collect();
        let beam = |heading| BeamView {
            x: 0.2,
            y: 0.0,
            heading,
            width: 0.3,
            max_range: 4.0,
        };
        Recording {
            scenario: "S with <three> obstacles".to_owned(),
            variant: "fuzzy & smooth".to_owned(),
            seed: 7,
            period: 0.1,
            robot_radius: 0.3,
            outline: Vec::new(),
            obstacles,
            path: vec![
                (0..=200)
                    .map(|step| place(f64::from(step) / 200.0, 0.0))
                    .map(|[x, y, _]| [x, y])
                    .collect(),
            ],
            beams: vec![beam(0.5), beam(-0.5)],
            tables: Vec::new(),
            frames,
            ..Recording::default()
        }
    }

    fn drawn(rec: &Recording) -> String {
        let svg = run_svg(rec).unwrap();
        // Attributes only: names may read as they like.
        assert!(
            !svg.contains("NaN") && !svg.contains("inf,") && !svg.contains("\"inf"),
            "{}",
            rec.scenario
        );
        // Saturated coordinates would mean that a number out of range had slipped through.
        assert!(
            !svg.contains(&i32::MAX.to_string()) && !svg.contains(&i32::MIN.to_string()),
            "{}",
            rec.scenario
        );
        assert_eq!(&png(&svg, 0.5).unwrap()[1..4], b"PNG");
        svg
    }

    fn map_size(svg: &str) -> (f64, f64) {
        let number = |name: &str| -> f64 {
            let rest = svg.split_once(&format!("{name}=\"")).unwrap().1;
            rest.split_once('"').unwrap().0.parse().unwrap()
        };
        (number("width"), number("height"))
    }

    #[test]
    fn a_run_shows_its_title_its_obstacles_and_its_avoidance() {
        let svg = drawn(&winding(600));
        for text in [
            "S with &lt;three&gt; obstacles",
            "fuzzy &amp; smooth",
            "seed 7",
            "Obs1",
            "avoid",
            "cross-track",
        ] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(svg.contains("#E69F00") && svg.contains("#0072B2"));
    }

    #[test]
    fn strips_say_the_mode_in_the_legend_s_colour() {
        let mut rec = winding(200);
        for frame in &mut rec.frames[100..150] {
            frame.mode = "blocked";
        }
        let svg = drawn(&rec);
        // A bar a strip, and no paler one of which it could be another mode's.
        let bars = svg
            .split("<rect ")
            .filter(|rest| {
                let own = rest.split_once('>').unwrap().0;
                own.contains("fill=\"#A81024\"") && own.contains("opacity=\"1\"")
            })
            .count();
        assert_eq!(bars, 4);
    }

    #[test]
    fn beams_are_shown_where_avoidance_begins() {
        let rec = winding(600);
        let frames: Vec<&Frame> = rec.frames.iter().collect();
        let first = rec
            .frames
            .iter()
            .position(|frame| frame.mode == "avoid" && frame.ranges[0].is_some())
            .unwrap();
        let moments = moments(&rec, &frames);
        assert!(moments.contains(&first));
        assert!((2..=MOST_MOMENTS).contains(&moments.len()));
        assert!(moments.is_sorted());
    }

    #[test]
    fn few_frames_or_none() {
        assert!(run_svg(&winding(0)).is_err());
        drawn(&winding(1));
        drawn(&winding(2));
        let mut lost = winding(5);
        for frame in &mut lost.frames {
            frame.truth[0] = f64::NAN;
        }
        assert!(run_svg(&lost).is_err());
    }

    #[test]
    fn an_empty_world() {
        let mut rec = winding(100);
        rec.obstacles.clear();
        rec.beams.clear();
        rec.path.clear();
        for frame in &mut rec.frames {
            frame.clearance = f64::INFINITY;
            frame.ranges.clear();
        }
        assert!(drawn(&rec).contains("no obstacle in reach"));
    }

    #[test]
    fn a_long_and_restless_run_stays_small() {
        let mut rec = winding(20_000);
        for (tick, frame) in rec.frames.iter_mut().enumerate() {
            let noise = (tick * 7919 % 1009) as f64 / 1009.0 - 0.5;
            frame.mode = ["follow", "avoid", "stop"][tick * 31 % 3];
            frame.truth[0] += 3.0 * noise;
            frame.truth[1] += 9.0 * (noise * 57.0).sin();
            frame.cross_track = noise;
            frame.twist = [noise, -noise];
            frame.clearance = 1.0 + noise;
        }
        rec.path = vec![
            rec.frames
                .iter()
                .map(|frame| [frame.truth[0], frame.truth[1]])
                .collect(),
        ];
        assert!(drawn(&rec).len() < 2_000_000);
    }

    #[test]
    fn straight_lines_keep_a_sane_shape() {
        for (dx, dy) in [
            (0.1, 0.0),
            (0.0, 0.1),
            (0.0, 0.0),
            (100.0, 0.0),
            (0.0, -1e-4),
        ] {
            let mut rec = winding(300);
            rec.obstacles.clear();
            rec.path.clear();
            for (tick, frame) in rec.frames.iter_mut().enumerate() {
                frame.truth = [dx * tick as f64, dy * tick as f64, 0.0];
            }
            let (width, height) = map_size(&drawn(&rec));
            assert!(
                width == WIDTH && (700.0..1600.0).contains(&height),
                "{dx} {dy}: {height}"
            );
        }
        let mut still = winding(10);
        still.robot_radius = 0.0;
        still.obstacles.clear();
        still.path.clear();
        for frame in &mut still.frames {
            frame.truth = [5.0, 5.0, 0.0];
        }
        drawn(&still);
    }

    #[test]
    fn remote_and_enormous_obstacles_do_not_shrink_the_run() {
        let mut rec = winding(300);
        let before = map_panel(&rec, &rec.frames.iter().collect::<Vec<_>>());
        rec.obstacles.push(Disc {
            name: "remote".to_owned(),
            x: 1e6,
            y: 0.0,
            radius: 2.0,
        });
        rec.obstacles.push(Disc {
            name: "wall".to_owned(),
            x: 24.0,
            y: -1e4,
            radius: 1e4,
        });
        let after = map_panel(&rec, &rec.frames.iter().collect::<Vec<_>>());
        assert!(after.x.end - after.x.start < 2.0 * (before.x.end - before.x.start));
        assert!(drawn(&rec).contains("wall"));
    }

    #[test]
    fn numbers_that_are_none_leave_gaps() {
        let mut rec = winding(200);
        for frame in rec.frames.iter_mut().step_by(7) {
            frame.cross_track = f64::NAN;
            frame.clearance = f64::NAN;
            frame.twist = [f64::INFINITY, f64::NEG_INFINITY];
            frame.ranges = vec![Some(f64::NAN), Some(f64::INFINITY)];
        }
        rec.frames[3].truth[2] = f64::NAN;
        rec.frames[4].t = f64::NAN;
        rec.path[0][5] = [f64::NAN, 0.0];
        rec.obstacles.push(Disc {
            name: "odd".to_owned(),
            x: f64::NAN,
            y: 0.0,
            radius: -1.0,
        });
        rec.robot_radius = f64::NAN;
        rec.period = f64::NAN;
        drawn(&rec);
    }

    #[test]
    fn labels_show_in_the_picture() {
        let mut rec = winding(50);
        let svg = drawn(&rec);
        rec.scenario = String::new();
        let bare = drawn(&rec);
        // The same run without its title is another picture: the title does appear.
        assert_ne!(png(&svg, 1.0).unwrap(), png(&bare, 1.0).unwrap());
    }
}
