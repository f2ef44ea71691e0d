//! VL53L0X: the start-up on the wire, several modelled parts on one bus, every way they can fail, and the budget of
//! transactions kept in every call.

use super::{config, metres};
use embedded_hal::digital::OutputPin;
use embedded_hal::i2c::{ErrorKind, I2c, NoAcknowledgeSource, Operation};
use embedded_hal_mock::eh1::i2c::{Mock, Transaction};
use fuzzypilot::ports::ring::Sample;
use fuzzypilot::ports::time_of_flight::{
    LEAST_TRANSACTIONS, RESET_ADDRESS, TimingBudget, TofArray,
};
use fuzzypilot::ports::{Fault, Range};
use proptest::prelude::*;
use std::cell::RefCell;
use std::collections::HashMap;
use std::convert::Infallible;
use std::rc::Rc;

/// How a modelled part misbehaves.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum Trouble {
    #[default]
    None,
    /// Not on the bus.
    Absent,
    /// Never says that a result is ready.
    Silent,
    /// Never ends its own start-up measurements.
    Stuck,
    /// Not a VL53L0X.
    Foreign,
}

/// A VL53L0X as far as a driver sees it.
#[derive(Clone, Debug, Default)]
struct Part {
    trouble: Trouble,
    powered: bool,
    powered_us: u32,
    address: u8,
    page: u8,
    registers: HashMap<(u8, u8), u8>,
    /// Reads until the reference SPADs are there.
    spad_reads: u8,
    ranging: bool,
    ready: bool,
    ready_us: u32,
    /// What it will report: range status code, millimetres.
    result: (u8, u16),
    spads: u8,
    good: [u8; 6],
    powers: u32,
}

#[derive(Debug, Default)]
struct World {
    now: u32,
    parts: Vec<Part>,
    /// Transactions since the test last looked.
    transactions: u32,
    /// The next so many transactions to this part fail.
    failing: Option<(usize, u32)>,
}

impl Part {
    fn write(&mut self, now: u32, register: u8, value: u8) {
        match (self.page, register, value) {
            (_, 0xFF, page) => self.page = page,
            (_, 0x8A, address) => self.address = address,
            (7, 0x83, 0x00) => self.spad_reads = 3,
            (0, 0x00, 0x41 | 0x01) if !self.ranging => self.ready = self.trouble != Trouble::Stuck,
            (0, 0x00, 0x02) => {
                assert_eq!(
                    self.registers.get(&(1, 0x91)),
                    Some(&0x3C),
                    "started without its stop variable"
                );
                self.ranging = true;
                self.ready = false;
                self.ready_us = now.wrapping_add(33_000);
            }
            (0, 0x0B, 0x01) => self.ready = false,
            _ => {}
        }
        self.registers.insert((self.page, register), value);
    }

    fn read(&mut self, now: u32, register: u8) -> u8 {
        let result = self.result;
        if self.ranging && !self.ready && now.wrapping_sub(self.ready_us) < u32::MAX / 2 {
            self.ready = self.trouble != Trouble::Silent;
            self.ready_us = now.wrapping_add(33_000);
        }
        match (self.page, register) {
            (0, 0xC0) if self.trouble == Trouble::Foreign => 0xEA,
            (0, 0xC0) => 0xEE,
            (1, 0x91) => 0x3C,
            (7, 0x83) if self.spad_reads > 0 => {
                self.spad_reads -= 1;
                u8::from(self.spad_reads == 0)
            }
            (7, 0x92) => self.spads,
            (0, 0xB0..=0xB5) => self.good[usize::from(register - 0xB0)],
            (0, 0x13) => {
                if self.ready {
                    0x44
                } else {
                    0x40
                }
            }
            (0, 0x14) => 0x80 | (result.0 << 3),
            (0, 0x1E) => result.1.to_be_bytes()[0],
            (0, 0x1F) => result.1.to_be_bytes()[1],
            (page, register) => self.registers.get(&(page, register)).copied().unwrap_or(0),
        }
    }
}

