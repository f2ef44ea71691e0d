/* A Cortex-M from reset to main and to the end, without a C library: vectors, data, bss; printing and exit by
 * semihosting, which QEMU and debuggers answer. */

#include "say.h"

#include <stdint.h>

extern uint32_t _data_load, _data, _data_end, _bss, _bss_end, _stack_top;

int main(void);

/* Semihosting: operation in r0, parameter in r1. */
static void semihost(uint32_t operation, const void *parameter) {
    register uint32_t r0 __asm__("r0") = operation;
    register const void *r1 __asm__("r1") = parameter;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

void say(const char *text) {
    semihost(0x04, text);
}

/* Ends the emulator: 0x20026 is an application's exit, anything else an error. */
static _Noreturn void end(int code) {
    semihost(0x18, code == 0 ? (const void *)0x20026 : (const void *)0x20023);
    for (;;) {
    }
}

static _Noreturn void fault(void) {
    say("the processor faulted\n");
    end(1);
}

_Noreturn void reset(void) {
    const uint32_t *from = &_data_load;
    for (uint32_t *to = &_data; to < &_data_end; to++) {
        *to = *from++;
    }
    for (uint32_t *to = &_bss; to < &_bss_end; to++) {
        *to = 0;
    }
#ifdef __ARM_FP
    /* The compilers may use the floating-point registers: switch them on, before the first use. */
    *(volatile uint32_t *)0xE000ED88 |= 0xFu << 20;
    __asm__ volatile("dsb\n\tisb" ::: "memory");
#endif
    end(main());
}

typedef void handler(void);

__attribute__((section(".vectors"), used)) static const struct {
    uint32_t *stack;
    handler *reset, *others[14];
} VECTORS = {
    &_stack_top,
    reset,
    {fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault},
};
