//! One run: a navigator, a world, a seed.

use super::arena::{Arena, Circle};
use super::body::{Body, BodyFrame, JACKAL};
use super::discs::Discs;
use super::navigator::{Command, Inputs, Mission, Mode, Navigator};
use super::odometry::{Drift, Odometry};
use super::ranging::{Disturbance, Ranging};
use super::score::barn;
use super::seeds::{Purpose, stream};
use super::vehicle::{Limits, STEPS, Vehicle};
use crate::recording::BeamView;
use fuzzypilot::ports::RangeReading;
use serde::{Deserialize, Serialize};

/// Ticks a second.
pub const RATE: f64 = 20.0;

/// Time between ticks, s.
pub const PERIOD: f64 = 1.0 / RATE;

/// Ticks from a command to its effect.
const LATENCY: usize = 1;

/// How far a robot must get from where it was to have made progress, m.
const PROGRESS: f64 = 0.4;

/// Who is near one place for longer, and does not say so, stalls, s.
pub const STALL: f64 = 5.0;

/// How long a navigator must report that it is blocked, or at the goal where it is not, for the run to end, s.
const PATIENCE: f64 = 10.0;

/// How far around the body clearances are measured, m. What is further away counts as this far.
pub const CLEARANCE_REACH: f64 = 1.0;

/// Whose pose decides whether the goal is reached.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Arrival {
    /// The true one.
    True,
    /// The one that odometry believes.
    Believed,
}

/// Which sensor is dead: it never hears anything, and does not know it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Dead {
    /// None.
    None,
    /// This one, counted from 0, from the right.
    One(usize),
    /// The one whose number is the seed, modulo their count: sixteen seeds are each of sixteen once.
    BySeed,
}

impl Dead {
    /// The dead one of `count` in a seed's run.
    pub fn sensor(self, seed: u64, count: usize) -> Option<usize> {
        match self {
            Self::None => None,
            Self::One(sensor) => Some(sensor),
            Self::BySeed => Some((seed % count.max(1) as u64) as usize),
        }
    }
}

/// All that is the same for every run of a campaign.
#[derive(Clone, Debug)]
pub struct Setting {
    /// The body.
    pub body: Body,
    /// What it can do.
    pub limits: Limits,
    /// Its sensors.
    pub sensors: Vec<BeamView>,
    /// How wrong these are.
    pub disturbance: Disturbance,
    /// Which of them is dead.
    pub dead: Dead,
    /// How wrong odometry is.
    pub drift: Drift,
    /// Whose pose decides.
    pub arrival: Arrival,
    /// Whether the navigator is given the planner's path, or only the straight line.
    pub planned: bool,
    /// Longest run, s.
    pub time_limit: f64,
}

impl Setting {
    /// The Jackal with given sensors, mildly noisy, exact odometry, 100 s.
    pub fn new(sensors: Vec<BeamView>, speed: f64, planned: bool) -> Self {
        Self {
            body: JACKAL,
            limits: super::vehicle::limits(speed),
            sensors,
            disturbance: Disturbance::MILD,
            dead: Dead::None,
            drift: Drift::default(),
            arrival: Arrival::True,
            planned,
            time_limit: 100.0,
        }
    }

    /// The same robot with nothing wrong: mild noise, all sensors alive, exact odometry.
    pub fn sound(&self) -> Self {
        Self {
            disturbance: Disturbance::MILD,
            dead: Dead::None,
            drift: Drift::default(),
            ..self.clone()
        }
    }

    /// What a navigator is told in a world.
    pub fn mission(&self, arena: &Arena) -> Mission {
        let [x, y, _] = arena.start;
        Mission {
            start: arena.start,
            goal: arena.goal,
            goal_radius: arena.goal_radius,
            pieces: match &arena.course {
                Some(course) if self.planned => course.pieces.clone(),
                _ => Vec::new(),
            },
            route: if self.planned {
                arena.route.clone()
            } else {
                vec![[x, y], arena.goal]
            },
            planned: self.planned,
            body: self.body.clone(),
            limits: self.limits,
            sensors: self.sensors.clone(),
            period: PERIOD,
            latency: LATENCY as f64 * PERIOD,
        }
    }
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Ending {
    /// At the goal.
    Reached,
    /// The body touched something.
    Collision,
    /// Out of time, or stopped for good where the navigator took another place for the goal.
    Timeout,
    /// The navigator reported that there is no way, and kept to it.
    Blocked,
}

impl Ending {
    /// In words, the same ones everywhere.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Reached => "reached",
            Self::Collision => "collision",
            Self::Timeout => "out of time",
            Self::Blocked => "blocked",
        }
    }
}

