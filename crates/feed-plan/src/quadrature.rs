//! Gauss-Legendre quadrature with five points: exact for polynomials up to degree nine.

use real::Real;

/// Number of points.
pub(crate) const POINTS: usize = 5;

/// Points and weights on [0, 1].
///
/// With `r = √(10/7)` the points are `½` and `½ ± √(5/9 ± (2/9) r)/2`, the weights `64/225` and
/// `161/900 ± (91/1800) r`, the larger for the inner points. They are computed in R: written as ratios of
/// 32-bit integers they would be good for nine digits only.
#[derive(Clone, Copy, Debug)]
pub(crate) struct GaussLegendre<R> {
    pub(crate) points: [R; POINTS],
    pub(crate) weights: [R; POINTS],
}

impl<R: Real> GaussLegendre<R> {
    pub(crate) fn new() -> Self {
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
    pub(crate) fn mean(&self, values: &[R; POINTS]) -> R {
        R::sum_of_products(self.weights.into_iter().zip(*values))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn powers_up_to_nine_are_integrated_exactly() {
        let rule = GaussLegendre::<f64>::new();
        for power in 0..=9 {
            let mean = rule.mean(&rule.points.map(|x| x.powi(power)));
            assert!((mean - 1.0 / f64::from(power + 1)).abs() < 1e-15, "x^{power}: {mean}");
        }
        // Degree ten is the first that is not: the rule has no more points than it says.
        assert!((rule.mean(&rule.points.map(|x| x.powi(10))) - 1.0 / 11.0).abs() > 1e-7);
    }
}
