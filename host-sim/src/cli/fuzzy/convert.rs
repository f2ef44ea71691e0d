//! `host-sim fuzzy convert`

use super::From;
use crate::cli::{BadInput, print, put};
use clap::{Args, ValueEnum};
use host_sim::fuzzy::files::{adapt, fcl, fll, load, writing::WriteError};
use host_sim::fuzzy::model::System;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub struct ConvertArguments {
    /// The design file: .fll, .fcl or .fis.
    #[arg(value_name = "IN")]
    file: PathBuf,
    /// What to write.
    #[arg(long, value_enum)]
    to: To,
    /// Where to write it; without it, to standard output.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// The design file's format, whatever its extension says.
    #[arg(long, value_enum)]
    from: Option<From>,
    /// What the target cannot say exactly becomes the nearest that it can say; each change is named.
    #[arg(long)]
    adapt: bool,
}

/// What can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum To {
    /// FuzzyLite.
    Fll,
    /// IEC 61131-7.
    Fcl,
}

impl To {
    fn write(self, system: &System) -> Result<String, WriteError> {
        match self {
            Self::Fll => fll::write(system),
            Self::Fcl => fcl::write(system),
        }
    }

    fn adapt(self, system: &mut System) -> Vec<String> {
        match self {
            Self::Fll => adapt::to_fll(system),
            Self::Fcl => adapt::to_fcl(system),
        }
    }
}

pub fn execute(arguments: &ConvertArguments) -> anyhow::Result<()> {
    let mut system = load(&arguments.file, arguments.from.map(From::format))?;
    if arguments.adapt {
        for change in arguments.to.adapt(&mut system) {
            eprintln!("note: {change}");
        }
    }
    let text = arguments
        .to
        .write(&system)
        .map_err(|error| refused(&arguments.file, &error, arguments.adapt))?;
    match &arguments.out {
        Some(file) => put(file, text.as_bytes()),
        None => print(text),
    }
}

fn refused(file: &Path, error: &WriteError, adapted: bool) -> BadInput {
    let line = match error.place.line {
        0 => String::new(),
        line => format!(":{line}:{}", error.place.column),
    };
    let hint = if error.adaptable && !adapted {
        " (--adapt does that)"
    } else {
        ""
    };
    BadInput(format!("{}{line}: {error}{hint}", file.display()))
}
