//! [`WheelDrive`] from two motors: the speed loop of each wheel, in integers.
//!
//! ```text
//!  speed wanted ─┬─▶ feed-forward ───────────────┐
//!                └─▶ (−) ─▶ P, I (bounded) ──────▶ (+) ─▶ effort limit ─▶ motor
//!                     ▲                                                    │
//!                     └────────────── speed measured ◀── encoder counts ◀──┘
//! ```
//!
//! [`set_speed`](WheelDrive::set_speed) only takes the command over. [`WheelLoop::step`] does the work: call it at a fixed
//! rate of 50 to 1000 Hz, at least as often as the tick, with the time and the encoders' counts. Whatever goes wrong, both
//! wheels are commanded, and both stop:
//!
//! | what | wheels | until |
//! |---|---|---|
//! | no command for a wheel within `timeout`, or up to a step less | rest | both are commanded again |
//! | high effort and no counts forward: [`WheelFault::Stalled`] | off | [`WheelLoop::clear`] |
//! | no counts for longer than `timeout`: [`WheelFault::Encoders`] | rest | counts come again |
//! | an output fails: [`WheelFault::Output`] | off | the next step that works |
//! | commands come, steps do not: [`WheelFault::NotStepped`] | off | the next step |
//!
//! *Off* coasts and pulls the standby pin low, *rest* is what a speed of 0 does ([`Rest`]). Each fault is also what
//! `set_speed` returns, so it reaches the tick's record.
//!
//! # Tuning
//!
//! 1. `reverse`, so that a positive effort rolls forward; then the encoders', so that they count up.
//! 2. `static_effort`: the least effort at which the wheel just keeps turning.
//! 3. `feed_forward`: (effort at half speed − `static_effort`) / speed. About 1 / (speed at full effort).
//! 4. `proportional` about as large as `feed_forward`; less if the wheel buzzes. One count in one step is
//!    `metres_per_count / step period` of measured speed: with 0.15 mm and 5 ms these are 0.03 m/s.
//! 5. `integral` about `proportional` / 0.2 s.

use super::bridge::{Bridge, BridgeError, Effort, Motor, MotorCommand};
use super::micros::{micros, since};
use super::{Fault, NoPin, Side, WheelCounts, WheelDrive};
use crate::integer::{quotient, saturate};
use crate::params::ParamError;
use crate::units::{MetresPerSecond, Seconds};
use embedded_hal::digital::OutputPin;
use fixed::types::{I16F16, U0F32};

/// How effort follows speed, for one wheel. Each 0 to 1000.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Gains {
    /// Effort against friction, in the direction wanted: a share, 0 to 1.
    pub static_effort: I16F16,
    /// Effort for a speed, 1/(m/s).
    pub feed_forward: I16F16,
    /// Effort for a speed error, 1/(m/s).
    pub proportional: I16F16,
    /// Effort a second for a speed error, 1/m.
    pub integral: I16F16,
}

/// What a wheel does that is to stand.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Rest {
    /// Brake.
    #[default]
    Brake,
    /// Roll out.
    Coast,
}

/// When a wheel counts as stalled: at least `effort` for `time`, and in that time less than `counts` in the direction of
/// the effort. A reversed encoder, or a wheel that is dragged backwards, is seen by it too.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Stall {
    /// Above what steady driving needs, and not above the limit.
    pub effort: Effort,
    /// At least 1; more where the encoder jitters.
    pub counts: u16,
    /// Above the time that the wheel needs to start, up to 10 s.
    pub time: Seconds,
}

/// Settings of a [`WheelLoop`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WheelLoopSettings {
    /// Wheel travel a count: that of [`Body`](crate::params::Body).
    pub metres_per_count: U0F32,
    /// Gains, left and right wheel.
    pub gains: [Gains; 2],
    /// Whether the motor's forward rolls the wheel backward, left and right.
    pub reverse: [bool; 2],
    /// Largest effort, above 0.
    pub limit: Effort,
    /// Speeds wanted below this are read as 0: slower than the loop can hold. At least 0.
    pub deadband: MetresPerSecond,
    /// What a wheel does at 0.
    pub rest: Rest,
    /// Time without a new command after which the wheels stop: above 0, up to 200 ms.
    pub timeout: Seconds,
    /// Stall check.
    pub stall: Stall,
}

