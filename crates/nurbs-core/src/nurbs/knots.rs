//! Knot vectors: `u_0 ≤ u_1 ≤ … ≤ u_{n+p+1}` for degree p and control points `P_0 … P_n`.
//!
//! A knot vector here is clamped: the first and the last knot occur exactly p + 1 times, so that the curve begins in
//! `P_0` and ends in `P_n`. An inner knot of multiplicity m leaves p - m continuous derivatives. A knot of m = p is a
//! corner; m = p + 1 would be a jump and is refused.

use real::Real;

use crate::nurbs::degree::CUBIC;
use crate::{CurveError, End, MAX_DEGREE, Quantity};

/// A valid, clamped knot vector, borrowed.
#[derive(Clone, Copy, Debug)]
pub struct KnotVector<'a, R> {
    knots: &'a [R],
    /// The knots that are at neither end, `u_{p+1} … u_n`.
    inner: &'a [R],
    degree: usize,
    span_count: usize,
    /// The knot index of each span, if the owner of the knots has such a table.
    spans: &'a [usize],
}

/// Two knot vectors are equal if their degrees and knots are equal, whoever owns the knots.
impl<R: PartialEq> PartialEq for KnotVector<'_, R> {
    fn eq(&self, other: &Self) -> bool {
        self.degree == other.degree && self.knots == other.knots
    }
}

impl<'a, R: Real> KnotVector<'a, R> {
    /// Checks the knots of a curve of `degree` with `point_count` control points.
    ///
    /// # Errors
    /// The first of these that fails: degree within `1 ..= MAX_DEGREE`; at least degree + 1 points; points + degree + 1
    /// knots; all knots finite; no knot less than the one before; a domain that is not empty and whose width fits the
    /// format; ends of multiplicity degree + 1; inner knots of multiplicity at most degree.
    pub fn try_new(degree: usize, point_count: usize, knots: &'a [R]) -> Result<Self, CurveError> {
        if !(1..=MAX_DEGREE).contains(&degree) {
            return Err(CurveError::DegreeOutOfRange { degree });
        }
        let order = degree + 1;
        if point_count < order {
            return Err(CurveError::TooFewControlPoints { least: order, found: point_count });
        }
        let expected = point_count.saturating_add(order);
        if knots.len() != expected {
            return Err(CurveError::WrongKnotCount { expected, found: knots.len() });
        }
        if let Some(index) = knots.iter().position(|u| !u.is_finite()) {
            return Err(CurveError::NotFinite { what: Quantity::Knot, index });
        }
        if let Some(before) = knots.windows(2).position(|pair| pair[1] < pair[0]) {
            return Err(CurveError::KnotsDecrease { index: before + 1 });
        }
        let (first, last) = (knots[0], knots[expected - 1]);
        if first == last {
            return Err(CurveError::EmptyDomain);
        }
        // The knots are in order, so a difference that is not positive has wrapped.
        let width = last - first;
        if !(width.is_finite() && width > R::zero()) {
            return Err(CurveError::DomainTooWide);
        }
        let count_of = |u| multiplicity(knots, u);
        for (end, u) in [(End::First, first), (End::Last, last)] {
            if count_of(u) != order {
                return Err(CurveError::NotClamped { end, expected: order, multiplicity: count_of(u) });
            }
        }
        let inner = &knots[order..point_count];
        let mut index = order;
        for equal in inner.chunk_by(|a, b| a == b) {
            if equal.len() > degree {
                return Err(CurveError::MultiplicityTooHigh { index, multiplicity: equal.len(), degree });
            }
            index += equal.len();
        }
        let span_count = knots.windows(2).filter(|pair| pair[0] < pair[1]).count();
        Ok(Self { knots, inner, degree, span_count, spans: &[] })
    }

    /// A knot vector that [`try_new`](Self::try_new) has found valid, with the number of its spans and their
    /// [`repeated_spans`](Self::repeated_spans).
    #[cfg(feature = "alloc")]
    pub(crate) fn from_valid(degree: usize, knots: &'a [R], span_count: usize, spans: &'a [usize]) -> Self {
        let order = degree + 1;
        let inner = knots.get(order..knots.len().saturating_sub(order)).unwrap_or_default();
        Self { knots, inner, degree, span_count, spans }
    }

