//! Circular arcs: `P(u) = O + cos(πu/2) a + sin(πu/2) b`, u in quarter turns.
//!
//! O is the centre, a the radius to the start, and b the radius a quarter turn further. One unit of the parameter is a
//! quarter turn and one span; the last span may be shorter.

#[cfg(feature = "alloc")]
use alloc::vec::Vec;

#[cfg(feature = "alloc")]
use real::Backend;
use real::{Real, Trigonometric};

#[cfg(feature = "alloc")]
use crate::shapes::{angle::quarter_turns, rounded::round_all, trig_segment::quarter_circle};
use crate::vector::{add, weighted_sum};
#[cfg(feature = "alloc")]
use crate::vector::{distance, dot, over, scaled, sub};
use crate::{Derivatives, Differentiate, Evaluate, ShapeError};
#[cfg(feature = "alloc")]
use crate::{NurbsBuf, TrigSegment, TrigSplineBuf};

/// A circular arc of up to a full turn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc<R, const D: usize> {
    centre: [R; D],
    /// a and b.
    radii: [[R; D]; 2],
    quarters: R,
}

/// The direction of an arc, seen from the positive end of the third axis: from the first axis of its plane toward the
/// second, or back.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sense {
    /// From the first axis toward the second: G3 in the XY plane.
    Counterclockwise,
    /// From the second axis toward the first: G2 in the XY plane.
    Clockwise,
}

impl<R: Real, const D: usize> Arc<R, D> {
    /// The arc about `centre` from the radius a over `quarters` quarter turns toward the radius b.
    ///
    /// The caller takes care that a and b are perpendicular and equally long; otherwise the curve is an arc of an
    /// ellipse.
    ///
    /// # Errors
    /// [`ShapeError::NotFinite`]; [`ShapeError::NoArc`] unless `0 < quarters ≤ 4`; [`ShapeError::ExtentTooWide`] unless the
    /// format holds the points of the whole circle, `|O| + r` along each axis, and the second derivative, `(π/2)² r`.
    pub fn try_new(centre: [R; D], radii: [[R; D]; 2], quarters: R) -> Result<Self, ShapeError> {
        if !centre.iter().chain(radii.iter().flatten()).all(|x| x.is_finite()) {
            return Err(ShapeError::NotFinite { what: "the centre or a radius of an arc" });
        }
        // A fourth of the angle is compared, so that the comparison needs no more integer bits than the domain itself.
        if !(quarters > R::zero() && quarters.ldexp(-2) <= R::one()) {
            return Err(ShapeError::NoArc);
        }
        // In two steps, because (π/2)² does not fit two integer bits.
        let longest = R::max_value() / R::half_pi() / R::half_pi();
        let is_too_wide = |axis: &usize| {
            let (o, r) = (centre[*axis], R::norm(&radii.map(|radius| radius[*axis])));
            // The radius, and the largest error of a point.
            let reach = || r + (r * R::resolution().ldexp(2) + R::resolution());
            !r.is_finite() || r > longest || o > R::max_value() - reach() || o < R::min_value() + reach()
        };
        match (0..D).find(is_too_wide) {
            Some(axis) => Err(ShapeError::ExtentTooWide { axis }),
            None => Ok(Self { centre, radii, quarters }),
        }
    }

    /// The centre O.
    #[must_use]
    pub fn centre(&self) -> &[R; D] {
        &self.centre
    }

    /// The radii a, to the start, and b, a quarter turn on.
    #[must_use]
    pub fn radii(&self) -> &[[R; D]; 2] {
        &self.radii
    }

    /// The angle in quarter turns.
    #[must_use]
    pub fn quarters(&self) -> R {
        self.quarters
    }

    /// `|a|`.
    #[must_use]
    pub fn radius(&self) -> R {
        R::norm(&self.radii[0])
    }

    /// Arc length.
    #[must_use]
    pub fn length(&self) -> R {
        R::half_pi() * (self.quarters * self.radius())
    }

