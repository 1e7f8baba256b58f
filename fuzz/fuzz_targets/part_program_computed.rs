//! Programs of loops, conditions, calls and expressions, a line for each byte: however they are nested, they end.
#![no_main]

use feedbits_fuzz::holds;
use libfuzzer_sys::fuzz_target;
use part_program::Dialect;

const LINES: &str = include_str!("../../crates/part-program/tests/programs/computed_lines.txt");

fuzz_target!(|bytes: &[u8]| {
    let Some((first, bytes)) = bytes.split_first() else { return };
    let known = LINES.lines().collect::<Vec<_>>();
    let lines = bytes.iter().map(|byte| known[usize::from(*byte) % known.len()]).collect::<Vec<_>>();
    let dialect = [None, Some(Dialect::Fanuc), Some(Dialect::LinuxCnc), Some(Dialect::Siemens)]
        [usize::from(*first) % 4];
    holds(lines.join("\n").as_bytes(), dialect, *first > 127);
});
