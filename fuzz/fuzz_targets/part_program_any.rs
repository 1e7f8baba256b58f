#![no_main]

use feedbits_fuzz::holds;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| holds(bytes, None, bytes.first() == Some(&b' ')));
