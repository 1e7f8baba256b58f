//! `nurbs-core`: where is the curve, how fast does it pass, how sharply does it bend, and how long is it?
//!
//! Answered for NURBS curves in any number format: floats, fixed point, or a wrapper that watches either. No heap, no
//! `unwrap` or `panic!`, no loop without a bound.
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
//! | algorithm | where |
//! |---|---|
//! | knot vectors, the span of a parameter (A2.1) | [`KnotVector`] |
//! | basis functions that sum to exactly 1 in fixed point (after A2.2) | [`basis_functions`] |
//! | points (A3.1, A4.1) | [`NurbsCurve`], [`Evaluate`] |
//! | first and second derivatives (after A3.3, A4.2) | [`Differentiate`] |
//! | curvature and radius, without cubes | [`curvature()`], [`curvature_vector`], [`radius`], all at once [`Frenet`] |
//! | arc length and its inverse, and the rule behind them | [`arc_length()`], [`parameter_at`], [`GaussLegendre`] |
//! | compiled pieces: what real time evaluates | [`Pieces`] |
//! | straight moves, circular arcs | [`Line`], [`Arc`] |
//! | cubic trigonometric splines: the basis, a segment, a curve | [`trig_basis()`], [`TrigSegment`], [`TrigSpline`] |
#![cfg_attr(feature = "alloc", doc = "| cutting a path into pieces, with proven ranges | [`compile()`] |")]
#![cfg_attr(
    feature = "alloc",
    doc = "| one polynomial a span, in f64: the fastest points and derivatives | [`PowerCurve`], where accurate [`FastCurve`] |"
)]
#![cfg_attr(
    feature = "alloc",
    doc = "| curves that own their numbers; conversion to another format | [`NurbsBuf`] |"
)]
#![cfg_attr(feature = "alloc", doc = "| a curve of any kind; conversion to NURBS | [`PathCurve`] |")]
#![cfg_attr(
    feature = "alloc",
    doc = "| trigonometric splines as polynomials, with a proven error | [`TrigSplineBuf::to_polynomials`] |"
)]
#![cfg_attr(
    feature = "alloc",
    doc = "| corners of straight moves and arcs: cut or looped, within a tolerance | [`smooth_corners`] |"
)]
#![cfg_attr(feature = "alloc", doc = "| knot insertion (A5.1) | [`NurbsBuf::insert_knot`] |")]
//! | whether the tangent breaks at a joint | [`tangent_breaks`] |
//! | the least value on an interval | [`golden_section()`] |
#![cfg_attr(
    any(test, feature = "generate"),
    doc = "| curves for tests: random ones, those of the papers | [`generate`], [`golden`] |"
)]
//!
//! The numbers refer to algorithms in Piegl and Tiller, *The NURBS Book*, 2nd ed. (1997).
//!
//! | feature | for |
//! |---|---|
//! | `std` (default) | square roots of floats through std; implies `alloc` |
//! | `libm` | square roots of floats without std |
//! | `alloc` | what owns its numbers: curves, compiling, smoothing; without it no allocator is linked |
//! | `generate` | proptest strategies |

#![cfg_attr(not(any(test, feature = "std")), no_std)]

#[cfg(feature = "alloc")]
extern crate alloc;

mod arc;
mod arc_length;
mod basis;
#[cfg(feature = "alloc")]
mod bezier;
#[cfg(feature = "alloc")]
mod compile;
#[cfg(feature = "alloc")]
mod corner;
#[cfg(feature = "alloc")]
mod corner_segment;
mod curvature;
mod curve;
mod derivatives;
mod error;
mod evaluate;
#[cfg(feature = "alloc")]
mod fast_curve;
#[cfg(any(test, feature = "generate"))]
pub mod generate;
#[cfg(any(test, feature = "generate"))]
pub mod golden;
mod golden_section;
#[cfg(feature = "alloc")]
mod hodograph;
#[cfg(feature = "alloc")]
mod knot_insertion;
mod knots;
#[cfg(feature = "alloc")]
mod leg;
mod line;
#[cfg(feature = "alloc")]
mod local_piece;
#[cfg(test)]
mod oracle;
#[cfg(feature = "alloc")]
mod owned;
#[cfg(feature = "alloc")]
mod path_curve;
mod pieces;
#[cfg(feature = "alloc")]
mod polynomial;
#[cfg(feature = "alloc")]
mod power_curve;
mod quadrature;
#[cfg(feature = "alloc")]
mod ranges;
mod shape_error;
#[cfg(feature = "alloc")]
mod smooth_path;
mod tangent_break;
mod trig_basis;
#[cfg(feature = "alloc")]
mod trig_polynomial;
mod trig_spline;

pub use arc::{Arc, Sense};
pub use arc_length::{ArcLength, ParameterSearch, arc_length, parameter_at};
pub use basis::basis_functions;
#[cfg(feature = "alloc")]
pub use compile::{CompileError, PieceLimits, PiecesBuf, Place, compile, compile_with_stops};
#[cfg(feature = "alloc")]
pub use corner::{Corner, CornerOutcome, CornerStyle, Reason, Turn};
pub use curvature::{Frenet, curvature, curvature_vector, radius};
pub use curve::NurbsCurve;
pub use error::{CurveError, End, Quantity};
pub use evaluate::{Derivatives, Differentiate, Evaluate};
#[cfg(feature = "alloc")]
pub use fast_curve::FastCurve;
pub use golden_section::{Least, golden_section};
pub use knots::{KnotVector, MAX_DEGREE};
pub use line::{Line, distance_to_segment, nearest_on_segment};
#[cfg(feature = "alloc")]
pub use owned::NurbsBuf;
#[cfg(feature = "alloc")]
pub use path_curve::PathCurve;
pub use pieces::{LONGEST_ROUND_CORNER, ORIGIN_EXPONENT, Piece, Pieces, Shifted, shift};
#[cfg(feature = "alloc")]
pub use power_curve::{PowerCursor, PowerCurve};
pub use quadrature::GaussLegendre;
#[cfg(feature = "alloc")]
pub use ranges::SignalBound;
pub use shape_error::ShapeError;
#[cfg(feature = "alloc")]
pub use smooth_path::{SmoothPath, smooth_corners};
pub use tangent_break::tangent_breaks;
pub use trig_basis::{ShapeFactors, trig_basis, trig_basis_derivatives};
#[cfg(feature = "alloc")]
pub use trig_polynomial::TrigPolynomials;
#[cfg(feature = "alloc")]
pub use trig_spline::TrigSplineBuf;
pub use trig_spline::{Ends, TrigSegment, TrigSpline};

use basis::BasisRows;
