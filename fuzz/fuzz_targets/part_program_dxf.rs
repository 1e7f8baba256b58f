#![no_main]

use feedbits_fuzz::holds;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    // The reader that is meant, whatever the bytes.
    let text = [b"0\nSECTION\n".as_slice(), bytes].concat();
    holds(&text, None, false);
});
