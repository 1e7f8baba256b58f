//! Straight moves.

#[cfg(feature = "alloc")]
use alloc::vec::Vec;

#[cfg(feature = "alloc")]
use real::Backend;
use real::Real;

#[cfg(feature = "alloc")]
use crate::NurbsBuf;
use crate::nurbs::curve::axis_too_wide;
#[cfg(feature = "alloc")]
use crate::shapes::rounded::round_all;
use crate::vector::{add, dot, scaled, sub, weighted_sum};
use crate::{Derivatives, Differentiate, Evaluate, ShapeError};

/// The line `(1 - u) A + u B`, u in [0, 1].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Line<R, const D: usize> {
    ends: [[R; D]; 2],
}

impl<R: Real, const D: usize> Line<R, D> {
    /// The line from A to B.
    ///
    /// # Errors
    /// [`ShapeError::NotFinite`]; [`ShapeError::ExtentTooWide`] when a component of B - A does not fit the format.
    pub fn try_new(a: [R; D], b: [R; D]) -> Result<Self, ShapeError> {
        let ends = [a, b];
        if !ends.iter().flatten().all(|x| x.is_finite()) {
            return Err(ShapeError::NotFinite { what: "an end of a line" });
        }
        match axis_too_wide(&ends, R::max_value()) {
            Some(axis) => Err(ShapeError::ExtentTooWide { axis }),
            None => Ok(Self { ends }),
        }
    }

    /// A and B.
    #[must_use]
    pub fn ends(&self) -> &[[R; D]; 2] {
        &self.ends
    }

    /// `|B - A|`.
    #[must_use]
    pub fn length(&self) -> R {
        R::norm(&self.difference())
    }

    /// B - A.
    fn difference(&self) -> [R; D] {
        sub(&self.ends[1], &self.ends[0])
    }
}

#[cfg(feature = "alloc")]
impl<const D: usize> Line<f64, D> {
    /// The line with every number rounded to the nearest of another format.
    ///
    /// # Errors
    /// [`ShapeError::OutOfRange`]; [`ShapeError::ExtentTooWide`].
    pub fn convert<Q: Backend>(&self) -> Result<Line<Q, D>, ShapeError> {
        let [a, b] = self.ends.map(|end| round_all(&end, "an end of a line"));
        Line::try_new(a?, b?)
    }

    /// The line as a NURBS curve of degree 1 over [0, 1]: the same points.
    ///
    /// # Errors
    /// [`ShapeError::Curve`] when the numbers do not make a curve.
    pub fn to_nurbs(&self) -> Result<NurbsBuf<f64, D>, ShapeError> {
        Ok(NurbsBuf::try_new_nonrational(1, self.ends.to_vec(), Vec::from([0.0, 0.0, 1.0, 1.0]))?)
    }
}

impl<R: Real, const D: usize> Evaluate<R, D> for Line<R, D> {
    fn domain(&self) -> (R, R) {
        (R::zero(), R::one())
    }

    /// Exactly A and B at the ends. In between, within one unit of the last place in fixed point, or `2 ε` of the
    /// larger end in floats.
    fn point(&self, u: R) -> [R; D] {
        weighted_sum(&[R::one() - u, u], &self.ends)
    }

    fn span_count(&self) -> usize {
        1
    }

    fn span_bounds(&self, _: usize) -> (R, R) {
        self.domain()
    }
}

impl<R: Real, const D: usize> Differentiate<R, D> for Line<R, D> {
    fn derivatives(&self, u: R) -> Derivatives<R, D> {
        Derivatives { point: self.point(u), first: self.difference(), second: [R::zero(); D] }
    }

    fn derivatives_in(&self, _: usize, u: R) -> Derivatives<R, D> {
        self.derivatives(u)
    }

    fn is_line(&self, _: usize) -> bool {
        true
    }
}

/// The u at which the straight line from A to B is nearest to P: `(P - A)·(B - A)/|B - A|²`, cut off to [0, 1]; 0 where
/// A is B.
#[must_use]
pub fn nearest_on_segment<const D: usize>(point: &[f64; D], ends: &[[f64; D]; 2]) -> f64 {
    Segment::new(ends).nearest(point)
}

/// The distance of P from the straight line from A to B, including its ends.
#[must_use]
pub fn distance_to_segment<const D: usize>(point: &[f64; D], ends: &[[f64; D]; 2]) -> f64 {
    f64::norm(&Segment::new(ends).way_from(point))
}

/// The largest distance of points from the straight line from A to B, including its ends; NaN if one is not a number, 0
/// if there are none.
///
/// It is the largest of [`distance_to_segment`], bit for bit, and takes one root for all points together. Domain:
/// distances of 0, or from 1e-140 to 1e150: their squares are normal numbers.
#[must_use]
#[inline]
pub fn farthest_from_segment<const D: usize>(
    points: impl Iterator<Item = [f64; D]>,
    ends: &[[f64; D]; 2],
) -> f64 {
    let segment = Segment::new(ends);
    let mut farthest = ([0.0; D], 0.0);
    for point in points {
        let way = segment.way_from(&point);
        let square = way.iter().fold(0.0, |sum: f64, x| sum + x * x);
        if square.is_nan() || square > farthest.1 {
            farthest = (way, square);
        }
        if square.is_nan() {
            break;
        }
    }
    f64::norm(&farthest.0)
}

/// The straight line from A to B.
struct Segment<'a, const D: usize> {
    begin: &'a [f64; D],
    /// B - A, and its square.
    chord: [f64; D],
    square: f64,
}

