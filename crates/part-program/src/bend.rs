//! The length of a curve, and its sharpest bend.
//!
//! The maximum of the curvature has no formula. Each knot span is sampled at [`SAMPLES`] + 1 parameters. Golden
//! sections search the maximum around each sample that bends more than its neighbours, and around each sample at which
//! the curve is slower than at its neighbours: if a bend is too narrow for the samples, the speed dips there. An arc
//! has the same curvature everywhere, so a single sample for each span is enough.
//!
//! Where the curve stands still for a moment it has no curvature. If it is a straight line there, it may turn back.
//! That counts as a bend of radius 0.

use nurbs_core::{Differentiate, Evaluate, arc_length, golden_section, radius};

use crate::curve::Curve;
use crate::moves::Shape;
use crate::vector::{dot, length};

/// Intervals of a knot span between samples.
const SAMPLES: u8 = 16;
/// Golden sections: 40 shrink an interval by 4e-9.
const SECTIONS: usize = 40;
/// Tolerance of the integrated length of a knot span, in mm.
const LENGTH_TOLERANCE_MM: f64 = 1e-7;
/// If an end control point is doubled, the curve starts there with speed 0, and rounding decides the computed bend. So
/// within this share of a span from the end of the curve, places with a speed below [`NO_DIRECTION`] of the fastest are
/// not judged.
const NEAR_END: f64 = 1e-3;
/// See [`NEAR_END`]. Elsewhere, a curve stands still if its speed is below this share of the speed beside.
const NO_DIRECTION: f64 = 1e-5;
/// Only places with a speed below this share of the fastest are tested for a standstill.
const SLOW: f64 = 1e-3;
/// A bend with a larger radius is the rounding of a straight line, in mm: 1000 km.
const STRAIGHT_MM: f64 = 1e9;

/// The length of a curve and its sharpest bend.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Measure {
    /// In mm, within 1e-7 mm a knot span.
    pub(crate) length_mm: f64,
    /// `None` on a straight line.
    pub(crate) sharpest: Option<SharpestBend>,
}

/// A place of a curve with the radius of its bend there.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct SharpestBend {
    pub(crate) parameter: f64,
    pub(crate) point_mm: [f64; 3],
    pub(crate) radius_mm: f64,
}

/// Measures a curve that obeys every rule.
pub(crate) fn measure(curve: &Curve, shape: Shape) -> Measure {
    if curve.degree() == 1 {
        return Measure { length_mm: curve.polygon_length_mm(), sharpest: None };
    }
    let Ok(nurbs) = curve.for_evaluation() else { return Measure::default() };
    let nurbs = nurbs.as_curve();
    let (first, last) = nurbs.domain();
    let length_mm = arc_length(&nurbs, first, last, LENGTH_TOLERANCE_MM).length;
    let mut sharpest: Option<SharpestBend> = None;
    for span in 0..nurbs.span_count() {
        let place = match shape {
            Shape::Arc => {
                place(&nurbs, span, f64::midpoint(nurbs.span_bounds(span).0, nurbs.span_bounds(span).1))
            }
            _ => sharpest_in(&nurbs, span),
        };
        if place.radius_mm < sharpest.map_or(STRAIGHT_MM, |so_far| so_far.radius_mm) {
            sharpest = Some(place);
        }
    }
    Measure { length_mm, sharpest }
}

fn place(curve: &impl Differentiate<f64, 3>, span: usize, parameter: f64) -> SharpestBend {
    let derivatives = curve.derivatives_in(span, parameter);
    SharpestBend { parameter, point_mm: derivatives.point, radius_mm: radius(&derivatives) }
}

fn sharpest_in(curve: &impl Differentiate<f64, 3>, span: usize) -> SharpestBend {
    let search = Search::new(curve, span);
    let middle = place(curve, span, f64::midpoint(search.from, search.to));
    let seen = search.candidates().into_iter().filter_map(|u| search.seen(u));
    seen.fold(middle, |sharpest, seen| if seen.radius_mm < sharpest.radius_mm { seen } else { sharpest })
}

/// The search for the sharpest bend of one knot span.
struct Search<'c, C> {
    curve: &'c C,
    span: usize,
    from: f64,
    to: f64,
    /// Radius and C' of each sample.
    samples: Vec<(f64, [f64; 3])>,
    /// The greatest speed of a sample.
    fastest: f64,
}

impl<'c, C: Differentiate<f64, 3>> Search<'c, C> {
    fn new(curve: &'c C, span: usize) -> Self {
        let (from, to) = curve.span_bounds(span);
        let mut search = Self { curve, span, from, to, samples: Vec::new(), fastest: 0.0 };
        search.samples =
            (0..=SAMPLES).map(|k| (search.bend(search.at(k)), search.first(search.at(k)))).collect();
        search.fastest = search.samples.iter().fold(0.0, |fastest, (_, first)| length(*first).max(fastest));
        search
    }

    /// The parameter of a sample.
    fn at(&self, k: u8) -> f64 {
        self.from + (self.to - self.from) * (f64::from(k) / f64::from(SAMPLES))
    }