#[derive(Clone)]
struct Bus(Rc<RefCell<World>>);

impl embedded_hal::i2c::ErrorType for Bus {
    type Error = ErrorKind;
}

impl I2c for Bus {
    fn transaction(&mut self, address: u8, ops: &mut [Operation<'_>]) -> Result<(), ErrorKind> {
        let world = &mut *self.0.borrow_mut();
        world.transactions += 1;
        let now = world.now;
        let answering: Vec<_> = (0..world.parts.len())
            .filter(|&i| {
                let part = &world.parts[i];
                part.powered && part.trouble != Trouble::Absent && part.address == address
            })
            .collect();
        assert!(answering.len() <= 1, "{answering:?} answer at {address:#x}");
        let nobody = ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address);
        let &index = answering.first().ok_or(nobody)?;
        if let Some((failing, left)) = &mut world.failing
            && *failing == index
            && *left > 0
        {
            *left -= 1;
            return Err(ErrorKind::ArbitrationLoss);
        }
        let part = &mut world.parts[index];
        let booted = now.wrapping_sub(part.powered_us) >= 1_200;
        assert!(booted, "spoken to before it has booted");
        let mut register = 0;
        for op in ops {
            match op {
                Operation::Write(bytes) => {
                    register = bytes[0];
                    for &value in &bytes[1..] {
                        part.write(now, register, value);
                        register = register.wrapping_add(1);
                    }
                }
                Operation::Read(bytes) => {
                    for byte in bytes.iter_mut() {
                        *byte = part.read(now, register);
                        register = register.wrapping_add(1);
                    }
                }
            }
        }
        Ok(())
    }
}

struct Shutdown(Rc<RefCell<World>>, usize);

impl embedded_hal::digital::ErrorType for Shutdown {
    type Error = Infallible;
}

impl OutputPin for Shutdown {
    fn set_low(&mut self) -> Result<(), Infallible> {
        let world = &mut *self.0.borrow_mut();
        let part = &mut world.parts[self.1];
        *part = Part {
            trouble: part.trouble,
            result: part.result,
            spads: part.spads,
            good: part.good,
            powers: part.powers,
            ..Part::default()
        };
        Ok(())
    }

    fn set_high(&mut self) -> Result<(), Infallible> {
        let world = &mut *self.0.borrow_mut();
        let part = &mut world.parts[self.1];
        if part.powered {
            return Ok(());
        }
        part.powered = true;
        part.powers += 1;
        part.address = RESET_ADDRESS;
        part.powered_us = world.now;
        Ok(())
    }
}

struct Rig<const N: usize> {
    world: Rc<RefCell<World>>,
    array: TofArray<Bus, Shutdown, N>,
    now: u32,
    /// Most transactions seen in one call.
    most: u32,
}

impl<const N: usize> Rig<N> {
    fn new(budget: TimingBudget) -> Self {
        let part = Part {
            result: (11, 500),
            spads: 0x80 | 5,
            good: [0xFF; 6],
            // As after a reset of the controller alone: on, at some address.
            powered: true,
            address: 0x31,
            ..Part::default()
        };
        let mut parts = vec![part; N];
        for (i, part) in parts.iter_mut().enumerate() {
            part.address += i as u8;
        }
        let world = Rc::new(RefCell::new(World {
            parts,
            ..World::default()
        }));
        let pins = core::array::from_fn(|i| Shutdown(world.clone(), i));
        Self {
            array: TofArray::new(Bus(world.clone()), pins, 0x30, budget).unwrap(),
            world,
            // Soon to wrap.
            now: u32::MAX - 200_000,
            most: 0,
        }
    }

    fn part(&self, index: usize, change: impl FnOnce(&mut Part)) {
        change(&mut self.world.borrow_mut().parts[index]);
    }

