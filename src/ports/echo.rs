//! Ultrasonic sensors with a trigger pin and an echo pin: HC-SR04, JSN-SR04T, US-100 and their like.
//!
//! ```text
//!  trigger ─┐▔▔├──────────────────────────────
//!  echo    ─────────┤▔▔▔▔▔▔▔▔▔▔▔├─────────────   how long it is high: the sound's way there and back
//!           ≥ 10 µs  rise       fall
//! ```
//!
//! [`EchoRing`] fires its sensors one after the other, so that none hears another's ping, and never waits: `poll` moves
//! on what is due, `edge` notes when the echo pin changed. Ways it can end:
//!
//! | what happens | reading |
//! |---|---|
//! | echo falls within `max_range` | [`Range::Echo`] |
//! | echo falls later | [`Range::Clear`] |
//! | echo falls before `min_range` | [`Fault::OutOfRange`]: too near to measure, or noise |
//! | no rise within `rise` | [`Fault::Timeout`]: no sensor there |
//! | no fall within `fall` | [`Fault::Timeout`] |
//! | no rise, because the pin has been high since before the ping | [`Fault::Bus`]: stuck |
//! | the trigger pin reports an error | [`Fault::Bus`] |

pub use super::sound::speed_of_sound;

use super::micros::{micros, since};
use super::ring::Sample;
use super::{Fault, Range};
use crate::integer::{quotient, saturate};
use crate::params::ParamError;
use crate::units::{Metres, MetresPerSecond, Seconds};
use embedded_hal::digital::OutputPin;

/// Timing of an [`EchoRing`]. Start from [`HC_SR04`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct EchoSettings {
    /// Speed of sound, 100 to 1000 m/s: [`speed_of_sound`] at the expected temperature. 10 °C beside it are 1.8 % of
    /// distance.
    pub sound: MetresPerSecond,
    /// Echoes from nearer are not believed.
    pub min_range: Metres,
    /// Echoes from farther count as clear; above `min_range`.
    pub max_range: Metres,
    /// From one ping to the next, of any sensor: the last echoes must have died away. 1 ms to 1 s.
    pub spacing: Seconds,
    /// Longest time from the trigger to the rise of echo. 1 ms to 1 s.
    pub rise: Seconds,
    /// Longest time that echo is high. More than `max_range` there and back, up to 1 s.
    pub fall: Seconds,
}

/// HC-SR04 at 20 °C: 2 cm to 4 m, 60 ms from ping to ping as its data sheet suggests. It lowers echo after some 38 ms
/// without a target; some copies take 200 ms or never do: these want a longer `fall` or better another copy.
pub const HC_SR04: EchoSettings = EchoSettings {
    sound: MetresPerSecond::lit("343.2"),
    min_range: Metres::lit("0.02"),
    max_range: Metres::lit("4"),
    spacing: Seconds::lit("0.06"),
    rise: Seconds::lit("0.01"),
    fall: Seconds::lit("0.05"),
};

/// Shortest trigger pulse that the sensors ask for.
const TRIGGER_US: u32 = 10;