    /// The knot index of each span, if an inner knot is repeated; otherwise [`span_index`](Self::span_index) needs no
    /// table.
    #[cfg(feature = "alloc")]
    pub(crate) fn repeated_spans(&self) -> alloc::vec::Vec<usize> {
        let spans = || self.starts().take(if self.is_simple() { 0 } else { self.span_count });
        spans().collect()
    }

    /// Whether every inner knot occurs once.
    fn is_simple(&self) -> bool {
        self.span_count == self.point_count() - self.degree
    }

    /// The knot index of each span, in order.
    fn starts(&self) -> impl Iterator<Item = usize> {
        (self.degree..self.point_count()).filter(|&i| self.knots[i] < self.knots[i + 1])
    }

    /// The degree p.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// The knots, `u_0 … u_{n+p+1}`.
    #[must_use]
    pub fn as_slice(&self) -> &'a [R] {
        self.knots
    }

    /// Number of control points, n + 1.
    #[must_use]
    pub fn point_count(&self) -> usize {
        self.knots.len() - self.degree - 1
    }

    /// First and last parameter, `u_p` and `u_{n+1}`.
    #[must_use]
    pub fn domain(&self) -> (R, R) {
        // Clamped: the outer knots are those of the ends.
        let end = |knot: Option<&R>| knot.copied().unwrap_or_else(R::zero);
        (end(self.knots.first()), end(self.knots.last()))
    }

    /// The index i with `u_i ≤ u < u_{i+1}`, by binary search; the span is never empty.
    ///
    /// The last span is closed on the right. The function is total: a `u` before the domain or NaN gives the first
    /// span, a `u` after the domain the last.
    ///
    /// # Source
    /// Piegl and Tiller, *The NURBS Book*, 2nd ed. (1997), algorithm A2.1, which requires `u` inside the domain.
    #[must_use]
    pub fn find_span(&self, u: R) -> usize {
        // Each inner knot that is not above u moves the span on by one.
        self.degree + self.inner.partition_point(|knot| *knot <= u)
    }

    /// The multiplicity of the knot `u`: 0 if u is not a knot.
    #[must_use]
    pub fn multiplicity(&self, u: R) -> usize {
        multiplicity(self.knots, u)
    }

    /// Number of spans that are not empty.
    #[must_use]
    pub fn span_count(&self) -> usize {
        self.span_count
    }

    /// The knot index at which the non-empty span number `span` begins; a larger number gives the last span.
    ///
    /// Each takes the same time, with one exception: if an inner knot is repeated and the knots are borrowed, it takes
    /// a walk over the knots. `NurbsBuf` keeps a table in that case.
    #[must_use]
    pub fn span_index(&self, span: usize) -> usize {
        let last = self.point_count() - 1;
        if self.is_simple() {
            return (self.degree + span.min(self.span_count - 1)).min(last);
        }
        let found =
            if self.spans.is_empty() { self.starts().nth(span) } else { self.spans.get(span).copied() };
        found.unwrap_or(last)
    }

    /// The number of the non-empty span that [`find_span`](Self::find_span) finds for `u`, at the same cost as
    /// [`span_index`](Self::span_index).
    #[must_use]
    pub fn span_number(&self, u: R) -> usize {
        let index = self.find_span(u);
        if self.is_simple() {
            index - self.degree
        } else if self.spans.is_empty() {
            self.starts().take_while(|start| *start < index).count()
        } else {
            self.spans.partition_point(|start| *start < index)
        }
    }

    /// First and last parameter of the non-empty span number `span`; a larger number gives the last span.
    #[must_use]
    pub fn span_bounds(&self, span: usize) -> (R, R) {
        let index = self.span_index(span);
        (self.knots[index], self.knots[index + 1])
    }

    /// The knots that matter in the span at knot index `span`; an index below p counts as p, one above n as n.
    #[inline(always)]
    pub(crate) fn around(&self, span: usize) -> LocalKnots<'a, R> {
        let span = span.min(self.point_count() - 1).max(self.degree);
        let first = span + 1 - self.degree;
        // A vector that was found valid has this range.
        LocalKnots(self.knots.get(first..first + 2 * self.degree).unwrap_or_default())
    }

    /// The same of a cubic, so that the compiler knows their number; `None` for an index below 3 or above n.
    #[inline(always)]
    pub(crate) fn around_cubic(&self, span: usize) -> Option<LocalKnots<'a, R>> {
        window::<{ 2 * CUBIC }, _>(self.knots, (span + 1).checked_sub(CUBIC)?).map(LocalKnots)
    }
}

