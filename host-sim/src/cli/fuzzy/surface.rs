//! `host-sim fuzzy surface`

use super::design::Design;
use super::named;
use crate::cli::{BadInput, DESIGN, check_folder, not_what_is_read, print, put_all};
use anyhow::Context;
use clap::Args;
use host_sim::fuzzy::evaluate::{Evaluator, Exact};
use host_sim::fuzzy::picture;
use host_sim::plot::{SurfaceSpec, curve_svg, membership_svg, pair, surface_svg};
use host_sim::scenario::shown;
use std::collections::HashSet;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub struct SurfaceArguments {
    #[command(flatten)]
    design: super::DesignArguments,
    /// Folder for the pictures.
    #[arg(long, value_name = "DIR", default_value = "out/fuzzy")]
    out: PathBuf,
    /// The two inputs to draw over, across first; without it, the first two.
    #[arg(long, value_name = "NAME,NAME")]
    axes: Option<String>,
    /// The value of an input that is not drawn over; without it, the middle of its range.
    #[arg(long, value_name = "NAME=VALUE")]
    hold: Vec<String>,
}

/// Names the picture of all terms, where an output's has its name.
const MEMBERSHIPS: &str = "memberships";

pub fn execute(arguments: &SurfaceArguments) -> anyhow::Result<()> {
    let design = Design::load(&arguments.design)?;
    let system = &design.system;
    let axes = axes(&design, arguments.axes.as_deref())?;
    let held = named::values(system, "--hold", &arguments.hold)?;
    for &axis in &axes {
        if held[axis].is_some() {
            let name = &system.inputs[axis].name;
            let what = format!(
                "--hold {}: is drawn over; allowed are the inputs that are not",
                shown(name)
            );
            return Err(BadInput(what).into());
        }
    }
    let out = &arguments.out;
    check_folder(out)?;
    let stem = picture::file_name(&design.stem);
    let memberships = membership_svg(&design.title(), &picture::variables(system))?;
    let mut files = Vec::from(pair(&format!("{stem}-{MEMBERSHIPS}"), &memberships)?);
    let base: Vec<f64> = system
        .inputs
        .iter()
        .zip(&held)
        .map(|(input, held)| held.unwrap_or_else(|| named::middle(input)))
        .collect();
    let exact = Exact::new(system);
    let mut taken = HashSet::from([MEMBERSHIPS.to_owned()]);
    for (index, output) in system.outputs.iter().enumerate() {
        let value = |free: &[(usize, f64)]| {
            let mut point = base.clone();
            for &(axis, x) in free {
                point[axis] = x;
            }
            exact.evaluate(&point).outputs.get(index).copied().flatten()
        };
        let title = format!("{}: {}", design.title(), output.name);
        let shown = picture::output_axis(output);
        let svg = match axes[..] {
            [across, up] => surface_svg(&SurfaceSpec {
                title,
                note: picture::held(system, &base, &axes),
                rows: picture::input_axis(&system.inputs[up]),
                cols: picture::input_axis(&system.inputs[across]),
                output: shown,
                eval: &|row, col| value(&[(across, col), (up, row)]),
            })?,
            _ => {
                let input = picture::input_axis(&system.inputs[0]);
                curve_svg(&title, &input, &shown, &|x| value(&[(0, x)]))?
            }
        };
        let name = free(&picture::file_name(&output.name), &mut taken);
        files.extend(pair(&format!("{stem}-{name}"), &svg)?);
    }
    for (name, _) in &files {
        let read = [(DESIGN, arguments.design.file.as_path())];
        not_what_is_read("--out", &out.join(name), &read)?;
    }
    std::fs::create_dir_all(out)
        .with_context(|| format!("{}: cannot be created", out.display()))?;
    let files: Vec<_> = files
        .iter()
        .map(|(name, bytes)| (out.join(name), bytes))
        .collect();
    let files: Vec<(&Path, &[u8])> = files
        .iter()
        .map(|(file, bytes)| (file.as_path(), bytes.as_slice()))
        .collect();
    put_all(&files)?;
    print(format_args!("written: {}\n", out.display()))
}

/// The name, or the first with a number behind it that no picture has yet: some file systems hold `Out` and `out` for one.
fn free(name: &str, taken: &mut HashSet<String>) -> String {
    let numbered = (2..).map(|number| format!("{name}-{number}"));
    let mut names = std::iter::once(name.to_owned()).chain(numbered);
    names
        .find(|name| taken.insert(name.to_lowercase()))
        .unwrap_or_else(|| name.to_owned())
}

/// The inputs to draw over: two, or the only one.
fn axes(design: &Design, text: Option<&str>) -> Result<Vec<usize>, BadInput> {
    let system = &design.system;
    let Some(text) = text else {
        return Ok((0..system.inputs.len().min(2)).collect());
    };
    let bad = |what: &str| BadInput(format!("--axes {}: {what}", shown(text)));
    let names: Vec<&str> = text.split(',').map(str::trim).collect();
    let [across, up] = names[..] else {
        return Err(bad("allowed are two inputs, NAME,NAME"));
    };
    let axes = [across, up].map(|name| named::input(system, "--axes", name));
    let [across, up] = axes;
    let (across, up) = (across?, up?);
    if across == up {
        return Err(bad("the same input twice; allowed are two different ones"));
    }
    Ok(vec![across, up])
}
