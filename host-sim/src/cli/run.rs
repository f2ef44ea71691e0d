//! `host-sim run`

use super::{
    BadInput, Variants, check_folder, load, none_of_what_is_read, not_what_is_read, print, put,
    whole,
};
use anyhow::Context;
use clap::Args;
use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use host_sim::metrics::{Metrics, Summary};
use host_sim::recording::Recording;
use host_sim::run::{Ending, Period, simulate};
use host_sim::scenario::Scenario;
use host_sim::{plot, recorder, replay, ticks};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;
use std::io::IsTerminal;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub struct RunArguments {
    /// Built-in scenario (see `host-sim list`) or a TOML file; experiment-1 when left out.
    scenario: Option<String>,
    #[command(flatten)]
    options: Options,
}

/// How to run, and where the results go.
#[derive(Args)]
pub struct Options {
    #[command(flatten)]
    variants: Variants,
    /// Seed of the run's noise.
    #[arg(long, default_value_t = 1, value_parser = whole(0, u64::MAX), allow_hyphen_values = true)]
    seed: u64,
    /// Folder for the results; out/SCENARIO when left out.
    #[arg(long, value_name = "DIR")]
    out: Option<PathBuf>,
    /// Also write the summary to this file.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
}

impl RunArguments {
    /// What is run without a command.
    pub fn experiment_1(options: Options) -> Self {
        Self {
            scenario: None,
            options,
        }
    }
}

pub fn execute(arguments: &RunArguments) -> anyhow::Result<()> {
    let name = arguments.scenario.as_deref().unwrap_or("experiment-1");
    let arguments = &arguments.options;
    let scenario = load(name, &arguments.variants)?;
    let folder = match &arguments.out {
        Some(folder) => folder.clone(),
        None => Path::new("out").join(&scenario.name),
    };
    check_folder(&folder)?;
    let read = [("the scenario", Path::new(name))];
    none_of_what_is_read("--out", &folder, &FILES, &read)?;
    if let Some(file) = &arguments.json {
        check_file(file, &folder)?;
        not_what_is_read("--json", file, &read)?;
    }

    let mut watch = Watch::new(&scenario, arguments.seed);
    let ending = simulate(&scenario, arguments.seed, &mut |step| {
        watch.period(&Period::Tick(step));
    })?;
    let summary = watch.write(ending, &folder)?;
    if let Some(file) = &arguments.json {
        put(file, &json(&summary)?)?;
    }
    print(report(&scenario, &summary))?;
    print(format_args!("written: {}\n", folder.display()))
}

/// Watches a run for everything that is written of it.
pub struct Watch {
    metrics: Metrics,
    recording: Recording,
    rows: Vec<Vec<String>>,
    progress: ProgressBar,
}

impl Watch {
    pub fn new(scenario: &Scenario, seed: u64) -> Self {
        let progress = progress(scenario);
        progress.set_message("driving");
        Self {
            metrics: Metrics::new(scenario, seed),
            recording: recorder::start(scenario, seed),
            rows: Vec::new(),
            progress,
        }
    }

    pub fn period(&mut self, period: &Period<'_>) {
        self.metrics.period(period);
        recorder::period(&mut self.recording, period);
        if let Period::Tick(step) = period {
            self.rows.push(ticks::row(step.record));
        }
        let count = self.recording.frames.len();
        if count.is_multiple_of(64) {
            self.progress.set_position(count as u64);
        }
    }

    /// Draws and writes everything.
    pub fn write(self, ending: Ending, folder: &Path) -> anyhow::Result<Summary> {
        let summary = self.metrics.finish(ending);
        self.progress.set_message("drawing");
        write(folder, &summary, &self.recording, &self.rows)?;
        self.progress.finish_and_clear();
        Ok(summary)
    }
}

/// Refuses early what could not be written after the run.
fn check_file(file: &Path, out: &Path) -> Result<(), BadInput> {
    let folder = file.parent().filter(|p| !p.as_os_str().is_empty());
    let named = file.file_name().is_some() && !file.as_os_str().to_string_lossy().ends_with('/');
    if !named || file.is_dir() || folder.is_some_and(|p| !p.is_dir() && p != out) {
        return Err(BadInput(format!(
            "--json {}: allowed is a file in an existing folder or the run's own",
            file.display()
        )));
    }
    Ok(())
}

