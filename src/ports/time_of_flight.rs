//! VL53L0X laser range sensors over I²C, one or several on one bus.
//!
//! Written from public facts: register names and the start-up sequence of ST's driver (STSW-IMG005, BSD-3-Clause, and its
//! user manual UM2039), the datasheet (DocID029104). ST documents most of the start-up values nowhere else; they are data
//! of the part.
//!
//! The crate `vl53l0x` 1.0 (MIT, embedded-hal 1.0) was looked at and not taken: its start-up and single shots wait in
//! loops of up to 65 535 bus reads (several seconds), its timing arithmetic can divide by zero, shift out or underflow
//! on what a disturbed bus returns (an image with it does not link without a panic), and it does not tell the range
//! status, without which a weak echo cannot be told from a good one.
//!
//! Here nothing waits: [`TofArray::poll`] makes at most as many bus transactions as it is allowed, and continues at the
//! next call. A sensor that does not answer is reset by its XSHUT pin and started again; the others go on measuring.
//! How long one transaction may take is up to your HAL: choose one with a timeout, or a stuck bus holds it for ever.
//!
//! # Readings
//!
//! | range status (`RESULT_RANGE_STATUS`, bits 3 to 6) | distance | reading |
//! |---|---|---|
//! | 11 range complete | below 8190 mm | [`Range::Echo`] |
//! | 4 no target, 6 and 9 phase, 11 | 8190 or 8191 mm | [`Range::Clear`] |
//! | 4, 6, 9 | below 8190 mm | [`Fault::OutOfRange`]: too weak or too far to believe |
//! | 1, 2, 3 laser or voltage check failed | any | [`Fault::Bus`] |
//! | others (too near, no result, overflow) | any | [`Fault::OutOfRange`] |
//!
//! A bus error is [`Fault::Bus`], no answer in time [`Fault::Timeout`]. Clear means "nothing that reflects enough": dark
//! grey is lost beyond some 0.7 m, so set the ring's `max_range` accordingly.

use super::micros::since;
use super::ring::Sample;
use super::{Fault, NoPin, Range};
use crate::params::ParamError;
use crate::units::Metres;
use embedded_hal::digital::OutputPin;
use embedded_hal::i2c::I2c;

/// Address (7 bits) of every VL53L0X after reset.
pub const RESET_ADDRESS: u8 = 0x29;

/// Least number of transactions that [`TofArray::poll`] can use.
pub const LEAST_TRANSACTIONS: u8 = 3;

/// Distances from here on mean that nothing was seen.
const NOTHING_MM: u16 = 8190;
/// Boot time after XSHUT rises: 1.2 ms (datasheet, tBOOT), with a margin.
const BOOT_US: u32 = 2_000;
/// How long a silent sensor is held in reset before it is tried again.
const REST_US: u32 = 200_000;
/// Longest wait for one of the start-up's own measurements; they take some ms.
const WAIT_US: u32 = 100_000;
/// Bus errors in a row after which a sensor is reset.
const ERRORS: u8 = 3;

/// Time for one measurement: longer is less noise. Continuous: the next begins when one is read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "defmt", derive(defmt::Format))]
pub struct TimingBudget {
    micros: u32,
    /// `FINAL_RANGE_CONFIG_TIMEOUT_MACROP`: (low byte · 2^high byte) + 1 macro periods.
    timeout: u16,
}

impl TimingBudget {
    /// 20 ms: the shortest, ± 5 % of distance.
    pub const FAST: Self = Self::new(20_000);
    /// 33 ms: the part's default, ± 3 %.
    pub const NORMAL: Self = Self::new(33_000);

