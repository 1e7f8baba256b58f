//! Runs a part as a controller would, a setpoint a period, and compares the run's checksum with the one that was judged.
#![no_std]
#![no_main]

mod part;

use core::panic::PanicInfo;

use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use secant_interp::PositionChecksum;

#[entry]
fn main() -> ! {
    let mut periods = 0;
    let mut checksum = PositionChecksum::default();
    for section in &part::SECTIONS {
        let run = part::PATH.on(section);
        let mut state = run.start();
        // Here an interrupt of a timer would make a step a period, and hand the position to the axes.
        while let Some(setpoint) = run.step(&mut state) {
            checksum.add(run.pieces.position(setpoint.piece, &setpoint.offset)); // In units of 2⁻³⁹ mm, 64 bits a coordinate.
            periods += 1;
        }
    }
    let is_good = checksum.value() == part::CHECKSUM; // Bit for bit the run that was judged.
    hprintln!("periods  {} of {}", periods, part::PERIODS);
    hprintln!("checksum {:#018x}, expected {:#018x}", checksum.value(), part::CHECKSUM);
    end(is_good)
}

#[panic_handler]
fn panic(_: &PanicInfo<'_>) -> ! {
    end(false)
}

/// Tells the emulator how the run ended.
fn end(is_good: bool) -> ! {
    debug::exit(if is_good { debug::EXIT_SUCCESS } else { debug::EXIT_FAILURE });
    loop {
        cortex_m::asm::wfi();
    }
}
