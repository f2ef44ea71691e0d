//! `host-sim bench`

mod conditions;
mod report;
pub mod table;

use super::{
    BadInput, MOST_SPEED, check_folder_of, none_of_what_is_read, not_what_is_read, of_worlds,
    print, put, ready_file, ready_folder, whole,
};
use clap::Args;
pub use conditions::Task;
use conditions::Trouble;
use host_sim::bench::attempt::Setting;
use host_sim::bench::body::Body;
use host_sim::bench::campaign::Campaign;
use host_sim::bench::controllers::{self, Controller};
use host_sim::bench::results::{Conditions, Results, by_world};
use host_sim::bench::shard::Shard;
use host_sim::bench::worlds::{self, numbers::Numbers, unmapped};
use host_sim::bench::{arena::Arena, sensors};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::path::{Path, PathBuf};

#[derive(Args)]
pub struct BenchArguments {
    /// Where the worlds are: BARN's as a folder (world_N.world, path_files/path_N.npy) or as JSON lines (.jsonl, .jsonl.gz,
    /// with common.json beside it), one of your own (.toml), or generated:KIND with KIND one of barn, corridor, rooms,
    /// slalom, forest, moving, u-trap, sealed, closed, and options such as generated:barn,fill=0.2,smooth=3,radius=0.36; or generated:routes,
    /// eight routes to follow.
    #[arg(long, value_name = "PLACE")]
    worlds: String,
    /// Which worlds (of generated ones there are 100 unless a list says more): all, dev (not divisible by 6), test (the others), or a list such as 1,7,10-19,0-294/6.
    #[arg(long, default_value = "all", value_name = "LIST")]
    numbers: String,
    /// What the robot is given.
    #[arg(long, value_enum, default_value_t = Task::Path)]
    task: Task,
    /// Cylinders that the path knows nothing of, world,x,y,r a line; or `generated`: three on every path that leave a way
    /// for a disc of 0.3 m. For `--task unmapped`.
    #[arg(long, value_name = "FILE")]
    unmapped: Option<PathBuf>,
    /// cone16, cone8, ultrasonic5, lidar720, or cones:COUNT:FIELD:WIDTH: 3 to 64 cones over a field above 0 and up to 360 degrees,
    /// each 0 to 90 degrees wide. More than 32 are to `ours` what a lidar's beams are: the nearest echo of each of 32 sectors, with
    /// the lidar's preset.
    #[arg(long, default_value = "cone16", value_name = "NAME")]
    sensors: String,
    /// The robot's outline: jackal (rectangle:0.508x0.430), rectangle:LENGTHxWIDTH, disc:RADIUS, or polygon:X,Y:X,Y:… with 3
    /// to 8 vertices counter-clockwise around the centre of rotation; metres.
    #[arg(long, default_value = "jackal", value_name = "SHAPE")]
    body: String,
    /// Speed cap, m/s.
    #[arg(long, default_value_t = 1.0, value_parser = super::number(0.05, MOST_SPEED), allow_hyphen_values = true)]
    speed: f64,
    /// Names of navigators between commas, or all.
    #[arg(long, default_value = "all", value_name = "LIST")]
    controllers: String,
    /// Seeds a world.
    #[arg(long, default_value_t = 1, value_parser = whole(1, 1_000_000), allow_hyphen_values = true)]
    seeds: u64,
    /// The first of them.
    #[arg(long, default_value_t = 0, value_parser = whole(0, 1_000_000_000), allow_hyphen_values = true)]
    first_seed: u64,
    #[command(flatten, next_help_heading = "What goes wrong")]
    trouble: Trouble,
    /// Also drive the same worlds and seeds with a sound robot (mild noise, all sensors alive, exact odometry), and say
    /// what goes wrong costs. `--dead each` does so by itself.
    #[arg(long)]
    cost: bool,
    /// Threads; as many as there are cores when left out. The results do not depend on it.
    #[arg(long, value_parser = whole(1, 4096), allow_hyphen_values = true)]
    threads: Option<u64>,
    /// Also write all results to this file.
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,
    /// Also write a page with a picture of every failed run that opens its replay, and the worlds' figures.
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Most replays of a controller in the report.
    #[arg(long, default_value_t = 500, value_parser = whole(0, 1_000_000), allow_hyphen_values = true)]
    most_replays: u64,
    /// Only this part of the worlds: i/n with i from 0 to n-1. `host-sim merge` puts the parts together.
    #[arg(long, value_name = "I/N")]
    shard: Option<String>,
}

