//! NURBS curves: `C(u) = Σ w_i P_i N_{i,p}(u) / Σ w_i N_{i,p}(u)`.

use real::Real;

use crate::nurbs::basis::BasisRows;
use crate::nurbs::span_numbers::SpanNumbers;
use crate::{CurveError, Evaluate, KnotVector, Quantity};

/// A NURBS curve in `D` dimensions whose numbers are borrowed: from flash, or from a [`NurbsBuf`](crate::NurbsBuf).
///
/// The constructor checks all conditions of evaluation; after that every operation is total.
///
/// Range, in fixed point: the format must hold the coordinates, the weights, the domain's width, the degree, and extent
/// · max(1, largest weight). The constructor checks all of these but the degree. The format must also hold the
/// derivatives and their control polygons, `p ΔP_i / (u_{i+p+1} - u_{i+1})`; these saturate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NurbsCurve<'a, R, const D: usize> {
    pub(crate) knots: KnotVector<'a, R>,
    pub(crate) control_points: &'a [[R; D]],
    /// `None` when all weights are equal: the denominator is then constant and is not computed.
    pub(crate) weights: Option<&'a [R]>,
}

impl<'a, R: Real, const D: usize> NurbsCurve<'a, R, D> {
    /// The curve of `degree` p with control points `P_0 … P_n`, one weight each and knots `u_0 … u_{n+p+1}`.
    ///
    /// If all weights are equal the curve is evaluated without division by a weight.
    ///
    /// # Errors
    /// Those of [`KnotVector::try_new`]. Also if there is not one weight per point, if a weight is not finite and above
    /// 0, if a coordinate is not finite, or if the extent along an axis, times the largest weight if that is above 1,
    /// does not fit the format.
    pub fn try_new(
        degree: usize,
        control_points: &'a [[R; D]],
        weights: &'a [R],
        knots: &'a [R],
    ) -> Result<Self, CurveError> {
        let knots = KnotVector::try_new(degree, control_points.len(), knots)?;
        check_weights(weights, control_points.len())?;
        let rational = weights.windows(2).any(|pair| pair[0] != pair[1]);
        let weights = rational.then_some(weights);
        check_points(control_points, weights.unwrap_or_default())?;
        Ok(Self { knots, control_points, weights })
    }

    /// The curve without weights, a B-spline: it equals the curve with equal weights.
    ///
    /// # Errors
    /// Those of [`try_new`](Self::try_new), except errors of weights.
    pub fn try_new_nonrational(
        degree: usize,
        control_points: &'a [[R; D]],
        knots: &'a [R],
    ) -> Result<Self, CurveError> {
        let knots = KnotVector::try_new(degree, control_points.len(), knots)?;
        check_points(control_points, &[])?;
        Ok(Self { knots, control_points, weights: None })
    }

    /// The degree p.
    #[must_use]
    pub fn degree(&self) -> usize {
        self.knots.degree()
    }

    /// The knot vector.
    #[must_use]
    pub fn knots(&self) -> &KnotVector<'a, R> {
        &self.knots
    }

    /// The control points `P_0 … P_n`, not multiplied by their weights.
    #[must_use]
    pub fn control_points(&self) -> &'a [[R; D]] {
        self.control_points
    }

    /// The weights, or `None` when they are all equal.
    #[must_use]
    pub fn weights(&self) -> Option<&'a [R]> {
        self.weights
    }

    /// The numbers that shape the span at knot index `span`.
    #[inline(always)]
    pub(crate) fn numbers(&self, span: usize) -> SpanNumbers<'a, R, D> {
        SpanNumbers::at(span, &self.knots, self.control_points, self.weights)
    }

    /// The same, known in number to the compiler, if this is a cubic and cubics are compiled apart.
    #[inline(always)]
    pub(crate) fn cubic_numbers(&self, span: usize) -> Option<SpanNumbers<'a, R, D>> {
        if !R::IS_FOR_SPEED || !cfg!(feature = "cubic") {
            return None;
        }
        SpanNumbers::at_cubic(span, &self.knots, self.control_points, self.weights)
    }

    /// The point at `u` of the span at knot index `span`.
    #[inline(never)] // Within `point` it would make every cubic save its registers.
    fn point_of_any_degree(&self, span: usize, u: R) -> [R; D] {
        let numbers = self.numbers(span);
        numbers.point(BasisRows::new(numbers.knots, u))
    }
}