/// `u_{i-p+1} … u_{i+p}`, the 2p knots on which the basis functions in span i depend.
#[derive(Clone, Copy)]
pub(crate) struct LocalKnots<'a, R>(&'a [R]);

impl<R: Real> LocalKnots<'_, R> {
    /// The degree p.
    #[inline(always)]
    pub(crate) fn degree(&self) -> usize {
        self.0.len() / 2
    }

    /// The pairs `(u_{i-q+1+r}, u_{i+1+r})`, r = 0 … q-1: the supports, in span i, of the q basis functions of
    /// degree q - 1. No pair is empty when span i is not. `q ≤ p`.
    #[inline(always)]
    pub(crate) fn supports(&self, q: usize) -> impl Iterator<Item = (R, R)> {
        let p = self.degree();
        let left = self.0.get(p.saturating_sub(q)..p).unwrap_or_default();
        let right = self.0.get(p..).unwrap_or_default();
        left.iter().copied().zip(right.iter().copied())
    }
}

/// The `N` items from `first` on, so that the compiler knows their number. Of a range that is given by its begin alone
/// only the end is compared with the length of `items`.
#[inline(always)]
pub(crate) fn window<const N: usize, T>(items: &[T], first: usize) -> Option<&[T]> {
    let window: &[T; N] = items.get(first..first + N)?.as_array()?;
    Some(window)
}

/// How many of the sorted `knots` equal `u`.
fn multiplicity<R: Real>(knots: &[R], u: R) -> usize {
    knots.partition_point(|knot| *knot <= u) - knots.partition_point(|knot| *knot < u)
}

#[cfg(test)]
mod tests {
    use super::*;
    use real::{Backend, I4F4, I16F16};

    const CUBIC: [f64; 11] = [0., 0., 0., 0., 0.25, 0.5, 0.5, 1., 1., 1., 1.];