    /// In microseconds, limited to 20 000 … 200 000.
    pub const fn new(micros: u32) -> Self {
        let micros = match micros {
            0..=20_000 => 20_000,
            20_001..=199_999 => micros,
            _ => 200_000,
        };
        // ST's sums for the steps that stay on (DSS, pre-range, final range) with the tuned registers below: pre-range
        // 151 periods of 14 clocks, MSRC 38; a clock is 1.655 ns, a period 2304 of them times the pulse period.
        const PRE_PERIODS: u32 = 151;
        const MSRC_US: u32 = (38 * period_ns(14) + period_ns(14) / 2) / 1000;
        const PRE_US: u32 = (PRE_PERIODS * period_ns(14) + period_ns(14) / 2) / 1000;
        const OTHERS_US: u32 = 1910 + 960 + 2 * (MSRC_US + 690) + (PRE_US + 660) + 550;
        const FINAL_NS: u32 = period_ns(10);
        let left = micros.saturating_sub(OTHERS_US);
        let periods = left.wrapping_mul(1000).wrapping_add(FINAL_NS / 2) / FINAL_NS;
        let mut low = periods.wrapping_add(PRE_PERIODS - 1);
        let mut high: u16 = 0;
        while low > 0xFF {
            low >>= 1;
            high = high.wrapping_add(1);
        }
        Self {
            micros,
            timeout: (high << 8) | low as u16,
        }
    }

    /// In microseconds.
    pub const fn micros(self) -> u32 {
        self.micros
    }
}

/// A macro period for a pulse period of so many clocks.
const fn period_ns(clocks: u32) -> u32 {
    (2304 * clocks * 1655 + 500) / 1000
}

/// `N` sensors on one bus. With more than one, each has its XSHUT pin on an output of yours.
///
/// ```
/// # use fuzzypilot::ports::NoPin;
/// # use embedded_hal::i2c::{ErrorKind, ErrorType, I2c, NoAcknowledgeSource, Operation};
/// # struct Bus;
/// # impl ErrorType for Bus { type Error = ErrorKind; }
/// # impl I2c for Bus {
/// #     fn transaction(&mut self, _: u8, _: &mut [Operation<'_>]) -> Result<(), ErrorKind> {
/// #         Err(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Address))
/// #     }
/// # }
/// # let (bus, shutdown) = (Bus, [NoPin, NoPin]);
/// use fuzzypilot::ports::{ring::Latest, time_of_flight::{TimingBudget, TofArray}};
///
/// let mut tof = TofArray::new(bus, shutdown, 0x30, TimingBudget::NORMAL)?; // 0x30, 0x31, …
/// let mut ranges = Latest::<2>::new();
/// for now_us in (0..50_000).step_by(1_000) {                               // your timer
///     if let Some(sample) = tof.poll(now_us, 4) {                          // ≤ 4 transactions
///         ranges.post(sample.index, sample.range, sample.at_us);
///     }
/// }
/// # Ok::<(), fuzzypilot::params::ParamError>(())
/// ```
///
/// XSHUT is not 5 V tolerant on a bare sensor; breakout boards shift its level.
#[derive(Debug)]
pub struct TofArray<B, X, const N: usize> {
    bus: B,
    shutdown: [X; N],
    sensors: [Sensor; N],
    first_address: u8,
    budget: TimingBudget,
    /// Whether all sensors were put in reset.
    reset: bool,
    /// The sensor that is being started: the only one that may answer at [`RESET_ADDRESS`].
    starting: Option<usize>,
    turn: usize,
}

/// ```text
/// Down ──REST──▶ Queued ──XSHUT up──▶ Booting ──BOOT──▶ Setup ──script──▶ Ranging ⟲
///   ▲                                    │                │                  │
///   └───────────────── no answer, XSHUT low ◀─────────────┴──────────────────┘
/// ```
#[derive(Clone, Copy, Debug)]
enum Phase {
    /// In reset since then.
    Down(u32),
    /// To be started when no other is.
    Queued,
    /// Out of reset since then.
    Booting(u32),
    /// At this step of [`SETUP`], this write of it, waiting since then.
    Setup {
        step: usize,
        write: usize,
        waiting: Option<u32>,
    },
    /// Measuring since then; bus errors in a row.
    Ranging { since_us: u32, errors: u8 },
}

#[derive(Clone, Copy, Debug)]
struct Sensor {
    phase: Phase,
    address: u8,
    /// `stop_variable` of ST's driver: read once, written before each start.
    stop: u8,
    /// Reference SPADs: how many (bits 0 to 6), whether with aperture (bit 7).
    spads: u8,
    /// Which reference SPADs are good.
    map: [u8; 6],
}