    /// Polls every ms; the readings, and their times since `self.now` was this.
    fn run(&mut self, time_ms: u32, transactions: u8) -> Vec<Sample> {
        let mut samples = Vec::new();
        for _ in 0..time_ms {
            self.now = self.now.wrapping_add(1_000);
            {
                let world = &mut *self.world.borrow_mut();
                world.now = self.now;
                world.transactions = 0;
            }
            samples.extend(self.array.poll(self.now, transactions));
            let used = self.world.borrow().transactions;
            assert!(used <= u32::from(transactions), "{used} of {transactions}");
            self.most = self.most.max(used);
        }
        samples
    }
}

fn of(samples: &[Sample], index: usize) -> Vec<Range> {
    let mine = samples.iter().filter(|s| s.index == index);
    mine.map(|s| s.range).collect()
}

const HALF: Range = Range::Echo(metres_half());

const fn metres_half() -> fuzzypilot::units::Metres {
    fuzzypilot::units::Metres::lit("0.5")
}

/// The wire of the first calls, byte by byte.
#[test]
fn the_start_up_begins_as_st_has_it() {
    let write = |register, value| Transaction::write(0x29, vec![register, value]);
    let read = |register, value| Transaction::write_read(0x29, vec![register], vec![value]);
    let expected = [
        read(0xC0, 0xEE),
        // Its address stays: it is alone.
        read(0x89, 0x00),
        write(0x89, 0x01),
        write(0x88, 0x00),
        write(0x80, 0x01),
        write(0xFF, 0x01),
        write(0x00, 0x00),
        read(0x91, 0x3C),
        write(0x00, 0x01),
        write(0xFF, 0x00),
        write(0x80, 0x00),
        read(0x60, 0x00),
        write(0x60, 0x12),
        write(0x44, 0x00),
        write(0x45, 0x20),
        write(0x01, 0xFF),
    ];
    let mut bus = Mock::new(&expected);
    let mut array = TofArray::single(bus.clone(), TimingBudget::NORMAL);
    assert_eq!(array.poll(0, 8), None, "reset");
    assert_eq!(array.poll(100, 8), None, "out of reset");
    assert_eq!(array.poll(1_000, 8), None, "boots");
    assert_eq!(array.poll(2_100, 8), None, "booted");
    // Setting an address that it has costs no transaction, but is counted as one.
    assert_eq!(array.poll(3_000, 8), None);
    assert_eq!(array.poll(4_000, 9), None);
    bus.done();
}

#[test]
fn several_sensors_get_addresses_and_measure() {
    let mut rig = Rig::<4>::new(TimingBudget::NORMAL);
    let started = rig.run(400, 4);
    for index in 0..4 {
        assert!(of(&started, index).contains(&HALF), "sensor {index}");
        let address = rig.world.borrow().parts[index].address;
        assert_eq!(address, 0x30 + index as u8);
    }
    rig.part(2, |part| part.result.1 = 1_234);
    rig.run(50, 4);
    let samples = rig.run(1_000, 4);
    for index in 0..4 {
        let ranges = of(&samples, index);
        assert!(
            (25..=31).contains(&ranges.len()),
            "{index}: {}",
            ranges.len()
        );
        let expected = if index == 2 {
            Range::Echo(metres(1.234))
        } else {
            HALF
        };
        assert!(ranges.iter().all(|range| *range == expected), "{ranges:?}");
    }
    let last = samples.last().unwrap();
    // Dated from the begin of the measurement.
    assert!(rig.now.wrapping_sub(last.at_us) >= 33_000);
}

#[test]
fn the_start_up_takes_as_many_transactions_as_documented() {
    let mut rig = Rig::<1>::new(TimingBudget::NORMAL);
    let mut all = 0;
    for _ in 0..200 {
        assert_eq!(rig.run(1, 4), []);
        all += rig.world.borrow().transactions;
        if rig.world.borrow().parts[0].ranging {
            break;
        }
    }
    // One more for each further time that it looks whether a measurement has ended.
    assert_eq!(all, 151 + 2, "two looks came too early");
}

