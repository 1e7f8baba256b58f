//! The arc length of the path in a step, from the points at which its chord error is sampled.

use nurbs_core::{Evaluate, FastCurve, arc_length, farthest_from_segment};
use real::Real;

/// Parts into which a step is cut.
const PARTS: usize = 8;

/// An extrapolated length is taken if it differs from the one before by no more than this share of it, and this share of the largest
/// coordinate, to whose last place points are rounded.
const AGREES: [f64; 2] = [1e-12, 8.0 * f64::EPSILON];

/// A curve's part of a step: points at even distances of the parameter, its ends among them.
pub(super) struct Sampled<const D: usize> {
    points: [[f64; D]; PARTS + 1],
}

impl<const D: usize> Sampled<D> {
    /// The points from one parameter over a width to another.
    pub(super) fn of(curve: &FastCurve<'_, D>, begin: f64, width: f64) -> Self {
        let at = |part: usize| begin + width * part as f64 / PARTS as f64;
        Self { points: std::array::from_fn(|part| curve.point(at(part))) }
    }

    /// The largest distance from a chord.
    pub(super) fn farthest_from(&self, chord: &[[f64; D]; 2]) -> f64 {
        farthest_from_segment(self.points.iter().skip(1).copied(), chord)
    }

    /// The arc length, in mm. The lengths of polygons of 1, 2, 4 and 8 sides are extrapolated to that of the curve, as Romberg has it
    /// for an error of even powers; where that does not settle, as at a knot or a corner, the curve is integrated.
    pub(super) fn arc_mm(&self, curve: &FastCurve<'_, D>, begin: f64, width: f64) -> f64 {
        let sides = |stride: usize| {
            let ends = self.points.iter().step_by(stride);
            let others = self.points.iter().skip(stride).step_by(stride);
            ends.zip(others).map(|(from, to)| length(from, to)).sum::<f64>()
        };
        let [l1, l2, l4, l8] = [8, 4, 2, 1].map(sides);
        let better = |fine: f64, coarse: f64, power: f64| fine + (fine - coarse) / (power - 1.0);
        let [a, b, c] = [better(l2, l1, 4.0), better(l4, l2, 4.0), better(l8, l4, 4.0)];
        let [a, b] = [better(b, a, 16.0), better(c, b, 16.0)];
        let found = better(b, a, 64.0);
        let farthest = self.points[0].iter().fold(0.0, |most: f64, x| most.max(x.abs()));
        let tolerance = AGREES[0] * l8 + AGREES[1] * farthest;
        if (found - b).abs() <= tolerance || found.is_nan() {
            return found;
        }
        arc_length(curve, begin, begin + width, tolerance).length
    }
}

fn length<const D: usize>(from: &[f64; D], to: &[f64; D]) -> f64 {
    f64::norm(&std::array::from_fn::<_, D, _>(|d| to[d] - from[d]))
}

#[cfg(test)]
mod tests {
    use nurbs_core::{FastCurve, NurbsBuf};

    use super::*;

    fn arc_of<const D: usize>(curve: &NurbsBuf<f64, D>, begin: f64, end: f64) -> f64 {
        let curve = FastCurve::of(curve.as_curve());
        Sampled::of(&curve, begin, end - begin).arc_mm(&curve, begin, end - begin)
    }

    /// A parabola of known length, and the same with a corner between its halves.
    #[test]
    fn arcs_are_those_of_closed_forms() {
        let parabola = NurbsBuf::try_new_nonrational(
            2,
            vec![[0.0, 0.0], [1.0, 0.0], [2.0, 2.0]],
            vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
        )
        .unwrap();
        // (2u, 2u²): y = x²/2, s = (x √(1 + x²) + asinh x)/2.
        let closed = |u: f64| {
            let x = 2.0 * u;
            (x * (1.0 + x * x).sqrt() + x.asinh()) / 2.0
        };
        for (begin, end) in [(0.0, 1.0), (0.3, 0.31), (0.5, 0.500_01)] {
            let expected = closed(end) - closed(begin);
            let found = arc_of(&parabola, begin, end);
            assert!((found - expected).abs() < 1e-12, "{begin} {end}: {found} {expected}");
        }
        let bent = NurbsBuf::try_new_nonrational(
            1,
            vec![[0.0, 0.0], [3.0, 0.0], [3.0, 4.0]],
            vec![0.0, 0.0, 0.3, 1.0, 1.0],
        )
        .unwrap();
        assert!((arc_of(&bent, 0.0, 1.0) - 7.0).abs() < 1e-12);
        assert!((arc_of(&bent, 0.29, 0.37) - (0.1 + 0.4)).abs() < 1e-12);
    }
}
