//! First and second derivatives of NURBS curves.
//!
//! The derivative of a B-spline `Σ B_i N_{i,p}` is the B-spline of degree p - 1 over the divided differences of its
//! coefficients, `p Σ Q_i N_{i,p-1}` with `Q_i = (B_{i+1} - B_i) / (u_{i+p+1} - u_{i+1})`, and so on. No basis function
//! is differentiated: the derivatives of basis functions are as large as 1 / span and cancel in the sum, whereas the
//! differences are as small as the result.
//!
//! A rational curve is `C = A / w`, and by the rule for quotients
//!
//! `C' = (A' - w' C) / w`, `C'' = (A'' - 2 w' C' - w'' C) / w`.
//!
//! At a given u, C is a constant vector, and `A - w C = Σ w_i (P_i - C) N_i` is the curve relative to its own point.
//! This B-spline has the coefficients `B_i = w_i (P_i - C)` and the derivatives `A' - w' C` and `A'' - w'' C`; only the
//! divisions by w are left. Only differences of coordinates enter, so a curve far from the origin loses no digits.
//!
//! Accuracy over the curves of the papers, relative to the largest derivative: 1e-15 in `f64`, 5e-7 in `f32`, 3e-9 in
//! `I32F32`; on the smaller of the two, 2e-4 in `I16F16`.
//!
//! # Source
//! Piegl and Tiller, *The NURBS Book*, 2nd ed. (1997), equations 3.4 to 3.6 and 4.8. Algorithm A4.2 evaluates equation
//! 4.8 with `A'` and `w'C` apart.

use real::Real;

use crate::nurbs::basis::BasisRows;
use crate::nurbs::degree::SCRATCH;
use crate::nurbs::knots::LocalKnots;
use crate::nurbs::span_numbers::SpanNumbers;
use crate::vector::{over, sub, weighted_sum};
use crate::{Derivatives, Differentiate, NurbsCurve};

impl<R: Real, const D: usize> Differentiate<R, D> for NurbsCurve<'_, R, D> {
    /// The point is that of [`point`](crate::Evaluate::point). The derivatives are within a few units of the largest
    /// derivative of their span: 1e-15 of it in `f64`, 5e-7 in `f32`, 3e-9 in `I32F32` on the curves of the papers.
    /// Beyond the ends the outer span is extrapolated.
    #[inline(always)] // A search and a call.
    fn derivatives(&self, u: R) -> Derivatives<R, D> {
        self.derivatives_at(self.knots.find_span(u), u)
    }

    fn derivatives_in(&self, span: usize, u: R) -> Derivatives<R, D> {
        self.derivatives_at(self.knots.span_index(span), u)
    }

    fn is_line(&self, _: usize) -> bool {
        self.degree() == 1 && self.weights.is_none()
    }
}

impl<R: Real, const D: usize> NurbsCurve<'_, R, D> {
    /// `C(u)`, `C'(u)` and `C''(u)` of the span at knot index `span`.
    #[inline(never)] // As `point`.
    fn derivatives_at(&self, span: usize, u: R) -> Derivatives<R, D> {
        match self.cubic_numbers(span) {
            Some(cubic) => cubic.derivatives(BasisRows::of_cubic(cubic.knots, u)),
            None => self.derivatives_of_any_degree(span, u),
        }
    }

    #[inline(never)] // Within the above it would make every cubic save its registers.
    fn derivatives_of_any_degree(&self, span: usize, u: R) -> Derivatives<R, D> {
        let numbers = self.numbers(span);
        numbers.derivatives(BasisRows::new(numbers.knots, u))
    }
}