#[test]
fn one_absent_sensor_does_not_stop_the_others() {
    let mut rig = Rig::<3>::new(TimingBudget::NORMAL);
    rig.part(1, |part| part.trouble = Trouble::Absent);
    let samples = rig.run(1_500, 4);
    let absent = of(&samples, 1);
    assert!(absent.len() >= 3, "{absent:?}");
    assert!(absent.iter().all(|r| *r == Range::Invalid(Fault::Bus)));
    for index in [0, 2] {
        assert!(of(&samples, index).len() > 30);
    }
    let powers = rig.world.borrow().parts[1].powers;
    assert!(
        (5..=8).contains(&powers),
        "a rest of 0.2 s between: {powers}"
    );
    // Plugged in.
    rig.part(1, |part| part.trouble = Trouble::None);
    assert!(of(&rig.run(1_000, 4), 1).contains(&HALF));
}

#[test]
fn a_dying_sensor_is_reset_and_comes_back() {
    let mut rig = Rig::<2>::new(TimingBudget::NORMAL);
    rig.run(500, 4);
    rig.part(1, |part| part.trouble = Trouble::Absent);
    let samples = rig.run(100, 4);
    let dead = of(&samples, 1);
    assert!(dead.len() >= 3, "{dead:?}");
    let bus = Range::Invalid(Fault::Bus);
    assert!(dead.iter().rev().take(3).all(|range| *range == bus));
    assert!(!rig.world.borrow().parts[1].powered, "held in reset");
    rig.part(1, |part| part.trouble = Trouble::None);
    let samples = rig.run(1_000, 4);
    assert!(of(&samples, 1).contains(&HALF));
    assert!(!of(&samples, 0).contains(&bus), "the other never noticed");
}

#[test]
fn a_single_bus_error_costs_one_reading_and_no_reset() {
    let mut rig = Rig::<1>::new(TimingBudget::NORMAL);
    rig.run(500, 4);
    let powers = rig.world.borrow().parts[0].powers;
    rig.world.borrow_mut().failing = Some((0, 2));
    let ranges = of(&rig.run(500, 4), 0);
    let errors = ranges.iter().filter(|r| **r != HALF).count();
    assert_eq!(errors, 2);
    assert!(ranges.len() > 10);
    assert_eq!(rig.world.borrow().parts[0].powers, powers);
}

#[test]
fn silent_stuck_and_foreign_sensors_are_told_and_retried() {
    for (trouble, fault) in [
        (Trouble::Silent, Fault::Timeout),
        (Trouble::Stuck, Fault::Timeout),
        (Trouble::Foreign, Fault::Bus),
    ] {
        let mut rig = Rig::<1>::new(TimingBudget::NORMAL);
        rig.part(0, |part| part.trouble = trouble);
        let ranges = of(&rig.run(2_000, 4), 0);
        assert!(ranges.len() >= 2, "{trouble:?}: {ranges:?}");
        for range in ranges {
            assert_eq!(range, Range::Invalid(fault), "{trouble:?}");
        }
        assert!(rig.world.borrow().parts[0].powers >= 3, "{trouble:?}");
        rig.part(0, |part| part.trouble = Trouble::None);
        assert!(of(&rig.run(1_000, 4), 0).contains(&HALF), "{trouble:?}");
    }
}

#[test]
fn waiting_is_bounded_to_the_millisecond() {
    // A start-up measurement that never ends: 100 ms.
    let mut rig = Rig::<1>::new(TimingBudget::NORMAL);
    rig.part(0, |part| part.trouble = Trouble::Stuck);
    let asked = |rig: &Rig<1>| rig.world.borrow().parts[0].registers.get(&(0, 0x00)) == Some(&0x41);
    let mut time = 0;
    while !asked(&rig) && time < 200 {
        assert_eq!(rig.run(1, 3), []);
        time += 1;
    }
    // The first look was in the same call.
    assert_eq!(rig.run(100, 3), []);
    assert_eq!(rig.run(1, 3).len(), 1);
    // A measurement that never ends: twice the budget and 100 ms.
    let mut rig = Rig::<1>::new(TimingBudget::NORMAL);
    rig.part(0, |part| part.trouble = Trouble::Silent);
    while !rig.world.borrow().parts[0].ranging && time < 1_000 {
        rig.run(1, 4);
        time += 1;
    }
    assert_eq!(rig.run(166, 4), []);
    assert_eq!(rig.run(1, 4).len(), 1);
}

