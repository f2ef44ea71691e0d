//! The navigator on a recorded robot, open loop.
//!
//! Every 50 ms it gets the recorded pose, and the scan where one came in that time; between scans its sensors are silent and
//! its memory goes on. Its goal, or the end of its path, is a place on the recorded robot's own way ahead: as far as is asked for, and a new one when
//! half of that is left. What it decides is noted and nobody follows; so what it takes for its own last command is not what
//! the robot did.

use super::log::{Log, Scan};
use super::timeline::Timeline;
use crate::bench::body::BodyFrame;
use crate::si;
use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::guide::StoredPath;
use fuzzypilot::navigate::{
    Footprint, Manoeuvre, NavigationRecord, Navigator, NavigatorParams, RangeSet, Setup, Task,
    Vector, presets,
};
use fuzzypilot::params::ParamError;
use fuzzypilot::units::{Angle, Metres};
use std::collections::HashSet;
use std::f64::consts::TAU;

/// Sectors that a scan is reduced to.
const SECTORS: usize = 32;

/// Period of the navigator, s.
pub const PERIOD: f64 = 0.05;

/// Longest range that the navigator takes, m.
const REACH: f64 = 7.9;

/// What the navigator is given.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Given {
    /// A place to reach.
    Goal,
    /// The recorded robot's own way there, as a path to follow.
    Path,
}

/// How to replay.
#[derive(Clone, Debug)]
pub struct Settings {
    /// What the navigator is given.
    pub given: Given,
    /// The robot's outline.
    pub footprint: Footprint,
    /// Speed cap, m/s.
    pub speed: f64,
    /// How far ahead on the robot's own way the goal lies, m.
    pub look: f64,
}

/// What was decided in a tick.
#[derive(Clone, Debug)]
pub struct Decision {
    /// Since the first message, s.
    pub time: f64,
    /// The recorded pose: x, y (m), heading (rad).
    pub pose: [f64; 3],
    /// Whether a scan came.
    pub scanned: bool,
    /// Nearest beam's end to the outline, m, in a tick with a scan; infinite if nothing came back.
    pub nearest_beam: f64,
    /// The goal, m.
    pub goal: [f64; 2],
    /// What the navigator made of it.
    pub record: NavigationRecord,
}

/// A replay.
#[derive(Clone, Debug)]
pub struct Replay {
    /// A tick after the other.
    pub decisions: Vec<Decision>,
    /// Places of points that were remembered at some time, m, one for each 5 cm.
    pub remembered: Vec<[f64; 2]>,
}

/// Feeds a log to the navigator.
///
/// # Errors
///
/// What the navigator cannot drive with.
pub fn replay(
    log: &Log,
    timeline: &Timeline<'_>,
    settings: &Settings,
) -> Result<Replay, ParamError> {
    let setup = setup(log, settings)?;
    let outline = settings.footprint.outline();
    let mut navigator = Box::new(Navigator::<SECTORS>::new());
    // The navigator counts in 1/65536 m from where the robot began, wherever that is.
    let [x0, y0, _] = timeline.at_time(0.0).0;
    let local = |[x, y]: [f64; 2]| Point::new(si::metres(x - x0), si::metres(y - y0));
    let mut goal_way = f64::NEG_INFINITY;
    let mut goal = [x0, y0];
    let mut path = None;
    let mut decisions = Vec::new();
    let mut remembered = Remembered::default();
    let mut moments = timeline.moments.iter().peekable();
    let ticks = (timeline.duration() / PERIOD).ceil() as u64;
    for tick in 0..=ticks {
        let time = tick as f64 * PERIOD;
        let (mut pose, way) = timeline.at_time(time);
        let mut scan = None;
        while let Some(moment) = moments.next_if(|m| m.time <= time + 1e-9) {
            if let Some(seen) = moment.scan {
                scan = Some(seen);
                // Where the robot was when it saw that: at most a period ago.
                pose = moment.pose;
            }
        }
        if goal_way - way < settings.look / 2.0 && goal_way < timeline.length() {
            goal_way = (way + settings.look).min(timeline.length());
            let [x, y, _] = timeline.at_way(goal_way);
            goal = [x, y];
            path = match settings.given {
                Given::Goal => None,
                Given::Path => stretch(timeline, way, goal_way, &local),
            };
            navigator.restart();
        }

        let beams: Vec<(Angle, Metres)> = scan.map(|s| beams(s, log.mount[2])).unwrap_or_default();
        navigator.see_scan(&setup, beams.iter().copied());
        let mount = Point::new(si::metres(log.mount[0]), si::metres(log.mount[1]));
        let ends = beams.iter().filter(|(_, range)| *range > Metres::ZERO);
        let nearest_beam = ends
            .map(|(direction, range)| mount + Point::polar(*range, *direction))
            .map(|end| si::from_metres(outline.clearance(Vector::of(end)).metres()))
            .fold(f64::INFINITY, f64::min);
        let at = Pose::new(local([pose[0], pose[1]]), si::angle(pose[2]));
        let path = path.as_ref().and_then(|path| path.path());
        let task = path.as_ref().map_or(Task::Goal(local(goal)), Task::Path);
        let record = navigator.step(&setup, at, task);
        if scan.is_some() {
            let frame = BodyFrame::new(pose);
            for point in navigator.memory().points() {
                let point = point.point();
                let [u, v] = [si::from_metres(point.x), si::from_metres(point.y)];
                remembered.add(frame.tell([u, v]));
            }
        }
        decisions.push(Decision {
            time,
            pose,
            scanned: scan.is_some(),
            nearest_beam,
            goal,
            record,
        });
    }
    Ok(Replay {
        decisions,
        remembered: remembered.places,
    })
}

