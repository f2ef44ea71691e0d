//! `host-sim fuzzy convert`

use super::{From, put_where_asked};
use crate::cli::{BadInput, DESIGN, check_folder, not_what_is_read, print};
use anyhow::Context;
use clap::{Args, ValueEnum};
use host_sim::fuzzy::check::bounds;
use host_sim::fuzzy::emit::{self, Design, RuleBase, rust};
use host_sim::fuzzy::files::{adapt, fcl, fll, load, writing::WriteError};
use host_sim::fuzzy::lower::{Lowered, lower};
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
    /// Where to write it; without it, to standard output. C are two files: NAME.c, with NAME.h beside it (either name will do), or a
    /// folder for both.
    #[arg(long, value_name = "FILE")]
    out: Option<PathBuf>,
    /// The design file's format, whatever its extension says.
    #[arg(long, value_enum)]
    from: Option<From>,
    /// What the target cannot say exactly becomes the nearest that it can say; each change is named. For fll and fcl.
    #[arg(long)]
    adapt: bool,
    /// Which part of the library evaluates a Rust module; general, unless it is said.
    #[arg(long, value_enum)]
    route: Option<Route>,
    /// What the Rust module or the C files call the controller; without it, the design's name, or its file's.
    #[arg(long)]
    name: Option<String>,
}

/// What can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum To {
    /// FuzzyLite.
    Fll,
    /// IEC 61131-7.
    Fcl,
    /// A const module for the library.
    Rust,
    /// A C99 header and source that need nothing else.
    C,
}

/// Which part of the library evaluates a design as a Rust module.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Route {
    /// Any design: every rule in every evaluation; the same integers as in C and as the simulator's fixed point.
    General,
    /// Two inputs divided between peaks, a complete table of constants: four rules an evaluation, quicker; integers and formats of its
    /// own.
    Fast,
    /// The fast one where the design is what it takes, else the general one.
    Auto,
}

impl Route {
    fn route(self) -> rust::Route {
        match self {
            Self::Auto => rust::Route::Auto,
            Self::Fast => rust::Route::Fast,
            Self::General => rust::Route::General,
        }
    }
}

pub fn execute(arguments: &ConvertArguments) -> anyhow::Result<()> {
    check(arguments)?;
    let system = load(&arguments.file, arguments.from.map(From::format))?;
    match arguments.to {
        To::Fll => design(arguments, system, adapt::to_fll, fll::write),
        To::Fcl => design(arguments, system, adapt::to_fcl, fcl::write),
        To::Rust | To::C => code(arguments, &system),
    }
}

/// Refuses what does not go together.
fn check(arguments: &ConvertArguments) -> Result<(), BadInput> {
    let refused = |what: &str, with: &str| {
        Err(BadInput(format!(
            "{what} is of no use here; allowed with {with}"
        )))
    };
    let is_code = matches!(arguments.to, To::Rust | To::C);
    if arguments.route.is_some() && arguments.to != To::Rust {
        return refused("--route", "--to rust");
    }
    if arguments.name.is_some() && !is_code {
        return refused("--name", "--to rust or --to c");
    }
    if arguments.adapt && is_code {
        return refused("--adapt", "--to fll or --to fcl");
    }
    if arguments
        .name
        .as_deref()
        .is_some_and(|name| name.trim().is_empty())
    {
        return Err(BadInput(
            "--name: found nothing; allowed is a name with a letter or a digit".into(),
        ));
    }
    match &arguments.out {
        None if arguments.to == To::C => Err(BadInput(
            "--to c writes two files; --out says where: NAME.c, or a folder for both".into(),
        )),
        Some(out) if arguments.to != To::C && is_folder(out) => Err(BadInput(format!(
            "--out {}: is a folder; --to {} writes one file, so allowed is a file's name",
            out.display(),
            said(arguments.to)
        ))),
        Some(out) => not_the_design(arguments, out),
        None => Ok(()),
    }
}

/// Whether it is one, or is written as one.
fn is_folder(out: &Path) -> bool {
    out.is_dir() || out.as_os_str().to_string_lossy().ends_with('/')
}

/// Refuses to write over the design itself: what its file says beside the model, such as comments, would be lost.
fn not_the_design(arguments: &ConvertArguments, out: &Path) -> Result<(), BadInput> {
    not_what_is_read("--out", out, &[(DESIGN, &arguments.file)])
}

