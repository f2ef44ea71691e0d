//! The RP2040's clocks, pins, PWM, serial port and watchdog, by registers: every wait is bounded, nothing panics.

use core::convert::Infallible;
use embedded_hal::digital::{self, OutputPin};
use embedded_hal::pwm::{self, SetDutyCycle};
use rp2040_pac::{IO_BANK0, PADS_BANK0, PWM, Peripherals, SIO, TIMER, WATCHDOG};

/// Core clock, Hz.
pub const CORE: u32 = 125_000_000;
/// PWM's period in core clocks: 20 kHz.
const PWM_PERIOD: u16 = 6_250;
/// Slice 0 drives GP16 (A) and GP17 (B).
const SLICE: usize = 0;
/// How often a flag is looked at before it is given up.
const PATIENCE: u32 = 100_000;

fn wait(mut ready: impl FnMut() -> bool) -> bool {
    (0..PATIENCE).any(|_| ready())
}

/// Crystal, PLL, resets; whether all of it answered.
#[allow(clippy::identity_op)]
pub fn start(chip: &Peripherals) -> bool {
    // IO_BANK0, PADS_BANK0, PLL_SYS, PWM, TIMER, UART0.
    const USED: u32 = 1 << 5 | 1 << 8 | 1 << 12 | 1 << 14 | 1 << 21 | 1 << 22;
    // Safety: values that the fields hold, in the order of the data sheet's chapters on XOSC, PLL and clocks.
    unsafe {
        // Glitch-free to the ring oscillator, whatever ran before.
        chip.CLOCKS
            .clk_sys_ctrl()
            .modify(|r, w| w.bits(r.bits() & !1));
        let slow = wait(|| chip.CLOCKS.clk_sys_selected().read().bits() == 1);
        chip.RESETS.reset().modify(|r, w| w.bits(r.bits() | USED));
        chip.RESETS.reset().modify(|r, w| w.bits(r.bits() & !USED));
        // 1 to 15 MHz; 1 ms until it is stable.
        chip.XOSC.startup().write(|w| w.bits(47));
        chip.XOSC.ctrl().write(|w| w.bits(0x00FA_BAA0));
        let stable = wait(|| chip.XOSC.status().read().stable().bit_is_set());
        if !(slow && stable) {
            return false;
        }
        chip.CLOCKS.clk_ref_ctrl().write(|w| w.bits(2));
        let reference = wait(|| chip.CLOCKS.clk_ref_selected().read().bits() == 1 << 2);
        // 12 MHz · 125 / 6 / 2.
        chip.PLL_SYS.cs().write(|w| w.bits(1));
        chip.PLL_SYS.fbdiv_int().write(|w| w.bits(125));
        chip.PLL_SYS.prim().write(|w| w.bits(6 << 16 | 2 << 12));
        chip.PLL_SYS.pwr().write(|w| w.bits(1 << 3));
        let locked = wait(|| chip.PLL_SYS.cs().read().lock().bit_is_set());
        chip.PLL_SYS.pwr().write(|w| w.bits(0));
        if !(reference && locked) {
            return false;
        }
        // The auxiliary source 0 is the PLL.
        chip.CLOCKS.clk_sys_ctrl().write(|w| w.bits(0));
        chip.CLOCKS.clk_sys_ctrl().write(|w| w.bits(1));
        let fast = wait(|| chip.CLOCKS.clk_sys_selected().read().bits() == 2);
        chip.CLOCKS.clk_peri_ctrl().write(|w| w.bits(1 << 11));
        // Microseconds for timer and watchdog: 12 periods of the crystal.
        chip.WATCHDOG.tick().write(|w| w.bits(1 << 9 | 12));
        fast && wait(|| chip.RESETS.reset_done().read().bits() & USED == USED)
    }
}

/// The time: microseconds, wrapping.
pub fn now_us() -> u32 {
    // Safety: a read without side effects.
    unsafe { (*TIMER::ptr()).timerawl().read().bits() }
}

/// PWM on both outputs at 0; the full duty.
pub fn start_pwm(chip: &Peripherals) -> u16 {
    let slice = chip.PWM.ch(SLICE);
    // Safety: values that the fields hold.
    unsafe {
        slice.cc().write(|w| w.bits(0));
        slice.top().write(|w| w.bits(u32::from(PWM_PERIOD) - 1));
        slice.csr().write(|w| w.bits(1));
    }
    Pin(16).function(4);
    Pin(17).function(4);
    PWM_PERIOD
}

/// UART0, 460 800 baud, 8N1, with queues.
pub fn start_uart(chip: &Peripherals) {
    let uart = &chip.UART0;
    // Safety: values that the fields hold. 125 MHz / 16 / 460 800 is 16 + 61/64.
    unsafe {
        uart.uartibrd().write(|w| w.bits(16));
        uart.uartfbrd().write(|w| w.bits(61));
        uart.uartlcr_h().write(|w| w.bits(0b111 << 4));
        uart.uartcr().write(|w| w.bits(1 << 9 | 1 << 8 | 1));
        // Bytes came, or came and no more followed.
        uart.uartimsc().write(|w| w.bits(1 << 6 | 1 << 4));
    }
    Pin(0).function(2);
    Pin(1).pads(PULL_UP);
    Pin(1).function(2);
}

