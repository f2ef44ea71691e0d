//! The wheel loop against a modelled motor: it reaches and holds speeds, and stops by itself whenever something is
//! wrong, both wheels each time.

use super::{config, fx, seconds, speed};
use fixed::types::{I16F16, U0F32};
use fuzzypilot::ports::bridge::{Bridge, BridgeError, Effort, Motor, MotorCommand};
use fuzzypilot::ports::wheel_loop::{
    Gains, Rest, SpeedLoop, Stall, WheelFault, WheelLoop, WheelLoopSettings,
};
use fuzzypilot::ports::{Fault, Side, WheelCounts, WheelDrive};
use proptest::prelude::*;
use std::cell::{Cell, RefCell};
use std::rc::Rc;

const COUNT: f64 = 0.000_142;
const STEP_US: u32 = 5_000;
/// One count in one step.
const COUNT_SPEED: f64 = COUNT / 0.005;
const GAINS: Gains = Gains {
    static_effort: I16F16::lit("0.08"),
    feed_forward: I16F16::lit("0.9"),
    proportional: I16F16::lit("1"),
    integral: I16F16::lit("5"),
};

fn settings() -> WheelLoopSettings {
    WheelLoopSettings {
        metres_per_count: U0F32::from_num(COUNT),
        gains: [GAINS; 2],
        reverse: [false, true],
        limit: Effort::lit("0.9"),
        deadband: speed(0.02),
        rest: Rest::Brake,
        timeout: seconds(0.2),
        stall: Stall {
            effort: Effort::lit("0.7"),
            counts: 4,
            time: seconds(0.5),
        },
    }
}

/// A motor that keeps the last command, and can fail.
#[derive(Clone)]
struct Keep(Rc<Cell<MotorCommand>>, Rc<Cell<bool>>);

impl Default for Keep {
    fn default() -> Self {
        Self(Rc::new(Cell::new(MotorCommand::Coast)), Rc::default())
    }
}

impl Keep {
    fn note(&self, command: MotorCommand) -> Result<(), &'static str> {
        self.0.set(command);
        if self.1.get() { Err("broken") } else { Ok(()) }
    }
}

impl Motor for Keep {
    type Error = &'static str;
    fn drive(&mut self, effort: Effort) -> Result<(), Self::Error> {
        self.note(MotorCommand::Drive(effort))
    }
    fn brake(&mut self) -> Result<(), Self::Error> {
        self.note(MotorCommand::Brake)
    }
    fn coast(&mut self) -> Result<(), Self::Error> {
        self.note(MotorCommand::Coast)
    }
}

/// Two wheels: 1.05 m/s at full effort, friction of 0.08, 60 ms of inertia; the right motor is mounted reversed.
struct Rig {
    drive: WheelLoop<Keep, Keep>,
    motors: [Keep; 2],
    speeds: [f64; 2],
    travel: [f64; 2],
    held: [bool; 2],
    /// The right encoder counts backwards against its motor.
    crossed: bool,
    now: u32,
}

impl Rig {
    fn new(settings: WheelLoopSettings) -> Self {
        let motors = [Keep::default(), Keep::default()];
        let bridge = Bridge::new(motors[0].clone(), motors[1].clone());
        Self {
            drive: WheelLoop::new(bridge, settings).unwrap(),
            motors,
            speeds: [0.0; 2],
            travel: [0.0; 2],
            held: [false; 2],
            crossed: false,
            // Soon to wrap.
            now: u32::MAX - 300_000,
        }
    }

    fn counts(&self) -> WheelCounts {
        // Near the end of the range: they wrap on the way.
        let count =
            |metres: f64| ((metres / COUNT).floor() as i64 + i64::from(i32::MAX) - 50) as i32;
        let right = self.travel[1];
        WheelCounts {
            left: count(self.travel[0]),
            right: count(if self.crossed { -right } else { right }),
        }
    }

