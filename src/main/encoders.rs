//! Wheel encoders on timers 2 (32 bits, left) and 3 (16 bits, right), counted by the hardware.

use fuzzypilot::ports::Fault;
use fuzzypilot::ports::quadrature::QuadratureCounter;
use stm32f4::stm32f411::{TIM2, TIM3};

/// Starts both: four counts a period, inputs filtered by eight clocks.
pub fn start(tim2: &TIM2, tim3: &TIM3) {
    const INPUTS: u32 = 0x3131;
    const BOTH_EDGES_OF_BOTH: u32 = 0b011;
    // Safety: values that the fields hold.
    unsafe {
        tim2.ccmr1_input().write(|w| w.bits(INPUTS));
        tim2.smcr().write(|w| w.bits(BOTH_EDGES_OF_BOTH));
        tim2.arr().write(|w| w.bits(u32::MAX));
        tim3.ccmr1_input().write(|w| w.bits(INPUTS));
        tim3.smcr().write(|w| w.bits(BOTH_EDGES_OF_BOTH));
        tim3.arr().write(|w| w.bits(u16::MAX.into()));
    }
    tim2.cr1().write(|w| w.cen().set_bit());
    tim3.cr1().write(|w| w.cen().set_bit());
}

/// The left wheel's; `still` stands for a wheel that does not turn: the emulator's timers know no encoders and run.
#[derive(Debug)]
pub struct Left {
    pub still: bool,
}

/// The right wheel's.
#[derive(Debug)]
pub struct Right {
    pub still: bool,
}

impl QuadratureCounter for Left {
    type Raw = u32;

    fn raw(&mut self) -> Result<u32, Fault> {
        // Safety: a read without side effects.
        let count = unsafe { (*TIM2::ptr()).cnt().read().bits() };
        Ok(if self.still { 0 } else { count })
    }
}

impl QuadratureCounter for Right {
    type Raw = u16;

    fn raw(&mut self) -> Result<u16, Fault> {
        // Safety: a read without side effects.
        let count = unsafe { (*TIM3::ptr()).cnt().read().bits() } as u16;
        Ok(if self.still { 0 } else { count })
    }
}
