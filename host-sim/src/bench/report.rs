//! The report of a campaign: a page with its figures and a small picture of every failed run that opens its replay, and
//! the worlds' figures as CSV.

use super::arena::Arena;
use super::attempt::Ending;
use super::body::Body;
use super::results::{Conditions, Figures, Results};
use super::rows;
use crate::plot::palette::{MODES, sheet};
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
    /// The sensor that was dead, if one was.
    pub dead: Option<usize>,
    /// How it ended.
    pub ending: Ending,
    /// When, s.
    pub time: f64,
    /// Whether something stood there that the route knows nothing of.
    pub unmapped: bool,
    /// Whether something moved.
    pub moving: bool,
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

/// What a page says of itself.
#[derive(Clone, Debug, Default)]
pub struct About {
    /// The command that wrote it.
    pub command: String,
    /// Files with more, by the page's own place.
    pub files: Vec<String>,
}

/// The page. `left_out` is the number of failed runs that have no picture.
pub fn page(results: &[Results], failures: &[Failure], left_out: usize, about: &About) -> String {
    let title = results.first().map_or_else(String::new, |first| {
        let c = &first.conditions;
        format!(": task {}, {}", escaped(&c.task), escaped(&c.sensors))
    });
    let mut page = head(&format!("Navigation bench{title}"));
    if let Some(first) = results.first() {
        conditions(&mut page, &first.conditions);
        if let Some([index, count]) = first.shard {
            let _ = writeln!(
                page,
                "<p><b>Only part {index}/{count} of the worlds.</b> <code>host-sim merge</code> puts the parts' results together.</p>"
            );
        }
    }
    figures(&mut page, results);
    beside(&mut page, results);
    if !failures.is_empty() {
        let planned = results.iter().all(|r| r.conditions.task != "goal");
        legend(&mut page, failures, planned);
    } else if left_out == 0 {
        page.push_str("<p>No run failed.</p>\n");
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
            let dead = f
                .dead
                .map_or_else(String::new, |sensor| format!(", sensor&nbsp;{sensor} dead"));
            let _ = writeln!(
                page,
                "<a href=\"{}\" style=\"width:max(9em,{}px)\">{}<span>world&nbsp;{}, seed&nbsp;{}{dead}: {} at&nbsp;{:.1}&nbsp;s</span></a>",
                f.replay,
                width(&f.picture),
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
    footer(&mut page, about);
    page.push_str("</main></body></html>\n");
    page
}

/// Where there is more, and how to have it again.
fn footer(page: &mut String, about: &About) {
    page.push_str("<p class=\"small\">");
    for file in &about.files {
        let name = file.rsplit('/').next().unwrap_or(file);
        let _ = write!(
            page,
            "<a href=\"{}\">{}</a>, ",
            escaped(&encoded(file)),
            escaped(name)
        );
    }
    let _ = writeln!(
        page,
        "host-sim {}: <code>{}</code></p>",
        env!("CARGO_PKG_VERSION"),
        escaped(&about.command)
    );
}

/// A path as a link has it.
fn encoded(path: &str) -> String {
    let mut text = String::new();
    for byte in path.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte) {
            text.push(char::from(byte));
        } else {
            let _ = write!(text, "%{byte:02X}");
        }
    }
    text
}

/// Width of a picture, pixels.
fn width(picture: &str) -> &str {
    let rest = picture.split_once("width=\"");
    rest.and_then(|(_, rest)| rest.split_once('"'))
        .map_or("0", |(width, _)| width)
}

/// What was run.
fn conditions(page: &mut String, c: &Conditions) {
    let seeds = match c.seeds {
        0 | 1 => format!("seed&nbsp;{}", c.first_seed),
        more => format!("seeds {} to&nbsp;{}", c.first_seed, c.first_seed + more - 1),
    };
    let unmapped = match &c.unmapped {
        Some(file) => format!(", cylinders from {}", escaped(file)),
        None => String::new(),
    };
    let _ = writeln!(
        page,
        "<p>Task {}, worlds {} ({}){unmapped}, body {}, sensors {}, {}&nbsp;m/s, {seeds}; {}.</p>",
        escaped(&c.task),
        escaped(&c.worlds),
        escaped(&c.numbers),
        escaped(&c.body),
        escaped(&c.sensors),
        c.speed,
        escaped(&c.disturbance),
    );
}

