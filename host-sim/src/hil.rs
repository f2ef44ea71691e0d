//! Hardware in the loop: the plant here, the tick on a robot behind a [`wire`], in lock-step.
//!
//! ```text
//!  run ─▶ target ─▶ line ─▶ fault ─▶ wire: local, serial or emulator ─▶ the firmware's Pilot
//!         tick by   frames,  spoils
//!         tick      retries  frames
//! ```
//!
//! The robot gets the scenario's settings and path, and with every tick its time, encoder counts and ranges; its records
//! come back. `docs/hil.md` tells how to use it, `docs/link.md` what is said.

pub mod fault;
pub mod hostile;
pub mod line;
pub mod local;
#[cfg(unix)]
pub mod qemu;
pub mod report;
pub mod serial;
pub mod target;
pub mod wire;

use crate::params::params;
use crate::run::{Ending, OwnedPath, Period, RunError, drive};
use crate::scenario::Scenario;
use crate::si;
use fuzzypilot::link::frame::VERSION;
use fuzzypilot::link::message::{Cause, Why};
use fuzzypilot::params::Params;
use line::Line;
use report::LinkReport;
use std::time::Duration;
use target::Target;
use wire::Wire;

/// No robot is silent for longer than this without the run being ended: with what is left to do then, in two seconds.
pub const LONGEST_SILENCE: Duration = Duration::from_millis(1200);

/// Why a robot at the other end of a link is of no use (any more).
#[derive(Debug, thiserror::Error)]
pub enum Outage {
    /// There is nobody.
    #[error("{wire}: cannot be opened: {why}")]
    Unopened {
        /// What it should lead to.
        wire: String,
        /// What the system says.
        why: String,
    },
    /// The wire ended.
    #[error("{wire}: the link is gone: {why}")]
    Gone {
        /// What it led to.
        wire: String,
        /// What the system or the emulator says.
        why: String,
    },
    /// Nothing was heard for [`LONGEST_SILENCE`] in the set-up.
    #[error(
        "{wire}: no answer for {} ms: is it on, is fuzzypilot's firmware in it, is the baud rate right?",
        LONGEST_SILENCE.as_millis()
    )]
    Mute {
        /// What it leads to.
        wire: String,
    },
    /// Nothing was heard for [`LONGEST_SILENCE`] in the run.
    #[error("{wire}: no answer for {} ms at {time:.2} s of the run", LONGEST_SILENCE.as_millis())]
    Silent {
        /// What it leads to.
        wire: String,
        /// When, s.
        time: f64,
    },
    /// It is heard, but its records are not.
    #[error("{wire}: {ticks} ticks in a row were lost until {time:.2} s of the run")]
    Deaf {
        /// What it leads to.
        wire: String,
        /// How many.
        ticks: u32,
        /// When, s.
        time: f64,
    },
    /// Hostile frames have had an effect.
    #[error("{wire}: after {frames} hostile frames: {what}")]
    Fell {
        /// What it leads to.
        wire: String,
        /// How many it stood.
        frames: u64,
        /// The effect.
        what: String,
    },
    /// Another protocol.
    #[error(
        "{wire}: it speaks protocol version {found}; allowed is {VERSION}: flash the firmware of this host-sim"
    )]
    Protocol {
        /// What it leads to.
        wire: String,
        /// The robot's.
        found: u8,
    },
    /// Another firmware: it may compute something else.
    #[error("{wire}: its firmware is {found}; allowed is {own}, this host-sim's own: flash that")]
    Firmware {
        /// What it leads to.
        wire: String,
        /// The robot's.
        found: String,
        /// This program's.
        own: String,
    },
    /// The scenario does not fit.
    #[error("{wire}: it has room for {room} {what}; the scenario has {needed}")]
    Room {
        /// What it leads to.
        wire: String,
        /// Of what.
        what: &'static str,
        /// How many fit.
        room: usize,
        /// How many there are.
        needed: usize,
    },
    /// The robot refused something that it must not refuse.
    #[error("{wire}: it refused {what}: {why}{}", hint(*why))]
    Refused {
        /// What it leads to.
        wire: String,
        /// What was asked.
        what: String,
        /// Its reason.
        why: Why,
    },
    /// An answer that makes no sense.
    #[error("{wire}: it answered {what} by something else: {found}")]
    Confused {
        /// What it leads to.
        wire: String,
        /// What was asked.
        what: String,
        /// What came.
        found: String,
    },
    /// The robot has started anew, and knows nothing any more.
    #[error("{wire}: it has restarted at {time:.2} s of the run: {cause}")]
    Restarted {
        /// What it leads to.
        wire: String,
        /// When, s.
        time: f64,
        /// Why, as it says.
        cause: Cause,
    },
    /// The robot has disarmed itself or was stopped, and nobody asked for it to be armed again.
    #[error("{wire}: it was disarmed at {time:.2} s of the run: {cause}; {hint}")]
    Disarmed {
        /// What it leads to.
        wire: String,
        /// When, s.
        time: f64,
        /// Why.
        cause: Cause,
        /// What to do.
        hint: &'static str,
    },
    /// The person at the keyboard has enough.
    #[error("interrupted")]
    Interrupted,
}

