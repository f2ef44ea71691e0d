//! Arguments and commands.

mod bench;
mod bench_tick;
mod errata;
mod eval;
mod fuzzy;
mod hil;
mod list;
mod merge;
mod overwriting;
mod ready;
mod replay_carmen;
mod run;
mod search;
mod surface;
mod sweep;
mod tune;

use anyhow::Context;
use clap::{Args, Parser, Subcommand, ValueEnum};
use host_sim::bench::worlds::error::WorldError;
use host_sim::carmen::log::LogError;
use host_sim::control::{
    AxisName, CoarseName, FineNn, InputName, IntegratorName, LawName, TablesName,
};
use host_sim::fuzzy::files::error::ReadError;
use host_sim::hil::Outage;
pub use host_sim::put::{put, put_all};
use host_sim::run::RunError;
use host_sim::scenario::{PathForm, Scenario, ScenarioError};
use host_sim::track::Piece;
pub use overwriting::{DESIGN, none_of_what_is_read, not_what_is_read, of_worlds};
use ready::{ready_file, ready_folder};
use std::fmt::Display;
use std::io::{ErrorKind, Write};
use std::path::Path;

/// Desktop simulator around fuzzypilot's own tick. Without a command it runs the chapter's Experiment 1.
#[derive(Parser)]
#[command(
    version,
    about,
    max_term_width = 100,
    args_conflicts_with_subcommands = true
)]
pub struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
    #[command(flatten, next_help_heading = "Options without a command")]
    options: run::Options,
}

#[derive(Subcommand)]
enum Command {
    /// Run one scenario and write its summary, ticks, pictures and replay.
    Run(run::RunArguments),
    /// List the built-in scenarios, or print one as the TOML file that it is.
    List(list::ListArguments),
    /// Evaluate a controller at a point, or at many from a CSV file, in fixed point and f64 side by side.
    Eval(eval::EvalArguments),
    /// Draw the membership functions and the control surface of every table.
    Surface(surface::SurfaceArguments),
    /// Run a scenario over many seeds on all cores and print the worst and the mean.
    Sweep(sweep::SweepArguments),
    /// Run a scenario, Experiment 1 by default, with every erratum printed and corrected, and print what each changes.
    Errata(errata::ErrataArguments),
    /// Run a scenario with the tick on a robot: its firmware in QEMU, or a board on a serial port.
    Hil(hil::HilArguments),
    /// Read, check, convert and tune fuzzy systems from design files (FuzzyLite, IEC 61131-7, MATLAB); no robot is needed.
    Fuzzy(fuzzy::FuzzyArguments),
    /// Measure ticks per second of the library alone and of the whole simulation, on one core.
    BenchTick(bench_tick::BenchArguments),
    /// Drive navigators through many worlds with many seeds on all cores, and print how often they arrive.
    Bench(Box<bench::BenchArguments>),
    /// Tune the navigator's settings and rule tables by driving through many worlds.
    Tune(Box<tune::TuneArguments>),
    /// Put the parts of a bench that was run with `--shard` together.
    Merge(merge::MergeArguments),
    /// Feed a real robot's CARMEN log to the navigator, open loop, and draw what it would have done.
    ReplayCarmen(replay_carmen::CarmenArguments),
}

/// Carries out a command line.
pub fn execute(arguments: Arguments) -> anyhow::Result<()> {
    match arguments.command {
        None => run::execute(&run::RunArguments::experiment_1(arguments.options)),
        Some(Command::Run(arguments)) => run::execute(&arguments),
        Some(Command::List(arguments)) => list::execute(&arguments),
        Some(Command::Eval(arguments)) => eval::execute(&arguments),
        Some(Command::Surface(arguments)) => surface::execute(&arguments),
        Some(Command::Sweep(arguments)) => sweep::execute(&arguments),
        Some(Command::Tune(arguments)) => tune::execute(&arguments),
        Some(Command::Errata(arguments)) => errata::execute(&arguments),
        Some(Command::Hil(arguments)) => hil::execute(&arguments),
        Some(Command::Fuzzy(arguments)) => fuzzy::execute(&arguments),
        Some(Command::BenchTick(arguments)) => bench_tick::execute(&arguments),
        Some(Command::Bench(arguments)) => bench::execute(&arguments),
        Some(Command::Merge(arguments)) => merge::execute(&arguments),
        Some(Command::ReplayCarmen(arguments)) => replay_carmen::execute(&arguments),
    }
}