    /// The radius to the point at `u` and the radius a quarter turn further: a and b, turned.
    pub(crate) fn turned(&self, u: R) -> [[R; D]; 2] {
        // Whole quarters exchange the radii, which is exact. The angle left is between 0 and 1, except where u is
        // extrapolated.
        let ([mut a, mut b], mut u) = (self.radii, u);
        for _ in 0..3 {
            if u > R::one() {
                (a, b, u) = (b, a.map(|x| -x), u - R::one());
            }
        }
        let (s, c) = R::sin_cos_quarter(u);
        [weighted_sum(&[c, s], &[a, b]), weighted_sum(&[-s, c], &[a, b])]
    }
}

impl<R: Real, const D: usize> Evaluate<R, D> for Arc<R, D> {
    /// From 0 to the angle in quarter turns.
    fn domain(&self) -> (R, R) {
        (R::zero(), self.quarters)
    }

    /// Accuracy: sine and cosine are within two units of the last place. So in fixed point each axis is within
    /// `2 √2 r + 1` units for a radius r, in floats within `6 ε r + ε |O|`.
    fn point(&self, u: R) -> [R; D] {
        add(&self.centre, &self.turned(u)[0])
    }

    fn span_count(&self) -> usize {
        let (one, two) = (R::one(), R::one() + R::one());
        // Halves, because three quarter turns need one integer bit more than one or two.
        match self.quarters {
            q if q <= one => 1,
            q if q.half() <= one => 2,
            q if q - one <= two => 3,
            _ => 4,
        }
    }

    fn span_bounds(&self, span: usize) -> (R, R) {
        let begin = (0..span.min(self.span_count() - 1)).fold(R::zero(), |sum, _| sum + R::one());
        (begin, self.quarters.min(begin + R::one()))
    }
}

impl<R: Real, const D: usize> Differentiate<R, D> for Arc<R, D> {
    /// `P' = (π/2) b_u`, `P'' = -(π/2)² a_u`, a_u and b_u being the radii at u.
    fn derivatives(&self, u: R) -> Derivatives<R, D> {
        let half_pi = R::half_pi();
        let [a, b] = self.turned(u);
        Derivatives {
            point: add(&self.centre, &a),
            first: b.map(|x| half_pi * x),
            second: a.map(|x| -(half_pi * (half_pi * x))),
        }
    }

    fn derivatives_in(&self, _: usize, u: R) -> Derivatives<R, D> {
        self.derivatives(u)
    }
}

#[cfg(feature = "alloc")]
impl<const D: usize> Arc<f64, D> {
    /// The arc from `start` to `end` about `centre` in the plane of two coordinate axes; a full turn if both points are
    /// the same in that plane. Other coordinates stay those of `start`.
    ///
    /// The centre in a file is rounded, so it is not equally far from both ends. It is moved along the chord, onto the
    /// line of points that are equally far from both, so that the arc meets both ends. If the radii differ by Δr the
    /// centre moves by `|Δr| r / |chord|`, which has no bound where a turn closes. So an arc of more than half a turn
    /// keeps the given centre if that would move by more than `tolerance_mm`. Such an arc begins in `start` and ends
    /// within |Δr| of `end`; it is a full turn if both lie in the same direction from the centre. No point is farther
    /// than the tolerance from a circle about the given centre through one of the ends, or from the ring between these
    /// circles.
    ///
    /// # Errors
    /// [`ShapeError::RadiiDiffer`] when the radii differ by more than `tolerance_mm`; [`ShapeError::NoArc`] without a
    /// radius; [`ShapeError::NotFinite`]. Domain: two different axes, both below D; else [`ShapeError::NoArc`].
    pub fn in_plane(
        [start, end, centre]: [[f64; D]; 3],
        axes: [usize; 2],
        sense: Sense,
        tolerance_mm: f64,
    ) -> Result<Self, ShapeError> {
        let [x, y] = axes;
        if x == y || x >= D || y >= D {
            return Err(ShapeError::NoArc);
        }
        let flat = |p: &[f64; D]| [p[x], p[y]];
        let (from, to, given) = (flat(&start), flat(&end), flat(&centre));
        let difference = distance(&from, &given) - distance(&to, &given);
        if difference.is_nan() || difference.abs() > tolerance_mm {
            return Err(ShapeError::RadiiDiffer);
        }
        let chord = sub(&to, &from);
        let middle = over(&add(&from, &to), 2.0);
        let square = dot(&chord, &chord);
        let off = if square > 0.0 { dot(&sub(&middle, &given), &chord) / square } else { 0.0 };
        let ahead = |[x, y]: [f64; 2]| match sense {
            Sense::Counterclockwise => [-y, x],
            Sense::Clockwise => [y, -x],
        };
        let (a, to_end) = (sub(&from, &given), sub(&to, &given));
        let (cosine, sine) = (dot(&to_end, &a), dot(&to_end, &ahead(a)));
        let is_beyond_half = !(sine > 0.0 || (sine >= 0.0 && cosine < 0.0));
        let is_far = off.abs() * square.sqrt() > tolerance_mm;
        let off = if is_beyond_half && is_far { 0.0 } else { off };
        let moved = add(&given, &scaled(&chord, off));
        let (a, to_end) = (sub(&from, &moved), sub(&to, &moved));
        if f64::norm(&a) <= 0.0 {
            return Err(ShapeError::NoArc);
        }
        let b = ahead(a);
        let quarters = if square > 0.0 { quarter_turns(dot(&to_end, &a), dot(&to_end, &b)) } else { 4.0 };
        let quarters = if is_beyond_half && quarters <= 0.0 { 4.0 } else { quarters };
        let mut circle_centre = start;
        (circle_centre[x], circle_centre[y]) = (moved[0], moved[1]);
        let lift = |p: [f64; 2]| {
            let mut radius = [0.0; D];
            (radius[x], radius[y]) = (p[0], p[1]);
            radius
        };
        // An end within rounding ahead of the start makes an arc of almost no angle.
        Self::try_new(circle_centre, [lift(a), lift(b)], quarters.max(f64::MIN_POSITIVE))
    }

