#![no_main]

use feedbits_fuzz::right;
use kernel_oracle::ChordCase;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|case: ChordCase| {
    right(case.check());
});
