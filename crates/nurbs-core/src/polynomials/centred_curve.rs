//! A curve as one polynomial a span about the span's middle, in numbers wider than f64: the reference of a judge.
//!
//! On the span from u_i to u_{i+1}, with s = (2u - u_i - u_{i+1})/(u_{i+1} - u_i) in [-1, 1],
//!
//! `C(s) = O + s (n_1 + n_2 s + … + n_p s^{p-1}) / (1 + w_1 s + … + w_p s^p)`,
//!
//! O is the point in the span's middle. A point takes p multiplications a coordinate and one division; basis functions
//! take p(p + 1)/2 divisions, and p + 1 more if the curve is rational. About the middle the powers lose less than about
//! an end: the Bernstein polynomial `binomial(p, j) ((1 - s)/2)^{p-j} ((1 + s)/2)^j` has coefficients whose magnitudes
//! add up to binomial(p, j), so that all of them together lose 2^p where those about an end lose 3^p.

use alloc::vec::Vec;
use core::array::from_fn;

use real::{Backend, Real};

use crate::NurbsCurve;
use crate::polynomials::bezier::{Bezier, computed};
use crate::polynomials::polynomial::binomial;

/// A NURBS curve of which points are computed in `H`, a float of more digits than its numbers have.
#[derive(Clone, Debug)]
pub struct CentredCurve<H, const D: usize> {
    /// Where each span but the first begins.
    inner: Vec<H>,
    /// The middle of each span, and 2 over its width.
    places: Vec<[H; 2]>,
    /// O, n_1 … n_p of each span.
    rows: Vec<[H; D]>,
    /// w_1 … w_p of each span; empty if the curve is not rational.
    weights: Vec<H>,
    degree: usize,
}

impl<H: Backend, const D: usize> CentredCurve<H, D> {
    /// What the polynomials of a curve may lose, in units of the last place of `H` at the largest coordinate: `2^p`, and
    /// with weights from v to W `2^p (W/v)²`, times the dozen roundings of a point.
    #[must_use]
    pub fn loss(curve: &NurbsCurve<'_, f64, D>) -> f64 {
        let power = (0..curve.degree()).fold(1.0, |power, _| 2.0 * power);
        let Some(weights) = curve.weights() else { return power };
        let (least, most) =
            weights.iter().fold((f64::MAX, 0.0_f64), |(least, most), w| (least.min(*w), most.max(*w)));
        power * (most / least) * (most / least)
    }

    /// Converts a curve. If `H` cannot hold a number of it, points of the spans with that number are NaN.
    #[must_use]
    pub fn new(curve: &NurbsCurve<'_, f64, D>) -> Self {
        let knots = curve.knots().as_slice();
        let degree = curve.degree();
        let mut own =
            Self { inner: Vec::new(), places: Vec::new(), rows: Vec::new(), weights: Vec::new(), degree };
        for span in (degree..curve.control_points().len()).filter(|i| knots[*i] < knots[i + 1]) {
            let [begin, end] = [knots[span], knots[span + 1]].map(computed::<H>);
            if !own.places.is_empty() {
                own.inner.push(begin);
            }
            own.places.push([(begin + end).half(), H::from_ratio(2, 1) / (end - begin)]);
            own.push_span(&Bezier::of_span(curve, span, begin, end));
        }
        own
    }

    fn push_span(&mut self, bezier: &Bezier<H, D>) {
        let powers = centred_powers(self.degree);
        let at = |k: usize, of: &dyn Fn(usize) -> H| {
            H::sum_of_products(powers[k].iter().enumerate().map(|(j, factor)| (of(j), computed(*factor))))
        };
        let unit = at(0, &|j| bezier.weights[j]);
        let origin: [H; D] = from_fn(|d| at(0, &|j| bezier.points[j][d]) / unit);
        self.rows.push(origin);
        self.rows
            .extend((1..=self.degree).map(|k| {
                from_fn(|d| at(k, &|j| bezier.points[j][d] - bezier.weights[j] * origin[d]) / unit)
            }));
        if bezier.rational {
            self.weights.extend((1..=self.degree).map(|k| at(k, &|j| bezier.weights[j]) / unit));
        }
    }

    /// The point at `u`. Beyond the ends the outer polynomials go on.
    ///
    /// Accuracy, u inside the domain: `16 (p + 1)` times [`loss`](Self::loss) units of the last place of the largest
    /// coordinate.
    #[must_use]
    #[inline]
    pub fn point(&self, u: H) -> [H; D] {
        let span = self.inner.partition_point(|begin| *begin <= u);
        let Some([middle, scale]) = self.places.get(span) else { return [H::zero(); D] };
        let s = (u - *middle) * *scale;
        let begin = span * (self.degree + 1);
        let Some([origin, rest @ ..]) = self.rows.get(begin..=begin + self.degree) else {
            return [H::zero(); D];
        };
        let factor = match self.weights.get(span * self.degree..(span + 1) * self.degree) {
            Some(weights) => {
                let [weight] = horner(weights.as_chunks::<1>().0, s);
                s / (weight * s + H::one())
            }
            None => s,
        };
        let offset = horner(rest, s);
        from_fn(|d| origin[d] + offset[d] * factor)
    }
}

