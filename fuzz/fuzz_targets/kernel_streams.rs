#![no_main]

use feedbits_fuzz::right;
use kernel_oracle::StreamCase;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|case: StreamCase| {
    right(case.check());
});
