//! Whether the robot may move.

use crate::link::message::{Cause, Why};

/// Whether the robot may move. Motion never starts by itself: every arrow to the right is a person's or a desktop's.
///
/// ```text
///  start ─▶ ┌─────────────────┐  the button, or Arm with the token   ┌───────┐
///  Boot,    │ Disarmed(cause) │ ───────────────────────────────────▶ │ Armed │
///  or why   │  wheels stand   │                                      │       │
///  it reset └─────────────────┘ ◀─────────────────────────────────── └───────┘
///               Stop, Button, Emergency · LinkTimeout, Sequence, NewSession · SettingsChanged ·
///               DriveFault, Overrun, Brownout, Watchdog, Panic, HardFault · PathOver
/// ```
///
/// To the right it goes only with settings that were checked since they last changed, a path, the emergency stop
/// released and wheels that obey.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub enum State {
    /// The wheels are commanded to stand.
    Disarmed(Cause),
    /// The robot drives.
    Armed,
}

/// The state and what guards it.
#[derive(Clone, Debug)]
pub(super) struct Arming {
    armed: bool,
    cause: Cause,
    /// Checked and placed since settings and path last changed.
    pub begun: bool,
    /// The emergency stop is pressed.
    pub emergency: bool,
    /// The wheels did not take the command to stand.
    pub drive_fault: bool,
    seed: u32,
    count: u32,
}

impl Arming {
    pub const fn new() -> Self {
        Self {
            armed: false,
            cause: Cause::Boot,
            begun: false,
            emergency: false,
            drive_fault: false,
            seed: 0,
            count: 0,
        }
    }

    pub fn state(&self) -> State {
        match self.armed {
            true => State::Armed,
            false => State::Disarmed(self.cause),
        }
    }

    pub fn is_armed(&self) -> bool {
        self.armed
    }

    /// Cause of the last disarming.
    pub fn cause(&self) -> Cause {
        self.cause
    }

    /// What an arm message must carry. It changes with every session, arming and disarming, so that a frame recorded
    /// before does not arm.
    pub fn token(&self) -> u32 {
        mix(self.seed ^ mix(self.count))
    }

    /// A new session: tokens that nobody can have seen.
    pub fn open(&mut self, nonce: u32, now_us: u32) {
        self.seed = mix(nonce ^ mix(now_us ^ self.seed));
        self.renew();
    }

    fn renew(&mut self) {
        self.count = self.count.wrapping_add(1);
    }

    pub fn arm(&mut self) -> Result<(), Why> {
        if self.emergency {
            Err(Why::Emergency)
        } else if !self.begun {
            Err(Why::NotBegun)
        } else if self.drive_fault {
            Err(Why::DriveFault)
        } else {
            self.armed = true;
            self.renew();
            Ok(())
        }
    }

    /// Disarms, and names the cause.
    pub fn fault(&mut self, cause: Cause) {
        self.armed = false;
        self.cause = cause;
        self.renew();
    }
}

/// Spreads every bit over all: the finaliser of MurmurHash3.
const fn mix(bits: u32) -> u32 {
    let bits = (bits ^ (bits >> 16)).wrapping_mul(0x85eb_ca6b);
    let bits = (bits ^ (bits >> 13)).wrapping_mul(0xc2b2_ae35);
    bits ^ (bits >> 16)
}
