#![no_main]

use feedbits_fuzz::expect;
use kernel_oracle::LimitTable;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|case: LimitTable| {
    expect(case.check());
});
