//! Circular arcs as rational curves of degree 2, helices as ones of degree 3.
//!
//! An arc of angle δ < 180° about a centre is the conic with the control points (start, meet of the end tangents, end)
//! and the weights (1, cos δ/2, 1). Longer arcs are one curve of several such spans, each of at most 90°, joined at
//! double knots.
//!
//! A helix is not a rational curve. Here its projection is the exact circle, raised to degree 3. Let φ be the angle
//! from the middle of a span of half angle a, and `τ = tan a/2`. The height of the curve is that of a helix with f(φ)
//! in place of φ:
//!
//! ```text
//! f(φ) = 2a (tan φ/2 + (1 + τ²)²/4 sin φ) / (τ (3 + τ²))        f(a) = a        f″(a) = 0
//! ```
//!
//! f is odd and the same in all spans, so that spans meet with the same slope and curvature: at their joints the limit
//! of an axis has no effect. The difference from φ is at most `0.0073 a⁵` for a up to 45°, and spans are short enough
//! for [`HELIX_TOLERANCE_MM`].
//!
//! Programs round, so that start and end are at different distances r₀ and r₁ from the centre as written. The centre is
//! kept: if it were moved onto the bisector of a short chord, it could move by up to a radius, and the arc would be
//! another one. Instead the radius of the control points goes from r₀ to r₁ as their angle goes from start to end. In a
//! span from ρ - d over ρ to ρ + d the conic is `ρ e^{iφ} + d (e^{ia} B₂ - e^{-ia} B₀) / (B₀ + B₁ cos a + B₂)`, and so
//! within d of the circle of radius ρ: the whole path is between the circles of radius r₀ and r₁.

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::curve::{Curve, Nurbs};

/// How far a point of a helix may be from its height, in mm: a tenth of the least length that drives resolve.
pub const HELIX_TOLERANCE_MM: f64 = 1e-6;
/// How far the end of an arc may be from the circle through its start, in mm. Rounding to two decimals of an inch
/// causes as much, and LinuxCNC accepts it. For a large arc, [`TAKEN_SHARE`] of the radius is allowed, as in LinuxCNC.
const CENTRE_TOLERANCE_MM: f64 = 0.072;
/// If the radii of start and end differ by more than this, in mm, and by more than [`TAKEN_SHARE`], the reader warns.
/// Grbl refuses such an arc, and LinuxCNC does above 0.028 mm.
pub(crate) const TAKEN_MM: f64 = 0.005;
/// The share of the radius for the same warning; both controls use it.
const TAKEN_SHARE: f64 = 1e-3;
/// An arc to its own start is a full turn. So is one whose end is no farther from its start than this, in mm: sums of
/// incremental moves lose as much.
pub(crate) const FULL_TURN_MM: f64 = 1e-6;
/// Spans of one arc; a helix that needs more is refused.
const MAX_SPANS: usize = 100_000;

/// The plane of an arc, by the axes (first, second, normal), so that first × second = normal.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Plane {
    /// G17.
    #[default]
    Xy,
    /// G18.
    Zx,
    /// G19.
    Yz,
}

impl Plane {
    pub(crate) fn axes(self) -> [usize; 3] {
        match self {
            Self::Xy => [0, 1, 2],
            Self::Zx => [2, 0, 1],
            Self::Yz => [1, 2, 0],
        }
    }
}

/// The circle of an arc, as the program gives it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Circle {
    /// The centre, in the coordinates (first, second) of the plane.
    Centre([f64; 2]),
    /// The radius; negative for the longer of the two arcs.
    Radius(f64),
}

/// An arc move.
#[derive(Clone, Copy, Debug)]
pub(crate) struct ArcMove {
    pub(crate) plane: Plane,
    pub(crate) clockwise: bool,
    pub(crate) start: [f64; 3],
    pub(crate) end: [f64; 3],
    pub(crate) circle: Circle,
    /// The number of turns, the last of which ends at the arc's end; at least 1.
    pub(crate) turns: u32,
}

