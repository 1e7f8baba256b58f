//! Cubic trigonometric interpolation splines: curves of [segments](TrigSegment), by themselves or through points.

#[cfg(feature = "alloc")]
use real::Backend;
use real::Real;

#[cfg(feature = "alloc")]
use crate::ShapeFactors;
use crate::vector::scaled;
#[cfg(feature = "alloc")]
use crate::vector::{add, sub};
use crate::{Derivatives, Differentiate, Evaluate, ShapeError, TrigSegment};

/// A curve of N segments, each over a unit of the parameter: segment i over [i, i + 1]. Borrowed, for flash.
///
/// A segment that is a part of a whole one covers one unit of the parameter too.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TrigSpline<'a, R, const D: usize> {
    segments: &'a [TrigSegment<R, D>],
}

impl<'a, R: Real, const D: usize> TrigSpline<'a, R, D> {
    /// The curve of these segments. The caller takes care that each begins where the one before ends.
    ///
    /// # Errors
    /// [`ShapeError::TooFewPoints`] without segments; [`ShapeError::TooManySegments`] when the format cannot count them.
    pub fn try_new(segments: &'a [TrigSegment<R, D>]) -> Result<Self, ShapeError> {
        let found = segments.len();
        if found == 0 {
            return Err(ShapeError::TooFewPoints { least: 4, found });
        }
        if i32::try_from(found).is_err() || number::<R>(found) - number::<R>(found - 1) != R::one() {
            return Err(ShapeError::TooManySegments { found });
        }
        Ok(Self { segments })
    }

    /// The segments.
    #[must_use]
    pub fn segments(&self) -> &'a [TrigSegment<R, D>] {
        self.segments
    }

    /// The segment at `u`; the last one at the end of the curve.
    fn find_segment(&self, u: R) -> usize {
        let (mut low, mut high) = (0, self.segments.len());
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            if u < number(middle) { high = middle } else { low = middle }
        }
        low
    }

    /// Segment `index`, or the last one; its own parameter at `u`; and the derivative of that parameter by `u`.
    fn local(&self, index: usize, u: R) -> Option<(&'a TrigSegment<R, D>, R, R)> {
        let index = index.min(self.segments.len().saturating_sub(1));
        let segment = self.segments.get(index)?;
        let (begin, end) = segment.domain();
        let width = end - begin;
        Some((segment, (u - number(index)).mul_add(width, begin), width))
    }
}

/// A count as a number of the format; saturates.
fn number<R: Real>(count: usize) -> R {
    i32::try_from(count).map_or(R::max_value(), |count| R::from_ratio(count, 1))
}

impl<R: Real, const D: usize> Evaluate<R, D> for TrigSpline<'_, R, D> {
    /// From 0 to the number of segments.
    fn domain(&self) -> (R, R) {
        (R::zero(), number(self.segments.len()))
    }

    /// The point of the [segment](TrigSegment) at `u`.
    fn point(&self, u: R) -> [R; D] {
        let found = self.local(self.find_segment(u), u);
        found.map_or([R::zero(); D], |(segment, local, _)| segment.point(local))
    }

    fn span_count(&self) -> usize {
        self.segments.len()
    }

    fn span_bounds(&self, span: usize) -> (R, R) {
        let span = span.min(self.segments.len().saturating_sub(1));
        (number(span), number(span + 1))
    }
}

impl<R: Real, const D: usize> Differentiate<R, D> for TrigSpline<'_, R, D> {
    fn derivatives(&self, u: R) -> Derivatives<R, D> {
        self.derivatives_in(self.find_segment(u), u)
    }

    fn derivatives_in(&self, span: usize, u: R) -> Derivatives<R, D> {
        let Some((segment, local, width)) = self.local(span, u) else {
            return Derivatives::default();
        };
        let Derivatives { point, first, second } = segment.derivatives(local);
        Derivatives { point, first: scaled(&first, width), second: scaled(&scaled(&second, width), width) }
    }
}

