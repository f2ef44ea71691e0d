//! The report of a campaign: a page with its figures and a small picture of every failed run that opens its replay, and
//! the worlds' figures as CSV.

use super::arena::Arena;
use super::attempt::Ending;
use super::body::Body;
use super::results::{Conditions, Figures, Results};
use crate::plot::palette::{MODES, hex};
use crate::plot::thumbnail::{Place, thumbnail_svg};
use crate::recording::Recording;
use std::fmt::Write;

/// A failed run on the page.
#[derive(Clone, Debug)]
pub struct Failure {
    /// Controller's name.
    pub controller: String,
    /// World.
    pub world: u32,
    /// Seed.
    pub seed: u64,
    /// How it ended.
    pub ending: Ending,
    /// When, s.
    pub time: f64,
    /// Its picture, SVG.
    pub picture: String,
    /// Its replay page, beside this one.
    pub replay: String,
}

/// Says on a run's replay, which lies in a folder beside the page, what was asked for.
pub fn explain(recording: &mut Recording, c: &Conditions) {
    let fact = |name: &str, value: String| (name.to_owned(), value);
    recording.facts = vec![
        fact("task", c.task.clone()),
        fact("sensors", c.sensors.clone()),
        fact("trouble", c.disturbance.clone()),
    ];
    recording.facts.extend(
        recording
            .dead
            .map(|sensor| fact("dead sensor", sensor.to_string())),
    );
    recording.back = Some("../index.html".to_owned());
}

/// A small picture of a run, SVG.
///
/// # Errors
/// When it cannot be drawn.
pub fn picture(
    arena: &Arena,
    body: &Body,
    recording: &Recording,
    ending: Ending,
) -> anyhow::Result<String> {
    let last = recording.frames.last();
    let outline = last.map(|f| body.corners(f.truth)).unwrap_or_default();
    let [x, y] = arena.goal;
    thumbnail_svg(
        recording,
        &Place {
            goal: [x, y, arena.goal_radius],
            outline: &outline,
            touched: ending == Ending::Collision,
        },
    )
}

/// The page. `left_out` is the number of failed runs that have no picture.
pub fn page(results: &[Results], failures: &[Failure], left_out: usize) -> String {
    let mut page = String::from(HEAD);
    if let Some(first) = results.first() {
        conditions(&mut page, &first.conditions);
    }
    figures(&mut page, results);
    for result in results {
        beside(&mut page, result);
    }
    if !failures.is_empty() {
        legend(&mut page);
    }
    for result in results {
        let name = &result.conditions.controller;
        let own: Vec<&Failure> = failures.iter().filter(|f| f.controller == *name).collect();
        if own.is_empty() {
            continue;
        }
        let _ = writeln!(
            page,
            "<h2>{}: runs that failed</h2>\n<div class=\"runs\">",
            escaped(name)
        );
        for f in own {
            let _ = writeln!(
                page,
                "<a href=\"{}\">{}<span>world {}, seed {}: {} at {:.1} s</span></a>",
                f.replay,
                f.picture,
                f.world,
                f.seed,
                f.ending.words(),
                f.time
            );
        }
        page.push_str("</div>\n");
    }
    if left_out > 0 {
        let _ = writeln!(
            page,
            "<p>{left_out} more failed runs have no picture; <code>--most-replays</code> allows more.</p>"
        );
    }
    page.push_str("</main></body></html>\n");
    page
}

/// What was run.
fn conditions(page: &mut String, c: &Conditions) {
    let last = c.first_seed + c.seeds.saturating_sub(1);
    let unmapped = match &c.unmapped {
        Some(file) => format!(", cylinders from {}", escaped(file)),
        None => String::new(),
    };
    let _ = writeln!(
        page,
        "<p>Task {}, worlds {} ({}){unmapped}, body {}, sensors {}, {} m/s, seeds {} to {last}; {}.</p>",
        escaped(&c.task),
        escaped(&c.worlds),
        escaped(&c.numbers),
        escaped(&c.body),
        escaped(&c.sensors),
        c.speed,
        c.first_seed,
        escaped(&c.disturbance),
    );
}

/// A row a controller, with 95 % intervals where there are some.
fn figures(page: &mut String, results: &[Results]) {
    page.push_str("<div class=\"wide\"><table><tr><th>controller");
    for (_, heading, _) in COLUMNS {
        let _ = write!(page, "<th>{heading}");
    }
    page.push('\n');
    for result in results {
        let _ = write!(page, "<tr><td>{}", escaped(&result.conditions.controller));
        for (name, _, cell) in COLUMNS {
            let i = &result.intervals_95;
            let interval = match name {
                "success" => Some(i.success_worlds),
                "collision" => Some(i.collision_worlds),
                "score" => Some(i.score_worlds),
                _ => None,
            };
            let _ = write!(page, "<td>{}", cell(&result.figures));
            if let Some([low, high]) = interval {
                let _ = write!(page, "<small>{low:.3}–{high:.3}</small>");
            }
        }
        page.push('\n');
    }
    page.push_str("</table></div>\n<p>Shares are from 0 to 1; small print: 95 % intervals, worlds resampled.</p>\n");
}

