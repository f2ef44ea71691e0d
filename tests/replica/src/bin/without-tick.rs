//! The bare shell without the library: see `with-tick`. Never run.
#![cfg_attr(target_os = "none", no_std, no_main)]

#[cfg(target_os = "none")]
mod image {
    use core::hint::black_box;
    use fuzzypilot::ports::{RangeReading, RangeSensors, Side, WheelDrive, WheelEncoders};
    use fuzzypilot::units::MetresPerSecond;
    use replica::shell::{Pins, halt};

    #[unsafe(no_mangle)]
    extern "C" fn image_main() -> ! {
        let mut readings = [RangeReading::NEVER_SEEN; 8];
        loop {
            let _ = black_box(Pins.counts());
            Pins.read(&mut readings);
            black_box(&readings);
            let _ = Pins.set_speed(Side::Left, black_box(MetresPerSecond::ZERO));
            let _ = Pins.set_speed(Side::Right, black_box(MetresPerSecond::ZERO));
        }
    }

    #[unsafe(no_mangle)]
    extern "C" fn image_fault() -> ! {
        halt()
    }

    #[panic_handler]
    fn panicked(_: &core::panic::PanicInfo<'_>) -> ! {
        halt()
    }
}

#[cfg(not(target_os = "none"))]
fn main() {}
