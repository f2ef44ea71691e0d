//! I2C1 as a bus that cannot hold the program: every wait is bounded, and a stuck bus is clocked free.
//!
//! The order of register accesses is that of the reference manual (RM0383, 18.3.3): the last bytes of a reading are
//! taken while the bus is stretched, so an interrupt that comes between does no harm.

use super::clock::wait;
use super::gpio::{Mode, Pin};
use embedded_hal::i2c::{ErrorKind, ErrorType, I2c, NoAcknowledgeSource, Operation};
use stm32f4::stm32f411::I2C1;

/// How often a flag is looked at: 10 bytes' time or so at 400 kHz.
const PATIENCE: u32 = 2_000;

/// The pins' alternate function.
const FUNCTION: u32 = 4;

/// The bus.
pub struct Bus {
    i2c: I2C1,
    clock: Pin,
    data: Pin,
    /// Its clock, MHz.
    mhz: u8,
}

/// A flag of the first status register.
#[derive(Clone, Copy)]
enum Flag {
    Started,
    Addressed,
    Finished,
    Received,
    Empty,
}

impl Bus {
    /// Sets pins and peripheral up; `frequency` is the peripheral's clock in Hz.
    pub fn start(i2c: I2C1, clock: Pin, data: Pin, frequency: u32) -> Self {
        let mut bus = Self {
            i2c,
            clock,
            data,
            mhz: (frequency / 1_000_000) as u8,
        };
        bus.free();
        bus
    }

    /// Brings the bus to rest: nine clocks let go whoever still wants to send a byte, then the peripheral starts anew.
    fn free(&mut self) {
        self.data.set_up(Mode::OpenDrain);
        self.clock.set_up(Mode::OpenDrain);
        for _ in 0..9 {
            // 5 µs and more.
            self.clock.write(false);
            cortex_m::asm::delay(500);
            self.clock.write(true);
            cortex_m::asm::delay(500);
        }
        self.data.set_up(Mode::FunctionOpen(FUNCTION));
        self.clock.set_up(Mode::FunctionOpen(FUNCTION));
        self.i2c.cr1().write(|w| w.swrst().set_bit());
        self.i2c.cr1().reset();
        let mhz = u16::from(self.mhz);
        // Safety: values that the fields hold. Fast mode, low twice as long as high: a third of the clock by 400 kHz; rises
        // within 300 ns.
        unsafe {
            self.i2c.cr2().write(|w| w.freq().bits(self.mhz));
            let ratio = mhz.wrapping_mul(1000).wrapping_add(1199) / 1200;
            self.i2c
                .ccr()
                .write(|w| w.f_s().set_bit().ccr().bits(ratio));
            let rise = mhz.wrapping_mul(3) / 10;
            self.i2c
                .trise()
                .write(|w| w.trise().bits(rise.wrapping_add(1) as u8));
        }
        self.i2c.cr1().write(|w| w.pe().set_bit());
    }

    fn wait(&self, flag: Flag) -> Result<(), ErrorKind> {
        let mut error = None;
        let came = wait(PATIENCE, || {
            let status = self.i2c.sr1().read();
            error = if status.af().bit_is_set() {
                Some(ErrorKind::NoAcknowledge(NoAcknowledgeSource::Unknown))
            } else if status.arlo().bit_is_set() {
                Some(ErrorKind::ArbitrationLoss)
            } else if status.berr().bit_is_set() {
                Some(ErrorKind::Bus)
            } else {
                None
            };
            error.is_some()
                || match flag {
                    Flag::Started => status.sb().bit_is_set(),
                    Flag::Addressed => status.addr().bit_is_set(),
                    Flag::Finished => status.btf().bit_is_set(),
                    Flag::Received => status.rx_ne().bit_is_set(),
                    Flag::Empty => status.tx_e().bit_is_set(),
                }
        });
        match error {
            Some(error) => Err(error),
            None if came => Ok(()),
            None => Err(ErrorKind::Other),
        }
    }

    fn send(&self, byte: u8) {
        // Safety: a byte.
        self.i2c.dr().write(|w| unsafe { w.dr().bits(byte) });
    }

    fn receive(&self) -> u8 {
        self.i2c.dr().read().dr().bits()
    }

