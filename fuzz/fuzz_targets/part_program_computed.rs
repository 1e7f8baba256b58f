//! Programs of loops, conditions, calls and expressions, a line for each byte: however they are nested, they end.
#![no_main]

use feedbits_fuzz::holds;
use libfuzzer_sys::fuzz_target;
use part_program::Dialect;

const LINES: [&str; 48] = [
    "o1 sub",
    "o1 endsub",
    "o1 endsub [#1]",
    "o1 return [#2]",
    "o1 call",
    "o1 call [1] [#1+1]",
    "o<b> sub",
    "o<b> endsub",
    "o<b> call [#1-1]",
    "o2 if [#1 GT 2]",
    "o2 elseif [#1 EQ 1]",
    "o2 else",
    "o2 endif",
    "o3 while [#1 LT 5]",
    "o3 endwhile",
    "o3 break",
    "o3 continue",
    "o4 do",
    "o4 while [#1 GT 0]",
    "o5 repeat [3]",
    "o5 endrepeat",
    "#1=[#1+1]",
    "#1=[#1-1]",
    "#<_a>=[#1*2]",
    "#[#1]=[1/#1]",
    "G1 X#1 Y[#1*2]",
    "G91 G1 X1 Z-[#1]",
    "G90",
    "G81 X#1 Z-1 R1",
    "G2 X#1 I[#1/2] P2",
    "M98 P1",
    "M98 P7 L2",
    "O7",
    "M99",
    "G65 P7 A#1 B2",
    "IF [#1 GT 3] GOTO 5",
    "N5 GOTO 6",
    "N6",
    "WHILE [#1 LT 4] DO1",
    "END1",
    "IF [#1 EQ #0] THEN #1=1",
    "M30",
    "G10 L2 P1 X#1 R30",
    "G92 X0",
    "R1=R1+1",
    "G1 X=R1",
    "G53 G0 Z0",
    "G4 P#1",
];

fuzz_target!(|bytes: &[u8]| {
    let Some((first, bytes)) = bytes.split_first() else { return };
    let lines = bytes.iter().map(|byte| LINES[usize::from(*byte) % LINES.len()]).collect::<Vec<_>>();
    let dialect = [None, Some(Dialect::Fanuc), Some(Dialect::LinuxCnc), Some(Dialect::Siemens)]
        [usize::from(*first) % 4];
    holds(lines.join("\n").as_bytes(), dialect, *first > 127);
});
