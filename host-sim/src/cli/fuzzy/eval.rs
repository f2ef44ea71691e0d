//! `host-sim fuzzy eval`

use super::convert::Route;
use super::design::Design;
use super::named;
use super::put_where_asked;
use super::table::{right, table};
use crate::cli::{BadInput, DESIGN, not_what_is_read, print, whole};
use clap::Args;
use comfy_table::{Cell, Table};
use host_sim::fuzzy::check::{Grid, strength};
use host_sim::fuzzy::describe;
use host_sim::fuzzy::evaluate::{Evaluation, Evaluator, Exact, memberships, rules, taken};
use host_sim::fuzzy::fast::Fast;
use host_sim::fuzzy::model::System;
use rayon::prelude::*;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub struct EvalArguments {
    #[command(flatten)]
    design: super::DesignArguments,
    /// An input's value; one for each input (with --grid, inputs that are given are held).
    #[arg(long = "input", value_name = "NAME=VALUE")]
    inputs: Vec<String>,
    /// Evaluate a grid of N values an input, from end to end of its range.
    #[arg(long, value_name = "N", requires = "csv", value_parser = whole(2, 1_000_000), allow_hyphen_values = true)]
    grid: Option<u64>,
    /// Where the grid's values go: inputs, then outputs in f64 and in fixed point; no value is an empty cell.
    #[arg(long, value_name = "FILE", requires = "grid")]
    csv: Option<PathBuf>,
    /// What stands beside f64: the general fixed point, whose integers are those of C, too, or what a module of `convert --route fast`
    /// computes.
    #[arg(long, value_enum, default_value_t = Route::General)]
    route: Route,
}

/// What stands beside `f64`.
struct Beside<'a> {
    /// `None` without a fixed point.
    evaluator: Option<&'a dyn Evaluator>,
    /// What its columns are called, in tables and in files.
    names: [&'static str; 2],
    /// What can be told apart of each output.
    resolutions: Vec<f64>,
}