impl<R: Real, const D: usize> SpanNumbers<'_, R, D> {
    /// The point and the derivatives that these basis functions give.
    #[inline(always)]
    fn derivatives(&self, mut rows: BasisRows<R>) -> Derivatives<R, D> {
        let denominator = self.make_rational(&mut rows.degree_p);
        let point = weighted_sum(&rows.degree_p, self.points);

        let mut coefficients = scratch(self.points, [R::zero(); D]);
        let Some(weights) = self.weights else {
            let (first, second) = spline_derivatives(&coefficients, self.knots, &rows);
            return Derivatives { point, first, second };
        };
        for (coefficient, weight) in coefficients.iter_mut().zip(weights) {
            *coefficient = sub(coefficient, &point).map(|x| *weight * x);
        }
        let (first, second) = spline_derivatives(&coefficients, self.knots, &rows);
        let weights = scratch(weights.as_chunks::<1>().0, [R::zero()]);
        let ([weight_rate], _) = spline_derivatives(&weights, self.knots, &rows);

        let first = over(&first, denominator);
        let twice_turned = first.map(|x| (weight_rate * x).ldexp(1));
        let second = over(&sub(&second, &twice_turned), denominator);
        Derivatives { point, first, second }
    }
}

/// First and second derivative of `Σ coefficients_r N_r`.
#[inline(always)]
fn spline_derivatives<R: Real, const D: usize>(
    coefficients: &[[R; D]; SCRATCH],
    knots: LocalKnots<'_, R>,
    rows: &BasisRows<R>,
) -> ([R; D], [R; D]) {
    let p = knots.degree();
    let one_lower = p.saturating_sub(1);
    let differences = divided_differences(coefficients, knots, p);
    let second_differences = divided_differences(&differences, knots, one_lower);
    let degree = |q: usize| R::from_ratio(i32::try_from(q).unwrap_or(i32::MAX), 1);
    let first = weighted_sum(front(&rows.one_lower, p), &differences).map(|x| x * degree(p));
    let second = weighted_sum(front(&rows.two_lower, one_lower), &second_differences);
    (first, second.map(|x| x * degree(one_lower) * degree(p)))
}

/// The first `count` functions and the 0 behind them: its product makes a sum of zeros +0, whatever their signs.
#[inline(always)]
fn front<R>(functions: &[R; SCRATCH], count: usize) -> &[R] {
    functions.get(..count + 1).unwrap_or(functions)
}

/// `(B_{r+1} - B_r) / (right_r - left_r)` over the supports of the `q` basis functions of degree q - 1; the rest is 0.
#[inline(always)]
fn divided_differences<R: Real, const D: usize>(
    coefficients: &[[R; D]; SCRATCH],
    knots: LocalKnots<'_, R>,
    q: usize,
) -> [[R; D]; SCRATCH] {
    let mut differences = [[R::zero(); D]; SCRATCH];
    for ((difference, pair), (left, right)) in
        differences.iter_mut().zip(coefficients.windows(2)).zip(knots.supports(q))
    {
        *difference = over(&sub(&pair[1], &pair[0]), right - left);
    }
    differences
}

/// An array with these numbers at its front and zeros behind.
#[inline(always)]
fn scratch<T: Copy>(numbers: &[T], zero: T) -> [T; SCRATCH] {
    let mut array = [zero; SCRATCH];
    for (place, number) in array.iter_mut().zip(numbers) {
        *place = *number;
    }
    array
}

#[cfg(test)]
mod tests {
    use crate::oracle::{self, exactly};
    use crate::{Derivatives, Differentiate, Evaluate, NurbsBuf, generate, golden};
    use proptest::prelude::*;
    use real::{Backend, DoubleDouble, I16F16, I32F32, Real};

    /// What rounding errors of the derivatives in a span are measured by: the extent times `p / span width` per
    /// differentiation, and the ratio of the weights likewise.
    fn sizes<const D: usize>(curve: &NurbsBuf<f64, D>, span: usize) -> [f64; 2] {
        let (a, b) = curve.as_curve().span_bounds(span);
        let largest = curve.control_points().iter().flatten().fold(0.0, |m: f64, x| m.max(x.abs()));
        let weights = curve.weights().iter().fold((f64::MAX, 0.0_f64), |(l, h), w| (l.min(*w), h.max(*w)));
        let growth = 2.0 * curve.degree() as f64 / (b - a) * (weights.1 / weights.0);
        [largest * growth, largest * growth * growth]
    }