/// Writes it as a design file again.
fn design(
    arguments: &ConvertArguments,
    mut system: System,
    adapt: fn(&mut System) -> Vec<String>,
    write: fn(&System) -> Result<String, WriteError>,
) -> anyhow::Result<()> {
    if arguments.adapt {
        for change in adapt(&mut system) {
            eprintln!("note: {change}");
        }
    }
    let text = write(&system).map_err(|error| refused(&arguments.file, &error, arguments.adapt))?;
    written(arguments, text)
}

/// Writes it as code.
fn code(arguments: &ConvertArguments, system: &System) -> anyhow::Result<()> {
    let file = arguments.file.display();
    let lowered = lower(system).map_err(|error| BadInput(format!("{file}: {error}")))?;
    let stem = arguments
        .file
        .file_stem()
        .unwrap_or_default()
        .to_string_lossy();
    let design = Design {
        system,
        lowered: &lowered,
        name: match &arguments.name {
            Some(name) => name,
            None if system.name.is_empty() => &stem,
            None => &system.name,
        },
        command: &command(arguments),
        bounds: Some(&bounds(system, &lowered)),
    };
    if arguments.to == To::C {
        return c(arguments, &design);
    }
    let route = arguments.route.unwrap_or(Route::General).route();
    let text = rust::write(&design, route).map_err(|why| BadInput(unfit(&file, &why)))?;
    written(arguments, text)?;
    if let (None, Ok(base)) = (arguments.route, design.rule_base()) {
        eprintln!("note: {}", quicker(&lowered, &base));
    }
    Ok(())
}

/// That the fast route is possible, and what its outputs have.
fn quicker(lowered: &Lowered, base: &RuleBase) -> String {
    let outputs = lowered.tables().outputs.iter().zip(&base.tables);
    let outputs = outputs.map(|(output, table)| {
        let (general, fast) = (output.format.fraction, base.fraction(table));
        format!("`{}` {fast} for {general}", output.name)
    });
    let outputs: Vec<String> = outputs.collect();
    format!(
        "--route fast is quicker and fits this design; its integers are others than C's: fractional bits are of {}",
        outputs.join(", ")
    )
}

/// That a design in `file` is not for the fast route.
pub fn unfit(file: &impl std::fmt::Display, why: &str) -> String {
    format!("{file}: --route fast does not fit: {why}; allowed is --route general")
}

/// The two files of C.
fn c(arguments: &ConvertArguments, design: &Design<'_>) -> anyhow::Result<()> {
    let out = arguments.out.as_deref().unwrap_or(Path::new("."));
    let source = match out.extension() {
        Some(extension) if (extension == "c" || extension == "h") && !out.is_dir() => {
            out.with_extension("c")
        }
        _ => {
            check_folder(out)?;
            out.join(emit::c::file_stem(design.name))
                .with_extension("c")
        }
    };
    let header = source.with_extension("h");
    let stem = source.file_stem().unwrap_or_default().to_string_lossy();
    if emit::c::shadows(&stem) {
        return Err(BadInput(format!(
            "--out {}: its header would be {stem}.h, which is one of C's; allowed is another name",
            out.display()
        ))
        .into());
    }
    let included = header.file_name().unwrap_or_default().to_string_lossy();
    let files = emit::c::write(design, &included);
    for file in [&source, &header] {
        not_the_design(arguments, file)?;
    }
    if source.parent() == Some(out) {
        std::fs::create_dir_all(out)
            .with_context(|| format!("{}: cannot be made", out.display()))?;
    }
    Ok(put_where_asked(&[
        (&header, files.header.as_bytes()),
        (&source, files.source.as_bytes()),
    ])?)
}

/// The command without folders: what it makes is the same wherever it ran.
fn command(arguments: &ConvertArguments) -> String {
    let name = arguments
        .file
        .file_name()
        .unwrap_or_default()
        .to_string_lossy();
    let mut command = format!("host-sim fuzzy convert {name} --to {}", said(arguments.to));
    for (option, value) in [
        ("from", arguments.from.map(said)),
        ("route", arguments.route.map(said)),
        ("name", arguments.name.clone()),
    ] {
        if let Some(value) = value {
            command += &format!(" --{option} {value}");
        }
    }
    command
}

/// As it is said on the command line.
fn said(value: impl ValueEnum) -> String {
    value
        .to_possible_value()
        .map_or_else(String::new, |value| value.get_name().to_owned())
}

fn written(arguments: &ConvertArguments, text: String) -> anyhow::Result<()> {
    match &arguments.out {
        Some(file) => Ok(put_where_asked(&[(file, text.as_bytes())])?),
        None => print(text),
    }
}

/// What a writer refuses, in the user's file.
pub(super) fn refused(file: &Path, error: &WriteError, adapted: bool) -> BadInput {
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
