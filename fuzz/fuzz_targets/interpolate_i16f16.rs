#![no_main]

use feedbits_fuzz::runs;
use libfuzzer_sys::fuzz_target;
use real::I16F16;

fuzz_target!(|bytes: &[u8]| runs::<I16F16>(bytes));