/// How a free curve ends: its last segment needs two more points than the two that it joins.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Ends {
    /// The last two points only shape the curve, as in the paper: of n points it passes the first n - 2.
    AsGiven,
    /// The last chord goes on straight for two more: the curve passes every point. The default.
    #[default]
    Continued,
    /// The last point is repeated: the curve passes every point, and reaches the last with `P' = 0`.
    Repeated,
    /// The first points follow the last: the curve passes every point and closes with equal first derivative.
    Closed,
}

/// A spline that owns its segments.
#[cfg(feature = "alloc")]
#[derive(Clone, Debug, PartialEq)]
pub struct TrigSplineBuf<R, const D: usize> {
    segments: alloc::vec::Vec<TrigSegment<R, D>>,
}

#[cfg(feature = "alloc")]
impl<R: Real, const D: usize> TrigSplineBuf<R, D> {
    /// The curve of these segments.
    ///
    /// # Errors
    /// Those of [`TrigSpline::try_new`].
    pub fn try_new(segments: alloc::vec::Vec<TrigSegment<R, D>>) -> Result<Self, ShapeError> {
        TrigSpline::try_new(&segments)?;
        Ok(Self { segments })
    }

    /// The free curve through `points`, segment i from point i to point i + 1, with equal first derivative at the joints.
    ///
    /// # Errors
    /// [`ShapeError::TooFewPoints`]: [`Ends::AsGiven`] takes four, [`Ends::Closed`] three, the others two;
    /// those of [`TrigSegment::try_new`] and [`TrigSpline::try_new`].
    pub fn through(points: &[[R; D]], shape: ShapeFactors<R>, ends: Ends) -> Result<Self, ShapeError> {
        let least = match ends {
            Ends::AsGiven => 4,
            Ends::Closed => 3,
            Ends::Continued | Ends::Repeated => 2,
        };
        let (Some(last), true) = (points.last(), points.len() >= least) else {
            return Err(ShapeError::TooFewPoints { least, found: points.len() });
        };
        let mut sequence = points.to_vec();
        match ends {
            Ends::AsGiven => {}
            Ends::Repeated => sequence.extend([*last; 2]),
            Ends::Closed => sequence.extend_from_slice(&points[..3]),
            Ends::Continued => {
                let chord = sub(last, &points[points.len() - 2]);
                let beyond = add(last, &chord);
                sequence.extend([beyond, add(&beyond, &chord)]);
            }
        }
        let segment = |q: &[[R; D]]| TrigSegment::try_new([q[0], q[1], q[2], q[3]], shape);
        Self::try_new(sequence.windows(4).map(segment).collect::<Result<_, _>>()?)
    }

    /// The curve, borrowed; no check is repeated.
    #[must_use]
    pub fn as_spline(&self) -> TrigSpline<'_, R, D> {
        TrigSpline { segments: &self.segments }
    }
}

#[cfg(feature = "alloc")]
impl<const D: usize> TrigSplineBuf<f64, D> {
    /// The curve with every number rounded to the nearest of another format.
    ///
    /// # Errors
    /// [`ShapeError::OutOfRange`]; [`ShapeError::ExtentTooWide`]; [`ShapeError::PartOutsideSegment`] when a part vanishes;
    /// [`ShapeError::TooManySegments`].
    pub fn convert<Q: Backend>(&self) -> Result<TrigSplineBuf<Q, D>, ShapeError> {
        let segments = self.segments.iter().map(TrigSegment::convert).collect::<Result<_, _>>()?;
        TrigSplineBuf::try_new(segments)
    }
}

#[cfg(all(test, feature = "alloc"))]
mod tests {
    use super::*;
    use crate::curvature;
    use crate::shapes::trig_segment::quarter_circle;
    use proptest::prelude::*;
    use real::{Backend, DoubleDouble, I8F24, I16F16, I16F48};

    fn factors<R: Backend>(lambda: f64, k: f64) -> ShapeFactors<R> {
        ShapeFactors { lambda: R::from_f64(lambda).unwrap(), k: R::from_f64(k).unwrap() }
    }