impl<'a, const D: usize> Segment<'a, D> {
    #[inline]
    fn new([begin, end]: &'a [[f64; D]; 2]) -> Self {
        let chord = sub(end, begin);
        Self { begin, chord, square: dot(&chord, &chord) }
    }

    #[inline]
    fn nearest(&self, point: &[f64; D]) -> f64 {
        let along = || dot(&sub(point, self.begin), &self.chord) / self.square;
        if self.square > 0.0 { along().clamp(0.0, 1.0) } else { 0.0 }
    }

    /// From a point to the nearest one of the line.
    #[inline]
    fn way_from(&self, point: &[f64; D]) -> [f64; D] {
        add(&sub(self.begin, point), &scaled(&self.chord, self.nearest(point)))
    }
}

#[cfg(all(test, feature = "alloc"))]
mod tests {
    use super::*;
    use crate::{curvature, radius};
    use proptest::prelude::*;
    use real::{I8F24, I16F16, I16F48};

    /// A right triangle over the line's middle, points beyond both ends, and a line without length.
    #[test]
    fn the_distance_to_a_segment_is_that_to_its_nearest_point() {
        let ends = [[1.0, 2.0, 0.0], [5.0, 2.0, 0.0]];
        for (point, u, distance) in [
            ([3.0, 5.0, 4.0], 0.5, 5.0),
            ([4.0, 2.0, 0.0], 0.75, 0.0),
            ([-2.0, 6.0, 0.0], 0.0, 5.0),
            ([8.0, 2.0, 4.0], 1.0, 5.0),
        ] {
            assert_eq!(
                (nearest_on_segment(&point, &ends), distance_to_segment(&point, &ends)),
                (u, distance)
            );
        }
        assert_eq!(distance_to_segment(&[4.0, 2.0, 4.0], &[ends[0]; 2]), 5.0);
        assert!(distance_to_segment(&[f64::NAN, 2.0, 4.0], &ends).is_nan());
    }

    proptest! {
        #[test]
        fn the_farthest_point_is_that_of_the_largest_distance(
            points in proptest::collection::vec([-2.0_f64..2.0, -2.0..2.0, -1e-9..1e-9], 0..9),
            ends in [[-1.0_f64..1.0, -1.0..1.0, -1.0..1.0], [-1.0..1.0, -1.0..1.0, -1.0..1.0]],
        ) {
            let expected = points.iter().map(|point| distance_to_segment(point, &ends)).fold(0.0, f64::max);
            prop_assert_eq!(farthest_from_segment(points.into_iter(), &ends), expected);
        }
    }

    #[test]
    fn a_point_that_is_no_number_is_not_lost() {
        for at in 0..3 {
            let mut points = [[1.0, 2.0], [3.0, 4.0], [5.0, 6.0]];
            points[at][1] = f64::NAN;
            assert!(farthest_from_segment(points.into_iter(), &[[0.0, 0.0], [1.0, 0.0]]).is_nan());
        }
    }

    #[test]
    fn a_line_is_straight_in_every_format() {
        fn check<R: Backend>() {
            let ends = [[0.3, -7.7, 2.0], [11.9, 3.1, 2.0]];
            let line = Line::try_new(ends[0], ends[1]).unwrap().convert::<R>().unwrap();
            let [a, b] = *line.ends();
            assert!(line.point(R::zero()) == a && line.point(R::one()) == b);
            for step in 0..=32 {
                let u = R::from_ratio(step, 32);
                let found = line.point(u);
                for d in 0..3 {
                    let exact = a[d].to_f64() + (b[d].to_f64() - a[d].to_f64()) * f64::from(step) / 32.0;
                    let units = (found[d].to_f64() - exact).abs() / R::resolution().to_f64();
                    let fixed = matches!(R::name(), real::FormatName::Fixed { .. });
                    assert!(units <= if fixed { 1.0 } else { 24.0 }, "{} {step}: {units}", R::name());
                }
                let derivatives = line.derivatives(u);
                assert!(curvature(&derivatives).is_zero() && radius(&derivatives) == R::max_value());
            }
        }
        check::<f64>();
        check::<f32>();
        check::<I8F24>();
        check::<I16F16>();
        check::<I16F48>();
    }

    #[test]
    fn length_and_refusals() {
        assert_eq!(Line::try_new([1.0, 1.0], [4.0, 5.0]).unwrap().length(), 5.0);
        assert_eq!(Line::try_new([f64::NAN], [0.0]), Err(ShapeError::NotFinite { what: "an end of a line" }));
        let far = Line::try_new([0.0], [400.0]).unwrap();
        assert_eq!(far.convert::<I8F24>(), Err(ShapeError::OutOfRange { what: "an end of a line" }));
    }
    #[test]
    fn a_difference_that_would_wrap_is_refused() {
        let wide = |a: f64, b: f64| Line::try_new([0.0, a], [1.0, b]).unwrap();
        assert_eq!(wide(-100.0, 100.0).convert::<I8F24>(), Err(ShapeError::ExtentTooWide { axis: 1 }));
        assert_eq!(wide(100.0, -100.0).convert::<I8F24>(), Err(ShapeError::ExtentTooWide { axis: 1 }));
        assert_eq!(wide(-100.0, 27.5).convert::<I8F24>().unwrap().length().to_f64(), 127.503_921_508_789_06);
        assert_eq!(Line::try_new([f64::MIN], [f64::MAX]), Err(ShapeError::ExtentTooWide { axis: 0 }));
    }
}
