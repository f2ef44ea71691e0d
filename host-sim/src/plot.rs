//! Figures: a run on the map with its signals over time, membership functions and control surfaces, each as an SVG
//! string that [`raster::png`] turns into the same picture as PNG.
//!
//! plotters draws whole pixels only, so everything here is drawn on a canvas `FINE` times larger than the figure
//! and the document's view box scales it back: curves stay smooth at any zoom.

pub mod axis;
pub mod curve;
pub mod membership;
pub mod palette;
pub mod raster;
pub mod run;
pub mod surface;
pub mod thumbnail;

use std::ops::Range;
use std::path::Path;

use crate::put::put_all;
use anyhow::{Result, ensure};
use plotters::coord::Shift;
use plotters::coord::ranged1d::{DefaultFormatting, KeyPointHint};
use plotters::prelude::*;
use plotters::style::text_anchor::{HPos, Pos, VPos};

pub use axis::Axis;
pub use curve::curve_svg;
pub use membership::{Form, TermCurve, Variable, membership_svg};
pub use raster::png;
pub use run::run_svg;
pub use surface::{SurfaceSpec, surface_svg};
pub use thumbnail::thumbnail_svg;

/// Drawing units a pixel of the figure.
const FINE: f64 = 8.0;
/// First the embedded face, then what a browser without it should take.
const FAMILY: &str = "Ubuntu, Helvetica, Arial, sans-serif";
/// Pixels of PNG a pixel of the figure in [`pair`].
const PNG_SCALE: f32 = 2.0;

/// Pixels across a figure.
const WIDTH: f64 = 1200.0;

const INK: RGBColor = RGBColor(0x22, 0x26, 0x2B);
const MUTED: RGBColor = RGBColor(0x5F, 0x66, 0x6E);
const GRID: RGBColor = RGBColor(0xE3, 0xE6, 0xE9);
const FRAME: RGBColor = RGBColor(0x8A, 0x91, 0x99);

/// A figure as files: `stem.svg` and `stem.png`.
///
/// # Errors
/// When the picture cannot be rasterised.
pub fn pair(stem: &str, svg: &str) -> Result<[(String, Vec<u8>); 2]> {
    let png = png(svg, PNG_SCALE)?;
    Ok([
        (format!("{stem}.svg"), svg.as_bytes().to_vec()),
        (format!("{stem}.png"), png),
    ])
}

/// Writes `stem.svg` and `stem.png` into `dir`, which must exist; a failure leaves no half-written file.
///
/// # Errors
/// When the picture cannot be rasterised or a file cannot be written.
pub fn write_pair(dir: &Path, stem: &str, svg: &str) -> Result<()> {
    // Rasterise first: a broken figure should not replace a good one.
    let [(svg_name, svg), (png_name, png)] = pair(stem, svg)?;
    put_all(&[(&dir.join(svg_name), &svg), (&dir.join(png_name), &png)])
}

/// A point of the figure, pixels from its top left corner.
type Point = (f64, f64);

/// An upright rectangle of the figure.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Rect {
    left: f64,
    top: f64,
    right: f64,
    bottom: f64,
}

impl Rect {
    fn new(left: f64, top: f64, width: f64, height: f64) -> Self {
        Self {
            left,
            top,
            right: left + width,
            bottom: top + height,
        }
    }

    fn around((x, y): Point, width: f64, height: f64) -> Self {
        Self::new(x - width / 2.0, y - height / 2.0, width, height)
    }

    fn width(&self) -> f64 {
        self.right - self.left
    }

    fn height(&self) -> f64 {
        self.bottom - self.top
    }

    fn centre(&self) -> Point {
        (
            (self.left + self.right) / 2.0,
            (self.top + self.bottom) / 2.0,
        )
    }

    fn contains(&self, (x, y): Point) -> bool {
        x >= self.left && x <= self.right && y >= self.top && y <= self.bottom
    }

    fn encloses(&self, other: &Self) -> bool {
        self.contains((other.left, other.top)) && self.contains((other.right, other.bottom))
    }

    fn overlap(&self, other: &Self) -> f64 {
        let width = self.right.min(other.right) - self.left.max(other.left);
        let height = self.bottom.min(other.bottom) - self.top.max(other.top);
        width.max(0.0) * height.max(0.0)
    }

