//! The functions of a curve that planning and interpolation call.

use real::Real;

/// A curve that can be evaluated: `u ↦ C(u)`, made of spans within which it is smooth.
pub trait Evaluate<R: Real, const D: usize> {
    /// First and last parameter of the curve.
    fn domain(&self) -> (R, R);

    /// The point `C(u)`, in the unit of the control points.
    ///
    /// Beyond either end the outer span is extrapolated: a solver may try a parameter past the end.
    fn point(&self, u: R) -> [R; D];

    /// Number of spans of nonzero length.
    fn span_count(&self) -> usize;

    /// First and last parameter of span `span`, `0 ≤ span < span_count()`; a larger index gives the last span.
    fn span_bounds(&self, span: usize) -> (R, R);
}

/// A curve with first and second derivatives with respect to its parameter.
pub trait Differentiate<R: Real, const D: usize>: Evaluate<R, D> {
    /// Point and derivatives at `u`. At a joint of two spans they are those of the span that begins there.
    fn derivatives(&self, u: R) -> Derivatives<R, D>;

    /// Point and derivatives at `u` of the function that describes span `span`. At the span's own ends the derivatives
    /// are one-sided.
    fn derivatives_in(&self, span: usize, u: R) -> Derivatives<R, D>;

    /// Whether span `span` is known to be a straight line with `C'` constant. Without knowledge of the curve's form:
    /// `false`.
    fn is_line(&self, span: usize) -> bool {
        let _ = span;
        false
    }
}

/// `C(u)`, `C'(u)` and `C''(u)`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Derivatives<R, const D: usize> {
    /// The point `C(u)`.
    pub point: [R; D],
    /// The first derivative `C'(u)`.
    pub first: [R; D],
    /// The second derivative `C''(u)`.
    pub second: [R; D],
}

impl<R: Real, const D: usize> Default for Derivatives<R, D> {
    /// The derivatives of a curve that is a single point, the origin.
    fn default() -> Self {
        let zero = [R::zero(); D];
        Self { point: zero, first: zero, second: zero }
    }
}
