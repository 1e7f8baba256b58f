//! `stress`: random paths and limits, and promises that every step on them must keep.
//!
//! | question | answer |
//! |---|---|
//! | which path, within which limits? | [`RandomPath`], made from bytes of a fuzzer, a property test or a seeded generator |
//! | which numbers, valid or not? | [`any_curve`], [`any_number`] |
//! | which path of a name? | [`paper_a`], [`ten_points`], [`lines`]; others are made by [`curves_at`] |
//! | what does the plan promise? | [`PlannedPath`], [`PlannedPath::check`] |
//! | what does each step on pieces promise? | [`OnPieces`] |
//! | what does each step on the global parameter promise? | [`OnCurve`] |
//! | are pieces the curve that they were compiled from? | [`check_pieces`] |
//! | does a fixed format follow a float? | [`check_against_float`] |
//! | does all of that hold for a hundred million periods? | [`soak_path`], [`Soak`] |
//! | what is the largest number of operations of a step? | [`StepBound::of`] |
//!
//! A broken promise is a [`Violation`]; a refused path is not.

mod generate;
mod named_paths;
mod next_setpoint;
mod on_curve;
mod on_pieces;
mod piece_points;
mod planned_path;
mod side_by_side;
mod soak;
mod split_mix;
mod step_bound;
mod violation;

pub use generate::{RandomPath, any_curve, any_number};
pub use kernel_oracle::Violation;
pub use named_paths::{bezier, curves_at, lines, paper_a, passing, polyline, ten_points};
pub use on_curve::{CurveFigures, OnCurve};
pub use on_pieces::{OnPieces, PieceFigures};
pub use piece_points::check_pieces;
pub use planned_path::PlannedPath;
pub use side_by_side::{SideBySide, check_against_float};
pub use soak::{
    SOAK_FORMATS, Soak, SoakFormat, SoakPaths, SoakViolation, Soaked, SoakedPath, SoakedRun, soak_path,
};
pub use split_mix::SplitMix64;
pub use step_bound::{StepBound, StepShape};
pub use violation::Outcome;