pub fn execute(arguments: &BenchArguments) -> anyhow::Result<()> {
    let named = |option: &str, text: &str, why: String| BadInput(format!("{option} {text}: {why}"));
    let chosen = controllers::named(&arguments.controllers)
        .map_err(|e| named("--controllers", &arguments.controllers, e))?;
    let sensors = sensors::named(&arguments.sensors)
        .map_err(|e| named("--sensors", &arguments.sensors, e))?;
    let body = Body::parse(&arguments.body).map_err(|e| named("--body", &arguments.body, e))?;
    let numbers = Numbers::parse(&arguments.numbers)
        .map_err(|e| named("--numbers", &arguments.numbers, e))?;
    let shard = match &arguments.shard {
        None => None,
        Some(text) => Some(Shard::parse(text).map_err(|e| named("--shard", text, e))?),
    };
    nothing_lost(arguments)?;
    let arenas = arenas(arguments, &numbers, &body)?;
    let arenas = match shard {
        Some(shard) => shard.of(arenas),
        None => arenas,
    };

    let mut setting = Setting::new(sensors, arguments.speed, arguments.task.planned());
    setting.body = body;
    arguments.trouble.apply(&mut setting)?;
    check_cost(arguments, &setting)?;
    let campaign = Campaign {
        arenas,
        seeds: (arguments.first_seed..arguments.first_seed + arguments.seeds).collect(),
        setting,
    };
    ready(arguments)?;
    let pool = rayon::ThreadPoolBuilder::new()
        .num_threads(arguments.threads.unwrap_or(0) as usize)
        .build()?;
    let begin = std::time::Instant::now();
    let results = pool.install(|| run(arguments, &campaign, &chosen, shard));
    let simulated: f64 = results
        .iter()
        .flat_map(|r| {
            r.per_world
                .iter()
                .chain(r.sound.iter().flat_map(|s| &s.per_world))
        })
        .flat_map(|w| &w.attempts)
        .fold(0.0, |sum, a| sum + a.outcome.time_s);
    let spent = begin.elapsed().as_secs_f64() * pool.current_num_threads() as f64;

    // All of it is tried: what cannot be written takes nothing else along.
    let printed = match (shard, campaign.arenas.is_empty()) {
        (Some(Shard { index, count }), true) => print(format_args!(
            "shard {index}/{count} has no world: there are fewer than {}\n",
            index + 1
        )),
        _ => print(format_args!(
            "{}{simulated:.0} s driven, {:.0} × real time a thread\n",
            table::all(&results),
            simulated / spent
        )),
    };
    let stored = arguments
        .json
        .as_ref()
        .map_or(Ok(()), |file| put(file, json(&results)?.as_bytes()));
    let reported = arguments.report.as_ref().map_or(Ok(()), |folder| {
        let most = arguments.most_replays as usize;
        let json = arguments.json.as_deref();
        report::write(folder, &campaign, &chosen, &results, most, json)
    });
    printed.and(stored).and(reported)
}

/// Refuses places where nothing can be written.
fn ready(arguments: &BenchArguments) -> Result<(), BadInput> {
    if let Some(file) = &arguments.json {
        ready_file("--json", file)?;
    }
    match &arguments.report {
        Some(folder) => {
            check_folder_of("--report", &folder.join("runs"))?;
            ready_folder("--report", folder, &report::FILES)
        }
        None => Ok(()),
    }
}

/// Refuses results in the place of what is read.
fn nothing_lost(arguments: &BenchArguments) -> Result<(), BadInput> {
    let worlds = of_worlds(&arguments.worlds);
    let worlds = worlds
        .iter()
        .map(|file| ("a file of the worlds", file.as_path()));
    let cylinders = arguments.unmapped.iter();
    let cylinders = cylinders.map(|file| ("the file of cylinders", file.as_path()));
    let read: Vec<(&str, &Path)> = worlds.chain(cylinders).collect();
    if let Some(file) = &arguments.json {
        not_what_is_read("--json", file, &read)?;
    }
    if let (Some(file), Some(folder)) = (&arguments.json, &arguments.report)
        && report::writes(folder, file)
    {
        return Err(BadInput(format!(
            "--json {}: --report {} writes there; allowed is another file",
            file.display(),
            folder.display()
        )));
    }
    match &arguments.report {
        Some(folder) => none_of_what_is_read("--report", folder, &report::FILES, &read),
        None => Ok(()),
    }
}

