//! The navigation bench: many worlds, many seeds, one fast kinematic robot, any [`navigator::Navigator`].
//!
//! [`worlds`] reads and makes [`arena::Arena`]s; [`attempt`] drives one navigator through one of them once, with
//! [`vehicle`], [`ranging`] and [`odometry`] around it; [`campaign`] does so for every world and seed on all cores;
//! [`score`] and [`statistics`] say what came out. [`controllers`] names the navigators, of which [`baselines`] are the
//! field's own.
//!
//! Unlike [`crate::run`] nothing here knows the library's tick: wheels and encoders are left out, so that a tick costs
//! microseconds. Frames and signs are REP 103's: x forward, y left, counter-clockwise positive; metres, seconds,
//! radians.
//!
//! The same seed and world give the same run on every machine and with any number of threads.

pub mod arena;
pub mod attempt;
pub mod baselines;
pub mod body;
pub mod campaign;
pub mod controllers;
pub mod cost;
pub mod discs;
pub mod navigator;
pub mod odometry;
pub mod ours;
pub mod ranging;
pub mod recorded;
pub mod report;
pub mod results;
pub mod rows;
pub mod score;
pub mod seeds;
pub mod sensors;
pub mod shard;
pub mod statistics;
pub mod tracking;
pub mod tuning;
pub mod vehicle;
pub mod worlds;
