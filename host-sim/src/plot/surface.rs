//! What a fuzzy controller computes: its membership functions, and its output over two inputs.

use std::collections::HashMap;
use std::ops::Range;

use anyhow::{Result, ensure};
use plotters::style::{Color, RGBColor};

use super::{
    CENTRED, Canvas, FRAME, FROM_LEFT, FROM_RIGHT, GRID, INK, MUTED, Panel, Point, Rect, UPWARD,
    between, decimals, distance, document, extent, fitted, text_width, tick_text, ticks, ticks_by,
};

/// A linguistic variable: its name, terms and range.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Name, for example `φ`.
    pub name: String,
    /// Unit, for example `°`; empty for a bare number.
    pub unit: String,
    /// Name and peak of each term, peaks ascending.
    pub terms: Vec<(String, f64)>,
    /// Least and greatest value shown.
    pub range: (f64, f64),
}

/// A two-input controller to draw.
pub struct SurfaceSpec<'a> {
    /// Heading of the figure.
    pub title: String,
    /// Input along the rows of the rule table.
    pub rows: Axis,
    /// Input along the columns.
    pub cols: Axis,
    /// Output; its terms' peaks are the singletons.
    pub output: Axis,
    /// Output for a row input and a column input.
    pub eval: &'a dyn Fn(f64 /* row input */, f64 /* col input */) -> f64,
}

const WIDTH: f64 = 1200.0;
const WHITE: RGBColor = RGBColor(255, 255, 255);

/// Cells of the heat map a side, and of the 3-D surface.
const FINE_CELLS: usize = 170;
const COARSE_CELLS: usize = 40;
/// Side of the heat map, pixels: whole drawing units a cell, so that no seam shows between cells.
const HEAT_SIDE: f64 = 425.0;
/// Most blocks of the heat map.
const MOST_RUNS: usize = 9000;
/// Shades of the heat map; neighbours are hardly told apart, and runs of one shade keep the document small.
const SHADES: f64 = 64.0;

/// Matplotlib's viridis at ninths.
const VIRIDIS: [(u8, u8, u8); 10] = [
    (68, 1, 84),
    (72, 40, 120),
    (62, 74, 137),
    (49, 104, 142),
    (38, 130, 142),
    (31, 158, 137),
    (53, 183, 121),
    (109, 205, 89),
    (180, 222, 44),
    (253, 231, 37),
];

fn viridis(share: f64) -> RGBColor {
    let place = share.clamp(0.0, 1.0) * 9.0;
    let low = (place.floor() as usize).min(8);
    let rest = place - low as f64;
    let (a, b) = (VIRIDIS[low], VIRIDIS[low + 1]);
    let mix = |a: u8, b: u8| (f64::from(a) + (f64::from(b) - f64::from(a)) * rest).round() as u8;
    RGBColor(mix(a.0, b.0), mix(a.1, b.1), mix(a.2, b.2))
}

/// Scaled towards black.
fn shaded(colour: RGBColor, light: f64) -> RGBColor {
    let dim = |channel: u8| (f64::from(channel) * light.clamp(0.0, 1.0)).round() as u8;
    RGBColor(dim(colour.0), dim(colour.1), dim(colour.2))
}

impl Axis {
    fn check(&self, input: bool) -> Result<()> {
        let (low, high) = self.range;
        let name = &self.name;
        ensure!(
            low.is_finite() && high.is_finite() && low < high,
            "{name}: {low} to {high} is no range"
        );
        ensure!(!self.terms.is_empty(), "{name} has no terms");
        ensure!(
            self.terms.iter().all(|(_, peak)| peak.is_finite()),
            "{name} has a peak that is no number"
        );
        let ascending = self.terms.windows(2).all(|pair| pair[0].1 < pair[1].1);
        ensure!(!input || ascending, "{name}: peaks must ascend");
        Ok(())
    }

    fn span(&self) -> Range<f64> {
        self.range.0..self.range.1
    }

    fn label(&self) -> String {
        if self.unit.is_empty() {
            self.name.clone()
        } else {
            format!("{} [{}]", self.name, self.unit)
        }
    }

    fn at(&self, share: f64) -> f64 {
        self.range.0 + (self.range.1 - self.range.0) * share
    }

    fn ticks(&self, most: f64) -> Vec<f64> {
        // Angles read best in divisions of the circle.
        let span = self.range.1 - self.range.0;
        if self.unit == "°" || self.unit == "deg" {
            let step = [1.0, 5.0, 10.0, 15.0, 30.0, 45.0, 90.0, 180.0]
                .into_iter()
                .find(|step| span / step <= most);
            if let Some(step) = step.filter(|step| span / step >= 2.0) {
                return ticks_by(&self.span(), step);
            }
        }
        ticks(&self.span(), most)
    }
}

