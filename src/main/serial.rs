//! The link's serial port, USART2: an interrupt moves bytes between the wire and two bounded queues.

use cortex_m::peripheral::{NVIC, SCB};
use fuzzypilot::firmware::pipe::Pipe;
use stm32f4::stm32f411::{Interrupt, USART2};

/// Baud rate, 8N1.
pub const BAUD: u32 = 460_800;

/// What came in: four of the longest frames, or 5.5 ms at full speed.
pub static RECEIVED: Pipe<256> = Pipe::new();

/// What is to go out: a record's three frames and one more.
static TO_SEND: Pipe<256> = Pipe::new();

/// So many bytes without the end of a frame are handed over all the same.
const ENOUGH: u8 = 32;

/// What the interrupt owns.
pub struct Port {
    usart: USART2,
    /// Bytes since the last hand-over.
    pending: u8,
}

impl Port {
    /// Switches the port on; `clock` is its clock in Hz.
    pub fn start(usart: USART2, clock: u32) -> Self {
        let divisor = clock.wrapping_add(BAUD / 2) / BAUD;
        // Safety: sixteenths of the divisor of 16 · baud are the divisor of baud, some 91.
        usart.brr().write(|w| unsafe { w.bits(divisor as u16) });
        usart.cr1().write(|w| {
            w.ue().set_bit();
            w.re().set_bit();
            w.te().set_bit();
            w.rxneie().set_bit()
        });
        Self { usart, pending: 0 }
    }

    /// The interrupt. A byte that finds no room is lost, and its frame with it: the CRC tells.
    pub fn serve(&mut self) {
        let status = self.usart.sr().read();
        // Reading the data clears an overrun, too.
        if status.rxne().bit_is_set() || status.ore().bit_is_set() {
            let byte = self.usart.dr().read().bits() as u8;
            RECEIVED.push(&[byte]);
            self.pending = self.pending.wrapping_add(1);
            if byte == 0 || self.pending >= ENOUGH {
                self.pending = 0;
                SCB::set_pendsv();
            }
        }
        // On the chip one byte fits at a time, the emulator takes them all.
        while self.usart.sr().read().txe().bit_is_set() {
            let Some(byte) = TO_SEND.pop() else {
                break;
            };
            // Safety: a byte.
            self.usart.dr().write(|w| unsafe { w.bits(byte.into()) });
        }
        let more = !TO_SEND.is_empty();
        self.usart.cr1().modify(|_, w| w.txeie().bit(more));
    }
}

/// Sends a frame, without waiting. Where there is no room for it, it is dropped, and the desktop asks again.
pub fn send(frame: &[u8]) {
    if TO_SEND.push(frame) {
        NVIC::pend(Interrupt::USART2);
    }
}
