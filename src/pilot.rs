//! The application around the tick, without hardware: arming, the stored path, the desktop's wish. Every board runs
//! it, and so do the tests on a desktop.
//!
//! A board calls [`Pilot::control`] every control period, [`Pilot::receive`] with every byte that its serial port took
//! in, and [`Pilot::button`], [`Pilot::emergency`] and [`Pilot::fault`] when there is something to tell. Time is an
//! argument, a microsecond counter that may wrap; it must be read once a wrap at least.
//!
//! In the [`Role::Monitor`] the robot drives by the board's ports, and whether a desktop listens does not matter to it.
//! In the [`Role::Lockstep`] sensors and time come in frames, each tick's record goes back, and the board's own wheels
//! are commanded to stand. Settings and path are the plant's then: when it is over, nothing arms the robot until the
//! board has put back its own ([`Pilot::restore`]).

mod arming;
mod dialogue;
mod lockstep;
mod session;

pub use arming::State;

use crate::geometry::Pose;
use crate::guide::{Path, StoreError, StoredPath};
use crate::link::frame::{Counters, Decoder, FrameError};
use crate::link::message::{Cause, Role, Why};
use crate::link::record::{self, RECORD_BYTES};
use crate::link::settings;
use crate::params::Params;
use crate::ports::micros::micros;
use crate::ports::{Fault, Ports, RangeSensors, Side, WheelCounts, WheelDrive, WheelEncoders};
use crate::signals::{Decision, StopReason, TickRecord, Twist, WheelCommand};
use crate::tick::Robot;
use crate::units::{MetresPerSecond, Seconds};
use arming::Arming;
use lockstep::Scan;
use session::{Answer, Session};

/// A tick may come this long after the last one before the robot is disarmed. Where the period is not shorter, a period and
/// this.
pub const GRACE_US: u32 = 200_000;

/// A lock-step session without a frame for this long, by the board's own clock, is over: the robot is its own again, with
/// its own settings and path where the board [puts them back](Pilot::restore).
pub const SILENCE_US: u32 = 10_000_000;

/// A robot with up to `N` range sensors, room for a path of `SEGMENTS` lines and arcs or `POINTS` points, and a link.
#[derive(Clone, Debug)]
pub struct Pilot<const N: usize, const SEGMENTS: usize, const POINTS: usize> {
    decoder: Decoder,
    counters: Counters,
    core: Core<N, SEGMENTS, POINTS>,
}

/// All but the frames' decoder, which lends the message while this acts on it.
#[derive(Clone, Debug)]
struct Core<const N: usize, const SEGMENTS: usize, const POINTS: usize> {
    robot: Robot<N>,
    /// Where a run begins.
    home: Pose,
    path: StoredPath<SEGMENTS, POINTS>,
    upload: Option<Upload>,
    arming: Arming,
    session: Session,
    scan: Scan<N>,
    /// The last tick's record, encoded, if there was a tick.
    record: [u8; RECORD_BYTES],
    recorded: bool,
    /// Number of the robot's next tick.
    next_tick: u32,
    /// When the last tick was, since arming.
    ticked_us: Option<u32>,
    /// The newest stamp; none before the first.
    now_us: Option<u32>,
    uptime_us: u64,
    /// When the desktop was last heard.
    heard_us: u32,
    stack: u32,
    /// The board's own encoders' last good counts.
    counts: WheelCounts,
    cadence: Option<Cadence>,
    /// Settings and path are a plant's, or may be: there was a lock-step session since they were the robot's own.
    foreign: bool,
}

/// The control periods that a board can keep by its own clock.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cadence {
    /// A period is a multiple of this, µs; above 0.
    pub step_us: u32,
    /// The longest, µs.
    pub longest_us: u32,
}

/// A path that is being sent.
#[derive(Clone, Copy, Debug)]
struct Upload {
    count: u16,
    gaps: bool,
}

impl<const N: usize, const SEGMENTS: usize, const POINTS: usize> Pilot<N, SEGMENTS, POINTS> {
    /// A robot that stands at `home` (world), disarmed, without a path. Unsound settings are refused when it is to be
    /// armed. It may be a `static`'s initial value, so that several kilobytes need not pass through the stack.
    pub const fn new(params: Params<N>, home: Pose) -> Self {
        Self {
            decoder: Decoder::new(),
            counters: Counters::new(),
            core: Core {
                robot: Robot::new(params, home),
                home,
                path: StoredPath::new(),
                upload: None,
                arming: Arming::new(),
                session: Session::new(),
                scan: Scan::new(),
                record: [0; RECORD_BYTES],
                recorded: false,
                next_tick: 0,
                ticked_us: None,
                now_us: None,
                uptime_us: 0,
                heard_us: 0,
                stack: 0,
                counts: WheelCounts { left: 0, right: 0 },
                cadence: None,
                foreign: false,
            },
        }
    }