/// What a controller's campaign has beside its figures: the sound robot, dead sensors, routes.
fn beside(page: &mut String, result: &Results) {
    let name = escaped(&result.conditions.controller);
    if let Some(sound) = &result.sound {
        let _ = writeln!(
            page,
            "<p>{name} with a sound robot: success {:.4}, collision {:.4}, score {:.4}.</p>",
            sound.figures.success, sound.figures.collision, sound.figures.score
        );
    }
    if let Some(dead) = &result.dead_sensors {
        let _ = writeln!(
            page,
            "<p>{name}, one sensor dead: the worst is number {} with success {:.4} and collision {:.4}.</p>",
            dead.worst.sensor, dead.worst.success, dead.worst.collision
        );
    }
    let routes = result.per_world.iter();
    let routes: Vec<_> = routes
        .filter_map(|w| Some((w.route.as_ref()?, &w.tracking)))
        .collect();
    if routes.is_empty() {
        return;
    }
    let _ = writeln!(
        page,
        "<table><tr><th>{name}: route<th>stretch<th>RMS m<th>largest m"
    );
    for (route, tracking) in routes {
        for t in tracking {
            let _ = writeln!(
                page,
                "<tr><td>{}<td>{}<td>{:.4}<td>{:.4}",
                escaped(route),
                escaped(&t.stretch),
                t.rms_m,
                t.max_m
            );
        }
    }
    page.push_str("</table>\n");
}

/// What the pictures' colours mean.
fn legend(page: &mut String) {
    page.push_str("<p class=\"legend\">");
    for hue in MODES.iter().filter(|hue| hue.mode != "stop") {
        let _ = write!(
            page,
            "<i style=\"background:{}\"></i>{}",
            hex(hue.light),
            hue.mode
        );
    }
    page.push_str(
        "<i class=\"route\"></i>given route, and the goal's circle. A picture opens the run's replay.</p>\n",
    );
}

/// The worlds' figures, a line a controller and world.
pub fn per_world(results: &[Results]) -> String {
    let mut text = String::from("controller,world");
    for (name, _, _) in COLUMNS {
        let _ = write!(text, ",{name}");
    }
    text.push('\n');
    for result in results {
        for world in &result.per_world {
            let _ = write!(text, "{},{}", result.conditions.controller, world.world);
            for (_, _, cell) in COLUMNS {
                let _ = write!(text, ",{}", cell(&world.figures));
            }
            text.push('\n');
        }
    }
    text
}

type Cell = fn(&Figures) -> String;

/// Name in the CSV file, heading on the page, and the figure.
const COLUMNS: [(&str, &str, Cell); 12] = [
    ("runs", "runs", |f| f.runs.to_string()),
    ("success", "success", |f| format!("{:.4}", f.success)),
    ("collision", "collision", |f| format!("{:.4}", f.collision)),
    ("timeout", "out of time", |f| format!("{:.4}", f.timeout)),
    ("blocked", "blocked", |f| format!("{:.4}", f.blocked)),
    ("out_or_blocked", "out or blocked", |f| {
        format!("{:.4}", f.out_or_blocked)
    }),
    ("score", "score", |f| format!("{:.4}", f.score)),
    ("time_s", "mean time s", |f| format!("{:.2}", f.mean_time_s)),
    ("min_clearance_m", "least clearance m, median", |f| {
        format!("{:.3}", f.median_min_clearance_m)
    }),
    (
        "yaw_acceleration_rms",
        "yaw acceleration rad/s², RMS",
        |f| format!("{:.2}", f.omega_rate_rms),
    ),
    ("longest_stall_s", "longest stall s", |f| {
        format!("{:.2}", f.longest_stall_s)
    }),
    ("stalls", "stalls over 5 s", |f| f.stalls.to_string()),
];

const HEAD: &str = "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>Navigation bench</title><style>
body{font:15px/1.45 Ubuntu,Helvetica,Arial,sans-serif;color:#22262b;margin:2em}main{max-width:80em;margin:auto}
.wide{overflow-x:auto}table{border-collapse:collapse;margin:1em 0}td,th{padding:.3em .8em;border-bottom:1px solid #e3e6e9;text-align:right;vertical-align:top}
th{font-weight:600;color:#5f666e;vertical-align:bottom}td:first-child,th:first-child{text-align:left}td small{display:block;color:#5f666e;white-space:nowrap}
.runs{display:flex;flex-wrap:wrap;gap:1em;align-items:flex-start}.runs a{color:#22262b;text-decoration:none;font-size:13px;width:min-content;min-width:9em}
.runs svg{display:block;border:1px solid #e3e6e9;margin-bottom:.3em}.runs a:hover svg{border-color:#22262b}
.legend i{display:inline-block;width:22px;height:3px;margin:0 .4em .25em 1.2em}.legend i:first-child{margin-left:0}
.legend i.route{height:0;background:none;border-top:2px dashed #9aa0a6}
</style></head><body><main><h1>Navigation bench</h1>
";

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}
