//! The board: what is wired where, the start, the interrupts, and what goes on between them.
//!
//! | priority | interrupt | does |
//! |---|---|---|
//! | 0 | USART2 | bytes to and from the wire |
//! | 0 | EXTI | dates the echo pins' edges |
//! | 0 | SysTick, 1 kHz | calls PendSV every 5 ms |
//! | 15 | PendSV | the machine: wheel loops, tick, link |
//! | – | `main` | range drivers, stack |
//!
//! Each value has one owner: no interrupt waits for a lock. The short ones do not interrupt each other: each is done
//! within a microsecond or two, a byte takes 22, and the stack has to hold one of them only (tests/firmware/stack.py adds it
//! up).

mod bus;
mod clock;
mod crash;
mod encoders;
mod gpio;
mod handover;
mod log;
mod motors;
mod ranges;
mod serial;

use bus::Bus;
use clock::Clocks;
use core::mem::MaybeUninit;
use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m::peripheral::scb::SystemHandler;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{NVIC, SCB};
use cortex_m_rt::{entry, exception};
use encoders::{Left, Right};
use fuzzypilot::firmware::{self, Board, BoardPilot, Event, Panel, STEP_US, kit, panel};
use fuzzypilot::link::message::Cause;
use fuzzypilot::params::Params;
use fuzzypilot::ports::bridge::{Bridge, PwmPinsMotor, WhilePwmLow};
use fuzzypilot::ports::quadrature::QuadratureEncoders;
use fuzzypilot::ports::ring::Sample;
use fuzzypilot::ports::wheel_loop::WheelLoop;
use gpio::{Mode, Pin, Port::A, Port::B, Port::C};
use handover::Handover;
use motors::Channel;
use ranges::Ranges;
use stm32f4::stm32f411::{IWDG, Interrupt, Peripherals, TIM1, TIM5, interrupt};

// The wiring, as in docs/wiring.md.
const PWM: [Pin; 2] = [Pin(A, 8), Pin(A, 9)];
const LEFT_IN: [Pin; 2] = [Pin(B, 13), Pin(B, 14)];
const RIGHT_IN: [Pin; 2] = [Pin(B, 15), Pin(A, 10)];
const STANDBY: Pin = Pin(B, 2);
const EMERGENCY: Pin = Pin(B, 12);
const ENCODERS: [(Pin, u32); 4] = [
    (Pin(A, 15), 1),
    (Pin(B, 3), 1),
    (Pin(B, 4), 2),
    (Pin(B, 5), 2),
];
const SERIAL: [Pin; 2] = [Pin(A, 2), Pin(A, 3)];
const BUS: [Pin; 2] = [Pin(B, 8), Pin(B, 9)];
const BUTTON: Pin = Pin(A, 0);
/// The Nucleo's green one.
const LAMP: Pin = Pin(A, 5);
/// The Black Pill's, lit by low; on the Nucleo the blue button, which open drain does not disturb.
const LAMP_LOW: Pin = Pin(C, 13);

/// The motors' direction and standby pins on port A and B.
const MOTOR_PINS_A: u32 = 1 << 10;
const MOTOR_PINS_B: u32 = 1 << 2 | 1 << 13 | 1 << 14 | 1 << 15;

/// SysTick's rate, Hz.
const TICKS: u32 = 1_000;

type Motor = PwmPinsMotor<Channel, Pin, Pin>;
type Machine = firmware::Machine<'static, Motor, Motor, Pin, QuadratureEncoders<Left, Right>>;

/// What PendSV owns.
type Pilotage = (Machine, Chip);

/// The board, as the machine sees it.
struct Chip {
    /// Steps done.
    steps: u32,
    tim1: TIM1,
    watchdog: IWDG,
}

static PILOTAGE: Handover<&'static mut Pilotage> = Handover::new();
/// The newest reading of each range sensor, until the next step takes it.
static SAMPLES: [Handover<Sample>; kit::SENSORS] = [const { Handover::new() }; kit::SENSORS];
static SERIAL_PORT: Handover<serial::Port> = Handover::new();

/// Steps due since the start.
static STEPS: AtomicU32 = AtomicU32::new(0);
/// Deepest stack so far, bytes.
static STACK: AtomicU32 = AtomicU32::new(0);

/// The time: microseconds, wrapping.
fn now_us() -> u32 {
    // Safety: a read without side effects.
    unsafe { (*TIM5::ptr()).cnt().read().bits() }
}

#[entry]
fn main() -> ! {
    static mut PILOT: BoardPilot = BoardPilot::new(kit::params(), kit::HOME);
    // No `Option`s: theirs would be initial values in flash.
    static mut OWN: MaybeUninit<Pilotage> = MaybeUninit::uninit();
    static mut RANGES: MaybeUninit<Ranges> = MaybeUninit::uninit();

    let ranges = start(PILOT, OWN, RANGES);
    go();
    loop {
        // After every interrupt, so every millisecond at least.
        ranges.poll();
        STACK.store(deepest_stack(), Ordering::Relaxed);
        cortex_m::asm::wfi();
    }
}

