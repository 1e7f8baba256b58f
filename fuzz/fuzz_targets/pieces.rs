#![no_main]

use feedbits_fuzz::expect;
use libfuzzer_sys::fuzz_target;
use real::{I4F28, I16F16, I16F48};
use stress::{RandomPath, check_pieces};

fuzz_target!(|bytes: &[u8]| {
    let Some(path) = RandomPath::<3>::from_bytes(bytes) else { return };
    expect(check_pieces::<f64, 3>(&path, 3));
    expect(check_pieces::<f32, 3>(&path, 3));
    expect(check_pieces::<I4F28, 3>(&path, 3));
    expect(check_pieces::<I16F16, 3>(&path, 3));
    expect(check_pieces::<I16F48, 3>(&path, 3));
});
