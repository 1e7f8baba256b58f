//! `nurbs-core`: where is the curve, how fast does it pass, how sharply does it bend, and how long is it?
//!
//! It answers for NURBS curves in any number format: floats, fixed point, or a wrapper that watches either. It takes no
//! heap in real time, and has no `unwrap`, no `panic!` and no loop without a bound.
//!
//! | folder | answers | public names |
//! |---|---|---|
//! | | which functions does a curve offer to all the others? | [`Evaluate`], [`Differentiate`], [`Derivatives`] |
//! | `nurbs/` | which knots are valid, and in which span is u? (A2.1) | [`KnotVector`] |
//! | | what are the basis functions, whose sum in fixed point is exactly 1? (after A2.2) | [`basis_functions`] |
//! | | where is the curve? (points A3.1, A4.1; derivatives after A3.3, A4.2) | [`NurbsCurve`] |
//! | | which curve owns its numbers, converts to another format, and takes inserted knots? (A5.1) | [`NurbsBuf`] |
//! | `measure/` | how sharply does a curve bend? Curvature and radius, without cubes | [`curvature()`], [`curvature_vector`], [`radius`], all at once [`Frenet`] |
//! | | does its tangent break at a joint? | [`tangent_breaks`] |
//! | | how long is a curve, and at which parameter has it reached a given length? The quadrature rule behind both | [`arc_length()`], [`parameter_at`], [`GaussLegendre`] |
//! | `polynomials/` | how is a curve evaluated fastest in f64? One polynomial a span; basis functions where it would lose too many digits | [`PowerCurve`], [`FastCurve`] |
//! | | where is it in more digits than f64 has? One polynomial a span about its middle | [`CentredCurve`] |
//! | | which Bezier points has a span of it? | [`bezier_points`] |
//! | `pieces/` | which polynomials does real time evaluate? | [`Pieces`], made of [`Piece`]s |
//! | | how is a path cut into them, with proven ranges? | [`compile()`], [`PiecesBuf`] |
//! | `shapes/` | straight moves and circular arcs | [`Line`], [`Arc`] |
//! | | cubic trigonometric splines: the basis, a segment, a curve, polynomials with a proven error | [`trig_basis()`], [`TrigSegment`], [`TrigSpline`], [`TrigSplineBuf::to_polynomials`] |
//! | | a curve of any kind; conversion to NURBS | [`PathCurve`] |
//! | `fitting/` | which cubic curve passes given points, with accumulated chords as knots? | [`interpolate()`], [`chord_length_parameters`] |
//! | | how far, proven, is a part of a curve from a straight move? | [`distance_from_segment`] |
//! | `smoothing/` | which corners of moves can be cut or looped within a tolerance? | [`smooth_corners`] |
//! | | where is a function least on an interval? | [`golden_section()`] |
//!
//! A folder uses only those above it in the table. The numbers refer to algorithms in Piegl and Tiller, *The NURBS Book*,
//! 2nd ed. (1997).
//!
//! ```
//! use nurbs_core::{Differentiate, Evaluate, NurbsCurve, arc_length, radius};
//!
//! // A quarter circle of radius 10 mm: degree 2, three control points, the middle one of weight 1/√2.
//! let points = [[10.0, 0.0], [10.0, 10.0], [0.0, 10.0]];
//! let weights = [1.0, 0.5_f64.sqrt(), 1.0];
//! let knots = [0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
//! let curve = NurbsCurve::try_new(2, &points, &weights, &knots)?;
//!
//! let [x, y] = curve.point(0.5);
//! assert!((x - y).abs() < 1e-14 && (x * x + y * y - 100.0).abs() < 1e-13);
//! assert!((radius(&curve.derivatives(0.3)) - 10.0).abs() < 1e-13);
//!
//! let quarter = arc_length(&curve, 0.0, 1.0, 1e-12);
//! assert!((quarter.length - 5.0 * std::f64::consts::PI).abs() < 1e-12);
//! # Ok::<(), nurbs_core::CurveError>(())
//! ```
//!
//! | feature | for |
//! |---|---|
//! | `std` (default) | square roots of floats through std; implies `alloc` and `cubic` |
//! | `libm` | square roots of floats without std |
//! | `alloc` | types that own their numbers: [`NurbsBuf`], `polynomials/`, [`compile()`], [`PathCurve`], `fitting/`, `smoothing/`; without it no allocator is linked |
//! | `cubic` | points and derivatives of a cubic [`NurbsCurve`] in fewer instructions, for more code |
//! | `generate` | curves for tests: proptest strategies in `generate`, the curves of the papers in `golden` |

#![cfg_attr(not(any(test, feature = "std")), no_std)]
#![allow(clippy::module_inception, reason = "a folder's main file has the folder's name")]

#[cfg(feature = "alloc")]
extern crate alloc;

mod evaluate;
#[cfg(any(test, feature = "generate"))]
pub mod generate;
#[cfg(any(test, feature = "generate"))]
pub mod golden;
mod golden_section;
#[cfg(feature = "alloc")]
mod nelder_mead;
#[cfg(test)]
mod oracle;
mod vector;