/// A row a controller, with 95 % intervals where there are some.
fn figures(page: &mut String, results: &[Results]) {
    table(page, &rows::figures(results), "Figures", "");
    page.push_str(
        "<p class=\"small\">Small print: 95&nbsp;% intervals, worlds resampled. Time: mean of the runs that reached the goal. Least clearance: \
         median over the runs. Cross-track, from the given route or the straight line, and yaw acceleration: RMS.</p>\n",
    );
}

/// What was asked for beside the figures: the sound robot, dead sensors, routes.
fn beside(page: &mut String, results: &[Results]) {
    if let Some(costs) = rows::costs(results) {
        page.push_str("<h2>The same with a sound robot</h2>\n");
        table(page, &costs, "The same with a sound robot", "");
    }
    for result in results {
        if let Some(dead) = &result.dead_sensors {
            let title = format!(
                "{}, one sensor dead",
                escaped(&result.conditions.controller)
            );
            let _ = writeln!(page, "<h2>{title}</h2>");
            table(page, &rows::dead_sensors(dead), &title, "");
            let _ = writeln!(page, "<p>{}.</p>", rows::worst(dead));
        }
    }
    if let Some(routes) = rows::routes(results) {
        page.push_str("<h2>Distance from the routes</h2>\n");
        table(
            page,
            &routes,
            "Distance from the routes",
            " class=\"words\"",
        );
    }
}

/// A table in a box of its own to scroll, which the keyboard reaches.
fn table(page: &mut String, rows: &rows::Table, label: &str, class: &str) {
    let _ = write!(
        page,
        "<div class=\"wide\" tabindex=\"0\" role=\"region\" aria-label=\"{label}\"><table{class}><tr>"
    );
    for heading in rows.headings {
        let _ = write!(page, "<th>{heading}");
    }
    page.push('\n');
    for row in &rows.rows {
        page.push_str("<tr>");
        for cell in row {
            let _ = write!(page, "<td>{}", escaped(&cell.text));
            if let Some(interval) = &cell.interval {
                let _ = write!(page, "<small>{interval}</small>");
            }
        }
        page.push('\n');
    }
    page.push_str("</table></div>\n");
}

/// What is seen in the pictures.
fn legend(page: &mut String, failures: &[Failure], planned: bool) {
    page.push_str("<p class=\"legend\">");
    for hue in MODES.iter().filter(|hue| hue.mode != "stop") {
        let mode = hue.mode;
        let _ = write!(
            page,
            "<span><i style=\"background:var(--mode-{mode})\"></i>{mode}</span> "
        );
    }
    let any = |of: fn(&Failure) -> bool| failures.iter().any(of);
    for (class, name, shown) in [
        (
            "route",
            if planned {
                "given route"
            } else {
                "straight line to the goal"
            },
            true,
        ),
        ("goal", "the goal's circle", true),
        ("start", "start", true),
        ("disc", "obstacle", true),
        (
            "unmapped",
            "obstacle that the route does not know",
            any(|f| f.unmapped),
        ),
        (
            "mover",
            "moving obstacle, where it was at the end",
            any(|f| f.moving),
        ),
        ("end", "robot where the run ended", true),
        (
            "touched",
            "touched something, at the cross",
            any(|f| f.ending == Ending::Collision),
        ),
    ] {
        if shown {
            let _ = write!(page, "<span><i class=\"{class}\"></i>{name}</span> ");
        }
    }
    page.push_str("<br>A picture opens the run's replay.</p>\n");
}

/// The worlds' figures, a line a controller and world.
pub fn per_world(results: &[Results]) -> String {
    let mut text = String::from("controller,world");
    for (name, _) in COLUMNS {
        let _ = write!(text, ",{name}");
    }
    text.push('\n');
    for result in results {
        for world in &result.per_world {
            let _ = write!(text, "{},{}", result.conditions.controller, world.world);
            for (_, cell) in COLUMNS {
                let _ = write!(text, ",{}", cell(&world.figures));
            }
            text.push('\n');
        }
    }
    text
}

