//! What the printed tables and the page's say, cell by cell, so that both say the same.

use super::attempt::CLEARANCE_REACH;
use super::cost::{DeadSensor, DeadSensors};
use super::results::Results;

/// A table.
#[derive(Clone, Debug)]
pub struct Table {
    /// Its columns.
    pub headings: &'static [&'static str],
    /// Its rows, of as many cells.
    pub rows: Vec<Vec<Cell>>,
}

/// A cell.
#[derive(Clone, Debug)]
pub struct Cell {
    /// What it says.
    pub text: String,
    /// The 95 % interval of that, where it has one.
    pub interval: Option<String>,
}

impl From<String> for Cell {
    fn from(text: String) -> Self {
        Self {
            text,
            interval: None,
        }
    }
}

/// What there is no figure for.
const NONE: &str = "–";

/// A number with a real minus sign, and none before a zero.
fn number(x: f64, digits: usize) -> String {
    let text = format!("{x:.digits$}");
    match text.strip_prefix('-') {
        Some(size) if size.bytes().any(|c| (b'1'..=b'9').contains(&c)) => format!("−{size}"),
        Some(zero) => zero.to_owned(),
        None => text,
    }
}

fn per_cent(share: f64) -> String {
    number(100.0 * share, 1)
}

fn share(x: f64, interval: [f64; 2]) -> Cell {
    between(per_cent(x), interval, per_cent)
}

/// A figure with its interval, none where that says no more than the figure.
fn between(text: String, interval: [f64; 2], show: impl Fn(f64) -> String) -> Cell {
    let [low, high] = interval.map(show);
    let interval = (low != text || high != text).then(|| format!("{low}–{high}"));
    Cell { text, interval }
}

/// A least clearance, m, as far as it is measured: how deep a contact was is the step's doing.
fn clearance(x: f64) -> String {
    if x >= CLEARANCE_REACH {
        format!("≥ {CLEARANCE_REACH}")
    } else if x > 0.0 {
        number(x, 3)
    } else {
        "contact".to_owned()
    }
}

/// A row a controller; intervals are 95 %, worlds resampled.
pub fn figures(results: &[Results]) -> Table {
    let row = |result: &Results| {
        let (f, i) = (&result.figures, &result.intervals_95);
        vec![
            result.conditions.controller.clone().into(),
            f.runs.to_string().into(),
            share(f.success, i.success_worlds),
            share(f.collision, i.collision_worlds),
            per_cent(f.timeout).into(),
            per_cent(f.blocked).into(),
            per_cent(f.out_or_blocked).into(),
            between(number(f.score, 4), i.score_worlds, |x| number(x, 4)),
            match (f.mean_time_s, i.mean_time_s_worlds) {
                (Some(time), Some(interval)) => {
                    between(number(time, 1), interval, |x| number(x, 1))
                }
                (time, _) => time
                    .map_or_else(|| NONE.to_owned(), |time| number(time, 1))
                    .into(),
            },
            between(
                clearance(f.median_min_clearance_m),
                i.median_min_clearance_m_worlds,
                clearance,
            ),
            between(
                number(f.cross_track_rms_m, 3),
                i.cross_track_rms_m_worlds,
                |x| number(x, 3),
            ),
            between(number(f.omega_rate_rms, 1), i.omega_rate_rms_worlds, |x| {
                number(x, 1)
            }),
            number(f.longest_stall_s, 1).into(),
            f.stalls.to_string().into(),
        ]
    };
    Table {
        headings: &[
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
        ],
        rows: results.iter().map(row).collect(),
    }
}

/// What trouble costs against a sound robot, a row a controller; none if no sound one was driven.
pub fn costs(results: &[Results]) -> Option<Table> {
    let row = |result: &Results| {
        let sound = result.sound.as_ref()?;
        let f = &sound.figures;
        let row: Vec<Cell> = [
            result.conditions.controller.clone(),
            f.runs.to_string(),
            per_cent(f.success),
            per_cent(sound.lost_success),
            per_cent(f.collision),
            per_cent(sound.more_collision),
            number(f.score, 4),
            number(sound.lost_score, 4),
        ]
        .map(Cell::from)
        .into();
        Some(row)
    };
    let rows: Vec<Vec<Cell>> = results.iter().filter_map(row).collect();
    (!rows.is_empty()).then_some(Table {
        headings: &[
            "controller",
            "runs",
            "success %",
            "points lost",
            "collision %",
            "points more",
            "score",
            "lost",
        ],
        rows,
    })
}

/// Sensors that were dead one at a time.
pub fn dead_sensors(dead: &DeadSensors) -> Table {
    let row = |sensor: &DeadSensor| {
        vec![
            sensor.sensor.to_string().into(),
            sensor.runs.to_string().into(),
            share(sensor.success, sensor.success_95),
            sensor.lost_success.map(per_cent).unwrap_or_default().into(),
            per_cent(sensor.collision).into(),
            number(sensor.score, 4).into(),
        ]
    };
    Table {
        headings: &[
            "dead",
            "runs",
            "success %",
            "points lost",
            "collision %",
            "score",
        ],
        rows: dead.sensors.iter().map(row).collect(),
    }
}

/// Which of them is the worst, in words; that none is, where all are alike.
pub fn worst(dead: &DeadSensors) -> String {
    let worst = &dead.worst;
    let alike = |s: &DeadSensor| s.success == worst.success && s.collision == worst.collision;
    let figures = format!(
        "success {} %, collision {} %",
        per_cent(worst.success),
        per_cent(worst.collision)
    );
    if dead.sensors.iter().all(alike) {
        return format!("none is worse than another: {figures}");
    }
    let lost = worst.lost_success.map_or_else(String::new, |lost| {
        format!(", {} points lost", per_cent(lost))
    });
    format!("worst: sensor {}, {figures}{lost}", worst.sensor)
}

/// How far from routes of known shape the runs were, a row a stretch; none if there is no such route. A robot that
/// crashed soon was near its route as long as it drove: where none reached the end there is no figure.
pub fn routes(results: &[Results]) -> Option<Table> {
    let mut rows: Vec<Vec<Cell>> = Vec::new();
    for result in results {
        for world in &result.per_world {
            let Some(route) = &world.route else {
                continue;
            };
            let reached = world.figures.success > 0.0;
            let figure = |text: String| if reached { text } else { NONE.to_owned() };
            for tracked in &world.tracking {
                let regained = match tracked.pass {
                    None => String::new(),
                    Some(pass) => figure(match pass.regained_after_m {
                        None => "never".to_owned(),
                        Some(way) => number(way, 2),
                    }),
                };
                let row = [
                    result.conditions.controller.clone(),
                    route.clone(),
                    tracked.stretch.clone(),
                    figure(number(tracked.rms_m, 4)),
                    figure(number(tracked.max_m, 4)),
                    regained,
                    number(100.0 * world.figures.success, 0),
                ];
                rows.push(row.map(Cell::from).into());
            }
        }
    }
    (!rows.is_empty()).then_some(Table {
        headings: &[
            "controller",
            "route",
            "stretch",
            "RMS m",
            "largest m",
            "on it again after m",
            "reached %",
        ],
        rows,
    })
}
