//! What every board does around the [`Pilot`](crate::pilot), without naming one: the steps between two control periods,
//! button and lamp, what a crash leaves behind, the reference robot. A board file adds registers and interrupts.
//!
//! ```text
//!  range drivers ─ samples ─▶ ┌─────────┐ ─ efforts ─▶ motors
//!  encoders ────── counts ──▶ │ Machine │
//!  serial port ─── bytes ───▶ │         │ ─ frames ──▶ serial port
//!  button, e-stop ──────────▶ └─────────┘ ─ lamp, watchdog
//! ```

pub mod crash;
pub mod kit;
pub mod panel;
pub mod pipe;

use crate::link::message::{Cause, Why};
use crate::params::Params;
use crate::pilot::{Cadence, Pilot, State};
use crate::ports::bridge::Motor;
use crate::ports::ring::{Latest, Sample};
use crate::ports::wheel_loop::WheelLoop;
use crate::ports::{Ports, WheelEncoders};
use crate::units::Seconds;
use embedded_hal::digital::OutputPin;
use panel::{Button, Lamp};

/// Range sensors that the settings have room for: as many as the largest ring of the simulator's scenarios.
pub const RANGES: usize = 64;
/// Lines and arcs that a path has room for.
pub const SEGMENTS: usize = 32;
/// Points that a path has room for.
pub const POINTS: usize = 64;

/// Time between two steps of [`Machine::run`].
pub const STEP_US: u32 = 5_000;

/// The longest control period by a board's own clock: a watchdog waits for one at least this many steps, 100 ms.
const PATIENT_STEPS: u16 = 20;

/// After a disarming it takes so many steps until a stall is forgiven: 2 s.
const FORGIVE_STEPS: u16 = 400;

/// The pilot with the capacities that every board has, so that any of them runs any scenario in the loop.
pub type BoardPilot = Pilot<RANGES, SEGMENTS, POINTS>;

/// A pilot on wheels: `L` and `R` are motors, `S` their standby pin, `E` the encoders.
#[derive(Debug)]
pub struct Machine<'a, L, R, S, E> {
    pilot: &'a mut BoardPilot,
    ports: Ports<WheelLoop<L, R, S>, E, Latest<{ kit::SENSORS }>>,
    button: Button,
    lamp: Lamp,
    /// As of the last look.
    armed: bool,
    /// As it was last logged.
    told: Option<State>,
    /// Steps since the last control period.
    steps: u16,
    /// Steps since disarming, up to [`FORGIVE_STEPS`].
    disarmed: u16,
}

/// What a person at the robot does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Panel {
    /// The button is down.
    pub button: bool,
    /// The emergency stop is pressed, or its wire is broken.
    pub emergency: bool,
}

/// What a board's log should tell.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Event {
    /// The robot was armed or disarmed.
    State(State),
    /// The button was pressed, and the robot is not armed.
    Refused(Why),
}

/// What a machine needs of its board, motors and encoders aside. Nothing here waits.
pub trait Board {
    /// Microseconds, wrapping.
    fn now_us(&mut self) -> u32;

    /// Whether a step is due; true once every [`STEP_US`]. Steps that were missed are not made up for.
    fn due(&mut self) -> bool;

    /// The person.
    fn panel(&mut self) -> Panel;

    /// A range reading, if there is one; its `index` is the sensor's place in the ring.
    fn sample(&mut self) -> Option<Sample>;

    /// A byte from the serial port, if there is one.
    fn received(&mut self) -> Option<u8>;

    /// Sends a frame by the serial port, or drops it.
    fn send(&mut self, frame: &[u8]);

    /// The deepest stack so far, in bytes; 0 if it is not known.
    fn stack(&mut self) -> u32;

    /// Switches the lamp.
    fn lamp(&mut self, on: bool);

    /// Feeds the watchdog, which must wait for 100 ms at least: a control period is complete.
    fn feed(&mut self);

    /// Puts the settings back with which the robot was switched on, after a plant's.
    fn own(&mut self, params: &mut Params<RANGES>);

    /// Logs what happened.
    fn log(&mut self, event: Event);
}