impl<B: I2c> TofArray<B, NoPin, 1> {
    /// One sensor that has the bus to itself, without XSHUT, at [`RESET_ADDRESS`].
    pub fn single(bus: B, budget: TimingBudget) -> Self {
        Self::build(bus, [NoPin], RESET_ADDRESS, budget)
    }
}

impl<B: I2c, X: OutputPin, const N: usize> TofArray<B, X, N> {
    /// Takes bus and pins over; writes nothing yet. The sensors get the addresses `first_address`, `first_address + 1`, …:
    /// all within 0x08 to 0x77, without [`RESET_ADDRESS`], and of nothing else on the bus.
    pub fn new(
        bus: B,
        shutdown: [X; N],
        first_address: u8,
        budget: TimingBudget,
    ) -> Result<Self, ParamError> {
        let last = usize::from(first_address)
            .saturating_add(N)
            .saturating_sub(1);
        let free = last < usize::from(RESET_ADDRESS) || first_address > RESET_ADDRESS;
        if N == 0 || first_address < 0x08 || last > 0x77 || !free {
            return Err(ParamError {
                field: "tof.first_address",
                allowed: "N addresses within 0x08 to 0x77, without 0x29",
            });
        }
        Ok(Self::build(bus, shutdown, first_address, budget))
    }

    fn build(bus: B, shutdown: [X; N], first_address: u8, budget: TimingBudget) -> Self {
        Self {
            bus,
            shutdown,
            sensors: [Sensor::NEW; N],
            first_address,
            budget,
            reset: false,
            starting: None,
            turn: 0,
        }
    }

    /// Gives bus and pins back as they are.
    pub fn release(self) -> (B, [X; N]) {
        (self.bus, self.shutdown)
    }

    /// Continues with what is due, in at most `transactions` bus transactions ([`LEAST_TRANSACTIONS`] or more; fewer do
    /// nothing but pins). Returns a reading when there is one. The longest transaction is 14 bytes and the address twice,
    /// 0.4 ms at 400 kHz; most are 3 bytes.
    ///
    /// Starting a sensor takes 151 transactions and some ms of waiting; they are started one after another.
    pub fn poll(&mut self, now_us: u32, transactions: u8) -> Option<Sample> {
        if !self.reset {
            return self.reset_all(now_us);
        }
        let mut left = transactions;
        for _ in 0..N {
            let index = self.turn;
            self.turn = match index.saturating_add(1) {
                next if next < N => next,
                _ => 0,
            };
            let served = self.serve(index, now_us, &mut left);
            if let Some((range, at_us)) = served {
                return Some(Sample {
                    index,
                    range,
                    at_us,
                });
            }
        }
        None
    }

    /// All sensors off, so that each can be given its address alone. Tried again at the next poll if a pin fails.
    fn reset_all(&mut self, now_us: u32) -> Option<Sample> {
        let mut failed = None;
        let parts = self.shutdown.iter_mut().zip(&mut self.sensors);
        for (index, (pin, sensor)) in (0..N).zip(parts) {
            sensor.phase = Phase::Queued;
            if pin.set_low().is_err() {
                failed = Some(index);
            }
        }
        self.reset = failed.is_none();
        failed.map(|index| Sample {
            index,
            range: Range::Invalid(Fault::Bus),
            at_us: now_us,
        })
    }

