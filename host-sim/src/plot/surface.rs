//! What a fuzzy controller computes: its output over two inputs.

use std::collections::HashMap;
use std::ops::Range;

use anyhow::{Result, bail};
use plotters::style::{Color, RGBColor};
use rayon::prelude::*;

use super::axis::{Axis, widest};
use super::{
    CENTRED, Canvas, FRAME, FROM_LEFT, FROM_RIGHT, GRID, INK, MUTED, Panel, Point, Rect, UPWARD,
    WIDTH, between, decimals, distance, document, extent, fitted, shaded, text_width, tick_text,
    ticks, viridis,
};

/// A two-input controller to draw.
pub struct SurfaceSpec<'a> {
    /// Heading of the figure.
    pub title: String,
    /// A smaller line below it; empty for none.
    pub note: String,
    /// Input along the rows of the rule table.
    pub rows: Axis,
    /// Input along the columns.
    pub cols: Axis,
    /// Output; its terms' peaks are the singletons.
    pub output: Axis,
    /// Output for a row input and a column input; `None` where it has no value.
    pub eval: &'a (dyn Fn(f64 /* row input */, f64 /* col input */) -> Option<f64> + Sync),
}

const WHITE: RGBColor = RGBColor(255, 255, 255);
/// Where the output has no value.
const NOTHING: RGBColor = RGBColor(0xD3, 0xD6, 0xDA);

/// Cells of the heat map a side, and of the 3-D surface.
const FINE_CELLS: usize = 170;
const COARSE_CELLS: usize = 40;
/// Side of the heat map, pixels: whole drawing units a cell, so that no seam shows between cells.
const HEAT_SIDE: f64 = 425.0;
/// Most blocks of the heat map.
const MOST_RUNS: usize = 9000;
/// Rounding, of what the output ranges over: lines of one value do not follow it.
const NOISE: f64 = 1e-9;
/// Shades of the heat map; neighbours are hardly told apart, and runs of one shade keep the document small.
const SHADES: f64 = 64.0;

/// Draws the output over both inputs: a heat map with labelled iso-lines, and the same as a surface in space.
///
/// # Errors
/// When an axis has an empty range, no terms or a peak that is no number, or the output is not finite somewhere.
pub fn surface_svg(spec: &SurfaceSpec) -> Result<String> {
    for axis in [&spec.rows, &spec.cols, &spec.output] {
        axis.check()?;
    }
    let mut fine = Field::sample(spec, FINE_CELLS)?;
    let coarse = Field::sample(spec, COARSE_CELLS)?;
    // One colour means the same value on both sides.
    let (low, high) =
        extent(fine.values.iter().chain(&coarse.values).copied()).unwrap_or((0.0, 1.0));
    let slack = 1e-9 * low.abs().max(high.abs()).max(1.0);
    let range = if high - low > slack {
        low..high
    } else {
        low - 0.5..low + 0.5
    };
    if fine.runs(&range).len() > MOST_RUNS {
        // Ruggedness is not worth a document that no viewer opens.
        fine = Field::sample(spec, FINE_CELLS / 2)?;
    }
    document(WIDTH, 620.0, |canvas| {
        canvas.heading(&spec.title)?;
        let note = fitted(&spec.note, 14.0, WIDTH - 110.0);
        canvas.text(&note, (82.0, 54.0), 14.0, MUTED, FROM_LEFT)?;
        // What long numbers beside the map, beside the colour bar and on the floor take, the surface in space gives.
        let beside_map = (widest(&spec.rows.ticks(7.0), 12.5) - 42.0).max(0.0);
        let beside_bar = (widest(&levels(&range), 12.5) - 32.0).max(0.0);
        heat_map(canvas, spec, &fine, &range, 82.0 + beside_map)?;
        let left = 665.0 + beside_map + 2.2 * beside_bar;
        let on_floor = [&spec.cols, &spec.rows].map(|axis| widest(&axis.ticks(5.0), 12.0));
        let right = 1185.0 - 1.5 * (on_floor[0].max(on_floor[1]) - 44.0).max(0.0);
        space(
            canvas,
            spec,
            &coarse,
            &range,
            &Rect::new(left, 62.0, right - left, 530.0),
        )
    })
}

/// The output on a square grid, row input major; NaN where it has no value.
struct Field {
    cells: usize,
    values: Vec<f64>,
}

