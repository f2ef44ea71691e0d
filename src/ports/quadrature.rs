//! Wheel encoders: two quadrature counters in hardware, or decoded in software.
//!
//! A counter of 16 bits wraps every few metres; [`QuadratureEncoders`] extends it to the 32 bits that the tick expects.
//! That is right as long as a wheel turns less than half the counter's range between two reads: 32 767 counts for 16
//! bits.

use super::{Fault, WheelCounts, WheelEncoders};

/// A raw count as wide as the hardware's counter.
pub trait RawCount: Copy + core::fmt::Debug {
    /// Counts from `earlier` to `self` by the short way round, sign-extended.
    fn since(self, earlier: Self) -> i32;
}

impl RawCount for u16 {
    fn since(self, earlier: Self) -> i32 {
        i32::from(self.wrapping_sub(earlier).cast_signed())
    }
}

impl RawCount for u32 {
    fn since(self, earlier: Self) -> i32 {
        self.wrapping_sub(earlier).cast_signed()
    }
}

/// One quadrature counter: embedded-hal 1.0 has no trait for it.
///
/// ```
/// use fuzzypilot::ports::{Fault, WheelEncoders, quadrature::*};
///
/// # struct Timer(u16);
/// # impl Timer { fn count(&self) -> u16 { self.0 } }
/// struct Left(Timer);                        // your HAL's quadrature timer
/// impl QuadratureCounter for Left {
///     type Raw = u16;                        // TIM3 and TIM4 of an STM32F411; its TIM2 and TIM5 have 32 bits
///     fn raw(&mut self) -> Result<u16, Fault> { Ok(self.0.count()) }
/// }
/// let mut encoders = QuadratureEncoders::new(Left(Timer(65_530)), Left(Timer(7))).reverse(false, true);
/// assert_eq!(encoders.counts()?.left, 0);    // counting begins where the counters stand
/// # Ok::<(), Fault>(())
/// ```
pub trait QuadratureCounter {
    /// The counter's width.
    type Raw: RawCount;

    /// The counter's value now, or why it cannot be read.
    fn raw(&mut self) -> Result<Self::Raw, Fault>;
}

/// [`WheelEncoders`] over two counters; both start at 0, wherever the counters stand at the first read.
#[derive(Clone, Debug)]
pub struct QuadratureEncoders<L: QuadratureCounter, R: QuadratureCounter> {
    left: Channel<L>,
    right: Channel<R>,
}

impl<L: QuadratureCounter, R: QuadratureCounter> QuadratureEncoders<L, R> {
    /// Counts as the hardware does, without a plausibility check.
    pub fn new(left: L, right: R) -> Self {
        Self {
            left: Channel::new(left),
            right: Channel::new(right),
        }
    }

    /// Which counters run backwards when the wheel rolls forward: on most robots one of the two.
    pub fn reverse(mut self, left: bool, right: bool) -> Self {
        self.left.reverse = left;
        self.right.reverse = right;
        self
    }

    /// No wheel can turn more than `counts` from one read to the next: more is [`Fault::OutOfRange`], as from a counter
    /// that was reset or a disturbed bus.
    ///
    /// A single disturbed read costs that read only: the next good one contains the travel in between, as
    /// [`WheelEncoders`] asks. A counter that has truly jumped, and goes on plausibly from there, is believed again after
    /// [`JUMP_READS`] reads; the jump is not travel.
    pub fn at_most(mut self, counts: u16) -> Self {
        self.left.most = Some(counts);
        self.right.most = Some(counts);
        self
    }
}

impl<L: QuadratureCounter, R: QuadratureCounter> WheelEncoders for QuadratureEncoders<L, R> {
    fn counts(&mut self) -> Result<WheelCounts, Fault> {
        // Both are read, close together, whatever the first says.
        let (left, right) = (self.left.read(), self.right.read());
        Ok(WheelCounts {
            left: left?,
            right: right?,
        })
    }
}

/// Reads after which a counter that jumped is believed at its new place.
pub const JUMP_READS: u8 = 3;