    fn points() -> impl Strategy<Value = Vec<[f64; 2]>> {
        proptest::collection::vec([-8.0..8.0, -8.0..8.0], 4..12)
    }

    /// The largest difference of two vectors along an axis.
    fn off<R: Backend, const D: usize>(a: [R; D], b: [R; D]) -> f64 {
        a.into_iter().zip(b).map(|(x, y)| (x - y).to_f64().abs()).fold(0.0, f64::max)
    }

    /// Passes its points exactly; joints have one first derivative, within `tolerance`.
    fn interpolates<R: Backend>(
        points: &[[f64; 2]],
        lambda: f64,
        k: f64,
        tolerance: f64,
    ) -> Result<(), TestCaseError> {
        let number = |x: f64| R::from_f64(x).unwrap();
        let points: Vec<[R; 2]> = points.iter().map(|p| p.map(number)).collect();
        for ends in [Ends::AsGiven, Ends::Continued, Ends::Repeated, Ends::Closed] {
            let curve = TrigSplineBuf::through(&points, factors(lambda, k), ends).unwrap();
            let spline = curve.as_spline();
            let passed = match ends {
                Ends::AsGiven => points.len() - 2,
                Ends::Continued | Ends::Repeated => points.len(),
                Ends::Closed => points.len() + 1,
            };
            prop_assert_eq!(spline.span_count(), passed - 1);
            for i in 0..passed {
                let expected = points[i % points.len()];
                prop_assert!(spline.point(super::number(i)) == expected, "{} {ends:?} {i}", R::name());
            }
            let last = spline.span_count() - 1;
            for i in 0..=last {
                let next = if i < last { i + 1 } else { 0 };
                if i == last && ends != Ends::Closed {
                    continue;
                }
                let end = spline.derivatives_in(i, super::number(i + 1)).first;
                let begin = spline.derivatives_in(next, super::number(next)).first;
                prop_assert!(off(end, begin) <= tolerance, "{} {ends:?} {i}: {end:?}, {begin:?}", R::name());
            }
        }
        Ok(())
    }

    proptest! {
        #[test]
        fn free_curves_pass_their_points_and_join_smoothly(points in points(), lambda in -2.0..2.0, k in -2.0..2.0) {
            interpolates::<f64>(&points, lambda, k, 1e-12)?;
            interpolates::<f32>(&points, lambda, k, 1e-3)?;
            interpolates::<I8F24>(&points, lambda, k, 1e-4)?;
            interpolates::<I16F48>(&points, lambda, k, 1e-10)?;
            interpolates::<DoubleDouble>(&points, lambda, k, 1e-27)?;
        }

        #[test]
        fn end_derivatives_are_the_papers(points in points(), lambda in -2.0..2.0, k in -2.0..2.0) {
            let q = [points[0], points[1], points[2], points[3]];
            let segment = TrigSegment::try_new(q, factors(lambda, k)).unwrap();
            let expected = |i: usize| -> [f64; 2] {
                sub(&sub(&q[i + 1], &q[i]), &scaled(&sub(&q[i + 2], &q[i + 1]), k))
            };
            prop_assert!(off(segment.derivatives(0.0).first, expected(0)) < 1e-12);
            prop_assert!(off(segment.derivatives(1.0).first, expected(1)) < 1e-12);
        }

        #[test]
        fn a_segment_in_a_format_is_within_the_documented_units(points in points(), u in 0.0..=1.0,
                                                                lambda in -2.0..2.0, k in -2.0..2.0) {
            fn check<R: Backend>(q: [[f64; 2]; 4], u: f64, lambda: f64, k: f64) -> Result<(), TestCaseError> {
                let exactly = |x: R| DoubleDouble::new(x.to_f64_pair().0, x.to_f64_pair().1);
                let number = |x: f64| R::from_f64(x).unwrap();
                let (points, shape, u) = (q.map(|p| p.map(number)), factors::<R>(lambda, k), number(u));
                let exact_shape = ShapeFactors { lambda: exactly(shape.lambda), k: exactly(shape.k) };
                let exact = TrigSegment::try_new(points.map(|p| p.map(exactly)), exact_shape).unwrap().point(exactly(u));
                let found = TrigSegment::try_new(points, shape).unwrap().point(u);
                for d in 0..2 {
                    let arms: f64 = [0, 2, 3].iter().map(|j| (q[*j][d] - q[1][d]).abs()).sum();
                    let bound = (12.0 * arms + 1.0) * R::resolution().to_f64();
                    let error = (exactly(found[d]) - exact[d]).value().abs();
                    prop_assert!(error <= bound, "{}: {error} > {bound}", R::name());
                }
                Ok(())
            }
            let q = [points[0], points[1], points[2], points[3]];
            check::<I8F24>(q, u, lambda, k)?;
            check::<I16F48>(q, u, lambda, k)?;
        }
    }