    /// A convex polygon's part inside (Sutherland and Hodgman).
    fn clip(&self, polygon: &[Point]) -> Vec<Point> {
        let inside: [&dyn Fn(Point) -> f64; 4] = [
            &|p| p.0 - self.left,
            &|p| self.right - p.0,
            &|p| p.1 - self.top,
            &|p| self.bottom - p.1,
        ];
        let mut kept = polygon.to_vec();
        for depth in inside {
            let before = std::mem::take(&mut kept);
            for (index, &to) in before.iter().enumerate() {
                let from = before[(index + before.len() - 1) % before.len()];
                let (a, b) = (depth(from), depth(to));
                if (a < 0.0) != (b < 0.0) {
                    kept.push(between(from, to, a / (a - b)));
                }
                if b >= 0.0 {
                    kept.push(to);
                }
            }
        }
        kept
    }

    /// A segment's part inside (Liang and Barsky).
    fn clip_line(&self, from: Point, to: Point) -> Option<(Point, Point)> {
        let (dx, dy) = (to.0 - from.0, to.1 - from.1);
        let (mut enter, mut leave) = (0.0_f64, 1.0_f64);
        for (step, room) in [
            (-dx, from.0 - self.left),
            (dx, self.right - from.0),
            (-dy, from.1 - self.top),
            (dy, self.bottom - from.1),
        ] {
            if step == 0.0 {
                if room < 0.0 {
                    return None;
                }
            } else if step < 0.0 {
                enter = enter.max(room / step);
            } else {
                leave = leave.min(room / step);
            }
        }
        (enter <= leave).then(|| (between(from, to, enter), between(from, to, leave)))
    }
}

fn between(from: Point, to: Point, share: f64) -> Point {
    (
        from.0 + (to.0 - from.0) * share,
        from.1 + (to.1 - from.1) * share,
    )
}

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

/// The colour of a share of the way from dark to bright.
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

/// Where a text hangs on its point.
#[derive(Clone, Copy)]
struct Hang(HPos, VPos, bool);

const CENTRED: Hang = Hang(HPos::Center, VPos::Center, false);
const FROM_LEFT: Hang = Hang(HPos::Left, VPos::Center, false);
const FROM_RIGHT: Hang = Hang(HPos::Right, VPos::Center, false);
const UPWARD: Hang = Hang(HPos::Center, VPos::Center, true);

/// The figure while it is drawn, in pixels.
struct Canvas<'a> {
    area: DrawingArea<SVGBackend<'a>, Shift>,
}

fn unit(value: f64) -> i32 {
    // The cast saturates and maps NaN to 0: whatever comes in, the document holds plain numbers.
    (value * FINE).round() as i32
}

fn units(point: Point) -> (i32, i32) {
    (unit(point.0), unit(point.1))
}

fn stroke(width: f64, colour: RGBAColor) -> ShapeStyle {
    ShapeStyle {
        color: colour,
        filled: false,
        stroke_width: unit(width).max(1).unsigned_abs(),
    }
}

/// Draws a figure of the given size on white.
fn document(width: f64, height: f64, draw: impl FnOnce(&Canvas) -> Result<()>) -> Result<String> {
    let (fine_width, fine_height) = (unit(width).unsigned_abs(), unit(height).unsigned_abs());
    let mut svg = String::new();
    {
        let area = SVGBackend::with_string(&mut svg, (fine_width, fine_height)).into_drawing_area();
        area.fill(&WHITE)?;
        let canvas = Canvas { area };
        draw(&canvas)?;
        canvas.area.present()?;
    }
    let given = format!("<svg width=\"{fine_width}\" height=\"{fine_height}\"");
    ensure!(
        svg.starts_with(&given),
        "the drawing library writes another head than expected"
    );
    // Round joins keep sharp turns of a dense polyline from growing spikes.
    let wanted =
        format!("<svg width=\"{width:.0}\" height=\"{height:.0}\" stroke-linejoin=\"round\"");
    svg.replace_range(..given.len(), &wanted);
    Ok(svg)
}

