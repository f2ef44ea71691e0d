//! The table that a bench prints.

use comfy_table::{Table, presets::UTF8_FULL_CONDENSED};
use host_sim::bench::cost::DeadSensors;
use host_sim::bench::results::Results;

/// All that a bench has to say: the controllers, and what was asked for beside them.
pub fn all(results: &[Results]) -> String {
    let mut text = format!("{}\n", of(results));
    if results.iter().any(|r| r.sound.is_some()) {
        text += &format!("\nThe same with a sound robot:\n{}\n", costs(results));
    }
    for result in results {
        if let Some(dead) = &result.dead_sensors {
            text += &dead_sensors(result, dead);
        }
    }
    if results
        .iter()
        .any(|r| r.per_world.iter().any(|w| w.route.is_some()))
    {
        text += &format!("\nDistance from the routes:\n{}\n", routes(results));
    }
    text
}

/// A row a controller. Intervals are 95 %, worlds resampled.
fn of(results: &[Results]) -> Table {
    let mut table = new([
        "controller",
        "runs",
        "success %",
        "collision %",
        "out of time %",
        "blocked %",
        "out or blocked %",
        "score",
        "time s",
        "least clearance m",
        "cross-track m",
        "yaw acc. rad/s²",
        "longest stall s",
        "stalls > 5 s",
    ]);
    for result in results {
        let f = &result.figures;
        let i = &result.intervals_95;
        let share = |x: f64, [low, high]: [f64; 2]| {
            format!("{:.1} ({:.1}–{:.1})", 100.0 * x, 100.0 * low, 100.0 * high)
        };
        table.add_row([
            result.conditions.controller.clone(),
            f.runs.to_string(),
            share(f.success, i.success_worlds),
            share(f.collision, i.collision_worlds),
            format!("{:.1}", 100.0 * f.timeout),
            format!("{:.1}", 100.0 * f.blocked),
            format!("{:.1}", 100.0 * f.out_or_blocked),
            format!(
                "{:.4} ({:.3}–{:.3})",
                f.score, i.score_worlds[0], i.score_worlds[1]
            ),
            format!("{:.1}", f.mean_time_s),
            format!("{:.3}", f.median_min_clearance_m),
            format!("{:.3}", f.cross_track_rms_m),
            format!("{:.1}", f.omega_rate_rms),
            format!("{:.1}", f.longest_stall_s),
            f.stalls.to_string(),
        ]);
    }
    table
}

fn new<const N: usize>(header: [&str; N]) -> Table {
    let mut table = Table::new();
    table.load_style(UTF8_FULL_CONDENSED);
    table.set_header(header);
    table
}

/// What the trouble costs.
fn costs(results: &[Results]) -> Table {
    let mut table = new([
        "controller",
        "runs",
        "success %",
        "points lost",
        "collision %",
        "points more",
        "score",
        "lost",
    ]);
    for result in results {
        let Some(sound) = &result.sound else {
            continue;
        };
        let f = &sound.figures;
        table.add_row([
            result.conditions.controller.clone(),
            f.runs.to_string(),
            format!("{:.1}", 100.0 * f.success),
            points(sound.lost_success),
            format!("{:.1}", 100.0 * f.collision),
            points(sound.more_collision),
            format!("{:.4}", f.score),
            format!("{:.4}", sound.lost_score),
        ]);
    }
    table
}

/// A difference of shares as points. No minus before a zero.
fn points(share: f64) -> String {
    let tenths = (1000.0 * share).round() / 10.0 + 0.0;
    format!("{tenths:.1}")
}

fn dead_sensors(result: &Results, dead: &DeadSensors) -> String {
    let mut table = new([
        "dead",
        "runs",
        "success %",
        "points lost",
        "collision %",
        "score",
    ]);
    for sensor in &dead.sensors {
        let [low, high] = sensor.success_95;
        table.add_row([
            sensor.sensor.to_string(),
            sensor.runs.to_string(),
            format!(
                "{:.1} ({:.1}–{:.1})",
                100.0 * sensor.success,
                100.0 * low,
                100.0 * high
            ),
            sensor.lost_success.map_or_else(String::new, points),
            format!("{:.1}", 100.0 * sensor.collision),
            format!("{:.4}", sensor.score),
        ]);
    }
    let worst = &dead.worst;
    let lost = worst.lost_success.map_or_else(String::new, |lost| {
        format!(", {} points lost", points(lost))
    });
    format!(
        "\n{}, one sensor dead:\n{table}\nworst: sensor {}, success {:.1} %, collision {:.1} %{lost}\n",
        result.conditions.controller,
        worst.sensor,
        100.0 * worst.success,
        100.0 * worst.collision,
    )
}

fn routes(results: &[Results]) -> Table {
    let mut table = new([
        "controller",
        "route",
        "stretch",
        "RMS m",
        "largest m",
        "on it again after m",
        "reached %",
    ]);
    for result in results {
        for world in &result.per_world {
            let Some(route) = &world.route else {
                continue;
            };
            for tracked in &world.tracking {
                let regained = match tracked.pass {
                    None => String::new(),
                    Some(pass) => pass
                        .regained_after_m
                        .map_or_else(|| "never".to_owned(), |way| format!("{way:.2}")),
                };
                table.add_row([
                    result.conditions.controller.clone(),
                    route.clone(),
                    tracked.stretch.clone(),
                    format!("{:.4}", tracked.rms_m),
                    format!("{:.4}", tracked.max_m),
                    regained,
                    format!("{:.0}", 100.0 * world.figures.success),
                ]);
            }
        }
    }
    table
}
