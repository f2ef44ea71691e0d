//! The wire between a robot and a desktop: what is said, how it is framed, and a tick's record as bytes. Shared by the
//! firmware and `host-sim`; `docs/link.md` describes it byte by byte for everybody else.
//!
//! No stage of the tick knows of it.

pub mod frame;
pub mod message;
pub mod record;
pub mod settings;
