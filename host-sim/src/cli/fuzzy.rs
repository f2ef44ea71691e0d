//! `host-sim fuzzy`: fuzzy systems from design files; only tuning may ask for a robot, the simulated one.

mod check;
mod convert;
mod design;
mod eval;
mod named;
mod surface;
pub mod table;
mod tune;

use crate::cli::{BadInput, put_all};
use clap::{Args, Subcommand, ValueEnum};
use host_sim::fuzzy::files::Format;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub struct FuzzyArguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Read a design file and write it in another format.
    Convert(convert::ConvertArguments),
    /// Report gaps, dead rules, unreachable terms, tables that turn, and the error of fixed point.
    Check(check::CheckArguments),
    /// Evaluate at a point, in f64 and in fixed point side by side with every rule that fires, or over a grid into a CSV
    /// file.
    Eval(eval::EvalArguments),
    /// Draw the membership functions, and every output over two inputs.
    Surface(surface::SurfaceArguments),
    /// Fit peaks, widths and consequents to data, or to how the robot drives with them.
    Tune(tune::TuneArguments),
}

/// Which design.
#[derive(Args)]
pub struct DesignArguments {
    /// The design file: .fll, .fcl or .fis.
    #[arg(value_name = "IN")]
    file: PathBuf,
    /// The design file's format, whatever its extension says.
    #[arg(long, value_enum)]
    from: Option<From>,
}

/// A format that design files are read in.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum From {
    /// FuzzyLite.
    Fll,
    /// IEC 61131-7.
    Fcl,
    /// MATLAB and Octave.
    Fis,
}

impl From {
    /// As the readers have it.
    pub fn format(self) -> Format {
        match self {
            Self::Fll => Format::Fll,
            Self::Fcl => Format::Fcl,
            Self::Fis => Format::Fis,
        }
    }
}

pub fn execute(arguments: &FuzzyArguments) -> anyhow::Result<()> {
    match &arguments.command {
        Command::Convert(arguments) => convert::execute(arguments),
        Command::Check(arguments) => check::execute(arguments),
        Command::Eval(arguments) => eval::execute(arguments),
        Command::Surface(arguments) => surface::execute(arguments),
        Command::Tune(arguments) => tune::execute(arguments),
    }
}

/// Writes what was asked for, all or nothing. A place that cannot be written is the user's to mend.
fn put_where_asked(files: &[(&Path, &[u8])]) -> Result<(), BadInput> {
    put_all(files).map_err(|error| BadInput(format!("{error:#}")))
}
