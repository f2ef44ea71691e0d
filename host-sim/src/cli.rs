//! Arguments and commands.

mod bench;
mod errata;
mod eval;
mod list;
mod run;
mod surface;
mod sweep;

use clap::{Args, Parser, Subcommand, ValueEnum};
use host_sim::params::{
    AxisName, CoarseName, FineNn, InputName, IntegratorName, LawName, TablesName,
};
use host_sim::run::RunError;
use host_sim::scenario::{PathForm, Scenario, ScenarioError};
use host_sim::track::Piece;

/// Desktop simulator around fuzzypilot's own tick. Without a command it runs the chapter's Experiment 1.
#[derive(Parser)]
#[command(version, about, max_term_width = 100)]
pub struct Arguments {
    #[command(subcommand)]
    command: Option<Command>,
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
    /// Run Experiment 1 with every erratum printed and corrected, and print what each changes.
    Errata(errata::ErrataArguments),
    /// Measure ticks per second of the library alone and of the whole simulation, on one core.
    BenchTick(bench::BenchArguments),
}

/// Carries out a command line.
pub fn execute(arguments: Arguments) -> anyhow::Result<()> {
    match arguments.command {
        None => run::execute(&run::RunArguments::default()),
        Some(Command::Run(arguments)) => run::execute(&arguments),
        Some(Command::List(arguments)) => list::execute(&arguments),
        Some(Command::Eval(arguments)) => eval::execute(&arguments),
        Some(Command::Surface(arguments)) => surface::execute(&arguments),
        Some(Command::Sweep(arguments)) => sweep::execute(&arguments),
        Some(Command::Errata(arguments)) => errata::execute(&arguments),
        Some(Command::BenchTick(arguments)) => bench::execute(&arguments),
    }
}

/// Input that the user can mend.
#[derive(Debug, thiserror::Error)]
#[error("{0}")]
pub struct BadInput(pub String);

/// Whether the user's input was at fault.
pub fn is_bad_input(error: &anyhow::Error) -> bool {
    error.is::<BadInput>() || error.is::<ScenarioError>() || error.is::<RunError>()
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
    #[arg(long, value_parser = radius)]
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

fn radius(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(r) if r > 0.0 && r <= 1000.0 => Ok(r),
        _ => Err("allowed is a number above 0, at most 1000".to_owned()),
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
        let tuned =
            control.fine_set(scenario.robot.preset) == fuzzypilot::tables::fine::FineSet::Tuned;
        if tuned && control.fine_nn == FineNn::Prose {
            return Err(BadInput(
                "--fine-nn prose: the tuned tables have no such erratum; allowed with --tables printed".into(),
            ));
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
                return Err(BadInput("--radius: this path has no arcs".into()));
            };
            let mut arcs = 0;
            for piece in pieces {
                if let Piece::Arc { radius, .. } = piece {
                    *radius = new;
                    arcs += 1;
                }
            }
            if arcs == 0 {
                return Err(BadInput("--radius: this path has no arcs".into()));
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
    host_sim::run::check(&scenario)?;
    Ok(scenario)
}
