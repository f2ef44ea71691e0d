//! `host-sim tune`

use super::bench::Task;
use super::run::json;
use super::search::{INTERRUPTED, STATE, bad, bar, listen, remember, show};
use super::{
    BadInput, Interrupted, MOST_SPEED, none_of_what_is_read, number, of_worlds, print, put_all,
    ready_folder, whole,
};
use clap::Args;
use comfy_table::Cell;
use host_sim::bench::arena::Arena;
use host_sim::bench::attempt::Setting;
use host_sim::bench::body::JACKAL;
use host_sim::bench::campaign::Campaign;
use host_sim::bench::ours::preset;
use host_sim::bench::results::Figures;
use host_sim::bench::sensors;
use host_sim::bench::tuning::{KNOBS, Knob, Tuned, Tuning, rust};
use host_sim::bench::worlds::numbers::{Numbers, is_test};
use host_sim::bench::worlds::{self, unmapped};
use host_sim::search::state::{Question, State};
use host_sim::search::{Search, SearchError, Settings, Stop};
use serde::Serialize;
use std::path::{Path, PathBuf};

/// What is written beside the state.
const MODULE: &str = "tuned.rs";
const REPORT: &str = "report.json";

#[derive(Args)]
#[command(after_help = "\
What moves: the navigator's settings, each within a range of its own, and the peaks of both rule tables; --list prints them.

Cost: the mean over all campaigns of the mean over all runs of: 0.5 - score; plus 1 if the goal is not reached, 2 after a \
collision; plus 0.01 a rad/s² of RMS yaw acceleration above 2; plus 0.3 a metre of clearance below 0.15 m; plus 0.02 a second \
above 4.8 s without progress.

Every task is driven at every speed in the worlds of every place: each is a campaign. Worlds whose number is divisible by 6 are the benchmark's test set: they are refused.

Files in DIR: tuned.rs (as src/navigate/presets has it), report.json, state.json (after every generation; --resume goes on \
from it: same result as without the break).

Exit code: 0; 1 if something cannot be written; 2 if the input is at fault; 130 if interrupted (Ctrl-C: the state and the \
best so far are written).")]
pub struct TuneArguments {
    /// Where the worlds are, as for `bench`; may be given several times.
    #[arg(long, value_name = "PLACE", default_value = "generated:barn")]
    worlds: Vec<String>,
    /// Which of them, as for `bench`; once for all places, or once for each in their order.
    #[arg(long, value_name = "LIST", default_value = "dev")]
    numbers: Vec<String>,
    /// What is driven: path, goal, unmapped (with three cylinders on every path that it does not know).
    #[arg(long, value_enum, value_name = "TASK,…", value_delimiter = ',', default_values_t = [Task::Goal, Task::Path, Task::Unmapped])]
    task: Vec<Task>,
    /// Sensors, as for `bench`; their number chooses the preset to start from: up to 6 ultrasonic5's, up to 11 cone8's, up to
    /// 32 cone16's, more the lidar's.
    #[arg(long, value_name = "NAME", default_value = "cone16")]
    sensors: String,
    /// Speed caps, m/s.
    #[arg(long, value_name = "M/S,…", value_delimiter = ',', default_values_t = [1.0], value_parser = number(0.05, MOST_SPEED), allow_hyphen_values = true)]
    speed: Vec<f64>,
    /// Seeds 0 to N-1 of every world.
    #[arg(long, value_name = "N", default_value_t = 1, value_parser = whole(1, 1000), allow_hyphen_values = true)]
    seeds: u64,
    /// Move only these; a name before the point stands for all of its fields.
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    only: Vec<String>,
    /// Do not move these.
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    fix: Vec<String>,
    /// Print what can move, with ranges and the start's values, and do nothing else.
    #[arg(long)]
    list: bool,
    /// Seed of everything random. The result is the same on any number of cores.
    #[arg(long, default_value_t = 1, value_parser = whole(0, u64::MAX), allow_hyphen_values = true)]
    seed: u64,
    /// First step, as a share of a setting's range.
    #[arg(long, default_value_t = 0.05, value_parser = number(1e-6, 1.0), allow_hyphen_values = true)]
    sigma: f64,
    /// Most candidates to judge.
    #[arg(long, value_name = "N", default_value_t = 400, value_parser = whole(1, 10_000_000), allow_hyphen_values = true)]
    evaluations: u64,
    /// A state.json to go on from; everything but --evaluations and --out has to be as it was.
    #[arg(long, value_name = "FILE")]
    resume: Option<PathBuf>,
    /// Folder for the results.
    #[arg(long, value_name = "DIR", default_value = "out/tune")]
    out: PathBuf,
}