fn check_weights<R: Real>(weights: &[R], expected: usize) -> Result<(), CurveError> {
    if weights.len() != expected {
        return Err(CurveError::WrongWeightCount { expected, found: weights.len() });
    }
    if let Some(index) = weights.iter().position(|w| !w.is_finite()) {
        return Err(CurveError::NotFinite { what: Quantity::Weight, index });
    }
    match weights.iter().position(|w| *w <= R::zero()) {
        Some(index) => Err(CurveError::WeightNotPositive { index }),
        None => Ok(()),
    }
}

fn check_points<R: Real, const D: usize>(points: &[[R; D]], weights: &[R]) -> Result<(), CurveError> {
    if let Some(index) = points.iter().position(|point| !point.iter().all(|x| x.is_finite())) {
        return Err(CurveError::NotFinite { what: Quantity::ControlPoint, index });
    }
    let largest_weight = weights.iter().fold(R::one(), |largest, w| largest.max(*w));
    // Double-double cannot divide its greatest value: the quotient is NaN, and a comparison with NaN refuses no curve.
    let widest = R::max_value() / largest_weight;
    match axis_too_wide(points, widest) {
        Some(axis) => Err(CurveError::ExtentTooWide { axis }),
        None => Ok(()),
    }
}

/// The first axis along which two points are farther apart than `widest`, or than the format holds.
pub(crate) fn axis_too_wide<R: Real, const D: usize>(points: &[[R; D]], widest: R) -> Option<usize> {
    (0..D).find(|axis| {
        let coordinates = || points.iter().map(|point| point[*axis]);
        let least = coordinates().fold(R::max_value(), |least, x| least.min(x));
        let greatest = coordinates().fold(R::min_value(), |greatest, x| greatest.max(x));
        let extent = greatest - least; // below zero when it has wrapped
        extent < R::zero() || !extent.is_finite() || extent > widest
    })
}