/// What came out of a run.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// How it ended.
    pub ending: Ending,
    /// How long it took, s.
    pub time_s: f64,
    /// The benchmark's score, 0 to 0.5.
    pub score: f64,
    /// Least distance of the body from anything, m; 1 if nothing was nearer, at or below 0 after a collision.
    pub min_clearance_m: f64,
    /// RMS distance of the body's centre from the given route, the straight line included, m.
    pub cross_track_rms_m: f64,
    /// Largest of these distances, m.
    #[serde(default)]
    pub cross_track_max_m: f64,
    /// RMS change of the commanded yaw rate, rad/s².
    pub omega_rate_rms: f64,
    /// Longest time within 0.4 m of one place without reporting that it is blocked or there, s.
    pub longest_stall_s: f64,
    /// How often that was longer than 5 s.
    #[serde(default)]
    pub stalls: u32,
}

/// What an observer sees of a tick, before the command acts.
#[derive(Clone, Copy, Debug)]
pub struct Step<'a> {
    /// Since the start, s.
    pub time: f64,
    /// True pose.
    pub pose: [f64; 3],
    /// Pose as odometry has it.
    pub believed: [f64; 3],
    /// True speed and yaw rate.
    pub twist: [f64; 2],
    /// What was seen.
    pub ranges: &'a [RangeReading],
    /// What the navigator wants.
    pub command: Command,
    /// Distance of the body from the nearest surface, at most 1 m.
    pub clearance: f64,
    /// Signed distance of the body's centre from the route, left positive, m.
    pub cross_track: f64,
    /// Place of the route that is nearest to the body's centre, m along it.
    pub way: f64,
    /// Who decided.
    pub navigator: &'a (dyn Navigator + 'a),
}

/// Where a run ended: up to a period after its last tick, in the middle of a motion.
#[derive(Clone, Copy, Debug)]
pub struct End {
    /// Since the start, s.
    pub time: f64,
    /// True pose.
    pub pose: [f64; 3],
    /// Pose as odometry has it.
    pub believed: [f64; 3],
    /// True speed and yaw rate.
    pub twist: [f64; 2],
    /// Distance of the body from the nearest surface, at most 1 m; at or below zero it touches.
    pub clearance: f64,
    /// Signed distance of the body's centre from the route, left positive, m.
    pub cross_track: f64,
    /// Place of the body's edge that touched something, m; none if nothing was touched.
    pub contact: Option<[f64; 2]>,
}