    fn first(&self, u: f64) -> [f64; 3] {
        self.curve.derivatives_in(self.span, u).first
    }

    fn speed(&self, u: f64) -> f64 {
        length(self.first(u))
    }

    fn bend(&self, u: f64) -> f64 {
        place(self.curve, self.span, u).radius_mm
    }

    /// Parameters at which the bend may be sharpest.
    fn candidates(&self) -> Vec<f64> {
        let (speed, bend) = (|u| self.speed(u), |u| self.bend(u));
        let within_end = NEAR_END * (self.to - self.from) / 10.0;
        let mut candidates = vec![self.from + within_end, self.to - within_end];
        for k in 0..=SAMPLES {
            let (before, after) = (k.saturating_sub(1), (k + 1).min(SAMPLES));
            let [sample, sample_before, sample_after] =
                [k, before, after].map(|k| self.samples[usize::from(k)]);
            let is_least = |of: fn((f64, [f64; 3])) -> f64| {
                of(sample) <= of(sample_before) && of(sample) <= of(sample_after)
            };
            candidates.push(self.at(k));
            if is_least(|(bend, _)| bend) && sample.0 < STRAIGHT_MM {
                candidates.push(least(self.at(before), self.at(after), bend));
            }
            if is_least(|(_, first)| length(first)) {
                let slowest = least(self.at(before), self.at(after), speed);
                let (from, to) = self.beside(slowest);
                candidates.extend([slowest, least(from, to, bend)]);
            }
            if dot(sample_before.1, sample.1) < 0.0 {
                candidates.push(least(self.at(before), self.at(k), speed));
            }
        }
        candidates
    }

    /// The bend at a parameter; `None` if rounding decides it.
    fn seen(&self, u: f64) -> Option<SharpestBend> {
        let (begin, end) = self.curve.domain();
        let near = NEAR_END * (self.to - self.from);
        let is_near_end = u - begin < near || end - u < near;
        let speed = self.speed(u);
        if is_near_end && speed < NO_DIRECTION * self.fastest {
            return None;
        }
        let seen = place(self.curve, self.span, u);
        let stands_still = !is_near_end && speed < SLOW * self.fastest && {
            let (before, after) = self.beside(u);
            speed <= NO_DIRECTION * self.speed(before).max(self.speed(after))
        };
        Some(if stands_still { SharpestBend { radius_mm: 0.0, ..seen } } else { seen })
    }

    /// The interval of a sixteenth of the samples' distance to both sides, within the span.
    fn beside(&self, u: f64) -> (f64, f64) {
        let width = (self.to - self.from) / f64::from(SAMPLES) / 16.0;
        ((u - width).max(self.from), (u + width).min(self.to))
    }
}

