//! What ends a run: motors off, the cause noted, reset. In a release image nothing panics, or it does not link.

use cortex_m_rt::{ExceptionFrame, exception};
use fuzzypilot::firmware::crash;
use fuzzypilot::link::message::Cause;
use rp2040_pac::{IO_BANK0, PSM, SIO, WATCHDOG};

/// Why the chip started. The note is in a register that a watchdog's reset leaves alone and power-on clears.
pub fn last_reset(watchdog: &WATCHDOG) -> Cause {
    let note = watchdog.scratch0().read().bits();
    // Safety: any value will do.
    watchdog.scratch0().write(|w| unsafe { w.bits(0) });
    match crash::cause(note) {
        Some(cause) => cause,
        None if watchdog.reason().read().timer().bit_is_set() => Cause::Watchdog,
        None => Cause::Boot,
    }
}

/// Everything but the oscillators is reset when the watchdog bites.
pub fn reset_all(psm: &rp2040_pac::psm::RegisterBlock) {
    // Safety: bits 0 and 1 are the oscillators, bit 16 is the last.
    psm.wdsel().write(|w| unsafe { w.bits(0x1_FFFC) });
}

/// Ends the run.
pub fn end(cause: Cause) -> ! {
    cortex_m::interrupt::disable();
    // Safety: the program goes no further, and nothing else touches these registers any more.
    unsafe {
        let (sio, io) = (&*SIO::ptr(), &*IO_BANK0::ptr());
        sio.gpio_out_clr().write(|w| w.bits(super::MOTOR_PINS));
        // The PWM pins become plain outputs, low as well.
        io.gpio(16).gpio_ctrl().write(|w| w.bits(5));
        io.gpio(17).gpio_ctrl().write(|w| w.bits(5));
        sio.gpio_oe_set().write(|w| w.bits(super::MOTOR_PINS));

        let watchdog = &*WATCHDOG::ptr();
        watchdog.scratch0().write(|w| w.bits(crash::word(cause)));
        reset_all(&*PSM::ptr());
        loop {
            watchdog.ctrl().write(|w| w.trigger().set_bit());
        }
    }
}

#[exception]
unsafe fn HardFault(_: &ExceptionFrame) -> ! {
    end(Cause::HardFault)
}

#[exception]
unsafe fn DefaultHandler(_: i16) {
    end(Cause::HardFault)
}

#[cfg(debug_assertions)]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    end(Cause::Panic)
}

/// No panic path may be left: the function that it would call does not exist.
#[cfg(not(debug_assertions))]
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    unsafe extern "C" {
        fn a_panic_is_left_in_the_release_image() -> !;
    }
    unsafe { a_panic_is_left_in_the_release_image() }
}
