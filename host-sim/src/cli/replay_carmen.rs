//! `host-sim replay-carmen`

use super::{
    BadInput, MOST_SPEED, check_folder, none_of_what_is_read, number, print, put, ready_folder,
};
use anyhow::Context;
use clap::{Args, ValueEnum};
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use host_sim::bench::body::Body;
use host_sim::carmen::summary::{Summary, csv};
use host_sim::carmen::timeline::{Clock, LONGEST, Timeline};
use host_sim::carmen::{log, picture, replay};
use host_sim::plot;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub struct CarmenArguments {
    /// CARMEN's text log, plain or gzip: FLASER, ROBOTLASER1 and ODOM lines are read.
    #[arg(value_name = "FILE")]
    file: PathBuf,
    /// Folder for the results; out/NAME when left out.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// What the navigator is given: a place on the robot's own way ahead, or that way as a path to follow.
    #[arg(long, value_enum, default_value_t = Task::Goal)]
    task: Task,
    /// How far ahead on the robot's own way the goal lies, m; a new one when half of it is left.
    #[arg(long, default_value_t = 3.0, value_parser = number(0.5, 100.0), allow_hyphen_values = true)]
    look: f64,
    /// The robot's outline: jackal, rectangle:LENGTHxWIDTH, disc:RADIUS, or polygon:X,Y:X,Y:… in metres, counter-clockwise.
    #[arg(long, default_value = "jackal", value_name = "SHAPE")]
    body: String,
    /// Speed cap of the navigator, m/s.
    #[arg(long, default_value_t = 1.0, value_parser = number(0.05, MOST_SPEED), allow_hyphen_values = true)]
    speed: f64,
    /// Speed that the recorded robot is taken to have driven with if the log has no usable times, m/s.
    #[arg(long, default_value_t = 0.5, value_parser = number(0.05, 5.0), allow_hyphen_values = true)]
    pace: f64,
}

/// What the navigator is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Task {
    /// A place.
    Goal,
    /// The way there.
    Path,
}

/// What is written.
const FILES: [&str; 4] = [
    "decisions.svg",
    "decisions.png",
    "ticks.csv",
    "summary.json",
];

pub fn execute(arguments: &CarmenArguments) -> anyhow::Result<()> {
    let file = &arguments.file;
    let name = file.file_name().unwrap_or_default().to_string_lossy();
    let stem = name.trim_end_matches(".gz").trim_end_matches(".log");
    let folder = match &arguments.out {
        Some(folder) => folder.clone(),
        None => Path::new("out").join(if stem.is_empty() { "carmen" } else { stem }),
    };
    let refused = |e| BadInput(format!("--body {}: {e}", arguments.body));
    let body = Body::parse(&arguments.body).map_err(refused)?;
    check_folder(&folder)?;
    none_of_what_is_read("--out", &folder, &FILES, &[("the log", file)])?;
    let log = log::read(file)?;
    let timeline = Timeline::new(&log, arguments.pace);
    if timeline.duration() > LONGEST {
        return Err(BadInput(format!(
            "{}: found {:.0} s; allowed: up to {LONGEST} s, cut the log{}",
            file.display(),
            timeline.duration(),
            match timeline.clock {
                Clock::Pace => " or raise --pace",
                _ => "",
            }
        ))
        .into());
    }
    let footprint = body
        .footprint()
        .context("a body that was read has few vertices")?;
    let settings = replay::Settings {
        given: match arguments.task {
            Task::Goal => replay::Given::Goal,
            Task::Path => replay::Given::Path,
        },
        footprint,
        speed: arguments.speed,
        look: arguments.look,
    };
    ready_folder("--out", &folder, &FILES)?;
    let replayed = replay::replay(&log, &timeline, &settings)
        .map_err(|e| BadInput(format!("{}: {e}", file.display())))?;
    let summary = Summary::of(&name, &log, &timeline, &replayed);

    let svg = picture::picture(&replayed, &summary, body.outer_radius())?;
    let table = csv(&replayed)?;
    // What cannot be written does not take the figures along.
    let printed = print(format_args!("{}\n", report(&summary)));
    plot::write_pair(&folder, "decisions", &svg)?;
    put(&folder.join("ticks.csv"), &table)?;
    put(&folder.join("summary.json"), &super::run::json(&summary)?)?;
    printed?;
    print(format_args!("written: {}\n", folder.display()))
}

fn report(summary: &Summary) -> Table {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header(["figure", "value"]);
    let clock = match summary.clock {
        Clock::Messages => "the messages' own",
        Clock::Logger => "the logger's",
        Clock::Pace => "none in the log: driven at --pace",
    };
    let per_cent = |share: f64| format!("{:.1} %", 100.0 * share);
    let mut row = |name: &str, value: String| {
        table.add_row([name.to_owned(), value]);
    };
    row(
        "scans",
        format!("{} of {} messages", summary.scans, summary.messages),
    );
    row("times", clock.to_owned());
    if summary.corrected {
        row("poses", "the lasers', corrected after the drive".to_owned());
    }
    row(
        "recorded way",
        format!("{:.1} m in {:.1} s", summary.driven_m, summary.duration_s),
    );
    row("ticks", summary.ticks.to_string());
    for (name, share) in &summary.manoeuvres {
        if *share > 0.0 {
            row(name, per_cent(*share));
        }
    }
    row("slowed by the barrier", per_cent(summary.slowed));
    row("changed by the brake gate", per_cent(summary.gated));
    row("no twist found that stays clear", per_cent(summary.trapped));
    row(
        "mean speed decided",
        format!("{:.2} m/s", summary.mean_speed_mps),
    );
    let metres = |x: Option<f64>| {
        x.map_or_else(
            || "none".to_owned(),
            // No minus before a zero.
            |x| format!("{:.3} m", (1000.0 * x).round() / 1000.0 + 0.0),
        )
    };
    let when = summary
        .least_clearance_at_s
        .map_or_else(String::new, |t| format!(" at {t:.2} s"));
    row(
        "smallest clearance, remembered points",
        metres(summary.least_clearance_m) + &when,
    );
    row("smallest clearance, beams", metres(summary.least_beam_m));
    row("most points remembered", summary.most_points.to_string());
    table
}
