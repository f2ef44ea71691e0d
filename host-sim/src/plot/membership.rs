//! The terms of variables: membership functions, singletons, and what has no picture as text.

use super::axis::Axis;
use super::{
    CENTRED, Canvas, FROM_LEFT, FROM_RIGHT, MUTED, Panel, Point, Rect, WIDTH, document, fitted,
    printable, shaded, text_width, viridis,
};
use anyhow::{Result, ensure};
use plotters::style::{Color, RGBColor, WHITE};
use std::ops::Range;

/// A variable and its terms, a panel of the figure.
#[derive(Clone, Debug, PartialEq)]
pub struct Variable {
    /// Name, unit and range; its terms are not looked at.
    pub axis: Axis,
    /// What stands at the side, for example `membership`.
    pub kind: String,
    /// One or more.
    pub terms: Vec<TermCurve>,
}

/// A term by its name and how it is drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct TermCurve {
    /// Name.
    pub name: String,
    /// How it is drawn.
    pub form: Form,
}

/// How a term is drawn.
#[derive(Clone, Debug, PartialEq)]
pub enum Form {
    /// A line through `(x, degree)`, x ascending.
    Line(Vec<(f64, f64)>),
    /// A single value.
    Stem(f64),
    /// Words: it depends on more than this variable.
    Text(String),
}

impl Variable {
    /// An input whose terms are triangles between neighbouring peaks, shoulders at both ends: a Ruspini partition. Its
    /// axis has two peaks or more that ascend, or one.
    pub fn partition(axis: &Axis) -> Self {
        let (low, high) = axis.range;
        let peaks: Vec<f64> = axis.terms.iter().map(|term| term.1).collect();
        let curve = |index: usize, peak: f64| {
            let before = index.checked_sub(1).and_then(|i| peaks.get(i));
            let left = before.map_or((low.min(peak), 1.0), |&foot| (foot, 0.0));
            let right = (peaks.get(index + 1)).map_or((high.max(peak), 1.0), |&foot| (foot, 0.0));
            let mut points = vec![left, (peak, 1.0), right];
            points.dedup();
            points
        };
        let terms = axis
            .terms
            .iter()
            .enumerate()
            .map(|(index, (name, peak))| TermCurve {
                name: name.clone(),
                form: Form::Line(curve(index, *peak)),
            });
        Self {
            terms: terms.collect(),
            kind: "membership".to_owned(),
            axis: axis.clone(),
        }
    }

    /// An output whose terms are numbers.
    pub fn singletons(axis: &Axis) -> Self {
        let terms = axis.terms.iter().map(|(name, peak)| TermCurve {
            name: name.clone(),
            form: Form::Stem(*peak),
        });
        Self {
            terms: terms.collect(),
            kind: "singletons".to_owned(),
            axis: axis.clone(),
        }
    }

    fn check(&self) -> Result<()> {
        self.axis.check()?;
        let name = &self.axis.name;
        ensure!(!self.terms.is_empty(), "{name} has no terms");
        for term in &self.terms {
            let sound = match &term.form {
                Form::Line(points) => {
                    let ascending = points.windows(2).all(|pair| pair[0].0 <= pair[1].0);
                    ascending && points.iter().all(|p| p.0.is_finite() && p.1.is_finite())
                }
                Form::Stem(at) => at.is_finite(),
                Form::Text(_) => true,
            };
            ensure!(
                sound,
                "{name}, {}: its values must ascend and be finite",
                term.name
            );
        }
        Ok(())
    }

    /// Stems at the ends of the range would stand on the frame, and a stem outside would be lost.
    fn span(&self) -> Range<f64> {
        let stems = self.terms.iter().filter_map(|term| match term.form {
            Form::Stem(at) => Some(at),
            Form::Line(_) | Form::Text(_) => None,
        });
        let stems: Vec<f64> = stems.collect();
        if stems.is_empty() {
            return self.axis.span();
        }
        let (low, high) = stems
            .iter()
            .fold(self.axis.range, |(low, high), &x| (low.min(x), high.max(x)));
        let pad = 0.03 * (high - low);
        low - pad..high + pad
    }
}

const LEFT: f64 = 82.0;
/// Room for half of a long number at the end of an axis.
const RIGHT: f64 = 44.0;
const HEIGHT: f64 = 168.0;
/// From one panel to the next, and down to the first.
const PITCH: f64 = HEIGHT + 104.0;
const FIRST: f64 = 96.0;
/// Of names, and from one row of them to the next.
const SIZE: f64 = 13.5;
const ROW: f64 = 16.0;
/// Rows of names that there is room for over every panel; more of them push it down.
const ROWS: usize = 2;
/// The longest line of names.
const LINE: f64 = 380.0;