impl Field {
    fn sample(spec: &SurfaceSpec, cells: usize) -> Result<Self> {
        let points: Vec<(f64, f64)> = (0..=cells)
            .flat_map(|row| (0..=cells).map(move |col| (row, col)))
            .map(|(row, col)| (row as f64 / cells as f64, col as f64 / cells as f64))
            .map(|(row, col)| (spec.rows.at(row), spec.cols.at(col)))
            .collect();
        let values = points
            .into_par_iter()
            .map(|(row, col)| match (spec.eval)(row, col) {
                None => Ok(f64::NAN),
                Some(value) if value.is_finite() => Ok(value),
                Some(value) => bail!("{} is {value} at {row}, {col}", spec.output.name),
            })
            .collect::<Result<Vec<f64>>>()?;
        Ok(Self { cells, values })
    }

    fn value(&self, row: usize, col: usize) -> f64 {
        self.values[row * (self.cells + 1) + col]
    }

    /// Mean of a cell's corners; NaN if one has no value.
    fn middle(&self, row: usize, col: usize) -> f64 {
        let sum = self.value(row, col)
            + self.value(row + 1, col)
            + self.value(row, col + 1)
            + self.value(row + 1, col + 1);
        sum / 4.0
    }

    /// Whether there is a cell without a value.
    fn has_gaps(&self) -> bool {
        self.values.iter().any(|value| value.is_nan())
    }

    /// Row, first and end column, and shade of each stretch of one shade; below zero without a value.
    fn runs(&self, range: &Range<f64>) -> Vec<(usize, usize, usize, f64)> {
        let shade = |row, col| {
            let place = share(self.middle(row, col), range) * SHADES;
            if place.is_nan() {
                -1.0
            } else {
                place.floor().clamp(0.0, SHADES - 1.0)
            }
        };
        let mut runs: Vec<(usize, usize, usize, f64)> = Vec::new();
        for row in 0..self.cells {
            for col in 0..self.cells {
                let tone = shade(row, col);
                match runs.last_mut() {
                    Some(last) if last.0 == row && last.3 == tone => last.2 = col + 1,
                    _ => runs.push((row, col, col + 1, tone)),
                }
            }
        }
        runs
    }

    /// Lines of one value, in cells from the first row and column (marching squares). What is on the level but for `noise` is
    /// on it: a plateau there has an edge, and its rounding none.
    fn isolines(&self, level: f64, noise: f64) -> Vec<Vec<Point>> {
        let snapped = |value: f64| match (value - level).abs() <= noise {
            true => level,
            false => value,
        };
        let mut segments: Vec<(Point, Point)> = Vec::new();
        for row in 0..self.cells {
            for col in 0..self.cells {
                let corners = [
                    (row, col),
                    (row, col + 1),
                    (row + 1, col + 1),
                    (row + 1, col),
                ];
                if self.middle(row, col).is_nan() {
                    continue;
                }
                let mut cuts = Vec::new();
                for side in 0..4 {
                    // Neighbouring cells must compute a shared side alike, or the chains below break.
                    let (mut from, mut to) = (corners[side], corners[(side + 1) % 4]);
                    if to < from {
                        (from, to) = (to, from);
                    }
                    let (a, b) = (self.value(from.0, from.1), self.value(to.0, to.1));
                    let (a, b) = (snapped(a), snapped(b));
                    if (a < level) != (b < level) {
                        let (from, to) =
                            ((from.1 as f64, from.0 as f64), (to.1 as f64, to.0 as f64));
                        cuts.push(between(from, to, (level - a) / (b - a)));
                    }
                }
                segments.extend(
                    cuts.chunks_exact(2)
                        .map(|pair| (pair[0], pair[1]))
                        .filter(|(from, to)| from != to),
                );
            }
        }
        chains(segments)
    }
}