/// Draws the two inputs' triangular partitions and the output's singletons, a panel each.
///
/// # Errors
/// When an axis has an empty range, no terms, or peaks that are not ascending numbers.
pub fn membership_svg(spec: &SurfaceSpec) -> Result<String> {
    spec.rows.check(true)?;
    spec.cols.check(true)?;
    spec.output.check(false)?;
    let (left, right) = (82.0, WIDTH - 28.0);
    let height = 168.0;
    let pitch = height + 104.0;
    let first = 96.0;
    document(WIDTH, first + 3.0 * pitch - 44.0, |canvas| {
        canvas.text(
            &fitted(&spec.title, 22.0, right - left),
            (left, 28.0),
            22.0,
            INK,
            FROM_LEFT,
        )?;
        for (index, (axis, input)) in [
            (&spec.rows, true),
            (&spec.cols, true),
            (&spec.output, false),
        ]
        .into_iter()
        .enumerate()
        {
            let rect = Rect::new(left, first + pitch * index as f64, right - left, height);
            let panel = Panel {
                rect,
                x: padded(axis, input),
                y: 0.0..1.08,
                x_ticks: axis.ticks(12.0),
                y_ticks: vec![0.0, 0.5, 1.0],
                x_name: axis.label(),
                y_name: if input { "membership" } else { "singletons" }.to_owned(),
                x_numbers: true,
            };
            panel.axes(canvas, true)?;
            if input {
                triangles(canvas, axis, &panel)?;
            } else {
                stems(canvas, axis, &panel)?;
            }
            panel.frame(canvas)?;
            term_names(canvas, axis, &panel)?;
        }
        Ok(())
    })
}

/// Stems at the ends of the range would stand on the frame, and a stem outside would be lost.
fn padded(axis: &Axis, input: bool) -> Range<f64> {
    if input {
        return axis.span();
    }
    let (low, high) = axis
        .terms
        .iter()
        .fold(axis.range, |(low, high), (_, peak)| {
            (low.min(*peak), high.max(*peak))
        });
    let pad = 0.03 * (high - low);
    low - pad..high + pad
}

fn term_colour(index: usize, count: usize) -> RGBColor {
    // Viridis' yellow end is too light for a line on white.
    shaded(
        viridis(0.82 * index as f64 / (count - 1).max(1) as f64),
        0.85,
    )
}

fn triangles(canvas: &Canvas, axis: &Axis, panel: &Panel) -> Result<()> {
    let (low, high) = axis.range;
    let terms = &axis.terms;
    for (index, (_, peak)) in terms.iter().enumerate() {
        let mut shape = Vec::new();
        match index.checked_sub(1).map(|before| terms[before].1) {
            Some(foot) => shape.push((foot, 0.0)),
            // A shoulder: the outermost term holds to the end of the range.
            None => shape.extend([(low.min(*peak), 0.0), (low.min(*peak), 1.0)]),
        }
        shape.push((*peak, 1.0));
        match terms.get(index + 1) {
            Some((_, foot)) => shape.push((*foot, 0.0)),
            None => shape.extend([(high.max(*peak), 1.0), (high.max(*peak), 0.0)]),
        }
        let colour = term_colour(index, terms.len());
        let points: Vec<Point> = shape.iter().map(|&(x, y)| panel.at(x, y)).collect();
        canvas.polygon(&panel.rect.clip(&points), colour.mix(0.13))?;
        // The shoulder's drop at the range's end is the frame's business.
        let top =
            &points[usize::from(index == 0)..points.len() - usize::from(index + 1 == terms.len())];
        for pair in top.windows(2) {
            if let Some((from, to)) = panel.rect.clip_line(pair[0], pair[1]) {
                canvas.line(&[from, to], 2.0, colour.to_rgba())?;
            }
        }
    }
    Ok(())
}

fn stems(canvas: &Canvas, axis: &Axis, panel: &Panel) -> Result<()> {
    for (index, (_, peak)) in axis.terms.iter().enumerate() {
        let colour = term_colour(index, axis.terms.len());
        canvas.line(
            &[panel.at(*peak, 0.0), panel.at(*peak, 1.0)],
            2.4,
            colour.to_rgba(),
        )?;
        canvas.disc(panel.at(*peak, 1.0), 5.0, colour.to_rgba())?;
    }
    Ok(())
}