/// Drives a navigator through a world. `discs` are the world's circles, binned once for all its runs.
pub fn drive(
    arena: &Arena,
    discs: &Discs,
    setting: &Setting,
    seed: u64,
    navigator: &mut dyn Navigator,
    observe: &mut dyn FnMut(&Step<'_>),
) -> Outcome {
    drive_to_end(arena, discs, setting, seed, navigator, observe).0
}

/// [`drive`], and where it ended, which no tick sees.
pub fn drive_to_end(
    arena: &Arena,
    discs: &Discs,
    setting: &Setting,
    seed: u64,
    navigator: &mut dyn Navigator,
    observe: &mut dyn FnMut(&Step<'_>),
) -> (Outcome, End) {
    let mission = setting.mission(arena);
    let ways = ways(&mission.route);
    let mut noise = stream(seed, arena.number, Purpose::Ranges);
    let mut errors = stream(seed, arena.number, Purpose::Odometry);
    let mut odometry = Odometry::new(setting.drift, arena.start, &mut errors);
    let dead = setting.dead.sensor(seed, setting.sensors.len());
    let mut ranging = Ranging::new(&setting.sensors, setting.disturbance, dead);
    let mut vehicle = Vehicle::new(setting.limits, arena.start, LATENCY);
    let mut watch = Watch::new(arena.start);
    let mut near = Vec::new();
    let mut close = Vec::new();
    let ticks = (setting.time_limit * RATE).round() as u64;
    // What the body may come near to within a tick.
    let close_reach = setting.body.outer_radius() + CLEARANCE_REACH + setting.limits.speed * PERIOD;
    gather(arena, discs, vehicle.pose, 0.0, close_reach, &mut close);
    let mut clearance = body_clearance(&setting.body, vehicle.pose, &close);
    watch.min_clearance = clearance;
    let (ending, time) = 'run: {
        if clearance <= 0.0 {
            break 'run (Ending::Collision, 0.0);
        }
        for tick in 0..ticks {
            let time = tick as f64 * PERIOD;
            gather(arena, discs, vehicle.pose, time, ranging.reach, &mut near);
            ranging.look(vehicle.pose, &near, &mut noise);
            let command = setting.limits.admit(navigator.tick(&Inputs {
                time,
                pose: odometry.pose,
                twist: odometry.twist,
                ranges: &ranging.readings,
            }));
            let (cross_track, way) = beside(&mission.route, &ways, vehicle.pose);
            observe(&Step {
                time,
                pose: vehicle.pose,
                believed: odometry.pose,
                twist: vehicle.twist,
                ranges: &ranging.readings,
                command,
                clearance,
                cross_track,
                way,
                navigator: &*navigator,
            });
            watch.see(time, vehicle.pose, cross_track, command);
            if watch.given_up(time) {
                let ending = match command.mode {
                    Mode::Blocked => Ending::Blocked,
                    _ => Ending::Timeout,
                };
                break 'run (ending, time);
            }

            vehicle.command(command);
            gather(arena, discs, vehicle.pose, time, close_reach, &mut close);
            let dt = PERIOD / STEPS as f64;
            for step in 1..=STEPS {
                let before = vehicle.twist;
                vehicle.advance(dt);
                let mean = [0, 1].map(|k| (before[k] + vehicle.twist[k]) / 2.0);
                odometry.observe(vehicle.pose, vehicle.twist, mean, dt);
                let now = time + step as f64 * dt;
                move_along(arena, now, &mut close);
                clearance = body_clearance(&setting.body, vehicle.pose, &close);
                watch.min_clearance = watch.min_clearance.min(clearance);
                if clearance <= 0.0 {
                    break 'run (Ending::Collision, now);
                }
                let judged = match setting.arrival {
                    Arrival::True => vehicle.pose,
                    Arrival::Believed => odometry.pose,
                };
                let [dx, dy] = [0, 1].map(|k| judged[k] - arena.goal[k]);
                if dx * dx + dy * dy <= arena.goal_radius * arena.goal_radius {
                    break 'run (Ending::Reached, now);
                }
            }
        }
        (Ending::Timeout, setting.time_limit)
    };
    let success = ending == Ending::Reached;
    let end = End {
        time,
        pose: vehicle.pose,
        believed: odometry.pose,
        twist: vehicle.twist,
        clearance,
        cross_track: beside(&mission.route, &ways, vehicle.pose).0,
        contact: touched(&setting.body, vehicle.pose, &close),
    };
    let outcome = watch.outcome(ending, time, barn(success, time, arena.route_length()));
    (outcome, end)
}

/// All circles within `reach` of a pose; the moving ones come last, all of them.
fn gather(
    arena: &Arena,
    discs: &Discs,
    pose: [f64; 3],
    time: f64,
    reach: f64,
    found: &mut Vec<Circle>,
) {
    found.clear();
    discs.near([pose[0], pose[1]], reach, found);
    found.extend(arena.movers.iter().map(|m| m.at(time)));
}

/// Brings the moving circles at the end of a list to where they are at `time`.
fn move_along(arena: &Arena, time: f64, circles: &mut [Circle]) {
    let still = circles.len() - arena.movers.len();
    for (circle, mover) in circles[still..].iter_mut().zip(&arena.movers) {
        *circle = mover.at(time);
    }
}

/// Distance of a body from the nearest circle, at most 1 m; at or below zero is contact.
pub fn body_clearance(body: &Body, pose: [f64; 3], circles: &[Circle]) -> f64 {
    let frame = BodyFrame::new(pose);
    circles.iter().fold(CLEARANCE_REACH, |least, c| {
        let p = frame.see(c.at);
        // Most circles are further away than what was found already: no root for them.
        let far = least + c.radius;
        if far > 0.0 && body.distance_squared(p) >= far * far {
            least
        } else {
            least.min(body.distance(p) - c.radius)
        }
    })
}

/// Place of a body's edge that touches one of the circles, in the world, m; none if nothing does.
fn touched(body: &Body, pose: [f64; 3], circles: &[Circle]) -> Option<[f64; 2]> {
    let frame = BodyFrame::new(pose);
    let depth = |c: &Circle| body.distance(frame.see(c.at)) - c.radius;
    let deepest = circles
        .iter()
        .min_by(|a, b| depth(a).total_cmp(&depth(b)))?;
    (depth(deepest) <= 0.0).then(|| frame.tell(body.nearest(frame.see(deepest.at))))
}

/// How far along a polyline its points are, m.
fn ways(route: &[[f64; 2]]) -> Vec<f64> {
    let mut way = 0.0;
    let steps = route.windows(2).map(|w| {
        way += libm::hypot(w[1][0] - w[0][0], w[1][1] - w[0][1]);
        way
    });
    std::iter::once(0.0).chain(steps).collect()
}

/// Signed distance from a polyline, left of it positive, and how far along it the nearest place is, m; zero if it has no
/// length. `ways` are its points' own.
fn beside(route: &[[f64; 2]], ways: &[f64], [x, y, _]: [f64; 3]) -> (f64, f64) {
    let mut best = (f64::INFINITY, 0.0, 0.0);
    for (w, way) in route.windows(2).zip(ways.windows(2)) {
        let (ex, ey) = (w[1][0] - w[0][0], w[1][1] - w[0][1]);
        let (px, py) = (x - w[0][0], y - w[0][1]);
        let length2 = ex * ex + ey * ey;
        if length2 == 0.0 {
            continue;
        }
        let share = ((px * ex + py * ey) / length2).clamp(0.0, 1.0);
        let (qx, qy) = (px - share * ex, py - share * ey);
        let squared = qx * qx + qy * qy;
        if squared < best.0 {
            let along = way[0] + share * (way[1] - way[0]);
            best = (squared, ex * py - ey * px, along);
        }
    }
    if best.0.is_finite() {
        (best.0.sqrt().copysign(best.1), best.2)
    } else {
        (0.0, 0.0)
    }
}

/// What is measured along the way.
struct Watch {
    min_clearance: f64,
    cross_track: f64,
    most_cross_track: f64,
    omega_rate: f64,
    ticks: u64,
    last_omega: f64,
    anchor: [f64; 2],
    anchored: f64,
    longest_stall: f64,
    stalls: u32,
    /// Whether the time at the anchor counts as a stall already.
    stalled: bool,
    /// Since when it says so, if it says that it is blocked or there.
    standing: Option<(Mode, f64)>,
}

impl Watch {
    fn new([x, y, _]: [f64; 3]) -> Self {
        Self {
            min_clearance: CLEARANCE_REACH,
            cross_track: 0.0,
            most_cross_track: 0.0,
            omega_rate: 0.0,
            ticks: 0,
            last_omega: 0.0,
            anchor: [x, y],
            anchored: 0.0,
            longest_stall: 0.0,
            stalls: 0,
            stalled: false,
            standing: None,
        }
    }

    fn see(&mut self, time: f64, [x, y, _]: [f64; 3], cross_track: f64, command: Command) {
        self.cross_track += cross_track * cross_track;
        self.most_cross_track = self.most_cross_track.max(cross_track.abs());
        let change = (command.yaw_rate - self.last_omega) * RATE;
        self.omega_rate += change * change;
        self.last_omega = command.yaw_rate;
        self.ticks += 1;

        let excused = matches!(command.mode, Mode::Blocked | Mode::Arrived);
        let moved = libm::hypot(x - self.anchor[0], y - self.anchor[1]) >= PROGRESS;
        if excused || moved {
            (self.anchor, self.anchored) = ([x, y], time);
            self.stalled = false;
        }
        let stood = time - self.anchored;
        self.longest_stall = self.longest_stall.max(stood);
        if stood > STALL + PERIOD / 2.0 && !self.stalled {
            self.stalled = true;
            self.stalls += 1;
        }
        self.standing = match self.standing {
            Some((mode, since)) if mode == command.mode => Some((mode, since)),
            _ if excused => Some((command.mode, time)),
            _ => None,
        };
    }

    fn given_up(&self, time: f64) -> bool {
        self.standing
            .is_some_and(|(_, since)| time - since >= PATIENCE)
    }

    fn outcome(&self, ending: Ending, time: f64, score: f64) -> Outcome {
        let rms = |sum: f64| (sum / self.ticks.max(1) as f64).sqrt();
        Outcome {
            ending,
            time_s: time,
            score,
            min_clearance_m: self.min_clearance,
            cross_track_rms_m: rms(self.cross_track),
            cross_track_max_m: self.most_cross_track,
            omega_rate_rms: rms(self.omega_rate),
            longest_stall_s: self.longest_stall,
            stalls: self.stalls,
        }
    }
}