/// Joins segments that share an end.
fn chains(segments: Vec<(Point, Point)>) -> Vec<Vec<Point>> {
    // Neighbouring cells compute a shared end from the same numbers, so that equal bits are the right test.
    let key = |point: Point| ((point.0 + 0.0).to_bits(), (point.1 + 0.0).to_bits());
    let mut at: HashMap<_, Vec<usize>> = HashMap::new();
    for (index, &(from, to)) in segments.iter().enumerate() {
        at.entry(key(from)).or_default().push(index);
        at.entry(key(to)).or_default().push(index);
    }
    let mut used = vec![false; segments.len()];
    let mut lines = Vec::new();
    for start in 0..segments.len() {
        if used[start] {
            continue;
        }
        used[start] = true;
        let mut line = vec![segments[start].0, segments[start].1];
        // Forward from one end, then, turned round, from the other.
        for _ in 0..2 {
            while let Some(next) = line
                .last()
                .and_then(|&tail| at.get(&key(tail)))
                .and_then(|ends| ends.iter().copied().find(|&index| !used[index]))
            {
                used[next] = true;
                let (from, to) = segments[next];
                let joins = line.last().is_some_and(|&tail| key(tail) == key(from));
                line.push(if joins { to } else { from });
            }
            line.reverse();
        }
        lines.push(line);
    }
    lines
}

fn share(value: f64, range: &Range<f64>) -> f64 {
    (value - range.start) / (range.end - range.start)
}

fn heat_map(
    canvas: &Canvas,
    spec: &SurfaceSpec,
    field: &Field,
    range: &Range<f64>,
    left: f64,
) -> Result<()> {
    let side = HEAT_SIDE;
    let cell = side / field.cells as f64;
    let rect = Rect::new(left, 110.0, side, side);
    let panel = Panel {
        rect,
        x: spec.cols.span(),
        y: spec.rows.span(),
        x_ticks: spec.cols.ticks_apart(7.0, side, 12.5),
        y_ticks: spec.rows.ticks(7.0),
        x_name: spec.cols.label(),
        y_name: spec.rows.label(),
        x_numbers: true,
    };
    panel.axes(canvas, false)?;
    for (row, from, to, tone) in field.runs(range) {
        let block = Rect {
            left: rect.left + cell * from as f64,
            right: rect.left + cell * to as f64,
            top: rect.bottom - cell * (row + 1) as f64,
            bottom: rect.bottom - cell * row as f64,
        };
        let colour = if tone < 0.0 {
            NOTHING
        } else {
            viridis((tone + 0.5) / SHADES)
        };
        canvas.block(&block, colour.to_rgba())?;
    }
    // Where the rules sit.
    for (_, peak) in &spec.rows.terms {
        if spec.rows.span().contains(peak) {
            canvas.line(
                &[panel.at(panel.x.start, *peak), panel.at(panel.x.end, *peak)],
                0.8,
                WHITE.mix(0.28),
            )?;
        }
    }
    for (_, peak) in &spec.cols.terms {
        if spec.cols.span().contains(peak) {
            canvas.line(
                &[panel.at(*peak, panel.y.start), panel.at(*peak, panel.y.end)],
                0.8,
                WHITE.mix(0.28),
            )?;
        }
    }
    isolines(canvas, field, range, &rect, cell)?;
    panel.frame(canvas)?;
    term_names_plain(canvas, spec, &panel)?;
    if field.has_gaps() {
        let key = Rect::new(rect.right - 116.0, rect.bottom + 28.0, 14.0, 14.0);
        canvas.block(&key, NOTHING.to_rgba())?;
        canvas.outline(&key, 0.8, FRAME.to_rgba())?;
        let at = (key.right + 6.0, key.centre().1);
        canvas.text("no value", at, 12.5, MUTED, FROM_LEFT)?;
    }
    colour_bar(
        canvas,
        spec,
        range,
        &Rect::new(rect.right + 64.0, rect.top, 16.0, side),
    )
}

/// Levels of the iso-lines and of the numbers on the output's axis.
fn levels(range: &Range<f64>) -> Vec<f64> {
    ticks(range, 10.0)
}