impl<'a, L, R, S, E> Machine<'a, L, R, S, E>
where
    L: Motor,
    R: Motor,
    S: OutputPin,
    E: WheelEncoders,
{
    /// Disarmed, because of what the board found out about its last reset.
    pub fn new(
        pilot: &'a mut BoardPilot,
        drive: WheelLoop<L, R, S>,
        encoders: E,
        reset: Cause,
    ) -> Self {
        pilot.fault(reset);
        pilot.keep(Cadence {
            step_us: STEP_US,
            longest_us: STEP_US.wrapping_mul(PATIENT_STEPS as u32),
        });
        Self {
            pilot,
            ports: Ports {
                drive,
                encoders,
                ranges: Latest::new(),
            },
            button: Button::new(),
            lamp: Lamp::new(),
            armed: false,
            told: None,
            steps: 0,
            disarmed: 0,
        }
    }

    /// Steps when it is time to, and takes what came in over the link in between. To be called by a low interrupt,
    /// whenever a step is due and whenever a frame has come.
    pub fn run(&mut self, board: &mut impl Board) {
        loop {
            if self.pilot.is_orphaned() {
                self.restore(board);
            }
            if board.due() {
                self.step(board);
            }
            let Some(byte) = board.received() else {
                break;
            };
            let now_us = board.now_us();
            self.receive(byte, now_us, &mut |frame| board.send(frame));
        }
    }

    /// What goes on every [`STEP_US`]: the wheel loops always, a tick when it is due.
    fn step(&mut self, board: &mut impl Board) {
        while let Some(sample) = board.sample() {
            let (index, range, at_us) = (sample.index, sample.range, sample.at_us);
            self.ports.ranges.post(index, range, at_us);
        }
        let (panel, now_us) = (board.panel(), board.now_us());
        self.pilot.note_stack(board.stack());
        self.pilot.emergency(panel.emergency);
        if self.button.sample(panel.button)
            && let Err(why) = self.pilot.button(now_us)
        {
            board.log(Event::Refused(why));
        }
        self.halt();
        self.forgive();
        self.turn(now_us);
        self.steps = self.steps.saturating_add(1);
        // With a longer period it is not driven by this clock; that the program goes on is still seen in time.
        let period = steps_of(self.pilot.robot().params().period).min(PATIENT_STEPS);
        if self.steps >= period {
            self.steps = 0;
            self.control(now_us);
            board.feed();
        }
        let state = self.pilot.state();
        if self.told.replace(state) != Some(state) {
            board.log(Event::State(state));
        }
        board.lamp(self.lamp.step(state, panel.emergency));
    }

    // None of these is inlined: their stacks do not add up then.

    /// A step of the wheel loops.
    #[inline(never)]
    fn turn(&mut self, now_us: u32) {
        let counts = self.ports.encoders.counts();
        self.pilot.note_counts(counts);
        // A fault is told to the tick by the next command.
        let _ = self.ports.drive.step(now_us, counts);
    }

    /// A control period.
    #[inline(never)]
    fn control(&mut self, now_us: u32) {
        self.ports.ranges.at(now_us);
        let _ = self.pilot.control(now_us, &mut self.ports);
    }

    /// A byte from the serial port.
    #[inline(never)]
    fn receive(&mut self, byte: u8, now_us: u32, out: &mut impl FnMut(&[u8])) {
        self.pilot.receive(byte, now_us, out);
        self.halt();
    }

    /// A plant is gone: settings and path are the robot's own again, as they were when it was switched on.
    #[inline(never)]
    fn restore(&mut self, board: &mut impl Board) {
        self.pilot.restore(kit::HOME, |params| board.own(params));
        kit::lay_path(self.pilot);
    }

    /// Whether the robot may move.
    pub fn state(&self) -> State {
        self.pilot.state()
    }

    /// Stops the wheels as soon as the robot is disarmed, without waiting for the next control period. Armed, they are
    /// measured as the odometry measures them.
    fn halt(&mut self) {
        let armed = self.pilot.state() == State::Armed;
        let was = core::mem::replace(&mut self.armed, armed);
        if was && !armed {
            // Both are off as far as they can be; what failed, the next command tells.
            let _ = self.ports.drive.stop();
        } else if armed && !was {
            let body = &self.pilot.robot().params().body;
            self.ports.drive.measure_by(body.metres_per_count);
        }
    }

    /// A stalled wheel stays off until the robot has been disarmed for a while, so that nobody arms it into the same
    /// wall at once.
    fn forgive(&mut self) {
        if self.armed {
            self.disarmed = 0;
        } else if self.disarmed < FORGIVE_STEPS {
            self.disarmed = self.disarmed.saturating_add(1);
            if self.disarmed == FORGIVE_STEPS {
                self.ports.drive.clear();
            }
        }
    }
}

/// Steps in a control period, rounded; at least one.
fn steps_of(period: Seconds) -> u16 {
    // A step with 24 fractional bits of a second.
    const STEP: u32 = ((STEP_US as u64) << 24).div_ceil(1_000_000) as u32;
    let period = period.bits().max(0).unsigned_abs();
    let steps = period.saturating_add(STEP / 2) / STEP;
    u16::try_from(steps).unwrap_or(u16::MAX).max(1)
}
