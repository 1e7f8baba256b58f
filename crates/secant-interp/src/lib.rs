//! `secant-interp`: real time. A curve and a schedule go in, one setpoint per interpolation period comes out.
//!
//! Each period has a chord of a given length. The interpolator finds the parameter at the chord's end.
//!
//! | folder | answers | public names |
//! |---|---|---|
//! | | how far does each period go? | [`StepLengths`], made of [`LengthStage`]s |
//! | `pieces/` | where does a chord end on compiled pieces? One chord without division, joints, runs from rest to rest | [`PieceInterpolator`], [`Chord`], [`Section`] |
//! | `global_parameter/` | where does a chord end on a curve with one parameter? Paper A's step | [`Interpolator`], [`secant`], [`predictor`], [`taylor`], [`CurvePart`] |
//! | `feed_override/` | which chord, while an operator turns the feed down or holds it? | [`FeedOverride`], [`PieceInterpolator::step_overridden`] |
//! | `compiled/` | how is a run stored for a controller, and does it make the same setpoints there? | `CompiledPath` (feature `alloc`; with an example from curve to setpoints), `Constant` (feature `std`), [`PositionChecksum`] |
//! | `stream/` | how is a run read from a file, section by section, through a small buffer? | [`StreamReader`]; `PathStream` (feature `std`) writes the file |
//!
//! [`PieceInterpolator::step_by`] makes a chord of a length that the caller gives.
//!
//! ```
//! use nurbs_core::{NurbsCurve, PieceLimits, compile};
//! use real::{Backend, DoubleDouble, I4F28, Real};
//! use secant_interp::{ChordTolerance, PieceInterpolator, StepLengths};
//!
//! // A quarter circle of 50 mm as pieces for I4F28, and a chord of 0.2 mm in their units of 2^-λ mm.
//! let (points, weights) = ([[50.0, 0.0], [50.0, 50.0], [0.0, 50.0]], [1.0, 0.5_f64.sqrt(), 1.0]);
//! let curve = NurbsCurve::try_new(2, &points, &weights, &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0])?;
//! let limits = PieceLimits { length_mm: 32.0, step_mm: 0.2 };
//! let table = compile::<DoubleDouble, I4F28, 2>(&[curve], &limits)?;
//! let pieces = table.as_pieces();
//! let chord = I4F28::from_f64(0.2.ldexp(pieces.chord_exponent)).unwrap_or_default();
//!
//! // Somebody else decides on the feed, so there are no stages: 0.2 mm a period, up to the end.
//! let tolerance = ChordTolerance::for_fluctuation(Some(1e-6), 5);
//! let run = PieceInterpolator { pieces, lengths: StepLengths { stages: &[], crossings: &[] }, tolerance, landing_step: chord };
//! let mut state = run.start();
//! let setpoints = std::iter::from_fn(|| run.step_by(&mut state, chord)).count();
//! assert_eq!(setpoints, 393); // 25π mm / 0.2 mm = 392.7
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! A step takes no heap, cannot panic and has no loop without a bound; everything is generic over [`real::Real`].
//!
//! | feature | for |
//! |---|---|
//! | `std` (default) | square roots of floats through std; implies `alloc` and `cubic` |
//! | `libm` | square roots of floats without std |
//! | `alloc` | `CompiledPath`: path and plan are compiled on the machine that runs them; without it no allocator is linked |
//! | `cubic` | a step on cubics that takes fewer instructions and more flash |
//!
//! # Source
//! *Paper A*: Wang Y., Gai R., Sun Y., Yang D., Han J., "NURBS interpolation algorithm for high-quality machining"
//! (received 2012), in Chinese: the step on the global parameter. `docs/papers.md` lists its misprints. The step on
//! pieces is ours.

#![cfg_attr(not(feature = "std"), no_std)]
#![allow(clippy::module_inception, reason = "a folder's main file has the folder's name")]

#[cfg(feature = "alloc")]
extern crate alloc;

mod step_lengths;