    /// Point and derivatives, to the last bit: `{:?}` shows the sign of a zero.
    fn same_in<Q: Backend>(curve: &NurbsBuf<f64, 2>, u: f64) -> Result<(), TestCaseError> {
        let (Ok(curve), Some(u)) = (curve.convert::<Q>(), Q::from_f64(u)) else {
            return Err(TestCaseError::reject("it does not fit"));
        };
        let curve = curve.as_curve();
        for u in curve.knots().as_slice().iter().copied().chain([u]) {
            let span = curve.knots().find_span(u);
            prop_assert_eq!(curve.cubic_numbers(span).is_some(), Q::IS_FOR_SPEED, "{}", Q::name());
            let (apart, as_any) = (curve.derivatives(u), curve.derivatives_of_any_degree(span, u));
            prop_assert_eq!(format!("{apart:?}"), format!("{as_any:?}"), "{} u={:?}", Q::name(), u);
            prop_assert_eq!(format!("{:?}", curve.point(u)), format!("{:?}", as_any.point));
        }
        Ok(())
    }

    proptest! {
        /// Inside the domain, at its knots, and where the outer spans are extrapolated.
        #[test]
        fn a_cubic_has_the_bits_of_any_degree(
            curve in generate::curve_of_degree::<2>(3..=3),
            u in -0.25..1.25,
        ) {
            same_in::<f64>(&curve, u)?;
            same_in::<f32>(&curve, u)?;
            same_in::<I16F16>(&curve, u)?;
            same_in::<I32F32>(&curve, u)?;
            same_in::<DoubleDouble>(&curve, u)?;
        }

        #[test]
        fn derivatives_are_limits_of_differences(
            (curve, span, t) in generate::curve_span_and_fraction::<2>()
        ) {
            let exact = exactly(&curve);
            let (a, b) = curve.as_curve().span_bounds(span);
            let [first, second] = sizes(&curve, span);
            // The error of a central difference is about C'''h²/6: with h a 1e-8th of the span, 1e-16 of the size.
            let (u, h) = (DoubleDouble::from(a + (b - a) * t), DoubleDouble::from((b - a) * 1e-8));
            let at = exact.as_curve().derivatives(u);
            let (after, before) = (exact.as_curve().derivatives(u + h), exact.as_curve().derivatives(u - h));
            for axis in 0..2 {
                let slope = |after: DoubleDouble, before: DoubleDouble| (after - before) / (h + h);
                let error = (slope(after.point[axis], before.point[axis]) - at.first[axis]).value().abs();
                prop_assert!(error <= 1e-13 * first, "C'({u:?}): {error}, size {first}");
                let error = (slope(after.first[axis], before.first[axis]) - at.second[axis]).value().abs();
                prop_assert!(error <= 1e-13 * second, "C''({u:?}): {error}, size {second}");
            }
        }

        #[test]
        fn floats_are_as_accurate_as_their_format((curve, span, t) in generate::curve_span_and_fraction::<3>()) {
            let (a, b) = curve.as_curve().span_bounds(span);
            let u = a + (b - a) * t;
            let exact = exactly(&curve).as_curve().derivatives_in(span, u.into());
            let found = curve.as_curve().derivatives_in(span, u);
            let [first, second] = sizes(&curve, span);
            for axis in 0..3 {
                let error = (DoubleDouble::from(found.first[axis]) - exact.first[axis]).value().abs();
                prop_assert!(error <= 64.0 * f64::EPSILON * first, "C'({u}): {error}, size {first}");
                let error = (DoubleDouble::from(found.second[axis]) - exact.second[axis]).value().abs();
                prop_assert!(error <= 64.0 * f64::EPSILON * second, "C''({u}): {error}, size {second}");
            }
        }

        #[test]
        fn the_point_is_that_of_evaluation((curve, u) in generate::curve_and_parameter::<2>()) {
            prop_assert_eq!(curve.as_curve().derivatives(u).point, curve.as_curve().point(u));
            let coarse = curve.convert::<I32F32>().map_err(|error| TestCaseError::reject(error.to_string()))?;
            let u = I32F32::from_f64(u).unwrap();
            prop_assert_eq!(coarse.as_curve().derivatives(u).point, coarse.as_curve().point(u));
        }
    }