/// 200 ms; it counts twice a microsecond (erratum RP2040-E1).
pub fn start_watchdog(watchdog: &WATCHDOG) {
    feed(watchdog);
    // Safety: the enable bit. It goes on counting while a debugger halts the core.
    watchdog.ctrl().write(|w| unsafe { w.bits(1 << 30) });
}

pub fn feed(watchdog: &WATCHDOG) {
    // Safety: 24 bits.
    watchdog.load().write(|w| unsafe { w.bits(400_000) });
}

/// Which watched pins changed since the last call.
pub fn edges() -> u32 {
    // Safety: reads, and writes that clear the flags that they name.
    let io = unsafe { &*IO_BANK0::ptr() };
    let mut changed = 0u32;
    for pin in 0..2usize {
        let flags = io.intr(pin).read().bits();
        io.intr(pin).write(|w| unsafe { w.bits(flags) });
        for place in 0..8u32 {
            if flags >> (place << 2) & 0b1100 != 0 {
                changed |= 1u32.wrapping_shl((pin as u32) << 3 | place);
            }
        }
    }
    changed
}

const PULL_UP: u32 = 1 << 3;

/// A pin of bank 0, GP0 to GP29.
#[derive(Clone, Copy, Debug)]
pub struct Pin(pub u8);

impl Pin {
    /// The pin's bit.
    pub const fn mask(self) -> u32 {
        1u32.wrapping_shl(self.0 as u32)
    }

    /// 4 mA, Schmitt trigger, input on.
    fn pads(self, pulls: u32) {
        let pin = usize::from(self.0 & 31);
        if pin < 30 {
            // Safety: values that the fields hold; before interrupts are on.
            unsafe {
                (*PADS_BANK0::ptr())
                    .gpio(pin)
                    .write(|w| w.bits(0x52 | pulls))
            };
        }
    }

    fn function(self, number: u32) {
        let pin = usize::from(self.0 & 31);
        if pin < 30 {
            // Safety: as above.
            unsafe {
                (*IO_BANK0::ptr())
                    .gpio(pin)
                    .gpio_ctrl()
                    .write(|w| w.bits(number))
            };
        }
    }

    /// An input that floats.
    pub fn input(self) {
        self.pads(0);
        self.function(5);
    }

    /// An input with pull-up.
    pub fn input_up(self) {
        self.pads(PULL_UP);
        self.function(5);
    }

    /// An output, low at first.
    pub fn output(self) {
        self.write(false);
        // Safety: 1 bits act, 0 bits do nothing.
        unsafe { (*SIO::ptr()).gpio_oe_set().write(|w| w.bits(self.mask())) };
        self.input();
    }

    /// Both edges interrupt; GP0 to GP15.
    pub fn watch(self) {
        let bits = 0b1100u32.wrapping_shl(u32::from(self.0 & 7) << 2);
        // Safety: before interrupts are on.
        let io = unsafe { &*IO_BANK0::ptr() };
        let enable = match self.0 {
            0..8 => io.proc0_inte(0),
            _ => io.proc0_inte(1),
        };
        enable.modify(|r, w| unsafe { w.bits(r.bits() | bits) });
    }

    /// Writes an output; one atomic store.
    pub fn write(self, high: bool) {
        // Safety: 1 bits act, 0 bits do nothing.
        let sio = unsafe { &*SIO::ptr() };
        if high {
            sio.gpio_out_set().write(|w| unsafe { w.bits(self.mask()) });
        } else {
            sio.gpio_out_clr().write(|w| unsafe { w.bits(self.mask()) });
        }
    }

    /// Reads the pin's level.
    pub fn read(self) -> bool {
        // Safety: a read without side effects.
        unsafe { (*SIO::ptr()).gpio_in().read().bits() & self.mask() != 0 }
    }
}

impl digital::ErrorType for Pin {
    type Error = Infallible;
}

impl OutputPin for Pin {
    fn set_low(&mut self) -> Result<(), Infallible> {
        self.write(false);
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        self.write(true);
        Ok(())
    }
}

/// One of the two PWM outputs.
#[derive(Debug)]
pub struct Channel {
    right: bool,
    top: u16,
}

impl Channel {
    /// GP16 or, for the `right` motor, GP17; `top` is what [`start_pwm`] returned.
    pub const fn new(right: bool, top: u16) -> Self {
        Self { right, top }
    }
}

impl pwm::ErrorType for Channel {
    type Error = Infallible;
}

impl SetDutyCycle for Channel {
    fn max_duty_cycle(&self) -> u16 {
        self.top
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        // Safety: both halves are written by PendSV alone.
        let slice = unsafe { (*PWM::ptr()).ch(SLICE) };
        let duty = u32::from(duty);
        slice.cc().modify(|r, w| unsafe {
            w.bits(match self.right {
                true => r.bits() & 0xFFFF | duty << 16,
                false => r.bits() & 0xFFFF_0000 | duty,
            })
        });
        Ok(())
    }
}
