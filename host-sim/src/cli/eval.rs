//! `host-sim eval`

use super::{BadInput, print};
use clap::{Args, Subcommand};
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use fixed::types::I16F16;
use fuzzypilot::fuzzy::FiredRule;
use fuzzypilot::tables::coarse::{self, CoarseOutput, CoarseTables};
use fuzzypilot::tables::fine::{self, FineOutput, FineSet, FineTables};
use host_sim::control::{CoarseName, Control, FineNn, InputName, TablesName};
use host_sim::robot::Preset;
use host_sim::scenario::shown;
use host_sim::tables::reference;
use std::fs::File;
use std::io::Read;
use std::path::PathBuf;

#[derive(Args)]
pub struct EvalArguments {
    #[command(subcommand)]
    controller: Controller,
}

#[derive(Subcommand)]
enum Controller {
    /// The fine follower: d on [0, 4], phi in degrees on [0, 180] to v on [0, 3] and deflection in degrees.
    Fine(FineArguments),
    /// The coarse avoider: s in metres, theta in degrees on [-90, 90] (positive: obstacle on the left) to deflection
    /// in degrees (positive: clockwise) and speed as a share of Vmax.
    Coarse(CoarseArguments),
}

#[derive(Args)]
struct FineArguments {
    /// Distance d, axis units.
    #[arg(allow_negative_numbers = true)]
    d: Option<String>,
    /// Angle phi, degrees.
    #[arg(allow_negative_numbers = true)]
    phi: Option<String>,
    /// Evaluate every row of this CSV file (columns d,phi) and print CSV (d,phi,v,dphi).
    #[arg(long, value_name = "FILE", conflicts_with_all = ["d", "phi"])]
    points: Option<PathBuf>,
    /// Which tables.
    #[arg(long, value_enum, default_value = "printed")]
    tables: TablesName,
    /// Erratum of the worked example.
    #[arg(long, value_enum, default_value = "table")]
    fine_nn: FineNn,
}

#[derive(Args)]
struct CoarseArguments {
    /// Distance s from rim to surface, m.
    #[arg(allow_negative_numbers = true)]
    s: Option<String>,
    /// Angle theta, degrees.
    #[arg(allow_negative_numbers = true)]
    theta: Option<String>,
    /// Evaluate every row of this CSV file (columns s,theta) and print CSV (s,theta,dtheta,v).
    #[arg(long, value_name = "FILE", conflicts_with_all = ["s", "theta"])]
    points: Option<PathBuf>,
    /// Detection range D, m: top of the s axis.
    #[arg(long, default_value = "4", allow_hyphen_values = true)]
    range: String,
    /// Erratum of Table 7.3.
    #[arg(long = "table-7-3", value_enum, default_value = "corrected")]
    table_7_3: CoarseName,
    /// Erratum of Table 7.4.
    #[arg(long = "table-7-4-input", value_enum, default_value = "deflection")]
    table_7_4_input: InputName,
}

pub fn execute(arguments: &EvalArguments) -> anyhow::Result<()> {
    match &arguments.controller {
        Controller::Fine(arguments) => fine(arguments),
        Controller::Coarse(arguments) => coarse(arguments),
    }
}

fn fine(arguments: &FineArguments) -> anyhow::Result<()> {
    let control = Control {
        tables: Some(arguments.tables),
        fine_nn: arguments.fine_nn,
        ..Control::default()
    };
    let set = control.fine_set(Preset::Chapter);
    if set == FineSet::Tuned && arguments.fine_nn == FineNn::Prose {
        return Err(BadInput(
            "--fine-nn prose: the tuned tables have no such erratum; allowed with --tables printed"
                .into(),
        )
        .into());
    }
    let tables = set.tables();
    let at = |d: f64, phi: f64| tables.evaluate(fixed(d), fixed(phi));
    if let Some(file) = &arguments.points {
        return many(file, ["d", "phi"], ["d", "phi", "v", "dphi"], |d, phi| {
            let out = at(d, phi);
            [out.speed.to_num(), out.deflection.to_num()]
        });
    }
    let d = number("d", arguments.d.as_deref())?;
    let phi = number("phi", arguments.phi.as_deref())?;
    print_fine(tables, d, phi, &at(d, phi))
}