/// Refuses a comparison of which nothing would be learned.
fn check_cost(arguments: &BenchArguments, setting: &Setting) -> Result<(), BadInput> {
    let sensors = setting.sensors.len() as u64;
    if arguments.trouble.each_dead() && arguments.seeds < sensors {
        return Err(BadInput(format!(
            "--dead each: --seeds {} leave sensors untried; allowed with --seeds {sensors} or more",
            arguments.seeds
        )));
    }
    let sound = setting.sound();
    let same = sound.disturbance == setting.disturbance
        && sound.dead == setting.dead
        && sound.drift == setting.drift;
    if arguments.cost && same {
        return Err(BadInput(
            "--cost: nothing goes wrong; allowed with --harsh, --noise, --dropout, --cross-talk, --specular, --dead or --drift"
                .to_owned(),
        ));
    }
    Ok(())
}

/// Results as the JSON file has them.
pub fn json(results: &[Results]) -> anyhow::Result<String> {
    let mut text = serde_json::to_string_pretty(results)?;
    text.push('\n');
    Ok(text)
}

/// The worlds that were asked for, with what the path does not know.
fn arenas(
    arguments: &BenchArguments,
    numbers: &Numbers,
    body: &Body,
) -> anyhow::Result<Vec<Arena>> {
    let mut arenas = worlds::load(&arguments.worlds, numbers, body)?;
    if arenas.is_empty() {
        return Err(BadInput(format!(
            "--numbers {}: no such world in {}; allowed are numbers that are there",
            arguments.numbers, arguments.worlds
        ))
        .into());
    }
    if arenas.iter().any(|a| a.course.is_some()) && arguments.task != Task::Path {
        return Err(BadInput(format!(
            "--task {}: {} are to be followed; allowed with --task path",
            arguments.task.name(),
            arguments.worlds
        ))
        .into());
    }
    match (&arguments.unmapped, arguments.task) {
        (Some(file), Task::Unmapped) if file.as_os_str() == "generated" => {
            unmapped::place(&mut arenas);
        }
        (Some(file), Task::Unmapped) => {
            worlds::check::check(&arguments.worlds, &arenas, body)?;
            if let Some(odd) = unmapped::add(file, &arguments.worlds, &mut arenas, body)? {
                eprintln!("note: {odd}");
            }
        }
        (None, Task::Unmapped) => {
            return Err(BadInput(
                "--task unmapped: no cylinders; allowed with --unmapped FILE.csv, or --unmapped generated".to_owned(),
            )
            .into());
        }
        (Some(_), _) => {
            return Err(BadInput(
                "--unmapped: for another task; allowed with --task unmapped".to_owned(),
            )
            .into());
        }
        (None, _) => {}
    }
    worlds::check::check(&arguments.worlds, &arenas, body)?;
    Ok(arenas)
}

fn run(
    arguments: &BenchArguments,
    campaign: &Campaign,
    chosen: &[Controller],
    shard: Option<Shard>,
) -> Vec<Results> {
    let sound = (arguments.cost || arguments.trouble.each_dead()).then(|| Campaign {
        setting: campaign.setting.sound(),
        ..campaign.clone()
    });
    let rounds = if sound.is_some() { 2 } else { 1 };
    let runs = campaign.arenas.len() * campaign.seeds.len() * chosen.len() * rounds;
    let bar = bar(runs as u64);
    let results = chosen
        .iter()
        .map(|controller| {
            bar.set_message(controller.name);
            let done = || bar.inc(1);
            let worlds = by_world(&campaign.run(controller, &done));
            let sound = sound
                .as_ref()
                .map(|sound| by_world(&sound.run(controller, &done)));
            let unmapped = arguments.unmapped.as_ref();
            let conditions = Conditions {
                controller: controller.name.to_owned(),
                task: arguments.task.name().to_owned(),
                sensors: arguments.sensors.clone(),
                worlds: arguments.worlds.clone(),
                numbers: arguments.numbers.clone(),
                unmapped: unmapped.map(|file| file.display().to_string()),
                body: arguments.body.clone(),
                speed: arguments.speed,
                first_seed: arguments.first_seed,
                seeds: arguments.seeds,
                disturbance: arguments.trouble.words(),
            };
            Results::of(conditions, shard.map(|s| [s.index, s.count]), worlds, sound)
        })
        .collect();
    bar.finish_and_clear();
    results
}

fn bar(runs: u64) -> ProgressBar {
    let target = if std::io::stderr().is_terminal() {
        ProgressDrawTarget::stderr()
    } else {
        ProgressDrawTarget::hidden()
    };
    let style = ProgressStyle::with_template("{msg:12} {bar:40} {pos} of {len} runs, {eta} left")
        .unwrap_or_else(|_| ProgressStyle::default_bar());
    ProgressBar::with_draw_target(Some(runs), target).with_style(style)
}