fn progress(scenario: &Scenario) -> ProgressBar {
    let ticks = (scenario.duration / scenario.robot.period).ceil() as u64;
    let target = if std::io::stderr().is_terminal() {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    };
    let style = ProgressStyle::with_template("{msg:8} {bar:40} tick {pos} of at most {len}")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::with_draw_target(Some(ticks), target).with_style(style)
}

pub fn json(summary: &impl Serialize) -> anyhow::Result<Vec<u8>> {
    let mut text = serde_json::to_string_pretty(summary)?;
    text.push('\n');
    Ok(text.into_bytes())
}

/// What [`write`] makes.
pub const FILES: [&str; 5] = [
    "run.svg",
    "run.png",
    "replay.html",
    "ticks.csv",
    "summary.json",
];

fn write(
    folder: &Path,
    summary: &Summary,
    recording: &Recording,
    rows: &[Vec<String>],
) -> anyhow::Result<()> {
    let svg = plot::run_svg(recording)?;
    let page = replay::html(recording)?;
    let table = ticks::csv(rows)?;
    std::fs::create_dir_all(folder)
        .with_context(|| format!("{}: cannot be created", folder.display()))?;
    plot::write_pair(folder, "run", &svg)?;
    put(&folder.join("replay.html"), page.as_bytes())?;
    put(&folder.join("ticks.csv"), &table)?;
    put(&folder.join("summary.json"), &json(summary)?)
}

/// The chapter's story: obstacle, side, steps to pass it, steps to regain the path where given.
const STORY: [(&str, &str, u64, Option<u64>); 3] = [
    ("Obs4", "right", 69, Some(40)),
    ("Obs5", "left", 36, None),
    ("Obs6", "left", 49, None),
];

/// The figures of a run as tables.
pub fn report(scenario: &Scenario, summary: &Summary) -> String {
    let mut text = format!(
        "{}: {} (seed {}), {} ticks, {:.1} s\n",
        summary.scenario, summary.variant, summary.seed, summary.ticks, summary.sim_time_s
    );
    let told = scenario.name == "experiment-1";
    if told || !summary.avoidances.is_empty() {
        text += &format!("{}\n", avoidances(summary, told));
    }
    let metres = |x: Option<f64>| x.map_or_else(|| "none".to_owned(), |x| format!("{x:.4} m"));
    let mut figures = Table::new();
    figures.load_style(UTF8_FULL_CONDENSED);
    figures.set_header(["figure", "value"]);
    figures.add_row(["ended by", summary.ended]);
    figures.add_row([
        "cross-track RMS, free stretches",
        &metres(summary.cross_track_rms_m),
    ]);
    figures.add_row([
        "cross-track maximum, free stretches",
        &metres(summary.cross_track_max_m),
    ]);
    figures.add_row(["minimum clearance", &metres(summary.min_clearance_m)]);
    figures.add_row(["collisions", &summary.collisions.to_string()]);
    figures.add_row(["mean speed", &format!("{:.3} m/s", summary.mean_speed_mps)]);
    figures.add_row([
        "odometry error at the end",
        &metres(Some(summary.odometry_error_m)),
    ]);
    text + &format!("{figures}\n")
}

fn avoidances(summary: &Summary, told: bool) -> Table {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    let mut header = vec![
        "obstacle",
        "turned",
        "steps",
        "path then at",
        "steps to regain",
    ];
    if told {
        header.extend(["chapter: turned", "steps", "to regain"]);
    }
    table.set_header(header);
    let steps = |n: Option<u64>| n.map_or_else(|| "–".to_owned(), |n| n.to_string());
    for pass in &summary.avoidances {
        let mut row = vec![
            pass.obstacle.clone(),
            pass.side.to_owned(),
            pass.steps.to_string(),
            format!("{:.2} m", pass.distance_at_end_m),
            steps(pass.regain_steps),
        ];
        if told {
            match STORY.iter().find(|s| s.0 == pass.obstacle) {
                Some((_, side, passed, regain)) => {
                    row.extend([(*side).to_owned(), passed.to_string(), steps(*regain)]);
                }
                None => row.extend(["–".to_owned(), "–".to_owned(), "–".to_owned()]),
            }
        }
        table.add_row(row);
    }
    for (name, side, passed, regain) in STORY
        .iter()
        .filter(|s| told && !summary.avoidances.iter().any(|pass| pass.obstacle == s.0))
    {
        table.add_row([
            *name,
            "not met",
            "–",
            "–",
            "–",
            side,
            &passed.to_string(),
            &steps(*regain),
        ]);
    }
    table
}
