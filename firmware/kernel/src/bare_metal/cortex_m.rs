//! Cortex-M: the vector table, and semihosting as console and end.

use core::arch::{asm, global_asm};

// The memory map puts the initial stack pointer before this. A fault ends the run.
global_asm!(
    ".section .vectors, \"a\"",
    ".word reset",
    ".rept 14",
    ".word fault",
    ".endr",
    ".section .text.reset, \"ax\"",
    ".global reset",
    ".thumb_func",
    ".type reset, %function",
    "reset:",
);

// Grants access to coprocessors 10 and 11, the floating-point unit: CPACR, bits 20 to 23.
#[cfg(target_abi = "eabihf")]
global_asm!(
    ".section .text.reset, \"ax\"",
    "ldr r0, =0xE000ED88",
    "ldr r1, [r0]",
    "orr r1, r1, #0x00F00000",
    "str r1, [r0]",
    "dsb",
    "isb",
);

global_asm!(
    ".section .text.reset, \"ax\"",
    "bl start",
    ".pool",
    ".thumb_func",
    ".type fault, %function",
    "fault:",
    "bl stopped_by_fault",
    ".pool",
);

#[unsafe(no_mangle)]
extern "C" fn stopped_by_fault() -> ! {
    super::print("fault\n");
    stop(false)
}

/// A request to the debugger, which is the emulator.
fn semihosting(operation: usize, argument: usize) {
    // SAFETY: the two operations used here read their argument and change no memory of the program.
    unsafe { asm!("bkpt 0xab", inout("r0") operation => _, in("r1") argument, options(nostack, readonly)) };
}

pub(crate) fn print(text: &[u8; 32]) {
    const WRITE0: usize = 4;
    semihosting(WRITE0, text.as_ptr() as usize);
}

pub(crate) fn stop(good: bool) -> ! {
    const EXIT: usize = 0x18;
    const APPLICATION_EXIT: usize = 0x2_0026;
    const RUN_TIME_ERROR: usize = 0x2_0023;
    semihosting(EXIT, if good { APPLICATION_EXIT } else { RUN_TIME_ERROR });
    loop {
        core::hint::spin_loop();
    }
}

#[inline(always)]
pub(crate) fn stack_pointer() -> usize {
    let pointer;
    // SAFETY: reads a register.
    unsafe { asm!("mov {}, sp", out(reg) pointer, options(nomem, nostack, preserves_flags)) };
    pointer
}
