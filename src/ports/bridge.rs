//! H-bridge motor channels over [`embedded_hal`]'s PWM and pins.
//!
//! | wiring | chips | adapter |
//! |---|---|---|
//! | one PWM, two direction pins | TB6612FNG, L298N, VNH2SP30 | [`PwmPinsMotor`] |
//! | two PWMs | DRV8833, DRV8871, L9110, MX1508 | [`TwoPwmMotor`] |
//!
//! Both make a [`Motor`]; two of them and the standby pin that they usually share make a [`Bridge`]. A failed write
//! never leaves a motor running on purpose: the channel is switched off as far as it still answers, then the error is
//! reported. Use a PWM of 10 to 25 kHz: below it is heard, above it heats the bridge.
//!
//! The crate `tb6612fng` 1.0 (MIT or Apache-2.0, embedded-hal 1.0, no panic path) drives the same chip. It sets whole
//! percents, where slow wheels need finer steps, and its stop leaves PWM low, a state that the chip's table does not
//! list as free-running. If you have it already, implement [`Motor`] on a newtype around its `Motor`: `drive` is
//! `Forward` or `Backward` of `|effort| · 100 / 32767`, `brake` is `Brake`, `coast` is `Stop`.

use super::{NoPin, Side};
use embedded_hal::digital::{self, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use fixed::types::I16F16;

/// Signed share of a motor's full effort (supply voltage): 15 fractional bits, ±32 767 is ±1; forward positive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Effort(i16);

impl Effort {
    /// None.
    pub const ZERO: Self = Self(0);
    /// All that the supply gives, forward.
    pub const FULL: Self = Self(i16::MAX);

    /// From the raw share; −32 768 is read as −32 767.
    pub const fn from_bits(bits: i16) -> Self {
        Self(if bits == i16::MIN { -i16::MAX } else { bits })
    }

    /// The raw share, ±32 767.
    pub const fn bits(self) -> i16 {
        self.0
    }

    /// From a share in `[-1, 1]`; saturates.
    pub const fn new(share: I16F16) -> Self {
        let one = 1 << 16;
        let bits = share.to_bits();
        let bits = if bits > one {
            one
        } else if bits < -one {
            -one
        } else {
            bits
        };
        // At most 2^16 · 32 767, below 2^31; rounded towards zero.
        Self((bits.wrapping_mul(i16::MAX as i32) / one) as i16)
    }

    /// Parses a share written as a decimal literal; in a `const` a malformed one does not compile.
    pub const fn lit(text: &str) -> Self {
        Self::new(I16F16::lit(text))
    }

    /// The same effort the other way round.
    pub const fn reversed(self) -> Self {
        Self(self.0.wrapping_neg())
    }

    /// This share of `top`, rounded, sign dropped: 0 to `top`.
    const fn duty(self, top: u16) -> u16 {
        let wide = (self.0.unsigned_abs() as u32).wrapping_mul(top as u32);
        (wide.wrapping_add(16_383) / 32_767) as u16
    }
}

/// What a motor is told.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum MotorCommand {
    /// Drive with this effort.
    Drive(Effort),
    /// Short the winding: stops within its friction and its own generator current.
    Brake,
    /// Let the outputs float: rolls out.
    Coast,
}

/// One motor channel.
///
/// *Implementers*: a method that returns an error has switched the motor off as far as it can.
pub trait Motor {
    /// What can go wrong.
    type Error: core::fmt::Debug;

    /// Drives with this share of full effort until the next call.
    fn drive(&mut self, effort: Effort) -> Result<(), Self::Error>;

    /// Brakes; a chip that cannot coasts.
    fn brake(&mut self) -> Result<(), Self::Error>;

    /// Coasts; a chip that cannot brakes.
    fn coast(&mut self) -> Result<(), Self::Error>;

    /// Any of the three.
    fn command(&mut self, command: MotorCommand) -> Result<(), Self::Error> {
        match command {
            MotorCommand::Drive(effort) => self.drive(effort),
            MotorCommand::Brake => self.brake(),
            MotorCommand::Coast => self.coast(),
        }
    }
}

/// Which of a motor's outputs failed, and what its driver called it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MotorError {
    /// A direction pin.
    Pin(digital::ErrorKind),
    /// A PWM output.
    Pwm(pwm::ErrorKind),
}

impl core::fmt::Display for MotorError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Pin(kind) => write!(f, "motor: direction pin: {kind}"),
            Self::Pwm(kind) => write!(f, "motor: PWM output: {kind}"),
        }
    }
}

impl core::error::Error for MotorError {}

fn level<P: OutputPin>(pin: &mut P, high: bool) -> Result<(), MotorError> {
    let written = if high { pin.set_high() } else { pin.set_low() };
    written.map_err(|e| MotorError::Pin(digital::Error::kind(&e)))
}