    /// Whether it may move.
    pub fn state(&self) -> State {
        self.core.arming.state()
    }

    /// Who gives it its inputs.
    pub fn role(&self) -> Role {
        self.core.session.role
    }

    /// The robot inside.
    pub fn robot(&self) -> &Robot<N> {
        &self.core.robot
    }

    /// The path, if there is one.
    pub fn path(&self) -> Option<Path<'_>> {
        self.core.path.path()
    }

    /// What came in over the link.
    pub fn counters(&self) -> Counters {
        self.counters
    }

    /// Takes over a path; disarms.
    ///
    /// # Errors
    ///
    /// There is no room for it. Then there is no path.
    pub fn set_path(&mut self, path: &Path<'_>) -> Result<(), StoreError> {
        self.core.change();
        self.core.path.copy(path)
    }

    /// Changes settings in place; disarms.
    pub fn change_params(&mut self, change: impl FnOnce(&mut Params<N>)) {
        self.core.change();
        change(self.core.robot.params_mut());
    }

    /// Whether settings and path are those of a lock-step session that is over. The robot does not drive with them
    /// ([`Why::Foreign`]) until the board has put back its own: [`Pilot::restore`].
    pub fn is_orphaned(&self) -> bool {
        self.core.is_orphaned()
    }

    /// Puts the board's own settings back after a plant, takes the robot to stand at `home`, and forgets the path: the
    /// board's own is [set](Pilot::set_path) next.
    pub fn restore(&mut self, home: Pose, own: impl FnOnce(&mut Params<N>)) {
        self.change_params(own);
        self.core.restore(home);
    }

    /// Tells what a desktop may ask for: the deepest stack so far, in bytes.
    pub fn note_stack(&mut self, bytes: u32) {
        self.core.stack = bytes;
    }

    /// Tells what a desktop may ask for: the board's own encoders' counts. A fault leaves them as they were.
    pub fn note_counts(&mut self, counts: Result<WheelCounts, Fault>) {
        if let Ok(counts) = counts {
            self.core.counts = counts;
        }
    }

    /// Tells which control periods the board can keep. Others are refused when a run by its own clock is to begin.
    pub fn keep(&mut self, cadence: Cadence) {
        self.core.cadence = Some(cadence);
    }

    /// Takes one byte from the link. `out` sends a whole frame; it is called at most three times.
    pub fn receive(&mut self, byte: u8, now_us: u32, out: &mut impl FnMut(&[u8])) {
        let Some(result) = self.decoder.push(byte) else {
            return;
        };
        self.counters.note(&result);
        match result {
            Ok(frame) => self.core.take(frame, self.counters, now_us, out),
            Err(FrameError::Version { sequence, .. }) => {
                let answer = Answer::Refused(Why::Version);
                self.core.send(sequence, answer, self.counters, out);
            }
            Err(_) => {}
        }
    }

    /// A control period by the board's own clock and ports. Call it every `params.period`.
    ///
    /// Armed, it is a tick, and the record is returned. Disarmed, dead reckoning goes on. In lock-step the ticks are the
    /// desktop's. Whatever it is, both wheels are commanded.
    pub fn control<D, E, R>(
        &mut self,
        now_us: u32,
        ports: &mut Ports<D, E, R>,
    ) -> Option<TickRecord>
    where
        D: WheelDrive,
        E: WheelEncoders,
        R: RangeSensors,
    {
        self.core.control(now_us, ports)
    }

    /// The button was pressed. An armed robot is disarmed; a disarmed one is taken to stand at home, where the last
    /// [`Begin`](crate::link::message::ToTarget::Begin) or [`Pilot::new`] put it, and drives its path from the start.
    ///
    /// # Errors
    ///
    /// Why it cannot be armed; it stays disarmed.
    pub fn button(&mut self, now_us: u32) -> Result<State, Why> {
        self.core.clock(now_us);
        if self.core.arming.is_armed() {
            self.core.disarm(Cause::Button);
        } else if self.core.session.role == Role::Lockstep {
            return Err(Why::Role);
        } else {
            self.core.begin(self.core.home)?;
            self.core.arming.arm()?;
        }
        Ok(self.state())
    }

    /// Tells whether the emergency stop is pressed. While it is, nothing arms the robot.
    pub fn emergency(&mut self, pressed: bool) {
        self.core.arming.emergency = pressed;
        if pressed {
            self.core.disarm(Cause::Emergency);
        }
    }

    /// Disarms for a cause that the board has found; at its start, why it was reset.
    pub fn fault(&mut self, cause: Cause) {
        self.core.fault(cause);
    }
}