    fn serve(&mut self, index: usize, now_us: u32, left: &mut u8) -> Option<(Range, u32)> {
        let pin = self.shutdown.get_mut(index)?;
        let sensor = self.sensors.get_mut(index)?;
        let served = match sensor.phase {
            Phase::Down(from) => {
                if since(now_us, from) >= REST_US {
                    sensor.phase = Phase::Queued;
                }
                return None;
            }
            Phase::Queued if self.starting.is_none() => match pin.set_high() {
                Ok(()) => {
                    self.starting = Some(index);
                    sensor.phase = Phase::Booting(now_us);
                    return None;
                }
                Err(_) => Err(Fault::Bus),
            },
            Phase::Queued => return None,
            Phase::Booting(from) => {
                if since(now_us, from) >= BOOT_US {
                    sensor.address = RESET_ADDRESS;
                    sensor.phase = Phase::Setup {
                        step: 0,
                        write: 0,
                        waiting: None,
                    };
                }
                return None;
            }
            Phase::Setup { .. } => {
                let offset = u8::try_from(index).unwrap_or(u8::MAX);
                let own = self.first_address.saturating_add(offset);
                sensor.set_up(&mut self.bus, own, self.budget, now_us, left)
            }
            Phase::Ranging { .. } => sensor.measure(&mut self.bus, self.budget, now_us, left),
        };
        let started = !matches!(sensor.phase, Phase::Setup { .. });
        if self.starting == Some(index) && (started || served.is_err()) {
            self.starting = None;
        }
        match served {
            Ok(Progress::Nothing) => None,
            Ok(Progress::Reading(range)) => {
                // The light was gathered over the whole budget: dated from its begin, the age is never too low.
                Some((range, now_us.wrapping_sub(self.budget.micros)))
            }
            Err(fault) => {
                // If the pin fails, too, the sensor stays as it is and is tried all the same.
                let _ = pin.set_low();
                sensor.phase = Phase::Down(now_us);
                Some((Range::Invalid(fault), now_us))
            }
        }
    }
}

/// What serving a sensor came to.
enum Progress {
    Nothing,
    Reading(Range),
}

impl Sensor {
    const NEW: Self = Self {
        phase: Phase::Queued,
        address: RESET_ADDRESS,
        stop: 0,
        spads: 0,
        map: [0; 6],
    };

    /// Runs the start-up script until the transactions are used up, or a wait begins.
    fn set_up(
        &mut self,
        bus: &mut impl I2c,
        own: u8,
        budget: TimingBudget,
        now_us: u32,
        left: &mut u8,
    ) -> Result<Progress, Fault> {
        // Every round costs at least one transaction.
        while let Phase::Setup {
            step: at,
            write,
            waiting,
        } = self.phase
        {
            let Some(step) = SETUP.get(at) else {
                self.phase = Phase::Ranging {
                    since_us: now_us,
                    errors: 0,
                };
                break;
            };
            let Some(rest) = left.checked_sub(step.cost()) else {
                break;
            };
            *left = rest;
            let mut next = Phase::Setup {
                step: at.saturating_add(1),
                write: 0,
                waiting: None,
            };
            match step {
                Step::Write(pairs) => {
                    if let Some(&(register, value)) = pairs.get(write) {
                        write_register(bus, self.address, register, value)?;
                    }
                    let write = write.saturating_add(1);
                    if write < pairs.len() {
                        next = Phase::Setup {
                            step: at,
                            write,
                            waiting: None,
                        };
                    }
                }
                Step::Wait(register, mask) => {
                    let [value] = read(bus, self.address, *register)?;
                    if value & mask == 0 {
                        let from = waiting.unwrap_or(now_us);
                        self.phase = Phase::Setup {
                            step: at,
                            write,
                            waiting: Some(from),
                        };
                        let late = since(now_us, from) > WAIT_US;
                        return match late {
                            true => Err(Fault::Timeout),
                            false => Ok(Progress::Nothing),
                        };
                    }
                }
                other => self.once(bus, other, own, budget)?,
            }
            self.phase = next;
        }
        Ok(Progress::Nothing)
    }

