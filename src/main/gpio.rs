//! Pins: set-up, outputs and inputs.

use core::convert::Infallible;
use embedded_hal::digital::{ErrorType, InputPin, OutputPin};
use stm32f4::stm32f411::{GPIOA, GPIOB, GPIOC, gpioh};

/// The ports that the wiring uses.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Port {
    A,
    B,
    C,
}

/// What a pin is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Input that floats.
    Input,
    /// Input with pull-up.
    InputUp,
    /// Push-pull output, low at first.
    Output,
    /// Open-drain output, released at first.
    OpenDrain,
    /// Alternate function.
    Function(u32),
    /// Alternate function with pull-up.
    FunctionUp(u32),
    /// Open-drain alternate function with pull-up.
    FunctionOpen(u32),
}

/// A pin, and so its output.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Pin(pub Port, pub u32);

impl Pin {
    fn registers(self) -> &'static gpioh::RegisterBlock {
        // The ports have the same registers; they differ in their reset values, for which the crate has three types.
        let port = match self.0 {
            Port::A => GPIOA::ptr().cast(),
            Port::B => GPIOB::ptr().cast(),
            Port::C => GPIOC::ptr(),
        };
        // Safety: registers live for ever, and every write below is of one pin or made before interrupts are on.
        unsafe { &*port }
    }

    /// Sets the pin up; to be called before interrupts are on, since neighbours share its registers.
    pub fn set_up(self, mode: Mode) {
        let (moder, function, open, pull) = match mode {
            Mode::Input => (0b00, 0, false, 0b00),
            Mode::InputUp => (0b00, 0, false, 0b01),
            Mode::Output => (0b01, 0, false, 0b00),
            Mode::OpenDrain => (0b01, 0, true, 0b00),
            Mode::Function(n) => (0b10, n, false, 0b00),
            Mode::FunctionUp(n) => (0b10, n, false, 0b01),
            Mode::FunctionOpen(n) => (0b10, n, true, 0b01),
        };
        let port = self.registers();
        let pin = self.1 & 15;
        self.write(open);
        let place = |bits: u32, width: u32, value: u32| {
            let at = (pin.wrapping_mul(width)) & 31;
            let mask = 1u32.wrapping_shl(width).wrapping_sub(1);
            bits & !mask.wrapping_shl(at) | value.wrapping_shl(at)
        };
        // Safety: each writes the bits of this pin only.
        unsafe {
            let open = u32::from(open);
            port.otyper()
                .modify(|r, w| w.bits(place(r.bits(), 1, open)));
            port.pupdr().modify(|r, w| w.bits(place(r.bits(), 2, pull)));
            if pin < 8 {
                port.afrl()
                    .modify(|r, w| w.bits(place(r.bits(), 4, function)));
            } else {
                port.afrh()
                    .modify(|r, w| w.bits(place(r.bits(), 4, function)));
            }
            port.moder()
                .modify(|r, w| w.bits(place(r.bits(), 2, moder)));
        }
    }

    /// The pin's bit in registers of one bit a pin.
    pub fn mask(self) -> u32 {
        1u32.wrapping_shl(self.1 & 15)
    }

    /// Writes an output; one atomic store.
    pub fn write(self, high: bool) {
        let bits = match high {
            true => self.mask(),
            false => self.mask() << 16,
        };
        // Safety: 1 bits act, 0 bits do nothing.
        self.registers().bsrr().write(|w| unsafe { w.bits(bits) });
    }

    /// Reads the pin's level.
    pub fn read(self) -> bool {
        self.registers().idr().read().bits() & self.mask() != 0
    }
}

impl ErrorType for Pin {
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

impl InputPin for Pin {
    fn is_high(&mut self) -> Result<bool, Infallible> {
        Ok(self.read())
    }

    fn is_low(&mut self) -> Result<bool, Infallible> {
        Ok(!self.read())
    }
}