/// Draws variables below one another.
///
/// # Errors
/// When a variable has an empty range, no terms, or a term whose values do not ascend or are no numbers.
pub fn membership_svg(title: &str, variables: &[Variable]) -> Result<String> {
    for variable in variables {
        variable.check()?;
    }
    let width = WIDTH - RIGHT - LEFT;
    let mut top = FIRST;
    let mut rects = Vec::new();
    for variable in variables {
        top += ROW * more_rows(variable, width) as f64;
        rects.push(Rect::new(LEFT, top, width, HEIGHT));
        top += PITCH;
    }
    let height = top.max(FIRST + PITCH) - 44.0;
    document(WIDTH, height, |canvas| {
        canvas.heading(title)?;
        for (variable, rect) in variables.iter().zip(rects) {
            draw(canvas, variable, rect)?;
        }
        Ok(())
    })
}

/// Rows of names for which there is no room over a panel.
fn more_rows(variable: &Variable, width: f64) -> usize {
    let panel = panel(variable, Rect::new(LEFT, 0.0, width, HEIGHT));
    let labels = labels(variable, &panel);
    let rows = labels.iter().map(|label| label.row + 1).max();
    rows.unwrap_or(0).saturating_sub(ROWS)
}

fn panel(variable: &Variable, rect: Rect) -> Panel {
    Panel {
        rect,
        x: variable.span(),
        y: 0.0..1.08,
        x_ticks: variable.axis.ticks_apart(12.0, rect.width(), 12.5),
        y_ticks: vec![0.0, 0.5, 1.0],
        x_name: variable.axis.label(),
        y_name: variable.kind.clone(),
        x_numbers: true,
    }
}

fn draw(canvas: &Canvas, variable: &Variable, rect: Rect) -> Result<()> {
    let panel = panel(variable, rect);
    panel.axes(canvas, true)?;
    let count = variable.terms.len();
    for (index, term) in variable.terms.iter().enumerate() {
        let colour = colour(index, count);
        match &term.form {
            Form::Line(points) => line(canvas, points, colour, &panel)?,
            Form::Stem(at) => {
                canvas.line(
                    &[panel.at(*at, 0.0), panel.at(*at, 1.0)],
                    2.4,
                    colour.to_rgba(),
                )?;
                canvas.disc(panel.at(*at, 1.0), 5.0, colour.to_rgba())?;
            }
            Form::Text(_) => {}
        }
    }
    texts(canvas, variable, &panel)?;
    panel.frame(canvas)?;
    names(canvas, variable, &panel)
}

/// Terms that are words, on lines of their own over what is drawn.
fn texts(canvas: &Canvas, variable: &Variable, panel: &Panel) -> Result<()> {
    let count = variable.terms.len();
    let words = variable.terms.iter().enumerate();
    let words = words.filter_map(|(index, term)| match &term.form {
        Form::Text(text) => Some((format!("{}: {text}", term.name), colour(index, count))),
        Form::Line(_) | Form::Stem(_) => None,
    });
    let stems = variable.terms.iter().filter_map(|term| match term.form {
        Form::Stem(at) => Some(panel.at(at, 0.0).0),
        Form::Line(_) | Form::Text(_) => None,
    });
    let stems: Vec<f64> = stems.collect();
    for (place, (text, colour)) in words.enumerate() {
        // Six lines fill the panel; what a seventh term says is told by the file.
        let text = match place {
            0..=5 => fitted(&text, 14.0, panel.rect.width() - 40.0),
            6 => "…".to_owned(),
            _ => break,
        };
        let width = text_width(&text, 14.0);
        let left = free(&stems, panel.rect.left + 18.0, width, panel.rect.right);
        let at = (left, panel.rect.top + 26.0 + 22.0 * place as f64);
        let behind = Rect::new(left - 5.0, at.1 - 10.0, width + 10.0, 20.0);
        canvas.block(&behind, WHITE.to_rgba())?;
        canvas.text(&text, at, 14.0, colour, FROM_LEFT)?;
    }
    Ok(())
}