#[derive(Clone, Debug)]
struct Channel<C: QuadratureCounter> {
    counter: C,
    reverse: bool,
    most: Option<u16>,
    total: i32,
    /// The last raw value that was believed.
    good: Option<C::Raw>,
    /// The last raw value that was not, and how many in a row agreed with one another.
    doubt: Option<(C::Raw, u8)>,
    /// Reads since the last believed one.
    missed: u8,
}

impl<C: QuadratureCounter> Channel<C> {
    fn new(counter: C) -> Self {
        Self {
            counter,
            reverse: false,
            most: None,
            total: 0,
            good: None,
            doubt: None,
            missed: 0,
        }
    }

    fn read(&mut self) -> Result<i32, Fault> {
        let missed = self.missed;
        self.missed = missed.saturating_add(1);
        let now = self.counter.raw()?;
        let moved = self.good.map_or(0, |good| now.since(good));
        if !self.plausible(moved, missed) {
            let agreed = match self.doubt {
                Some((last, times)) if self.plausible(now.since(last), 0) => {
                    times.saturating_add(1)
                }
                _ => 1,
            };
            if agreed < JUMP_READS {
                self.doubt = Some((now, agreed));
                return Err(Fault::OutOfRange);
            }
        } else {
            let forward = if self.reverse {
                moved.wrapping_neg()
            } else {
                moved
            };
            self.total = self.total.wrapping_add(forward);
        }
        self.good = Some(now);
        self.doubt = None;
        self.missed = 0;
        Ok(self.total)
    }

    fn plausible(&self, moved: i32, missed: u8) -> bool {
        let reads = u32::from(missed).saturating_add(1);
        self.most
            .is_none_or(|most| moved.unsigned_abs() <= u32::from(most).saturating_mul(reads))
    }
}

/// Decodes A and B in software, for boards without a counter: call [`on_edge`](Self::on_edge) from the interrupt of
/// either line, or at a fixed rate above twice the fastest edge rate.
///
/// Both lines changing at once means that an edge was lost: two counts of unknown direction. It is counted, not
/// guessed. More such steps than tolerated since the last read make that read [`Fault::OutOfRange`].
#[derive(Clone, Copy, Debug, Default)]
pub struct QuadratureDecoder {
    levels: Option<(bool, bool)>,
    count: u32,
    illegal: u32,
    reported: u32,
    tolerated: u32,
}

impl QuadratureDecoder {
    /// At 0; any illegal step is a fault.
    pub const fn new() -> Self {
        Self {
            levels: None,
            count: 0,
            illegal: 0,
            reported: 0,
            tolerated: 0,
        }
    }

    /// Lets so many illegal steps pass between two reads.
    pub const fn tolerate(mut self, steps: u32) -> Self {
        self.tolerated = steps;
        self
    }

    /// The levels of both lines now. A leading B counts up; levels that did not change count nothing.
    pub fn on_edge(&mut self, a: bool, b: bool) {
        let Some((was_a, was_b)) = self.levels.replace((a, b)) else {
            return;
        };
        match (a != was_a, b != was_b) {
            (false, false) => {}
            (true, true) => self.illegal = self.illegal.saturating_add(1),
            // A leads B: after an edge of A the two differ, after an edge of B they are equal.
            (a_changed, _) => {
                self.count = if a_changed == (a != b) {
                    self.count.wrapping_add(1)
                } else {
                    self.count.wrapping_sub(1)
                };
            }
        }
    }

    /// Counts so far, wrapping.
    pub const fn count(&self) -> i32 {
        self.count.cast_signed()
    }

    /// Illegal steps so far; stays at the largest number.
    pub const fn illegal(&self) -> u32 {
        self.illegal
    }
}

impl QuadratureCounter for QuadratureDecoder {
    type Raw = u32;

    fn raw(&mut self) -> Result<u32, Fault> {
        let new = self.illegal.saturating_sub(self.reported);
        self.reported = self.illegal;
        if new > self.tolerated {
            return Err(Fault::OutOfRange);
        }
        Ok(self.count)
    }
}
