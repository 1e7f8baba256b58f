//! The basis functions: row by row through the triangle of degrees.
//!
//! In span i, `u_i ≤ u < u_{i+1}`, only the p + 1 functions `N_{i-p,p} … N_{i,p}` are not zero. They follow from
//! the single `N_{i,0} = 1` by raising the degree p times. With
//!
//! `α_{k,q}(u) = (u - u_k) / (u_{k+q} - u_k)`, the recurrence of Cox and de Boor is
//!
//! `N_{k,q} = α_{k,q} N_{k,q-1} + (1 - α_{k+1,q}) N_{k+1,q-1}`.
//!
//! Read from the side of the lower degree, each `N_{k,q-1}` is divided between two functions: the part α goes to
//! `N_{k,q}`, the rest to `N_{k-1,q}`. [`raise_degree`] computes the smaller part as a product and subtracts it for the
//! other. So
//!
//! - there is one division per pair, as in algorithm A2.2, but of numbers whose quotient is in [0, 1]. A2.2 divides a
//!   basis function by the width of a span, which overflows a fixed-point format where knots are close;
//! - in fixed point the functions sum to exactly 1, and each is exactly 0 or 1 at a clamped end;
//! - in floating point each function is relatively accurate, however small, as no two numbers cancel.
//!
//! # Source
//! Piegl and Tiller, *The NURBS Book*, 2nd ed. (1997), equation 2.5 and algorithm A2.2.

use real::Real;

use crate::nurbs::degree::SCRATCH;
use crate::nurbs::knots::LocalKnots;
use crate::{KnotVector, MAX_DEGREE};

/// The basis functions `N_{i-p,p}(u) … N_{i,p}(u)` in the span at knot index `span` = i; the rest of the array is 0.
///
/// `u` may lie outside the span: the span's polynomials are then extrapolated. An index below p counts as p, the first
/// span, and one above n as n, the last. An empty span, between equal knots, has no basis functions: with 0/0 = 0 the
/// recurrence gives numbers that sum to 1 and belong to no point of the curve.
///
/// Accuracy, `u` inside the span: fixed point, each function is within `p(p+1)` units of the last place and the sum
/// is exactly 1; floating point, each function is within a relative `4p` units.
#[must_use]
pub fn basis_functions<R: Real>(knots: &KnotVector<'_, R>, span: usize, u: R) -> [R; MAX_DEGREE + 1] {
    let knots = knots.around(span);
    let mut functions = of_degree_0();
    for degree in 1..=knots.degree() {
        raise_degree(&mut functions, knots, degree, u, quotient);
    }
    functions
}

/// The basis functions that a curve's point and first two derivatives need.
pub(crate) struct BasisRows<R> {
    /// `N_{i-p,p} … N_{i,p}`.
    pub(crate) degree_p: [R; SCRATCH],
    /// `N_{i-p+1,p-1} … N_{i,p-1}`.
    pub(crate) one_lower: [R; SCRATCH],
    /// `N_{i-p+2,p-2} … N_{i,p-2}`; all 0 for p = 1.
    pub(crate) two_lower: [R; SCRATCH],
}

impl<R: Real> BasisRows<R> {
    /// Those in a span that is not empty.
    #[inline(always)] // Rows that the caller does not read are then not copied.
    pub(crate) fn new(knots: LocalKnots<'_, R>, u: R) -> Self {
        let zeros = [R::zero(); SCRATCH];
        let mut rows = Self { degree_p: of_degree_0(), one_lower: zeros, two_lower: zeros };
        let p = knots.degree();
        for degree in 1..=p {
            if degree + 1 == p {
                rows.two_lower = rows.degree_p;
            }
            if degree == p {
                rows.one_lower = rows.degree_p;
            }
            raise_degree(&mut rows.degree_p, knots, degree, u, R::div);
        }
        rows
    }

    /// The same of a cubic, without a loop over the degrees: the compiler unrolls what is left.
    #[inline(always)]
    pub(crate) fn of_cubic(knots: LocalKnots<'_, R>, u: R) -> Self {
        let mut degree_p = of_degree_0();
        raise_degree(&mut degree_p, knots, 1, u, R::div);
        let two_lower = degree_p;
        raise_degree(&mut degree_p, knots, 2, u, R::div);
        let one_lower = degree_p;
        raise_degree(&mut degree_p, knots, 3, u, R::div);
        Self { degree_p, one_lower, two_lower }
    }
}

/// `N_{i,0}` = 1.
#[inline(always)]
fn of_degree_0<R: Real>() -> [R; SCRATCH] {
    let mut functions = [R::zero(); SCRATCH];
    functions[0] = R::one();
    functions
}

/// Turns the functions of degree `degree - 1` into those of `degree`; `over` divides.
#[inline(always)] // The compiler then knows the degree where the caller does.
fn raise_degree<R: Real>(
    functions: &mut [R; SCRATCH],
    knots: LocalKnots<'_, R>,
    degree: usize,
    u: R,
    over: impl Fn(R, R) -> R,
) {
    let mut from_left = R::zero();
    for (function, (left, right)) in functions.iter_mut().zip(knots.supports(degree)) {
        let (below, above, width) = (u - left, right - u, right - left);
        let (stays, moves) = if below < above {
            let moves = *function * over(below, width);
            (*function - moves, moves)
        } else {
            let stays = *function * over(above, width);
            (stays, *function - stays)
        };
        *function = from_left + stays;
        from_left = moves;
    }
    if let Some(last) = functions.get_mut(degree) {
        *last = from_left;
    }
}

