//! The loop: plant and sensors around the library's own tick, which is computed here or by a [`Controller`] elsewhere.

use crate::driving::Fine;
use crate::params::params;
use crate::plant::{Plant, PlantSettings, command_timeout};
use crate::recording::BeamView;
use crate::robot::beams;
use crate::scenario::{PathForm, Scenario};
use crate::sensors::{SimDrive, SimEncoders, SimRanges};
use crate::si;
use crate::track::{Piece, Track};
use fixed::types::I16F16;
use fuzzypilot::behaviour::fine::FineController;
use fuzzypilot::geometry::Point;
use fuzzypilot::guide::{Path, PathError, Segment, Waypoint};
use fuzzypilot::link::message::Cause;
use fuzzypilot::params::{Follower, Limits, ParamError, Params};
use fuzzypilot::ports::{Fault, Ports, RangeReading, WheelCounts, WheelEncoders};
use fuzzypilot::signals::{Decision, StopReason, TickRecord};
use fuzzypilot::tick::Robot;
use std::convert::Infallible;
use std::f64::consts::TAU;

/// One tick as an observer sees it: the robot's own record, and the truth at the moment it sensed.
#[derive(Clone, Copy, Debug)]
pub struct Step<'a> {
    /// Time of the tick, s.
    pub time: f64,
    /// The robot's record.
    pub record: &'a TickRecord,
    /// True pose.
    pub truth: [f64; 3],
    /// True wheel speeds.
    pub wheels: [f64; 2],
    /// Distance from the rim to the nearest obstacle, and which; infinite in an empty world.
    pub clearance: (f64, Option<usize>),
    /// True cross-track error.
    pub cross_track: f64,
    /// Ranges as measured.
    pub ranges: &'a [Option<f64>],
    /// What the robot's ports gave it: wheel counts…
    pub counts: Result<WheelCounts, Fault>,
    /// …and range readings.
    pub readings: &'a [RangeReading],
}

/// A control period in which no tick was computed.
#[derive(Clone, Copy, Debug)]
pub struct Gap {
    /// Its time, s.
    pub time: f64,
    /// Why the robot is disarmed; none if it did not answer.
    pub disarmed: Option<Cause>,
    /// True pose.
    pub truth: [f64; 3],
    /// True wheel speeds.
    pub wheels: [f64; 2],
    /// Distance from the rim to the nearest obstacle, and which; infinite in an empty world.
    pub clearance: (f64, Option<usize>),
    /// True cross-track error.
    pub cross_track: f64,
    /// When the motors last stopped by themselves while they were driven, s, and how long after their last command.
    pub timed_out: Option<(f64, f64)>,
}

/// A control period as an observer sees it.
#[derive(Clone, Copy, Debug)]
pub enum Period<'a> {
    /// With a tick.
    Tick(Step<'a>),
    /// Without.
    Gap(Gap),
}

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The path's end, or the last lap.
    PathEnd,
    /// The path was over, and the robot not at its end.
    PathMissed,
    /// The time limit.
    TimeLimit,
    /// The robot disarmed itself.
    Disarmed,
    /// The robot could not be reached any more.
    LinkLost,
}

/// Why a run could not start: the library refuses the scenario's numbers.
#[derive(Debug, thiserror::Error)]
pub enum RunError {
    /// Settings.
    #[error("robot settings: {0}")]
    Params(ParamError),
    /// Path.
    #[error("path: {0}")]
    Path(PathError),
}

impl From<ParamError> for RunError {
    fn from(error: ParamError) -> Self {
        Self::Params(error)
    }
}

impl From<PathError> for RunError {
    fn from(error: PathError) -> Self {
        Self::Path(error)
    }
}

/// A path in the library's form, owned.
#[derive(Clone, Debug)]
pub enum OwnedPath {
    /// Points.
    Points(Vec<Waypoint>, bool),
    /// Lines and arcs; whether closed; whether gaps are allowed.
    Segments(Vec<Segment>, bool, bool),
}

impl OwnedPath {
    /// Converts a scenario's path.
    pub fn new(scenario: &Scenario) -> Self {
        let path = &scenario.path;
        match &path.form {
            PathForm::Points(points) => {
                Self::Points(points.iter().copied().map(si::pose).collect(), path.closed)
            }
            PathForm::Pieces(pieces) => {
                Self::Segments(pieces.iter().map(segment).collect(), path.closed, path.gaps)
            }
        }
    }

    /// The library's checked view of it.
    pub fn view(&self) -> Result<Path<'_>, PathError> {
        match self {
            Self::Points(points, closed) => Path::points(points, *closed),
            Self::Segments(segments, closed, false) => Path::segments(segments, *closed),
            Self::Segments(segments, closed, true) => Path::segments_with_gaps(segments, *closed),
        }
    }
}

