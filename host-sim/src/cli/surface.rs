//! `host-sim surface`

use anyhow::Context;
use clap::Args;
use fixed::types::I16F16;
use fuzzypilot::tables::coarse::{self, CoarseSet, SpeedInput};
use fuzzypilot::tables::fine::{self, FineSet};
use host_sim::plot::{Axis, SurfaceSpec, Variable, membership_svg, surface_svg, write_pair};
use host_sim::si;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub struct SurfaceArguments {
    /// Folder for the pictures.
    #[arg(long, value_name = "DIR", default_value = "out/surface")]
    out: PathBuf,
}

pub fn execute(arguments: &SurfaceArguments) -> anyhow::Result<()> {
    let out = &arguments.out;
    super::check_folder(out)?;
    std::fs::create_dir_all(out)
        .with_context(|| format!("{}: cannot be created", out.display()))?;
    for (set, name, title) in [
        (FineSet::Printed, "fine-printed", "Tables 7.1 and 7.2"),
        (
            FineSet::PrintedProse,
            "fine-printed-prose",
            "Tables 7.1 and 7.2 by the prose",
        ),
        (FineSet::Tuned, "fine-tuned", "Tuned fine tables"),
    ] {
        fine_pictures(out, set, name, title)?;
    }
    for (set, name, title) in [
        (
            CoarseSet::Corrected,
            "coarse-corrected",
            "Tables 7.3 (corrected) and 7.4",
        ),
        (
            CoarseSet::Printed,
            "coarse-printed",
            "Tables 7.3 (as printed) and 7.4",
        ),
    ] {
        coarse_pictures(out, set, name, title)?;
    }
    super::print(format_args!("written: {}\n", out.display()))
}

fn axis(name: &str, unit: &str, terms: &[&str], peaks: &[f64], range: (f64, f64)) -> Axis {
    Axis {
        name: name.to_owned(),
        unit: unit.to_owned(),
        terms: terms
            .iter()
            .map(|&t| t.to_owned())
            .zip(peaks.iter().copied())
            .collect(),
        range,
    }
}

/// An output's terms with the peaks that its table's cells conclude.
fn consequents<const R: usize, const C: usize, O>(
    table: &fuzzypilot::fuzzy::RuleTable<R, C, O>,
    names: &[&str],
) -> Vec<(String, f64)>
where
    O: fuzzypilot::fuzzy::FixedOutput + Into<f64>,
{
    let mut found: Vec<(usize, f64)> = (0..R)
        .flat_map(|row| (0..C).map(move |col| (row, col)))
        .map(|(row, col)| {
            let term = usize::from(table.terms()[row][col].0);
            (term, table.peak(row, col).into())
        })
        .collect();
    found.sort_by_key(|(term, _)| *term);
    found.dedup_by_key(|(term, _)| *term);
    found
        .into_iter()
        .map(|(term, peak)| (names.get(term).copied().unwrap_or("?").to_owned(), peak))
        .collect()
}

fn draw(out: &Path, stem: &str, spec: &SurfaceSpec<'_>) -> anyhow::Result<()> {
    let variables = [
        Variable::partition(&spec.rows),
        Variable::partition(&spec.cols),
        Variable::singletons(&spec.output),
    ];
    let memberships = membership_svg(&spec.title, &variables)?;
    write_pair(out, &format!("{stem}-memberships"), &memberships)?;
    write_pair(out, &format!("{stem}-surface"), &surface_svg(spec)?)
}

fn number(x: f64) -> I16F16 {
    si::number(x)
}

fn fine_pictures(out: &Path, set: FineSet, stem: &str, title: &str) -> anyhow::Result<()> {
    let tables = set.tables();
    let phi = tables.antecedents.rows.peaks().map(|p| p.to_num::<f64>());
    let d = tables.antecedents.cols.peaks().map(|p| p.to_num::<f64>());
    let rows = axis("φ", "°", &fine::TERMS, &phi, (0.0, 180.0));
    let cols = axis("d", "axis units", &fine::DISTANCE_TERMS, &d, (0.0, 4.0));
    let speed = Axis {
        name: "v".into(),
        unit: "axis units".into(),
        terms: consequents(&tables.speed, &fine::TERMS),
        range: (0.0, fine::SPEED_AXIS.to_num()),
    };
    draw(
        out,
        &format!("{stem}-speed"),
        &SurfaceSpec {
            title: format!("{title}: speed"),
            note: String::new(),
            rows: rows.clone(),
            cols: cols.clone(),
            output: speed,
            eval: &|phi, d| Some(tables.evaluate(number(d), number(phi)).speed.to_num()),
        },
    )?;
    let deflection = Axis {
        name: "Δφ".into(),
        unit: "°".into(),
        terms: consequents(&tables.deflection, &fine::TERMS),
        range: (0.0, 90.0),
    };
    draw(
        out,
        &format!("{stem}-deflection"),
        &SurfaceSpec {
            title: format!("{title}: deflection"),
            note: String::new(),
            rows,
            cols,
            output: deflection,
            eval: &|phi, d| Some(tables.evaluate(number(d), number(phi)).deflection.to_num()),
        },
    )
}

fn coarse_pictures(out: &Path, set: CoarseSet, stem: &str, title: &str) -> anyhow::Result<()> {
    let tables = set.tables();
    let s = tables.antecedents.rows.peaks().map(|p| p.to_num::<f64>());
    let theta = tables.antecedents.cols.peaks().map(|p| p.to_num::<f64>());
    let rows = axis("s / D", "share", &coarse::DISTANCE_TERMS, &s, (0.0, 1.0));
    let cols = axis("θ", "°", &coarse::ANGLE_TERMS, &theta, (-90.0, 90.0));
    let at = |s: f64, theta: f64, input| tables.evaluate(number(s), number(theta), input);
    let deflection = Axis {
        name: "Δθ".into(),
        unit: "° clockwise".into(),
        terms: consequents(&tables.deflection, &coarse::ANGLE_TERMS),
        range: (-90.0, 90.0),
    };
    draw(
        out,
        &format!("{stem}-deflection"),
        &SurfaceSpec {
            title: format!("{title}: deflection"),
            note: String::new(),
            rows: rows.clone(),
            cols: cols.clone(),
            output: deflection,
            eval: &|s, theta| Some(at(s, theta, SpeedInput::Deflection).deflection.to_num()),
        },
    )?;
    for (input, name, by) in [
        (
            SpeedInput::Deflection,
            "speed",
            "speed, nested over the deflection",
        ),
        (
            SpeedInput::Bearing,
            "speed-by-bearing",
            "speed, read over the bearing",
        ),
    ] {
        let speed = Axis {
            name: "v".into(),
            unit: "share of Vmax".into(),
            terms: consequents(&tables.speed, &coarse::SPEED_TERMS),
            range: (0.0, 1.0),
        };
        draw(
            out,
            &format!("{stem}-{name}"),
            &SurfaceSpec {
                title: format!("{title}: {by}"),
                note: String::new(),
                rows: rows.clone(),
                cols: cols.clone(),
                output: speed,
                eval: &|s, theta| Some(at(s, theta, input).speed.to_num()),
            },
        )?;
    }
    Ok(())
}
