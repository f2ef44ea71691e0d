//! A board that costs next to nothing: what `with-tick` and `without-tick` have in common.

use core::sync::atomic::{AtomicI32, Ordering::Relaxed};
use fuzzypilot::ports::{
    Fault, Range, RangeReading, RangeSensors, Side, WheelCounts, WheelDrive, WheelEncoders,
};
use fuzzypilot::units::{Metres, MetresPerSecond};

/// Stands for all of the board's registers.
static REGISTER: AtomicI32 = AtomicI32::new(0);

/// Wheels, encoders and ranges.
pub struct Pins;

impl WheelDrive for Pins {
    type Error = core::convert::Infallible;

    fn set_speed(&mut self, _: Side, speed: MetresPerSecond) -> Result<(), Self::Error> {
        REGISTER.store(speed.bits(), Relaxed);
        Ok(())
    }
}

impl WheelEncoders for Pins {
    fn counts(&mut self) -> Result<WheelCounts, Fault> {
        Ok(WheelCounts {
            left: REGISTER.load(Relaxed),
            right: REGISTER.load(Relaxed),
        })
    }
}

impl RangeSensors for Pins {
    fn read(&mut self, readings: &mut [RangeReading]) {
        for reading in readings {
            let echo = Metres::from_bits(REGISTER.load(Relaxed));
            *reading = RangeReading::fresh(Range::Echo(echo));
        }
    }
}

/// The end, also of a fault and of a panic.
pub fn halt() -> ! {
    loop {
        core::hint::spin_loop();
    }
}