pub fn execute(arguments: &TuneArguments) -> anyhow::Result<()> {
    let views = sensors::named(&arguments.sensors)
        .map_err(|why| BadInput(format!("--sensors {}: {why}", arguments.sensors)))?;
    let start = Tuned::from_preset(preset(&views));
    let knobs = chosen(arguments)?;
    if arguments.list {
        return list(&start, &knobs);
    }
    nothing_lost(arguments)?;
    let settings = Settings {
        seed: arguments.seed,
        sigma: arguments.sigma,
        evaluations: arguments.evaluations as usize,
    };
    settings.check(knobs.len()).map_err(bad)?;
    let tuning = Tuning {
        campaigns: campaigns(arguments, &views)?,
        start,
        knobs,
    };
    let question = Question {
        design: Question::fingerprint(&format!("{:?}", tuning.start)),
        objective: Question::fingerprint(&format!("{:?}", tuning.campaigns)),
        moving: Question::fingerprint(&names(&tuning.knobs)),
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
    ready_folder("--out", out, &[STATE, MODULE, REPORT])?;
    listen()?;
    let before = tuning.judge(&tuning.start).ok_or_else(|| {
        bad(SearchError::Start(
            "the library refuses the preset".to_owned(),
        ))
    })?;
    let state = out.join(STATE);
    let bar = bar(arguments.evaluations);
    let found = Search {
        problem: &tuning,
        settings,
        known: &known,
        stop: &INTERRUPTED,
    }
    .run(before, &mut |progress| {
        show(&bar, &progress);
        remember(&state, &question, &progress)
    })
    .map_err(bad)?;
    bar.finish_and_clear();
    let candidate = found.best.as_ref().map(|vector| tuning.decode(vector).0);
    let after = candidate.as_ref().and_then(|tuned| tuning.judge(tuned));
    // What was meant beyond the walls may do worse as it is.
    let better = after.is_some_and(|after| after < before);
    let best = candidate
        .filter(|_| better)
        .unwrap_or_else(|| tuning.start.clone());
    let report = Report {
        candidates: found.evaluations,
        known: found.known,
        refused: found.refused,
        stopped: format!("{:?}", found.stop),
        cost: [before, after.filter(|_| better).unwrap_or(before)],
        campaigns: tuning
            .figures(&tuning.start)
            .into_iter()
            .zip(tuning.figures(&best))
            .map(|((name, before), (_, after))| (name.to_owned(), [before, after]))
            .collect(),
        changed: tuning
            .knobs
            .iter()
            .map(|knob| (knob.name, [knob.get(&tuning.start), knob.get(&best)]))
            .filter(|(_, [before, after])| before != after)
            .collect(),
    };
    let module = rust(&best, &command(arguments), &arguments.sensors);
    // What cannot be written takes what is printed along no more than the other way round.
    let printed = print(report.text());
    put_all(&[
        (&out.join(MODULE), module.as_bytes()),
        (&out.join(REPORT), &json(&report)?),
    ])?;
    printed?;
    print(format_args!("written: {}\n", out.display()))?;
    if found.stop == Stop::Interrupted {
        return Err(Interrupted(format!("--resume {} goes on", state.display())).into());
    }
    Ok(())
}

/// Refuses results in the place of what is read. Only the state that is gone on from has its successor there.
fn nothing_lost(arguments: &TuneArguments) -> Result<(), BadInput> {
    let worlds: Vec<PathBuf> = arguments
        .worlds
        .iter()
        .flat_map(|place| of_worlds(place))
        .collect();
    let mut read: Vec<(&str, &Path)> = Vec::new();
    read.extend(
        worlds
            .iter()
            .map(|file| ("a file of the worlds", file.as_path())),
    );
    none_of_what_is_read("--out", &arguments.out, &[STATE], &read)?;
    let state = arguments.resume.iter();
    read.extend(state.map(|file| ("the state", file.as_path())));
    none_of_what_is_read("--out", &arguments.out, &[MODULE, REPORT], &read)
}

/// Every task at every speed in the worlds of every place.
fn campaigns(
    arguments: &TuneArguments,
    views: &[host_sim::recording::BeamView],
) -> anyhow::Result<Vec<(String, Campaign)>> {
    let places = places(arguments)?;
    let mut campaigns = Vec::new();
    for (place, numbers) in &places {
        let arenas = arenas(place, numbers)?;
        for task in &arguments.task {
            let mut arenas = arenas.clone();
            if *task == Task::Unmapped {
                unmapped::place(&mut arenas);
            }
            for speed in &arguments.speed {
                let campaign = Campaign {
                    arenas: arenas.clone(),
                    seeds: (0..arguments.seeds).collect(),
                    setting: Setting::new(views.to_vec(), *speed, task.planned()),
                };
                let mut name = format!("{} {speed} m/s", task.name());
                if places.len() > 1 {
                    name += &format!(", {} {numbers}", without_folders(place));
                }
                campaigns.push((name, campaign));
            }
        }
    }
    Ok(campaigns)
}

/// The places of worlds and the numbers of each.
fn places(arguments: &TuneArguments) -> Result<Vec<(&str, &str)>, BadInput> {
    let (places, numbers) = (&arguments.worlds, &arguments.numbers);
    let each = numbers.len();
    if each != 1 && each != places.len() {
        return Err(BadInput(format!(
            "--numbers: found {each} lists for {} places; allowed is one for all, or one for each",
            places.len()
        )));
    }
    let lists = numbers.iter().cycle();
    let pairs = places.iter().zip(lists);
    Ok(pairs
        .map(|(place, list)| (place.as_str(), list.as_str()))
        .collect())
}

/// The worlds of a place that may be tuned on.
fn arenas(place: &str, list: &str) -> anyhow::Result<Vec<Arena>> {
    let numbers =
        Numbers::parse(list).map_err(|why| BadInput(format!("--numbers {list}: {why}")))?;
    let arenas = worlds::load(place, &numbers, &JACKAL)?;
    if let Some(test) = arenas.iter().find(|arena| is_test(arena.number)) {
        return Err(BadInput(format!(
            "--numbers {list}: found world {}, which is of the test set; allowed are numbers not divisible by 6, such as dev",
            test.number
        ))
        .into());
    }
    if arenas.is_empty() {
        return Err(BadInput(format!(
            "--numbers {list}: no such world in {place}; allowed are numbers that are there"
        ))
        .into());
    }
    if let Some(sealed) = arenas.iter().find(|arena| arena.sealed) {
        return Err(BadInput(format!(
            "--worlds {place}: world {} is sealed, no settings arrive there; allowed are worlds with a way to the goal",
            sealed.number
        ))
        .into());
    }
    worlds::check::check(place, &arenas, &JACKAL)?;
    Ok(arenas)
}

fn chosen(arguments: &TuneArguments) -> Result<Vec<&'static Knob>, BadInput> {
    let means = |text: &str, knob: &Knob| {
        knob.name == text
            || knob
                .name
                .split_once('.')
                .is_some_and(|(group, _)| group == text)
    };
    for (flag, texts) in [("--only", &arguments.only), ("--fix", &arguments.fix)] {
        for text in texts {
            if !KNOBS.iter().any(|knob| means(text, knob)) {
                return Err(BadInput(format!(
                    "{flag} {text}: no such setting; allowed are {}",
                    names(&KNOBS.iter().collect::<Vec<_>>())
                )));
            }
        }
    }
    let among = |texts: &[String], knob: &Knob| texts.iter().any(|text| means(text, knob));
    let knobs = KNOBS.iter();
    let only: Vec<&Knob> = knobs
        .filter(|knob| arguments.only.is_empty() || among(&arguments.only, knob))
        .collect();
    let left = only.iter().copied();
    let left: Vec<&Knob> = left.filter(|knob| !among(&arguments.fix, knob)).collect();
    if left.is_empty() {
        return Err(BadInput(format!(
            "--fix {}: no setting is left to move; without it {}",
            arguments.fix.join(","),
            names(&only)
        )));
    }
    Ok(left)
}

