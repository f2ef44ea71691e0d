#![cfg_attr(target_os = "none", no_std)]
#![allow(clippy::missing_safety_doc)] // One contract for every function: it stands in `pointer`, and on top of the header.
//! fuzzypilot for C. What stands here is read as `include/fuzzypilot.h`, which is generated from it; `docs/c.md` says how to
//! build, link and call.
//!
//! Every function answers with a [`status::FpStatus`], and where it is not `Ok`, nothing has changed unless its comment
//! says so. What lives longer than a call ([`robot::FpRobot`], [`path::FpPath`], [`fine::FpFine`]) lives in the caller's
//! memory: there is no heap, no global state, and nothing to free.
//!
//! Choices come as plain integers and are checked: an enum that C fills with anything else would be undefined behaviour.

#[cfg(target_endian = "big")]
compile_error!("a record is little endian, and its struct in C is laid over it");

pub mod coarse;
pub mod fine;
mod panic;
pub mod path;
mod pointer;
pub mod robot;
pub mod rule;
pub mod setting;
pub mod status;
mod storage;
mod text;
pub mod tick;