fn isolines(
    canvas: &Canvas,
    field: &Field,
    range: &Range<f64>,
    rect: &Rect,
    cell: f64,
) -> Result<()> {
    let levels = levels(range);
    let places = decimals(&levels);
    let mut taken: Vec<Rect> = Vec::new();
    for &level in &levels {
        let mut lines: Vec<Vec<Point>> = field
            .isolines(level, NOISE * (range.end - range.start))
            .into_iter()
            .map(|line| {
                line.iter()
                    .map(|&(x, y)| (rect.left + cell * x, rect.bottom - cell * y))
                    .collect()
            })
            .collect();
        let length = |line: &Vec<Point>| {
            line.windows(2)
                .map(|pair| distance(pair[0], pair[1]))
                .sum::<f64>()
        };
        lines.retain(|line| length(line) > 3.0);
        lines.sort_by(|a, b| length(b).total_cmp(&length(a)));
        // A rugged surface has islets without end; the long lines tell its shape.
        lines.truncate(40);
        let ink = if share(level, range) > 0.68 {
            INK
        } else {
            WHITE
        };
        let text = tick_text(level, places);
        let (width, height) = (text_width(&text, 11.5) + 4.0, 13.0);
        for (index, line) in lines.iter().enumerate() {
            // The longest pieces carry the number, where it lies inside and on no other number.
            let spot = (index < 2 && length(line) > 70.0)
                .then(|| label_spot(line, width, height, rect, &taken));
            let Some(at) = spot.flatten() else {
                canvas.line(line, 1.1, ink.mix(0.85))?;
                continue;
            };
            let gap = Rect::around(at, width, height);
            taken.push(gap);
            for piece in line.split(|&point| gap.contains(point)) {
                canvas.line(piece, 1.1, ink.mix(0.85))?;
            }
            canvas.text(&text, at, 11.5, ink, CENTRED)?;
        }
    }
    Ok(())
}

fn label_spot(
    line: &[Point],
    width: f64,
    height: f64,
    rect: &Rect,
    taken: &[Rect],
) -> Option<Point> {
    let middle = line.len() / 2;
    (0..line.len())
        .map(|step| {
            if step % 2 == 0 {
                middle + step / 2
            } else {
                middle.wrapping_sub(step / 2 + 1)
            }
        })
        .filter_map(|index| line.get(index).copied())
        .find(|&at| {
            let wide = Rect::around(at, width + 12.0, height + 10.0);
            rect.encloses(&wide) && taken.iter().all(|other| wide.overlap(other) == 0.0)
        })
}

fn term_names_plain(canvas: &Canvas, spec: &SurfaceSpec, panel: &Panel) -> Result<()> {
    let mut end = f64::NEG_INFINITY;
    for (name, peak) in &spec.cols.terms {
        let name = fitted(name, 12.5, 70.0);
        let width = text_width(&name, 12.5);
        let x = panel.at(*peak, panel.y.end).0;
        if panel.rect.contains((x, panel.rect.top)) && x - width / 2.0 > end + 4.0 {
            canvas.text(&name, (x, panel.rect.top - 12.0), 12.5, MUTED, CENTRED)?;
            end = x + width / 2.0;
        }
    }
    let mut top = f64::INFINITY;
    for (name, peak) in &spec.rows.terms {
        let y = panel.at(panel.x.end, *peak).1;
        if panel.rect.contains((panel.rect.right, y)) && y < top - 14.0 {
            canvas.text(
                &fitted(name, 12.5, 52.0),
                (panel.rect.right + 8.0, y),
                12.5,
                MUTED,
                FROM_LEFT,
            )?;
            top = y;
        }
    }
    Ok(())
}

fn colour_bar(canvas: &Canvas, spec: &SurfaceSpec, range: &Range<f64>, rect: &Rect) -> Result<()> {
    let step = rect.height() / SHADES;
    for tone in 0..SHADES as usize {
        let bottom = rect.bottom - step * tone as f64;
        // Each covers the one below by a little: no seams.
        let block = Rect {
            top: bottom - step,
            bottom: if tone == 0 { bottom } else { bottom + 0.5 },
            ..*rect
        };
        canvas.block(&block, viridis((tone as f64 + 0.5) / SHADES).to_rgba())?;
    }
    canvas.outline(rect, 1.0, FRAME.to_rgba())?;
    let levels = levels(range);
    let places = decimals(&levels);
    for level in levels {
        let y = rect.bottom - share(level, range) * rect.height();
        canvas.line(
            &[(rect.right, y), (rect.right + 4.0, y)],
            1.0,
            FRAME.to_rgba(),
        )?;
        canvas.text(
            &tick_text(level, places),
            (rect.right + 8.0, y),
            12.5,
            INK,
            FROM_LEFT,
        )?;
    }
    let name = fitted(&spec.output.label(), 13.5, 150.0);
    canvas.text(
        &name,
        (rect.centre().0, rect.top - 34.0),
        13.5,
        INK,
        CENTRED,
    )
}

/// Parallel projection of the unit cube, seen from above.
struct View {
    sin: f64,
    cos: f64,
    tilt_sin: f64,
    tilt_cos: f64,
    centre: Point,
    scale: f64,
}

/// Height of the box against its sides.
const RISE: f64 = 0.72;

