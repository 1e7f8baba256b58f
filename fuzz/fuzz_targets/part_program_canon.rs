#![no_main]

use feedbits_fuzz::holds;
use libfuzzer_sys::fuzz_target;
use part_program::Dialect;

fuzz_target!(|bytes: &[u8]| holds(bytes, Some(Dialect::Canon), bytes.first() == Some(&b' ')));