/// Where something of this width stands clear of all stems, from the left; at the left if nowhere.
fn free(stems: &[f64], left: f64, width: f64, right: f64) -> f64 {
    let clear = |from: f64| {
        let (first, last) = (from - 12.0, from + width + 12.0);
        !stems.iter().any(|x| (first..=last).contains(x))
    };
    (0..)
        .map(|step| left + 20.0 * f64::from(step))
        .take_while(|from| from + width < right)
        .find(|from| clear(*from))
        .unwrap_or(left)
}

fn colour(index: usize, count: usize) -> RGBColor {
    // Viridis' yellow end is too light for a line on white.
    shaded(
        viridis(0.82 * index as f64 / (count - 1).max(1) as f64),
        0.85,
    )
}

fn line(canvas: &Canvas, points: &[(f64, f64)], colour: RGBColor, panel: &Panel) -> Result<()> {
    let top: Vec<Point> = points.iter().map(|&(x, y)| panel.at(x, y)).collect();
    let foot = |point: Option<&(f64, f64)>| point.map(|&(x, _)| panel.at(x, 0.0));
    // Pieces side by side: the area below a membership function need not be convex.
    for pair in points.windows(2) {
        let piece: Vec<Point> = [foot(pair.first()), foot(pair.last())]
            .into_iter()
            .flatten()
            .chain([
                panel.at(pair[1].0, pair[1].1),
                panel.at(pair[0].0, pair[0].1),
            ])
            .collect();
        canvas.polygon(&panel.rect.clip(&piece), colour.mix(0.13))?;
    }
    // In runs of what lies inside, so that joints are round.
    let mut run: Vec<Point> = Vec::new();
    for (pair, ends) in top.windows(2).zip(points.windows(2)) {
        // Where there is nothing of a term the axis shows.
        let some = ends[0].1 > 0.0 || ends[1].1 > 0.0;
        match panel.rect.clip_line(pair[0], pair[1]).filter(|_| some) {
            Some((from, to)) => {
                if run.last() != Some(&from) {
                    canvas.line(&run, 2.0, colour.to_rgba())?;
                    run = vec![from];
                }
                run.push(to);
            }
            None => {
                canvas.line(&run, 2.0, colour.to_rgba())?;
                run.clear();
            }
        }
    }
    canvas.line(&run, 2.0, colour.to_rgba())
}

/// Where a term's name belongs: over the middle of where it is highest within what is shown.
fn place(form: &Form, shown: &Range<f64>) -> Option<f64> {
    match form {
        Form::Stem(at) => Some(*at),
        Form::Text(_) => None,
        Form::Line(points) => {
            let inside = |p: &&(f64, f64)| p.0 >= shown.start && p.0 <= shown.end;
            let highest = points
                .iter()
                .filter(inside)
                .map(|p| p.1)
                .fold(0.0, f64::max);
            let mut top = points
                .iter()
                .filter(inside)
                .filter(|p| p.1 >= highest - 1e-6);
            let first = top.next()?.0;
            let last = top.next_back().map_or(first, |p| p.0);
            (highest > 0.0).then_some((first + last) / 2.0)
        }
    }
}

/// A line of names over a panel: what it says, around which x, in which row from below, in whose colour.
struct Label {
    text: String,
    centre: f64,
    row: usize,
    term: usize,
}

/// The names of terms over their places, in a second row where neighbours would touch. Those at one place stand together, in
/// the first one's colour, in as many lines as they take.
fn labels(variable: &Variable, panel: &Panel) -> Vec<Label> {
    let mut places: Vec<(f64, usize)> = variable
        .terms
        .iter()
        .enumerate()
        .filter_map(|(index, term)| Some((place(&term.form, &panel.x)?, index)))
        .collect();
    places.sort_by(|a, b| a.0.total_cmp(&b.0));
    let same = |a: &(f64, usize), b: &(f64, usize)| {
        (panel.at(a.0, 1.0).0 - panel.at(b.0, 1.0).0).abs() < 1.0
    };
    let inside = |x: &f64| (panel.rect.left - 1.0..=panel.rect.right + 1.0).contains(x);
    let blocks = places.chunk_by(same).map(|together| {
        let (at, term) = together[0];
        let names = together.iter();
        let names = names.map(|&(_, index)| cut(&variable.terms[index].name, SIZE, 120.0));
        (panel.at(at, 1.0).0, term, lines(names))
    });
    let blocks: Vec<(f64, usize, Vec<String>)> = blocks.filter(|(x, ..)| inside(x)).collect();
    // Over a block of several lines its neighbours have as many rows as elsewhere.
    let tallest = blocks.iter().map(|(.., lines)| lines.len()).max();
    let starts = match tallest {
        Some(lines) if lines > 1 => lines + ROWS,
        _ => ROWS,
    };
    let mut labels = Vec::new();
    // How far each row is written.
    let mut ends: Vec<f64> = Vec::new();
    for (x, term, lines) in blocks {
        let widths = lines.iter().map(|line| text_width(line, SIZE));
        let width = widths.fold(0.0, f64::max);
        let from = (x - width / 2.0)
            .min(panel.rect.right + 18.0 - width)
            .max(8.0);
        let end = |row: usize| ends.get(row).copied().unwrap_or(f64::NEG_INFINITY);
        let fits = |&row: &usize| (row..row + lines.len()).all(|row| from > end(row) + 5.0);
        // A name without room is left out rather than printed over its neighbour.
        let Some(row) = (0..starts).find(fits) else {
            continue;
        };
        ends.resize(ends.len().max(row + lines.len()), f64::NEG_INFINITY);
        ends[row..row + lines.len()].fill(from + width);
        for (above, text) in lines.into_iter().rev().enumerate() {
            labels.push(Label {
                text,
                centre: from + width / 2.0,
                row: row + above,
                term,
            });
        }
    }
    labels
}