type Cell = fn(&Figures) -> String;

/// Name in the CSV file, and the figure. Shares are from 0 to 1.
const COLUMNS: [(&str, Cell); 13] = [
    ("runs", |f| f.runs.to_string()),
    ("success", |f| format!("{:.4}", f.success)),
    ("collision", |f| format!("{:.4}", f.collision)),
    ("timeout", |f| format!("{:.4}", f.timeout)),
    ("blocked", |f| format!("{:.4}", f.blocked)),
    ("out_or_blocked", |f| format!("{:.4}", f.out_or_blocked)),
    ("score", |f| format!("{:.4}", f.score)),
    ("time_s", |f| {
        f.mean_time_s
            .map_or_else(String::new, |time| format!("{time:.2}"))
    }),
    ("min_clearance_m", |f| {
        format!("{:.3}", f.median_min_clearance_m)
    }),
    ("cross_track_rms_m", |f| {
        format!("{:.3}", f.cross_track_rms_m)
    }),
    ("yaw_acceleration_rms", |f| {
        format!("{:.2}", f.omega_rate_rms)
    }),
    ("longest_stall_s", |f| format!("{:.2}", f.longest_stall_s)),
    ("stalls", |f| f.stalls.to_string()),
];

/// The page up to its heading.
fn head(title: &str) -> String {
    format!(
        "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"><title>{title}</title><style>\n{}{STYLE}</style></head><body><main><h1>{title}</h1>\n",
        sheet(".runs svg")
    )
}

const STYLE: &str = ":root{--muted:#5f666e;--line:#e3e6e9}
@media (prefers-color-scheme:dark){:root{--muted:#9aa8b5;--line:#2b3640}}
body{font:15px/1.45 Ubuntu,Helvetica,Arial,sans-serif;color:var(--ink);background:var(--page);margin:min(2em,4vw)}main{max-width:80em;margin:auto}
a{color:inherit}p,code{overflow-wrap:anywhere}.small{color:var(--muted);font-size:13px}
.wide{overflow-x:auto}table{border-collapse:collapse;margin:1em 0}td,th{padding:.3em .8em;border-bottom:1px solid var(--line);text-align:right;vertical-align:top}
th{font-weight:600;color:var(--muted);vertical-align:bottom}td small{display:block;color:var(--muted);white-space:nowrap}
td:first-child,th:first-child{text-align:left;position:sticky;left:0;background:var(--page);white-space:nowrap}
.words td:nth-child(-n+3),.words th:nth-child(-n+3){text-align:left}
.runs{display:flex;flex-wrap:wrap;gap:1em;align-items:flex-start}.runs a{text-decoration:none;font-size:13px;max-width:100%}
.runs svg{display:block;box-sizing:border-box;max-width:100%;height:auto;border:1px solid var(--line);margin-bottom:.3em}.runs a:hover svg{border-color:var(--ink)}
.legend span{white-space:nowrap;margin-right:.9em}.legend i{display:inline-block;box-sizing:border-box;width:22px;height:3px;margin:0 .4em .25em 0}
.legend i.route{height:0;border-top:2px dashed var(--route)}
.legend i.goal,.legend i.start,.legend i.disc,.legend i.unmapped,.legend i.mover{width:10px;height:10px;border-radius:50%;margin-bottom:0}
.legend i.goal{width:14px;height:14px;border:1.5px solid var(--route);margin-bottom:-.15em}
.legend i.start{width:7px;height:7px;background:var(--ink);margin-bottom:.1em}.legend i.disc{background:var(--disc)}
.legend i.unmapped{border:2px solid var(--ink)}.legend i.mover{border:1px solid var(--disc);box-shadow:inset 0 0 0 2px var(--line);background:var(--line)}
.legend i.end,.legend i.touched{width:14px;height:12px;border:1.5px solid var(--ink);margin-bottom:-.1em}.legend i.touched{border-color:var(--mode-stop)}
";

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}