    /// One step; returns its result.
    fn step(&mut self, counts: Result<WheelCounts, Fault>) -> Result<(), WheelFault> {
        self.now = self.now.wrapping_add(STEP_US);
        let result = self.drive.step(self.now, counts);
        let dt = f64::from(STEP_US) * 1e-6;
        for (i, motor) in self.motors.iter().enumerate() {
            let effort = match motor.0.get() {
                MotorCommand::Drive(effort) => f64::from(effort.bits()) / 32_767.0,
                _ => 0.0,
            };
            let effort = if i == 1 { -effort } else { effort };
            let goal = 1.05 * effort.signum() * (effort.abs() - 0.08).max(0.0) / 0.92;
            self.speeds[i] += (goal - self.speeds[i]) * (dt / 0.06);
            if self.held[i] {
                self.speeds[i] = 0.0;
            }
            self.travel[i] += self.speeds[i] * dt;
        }
        result
    }

    fn command(&mut self, left: f64, right: f64) -> [Result<(), WheelFault>; 2] {
        [
            self.drive.set_speed(Side::Left, speed(left)),
            self.drive.set_speed(Side::Right, speed(right)),
        ]
    }

    /// Commanded every fourth step, for so many seconds; the largest speeds on the way.
    fn run(&mut self, left: f64, right: f64, time: f64) -> Outcome {
        let mut most = [0.0_f64; 2];
        let mut result = Ok(());
        for step in 0..(time * 1e6) as u32 / STEP_US {
            if step % 4 == 0 {
                let _ = self.command(left, right);
            }
            result = self.step(Ok(self.counts()));
            for (most, speed) in most.iter_mut().zip(self.speeds) {
                *most = most.max(speed.abs());
            }
        }
        Outcome { most, result }
    }

    fn told(&self) -> [MotorCommand; 2] {
        [self.motors[0].0.get(), self.motors[1].0.get()]
    }
}

struct Outcome {
    most: [f64; 2],
    result: Result<(), WheelFault>,
}

const BRAKES: [MotorCommand; 2] = [MotorCommand::Brake; 2];
const COASTS: [MotorCommand; 2] = [MotorCommand::Coast; 2];

fn near(speeds: [f64; 2], wanted: [f64; 2], tolerance: f64) {
    for (got, wanted) in speeds.into_iter().zip(wanted) {
        assert!(
            (got - wanted).abs() <= (tolerance * wanted.abs()).max(0.5 * COUNT_SPEED),
            "{speeds:?} for {wanted}"
        );
    }
}

#[test]
fn both_wheels_reach_their_speeds_and_hold_them() {
    let mut rig = Rig::new(settings());
    for wanted in [[0.5, 0.3], [-0.4, 0.4], [0.1, -0.6], [0.05, 0.05]] {
        let Outcome { most, result } = rig.run(wanted[0], wanted[1], 0.6);
        assert_eq!(result, Ok(()));
        near(rig.speeds, wanted, 0.12);
        for (most, wanted) in most.into_iter().zip(wanted) {
            // Never far beyond what was or is wanted.
            assert!(most < 0.65, "{most} for {wanted}");
        }
        rig.run(wanted[0], wanted[1], 1.0);
        near(rig.speeds, wanted, 0.04);
        let measured = rig.drive.speed(Side::Left).get().to_num::<f64>();
        assert!((measured - wanted[0]).abs() < 0.05, "{measured}");
    }
    rig.run(0.0, 0.01, 0.1);
    assert_eq!(rig.told(), BRAKES, "0, and what is inside the deadband");
}

#[test]
fn the_integral_makes_good_what_the_feed_forward_misses() {
    let mut weak = settings();
    for gains in &mut weak.gains {
        gains.feed_forward = fx(0.4);
        gains.static_effort = fx(0.0);
    }
    let mut rig = Rig::new(weak);
    rig.run(0.5, 0.5, 2.0);
    near(rig.speeds, [0.5, 0.5], 0.03);
}