/// Lends the design's fixed point or its fast route.
fn beside<R>(design: &Design, fast: Option<&Fast>, use_it: impl FnOnce(Beside<'_>) -> R) -> R {
    let outputs = 0..design.system.outputs.len();
    if let Some(fast) = fast {
        let step = |output| fast.format(output).map_or(0.0, |format| format.value(1));
        return use_it(Beside {
            evaluator: Some(fast),
            names: ["fast route", "fast"],
            resolutions: outputs.map(step).collect(),
        });
    }
    design.opened(|fixed| {
        use_it(Beside {
            evaluator: fixed.as_ref().map(|fixed| fixed as &dyn Evaluator),
            names: ["fixed point", "fixed"],
            resolutions: outputs.map(|output| design.resolution(output)).collect(),
        })
    })
}

/// Most rows of a grid.
const MOST_ROWS: usize = 2_000_000;

pub fn execute(arguments: &EvalArguments) -> anyhow::Result<()> {
    if let Some(file) = &arguments.csv {
        not_what_is_read("--csv", file, &[(DESIGN, &arguments.design.file)])?;
    }
    let design = Design::load(&arguments.design)?;
    let values = named::values(&design.system, "--input", &arguments.inputs)?;
    let fast = design.fast(&arguments.design, arguments.route)?;
    if let (Some(grid), Some(csv)) = (arguments.grid, &arguments.csv) {
        return beside(&design, fast.as_ref(), |beside| {
            surface(&design, &beside, &values, grid as usize, csv)
        });
    }
    let missing: Vec<&str> = design
        .system
        .inputs
        .iter()
        .zip(&values)
        .filter(|(_, value)| value.is_none())
        .map(|(input, _)| input.name.as_str())
        .collect();
    if !missing.is_empty() {
        let what = format!(
            "--input: missing: {}; needed is a value for every input",
            missing.join(", ")
        );
        return Err(BadInput(what).into());
    }
    let point: Vec<f64> = values.into_iter().flatten().collect();
    beside(&design, fast.as_ref(), |beside| {
        at_point(&design, &beside, &point)
    })
}

fn at_point(design: &Design, beside: &Beside<'_>, point: &[f64]) -> anyhow::Result<()> {
    let system = &design.system;
    let exact = Exact::new(system).evaluate(point);
    let fixed = beside.evaluator.map(|fixed| fixed.evaluate(point));
    print(format_args!(
        "{} at {}\n",
        design.title(),
        describe::given_point(system, point)
    ))?;
    print(format_args!("{}\n", inputs(design, point)))?;
    let values: Vec<Option<f64>> = point.iter().copied().map(Some).collect();
    print(outside(system, &values))?;
    print(format_args!(
        "{}\n",
        outputs(design, beside, point, &exact, fixed.as_ref())
    ))?;
    print(format_args!(
        "{}\n",
        fired(design, beside, &exact, fixed.as_ref())
    ))?;
    print(design.note())
}

/// What every input takes, and its terms' degrees.
fn inputs(design: &Design, point: &[f64]) -> Table {
    let system = &design.system;
    let mut table = table(["input", "value", "terms"]);
    let grades = memberships(system, point);
    for ((input, value), grades) in system.inputs.iter().zip(taken(system, point)).zip(&grades) {
        let reached = input
            .terms
            .iter()
            .zip(grades)
            .filter(|(_, grade)| **grade > 0.0);
        let terms: Vec<String> = reached
            .map(|(term, grade)| format!("{} {}", term.name, degree(*grade)))
            .collect();
        let terms = if terms.is_empty() {
            "none".to_owned()
        } else {
            terms.join(", ")
        };
        table.add_row([
            Cell::new(&input.name),
            right(describe::exact(value)),
            Cell::new(terms),
        ]);
    }
    table
}

/// A line for every value that lies outside its input's range.
fn outside(system: &System, values: &[Option<f64>]) -> String {
    let mut text = String::new();
    for (input, value) in system.inputs.iter().zip(values) {
        let Some(x) = value.filter(|x| !input.range.contains(x)) else {
            continue;
        };
        let (start, end) = (*input.range.start(), *input.range.end());
        let what = match input.clamp {
            true => format!("it counts as {}", describe::exact(x.clamp(start, end))),
            false => "the announced error does not hold there".to_owned(),
        };
        let [start, end] = [start, end].map(describe::exact);
        text += &format!("{} lies outside {start} to {end}: {what}\n", input.name);
    }
    text
}

fn outputs(
    design: &Design,
    beside: &Beside<'_>,
    point: &[f64],
    exact: &Evaluation,
    fixed: Option<&Evaluation>,
) -> Table {
    let mut table = table(["output", "f64", beside.names[0], "difference"]);
    let concluded = concluded(&design.system, point);
    for (index, output) in design.system.outputs.iter().enumerate() {
        let resolution = beside.resolutions[index];
        let fires = |of: &Evaluation| strength(&design.system, index, of) > 0.0;
        let why = match fires(exact) {
            true => "the concluded sets meet no sample",
            false => "no rule fires",
        };
        let of = |of: &Evaluation| of.outputs.get(index).copied().flatten();
        let text = |value: f64| describe::number_to(value, resolution);
        let in_f64 = match (of(exact), concluded[index]) {
            (Some(value), true) => text(value),
            (Some(value), false) => format!("{}, the default: {why}", text(value)),
            (None, _) if fires(exact) => format!("no value: {why}"),
            (None, _) => why.to_owned(),
        };
        let in_fixed = match fixed.map(|fixed| (of(fixed), fires(fixed))) {
            None => "–".to_owned(),
            Some((Some(value), true)) => text(value),
            Some((Some(value), false)) => format!("{}, the default", text(value)),
            Some((None, _)) => "no value".to_owned(),
        };
        let difference = match (of(exact), fixed.and_then(of)) {
            (Some(exact), Some(fixed)) => format!("{:+.1e}", fixed - exact),
            _ => "–".to_owned(),
        };
        table.add_row([
            Cell::new(&output.name),
            right(in_f64),
            right(in_fixed),
            right(difference),
        ]);
    }
    table
}

/// Whether each output has a value there without its default.
fn concluded(system: &System, point: &[f64]) -> Vec<bool> {
    let mut system = system.clone();
    for output in &mut system.outputs {
        output.default = None;
    }
    let values = Exact::new(&system).evaluate(point).outputs;
    values.iter().map(Option::is_some).collect()
}

/// Every rule that fires, in `f64` or in fixed point.
fn fired(
    design: &Design,
    beside: &Beside<'_>,
    exact: &Evaluation,
    fixed: Option<&Evaluation>,
) -> Table {
    let mut table = table(["rule", "degree f64", beside.names[0], "reads"]);
    for (index, (_, rule)) in rules(&design.system).enumerate() {
        let of = |evaluation: &Evaluation| evaluation.rules.get(index).copied().unwrap_or(0.0);
        let (exact, fixed) = (of(exact), fixed.map(of));
        if exact > 0.0 || fixed.is_some_and(|degree| degree > 0.0) {
            table.add_row([
                right(index + 1),
                right(degree(exact)),
                right(fixed.map_or("–".to_owned(), degree)),
                Cell::new(describe::rule(&design.system, rule)),
            ]);
        }
    }
    table
}

/// A degree; one that would read as zero by its power of ten.
fn degree(degree: f64) -> String {
    if degree > 0.0 && degree < 0.000_05 {
        format!("{degree:.0e}")
    } else {
        format!("{degree:.4}")
    }
}

fn surface(
    design: &Design,
    beside: &Beside<'_>,
    held: &[Option<f64>],
    each: usize,
    csv: &Path,
) -> anyhow::Result<()> {
    let free = held.iter().filter(|value| value.is_none()).count() as u32;
    let rows = each.checked_pow(free).filter(|rows| *rows <= MOST_ROWS);
    if rows.is_none() {
        return Err(BadInput(format!(
            "--grid {each}: {each} to the power of {free} rows; allowed are {MOST_ROWS} at most"
        ))
        .into());
    }
    let mut grid = Grid::even(&design.system, each);
    for (axis, value) in grid.axes.iter_mut().zip(held) {
        if let Some(value) = value {
            *axis = vec![*value];
        }
    }
    let bytes = table_of(&design.system, beside, &grid)?;
    put_where_asked(&[(csv, &bytes)])?;
    print(format_args!("{}: rows: {}\n", csv.display(), grid.len()))?;
    print(outside(&design.system, held))?;
    print(design.note())
}

fn table_of(system: &System, beside: &Beside<'_>, grid: &Grid) -> anyhow::Result<Vec<u8>> {
    let fixed = beside.evaluator;
    let exact = Exact::new(system);
    let mut writer = csv::Writer::from_writer(Vec::new());
    let inputs = system.inputs.iter().map(|input| input.name.clone());
    let outputs = system.outputs.iter().map(|output| output.name.clone());
    let in_fixed = outputs
        .clone()
        .map(|name| format!("{name} ({})", beside.names[1]));
    let in_fixed = in_fixed.filter(|_| fixed.is_some());
    writer.write_record(inputs.chain(outputs).chain(in_fixed))?;
    let text = |value: Option<f64>| value.map_or(String::new(), |value| value.to_string());
    for first in (0..grid.len()).step_by(8192) {
        // Evaluated on all cores, written in order.
        let rows: Vec<Vec<String>> = (first..(first + 8192).min(grid.len()))
            .into_par_iter()
            .map(|index| {
                let point = grid.point(index);
                let values = exact.evaluate(&point).outputs;
                let fixed = fixed.map(|fixed| fixed.evaluate(&point).outputs);
                let numbers = point.into_iter().map(Some).chain(values);
                numbers
                    .chain(fixed.into_iter().flatten())
                    .map(text)
                    .collect()
            })
            .collect();
        for row in rows {
            writer.write_record(row)?;
        }
    }
    Ok(writer.into_inner()?)
}
