//! The library's navigator behind the bench's trait: quantities at the edge, the route as a path, a scan to sectors.

use super::navigator::{Command, Inputs, Mission, Mode, Navigator};
use crate::recording::{BeamView, NavigatorView};
use crate::run::segment;
use crate::si;
use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::guide::{StoredPath, Waypoint};
use fuzzypilot::navigate::{
    Manoeuvre, NavigationRecord, Navigator as Engine, NavigatorParams, RangeSet, Setup, Task,
    presets,
};
use fuzzypilot::params::{Limits, Mount};
use fuzzypilot::ports::Range;
use fuzzypilot::tables::clutter::Peaks;
use fuzzypilot::units::{Angle, Metres};

/// The most sensors, or sectors of a lidar.
const SENSORS: usize = 32;

/// The most points of a path.
const POINTS: usize = 1024;

/// The most lines and arcs of one.
const PIECES: usize = 16;

/// Distance of a path's points, m; longer paths have them wider apart.
const SPACING: f64 = 0.15;

/// How often a planner's path is rounded: each time by a quarter of each neighbour. Ten times is a standard deviation of
/// 0.34 m, which makes a curve of the steps of a grid.
const ROUNDING: usize = 10;

/// See the module.
pub struct Ours {
    setup: Setup<SENSORS>,
    engine: Box<Engine<SENSORS>>,
    goal: Point,
    path: Option<Box<StoredPath<PIECES, POINTS>>>,
    /// Directions of a lidar's beams; none with single sensors.
    beams: Vec<Angle>,
    last: Option<NavigationRecord>,
}

impl Ours {
    /// For a mission.
    ///
    /// # Panics
    ///
    /// If the mission's robot or sensors are none that the library can drive.
    pub fn new(mission: &Mission) -> Self {
        Self::with(mission, preset(&mission.sensors).0)
    }

    /// With settings of one's own; body, limits, timing and sensors are the mission's.
    ///
    /// # Panics
    ///
    /// As [`Ours::new`].
    pub fn with(mission: &Mission, mut params: NavigatorParams<SENSORS>) -> Self {
        params.footprint = mission
            .body
            .footprint()
            .expect("the mission's body has few vertices");
        let limits = mission.limits;
        params.limits = Limits {
            speed: si::speed(limits.speed),
            yaw_rate: si::number(limits.yaw_rate),
            acceleration: si::number(limits.acceleration),
            yaw_acceleration: si::number(limits.yaw_acceleration),
            ..params.limits
        };
        params.reverse = si::speed(limits.reverse);
        params.period = si::seconds(mission.period);
        params.latency = si::seconds(mission.latency);
        // A larger body's corners sweep more.
        params.barrier.gate = params.barrier.gate.max(params.least_gate());
        let (sensors, beams) = sensors(&mission.sensors, &params.sensors);
        params.sensors = sensors;
        let setup = params.setup().expect("the mission's robot can be driven");
        let path = mission.planned.then(|| path(mission));
        let [x, y] = mission.goal;
        Self {
            setup,
            engine: Box::new(Engine::new()),
            goal: Point::new(si::metres(x), si::metres(y)),
            path,
            beams,
            last: None,
        }
    }
}

impl Navigator for Ours {
    fn tick(&mut self, inputs: &Inputs<'_>) -> Command {
        if self.beams.is_empty() {
            self.engine.see(&self.setup, inputs.ranges);
        } else {
            let ranges = inputs.ranges.iter().map(|reading| match reading.range {
                Range::Echo(range) => range,
                Range::Clear | Range::Invalid(_) => Metres::ZERO,
            });
            self.engine
                .see_scan(&self.setup, self.beams.iter().copied().zip(ranges));
        }
        let path = self.path.as_ref().and_then(|path| path.path());
        let task = match &path {
            Some(path) => Task::Path(path),
            None => Task::Goal(self.goal),
        };
        let record = self.engine.step(&self.setup, si::pose(inputs.pose), task);
        self.last = Some(record);
        Command {
            speed: si::from_speed(record.twist.linear),
            yaw_rate: si::from_rate(record.twist.angular),
            mode: match record.manoeuvre {
                Manoeuvre::Follow => Mode::Follow,
                Manoeuvre::Avoid => Mode::Avoid,
                Manoeuvre::Escape => Mode::Escape,
                Manoeuvre::Blocked => Mode::Blocked,
                Manoeuvre::Arrived => Mode::Arrived,
            },
        }
    }