    fn stop(&self) {
        self.i2c.cr1().modify(|_, w| w.stop().set_bit());
    }

    fn acknowledge(&self, on: bool) {
        self.i2c.cr1().modify(|_, w| w.ack().bit(on));
    }

    /// Ends the address phase.
    fn addressed(&self) {
        let _ = self.i2c.sr2().read();
    }

    /// Start or repeated start, and the address.
    fn address(&self, address: u8, read: bool) -> Result<(), ErrorKind> {
        self.i2c.cr1().modify(|_, w| w.start().set_bit());
        self.wait(Flag::Started)?;
        self.send(address << 1 | u8::from(read));
        self.wait(Flag::Addressed)
    }

    fn write<'a>(&self, address: u8, bytes: impl Iterator<Item = &'a u8>) -> Result<(), ErrorKind> {
        self.address(address, false)?;
        self.addressed();
        for byte in bytes {
            self.wait(Flag::Empty)?;
            self.send(*byte);
        }
        self.wait(Flag::Finished)
    }

    /// Reads `count` bytes; the last is not acknowledged.
    fn read<'a>(
        &self,
        address: u8,
        count: usize,
        bytes: impl Iterator<Item = &'a mut u8>,
        last: bool,
    ) -> Result<(), ErrorKind> {
        let end = || {
            if last {
                self.stop();
            }
        };
        self.acknowledge(true);
        self.i2c.cr1().modify(|_, w| w.pos().bit(count == 2));
        self.address(address, true)?;
        critical_section::with(|_| match count {
            1 => {
                self.acknowledge(false);
                self.addressed();
                end();
            }
            2 => {
                self.addressed();
                self.acknowledge(false);
            }
            _ => self.addressed(),
        });
        for (left, byte) in (1..=count).rev().zip(bytes) {
            match left {
                // The bus waits with the last two received.
                2 => {
                    self.wait(Flag::Finished)?;
                    end();
                }
                3 => {
                    self.wait(Flag::Finished)?;
                    self.acknowledge(false);
                }
                _ => self.wait(Flag::Received)?,
            }
            *byte = self.receive();
        }
        Ok(())
    }

    /// Reads and writes, each run of one kind in one go.
    fn transfer(&self, address: u8, operations: &mut [Operation<'_>]) -> Result<(), ErrorKind> {
        let mut runs = operations
            .chunk_by_mut(|a, b| is_read(a) == is_read(b))
            .peekable();
        while let Some(run) = runs.next() {
            let last = runs.peek().is_none();
            if run.first().is_some_and(is_read) {
                let count = run.iter().map(length).fold(0, usize::saturating_add);
                let bytes = run.iter_mut().flat_map(|operation| match operation {
                    Operation::Read(bytes) => bytes.iter_mut(),
                    Operation::Write(_) => [].iter_mut(),
                });
                self.read(address, count, bytes, last)?;
            } else {
                let bytes = run.iter().flat_map(|operation| match operation {
                    Operation::Write(bytes) => bytes.iter(),
                    Operation::Read(_) => [].iter(),
                });
                self.write(address, bytes)?;
                if last {
                    self.stop();
                }
            }
        }
        Ok(())
    }
}

fn is_read(operation: &Operation<'_>) -> bool {
    matches!(operation, Operation::Read(_))
}

fn length(operation: &Operation<'_>) -> usize {
    match operation {
        Operation::Read(bytes) => bytes.len(),
        Operation::Write(bytes) => bytes.len(),
    }
}

impl ErrorType for Bus {
    type Error = ErrorKind;
}

impl I2c for Bus {
    fn transaction(
        &mut self,
        address: u8,
        operations: &mut [Operation<'_>],
    ) -> Result<(), ErrorKind> {
        let done = self.transfer(address, operations);
        if done.is_err() {
            self.stop();
        }
        let rests = || self.i2c.sr2().read().busy().bit_is_clear();
        if !wait(PATIENCE, rests) {
            self.free();
        }
        // The flags of what went wrong; they would be the next transaction's.
        self.i2c
            .sr1()
            .modify(|_, w| w.af().clear_bit().arlo().clear_bit().berr().clear_bit());
        done
    }
}