impl Canvas<'_> {
    fn line(&self, points: &[Point], width: f64, colour: RGBAColor) -> Result<()> {
        let mut fine: Vec<_> = points.iter().copied().map(units).collect();
        fine.dedup();
        if fine.len() > 1 {
            self.area
                .draw(&PathElement::new(fine, stroke(width, colour)))?;
        }
        Ok(())
    }

    /// Dashes of `on` pixels with gaps of `off`; solid when that would take thousands of them.
    fn dashes(
        &self,
        points: &[Point],
        (on, off): (f64, f64),
        width: f64,
        colour: RGBAColor,
    ) -> Result<()> {
        let length: f64 = points
            .windows(2)
            .map(|pair| distance(pair[0], pair[1]))
            .sum();
        if length / (on + off) > 2500.0 {
            return self.line(points, width, colour);
        }
        let mut dash = Vec::new();
        let (mut drawing, mut left) = (true, on);
        for pair in points.windows(2) {
            let (mut from, to) = (pair[0], pair[1]);
            loop {
                if drawing && dash.is_empty() {
                    dash.push(from);
                }
                let rest = distance(from, to);
                if rest < left {
                    left -= rest;
                    if drawing {
                        dash.push(to);
                    }
                    break;
                }
                from = between(from, to, if rest > 0.0 { left / rest } else { 1.0 });
                if drawing {
                    dash.push(from);
                    self.line(&dash, width, colour)?;
                    dash.clear();
                }
                drawing = !drawing;
                left = if drawing { on } else { off };
            }
        }
        self.line(&dash, width, colour)
    }

    fn polygon(&self, points: &[Point], colour: RGBAColor) -> Result<()> {
        if points.len() > 2 {
            let fine: Vec<_> = points.iter().copied().map(units).collect();
            self.area.draw(&Polygon::new(fine, colour.filled()))?;
        }
        Ok(())
    }

    fn block(&self, rect: &Rect, colour: RGBAColor) -> Result<()> {
        let corners = [
            units((rect.left, rect.top)),
            units((rect.right, rect.bottom)),
        ];
        self.area.draw(&Rectangle::new(corners, colour.filled()))?;
        Ok(())
    }

    fn outline(&self, rect: &Rect, width: f64, colour: RGBAColor) -> Result<()> {
        let Rect {
            left,
            top,
            right,
            bottom,
        } = *rect;
        let corners = [
            (left, top),
            (right, top),
            (right, bottom),
            (left, bottom),
            (left, top),
        ];
        self.line(&corners, width, colour)
    }

    fn disc(&self, centre: Point, radius: f64, colour: RGBAColor) -> Result<()> {
        self.area
            .draw(&Circle::new(units(centre), unit(radius), colour.filled()))?;
        Ok(())
    }

    fn ring(&self, centre: Point, radius: f64, width: f64, colour: RGBAColor) -> Result<()> {
        self.area.draw(&Circle::new(
            units(centre),
            unit(radius),
            stroke(width, colour),
        ))?;
        Ok(())
    }

    /// The title of a figure, as much of it as fits.
    fn heading(&self, title: &str) -> Result<()> {
        let (left, size) = (82.0, 22.0);
        let title = fitted(title, size, WIDTH - 28.0 - left);
        self.text(&title, (left, 28.0), size, INK, FROM_LEFT)
    }

    fn text(&self, text: &str, at: Point, size: f64, colour: RGBColor, hang: Hang) -> Result<()> {
        let clean = printable(text);
        let turn = if hang.2 {
            FontTransform::Rotate270
        } else {
            FontTransform::None
        };
        let font = (FAMILY, font_size(size)).into_font().transform(turn);
        let style = TextStyle::from(font)
            .color(&colour)
            .pos(Pos::new(hang.0, hang.1));
        self.area.draw(&Text::new(clean, units(at), style))?;
        Ok(())
    }
}

/// plotters' measure of a font whose em is `size` pixels.
fn font_size(size: f64) -> f64 {
    size * FINE * 1.24
}

/// Control characters have no place in XML.
fn printable(text: &str) -> String {
    text.chars()
        .filter(|c| !c.is_control() && !matches!(c, '\u{FFFE}' | '\u{FFFF}'))
        .collect()
}

/// Approximate width of a text in the embedded face, pixels, on the generous side.
fn text_width(text: &str, size: f64) -> f64 {
    let em: f64 = text
        .chars()
        .map(|c| match c {
            'i' | 'j' | 'l' | 'I' | '.' | ',' | ':' | ';' | '\'' | '|' | '!' | ' ' => 0.26,
            'f' | 't' | 'r' | '(' | ')' | '[' | ']' | '/' | '-' => 0.36,
            'm' | 'w' | 'M' | 'W' | '@' | '%' => 0.86,
            'A'..='Z' => 0.67,
            _ => 0.57,
        })
        .sum();
    em * size
}

