//! H-bridges: levels and duties as the chips' tables ask for them, in an order that never drives the wrong way, and off
//! when anything fails.

use super::{config, fx};
use embedded_hal::digital::OutputPin;
use embedded_hal::pwm::SetDutyCycle;
use embedded_hal_mock::eh1::MockError;
use embedded_hal_mock::eh1::digital::{Mock as Pin, State, Transaction as Level};
use embedded_hal_mock::eh1::pwm::{Mock as Pwm, Transaction as Duty};
use fuzzypilot::ports::Side;
use fuzzypilot::ports::bridge::{
    Bridge, BridgeError, Decay, Effort, Motor, MotorCommand, MotorError, PwmPinsMotor, TwoPwmMotor,
    WhilePwmLow,
};
use proptest::prelude::*;
use std::cell::RefCell;
use std::io::ErrorKind;
use std::rc::Rc;

const HIGH: State = State::High;
const LOW: State = State::Low;

fn set(levels: &[State]) -> Pin {
    let expected: Vec<_> = levels.iter().map(|&level| Level::set(level)).collect();
    Pin::new(&expected)
}

fn failing() -> MockError {
    MockError::Io(ErrorKind::NotConnected)
}

/// Drives a PWM-and-pins motor whose outputs expect exactly this.
fn pwm_pins(
    low: WhilePwmLow,
    pwm: &[Duty],
    in1: &[State],
    in2: &[State],
    run: impl Fn(&mut PwmPinsMotor<Pwm, Pin, Pin>),
) {
    let mut motor = PwmPinsMotor::new(Pwm::new(pwm), set(in1), set(in2), low);
    run(&mut motor);
    let (mut pwm, mut in1, mut in2) = motor.release();
    pwm.done();
    in1.done();
    in2.done();
}

#[test]
fn a_change_of_direction_goes_through_zero() {
    let duties = [
        Duty::set_duty_cycle(0),
        Duty::max_duty_cycle(1000),
        Duty::set_duty_cycle(500),
        // The same way again: the duty alone.
        Duty::max_duty_cycle(1000),
        Duty::set_duty_cycle(1000),
        // The other way.
        Duty::set_duty_cycle(0),
        Duty::max_duty_cycle(1000),
        Duty::set_duty_cycle(250),
    ];
    let run = |motor: &mut PwmPinsMotor<_, _, _>| {
        motor.drive(Effort::lit("0.5")).unwrap();
        motor.drive(Effort::FULL).unwrap();
        motor.drive(Effort::lit("-0.25")).unwrap();
    };
    pwm_pins(
        WhilePwmLow::Brakes,
        &duties,
        &[HIGH, LOW],
        &[LOW, HIGH],
        run,
    );
}

#[test]
fn brake_and_coast_follow_the_chips_tables() {
    let off = [
        Duty::set_duty_cycle(0),
        Duty::max_duty_cycle(1000),
        Duty::set_duty_cycle(0),
    ];
    let on = [
        Duty::set_duty_cycle(0),
        Duty::max_duty_cycle(1000),
        Duty::set_duty_cycle(1000),
    ];
    let (brake, coast) = (
        |motor: &mut PwmPinsMotor<_, _, _>| motor.brake().unwrap(),
        |motor: &mut PwmPinsMotor<_, _, _>| motor.coast().unwrap(),
    );
    pwm_pins(WhilePwmLow::Brakes, &off, &[HIGH], &[HIGH], brake);
    pwm_pins(WhilePwmLow::Brakes, &on, &[LOW], &[LOW], coast);
    pwm_pins(WhilePwmLow::Floats, &on, &[LOW], &[LOW], brake);
    pwm_pins(WhilePwmLow::Floats, &off, &[LOW], &[LOW], coast);
}