mod global_parameter {
    pub(crate) mod curve_part;
    pub(crate) mod interpolator;
    pub mod predictor;
    pub mod secant;
    pub mod taylor;
}

mod pieces {
    pub(crate) mod alike;
    pub(crate) mod chord_step;
    pub(crate) mod joint;
    pub(crate) mod over_joints;
    pub(crate) mod piece_interpolator;
    pub(crate) mod place;
    pub(crate) mod section;
    pub(crate) mod state;
    pub(crate) mod terms;
    pub(crate) mod trend;
}

mod feed_override {
    pub(crate) mod feed_override;
    pub(crate) mod landing;
    pub(crate) mod overridden_step;
}

mod stream {
    mod bytes;
    pub(crate) mod crc32;
    pub(crate) mod error;
    pub(crate) mod header;
    pub(crate) mod layout;
    pub(crate) mod reader;
    mod rows;
    mod section_head;
    pub(crate) mod storage;
    pub(crate) mod stored_override;
    mod straight;
    #[cfg(feature = "std")]
    pub(crate) mod writer;
}

mod compiled {
    #[cfg(feature = "alloc")]
    pub(crate) mod compiled_path;
    #[cfg(feature = "std")]
    pub(crate) mod constant;
    #[cfg(feature = "alloc")]
    pub(crate) mod period_limits;
    pub(crate) mod position_checksum;
    pub(crate) mod table_layout;
}

#[cfg(feature = "alloc")]
pub use compiled::compiled_path::{CompiledPath, CompiledPathError};
#[cfg(feature = "std")]
pub use compiled::constant::{Constant, fixed_point_word, number_function, number_type};
#[cfg(feature = "alloc")]
pub use compiled::period_limits::PeriodLimits;
pub use compiled::position_checksum::PositionChecksum;
pub use compiled::table_layout::{TABLE_LAYOUT, TablesOf};
pub use feed_override::feed_override::{FeedOverride, OverrideLimits, OverrideState, Rate};
pub use feed_override::overridden_step::LANDING_REACH;
pub use feed_plan::StageShape;
pub use global_parameter::curve_part::CurvePart;
pub use global_parameter::interpolator::{Interpolator, Method, Setpoint, State};
pub use global_parameter::secant::{Outcome, Tolerance};
pub use global_parameter::{predictor, secant, taylor};
pub use pieces::alike::Course;
pub use pieces::chord_step::{BEHIND_JOINT, Chord, ChordBefore, ChordTolerance};
pub use pieces::piece_interpolator::PieceInterpolator;
pub use pieces::section::Section;
pub use pieces::state::{PieceSetpoint, PieceState};
#[cfg(feature = "alloc")]
pub use step_lengths::crossings;
pub use step_lengths::{Crossing, LengthCursor, LengthStage, StepLengths};
pub use stream::crc32::crc32;
pub use stream::error::StreamError;
pub use stream::header::StreamHeader;
pub use stream::layout::SECTION_HEAD_BYTES;
pub use stream::reader::StreamReader;
#[cfg(feature = "alloc")]
pub use stream::storage::SectionBuf;
pub use stream::storage::SectionStorage;
pub use stream::stored_override::StreamOverride;
#[cfg(feature = "std")]
pub use stream::writer::{NoStream, PathStream, StreamedRun};

/// The version of the kernels, major and minor. Constants that `feedbits compile` has written name theirs: with another version
/// they do not compile, because fields and their meaning may differ.
///
/// ```compile_fail
/// const _: () = assert!(matches!(secant_interp::VERSION, [99, 0]), "these constants are for secant-interp 99.0");
/// ```
pub const VERSION: [u16; 2] =
    [number_in(env!("CARGO_PKG_VERSION_MAJOR")), number_in(env!("CARGO_PKG_VERSION_MINOR"))];

/// The decimal number that a text is.
const fn number_in(digits: &str) -> u16 {
    let (digits, mut number, mut at) = (digits.as_bytes(), 0, 0);
    while at < digits.len() {
        number = 10 * number + (digits[at] - b'0') as u16;
        at += 1;
    }
    number
}