impl View {
    fn new(turn: f64, rect: &Rect) -> Self {
        let (sin, cos) = turn.to_radians().sin_cos();
        let (tilt_sin, tilt_cos) = 27.0_f64.to_radians().sin_cos();
        let centre = rect.centre();
        Self {
            sin,
            cos,
            tilt_sin,
            tilt_cos,
            centre,
            scale: rect.width() / 1.75,
        }
    }

    /// Screen point of column share, row share and output share.
    fn at(&self, col: f64, row: f64, out: f64) -> Point {
        let (x, y, z) = (col - 0.5, row - 0.5, (out - 0.5) * RISE);
        let right = x * self.cos - y * self.sin;
        let away = x * self.sin + y * self.cos;
        (
            self.centre.0 + self.scale * right,
            self.centre.1 - self.scale * (z * self.tilt_cos + away * self.tilt_sin),
        )
    }

    /// Distance from the viewer on the floor.
    fn away(&self, col: f64, row: f64) -> f64 {
        (col - 0.5) * self.sin + (row - 0.5) * self.cos
    }
}

fn space(
    canvas: &Canvas,
    spec: &SurfaceSpec,
    field: &Field,
    range: &Range<f64>,
    rect: &Rect,
) -> Result<()> {
    // Of the four corners to look from, the one over the lowest ground: hills then stand behind it.
    let turn = [-38.0, 52.0, 142.0, 232.0]
        .into_iter()
        .min_by(|a, b| {
            let hidden = |turn: f64| {
                let view = View::new(turn, rect);
                let cells = field.cells;
                let mut sum = 0.0;
                for row in 0..cells {
                    for col in 0..cells {
                        let away = view.away(col as f64 / cells as f64, row as f64 / cells as f64);
                        let ground = share(field.middle(row, col), range);
                        sum -= if ground.is_nan() { 0.0 } else { ground * away };
                    }
                }
                // A tie goes to the first, so that rounding does not decide the view.
                (sum * 1e3 / (cells * cells) as f64).round()
            };
            hidden(*a).total_cmp(&hidden(*b))
        })
        .unwrap_or(-38.0);
    let view = View::new(turn, rect);
    let near = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
        .into_iter()
        .min_by(|a, b| view.away(a.0, a.1).total_cmp(&view.away(b.0, b.1)))
        .unwrap_or((0.0, 0.0));
    let far = (1.0 - near.0, 1.0 - near.1);

    let levels = levels(range);
    // The floor's near edges as wide as they look.
    let corner = view.at(near.0, near.1, 0.0).0;
    let col_room = (view.at(far.0, near.1, 0.0).0 - corner).abs();
    let row_room = (view.at(near.0, far.1, 0.0).0 - corner).abs();
    let col_ticks = spec.cols.ticks_apart(5.0, col_room, 12.0);
    let row_ticks = spec.rows.ticks_apart(5.0, row_room, 12.0);
    let col_share = |value: f64| share(value, &spec.cols.span());
    let row_share = |value: f64| share(value, &spec.rows.span());

    // Floor and the two walls behind.
    let walls: [[(f64, f64, f64); 4]; 3] = [
        [
            (0.0, 0.0, 0.0),
            (1.0, 0.0, 0.0),
            (1.0, 1.0, 0.0),
            (0.0, 1.0, 0.0),
        ],
        [
            (far.0, 0.0, 0.0),
            (far.0, 1.0, 0.0),
            (far.0, 1.0, 1.0),
            (far.0, 0.0, 1.0),
        ],
        [
            (0.0, far.1, 0.0),
            (1.0, far.1, 0.0),
            (1.0, far.1, 1.0),
            (0.0, far.1, 1.0),
        ],
    ];
    for (wall, tint) in walls.iter().zip([
        RGBColor(242, 244, 246),
        RGBColor(248, 249, 250),
        RGBColor(251, 251, 252),
    ]) {
        let mut corners: Vec<Point> = wall.iter().map(|&(c, r, o)| view.at(c, r, o)).collect();
        canvas.polygon(&corners, tint.to_rgba())?;
        corners.push(corners[0]);
        canvas.line(&corners, 0.9, FRAME.mix(0.7))?;
    }
    let rule = |line: &[(f64, f64, f64)]| {
        let points: Vec<Point> = line.iter().map(|&(c, r, o)| view.at(c, r, o)).collect();
        canvas.line(&points, 0.8, GRID.to_rgba())
    };
    for &tick in &col_ticks {
        let c = col_share(tick);
        rule(&[(c, near.1, 0.0), (c, far.1, 0.0), (c, far.1, 1.0)])?;
    }
    for &tick in &row_ticks {
        let r = row_share(tick);
        rule(&[(near.0, r, 0.0), (far.0, r, 0.0), (far.0, r, 1.0)])?;
    }
    for &level in &levels {
        let o = share(level, range);
        rule(&[(far.0, near.1, o), (far.0, far.1, o), (near.0, far.1, o)])?;
    }

    mesh(canvas, field, range, &view)?;

    // Numbers along the two near edges of the floor and up the leftmost edge.
    for (ticks, along_cols, name) in [
        (&col_ticks, true, spec.cols.label()),
        (&row_ticks, false, spec.rows.label()),
    ] {
        // A text off the edge, in the direction in which a tick on the floor would point.
        let beyond = |place: f64, gap: f64| {
            let (edge, out) = if along_cols {
                (
                    view.at(place, near.1, 0.0),
                    view.at(place, 2.0 * near.1 - 0.5, 0.0),
                )
            } else {
                (
                    view.at(near.0, place, 0.0),
                    view.at(2.0 * near.0 - 0.5, place, 0.0),
                )
            };
            (edge, between(edge, out, gap / distance(edge, out)))
        };
        let places = decimals(ticks);
        for &tick in ticks {
            let place = if along_cols {
                col_share(tick)
            } else {
                row_share(tick)
            };
            let (edge, end) = beyond(place, 5.0);
            canvas.line(&[edge, end], 1.0, FRAME.to_rgba())?;
            // A long number keeps its end where a short one has it.
            let text = tick_text(tick, places);
            let long = (text_width(&text, 12.0) / 2.0 - 14.0).max(0.0);
            let (x, y) = beyond(place, 18.0).1;
            let x = if end.0 < edge.0 { x - long } else { x + long };
            canvas.text(&text, (x, y), 12.0, INK, CENTRED)?;
        }
        let (edge, end) = beyond(0.5, 52.0 + (widest(ticks, 12.0) - 28.0).max(0.0));
        // Names hang away from the box, whatever their length.
        let hang = if end.0 < edge.0 {
            FROM_RIGHT
        } else {
            FROM_LEFT
        };
        canvas.text(
            &fitted(&name, 14.0, 150.0),
            (end.0, end.1 + 4.0),
            14.0,
            INK,
            hang,
        )?;
    }
    let left = [(0.0, 0.0), (1.0, 0.0), (1.0, 1.0), (0.0, 1.0)]
        .into_iter()
        .min_by(|a, b| {
            view.at(a.0, a.1, 0.0)
                .0
                .total_cmp(&view.at(b.0, b.1, 0.0).0)
        })
        .unwrap_or(near);
    let post = [view.at(left.0, left.1, 0.0), view.at(left.0, left.1, 1.0)];
    canvas.line(&post, 1.0, FRAME.to_rgba())?;
    let places = decimals(&levels);
    for &level in &levels {
        let (x, y) = view.at(left.0, left.1, share(level, range));
        let text = tick_text(level, places);
        canvas.line(&[(x, y), (x - 4.0, y)], 1.0, FRAME.to_rgba())?;
        // The lowest number makes way for the floor's own at the same corner.
        canvas.text(
            &text,
            (x - 7.0, y.min(post[0].1 - 6.0)),
            12.0,
            INK,
            FROM_RIGHT,
        )?;
    }
    let name = fitted(&spec.output.label(), 14.0, 240.0);
    let wide = widest(&levels, 12.0);
    let at = (post[0].0 - 22.0 - wide, (post[0].1 + post[1].1) / 2.0);
    canvas.text(&name, at, 14.0, INK, UPWARD)
}