/// Most points of a stretch, and their distance where that is enough, m.
const POINTS: usize = 256;
const SPACING: f64 = 0.15;

/// The recorded way between two places of it as a path; none if that is too short to have a direction.
fn stretch(
    timeline: &Timeline<'_>,
    from: f64,
    to: f64,
    local: &dyn Fn([f64; 2]) -> Point,
) -> Option<Box<StoredPath<1, POINTS>>> {
    let count = (((to - from) / SPACING).floor() as usize).min(POINTS - 1);
    if count < 2 {
        return None;
    }
    let place = |k: usize| {
        let [x, y, _] = timeline.at_way(from + (to - from) * k as f64 / count as f64);
        [x, y]
    };
    let mut path = Box::new(StoredPath::new());
    path.begin_points(false);
    for k in 0..=count {
        let (behind, ahead) = (place(k.saturating_sub(1)), place((k + 1).min(count)));
        let heading = libm::atan2(ahead[1] - behind[1], ahead[0] - behind[0]);
        path.push_point(Pose::new(local(place(k)), si::angle(heading)))
            .ok()?;
    }
    path.commit(false).ok()?;
    Some(path)
}

/// Directions from the robot's front and ranges of a scan's beams; zero where nothing came back or nothing is within reach.
fn beams(scan: &Scan, heading: f64) -> Vec<(Angle, Metres)> {
    let reach = scan.max_range.min(REACH);
    let beam = |(k, range): (usize, &f64)| {
        let direction = heading + scan.first + scan.pitch * k as f64;
        let range = if *range < reach { *range } else { 0.0 };
        (si::angle(direction), si::metres(range))
    };
    scan.ranges.iter().enumerate().map(beam).collect()
}

/// The library's preset for a lidar with the log's laser and the settings' body.
fn setup(log: &Log, settings: &Settings) -> Result<Setup<SECTORS>, ParamError> {
    let preset: NavigatorParams<SECTORS> = presets::jackal_lidar();
    let scans = || log.events.iter().filter_map(|event| event.scan.as_ref());
    // Sectors lie about straight ahead: the field reaches as far as the beam that is farthest from there.
    let widest = scans()
        .flat_map(|scan| {
            let first = log.mount[2] + scan.first;
            let last = first + scan.pitch * (scan.ranges.len() as f64 - 1.0);
            [first.abs(), last.abs()].map(|aside| aside + scan.pitch / 2.0)
        })
        .fold(0.0, f64::max);
    let whole_turn = 2.0 * widest >= TAU;
    let field = if whole_turn {
        Angle::ZERO
    } else {
        si::angle(2.0 * widest)
    };
    let reach = scans().map(|scan| scan.max_range).fold(0.0, f64::max);
    let place = Point::new(si::metres(log.mount[0]), si::metres(log.mount[1]));
    let mut params = NavigatorParams {
        footprint: settings.footprint.clone(),
        limits: fuzzypilot::params::Limits {
            speed: si::speed(settings.speed),
            ..preset.limits
        },
        period: si::seconds(PERIOD),
        latency: si::seconds(PERIOD),
        sensors: RangeSet::sectors(
            place,
            field,
            si::metres(reach.min(REACH)),
            preset.sensors.max_age,
        ),
        ..preset
    };
    // A larger body's corners sweep more.
    params.barrier.gate = params.barrier.gate.max(params.least_gate());
    params.setup()
}

/// Name of a manoeuvre, for tables and pictures.
pub const fn name(manoeuvre: Manoeuvre) -> &'static str {
    match manoeuvre {
        Manoeuvre::Follow => "follow",
        Manoeuvre::Avoid => "avoid",
        Manoeuvre::Escape => "escape",
        Manoeuvre::Blocked => "blocked",
        Manoeuvre::Arrived => "arrived",
    }
}

/// Edge of a cell that keeps one remembered place, m.
const CELL: f64 = 0.05;

/// Places, one a cell.
#[derive(Default)]
struct Remembered {
    cells: HashSet<[i64; 2]>,
    places: Vec<[f64; 2]>,
}

impl Remembered {
    fn add(&mut self, place: [f64; 2]) {
        let cell = place.map(|x| (x / CELL).floor() as i64);
        if self.cells.insert(cell) {
            self.places.push(place);
        }
    }
}
