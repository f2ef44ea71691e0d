//! The Raspberry Pi Pico 2's start of a board file: shows that the library runs on it unchanged.
//!
//! Wired: the machine at its fixed rate, lamp (GP25), button (GP27), emergency stop (GP26, opens), watchdog fed by
//! complete control periods only. Not wired: motors, encoders, range sensors, link; it cannot drive. Take these from
//! `examples/pico`.
#![no_std]
#![no_main]

use core::convert::Infallible;
use embedded_hal::digital::{InputPin, OutputPin};
use fuzzypilot::firmware::{Board, BoardPilot, Event, Machine, Panel, RANGES, STEP_US, kit};
use fuzzypilot::link::message::Cause;
use fuzzypilot::params::Params;
use fuzzypilot::ports::bridge::{Bridge, Effort, Motor};
use fuzzypilot::ports::ring::Sample;
use fuzzypilot::ports::wheel_loop::WheelLoop;
use fuzzypilot::ports::{Fault, WheelCounts, WheelEncoders};
use rp235x_hal as hal;

#[unsafe(link_section = ".start_block")]
#[used]
static IMAGE: hal::block::ImageDef = hal::block::ImageDef::secure_exe();

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

#[hal::entry]
fn main() -> ! {
    static mut PILOT: BoardPilot = BoardPilot::new(kit::params(), kit::HOME);

    // Safety: taken once, here.
    let mut chip = unsafe { hal::pac::Peripherals::steal() };
    let mut watchdog = hal::Watchdog::new(chip.WATCHDOG);
    let Ok(clocks) = hal::clocks::init_clocks_and_plls(
        12_000_000,
        chip.XOSC,
        chip.CLOCKS,
        chip.PLL_SYS,
        chip.PLL_USB,
        &mut chip.RESETS,
        &mut watchdog,
    ) else {
        hal::reset()
    };
    let timer = hal::Timer::new_timer0(chip.TIMER0, &mut chip.RESETS, &clocks);
    let sio = hal::Sio::new(chip.SIO);
    let bank = chip.IO_BANK0;
    let pins = hal::gpio::Pins::new(bank, chip.PADS_BANK0, sio.gpio_bank0, &mut chip.RESETS);
    let mut lamp = pins.gpio25.into_push_pull_output();
    let mut emergency = pins.gpio26.into_pull_up_input();
    let mut button = pins.gpio27.into_pull_up_input();

    let Ok(drive) = WheelLoop::new(Bridge::new(NoMotor, NoMotor), kit::wheels()) else {
        hal::reset()
    };
    kit::lay_path(PILOT);
    let mut machine = Machine::new(PILOT, drive, NoEncoders, Cause::Boot);
    watchdog.start(fugit::ExtU32::millis(200));
    let mut board = Chip {
        now_us: || timer.get_counter_low(),
        due: timer.get_counter_low(),
        button: || button.is_low().unwrap_or(false),
        emergency: || emergency.is_high().unwrap_or(true),
        lamp: |on: bool| {
            let _ = lamp.set_state(on.into());
        },
        feed: || watchdog.feed(),
    };
    loop {
        machine.run(&mut board);
    }
}

/// What the machine sees of the board.
struct Chip<N, B, E, L, F> {
    now_us: N,
    /// When the last step was due.
    due: u32,
    button: B,
    emergency: E,
    lamp: L,
    feed: F,
}

impl<N, B, E, L, F> Board for Chip<N, B, E, L, F>
where
    N: FnMut() -> u32,
    B: FnMut() -> bool,
    E: FnMut() -> bool,
    L: FnMut(bool),
    F: FnMut(),
{
    fn now_us(&mut self) -> u32 {
        (self.now_us)()
    }

    fn due(&mut self) -> bool {
        let now_us = (self.now_us)();
        let late = now_us.wrapping_sub(self.due);
        let due = late >= STEP_US;
        if due {
            // Missed steps are not made up for.
            self.due = now_us.wrapping_sub(late % STEP_US);
        }
        due
    }

    fn panel(&mut self) -> Panel {
        Panel {
            button: (self.button)(),
            emergency: (self.emergency)(),
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
        (self.lamp)(on);
    }

    fn feed(&mut self) {
        (self.feed)();
    }

    fn own(&mut self, params: &mut Params<RANGES>) {
        *params = kit::params();
    }

    fn log(&mut self, _: Event) {}
}

/// No motor is wired that would have to be switched off first.
#[panic_handler]
fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
    hal::reset()
}
