//! The Raspberry Pi Pico's board file: wiring, start, interrupts. What the robot does is the library's. Pins and faults:
//! `docs/wiring-pico.md`.
//!
//! Five HC-SR04 take the places of the reference robot's five sensors; its laser sensors are not wired.
//!
//! | priority | interrupt | does |
//! |---|---|---|
//! | 0 | UART0, IO_BANK0 | bytes to and from the wire; encoder steps, echo edges |
//! | 2 | SysTick, 1 kHz | calls PendSV every 5 ms |
//! | 3 | PendSV | the machine: wheel loops, tick, link |
//! | – | `main` | range driver |
#![no_std]
#![no_main]

mod chip;
mod crash;
#[path = "../../../src/main/handover.rs"]
mod handover;

use chip::{Channel, Pin};
use core::cell::RefCell;
use core::sync::atomic::{AtomicU32, Ordering};
use cortex_m::peripheral::scb::SystemHandler;
use cortex_m::peripheral::syst::SystClkSource;
use cortex_m::peripheral::{NVIC, SCB};
use cortex_m_rt::{entry, exception};
use critical_section::Mutex;
use fuzzypilot::firmware::pipe::Pipe;
use fuzzypilot::firmware::{self, Board, BoardPilot, Event, Panel, RANGES, STEP_US, kit};
use fuzzypilot::link::message::Cause;
use fuzzypilot::params::Params;
use fuzzypilot::ports::Fault;
use fuzzypilot::ports::bridge::{Bridge, PwmPinsMotor, WhilePwmLow};
use fuzzypilot::ports::echo::{EchoRing, HC_SR04};
use fuzzypilot::ports::quadrature::{QuadratureCounter, QuadratureDecoder, QuadratureEncoders};
use fuzzypilot::ports::ring::Sample;
use fuzzypilot::ports::wheel_loop::WheelLoop;
use fuzzypilot::units::Seconds;
use handover::Handover;
use rp2040_pac::{Interrupt, Peripherals, UART0, WATCHDOG, interrupt};

#[unsafe(link_section = ".boot2")]
#[used]
static BOOT2: [u8; 256] = rp2040_boot2::BOOT_LOADER_GENERIC_03H;

// The wiring, as in docs/wiring-pico.md. UART0 is GP0 and GP1.
const ENCODERS: [[Pin; 2]; 2] = [[Pin(2), Pin(3)], [Pin(4), Pin(5)]];
const TRIGGERS: [Pin; 5] = [Pin(6), Pin(7), Pin(10), Pin(11), Pin(12)];
const ECHO: [Pin; 5] = [Pin(8), Pin(9), Pin(13), Pin(14), Pin(15)];
/// Places in the ring, in the order of firing: neighbours far apart.
const PLACES: [usize; 5] = [0, 2, 4, 1, 3];
const LEFT_IN: [Pin; 2] = [Pin(18), Pin(19)];
const RIGHT_IN: [Pin; 2] = [Pin(20), Pin(21)];
const STANDBY: Pin = Pin(22);
const LAMP: Pin = Pin(25);
/// Opens when pressed; so does a broken wire.
const EMERGENCY: Pin = Pin(26);
const BUTTON: Pin = Pin(27);

/// PWM on GP16 and GP17, direction pins, standby.
const MOTOR_PINS: u32 = 0b111_1111 << 16;

type Motor = PwmPinsMotor<Channel, Pin, Pin>;
type Machine = firmware::Machine<'static, Motor, Motor, Pin, QuadratureEncoders<Wheel, Wheel>>;

/// What PendSV owns.
type Pilotage = (Machine, Chip);

/// What the machine sees of the board.
struct Chip {
    /// Steps done.
    steps: u32,
    watchdog: WATCHDOG,
}

static PILOTAGE: Handover<&'static mut Pilotage> = Handover::new();
/// The newest reading of each range sensor, until the next step takes it.
static SAMPLES: [Handover<Sample>; kit::SENSORS] = [const { Handover::new() }; kit::SENSORS];
/// Steps due since the start.
static STEPS: AtomicU32 = AtomicU32::new(0);
/// Echo edges on their way to `main`: sensor, level, time.
static EDGES: Pipe<64> = Pipe::new();
const EDGE: usize = 6;
static RECEIVED: Pipe<256> = Pipe::new();
static TO_SEND: Pipe<256> = Pipe::new();

