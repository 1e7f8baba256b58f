//! What a program without an operating system needs: a start, a console, an end, and a stack to look at.

#[cfg_attr(target_arch = "arm", path = "cortex_m.rs")]
#[cfg_attr(target_arch = "riscv32", path = "riscv.rs")]
mod machine;
mod stack;

use core::panic::PanicInfo;

use kernel::{Board, Record};

struct Emulator;

impl Board for Emulator {
    fn paint_stack(&mut self) {
        stack::paint();
    }

    fn used_stack(&mut self) -> usize {
        stack::used()
    }

    fn record(&mut self, record: Record) {
        print("record ");
        print(record.format);
        print(" ");
        print(record.item);
        print_number(u64::from(record.calls), 10);
        print_number(record.checksum, 16);
        print_number(record.stack_bytes as u64, 10);
        print("\n");
    }
}

fn print(text: &str) {
    // The machines take text that ends with a zero, in chunks.
    for chunk in text.as_bytes().chunks(31) {
        let mut bytes = [0; 32];
        for (to, from) in bytes.iter_mut().zip(chunk) {
            *to = *from;
        }
        machine::print(&bytes);
    }
}

/// A blank and the number; hexadecimal ones with all sixteen digits.
fn print_number(number: u64, base: u64) {
    let mut digits = [b'0'; 17];
    let mut rest = number;
    let mut first = digits.len();
    while rest != 0 || first == digits.len() || (base == 16 && first > 1) {
        let Some(before) = first.checked_sub(1) else { break };
        first = before;
        if let Some(digit) = digits.get_mut(first) {
            *digit = *b"0123456789abcdef".get((rest % base) as usize).unwrap_or(&b'?');
        }
        rest /= base;
    }
    print(" ");
    print(digits.get(first..).and_then(|d| core::str::from_utf8(d).ok()).unwrap_or("?"));
}

/// Called by the machine's start code, with the stack set up.
#[unsafe(no_mangle)]
extern "C" fn start() -> ! {
    kernel::run_all(&mut Emulator);
    machine::stop(true)
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    print("panic\n");
    machine::stop(false)
}