impl WheelLoopSettings {
    fn check(&self) -> Result<(), ParamError> {
        let check = |ok: bool, field, allowed| match ok {
            true => Ok(()),
            false => Err(ParamError { field, allowed }),
        };
        check(
            self.metres_per_count > U0F32::ZERO,
            "wheel_loop.metres_per_count",
            "above 0",
        )?;
        for gains in &self.gains {
            check(
                gains.static_effort >= 0 && gains.static_effort <= 1,
                "wheel_loop.gains.static_effort",
                "0 to 1",
            )?;
            let gain = |gain| (0..=1000 << 16).contains(&I16F16::to_bits(gain));
            check(
                gain(gains.feed_forward) && gain(gains.proportional) && gain(gains.integral),
                "wheel_loop.gains",
                "each 0 to 1000",
            )?;
        }
        check(self.limit > Effort::ZERO, "wheel_loop.limit", "above 0")?;
        check(
            self.deadband >= MetresPerSecond::ZERO,
            "wheel_loop.deadband",
            "0 or more",
        )?;
        check(
            self.timeout > Seconds::ZERO && self.timeout <= const { Seconds::lit("0.2") },
            "wheel_loop.timeout",
            "above 0, up to 0.2 s",
        )?;
        check(
            self.stall.effort > Effort::ZERO && self.stall.effort <= self.limit,
            "wheel_loop.stall.effort",
            "above 0, up to limit",
        )?;
        check(
            self.stall.counts > 0,
            "wheel_loop.stall.counts",
            "1 or more",
        )?;
        check(
            self.stall.time > Seconds::ZERO && self.stall.time <= const { Seconds::lit("10") },
            "wheel_loop.stall.time",
            "above 0, up to 10 s",
        )
    }
}

/// Why the wheels do not turn as commanded.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum WheelFault {
    /// This wheel had high effort and did not turn its way. Stays until cleared.
    Stalled(Side),
    /// The encoders gave no counts for too long, and why.
    Encoders(Fault),
    /// An output failed.
    Output(BridgeError),
    /// [`WheelLoop::step`] is not called any more.
    NotStepped,
}

impl core::fmt::Display for WheelFault {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        match self {
            Self::Stalled(Side::Left) => f.write_str("wheel loop: the left wheel is stalled"),
            Self::Stalled(Side::Right) => f.write_str("wheel loop: the right wheel is stalled"),
            Self::Encoders(fault) => write!(f, "wheel loop: no encoder counts: {fault:?}"),
            Self::Output(error) => write!(f, "wheel loop: {error}"),
            Self::NotStepped => f.write_str("wheel loop: commanded, but not stepped"),
        }
    }
}

impl core::error::Error for WheelFault {}

/// Commands in a row without a step after which the loop is taken for dead: four ticks.
const UNSTEPPED: u8 = 8;

/// Longest step that the integral counts, so that a pause does not jolt the wheels.
const LONGEST_STEP_US: u32 = 100_000;

/// One, with 16 fractional bits.
const ONE: i64 = 1 << 16;

/// One wheel's speed loop: feed-forward, proportional and integral part.
///
/// The integral never exceeds the effort limit, and stands still while the effort is at its limit and the error would
/// drive it further. It is forgotten when the direction wanted changes.
#[derive(Clone, Copy, Debug, Default)]
pub struct SpeedLoop {
    /// Share of effort with 32 fractional bits.
    integral: i64,
    last: MetresPerSecond,
}

impl SpeedLoop {
    /// Integral part now, as a share of effort with 32 fractional bits; within ± the limit.
    pub const fn integral(&self) -> i64 {
        self.integral
    }