    #[test]
    fn the_line_is_straight_and_stands_still_at_its_ends() {
        fn check<R: Backend>(units: f64) {
            let (b, c) = ([1.5, -2.0], [4.0, 3.0]);
            let number = |x: f64| R::from_f64(x).unwrap();
            for lambda in [0.0, 0.6, 1.0, 2.0] {
                let q = [b, c, b, c].map(|p| p.map(number));
                let line = TrigSegment::try_new(q, factors(lambda, -1.0)).unwrap();
                for step in 0..=64 {
                    let [x, y] = line.point(R::from_ratio(step, 64)).map(|v| v.to_f64());
                    // Distance from the line through (1.5, -2) with the direction (1, 2)/√5.
                    let distance = ((x - 1.5) * 2.0 - (y + 2.0)).abs() / 5.0_f64.sqrt();
                    let bound = units * R::resolution().to_f64();
                    assert!(distance <= bound, "{} at {step}: {distance} > {bound}", R::name());
                }
                if lambda == 0.0 {
                    assert!(line == TrigSegment::line(q[0], q[1]).unwrap());
                    for end in [R::zero(), R::one()] {
                        let first = line.derivatives(end).first;
                        assert!(off(first, [R::zero(); 2]) <= 60.0 * R::resolution().to_f64(), "{first:?}");
                    }
                }
            }
        }
        check::<f64>(8.0);
        check::<f32>(8.0);
        check::<I8F24>(1.0); // B_0 + B_1 + B_2 + B_3 is 1, and what B and C share is rounded once an axis
        check::<I16F48>(1.0);
    }

    #[test]
    fn the_quarter_circle_is_exact_for_every_lambda() {
        fn check<R: Backend>(units: f64) {
            let number = |x: f64| R::from_f64(x).unwrap();
            let radius = 4.0;
            let [a, b] = [[radius, 0.0], [0.0, radius]].map(|p| p.map(number));
            let of_one = quarter_circle(&[R::zero(); 2], &a, &b).unwrap();
            for lambda in [0.0, 0.6, 1.0, 2.0] {
                let quarter = TrigSegment::try_new(*of_one.control_points(), factors(lambda, -1.0)).unwrap();
                for step in 0..=64 {
                    let derivatives = quarter.derivatives(R::from_ratio(step, 64));
                    let [x, y] = derivatives.point.map(|v| v.to_f64());
                    let error = (x.hypot(y) - radius).abs();
                    let bound = units * R::resolution().to_f64();
                    assert!(error <= bound, "{} λ={lambda} at {step}: {error} > {bound}", R::name());
                    let bend = (curvature(&derivatives).to_f64() - 0.25).abs();
                    assert!(bend <= 30.0 * R::resolution().to_f64(), "{} λ={lambda}: {bend}", R::name());
                }
            }
        }
        // The radius is 4, the third point 7.4 from the second: a few units each.
        check::<f64>(32.0);
        check::<f32>(32.0);
        check::<I8F24>(32.0);
        check::<I16F48>(32.0);
    }