#[test]
fn a_sensor_is_not_asked_before_its_result_can_be_there() {
    let mut rig = Rig::<1>::new(TimingBudget::NORMAL);
    rig.run(500, 4);
    let mut time = 0;
    while rig.run(1, 4).is_empty() && time < 100 {
        time += 1;
    }
    for ms in 1..=33 {
        rig.run(1, 4);
        let asked = rig.world.borrow().transactions > 0;
        assert_eq!(asked, ms >= 29, "after {ms} ms");
    }
}

#[test]
fn registers_keep_the_bits_that_are_not_the_drivers() {
    let mut rig = Rig::<1>::new(TimingBudget::NORMAL);
    let mut time = 0;
    while !rig.world.borrow().parts[0].powered || time < 3 {
        rig.run(1, 0);
        time += 1;
    }
    rig.part(0, |part| {
        part.registers.insert((0, 0x84), 0xFF);
        part.registers.insert((0, 0x89), 0xF1);
    });
    rig.run(200, 6);
    let registers = &rig.world.borrow().parts[0].registers;
    assert_eq!(registers[&(0, 0x84)], 0xEF);
    assert_eq!(registers[&(0, 0x89)], 0xF1);
}

#[test]
fn every_range_status_has_its_reading() {
    let mut rig = Rig::<1>::new(TimingBudget::NORMAL);
    rig.run(500, 4);
    for status in 0..16 {
        for mm in [0, 500, 8_189, 8_190, 8_191] {
            rig.part(0, |part| part.result = (status, mm));
            rig.run(70, 4);
            let range = of(&rig.run(70, 4), 0)[0];
            let expected = match (status, mm) {
                (4 | 6 | 9 | 11, 8_190..) => Range::Clear,
                (11, mm) => Range::Echo(metres(f64::from(mm) / 1000.0)),
                (1..=3, _) => Range::Invalid(Fault::Bus),
                _ => Range::Invalid(Fault::OutOfRange),
            };
            let same = match (range, expected) {
                (Range::Echo(a), Range::Echo(b)) => (a.bits() - b.bits()).abs() <= 1,
                (a, b) => a == b,
            };
            assert!(same, "status {status}, {mm} mm: {range:?}");
        }
    }
}

#[test]
fn addresses_are_checked() {
    fn with<const N: usize>(first: u8) -> Result<(), &'static str> {
        let world = Rc::new(RefCell::new(World::default()));
        let pins = core::array::from_fn::<_, N, _>(|i| Shutdown(world.clone(), i));
        TofArray::new(Bus(world.clone()), pins, first, TimingBudget::FAST)
            .map(|_| ())
            .map_err(|e| e.field)
    }
    let refused = Err("tof.first_address");
    assert_eq!(with::<8>(0x30), Ok(()));
    assert_eq!(with::<1>(RESET_ADDRESS), refused);
    assert_eq!(with::<4>(0x25), Ok(()));
    assert_eq!(with::<5>(0x25), refused);
    assert_eq!(with::<1>(0x07), refused);
    assert_eq!(with::<2>(0x77), refused);
    assert_eq!(with::<1>(0x77), Ok(()));
    assert_eq!(with::<0>(0x30), refused);
    assert_eq!(with::<250>(0x30), refused);
}

