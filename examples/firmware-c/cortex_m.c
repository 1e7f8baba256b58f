/* A Cortex-M in QEMU: the vector table, and semihosting as console and end. */
#include <stdint.h>

#include "board.h"

int main(void);
void reset(void);
void fault(void);

/* The linker script puts the initial stack pointer before this: then come the reset and every fault. */
__attribute__((section(".vectors"), used)) static void (*const vectors[15])(void) = {
    reset, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault, fault,
};

/* Asks the debugger, which is the emulator. */
static void semihosting(uint32_t operation, uint32_t argument)
{
    register uint32_t r0 __asm__("r0") = operation;
    register uint32_t r1 __asm__("r1") = argument;
    __asm__ volatile("bkpt 0xab" : "+r"(r0) : "r"(r1) : "memory");
}

void print(const char *text)
{
    semihosting(4u, (uint32_t)(uintptr_t)text);
}

static void stop(uint32_t is_good)
{
    for (;;) {
        semihosting(0x18u, (is_good != 0u) ? 0x20026u : 0x20023u);
    }
}

void run_main(void)
{
    stop((main() == 0) ? 1u : 0u);
}

void reset(void)
{
#if defined(__ARM_FP)
    /* Grants access to the floating-point unit: CPACR, bits 20 to 23. */
    *(volatile uint32_t *)0xE000ED88u |= 0x00F00000u;
    __asm__ volatile("dsb\n\tisb");
#endif
    run_main();
}

void fault(void)
{
    print("fault\n");
    stop(0u);
}
