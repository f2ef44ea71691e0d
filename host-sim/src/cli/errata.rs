//! `host-sim errata`: what every printed variant does to Experiment 1, measured.

use super::sweep::many;
use super::whole;
use clap::Args;
use comfy_table::{Table, presets::ASCII_MARKDOWN};
use host_sim::params::{AxisName, CoarseName, FineNn, InputName, LawName, TablesName};
use host_sim::scenario::{PathForm, Scenario};
use host_sim::track::Piece;

#[derive(Args)]
pub struct ErrataArguments {
    /// Seeds a variant.
    #[arg(long, default_value_t = 20, value_parser = whole(1, 100_000), allow_hyphen_values = true)]
    seeds: u64,
}

type Change = fn(&mut Scenario);

/// Every variant beside the default: its flag, and what it changes.
const VARIANTS: [(&str, Change); 9] = [
    ("(default)", |_| {}),
    ("--fine-nn prose", |s| s.control.fine_nn = FineNn::Prose),
    ("--speed-axis literal", |s| {
        s.control.speed_axis = AxisName::Literal;
    }),
    ("--table-7-3 printed", |s| {
        s.control.table_7_3 = CoarseName::Printed;
    }),
    ("--table-7-4-input bearing", |s| {
        s.control.table_7_4_input = InputName::Bearing;
    }),
    ("--radius 6", |s| {
        if let PathForm::Pieces(pieces) = &mut s.path.form {
            for piece in pieces {
                if let Piece::Arc { radius, .. } = piece {
                    *radius = 6.0;
                }
            }
        }
    }),
    ("--law paper", |s| s.control.law = LawName::Paper),
    ("--tables tuned", |s| {
        s.control.tables = Some(TablesName::Tuned);
    }),
    ("--law paper --table-7-3 printed", |s| {
        s.control.law = LawName::Paper;
        s.control.table_7_3 = CoarseName::Printed;
    }),
];

pub fn execute(arguments: &ErrataArguments) -> anyhow::Result<()> {
    let base = host_sim::scenario::load("experiment-1")?;
    let mut table = Table::new();
    table.load_style(ASCII_MARKDOWN);
    table.set_header([
        "variant",
        "reached end",
        "collisions",
        "least clearance",
        "RMS free",
        "max free",
        "ticks (mean)",
        "Obs4, Obs5, Obs6 (seed 1)",
    ]);
    for (name, change) in VARIANTS {
        let mut scenario = base.clone();
        change(&mut scenario);
        let all = many(&scenario, arguments.seeds)?;
        let runs = all.len() as f64;
        let least = all
            .iter()
            .filter_map(|s| s.min_clearance_m)
            .fold(f64::INFINITY, f64::min);
        let worst = |of: fn(&host_sim::metrics::Summary) -> Option<f64>| {
            let worst = all.iter().filter_map(of).fold(f64::NEG_INFINITY, f64::max);
            if worst.is_finite() {
                format!("{worst:.3}")
            } else {
                "never on it".to_owned()
            }
        };
        let steps = all.first().map_or_else(String::new, |s| {
            s.avoidances
                .iter()
                .map(|a| format!("{} {} {}", a.obstacle, a.side, a.steps))
                .collect::<Vec<_>>()
                .join(", ")
        });
        table.add_row([
            name.to_owned(),
            format!(
                "{} of {}",
                all.iter().filter(|s| s.reached_end).count(),
                all.len()
            ),
            all.iter().map(|s| s.collisions).sum::<u64>().to_string(),
            format!("{least:.3}"),
            worst(|s| s.cross_track_rms_m),
            worst(|s| s.cross_track_max_m),
            format!(
                "{:.0}",
                all.iter().map(|s| s.ticks as f64).sum::<f64>() / runs
            ),
            steps,
        ]);
    }
    super::print(format_args!("{table}\n"))
}