/// Input that the user can mend.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct BadInput(pub String);

/// Told to stop before it was done.
#[derive(Debug, thiserror::Error)]
#[error("interrupted; {0}")]
pub struct Interrupted(pub String);

/// What the program ends with: 2 if the user's input was at fault, 3 if a robot at the other end of a link was.
pub fn exit_code(error: &anyhow::Error) -> u8 {
    match error.downcast_ref::<Outage>() {
        // As a shell has it.
        Some(Outage::Interrupted) => 130,
        Some(_) => 3,
        None if error.is::<Interrupted>() => 130,
        None if error.is::<BadInput>()
            || error.is::<ReadError>()
            || error.is::<ScenarioError>()
            || error.is::<RunError>()
            || error.is::<WorldError>()
            || error.is::<LogError>() =>
        {
            2
        }
        None => 1,
    }
}

/// Odometry of the simulated robot.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Odometry {
    /// Micrometre counts, no slip.
    Exact,
    /// 0.1 % scale error a wheel, 1 % slip in every tick.
    Noisy,
}

/// What may be chosen instead of a scenario's own settings.
#[derive(Args, Clone, Copy, Debug, Default)]
pub struct Variants {
    /// Guidance law.
    #[arg(long, value_enum)]
    law: Option<LawName>,
    /// Fine rule tables.
    #[arg(long, value_enum)]
    tables: Option<TablesName>,
    /// Radius of every arc of the path, m (erratum: Experiment 1 prints 6; only 8 makes its arcs meet).
    #[arg(long, value_parser = number(LEAST_RADIUS, MOST_RADIUS), allow_hyphen_values = true)]
    radius: Option<f64>,
    /// Erratum, Table 7.2 at (d = N, phi = N): the table's N or the prose's B. Printed tables only.
    #[arg(long, value_enum)]
    fine_nn: Option<FineNn>,
    /// Erratum, speed axis: its top is the robot's top speed, or it is m/s as it stands.
    #[arg(long, value_enum)]
    speed_axis: Option<AxisName>,
    /// Erratum, Table 7.3 at (s = N, theta = R): corrected to R, or L as printed.
    #[arg(long = "table-7-3", value_enum)]
    table_7_3: Option<CoarseName>,
    /// Erratum, what Table 7.4 reads: the deflection (equation 7.5) or the bearing (its heading).
    #[arg(long = "table-7-4-input", value_enum)]
    table_7_4_input: Option<InputName>,
    /// Integration rule of plant and odometry: exact arcs, or Euler steps as in equation 7.1.
    #[arg(long, value_enum)]
    integrator: Option<IntegratorName>,
    /// Wheel odometry instead of the scenario's.
    #[arg(long, value_enum)]
    odometry: Option<Odometry>,
}

/// Highest speed cap that the library's navigator takes, m/s: the benchmark's robot has to stop from it within 23 periods.
const MOST_SPEED: f64 = 2.8;

const LEAST_RADIUS: f64 = 0.01;
const MOST_RADIUS: f64 = 1000.0;

/// Reads a number within limits; neither NaN nor infinity is.
pub fn number(least: f64, most: f64) -> impl Fn(&str) -> Result<f64, String> + Clone {
    move |text| match text.parse::<f64>() {
        Ok(x) if x >= least && x <= most => Ok(x),
        _ => Err(format!("allowed is a number from {least} to {most}")),
    }
}