    /// One step: the effort within ±`limit` for `wanted`, given the speed `measured` over the last `elapsed_us`. Without a
    /// measurement, feed-forward and the integral as it stands.
    pub fn step(
        &mut self,
        gains: &Gains,
        limit: Effort,
        wanted: MetresPerSecond,
        measured: Option<MetresPerSecond>,
        elapsed_us: u32,
    ) -> Effort {
        let direction = i64::from(wanted.bits().signum());
        if direction != i64::from(self.last.bits().signum()) {
            self.integral = 0;
        }
        self.last = wanted;
        // Efforts below have 16 fractional bits in i64, rounded towards zero so that both directions are the same law.
        // Gains below 2^26, speeds below 2^31, so products below 2^57.
        let of = |gain: I16F16, speed: MetresPerSecond| {
            i64::from(gain.to_bits()).saturating_mul(speed.bits().into())
        };
        // Below 2^31.
        let most = i64::from(u32::from(limit.bits().unsigned_abs()).wrapping_mul(1 << 16) / 32_767);
        let error = measured.map_or(MetresPerSecond::ZERO, |measured| wanted - measured);
        let forward = i64::from(gains.static_effort.to_bits())
            .saturating_mul(direction)
            .saturating_add(of(gains.feed_forward, wanted) / ONE);
        let raw = forward
            .saturating_add(of(gains.proportional, error) / ONE)
            .saturating_add(self.integral / ONE);
        let winds = (raw >= most && error > MetresPerSecond::ZERO)
            || (raw <= most.saturating_neg() && error < MetresPerSecond::ZERO);
        if !winds {
            // 2^32 / 10^6 with 16 more bits: step time with 32 fractional bits, at most 0.1 s.
            let step = i64::from(elapsed_us.min(LONGEST_STEP_US)).saturating_mul(281_474_977) >> 16;
            let grown = (of(gains.integral, error) / ONE).saturating_mul(step) / ONE;
            let bound = most.saturating_mul(ONE);
            self.integral = within(self.integral.saturating_add(grown), bound);
        }
        // Within ±2^16, as the limit is.
        Effort::new(I16F16::from_bits(within(raw, most) as i32))
    }

    /// Forgets what the integral learned.
    pub fn reset(&mut self) {
        *self = Self::default();
    }
}

/// Metres a count · 10^6, with 16 fractional bits; below 2^36.
fn travel(metres_per_count: U0F32) -> i64 {
    let travel = u64::from(metres_per_count.to_bits()).saturating_mul(1_000_000) >> 16;
    travel.cast_signed()
}

fn within(value: i64, bound: i64) -> i64 {
    value.min(bound).max(bound.saturating_neg())
}

/// Both wheels' speed loops on a [`Bridge`].
///
/// ```
/// use fuzzypilot::ports::{Side, WheelCounts, WheelDrive, bridge::*, wheel_loop::*};
/// use fuzzypilot::units::{MetresPerSecond, Seconds};
/// use fixed::types::{I16F16, U0F32};
///
/// # struct Any;
/// # impl Motor for Any {
/// #     type Error = core::convert::Infallible;
/// #     fn drive(&mut self, _: Effort) -> Result<(), Self::Error> { Ok(()) }
/// #     fn brake(&mut self) -> Result<(), Self::Error> { Ok(()) }
/// #     fn coast(&mut self) -> Result<(), Self::Error> { Ok(()) }
/// # }
/// # let (left_motor, right_motor) = (Any, Any);
/// let gains = Gains {
///     static_effort: I16F16::lit("0.08"),
///     feed_forward: I16F16::lit("1.1"),
///     proportional: I16F16::lit("1"),
///     integral: I16F16::lit("5"),
/// };
/// let settings = WheelLoopSettings {
///     metres_per_count: U0F32::lit("0.000142"),          // 65 mm wheel, 1440 counts a turn
///     gains: [gains; 2],
///     reverse: [false, true],
///     limit: Effort::lit("0.9"),
///     deadband: MetresPerSecond::lit("0.02"),
///     rest: Rest::Brake,
///     timeout: Seconds::lit("0.2"),
///     stall: Stall { effort: Effort::lit("0.7"), counts: 4, time: Seconds::lit("0.5") },
/// };
/// let mut drive = WheelLoop::new(Bridge::new(left_motor, right_motor), settings)?;
/// // The tick sets the speeds; a timer steps:
/// drive.set_speed(Side::Left, MetresPerSecond::lit("0.3"))?;
/// drive.set_speed(Side::Right, MetresPerSecond::lit("0.3"))?;
/// drive.step(5_000, Ok(WheelCounts { left: 0, right: 0 }))?;
/// drive.step(10_000, Ok(WheelCounts { left: 7, right: 7 }))?;
/// assert!(drive.effort(Side::Left) > Effort::lit("0.4"));
/// # Ok::<(), Box<dyn core::error::Error>>(())
/// ```
#[derive(Debug)]
pub struct WheelLoop<L, R, S = NoPin> {
    bridge: Bridge<L, R, S>,
    settings: WheelLoopSettings,
    /// Metres a count · 10^6, with 16 fractional bits.
    travel: i64,
    timeout_us: u32,
    stall_us: u32,
    wheels: [Wheel; 2],
    stepped_us: Option<u32>,
    /// Last good counts and when they came.
    counted: Option<(u32, WheelCounts)>,
    /// Time without counts.
    blind_us: u32,
    /// Commands since the last step.
    unstepped: u8,
    stalled: Option<Side>,
    fault: Option<WheelFault>,
}

