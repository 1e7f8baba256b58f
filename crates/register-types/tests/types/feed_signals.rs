// Part a ?part? -- ?/ of?mine: 3 registers of 34 bits in all.
//
// Its signals.
// Rounding: to nearest, ties up. Overflow: the high bits are lost.
//
// For the crate `fixed`. Its operators round down: round their results as above.

/// what it is; at most 3.4567: I3F23, 26 of 32 bits.
pub type Parameter = fixed::FixedI32<fixed::types::extra::U23>;
/// what it is; at most 0.0335: I1F4, 5 of 8 bits.
pub type ChordTurn = fixed::FixedI8<fixed::types::extra::U4>;
/// what it is; at most 1.0001: I2F1, 3 of 8 bits.
pub type JointTravelled = fixed::FixedI8<fixed::types::extra::U1>;
