//! The ports of a tick whose inputs came in frames.

use crate::link::message::Readings;
use crate::ports::{
    Fault, Ports, Range, RangeReading, RangeSensors, Side, WheelCounts, WheelDrive, WheelEncoders,
};
use crate::units::MetresPerSecond;
use core::convert::Infallible;

/// What stands for a reading that did not come.
const MISSING: RangeReading = RangeReading::fresh(Range::Invalid(Fault::Timeout));

/// The readings of one scan, as far as they have come.
#[derive(Clone, Debug)]
pub(super) struct Scan<const N: usize> {
    readings: [RangeReading; N],
    number: u8,
}

impl<const N: usize> Scan<N> {
    pub const fn new() -> Self {
        Self {
            readings: [MISSING; N],
            number: 0,
        }
    }

    /// Readings that belong to another tick are never taken for this one's.
    pub fn clear(&mut self) {
        self.readings.fill(MISSING);
    }

    /// Turns to scan `number`; what there is of another one is gone.
    pub fn turn_to(&mut self, number: u8) {
        if self.number != number {
            self.clear();
            self.number = number;
        }
    }

    /// Takes over readings from place `first` on; those past the end are ignored.
    pub fn take(&mut self, first: u8, readings: Readings<'_>) {
        let places = self.readings.iter_mut().skip(usize::from(first));
        for (place, reading) in places.zip(readings.iter()) {
            *place = reading.unwrap_or(MISSING);
        }
    }

    /// Ports of a tick: these readings, those counts, and wheels that are commanded in the record only.
    pub fn ports(
        &self,
        counts: Result<WheelCounts, Fault>,
    ) -> Ports<NoWheels, Carried, Scanned<'_>> {
        Ports {
            drive: NoWheels,
            encoders: Carried(counts),
            ranges: Scanned(&self.readings),
        }
    }
}

pub(super) struct NoWheels;

impl WheelDrive for NoWheels {
    type Error = Infallible;
    fn set_speed(&mut self, _: Side, _: MetresPerSecond) -> Result<(), Infallible> {
        Ok(())
    }
}

pub(super) struct Carried(Result<WheelCounts, Fault>);

impl WheelEncoders for Carried {
    fn counts(&mut self) -> Result<WheelCounts, Fault> {
        self.0
    }
}

pub(super) struct Scanned<'a>(&'a [RangeReading]);

impl RangeSensors for Scanned<'_> {
    fn read(&mut self, readings: &mut [RangeReading]) {
        for (place, reading) in readings.iter_mut().zip(self.0) {
            *place = *reading;
        }
    }
}