#[test]
fn a_failing_pin_leaves_the_motor_off() {
    // in2 refuses to rise: PWM must not rise either.
    let pwm = [Duty::set_duty_cycle(0), Duty::set_duty_cycle(0)];
    let in2 = [Level::set(HIGH).with_error(failing()), Level::set(LOW)];
    let mut motor = PwmPinsMotor::new(
        Pwm::new(&pwm),
        set(&[LOW, LOW]),
        Pin::new(&in2),
        WhilePwmLow::Brakes,
    );
    let error = motor.drive(Effort::lit("-1")).unwrap_err();
    assert!(matches!(error, MotorError::Pin(_)), "{error}");
    let (mut pwm, mut in1, mut in2) = motor.release();
    pwm.done();
    in1.done();
    in2.done();
}

#[test]
fn a_failing_pwm_leaves_the_pins_low() {
    let pwm = [
        Duty::set_duty_cycle(0),
        Duty::max_duty_cycle(100),
        Duty::set_duty_cycle(100).with_error(failing()),
        Duty::set_duty_cycle(0),
    ];
    let mut motor = PwmPinsMotor::new(
        Pwm::new(&pwm),
        set(&[HIGH, LOW]),
        set(&[LOW, LOW]),
        WhilePwmLow::Brakes,
    );
    let error = motor.drive(Effort::FULL).unwrap_err();
    assert!(matches!(error, MotorError::Pwm(_)), "{error}");
    let (mut pwm, mut in1, mut in2) = motor.release();
    pwm.done();
    in1.done();
    in2.done();
}

/// What two PWMs of 200 and 100 steps are set to.
fn two_pwms(decay: Decay, command: MotorCommand) -> [u16; 2] {
    let log = Rc::new(RefCell::new(Vec::new()));
    let output = |name, top| Output {
        name,
        top,
        log: log.clone(),
        broken: Rc::default(),
    };
    let mut motor = TwoPwmMotor::new(output("f", 200), output("b", 100), decay);
    motor.command(command).unwrap();
    let log = log.borrow();
    assert_eq!(log.len(), 2, "{log:?}");
    assert!(log[0].1 <= log[1].1, "the smaller first: {log:?}");
    let of = |name| log.iter().find(|(n, _)| *n == name).unwrap().1;
    [of("f"), of("b")]
}

#[test]
fn two_pwms_follow_the_drv8833_table() {
    use MotorCommand::{Brake, Coast, Drive};
    let (half, back) = (Effort::lit("0.5"), Effort::lit("-0.25"));
    for decay in [Decay::Fast, Decay::Slow] {
        assert_eq!(two_pwms(decay, Coast), [0, 0]);
        assert_eq!(two_pwms(decay, Brake), [200, 100]);
        assert_eq!(two_pwms(decay, Drive(Effort::FULL)), [200, 0]);
        assert_eq!(two_pwms(decay, Drive(Effort::FULL.reversed())), [0, 100]);
    }
    assert_eq!(two_pwms(Decay::Fast, Drive(half)), [100, 0]);
    assert_eq!(two_pwms(Decay::Fast, Drive(back)), [0, 25]);
    assert_eq!(two_pwms(Decay::Slow, Drive(half)), [200, 50]);
    assert_eq!(two_pwms(Decay::Slow, Drive(back)), [150, 100]);
}

/// A PWM or a pin that notes what it is set to and can break.
#[derive(Clone)]
struct Output {
    name: &'static str,
    top: u16,
    log: Rc<RefCell<Vec<(&'static str, u16)>>>,
    broken: Rc<RefCell<bool>>,
}

impl Output {
    fn note(&self, value: u16) -> Result<(), MockError> {
        self.log.borrow_mut().push((self.name, value));
        match *self.broken.borrow() {
            true => Err(failing()),
            false => Ok(()),
        }
    }
}

impl embedded_hal::pwm::ErrorType for Output {
    type Error = MockError;
}

impl SetDutyCycle for Output {
    fn max_duty_cycle(&self) -> u16 {
        self.top
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), MockError> {
        assert!(duty <= self.top, "{}: {duty} of {}", self.name, self.top);
        self.note(duty)
    }
}

impl embedded_hal::digital::ErrorType for Output {
    type Error = MockError;
}

impl OutputPin for Output {
    fn set_low(&mut self) -> Result<(), MockError> {
        self.note(0)
    }