/// `N` echo sensors on one clock, fired in turn in the order of their trigger pins; their index is their place in it.
/// Neighbours hear each other most: put them far apart in the order. Each measures every `N` · `spacing`: the ring's
/// [`max_age`](crate::params::RingGeometry::max_age) must be above that plus the longest echo, or readings go stale.
///
/// Call [`poll`](Self::poll) every 0.1 to 2 ms. Report the echo pins by [`edge`](Self::edge): best from an interrupt on
/// both edges or a timer's input capture (1 µs is 0.2 mm); else before each poll, with the pin's level (100 µs are 17 mm).
/// Who reports edges only reports the pin's level once more after each of its readings, else one that is stuck high is a
/// [`Fault::Bus`] once and a [`Fault::Timeout`] from then on.
/// Between `poll` and an interrupt's `edge`, share the ring as your platform shares any state.
///
/// ```
/// # use embedded_hal_mock::eh1::digital::{Mock as Pin, State::{High, Low}, Transaction};
/// use fuzzypilot::ports::{Range, echo::{EchoRing, HC_SR04}, ring::Latest};
///
/// # let mut trigger = Pin::new(&[Transaction::set(High), Transaction::set(Low)]);
/// # let mut done = trigger.clone();
/// let mut sonar = EchoRing::new([trigger], HC_SR04)?;
/// let mut ranges = Latest::<1>::new();
/// for now_us in (0..30_000).step_by(100) {               // your timer
///     let echo_is_high = (600..3_514).contains(&now_us); // your pin
///     sonar.edge(0, echo_is_high, now_us);
///     if let Some(sample) = sonar.poll(now_us) {
///         ranges.post(sample.index, sample.range, sample.at_us);
/// #       assert!(matches!(sample.range, Range::Echo(d) if (0.48..0.53).contains(&d.get().to_num::<f64>())));
///     }
/// }
/// # done.done();
/// # Ok::<(), fuzzypilot::params::ParamError>(())
/// ```
#[derive(Debug)]
pub struct EchoRing<T, const N: usize> {
    triggers: [T; N],
    /// Last known levels of the echo pins.
    levels: [bool; N],
    timing: Timing,
    /// The sensor whose turn it is.
    turn: usize,
    phase: Phase,
    /// Whether the trigger of this turn is still high.
    triggering: bool,
    fired_us: Option<u32>,
}

/// Settings, ready to use.
#[derive(Clone, Copy, Debug)]
struct Timing {
    /// Steps of [`Metres`] one way a microsecond of echo, 2^16 of them.
    reach: i64,
    min_range: Metres,
    max_range: Metres,
    spacing_us: u32,
    rise_us: u32,
    fall_us: u32,
}

/// ```text
/// Quiet ──spacing──▶ Fired ──rise──▶ Sounding ──fall──▶ Heard ──▶ Quiet, next sensor
///                      └──too long──▶ Quiet ◀──too long──┘
/// ```
#[derive(Clone, Copy, Debug)]
enum Phase {
    /// Until the next ping is due.
    Quiet,
    /// Triggered; echo has not risen.
    Fired,
    /// Echo is high since then.
    Sounding(u32),
    /// Echo was high so long, and fell then.
    Heard { width_us: u32, at_us: u32 },
}

impl<T: OutputPin, const N: usize> EchoRing<T, N> {
    /// Takes the trigger pins over; the settings are checked. Writes nothing yet: the pins are low from their setup.
    pub fn new(triggers: [T; N], settings: EchoSettings) -> Result<Self, ParamError> {
        const { assert!(N > 0, "a ring of echo sensors has at least one") };
        Ok(Self {
            triggers,
            levels: [false; N],
            timing: Timing::of(&settings)?,
            turn: 0,
            phase: Phase::Quiet,
            triggering: false,
            fired_us: None,
        })
    }

    /// New settings, such as another temperature's speed of sound; they hold from the next reading.
    pub fn set(&mut self, settings: EchoSettings) -> Result<(), ParamError> {
        self.timing = Timing::of(&settings)?;
        Ok(())
    }

    /// The level of an echo pin and when it was seen. A repeated level does no harm; an unknown index is ignored.
    pub fn edge(&mut self, index: usize, high: bool, now_us: u32) {
        let Some(level) = self.levels.get_mut(index) else {
            return;
        };
        let was = core::mem::replace(level, high);
        if index != self.turn {
            return;
        }
        match self.phase {
            Phase::Fired if high && !was => self.phase = Phase::Sounding(now_us),
            Phase::Sounding(rise) if !high => {
                self.phase = Phase::Heard {
                    width_us: since(now_us, rise),
                    at_us: now_us,
                };
            }
            _ => {}
        }
    }

