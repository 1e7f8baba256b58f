#![no_main]

use feedbits_fuzz::runs;
use libfuzzer_sys::fuzz_target;
use real::I32F32;

fuzz_target!(|bytes: &[u8]| runs::<I32F32>(bytes));
