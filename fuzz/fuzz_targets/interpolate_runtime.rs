#![no_main]

use feedbits_fuzz::runs;
use libfuzzer_sys::fuzz_target;
use real::{Overflow, Rounding, RuntimeFixed, RuntimeFormat};

fuzz_target!(|bytes: &[u8]| {
    let [width, fraction, modes, rest @ ..] = bytes else { return };
    let width = 3 + u32::from(*width) % 62;
    let fraction = u32::from(*fraction) % (width - 1);
    let overflow = [Overflow::Wrap, Overflow::Saturate][usize::from(*modes >> 7)];
    // A format is narrow before it is none.
    let Some(format) = RuntimeFormat::new(width, fraction, Rounding::ALL[usize::from(*modes % 4)], overflow)
    else {
        return;
    };
    format.run::<0, ()>(|| runs::<RuntimeFixed<0>>(rest));
});
