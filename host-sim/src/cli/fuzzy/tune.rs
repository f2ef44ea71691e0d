//! `host-sim fuzzy tune`

mod goal;
mod report;
mod result;
mod selected;

use super::convert::refused;
use super::design::Design;
use crate::cli::search::{INTERRUPTED, STATE, bad, bar, listen, remember, show};
use crate::cli::{
    BadInput, DESIGN, Interrupted, check_folder, not_what_is_read, number, print, whole,
};
use clap::{ArgGroup, Args};
use goal::Goal;
use host_sim::fuzzy::tune::{Movable, Search, Selection};
use host_sim::scenario::shown;
use host_sim::search::state::{Question, State};
use host_sim::search::{Settings, Stop};
use report::Report;
use result::Written;
use selected::{named, what_could};
use std::path::{Path, PathBuf};

#[derive(Args)]
#[command(
    group = ArgGroup::new("goal").required(true).args(["data", "scenario"]),
    after_help = "\
What moves: peaks, feet and middles of membership functions inside their range (those at one value together), widths of \
curved ones (half to double), constants within their range, numbers of order-1 terms. They keep their order and a least \
distance. Terms, rules, weights and ranges stay.

Cost with --data: root of the mean square of (output − data) / range of the output, over all rows and outputs, in fixed \
point.

Cost with --scenario: the mean over all runs of: RMS cross-track error of all ticks that follow the path, in robot radii; \
plus 0.1 · time, in multiples of what the path takes at top speed; plus the mean change of the yaw rate from tick to \
tick, as a share of what the robot can; plus 10 a collision; plus 10 if the end is not reached. \
The design is the follower's (inputs phi and d, outputs speed and deflection, 25 rules: see designs/fine.fll). Its quick \
route reads even terms: the outputs move, and d's peaks together, by their distance; phi's are the robot's angle and stay. On the \
robot the distance divides Follower::distance_scale.

Files in DIR: tuned.fll (tuned.fcl for an FCL design and for MATLAB's with centroids), tuned.rs (as convert makes it of that), report.json, memberships.svg and .png (before and after), state.json (after every \
generation; --resume goes on from it: same result as without the break, but for the count of those known).

Exit code: 0; 1 if something cannot be written; 2 if the input is at fault; 130 if interrupted (Ctrl-C: the state and the \
best so far are written)."
)]
pub struct TuneArguments {
    #[command(flatten)]
    design: super::DesignArguments,
    /// Rows to fit: a CSV file with a line of names, a column for every input and for one output or more.
    #[arg(long, value_name = "FILE")]
    data: Option<PathBuf>,
    /// Scenarios to drive well, built-in or TOML files.
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    scenario: Vec<String>,
    /// Seeds 1 to N of every scenario.
    #[arg(long, value_name = "N", default_value_t = 1, requires = "scenario", conflicts_with = "data", value_parser = whole(1, 1000), allow_hyphen_values = true)]
    seeds: u64,
    /// Columns of the data that are not looked at.
    #[arg(
        long,
        value_name = "NAME,…",
        value_delimiter = ',',
        conflicts_with = "scenario"
    )]
    ignore: Vec<String>,
    /// Share of the rows that is only judged by, not fitted to; picked at random from the seed.
    #[arg(long, value_name = "SHARE", default_value_t = 0.0, conflicts_with = "scenario", value_parser = number(0.0, 0.9), allow_hyphen_values = true)]
    validate: f64,
    /// Move only these: VARIABLE or VARIABLE.TERM.
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    only: Vec<String>,
    /// Do not move these: VARIABLE or VARIABLE.TERM. What they share with other terms stays, too.
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    fix: Vec<String>,
    /// Names that the result's format has not, such as those with blanks, become the nearest that it has; each change is
    /// named. Data, --only and --fix use the design's own.
    #[arg(long)]
    adapt: bool,
    /// Seed of everything random. The result is the same on any number of cores.
    #[arg(long, default_value_t = 1, value_parser = whole(0, u64::MAX), allow_hyphen_values = true)]
    seed: u64,
    /// First step, as a share of a variable's range.
    #[arg(long, default_value_t = 0.1, value_parser = number(1e-6, 1.0), allow_hyphen_values = true)]
    sigma: f64,
    /// Most candidates to judge.
    #[arg(long, value_name = "N", default_value_t = 2000, value_parser = whole(1, 10_000_000), allow_hyphen_values = true)]
    evaluations: u64,
    /// A state.json to go on from; everything but --evaluations and --out has to be as it was.
    #[arg(long, value_name = "FILE")]
    resume: Option<PathBuf>,
    /// Folder for the results.
    #[arg(long, value_name = "DIR", default_value = "out/tune")]
    out: PathBuf,
}

