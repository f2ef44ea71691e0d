//! The robot's tick: every stage in order, one way out.

use crate::behaviour::{avoider::avoid, fine::FineController, follower::follow};
use crate::drive::drive;
use crate::geometry::Pose;
use crate::guard::guard;
use crate::guide::{Cursor, Path, guide, pace};
use crate::localise::Localiser;
use crate::params::{ParamError, Params};
use crate::ports::{
    Fault, Ports, RangeReading, RangeSensors, Side, WheelCounts, WheelDrive, WheelEncoders,
};
use crate::sense::{Beams, Odometer, sense_ranges};
use crate::signals::{Behaviour, Decision, Sensed, TickRecord, Travel, Twist};
use crate::supervisor::{Situation, SupervisorState};
use crate::units::MetresPerSecond;

/// A part of the tick, for a [`Probe`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// Reading the encoders and the ranges.
    Read,
    /// Counts to travel, echoes to obstacles.
    Sense,
    /// Travel to pose.
    Localise,
    /// Cursor and guidance law.
    Guide,
    /// The higher level's decision.
    Supervise,
    /// The speed that the path ahead allows, if it is followed.
    Pace,
    /// The lower level's tables.
    Behave,
    /// The last barrier.
    Guard,
    /// Twist to wheels.
    Drive,
}

/// Watches a tick go from stage to stage, to measure what each costs.
pub trait Probe {
    /// `stage` is done.
    fn mark(&mut self, stage: Stage);
}

/// Watches nothing and costs nothing.
impl Probe for () {
    fn mark(&mut self, _: Stage) {}
}

/// A robot with up to `N` range sensors: its settings and everything that it remembers from tick to tick.
#[derive(Clone, Debug)]
pub struct Robot<const N: usize> {
    params: Params<N>,
    // From the settings, before the first tick.
    beams: Beams<N>,
    placed: bool,
    // Of the settings, made where they are checked.
    fine: FineController,
    // Scratch of one tick. Here, because a microcontroller's stack is small.
    readings: [RangeReading; N],
    sensed: Sensed,
    odometer: Odometer,
    localiser: Localiser,
    cursor: Cursor,
    supervisor: SupervisorState,
    last: Twist,
    tick: u32,
}

impl<const N: usize> Robot<N> {
    /// A robot at rest at `start` (world frame), at the beginning of its path. Pass [`Params::checked`] settings.
    pub const fn new(params: Params<N>, start: Pose) -> Self {
        let fine = FineController::new(&params.follower, &params.limits);
        Self::with_fine(params, fine, start)
    }

    /// Like [`Robot::new`] with a fine controller of one's own, until [`Robot::restart`] takes the settings' again.
    pub const fn with_fine(params: Params<N>, fine: FineController, start: Pose) -> Self {
        Self {
            localiser: Localiser::new(&params.body, start),
            fine,
            params,
            beams: Beams::new(),
            placed: false,
            readings: [RangeReading::NEVER_SEEN; N],
            sensed: Sensed::new(),
            odometer: Odometer::new(),
            cursor: Cursor::new(),
            supervisor: SupervisorState::new(),
            last: Twist::REST,
            tick: 0,
        }
    }

    /// The settings.
    pub fn params(&self) -> &Params<N> {
        &self.params
    }

    /// The settings, to be changed while the robot rests. Call [`Robot::restart`] before the next tick: it checks them.
    pub fn params_mut(&mut self) -> &mut Params<N> {
        &mut self.params
    }

    /// Checks the settings, forgets everything and begins anew at rest at `start`.
    ///
    /// # Errors
    ///
    /// The first setting that the robot cannot be driven with; then nothing is forgotten.
    pub fn restart(&mut self, start: Pose) -> Result<(), ParamError> {
        self.params.check()?;
        self.placed = false;
        self.fine = FineController::new(&self.params.follower, &self.params.limits);
        self.localiser = Localiser::new(&self.params.body, start);
        self.odometer = Odometer::default();
        self.restart_path();
        self.last = Twist::default();
        self.tick = 0;
        Ok(())
    }

    /// Believed pose.
    pub fn pose(&self) -> Pose {
        self.localiser.pose()
    }

    /// Puts the cursor back to the start of a (new) path; the pose stays.
    pub fn restart_path(&mut self) {
        self.cursor = Cursor::default();
        self.supervisor = SupervisorState::default();
    }

    /// A control period without driving: both wheels are commanded to stand, dead reckoning goes on. Returns whether a
    /// wheel could not be written.
    pub fn rest<D, E, R>(&mut self, ports: &mut Ports<D, E, R>) -> bool
    where
        D: WheelDrive,
        E: WheelEncoders,
    {
        let travel = self.odometer.travel(ports.encoders.counts());
        let p = &self.params;
        self.localiser.advance(&p.body, p.integrator, travel);
        self.last = Twist::default();
        let left = ports.drive.set_speed(Side::Left, MetresPerSecond::ZERO);
        let right = ports.drive.set_speed(Side::Right, MetresPerSecond::ZERO);
        left.is_err() || right.is_err()
    }