    /// The part over u in [begin, end], turned so that its own parameter begins at 0.
    ///
    /// # Errors
    /// [`ShapeError::NoArc`] unless `begin < end`.
    pub fn part(&self, begin: f64, end: f64) -> Result<Self, ShapeError> {
        Self::try_new(self.centre, self.turned(begin), end - begin)
    }

    /// The arc with every number rounded to the nearest of another format.
    ///
    /// # Errors
    /// [`ShapeError::OutOfRange`], also if the angle becomes 0; [`ShapeError::ExtentTooWide`].
    pub fn convert<Q: Backend>(&self) -> Result<Arc<Q, D>, ShapeError> {
        let centre = round_all(&self.centre, "the centre of an arc")?;
        let [a, b] = self.radii.map(|radius| round_all(&radius, "a radius of an arc"));
        let [quarters] = round_all(&[self.quarters], "the angle of an arc")?;
        Arc::try_new(centre, [a?, b?], quarters).map_err(|error| match error {
            ShapeError::NoArc => ShapeError::OutOfRange { what: "the angle of an arc" },
            other => other,
        })
    }

    /// The arc as a rational curve of degree 2 over the same domain, with a Bezier segment for each quarter turn or
    /// less. The circle is the same; only the parameter runs a little unevenly inside a segment.
    ///
    /// The middle control point of a segment of angle 2α is where the tangents of its ends meet, on the bisector at r/cos α,
    /// and its weight is cos α.
    ///
    /// # Errors
    /// [`ShapeError::Curve`] when the numbers do not make a curve.
    ///
    /// # Source
    /// Piegl and Tiller, *The NURBS Book*, 2nd ed. (1997), section 7.3.
    pub fn to_nurbs(&self) -> Result<NurbsBuf<f64, D>, ShapeError> {
        let spans = self.span_count();
        let count = f64::from(u32::try_from(spans).unwrap_or(1));
        let width = self.quarters() / count;
        let (_, cosine) = f64::sin_cos_quarter(width / 2.0);
        let mut control_points = Vec::from([self.point(0.0)]);
        let (mut weights, mut knots) = (Vec::from([1.0]), Vec::from([0.0; 3]));
        for span in 0..spans {
            let begin = width * f64::from(u32::try_from(span).unwrap_or(0));
            let end = if span + 1 == spans { self.quarters() } else { begin + width };
            let middle = self.turned(begin + width / 2.0)[0];
            control_points.extend([add(&self.centre, &over(&middle, cosine)), self.point(end)]);
            weights.extend([cosine, 1.0]);
            knots.extend([end; 2]);
        }
        knots.push(self.quarters());
        Ok(NurbsBuf::try_new(2, control_points, weights, knots)?)
    }