    /// Moves on whatever is due: at most one pin is written. Returns a reading when a turn has ended.
    pub fn poll(&mut self, now_us: u32) -> Option<Sample> {
        let elapsed = self.fired_us.map(|fired| since(now_us, fired));
        if self.triggering && elapsed.is_none_or(|us| us >= TRIGGER_US) {
            self.triggering = false;
            let trigger = self.triggers.get_mut(self.turn)?;
            if trigger.set_low().is_err() {
                return self.end(Range::Invalid(Fault::Bus), now_us);
            }
            return None;
        }
        match self.phase {
            Phase::Quiet => {
                if elapsed.is_some_and(|us| us < self.timing.spacing_us) {
                    return None;
                }
                self.fired_us = Some(now_us);
                let trigger = self.triggers.get_mut(self.turn)?;
                if trigger.set_high().is_err() {
                    return self.end(Range::Invalid(Fault::Bus), now_us);
                }
                self.triggering = true;
                self.phase = Phase::Fired;
                None
            }
            Phase::Fired if elapsed.is_some_and(|us| us > self.timing.rise_us) => {
                let fault = match self.forget_level() {
                    true => Fault::Bus,
                    false => Fault::Timeout,
                };
                self.end(Range::Invalid(fault), now_us)
            }
            Phase::Sounding(rise) if since(now_us, rise) > self.timing.fall_us => {
                self.forget_level();
                self.end(Range::Invalid(Fault::Timeout), now_us)
            }
            Phase::Heard { width_us, at_us } => self.end(self.timing.range(width_us), at_us),
            Phase::Fired | Phase::Sounding(_) => None,
        }
    }

    /// Takes the pin for low, and says what it was believed to be: should a falling edge have been missed, the next rise
    /// counts again.
    fn forget_level(&mut self) -> bool {
        let level = self.levels.get_mut(self.turn);
        level.is_some_and(core::mem::take)
    }

    /// Ends the turn.
    fn end(&mut self, range: Range, at_us: u32) -> Option<Sample> {
        let index = self.turn;
        self.phase = Phase::Quiet;
        self.triggering = false;
        self.turn = match index.saturating_add(1) {
            next if next < N => next,
            _ => 0,
        };
        Some(Sample {
            index,
            range,
            at_us,
        })
    }
}

impl Timing {
    fn of(settings: &EchoSettings) -> Result<Self, ParamError> {
        let check = |ok: bool, field, allowed| match ok {
            true => Ok(()),
            false => Err(ParamError { field, allowed }),
        };
        let least = const { Seconds::lit("0.001") };
        let most = const { Seconds::lit("1") };
        let duration = |time: Seconds| time >= least && time <= most;
        let [slow, fast] = const { [MetresPerSecond::lit("100"), MetresPerSecond::lit("1000")] };
        check(
            settings.sound >= slow && settings.sound <= fast,
            "echo.sound",
            "100 to 1000 m/s",
        )?;
        check(
            settings.min_range >= Metres::ZERO && settings.max_range > settings.min_range,
            "echo.min_range, echo.max_range",
            "0 <= min_range < max_range",
        )?;
        check(duration(settings.spacing), "echo.spacing", "1 ms to 1 s")?;
        check(duration(settings.rise), "echo.rise", "1 ms to 1 s")?;
        // Half of m/s · 2^16 · 2^16 / 10^6.
        let reach = quotient(i64::from(settings.sound.bits()) << 16, 2_000_000).unwrap_or(0);
        let timing = Self {
            reach,
            min_range: settings.min_range,
            max_range: settings.max_range,
            spacing_us: micros(settings.spacing),
            rise_us: micros(settings.rise),
            fall_us: micros(settings.fall),
        };
        check(
            settings.fall <= most && timing.distance(timing.fall_us) > settings.max_range,
            "echo.fall",
            "longer than the echo from max_range, up to 1 s",
        )?;
        Ok(timing)
    }

    fn range(&self, width_us: u32) -> Range {
        match self.distance(width_us) {
            distance if distance < self.min_range => Range::Invalid(Fault::OutOfRange),
            distance if distance > self.max_range => Range::Clear,
            distance => Range::Echo(distance),
        }
    }

    /// One way, of an echo so long; saturates.
    fn distance(&self, width_us: u32) -> Metres {
        Metres::from_bits(saturate(self.reach.saturating_mul(width_us.into()) >> 16))
    }
}