/// `numerator / denominator` with the convention of the recurrence, 0/0 = 0. The denominator is 0 only in an empty
/// span, which no search returns.
pub(crate) fn quotient<R: Real>(numerator: R, denominator: R) -> R {
    if denominator.is_zero() { R::zero() } else { numerator / denominator }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::generate;
    use crate::oracle::cox_de_boor;
    use proptest::prelude::*;
    use real::{Backend, DoubleDouble, FixedPoint, I16F16, I32F32};

    /// 0, 0, 0, 1, 1, 2, 2, 2: between the two knots 1 lies no span, and index 3 is not taken as 2 or 4.
    #[test]
    fn an_index_beyond_the_spans_is_the_nearest_and_that_of_an_empty_one_is_not() {
        let knots = [0.0, 0.0, 0.0, 1.0, 1.0, 2.0, 2.0, 2.0];
        let knots = KnotVector::try_new(2, 5, &knots).unwrap();
        let at = |span, u| basis_functions(&knots, span, u);
        assert_eq!((at(0, 0.25), at(99, 1.75)), (at(2, 0.25), at(4, 1.75)));
        for u in [0.25, 1.75] {
            assert!(at(3, u) != at(2, u) && at(3, u) != at(4, u), "{:?}", at(3, u));
            assert_eq!(at(3, u).iter().sum::<f64>(), 1.0);
        }
    }

    proptest! {
        #[test]
        fn floats_are_relatively_accurate((curve, u) in generate::curve_and_parameter::<2>()) {
            let knots = *curve.as_curve().knots();
            let span = knots.find_span(u);
            let p = knots.degree();
            let exact: Vec<DoubleDouble> = knots.as_slice().iter().map(|k| DoubleDouble::from(*k)).collect();
            let found = basis_functions(&knots, span, u);
            for (r, n) in found.iter().take(p + 1).enumerate() {
                let expected = cox_de_boor(&exact, span - p + r, p, span, DoubleDouble::from(u));
                let error = (DoubleDouble::from(*n) - expected).value().abs();
                let bound = 4.0 * p as f64 * f64::EPSILON * expected.value().abs();
                prop_assert!(error <= bound, "N_{r}({u}) = {n}: {error} > {bound}");
            }
            let sum: f64 = found.iter().sum();
            prop_assert!((sum - 1.0).abs() <= 8.0 * f64::EPSILON * p as f64, "sum {sum}");
        }

        #[test]
        fn fixed_point_functions_sum_to_exactly_one((curve, u) in generate::curve_and_parameter::<2>()) {
            fixed_point_case::<I32F32>(&curve, u)?;
            fixed_point_case::<I16F16>(&curve, u)?;
            fixed_point_case::<FixedPoint<fixed::types::I2F30>>(&curve, u)?;
        }
    }

    fn fixed_point_case<Q: Backend>(curve: &crate::NurbsBuf<f64, 2>, u: f64) -> Result<(), TestCaseError> {
        let all: Option<Vec<Q>> = curve.knots().iter().map(|k| Q::from_f64(*k)).collect();
        let (Some(rounded), Some(u)) = (all, Q::from_f64(u)) else {
            return Err(TestCaseError::reject("a knot does not fit"));
        };
        let Ok(knots) = KnotVector::try_new(curve.degree(), curve.control_points().len(), &rounded) else {
            return Err(TestCaseError::reject("knots have merged"));
        };
        let (span, p) = (knots.find_span(u), knots.degree());
        let exact: Vec<DoubleDouble> = rounded.iter().map(|k| DoubleDouble::from(k.to_f64())).collect();
        let found = basis_functions(&knots, span, u);
        let sum = found.iter().fold(Q::zero(), |sum, n| sum + *n);
        prop_assert_eq!(sum, Q::one());
        for (r, n) in found.iter().take(p + 1).enumerate() {
            let expected = cox_de_boor(&exact, span - p + r, p, span, DoubleDouble::from(u.to_f64())).value();
            let error = (n.to_f64() - expected).abs();
            let bound = (p * (p + 1)) as f64 * Q::resolution().to_f64();
            prop_assert!(error <= bound, "{} N_{r}({u:?}) = {n:?}: {error} > {bound}", Q::name());
            prop_assert!(*n >= Q::zero(), "N_{r}({u:?}) = {n:?}");
        }
        Ok(())
    }

    #[test]
    fn outside_its_span_a_polynomial_is_extrapolated() {
        // Bernstein polynomials (1-u)², 2u(1-u), u² at u = 2 and at u = -1.
        let knots = KnotVector::try_new(2, 3, &[0., 0., 0., 1., 1., 1.]).unwrap();
        assert_eq!(basis_functions(&knots, 2, 2.0)[..4], [1., -4., 4., 0.]);
        assert_eq!(basis_functions(&knots, 2, -1.0)[..4], [4., -4., 1., 0.]);
    }

    #[test]
    fn any_span_index_is_accepted() {
        let knots = KnotVector::try_new(1, 4, &[0., 0., 1., 2., 3., 3.]).unwrap();
        assert_eq!(basis_functions(&knots, 0, 0.25)[..2], [0.75, 0.25]);
        assert_eq!(basis_functions(&knots, 99, 2.25)[..2], [0.75, 0.25]);
        let corner = KnotVector::try_new(2, 5, &[0., 0., 0., 1., 1., 2., 2., 2.]).unwrap();
        assert!(basis_functions(&corner, 3, 1.0).iter().all(|n| n.is_finite()));
    }
}