mod nurbs {
    pub(crate) mod basis;
    pub(crate) mod curve;
    pub(crate) mod degree;
    mod derivatives;
    pub(crate) mod error;
    #[cfg(feature = "alloc")]
    mod knot_insertion;
    pub(crate) mod knots;
    #[cfg(feature = "alloc")]
    pub(crate) mod owned;
    pub(crate) mod span_numbers;
}

mod measure {
    pub(crate) mod arc_length;
    pub(crate) mod curvature;
    pub(crate) mod quadrature;
    pub(crate) mod tangent_break;
}

#[cfg(feature = "alloc")]
mod polynomials {
    pub(crate) mod bezier;
    pub(crate) mod centred_curve;
    pub(crate) mod fast_curve;
    pub(crate) mod polynomial;
    pub(crate) mod power_curve;
    mod span_table;
}

mod pieces {
    #[cfg(feature = "alloc")]
    pub(crate) mod compile;
    #[cfg(feature = "alloc")]
    pub(crate) mod compile_error;
    #[cfg(feature = "alloc")]
    pub(crate) mod cut;
    #[cfg(feature = "alloc")]
    pub(crate) mod cut_path;
    #[cfg(feature = "alloc")]
    mod hodograph;
    #[cfg(feature = "alloc")]
    mod local_piece;
    pub(crate) mod piece;
    pub(crate) mod pieces;
    #[cfg(feature = "alloc")]
    pub(crate) mod pieces_buf;
    #[cfg(feature = "alloc")]
    pub(crate) mod place;
    #[cfg(feature = "alloc")]
    pub(crate) mod ranges;
    pub(crate) mod right_shifts;
    #[cfg(feature = "alloc")]
    mod scales;
    pub(crate) mod shift;
    #[cfg(feature = "alloc")]
    mod speed;
}

mod shapes {
    #[cfg(feature = "alloc")]
    pub(crate) mod angle;
    pub(crate) mod arc;
    pub(crate) mod line;
    #[cfg(feature = "alloc")]
    pub(crate) mod path_curve;
    #[cfg(feature = "alloc")]
    mod rounded;
    pub(crate) mod shape_error;
    pub(crate) mod trig_basis;
    #[cfg(feature = "alloc")]
    pub(crate) mod trig_polynomial;
    pub(crate) mod trig_segment;
    pub(crate) mod trig_spline;
}

#[cfg(feature = "alloc")]
mod fitting {
    pub(crate) mod interpolation;
    pub(crate) mod segment_distance;
}

#[cfg(feature = "alloc")]
mod smoothing {
    pub(crate) mod corner;
    mod corner_segment;
    pub(crate) mod corner_shape;
    mod leg;
    pub(crate) mod smooth_path;
}

pub use evaluate::{Derivatives, Differentiate, Evaluate};
pub use golden_section::{Least, golden_section};
pub use measure::{
    arc_length::{ArcLength, ParameterSearch, arc_length, parameter_at},
    curvature::{Frenet, curvature, curvature_vector, radius},
    quadrature::GaussLegendre,
    tangent_break::tangent_breaks,
};
pub use nurbs::{
    basis::basis_functions,
    curve::NurbsCurve,
    degree::MAX_DEGREE,
    error::{CurveError, End, Quantity},
    knots::KnotVector,
};
pub use pieces::{
    piece::{Joint, ORIGIN_EXPONENT, Piece},
    pieces::{Coefficients, Pieces},
    right_shifts::RightShifts,
    shift::{Shifted, divide_by_weight, shift},
};
pub use shapes::{
    arc::{Arc, Sense},
    line::{Line, distance_to_segment, farthest_from_segment, nearest_on_segment},
    shape_error::ShapeError,
    trig_basis::{ShapeFactors, trig_basis, trig_basis_derivatives},
    trig_segment::TrigSegment,
    trig_spline::{Ends, TrigSpline},
};
#[cfg(feature = "alloc")]
pub use {
    fitting::{
        interpolation::{EndCondition, InterpolationError, chord_length_parameters, interpolate},
        segment_distance::distance_from_segment,
    },
    nurbs::owned::NurbsBuf,
    pieces::{
        compile::{compile, compile_with_stops},
        compile_error::CompileError,
        cut::PieceLimits,
        cut_path::CutPath,
        pieces_buf::PiecesBuf,
        place::Place,
        ranges::SignalBound,
    },
    polynomials::{
        bezier::bezier_points,
        centred_curve::CentredCurve,
        fast_curve::{FastCurve, FastLine},
        power_curve::{PowerCursor, PowerCurve},
    },
    shapes::{path_curve::PathCurve, trig_polynomial::TrigPolynomials, trig_spline::TrigSplineBuf},
    smoothing::{
        corner::{Corner, CornerOutcome, CornerStyle, Reason, Turn},
        corner_shape::{CornerLambda, MOST_CORNER_LAMBDA},
        smooth_path::{SmoothPath, smooth_corners},
    },
};