/// The reason why an arc is not valid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ArcFault {
    /// The centre is the start.
    NoRadius,
    /// Distances of start and end from the centre differ.
    EndOffCircle { start: f64, end: f64 },
    /// Start and end are further apart than the diameter.
    RadiusTooSmall { radius: f64, chord: f64 },
    /// A full circle is given by its radius, which does not determine it.
    FullCircleByRadius,
    /// The helix is too long to be represented.
    TooLong,
}

impl ArcMove {
    /// An arc of at most one turn between two ends, from the first to the second.
    pub(crate) fn new(plane: Plane, clockwise: bool, [start, end]: [[f64; 3]; 2], circle: Circle) -> Self {
        Self { plane, clockwise, start, end, circle, turns: 1 }
    }

    /// The curve and its length, in mm.
    pub(crate) fn curve(&self) -> Result<(Curve, f64), ArcFault> {
        self.within(CENTRE_TOLERANCE_MM)
    }

    /// The curve and its length, in mm, of an arc that a control has accepted: its end may be off the circle by any
    /// distance.
    pub(crate) fn spiral(&self) -> Result<(Curve, f64), ArcFault> {
        self.within(f64::INFINITY)
    }

    /// The centre in the plane, of an arc that a control has accepted.
    pub(crate) fn centre(&self) -> Result<[f64; 2], ArcFault> {
        let [a, b, _] = self.plane.axes();
        let (from, to) = ([self.start[a], self.start[b]], [self.end[a], self.end[b]]);
        Ok(self.turn(from, to, f64::INFINITY)?.centre)
    }

    /// The angle, without its sign, by which an arc turns that a control has accepted.
    pub(crate) fn sweep(&self) -> Result<f64, ArcFault> {
        let [a, b, _] = self.plane.axes();
        let (from, to) = ([self.start[a], self.start[b]], [self.end[a], self.end[b]]);
        let turn = self.turn(from, to, f64::INFINITY)?;
        Ok(turn.sweep.abs())
    }

    /// The curve and its length. If the circle is given by a centre, the end may be off it by `tolerance_mm`.
    fn within(&self, tolerance_mm: f64) -> Result<(Curve, f64), ArcFault> {
        let [a, b, normal] = self.plane.axes();
        let (from, to) = ([self.start[a], self.start[b]], [self.end[a], self.end[b]]);
        let Turn { centre, radii, sweep } = self.turn(from, to, tolerance_mm)?;
        let rise = self.end[normal] - self.start[normal];
        let spans = span_count(sweep.abs(), rise.abs()).ok_or(ArcFault::TooLong)?;

        #[allow(clippy::cast_precision_loss, reason = "at most MAX_SPANS")]
        let (count, half) = (spans as f64, sweep / (2.0 * spans as f64));
        let first_angle = (from[1] - centre[1]).atan2(from[0] - centre[0]);
        let mut points = Vec::with_capacity(2 * spans + 1);
        let mut weights = Vec::with_capacity(2 * spans + 1);
        for j in 0..=2 * spans {
            #[allow(clippy::cast_precision_loss, reason = "at most 2 MAX_SPANS")]
            let step = j as f64;
            let weight = if j % 2 == 0 { 1.0 } else { half.cos() };
            let (share, (sin, cos)) = (step / (2.0 * count), (first_angle + step * half).sin_cos());
            let radius = radii[0] + (radii[1] - radii[0]) * share;
            let mut point = [0.0; 3];
            point[a] = centre[0] + radius / weight * cos;
            point[b] = centre[1] + radius / weight * sin;
            point[normal] = self.start[normal] + rise * share;
            points.push(point);
            weights.push(weight);
        }
        points[0] = self.start;
        points[2 * spans] = self.end;

        let degree = if rise == 0.0 { 2 } else { 3 };
        if degree == 3 {
            (points, weights) = raised(&points, &weights, normal);
        }
        let mut knots = vec![0.0];
        #[allow(clippy::cast_precision_loss, reason = "at most MAX_SPANS")]
        knots.extend((0..=spans).flat_map(|i| std::iter::repeat_n(i as f64 / count, degree)));
        knots.push(1.0);
        let dimension = Nurbs::dimension_of(&points);
        let curve = Nurbs { degree, control_points_mm: points, dimension, weights, knots };
        let around = f64::midpoint(radii[0], radii[1]) * sweep;
        Ok((curve.into(), around.hypot(radii[1] - radii[0]).hypot(rise)))
    }