#[derive(Clone, Copy, Debug, Default)]
struct Wheel {
    target: MetresPerSecond,
    /// Commanded since the last step.
    fresh: bool,
    /// When the command came at the earliest; none is no command.
    commanded_us: Option<u32>,
    speed: MetresPerSecond,
    effort: Effort,
    control: SpeedLoop,
    /// Time at high effort, and counts its way in it.
    strained_us: u32,
    progress: i32,
}

impl<L: Motor, R: Motor, S: OutputPin> WheelLoop<L, R, S> {
    /// Takes the bridge over; the settings are checked. Writes nothing yet.
    pub fn new(bridge: Bridge<L, R, S>, settings: WheelLoopSettings) -> Result<Self, ParamError> {
        settings.check()?;
        Ok(Self {
            bridge,
            travel: travel(settings.metres_per_count),
            timeout_us: micros(settings.timeout),
            stall_us: micros(settings.stall.time),
            settings,
            wheels: [Wheel::default(); 2],
            stepped_us: None,
            counted: None,
            blind_us: 0,
            unstepped: 0,
            stalled: None,
            fault: None,
        })
    }

    /// One step of both loops: `counts` are what the encoders said at `now_us`. Returns what is wrong, as `set_speed`
    /// does until the next step.
    pub fn step(
        &mut self,
        now_us: u32,
        counts: Result<WheelCounts, Fault>,
    ) -> Result<(), WheelFault> {
        self.unstepped = 0;
        let elapsed = self.stepped_us.replace(now_us);
        let elapsed = elapsed.map_or(0, |last| since(now_us, last));
        let encoders = self.measure(now_us, elapsed, counts);
        self.expire(now_us, elapsed);
        self.watch(elapsed);
        let result = if let Some(side) = self.stalled {
            self.release();
            let _ = self.bridge.off();
            Err(WheelFault::Stalled(side))
        } else {
            let [left, right] = self.commands(encoders, elapsed);
            let written = self.bridge.command(left, right);
            written
                .map_err(|error| {
                    self.release();
                    WheelFault::Output(error)
                })
                .and(encoders.map_err(WheelFault::Encoders))
        };
        self.fault = result.err();
        result
    }

    /// Switches both motors off at once, forgets commands and what the loops learned. Commands count again from now on.
    pub fn stop(&mut self) -> Result<(), BridgeError> {
        for wheel in &mut self.wheels {
            wheel.forget();
        }
        self.release();
        self.bridge.off()
    }

    /// Forgets a stall and the commands before it: the robot was armed again.
    pub fn clear(&mut self) {
        for wheel in &mut self.wheels {
            wheel.forget();
        }
        self.stalled = None;
        self.fault = None;
    }

    /// Takes another wheel travel a count, above 0: the odometry's may be set while the robot stands.
    pub fn measure_by(&mut self, metres_per_count: U0F32) {
        self.travel = travel(metres_per_count);
    }

    /// What is wrong since the last step.
    pub fn fault(&self) -> Option<WheelFault> {
        self.fault
    }

    /// Measured speed of a wheel.
    pub fn speed(&self, side: Side) -> MetresPerSecond {
        self.wheel(side).speed
    }

    /// Effort that a wheel's motor is given; forward positive for both.
    pub fn effort(&self, side: Side) -> Effort {
        self.wheel(side).effort
    }

    fn wheel(&self, side: Side) -> &Wheel {
        let [left, right] = &self.wheels;
        match side {
            Side::Left => left,
            Side::Right => right,
        }
    }

    /// Speeds from counts. Err once they have been missing for too long.
    fn measure(
        &mut self,
        now_us: u32,
        elapsed: u32,
        counts: Result<WheelCounts, Fault>,
    ) -> Result<(), Fault> {
        let now = match counts {
            Ok(now) => now,
            Err(fault) => {
                self.blind_us = self.blind_us.saturating_add(elapsed);
                return match self.blind_us > self.timeout_us {
                    true => Err(fault),
                    false => Ok(()),
                };
            }
        };
        self.blind_us = 0;
        let (last_us, last) = self.counted.unwrap_or((now_us, now));
        let moved = [
            now.left.wrapping_sub(last.left),
            now.right.wrapping_sub(last.right),
        ];
        self.counted = Some((now_us, now));
        let time = i32::try_from(since(now_us, last_us)).unwrap_or(i32::MAX);
        for (wheel, moved) in self.wheels.iter_mut().zip(moved) {
            let travel = self.travel.saturating_mul(moved.into());
            // Twice at the same time: the speed stays.
            if let Some(speed) = quotient(travel, time) {
                wheel.speed = MetresPerSecond::from_bits(saturate(speed));
            }
            let its_way = if wheel.effort < Effort::ZERO {
                moved.wrapping_neg()
            } else {
                moved
            };
            wheel.progress = wheel.progress.saturating_add(its_way);
        }
        Ok(())
    }

