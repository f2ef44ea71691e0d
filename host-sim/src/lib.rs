//! host-sim: the desktop simulator around fuzzypilot's tick.
//!
//! A [`scenario`] says what is driven where; [`run`] closes the loop of [`plant`], [`sensors`] and the library's own
//! `Robot::tick`, or of a robot's behind a link ([`hil`]); [`metrics`], [`recorder`] and [`ticks`] watch it; [`plot`] and [`replay`] show it.
//! [`fuzzy`] is for fuzzy systems without a robot; [`driving`] lets one of them drive it. [`mod@bench`] drives navigators through
//! clutter; [`carmen`] feeds them what a real robot recorded.

pub mod bench;
pub mod carmen;
pub mod control;
pub mod driving;
pub mod fuzzy;
pub mod hil;
pub mod metrics;
pub mod params;
pub mod plant;
pub mod plot;
pub mod put;
pub mod recorder;
pub mod recording;
pub mod replay;
pub mod robot;
pub mod run;
pub mod scenario;
pub mod search;
pub mod sensors;
pub mod si;
pub mod tables;
pub mod ticks;
pub mod track;
pub mod world;