    /// If they differ by more than controls accept: the radii at start and end; or the radius as written and half of
    /// the chord, which is longer.
    pub(crate) fn strained_radii(&self) -> Option<[f64; 2]> {
        let [a, b, _] = self.plane.axes();
        let (from, to) = ([self.start[a], self.start[b]], [self.end[a], self.end[b]]);
        let radii = match self.circle {
            Circle::Centre(centre) => [distance(from, centre), distance(to, centre)],
            Circle::Radius(radius) => [radius.abs(), radius.abs().max(distance(from, to) / 2.0)],
        };
        let difference = (radii[1] - radii[0]).abs();
        (difference > TAKEN_MM && difference > TAKEN_SHARE * radii[0]).then_some(radii)
    }

    /// The centre, with the radii and the angle of the turn about it.
    fn turn(&self, from: [f64; 2], to: [f64; 2], tolerance_mm: f64) -> Result<Turn, ArcFault> {
        let chord = distance(from, to);
        let (centre, radii, turned) = match self.circle {
            Circle::Centre(centre) => {
                let (start, end) = (distance(from, centre), distance(to, centre));
                if start == 0.0 {
                    return Err(ArcFault::NoRadius);
                }
                if (start - end).abs() > tolerance_mm.max(TAKEN_SHARE * start.max(end)) {
                    return Err(ArcFault::EndOffCircle { start, end });
                }
                let angle = |p: [f64; 2]| (p[1] - centre[1]).atan2(p[0] - centre[0]);
                let ahead = if from == to { 0.0 } else { angle(to) - angle(from) };
                let ahead = if self.clockwise { -ahead } else { ahead }.rem_euclid(TAU);
                let turned = if ahead * start <= FULL_TURN_MM { ahead + TAU } else { ahead };
                (centre, [start, end], turned)
            }
            Circle::Radius(radius) => {
                if chord == 0.0 {
                    return Err(ArcFault::FullCircleByRadius);
                }
                if chord / 2.0 > radius.abs() + CENTRE_TOLERANCE_MM {
                    return Err(ArcFault::RadiusTooSmall { radius, chord });
                }
                let middle = [f64::midpoint(from[0], to[0]), f64::midpoint(from[1], to[1])];
                let across = [-(to[1] - from[1]) / chord, (to[0] - from[0]) / chord];
                let height = (radius * radius - chord * chord / 4.0).max(0.0).sqrt();
                // Counterclockwise, the shorter arc has its centre on the left of the chord.
                let offset = if self.clockwise == (radius < 0.0) { height } else { -height };
                let centre = [middle[0] + offset * across[0], middle[1] + offset * across[1]];
                let shorter = 2.0 * (chord / 2.0).atan2(height);
                let turned = if radius < 0.0 { TAU - shorter } else { shorter };
                (centre, [distance(from, centre); 2], turned)
            }
        };
        let turned = turned + f64::from(self.turns.saturating_sub(1)) * TAU;
        Ok(Turn { centre, radii, sweep: if self.clockwise { -turned } else { turned } })
    }
}

/// An arc about its centre.
struct Turn {
    centre: [f64; 2],
    /// Distances of start and end from the centre; they differ by the program's rounding.
    radii: [f64; 2],
    /// The signed angle, counterclockwise positive.
    sweep: f64,
}

/// Raises rational spans of degree 2 to degree 3. Their points in the plane stay the same; their heights are those of a
/// helix.
///
/// For a span with the points P₀ P₁ P₂ and the weights (1, c, 1), `c = cos a`, the inner points are `(P₀ + 2c P₁)/(1 +
/// 2c)` and `(2c P₁ + P₂)/(1 + 2c)`, and their weights are `(1 + 2c)/3`. The heights of the inner points are above and
/// below the height of the span's middle by `(1 - 2 sin² a/(2 + c))/(1 + 2c)` of half the span's rise: f in Bezier
/// form.
fn raised(points: &[[f64; 3]], weights: &[f64], normal: usize) -> (Vec<[f64; 3]>, Vec<f64>) {
    let (mut raised_points, mut raised_weights) = (vec![points[0]], vec![1.0]);
    for (span, weights) in points.windows(3).zip(weights.windows(3)).step_by(2) {
        let [from, middle, to] = [span[0], span[1], span[2]];
        let twice = 2.0 * weights[1];
        let height = (1.0 - 4.0 * (1.0 - weights[1] * weights[1]) / (4.0 + twice)) / (1.0 + twice);
        let inner = |end: [f64; 3]| {
            let mut point: [f64; 3] = std::array::from_fn(|d| (end[d] + twice * middle[d]) / (1.0 + twice));
            point[normal] = middle[normal] + (end[normal] - middle[normal]) * height;
            point
        };
        raised_points.extend([inner(from), inner(to), to]);
        raised_weights.extend([(1.0 + twice) / 3.0, (1.0 + twice) / 3.0, 1.0]);
    }
    (raised_points, raised_weights)
}

