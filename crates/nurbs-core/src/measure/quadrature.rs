//! Gauss-Legendre quadrature with five points: exact for polynomials up to degree nine.

use real::Real;

/// Points and weights on [0, 1].
///
/// With `r = √(10/7)` the points are `½` and `½ ± √(5/9 ± (2/9) r)/2`, the weights `64/225` and
/// `161/900 ± (91/1800) r`, the larger for the inner points. They are computed in R, because ratios of 32-bit integers
/// would be good for nine digits only. No intermediate is as large as 2.
#[derive(Clone, Copy, Debug)]
pub struct GaussLegendre<R> {
    /// The points, rising.
    pub points: [R; 5],
    /// Their weights; the sum is 1, up to rounding.
    pub weights: [R; 5],
}

impl<R: Real> GaussLegendre<R> {
    /// The rule in this format, within two units of the resolution.
    #[must_use]
    #[allow(clippy::new_without_default, reason = "there is one rule, and no plainer one")]
    pub fn new() -> Self {
        let r = R::from_ratio(10, 7).sqrt();
        let half = R::one().half();
        let inner = (R::from_ratio(5, 9) - R::from_ratio(2, 9) * r).sqrt().half();
        let outer = (R::from_ratio(5, 9) + R::from_ratio(2, 9) * r).sqrt().half();
        let heavy = R::from_ratio(161, 900) + R::from_ratio(91, 1800) * r;
        let light = R::from_ratio(161, 900) - R::from_ratio(91, 1800) * r;
        Self {
            points: [half - outer, half - inner, half, half + inner, half + outer],
            weights: [light, heavy, R::from_ratio(64, 225), heavy, light],
        }
    }

    /// Mean of a function over [0, 1] from its values at the points.
    pub fn mean(&self, values: &[R; 5]) -> R {
        R::sum_of_products(self.weights.into_iter().zip(*values))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use real::{Backend, DoubleDouble, I2F30, I3F29, I4F28, I4F60, I8F24, I16F16, I32F32};

    #[test]
    fn powers_up_to_nine_are_integrated_exactly() {
        let rule = GaussLegendre::<DoubleDouble>::new();
        let off = |power| {
            let powers =
                rule.points.map(|x| (0..power).fold(DoubleDouble::from(1.0), |product, _| product * x));
            (rule.mean(&powers) - DoubleDouble::from_ratio(1, power + 1)).value().abs()
        };
        for power in 0..=9 {
            assert!(off(power) < 1e-30, "x^{power}: {}", off(power));
        }
        // Degree ten is the first that is not: the rule has no more points than it says.
        assert!(off(10) > 1e-7);
    }

    /// 5 and √70 of the usual form do not fit all of these.
    #[test]
    fn every_format_has_the_rule_to_two_units() {
        fn check<R: Backend>() {
            let (rule, exact) = (GaussLegendre::<R>::new(), GaussLegendre::<DoubleDouble>::new());
            let found = rule.points.iter().chain(&rule.weights);
            for (found, exact) in found.zip(exact.points.iter().chain(&exact.weights)) {
                let off = (DoubleDouble::from(found.to_f64()) - *exact).value().abs();
                // f64 has no more of a number below 1.
                let units = off / R::resolution().to_f64().max(f64::EPSILON / 2.0);
                assert!(units <= 2.0, "{}: {found:?} is {units} units off", R::name());
            }
        }
        check::<f64>();
        check::<f32>();
        check::<I2F30>();
        check::<I3F29>();
        check::<I4F28>();
        check::<I8F24>();
        check::<I16F16>();
        check::<I32F32>();
        check::<I4F60>();
    }
}
