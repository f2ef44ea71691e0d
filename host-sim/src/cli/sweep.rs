//! `host-sim sweep`

use super::{Variants, load, whole};
use clap::Args;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use host_sim::metrics::{Metrics, Summary};
use host_sim::run::{RunError, simulate};
use host_sim::scenario::Scenario;
use rayon::prelude::*;

#[derive(Args)]
pub struct SweepArguments {
    /// Built-in scenarios or TOML files.
    #[arg(required = true)]
    scenarios: Vec<String>,
    #[command(flatten)]
    variants: Variants,
    /// Number of seeds, from 1 up.
    #[arg(long, default_value_t = 100, value_parser = whole(1, 1_000_000), allow_hyphen_values = true)]
    seeds: u64,
}

/// Runs one seed and keeps only the figures.
pub fn once(scenario: &Scenario, seed: u64) -> Result<Summary, RunError> {
    let mut metrics = Metrics::new(scenario, seed);
    let ending = simulate(scenario, seed, &mut |step| metrics.observe(&step))?;
    Ok(metrics.finish(ending))
}

/// Obstacles passed and on which side.
pub fn sides(summary: &Summary) -> Vec<(&str, &str)> {
    summary
        .avoidances
        .iter()
        .map(|a| (a.obstacle.as_str(), a.side))
        .collect()
}

/// Runs seeds 1 to `seeds`; the order, and so the result, does not depend on the number of threads.
pub fn many(scenario: &Scenario, seeds: u64) -> Result<Vec<Summary>, RunError> {
    (1..=seeds)
        .into_par_iter()
        .map(|seed| once(scenario, seed))
        .collect()
}

pub fn execute(arguments: &SweepArguments) -> anyhow::Result<()> {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header([
        "scenario",
        "runs",
        "reached end",
        "collisions",
        "least clearance m",
        "RMS worst m",
        "RMS mean m",
        "max worst m",
        "regained after m",
        "time mean s",
        "avoidances of seed 1",
        "same sides",
    ]);
    let scenarios = arguments
        .scenarios
        .iter()
        .map(|name| load(name, &arguments.variants))
        .collect::<Result<Vec<_>, _>>()?;
    for scenario in &scenarios {
        let all = many(scenario, arguments.seeds)?;
        let worst = |of: fn(&Summary) -> Option<f64>| {
            all.iter().filter_map(of).fold(f64::NEG_INFINITY, f64::max)
        };
        let mean = |of: fn(&Summary) -> Option<f64>| {
            let values: Vec<f64> = all.iter().filter_map(of).collect();
            values.iter().sum::<f64>() / values.len() as f64
        };
        let figure = |x: f64| {
            if x.is_finite() {
                format!("{x:.4}")
            } else {
                "–".to_owned()
            }
        };
        let story = all.first().map_or_else(String::new, |s| {
            s.avoidances
                .iter()
                .map(|a| format!("{} {} {}", a.obstacle, a.side, a.steps))
                .collect::<Vec<_>>()
                .join(", ")
        });
        table.add_row([
            scenario.name.clone(),
            all.len().to_string(),
            all.iter().filter(|s| s.reached_end).count().to_string(),
            all.iter().map(|s| s.collisions).sum::<u64>().to_string(),
            figure(-worst(|s| s.min_clearance_m.map(|c| -c))),
            figure(worst(|s| s.cross_track_rms_m)),
            figure(mean(|s| s.cross_track_rms_m)),
            figure(worst(|s| s.cross_track_max_m)),
            figure(worst(|s| s.first_regained_after_m)),
            figure(mean(|s| Some(s.sim_time_s))),
            story,
            all.iter()
                .filter(|s| all.first().is_some_and(|first| sides(s) == sides(first)))
                .count()
                .to_string(),
        ]);
    }
    super::print(format_args!("{table}\n"))
}
