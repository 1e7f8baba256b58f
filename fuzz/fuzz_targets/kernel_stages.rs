#![no_main]

use feedbits_fuzz::right;
use kernel_oracle::StageCase;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|case: StageCase| {
    right(case.check());
});
