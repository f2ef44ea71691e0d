//! A variable as an axis of a figure.

use super::{decimals, text_width, tick_text, ticks, ticks_by};
use anyhow::{Result, ensure};
use std::ops::Range;

/// A linguistic variable: its name, terms and range.
#[derive(Clone, Debug, PartialEq)]
pub struct Axis {
    /// Name, for example `φ`.
    pub name: String,
    /// Unit, for example `°`; empty for a bare number.
    pub unit: String,
    /// Name and peak of each term that has one, ascending.
    pub terms: Vec<(String, f64)>,
    /// Least and greatest value shown.
    pub range: (f64, f64),
}

impl Axis {
    pub(super) fn check(&self) -> Result<()> {
        let (low, high) = self.range;
        let name = &self.name;
        ensure!(
            low.is_finite() && high.is_finite() && low < high,
            "{name}: {low} to {high} is no range"
        );
        ensure!(
            self.terms.iter().all(|(_, peak)| peak.is_finite()),
            "{name} has a peak that is no number"
        );
        Ok(())
    }

    pub(super) fn span(&self) -> Range<f64> {
        self.range.0..self.range.1
    }

    /// Name and unit.
    pub(super) fn label(&self) -> String {
        if self.unit.is_empty() {
            self.name.clone()
        } else {
            format!("{} [{}]", self.name, self.unit)
        }
    }

    /// The value at a share of the range.
    pub(super) fn at(&self, share: f64) -> f64 {
        self.range.0 + (self.range.1 - self.range.0) * share
    }

    /// About `most` round values in the range.
    pub(super) fn ticks(&self, most: f64) -> Vec<f64> {
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

    /// The same, but fewer where their numbers, written in this size, would touch each other along `room` pixels.
    pub(super) fn ticks_apart(&self, most: f64, room: f64, size: f64) -> Vec<f64> {
        let scale = room / (self.range.1 - self.range.0);
        let mut most = most;
        loop {
            let ticks = self.ticks(most);
            let gaps = ticks.windows(2).map(|pair| scale * (pair[1] - pair[0]));
            let gap = gaps.fold(f64::INFINITY, f64::min);
            if gap >= widest(&ticks, size) + 8.0 || most <= 2.0 {
                return ticks;
            }
            most -= 1.0;
        }
    }
}

/// Pixels of the longest number among ticks.
pub(super) fn widest(ticks: &[f64], size: f64) -> f64 {
    let places = decimals(ticks);
    let widths = ticks
        .iter()
        .map(|&tick| text_width(&tick_text(tick, places), size));
    widths.fold(0.0, f64::max)
}
