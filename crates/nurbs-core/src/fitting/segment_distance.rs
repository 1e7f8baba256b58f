//! A proven bound of the distance between a part of a curve and a straight move.
//!
//! The part is a Bezier curve in the convex hull of its control points. If each of them is within a distance of the
//! segment, so is the hull, and the part in it. The other way round: if the part's ends are within the distance of the
//! segment's, the part goes from one of these to the other without a break, so the feet of its points on the segment's line are all that lies between
//! the feet of its ends. The point of the part above such a foot is no farther from the foot than it is from the segment.
//! Beyond the foot of the part's end, the end itself is as near. So one bound holds both ways.
//!
//! Halving the part shrinks its hulls: the bound tends to the distance with the square of their number.

use alloc::vec::Vec;

use real::{Backend, Real};

use crate::polynomials::bezier::{Bezier, computed};
use crate::vector::{over, scaled, sub};
use crate::{NurbsCurve, distance_to_segment};

/// Halvings of a part: 8 hulls.
const HALVINGS: u32 = 3;
/// Rounding of f64 in the halvings, as a share of the largest coordinate about the part's begin: some 20 operations of
/// 2^-53 each.
const ROUNDING: f64 = 1.0 / (1_u64 << 48) as f64;

/// A bound in mm of the distance, both ways, between the part [begin, end] of a curve's span and the segment between two
/// points: each point of the one is at most so far from a point of the other.
///
/// `span` counts spans that are not empty, from 0. Control points are computed in `H`, as in
/// [`compile`](crate::compile): in the double-double, what is rounded there is less than what the bound adds for rounding.
/// In f64 the bound holds up to some 1e-15 of the coordinates.
///
/// Domain: begin and end within the span. NaN where a number is none.
#[must_use]
pub fn distance_from_segment<H: Backend, const D: usize>(
    curve: &NurbsCurve<'_, f64, D>,
    span: usize,
    [begin, end]: [f64; 2],
    segment: &[[f64; D]; 2],
) -> f64 {
    let knot = curve.knots().span_index(span);
    let bezier = Bezier::<H, D>::of_span(curve, knot, computed(begin), computed(end));
    let start = bezier.euclidean(0);
    let seen = |point: &[f64; D]| sub(&point.map(computed::<H>), &start).map(|x| x.to_f64());
    let segment = [seen(&segment[0]), seen(&segment[1])];
    let hull: Vec<([f64; D], f64)> = bezier.relative();
    let largest =
        hull.iter().flat_map(|(point, w)| point.map(|x| x / w)).chain(segment.iter().flatten().copied());
    let largest = largest.fold(0.0, |most: f64, x| most.max(x.abs()));
    let ends = [hull.first(), hull.last()].into_iter().flatten().zip(&segment);
    let ends = ends.map(|((point, w), end)| f64::norm(&sub(&over(point, *w), end)));
    greatest(ends.chain([farthest(hull.clone(), &segment, HALVINGS)])) + ROUNDING * largest
}

/// The largest distance of a control point of the hull's parts. Points are times their weights.
fn farthest<const D: usize>(mut hull: Vec<([f64; D], f64)>, segment: &[[f64; D]; 2], halvings: u32) -> f64 {
    if halvings == 0 {
        return greatest(hull.iter().map(|(point, w)| distance_to_segment(&over(point, *w), segment)));
    }
    let (degree, mut first) = (hull.len() - 1, Vec::with_capacity(hull.len()));
    let mut second = Vec::with_capacity(hull.len());
    for round in 0..=degree {
        first.push(hull[0]);
        second.push(hull[degree - round]);
        for k in 0..degree - round {
            let ((a, v), (b, w)) = (hull[k], hull[k + 1]);
            let middle = core::array::from_fn(|d| a[d] + b[d]);
            hull[k] = (scaled(&middle, 0.5), 0.5 * (v + w));
        }
    }
    second.reverse();
    greatest([first, second].into_iter().map(|half| farthest(half, segment, halvings - 1)))
}

/// The greatest number; NaN if one is none.
fn greatest(numbers: impl Iterator<Item = f64>) -> f64 {
    numbers.fold(0.0, |most: f64, x| if x > most || x.is_nan() { x } else { most })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Differentiate, Evaluate, generate};
    use proptest::prelude::*;
    use real::DoubleDouble;

    /// The largest distance of many points, both ways.
    fn sampled<const D: usize>(
        curve: &NurbsCurve<'_, f64, D>,
        span: usize,
        [begin, end]: [f64; 2],
        segment: &[[f64; D]; 2],
    ) -> f64 {
        let at = |k: u32| curve.derivatives_in(span, begin + (end - begin) * (f64::from(k) / 400.0)).point;
        let points: Vec<_> = (0..=400).map(at).collect();
        let off = points.iter().map(|point| distance_to_segment(point, segment)).fold(0.0, f64::max);
        let back = (0..=100_u32).map(|k| {
            let share = f64::from(k) / 100.0;
            let on = core::array::from_fn(|d| segment[0][d] + share * (segment[1][d] - segment[0][d]));
            points
                .windows(2)
                .map(|pair| distance_to_segment(&on, &[pair[0], pair[1]]))
                .fold(f64::MAX, f64::min)
        });
        back.fold(off, f64::max)
    }

    /// The parabola (u, 4 h u (1 - u)) is h above its chord, and h is 1/8 of what its control points bound.
    #[test]
    fn the_bound_is_near_the_distance() {
        let curve = NurbsCurve::try_new_nonrational(
            2,
            &[[0.0, 0.0], [5.0, 2.0], [10.0, 0.0]],
            &[0.0, 0.0, 0.0, 1.0, 1.0, 1.0],
        );
        let curve = curve.unwrap();
        let segment = [[0.0, 0.0], [10.0, 0.0]];
        let bound = distance_from_segment::<DoubleDouble, 2>(&curve, 0, [0.0, 1.0], &segment);
        assert!((1.0..1.02).contains(&bound), "{bound}");
        // The half from the top on begins as far off as the top is high.
        let half = distance_from_segment::<f64, 2>(&curve, 0, [0.5, 1.0], &[[5.0, 0.0], [10.0, 0.0]]);
        assert!((1.0..1.02).contains(&half), "{half}");
    }

    /// A curve over a part of the segment leaves the rest of it: the ends are far apart.
    #[test]
    fn a_segment_that_goes_farther_is_far() {
        let curve = NurbsCurve::try_new_nonrational(1, &[[0.0], [1.0]], &[0.0, 0.0, 1.0, 1.0]).unwrap();
        let bound = distance_from_segment::<f64, 1>(&curve, 0, [0.0, 1.0], &[[0.0], [3.0]]);
        assert!(bound >= 2.0, "{bound}");
    }

    proptest! {
        /// Also rational curves, parts of spans, and segments that are not the chord.
        #[test]
        fn no_sampled_distance_is_above_the_bound(
            (curve, span, t) in generate::curve_span_and_fraction::<2>(),
            shift in prop::array::uniform2(-0.3..0.3_f64),
        ) {
            let curve = curve.as_curve();
            let (a, b) = curve.span_bounds(span);
            let part = [a, a + (b - a) * (0.5 + 0.5 * t)];
            let mut segment = part.map(|u| curve.derivatives_in(span, u).point);
            segment[1] = [segment[1][0] + shift[0], segment[1][1] + shift[1]];
            let bound = distance_from_segment::<DoubleDouble, 2>(&curve, span, part, &segment);
            let seen = sampled(&curve, span, part, &segment);
            prop_assert!(seen <= bound * (1.0 + 1e-9) + 1e-12, "{seen} above {bound}");
        }
    }
}