/// The text, cut to a width with an ellipsis.
fn fitted(text: &str, size: f64, width: f64) -> String {
    let clean = printable(text);
    if text_width(&clean, size) <= width {
        return clean;
    }
    let mut kept = String::new();
    for c in clean.chars() {
        kept.push(c);
        if text_width(&kept, size) + size > width {
            break;
        }
    }
    kept.push('…');
    kept
}

fn distance(a: Point, b: Point) -> f64 {
    (a.0 - b.0).hypot(a.1 - b.1)
}

/// A panel with axes.
struct Panel {
    rect: Rect,
    x: Range<f64>,
    y: Range<f64>,
    x_ticks: Vec<f64>,
    y_ticks: Vec<f64>,
    /// Names below and left of the axes; a line break starts another line, an empty one leaves the ticks bare.
    x_name: String,
    y_name: String,
    x_numbers: bool,
}

/// A linear axis with ticks of our own choice: both axes of a map want the same step.
struct Ticked {
    range: Range<f64>,
    ticks: Vec<f64>,
}

impl Ranged for Ticked {
    type FormatOption = DefaultFormatting;
    type ValueType = f64;

    fn map(&self, value: &f64, limit: (i32, i32)) -> i32 {
        let share = (value - self.range.start) / (self.range.end - self.range.start);
        limit.0 + (f64::from(limit.1 - limit.0) * share).round() as i32
    }

    fn key_points<Hint: KeyPointHint>(&self, hint: Hint) -> Vec<f64> {
        // Lines between the ticks would only be noise.
        if hint.weight().allow_light_points() {
            Vec::new()
        } else {
            self.ticks.clone()
        }
    }

    fn range(&self) -> Range<f64> {
        self.range.clone()
    }
}

/// Room that a panel takes left of its frame for numbers and the name.
const LEFT_ROOM: f64 = 50.0;
const BOTTOM_ROOM: f64 = 26.0;

impl Panel {
    fn at(&self, x: f64, y: f64) -> Point {
        let across = (x - self.x.start) / (self.x.end - self.x.start);
        let up = (y - self.y.start) / (self.y.end - self.y.start);
        (
            self.rect.left + across * self.rect.width(),
            self.rect.bottom - up * self.rect.height(),
        )
    }

    /// Grid, numbers and names; the frame is left to [`Panel::frame`], which belongs above the data.
    fn axes(&self, canvas: &Canvas, grid: bool) -> Result<()> {
        let area = canvas.area.clone().shrink(
            units((self.rect.left - LEFT_ROOM, self.rect.top)),
            units((
                self.rect.width() + LEFT_ROOM,
                self.rect.height() + BOTTOM_ROOM,
            )),
        );
        let mut chart = ChartBuilder::on(&area)
            .x_label_area_size(unit(BOTTOM_ROOM))
            .y_label_area_size(unit(LEFT_ROOM))
            .build_cartesian_2d(
                Ticked {
                    range: self.x.clone(),
                    ticks: self.x_ticks.clone(),
                },
                Ticked {
                    range: self.y.clone(),
                    ticks: self.y_ticks.clone(),
                },
            )?;
        let number = |ticks: &[f64]| {
            let places = decimals(ticks);
            move |value: &f64| tick_text(*value, places)
        };
        let (x_number, y_number) = (number(&self.x_ticks), number(&self.y_ticks));
        let x_number = |value: &f64| {
            if self.x_numbers {
                x_number(value)
            } else {
                String::new()
            }
        };
        let mut mesh = chart.configure_mesh();
        mesh.label_style((FAMILY, font_size(12.5)).into_font().color(&INK))
            .x_labels(self.x_ticks.len().max(1))
            .y_labels(self.y_ticks.len().max(1))
            .x_label_formatter(&x_number)
            .y_label_formatter(&y_number)
            .axis_style(stroke(1.0, FRAME.to_rgba()))
            .bold_line_style(stroke(0.9, GRID.to_rgba()))
            .light_line_style(TRANSPARENT)
            .set_all_tick_mark_size(unit(4.0));
        if !grid {
            mesh.disable_mesh();
        }
        mesh.draw()?;
        let (across, up) = self.rect.centre();
        if !self.x_name.is_empty() {
            canvas.text(
                &self.x_name,
                (across, self.rect.bottom + 36.0),
                14.0,
                INK,
                CENTRED,
            )?;
        }
        let lines: Vec<&str> = self.y_name.lines().collect();
        for (index, line) in lines.iter().enumerate() {
            let clear = (axis::widest(&self.y_ticks, 12.5) + 20.0).max(60.0);
            let left = self.rect.left - clear - 16.0 * (lines.len() - 1 - index) as f64;
            canvas.text(line, (left, up), 14.0, INK, UPWARD)?;
        }
        Ok(())
    }