    fn cubic() -> KnotVector<'static, f64> {
        KnotVector::try_new(3, 7, &CUBIC).unwrap()
    }

    #[test]
    fn a_span_begins_at_its_knot_and_the_last_one_is_closed() {
        let knots = cubic();
        for (u, span) in [(0.0, 3), (0.2, 3), (0.25, 4), (0.499, 4), (0.5, 6), (0.9, 6), (1.0, 6)] {
            assert_eq!(knots.find_span(u), span, "u={u}");
        }
    }

    #[test]
    fn find_span_is_total() {
        let knots = cubic();
        assert_eq!(knots.find_span(-1.0), 3);
        assert_eq!(knots.find_span(f64::NAN), 3);
        assert_eq!(knots.find_span(f64::NEG_INFINITY), 3);
        assert_eq!(knots.find_span(2.0), 6);
        assert_eq!(knots.find_span(f64::INFINITY), 6);
    }

    #[test]
    fn spans_are_numbered_without_the_empty_ones() {
        let knots = cubic();
        assert_eq!(knots.span_count(), 3);
        assert_eq!([0, 1, 2, 3, 99].map(|span| knots.span_index(span)), [3, 4, 6, 6, 6]);
        assert_eq!(knots.span_bounds(2), (0.5, 1.0));
        assert_eq!(knots.domain(), (0.0, 1.0));
        let simple = KnotVector::try_new(2, 5, &[0., 0., 0., 1., 2., 3., 3., 3.]).unwrap();
        assert_eq!([0, 1, 2, 3].map(|span| simple.span_index(span)), [2, 3, 4, 4]);
    }

    #[test]
    fn a_table_of_spans_says_the_same() {
        let (borrowed, simple) = (cubic(), KnotVector::try_new(1, 3, &[0., 0., 1., 2., 2.]).unwrap());
        let spans = borrowed.repeated_spans();
        assert_eq!((spans.as_slice(), simple.repeated_spans().len()), ([3, 4, 6].as_slice(), 0));
        let owned = KnotVector::from_valid(3, borrowed.as_slice(), 3, &spans);
        assert_eq!(owned, borrowed);
        for span in [0, 1, 2, 3, 99] {
            assert_eq!(owned.span_index(span), borrowed.span_index(span));
        }
        for (u, span) in [(-1.0, 0), (0.0, 0), (0.25, 1), (0.499, 1), (0.5, 2), (1.0, 2), (9.0, 2)] {
            assert_eq!((owned.span_number(u), borrowed.span_number(u)), (span, span), "u={u}");
        }
        assert_eq!([0.5, 1.0, 2.0].map(|u| simple.span_number(u)), [0, 1, 1]);
    }

    #[test]
    fn multiplicities_are_counted() {
        assert_eq!([0.0, 0.25, 0.3, 0.5, 1.0].map(|u| cubic().multiplicity(u)), [4, 1, 0, 2, 4]);
    }

    #[test]
    fn each_violated_relation_has_its_error() {
        let check = |degree, points, knots: &[f64]| KnotVector::try_new(degree, points, knots).unwrap_err();
        assert_eq!(check(0, 2, &[0., 1.]), CurveError::DegreeOutOfRange { degree: 0 });
        assert_eq!(check(10, 11, &[0.; 22]), CurveError::DegreeOutOfRange { degree: 10 });
        assert_eq!(check(2, 2, &[0.; 5]), CurveError::TooFewControlPoints { least: 3, found: 2 });
        assert_eq!(check(1, 2, &[0., 0., 1.]), CurveError::WrongKnotCount { expected: 4, found: 3 });
        assert_eq!(check(1, usize::MAX, &[]), CurveError::WrongKnotCount { expected: usize::MAX, found: 0 });
        assert_eq!(
            check(1, 2, &[0., 0., f64::NAN, 1.]),
            CurveError::NotFinite { what: Quantity::Knot, index: 2 }
        );
        assert_eq!(check(1, 3, &[0., 0., 2., 1., 1.]), CurveError::KnotsDecrease { index: 3 });
        assert_eq!(check(1, 2, &[1.; 4]), CurveError::EmptyDomain);
        assert_eq!(check(1, 2, &[f64::MIN, f64::MIN, f64::MAX, f64::MAX]), CurveError::DomainTooWide);
        assert_eq!(
            check(2, 3, &[0., 0., 0.5, 1., 1., 1.]),
            CurveError::NotClamped { end: End::First, expected: 3, multiplicity: 2 }
        );
        assert_eq!(
            check(1, 3, &[0., 0., 1., 1., 1.]),
            CurveError::NotClamped { end: End::Last, expected: 2, multiplicity: 3 }
        );
        assert_eq!(
            check(1, 5, &[0., 0., 1., 2., 2., 3., 3.]),
            CurveError::MultiplicityTooHigh { index: 3, multiplicity: 2, degree: 1 }
        );
    }

    #[test]
    fn a_domain_wider_than_a_fixed_format_is_refused() {
        let wide = [-8.0, -8.0, 7.0, 7.0].map(|u| I4F4::from_f64(u).unwrap());
        assert_eq!(KnotVector::try_new(1, 2, &wide), Err(CurveError::DomainTooWide));
        let knots = wide.map(|u| I16F16::from_f64(u.to_f64()).unwrap());
        assert!(KnotVector::try_new(1, 2, &knots).is_ok());
    }
}