#[test]
fn without_commands_the_wheels_stop_within_the_timeout() {
    let mut rig = Rig::new(settings());
    rig.run(0.4, 0.4, 0.5);
    // The last command was at most four steps ago.
    for step in 1..=36 {
        let _ = rig.step(Ok(rig.counts()));
        if step <= 35 {
            assert!(
                matches!(rig.told()[0], MotorCommand::Drive(_)),
                "step {step}"
            );
        }
    }
    assert_eq!(rig.told(), BRAKES);
    // A new command drives again; one for a single wheel does not.
    rig.drive.set_speed(Side::Left, speed(0.3)).unwrap();
    rig.step(Ok(rig.counts())).unwrap();
    assert_eq!(rig.told(), BRAKES);
    rig.run(0.4, 0.4, 0.3);
    assert!(rig.told() != BRAKES);
    for _ in 0..41 {
        rig.drive.set_speed(Side::Right, speed(0.4)).unwrap();
        rig.step(Ok(rig.counts())).unwrap();
    }
    assert_eq!(rig.told(), BRAKES, "the left wheel was forgotten");
}

#[test]
fn a_stall_switches_both_off_until_cleared() {
    let mut rig = Rig::new(settings());
    rig.run(0.4, 0.4, 1.0);
    rig.held[1] = true;
    let result = rig.run(0.4, 0.4, 0.45).result;
    assert_eq!(result, Ok(()), "not yet");
    let result = rig.run(0.4, 0.4, 0.8).result;
    assert_eq!(result, Err(WheelFault::Stalled(Side::Right)));
    assert_eq!(rig.told(), COASTS);
    assert_eq!(rig.command(0.4, 0.4), [result; 2]);
    assert_eq!(rig.drive.fault(), result.err());
    rig.held[1] = false;
    let result = rig.run(0.4, 0.4, 1.0).result;
    assert_eq!(result, Err(WheelFault::Stalled(Side::Right)), "it stays");
    rig.drive.clear();
    assert_eq!(rig.drive.fault(), None);
    rig.step(Ok(rig.counts())).unwrap();
    assert_eq!(rig.told(), BRAKES, "the old command is not taken up again");
    rig.run(0.4, 0.4, 1.0);
    near(rig.speeds, [0.4, 0.4], 0.05);
}

#[test]
fn a_stall_is_found_backwards_too() {
    let mut rig = Rig::new(settings());
    rig.run(-0.4, -0.4, 1.0);
    rig.held[0] = true;
    let result = rig.run(-0.4, -0.4, 1.5).result;
    assert_eq!(result, Err(WheelFault::Stalled(Side::Left)));
}

#[test]
fn rocking_a_held_wheel_is_no_stall() {
    // Half the stall's time one way, then the other, and again.
    let mut rig = Rig::new(settings());
    rig.held = [true; 2];
    for turn in 0..12 {
        let wanted = if turn % 2 == 0 { 0.8 } else { -0.8 };
        assert_eq!(rig.run(wanted, wanted, 0.3).result, Ok(()), "turn {turn}");
    }
}

#[test]
fn the_timeout_counts_from_the_command() {
    // As long as the steps are, and wherever between two of them the command comes.
    for step in [1_000, 4_999, 5_000, 5_003, 20_000] {
        for at in [0, 1, step / 2, step - 1] {
            let mut rig = Rig::new(settings());
            rig.run(0.4, 0.4, 0.5);
            let next = |rig: &mut Rig| {
                rig.now = rig.now.wrapping_add(step);
                rig.drive.step(rig.now, Ok(rig.counts())).unwrap();
            };
            next(&mut rig);
            let commanded = rig.now.wrapping_add(at);
            assert_eq!(rig.command(0.4, 0.4), [Ok(()); 2]);
            while rig.told() != BRAKES {
                next(&mut rig);
                assert!(rig.now.wrapping_sub(commanded) <= 200_000, "{step} {at}");
            }
            let after = rig.now.wrapping_sub(commanded);
            assert!(after + 2 * step > 200_000, "{step} {at}: {after}");
        }
    }
}

