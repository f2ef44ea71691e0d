//! The button, the lamp and the emergency stop of a robot.

use crate::link::message::Cause;
use crate::pilot::State;

/// A level must hold for so many samples before it counts: 30 ms.
const STEADY: u8 = 6;

/// A button, debounced. One that is down when the robot is switched on counts from its first release on.
#[derive(Clone, Debug, Default)]
pub struct Button {
    /// Down, as far as it is believed; none before the first steady level.
    down: Option<bool>,
    /// Samples in a row of the other level.
    steady: u8,
    last: bool,
}

impl Button {
    /// Not yet looked at.
    pub const fn new() -> Self {
        Self {
            down: None,
            steady: 0,
            last: false,
        }
    }

    /// Takes a sample every [`STEP_US`](super::STEP_US); whether the button has just been pressed.
    pub fn sample(&mut self, down: bool) -> bool {
        if down != self.last {
            self.last = down;
            self.steady = 0;
        }
        self.steady = self.steady.saturating_add(1);
        if self.steady < STEADY || self.down == Some(down) {
            return false;
        }
        let was = self.down.replace(down);
        was == Some(false) && down
    }
}

/// A PWM timer whose break input is the emergency stop: pressed, it switches the outputs off without the program, and
/// notes that.
pub trait BreakInput {
    /// Whether it is pressed now.
    fn pressed(&mut self) -> bool;

    /// Whether it has been pressed since [`forget`](Self::forget).
    fn tripped(&mut self) -> bool;

    /// Forgets that it was pressed; without effect while it is.
    fn forget(&mut self);

    /// Lets the outputs drive again; without effect while it is pressed.
    fn enable(&mut self);
}

/// Looks at the emergency stop every [`STEP_US`](super::STEP_US); whether the robot must be disarmed. However short it was
/// pressed, it is told once at least, and the outputs drive again a step later: the robot is disarmed by then.
pub fn emergency(input: &mut impl BreakInput) -> bool {
    let (pressed, tripped) = (input.pressed(), input.tripped());
    match (pressed, tripped) {
        (false, false) => input.enable(),
        (false, true) => input.forget(),
        (true, _) => {}
    }
    pressed || tripped
}

/// The robot's state as blinks of one lamp, a second each round:
///
/// | lamp | meaning |
/// |---|---|
/// | on | armed: it moves |
/// | one long blink | disarmed, all is well |
/// | two short blinks | the emergency stop is pressed |
/// | fast blinking | disarmed by a fault: see the [`Cause`] over the link or in the log |
#[derive(Clone, Debug, Default)]
pub struct Lamp {
    /// Steps into the round.
    phase: u8,
}

/// Steps in a round: 1 s.
const ROUND: u8 = 200;

impl Lamp {
    /// At the beginning of a round.
    pub const fn new() -> Self {
        Self { phase: 0 }
    }

    /// Whether it shines in this step, [`STEP_US`](super::STEP_US) long.
    pub fn step(&mut self, state: State, emergency: bool) -> bool {
        let phase = self.phase;
        self.phase = match phase.saturating_add(1) {
            ROUND.. => 0,
            next => next,
        };
        match state {
            State::Armed => true,
            _ if emergency => matches!(phase, 0..20 | 40..60),
            State::Disarmed(cause) if is_fault(cause) => phase % 20 < 10,
            State::Disarmed(_) => phase < 100,
        }
    }
}

/// Whether somebody should look after the robot.
fn is_fault(cause: Cause) -> bool {
    match cause {
        Cause::Boot
        | Cause::StopCommand
        | Cause::Button
        | Cause::Emergency
        | Cause::NewSession
        | Cause::SettingsChanged
        | Cause::PathOver => false,
        Cause::LinkTimeout
        | Cause::Sequence
        | Cause::DriveFault
        | Cause::Overrun
        | Cause::Brownout
        | Cause::Watchdog
        | Cause::Panic
        | Cause::HardFault => true,
    }
}