fn duty<P: SetDutyCycle>(pwm: &mut P, duty: u16) -> Result<(), MotorError> {
    pwm.set_duty_cycle(duty)
        .map_err(|e| MotorError::Pwm(pwm::Error::kind(&e)))
}

/// What a chip with two direction pins does while its PWM input is low.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum WhilePwmLow {
    /// Shorts the motor: TB6612FNG (its datasheet's control table).
    Brakes,
    /// Lets it float: L298N (its enable input).
    Floats,
}

/// A channel with one PWM and two direction pins. Forward is `in1` high, `in2` low.
///
/// When the direction changes, PWM goes to 0 first and rises after both pins have answered.
///
/// ```
/// # use embedded_hal_mock::eh1::{digital::{Mock as Pin, State::{High, Low}, Transaction as P}};
/// # use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as D};
/// use fuzzypilot::ports::bridge::{Effort, Motor, PwmPinsMotor, WhilePwmLow};
///
/// # let mut pwm = Pwm::new(&[D::set_duty_cycle(0), D::max_duty_cycle(1000), D::set_duty_cycle(250)]);
/// # let mut in1 = Pin::new(&[P::set(High)]);
/// # let mut in2 = Pin::new(&[P::set(Low)]);
/// # let (mut p, mut a, mut b) = (pwm.clone(), in1.clone(), in2.clone());
/// // A timer channel and two output pins of your HAL:
/// let mut motor = PwmPinsMotor::new(pwm, in1, in2, WhilePwmLow::Brakes);
/// motor.drive(Effort::lit("0.25"))?;
/// # p.done(); a.done(); b.done();
/// # Ok::<(), fuzzypilot::ports::bridge::MotorError>(())
/// ```
#[derive(Debug)]
pub struct PwmPinsMotor<P, A, B> {
    pwm: P,
    in1: A,
    in2: B,
    low: WhilePwmLow,
    /// Levels of the two pins, where known.
    pins: Option<(bool, bool)>,
}

impl<P: SetDutyCycle, A: OutputPin, B: OutputPin> PwmPinsMotor<P, A, B> {
    /// Takes the outputs over; writes nothing yet.
    pub fn new(pwm: P, in1: A, in2: B, low: WhilePwmLow) -> Self {
        Self {
            pwm,
            in1,
            in2,
            low,
            pins: None,
        }
    }

    /// Gives the outputs back as they are.
    pub fn release(self) -> (P, A, B) {
        (self.pwm, self.in1, self.in2)
    }

    fn set(&mut self, pins: (bool, bool), on: Effort) -> Result<(), MotorError> {
        let written = self.try_set(pins, on);
        if written.is_err() {
            // The error is on its way already; whatever still answers goes off.
            self.pins = None;
            let _ = duty(&mut self.pwm, 0);
            let _ = level(&mut self.in1, false);
            let _ = level(&mut self.in2, false);
        }
        written
    }

    fn try_set(&mut self, pins: (bool, bool), on: Effort) -> Result<(), MotorError> {
        if self.pins != Some(pins) {
            duty(&mut self.pwm, 0)?;
            level(&mut self.in1, pins.0)?;
            level(&mut self.in2, pins.1)?;
            self.pins = Some(pins);
        }
        let on = on.duty(self.pwm.max_duty_cycle());
        duty(&mut self.pwm, on)
    }
}

impl<P: SetDutyCycle, A: OutputPin, B: OutputPin> Motor for PwmPinsMotor<P, A, B> {
    type Error = MotorError;

    fn drive(&mut self, effort: Effort) -> Result<(), MotorError> {
        let forward = effort.bits() >= 0;
        self.set((forward, !forward), effort)
    }

    fn brake(&mut self) -> Result<(), MotorError> {
        match self.low {
            WhilePwmLow::Brakes => self.set((true, true), Effort::ZERO),
            WhilePwmLow::Floats => self.set((false, false), Effort::FULL),
        }
    }

    fn coast(&mut self) -> Result<(), MotorError> {
        match self.low {
            // The table lists "off" with PWM high only; the pins are low before it rises.
            WhilePwmLow::Brakes => self.set((false, false), Effort::FULL),
            WhilePwmLow::Floats => self.set((false, false), Effort::ZERO),
        }
    }
}

/// What the winding does in the off part of each PWM period of a two-PWM channel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Decay {
    /// The current runs out against the supply: the other input stays low. A given effort turns the wheel little at low
    /// speeds.
    Fast,
    /// The current circulates in the shorted winding: the other input stays high. Speed follows effort more linearly;
    /// better for a wheel loop.
    Slow,
}

/// A channel with two PWMs: `forward` drives one way, `backward` the other. Both low coasts and both high brakes on a
/// DRV8833; an L9110 brakes in both cases.
#[derive(Debug)]
pub struct TwoPwmMotor<F, B> {
    forward: F,
    backward: B,
    decay: Decay,
}