    /// Dates new commands; forgets both if either is overdue, or would be before another step as long as the last one. A
    /// command is as old as the step before it at most.
    fn expire(&mut self, now_us: u32, elapsed: u32) {
        let mut overdue = false;
        for wheel in &mut self.wheels {
            if core::mem::take(&mut wheel.fresh) {
                wheel.commanded_us = Some(now_us.wrapping_sub(elapsed));
            }
            overdue |= wheel
                .commanded_us
                .is_none_or(|at| since(now_us, at).saturating_add(elapsed) > self.timeout_us);
        }
        if overdue {
            for wheel in &mut self.wheels {
                wheel.forget();
            }
        }
    }

    /// The stall check, on the effort that the last step gave.
    fn watch(&mut self, elapsed: u32) {
        let stall = &self.settings.stall;
        for (wheel, side) in self.wheels.iter_mut().zip([Side::Left, Side::Right]) {
            let strained = wheel.effort.bits().unsigned_abs() >= stall.effort.bits().unsigned_abs();
            if !strained || wheel.progress >= i32::from(stall.counts) {
                wheel.strained_us = 0;
                wheel.progress = 0;
                continue;
            }
            wheel.strained_us = wheel.strained_us.saturating_add(elapsed);
            if wheel.strained_us >= self.stall_us {
                self.stalled = Some(side);
            }
        }
    }

    /// What each motor is to do.
    fn commands(&mut self, encoders: Result<(), Fault>, elapsed: u32) -> [MotorCommand; 2] {
        let settings = &self.settings;
        let known = self.counted.is_some() && encoders.is_ok();
        let seeing = self.blind_us == 0;
        let mut commands = [MotorCommand::Brake; 2];
        let each = self.wheels.iter_mut().zip(&mut commands);
        for ((wheel, command), (gains, reverse)) in
            each.zip(settings.gains.iter().zip(settings.reverse))
        {
            let standing = wheel.target.abs() < settings.deadband || wheel.target.bits() == 0;
            if standing || !known {
                wheel.release();
                *command = match settings.rest {
                    Rest::Brake => MotorCommand::Brake,
                    Rest::Coast => MotorCommand::Coast,
                };
                continue;
            }
            let measured = seeing.then_some(wheel.speed);
            let effort = wheel
                .control
                .step(gains, settings.limit, wheel.target, measured, elapsed);
            if (effort < Effort::ZERO) != (wheel.effort < Effort::ZERO) {
                wheel.strained_us = 0;
                wheel.progress = 0;
            }
            wheel.effort = effort;
            *command = MotorCommand::Drive(if reverse { effort.reversed() } else { effort });
        }
        commands
    }

    fn release(&mut self) {
        for wheel in &mut self.wheels {
            wheel.release();
        }
    }
}

impl Wheel {
    /// No effort, no memory.
    fn release(&mut self) {
        self.effort = Effort::ZERO;
        self.control.reset();
        self.strained_us = 0;
        self.progress = 0;
    }

    /// No command.
    fn forget(&mut self) {
        self.target = MetresPerSecond::ZERO;
        self.fresh = false;
        self.commanded_us = None;
    }
}

impl<L: Motor, R: Motor, S: OutputPin> WheelDrive for WheelLoop<L, R, S> {
    type Error = WheelFault;

    fn set_speed(&mut self, wheel: Side, speed: MetresPerSecond) -> Result<(), WheelFault> {
        self.unstepped = self.unstepped.saturating_add(1);
        if self.unstepped > UNSTEPPED {
            let _ = self.stop();
            self.fault = Some(WheelFault::NotStepped);
            return Err(WheelFault::NotStepped);
        }
        let [left, right] = &mut self.wheels;
        let wheel = match wheel {
            Side::Left => left,
            Side::Right => right,
        };
        wheel.target = speed;
        wheel.fresh = true;
        self.fault.map_or(Ok(()), Err)
    }
}