impl<R: Real, const D: usize> Evaluate<R, D> for NurbsCurve<'_, R, D> {
    fn domain(&self) -> (R, R) {
        self.knots.domain()
    }

    /// The point `C(u)`, by algorithm A3.1 or, with weights, A4.1.
    ///
    /// Both ends are exactly the first and the last control point, in every format. Far beyond an end a rational curve
    /// may have a pole: the point is then infinite, not a number, or saturated.
    ///
    /// Accuracy, `u` inside the domain and P the largest coordinate: floating point, `8 (p+1) ε P`, with or without
    /// weights.
    /// Fixed point without weights, E being the extent of the span's control points: `p(p+1)/2 · E + 1/2` units of the
    /// last place along each axis. Raising the degree from q - 1 to q divides q functions into two parts each, and each
    /// part that is off by a unit moves the point by at most E units.
    /// Fixed point with weights from v to W in the span: `(p(p+1) E W/v + (p+1) (E/v + P) + 1)` units.
    ///
    /// # Source
    /// Piegl and Tiller, *The NURBS Book*, 2nd ed. (1997), algorithms A3.1 and A4.1.
    #[inline(never)] // What it costs then does not hang on how often a program calls it.
    fn point(&self, u: R) -> [R; D] {
        let span = self.knots.find_span(u);
        match self.cubic_numbers(span) {
            Some(cubic) => cubic.point(BasisRows::of_cubic(cubic.knots, u)),
            None => self.point_of_any_degree(span, u),
        }
    }

    fn span_count(&self) -> usize {
        self.knots.span_count()
    }

    fn span_bounds(&self, span: usize) -> (R, R) {
        self.knots.span_bounds(span)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::golden;
    use crate::oracle::{self, exactly};
    use crate::{Differentiate, NurbsBuf, generate};
    use proptest::prelude::*;
    use real::{Backend, I8F24, I16F16, I32F32};

    fn largest_coordinate<const D: usize>(curve: &NurbsBuf<f64, D>) -> f64 {
        curve.control_points().iter().flatten().fold(0.0, |largest: f64, x| largest.max(x.abs()))
    }

    /// Largest extent of the control points along an axis.
    fn extent<const D: usize>(curve: &NurbsBuf<f64, D>) -> f64 {
        (0..D)
            .map(|axis| {
                let xs = || curve.control_points().iter().map(|p| p[axis]);
                xs().fold(f64::MIN, f64::max) - xs().fold(f64::MAX, f64::min)
            })
            .fold(0.0, f64::max)
    }

    proptest! {
        #[test]
        fn floats_match_the_definition((curve, u) in generate::curve_and_parameter::<3>()) {
            let exact = oracle::point(&exactly(&curve), u.into());
            let bound = 8.0 * (curve.degree() + 1) as f64 * f64::EPSILON * largest_coordinate(&curve);
            for (found, expected) in curve.as_curve().point(u).into_iter().zip(exact) {
                let error = (real::DoubleDouble::from(found) - expected).value().abs();
                prop_assert!(error <= bound, "C({u}): {error} > {bound}");
            }
        }

        #[test]
        fn single_precision_matches_the_definition((curve, u) in generate::curve_and_parameter::<3>()) {
            accuracy_case::<f32, 3>(&curve, u, |rounded| {
                8.0 * (rounded.degree() + 1) as f64 * f64::from(f32::EPSILON) * largest_coordinate(rounded)
            })?;
        }

        #[test]
        fn fixed_point_stays_within_its_bound((curve, u) in generate::curve_and_parameter::<2>()) {
            accuracy_case::<I32F32, 2>(&curve, u, |rounded| fixed_bound(rounded) * 2.0_f64.powi(-32))?;
            accuracy_case::<I16F16, 2>(&curve, u, |rounded| fixed_bound(rounded) * 2.0_f64.powi(-16))?;
        }

        #[test]
        fn ends_are_control_points_in_every_format(curve in generate::curve::<2>()) {
            ends_case::<f64>(&curve)?;
            ends_case::<f32>(&curve)?;
            ends_case::<I32F32>(&curve)?;
            ends_case::<I16F16>(&curve)?;
        }
    }

    /// The bound of the docstring, in units of the last place.
    fn fixed_bound<const D: usize>(curve: &NurbsBuf<f64, D>) -> f64 {
        let (p, extent) = (curve.degree() as f64, extent(curve));
        let Some(weights) = curve.as_curve().weights() else { return p * (p + 1.0) / 2.0 * extent + 0.5 };
        let (low, high) = weights.iter().fold((f64::MAX, 0.0_f64), |(l, h), w| (l.min(*w), h.max(*w)));
        p * (p + 1.0) * extent * high / low + (p + 1.0) * (extent / low + largest_coordinate(curve)) + 1.0
    }

    /// Compares the curve in `Q` with the same, already rounded, curve in double-double.
    fn accuracy_case<Q: Backend, const D: usize>(
        curve: &NurbsBuf<f64, D>,
        u: f64,
        bound: impl Fn(&NurbsBuf<f64, D>) -> f64,
    ) -> Result<(), TestCaseError> {
        let coarse = curve.convert::<Q>().map_err(|error| TestCaseError::reject(error.to_string()))?;
        let u = Q::from_f64(u).unwrap();
        let rounded = oracle::in_f64(&coarse);
        let exact = oracle::point(&exactly(&rounded), u.to_f64().into());
        let bound = bound(&rounded);
        for (found, expected) in coarse.as_curve().point(u).into_iter().zip(exact) {
            let error = (found.to_f64() - expected.value()).abs();
            prop_assert!(error <= bound, "{} C({u:?}): {error} > {bound}", Q::name());
        }
        Ok(())
    }

    fn ends_case<Q: Backend>(curve: &NurbsBuf<f64, 2>) -> Result<(), TestCaseError> {
        let curve = curve.convert::<Q>().map_err(|error| TestCaseError::reject(error.to_string()))?;
        let points = curve.control_points();
        let (first, last) = curve.as_curve().domain();
        prop_assert_eq!(curve.as_curve().point(first), points[0]);
        prop_assert_eq!(curve.as_curve().point(last), points[points.len() - 1]);
        Ok(())
    }

    #[test]
    fn a_circle_keeps_its_radius() {
        fn worst<Q: Backend>() -> f64 {
            let circle = golden::circle(10.0).convert::<Q>().unwrap();
            let radius = |k: i32| {
                let point = circle.as_curve().point(Q::from_ratio(k, 1000)).map(Q::to_f64);
                (f64::norm(&point) - 10.0).abs()
            };
            (0..=1000).map(radius).fold(0.0, f64::max)
        }
        for (name, worst, bound) in [
            ("f64", worst::<f64>(), 8e-15),
            ("f32", worst::<f32>(), 4e-6),
            ("I32F32", worst::<I32F32>(), 1.2e-8),
            ("I16F16", worst::<I16F16>(), 8e-4),
            ("I8F24", worst::<I8F24>(), 3e-6),
        ] {
            assert!(worst <= bound, "{name}: {worst} > {bound}");
        }
    }

    #[test]
    fn beyond_the_ends_the_outer_span_is_extrapolated() {
        // A parabola (u, u²) of one span, and the same as two spans.
        let one = NurbsBuf::try_new(
            2,
            vec![[0., 0.], [1., 0.], [2., 4.]],
            vec![1.; 3],
            vec![0., 0., 0., 2., 2., 2.],
        );
        let two = one.as_ref().unwrap().insert_knot(1.0).unwrap();
        for curve in [one.unwrap(), two] {
            for u in [-1.0, -0.25, 2.5, 3.0] {
                assert_eq!(curve.as_curve().point(u), [u, u * u]);
            }
        }
    }

    #[test]
    fn equal_weights_are_no_weights() {
        let (points, knots) = ([[0.0, 1.0], [2.0, 3.0]], [0.0, 0.0, 1.0, 1.0]);
        let weighted = NurbsCurve::try_new(1, &points, &[0.3, 0.3], &knots).unwrap();
        assert_eq!(weighted.weights(), None);
        assert_eq!(Ok(weighted), NurbsCurve::try_new_nonrational(1, &points, &knots));
    }

    #[test]
    fn coincident_control_points_are_a_point() {
        let curve = NurbsBuf::try_new(2, vec![[3.0, 4.0]; 3], vec![1., 2., 1.], vec![0., 0., 0., 1., 1., 1.])
            .unwrap();
        let d = curve.as_curve().derivatives(0.5);
        assert!(f64::norm(&[d.point[0] - 3.0, d.point[1] - 4.0]) <= 1e-15, "{d:?}");
        assert!(f64::norm(&d.first) <= 1e-14 && f64::norm(&d.second) <= 1e-13, "{d:?}");
    }

    #[test]
    fn each_violated_relation_has_its_error() {
        let knots = [0.0, 0.0, 1.0, 1.0];
        let check = |points: &[[f64; 2]], weights: &[f64]| {
            NurbsCurve::try_new(1, points, weights, &knots).unwrap_err()
        };
        let points = [[0.0, 0.0], [1.0, 1.0]];
        assert_eq!(check(&points[..1], &[1.0]), CurveError::TooFewControlPoints { least: 2, found: 1 });
        assert_eq!(check(&points, &[1.0]), CurveError::WrongWeightCount { expected: 2, found: 1 });
        assert_eq!(check(&points, &[1.0, 0.0]), CurveError::WeightNotPositive { index: 1 });
        assert_eq!(check(&points, &[-1.0, 1.0]), CurveError::WeightNotPositive { index: 0 });
        assert_eq!(
            check(&points, &[f64::INFINITY, 1.0]),
            CurveError::NotFinite { what: Quantity::Weight, index: 0 }
        );
        assert_eq!(
            check(&[[0.0, 0.0], [f64::NAN, 0.0]], &[1.0, 1.0]),
            CurveError::NotFinite { what: Quantity::ControlPoint, index: 1 }
        );
        assert_eq!(
            check(&[[0.0, f64::MIN], [0.0, f64::MAX]], &[1.0, 1.0]),
            CurveError::ExtentTooWide { axis: 1 }
        );
    }

    #[test]
    fn an_extent_that_weights_carry_out_of_the_format_is_refused() {
        let number = |x| I8F24::from_f64(x).unwrap();
        let (points, knots) = ([[-50.0], [50.0]].map(|p| p.map(number)), [0.0, 0.0, 1.0, 1.0].map(number));
        let check = |weights: [f64; 2]| NurbsCurve::try_new(1, &points, &weights.map(number), &knots).err();
        assert_eq!(check([1.0, 1.25]), None);
        assert_eq!(check([1.0, 1.5]), Some(CurveError::ExtentTooWide { axis: 0 }));
        let far = [[-100.0], [100.0]].map(|p| p.map(number));
        assert_eq!(
            NurbsCurve::try_new_nonrational(1, &far, &knots),
            Err(CurveError::ExtentTooWide { axis: 0 })
        );
    }
}
