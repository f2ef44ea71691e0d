#![no_std]
#![cfg_attr(not(dsp), forbid(unsafe_code))]
#![cfg_attr(dsp, deny(unsafe_code))]
//! A fuzzy controller that drives a differential robot along a path and around obstacles: `no_std`, no allocation,
//! fixed point, the same bits on every architecture.
//!
//! It implements the two-level scheme of *Path Following and Obstacle Avoidance Control Based on Different Fuzzy
//! Grains* (Proceedings of the 2015 Chinese Intelligent Automation Conference, doi 10.1007/978-3-662-46463-2_7), its
//! errata named and selectable, and adds a guidance law that converges on any path.
//!
//! # One tick
//!
//! ```text
//!  ports ─▶ sense ─▶ localise ─▶ guide ─▶ supervise ─▶ behave ─▶ guard ─▶ drive ─▶ ports
//!           echoes   pose        where    follow,      fuzzy     brakes   limits,
//!           circles              to head  avoid, stop  tables    only     wheels
//! ```
//!
//! [`tick::Robot::tick`] is that line in code. Stages never see each other; they pass the records of [`signals`].
//! Settings live in [`params`] (start from [`presets`]), hardware behind the traits of [`ports`]. [`fuzzy`] knows
//! nothing of robots and can be used alone. Around the tick, [`pilot`] is the application that every board runs, and
//! [`link`] the wire to a desktop.
//!
//! For clutter, where one obstacle at a time is not enough, there is a second, larger tick: [`navigate`] remembers what it
//! saw, knows the robot's outline, and finds its way out of dead ends.
//!
//! # Frames, signs, units
//!
//! x forward, y left, counter-clockwise positive (ROS REP 103); metres, seconds, radians. Angles are binary inside: a
//! full turn is 2³², so wrap-around is free ([`units`]). The chapter's own signs (θ, Δθ clockwise positive) exist inside
//! [`tables::coarse`] only; the avoider converts once.
//!
//! # Example
//!
//! ```
//! use fuzzypilot::{geometry::Pose, guide::{Path, Segment}, ports::*, presets, tick::Robot, units::*};
//!
//! struct Wheels;                                            // your motor driver
//! impl WheelDrive for Wheels {
//!     type Error = core::convert::Infallible;
//!     fn set_speed(&mut self, _: Side, _: MetresPerSecond) -> Result<(), Self::Error> { Ok(()) }
//! }
//! struct Encoders;                                          // your counters
//! impl WheelEncoders for Encoders {
//!     fn counts(&mut self) -> Result<WheelCounts, Fault> { Ok(WheelCounts { left: 0, right: 0 }) }
//! }
//! struct Ranges;                                            // your range sensors
//! impl RangeSensors for Ranges {
//!     fn read(&mut self, readings: &mut [RangeReading]) { readings.fill(RangeReading::fresh(Range::Clear)) }
//! }
//!
//! let params = presets::small_robot::<8>().checked()?;
//! let line = [Segment::line(Pose::default(), Metres::lit("5"))];
//! let path = Path::segments(&line, false)?;
//! let mut robot = Robot::new(params, Pose::default());
//! let mut ports = Ports { drive: Wheels, encoders: Encoders, ranges: Ranges };
//! let record = robot.tick(&path, &mut ports);               // every 50 ms
//! assert!(record.twist.linear > MetresPerSecond::ZERO);     // off it goes
//! # Ok::<(), Box<dyn core::error::Error>>(())
//! ```

pub mod behaviour;
pub mod drive;
pub mod firmware;
pub mod fuzzy;
pub mod geometry;
pub mod guard;
pub mod guide;
mod integer;
pub mod link;
pub mod localise;
pub mod navigate;
pub mod params;
pub mod pilot;
pub mod ports;
pub mod presets;
pub mod sense;
pub mod signals;
pub mod supervisor;
pub mod tables;
pub mod tick;
pub mod units;
