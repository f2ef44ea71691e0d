//! How near a design comes to data.

use super::Objective;
use super::data::{Data, Row};
use crate::fuzzy::evaluate::Evaluator;
use crate::fuzzy::lower::Lowered;
use crate::fuzzy::model::System;

/// The root of the mean square of what outputs are off, each as a share of its range, over all rows and outputs: of the
/// design in fixed point, as a controller computes it.
pub struct Fit<'a>(pub &'a Data);

/// What one output is off, in its own unit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OutputFit {
    /// Root of the mean square.
    pub rms: f64,
    /// The most.
    pub worst: f64,
}

impl Fit<'_> {
    /// What every output that has data is off.
    pub fn outputs(&self, lowered: &Lowered) -> Vec<OutputFit> {
        let none = || vec![(0.0_f64, 0.0_f64); self.0.outputs.len()];
        let sums = self.fold(lowered, none(), |mut sums, index, error| {
            let sum = &mut sums[index];
            *sum = (sum.0 + error * error, sum.1.max(error.abs()));
            sums
        });
        let count = self.0.rows.len().max(1) as f64;
        sums.into_iter()
            .map(|(squares, worst)| OutputFit {
                rms: (squares / count).sqrt(),
                worst,
            })
            .collect()
    }

    /// Shows every error: the place among [`Data::outputs`], and the value.
    fn fold<R>(&self, lowered: &Lowered, start: R, see: impl Fn(R, usize, f64) -> R) -> R {
        lowered.open(|fixed| {
            self.0.rows.iter().fold(start, |so_far, row: &Row| {
                let found = fixed.evaluate(&row.inputs).outputs;
                let pairs = self.0.outputs.iter().zip(&row.targets).enumerate();
                pairs.fold(so_far, |so_far, (index, (&output, target))| {
                    let value = found.get(output).copied().flatten().unwrap_or(f64::NAN);
                    see(so_far, index, value - target)
                })
            })
        })
    }
}

impl Objective for Fit<'_> {
    fn cost(&self, system: &System, lowered: &Lowered) -> Option<f64> {
        let widths: Vec<f64> = self
            .0
            .outputs
            .iter()
            .filter_map(|&output| system.outputs.get(output))
            .map(|output| output.range.end() - output.range.start())
            .collect();
        let squares = self.fold(lowered, 0.0, |sum, index, error| {
            sum + (error / widths[index]).powi(2)
        });
        let count = self.0.rows.len() * self.0.outputs.len();
        Some((squares / count.max(1) as f64).sqrt()).filter(|cost| cost.is_finite())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fuzzy::lower::lower;
    use crate::fuzzy::sample::fan;

    #[test]
    fn an_error_is_told_as_it_is() {
        let fan = fan();
        let lowered = lower(&fan).unwrap();
        // At 24 °C and 80 % the fan runs at 40 %.
        let row = |target| Row {
            inputs: vec![24.0, 80.0],
            targets: vec![target],
        };
        let data = Data {
            outputs: vec![0],
            rows: vec![row(40.0), row(50.0)],
        };
        let fit = Fit(&data).outputs(&lowered)[0];
        assert!((fit.rms - 50.0_f64.sqrt()).abs() < 1e-3, "{fit:?}");
        assert!((fit.worst - 10.0).abs() < 1e-3, "{fit:?}");
        let cost = Fit(&data).cost(&fan, &lowered).unwrap();
        assert!((cost - fit.rms / 100.0).abs() < 1e-12);
    }
}
