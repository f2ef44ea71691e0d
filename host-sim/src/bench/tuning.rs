//! Tuning of the navigator: its settings and the peaks of its rule tables, moved until it drives best.
//!
//! ```text
//! vector ──knobs──▶ settings, tables ──library's checks──▶ campaigns ──loss──▶ CMA-ES ──▶ next vectors
//! ```
//!
//! Candidates are rounded as they are written, so that what is written is what was judged.

mod emit;
mod knobs;
mod loss;

pub use emit::rust;
pub use knobs::{KNOBS, Knob, Tuned};
pub use loss::loss;

use super::attempt::Outcome;
use super::campaign::Campaign;
use super::navigator::Navigator;
use super::ours::Ours;
use super::results::Figures;
use crate::search::Problem;

/// A search for better settings.
pub struct Tuning {
    /// What is driven, each with its name.
    pub campaigns: Vec<(String, Campaign)>,
    /// The settings to start from.
    pub start: Tuned,
    /// What moves.
    pub knobs: Vec<&'static Knob>,
}

impl Tuning {
    /// The settings that a vector stands for: shares of the knobs' ranges away from the start, and how far beyond the
    /// ranges it lies.
    pub fn decode(&self, vector: &[f64]) -> (Tuned, f64) {
        let mut tuned = self.start.clone();
        let mut excess = 0.0;
        for (knob, share) in self.knobs.iter().zip(vector) {
            let meant = knob.get(&self.start) + share * (knob.to - knob.from);
            let value = meant.clamp(knob.from, knob.to);
            excess += (meant - value).abs() / (knob.to - knob.from);
            knob.set(&mut tuned, value);
        }
        (tuned, excess)
    }

    /// What settings make of every campaign; `None` if the library refuses them.
    pub fn drive(&self, tuned: &Tuned) -> Option<Vec<Vec<Outcome>>> {
        tuned.params().check().ok()?;
        let drive = |(_, campaign): &(String, Campaign)| {
            let params = tuned.params();
            let build = |mission: &_| -> Box<dyn Navigator> {
                Box::new(Ours::with(mission, params.clone()))
            };
            let runs = campaign.run_with(&build, &|| {});
            runs.into_iter().map(|run| run.outcome).collect()
        };
        Some(self.campaigns.iter().map(drive).collect())
    }

    /// The mean loss over the campaigns.
    pub fn judge(&self, tuned: &Tuned) -> Option<f64> {
        let driven = self.drive(tuned)?;
        let mean =
            |runs: &Vec<Outcome>| runs.iter().map(loss).sum::<f64>() / runs.len().max(1) as f64;
        Some(driven.iter().map(mean).sum::<f64>() / driven.len().max(1) as f64)
    }

    /// The figures of every campaign; none if the library refuses the settings.
    pub fn figures(&self, tuned: &Tuned) -> Vec<(&str, Figures)> {
        let names = self.campaigns.iter().map(|(name, _)| name.as_str());
        let driven = self.drive(tuned).unwrap_or_default();
        names
            .zip(driven.iter().map(|runs| Figures::of(runs)))
            .collect()
    }
}

impl Problem for Tuning {
    fn dimensions(&self) -> usize {
        self.knobs.len()
    }

    fn cost(&self, vector: &[f64]) -> Option<f64> {
        let (tuned, excess) = self.decode(vector);
        // Beyond the walls the farther is the worse, so that the search comes back.
        Some(self.judge(&tuned)? * (1.0 + excess))
    }
}