/// Starts everything. Not inlined: its stack is free again afterwards.
#[inline(never)]
fn start(
    pilot: &'static mut BoardPilot,
    own: &'static mut MaybeUninit<Pilotage>,
    ranges: &'static mut MaybeUninit<Ranges>,
) -> &'static mut Ranges {
    // Safety: taken once, here.
    let chip = unsafe { Peripherals::steal() };
    let mut core = unsafe { cortex_m::Peripherals::steal() };

    let clocks = clock::start(&chip.RCC, &chip.FLASH, &chip.TIM11);
    let still = clocks.source == clock::Source::Emulated;
    if still {
        log::emulated();
    }
    power_up(&chip);
    start_time(&chip.TIM5, &clocks);
    let (reset, place) = crash::last_reset(&chip.RCC);
    defmt::info!(
        "fuzzypilot {=str}, clock {}",
        env!("CARGO_PKG_VERSION"),
        clocks.source
    );
    defmt::info!("last reset: {} at {=u32:#x}", reset, place);

    set_up_pins();
    let top = motors::start(&chip.TIM1, clocks.timers);
    encoders::start(&chip.TIM2, &chip.TIM3);

    let [left_1, left_2] = LEFT_IN;
    let [right_1, right_2] = RIGHT_IN;
    let brakes = WhilePwmLow::Brakes;
    let bridge = Bridge::with_standby(
        PwmPinsMotor::new(Channel::new(false, top), left_1, left_2, brakes),
        PwmPinsMotor::new(Channel::new(true, top), right_1, right_2, brakes),
        STANDBY,
    );
    let [clock, data] = BUS;
    let bus = Bus::start(chip.I2C1, clock, data, clocks.slow);
    let drive = WheelLoop::new(bridge, kit::wheels());
    let sensors = Ranges::start(bus, &chip.SYSCFG, &chip.EXTI);
    let (Ok(drive), Ok(sensors)) = (drive, sensors) else {
        // The library's tests hold that the settings are sound.
        crash::end(Cause::Panic, 0)
    };
    let encoders = QuadratureEncoders::new(Left { still }, Right { still })
        .reverse(false, true)
        .at_most(kit::COUNTS_A_STEP);
    kit::lay_path(pilot);
    SERIAL_PORT.put(serial::Port::start(chip.USART2, clocks.slow));
    core.SYST.set_clock_source(SystClkSource::Core);
    core.SYST.set_reload((clocks.core / TICKS).wrapping_sub(1));
    core.SYST.clear_current();
    core.SYST.enable_counter();
    start_watchdog(&chip.IWDG);
    PILOTAGE.put(own.write((
        Machine::new(pilot, drive, encoders, reset),
        Chip {
            steps: 0,
            tim1: chip.TIM1,
            watchdog: chip.IWDG,
        },
    )));
    ranges.write(sensors)
}

/// Lets the interrupts come.
fn go() {
    // Safety: everything that they need is there.
    unsafe {
        let mut core = cortex_m::Peripherals::steal();
        // All others are at 0, the most urgent, from reset on.
        core.SCB.set_priority(SystemHandler::PendSV, 15 << 4);
        core.SYST.enable_interrupt();
        NVIC::unmask(Interrupt::USART2);
        NVIC::unmask(Interrupt::EXTI9_5);
        NVIC::unmask(Interrupt::EXTI15_10);
    }
}

/// Clocks to all that is used.
fn power_up(chip: &Peripherals) {
    chip.RCC.ahb1enr().modify(|_, w| {
        w.gpioaen().set_bit();
        w.gpioben().set_bit();
        w.gpiocen().set_bit()
    });
    chip.RCC.apb1enr().modify(|_, w| {
        w.tim2en().set_bit();
        w.tim3en().set_bit();
        w.tim5en().set_bit();
        w.usart2en().set_bit();
        w.i2c1en().set_bit()
    });
    chip.RCC.apb2enr().modify(|_, w| {
        w.tim1en().set_bit();
        w.syscfgen().set_bit()
    });
    // Peripherals wait for a moment after their clock is on.
    let _ = chip.RCC.apb2enr().read();
}

/// Starts the microsecond counter.
fn start_time(tim5: &TIM5, clocks: &Clocks) {
    let divisor = (clocks.timers / 1_000_000).wrapping_sub(1);
    // Safety: the division fits 16 bits.
    unsafe {
        tim5.psc().write(|w| w.bits(divisor));
        tim5.arr().write(|w| w.bits(u32::MAX));
    }
    // The division counts from an update on.
    tim5.egr().write(|w| w.ug().set_bit());
    tim5.cr1().write(|w| w.cen().set_bit());
}

