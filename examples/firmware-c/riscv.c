/* RV32 in QEMU's machine `virt`: a UART as console, and a test device as end. */
#include <stdint.h>

#include "board.h"

int main(void);
void fault(void);

__asm__(".section .vectors, \"ax\"\n"
        ".global reset\n"
        "reset:\n"
        ".option arch, +zicsr\n"
        "la sp, stack_top\n"
        "la t0, fault\n"
        "csrw mtvec, t0\n"
        "call run_main\n"
        ".text\n");

void print(const char *text)
{
    volatile uint8_t *const uart = (volatile uint8_t *)0x10000000u;
    for (const char *c = text; *c != '\0'; c++) {
        *uart = (uint8_t)*c;
    }
}

static void stop(uint32_t is_good)
{
    volatile uint32_t *const test = (volatile uint32_t *)0x100000u;
    for (;;) {
        *test = (is_good != 0u) ? 0x5555u : 0x13333u;
    }
}

void run_main(void)
{
    stop((main() == 0) ? 1u : 0u);
}

__attribute__((aligned(4))) void fault(void)
{
    print("fault\n");
    stop(0u);
}