/// What to do about a refusal, where a person at the robot must.
fn hint(why: Why) -> &'static str {
    match why {
        Why::Emergency => {
            "; release it, or join its input to ground where there is none (docs/hil.md)"
        }
        _ => "",
    }
}

/// Why nothing was driven.
#[derive(Debug, thiserror::Error)]
pub enum HilError {
    /// The scenario cannot be run at all.
    #[error(transparent)]
    Run(#[from] RunError),
    /// The robot cannot be used.
    #[error(transparent)]
    Outage(#[from] Outage),
}

/// A run that has at least begun.
#[derive(Debug)]
pub struct Driven {
    /// How it ended.
    pub ending: Ending,
    /// Why, if the robot was the reason.
    pub outage: Option<Outage>,
    /// What went over the link.
    pub report: LinkReport,
    /// What the robot has logged.
    pub log: Vec<u8>,
}

/// Range sensors in a scenario, at most.
pub const SENSORS: usize = 64;

/// Runs a scenario with the tick on the robot behind `wire`, and shows every control period to `observe`. After `rearm`
/// good answers in a row a robot that the link has disarmed is armed again; never, if there is no such number.
///
/// # Errors
///
/// Nothing was driven.
pub fn run(
    scenario: &Scenario,
    seed: u64,
    wire: Box<dyn Wire>,
    rearm: Option<u32>,
    observe: &mut dyn FnMut(&Period<'_>),
) -> Result<Driven, HilError> {
    let params: Params<SENSORS> = params(scenario).map_err(RunError::from)?;
    let path = OwnedPath::new(scenario);
    let start = si::pose(scenario.start);
    let mut target = Target::set_up(Line::new(wire), &params, &path, start, rearm)?;
    let period = scenario.robot.period;
    let mut stops: Vec<(f64, f64)> = Vec::new();
    let driven = drive(scenario, seed, &params, &mut target, &mut |seen| {
        if let Period::Gap(gap) = &seen
            && let Some((time, after)) = gap.timed_out
            && stops.last().is_none_or(|(last, _)| *last != time)
        {
            stops.push((time, after));
        }
        observe(&seen);
    });
    let (ending, outage) = match driven {
        Ok(ending) => (ending, None),
        Err(outage @ Outage::Disarmed { .. }) => (Ending::Disarmed, Some(outage)),
        Err(outage) => (Ending::LinkLost, Some(outage)),
    };
    let (mut report, log) = target.finish(period);
    report.motors(&stops);
    Ok(Driven {
        ending,
        outage,
        report,
        log,
    })
}
