//! What ends a run: motors off, the cause noted, reset. In a release image nothing panics, or it does not link.

use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m::peripheral::SCB;
use cortex_m_rt::{ExceptionFrame, exception};
use fuzzypilot::firmware::crash;
use fuzzypilot::link::message::Cause;
use stm32f4::stm32f411::{GPIOA, GPIOB, RCC, TIM1};

/// Survives a reset; noise after power-on.
#[unsafe(link_section = ".uninit.crash")]
static NOTE: AtomicU32 = AtomicU32::new(0);

/// Where it happened: the program counter, or the source line of a panic.
#[unsafe(link_section = ".uninit.crash")]
static PLACE: AtomicU32 = AtomicU32::new(0);

/// Why the chip started, and where the last run ended if it crashed.
pub fn last_reset(rcc: &RCC) -> (Cause, u32) {
    let flags = rcc.csr().read();
    rcc.csr().modify(|_, w| w.rmvf().set_bit());
    let note = NOTE.load(Ordering::Relaxed);
    NOTE.store(0, Ordering::Relaxed);
    let power = flags.porrstf().bit_is_set();
    match crash::cause(note) {
        Some(cause) if !power => (cause, PLACE.load(Ordering::Relaxed)),
        _ if flags.wdgrstf().bit_is_set() => (Cause::Watchdog, 0),
        _ if flags.borrstf().bit_is_set() && !power => (Cause::Brownout, 0),
        _ => (Cause::Boot, 0),
    }
}

/// Both motors off, whatever state the program is in: PWM outputs to idle (low), direction and standby pins low.
fn motors_off() {
    // Safety: stores to registers of outputs that nothing uses after this.
    unsafe {
        (*TIM1::ptr()).bdtr().modify(|_, w| w.moe().clear_bit());
        (*GPIOA::ptr())
            .bsrr()
            .write(|w| w.bits(super::MOTOR_PINS_A << 16));
        (*GPIOB::ptr())
            .bsrr()
            .write(|w| w.bits(super::MOTOR_PINS_B << 16));
    }
}

/// Ends the run.
pub fn end(cause: Cause, place: u32) -> ! {
    cortex_m::interrupt::disable();
    motors_off();
    NOTE.store(crash::word(cause), Ordering::Relaxed);
    PLACE.store(place, Ordering::Relaxed);
    SCB::sys_reset()
}

#[exception]
unsafe fn HardFault(frame: &ExceptionFrame) -> ! {
    end(Cause::HardFault, frame.pc())
}

/// The crystal has stopped.
#[exception]
unsafe fn NonMaskableInt() {
    end(Cause::HardFault, 0)
}

#[exception]
unsafe fn DefaultHandler(number: i16) {
    end(Cause::HardFault, number as u32)
}

#[cfg(debug_assertions)]
#[panic_handler]
fn panic(info: &core::panic::PanicInfo<'_>) -> ! {
    end(
        Cause::Panic,
        info.location().map_or(0, |place| place.line()),
    )
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
