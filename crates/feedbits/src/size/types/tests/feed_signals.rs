// Part a ?part? -- ?/ of?mine: 3 registers of 34 bits in all.
// Written by `feedbits size --types`, version 0.1.0.
//
// The feed fluctuates by 7.6e-7, and 1.0e-6 are allowed, if each signal
// is rounded to its type wherever it is computed, and the operators between two
// signals are exact to 53 bits. A type is as wide as the bound of its signal, which
// is proved for this part, demands: only what is rounded up to the bound overflows.
// Rounding: to nearest, ties up. Overflow: the high bits are lost.
//
// For the crate `fixed`. Its operators round down: round their results as above.

/// what it is; at most 3.4567: I3F23, 26 of 32 bits.
pub type Parameter = fixed::FixedI32<fixed::types::extra::U23>;
/// what it is; at most 0.0335: I1F4, 5 of 8 bits.
pub type ChordTurn = fixed::FixedI8<fixed::types::extra::U4>;
/// what it is; at most 1.0001: I2F1, 3 of 8 bits.
pub type JointTravelled = fixed::FixedI8<fixed::types::extra::U1>;
