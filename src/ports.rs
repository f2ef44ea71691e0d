//! What the tick asks of the hardware. Implement these three traits for your board, or take `host-sim`'s.
//!
//! On the implementer's side of each trait: never block longer than a small share of the control period, never
//! panic, and report trouble as data. On the caller's side: every method is called exactly once a tick, encoders
//! first, ranges next, wheels last, and a failure in one never skips the others.
//!
//! # Drivers
//!
//! Adapters over [`embedded_hal`] 1.0 for usual parts. None blocks, none panics; every error is a value.
//!
//! | module | part | what to call |
//! |---|---|---|
//! | [`bridge`] | H-bridges: PWM + two pins (TB6612FNG, L298N), two PWMs (DRV8833, L9110) | – |
//! | [`wheel_loop`] | [`WheelDrive`]: speed loop over two motors | `step` at 50 to 1000 Hz |
//! | [`quadrature`] | [`WheelEncoders`]: hardware counters of 16 or 32 bits, or a decoder in software | – |
//! | [`echo`] | HC-SR04 and its like, several in turn | `poll` every 0.1 to 2 ms, `edge` from the pin's interrupt |
//! | [`time_of_flight`] | VL53L0X, several on one bus | `poll` every 1 to 5 ms |
//! | [`analog`] | Sharp GP2Y0A21 and its like | `read` between ticks |
//! | [`ring`] | [`RangeSensors`]: the latest reading of each of these, with its age | `post` what they return, `at` before the tick |
//!
//! A robot on them has two rates, the wheel loop's and the tick's:
//!
//! ```
//! # use fuzzypilot::{geometry::Pose, guide::Path, ports::{bridge::Motor, quadrature::QuadratureCounter, ring::Latest}};
//! use fuzzypilot::{ports::*, signals::TickRecord, tick::Robot};
//! use fuzzypilot::ports::{quadrature::QuadratureEncoders, wheel_loop::WheelLoop};
//!
//! # struct Machine<M: Motor, C: QuadratureCounter> {
//! #     robot: Robot<4>,
//! #     ports: Ports<WheelLoop<M, M>, QuadratureEncoders<C, C>, Latest<4>>,
//! # }
//! # impl<M: Motor, C: QuadratureCounter> Machine<M, C> {
//! fn every_5_ms(&mut self, now_us: u32) {
//!     let counts = self.ports.encoders.counts();
//!     let _ = self.ports.drive.step(now_us, counts); // what it says, the next tick's record says, too
//! }
//!
//! fn every_50_ms(&mut self, now_us: u32, path: &Path<'_>) -> TickRecord {
//!     self.ports.ranges.at(now_us);                  // posted to in between, as sensors answer
//!     self.robot.tick(path, &mut self.ports)
//! }
//! # }
//! ```
//!
//! The drivers' clock is `now_us`: microseconds of any free-running counter, 32 bits, wrapping (every 71.6 minutes).
//! All of them get the same one, and each is called at least every half hour.

pub mod analog;
pub mod bridge;
pub mod echo;
pub(crate) mod micros;
pub mod quadrature;
pub mod ring;
mod sound;
pub mod time_of_flight;
pub mod wheel_loop;

use crate::units::{Metres, MetresPerSecond, Seconds};
use core::convert::Infallible;
use embedded_hal::digital;

/// A wheel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Side {
    /// The left wheel, at +y.
    Left,
    /// The right wheel, at −y.
    Right,
}

/// Sets wheel speeds.
///
/// *Implementers*: take the speed over until the next call; forward positive for both wheels. The caller has limited
/// it to the configured wheel speed. If no call comes within 200 ms, stop the wheels by yourself.
///
/// *Callers*: always set both wheels, also after an error on the first.
pub trait WheelDrive {
    /// What can go wrong; only its presence reaches the record.
    type Error: core::fmt::Debug;

    /// Commands one wheel.
    fn set_speed(&mut self, wheel: Side, speed: MetresPerSecond) -> Result<(), Self::Error>;
}

/// Cumulative encoder counts of both wheels; they wrap, and only differences matter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct WheelCounts {
    /// Left wheel, forward positive.
    pub left: i32,
    /// Right wheel, forward positive.
    pub right: i32,
}

/// Reads the wheel encoders.
///
/// *Implementers*: both counts from as nearly the same moment as the hardware allows; sign-extend narrower counters
/// so that wrap-around happens at 32 bits.
///
/// *Callers*: an `Err` means "unknown this tick", and the next good reading contains the travel in between.
pub trait WheelEncoders {
    /// Cumulative counts now, or why not.
    fn counts(&mut self) -> Result<WheelCounts, Fault>;
}

/// Reads a ring of range sensors.
///
/// *Implementers*: fill every entry in the mounting order of [`RingGeometry`](crate::params::RingGeometry); what is not
/// filled stays "never seen". A sensor that has nothing new repeats its last reading with its age; it never repeats it
/// as fresh.
///
/// *Callers*: hand over one entry a mounted sensor, all set to [`RangeReading::NEVER_SEEN`]; treat [`Range::Invalid`] as
/// unknown, never as free.
pub trait RangeSensors {
    /// The latest reading of every sensor.
    fn read(&mut self, readings: &mut [RangeReading]);
}

/// One sensor's latest reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct RangeReading {
    /// What it saw.
    pub range: Range,
    /// Time since it was measured.
    pub age: Seconds,
}

impl RangeReading {
    /// What stands for a sensor that has not answered yet.
    pub const NEVER_SEEN: Self = Self::fresh(Range::Invalid(Fault::NeverSeen));

    /// A reading of this very tick.
    pub const fn fresh(range: Range) -> Self {
        Self {
            range,
            age: Seconds::ZERO,
        }
    }
}

/// What a range sensor saw.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Range {
    /// An echo at this distance from the sensor.
    Echo(Metres),
    /// Nothing up to the sensor's largest range.
    Clear,
    /// No usable reading.
    Invalid(Fault),
}

/// Why a reading is invalid.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum Fault {
    /// Nothing was ever received.
    NeverSeen,
    /// No answer in time.
    Timeout,
    /// The bus, the pin or the sensor itself reported an error.
    Bus,
    /// The value is outside what the sensor can measure.
    OutOfRange,
    /// The last reading is older than allowed.
    Stale,
}

/// The three ports of a robot, owned together.
#[derive(Clone, Debug)]
pub struct Ports<D, E, R> {
    /// Wheel drive.
    pub drive: D,
    /// Wheel encoders.
    pub encoders: E,
    /// Range sensors.
    pub ranges: R,
}

/// An output that is not connected: stands for an optional pin that the robot does not have.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NoPin;

impl digital::ErrorType for NoPin {
    type Error = Infallible;
}

impl digital::OutputPin for NoPin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}