    /// A step that is done in one go.
    fn once(
        &mut self,
        bus: &mut impl I2c,
        step: &Step,
        own: u8,
        budget: TimingBudget,
    ) -> Result<(), Fault> {
        let at = self.address;
        match step {
            Step::Identify => {
                let [model] = read(bus, at, MODEL_ID)?;
                // Something else answers there.
                if model == MODEL {
                    Ok(())
                } else {
                    Err(Fault::Bus)
                }
            }
            Step::Address => {
                if own != at {
                    write_register(bus, at, I2C_ADDRESS, own)?;
                    self.address = own;
                }
                Ok(())
            }
            Step::Change(register, clear, set) => {
                let [value] = read(bus, at, *register)?;
                write_register(bus, at, *register, value & !clear | set)
            }
            Step::KeepStop => {
                [self.stop] = read(bus, at, STOP)?;
                Ok(())
            }
            Step::WriteStop => write_register(bus, at, STOP, self.stop),
            Step::KeepSpads => {
                [self.spads] = read(bus, at, SPAD_INFO)?;
                Ok(())
            }
            Step::KeepMap => {
                self.map = read(bus, at, SPAD_MAP)?;
                Ok(())
            }
            Step::WriteMap => {
                let [a, b, c, d, e, f] = chosen_spads(self.spads, self.map);
                write(bus, at, &[SPAD_MAP, a, b, c, d, e, f])
            }
            Step::Budget => {
                let [high, low] = budget.timeout.to_be_bytes();
                write(bus, at, &[FINAL_TIMEOUT, high, low])
            }
            // Both are run by `set_up`.
            Step::Write(_) | Step::Wait(..) => Ok(()),
        }
    }

    /// Asks for a result once it can be there, and reads it.
    fn measure(
        &mut self,
        bus: &mut impl I2c,
        budget: TimingBudget,
        now_us: u32,
        left: &mut u8,
    ) -> Result<Progress, Fault> {
        let Phase::Ranging { since_us, errors } = self.phase else {
            return Ok(Progress::Nothing);
        };
        let waited = since(now_us, since_us);
        // The part keeps its time within some percent.
        let early = budget.micros.wrapping_sub(budget.micros >> 3);
        if waited < early || *left < LEAST_TRANSACTIONS {
            return Ok(Progress::Nothing);
        }
        *left = left.saturating_sub(LEAST_TRANSACTIONS);
        match self.result(bus) {
            Ok(Some(range)) => {
                self.phase = Phase::Ranging {
                    since_us: now_us,
                    errors: 0,
                };
                Ok(Progress::Reading(range))
            }
            Ok(None) if waited > budget.micros.saturating_mul(2).saturating_add(WAIT_US) => {
                Err(Fault::Timeout)
            }
            Ok(None) => Ok(Progress::Nothing),
            Err(fault) => {
                let errors = errors.saturating_add(1);
                if errors >= ERRORS {
                    return Err(fault);
                }
                self.phase = Phase::Ranging { since_us, errors };
                Ok(Progress::Reading(Range::Invalid(fault)))
            }
        }
    }

    /// A result if there is one: two or three transactions.
    fn result(&self, bus: &mut impl I2c) -> Result<Option<Range>, Fault> {
        let [interrupt] = read(bus, self.address, INTERRUPT_STATUS)?;
        if interrupt & 0x07 == 0 {
            return Ok(None);
        }
        let [status, .., high, low] = read::<12>(bus, self.address, RESULT)?;
        write_register(bus, self.address, INTERRUPT_CLEAR, 0x01)?;
        Ok(Some(range_of(status, u16::from_be_bytes([high, low]))))
    }
}

/// The table of [the module's page](self).
fn range_of(status: u8, millimetres: u16) -> Range {
    let far = millimetres >= NOTHING_MM;
    match (status & 0x78) >> 3 {
        4 | 6 | 9 | 11 if far => Range::Clear,
        // Steps of 2^-16 m, rounded; at most 8.2 m.
        11 => Range::Echo(Metres::from_bits(
            i32::from(millimetres).wrapping_mul(8192).wrapping_add(62) / 125,
        )),
        1..=3 => Range::Invalid(Fault::Bus),
        _ => Range::Invalid(Fault::OutOfRange),
    }
}

/// The first good reference SPADs, as many as the part asks for; those with aperture begin at 12.
fn chosen_spads(info: u8, good: [u8; 6]) -> [u8; 6] {
    let first = if info & 0x80 != 0 { 12 } else { 0 };
    let mut wanted = info & 0x7F;
    let mut chosen = [0; 6];
    let mut place = 0_u8;
    for (good, chosen) in good.into_iter().zip(&mut chosen) {
        for bit in [1_u8, 2, 4, 8, 16, 32, 64, 128] {
            if place >= first && wanted > 0 && good & bit != 0 {
                *chosen |= bit;
                wanted = wanted.saturating_sub(1);
            }
            place = place.saturating_add(1);
        }
    }
    chosen
}