    /// Largest errors of `C'` and `C''` over the curve, relative to the largest `C'` and `C''`.
    fn worst_errors<Q: Backend>(curve: &NurbsBuf<f64, 2>) -> [f64; 2] {
        let coarse = curve.convert::<Q>().unwrap();
        let exact = exactly(&oracle::in_f64(&coarse));
        let (mut errors, mut sizes) = ([0.0_f64; 2], [0.0_f64; 2]);
        for k in 0..=1000 {
            let u = Q::from_ratio(k, 1000);
            let found = coarse.as_curve().derivatives(u);
            let expected = exact.as_curve().derivatives(u.to_f64().into());
            let pairs = [(found.first, expected.first), (found.second, expected.second)];
            for (order, (found, expected)) in pairs.into_iter().enumerate() {
                let expected = expected.map(DoubleDouble::value);
                let found = found.map(Q::to_f64);
                errors[order] =
                    errors[order].max(f64::norm(&[found[0] - expected[0], found[1] - expected[1]]));
                sizes[order] = sizes[order].max(f64::norm(&expected));
            }
        }
        [errors[0] / sizes[0], errors[1] / sizes[1]]
    }

    #[test]
    fn relative_errors_on_the_curves_of_the_papers() {
        let (plain, rational) = (golden::seed_000(), golden::seed_003());
        for (name, [first, second], bounds) in [
            ("seed 000 f64", worst_errors::<f64>(&plain), [1e-15, 1e-15]),
            ("seed 000 f32", worst_errors::<f32>(&plain), [5e-7, 5e-7]),
            ("seed 000 I32F32", worst_errors::<I32F32>(&plain), [3e-9, 3e-9]),
            ("seed 003 f64", worst_errors::<f64>(&rational), [1e-15, 1e-15]),
            ("seed 003 f32", worst_errors::<f32>(&rational), [5e-7, 5e-7]),
            ("seed 003 I32F32", worst_errors::<I32F32>(&rational), [3e-9, 3e-9]),
            ("seed 003 I16F16", worst_errors::<I16F16>(&rational), [2e-4, 2e-4]),
        ] {
            assert!(first <= bounds[0] && second <= bounds[1], "{name}: {first:e}, {second:e} > {bounds:?}");
        }
    }

    #[test]
    fn a_derivative_of_zero_has_no_sign() {
        let still = NurbsBuf::try_new_nonrational(1, vec![[0.0], [-0.0]], vec![0.0, 0.0, 1.0, 1.0]).unwrap();
        let at = still.as_curve().derivatives(0.5_f64);
        assert_eq!([at.first, at.second].map(|[x]| x.to_bits()), [0, 0]);
    }

    #[test]
    fn at_a_corner_each_span_has_its_own_derivative() {
        let curve = NurbsBuf::try_new_nonrational(
            1,
            vec![[0.0, 0.0], [2.0, 0.0], [2.0, 3.0]],
            vec![0.0, 0.0, 1.0, 2.0, 2.0],
        )
        .unwrap();
        let curve = curve.as_curve();
        let corner = |first| Derivatives { point: [2.0, 0.0], first, second: [0.0, 0.0] };
        assert_eq!(curve.derivatives_in(0, 1.0), corner([2.0, 0.0]));
        assert_eq!(curve.derivatives_in(1, 1.0), corner([0.0, 3.0]));
        assert_eq!(curve.derivatives(1.0), corner([0.0, 3.0]));
    }
}