/// The number of spans for a turn of `sweep` rad that rises `rise` mm.
fn span_count(sweep: f64, rise: f64) -> Option<usize> {
    // Rounding may leave a quarter turn a hair above 90°; it stays one span.
    let by_angle = (sweep / FRAC_PI_2 - 1e-9).ceil().max(1.0);
    // 0.0073 (sweep / 2n)⁵ rise / sweep = tolerance, solved for n.
    let by_height = (sweep / 2.0 * (0.0073 * rise / (sweep * HELIX_TOLERANCE_MM)).powf(0.2)).ceil();
    let spans = by_angle.max(by_height);
    #[allow(clippy::cast_precision_loss, reason = "a constant")]
    let fits = spans <= MAX_SPANS as f64;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 ..= MAX_SPANS")]
    fits.then_some(spans as usize)
}

fn distance(p: [f64; 2], q: [f64; 2]) -> f64 {
    (p[0] - q[0]).hypot(p[1] - q[1])
}

#[cfg(test)]
mod tests {
    use nurbs_core::{Differentiate, Evaluate, curvature_vector};
    use proptest::prelude::*;

    use super::*;

    /// Points of a curve, 100 a span, in the coordinates of a plane.
    fn seen(curve: Curve, plane: Plane) -> Vec<[f64; 2]> {
        let (nurbs, [a, b, _]) = (curve.for_evaluation().unwrap(), plane.axes());
        let nurbs = nurbs.as_curve();
        let spans = (0..nurbs.span_count()).flat_map(|span| (0..=100_u8).map(move |k| (span, k)));
        let points = spans.map(|(span, k)| {
            let (from, to) = nurbs.span_bounds(span);
            nurbs.derivatives_in(span, from + (to - from) * f64::from(k) / 100.0).point
        });
        points.map(|point| [point[a], point[b]]).collect()
    }

    /// The angle that a path turns about a centre.
    fn turned(path: &[[f64; 2]], centre: [f64; 2]) -> f64 {
        let arms = path.iter().map(|p| [p[0] - centre[0], p[1] - centre[1]]).collect::<Vec<_>>();
        arms.windows(2)
            .map(|pair| {
                let ([ax, ay], [bx, by]) = (pair[0], pair[1]);
                (ax * by - ay * bx).atan2(ax * bx + ay * by)
            })
            .sum()
    }

