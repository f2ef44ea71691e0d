//! The range sensors: three HC-SR04 whose echo edges are dated by interrupts, two VL53L0X on the bus.

use super::bus::Bus;
use super::gpio::{Mode, Pin, Port::A, Port::B};
use super::{SAMPLES, now_us};
use fuzzypilot::firmware::kit::{ECHOES, LASERS};
use fuzzypilot::firmware::pipe::Pipe;
use fuzzypilot::params::ParamError;
use fuzzypilot::ports::echo::{EchoRing, HC_SR04};
use fuzzypilot::ports::ring::Sample;
use fuzzypilot::ports::time_of_flight::{TimingBudget, TofArray};
use stm32f4::stm32f411::{EXTI, SYSCFG, interrupt};

const TRIGGERS: [Pin; 3] = [Pin(A, 6), Pin(A, 7), Pin(B, 0)];
/// All on port B, in the order of the triggers.
const ECHO: [Pin; 3] = [Pin(B, 6), Pin(B, 7), Pin(B, 10)];
const SHUTDOWN: [Pin; 2] = [Pin(A, 4), Pin(B, 1)];

/// First of the laser sensors' addresses.
const ADDRESS: u8 = 0x30;
/// Bus transactions at a time: 1 ms or so.
const TRANSACTIONS: u8 = 4;
/// From one look at the laser sensors to the next, in microseconds.
const LASER_US: u32 = 2_000;

/// Edges on their way from the interrupts: sensor, level, time.
static EDGES: Pipe<64> = Pipe::new();
const EDGE: usize = 6;

/// What `main` looks after between the interrupts.
pub struct Ranges {
    sonar: EchoRing<Pin, 3>,
    lasers: TofArray<Bus, Pin, 2>,
    lasers_us: u32,
}

impl Ranges {
    /// Sets the pins up and chooses the echo interrupts.
    pub fn start(bus: Bus, syscfg: &SYSCFG, exti: &EXTI) -> Result<Self, ParamError> {
        for pin in TRIGGERS {
            pin.set_up(Mode::Output);
        }
        for pin in ECHO {
            pin.set_up(Mode::Input);
        }
        for pin in SHUTDOWN {
            pin.set_up(Mode::OpenDrain);
        }
        let lines = ECHO.iter().fold(0, |lines, pin| lines | pin.mask());
        // Safety: 1 selects port B for a line; the masks are of lines that exist.
        unsafe {
            syscfg
                .exticr2()
                .modify(|_, w| w.exti6().bits(1).exti7().bits(1));
            syscfg.exticr3().modify(|_, w| w.exti10().bits(1));
            exti.rtsr().modify(|r, w| w.bits(r.bits() | lines));
            exti.ftsr().modify(|r, w| w.bits(r.bits() | lines));
            exti.imr().modify(|r, w| w.bits(r.bits() | lines));
        }
        Ok(Self {
            sonar: EchoRing::new(TRIGGERS, HC_SR04)?,
            lasers: TofArray::new(bus, SHUTDOWN, ADDRESS, TimingBudget::NORMAL)?,
            lasers_us: 0,
        })
    }

    /// Moves on whatever is due; to be called every millisecond at least.
    pub fn poll(&mut self) {
        self.listen();
        if now_us().wrapping_sub(self.lasers_us) >= LASER_US {
            self.lasers_us = now_us();
            self.look();
        }
    }

    // Neither is inlined: their stacks do not add up then.

    #[inline(never)]
    fn listen(&mut self) {
        while let Some([sensor, level, t0, t1, t2, t3]) = EDGES.pop_all::<EDGE>() {
            let at_us = u32::from_le_bytes([t0, t1, t2, t3]);
            self.sonar.edge(sensor.into(), level != 0, at_us);
        }
        if let Some(sample) = self.sonar.poll(now_us()) {
            // A pin that is stuck has no edges: it is told each time.
            if let Some(pin) = ECHO.get(sample.index) {
                self.sonar.edge(sample.index, pin.read(), now_us());
            }
            post(sample, &ECHOES);
        }
    }

    #[inline(never)]
    fn look(&mut self) {
        if let Some(sample) = self.lasers.poll(now_us(), TRANSACTIONS) {
            post(sample, &LASERS);
        }
    }
}

/// Leaves a reading for the next step, at its sensor's place in the ring.
fn post(sample: Sample, places: &[usize]) {
    if let Some(&index) = places.get(sample.index)
        && let Some(place) = SAMPLES.get(index)
    {
        place.put(Sample { index, ..sample });
    }
}

/// An edge on one of the echo lines.
fn edge() {
    let [t0, t1, t2, t3] = now_us().to_le_bytes();
    // Safety: a read, and a write that clears the flags that it names.
    let exti = unsafe { &*EXTI::ptr() };
    let pending = exti.pr().read().bits();
    exti.pr().write(|w| unsafe { w.bits(pending) });
    for (sensor, pin) in (0..).zip(&ECHO) {
        if pending & pin.mask() != 0 {
            // Without room the edge is lost, and the sensor's turn with it.
            EDGES.push(&[sensor, u8::from(pin.read()), t0, t1, t2, t3]);
        }
    }
}

#[interrupt]
fn EXTI9_5() {
    edge();
}

#[interrupt]
fn EXTI15_10() {
    edge();
}
