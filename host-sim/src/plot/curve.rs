//! The output of a controller with one input.

use super::axis::Axis;
use super::{FROM_LEFT, MUTED, Panel, Point, Rect, WIDTH, document, extent, ticks, viridis};
use anyhow::{Result, ensure};
use plotters::style::Color;

/// Pieces of the line.
const PIECES: usize = 1200;

/// Draws an output over its only input; the line is broken where the output has no value.
///
/// # Errors
/// When an axis has an empty range, or the output is not finite somewhere.
pub fn curve_svg(
    title: &str,
    input: &Axis,
    output: &Axis,
    eval: &dyn Fn(f64) -> Option<f64>,
) -> Result<String> {
    input.check()?;
    output.check()?;
    let mut points = Vec::new();
    for piece in 0..=PIECES {
        let x = input.at(piece as f64 / PIECES as f64);
        let y = eval(x);
        let sound = y.is_none_or(f64::is_finite);
        ensure!(sound, "{} is {y:?} at {x}", output.name);
        points.push((x, y));
    }
    let (low, high) = extent(points.iter().filter_map(|p| p.1)).unwrap_or(output.range);
    // What hardly moves should look like it.
    let least = 0.02 * (output.range.1 - output.range.0);
    let pad = 0.05 * (high - low).max(least) + (least - (high - low)).max(0.0) / 2.0;
    let y = low - pad..high + pad;
    let height = 470.0;
    document(WIDTH, height, |canvas| {
        canvas.heading(title)?;
        let panel = Panel {
            rect: Rect::new(92.0, 60.0, WIDTH - 120.0, height - 122.0),
            x: input.span(),
            x_ticks: input.ticks(12.0),
            y_ticks: ticks(&y, 7.0),
            y,
            x_name: input.label(),
            y_name: output.label(),
            x_numbers: true,
        };
        panel.axes(canvas, true)?;
        for run in points.split(|point| point.1.is_none()) {
            let line: Vec<Point> = run
                .iter()
                .filter_map(|&(x, y)| Some(panel.at(x, y?)))
                .collect();
            canvas.line(&line, 2.2, viridis(0.3).to_rgba())?;
        }
        if points.iter().any(|point| point.1.is_none()) {
            let at = (panel.rect.right - 170.0, panel.rect.bottom + 36.0);
            canvas.text("no line: no value", at, 12.5, MUTED, FROM_LEFT)?;
        }
        panel.frame(canvas)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plot::tests::{axis, sound};

    #[test]
    fn lines_gaps_and_flat_ones_can_be_drawn() {
        let eval: [&dyn Fn(f64) -> Option<f64>; 4] = [
            &|x| Some(x * x),
            &|x| (x > 1.0).then_some(x),
            &|_| Some(3.0),
            &|_| None,
        ];
        let (input, output) = (axis("x", &[], (0.0, 2.0)), axis("y", &[], (0.0, 4.0)));
        for eval in eval {
            let svg = sound(curve_svg("curve", &input, &output, eval).unwrap());
            assert_eq!(svg.contains("no value"), eval(0.5).is_none());
        }
        assert!(curve_svg("", &input, &output, &|_| Some(f64::NAN)).is_err());
    }
}