fn print_fine(tables: &FineTables, d: f64, phi: f64, out: &FineOutput) -> anyhow::Result<()> {
    let peaks = (
        tables.antecedents.rows.peaks().map(|p| p.to_num::<f64>()),
        tables.antecedents.cols.peaks().map(|p| p.to_num::<f64>()),
    );
    let exact = |table: &dyn Fn() -> f64| table();
    print(format_args!("fine controller at d = {d}, φ = {phi}°\n"))?;
    print(format_args!(
        "{}\n",
        outputs(&[
            (
                "v [axis units, 0 to 3]",
                out.speed.to_num(),
                exact(&|| reference(&tables.speed, (&peaks.0, &peaks.1), (phi, d))),
                4
            ),
            (
                "Δφ [°]",
                out.deflection.to_num(),
                exact(&|| reference(&tables.deflection, (&peaks.0, &peaks.1), (phi, d))),
                3
            ),
        ])
    ))?;
    let rules = out.activation.fired();
    print(format_args!(
        "{}\n",
        fired(
            ["φ", "d", "v", "Δφ"],
            &rules,
            &fine::TERMS,
            &fine::DISTANCE_TERMS,
            |rule| {
                let (row, col) = (usize::from(rule.row), usize::from(rule.col));
                [
                    fine::TERMS[usize::from(tables.speed.terms()[row][col].0)],
                    fine::TERMS[usize::from(tables.deflection.terms()[row][col].0)],
                ]
                .to_vec()
            }
        )
    ))
}

fn coarse(arguments: &CoarseArguments) -> anyhow::Result<()> {
    let control = Control {
        table_7_3: arguments.table_7_3,
        table_7_4_input: arguments.table_7_4_input,
        ..Control::default()
    };
    let tables = control.coarse_set().tables();
    let input = control.speed_input();
    let range = number("--range", Some(&arguments.range))?;
    if range <= 0.0 {
        return Err(BadInput(format!(
            "--range: found {range}; allowed is a number above 0"
        ))
        .into());
    }
    let at = |s: f64, theta: f64| tables.evaluate(fixed(s / range), fixed(theta), input);
    if let Some(file) = &arguments.points {
        return many(
            file,
            ["s", "theta"],
            ["s", "theta", "dtheta", "v"],
            |s, theta| {
                let out = at(s, theta);
                [out.deflection.to_num(), out.speed.to_num()]
            },
        );
    }
    let s = number("s", arguments.s.as_deref())?;
    let theta = number("theta", arguments.theta.as_deref())?;
    print_coarse(tables, [s, theta, range], input, &at(s, theta))
}

fn print_coarse(
    tables: &CoarseTables,
    [s, theta, range]: [f64; 3],
    input: coarse::SpeedInput,
    out: &CoarseOutput,
) -> anyhow::Result<()> {
    let peaks = (
        tables.antecedents.rows.peaks().map(|p| p.to_num::<f64>()),
        tables.antecedents.cols.peaks().map(|p| p.to_num::<f64>()),
    );
    let share = s / range;
    let deflection = reference(&tables.deflection, (&peaks.0, &peaks.1), (share, theta));
    let angle = match input {
        coarse::SpeedInput::Deflection => deflection,
        coarse::SpeedInput::Bearing => theta,
    };
    let speed = reference(&tables.speed, (&peaks.0, &peaks.1), (share, angle));
    print(format_args!(
        "coarse controller at s = {s} m of {range} m, θ = {theta}° (positive: obstacle on the left)\n"
    ))?;
    print(format_args!(
        "{}\n",
        outputs(&[
            ("Δθ [°, clockwise]", out.deflection.to_num(), deflection, 3),
            ("v [share of Vmax]", out.speed.to_num(), speed, 4),
        ])
    ))?;
    let (column, names) = match input {
        coarse::SpeedInput::Deflection => ("Δθ", "7.4: v"),
        coarse::SpeedInput::Bearing => ("θ", "7.4: v"),
    };
    let term =
        |terms: &[[fuzzypilot::fuzzy::Term; 3]; 3], rule: &FiredRule, of: [&'static str; 3]| {
            vec![of[usize::from(terms[usize::from(rule.row)][usize::from(rule.col)].0)]]
        };
    print(format_args!(
        "{}\n",
        fired(
            ["s", "θ", "7.3: Δθ"],
            &out.deflection_rules.fired(),
            &coarse::DISTANCE_TERMS,
            &coarse::ANGLE_TERMS,
            |rule| term(tables.deflection.terms(), rule, coarse::ANGLE_TERMS),
        )
    ))?;
    print(format_args!(
        "{}\n",
        fired(
            ["s", column, names],
            &out.speed_rules.fired(),
            &coarse::DISTANCE_TERMS,
            &coarse::ANGLE_TERMS,
            |rule| term(tables.speed.terms(), rule, coarse::SPEED_TERMS),
        )
    ))
}

fn outputs(rows: &[(&str, f64, f64, usize)]) -> Table {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header(["output", "fixed point", "f64", "difference"]);
    for (name, fixed, exact, digits) in rows {
        table.add_row([
            (*name).to_owned(),
            format!("{fixed:.digits$}"),
            format!("{exact:.digits$}"),
            format!("{:+.1e}", fixed - exact),
        ]);
    }
    table
}

