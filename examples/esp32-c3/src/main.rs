//! The ESP32-C3's start of a board file: shows that the library compiles for it unchanged.
//!
//! Wired: the machine at its fixed rate, lamp (GPIO 10), button (GPIO 9), emergency stop (GPIO 3, opens). Not wired: motors,
//! encoders, range sensors, link, watchdog; it cannot drive. Take the drivers' side from `examples/pico`.
#![no_std]
#![no_main]

use core::convert::Infallible;
use esp32c3::{GPIO, SYSTIMER};
use fuzzypilot::firmware::{Board, BoardPilot, Event, Machine, Panel, RANGES, STEP_US, kit};
use fuzzypilot::link::message::Cause;
use fuzzypilot::params::Params;
use fuzzypilot::ports::bridge::{Bridge, Effort, Motor};
use fuzzypilot::ports::ring::Sample;
use fuzzypilot::ports::wheel_loop::WheelLoop;
use fuzzypilot::ports::{Fault, WheelCounts, WheelEncoders};

const LAMP: u32 = 1 << 10;
const BUTTON: u32 = 1 << 9;
const EMERGENCY: u32 = 1 << 3;

/// A motor that is not connected.
struct NoMotor;

impl Motor for NoMotor {
    type Error = Infallible;

    fn drive(&mut self, _: Effort) -> Result<(), Infallible> {
        Ok(())
    }

    fn brake(&mut self) -> Result<(), Infallible> {
        Ok(())
    }

    fn coast(&mut self) -> Result<(), Infallible> {
        Ok(())
    }
}

/// Encoders that are not connected.
struct NoEncoders;

impl WheelEncoders for NoEncoders {
    fn counts(&mut self) -> Result<WheelCounts, Fault> {
        Err(Fault::NeverSeen)
    }
}

/// What the machine sees of the board.
struct Chip {
    gpio: GPIO,
    timer: SYSTIMER,
    /// When the last step was due.
    due: u32,
}

impl Board for Chip {
    /// The system timer counts sixteenths.
    fn now_us(&mut self) -> u32 {
        self.timer.unit0_op().write(|w| w.update().set_bit());
        let low = self.timer.unit_value(0).lo().read().bits();
        let high = self.timer.unit_value(0).hi().read().bits();
        (high << 28) | (low >> 4)
    }

    fn due(&mut self) -> bool {
        let now_us = self.now_us();
        let late = now_us.wrapping_sub(self.due);
        let due = late >= STEP_US;
        if due {
            // Missed steps are not made up for.
            self.due = now_us.wrapping_sub(late % STEP_US);
        }
        due
    }

    fn panel(&mut self) -> Panel {
        let pins = self.gpio.in_().read().bits();
        Panel {
            button: pins & BUTTON == 0,
            emergency: pins & EMERGENCY != 0,
        }
    }

    fn sample(&mut self) -> Option<Sample> {
        None
    }

    fn received(&mut self) -> Option<u8> {
        None
    }

    fn send(&mut self, _: &[u8]) {}

    fn stack(&mut self) -> u32 {
        0
    }

    fn lamp(&mut self, on: bool) {
        // Safety: a bit that sets or clears a pin.
        unsafe {
            if on {
                self.gpio.out_w1ts().write(|w| w.bits(LAMP));
            } else {
                self.gpio.out_w1tc().write(|w| w.bits(LAMP));
            }
        }
    }

    fn feed(&mut self) {}

    fn own(&mut self, params: &mut Params<RANGES>) {
        *params = kit::params();
    }

    fn log(&mut self, _: Event) {}
}

#[riscv_rt::entry]
fn main() -> ! {
    static mut PILOT: BoardPilot = BoardPilot::new(kit::params(), kit::HOME);

    // Safety: each taken once, here; the bit of a pin.
    let (pilot, gpio, timer) =
        unsafe { (&mut *(&raw mut PILOT), GPIO::steal(), SYSTIMER::steal()) };
    unsafe { gpio.enable_w1ts().write(|w| w.bits(LAMP)) };
    let mut board = Chip {
        gpio,
        timer,
        due: 0,
    };
    board.due = board.now_us();
    if let Ok(drive) = WheelLoop::new(Bridge::new(NoMotor, NoMotor), kit::wheels()) {
        kit::lay_path(pilot);
        let mut machine = Machine::new(pilot, drive, NoEncoders, Cause::Boot);
        loop {
            machine.run(&mut board);
        }
    }
    loop {}
}

/// No motor is wired that would have to be switched off first.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    loop {}
}
