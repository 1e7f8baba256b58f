//! From a trigonometric spline to polynomials, for real time: without sine and cosine, with a proven bound of the error.
//!
//! A segment is a sum of three harmonics. With `W = (q_0 - q_1) + (2/π)(D_0 + D_1)` and θ = πu/2 the basis gives
//!
//! `P = const + (3W/4 - (2/π) D_1) cos θ + ((2/π) D_0 - 3λW/4) sin θ - (λW/2) cos 2θ + (W/4) cos 3θ + (λW/4) sin 3θ`,
//!
//! so the n-th derivative is known for every n, and is nowhere longer than
//!
//! `M_n = (π/2)ⁿ (|(A_1, B_1)| + 2ⁿ |λW|/2 + 3ⁿ √(1 + λ²) |W|/4)`.
//!
//! Each segment is cut into equal pieces of width h, and a piece becomes the polynomial of degree p = 2r + 1 that has the same value
//! and the same first r derivatives at both ends (Hermite). The remainder of that interpolation is
//! `f⁽²ʳ⁺²⁾(ξ) (u - a)ʳ⁺¹ (u - b)ʳ⁺¹ / (2r + 2)!` for every direction, so the error vector is nowhere longer than
//!
//! `M_{p+1} (h/2)^{p+1} / (p+1)!`
//!
//! and the number of pieces is the least that brings this below the tolerance. Pieces of a segment join with r continuous
//! derivatives; the ends of the segments, and the first derivative there, stay as they were.

use alloc::vec::Vec;

use real::{Real, Trigonometric};

use crate::{Evaluate, MAX_DEGREE, NurbsBuf, ShapeError, TrigSegment, TrigSplineBuf};

/// A spline as polynomials, and the largest distance between the two.
#[derive(Clone, Debug, PartialEq)]
pub struct TrigPolynomials<const D: usize> {
    /// The polynomials, as one curve of the same parameter: a Bezier segment each.
    pub curve: NurbsBuf<f64, D>,
    /// No point of the curve is farther than this from the spline's point at the same parameter, in mm, apart from
    /// rounding.
    pub error_bound_mm: f64,
}

/// Most pieces of a segment.
const MOST_PIECES: u32 = 4096;

impl<const D: usize> TrigSplineBuf<f64, D> {
    /// The spline as polynomials of `degree` 3, 5, 7 or 9 within `tolerance_mm`.
    ///
    /// # Errors
    /// [`ShapeError::ToleranceNotPositive`], [`ShapeError::DegreeNotOdd`], [`ShapeError::TooManyPieces`], and
    /// [`ShapeError::Curve`] for coordinates that do not make a curve.
    pub fn to_polynomials(&self, tolerance_mm: f64, degree: usize) -> Result<TrigPolynomials<D>, ShapeError> {
        if !(tolerance_mm > 0.0 && tolerance_mm.is_finite()) {
            return Err(ShapeError::ToleranceNotPositive);
        }
        if !(3..=MAX_DEGREE).contains(&degree) || degree.is_multiple_of(2) {
            return Err(ShapeError::DegreeNotOdd { degree });
        }
        let spline = self.as_spline();
        let (mut control_points, mut knots, mut error_bound_mm) = (Vec::new(), Vec::new(), 0.0_f64);
        for (index, segment) in spline.segments().iter().enumerate() {
            let harmonics = Harmonics::of(segment);
            let (pieces, bound) = harmonics.pieces_within(tolerance_mm, degree)?;
            error_bound_mm = error_bound_mm.max(bound);
            let (begin, end) = spline.span_bounds(index);
            let joint = control_points.len().saturating_sub(1);
            for piece in 0..pieces {
                let at = |edge: u32| f64::from(edge) / f64::from(pieces);
                let bezier = harmonics.hermite(at(piece), at(piece + 1), degree);
                // Both segments share the control point at their joint.
                control_points.extend_from_slice(&bezier[usize::from(!control_points.is_empty())..]);
                knots.extend(core::iter::repeat_n(begin + (end - begin) * at(piece), degree));
            }
            // The harmonics are rounded; the ends of the segment are not.
            let (from, to) = segment.domain();
            if let Some(slot) = control_points.get_mut(joint) {
                *slot = segment.point(from);
            }
            if let Some(slot) = control_points.last_mut() {
                *slot = segment.point(to);
            }
        }
        let (first, last) = spline.domain();
        knots.insert(0, first);
        knots.extend(core::iter::repeat_n(last, degree + 1));
        Ok(TrigPolynomials {
            curve: NurbsBuf::try_new_nonrational(degree, control_points, knots)?,
            error_bound_mm,
        })
    }
}

