#![no_main]

use feedbits_fuzz::right;
use kernel_oracle::OperationCase;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|case: OperationCase| {
    right(case.check());
});
