//! Stack use, by painting what is free and looking how far down the paint has gone.

use core::ptr;
use core::sync::atomic::{AtomicUsize, Ordering};

/// Unlikely as data.
const PAINT: u32 = 0x5eed_57ac;

/// Left alone below the stack pointer: the painter's own frame.
const MARGIN: usize = 64;

unsafe extern "C" {
    /// The lowest address of the stack, from the memory map.
    static _stack_limit: u32;
}

static POINTER: AtomicUsize = AtomicUsize::new(0);

fn limit() -> *mut u32 {
    ptr::addr_of!(_stack_limit).cast_mut()
}

/// Paints from just below the caller's frame down to the limit.
#[inline(always)]
pub(crate) fn paint() {
    let pointer = super::machine::stack_pointer();
    POINTER.store(pointer, Ordering::Relaxed);
    let mut at = limit();
    while (at as usize) < pointer - MARGIN {
        // SAFETY: between the limit and the stack pointer there is memory that nobody uses.
        unsafe { ptr::write_volatile(at, PAINT) };
        at = at.wrapping_add(1);
    }
}

/// Bytes below the stack pointer of the last [`paint`] that have been written.
pub(crate) fn used() -> usize {
    let mut at = limit();
    let pointer = POINTER.load(Ordering::Relaxed);
    // SAFETY: the same memory as in `paint`, and all bits are valid numbers.
    while (at as usize) < pointer && unsafe { ptr::read_volatile(at) } == PAINT {
        at = at.wrapping_add(1);
    }
    pointer - at as usize
}