impl<const N: usize, const SEGMENTS: usize, const POINTS: usize> Core<N, SEGMENTS, POINTS> {
    /// Lets time pass. A stamp from before the last one, taken by an interrupt that came between, changes nothing.
    fn clock(&mut self, now_us: u32) {
        let elapsed = now_us.wrapping_sub(self.now_us.unwrap_or(now_us));
        if elapsed > i32::MAX as u32 {
            return;
        }
        self.now_us = Some(now_us);
        self.uptime_us = self.uptime_us.wrapping_add(elapsed.into());
        let silent = now_us.wrapping_sub(self.heard_us);
        if self.session.role == Role::Lockstep && silent > SILENCE_US {
            self.disarm(Cause::LinkTimeout);
            self.session.close();
            self.come_home();
        }
    }

    fn control<D, E, R>(&mut self, now_us: u32, ports: &mut Ports<D, E, R>) -> Option<TickRecord>
    where
        D: WheelDrive,
        E: WheelEncoders,
        R: RangeSensors,
    {
        self.clock(now_us);
        if self.session.role == Role::Lockstep {
            // Neither result matters: the robot does not drive by these wheels.
            let _ = ports.drive.set_speed(Side::Left, MetresPerSecond::ZERO);
            let _ = ports.drive.set_speed(Side::Right, MetresPerSecond::ZERO);
            return None;
        }
        if self.arming.is_armed() && !self.in_time(now_us) {
            self.disarm(Cause::Overrun);
        }
        let path = self.path.path().filter(|_| self.arming.is_armed());
        let Some(path) = path else {
            self.arming.drive_fault = self.robot.rest(ports);
            return None;
        };
        let record = self.robot.tick(&path, ports);
        self.ticked(now_us, &record);
        let over = matches!(
            record.decision,
            Decision::Stop(StopReason::PathEnd | StopReason::PathMissed)
        );
        if record.drive_fault {
            self.disarm(Cause::DriveFault);
        } else if over && (record.twist, record.wheels) == <(Twist, WheelCommand)>::default() {
            self.disarm(Cause::PathOver);
        }
        Some(record)
    }

    /// Whether the last tick is no longer ago than [`GRACE_US`] lets it be.
    fn in_time(&self, now_us: u32) -> bool {
        let most = match micros(self.robot.params().period) {
            ..GRACE_US => GRACE_US,
            period => period.saturating_add(GRACE_US),
        };
        self.ticked_us
            .is_none_or(|last| now_us.wrapping_sub(last) <= most)
    }

    fn ticked(&mut self, now_us: u32, record: &TickRecord) {
        self.ticked_us = Some(now_us);
        self.next_tick = record.tick.wrapping_add(1);
        record::encode_into(record, &mut self.record);
        self.recorded = true;
    }

    fn disarm(&mut self, cause: Cause) {
        if self.arming.is_armed() {
            self.fault(cause);
        }
    }

    fn fault(&mut self, cause: Cause) {
        self.arming.fault(cause);
        self.ticked_us = None;
        self.scan.clear();
        // The next run sets off from rest, whatever was commanded last.
        let _ = self.robot.rest(&mut self.scan.ports(Err(Fault::Stale)));
    }

    /// Places the robot at the beginning of its path, if settings and path are sound.
    fn begin(&mut self, start: Pose) -> Result<(), Why> {
        if self.arming.is_armed() {
            return Err(Why::NotDisarmed);
        }
        if self.is_orphaned() {
            return Err(Why::Foreign);
        }
        if self.path.path().is_none() {
            return Err(Why::NoPath);
        }
        let period = self.robot.params().period;
        if self.session.role == Role::Monitor && !self.cadence.is_none_or(|c| c.has(period)) {
            return Err(Why::Setting {
                id: settings::PERIOD,
            });
        }
        self.robot.restart(start).map_err(|error| Why::Setting {
            // Every field that the check names has an id; a test holds that.
            id: settings::id_of(error.field).unwrap_or(0),
        })?;
        self.home = start;
        self.next_tick = 0;
        self.scan.clear();
        self.arming.begun = true;
        Ok(())
    }

    /// Settings or path are about to change at the board's wish.
    fn change(&mut self) {
        self.disarm(Cause::SettingsChanged);
        self.arming.begun = false;
        self.upload = None;
    }

    /// Settings are the board's own again.
    fn restore(&mut self, home: Pose) {
        self.path.begin_segments(false);
        self.home = home;
        self.foreign = false;
        self.come_home();
    }

    fn is_orphaned(&self) -> bool {
        self.foreign && self.session.role == Role::Monitor
    }

    /// What the robot believes came from other sensors than those that it has now.
    fn come_home(&mut self) {
        self.arming.begun = false;
        self.scan.clear();
        self.recorded = false;
        // With unsound settings nothing is forgotten, and nothing can be armed either.
        let _ = self.robot.restart(self.home);
        self.next_tick = 0;
    }
}

impl Cadence {
    fn has(self, period: Seconds) -> bool {
        let period = micros(period);
        period <= self.longest_us && period.checked_rem(self.step_us) == Some(0)
    }
}