/// The place of the minimum of a function that has only one in [from, to].
fn least(from: f64, to: f64, of: impl Fn(f64) -> f64) -> f64 {
    let least = golden_section((from, to), SECTIONS, of, |y| *y);
    f64::midpoint(least.from, least.to)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::Nurbs;
    use proptest::prelude::*;

    fn bezier(points: Vec<[f64; 3]>, weights: Vec<f64>) -> Curve {
        let degree = points.len() - 1;
        let knots = [vec![0.0; degree + 1], vec![1.0; degree + 1]].concat();
        Nurbs { degree, dimension: 3, control_points_mm: points, weights, knots }.into()
    }

    #[test]
    fn the_vertex_of_a_parabola_is_its_sharpest_bend() {
        // y = x² from -1 to 3: the radius at the vertex is 1/2, at u = 1/4.
        let parabola = bezier(vec![[-1.0, 1.0, 0.0], [1.0, -3.0, 0.0], [3.0, 9.0, 0.0]], vec![1.0; 3]);
        let seen = measure(&parabola, Shape::Nurbs);
        let place = seen.sharpest.unwrap();
        assert!((place.radius_mm - 0.5).abs() < 1e-12 && (place.parameter - 0.25).abs() < 1e-6, "{place:?}");
        // ∫ √(1 + 4x²) dx = x √(1 + 4x²) / 2 + asinh(2x) / 4.
        let part = |x: f64| x * (1.0 + 4.0 * x * x).sqrt() / 2.0 + (2.0 * x).asinh() / 4.0;
        assert!((seen.length_mm - (part(3.0) - part(-1.0))).abs() < 1e-9, "{}", seen.length_mm);
    }

    #[test]
    fn a_straight_spline_has_no_bend_and_a_cusp_has_the_radius_0() {
        let straight = bezier(vec![[0.0; 3], [1.0, 1.0, 1.0], [4.0, 4.0, 4.0]], vec![1.0, 2.0, 1.0]);
        assert_eq!(measure(&straight, Shape::Nurbs).sharpest, None);
        // A cusp off the samples: C' = 0 at u = 0.3, where both coordinates have a double root or a triple one.
        let cusp: Vec<[f64; 3]> = (0..4_u8)
            .map(|j| {
                // Blossoms of (u - 0.3)² and (u - 0.3)³ at 3 - j zeros and j ones.
                let ones = f64::from(j);
                let (zeros, a, b) = (3.0 - ones, 0.7, -0.3);
                let pairs = (ones * (ones - 1.0) * a * a
                    + 2.0 * ones * zeros * a * b
                    + zeros * (zeros - 1.0) * b * b)
                    / 6.0;
                [pairs, f64::powf(a, ones) * f64::powi(b, 3 - i32::from(j)), 0.0]
            })
            .collect();
        let place = measure(&bezier(cusp, vec![1.0; 4]), Shape::Nurbs).sharpest.unwrap();
        assert!((place.parameter - 0.3).abs() < 1e-5 && place.radius_mm < 1e-6, "{place:?}");
    }

    /// On a straight line the radius is infinite on both sides of the place where the line turns back.
    #[test]
    fn a_straight_spline_that_turns_back_has_a_cusp() {
        // C' = 2 [20 (1 - u) - 15 u] = 0 at u = 4/7.
        let back = bezier(vec![[0.0; 3], [20.0, 0.0, 0.0], [5.0, 0.0, 0.0]], vec![1.0; 3]);
        let place = measure(&back, Shape::Nurbs).sharpest.unwrap();
        assert!(place.radius_mm == 0.0 && (place.parameter - 4.0 / 7.0).abs() < 1e-6, "{place:?}");
        let scaled = |x: &[f64]| x.iter().map(|x| [2.0 * x, -x, 0.5 * x]).collect::<Vec<_>>();
        for (what, points, weights) in [
            ("twice", scaled(&[0.0, 9.0, -5.0, 3.0]), vec![1.0; 4]),
            // x = (u - 1/2)³: it stands still and goes on.
            ("on", scaled(&[-1.0, 1.0, -1.0, 1.0]), vec![1.0; 4]),
            ("rational", scaled(&[0.0, 1.0, 9.0, 3.0]), vec![1.0, 0.2, 7.0, 2.0]),
            ("quintic", scaled(&[0.0, 1.0, 2.0, 1.5, 9.0, 3.0]), vec![1.0; 6]),
        ] {
            let place = measure(&bezier(points, weights), Shape::Nurbs).sharpest;
            assert!(place.is_some_and(|place| place.radius_mm == 0.0), "{what}: {place:?}");
        }
        // At a knot where two spans end.
        let at_knot = Nurbs {
            degree: 2,
            dimension: 2,
            control_points_mm: scaled(&[0.0, 1.0, 1.0, 0.0]),
            weights: vec![1.0; 4],
            knots: vec![0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0],
        };
        assert_eq!(measure(&at_knot.into(), Shape::Nurbs).sharpest.map(|place| place.radius_mm), Some(0.0));
    }

    #[test]
    fn an_end_without_speed_is_no_bend() {
        for end in [[9.0, 7.0, 3.0], [1.0, 1.0, 1.0], [0.3, -0.7, 100.0]] {
            let twice = bezier(vec![[0.1, 0.2, 0.3], [0.1, 0.2, 0.3], end], vec![1.0; 3]);
            let bend = measure(&twice, Shape::Nurbs).sharpest;
            assert!(bend.is_none_or(|place| place.radius_mm > 1e3), "{bend:?}");
        }
    }

    proptest! {
        /// x never turns back: |C'| ≥ p/2 with steps of at least 1/2. Steps differ by at most (4.5, 20, 6), so |C''| ≤ 21.4 p (p - 1), and
        /// the radius is at least |C'|²/|C''| ≥ p/(86 (p - 1)) > 0.01.
        #[test]
        fn a_curve_that_never_stands_still_has_no_cusp(
            steps in prop::collection::vec([0.5..5.0_f64, -10.0..10.0_f64, -3.0..3.0_f64], 2..6),
            is_straight in any::<bool>(),
        ) {
            let mut point = [0.0; 3];
            let mut points = vec![point];
            for step in steps {
                let step = if is_straight { [step[0], 0.0, 0.0] } else { step };
                point = std::array::from_fn(|axis| point[axis] + step[axis]);
                points.push(point);
            }
            let weights = vec![1.0; points.len()];
            let sharpest = measure(&bezier(points, weights), Shape::Nurbs).sharpest;
            prop_assert!(sharpest.is_none_or(|place| place.radius_mm > 0.01 && !is_straight), "{sharpest:?}");
        }

        /// Of 5000 bends sampled, none is sharper by more than a hundredth.
        #[test]
        fn no_sharper_bend_is_found_by_looking_everywhere(
            points in prop::collection::vec([-10.0..10.0_f64, -10.0..10.0_f64, -3.0..3.0_f64], 3..6),
            weights in prop::collection::vec(0.2..5.0_f64, 6),
        ) {
            let weights = weights[..points.len()].to_vec();
            let curve = bezier(points, weights);
            let found = measure(&curve, Shape::Nurbs).sharpest.map_or(STRAIGHT_MM, |place| place.radius_mm);
            let nurbs = curve.for_evaluation().unwrap();
            let seen = (0..=5000).map(|k| place(&nurbs.as_curve(), 0, f64::from(k) / 5000.0).radius_mm);
            let least = seen.fold(STRAIGHT_MM, f64::min);
            prop_assert!(found <= 1.01 * least, "{found} of {least}");
        }
    }
}