fn names(knobs: &[&Knob]) -> String {
    let names: Vec<&str> = knobs.iter().map(|knob| knob.name).collect();
    names.join(", ")
}

fn list(start: &Tuned, knobs: &[&Knob]) -> anyhow::Result<()> {
    let mut table = super::fuzzy::table::table(["setting", "from", "to", "start"]);
    for knob in knobs {
        let row = [knob.from, knob.to, knob.get(start)].map(|x| Cell::new(x.to_string()));
        let mut cells = vec![Cell::new(knob.name)];
        cells.extend(row);
        table.add_row(cells);
    }
    print(format_args!("{table}\n"))
}

/// The command on one line, without folders. Whether it was resumed makes no difference.
fn command(arguments: &TuneArguments) -> String {
    let list = |texts: Vec<String>| texts.join(",");
    let places = arguments.worlds.iter();
    let places = places.map(|place| format!(" --worlds {}", without_folders(place)));
    let numbers = arguments
        .numbers
        .iter()
        .map(|list| format!(" --numbers {list}"));
    let mut command = format!(
        "host-sim tune{} --task {} --sensors {} --speed {} --seeds {}",
        places.chain(numbers).collect::<String>(),
        list(
            arguments
                .task
                .iter()
                .map(|task| task.name().to_owned())
                .collect()
        ),
        arguments.sensors,
        list(arguments.speed.iter().map(f64::to_string).collect()),
        arguments.seeds,
    );
    for (flag, texts) in [("only", &arguments.only), ("fix", &arguments.fix)] {
        if !texts.is_empty() {
            command += &format!(" --{flag} {}", texts.join(","));
        }
    }
    command
        + &format!(
            " --seed {} --sigma {} --evaluations {}",
            arguments.seed, arguments.sigma, arguments.evaluations
        )
}