fn fired<const K: usize>(
    header: [&str; K],
    rules: &[FiredRule],
    rows: &[&str],
    cols: &[&str],
    conclude: impl Fn(&FiredRule) -> Vec<&'static str>,
) -> Table {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header(header.iter().copied().chain(["degree"]));
    for rule in rules {
        let mut cells = vec![rows[usize::from(rule.row)], cols[usize::from(rule.col)]];
        cells.extend(conclude(rule));
        let mut cells: Vec<String> = cells.into_iter().map(str::to_owned).collect();
        cells.push(format!("{:.3}", f64::from(rule.degree.bits()) / 32_768.0));
        table.add_row(cells);
    }
    table
}

/// The engine's input format; what does not fit saturates, as it does on the robot.
fn fixed(x: f64) -> I16F16 {
    host_sim::si::number(x)
}

fn number(name: &str, text: Option<&str>) -> Result<f64, BadInput> {
    let text =
        text.ok_or_else(|| BadInput(format!("{name}: missing; allowed is a finite number")))?;
    match text.trim().parse::<f64>() {
        Ok(x) if x.is_finite() => Ok(x),
        _ => Err(BadInput(format!(
            "{name}: found `{}`; allowed is a finite number",
            shown(text)
        ))),
    }
}

/// Longest file of points that is read, bytes.
const MAX_FILE: u64 = 64 << 20;

/// Evaluates a file row by row; prints nothing unless every row is good.
fn many(
    file: &std::path::Path,
    inputs: [&str; 2],
    columns: [&str; 4],
    evaluate: impl Fn(f64, f64) -> [f64; 2],
) -> anyhow::Result<()> {
    let name = file.display();
    let bad = |line: u64, what: String| BadInput(format!("{name}:{line}: {what}"));
    let unreadable = |why: String| {
        BadInput(format!(
            "{name}: cannot be read ({why}); allowed is a CSV file with columns {}",
            inputs.join(",")
        ))
    };
    let mut bytes = Vec::new();
    File::open(file)
        .and_then(|file| file.take(MAX_FILE + 1).read_to_end(&mut bytes))
        .map_err(|e| unreadable(e.to_string()))?;
    if bytes.len() as u64 > MAX_FILE {
        return Err(unreadable("it is longer than 64 MiB".to_owned()).into());
    }
    // The reader's own line numbers are off after empty lines and Windows line ends.
    let line_of = |at: Option<&csv::Position>| {
        let is_end = |b: &u8| matches!(b, b'\n' | b'\r');
        let from = at.map_or(0, |at| at.byte() as usize).min(bytes.len());
        let ends = bytes[from..].iter().take_while(|b| is_end(b)).count();
        let before = bytes[..from + ends].iter();
        before.filter(|b| **b == b'\n').count() as u64 + 1
    };
    let mut reader = csv::ReaderBuilder::new()
        .trim(csv::Trim::All)
        .from_reader(&bytes[..]);
    let header = reader
        .headers()
        .map_err(|e| unreadable(e.to_string()))?
        .clone();
    let mut place = [0; 2];
    for (slot, input) in place.iter_mut().zip(inputs) {
        *slot = header.iter().position(|h| h == input).ok_or_else(|| {
            bad(
                1,
                format!(
                    "header: found `{}`; allowed are columns {}",
                    shown(&header.iter().collect::<Vec<_>>().join(",")),
                    inputs.join(",")
                ),
            )
        })?;
    }
    let mut writer = csv::Writer::from_writer(Vec::new());
    writer.write_record(columns)?;
    for row in reader.records() {
        let row = row.map_err(|e| {
            let what = match e.kind() {
                csv::ErrorKind::UnequalLengths {
                    expected_len, len, ..
                } => format!("found fields: {len}; allowed: {expected_len}, as the header has"),
                _ => "found a byte that is not UTF-8; allowed is UTF-8 text".to_owned(),
            };
            bad(line_of(e.position()), format!("row: {what}"))
        })?;
        let mut values = [0.0; 2];
        for ((value, at), input) in values.iter_mut().zip(place).zip(inputs) {
            let text = row.get(at).unwrap_or("");
            *value = text
                .parse::<f64>()
                .ok()
                .filter(|x| x.is_finite())
                .ok_or_else(|| {
                    bad(
                        line_of(row.position()),
                        format!(
                            "{input}: found `{}`; allowed is a finite number",
                            shown(text)
                        ),
                    )
                })?;
        }
        let [a, b] = evaluate(values[0], values[1]);
        let echo = |i: usize| row.get(place[i]).unwrap_or("").to_owned();
        writer.write_record([echo(0), echo(1), a.to_string(), b.to_string()])?;
    }
    print(String::from_utf8(writer.into_inner()?)?)
}