fn set_up_pins() {
    for pin in [LEFT_IN, RIGHT_IN].as_flattened() {
        pin.set_up(Mode::Output);
    }
    STANDBY.set_up(Mode::Output);
    EMERGENCY.set_up(Mode::FunctionUp(1));
    for pin in PWM {
        pin.set_up(Mode::Function(1));
    }
    for (pin, function) in ENCODERS {
        pin.set_up(Mode::FunctionUp(function));
    }
    for pin in SERIAL {
        pin.set_up(Mode::FunctionUp(7));
    }
    BUTTON.set_up(Mode::InputUp);
    LAMP.set_up(Mode::Output);
    LAMP_LOW.set_up(Mode::OpenDrain);
}

/// The independent watchdog, on an oscillator of its own: 200 ms (140 to 380, as that oscillator goes). It cannot be
/// switched off again.
fn start_watchdog(watchdog: &IWDG) {
    // Safety: the register's keys and values. 32 kHz / 32 is 1 kHz.
    unsafe {
        watchdog.kr().write(|w| w.bits(0xCCCC));
        watchdog.kr().write(|w| w.bits(0x5555));
        watchdog.pr().write(|w| w.bits(3));
        watchdog.rlr().write(|w| w.bits(200));
    }
    feed(watchdog);
}

fn feed(watchdog: &IWDG) {
    // Safety: the key.
    watchdog.kr().write(|w| unsafe { w.bits(0xAAAA) });
}

/// The deepest that the stack has been, in bytes: what of the paint is gone.
fn deepest_stack() -> u32 {
    unsafe extern "C" {
        static _stack_end: u32;
        static _stack_start: u32;
    }
    let (end, start) = (&raw const _stack_end, &raw const _stack_start);
    let mut at = end;
    // Safety: reads between the two symbols, which lie in RAM.
    while at < start && unsafe { at.read_volatile() } == cortex_m_rt::STACK_PAINT_VALUE {
        at = at.wrapping_add(1);
    }
    (start as u32).wrapping_sub(at as u32)
}

#[exception]
fn SysTick() {
    static mut MILLIS: u32 = 0;
    *MILLIS = MILLIS.wrapping_add(1);
    if *MILLIS >= STEP_US / 1_000 {
        *MILLIS = 0;
        let steps = STEPS.load(Ordering::Relaxed);
        STEPS.store(steps.wrapping_add(1), Ordering::Relaxed);
        SCB::set_pendsv();
    }
}

#[exception]
fn PendSV() {
    static mut OWN: Option<&'static mut Pilotage> = None;
    if OWN.is_none() {
        *OWN = PILOTAGE.take();
    }
    if let Some((machine, chip)) = OWN {
        machine.run(chip);
    }
}

#[interrupt]
fn USART2() {
    static mut OWN: Option<serial::Port> = None;
    if OWN.is_none() {
        *OWN = SERIAL_PORT.take();
    }
    if let Some(own) = OWN {
        own.serve();
    }
}

impl Board for Chip {
    fn now_us(&mut self) -> u32 {
        now_us()
    }

    fn due(&mut self) -> bool {
        let steps = STEPS.load(Ordering::Relaxed);
        core::mem::replace(&mut self.steps, steps) != steps
    }

    fn panel(&mut self) -> Panel {
        Panel {
            button: !BUTTON.read(),
            emergency: panel::emergency(&mut motors::Break(&self.tim1, EMERGENCY)),
        }
    }

    fn sample(&mut self) -> Option<Sample> {
        SAMPLES.iter().find_map(Handover::take)
    }

    fn received(&mut self) -> Option<u8> {
        serial::RECEIVED.pop()
    }

    fn send(&mut self, frame: &[u8]) {
        serial::send(frame);
    }

    fn stack(&mut self) -> u32 {
        STACK.load(Ordering::Relaxed)
    }

    fn lamp(&mut self, on: bool) {
        LAMP.write(on);
        LAMP_LOW.write(!on);
    }

    fn feed(&mut self) {
        feed(&self.watchdog);
    }

    /// From where the start copied them, together with all other statics' initial values: room for them once more there
    /// is not.
    fn own(&mut self, params: &mut Params<{ firmware::RANGES }>) {
        unsafe extern "C" {
            static __sdata: u8;
            static __sidata: u8;
        }
        let own = core::ptr::from_mut(params);
        let offset = (own as usize).wrapping_sub(&raw const __sdata as usize);
        let initial = (&raw const __sidata).wrapping_add(offset).cast();
        // Safety: the pilot is a static with initial values: they lie in flash as it does in RAM. Settings are plain data.
        unsafe { core::ptr::copy_nonoverlapping(initial, own, 1) };
    }

    fn log(&mut self, event: Event) {
        defmt::info!("{}", event);
    }
}
