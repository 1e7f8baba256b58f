//! RV32 on QEMU's `virt`: an NS16550 as console, a test device as end.

use core::arch::{asm, global_asm};
use core::ptr;

global_asm!(
    ".section .vectors, \"ax\"",
    ".global reset",
    "reset:",
    "la sp, _stack_top",
    "la t0, fault",
    "csrw mtvec, t0",
    "call start",
    ".balign 4",
    "fault:",
    "call stopped_by_fault",
);

#[unsafe(no_mangle)]
extern "C" fn stopped_by_fault() -> ! {
    super::print("fault\n");
    stop(false)
}

pub(crate) fn print(text: &[u8; 32]) {
    const UART: *mut u8 = 0x1000_0000 as *mut u8;
    for byte in text.iter().take_while(|b| **b != 0) {
        // SAFETY: the transmit register of the machine's UART.
        unsafe { ptr::write_volatile(UART, *byte) };
    }
}

pub(crate) fn stop(good: bool) -> ! {
    const TEST: *mut u32 = 0x10_0000 as *mut u32;
    const PASS: u32 = 0x5555;
    const FAIL: u32 = 0x1_3333;
    // SAFETY: the machine's test device, which ends the emulation.
    unsafe { ptr::write_volatile(TEST, if good { PASS } else { FAIL }) };
    loop {
        core::hint::spin_loop();
    }
}

#[inline(always)]
pub(crate) fn stack_pointer() -> usize {
    let pointer;
    // SAFETY: reads a register.
    unsafe { asm!("mv {}, sp", out(reg) pointer, options(nomem, nostack, preserves_flags)) };
    pointer
}
