//! Random valid curves for property tests, as proptest strategies.
//!
//! Degree 1 to 7. 2 to 20 inner knots: they cluster, with gaps of 1, 1e-2 and 1e-4 relative to each other, and repeat
//! up to `degree` times. Coordinates within ±500 mm. Weights all equal in half of the curves, else 0.01 to 100. Every
//! curve converts to `f32`. A fixed format may refuse a curve whose knots or weights it does not resolve.

use core::ops::RangeInclusive;

use proptest::collection::vec;
use proptest::prelude::*;

use crate::{Evaluate, NurbsBuf};

/// How the next knot follows the one before it.
#[derive(Clone, Copy, Debug)]
enum Gap {
    /// The knot before is repeated, if its multiplicity allows.
    Repeat,
    /// A larger knot.
    Step(f64),
}

fn gap() -> impl Strategy<Value = Gap> {
    prop_oneof![
        4 => (0.2..1.0).prop_map(Gap::Step),
        1 => (0.2..1.0).prop_map(|g: f64| Gap::Step(g * 1e-2)),
        1 => (0.2..1.0).prop_map(|g: f64| Gap::Step(g * 1e-4)),
        2 => Just(Gap::Repeat),
    ]
}

/// A clamped knot vector over [0, 1] from the gaps between its inner knots.
fn clamped_knots(degree: usize, gaps: &[Gap]) -> Vec<f64> {
    let (mut u, mut multiplicity) = (0.0, degree + 1);
    let mut inner = Vec::new();
    for gap in gaps {
        match gap {
            Gap::Repeat if multiplicity < degree => multiplicity += 1,
            Gap::Repeat => (u, multiplicity) = (u + 0.5, 1),
            Gap::Step(step) => (u, multiplicity) = (u + step, 1),
        }
        inner.push(u);
    }
    let end = u + 0.5;
    let start = core::iter::repeat_n(0.0, degree + 1);
    start.chain(inner.into_iter().map(|u| u / end)).chain(core::iter::repeat_n(1.0, degree + 1)).collect()
}

fn weights(count: usize) -> impl Strategy<Value = Vec<f64>> {
    prop_oneof![
        Just(vec![1.0; count]),
        vec((-2.0..2.0).prop_map(|exponent: f64| 10.0_f64.powf(exponent)), count),
    ]
}

/// A random valid curve over [0, 1].
pub fn curve<const D: usize>() -> impl Strategy<Value = NurbsBuf<f64, D>> {
    curve_of_degree(1..=7)
}

/// A random valid curve over [0, 1] of one of these degrees.
pub fn curve_of_degree<const D: usize>(
    degrees: RangeInclusive<usize>,
) -> impl Strategy<Value = NurbsBuf<f64, D>> {
    (degrees, vec(gap(), 2..=20))
        .prop_flat_map(|(degree, gaps)| {
            let knots = clamped_knots(degree, &gaps);
            let count = degree + 1 + gaps.len();
            let coordinates = vec(-500.0..500.0_f64, D * count);
            (Just(degree), coordinates, weights(count), Just(knots))
        })
        .prop_filter_map("the generator makes valid curves", |(degree, coordinates, weights, knots)| {
            let point = |i: usize| core::array::from_fn(|axis| coordinates[i * D + axis]);
            NurbsBuf::try_new(degree, (0..weights.len()).map(point).collect(), weights, knots).ok()
        })
}

/// A random curve, a third of whose control points coincide with the one before them, also at the ends. Not all points
/// coincide.
pub fn curve_with_coincident_points<const D: usize>() -> impl Strategy<Value = NurbsBuf<f64, D>> {
    let repeats = vec(prop_oneof![2 => Just(false), 1 => Just(true)], 1..=28);
    (curve::<D>(), repeats).prop_filter_map("not all points are the same", |(curve, repeats)| {
        let mut points = curve.control_points().to_vec();
        for (i, _) in repeats.iter().cycle().skip(1).enumerate().take(points.len() - 1).filter(|(_, is)| **is)
        {
            points[i + 1] = points[i];
        }
        let moves = points.windows(2).any(|pair| pair[0] != pair[1]);
        let (weights, knots) = (curve.weights().to_vec(), curve.knots().to_vec());
        moves.then(|| NurbsBuf::try_new(curve.degree(), points, weights, knots).ok())?
    })
}

/// A random curve and a parameter in its domain; one in four is a knot.
pub fn curve_and_parameter<const D: usize>() -> impl Strategy<Value = (NurbsBuf<f64, D>, f64)> {
    (curve::<D>(), 0.0..=1.0_f64, any::<prop::sample::Index>(), 0..4).prop_map(|(curve, t, knot, kind)| {
        let (first, last) = curve.as_curve().domain();
        let u = if kind == 0 { *knot.get(curve.knots()) } else { (first + (last - first) * t).min(last) };
        (curve, u)
    })
}

/// A random curve, the number of one of its spans, and a fraction of that span from 0.01 to 0.99.
pub fn curve_span_and_fraction<const D: usize>() -> impl Strategy<Value = (NurbsBuf<f64, D>, usize, f64)> {
    (curve::<D>(), any::<prop::sample::Index>(), 0.01..0.99_f64).prop_map(|(curve, span, t)| {
        let span = span.index(curve.as_curve().span_count());
        (curve, span, t)
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::strategy::ValueTree;
    use proptest::test_runner::TestRunner;

    #[test]
    fn the_generator_covers_what_it_claims() {
        let mut runner = TestRunner::deterministic();
        let (mut rational, mut repeated, mut clustered, mut degrees) = (0, 0, 0, [0; 8]);
        for _ in 0..1000 {
            let curve = curve::<2>().new_tree(&mut runner).unwrap().current();
            let knots = curve.knots();
            degrees[curve.degree()] += 1;
            assert!(curve.convert::<f32>().is_ok(), "{curve:?}");
            rational += usize::from(curve.as_curve().weights().is_some());
            let inner = &knots[curve.degree() + 1..curve.control_points().len()];
            assert!((2..=20).contains(&inner.len()));
            repeated += usize::from(inner.windows(2).any(|k| k[0] == k[1]));
            clustered += usize::from(inner.windows(2).any(|k| k[0] < k[1] && k[1] - k[0] < 1e-4));
        }
        assert!(degrees[1..].iter().all(|n| *n > 50), "{degrees:?}");
        assert!((300..700).contains(&rational), "{rational}");
        assert!(repeated > 500, "{repeated}");
        assert!(clustered > 300, "{clustered}");
    }
}