    /// The arc as trigonometric segments, with the same points. Each is a quarter circle for a quarter turn or less; of
    /// the last, only a part is used.
    ///
    /// # Errors
    /// [`ShapeError::NotFinite`] when a control point overflows.
    pub fn to_trig_spline(&self) -> Result<TrigSplineBuf<f64, D>, ShapeError> {
        let spans = self.span_count();
        let width = self.quarters() / f64::from(u32::try_from(spans).unwrap_or(1));
        let segment = |span: usize| -> Result<TrigSegment<f64, D>, ShapeError> {
            let [a, b] = self.turned(width * f64::from(u32::try_from(span).unwrap_or(0)));
            quarter_circle(self.centre(), &a, &b)?.part(0.0, width.min(1.0))
        };
        TrigSplineBuf::try_new((0..spans).map(segment).collect::<Result<_, _>>()?)
    }
}

#[cfg(all(test, feature = "alloc"))]
mod tests {
    use super::*;
    use crate::{PathCurve, curvature};
    use proptest::prelude::*;
    use real::{I8F24, I16F16, I16F48};

    fn unit_arc(quarters: f64) -> Arc<f64, 2> {
        Arc::try_new([1.0, 2.0], [[3.0, 0.0], [0.0, 3.0]], quarters).unwrap()
    }

    /// Largest deviation from the circle of radius 3 about (1, 2).
    fn off_circle<R: Backend, C: Evaluate<R, 2>>(curve: &C) -> f64 {
        let (begin, end) = curve.domain();
        let at = |step: i32| {
            let [x, y] = curve.point(begin + (end - begin) * R::from_ratio(step, 100)).map(|v| v.to_f64());
            ((x - 1.0).hypot(y - 2.0) - 3.0).abs()
        };
        (0..=100).map(at).fold(0.0, f64::max)
    }