/// Names over the peaks, in a second row where neighbours would touch.
fn term_names(canvas: &Canvas, axis: &Axis, panel: &Panel) -> Result<()> {
    let mut ends = [f64::NEG_INFINITY; 2];
    for (index, (name, peak)) in axis.terms.iter().enumerate() {
        let name = fitted(name, 13.5, 120.0);
        let width = text_width(&name, 13.5);
        let x = panel.at(*peak, 1.0).0;
        if x < panel.rect.left - 1.0 || x > panel.rect.right + 1.0 {
            continue;
        }
        let from = (x - width / 2.0).min(panel.rect.right + 18.0 - width);
        let row = (0..2).find(|&row| from > ends[row] + 5.0);
        // A name without room is left out rather than printed over its neighbour.
        let Some(row) = row else { continue };
        ends[row] = from + width;
        let at = (
            from + width / 2.0,
            panel.rect.top - 12.0 - 16.0 * row as f64,
        );
        canvas.text(
            &name,
            at,
            13.5,
            term_colour(index, axis.terms.len()),
            CENTRED,
        )?;
    }
    Ok(())
}

/// Draws the output over both inputs: a heat map with labelled iso-lines, and the same as a surface in space.
///
/// # Errors
/// When an axis is not drawable (see [`membership_svg`]) or the output is not a number somewhere.
pub fn surface_svg(spec: &SurfaceSpec) -> Result<String> {
    spec.rows.check(true)?;
    spec.cols.check(true)?;
    spec.output.check(false)?;
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
        canvas.text(
            &fitted(&spec.title, 22.0, WIDTH - 110.0),
            (82.0, 28.0),
            22.0,
            INK,
            FROM_LEFT,
        )?;
        heat_map(canvas, spec, &fine, &range)?;
        space(
            canvas,
            spec,
            &coarse,
            &range,
            &Rect::new(665.0, 62.0, 520.0, 530.0),
        )
    })
}

/// The output on a square grid, row input major.
struct Field {
    cells: usize,
    values: Vec<f64>,
}

impl Field {
    fn sample(spec: &SurfaceSpec, cells: usize) -> Result<Self> {
        let mut values = Vec::with_capacity((cells + 1) * (cells + 1));
        for row in 0..=cells {
            for col in 0..=cells {
                let row = spec.rows.at(row as f64 / cells as f64);
                let col = spec.cols.at(col as f64 / cells as f64);
                let value = (spec.eval)(row, col);
                ensure!(
                    value.is_finite(),
                    "{} is {value} at {row}, {col}",
                    spec.output.name
                );
                values.push(value);
            }
        }
        Ok(Self { cells, values })
    }

    fn value(&self, row: usize, col: usize) -> f64 {
        self.values[row * (self.cells + 1) + col]
    }

    fn middle(&self, row: usize, col: usize) -> f64 {
        let sum = self.value(row, col)
            + self.value(row + 1, col)
            + self.value(row, col + 1)
            + self.value(row + 1, col + 1);
        sum / 4.0
    }

