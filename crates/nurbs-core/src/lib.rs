//! `nurbs-core`: where is the curve and how fast does it pass?
//!
//! Answered for NURBS curves in any number format: floats, fixed point, or a wrapper that watches either. No heap, no
//! panic, no loop without a bound.
//!
//! | algorithm | where |
//! |---|---|
//! | knot vectors, the span of a parameter (A2.1) | [`KnotVector`] |
//! | basis functions that sum to exactly 1 in fixed point (after A2.2) | [`basis_functions`] |
//! | points (A3.1, A4.1) | [`NurbsCurve`], [`Evaluate`] |
//! | first and second derivatives (after A3.3, A4.2) | [`Differentiate`] |
#![cfg_attr(
    feature = "alloc",
    doc = "| curves that own their numbers; conversion to another format | [`NurbsBuf`] |"
)]
#![cfg_attr(feature = "alloc", doc = "| knot insertion (A5.1) | [`NurbsBuf::insert_knot`] |")]
#![cfg_attr(any(test, feature = "generate"), doc = "| random valid curves for tests | [`generate`] |")]
//!
//! The numbers refer to algorithms in Piegl and Tiller, *The NURBS Book*, 2nd ed. (1997).
//!
//! | feature | for |
//! |---|---|
//! | `std` (default) | square roots of floats through std; implies `alloc` |
//! | `libm` | square roots of floats without std |
//! | `alloc` | owned curves, conversion, knot insertion |
//! | `generate` | proptest strategies |

#![cfg_attr(not(any(test, feature = "std")), no_std)]

#[cfg(feature = "alloc")]
extern crate alloc;

mod basis;
mod curve;
mod derivatives;
mod error;
mod evaluate;
#[cfg(any(test, feature = "generate"))]
pub mod generate;
#[cfg(test)]
mod golden;
#[cfg(feature = "alloc")]
mod knot_insertion;
mod knots;
#[cfg(test)]
mod oracle;
#[cfg(feature = "alloc")]
mod owned;

pub use basis::basis_functions;
pub use curve::NurbsCurve;
pub use error::{CurveError, End, Quantity};
pub use evaluate::{Derivatives, Differentiate, Evaluate};
pub use knots::{KnotVector, MAX_DEGREE};
#[cfg(feature = "alloc")]
pub use owned::NurbsBuf;

use basis::BasisRows;
