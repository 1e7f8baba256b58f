//! Knot insertion: the same curve with one knot and one control point more.
//!
//! Inserting a knot until its multiplicity is the degree cuts the curve there into two; doing so at every knot is
//! its decomposition into Bezier spans.

use alloc::vec::Vec;

use real::Real;

use crate::nurbs::basis::quotient;
use crate::vector::lerp;
use crate::{CurveError, NurbsBuf};

impl<R: Real, const D: usize> NurbsBuf<R, D> {
    /// The same curve with the knot `u` inserted once.
    ///
    /// With k the span of u, s its multiplicity and `α_i = (u - u_i) / (u_{i+p} - u_i)`, the new homogeneous control
    /// points are `Q_i = α_i P_i + (1 - α_i) P_{i-1}` for i = k-p+1 … k-s; those before and after are kept.
    ///
    /// # Errors
    /// [`CurveError::OutsideDomain`] unless u is inside the domain; [`CurveError::MultiplicityTooHigh`] if u already
    /// occurs `degree` times.
    ///
    /// # Source
    /// Piegl and Tiller, *The NURBS Book*, 2nd ed. (1997), algorithm A5.1 with r = 1.
    pub fn insert_knot(&self, u: R) -> Result<Self, CurveError> {
        let curve = self.as_curve();
        let (first, last) = curve.knots.domain();
        if !(first < u && u < last) {
            return Err(CurveError::OutsideDomain);
        }
        let (p, k, s) = (self.degree(), curve.knots.find_span(u), curve.knots.multiplicity(u));
        if s >= p {
            return Err(CurveError::MultiplicityTooHigh { index: k + 1 - s, multiplicity: s + 1, degree: p });
        }

        let homogeneous = || self.control_points().iter().zip(self.weights());
        let (mut points, mut weights) = (Vec::new(), Vec::new());
        let mut keep = |(point, weight): (&[R; D], &R)| {
            points.push(*point);
            weights.push(*weight);
        };
        homogeneous().take(k - p + 1).for_each(&mut keep);
        let pairs = homogeneous().zip(homogeneous().skip(1)).skip(k - p).take(p - s);
        let supports = self.knots().iter().zip(self.knots().iter().skip(p)).skip(k - p + 1);
        for (((before, w_before), (after, w_after)), (left, right)) in pairs.zip(supports) {
            let alpha = quotient(u - *left, *right - *left);
            let (part_before, part_after) = (*w_before - *w_before * alpha, *w_after * alpha);
            let weight = part_before + part_after;
            let share = quotient(part_after, weight);
            let point = lerp(before, after, share);
            keep((&point, &weight));
        }
        homogeneous().skip(k - s).for_each(&mut keep);

        let mut knots = self.knots().to_vec();
        knots.insert(k + 1, u);
        Self::try_new(p, points, weights, knots)
    }
}

#[cfg(test)]
mod tests {
    use crate::{CurveError, Evaluate, generate, golden};
    use proptest::prelude::*;
    use real::{Backend, I32F32, Real};

    proptest! {
        #[test]
        fn insertion_leaves_the_curve_unchanged(
            (curve, span, t) in generate::curve_span_and_fraction::<2>(), at in 0.0..1.0,
        ) {
            let (a, b) = curve.as_curve().span_bounds(span);
            let finer = curve.insert_knot(a + (b - a) * t).unwrap();
            let (first, last) = curve.as_curve().domain();
            let u = first + (last - first) * at;
            let (before, after) = (curve.as_curve().point(u), finer.as_curve().point(u));
            let error = f64::norm(&[after[0] - before[0], after[1] - before[1]]);
            prop_assert!(error <= 1e-11, "u={u}: {error}");
        }
    }

    #[test]
    fn a_knot_of_full_multiplicity_is_a_point_of_the_curve() {
        let mut curve = golden::seed_003();
        let expected = curve.as_curve().point(0.3);
        for _ in 0..3 {
            curve = curve.insert_knot(0.3).unwrap();
        }
        let point = curve.control_points()[curve.as_curve().knots().find_span(0.3) - 3];
        assert!(f64::norm(&[point[0] - expected[0], point[1] - expected[1]]) < 1e-13);
        let index = 5; // after 0 0 0 0 0.1836 0.2781 comes 0.3
        assert_eq!(
            curve.insert_knot(0.3),
            Err(CurveError::MultiplicityTooHigh { index: index + 1, multiplicity: 4, degree: 3 })
        );
    }

    #[test]
    fn fixed_point_inserts_within_its_resolution() {
        let curve = golden::seed_003().convert::<I32F32>().unwrap();
        let finer = curve.insert_knot(I32F32::from_ratio(1, 3)).unwrap();
        for k in 0..=100 {
            let u = I32F32::from_ratio(k, 100);
            let (before, after) = (curve.as_curve().point(u), finer.as_curve().point(u));
            let error = I32F32::norm(&[after[0] - before[0], after[1] - before[1]]).to_f64();
            assert!(error <= 2e-7, "u={u:?}: {error}");
        }
    }

    #[test]
    fn ends_are_not_inserted_at() {
        let curve = golden::seed_000();
        for u in [0.0, 1.0, -1.0, 2.0, f64::NAN] {
            assert_eq!(curve.insert_knot(u), Err(CurveError::OutsideDomain));
        }
    }
}
