//! The report of a campaign: a page with its figures and a small picture of every failed run that opens its replay, and
//! the worlds' figures as CSV.

mod picture;

pub use picture::picture;

use super::attempt::Ending;
use super::results::{Figures, Results};
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

/// The page. `left_out` is the number of failed runs that have no picture.
pub fn page(results: &[Results], failures: &[Failure], left_out: usize) -> String {
    let mut page = String::from(HEAD);
    if let Some(first) = results.first() {
        let c = &first.conditions;
        let _ = writeln!(
            page,
            "<p>Task {}, worlds {} ({}), sensors {}, {} m/s, seeds {} to {}. {}.</p>",
            escaped(&c.task),
            escaped(&c.worlds),
            escaped(&c.numbers),
            escaped(&c.sensors),
            c.speed,
            c.first_seed,
            c.first_seed + c.seeds.saturating_sub(1),
            escaped(&c.disturbance),
        );
    }
    page.push_str("<table><tr><th>controller");
    for (heading, _) in COLUMNS {
        let _ = write!(page, "<th>{heading}");
    }
    page.push('\n');
    for result in results {
        let _ = write!(page, "<tr><td>{}", escaped(&result.conditions.controller));
        for (_, cell) in COLUMNS {
            let _ = write!(page, "<td>{}", cell(&result.figures));
        }
        page.push('\n');
    }
    page.push_str("</table>\n");
    for result in results {
        let name = &result.conditions.controller;
        let own: Vec<&Failure> = failures.iter().filter(|f| f.controller == *name).collect();
        if own.is_empty() {
            continue;
        }
        let _ = writeln!(page, "<h2>{}: runs that failed</h2>\n<div>", escaped(name));
        for f in own {
            let _ = writeln!(
                page,
                "<a href=\"{}\">{}<br>world {}, seed {}: {} at {:.1} s</a>",
                f.replay,
                f.picture,
                f.world,
                f.seed,
                words(f.ending),
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
    page.push_str("</body></html>\n");
    page
}

/// The worlds' figures, a line a controller and world.
pub fn per_world(results: &[Results]) -> String {
    let mut text = String::from("controller,world");
    for (heading, _) in COLUMNS {
        let _ = write!(text, ",{heading}");
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

const COLUMNS: [(&str, Cell); 10] = [
    ("runs", |f| f.runs.to_string()),
    ("success", |f| format!("{:.4}", f.success)),
    ("collision", |f| format!("{:.4}", f.collision)),
    ("timeout", |f| format!("{:.4}", f.timeout)),
    ("blocked", |f| format!("{:.4}", f.blocked)),
    ("score", |f| format!("{:.4}", f.score)),
    ("time_s", |f| format!("{:.2}", f.mean_time_s)),
    ("min_clearance_m", |f| {
        format!("{:.3}", f.median_min_clearance_m)
    }),
    ("yaw_acceleration_rms", |f| {
        format!("{:.2}", f.omega_rate_rms)
    }),
    ("longest_stall_s", |f| format!("{:.2}", f.longest_stall_s)),
];

const HEAD: &str = "<!doctype html><html lang=\"en\"><head><meta charset=\"utf-8\"><title>Navigation bench</title><style>
body{font:14px sans-serif;margin:2em;max-width:80em}
table{border-collapse:collapse}td,th{padding:.2em .7em;border-bottom:1px solid #ccc;text-align:right}
td:first-child,th:first-child{text-align:left}
div{display:flex;flex-wrap:wrap;gap:1em}a{color:#333;text-decoration:none;font-size:12px}svg{border:1px solid #ccc}
</style></head><body><h1>Navigation bench</h1>
";

fn words(ending: Ending) -> &'static str {
    match ending {
        Ending::Reached => "reached",
        Ending::Collision => "collision",
        Ending::Timeout => "out of time",
        Ending::Blocked => "blocked",
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;")
        .replace('<', "&lt;")
        .replace('"', "&quot;")
}