/// The surface's cells, the farthest first.
fn mesh(canvas: &Canvas, field: &Field, range: &Range<f64>, view: &View) -> Result<()> {
    let cells = field.cells;
    let place = |index: usize| index as f64 / cells as f64;
    let mut order: Vec<(usize, usize)> = (0..cells * cells)
        .map(|index| (index / cells, index % cells))
        .collect();
    order.sort_by(|a, b| {
        view.away(place(b.1), place(b.0))
            .total_cmp(&view.away(place(a.1), place(a.0)))
    });
    for (row, col) in order {
        if field.middle(row, col).is_nan() {
            continue;
        }
        let corner = |row: usize, col: usize| {
            view.at(place(col), place(row), share(field.value(row, col), range))
        };
        let quad = [
            corner(row, col),
            corner(row, col + 1),
            corner(row + 1, col + 1),
            corner(row + 1, col),
        ];
        let colour = viridis(share(field.middle(row, col), range));
        canvas.polygon(&quad, colour.to_rgba())?;
        // The grid also hides the seams between neighbours; every second line is enough to read the shape.
        canvas.line(
            &[quad[0], quad[1], quad[2], quad[3], quad[0]],
            0.5,
            shaded(colour, 0.82).to_rgba(),
        )?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::tests::{axis, sound};

    type Eval<'a> = &'a (dyn Fn(f64, f64) -> Option<f64> + Sync);

    fn spec(eval: Eval<'_>) -> SurfaceSpec<'_> {
        SurfaceSpec {
            title: "Deflection <steep>".to_owned(),
            note: "held: speed = 1".to_owned(),
            rows: axis(
                "φ",
                &[("ahead", 0.0), ("abeam", 90.0), ("behind", 180.0)],
                (-10.0, 190.0),
            ),
            cols: axis(
                "d",
                &[("near", 0.0), ("middle", 1.0), ("far", 4.0)],
                (0.0, 5.0),
            ),
            output: axis(
                "deflection",
                &[("none", 0.0), ("some", 30.0), ("hard", 90.0)],
                (0.0, 90.0),
            ),
            eval,
        }
    }

    #[test]
    fn every_shape_of_surface_can_be_drawn() {
        let shapes: [Eval; 7] = [
            &|row, col| Some((90.0 - row / 2.0) * (1.0 - col / 5.0)),
            &|_, _| Some(3.0),
            &|row, _| Some(if row < 90.0 { -1e-3 } else { 1e-3 }),
            &|row, col| Some(1e6 * (row / 20.0).sin() * (col * 3.0).cos()),
            &|row, col| Some((row * 917.3 + col * 77.7).sin()),
            &|row, col| (row > 20.0 && col < 4.0).then_some(row),
            &|_, _| None,
        ];
        for shape in shapes {
            sound(surface_svg(&spec(shape)).unwrap());
        }
    }

    #[test]
    fn both_sides_name_axes_and_terms() {
        let svg = surface_svg(&spec(&|row, col| Some(row * col))).unwrap();
        for text in [
            "Deflection &lt;steep&gt;",
            "held: speed = 1",
            "φ [°]",
            "d [°]",
            "deflection [°]",
            "abeam",
            "middle",
        ] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(svg.matches("φ [°]").count() == 2);
        assert!(!svg.contains("no value"));
    }

    #[test]
    fn an_output_that_is_no_number_is_an_error() {
        let odd = |_, col| Some(if col > 3.0 { f64::NAN } else { 0.0 });
        assert!(surface_svg(&spec(&odd)).is_err());
    }

    #[test]
    fn where_there_is_no_value_the_picture_says_so() {
        let svg = surface_svg(&spec(&|row, _| (row > 20.0).then_some(row))).unwrap();
        assert!(svg.contains("no value"));
        let mut odd = spec(&|_, _| Some(0.0));
        odd.cols.range = (1.0, 1.0);
        assert!(surface_svg(&odd).is_err());
    }

    #[test]
    fn isolines_are_joined() {
        let bowl = spec(&|row, col| Some(((row - 90.0) / 100.0).hypot((col - 2.5) / 2.5)));
        let lines = Field::sample(&bowl, 60).unwrap().isolines(0.7, 1e-9);
        // One closed ring.
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].first(), lines[0].last());
    }

    #[test]
    fn rounding_on_a_plateau_draws_no_line() {
        // 5 but for the last bit, from column 2.5 on; a slope up to it before.
        let plateau = spec(&|row, col| {
            let noise = if (row * 917.3 + col * 77.7).sin() > 0.0 {
                1e-15
            } else {
                -1e-15
            };
            Some(col.min(2.5) * 2.0 + noise)
        });
        let lines = Field::sample(&plateau, 60).unwrap().isolines(5.0, 5e-9);
        assert_eq!(lines.len(), 1);
        assert!(
            lines[0].iter().all(|point| (point.0 - 30.0).abs() < 1e-6),
            "{lines:?}"
        );
    }
}