/// A segment as a sum of harmonics of θ: `constant + Σ_r (cosines_r cos rθ + sines_r sin rθ)`, r = 1, 2, 3.
struct Harmonics<const D: usize> {
    constant: [f64; D],
    cosines: [[f64; D]; 3],
    sines: [[f64; D]; 3],
    /// The part of the segment, in its own parameter u.
    begin: f64,
    width: f64,
}

impl<const D: usize> Harmonics<D> {
    fn of(segment: &TrigSegment<f64, D>) -> Self {
        let [q0, q1, q2, q3] = segment.control_points();
        let (lambda, k) = (segment.shape().lambda, segment.shape().k);
        let two_over_pi = f64::two_over_pi();
        let mut harmonics =
            Self { constant: [0.0; D], cosines: [[0.0; D]; 3], sines: [[0.0; D]; 3], begin: 0.0, width: 1.0 };
        for d in 0..D {
            let d0 = (q1[d] - q0[d]) - k * (q2[d] - q1[d]);
            let d1 = (q2[d] - q1[d]) - k * (q3[d] - q2[d]);
            let w = (q0[d] - q1[d]) + two_over_pi * (d0 + d1);
            harmonics.constant[d] = q1[d] - two_over_pi * d0 + lambda * w / 2.0;
            for (r, cosine, sine) in [
                (0, 0.75 * w - two_over_pi * d1, two_over_pi * d0 - 0.75 * lambda * w),
                (1, -lambda * w / 2.0, 0.0),
                (2, w / 4.0, lambda * w / 4.0),
            ] {
                (harmonics.cosines[r][d], harmonics.sines[r][d]) = (cosine, sine);
            }
        }
        let (begin, end) = segment.domain();
        Self { begin, width: end - begin, ..harmonics }
    }

    /// A bound of the n-th derivative by the part's own parameter, in [0, 1]: M_n times the n-th power of its width.
    fn derivative_bound(&self, n: usize) -> f64 {
        let amplitude = |r: usize| f64::norm(&[f64::norm(&self.cosines[r]), f64::norm(&self.sines[r])]);
        (0..3).map(|r| amplitude(r) * power(self.frequency(r), n)).sum()
    }

    /// The factor by which each derivative multiplies harmonic r + 1.
    fn frequency(&self, r: usize) -> f64 {
        [1.0, 2.0, 3.0][r] * f64::half_pi() * self.width
    }

    /// The least number of pieces within the tolerance, and the error bound with it.
    fn pieces_within(&self, tolerance_mm: f64, degree: usize) -> Result<(u32, f64), ShapeError> {
        let factorial: f64 = (1_u8..=10).take(degree + 1).map(f64::from).product();
        let whole = self.derivative_bound(degree + 1) / factorial;
        let bound = |pieces: u32| whole * power(0.5 / f64::from(pieces), degree + 1);
        // The bound falls with the number: search between powers of two.
        let Some(high) = (0..=12).map(|e| 1_u32 << e).find(|pieces| bound(*pieces) <= tolerance_mm) else {
            return Err(ShapeError::TooManyPieces { most: MOST_PIECES });
        };
        let pieces = (high / 2 + 1..=high).find(|pieces| bound(*pieces) <= tolerance_mm).unwrap_or(high);
        Ok((pieces, bound(pieces)))
    }

