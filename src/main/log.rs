//! Logs by defmt, without a way to panic or to wait: into memory that a probe reads while the program runs (RTT), and in
//! the emulator, which has no probe, out by semihosting. Which of the two is found out at start; the image is the same.
//!
//! A message that finds no room is dropped whole. `defmt-rtt` does the first half as well, but panics on re-entry.

use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicBool, AtomicPtr, AtomicU8, AtomicUsize, Ordering};
use critical_section::RestoreState;
use defmt::Encoder;

/// Bytes of log that wait for the probe; a power of two.
const ROOM: usize = 512;

static BUFFER: [AtomicU8; ROOM] = [const { AtomicU8::new(0) }; ROOM];

/// SEGGER's control block, as probes search it: one channel up, none down.
#[repr(C)]
struct Control {
    id: [u8; 16],
    up: usize,
    down: usize,
    name: AtomicPtr<u8>,
    buffer: AtomicPtr<AtomicU8>,
    room: usize,
    /// Written by the program.
    write: AtomicUsize,
    /// Written by the probe.
    read: AtomicUsize,
    flags: AtomicUsize,
}

#[unsafe(no_mangle)]
static _SEGGER_RTT: Control = Control {
    id: *b"SEGGER RTT\0\0\0\0\0\0",
    up: 1,
    down: 0,
    name: AtomicPtr::new(c"defmt".as_ptr().cast_mut().cast()),
    buffer: AtomicPtr::new((&raw const BUFFER).cast_mut().cast()),
    room: ROOM,
    write: AtomicUsize::new(0),
    read: AtomicUsize::new(0),
    flags: AtomicUsize::new(0),
};

/// Whether messages go out by semihosting, too.
static EMULATED: AtomicBool = AtomicBool::new(false);

/// Tells that there is no probe but an emulator. On a chip without a probe semihosting would be a hard fault.
pub fn emulated() {
    EMULATED.store(true, Ordering::Relaxed);
}

/// The message that is being written.
struct Message {
    encoder: Encoder,
    place: Place,
    interrupts: RestoreState,
}

struct Shared(UnsafeCell<Message>);

// Safety: used between `acquire` and `release` only, where interrupts are off.
unsafe impl Sync for Shared {}

static MESSAGE: Shared = Shared(UnsafeCell::new(Message {
    encoder: Encoder::new(),
    place: Place { at: 0, fits: true },
    interrupts: RestoreState::invalid(),
}));

/// Where a message's next byte goes, and whether it has fitted so far.
struct Place {
    at: usize,
    fits: bool,
}

impl Place {
    fn put(&mut self, bytes: &[u8]) {
        let read = _SEGGER_RTT.read.load(Ordering::Acquire);
        for byte in bytes {
            let next = self.at.wrapping_add(1) % ROOM;
            match BUFFER.get(self.at) {
                Some(place) if next != read && self.fits => {
                    place.store(*byte, Ordering::Relaxed);
                    self.at = next;
                }
                _ => self.fits = false,
            }
        }
    }
}

#[defmt::global_logger]
struct Log;

// Safety: `acquire` begins a critical section and `release` ends it.
unsafe impl defmt::Logger for Log {
    fn acquire() {
        unsafe {
            let interrupts = critical_section::acquire();
            let message = &mut *MESSAGE.0.get();
            message.interrupts = interrupts;
            message.place = Place {
                at: _SEGGER_RTT.write.load(Ordering::Relaxed),
                fits: true,
            };
            let place = &mut message.place;
            message.encoder.start_frame(|bytes| place.put(bytes));
        }
    }

    unsafe fn flush() {}

    unsafe fn release() {
        unsafe {
            let message = &mut *MESSAGE.0.get();
            let place = &mut message.place;
            message.encoder.end_frame(|bytes| place.put(bytes));
            if place.fits {
                _SEGGER_RTT.write.store(place.at, Ordering::Release);
            }
            if EMULATED.load(Ordering::Relaxed) {
                semihosting::drain();
            }
            critical_section::release(message.interrupts);
        }
    }

    unsafe fn write(bytes: &[u8]) {
        unsafe {
            let message = &mut *MESSAGE.0.get();
            let place = &mut message.place;
            message.encoder.write(bytes, |bytes| place.put(bytes));
        }
    }
}

defmt::timestamp!("{=u32:us}", super::now_us());

/// The probe's part, played by the emulator.
mod semihosting {
    use super::{_SEGGER_RTT, AtomicUsize, BUFFER, Ordering};
    use core::arch::asm;

    const SYS_OPEN: usize = 1;
    const SYS_WRITE: usize = 5;
    /// `fopen`'s "w".
    const MODE_W: usize = 4;

    /// The emulator's standard output; 0 is not yet opened.
    static OUTPUT: AtomicUsize = AtomicUsize::new(0);

    /// Hands everything over that waits.
    pub fn drain() {
        let mut output = OUTPUT.load(Ordering::Relaxed);
        if output == 0 {
            const CONSOLE: &core::ffi::CStr = c":tt";
            output = call(SYS_OPEN, [CONSOLE.as_ptr() as usize, MODE_W, 3]);
            OUTPUT.store(output, Ordering::Relaxed);
        }
        let write = _SEGGER_RTT.write.load(Ordering::Relaxed);
        let read = _SEGGER_RTT.read.load(Ordering::Relaxed);
        let waiting = match read <= write {
            true => [BUFFER.get(read..write), None],
            false => [BUFFER.get(read..), BUFFER.get(..write)],
        };
        for bytes in waiting.into_iter().flatten() {
            call(SYS_WRITE, [output, bytes.as_ptr() as usize, bytes.len()]);
        }
        _SEGGER_RTT.read.store(write, Ordering::Relaxed);
    }

    fn call(operation: usize, arguments: [usize; 3]) -> usize {
        let mut result = operation;
        // Safety: the emulator reads the arguments and what they point to.
        unsafe {
            asm!("bkpt #0xAB", inout("r0") result, in("r1") &raw const arguments);
        }
        result
    }
}