fn write(bus: &mut impl I2c, address: u8, bytes: &[u8]) -> Result<(), Fault> {
    bus.write(address, bytes).map_err(|_| Fault::Bus)
}

fn write_register(bus: &mut impl I2c, address: u8, register: u8, value: u8) -> Result<(), Fault> {
    write(bus, address, &[register, value])
}

fn read<const N: usize>(bus: &mut impl I2c, address: u8, register: u8) -> Result<[u8; N], Fault> {
    let mut bytes = [0; N];
    bus.write_read(address, &[register], &mut bytes)
        .map_err(|_| Fault::Bus)?;
    Ok(bytes)
}

// Registers, by the names of ST's driver where it has one.
const MODEL_ID: u8 = 0xC0; // IDENTIFICATION_MODEL_ID
const MODEL: u8 = 0xEE;
const I2C_ADDRESS: u8 = 0x8A; // I2C_SLAVE_DEVICE_ADDRESS
const STOP: u8 = 0x91;
const SPAD_INFO: u8 = 0x92;
const SPAD_MAP: u8 = 0xB0; // GLOBAL_CONFIG_SPAD_ENABLES_REF_0 to _5
const FINAL_TIMEOUT: u8 = 0x71; // FINAL_RANGE_CONFIG_TIMEOUT_MACROP_HI, _LO
const INTERRUPT_STATUS: u8 = 0x13; // RESULT_INTERRUPT_STATUS
const RESULT: u8 = 0x14; // RESULT_RANGE_STATUS; the distance is in its bytes 10 and 11
const INTERRUPT_CLEAR: u8 = 0x0B; // SYSTEM_INTERRUPT_CLEAR