/// The end of a place's path.
fn without_folders(place: &str) -> &str {
    place.rsplit('/').next().unwrap_or_default()
}

/// What came of it; pairs are before and after.
#[derive(Serialize)]
struct Report {
    candidates: usize,
    /// Only told: after a break the file is as it would have been without.
    #[serde(skip)]
    known: usize,
    refused: usize,
    stopped: String,
    cost: [f64; 2],
    campaigns: Vec<(String, [Figures; 2])>,
    changed: Vec<(&'static str, [f64; 2])>,
}

impl Report {
    fn text(&self) -> String {
        let mut drives = super::fuzzy::table::table([
            "campaign",
            "",
            "success %",
            "collision %",
            "score",
            "clearance m",
            "yaw rad/s²",
            "stall s",
        ]);
        for (name, pair) in &self.campaigns {
            for (when, figures) in ["before", "after"].into_iter().zip(pair) {
                drives.add_row(vec![
                    name.clone(),
                    when.to_owned(),
                    format!("{:.1}", 100.0 * figures.success),
                    format!("{:.1}", 100.0 * figures.collision),
                    format!("{:.4}", figures.score),
                    format!("{:.3}", figures.median_min_clearance_m),
                    format!("{:.2}", figures.omega_rate_rms),
                    format!("{:.1}", figures.longest_stall_s),
                ]);
            }
        }
        let mut changed = super::fuzzy::table::table(["changed", "before", "after"]);
        for (name, [before, after]) in &self.changed {
            changed.add_row(vec![
                (*name).to_owned(),
                before.to_string(),
                after.to_string(),
            ]);
        }
        let [before, after] = self.cost;
        format!(
            "{} candidates ({} known, {} refused), ended by: {}\ncost: {before:.5} before, {after:.5} after\n{drives}\n{}",
            self.candidates,
            self.known,
            self.refused,
            self.stopped,
            if self.changed.is_empty() {
                "no candidate was better: the settings are as they were\n".to_owned()
            } else {
                format!("{changed}\n")
            }
        )
    }
}