    /// One control period: sense, localise, guide, decide, behave, guard, drive. Call it every `params.period`.
    ///
    /// Each port is used once, whatever fails; both wheels are always written.
    pub fn tick<D, E, R>(&mut self, path: &Path<'_>, ports: &mut Ports<D, E, R>) -> TickRecord
    where
        D: WheelDrive,
        E: WheelEncoders,
        R: RangeSensors,
    {
        self.tick_observed(path, ports, &mut ())
    }

    /// [`Robot::tick`] with a look at each stage's end.
    pub fn tick_observed<D, E, R, P>(
        &mut self,
        path: &Path<'_>,
        ports: &mut Ports<D, E, R>,
        probe: &mut P,
    ) -> TickRecord
    where
        D: WheelDrive,
        E: WheelEncoders,
        R: RangeSensors,
        P: Probe,
    {
        let counts = ports.encoders.counts();
        let mounted = self.params.ring.mounts.len().min(N);
        let readings = self.readings.get_mut(..mounted).unwrap_or_default();
        readings.fill(RangeReading::NEVER_SEEN);
        ports.ranges.read(readings);
        probe.mark(Stage::Read);

        let travel = self.sense(counts, mounted, probe);
        let mut record = self.decide(path, travel, probe);

        let left = ports.drive.set_speed(Side::Left, record.wheels.left);
        let right = ports.drive.set_speed(Side::Right, record.wheels.right);
        record.drive_fault = left.is_err() || right.is_err();
        record
    }

    // The stages, in two functions that know no ports: so they are in an image once, and the stack that sensing needs is
    // free again when the others begin.

    /// Sense.
    fn sense<P: Probe>(
        &mut self,
        counts: Result<WheelCounts, Fault>,
        mounted: usize,
        probe: &mut P,
    ) -> Travel {
        let p = &self.params;
        let travel = self.odometer.travel(counts);
        let readings = self.readings.get(..mounted).unwrap_or_default();
        if !core::mem::replace(&mut self.placed, true) {
            self.beams.place(&p.ring);
        }
        let speed = self.last.linear;
        sense_ranges(&p.ring, &self.beams, readings, speed, &mut self.sensed);
        probe.mark(Stage::Sense);
        travel
    }

    /// Localise, guide, supervise, behave, guard, drive.
    fn decide<P: Probe>(&mut self, path: &Path<'_>, travel: Travel, probe: &mut P) -> TickRecord {
        let p = &self.params;
        let pose = self.localiser.advance(&p.body, p.integrator, travel);
        probe.mark(Stage::Localise);
        let sensed = &self.sensed;
        let timing = (p.period, p.latency);
        let mut guidance = guide(
            &p.follower,
            &p.limits,
            timing,
            path,
            &mut self.cursor,
            pose,
            self.last,
        );
        probe.mark(Stage::Guide);
        let situation = Situation {
            robot_radius: p.body.radius,
            sensed,
            travel,
            pose: pose.frame(),
            guidance: &guidance,
        };
        let decision = self
            .supervisor
            .decide(&p.supervisor, &p.avoider, &situation);
        probe.mark(Stage::Supervise);
        if matches!(decision, Decision::Follow) {
            guidance.speed_limit = pace(&p.follower, &p.limits, path, &mut self.cursor, &guidance);
        }
        probe.mark(Stage::Pace);
        let Behaviour {
            twist: desired,
            trace,
        } = match &decision {
            Decision::Follow => follow(
                &self.fine,
                &p.follower,
                &p.limits,
                p.period,
                &guidance,
                self.last,
            ),
            Decision::Avoid { side, obstacle } => avoid(
                &p.avoider,
                &p.limits,
                p.body.radius,
                sensed,
                *side,
                obstacle,
                self.supervisor.sight(),
            ),
            Decision::Stop(_) => Behaviour::default(),
        };
        probe.mark(Stage::Behave);
        let (passed, guarded) = guard(&p.guard, p.body.radius, timing, sensed, self.last, desired);
        probe.mark(Stage::Guard);
        let driven = drive(&p.body, &p.limits, p.period, self.last, passed);
        probe.mark(Stage::Drive);

        self.last = driven.twist;
        let tick = self.tick;
        self.tick = self.tick.wrapping_add(1);
        TickRecord {
            tick,
            decision,
            pose,
            guidance,
            obstacles: sensed.obstacles.len() as u8,
            valid_ranges: sensed.valid,
            nearest: sensed.nearest,
            trace,
            desired,
            twist: driven.twist,
            wheels: driven.wheels,
            guarded,
            drive_fault: false,
        }
    }
}