/// A step of the start-up.
enum Step {
    /// The right part answers.
    Identify,
    /// Its own address.
    Address,
    /// Registers and values, one transaction each.
    Write(&'static [(u8, u8)]),
    /// Clears and sets bits of a register.
    Change(u8, u8, u8),
    /// Until any of these bits is set.
    Wait(u8, u8),
    /// Keeps what is written back before a start.
    KeepStop,
    /// Writes it.
    WriteStop,
    /// Keeps number and kind of the reference SPADs.
    KeepSpads,
    /// Keeps which of them are good.
    KeepMap,
    /// Enables those chosen.
    WriteMap,
    /// The timing budget.
    Budget,
}

impl Step {
    /// Transactions at most: of one write, for `Write`.
    const fn cost(&self) -> u8 {
        match self {
            Self::Change(..) => 2,
            _ => 1,
        }
    }
}

/// Start-up and start of continuous measuring, in the order of ST's `DataInit`, `StaticInit`, `PerformRefCalibration` and
/// `StartMeasurement`. Register 0xFF selects a page.
const SETUP: &[Step] = &[
    Step::Identify,
    Step::Address,
    // DataInit: 2.8 V I/O, standard I2C mode.
    Step::Change(0x89, 0x00, 0x01),
    Step::Write(&[(0x88, 0x00), (0x80, 0x01), (0xFF, 0x01), (0x00, 0x00)]),
    Step::KeepStop,
    Step::Write(&[(0x00, 0x01), (0xFF, 0x00), (0x80, 0x00)]),
    // No limit checks on MSRC and pre-range; least return signal 0.25 Mcps (9.7 bits); all steps on.
    Step::Change(0x60, 0x00, 0x12),
    Step::Write(&[(0x44, 0x00), (0x45, 0x20), (0x01, 0xFF)]),
    // Reference SPADs as the factory found them.
    Step::Write(&[(0x80, 0x01), (0xFF, 0x01), (0x00, 0x00), (0xFF, 0x06)]),
    Step::Change(0x83, 0x00, 0x04),
    Step::Write(&[
        (0xFF, 0x07),
        (0x81, 0x01),
        (0x80, 0x01),
        (0x94, 0x6B),
        (0x83, 0x00),
    ]),
    Step::Wait(0x83, 0xFF),
    Step::Write(&[(0x83, 0x01)]),
    Step::KeepSpads,
    Step::Write(&[(0x81, 0x00), (0xFF, 0x06)]),
    Step::Change(0x83, 0x04, 0x00),
    Step::Write(&[(0xFF, 0x01), (0x00, 0x01), (0xFF, 0x00), (0x80, 0x00)]),
    Step::KeepMap,
    Step::Write(&[
        (0xFF, 0x01),
        (0x4F, 0x00),
        (0x4E, 0x2C),
        (0xFF, 0x00),
        (0xB6, 0xB4),
    ]),
    Step::WriteMap,
    Step::Write(TUNING),
    // Interrupt status on a new sample, active low; clear it.
    Step::Write(&[(0x0A, 0x04)]),
    Step::Change(0x84, 0x10, 0x00),
    // Steps that stay on: DSS, pre-range, final range.
    Step::Write(&[(0x0B, 0x01), (0x01, 0xE8)]),
    Step::Budget,
    // Reference calibration: VHV, then phase.
    Step::Write(&[(0x01, 0x01), (0x00, 0x41)]),
    Step::Wait(0x13, 0x07),
    Step::Write(&[(0x0B, 0x01), (0x00, 0x00), (0x01, 0x02), (0x00, 0x01)]),
    Step::Wait(0x13, 0x07),
    Step::Write(&[(0x0B, 0x01), (0x00, 0x00), (0x01, 0xE8)]),
    // Measure back to back.
    Step::Write(&[(0x80, 0x01), (0xFF, 0x01), (0x00, 0x00)]),
    Step::WriteStop,
    Step::Write(&[(0x00, 0x01), (0xFF, 0x00), (0x80, 0x00), (0x00, 0x02)]),
];

/// ST's default tuning, as in `vl53l0x_tuning.h` (version of 02/11/2015).
#[rustfmt::skip]
const TUNING: &[(u8, u8)] = &[
    (0xFF, 0x01), (0x00, 0x00),
    (0xFF, 0x00), (0x09, 0x00), (0x10, 0x00), (0x11, 0x00), (0x24, 0x01), (0x25, 0xFF), (0x75, 0x00),
    (0xFF, 0x01), (0x4E, 0x2C), (0x48, 0x00), (0x30, 0x20),
    (0xFF, 0x00), (0x30, 0x09), (0x54, 0x00), (0x31, 0x04), (0x32, 0x03), (0x40, 0x83), (0x46, 0x25),
    (0x60, 0x00), (0x27, 0x00), (0x50, 0x06), (0x51, 0x00), (0x52, 0x96), (0x56, 0x08), (0x57, 0x30),
    (0x61, 0x00), (0x62, 0x00), (0x64, 0x00), (0x65, 0x00), (0x66, 0xA0),
    (0xFF, 0x01), (0x22, 0x32), (0x47, 0x14), (0x49, 0xFF), (0x4A, 0x00),
    (0xFF, 0x00), (0x7A, 0x0A), (0x7B, 0x00), (0x78, 0x21),
    (0xFF, 0x01), (0x23, 0x34), (0x42, 0x00), (0x44, 0xFF), (0x45, 0x26), (0x46, 0x05), (0x40, 0x40),
    (0x0E, 0x06), (0x20, 0x1A), (0x43, 0x40),
    (0xFF, 0x00), (0x34, 0x03), (0x35, 0x44),
    (0xFF, 0x01), (0x31, 0x04), (0x4B, 0x09), (0x4C, 0x05), (0x4D, 0x04),
    (0xFF, 0x00), (0x44, 0x00), (0x45, 0x20), (0x47, 0x08), (0x48, 0x28), (0x67, 0x00), (0x70, 0x04),
    (0x71, 0x01), (0x72, 0xFE), (0x76, 0x00), (0x77, 0x00),
    (0xFF, 0x01), (0x0D, 0x01),
    (0xFF, 0x00), (0x80, 0x01), (0x01, 0xF8),
    (0xFF, 0x01), (0x8E, 0x01), (0x00, 0x01), (0xFF, 0x00), (0x80, 0x00),
];
