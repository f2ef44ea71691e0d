//! A clock that goes on by a fixed step with every instruction while the emulator runs with `-icount`: SysTick on
//! Cortex-M, the cycle counter on RISC-V.

use fuzzypilot::navigate;
use fuzzypilot::tick::{Probe, Stage};

#[cfg(target_arch = "arm")]
mod counter {
    const CONTROL: *mut u32 = 0xE000_E010 as *mut u32;
    const RELOAD: *mut u32 = 0xE000_E014 as *mut u32;
    const VALUE: *mut u32 = 0xE000_E018 as *mut u32;
    const SPAN: u32 = 0x00FF_FFFF;

    /// Starts it.
    pub fn start() {
        // SAFETY: every machine emulated has a SysTick, and nothing else uses it.
        unsafe {
            RELOAD.write_volatile(SPAN);
            VALUE.write_volatile(0);
            CONTROL.write_volatile(5);
        }
    }

    #[inline(always)]
    pub fn read() -> u32 {
        // SAFETY: as above; reading has no side effect here.
        unsafe { VALUE.read_volatile() }
    }

    /// It counts down.
    #[inline(always)]
    pub fn between(begin: u32, end: u32) -> u32 {
        begin.wrapping_sub(end) & SPAN
    }
}

#[cfg(target_arch = "riscv32")]
mod counter {
    /// It runs from reset on.
    pub fn start() {}

    #[inline(always)]
    pub fn read() -> u32 {
        let count: u32;
        // SAFETY: reading a counter changes nothing.
        unsafe { core::arch::asm!("csrr {}, mcycle", out(reg) count, options(nomem, nostack)) };
        count
    }

    #[inline(always)]
    pub fn between(begin: u32, end: u32) -> u32 {
        end.wrapping_sub(begin)
    }
}

pub use counter::start;

/// The clock now. A call, so that it costs the same everywhere; by its name the emulator's log is searched.
#[inline(never)]
#[unsafe(no_mangle)]
pub extern "C" fn clock_now() -> u32 {
    counter::read()
}

pub use clock_now as now;

/// Clock ticks since `begin`.
#[inline(always)]
pub fn since(begin: u32) -> u32 {
    counter::between(begin, now())
}

/// The count of nothing.
#[inline(never)]
pub fn empty() -> u32 {
    let begin = now();
    since(begin)
}

/// The count of 1,000 instructions and of nothing.
#[inline(never)]
pub fn thousand() -> u32 {
    let begin = now();
    // SAFETY: does nothing, a thousand times.
    unsafe { core::arch::asm!(".rept 1000", "nop", ".endr", options(nomem, nostack)) };
    since(begin)
}

/// Stages of a tick.
const STAGES: usize = 9;

/// Counts every stage of one tick.
pub struct Clock {
    last: u32,
    /// By stage.
    pub counts: [u32; STAGES],
}

impl Default for Clock {
    fn default() -> Self {
        Self::new()
    }
}

impl Clock {
    /// Before the first tick.
    pub fn new() -> Self {
        Self {
            last: 0,
            counts: [0; STAGES],
        }
    }

    /// The tick begins now.
    #[inline(never)]
    pub fn begin(&mut self) {
        self.last = now();
    }
}

impl Probe for Clock {
    #[inline(never)]
    fn mark(&mut self, stage: Stage) {
        let count = since(self.last);
        if let Some(place) = self.counts.get_mut(stage as usize) {
            *place = count;
        }
        self.last = now();
    }
}

/// The count of an empty stage.
#[inline(never)]
pub fn empty_stage() -> u32 {
    let mut clock = Clock::new();
    clock.begin();
    clock.mark(Stage::Read);
    clock.mark(Stage::Sense);
    clock.counts[1]
}

/// Stages of a navigator's tick.
const PARTS: usize = 9;

/// Counts every stage of one tick of a navigator.
pub struct Marks {
    last: u32,
    /// By stage.
    pub counts: [u32; PARTS],
}

impl Default for Marks {
    fn default() -> Self {
        Self::new()
    }
}

impl Marks {
    /// Before the tick.
    pub fn new() -> Self {
        Self {
            last: 0,
            counts: [0; PARTS],
        }
    }

    /// The tick begins now.
    #[inline(never)]
    pub fn begin(&mut self) {
        self.last = now();
    }
}

impl navigate::Probe for Marks {
    #[inline(never)]
    fn mark(&mut self, stage: navigate::Stage) {
        let count = since(self.last);
        if let Some(place) = self.counts.get_mut(stage as usize) {
            *place = count;
        }
        self.last = now();
    }
}

/// The count of an empty stage of a navigator's tick.
#[inline(never)]
pub fn empty_mark() -> u32 {
    let mut marks = Marks::new();
    marks.begin();
    navigate::Probe::mark(&mut marks, navigate::Stage::Remember);
    navigate::Probe::mark(&mut marks, navigate::Stage::Near);
    marks.counts[1]
}