    fn frame(&self, canvas: &Canvas) -> Result<()> {
        canvas.outline(&self.rect, 1.0, FRAME.to_rgba())
    }
}

/// Step of 1, 2 or 5 times a power of ten with at most `most` steps in the span.
fn nice_step(span: f64, most: f64) -> f64 {
    let raw = (span / most.max(1.0)).max(1e-12);
    let power = 10.0_f64.powf(raw.log10().floor());
    let factor = [1.0, 2.0, 5.0]
        .into_iter()
        .find(|factor| factor * power >= raw * (1.0 - 1e-9))
        .unwrap_or(10.0);
    factor * power
}

fn ticks_by(range: &Range<f64>, step: f64) -> Vec<f64> {
    let (first, last) = (
        (range.start / step - 1e-6).ceil(),
        (range.end / step + 1e-6).floor(),
    );
    // Adding 0 turns a negative zero into a plain one.
    (0..=(last - first).clamp(0.0, 200.0) as u32)
        .map(|index| (first + f64::from(index)) * step + 0.0)
        .collect()
}

fn ticks(range: &Range<f64>, most: f64) -> Vec<f64> {
    ticks_by(range, nice_step(range.end - range.start, most))
}

fn decimals(ticks: &[f64]) -> usize {
    let step = ticks
        .windows(2)
        .map(|pair| (pair[1] - pair[0]).abs())
        .fold(f64::INFINITY, f64::min);
    if !step.is_finite() || step <= 0.0 {
        return 1;
    }
    (0..6)
        .find(|&places| {
            let scaled = step * 10.0_f64.powi(places);
            (scaled - scaled.round()).abs() < 1e-6 * scaled.max(1.0) && scaled.round() >= 1.0
        })
        .map_or(3, |places| places as usize)
}

fn tick_text(value: f64, places: usize) -> String {
    // A typographic minus is as wide as the plus and reads better than the hyphen.
    let text = format!("{:.places$}", value + 0.0);
    match text.strip_prefix('-') {
        Some(rest) if rest.chars().all(|c| c == '0' || c == '.') => rest.to_owned(),
        Some(rest) => format!("−{rest}"),
        None => text,
    }
}

/// Least and greatest finite value.
fn extent(values: impl IntoIterator<Item = f64>) -> Option<(f64, f64)> {
    values
        .into_iter()
        .filter(|value| value.is_finite())
        .fold(None, |seen, value| match seen {
            None => Some((value, value)),
            Some((low, high)) => Some((low.min(value), high.max(value))),
        })
}

/// Finds room for labels between what is already drawn.
struct Placer {
    bounds: Rect,
    taken: Vec<Rect>,
    points: Vec<Point>,
}

