#![no_std]
//! fuzzypilot
pub mod behaviour;
pub mod drive;
pub mod fuzzy;
pub mod geometry;
pub mod guard;
pub mod guide;
pub mod localise;
pub mod params;
pub mod ports;
pub mod sense;
pub mod signals;
pub mod supervisor;
pub mod tables;
pub mod tick;
pub mod units;