    #[test]
    fn the_curves_of_the_papers_figures() {
        let table = include_str!("../../../../data/trig-spline-figures.csv");
        let rows = table.lines().filter(|line| line.starts_with(|c: char| c.is_ascii_digit()));
        let [a, b, c, d] = [[0.0, 0.0], [10.0, 30.0], [40.0, 35.0], [50.0, 5.0]];
        let mut count = 0;
        for row in rows {
            let numbers: Vec<f64> = row.split(',').map(|x| x.parse().unwrap()).collect();
            let [figure, lambda, k, u, x, y] = numbers[..] else { panic!("{row}") };
            let q = if figure == 1.0 { [a, b, c, d] } else { [b, b, c, d] };
            let found = TrigSegment::try_new(q, factors(lambda, k)).unwrap().point(u);
            assert!(off(found, [x, y]) <= 4e-14, "{row}: {found:?}");
            count += 1;
        }
        assert_eq!(count, 2 * 4 * 9);
    }

    #[test]
    fn parts_and_segments_have_the_documented_domains() {
        let whole = TrigSegment::try_new([[0.0], [1.0], [2.0], [3.0]], factors::<f64>(1.0, -1.0)).unwrap();
        let part = whole.part(0.25, 0.75).unwrap();
        let spline = TrigSplineBuf::try_new(alloc::vec![whole, part]).unwrap();
        let spline = spline.as_spline();
        assert_eq!((spline.domain(), part.domain()), ((0.0, 2.0), (0.25, 0.75)));
        assert_eq!(spline.point(1.5), whole.point(0.5));
        assert_eq!(spline.derivatives(1.5).first, [whole.derivatives(0.5).first[0] * 0.5]);
        assert_eq!(spline.derivatives(1.5).second, [whole.derivatives(0.5).second[0] * 0.25]);
        assert_eq!((spline.span_bounds(0), spline.span_bounds(9)), ((0.0, 1.0), (1.0, 2.0)));
        for (begin, end) in [(-0.1, 0.5), (0.5, 0.5), (0.5, 1.1), (f64::NAN, 1.0)] {
            assert_eq!(whole.part(begin, end), Err(ShapeError::PartOutsideSegment));
        }
    }

    #[test]
    fn what_is_no_spline_is_refused() {
        let shape = factors::<f64>(1.0, -1.0);
        let through =
            |count: usize, ends| TrigSplineBuf::through(&alloc::vec![[1.0]; count], shape, ends).err();
        let too_few = |least, found| Some(ShapeError::TooFewPoints { least, found });
        assert_eq!(through(3, Ends::AsGiven), too_few(4, 3));
        assert_eq!(through(2, Ends::Closed), too_few(3, 2));
        assert_eq!(through(1, Ends::Continued), too_few(2, 1));
        assert_eq!(through(0, Ends::Repeated), too_few(2, 0));
        assert_eq!(through(2, Ends::Repeated), None);
        let not_finite = TrigSegment::try_new([[f64::NAN]; 4], shape).unwrap_err();
        assert_eq!(not_finite, ShapeError::NotFinite { what: "a control point" });
        // Eight segments do not fit ±8.
        let narrow = TrigSegment::try_new([[real::I4F28::from_ratio(1, 1)]; 4], factors(1.0, -1.0)).unwrap();
        assert_eq!(TrigSpline::try_new(&[narrow; 8]), Err(ShapeError::TooManySegments { found: 8 }));
        assert!(TrigSpline::try_new(&[narrow; 7]).is_ok());
        let far = TrigSplineBuf::through(&[[0.0], [1000.0]], shape, Ends::Repeated).unwrap();
        assert_eq!(far.convert::<I8F24>(), Err(ShapeError::OutOfRange { what: "a control point" }));
    }
    #[test]
    fn control_points_too_far_apart_are_refused() {
        let points = [[-100.0, 0.0], [100.0, 0.0], [100.0, 10.0], [-100.0, 10.0]];
        let spline = TrigSplineBuf::through(&points, factors(1.0, -1.0), Ends::AsGiven).unwrap();
        assert_eq!(spline.convert::<I8F24>(), Err(ShapeError::ExtentTooWide { axis: 0 }));
        assert!(spline.convert::<I16F16>().is_ok());
    }
}
