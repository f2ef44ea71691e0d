//! How deep the stack goes: paint what lies below, call, and look how much paint is left. And whether it ever went too
//! deep.

const PAINT: u32 = 0xA5A5_5A5A;
/// Painted bytes; more stack than this cannot be told.
const REACH: usize = 4096;
/// Left alone for the painter itself.
const OWN: usize = 128;

unsafe extern "C" {
    static mut _bss_end: [u32; GUARD];
}

/// Words above the data that nobody may touch.
const GUARD: usize = 16;

/// Paints the end of the stack.
pub fn guard() {
    let end = &raw mut _bss_end;
    for i in 0..GUARD {
        // SAFETY: above the data, far below the stack pointer.
        unsafe { (&raw mut (*end)[i]).write_volatile(PAINT) };
    }
}

/// Whether the stack's end is untouched.
pub fn is_sound() -> bool {
    let end = &raw const _bss_end;
    // SAFETY: as above.
    (0..GUARD).all(|i| unsafe { (&raw const (*end)[i]).read_volatile() } == PAINT)
}

#[inline(always)]
fn pointer() -> usize {
    let sp: usize;
    // SAFETY: reads a register.
    unsafe {
        #[cfg(target_arch = "arm")]
        core::arch::asm!("mov {}, sp", out(reg) sp, options(nomem, nostack));
        #[cfg(target_arch = "riscv32")]
        core::arch::asm!("mv {}, sp", out(reg) sp, options(nomem, nostack));
    }
    sp
}

/// Bytes of stack that `call` uses.
#[inline(never)]
pub fn depth_of(call: impl FnOnce()) -> u32 {
    let bottom = (pointer() - REACH) as *mut u32;
    paint(bottom);
    call();
    (REACH - 4 * unpainted(bottom)) as u32
}

const WORDS: usize = (REACH - OWN) / 4;

#[inline(never)]
fn paint(bottom: *mut u32) {
    for i in 0..WORDS {
        // SAFETY: below the stack pointer and, by the linker script, above all data.
        unsafe { bottom.add(i).write_volatile(PAINT) };
    }
}

/// Words that still bear their paint, from the bottom.
#[inline(never)]
fn unpainted(bottom: *mut u32) -> usize {
    (0..WORDS)
        // SAFETY: as above.
        .find(|i| unsafe { bottom.add(*i).read_volatile() } != PAINT)
        .unwrap_or(WORDS)
}