#[test]
fn a_late_step_sees_the_timeout() {
    for pause in [200_001, 900_000] {
        let mut rig = Rig::new(settings());
        rig.run(0.4, 0.4, 0.5);
        assert_eq!(rig.command(0.4, 0.4), [Ok(()); 2]);
        rig.now = rig.now.wrapping_add(pause - STEP_US);
        let _ = rig.step(Ok(rig.counts()));
        assert_eq!(rig.told(), BRAKES, "{pause}");
    }
}

#[test]
fn hard_work_is_no_stall() {
    // Full speed needs more than the stall's effort all the time.
    let mut rig = Rig::new(settings());
    let result = rig.run(0.8, -0.8, 3.0).result;
    assert_eq!(result, Ok(()));
    assert!(rig.drive.effort(Side::Left) >= Effort::lit("0.7"));
    assert!(rig.drive.effort(Side::Right) <= Effort::lit("-0.7"));
}

#[test]
fn a_crossed_encoder_is_found_by_the_stall_check() {
    let mut rig = Rig::new(settings());
    rig.crossed = true;
    let result = rig.run(0.2, 0.2, 2.0).result;
    assert_eq!(result, Err(WheelFault::Stalled(Side::Right)));
    assert_eq!(rig.told(), COASTS);
}

#[test]
fn missing_counts_are_bridged_for_the_timeout_only() {
    let mut rig = Rig::new(settings());
    rig.run(0.4, 0.4, 1.0);
    for step in 0..60 {
        let _ = rig.command(0.4, 0.4);
        let result = rig.step(Err(Fault::Bus));
        if step < 40 {
            assert_eq!(result, Ok(()), "step {step}");
            near(rig.speeds, [0.4, 0.4], 0.1);
        } else {
            assert_eq!(result, Err(WheelFault::Encoders(Fault::Bus)), "step {step}");
            assert_eq!(rig.told(), BRAKES);
        }
    }
    assert_eq!(
        rig.command(0.4, 0.4),
        [Err(WheelFault::Encoders(Fault::Bus)); 2]
    );
    let result = rig.run(0.4, 0.4, 1.0).result;
    assert_eq!(result, Ok(()));
    near(rig.speeds, [0.4, 0.4], 0.05);
}

#[test]
fn without_any_counts_nothing_moves() {
    let mut rig = Rig::new(settings());
    for _ in 0..100 {
        let _ = rig.command(0.4, 0.4);
        let _ = rig.step(Err(Fault::NeverSeen));
        assert_eq!(rig.told(), BRAKES);
    }
}

#[test]
fn a_failing_output_switches_both_off_and_is_tried_again() {
    let mut rig = Rig::new(settings());
    rig.run(0.4, 0.4, 0.5);
    rig.motors[0].1.set(true);
    let result = rig.run(0.4, 0.4, 0.1).result;
    let fault = WheelFault::Output(BridgeError::Motor(Side::Left));
    assert_eq!(result, Err(fault));
    assert_eq!(rig.told(), COASTS);
    assert_eq!(rig.drive.effort(Side::Right), Effort::ZERO);
    assert_eq!(rig.command(0.4, 0.4), [Err(fault); 2]);
    rig.motors[0].1.set(false);
    let result = rig.run(0.4, 0.4, 1.0).result;
    assert_eq!(result, Ok(()));
    near(rig.speeds, [0.4, 0.4], 0.05);
}

#[test]
fn a_loop_that_is_not_stepped_switches_off() {
    let mut rig = Rig::new(settings());
    rig.run(0.4, 0.4, 0.5);
    for tick in 0..4 {
        assert_eq!(rig.command(0.4, 0.4), [Ok(()); 2], "tick {tick}");
        assert!(matches!(rig.told()[0], MotorCommand::Drive(_)));
    }
    assert_eq!(rig.command(0.4, 0.4), [Err(WheelFault::NotStepped); 2]);
    assert_eq!(rig.told(), COASTS);
    let result = rig.run(0.4, 0.4, 1.0).result;
    assert_eq!(result, Ok(()));
}

#[test]
fn stop_is_immediate_and_lasts() {
    let mut rig = Rig::new(settings());
    rig.run(0.4, 0.4, 0.5);
    rig.drive.stop().unwrap();
    assert_eq!(rig.told(), COASTS);
    rig.step(Ok(rig.counts())).unwrap();
    assert_eq!(rig.told(), BRAKES);
}

