//! `secant-interp`: real time. A curve and a schedule go in, one setpoint per interpolation period comes out.
//!
//! Each period wants a chord of a given length; sought is the parameter at which the curve has moved that far.
//! | algorithm | where |
//! |---|---|
//! | the period loop, landing on the end | [`Interpolator`] |
//! | safeguarded secant iteration | [`secant`] |
//! | start values (6) and (7) | [`predictor`] |
//! | Taylor expansions of first and second order | [`taylor`] |
//! | the period loop on compiled pieces | [`PieceInterpolator`] |
//! | the same by chords that are given, not planned | [`PieceInterpolator::step_by`] |
//! | many runs of it at once, with the feature `lanes` | `LaneInterpolator` |
//! | one chord on a piece, without division | [`Chord`] |
//! | the distance of each period | [`StepLengths`] |
//! | a run that lands on each stop on the way | [`CompiledPath::runs`], [`PieceInterpolator::on`] |
//! | feed override and feed hold while a plan runs | [`FeedOverride`] |
#![cfg_attr(
    feature = "alloc",
    doc = "| path and plan together, ready to run; with an example from curve to setpoints | [`CompiledPath`] |"
)]
//! | a run as constants for flash, with the feature `std`; whether a controller makes the same | `Constant`, [`PositionChecksum`] |
//!
//! A step takes no heap, cannot panic and has no loop without a bound; everything is generic over [`real::Real`].
//!
//! | feature | for |
//! |---|---|
//! | `std` (default) | square roots of floats through std; implies `alloc` and `cubic` |
//! | `libm` | square roots of floats without std |
//! | `alloc` | `CompiledPath`: path and plan compiled where they are run; without it no allocator is linked |
//! | `cubic` | a step on cubics that takes up to 40 % fewer instructions and more flash |
//! | `lanes` | simulations on a large machine |
//!
//! # Source
//! *Paper A*: Wang Y., Gai R., Sun Y., Yang D., Han J., "NURBS interpolation algorithm for high-quality machining" (received 2012), in
//! Chinese: the step on the global parameter. What it misprints is in `docs/papers.md`. The step on pieces is ours.

#![cfg_attr(not(feature = "std"), no_std)]

#[cfg(feature = "alloc")]
extern crate alloc;

mod chord_step;
#[cfg(feature = "alloc")]
mod compiled_path;
#[cfg(feature = "std")]
mod constant;
mod curve_part;
mod feed_override;
mod interpolator;
mod joint;
mod landing;
#[cfg(feature = "lanes")]
mod lanes;
mod overridden_step;
mod piece_interpolator;
mod position_checksum;
pub mod predictor;
pub mod secant;
mod section;
mod step_lengths;
pub mod taylor;
mod trend;

pub use chord_step::{Chord, ChordTolerance};
#[cfg(feature = "alloc")]
pub use compiled_path::{CompiledPath, CompiledPathError};
#[cfg(feature = "std")]
pub use constant::{Constant, number_function, number_type};
pub use curve_part::CurvePart;
pub use feed_override::{FeedOverride, OverrideLimits, OverrideState, Rate};
pub use feed_plan::StageShape;
pub use interpolator::{Interpolator, Method, Setpoint, State};
#[cfg(feature = "lanes")]
pub use lanes::LaneInterpolator;
pub use piece_interpolator::{PieceInterpolator, PieceSetpoint, PieceState};
pub use position_checksum::PositionChecksum;
pub use secant::{Outcome, Tolerance};
pub use section::Section;
pub use step_lengths::{LengthCursor, LengthStage, StepLengths};
