//! From reset to the image's `image_main`; any fault leads to its `image_fault`. An image has both, `no_mangle` and
//! without return.

unsafe extern "C" {
    fn image_main() -> !;
    fn image_fault() -> !;
}

#[cfg(target_arch = "arm")]
core::arch::global_asm!(
    ".section .vectors, \"a\"",
    ".word _stack_top",
    ".word _start",
    ".rept 14",
    ".word _fault",
    ".endr",
    ".section .start, \"ax\"",
    ".global _start",
    ".thumb_func",
    "_start:",
    "ldr r0, =_data",
    "ldr r1, =_data_end",
    "ldr r2, =_data_load",
    "b 2f",
    "1: ldr r3, [r2]",
    "str r3, [r0]",
    "adds r0, #4",
    "adds r2, #4",
    "2: cmp r0, r1",
    "blo 1b",
    "ldr r0, =_bss",
    "ldr r1, =_bss_end",
    "movs r3, #0",
    "b 4f",
    "3: str r3, [r0]",
    "adds r0, #4",
    "4: cmp r0, r1",
    "blo 3b",
    "bl {main}",
    ".thumb_func",
    "_fault:",
    "bl {fault}",
    ".ltorg",
    main = sym main,
    fault = sym image_fault,
);

#[cfg(target_arch = "riscv32")]
core::arch::global_asm!(
    ".section .vectors, \"ax\"",
    ".global _start",
    "_start:",
    "la sp, _stack_top",
    "la t0, 9f",
    "csrw mtvec, t0",
    "la a0, _data",
    "la a1, _data_end",
    "la a2, _data_load",
    "j 2f",
    "1: lw a3, 0(a2)",
    "sw a3, 0(a0)",
    "addi a0, a0, 4",
    "addi a2, a2, 4",
    "2: bltu a0, a1, 1b",
    "la a0, _bss",
    "la a1, _bss_end",
    "j 4f",
    "3: sw zero, 0(a0)",
    "addi a0, a0, 4",
    "4: bltu a0, a1, 3b",
    "call {main}",
    ".balign 4",
    "9: call {fault}",
    main = sym main,
    fault = sym image_fault,
);

extern "C" fn main() -> ! {
    // Without a float in sight, the compiler may still keep integers in the FPU's registers.
    #[cfg(target_abi = "eabihf")]
    // SAFETY: switches the coprocessor on, before its first use.
    unsafe {
        let access = 0xE000_ED88 as *mut u32;
        access.write_volatile(access.read_volatile() | 0xF << 20);
        core::arch::asm!("dsb", "isb", options(nostack));
    }
    // SAFETY: the image's own, of that type.
    unsafe { image_main() }
}