impl<F: SetDutyCycle, B: SetDutyCycle> TwoPwmMotor<F, B> {
    /// Takes the outputs over; writes nothing yet.
    pub fn new(forward: F, backward: B, decay: Decay) -> Self {
        Self {
            forward,
            backward,
            decay,
        }
    }

    /// Gives the outputs back as they are.
    pub fn release(self) -> (F, B) {
        (self.forward, self.backward)
    }

    /// Shares of both inputs; the smaller is written first, so that the motor is never driven harder on the way.
    fn set(&mut self, forward: u16, backward: u16) -> Result<(), MotorError> {
        let (f, b) = (&mut self.forward, &mut self.backward);
        let written = if forward <= backward {
            duty(f, forward).and_then(|()| duty(b, backward))
        } else {
            duty(b, backward).and_then(|()| duty(f, forward))
        };
        if written.is_err() {
            let _ = duty(f, 0);
            let _ = duty(b, 0);
        }
        written
    }
}

impl<F: SetDutyCycle, B: SetDutyCycle> Motor for TwoPwmMotor<F, B> {
    type Error = MotorError;

    fn drive(&mut self, effort: Effort) -> Result<(), MotorError> {
        let (top_f, top_b) = (
            self.forward.max_duty_cycle(),
            self.backward.max_duty_cycle(),
        );
        let (on_f, on_b) = (effort.duty(top_f), effort.duty(top_b));
        let ahead = effort.bits() >= 0;
        match (self.decay, ahead) {
            (Decay::Fast, true) => self.set(on_f, 0),
            (Decay::Fast, false) => self.set(0, on_b),
            (Decay::Slow, true) => self.set(top_f, top_b.saturating_sub(on_b)),
            (Decay::Slow, false) => self.set(top_f.saturating_sub(on_f), top_b),
        }
    }

    fn brake(&mut self) -> Result<(), MotorError> {
        let (f, b) = (
            self.forward.max_duty_cycle(),
            self.backward.max_duty_cycle(),
        );
        self.set(f, b)
    }

    fn coast(&mut self) -> Result<(), MotorError> {
        self.set(0, 0)
    }
}

/// Two motors and the pin that wakes their driver chip (`STBY` of a TB6612FNG, `nSLEEP` of a DRV8833); [`NoPin`] where
/// it is tied high.
#[derive(Debug)]
pub struct Bridge<L, R, S = NoPin> {
    left: L,
    right: R,
    standby: S,
    awake: bool,
}

/// Which part of a [`Bridge`] failed first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum BridgeError {
    /// This wheel's motor.
    Motor(Side),
    /// The standby pin.
    Standby,
}

impl core::fmt::Display for BridgeError {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Motor(Side::Left) => "bridge: the left motor's output failed",
            Self::Motor(Side::Right) => "bridge: the right motor's output failed",
            Self::Standby => "bridge: the standby pin failed",
        })
    }
}

impl core::error::Error for BridgeError {}

impl<L: Motor, R: Motor> Bridge<L, R, NoPin> {
    /// Without a standby pin; writes nothing yet.
    pub fn new(left: L, right: R) -> Self {
        Self::with_standby(left, right, NoPin)
    }
}

impl<L: Motor, R: Motor, S: OutputPin> Bridge<L, R, S> {
    /// With the pin that is high while the motors may drive; writes nothing yet. A DRV8833 needs up to 1 ms to wake:
    /// the first period of a drive is lost.
    pub fn with_standby(left: L, right: R, standby: S) -> Self {
        Self {
            left,
            right,
            standby,
            awake: false,
        }
    }

    /// Commands both motors. Both are always attempted; if anything fails, everything goes [`off`](Self::off), and
    /// the first failure is returned.
    pub fn command(&mut self, left: MotorCommand, right: MotorCommand) -> Result<(), BridgeError> {
        let written = both(self.left.command(left), self.right.command(right));
        // The chip wakes when its inputs say what it is to do, not what they said before.
        let woken = if self.awake {
            Ok(())
        } else {
            self.standby.set_high().map_err(|_| BridgeError::Standby)
        };
        self.awake = true;
        let done = written.and(woken);
        if done.is_err() {
            let _ = self.off();
        }
        done
    }

    /// Both motors coast and the chip sleeps. Everything is attempted; the first failure is returned.
    pub fn off(&mut self) -> Result<(), BridgeError> {
        self.awake = false;
        let asleep = self.standby.set_low().map_err(|_| BridgeError::Standby);
        asleep.and(both(self.left.coast(), self.right.coast()))
    }
}

fn both<E, F>(left: Result<(), E>, right: Result<(), F>) -> Result<(), BridgeError> {
    left.map_err(|_| BridgeError::Motor(Side::Left))
        .and(right.map_err(|_| BridgeError::Motor(Side::Right)))
}
