//! The loop: plant and sensors around the library's own tick.

use crate::params::params;
use crate::plant::{Plant, PlantSettings};
use crate::recording::BeamView;
use crate::robot::beams;
use crate::scenario::{PathForm, Scenario};
use crate::sensors::{SimDrive, SimEncoders, SimRanges};
use crate::si;
use crate::track::{Piece, Track};
use fuzzypilot::geometry::{Point, Pose};
use fuzzypilot::guide::{Path, PathError, Segment, Waypoint};
use fuzzypilot::params::{ParamError, Params};
use fuzzypilot::ports::{Fault, Ports, RangeReading, WheelCounts, WheelEncoders};
use fuzzypilot::signals::{Decision, StopReason, TickRecord};
use fuzzypilot::tick::Robot;
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

/// How a run ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ending {
    /// The path's end, or the last lap.
    PathEnd,
    /// The path was over, and the robot not at its end.
    PathMissed,
    /// The time limit.
    TimeLimit,
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

fn segment(piece: &Piece) -> Segment {
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

/// Runs a scenario to its end and shows every tick to `observe`.
pub fn simulate(
    scenario: &Scenario,
    seed: u64,
    observe: &mut dyn FnMut(Step<'_>),
) -> Result<Ending, RunError> {
    match scenario.sensors.count {
        8 => with_ring::<8>(scenario, seed, observe),
        16 => with_ring::<16>(scenario, seed, observe),
        32 => with_ring::<32>(scenario, seed, observe),
        _ => with_ring::<64>(scenario, seed, observe),
    }
}

fn with_ring<const N: usize>(
    scenario: &Scenario,
    seed: u64,
    observe: &mut dyn FnMut(Step<'_>),
) -> Result<Ending, RunError> {
    let params: Params<N> = params(scenario)?;
    let owned = OwnedPath::new(scenario);
    let path = owned.view()?;
    let mut bench = Bench::<N>::new(scenario, params, seed);
    let ticks = (scenario.duration / scenario.robot.period).ceil() as u64;
    for tick in 0..ticks {
        let record = bench.step(scenario, &path, tick, observe);
        match record.decision {
            Decision::Stop(StopReason::PathEnd) => return Ok(Ending::PathEnd),
            Decision::Stop(StopReason::PathMissed) => return Ok(Ending::PathMissed),
            _ => {}
        }
        if path.is_closed() && record.guidance.laps >= scenario.laps {
            // The cursor has been round; whether the robot was there, too, the last place tells.
            let there = record.guidance.distance <= bench.robot.params().follower.end_radius;
            return Ok(if there {
                Ending::PathEnd
            } else {
                Ending::PathMissed
            });
        }
    }
    Ok(Ending::TimeLimit)
}

/// The simulated robot with everything around it.
struct Bench<const N: usize> {
    robot: Robot<N>,
    ports: Ports<SimDrive, SimEncoders, SimRanges<N>>,
    plant: Plant,
    beams: Vec<BeamView>,
    track: Track,
}

impl<const N: usize> Bench<N> {
    fn new(scenario: &Scenario, params: Params<N>, seed: u64) -> Self {
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
        let start: Pose = si::pose(scenario.start);
        Self {
            robot: Robot::new(params, start),
            ports: Ports {
                drive: SimDrive::default(),
                encoders: SimEncoders::new(metres_per_count, &scenario.noise, seed),
                ranges: SimRanges::new(&scenario.noise, seed),
            },
            plant: Plant::new(settings, scenario.start),
            beams: beams(&scenario.sensors),
            track: scenario.path.track(),
        }
    }

    fn step(
        &mut self,
        scenario: &Scenario,
        path: &Path<'_>,
        tick: u64,
        observe: &mut dyn FnMut(Step<'_>),
    ) -> TickRecord {
        let truth = self.plant.pose;
        let at = [truth[0], truth[1]];
        self.ports.encoders.observe(self.plant.travel);
        self.ports
            .ranges
            .observe(&scenario.world, &self.beams, truth);
        let record = self.robot.tick(path, &mut self.ports);
        observe(Step {
            time: tick as f64 * scenario.robot.period,
            record: &record,
            truth,
            wheels: self.plant.wheels,
            clearance: scenario.world.clearance(at, scenario.robot.radius),
            cross_track: self
                .track
                .cross_track(at, si::from_metres(record.guidance.progress)),
            ranges: &self.ports.ranges.seen,
            counts: self.ports.encoders.counts(),
            readings: &self.ports.ranges.readings,
        });
        self.plant.command(self.ports.drive.command);
        self.plant.advance(scenario.robot.period);
        record
    }
}
