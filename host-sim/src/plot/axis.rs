//! A variable as an axis of a figure.

use super::{ticks, ticks_by};
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
}