/// Reads a whole number within limits.
pub fn whole(least: u64, most: u64) -> impl Fn(&str) -> Result<u64, String> + Clone {
    move |text| match text.parse::<u64>() {
        Ok(n) if n >= least && n <= most => Ok(n),
        _ => Err(format!("allowed is a whole number from {least} to {most}")),
    }
}

/// Prints to standard output. Whoever reads it may have seen enough (`host-sim list | head -1`).
pub fn print(text: impl Display) -> anyhow::Result<()> {
    let mut out = std::io::stdout().lock();
    match write!(out, "{text}").and_then(|()| out.flush()) {
        Err(e) if e.kind() == ErrorKind::BrokenPipe => Ok(()),
        done => done.context("standard output: cannot be written"),
    }
}

/// Refuses a folder that is a file, or lies under one.
pub fn check_folder(folder: &Path) -> Result<(), BadInput> {
    check_folder_of("--out", folder)
}

/// The same for another option.
pub fn check_folder_of(option: &str, folder: &Path) -> Result<(), BadInput> {
    let above = folder.ancestors().find(|p| p.symlink_metadata().is_ok());
    match above {
        Some(file) if !file.is_dir() => Err(BadInput(format!(
            "{option} {}: {} is a file; allowed is a folder, existing or new",
            folder.display(),
            file.display()
        ))),
        _ => Ok(()),
    }
}

impl Variants {
    /// Puts the choices into a scenario.
    pub fn apply(&self, scenario: &mut Scenario) -> Result<(), BadInput> {
        let control = &mut scenario.control;
        control.law = self.law.unwrap_or(control.law);
        control.tables = self.tables.or(control.tables);
        control.fine_nn = self.fine_nn.unwrap_or(control.fine_nn);
        control.speed_axis = self.speed_axis.unwrap_or(control.speed_axis);
        control.table_7_3 = self.table_7_3.unwrap_or(control.table_7_3);
        control.table_7_4_input = self.table_7_4_input.unwrap_or(control.table_7_4_input);
        control.integrator = self.integrator.or(control.integrator);
        if host_sim::scenario::contradicts(control, scenario.robot.preset) {
            let flag = match self.fine_nn {
                Some(_) => "--fine-nn prose",
                None => "--tables tuned (the scenario has fine-nn = \"prose\")",
            };
            return Err(BadInput(format!(
                "{flag}: the tuned tables have no such erratum; allowed with --tables printed"
            )));
        }
        match self.odometry {
            None => {}
            Some(Odometry::Exact) => {
                scenario.noise.wheel_scale = 0.0;
                scenario.noise.wheel_slip = 0.0;
            }
            Some(Odometry::Noisy) => {
                scenario.noise.wheel_scale = 0.001;
                scenario.noise.wheel_slip = 0.01;
            }
        }
        if let Some(new) = self.radius {
            let PathForm::Pieces(pieces) = &mut scenario.path.form else {
                return Err(BadInput(
                    "--radius: this path has no arcs; allowed with a path that has some".into(),
                ));
            };
            let mut arcs = 0;
            for piece in pieces {
                if let Piece::Arc { radius, .. } = piece {
                    *radius = new;
                    arcs += 1;
                }
            }
            if arcs == 0 {
                return Err(BadInput(
                    "--radius: this path has no arcs; allowed with a path that has some".into(),
                ));
            }
            // With another radius the pieces need not meet any more.
            scenario.path.gaps = true;
        }
        Ok(())
    }
}

/// A scenario by name or file, with variants, accepted by the library too.
pub fn load(name: &str, variants: &Variants) -> anyhow::Result<Scenario> {
    let mut scenario = host_sim::scenario::load(name)?;
    variants.apply(&mut scenario)?;
    host_sim::run::check(&scenario).map_err(|e| BadInput(format!("{name}: {e}")))?;
    Ok(scenario)
}
