#![no_main]

use feedbits_fuzz::right;
use kernel_oracle::{reads_stream, sealed};
use libfuzzer_sys::fuzz_target;
use real::{I4F28, I16F16, I16F48};

fuzz_target!(|bytes: &[u8]| {
    for bytes in [bytes.to_vec(), sealed(bytes)] {
        right(reads_stream::<I4F28, 2>(&bytes));
        right(reads_stream::<I16F16, 3>(&bytes));
        right(reads_stream::<I16F48, 2>(&bytes));
        right(reads_stream::<f32, 3>(&bytes));
        right(reads_stream::<f64, 2>(&bytes));
    }
});
