//! Clock start, bounded: whatever does not answer is done without.
//!
//! ```text
//!  crystal or ST-LINK, measured: 25 or 8 MHz ─┐
//!                  internal oscillator, 16 MHz ┴▶ PLL ─▶ 84 MHz core and timers, 42 MHz serial port and I²C
//! ```

use stm32f4::stm32f411::{FLASH, RCC, TIM11};

/// Where the clock comes from.
#[derive(Clone, Copy, PartialEq, Eq, defmt::Format)]
pub enum Source {
    /// A crystal or clock input of so many MHz, by the PLL.
    External(u8),
    /// The internal oscillator by the PLL, ± 1 % at room temperature: nothing usable came from outside.
    Internal,
    /// The internal oscillator as it is, 16 MHz: the PLL did not start.
    Bare,
    /// None: this is QEMU, which has no clock tree.
    Emulated,
}

/// What runs how fast.
#[derive(Clone, Copy)]
pub struct Clocks {
    pub source: Source,
    /// Core and SysTick, Hz.
    pub core: u32,
    /// TIM1 to TIM5, Hz.
    pub timers: u32,
    /// USART2 and I2C1, Hz.
    pub slow: u32,
}

/// The internal oscillator, Hz.
const INTERNAL: u32 = 16_000_000;

/// How often a flag is looked at before it is given up: 100 ms or so on the internal oscillator, which a crystal has
/// long started in.
const PATIENCE: u32 = 100_000;

/// Whether `ready` became true in time.
pub fn wait(patience: u32, mut ready: impl FnMut() -> bool) -> bool {
    (0..patience).any(|_| ready())
}

/// Starts the clocks.
pub fn start(rcc: &RCC, flash: &FLASH, tim11: &TIM11) -> Clocks {
    // Out of reset the core runs on the internal oscillator, so it is ready: only an emulator has none.
    if rcc.cr().read().hsirdy().bit_is_clear() {
        return Clocks {
            source: Source::Emulated,
            core: 168_000_000,
            timers: 1_000_000_000,
            slow: 42_000_000,
        };
    }
    let external = external(rcc, tim11);
    // The PLL wants 1 MHz.
    let divisor = external.unwrap_or((INTERNAL / 1_000_000) as u8);
    rcc.pllcfgr().write(|w| unsafe {
        w.pllsrc().bit(external.is_some());
        w.pllm().bits(divisor);
        w.plln().bits(168);
        // 0 is a division by 2.
        w.pllp().bits(0);
        w.pllq().bits(7)
    });
    rcc.cr().modify(|_, w| w.pllon().set_bit());
    let locked = wait(PATIENCE, || rcc.cr().read().pllrdy().bit_is_set());
    // Two wait states do for 90 MHz at 2.7 V.
    const LATENCY: u8 = 2;
    flash.acr().write(|w| unsafe {
        w.latency().bits(LATENCY);
        w.prften().set_bit();
        w.icen().set_bit();
        w.dcen().set_bit()
    });
    let slowed = wait(PATIENCE, || flash.acr().read().latency().bits() == LATENCY);
    let switched = locked && slowed && {
        // APB1 at half speed; its timers run at twice that again.
        rcc.cfgr()
            .modify(|_, w| unsafe { w.ppre1().bits(0b100).sw().bits(0b10) });
        wait(PATIENCE, || rcc.cfgr().read().sws().bits() == 0b10)
    };
    if !switched {
        rcc.cfgr()
            .modify(|_, w| unsafe { w.ppre1().bits(0).sw().bits(0) });
        return Clocks {
            source: Source::Bare,
            core: INTERNAL,
            timers: INTERNAL,
            slow: INTERNAL,
        };
    }
    // Should the crystal die on the way, an NMI tells, and the reset after it starts without.
    rcc.cr().modify(|_, w| w.csson().bit(external.is_some()));
    Clocks {
        source: external.map_or(Source::Internal, Source::External),
        core: 84_000_000,
        timers: 84_000_000,
        slow: 42_000_000,
    }
}

/// Starts what is on the oscillator pins and measures it: the two boards have different frequencies. MHz.
fn external(rcc: &RCC, tim11: &TIM11) -> Option<u8> {
    let ready = || wait(PATIENCE, || rcc.cr().read().hserdy().bit_is_set());
    rcc.cr().modify(|_, w| w.hseon().set_bit());
    // A crystal; else a clock from the ST-LINK, as on the Nucleo.
    let running = ready() || {
        rcc.cr().modify(|_, w| w.hseon().clear_bit());
        rcc.cr().modify(|_, w| w.hsebyp().set_bit());
        rcc.cr().modify(|_, w| w.hseon().set_bit());
        ready()
    };
    let found = if running { measure(rcc, tim11) } else { None };
    if found.is_none() {
        rcc.cr().modify(|_, w| w.hseon().clear_bit());
    }
    found
}

/// The external frequency by timer 11, which counts the internal oscillator's periods in 31 · 8 external ones.
fn measure(rcc: &RCC, tim11: &TIM11) -> Option<u8> {
    rcc.cfgr().modify(|_, w| unsafe { w.rtcpre().bits(31) });
    rcc.apb2enr().modify(|_, w| w.tim11en().set_bit());
    tim11.or().write(|w| unsafe { w.rmp().bits(0b10) });
    // Channel 1 from its input, every eighth edge.
    tim11.ccmr1_input().write(|w| unsafe { w.bits(0b1101) });
    tim11.ccer().write(|w| w.cc1e().set_bit());
    tim11.cr1().write(|w| w.cen().set_bit());
    let capture = || {
        let came = wait(PATIENCE, || tim11.sr().read().cc1if().bit_is_set());
        came.then(|| tim11.ccr1().read().bits() as u16)
    };
    // The first capture ends an unknown time.
    let _ = capture()?;
    let first = capture()?;
    let second = capture()?;
    rcc.apb2enr().modify(|_, w| w.tim11en().clear_bit());
    // 248 periods are 158.7 of the internal oscillator's at 25 MHz, 496 at 8 MHz; ± 5 %.
    match second.wrapping_sub(first) {
        151..=167 => Some(25),
        471..=521 => Some(8),
        _ => None,
    }
}