#[test]
fn the_integral_is_gain_times_error_times_time() {
    let mut control = SpeedLoop::default();
    for _ in 0..10 {
        control.step(&GAINS, Effort::FULL, speed(0.3), Some(speed(0.2)), 10_000);
    }
    // 5 /m · 0.1 m/s · 0.1 s.
    let share = control.integral() as f64 / 2_f64.powi(32);
    assert!((share - 0.05).abs() < 1e-4, "{share}");
    // A pause counts 0.1 s only.
    control.step(
        &GAINS,
        Effort::FULL,
        speed(0.3),
        Some(speed(0.2)),
        3_000_000,
    );
    let share = control.integral() as f64 / 2_f64.powi(32);
    assert!((share - 0.1).abs() < 1e-4, "{share}");
    control.step(&GAINS, Effort::FULL, speed(0.3), None, 10_000);
    assert!((control.integral() as f64 / 2_f64.powi(32) - share).abs() < 1e-9);
    control.reset();
    assert_eq!(control.integral(), 0);
}

#[test]
fn settings_are_checked() {
    let with = |change: fn(&mut WheelLoopSettings)| {
        let mut settings = settings();
        change(&mut settings);
        let bridge = Bridge::new(Keep::default(), Keep::default());
        WheelLoop::new(bridge, settings)
            .map(|_| ())
            .map_err(|e| e.field)
    };
    assert_eq!(with(|_| ()), Ok(()));
    assert_eq!(
        with(|s| s.timeout = seconds(0.2001)),
        Err("wheel_loop.timeout")
    );
    assert_eq!(
        with(|s| s.timeout = seconds(0.0)),
        Err("wheel_loop.timeout")
    );
    assert_eq!(with(|s| s.limit = Effort::ZERO), Err("wheel_loop.limit"));
    assert_eq!(
        with(|s| s.stall.effort = Effort::ZERO),
        Err("wheel_loop.stall.effort")
    );
    assert_eq!(
        with(|s| s.stall.time = seconds(0.0)),
        Err("wheel_loop.stall.time")
    );
    assert_eq!(
        with(|s| s.metres_per_count = U0F32::ZERO),
        Err("wheel_loop.metres_per_count")
    );
    assert_eq!(
        with(|s| s.gains[1].integral = fx(-0.1)),
        Err("wheel_loop.gains")
    );
    assert_eq!(
        with(|s| s.gains[0].static_effort = fx(1.1)),
        Err("wheel_loop.gains.static_effort")
    );
    assert_eq!(
        with(|s| s.deadband = speed(-0.1)),
        Err("wheel_loop.deadband")
    );
    let beyond_limit = |s: &mut WheelLoopSettings| s.stall.effort = Effort::FULL;
    assert_eq!(with(beyond_limit), Err("wheel_loop.stall.effort"));
    assert_eq!(with(|s| s.stall.counts = 0), Err("wheel_loop.stall.counts"));
    assert_eq!(
        with(|s| s.stall.time = seconds(11.0)),
        Err("wheel_loop.stall.time")
    );
}

/// Every command of a motor, and whether a pin error struck: nothing but `Drive` within the limit ever comes.
#[derive(Clone, Default)]
struct Limits(Rc<RefCell<Vec<i16>>>);

impl Motor for Limits {
    type Error = core::convert::Infallible;
    fn drive(&mut self, effort: Effort) -> Result<(), Self::Error> {
        self.0.borrow_mut().push(effort.bits());
        Ok(())
    }
    fn brake(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }
    fn coast(&mut self) -> Result<(), Self::Error> {
        Ok(())
    }
}

fn gain() -> impl Strategy<Value = I16F16> {
    prop_oneof![0..=1000_i32 << 16, 0..=10_i32 << 16].prop_map(I16F16::from_bits)
}

