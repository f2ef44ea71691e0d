//! `host-sim errata`: what every printed variant does to a scenario, measured.

use super::sweep::{many, sides};
use super::{Variants, load, whole};
use clap::Args;
use comfy_table::{Table, presets::ASCII_MARKDOWN};
use host_sim::control::{AxisName, CoarseName, FineNn, InputName, LawName, TablesName};
use host_sim::metrics::Summary;

#[derive(Args)]
pub struct ErrataArguments {
    /// Built-in scenario or TOML file; variants that it has no use for are left out.
    #[arg(default_value = "experiment-1")]
    scenario: String,
    /// Seeds a variant.
    #[arg(long, default_value_t = 20, value_parser = whole(1, 100_000), allow_hyphen_values = true)]
    seeds: u64,
}

/// Every variant beside the default, by its flags.
fn variants() -> Vec<(&'static str, Variants)> {
    let none = Variants::default();
    vec![
        ("(default)", none),
        (
            "--fine-nn prose",
            Variants {
                fine_nn: Some(FineNn::Prose),
                ..none
            },
        ),
        (
            "--speed-axis literal",
            Variants {
                speed_axis: Some(AxisName::Literal),
                ..none
            },
        ),
        (
            "--table-7-3 printed",
            Variants {
                table_7_3: Some(CoarseName::Printed),
                ..none
            },
        ),
        (
            "--table-7-4-input bearing",
            Variants {
                table_7_4_input: Some(InputName::Bearing),
                ..none
            },
        ),
        (
            "--radius 6",
            Variants {
                radius: Some(6.0),
                ..none
            },
        ),
        (
            "--law paper",
            Variants {
                law: Some(LawName::Paper),
                ..none
            },
        ),
        (
            "--tables printed",
            Variants {
                tables: Some(TablesName::Printed),
                ..none
            },
        ),
        (
            "--tables tuned",
            Variants {
                tables: Some(TablesName::Tuned),
                ..none
            },
        ),
    ]
}

pub fn execute(arguments: &ErrataArguments) -> anyhow::Result<()> {
    let base = load(&arguments.scenario, &Variants::default())?;
    let mut table = Table::new();
    table.load_style(ASCII_MARKDOWN);
    table.set_header([
        "variant",
        "reached end",
        "collisions",
        "clearance least / mean",
        "RMS free",
        "max free",
        "ticks",
        "passes of seed 1 (runs that agree)",
    ]);
    for (name, variant) in variants() {
        let mut scenario = base.clone();
        if variant.apply(&mut scenario).is_err() {
            continue;
        }
        let all = many(&scenario, arguments.seeds)?;
        table.add_row(row(name, &all));
    }
    super::print(format_args!("{table}\n"))
}

fn row(name: &str, all: &[Summary]) -> [String; 8] {
    let runs = all.len() as f64;
    let clearances: Vec<f64> = all.iter().filter_map(|s| s.min_clearance_m).collect();
    let clearance = if clearances.is_empty() {
        "–".to_owned()
    } else {
        let least = clearances.iter().copied().fold(f64::INFINITY, f64::min);
        format!(
            "{least:.3} / {:.3}",
            clearances.iter().sum::<f64>() / clearances.len() as f64
        )
    };
    let worst = |of: fn(&Summary) -> Option<f64>| {
        let worst = all.iter().filter_map(of).fold(f64::NEG_INFINITY, f64::max);
        if worst.is_finite() {
            format!("{worst:.3}")
        } else {
            "never on it".to_owned()
        }
    };
    let passes = all.first().map_or_else(String::new, |first| {
        let passes: Vec<String> = first
            .avoidances
            .iter()
            .map(|a| format!("{} {} {}", a.obstacle, a.side, a.steps))
            .collect();
        let agree = all.iter().filter(|s| sides(s) == sides(first)).count();
        format!("{} ({agree})", passes.join(", "))
    });
    [
        name.to_owned(),
        format!(
            "{} of {}",
            all.iter().filter(|s| s.reached_end).count(),
            all.len()
        ),
        all.iter().map(|s| s.collisions).sum::<u64>().to_string(),
        clearance,
        worst(|s| s.cross_track_rms_m),
        worst(|s| s.cross_track_max_m),
        format!(
            "{:.0}",
            all.iter().map(|s| s.ticks as f64).sum::<f64>() / runs
        ),
        passes,
    ]
}