    /// The n-th derivative at t of the part's own parameter: each derivative turns a harmonic by a quarter turn.
    fn derivative(&self, n: usize, t: f64) -> [f64; D] {
        let (s, c) = f64::sin_cos_quarter(self.begin + self.width * t);
        let (mut sine, mut cosine) = (0.0, 1.0);
        let mut sum = if n == 0 { self.constant } else { [0.0; D] };
        for r in 0..3 {
            (sine, cosine) = (sine * c + cosine * s, cosine * c - sine * s); // of (r + 1)θ
            let (of_cosine, of_sine) = match n % 4 {
                0 => (cosine, sine),
                1 => (-sine, cosine),
                2 => (-cosine, -sine),
                _ => (sine, -cosine),
            };
            let gain = power(self.frequency(r), n);
            for (x, (a, b)) in sum.iter_mut().zip(self.cosines[r].iter().zip(&self.sines[r])) {
                *x += gain * (a * of_cosine + b * of_sine);
            }
        }
        sum
    }

    /// The Bezier points of the Hermite polynomial over [from, to]. Each half of the points follows from the
    /// derivatives at its end,
    /// `b_j = Σ_{i ≤ j} binomial(j, i) (p - i)!/p! (±h)ⁱ f⁽ⁱ⁾`.
    fn hermite(&self, from: f64, to: f64, degree: usize) -> Vec<[f64; D]> {
        let half = degree.div_ceil(2);
        let side = |end: f64, step: f64| -> Vec<[f64; D]> {
            let derivatives: Vec<_> = (0..half).map(|i| self.derivative(i, end)).collect();
            let point = |j: usize| {
                let (mut sum, mut factor) = ([0.0; D], 1.0);
                for (i, derivative) in derivatives.iter().enumerate().take(j + 1) {
                    for (x, y) in sum.iter_mut().zip(derivative) {
                        *x += factor * y;
                    }
                    // binomial(j, i) hⁱ (p - i)!/p!, from i to i + 1.
                    factor *= step * float(j - i) / (float(i + 1) * float(degree - i));
                }
                sum
            };
            (0..half).map(point).collect()
        };
        let mut points = side(from, to - from);
        points.extend(side(to, from - to).into_iter().rev());
        points
    }
}

fn power(base: f64, exponent: usize) -> f64 {
    (0..exponent).fold(1.0, |product, _| product * base)
}