/// Decodes a wheel's encoder.
type Decoder = Mutex<RefCell<QuadratureDecoder>>;
static WHEELS: [Decoder; 2] =
    [const { Mutex::new(RefCell::new(QuadratureDecoder::new().tolerate(2))) }; 2];

/// A wheel's count.
struct Wheel(&'static Decoder);

impl QuadratureCounter for Wheel {
    type Raw = u32;

    fn raw(&mut self) -> Result<u32, Fault> {
        critical_section::with(|cs| match self.0.borrow(cs).try_borrow_mut() {
            Ok(mut decoder) => decoder.raw(),
            // Never: the critical section is the only way in.
            Err(_) => Err(Fault::Bus),
        })
    }
}

/// The reference robot; five pings of 60 ms go by until a sensor's turn comes again.
const fn params() -> Params<RANGES> {
    let mut params = kit::params();
    params.ring.max_age = const { Seconds::lit("0.4") };
    params
}

#[entry]
fn main() -> ! {
    static mut PILOT: BoardPilot = BoardPilot::new(params(), kit::HOME);
    static mut OWN: Option<Pilotage> = None;

    start(PILOT, OWN);
    let Ok(mut sonar) = EchoRing::new(TRIGGERS, HC_SR04) else {
        // The library's tests hold that the settings are sound.
        crash::end(Cause::Panic)
    };
    go();
    loop {
        while let Some([sensor, level, t0, t1, t2, t3]) = EDGES.pop_all::<EDGE>() {
            let at_us = u32::from_le_bytes([t0, t1, t2, t3]);
            sonar.edge(sensor.into(), level != 0, at_us);
        }
        if let Some(sample) = sonar.poll(chip::now_us())
            && let Some(&index) = PLACES.get(sample.index)
            && let Some(pin) = ECHO.get(sample.index)
            && let Some(place) = SAMPLES.get(index)
        {
            // A pin that is stuck has no edges: it is told each time.
            sonar.edge(sample.index, pin.read(), chip::now_us());
            place.put(Sample { index, ..sample });
        }
        // Every interrupt, so every millisecond at least.
        cortex_m::asm::wfi();
    }
}

/// Starts everything. Not inlined: its stack is free again afterwards.
#[inline(never)]
fn start(pilot: &'static mut BoardPilot, own: &'static mut Option<Pilotage>) {
    // Safety: taken once, here.
    let chip = unsafe { Peripherals::steal() };
    let mut core = unsafe { cortex_m::Peripherals::steal() };

    if !chip::start(&chip) {
        // Without its crystal the chip has no time: it does not drive.
        crash::end(Cause::HardFault)
    }
    let reset = crash::last_reset(&chip.WATCHDOG);
    crash::reset_all(&chip.PSM);

    for pin in [LEFT_IN, RIGHT_IN].as_flattened() {
        pin.output();
    }
    for pin in TRIGGERS.iter().chain(&[STANDBY, LAMP]) {
        pin.output();
    }
    for pin in ENCODERS.as_flattened().iter().chain(&[EMERGENCY, BUTTON]) {
        pin.input_up();
    }
    for pin in &ECHO {
        pin.input();
    }
    for pin in ENCODERS.as_flattened().iter().chain(&ECHO) {
        pin.watch();
    }
    let top = chip::start_pwm(&chip);
    chip::start_uart(&chip);

    let [left_1, left_2] = LEFT_IN;
    let [right_1, right_2] = RIGHT_IN;
    let brakes = WhilePwmLow::Brakes;
    let bridge = Bridge::with_standby(
        PwmPinsMotor::new(Channel::new(false, top), left_1, left_2, brakes),
        PwmPinsMotor::new(Channel::new(true, top), right_1, right_2, brakes),
        STANDBY,
    );
    let Ok(drive) = WheelLoop::new(bridge, kit::wheels()) else {
        crash::end(Cause::Panic)
    };
    let [left, right] = &WHEELS;
    let encoders = QuadratureEncoders::new(Wheel(left), Wheel(right))
        .reverse(false, true)
        .at_most(kit::COUNTS_A_STEP);
    kit::lay_path(pilot);
    core.SYST.set_clock_source(SystClkSource::Core);
    core.SYST.set_reload(chip::CORE / 1_000 - 1);
    core.SYST.clear_current();
    core.SYST.enable_counter();
    chip::start_watchdog(&chip.WATCHDOG);
    let board = Chip {
        steps: 0,
        watchdog: chip.WATCHDOG,
    };
    PILOTAGE.put(own.insert((Machine::new(pilot, drive, encoders, reset), board)));
}

/// Lets the interrupts come.
fn go() {
    // Safety: everything that they need is there.
    unsafe {
        let mut core = cortex_m::Peripherals::steal();
        core.SCB.set_priority(SystemHandler::SysTick, 2 << 6);
        core.SCB.set_priority(SystemHandler::PendSV, 3 << 6);
        core.SYST.enable_interrupt();
        NVIC::unmask(Interrupt::UART0_IRQ);
        NVIC::unmask(Interrupt::IO_IRQ_BANK0);
    }
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
    if let Some((machine, board)) = OWN {
        machine.run(board);
    }
}

/// An edge of an encoder or an echo.
#[interrupt]
fn IO_IRQ_BANK0() {
    let [t0, t1, t2, t3] = chip::now_us().to_le_bytes();
    let changed = chip::edges();
    for (decoder, [a, b]) in WHEELS.iter().zip(&ENCODERS) {
        if changed & (a.mask() | b.mask()) != 0 {
            critical_section::with(|cs| {
                if let Ok(mut decoder) = decoder.borrow(cs).try_borrow_mut() {
                    decoder.on_edge(a.read(), b.read());
                }
            });
        }
    }
    for (sensor, pin) in (0..).zip(&ECHO) {
        if changed & pin.mask() != 0 {
            // Without room the edge is lost, and the sensor's turn with it.
            EDGES.push(&[sensor, u8::from(pin.read()), t0, t1, t2, t3]);
        }
    }
}

/// Moves bytes between the wire and the queues. One that finds no room is lost, and its frame with it: the CRC tells.
#[interrupt]
fn UART0_IRQ() {
    // Safety: only this interrupt uses the port once it runs.
    let uart = unsafe { &*UART0::ptr() };
    while uart.uartfr().read().rxfe().bit_is_clear() {
        RECEIVED.push(&[uart.uartdr().read().bits() as u8]);
        SCB::set_pendsv();
    }
    while uart.uartfr().read().txff().bit_is_clear() {
        let Some(byte) = TO_SEND.pop() else {
            break;
        };
        // Safety: a byte.
        uart.uartdr().write(|w| unsafe { w.bits(byte.into()) });
    }
    let more = !TO_SEND.is_empty();
    uart.uartimsc().modify(|_, w| w.txim().bit(more));
}

impl Board for Chip {
    fn now_us(&mut self) -> u32 {
        chip::now_us()
    }

    fn due(&mut self) -> bool {
        let steps = STEPS.load(Ordering::Relaxed);
        core::mem::replace(&mut self.steps, steps) != steps
    }

    fn panel(&mut self) -> Panel {
        Panel {
            button: !BUTTON.read(),
            emergency: EMERGENCY.read(),
        }
    }

    fn sample(&mut self) -> Option<Sample> {
        SAMPLES.iter().find_map(Handover::take)
    }

    fn received(&mut self) -> Option<u8> {
        RECEIVED.pop()
    }

    /// Where there is no room for the frame it is dropped, and the desktop asks again.
    fn send(&mut self, frame: &[u8]) {
        if TO_SEND.push(frame) {
            NVIC::pend(Interrupt::UART0_IRQ);
        }
    }

    /// Not measured here.
    fn stack(&mut self) -> u32 {
        0
    }

    fn lamp(&mut self, on: bool) {
        LAMP.write(on);
    }

    fn feed(&mut self) {
        chip::feed(&self.watchdog);
    }

    fn own(&mut self, params: &mut Params<RANGES>) {
        *params = self::params();
    }

    /// The link tells.
    fn log(&mut self, _: Event) {}
}