/// A piece as the library has it.
pub(crate) fn segment(piece: &Piece) -> Segment {
    match *piece {
        Piece::Line { from, to } => {
            let heading = libm::atan2(to[1] - from[1], to[0] - from[0]);
            Segment::line(
                si::pose([from[0], from[1], heading]),
                si::metres(piece.length()),
            )
        }
        Piece::Arc {
            centre,
            radius,
            from,
            sweep,
        } => Segment::Arc {
            centre: Point::new(si::metres(centre[0]), si::metres(centre[1])),
            radius: si::metres(radius),
            from: si::angle(from),
            sweep: (sweep / TAU * f64::from(1 << 24)).round() as i32,
        },
    }
}

/// Checks that the library accepts the scenario, without running it.
pub fn check(scenario: &Scenario) -> Result<(), RunError> {
    OwnedPath::new(scenario).view()?;
    params::<8>(scenario)?;
    Ok(())
}

/// Runs a scenario to its end, the tick computed here, and shows every tick to `observe`.
pub fn simulate(
    scenario: &Scenario,
    seed: u64,
    observe: &mut dyn FnMut(Step<'_>),
) -> Result<Ending, RunError> {
    let tables = scenario.control.fine_set(scenario.robot.preset).twin();
    let fine = Fine { tables, apart: 1.0 };
    simulate_with(scenario, seed, fine, observe)
}

/// Like [`simulate`] with these fine tables instead of the scenario's.
pub fn simulate_with(
    scenario: &Scenario,
    seed: u64,
    fine: Fine<'static>,
    observe: &mut dyn FnMut(Step<'_>),
) -> Result<Ending, RunError> {
    match scenario.sensors.count {
        8 => in_process::<8>(scenario, seed, fine, observe),
        16 => in_process::<16>(scenario, seed, fine, observe),
        32 => in_process::<32>(scenario, seed, fine, observe),
        _ => in_process::<64>(scenario, seed, fine, observe),
    }
}

/// The controller of these tables. Peaks of d that are nearer to each other are a larger scale of d; one that the number format
/// has no place for is its largest.
fn controller(fine: Fine<'static>, follower: &Follower, limits: &Limits) -> FineController {
    let mut follower = *follower;
    let scale = follower.distance_scale.to_num::<f64>() / fine.apart;
    follower.distance_scale = I16F16::saturating_from_num(scale);
    FineController::of(fine.tables, &follower, limits)
}

fn in_process<const N: usize>(
    scenario: &Scenario,
    seed: u64,
    fine: Fine<'static>,
    observe: &mut dyn FnMut(Step<'_>),
) -> Result<Ending, RunError> {
    let params: Params<N> = params(scenario)?;
    let owned = OwnedPath::new(scenario);
    let fine = controller(fine, &params.follower, &params.limits);
    let mut controller = InProcess {
        robot: Robot::with_fine(params.clone(), fine, si::pose(scenario.start)),
        path: owned.view()?,
    };
    let driven = drive(scenario, seed, &params, &mut controller, &mut |period| {
        if let Period::Tick(step) = period {
            observe(step);
        }
    });
    Ok(driven.unwrap_or_else(|never| match never {}))
}

/// Runs a scenario to its end, the tick computed by `controller`, and shows every control period to `observe`. `params`
/// are the scenario's.
///
/// # Errors
///
/// The controller cannot go on. What the robot then does until it stands was shown, too.
pub fn drive<const N: usize, C: Controller<N>>(
    scenario: &Scenario,
    seed: u64,
    params: &Params<N>,
    controller: &mut C,
    observe: &mut dyn FnMut(Period<'_>),
) -> Result<Ending, C::Error> {
    let mut bench = Bench::<N>::new(scenario, params, seed);
    let periods = (scenario.duration / scenario.robot.period).ceil() as u64;
    for period in 0..periods {
        let record = match bench.period(scenario, period, controller, observe) {
            Ok(Some(record)) => record,
            Ok(None) => continue,
            Err(error) => {
                bench.run_out(scenario, period, observe);
                return Err(error);
            }
        };
        match record.decision {
            Decision::Stop(StopReason::PathEnd) => return Ok(Ending::PathEnd),
            Decision::Stop(StopReason::PathMissed) => return Ok(Ending::PathMissed),
            _ => {}
        }
        if scenario.path.closed && record.guidance.laps >= scenario.laps {
            // The cursor has been round; whether the robot was there, too, the last place tells.
            let there = record.guidance.distance <= params.follower.end_radius;
            return Ok(if there {
                Ending::PathEnd
            } else {
                Ending::PathMissed
            });
        }
    }
    Ok(Ending::TimeLimit)
}

/// The simulated robot's ports.
pub type SimPorts<const N: usize> = Ports<SimDrive, SimEncoders, SimRanges<N>>;

/// Who computes the tick.
pub trait Controller<const N: usize> {
    /// Why it cannot go on.
    type Error;

    /// Computes the tick at `time`, s, from what the ports tell.
    fn tick(&mut self, time: f64, ports: &mut SimPorts<N>) -> Result<Reply, Self::Error>;
}

/// What came of a tick.
#[derive(Clone, Debug, PartialEq)]
pub enum Reply {
    /// It was computed.
    Tick(Box<TickRecord>),
    /// No answer: the motors go on with their last command, until they miss the next one.
    Lost,
    /// The robot is disarmed, and its wheels are commanded to stand.
    Disarmed(Cause),
}

/// The library's tick, called.
struct InProcess<'a, const N: usize> {
    robot: Robot<N>,
    path: Path<'a>,
}

impl<const N: usize> Controller<N> for InProcess<'_, N> {
    type Error = Infallible;

    fn tick(&mut self, _: f64, ports: &mut SimPorts<N>) -> Result<Reply, Infallible> {
        Ok(Reply::Tick(Box::new(self.robot.tick(&self.path, ports))))
    }
}

/// The simulated robot's body with everything around it.
struct Bench<const N: usize> {
    ports: SimPorts<N>,
    plant: Plant,
    beams: Vec<BeamView>,
    track: Track,
    /// The last record's progress along the path, m.
    progress: f64,
}

impl<const N: usize> Bench<N> {
    fn new(scenario: &Scenario, params: &Params<N>, seed: u64) -> Self {
        let robot = &scenario.robot;
        let metres_per_count = f64::from(params.body.metres_per_count.to_bits()) / 4_294_967_296.0;
        let settings = PlantSettings {
            track: robot.track,
            wheel_speed: robot.wheel_speed,
            acceleration: robot.acceleration,
            yaw_acceleration: robot.yaw_acceleration,
            lag: robot.lag,
            latency: robot.latency,
            integrator: params.integrator,
        };
        Self {
            ports: Ports {
                drive: SimDrive::default(),
                encoders: SimEncoders::new(metres_per_count, &scenario.noise, seed),
                ranges: SimRanges::new(&scenario.noise, seed),
            },
            plant: Plant::new(settings, scenario.start),
            beams: beams(&scenario.sensors),
            track: scenario.path.track(),
            progress: 0.0,
        }
    }

    /// One control period. The record of its tick, if there is one.
    fn period<C: Controller<N>>(
        &mut self,
        scenario: &Scenario,
        period: u64,
        controller: &mut C,
        observe: &mut dyn FnMut(Period<'_>),
    ) -> Result<Option<Box<TickRecord>>, C::Error> {
        let time = period as f64 * scenario.robot.period;
        self.ports.encoders.observe(self.plant.travel);
        let ranges = &mut self.ports.ranges;
        ranges.observe(&scenario.world, &self.beams, self.plant.pose);
        self.ports.drive.timed_out = self.plant.timed_out;
        let reply = controller.tick(time, &mut self.ports)?;
        let timeout = command_timeout(scenario.robot.period);
        let record = match reply {
            Reply::Tick(record) => {
                self.progress = si::from_metres(record.guidance.progress);
                let truth = self.plant.pose;
                let counts = self.ports.encoders.counts();
                observe(Period::Tick(Step {
                    time,
                    record: &record,
                    truth,
                    wheels: self.plant.wheels,
                    clearance: clearance(scenario, truth),
                    cross_track: self.track.cross_track([truth[0], truth[1]], self.progress),
                    ranges: self.seen(),
                    counts,
                    readings: &self.ports.ranges.readings[..self.beams.len().min(N)],
                }));
                self.plant.command(self.ports.drive.command, timeout);
                Some(record)
            }
            Reply::Lost => {
                self.gap(scenario, time, None, observe);
                None
            }
            Reply::Disarmed(cause) => {
                self.gap(scenario, time, Some(cause), observe);
                self.plant.command([0.0; 2], timeout);
                None
            }
        };
        self.plant.advance(scenario.robot.period);
        Ok(record)
    }

    /// Nobody commands the motors any more: they stop by themselves.
    fn run_out(&mut self, scenario: &Scenario, from: u64, observe: &mut dyn FnMut(Period<'_>)) {
        let last = from + (LONGEST_RUN_OUT / scenario.robot.period).ceil() as u64;
        for period in from..=last {
            self.gap(
                scenario,
                period as f64 * scenario.robot.period,
                None,
                observe,
            );
            if self.plant.stands() {
                break;
            }
            self.plant.advance(scenario.robot.period);
        }
    }

    fn gap(
        &self,
        scenario: &Scenario,
        time: f64,
        disarmed: Option<Cause>,
        observe: &mut dyn FnMut(Period<'_>),
    ) {
        let truth = self.plant.pose;
        observe(Period::Gap(Gap {
            time,
            disarmed,
            truth,
            wheels: self.plant.wheels,
            clearance: clearance(scenario, truth),
            cross_track: self.track.cross_track([truth[0], truth[1]], self.progress),
            timed_out: self.plant.timed_out,
        }));
    }

    fn seen(&self) -> &[Option<f64>] {
        let ranges = &self.ports.ranges;
        &ranges.seen[..ranges.mounted()]
    }
}

/// Longest time for which a robot that cannot be reached any more is watched, s.
const LONGEST_RUN_OUT: f64 = 5.0;

fn clearance(scenario: &Scenario, truth: [f64; 3]) -> (f64, Option<usize>) {
    let at = [truth[0], truth[1]];
    scenario.world.clearance(at, scenario.robot.radius)
}