/// The final range's timeout register, decoded: how long the whole measurement takes by ST's sums, in µs.
fn budget_on_the_wire(budget: TimingBudget) -> f64 {
    let mut rig = Rig::<1>::new(budget);
    rig.run(200, 6);
    let registers = &rig.world.borrow().parts[0].registers;
    let (high, low) = (registers[&(0, 0x71)], registers[&(0, 0x72)]);
    let periods = f64::from(low) * 2_f64.powi(high.into()) + 1.0;
    let period = |clocks: f64| 2304.0 * clocks * 1.655e-3;
    let pre = 151.0 * period(14.0);
    let msrc = 38.0 * period(14.0);
    let last = (periods - 151.0) * period(10.0);
    1910.0 + 960.0 + 2.0 * (msrc + 690.0) + (pre + 660.0) + (last + 550.0)
}

#[test]
fn the_timing_budget_reaches_the_part() {
    for micros in [20_000, 25_000, 33_000, 66_000, 100_000, 200_000] {
        let on_the_wire = budget_on_the_wire(TimingBudget::new(micros));
        let error = on_the_wire / f64::from(micros) - 1.0;
        assert!(error.abs() < 0.01, "{micros}: {on_the_wire}");
    }
    assert_eq!(TimingBudget::new(0), TimingBudget::FAST);
    assert_eq!(TimingBudget::new(u32::MAX).micros(), 200_000);
    assert_eq!(TimingBudget::NORMAL.micros(), 33_000);
}

proptest! {
    #![proptest_config(config(48))]

    /// Enabled reference SPADs: good ones only, the first ones, as many as asked for if there are, with aperture from 12 on.
    #[test]
    fn reference_spads_are_the_first_good_ones(info in any::<u8>(), good in any::<[u8; 6]>()) {
        let mut rig = Rig::<1>::new(TimingBudget::NORMAL);
        rig.part(0, |part| (part.spads, part.good) = (info, good));
        rig.run(200, 6);
        let registers = &rig.world.borrow().parts[0].registers;
        let enabled = |i: usize| registers[&(0, 0xB0 + i as u8 / 8)] >> (i % 8) & 1 == 1;
        let first = if info & 0x80 != 0 { 12 } else { 0 };
        let usable: Vec<_> = (first..48).filter(|i| good[i / 8] >> (i % 8) & 1 == 1).collect();
        let wanted = usize::from(info & 0x7F).min(usable.len());
        for i in 0..48 {
            prop_assert_eq!(enabled(i), usable[..wanted].contains(&i), "SPAD {}", i);
        }
    }

    /// Random bus errors and parts that come and go: every call keeps its transactions (asserted in `run`), never two parts
    /// answer at one address (asserted on the bus), and when all is well again, all measure.
    #[test]
    fn any_trouble_is_survived(
        events in prop::collection::vec((0_usize..3, 0_u8..5, 0_u32..6, 1_u32..300), 1..12),
        transactions in LEAST_TRANSACTIONS..12,
    ) {
        let mut rig = Rig::<3>::new(TimingBudget::FAST);
        for (index, trouble, failing, time) in events {
            let trouble = match trouble {
                1 => Trouble::Absent,
                2 => Trouble::Silent,
                3 => Trouble::Stuck,
                4 => Trouble::Foreign,
                _ => Trouble::None,
            };
            rig.part(index, |part| part.trouble = trouble);
            rig.world.borrow_mut().failing = Some((index, failing));
            rig.run(time, transactions);
        }
        for index in 0..3 {
            rig.part(index, |part| part.trouble = Trouble::None);
        }
        rig.world.borrow_mut().failing = None;
        rig.run(2_500, transactions);
        let samples = rig.run(300, transactions);
        for index in 0..3 {
            prop_assert!(of(&samples, index).contains(&HALF), "sensor {}", index);
        }
    }
}

#[test]
fn too_few_transactions_do_nothing() {
    let mut rig = Rig::<1>::new(TimingBudget::NORMAL);
    assert_eq!(rig.run(100, 0), []);
    assert_eq!(rig.most, 0);
    assert!(!rig.run(600, LEAST_TRANSACTIONS).is_empty());
    assert_eq!(rig.most, u32::from(LEAST_TRANSACTIONS));
}
