//! `host-sim fuzzy`: fuzzy systems from design files, without a robot.

mod convert;

use clap::{Args, Subcommand, ValueEnum};
use host_sim::fuzzy::files::Format;

#[derive(Args)]
pub struct FuzzyArguments {
    #[command(subcommand)]
    command: Command,
}

#[derive(Subcommand)]
enum Command {
    /// Read a design file and write it in another format.
    Convert(convert::ConvertArguments),
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
    }
}