    proptest! {
        #[test]
        fn every_angle_in_every_form_is_the_same_circle(quarters in 0.01..=4.0_f64) {
            let arc = unit_arc(quarters);
            prop_assert!(off_circle(&arc) <= 2e-15);
            let nurbs = arc.to_nurbs().unwrap();
            prop_assert!(off_circle(&nurbs.as_curve()) <= 4e-15, "{}", off_circle(&nurbs.as_curve()));
            let spline = arc.to_trig_spline().unwrap();
            prop_assert!(off_circle(&spline.as_spline()) <= 2e-14, "{}", off_circle(&spline.as_spline()));
            for (curve, bound) in [(PathCurve::from(nurbs), 4e-15), (PathCurve::from(spline), 2e-14)] {
                for (mine, its) in [(0.0, curve.domain().0), (quarters, curve.domain().1)] {
                    let (mine, its) = (arc.point(mine), curve.point(its));
                    prop_assert!((mine[0] - its[0]).abs().max((mine[1] - its[1]).abs()) <= bound);
                }
            }
            fn in_format<R: Backend>(arc: &Arc<f64, 2>) -> Result<(), TestCaseError> {
                let units = off_circle(&arc.convert::<R>().unwrap()) / R::resolution().to_f64();
                prop_assert!(units <= 2.0 * 2.0_f64.sqrt() * 3.0 + 1.0, "{}: {units}", R::name());
                Ok(())
            }
            in_format::<I16F16>(&arc)?;
            in_format::<I8F24>(&arc)?;
            in_format::<I16F48>(&arc)?;
            in_format::<f32>(&arc)?;
        }

        #[test]
        fn derivatives_turn_with_the_arc(quarters in 0.1..=4.0_f64, at in 0.0..=1.0) {
            let (arc, h) = (unit_arc(quarters), 1e-5);
            let u = at * quarters;
            let d = arc.derivatives(u);
            prop_assert!((curvature(&d) * 3.0 - 1.0).abs() <= 1e-14);
            for axis in 0..2 {
                let difference = (arc.point(u + h)[axis] - arc.point(u - h)[axis]) / (2.0 * h);
                prop_assert!((difference - d.first[axis]).abs() < 1e-8);
            }
        }

        #[test]
        fn an_angle_is_found_from_its_vector(quarters in 0.0..4.0_f64, length in 1e-3..1e3_f64) {
            let angle = quarters * core::f64::consts::FRAC_PI_2;
            let found = quarter_turns(length * angle.cos(), length * angle.sin());
            let error = (found - quarters).abs();
            prop_assert!(error.min(4.0 - error) <= 1e-15 * 4.0, "{quarters}: {found}");
        }

        #[test]
        fn an_arc_of_a_program_meets_its_ends(from in 0.0..4.0_f64, by in 0.01..3.99_f64, radius in 0.1..100.0_f64,
                                              clockwise: bool, noise in [-5e-4..5e-4, -5e-4..5e-4]) {
            // A program's centre is rounded: here it is off by up to half a micrometre each way.
            let at = |quarters: f64| {
                let angle = quarters * core::f64::consts::FRAC_PI_2;
                [7.0, radius * angle.cos(), radius * angle.sin()]
            };
            let (sense, to) = if clockwise { (Sense::Clockwise, from - by) } else { (Sense::Counterclockwise, from + by) };
            let centre = [99.0, noise[0], noise[1]];
            let arc = Arc::in_plane([at(from), at(to), centre], [1, 2], sense, 2e-3).unwrap();
            let [first, last] = [from, to].map(|end| f64::norm(&[at(end)[1] - noise[0], at(end)[2] - noise[1]]));
            for (found, expected) in [(arc.point(0.0), at(from)), (arc.point(arc.quarters()), at(to))] {
                let off = distance(&found, &expected);
                let stays = by > 2.0 && arc.centre()[1..] == noise && expected == at(to);
                let allowed = if stays { (first - last).abs() } else { 0.0 };
                prop_assert!(off <= allowed + 1e-14 * radius.max(1.0) * 8.0, "{off}");
            }
            for step in 0..=100 {
                let [_, y, z] = arc.point(arc.quarters() * f64::from(step) / 100.0);
                let away = f64::norm(&[y - noise[0], z - noise[1]]);
                let off = (first.min(last) - away).max(away - first.max(last));
                prop_assert!(off <= 2e-3 + 1e-6 / radius, "{off}");
            }
            let half_chord = radius * (by * core::f64::consts::FRAC_PI_4).sin().abs();
            prop_assert!((arc.quarters() - by).abs() <= 4e-3 / half_chord.max(1e-3) + 1e-14, "{} {by}", arc.quarters());
        }
    }

    #[test]
    fn axes_and_quarters_have_their_angles() {
        for (vector, quarters) in
            [((1.0, 0.0), 0.0), ((0.0, 2.0), 1.0), ((-3.0, 0.0), 2.0), ((0.0, -1.0), 3.0)]
        {
            assert_eq!(quarter_turns(vector.0, vector.1), quarters);
        }
        assert!((quarter_turns(1.0, 1.0) - 0.5).abs() <= f64::EPSILON);
    }

    #[test]
    fn spans_are_quarters_and_a_rest() {
        for (quarters, count, last) in
            [(0.5, 1, 0.0), (1.0, 1, 0.0), (2.0, 2, 1.0), (2.25, 3, 2.0), (3.0, 3, 2.0), (4.0, 4, 3.0)]
        {
            let arc = unit_arc(quarters);
            assert_eq!((arc.span_count(), arc.span_bounds(9)), (count, (last, quarters)));
        }
    }

    #[test]
    fn a_full_turn_and_what_is_no_arc() {
        let full =
            Arc::in_plane([[5.0, 0.0], [5.0, 0.0], [0.0, 0.0]], [0, 1], Sense::Clockwise, 1e-3).unwrap();
        assert_eq!(full.quarters(), 4.0);
        assert!(full.point(1.0)[1] < -4.9);
        let arc = |points, axes| Arc::<f64, 2>::in_plane(points, axes, Sense::Clockwise, 1e-3).unwrap_err();
        assert_eq!(arc([[5.0, 0.0], [0.0, 6.0], [0.0, 0.0]], [0, 1]), ShapeError::RadiiDiffer);
        assert_eq!(arc([[0.0, 0.0]; 3], [0, 1]), ShapeError::NoArc);
        assert_eq!(arc([[5.0, 0.0], [0.0, 5.0], [0.0, 0.0]], [0, 2]), ShapeError::NoArc);
        assert_eq!(arc([[f64::NAN, 0.0], [0.0, 5.0], [0.0, 0.0]], [0, 1]), ShapeError::RadiiDiffer);
        assert_eq!(Arc::try_new([0.0], [[1.0], [1.0]], 4.5), Err(ShapeError::NoArc));
        assert_eq!(
            unit_arc(1e-9).convert::<I16F16>(),
            Err(ShapeError::OutOfRange { what: "the angle of an arc" })
        );
    }

