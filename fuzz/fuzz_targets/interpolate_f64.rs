#![no_main]

use feedbits_fuzz::runs;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| runs::<f64>(bytes));