proptest! {
    #![proptest_config(config(256))]

    /// Whatever the gains, speeds and step times: effort and integral stay within the limit, and a loop that was held for
    /// ever lets go as soon as the error turns.
    #[test]
    fn windup_is_bounded(
        gains in prop::array::uniform4(gain()),
        limit in 1_i16..,
        inputs in prop::collection::vec((any::<i32>(), prop::option::of(any::<i32>()), any::<u32>()), 1..50),
    ) {
        let gains = Gains {
            static_effort: gains[0].min(fx(1.0)),
            feed_forward: gains[1],
            proportional: gains[2],
            integral: gains[3],
        };
        let limit = Effort::from_bits(limit);
        let bound = (i64::from(limit.bits()) << 32) / 32_767;
        let mut control = SpeedLoop::default();
        for (wanted, measured, elapsed) in inputs {
            let to = |bits| fuzzypilot::units::MetresPerSecond::from_bits(bits);
            let effort = control.step(&gains, limit, to(wanted), measured.map(to), elapsed);
            prop_assert!(effort.bits().unsigned_abs() <= limit.bits().unsigned_abs());
            prop_assert!(control.integral().abs() <= bound);
        }
    }

    /// A wheel held for ten minutes: once it runs a little faster than wanted, effort leaves the limit within the time in
    /// which the integral covers twice the limit.
    #[test]
    fn a_held_wheel_recovers(integral in 1.0..50.0_f64, excess in 0.05..0.5_f64) {
        let gains = Gains { integral: fx(integral), ..GAINS };
        let limit = Effort::lit("0.9");
        let mut control = SpeedLoop::default();
        for _ in 0..6_000 {
            control.step(&gains, limit, speed(0.3), Some(speed(0.0)), 100_000);
        }
        let time = 2.0 * 0.9 / (integral * excess);
        let mut effort = limit;
        for _ in 0..(time / 0.005) as u32 + 2 {
            effort = control.step(&gains, limit, speed(0.3), Some(speed(0.3 + excess)), 5_000);
        }
        prop_assert!(effort < limit, "{effort:?}");
    }

    /// Forward and backward are the same law, to the last bit.
    #[test]
    fn both_directions_are_alike(speeds in prop::collection::vec((-0.9..0.9_f64, -0.9..0.9_f64), 1..40)) {
        let (mut ahead, mut back) = (SpeedLoop::default(), SpeedLoop::default());
        let limit = Effort::lit("0.9");
        for (wanted, measured) in speeds {
            let a = ahead.step(&GAINS, limit, speed(wanted), Some(speed(measured)), 5_000);
            let b = back.step(&GAINS, limit, -speed(wanted), Some(-speed(measured)), 5_000);
            prop_assert_eq!(a, b.reversed());
        }
    }

    /// Random commands, counts, faults and times: the motors never see more than the limit.
    #[test]
    fn anything_is_survived(
        events in prop::collection::vec((any::<u8>(), any::<i32>(), any::<i32>(), 0_u32..400_000), 1..200),
    ) {
        let motor = Limits::default();
        let bridge = Bridge::new(motor.clone(), motor.clone());
        let mut drive = WheelLoop::new(bridge, settings()).unwrap();
        let mut now = 0_u32;
        for (kind, a, b, time) in events {
            now = now.wrapping_add(time);
            let to = |bits| fuzzypilot::units::MetresPerSecond::from_bits(bits);
            match kind % 8 {
                0 => { let _ = drive.step(now, Err(Fault::Timeout)); }
                1 => drive.clear(),
                2 => { let _ = drive.set_speed(Side::Left, to(a)); }
                3 => { let _ = drive.set_speed(Side::Right, to(b)); }
                _ => {
                    let _ = drive.set_speed(Side::Left, to(a >> 12));
                    let _ = drive.set_speed(Side::Right, to(b >> 12));
                    let _ = drive.step(now, Ok(WheelCounts { left: a, right: b }));
                }
            }
        }
        let limit = Effort::lit("0.9").bits();
        prop_assert!(motor.0.borrow().iter().all(|bits| (-limit..=limit).contains(bits)));
    }
}
