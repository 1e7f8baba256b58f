//! `real`: the numbers that the kernels compute with.
//!
//! A kernel is written once, generic over [`Real`], and runs in floats, in fixed point, or in a wrapper that
//! watches it:
//!
//! ```
//! use real::{Backend, I16F16, Real};
//!
//! /// Chord of a step on a circle: 2ρ sin(θ/2) ≈ ρθ(1 - θ²/24).
//! fn chord<R: Real>(radius: R, angle: R) -> R {
//!     let correction = R::one() - angle * angle * R::from_ratio(1, 24);
//!     radius * angle * correction
//! }
//!
//! let exact = chord(10.0_f64, 0.1);
//! let coarse = chord(I16F16::from_f64(10.0).unwrap(), I16F16::from_f64(0.1).unwrap());
//! assert!((coarse.to_f64() - exact).abs() < 2e-4);
//! ```
//!
//! | backend | for |
//! |---|---|
//! | `f64`, `f32` | controllers with a floating-point unit |
//! | [`FixedPoint`] over the `fixed` crate's types: [`I16F16`], [`I8F24`], [`I32F32`], … | controllers without, FPGAs |
//! | `DoubleDouble` (feature `reference`) | judging the others: about 106 bits |
//! | `RuntimeFixed` (feature `std`) | any width up to 64 bits, chosen at run time |
//! | `Quantized` (feature `std`) | registers of mixed widths, signal by signal |
//!
//! Around any of them, with the feature `std`, a wrapper that changes no value:
//!
//! | wrapper | sees |
//! |---|---|
//! | `Audited`, read by `Audit::of` | overflows, underflows, and the range and `Histogram` of every named signal |
//! | `Counted`, read by `OperationCounts::of` | how many operations of each kind are done |
//! | `Watched`, read by `Watch::of` | which way a kernel went at every comparison, and how many integer bits its results need |
//! | `Recorded`, read by `Graph::of` | which operation takes its operands from which |
//!
//! [`FromWord`] makes a number of the bits that hold it, as a file has them.
//!
//! The integer algorithms beneath fixed point, with their derivations: division by Newton's reciprocal in `division.rs`,
//! roots in `square_root.rs`, conversion and rounding of words in `word.rs`.
//!
//! Features: `std` (default), `libm` for floats without std, `reference` for the double-double.

#![cfg_attr(not(feature = "std"), no_std)]

#[cfg(feature = "std")]
#[allow(clippy::module_inception, reason = "a folder's main file has the folder's name")]
mod audit {
    mod all_signals;
    pub(crate) mod audit;
    pub(crate) mod audited;
    mod signal;
    pub(crate) mod signal_range;
    mod thread_record;
    mod value;
    mod words;
}
#[cfg(feature = "std")]
mod count;
mod datapath;
mod division;
#[cfg(feature = "reference")]
mod double_double;
#[cfg(feature = "std")]
mod extremes;
#[cfg(feature = "std")]
mod fate;
#[cfg(feature = "std")]
mod few_backends;
mod fixed_point;
mod float;
mod format_name;
mod from_word;
#[cfg(feature = "std")]
mod histogram;
#[cfg(feature = "std")]
mod named;
mod operation;
mod q_name;
#[cfg(feature = "std")]
mod quantized;
#[allow(clippy::module_inception, reason = "the trait's file carries the crate's one noun")]
mod real;
#[cfg(feature = "std")]
mod record;
#[cfg(feature = "std")]
mod runtime_format;
mod square_root;
mod trigonometry;
#[cfg(feature = "std")]
mod watch;
mod word;
#[cfg(feature = "std")]
mod wrapper;

#[cfg(feature = "std")]
pub use audit::{audit::Audit, audited::Audited, signal_range::SignalRange};
#[cfg(feature = "std")]
pub use count::{Counted, OperationCounts};
pub use datapath::{Datapath, Overflow, Rounding};
#[cfg(feature = "reference")]
pub use double_double::DoubleDouble;
#[cfg(feature = "std")]
pub use extremes::Extremes;
#[cfg(feature = "std")]
pub use few_backends::{Work, in_few_backends};
/// The crate whose types [`FixedPoint`] wraps.
pub use fixed;
pub use fixed_point::FixedPoint;
pub use format_name::FormatName;
pub use from_word::{FromWord, word_of};
#[cfg(feature = "std")]
pub use histogram::Histogram;
#[cfg(feature = "std")]
pub use named::{Named, named_words};
pub use operation::Operation;
pub use q_name::QName;
#[cfg(feature = "std")]
pub use quantized::Quantized;
pub use real::{Backend, Real};
#[cfg(feature = "std")]
pub use record::{Graph, Node, NodeId, NodeKind, Recorded};
#[cfg(feature = "std")]
pub use runtime_format::{RuntimeFixed, RuntimeFormat, RuntimeFormats};
pub use trigonometry::{Trigonometric, sine_terms};
#[cfg(feature = "std")]
pub use watch::{Decision, Watch, Watched, Watching};
pub use word::{Word, product_of_words};

/// 4 integer and 4 fraction bits: small enough to test every operation on every pair.
pub type I4F4 = FixedPoint<fixed::types::I4F4>;
/// 16 integer and 16 fraction bits: ±32 768 in steps of 1.5e-5.
pub type I16F16 = FixedPoint<fixed::types::I16F16>;
/// 12 integer and 20 fraction bits: ±2 048 in steps of 9.5e-7.
pub type I12F20 = FixedPoint<fixed::types::I12F20>;
/// 8 integer and 24 fraction bits: ±128 in steps of 6.0e-8.
pub type I8F24 = FixedPoint<fixed::types::I8F24>;
/// 4 integer and 28 fraction bits: ±8 in steps of 3.7e-9.
pub type I4F28 = FixedPoint<fixed::types::I4F28>;
/// 32 integer and 32 fraction bits: ±2.1e9 in steps of 2.3e-10.
pub type I32F32 = FixedPoint<fixed::types::I32F32>;
/// 16 integer and 48 fraction bits: ±32 768 in steps of 3.6e-15.
pub type I16F48 = FixedPoint<fixed::types::I16F48>;
/// 4 integer and 60 fraction bits: ±8 in steps of 8.7e-19.
pub type I4F60 = FixedPoint<fixed::types::I4F60>;
/// 3 integer and 29 fraction bits: ±4 in steps of 1.9e-9.
pub type I3F29 = FixedPoint<fixed::types::I3F29>;
/// 2 integer and 30 fraction bits: ±2 in steps of 9.3e-10.
pub type I2F30 = FixedPoint<fixed::types::I2F30>;
