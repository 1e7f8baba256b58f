//! A part of a curve as a curve of its own, for a run from stop to stop.

use nurbs_core::{Derivatives, Differentiate, Evaluate};
use real::Real;

/// The part of a curve between two parameters.
///
/// Behind an end that is not the end of the whole curve, the point stays where it is. So no chord reaches past a stop,
/// round the corner there or back from the cusp there, and a step that is longer than the remaining part lands on the
/// stop.
#[derive(Clone, Copy, Debug)]
pub struct CurvePart<R, C> {
    curve: C,
    begin: R,
    end: R,
    ends_with_curve: bool,
}

impl<R: Real, C> CurvePart<R, C> {
    /// The part between two parameters, which are put in order and into the curve's domain.
    #[must_use]
    pub fn new<const D: usize>(curve: C, begin: R, end: R) -> Self
    where
        C: Evaluate<R, D>,
    {
        let (first, last) = curve.domain();
        let begin = begin.max(first).min(last);
        let end = end.max(begin).min(last);
        Self { curve, begin, end, ends_with_curve: end >= last }
    }

    /// u, cut off at the end of the part unless that is the end of the whole curve.
    fn within(&self, u: R) -> R {
        if self.ends_with_curve { u } else { u.min(self.end) }
    }
}

impl<R: Real, C: Evaluate<R, D>, const D: usize> Evaluate<R, D> for CurvePart<R, C> {
    fn domain(&self) -> (R, R) {
        (self.begin, self.end)
    }

    fn point(&self, u: R) -> [R; D] {
        self.curve.point(self.within(u))
    }

    fn span_count(&self) -> usize {
        self.curve.span_count()
    }

    fn span_bounds(&self, span: usize) -> (R, R) {
        self.curve.span_bounds(span)
    }
}

impl<R: Real, C: Differentiate<R, D>, const D: usize> Differentiate<R, D> for CurvePart<R, C> {
    fn derivatives(&self, u: R) -> Derivatives<R, D> {
        self.curve.derivatives(self.within(u))
    }

    fn derivatives_in(&self, span: usize, u: R) -> Derivatives<R, D> {
        self.curve.derivatives_in(span, self.within(u))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use nurbs_core::NurbsCurve;

    #[test]
    fn a_part_stays_at_its_end_unless_that_is_the_curves() {
        let points = [[0.0, 0.0], [4.0, 0.0], [4.0, 3.0]];
        let curve = NurbsCurve::try_new_nonrational(1, &points, &[0.0, 0.0, 1.0, 2.0, 2.0]).unwrap();
        let first = CurvePart::new(curve, -1.0, 1.0);
        assert_eq!(
            (first.domain(), first.point(0.5), first.point(1.5)),
            ((0.0, 1.0), [2.0, 0.0], [4.0, 0.0])
        );
        let last = CurvePart::new(curve, 1.0, 7.0);
        assert_eq!((last.domain(), last.point(1.5), last.point(3.0)), ((1.0, 2.0), [4.0, 1.5], [4.0, 6.0]));
        assert_eq!(last.derivatives(1.0).first, [0.0, 3.0]);
        assert_eq!(CurvePart::new(curve, 1.5, 0.5).domain(), (1.5, 1.5));
    }
}
