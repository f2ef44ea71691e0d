//! Recordings of real robots in CARMEN's text format, and what the navigator would have done in their place.
//!
//! [`log`] reads `FLASER`, `ROBOTLASER1` and `ODOM` lines; [`timeline`] puts them on a clock; [`replay`] feeds them to the
//! library's navigator, open loop: the recorded robot goes its own way, and what the navigator decides is only noted.
//! [`summary`] counts it, [`picture`] draws it.

pub mod log;
pub mod picture;
pub mod replay;
pub mod summary;
pub mod timeline;