/// `Σ rows_k s^k`.
#[inline]
fn horner<H: Real, const N: usize>(rows: &[[H; N]], s: H) -> [H; N] {
    let Some((top, lower)) = rows.split_last() else { return [H::zero(); N] };
    lower.iter().rev().fold(*top, |sum, row| from_fn(|d| sum[d] * s + row[d]))
}

/// Row k has the coefficient of s^k in each Bernstein polynomial of degree p on [-1, 1]: an integer over 2^p, exactly.
fn centred_powers(degree: usize) -> Vec<Vec<f64>> {
    let unit = (0..degree).fold(1.0, |unit, _| 0.5 * unit);
    let columns = (0..=degree).map(|j| {
        let mut powers = Vec::from([binomial(degree, j) * unit]);
        for factor in 0..degree {
            // Times 1 - s, p - j times, and 1 + s, j times.
            let sign = if factor < degree - j { -1.0 } else { 1.0 };
            powers.push(0.0);
            for k in (1..powers.len()).rev() {
                powers[k] += sign * powers[k - 1];
            }
        }
        powers
    });
    let columns: Vec<Vec<f64>> = columns.collect();
    (0..=degree).map(|k| columns.iter().map(|powers| powers[k]).collect()).collect()
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;
    use real::DoubleDouble;

    use super::*;
    use crate::oracle::{self, exactly};
    use crate::{Evaluate, NurbsBuf, generate, golden};

    fn largest<const D: usize>(curve: &NurbsBuf<f64, D>) -> f64 {
        curve.control_points().iter().flatten().fold(0.0, |largest: f64, x| largest.max(x.abs()))
    }

    /// The distance of the form's point from the definition's, over the bound that the form promises.
    fn share_of_bound<const D: usize>(curve: &NurbsBuf<f64, D>, u: DoubleDouble) -> f64 {
        let form = CentredCurve::<DoubleDouble, D>::new(&curve.as_curve());
        let (found, exact) = (form.point(u), oracle::point(&exactly(curve), u));
        let loss = CentredCurve::<DoubleDouble, D>::loss(&curve.as_curve());
        let unit = DoubleDouble::resolution().value() * largest(curve);
        let bound = 16.0 * (curve.degree() + 1) as f64 * loss * unit;
        let off = |d: usize| (found[d] - exact[d]).value().abs();
        (0..D).map(off).fold(0.0, f64::max) / bound
    }

    proptest! {
        #[test]
        fn points_are_those_of_the_definition((curve, u) in generate::curve_and_parameter::<3>(), low in -1.0_f64..1.0) {
            let (first, last) = curve.as_curve().domain();
            let u = DoubleDouble::new(u, low * f64::EPSILON / 2.0 * u);
            if DoubleDouble::from(first) <= u && u <= DoubleDouble::from(last) {
                let share = share_of_bound(&curve, u);
                prop_assert!(share <= 1.0, "C({u:?}): {share}");
            }
        }
    }

    /// Quarters of a circle keep their radius to 30 digits.
    #[test]
    fn a_circle_keeps_its_radius() {
        let circle = golden::circle(10.0);
        let form = CentredCurve::<DoubleDouble, 2>::new(&circle.as_curve());
        let radius = |k: i32| DoubleDouble::norm(&form.point(DoubleDouble::from_ratio(k, 1000)));
        // The weight √½ of the table is off by half a unit of f64's last place, and so is the circle.
        let exact =
            |k: i32| DoubleDouble::norm(&oracle::point(&exactly(&circle), DoubleDouble::from_ratio(k, 1000)));
        let off = |k: i32| (radius(k) - exact(k)).value().abs();
        assert!((1..1000).map(off).fold(0.0, f64::max) < 1e-29);
    }

    #[test]
    fn coefficients_about_the_middle_are_those_of_the_bernstein_polynomials() {
        // (1 - s)²/4, (1 - s²)/2, (1 + s)²/4.
        assert_eq!(centred_powers(2), [[0.25, 0.5, 0.25], [-0.5, 0.0, 0.5], [0.25, -0.5, 0.25]]);
        for degree in 1..=crate::MAX_DEGREE {
            // The magnitudes of one polynomial's coefficients add up to binomial(p, j).
            let rows = centred_powers(degree);
            for j in 0..=degree {
                let sum: f64 = rows.iter().map(|row| row[j].abs()).sum();
                assert!(sum <= binomial(degree, j), "{degree} {j}: {sum}");
            }
        }
    }
}
