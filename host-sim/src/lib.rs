//! host-sim: the desktop simulator around fuzzypilot's tick.
pub mod recording;
