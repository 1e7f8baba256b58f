#![no_main]

use feedbits_fuzz::{MOST_PERIODS, expect};
use libfuzzer_sys::fuzz_target;
use real::{I4F28, I8F24, I16F48};
use stress::{PlannedPath, RandomPath, check_against_float};

fuzz_target!(|bytes: &[u8]| {
    let Some(path) = RandomPath::<2>::from_bytes(bytes) else { return };
    let Some(planned) = PlannedPath::new(&path, MOST_PERIODS) else { return };
    expect(check_against_float::<I8F24, 2>(&planned));
    expect(check_against_float::<I4F28, 2>(&planned));
    expect(check_against_float::<I16F48, 2>(&planned));
});
