//! Motor PWM on timer 1, whose break input is the emergency stop: it switches the outputs off without the program.

use super::gpio::Pin;
use core::convert::Infallible;
use embedded_hal::pwm::{ErrorType, SetDutyCycle};
use fuzzypilot::firmware::panel::BreakInput;
use stm32f4::stm32f411::TIM1;

/// PWM frequency, Hz: above what is heard.
const FREQUENCY: u32 = 20_000;

/// Switches the timer on, both outputs at 0; `clock` is its clock in Hz.
pub fn start(tim1: &TIM1, clock: u32) -> u16 {
    let top = u16::try_from(clock / FREQUENCY).unwrap_or(u16::MAX);
    // Safety: values that the fields hold.
    unsafe {
        tim1.arr()
            .write(|w| w.bits(u32::from(top.saturating_sub(1))));
        // PWM mode 1 on both. Without preload: a duty of 0 must hold before the direction pins change, not a period later.
        tim1.ccmr1_output().write(|w| w.bits(0x6060));
        tim1.ccer().write(|w| w.cc1e().set_bit().cc2e().set_bit());
        // Idle outputs are driven low; a high break input is a stop, and ends with the next `enable` only.
        tim1.bdtr().write(|w| {
            w.ossr()
                .set_bit()
                .ossi()
                .set_bit()
                .bke()
                .set_bit()
                .bkp()
                .set_bit()
        });
        tim1.egr().write(|w| w.ug().set_bit());
    }
    tim1.cr1().write(|w| w.arpe().set_bit().cen().set_bit());
    enable(tim1);
    top
}

fn enable(tim1: &TIM1) {
    tim1.bdtr().modify(|_, w| w.moe().set_bit());
}

/// The break input, on its pin.
#[derive(Debug)]
pub struct Break<'a>(pub &'a TIM1, pub Pin);

impl BreakInput for Break<'_> {
    fn pressed(&mut self) -> bool {
        self.1.read()
    }

    fn tripped(&mut self) -> bool {
        self.0.sr().read().bif().bit_is_set()
    }

    fn forget(&mut self) {
        // Zeros clear, ones do nothing.
        self.0
            .sr()
            .write(|w| unsafe { w.bits(u32::MAX).bif().clear_bit() });
    }

    fn enable(&mut self) {
        enable(self.0);
    }
}

/// One of the two PWM outputs.
#[derive(Debug)]
pub struct Channel {
    right: bool,
    top: u16,
}

impl Channel {
    /// Channel 1 or, for the `right` motor, 2; `top` is what [`start`] returned.
    pub const fn new(right: bool, top: u16) -> Self {
        Self { right, top }
    }
}

impl ErrorType for Channel {
    type Error = Infallible;
}

impl SetDutyCycle for Channel {
    fn max_duty_cycle(&self) -> u16 {
        self.top
    }

    fn set_duty_cycle(&mut self, duty: u16) -> Result<(), Infallible> {
        // Safety: each channel's register belongs to its one `Channel`.
        let tim1 = unsafe { &*TIM1::ptr() };
        let register = if self.right { tim1.ccr2() } else { tim1.ccr1() };
        register.write(|w| unsafe { w.bits(duty.into()) });
        Ok(())
    }
}