    fn set_high(&mut self) -> Result<(), MockError> {
        self.note(1)
    }
}

#[test]
fn a_bridge_tries_everything_and_goes_off() {
    for broken in ["left", "right", "standby"] {
        let log = Rc::new(RefCell::new(Vec::new()));
        let output = |name| Output {
            name,
            top: 100,
            log: log.clone(),
            broken: Rc::new(RefCell::new(name == broken)),
        };
        let motor = |name| TwoPwmMotor::new(output(name), output(name), Decay::Fast);
        let mut bridge = Bridge::with_standby(motor("left"), motor("right"), output("standby"));
        let full = MotorCommand::Drive(Effort::FULL);
        let error = bridge.command(full, full).unwrap_err();
        let expected = match broken {
            "left" => BridgeError::Motor(Side::Left),
            "right" => BridgeError::Motor(Side::Right),
            _ => BridgeError::Standby,
        };
        assert_eq!(error, expected);
        let log = log.borrow();
        for part in ["left", "right", "standby"] {
            assert!(
                log.contains(&(part, if part == "standby" { 1 } else { 100 })) || part == broken,
                "{part} was not tried: {log:?}"
            );
            let last = log.iter().rev().find(|(name, _)| *name == part);
            assert_eq!(last, Some(&(part, 0)), "{part} is not off: {log:?}");
        }
    }
}

#[test]
fn the_standby_pin_wakes_once_and_sleeps_when_off() {
    let log = Rc::new(RefCell::new(Vec::new()));
    let output = |name| Output {
        name,
        top: 100,
        log: log.clone(),
        broken: Rc::default(),
    };
    let motor = |name| TwoPwmMotor::new(output(name), output(name), Decay::Fast);
    let mut bridge = Bridge::with_standby(motor("left"), motor("right"), output("standby"));
    let full = MotorCommand::Drive(Effort::FULL);
    bridge.command(full, full).unwrap();
    bridge.command(full, MotorCommand::Brake).unwrap();
    bridge.off().unwrap();
    bridge.command(full, full).unwrap();
    let log = log.borrow();
    let standby: Vec<_> = log.iter().filter(|(name, _)| *name == "standby").collect();
    assert_eq!(standby, [&("standby", 1), &("standby", 0), &("standby", 1)]);
    // It wakes to what it is to do.
    let woken = log.iter().position(|write| *write == ("standby", 1));
    let driven = |name| log.iter().position(|write| *write == (name, 100));
    assert!(driven("left") < woken && driven("right") < woken, "{log:?}");
}

#[test]
fn the_ends_of_effort_are_symmetric() {
    assert_eq!(Effort::from_bits(i16::MIN), Effort::FULL.reversed());
    assert_eq!(Effort::lit("-1"), Effort::FULL.reversed());
    assert_eq!(Effort::FULL.reversed().bits(), -32_767);
}

proptest! {
    #![proptest_config(config(512))]

    /// Duty is the share of the top, to the nearest step, for every effort and resolution.
    #[test]
    fn duty_is_the_share(bits in any::<i16>(), top in 1_u16..) {
        let pwm = [Duty::set_duty_cycle(0), Duty::max_duty_cycle(top)];
        let effort = Effort::from_bits(bits);
        let exact = f64::from(effort.bits()).abs() / 32_767.0 * f64::from(top);
        let duty = Duty::set_duty_cycle(exact.round() as u16);
        let level = if effort.bits() >= 0 { [HIGH, LOW] } else { [LOW, HIGH] };
        let expected: Vec<_> = pwm.into_iter().chain([duty]).collect();
        pwm_pins(WhilePwmLow::Brakes, &expected, &level[..1], &level[1..], |motor| {
            motor.drive(effort).unwrap();
        });
    }

    #[test]
    fn efforts_saturate(share in -4.0..4.0_f64) {
        let effort = f64::from(Effort::new(fx(share)).bits()) / 32_767.0;
        prop_assert!((effort - share.clamp(-1.0, 1.0)).abs() < 1e-4, "{effort}");
        prop_assert_eq!(Effort::new(fx(share)).reversed().reversed(), Effort::new(fx(share)));
    }
}