/// A small count as a number.
fn float(count: usize) -> f64 {
    f64::from(u32::try_from(count).unwrap_or(u32::MAX))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Differentiate, Ends, PieceLimits, ShapeFactors, compile, vector};
    use proptest::prelude::*;
    use real::DoubleDouble;

    fn splines() -> impl Strategy<Value = TrigSplineBuf<f64, 2>> {
        let points = proptest::collection::vec([-50.0..50.0, -50.0..50.0], 4..7);
        (points, -2.0..2.0, -2.0..2.0, 0.0..0.4, 0.6..1.0).prop_filter_map(
            "valid",
            |(points, lambda, k, begin, end)| {
                let shape = ShapeFactors { lambda, k };
                let spline = TrigSplineBuf::through(&points, shape, Ends::Closed).ok()?;
                let mut segments = spline.as_spline().segments().to_vec();
                segments[1] = segments[1].part(begin, end).ok()?;
                TrigSplineBuf::try_new(segments[..2].to_vec()).ok()
            },
        )
    }

    fn distance(a: [f64; 2], b: [f64; 2]) -> f64 {
        vector::distance(&a, &b)
    }

    proptest! {
        #[test]
        fn harmonics_are_the_segment(spline in splines(), t in 0.0..=1.0) {
            for segment in spline.as_spline().segments() {
                let (begin, end) = segment.domain();
                let expected = segment.derivatives(begin + (end - begin) * t);
                let harmonics = Harmonics::of(segment);
                let width = end - begin;
                prop_assert!(distance(harmonics.derivative(0, t), expected.point) <= 1e-12);
                prop_assert!(distance(harmonics.derivative(1, t), expected.first.map(|x| x * width)) <= 1e-11);
                prop_assert!(distance(harmonics.derivative(2, t), expected.second.map(|x| x * width * width)) <= 1e-10);
                for n in [6, 10] {
                    let (length, bound) = (f64::norm(&harmonics.derivative(n, t)), harmonics.derivative_bound(n));
                    prop_assert!(length <= bound * (1.0 + 1e-12), "{n}: {length} > {bound}");
                }
            }
        }

        #[test]
        fn the_error_is_within_its_bound_and_the_bound_within_the_tolerance(
            spline in splines(), exponent in -8..0_i32, degree in prop::sample::select(vec![3_usize, 5, 7, 9])
        ) {
            // The first segment only: the second begins elsewhere, since its part has been changed.
            let segment = spline.as_spline().segments()[0];
            let spline = TrigSplineBuf::try_new(alloc::vec![segment]).unwrap();
            let tolerance = 10.0_f64.powi(exponent);
            let polynomials = spline.to_polynomials(tolerance, degree).unwrap();
            prop_assert!(polynomials.error_bound_mm <= tolerance);
            let (exact, found) = (spline.convert::<DoubleDouble>().unwrap(), polynomials.curve.convert::<DoubleDouble>().unwrap());
            for step in 0..=500 {
                let u = DoubleDouble::from_ratio(step, 500);
                let (a, b) = (exact.as_spline().point(u), found.as_curve().point(u));
                let error = distance([(a[0] - b[0]).value(), (a[1] - b[1]).value()], [0.0; 2]);
                // The Bezier points themselves are f64: 1e-13 of coordinates up to some hundreds.
                prop_assert!(error <= polynomials.error_bound_mm + 1e-12, "{step}: {error} > {}", polynomials.error_bound_mm);
            }
        }

        #[test]
        fn ends_and_end_derivatives_stay(spline in splines()) {
            let segment = spline.as_spline().segments()[1];
            let one = TrigSplineBuf::try_new(alloc::vec![segment]).unwrap();
            let curve = one.to_polynomials(1e-3, 5).unwrap().curve;
            for u in [0.0, 1.0] {
                let (a, b) = (one.as_spline().derivatives(u), curve.as_curve().derivatives(u));
                prop_assert!(distance(a.point, b.point) <= 1e-12);
                prop_assert!(distance(a.first, b.first) <= 1e-10, "{:?} {:?}", a.first, b.first);
                prop_assert!(distance(a.second, b.second) <= 1e-8, "{:?} {:?}", a.second, b.second);
            }
        }
    }

    #[test]
    fn a_corner_takes_few_pieces_and_compiles() {
        // A corner of 10 mm each way, and its polynomials in real time's form.
        let corner =
            TrigSegment::between([[0.0, 0.0], [10.0, 10.0]], [[16.0, 0.0], [0.0, 16.0]], 1.0).unwrap();
        let spline = TrigSplineBuf::try_new(alloc::vec![corner]).unwrap();
        let pieces = [3, 5, 7, 9]
            .map(|degree| spline.to_polynomials(1e-5, degree).unwrap().curve.as_curve().span_count());
        assert_eq!(pieces, [14, 4, 2, 2]);
        let curve = spline.to_polynomials(1e-5, 5).unwrap().curve;
        let limits = PieceLimits { length_mm: 32.0, step_mm: 0.2 };
        let table = compile::<f64, real::I4F28, 2>(&[curve.as_curve()], &limits).unwrap();
        assert!(!table.as_pieces().is_rational());
    }

    #[test]
    fn what_cannot_be_had_is_refused() {
        let spline =
            TrigSplineBuf::through(&[[0.0], [10.0]], ShapeFactors::symmetric(), Ends::Continued).unwrap();
        let error = |tolerance, degree| spline.to_polynomials(tolerance, degree).unwrap_err();
        assert_eq!(error(0.0, 5), ShapeError::ToleranceNotPositive);
        assert_eq!(error(f64::NAN, 5), ShapeError::ToleranceNotPositive);
        assert_eq!(error(1e-3, 4), ShapeError::DegreeNotOdd { degree: 4 });
        assert_eq!(error(1e-3, 11), ShapeError::DegreeNotOdd { degree: 11 });
        assert_eq!(error(1e-20, 3), ShapeError::TooManyPieces { most: MOST_PIECES });
    }
}