    #[test]
    fn a_circle_that_would_wrap_is_refused() {
        let arc = |centre, radius| arc_in_f64(centre, radius).convert::<I8F24>();
        let refused = |axis| Err(ShapeError::ExtentTooWide { axis });
        assert_eq!(arc(0.0, 100.0), refused(0)); // C'' is 247 mm
        assert_eq!(arc(0.0, 52.0), refused(0));
        assert_eq!(arc(100.0, 30.0), refused(1));
        assert_eq!(arc(-100.0, 28.0), refused(1));
        for (centre, radius) in [(0.0, 51.5), (97.5, 30.0), (-100.0, 27.9)] {
            let (held, exact) = (arc(centre, radius).unwrap(), arc_in_f64(centre, radius));
            for step in 0..=32 {
                let u = f64::from(step) / 16.0;
                let (found, wanted) = (held.derivatives(I8F24::from_f64(u).unwrap()), exact.derivatives(u));
                for (found, wanted) in
                    [(found.point, wanted.point), (found.first, wanted.first), (found.second, wanted.second)]
                {
                    let off = (0..2).map(|d| (found[d].to_f64() - wanted[d]).abs()).fold(0.0, f64::max);
                    assert!(off < 1e-4, "{centre} {radius} {u}: {off}");
                }
            }
        }
    }

    fn arc_in_f64(centre: f64, radius: f64) -> Arc<f64, 2> {
        Arc::try_new([0.0, centre], [[radius, 0.0], [0.0, radius]], 2.0).unwrap()
    }

    /// The centre once moved by `|Δr| r / |chord|`, here 4.3 mm: a circle of radius 2.57 for one of 5.
    #[test]
    fn a_turn_that_all_but_closes_keeps_its_circle() {
        let turn =
            |end: [f64; 2], sense| Arc::in_plane([[5.0, 0.0], end, [0.0, 0.0]], [0, 1], sense, 1e-3).unwrap();
        let whole = 10.0 * core::f64::consts::PI;
        for (end, ahead) in
            [([5.0005, -0.0003], 3e-4), ([5.0005, 0.0], 0.0), ([4.9995, -0.02], 0.02), ([5.0, -1e-4], 1e-4)]
        {
            for (end, sense) in [(end, Sense::Counterclockwise), ([end[0], -end[1]], Sense::Clockwise)] {
                let arc = turn(end, sense);
                assert!((arc.radius() - 5.0).abs() <= 1e-3, "{arc:?}");
                assert!(
                    (arc.length() - (whole - ahead)).abs() <= 2.0 * 3.2 * 1e-3,
                    "{} {ahead}",
                    arc.length()
                );
                let last = arc.point(arc.quarters());
                assert!(f64::norm(&[last[0] - end[0], last[1] - end[1]]) <= 5.1e-4, "{last:?}");
            }
        }
        // Ahead of the start it is short, whatever the radii.
        let short = turn([5.0005, 0.0003], Sense::Counterclockwise);
        assert!(short.length() <= 1e-3, "{}", short.length());
        assert_eq!(short.point(0.0).map(|x| (x * 1e9).round()), [5e9, 0.0]);
    }

    #[test]
    fn a_part_lies_on_the_arc() {
        let (arc, part) = (unit_arc(3.5), unit_arc(3.5).part(1.25, 3.0).unwrap());
        assert_eq!(part.quarters(), 1.75);
        let off = |u: f64| distance(&part.point(u), &arc.point(1.25 + u));
        assert!([0.0, 0.5, 1.75].into_iter().all(|u| off(u) <= 4e-15));
        assert!(arc.part(2.0, 2.0).is_err());
    }
}