    /// Row, first and end column, and shade of each stretch of one shade.
    fn runs(&self, range: &Range<f64>) -> Vec<(usize, usize, usize, f64)> {
        let shade = |row, col| {
            let place = share(self.middle(row, col), range) * SHADES;
            place.floor().clamp(0.0, SHADES - 1.0)
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

    /// Lines of one value, in cells from the first row and column (marching squares).
    fn isolines(&self, level: f64) -> Vec<Vec<Point>> {
        let mut segments: Vec<(Point, Point)> = Vec::new();
        for row in 0..self.cells {
            for col in 0..self.cells {
                let corners = [
                    (row, col),
                    (row, col + 1),
                    (row + 1, col + 1),
                    (row + 1, col),
                ];
                let mut cuts = Vec::new();
                for side in 0..4 {
                    // Neighbouring cells must compute a shared side alike, or the chains below break.
                    let (mut from, mut to) = (corners[side], corners[(side + 1) % 4]);
                    if to < from {
                        (from, to) = (to, from);
                    }
                    let (a, b) = (self.value(from.0, from.1), self.value(to.0, to.1));
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

fn heat_map(canvas: &Canvas, spec: &SurfaceSpec, field: &Field, range: &Range<f64>) -> Result<()> {
    let side = HEAT_SIDE;
    let cell = side / field.cells as f64;
    let rect = Rect::new(82.0, 110.0, side, side);
    let panel = Panel {
        rect,
        x: spec.cols.span(),
        y: spec.rows.span(),
        x_ticks: spec.cols.ticks(7.0),
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
        canvas.block(&block, viridis((tone + 0.5) / SHADES).to_rgba())?;
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
            .isolines(level)
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
                        sum -= share(field.middle(row, col), range) * away;
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
    let (col_ticks, row_ticks) = (spec.cols.ticks(5.0), spec.rows.ticks(5.0));
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
            canvas.text(
                &tick_text(tick, places),
                beyond(place, 18.0).1,
                12.0,
                INK,
                CENTRED,
            )?;
        }
        let (edge, end) = beyond(0.5, 52.0);
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
    let mut widest = 0.0_f64;
    for &level in &levels {
        let (x, y) = view.at(left.0, left.1, share(level, range));
        let text = tick_text(level, places);
        widest = widest.max(text_width(&text, 12.0));
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
    let at = (post[0].0 - 22.0 - widest, (post[0].1 + post[1].1) / 2.0);
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
    use crate::plot::png;

    fn axis(name: &str, terms: &[(&str, f64)], range: (f64, f64)) -> Axis {
        Axis {
            name: name.to_owned(),
            unit: "°".to_owned(),
            terms: terms
                .iter()
                .map(|&(name, peak)| (name.to_owned(), peak))
                .collect(),
            range,
        }
    }

    fn spec(eval: &dyn Fn(f64, f64) -> f64) -> SurfaceSpec<'_> {
        SurfaceSpec {
            title: "Deflection <steep>".to_owned(),
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

    fn sound(svg: &str) {
        assert!(svg.len() < 2_000_000 && !svg.contains("NaN"));
        assert_eq!(&png(svg, 0.5).unwrap()[1..4], b"PNG");
    }

    #[test]
    fn every_shape_of_surface_can_be_drawn() {
        let shapes: [&dyn Fn(f64, f64) -> f64; 5] = [
            &|row, col| (90.0 - row / 2.0) * (1.0 - col / 5.0),
            &|_, _| 3.0,
            &|row, _| if row < 90.0 { -1e-3 } else { 1e-3 },
            &|row, col| 1e6 * (row / 20.0).sin() * (col * 3.0).cos(),
            &|row, col| (row * 917.3 + col * 77.7).sin(),
        ];
        for shape in shapes {
            sound(&surface_svg(&spec(shape)).unwrap());
        }
    }

    #[test]
    fn both_sides_name_axes_and_terms() {
        let svg = surface_svg(&spec(&|row, col| row * col)).unwrap();
        for text in [
            "Deflection &lt;steep&gt;",
            "φ [°]",
            "d [°]",
            "deflection [°]",
            "abeam",
            "middle",
        ] {
            assert!(svg.contains(text), "{text}");
        }
        assert!(svg.matches("φ [°]").count() == 2);
    }

    #[test]
    fn an_output_that_is_no_number_is_an_error() {
        assert!(surface_svg(&spec(&|_, col| if col > 3.0 { f64::NAN } else { 0.0 })).is_err());
    }

    #[test]
    fn memberships_name_every_term() {
        let svg = membership_svg(&spec(&|_, _| 0.0)).unwrap();
        sound(&svg);
        for text in ["ahead", "behind", "near", "far", "none", "hard"] {
            assert!(svg.contains(text), "{text}");
        }
    }

    #[test]
    fn odd_axes() {
        let mut odd = spec(&|_, _| 0.0);
        odd.rows.terms.truncate(1);
        odd.output.terms.push(("more".to_owned(), 120.0));
        sound(&membership_svg(&odd).unwrap());
        odd.rows.terms.clear();
        assert!(membership_svg(&odd).is_err());
        let mut odd = spec(&|_, _| 0.0);
        odd.cols.terms.reverse();
        assert!(membership_svg(&odd).is_err());
        let mut odd = spec(&|_, _| 0.0);
        odd.cols.range = (1.0, 1.0);
        assert!(surface_svg(&odd).is_err());
    }

    #[test]
    fn isolines_are_joined() {
        let bowl = spec(&|row, col| ((row - 90.0) / 100.0).hypot((col - 2.5) / 2.5));
        let lines = Field::sample(&bowl, 60).unwrap().isolines(0.7);
        // One closed ring.
        assert_eq!(lines.len(), 1);
        assert_eq!(lines[0].first(), lines[0].last());
    }

    #[test]
    fn colours_run_from_dark_to_bright() {
        let light = |share| {
            let RGBColor(r, g, b) = viridis(share);
            0.3 * f64::from(r) + 0.6 * f64::from(g) + 0.1 * f64::from(b)
        };
        assert!(
            (0..20).all(|step| light(f64::from(step) / 20.0) < light(f64::from(step + 1) / 20.0))
        );
    }
}