/// A name, cut in the middle if it is too wide: names that share a beginning often end differently.
fn cut(name: &str, size: f64, width: f64) -> String {
    let clean: Vec<char> = printable(name).chars().collect();
    let kept = |count: usize| -> String {
        let head = clean.iter().take(count.div_ceil(2));
        let tail = clean.iter().skip(clean.len() - count / 2);
        head.chain(['…'].iter()).chain(tail).collect()
    };
    let whole: String = clean.iter().collect();
    if text_width(&whole, size) <= width {
        return whole;
    }
    let mut counts = (0..clean.len()).rev().map(kept);
    counts
        .find(|text| text_width(text, size) <= width)
        .unwrap_or_default()
}

/// Names in lines, commas between them.
fn lines(names: impl Iterator<Item = String>) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for name in names {
        match lines.last_mut() {
            None => lines.push(name),
            Some(line) => {
                line.push(',');
                let longer = format!("{line} {name}");
                match text_width(&longer, SIZE) <= LINE {
                    true => *line = longer,
                    false => lines.push(name),
                }
            }
        }
    }
    lines
}

/// Writes the names, and under the axis those of terms that have no place in it.
fn names(canvas: &Canvas, variable: &Variable, panel: &Panel) -> Result<()> {
    let count = variable.terms.len();
    for label in labels(variable, panel) {
        let up = 12.0 + ROW * label.row as f64;
        let at = (label.centre, panel.rect.top - up);
        canvas.text(&label.text, at, SIZE, colour(label.term, count), CENTRED)?;
    }
    let nowhere = |term: &&TermCurve| {
        !matches!(term.form, Form::Text(_)) && place(&term.form, &panel.x).is_none()
    };
    let nowhere = variable.terms.iter().filter(nowhere);
    let nowhere: Vec<&str> = nowhere.map(|term| term.name.as_str()).collect();
    if !nowhere.is_empty() {
        let text = format!("out of this range: {}", nowhere.join(", "));
        let text = fitted(&text, 12.5, panel.rect.width() / 2.5);
        let at = (panel.rect.right, panel.rect.bottom + 36.0);
        canvas.text(&text, at, 12.5, MUTED, FROM_RIGHT)?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::tests::{axis, sound};

    fn variables() -> Vec<Variable> {
        vec![
            Variable::partition(&axis(
                "φ",
                &[("ahead", 0.0), ("abeam", 90.0), ("behind", 180.0)],
                (-10.0, 190.0),
            )),
            Variable::singletons(&axis(
                "deflection",
                &[("none", 0.0), ("hard", 120.0)],
                (0.0, 90.0),
            )),
        ]
    }

    fn drawn(variables: &[Variable]) -> String {
        sound(membership_svg("Terms <all>", variables).unwrap())
    }

    #[test]
    fn every_term_is_named() {
        let mut variables = variables();
        variables[1].terms.push(TermCurve {
            name: "more".to_owned(),
            form: Form::Text("0.5·φ + 1".to_owned()),
        });
        let svg = drawn(&variables);
        for text in [
            "Terms &lt;all&gt;",
            "ahead",
            "abeam",
            "behind",
            "none",
            "hard",
            "more: 0.5·φ + 1",
        ] {
            assert!(svg.contains(text), "{text}");
        }
    }

    #[test]
    fn terms_at_one_place_are_named_together() {
        let mut variables = variables();
        for name in ["beside", "across"] {
            let mut twin = variables[0].terms[1].clone();
            twin.name = name.to_owned();
            variables[0].terms.push(twin);
        }
        assert!(drawn(&variables).contains("abeam, beside, across"));
    }

    #[test]
    fn many_names_at_one_place_stay_inside_the_picture() {
        let mut variables = variables();
        variables[1].terms = (1..=12)
            .map(|i| TermCurve {
                name: format!("rather long {i}"),
                form: Form::Stem(30.0),
            })
            .collect();
        let svg = drawn(&variables);
        for i in 1..=12 {
            assert!(svg.contains(&format!("rather long {i}")), "{i}");
        }
        let panel = panel(&variables[1], Rect::new(LEFT, 0.0, 500.0, HEIGHT));
        let labels = labels(&variables[1], &panel);
        let rows: Vec<usize> = labels.iter().map(|label| label.row).collect();
        assert_eq!(rows, (0..labels.len()).collect::<Vec<_>>());
        for label in &labels {
            let half = text_width(&label.text, SIZE) / 2.0;
            let inside = label.centre - half >= 0.0 && label.centre + half <= WIDTH;
            assert!(inside && half <= LINE / 2.0, "{}", label.text);
        }
        // The panel makes room for them, and the one above it stays where it is.
        let height = |svg: &str| -> f64 {
            let (_, rest) = svg.split_once("height=\"").unwrap();
            rest.split_once('"').unwrap().0.parse().unwrap()
        };
        let few = height(&drawn(&self::variables()));
        assert_eq!(height(&svg), few + ROW * (labels.len() - ROWS) as f64);
    }

    #[test]
    fn neighbours_of_many_names_are_named_above_them() {
        let names = [
            "rather_long_1",
            "rather_long_2",
            "rather_long_3",
            "rather_long_4",
            "rather_long_5",
        ];
        let mut variables = variables();
        let stem = |name: &str, at| TermCurve {
            name: name.to_owned(),
            form: Form::Stem(at),
        };
        variables[1].axis.range = (0.0, 10.0);
        for neighbour in [4.6, 3.4] {
            variables[1].terms = names.iter().map(|name| stem(name, 4.0)).collect();
            variables[1].terms.push(stem("mild", neighbour));
            let svg = drawn(&variables);
            for name in names.iter().chain(&["mild"]) {
                assert!(svg.contains(name), "{name} beside {neighbour}");
            }
        }
    }

    #[test]
    fn long_names_keep_both_ends() {
        let long = |i: usize| format!("quite_a_long_name_of_a_term_{i}");
        let [a, b] = [11, 12].map(|i| cut(&long(i), SIZE, 120.0));
        assert!(
            a != b && a.starts_with("quite_") && b.ends_with("_12"),
            "{a} {b}"
        );
        assert!(text_width(&a, SIZE) <= 120.0);
        assert_eq!(cut("mild", SIZE, 120.0), "mild");
    }

    #[test]
    fn a_partition_crosses_at_one_half_and_holds_to_the_ends() {
        let lines: Vec<Form> = variables()[0]
            .terms
            .iter()
            .map(|term| term.form.clone())
            .collect();
        assert_eq!(
            lines[0],
            Form::Line(vec![(-10.0, 1.0), (0.0, 1.0), (90.0, 0.0)])
        );
        assert_eq!(
            lines[1],
            Form::Line(vec![(0.0, 0.0), (90.0, 1.0), (180.0, 0.0)])
        );
        assert_eq!(
            lines[2],
            Form::Line(vec![(90.0, 0.0), (180.0, 1.0), (190.0, 1.0)])
        );
    }

    #[test]
    fn odd_variables() {
        let mut odd = variables();
        odd[0].axis.range = (185.0, 2000.0);
        assert!(drawn(&odd).contains("out of this range: ahead, abeam"));
        odd[0].terms.clear();
        assert!(membership_svg("", &odd).is_err());
        let mut odd = variables();
        odd[0].terms[0].form = Form::Line(vec![(1.0, 0.0), (0.0, 1.0)]);
        assert!(membership_svg("", &odd).is_err());
        let mut odd = variables();
        odd[1].terms[0].form = Form::Stem(f64::NAN);
        assert!(membership_svg("", &odd).is_err());
    }
}