impl Placer {
    /// Centre for a label beside a thing of the given radius; claims the place.
    fn beside(&mut self, centre: Point, radius: f64, width: f64, height: f64) -> Point {
        let mut best = (f64::INFINITY, centre);
        for (ring, gap) in [5.0, 14.0, 26.0, 42.0].into_iter().enumerate() {
            for turn in 0..16 {
                let (sin, cos) = (f64::from(turn) * std::f64::consts::TAU / 16.0).sin_cos();
                // The label's own half extent in this direction keeps it off the thing.
                let own = (width / 2.0 * cos).abs() + (height / 2.0 * sin).abs();
                let reach = radius + gap + own;
                let at = (centre.0 + cos * reach, centre.1 - sin * reach);
                let rect = Rect::around(at, width + 4.0, height + 2.0);
                let crossed = self
                    .points
                    .iter()
                    .filter(|&&point| rect.contains(point))
                    .count();
                let covered: f64 = self.taken.iter().map(|other| rect.overlap(other)).sum();
                let outside = if self.bounds.encloses(&rect) {
                    0.0
                } else {
                    1e4
                };
                // Diagonal places and far ones only when the others are taken.
                let taste = ring as f64 * 1.5 + f64::from(turn % 4) * 0.2;
                let cost = outside + covered * 5.0 + crossed as f64 * 4.0 + taste;
                if cost < best.0 {
                    best = (cost, at);
                }
            }
        }
        self.taken
            .push(Rect::around(best.1, width + 4.0, height + 2.0));
        best.1
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// An axis in degrees, to draw.
    pub(super) fn axis(name: &str, terms: &[(&str, f64)], range: (f64, f64)) -> Axis {
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

    /// A figure, once it was seen to be one.
    pub(super) fn sound(svg: String) -> String {
        assert!(svg.len() < 2_000_000 && !svg.contains("NaN"));
        assert_eq!(&png(&svg, 0.5).unwrap()[1..4], b"PNG");
        svg
    }

    #[test]
    fn steps_are_round_and_ticks_lie_inside() {
        assert!((nice_step(10.0, 5.0) - 2.0).abs() < 1e-12);
        assert!((nice_step(0.07, 3.0) - 0.05).abs() < 1e-12);
        assert_eq!(ticks(&(-1.0..1.0), 4.0), [-1.0, -0.5, 0.0, 0.5, 1.0]);
        assert_eq!(tick_text(-0.25, 2), "−0.25");
        assert_eq!(tick_text(-0.001, 1), "0.0");
        assert_eq!(decimals(&[0.0, 0.05, 0.1]), 2);
        assert_eq!(decimals(&[0.0, 20.0]), 0);
    }

    #[test]
    fn clipping_keeps_what_is_inside() {
        let rect = Rect::new(0.0, 0.0, 10.0, 10.0);
        assert_eq!(
            rect.clip_line((-5.0, 5.0), (15.0, 5.0)),
            Some(((0.0, 5.0), (10.0, 5.0)))
        );
        assert_eq!(rect.clip_line((-5.0, -5.0), (-1.0, 20.0)), None);
        let big = [(-9.0, -9.0), (19.0, -9.0), (19.0, 19.0), (-9.0, 19.0)];
        let kept = rect.clip(&big);
        assert_eq!(kept.len(), 4);
        assert!(kept.iter().all(|&point| rect.contains(point)));
        assert!(
            rect.clip(&[(20.0, 0.0), (30.0, 0.0), (25.0, 9.0)])
                .is_empty()
        );
    }

    #[test]
    fn labels_do_not_share_a_place() {
        let mut placer = Placer {
            bounds: Rect::new(0.0, 0.0, 400.0, 400.0),
            taken: Vec::new(),
            points: Vec::new(),
        };
        for _ in 0..6 {
            placer.beside((200.0, 200.0), 5.0, 40.0, 14.0);
        }
        for (index, one) in placer.taken.iter().enumerate() {
            assert!(
                placer.taken[..index]
                    .iter()
                    .all(|other| one.overlap(other) < 1.0)
            );
        }
    }

    #[test]
    fn text_is_cut_and_cleaned() {
        assert_eq!(fitted("a\u{0}b", 12.0, 100.0), "ab");
        let cut = fitted(&"long ".repeat(50), 12.0, 100.0);
        assert!(cut.ends_with('…') && text_width(&cut, 12.0) <= 110.0);
    }

    #[test]
    fn a_pair_leaves_both_files_and_nothing_else() {
        let dir = tempfile::tempdir().unwrap();
        let svg = document(40.0, 20.0, |canvas| {
            canvas.text("x", (20.0, 10.0), 10.0, INK, CENTRED)
        })
        .unwrap();
        write_pair(dir.path(), "figure", &svg).unwrap();
        let mut names: Vec<_> = std::fs::read_dir(dir.path())
            .unwrap()
            .map(|e| e.unwrap().file_name())
            .collect();
        names.sort();
        assert_eq!(names, ["figure.png", "figure.svg"]);
        assert!(write_pair(dir.path(), "broken", "no figure").is_err());
        assert!(!dir.path().join("broken.svg").exists());
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