    fn view(&self) -> Option<NavigatorView> {
        let record = self.last?;
        let points = self.engine.memory().points().map(|point| {
            let point = point.point();
            [si::from_metres(point.x), si::from_metres(point.y)]
        });
        let wanted = record.wanted;
        let seems_dead = |sensor: &usize| record.dead >> sensor & 1 == 1;
        Some(NavigatorView {
            points: points.collect(),
            heading: record.heading.map(|heading| si::from_angle(heading.angle)),
            direction: si::from_angle(record.direction),
            wanted: [si::from_speed(wanted.linear), si::from_rate(wanted.angular)],
            slowed: record.guarded.slowed,
            gated: record.guarded.gated,
            trapped: record.guarded.trapped,
            // Of a lidar these are sectors, not beams.
            dead: if self.beams.is_empty() {
                (0..SENSORS).filter(seems_dead).collect()
            } else {
                Vec::new()
            },
        })
    }
}

/// The library's preset for sensors like these, and the peaks of its rule tables.
pub fn preset(views: &[BeamView]) -> (NavigatorParams<SENSORS>, Peaks) {
    match views.len() {
        0..=6 => (presets::ultrasonic_five(), presets::five::PEAKS),
        7..=11 => (presets::jackal_eight(), presets::eight::PEAKS),
        12..=SENSORS => (presets::jackal(), presets::sixteen::PEAKS),
        _ => (presets::jackal_lidar(), presets::lidar::PEAKS),
    }
}

/// The mission's sensors as the library's; more than it takes are a lidar's beams, which it reduces to sectors.
fn sensors(views: &[BeamView], like: &RangeSet<SENSORS>) -> (RangeSet<SENSORS>, Vec<Angle>) {
    let at = |view: &BeamView| Point::new(si::metres(view.x), si::metres(view.y));
    let max_range = views.iter().map(|view| view.max_range).fold(0.0, f64::max);
    let max_range = si::metres(max_range.min(7.9));
    if views.len() <= SENSORS {
        let mounts = views.iter().map(|view| Mount {
            pose: Pose::new(at(view), si::angle(view.heading)),
            width: si::angle(view.width),
        });
        let set = RangeSet {
            mounts: mounts.collect(),
            max_range,
            max_age: like.max_age,
        };
        return (set, Vec::new());
    }
    let widest = views
        .iter()
        .map(|view| view.heading.abs())
        .fold(0.0, f64::max);
    let place = views.first().map(at).unwrap_or_default();
    let field = si::angle(2.0 * widest);
    let set = RangeSet::sectors(place, field, max_range, like.max_age);
    let beams = views.iter().map(|view| si::angle(view.heading)).collect();
    (set, beams)
}

/// The route as it is, of lines and arcs, or a planner's as [`waypoints`].
fn path(mission: &Mission) -> Box<StoredPath<PIECES, POINTS>> {
    let mut path = Box::new(StoredPath::new());
    if (1..=PIECES).contains(&mission.pieces.len()) {
        path.begin_segments(false);
        for piece in &mission.pieces {
            path.push_segment(segment(piece)).expect("there is room");
        }
        path.commit(false).expect("the pieces follow each other");
        return path;
    }
    path.begin_points(false);
    let mut points = waypoints(&mission.route, POINTS);
    // Where a route turns back on itself two may fall together.
    points.dedup_by_key(|point| point.at);
    for point in points {
        path.push_point(point).expect("there is room");
    }
    path.commit(false).expect("the route has a length");
    path
}

/// The route with evenly spaced points, `most` at most, rounded, and its tangents.
pub fn waypoints(route: &[[f64; 2]], most: usize) -> Vec<Waypoint> {
    let length: f64 = route.windows(2).map(|leg| distance(leg[0], leg[1])).sum();
    let count = ((length / SPACING).ceil() as usize).clamp(1, most - 1);
    let mut points = spaced(route, length / count as f64, count);
    for _ in 0..ROUNDING {
        let before = points.clone();
        for (point, around) in points.iter_mut().skip(1).zip(before.windows(3)) {
            *point = [0, 1].map(|k| 0.25 * around[0][k] + 0.5 * around[1][k] + 0.25 * around[2][k]);
        }
    }
    let last = points.len() - 1;
    (0..=last)
        .map(|i| {
            let (from, to) = (points[i.saturating_sub(1)], points[(i + 1).min(last)]);
            let heading = libm::atan2(to[1] - from[1], to[0] - from[0]);
            let [x, y] = points[i];
            si::pose([x, y, heading])
        })
        .collect()
}

fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
    libm::hypot(b[0] - a[0], b[1] - a[1])
}

/// `count` + 1 points along the route, both ends included.
fn spaced(route: &[[f64; 2]], spacing: f64, count: usize) -> Vec<[f64; 2]> {
    let mut points = Vec::with_capacity(count + 1);
    let mut before = 0.0;
    for leg in route.windows(2) {
        let length = distance(leg[0], leg[1]);
        while points.len() < count && points.len() as f64 * spacing <= before + length {
            let share = (points.len() as f64 * spacing - before) / length.max(1e-9);
            points.push([0, 1].map(|k| leg[0][k] + (leg[1][k] - leg[0][k]) * share));
        }
        before += length;
    }
    points.extend(route.last().copied());
    points
}
