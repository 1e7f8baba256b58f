//! `kernel`: the real-time kernels as a controller runs them, in every number format, with a known sequence of calls.
//!
//! | what is called | where |
//! |---|---|
//! | each operation of [`real::Real`] on sixteen sets of operands | [`operations`] |
//! | one period of a run along a compiled path, from its start to its end | [`path_run`] |
//! | the starts and periods of a part of the user's own, with the feature `part` and nothing else | `own_part` |
//!
//! [`run_all`] makes all calls and reports a [`Record`] for each group of them. On a target the records are printed; a
//! host makes the same calls and must come to the same checksums. Every called kernel is an exported symbol that is not
//! inlined, so that a trace can tell where a call begins and ends.

#![no_std]
#![cfg_attr(feature = "part", allow(unused, reason = "an image of a part makes no other calls"))]

pub mod operations;
#[cfg(feature = "part")]
mod own_part;
pub mod path_run;
mod period_kind;

mod checksum;
#[cfg_attr(
    not(all(feature = "floats", feature = "fixed-32", feature = "fixed-64")),
    allow(dead_code, unused_imports, reason = "an image has a part of the formats")
)]
mod compiled {
    //! The compiled paths.
    use nurbs_core::{Joint, Piece, Pieces};
    use secant_interp::{ChordTolerance, Crossing, LengthStage, PieceInterpolator, StageShape, StepLengths};
    include!(concat!(env!("OUT_DIR"), "/paths.rs"));
}

pub use period_kind::PeriodKind;
use real::FormatName;

/// A group of calls to one kernel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Record {
    /// The number format.
    pub format: &'static str,
    /// The operation, or the path that was run.
    pub item: &'static str,
    /// The symbol of the kernel.
    pub symbol: &'static str,
    /// How often it was called.
    pub calls: u32,
    /// FNV-1a of all results, bit for bit.
    pub checksum: u64,
    /// Stack that the calls used, in bytes; 0 where that is not measured.
    pub stack_bytes: usize,
}

/// What the kernels run on.
pub trait Board {
    /// Makes the unused stack recognisable.
    fn paint_stack(&mut self);
    /// How much of the painted stack has been used since.
    fn used_stack(&mut self) -> usize;
    /// Takes a group's result.
    fn record(&mut self, record: Record);
    /// Takes the kind of each period of a part.
    fn period(&mut self, _kind: PeriodKind) {}
}

/// The bits of a number, for checksums.
pub trait Bits: real::Real {
    /// All bits, zero-extended.
    fn bits(self) -> u64;
}

impl Bits for f64 {
    fn bits(self) -> u64 {
        self.to_bits()
    }
}

impl Bits for f32 {
    fn bits(self) -> u64 {
        u64::from(self.to_bits())
    }
}

macro_rules! fixed_bits {
    ($($format:ident),*) => {$(
        impl Bits for real::$format {
            fn bits(self) -> u64 {
                u64::from(self.to_bits().cast_unsigned())
            }
        }
    )*};
}

fixed_bits!(I16F16, I8F24, I4F28, I3F29, I2F30, I32F32, I16F48, I4F60);

/// The user's own part, in place of all else.
#[derive(Clone, Copy, Debug)]
pub struct OwnPart {
    /// The format of its numbers.
    pub format: FormatName,
    /// The checksum of the run that was judged.
    pub judged: u64,
}

/// The part, with the feature `part`.
#[must_use]
pub fn own_part() -> Option<OwnPart> {
    #[cfg(feature = "part")]
    return Some(own_part::part());
    #[cfg(not(feature = "part"))]
    None
}

/// Makes the calls of the user's own part.
#[cfg(feature = "part")]
pub fn run_all(board: &mut impl Board) {
    own_part::run_all(board);
}

/// Makes all calls, in an order that is the same everywhere.
#[cfg(not(feature = "part"))]
pub fn run_all(board: &mut impl Board) {
    operations::run_all(board);
    path_run::run_all(board);
}
