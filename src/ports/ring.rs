//! Where range drivers of any kind leave their readings, and the tick finds them: [`RangeSensors`] with ages.

use super::micros::{seconds, since};
use super::{Fault, Range, RangeReading, RangeSensors};

/// A reading as a driver returns it: which of its sensors, what, and when it was measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct Sample {
    /// The sensor's place in its driver, from 0.
    pub index: usize,
    /// What it saw.
    pub range: Range,
    /// When, on the clock that the driver was given.
    pub at_us: u32,
}

/// Measured this long after "now": an interrupt posted while the tick read its clock.
const AHEAD_US: u32 = 1_000_000;

/// Older than this counts as lost; nearly the longest that [`Seconds`](crate::units::Seconds) holds.
const FORGOTTEN_US: u32 = 120_000_000;

/// The latest reading of `N` sensors, in mounting order; every one [`Fault::NeverSeen`] at first.
///
/// Drivers post between the ticks, in any order and from any kind of sensor; the tick finds each one's latest with its
/// age. A reading is never repeated as fresh: after two minutes it is [`Fault::Stale`] whatever the ring's
/// [`max_age`](crate::params::RingGeometry::max_age), and a tick that was not told the time finds all of them stale.
///
/// ```
/// use fuzzypilot::ports::{Range, RangeReading, RangeSensors, ring::Latest};
/// use fuzzypilot::units::{Metres, Seconds};
///
/// let mut ranges = Latest::<3>::new();       // 0: ultrasonic, 1: laser, 2: infrared
/// // between the ticks, as readings come in:
/// ranges.post(1, Range::Echo(Metres::lit("0.8")), 1_000_000);
/// // at the tick (`Robot::tick` does the reading):
/// ranges.at(1_030_000);
/// let mut readings = [RangeReading::NEVER_SEEN; 3];
/// ranges.read(&mut readings);
/// assert_eq!(readings[1].range, Range::Echo(Metres::lit("0.8")));
/// assert_eq!(readings[1].age, Seconds::lit("0.03"));
/// ```
///
/// Where an interrupt posts, share it as your platform shares any state (a `critical_section::Mutex`, an RTIC resource).
#[derive(Clone, Debug)]
pub struct Latest<const N: usize> {
    slots: [Slot; N],
    now_us: Option<u32>,
}

#[derive(Clone, Copy, Debug)]
struct Slot {
    range: Range,
    /// None: the reading has no age that could be told.
    at_us: Option<u32>,
}

impl<const N: usize> Latest<N> {
    /// Nothing seen yet.
    pub const fn new() -> Self {
        let slot = Slot {
            range: Range::Invalid(Fault::NeverSeen),
            at_us: None,
        };
        Self {
            slots: [slot; N],
            now_us: None,
        }
    }

    /// Keeps a reading as the latest of sensor `index`. An index past the last sensor is ignored: the sensor that it was
    /// meant for stays "never seen".
    pub fn post(&mut self, index: usize, range: Range, at_us: u32) {
        if let Some(slot) = self.slots.get_mut(index) {
            *slot = Slot {
                range,
                at_us: Some(at_us),
            };
        }
    }

    /// Tells the time of the coming [`read`](RangeSensors::read); needed before each.
    pub fn at(&mut self, now_us: u32) {
        self.now_us = Some(now_us);
    }
}

impl<const N: usize> Default for Latest<N> {
    fn default() -> Self {
        Self::new()
    }
}

impl<const N: usize> RangeSensors for Latest<N> {
    fn read(&mut self, readings: &mut [RangeReading]) {
        let now = self.now_us.take();
        for (slot, reading) in self.slots.iter_mut().zip(readings) {
            *reading = match (now, slot.at_us) {
                (_, None) => RangeReading::fresh(slot.range),
                (None, Some(_)) => RangeReading::fresh(Range::Invalid(Fault::Stale)),
                (Some(now), Some(at)) => {
                    let mut age = since(now, at);
                    if since(at, now) <= AHEAD_US {
                        age = 0;
                    }
                    if age > FORGOTTEN_US {
                        // For good, or it would look fresh again when the clock has wrapped.
                        *slot = Slot {
                            range: Range::Invalid(Fault::Stale),
                            at_us: None,
                        };
                    }
                    RangeReading {
                        range: slot.range,
                        age: seconds(age),
                    }
                }
            };
        }
    }
}
