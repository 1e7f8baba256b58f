#![no_main]

use feedbits_fuzz::holds;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    // The readers that are meant, whatever the bytes: of text, and of binary groups.
    for head in [b"0\nSECTION\n".as_slice(), b"AutoCAD Binary DXF\r\n\x1a\0"] {
        holds(&[head, bytes].concat(), None, false);
    }
});