    proptest! {
        /// Ends are rounded by up to 0.01 mm; chords go from a few micrometres to full circles. The path lies between
        /// the circles through its start and its end, turns by the intended angle, and ends at the commanded point.
        #[test]
        fn a_rounded_end_keeps_centre_and_turn(
            plane in prop::sample::select(vec![Plane::Xy, Plane::Zx, Plane::Yz]),
            clockwise: bool,
            centre in [-100.0..100.0_f64, -100.0..100.0_f64],
            first in 0.0..TAU,
            radius in (-1.0..3.0_f64).prop_map(|exponent| 10.0_f64.powf(exponent)),
            share in prop_oneof![0.0..1.0_f64, (-6.0..-1.0_f64).prop_map(|exponent| 10.0_f64.powf(exponent))],
            nearly_full: bool,
            off in -0.01..0.01_f64,
        ) {
            let share = if nearly_full { 1.0 - share } else { share };
            prop_assume!(share * TAU * radius > 2e-6);
            let sweep = if clockwise { -share * TAU } else { share * TAU };
            let [a, b, _] = plane.axes();
            let at = |radius: f64, angle: f64| {
                let mut point = [0.0; 3];
                (point[a], point[b]) = (centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin());
                point
            };
            let (start, end) = (at(radius, first), at(radius + off, first + sweep));
            let circle = Circle::Centre(centre);
            let (curve, length) = ArcMove::new(plane, clockwise, [start, end], circle).curve().unwrap();
            prop_assert_eq!(curve.control_points_mm().first(), Some(&start));
            prop_assert_eq!(curve.control_points_mm().last(), Some(&end));
            let path = seen(curve, plane);
            for p in &path {
                let distance = distance(*p, centre);
                let (least, most) = (radius.min(radius + off), radius.max(radius + off));
                prop_assert!(least - 1e-11 < distance && distance < most + 1e-11, "{distance}: {least} to {most}");
            }
            let turned = turned(&path, centre);
            prop_assert!((turned - sweep).abs() < 1e-9, "{turned}, not {sweep}");
            let measured: f64 = path.windows(2).map(|pair| distance(pair[0], pair[1])).sum();
            // The length leaves out the square of the disagreement.
            let tolerance = 1e-4 * length + off * off / radius;
            prop_assert!((length - measured).abs() < tolerance, "{length}, not {measured}");
        }
    }

    /// z″ of a helix once stepped by 6.4e-4 /mm where spans met, every 15 mm, and an axis with a limit of jerk slowed
    /// down there.
    #[test]
    fn a_helix_has_one_curvature_where_spans_meet() {
        let (start, end) = ([20.0, 0.0, 0.0], [20.0, 0.0, -8.0]);
        let circle = Circle::Centre([0.0; 2]);
        let helix = ArcMove::new(Plane::Xy, false, [start, end], circle);
        let (curve, _) = helix.curve().unwrap();
        let nurbs = curve.for_evaluation().unwrap();
        let nurbs = nurbs.as_curve();
        assert!((10..=20).contains(&nurbs.span_count()), "{}", nurbs.span_count());
        for span in 1..nurbs.span_count() {
            let joint = nurbs.span_bounds(span).0;
            let sides = [span - 1, span].map(|span| nurbs.derivatives_in(span, joint));
            let [before, behind] = sides.map(|side| curvature_vector(&side).unwrap());
            for d in 0..3 {
                assert!((before[d] - behind[d]).abs() < 1e-12, "{joint}: {before:?} {behind:?}");
            }
        }
    }

    /// The centre of an arc whose ends are 1 µm apart was once moved onto the bisector of its chord: a full circle of
    /// radius 10 mm became a half circle of 0.5 µm.
    #[test]
    fn an_end_beside_the_start_is_a_full_circle_and_no_point() {
        for (end, clockwise, sweep) in [
            ([10.001, 0.0, 0.0], false, TAU),
            ([10.001, 0.0, 0.0], true, -TAU),
            ([9.999, -0.001, 0.0], false, TAU - 1e-4),
            ([9.999, -0.001, 0.0], true, -1e-4),
        ] {
            let start = [10.0, 0.0, 0.0];
            let circle = Circle::Centre([0.0; 2]);
            let arc = ArcMove::new(Plane::Xy, clockwise, [start, end], circle);
            let (curve, _) = arc.curve().unwrap();
            let turned = turned(&seen(curve, Plane::Xy), [0.0; 2]);
            assert!((turned - sweep).abs() < 1e-7, "{end:?}: {turned}, not {sweep}");
        }
    }

    /// If a radius is given and the end is close to the start, the sign selects the shorter arc or the longer one.
    #[test]
    fn a_short_chord_by_radius_is_no_full_circle() {
        for (radius, length) in [(10.0, 1e-9), (-10.0, 10.0 * TAU)] {
            let (start, end) = ([0.0; 3], [1e-9, 0.0, 0.0]);
            let circle = Circle::Radius(radius);
            let arc = ArcMove::new(Plane::Xy, false, [start, end], circle);
            let (_, found) = arc.curve().unwrap();
            assert!((found - length).abs() < 1e-8, "{radius}: {found}, not {length}");
        }
    }
}