pub fn execute(arguments: &TuneArguments) -> anyhow::Result<()> {
    let design = Design::load(&arguments.design)?;
    let system = &design.system;
    if let Err(why) = &design.fixed {
        let file = arguments.design.file.display();
        return Err(BadInput(format!("{file}: no fixed point: {why}")).into());
    }
    let drives = !arguments.scenario.is_empty();
    let written = Written::of(&arguments.design, system, arguments.adapt, drives);
    let (_, renamed, _) = written
        .text(system)
        .map_err(|error| refused(&arguments.design.file, &error, arguments.adapt))?;
    let goal = Goal::load(arguments, system)?;
    let mut selection = Selection {
        only: named(system, "--only", &arguments.only)?,
        fix: named(system, "--fix", &arguments.fix)?,
        even: Vec::new(),
    };
    goal.hold(system, &mut selection);
    let movable = Movable::new(system, &selection);
    if movable.is_empty() {
        let mut free = Selection::default();
        goal.hold(system, &mut free);
        let asked = [&arguments.only[..], &arguments.fix[..]];
        return Err(what_could(system, &free, asked, drives).into());
    }
    let question = Question {
        design: Question::fingerprint(&format!(
            "{:?}",
            system.clone().without_places().without_descriptions()
        )),
        objective: goal.fingerprint(),
        moving: Question::fingerprint(&format!("{selection:?}")),
        seed: arguments.seed,
        sigma: arguments.sigma,
    };
    let known = match &arguments.resume {
        Some(file) => {
            State::load(file, &question).map_err(|e| BadInput(format!("--resume {e}")))?
        }
        None => Default::default(),
    };
    let out = &arguments.out;
    check_folder(out)?;
    nothing_lost(arguments, &written)?;
    for change in renamed {
        eprintln!("note: in the result {change}");
    }
    listen()?;
    let search = Search {
        movable: &movable,
        objective: goal.objective(),
        settings: Settings {
            seed: arguments.seed,
            sigma: arguments.sigma,
            evaluations: arguments.evaluations as usize,
        },
        known,
        stop: &INTERRUPTED,
    };
    let state = out.join(STATE);
    let bar = bar(arguments.evaluations);
    let outcome = search
        .run(&mut |progress| {
            show(&bar, &progress);
            remember(&state, &question, &progress)
        })
        .map_err(bad)?;
    bar.finish_and_clear();
    let report = Report::new(&design, &goal, &movable, &outcome)?;
    let mut how = command(arguments);
    if outcome.stop == Stop::Interrupted {
        how += &format!(" (interrupted after {} candidates)", outcome.evaluations);
    }
    written.write(out, &design, &outcome.best.system, &report, &how)?;
    print(&report)?;
    print(format_args!("written: {}\n", out.display()))?;
    if outcome.stop == Stop::Interrupted {
        let how = format!("--resume {} goes on", state.display());
        return Err(Interrupted(how).into());
    }
    Ok(())
}

/// Refuses results in the place of what is read. Only the state that is gone on from has its successor there.
fn nothing_lost(arguments: &TuneArguments, written: &Written) -> Result<(), BadInput> {
    let mut read = vec![(DESIGN, arguments.design.file.as_path())];
    read.extend(
        arguments
            .data
            .iter()
            .map(|file| ("the data", file.as_path())),
    );
    let scenarios = arguments.scenario.iter();
    read.extend(scenarios.map(|name| ("the scenario", Path::new(name))));
    not_what_is_read("--out", &arguments.out.join(STATE), &read)?;
    read.extend(
        arguments
            .resume
            .iter()
            .map(|file| ("the state", file.as_path())),
    );
    let mut files = written.files().into_iter();
    files.try_for_each(|file| not_what_is_read("--out", &arguments.out.join(file), &read))
}

/// The command on one line, without folders and line breaks. Whether it was resumed makes no difference.
fn command(arguments: &TuneArguments) -> String {
    let name = |path: &Path| {
        path.file_name()
            .unwrap_or_default()
            .to_string_lossy()
            .into_owned()
    };
    let list = |names: &[String]| (!names.is_empty()).then(|| names.join(","));
    let driving = !arguments.scenario.is_empty();
    let mut command = format!("host-sim fuzzy tune {}", name(&arguments.design.file));
    for (option, value) in [
        ("data", arguments.data.as_deref().map(name)),
        ("ignore", list(&arguments.ignore)),
        (
            "validate",
            (arguments.validate > 0.0).then(|| arguments.validate.to_string()),
        ),
        ("scenario", list(&arguments.scenario)),
        ("seeds", driving.then(|| arguments.seeds.to_string())),
        ("only", list(&arguments.only)),
        ("fix", list(&arguments.fix)),
        ("seed", Some(arguments.seed.to_string())),
        ("sigma", Some(arguments.sigma.to_string())),
        ("evaluations", Some(arguments.evaluations.to_string())),
    ] {
        if let Some(value) = value {
            let value = shown(&value);
            let quote = if value.contains(' ') { "'" } else { "" };
            command += &format!(" --{option} {quote}{value}{quote}");
        }
    }
    if arguments.adapt {
        command += " --adapt";
    }
    command
}
