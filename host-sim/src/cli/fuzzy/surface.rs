//! `host-sim fuzzy surface`

use super::design::Design;
use super::named;
use crate::cli::{BadInput, check_folder, print};
use anyhow::Context;
use clap::Args;
use host_sim::fuzzy::evaluate::{Evaluator, Exact};
use host_sim::fuzzy::picture;
use host_sim::plot::{SurfaceSpec, curve_svg, membership_svg, surface_svg, write_pair};
use host_sim::scenario::shown;
use std::path::PathBuf;

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
    std::fs::create_dir_all(out)
        .with_context(|| format!("{}: cannot be created", out.display()))?;
    let stem = picture::file_name(&design.stem);
    let memberships = membership_svg(&design.title(), &picture::variables(system))?;
    write_pair(out, &format!("{stem}-memberships"), &memberships)?;
    let base: Vec<f64> = system
        .inputs
        .iter()
        .zip(&held)
        .map(|(input, held)| held.unwrap_or_else(|| named::middle(input)))
        .collect();
    let exact = Exact::new(system);
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
        let name = picture::file_name(&output.name);
        // Names that differ only in what a file name cannot hold stay apart.
        let same = system.outputs[..index].iter();
        let same = same
            .filter(|before| picture::file_name(&before.name) == name)
            .count();
        let again = if same > 0 {
            format!("-{}", same + 1)
        } else {
            String::new()
        };
        write_pair(out, &format!("{stem}-{name}{again}"), &svg)?;
    }
    print(format_args!("written: {}\n", out.display()))
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
