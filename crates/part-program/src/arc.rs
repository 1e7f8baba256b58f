//! Circular arcs and helices as rational curves of degree 2.
//!
//! An arc of angle δ < 180° about a centre is the conic with the control points (start, meet of the end tangents, end)
//! and the weights (1, cos δ/2, 1). Longer arcs are one curve of several such spans, each of at most 90°, joined at
//! double knots.
//!
//! A helix is no rational curve. Its projection here is the exact circle; with φ the angle from the middle of a span of
//! half angle a, its height is `sin φ / sin a` where the helix has `φ / a`. The difference is at most about
//! `0.0321 a²` of the rise of the span, so spans are made short enough for [`HELIX_TOLERANCE_MM`].

use std::f64::consts::{FRAC_PI_2, TAU};

use crate::curve::Curve;

/// How far a point of a helix may be from its height, in mm.
pub const HELIX_TOLERANCE_MM: f64 = 1e-4;
/// How far the end of an arc may be from the circle through its start, in mm: what rounding to two decimals does.
const CENTRE_TOLERANCE_MM: f64 = 0.02;
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

/// How an arc's circle is given.
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
}

/// Why an arc is none.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum ArcFault {
    /// The centre is the start.
    NoRadius,
    /// Distances of start and end from the centre differ.
    EndOffCircle { start: f64, end: f64 },
    /// Start and end are further apart than the diameter.
    RadiusTooSmall { radius: f64, chord: f64 },
    /// A radius does not say which full circle.
    FullCircleByRadius,
    /// The helix is too long to be represented.
    TooLong,
}

impl ArcMove {
    /// The curve and its length, in mm.
    pub(crate) fn curve(&self) -> Result<(Curve, f64), ArcFault> {
        let [a, b, normal] = self.plane.axes();
        let (from, to) = ([self.start[a], self.start[b]], [self.end[a], self.end[b]]);
        let centre = self.centre(from, to)?;
        let radius = distance(from, centre);
        let rise = self.end[normal] - self.start[normal];
        let sweep = self.sweep(from, to, centre);
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
            let (sin, cos) = (first_angle + step * half).sin_cos();
            let mut point = [0.0; 3];
            point[a] = centre[0] + radius / weight * cos;
            point[b] = centre[1] + radius / weight * sin;
            point[normal] = self.start[normal] + rise * (step / (2.0 * count));
            points.push(point);
            weights.push(weight);
        }
        points[0] = self.start;
        points[2 * spans] = self.end;

        let mut knots = vec![0.0; 3];
        #[allow(clippy::cast_precision_loss, reason = "at most MAX_SPANS")]
        knots.extend((1..spans).flat_map(|i| [i as f64 / count; 2]));
        knots.extend([1.0; 3]);
        let dimension = Curve::dimension_of(&points);
        let curve = Curve { degree: 2, control_points_mm: points, dimension, weights, knots };
        Ok((curve, (radius * sweep).hypot(rise)))
    }

    /// The centre of the circle through start and end that is nearest to what was given.
    fn centre(&self, from: [f64; 2], to: [f64; 2]) -> Result<[f64; 2], ArcFault> {
        let chord = distance(from, to);
        let middle = [f64::midpoint(from[0], to[0]), f64::midpoint(from[1], to[1])];
        let across = [-(to[1] - from[1]) / chord, (to[0] - from[0]) / chord];
        let beside = |offset: f64| [middle[0] + offset * across[0], middle[1] + offset * across[1]];
        match self.circle {
            Circle::Centre(centre) => {
                let (start, end) = (distance(from, centre), distance(to, centre));
                if start == 0.0 {
                    return Err(ArcFault::NoRadius);
                }
                if (start - end).abs() > CENTRE_TOLERANCE_MM {
                    return Err(ArcFault::EndOffCircle { start, end });
                }
                if chord == 0.0 {
                    return Ok(centre);
                }
                Ok(beside((centre[0] - middle[0]) * across[0] + (centre[1] - middle[1]) * across[1]))
            }
            Circle::Radius(radius) => {
                if chord == 0.0 {
                    return Err(ArcFault::FullCircleByRadius);
                }
                if chord / 2.0 > radius.abs() + CENTRE_TOLERANCE_MM {
                    return Err(ArcFault::RadiusTooSmall { radius, chord });
                }
                let offset = (radius * radius - chord * chord / 4.0).max(0.0).sqrt();
                // Counterclockwise, the shorter arc has its centre on the left of the chord.
                Ok(beside(if self.clockwise == (radius < 0.0) { offset } else { -offset }))
            }
        }
    }

    /// The signed angle, counterclockwise positive; a full turn if the arc ends where it starts.
    fn sweep(&self, from: [f64; 2], to: [f64; 2], centre: [f64; 2]) -> f64 {
        let angle = |p: [f64; 2]| (p[1] - centre[1]).atan2(p[0] - centre[0]);
        let turn = if from == to { 0.0 } else { angle(to) - angle(from) };
        if self.clockwise {
            let turn = turn.rem_euclid(TAU) - TAU;
            if turn == 0.0 { -TAU } else { turn }
        } else {
            let turn = turn.rem_euclid(TAU);
            if turn == 0.0 { TAU } else { turn }
        }
    }
}

/// The number of spans for a turn of `sweep` rad that rises `rise` mm.
fn span_count(sweep: f64, rise: f64) -> Option<usize> {
    // Rounding may leave a quarter turn a hair above 90°; it stays one span.
    let by_angle = (sweep / FRAC_PI_2 - 1e-9).ceil().max(1.0);
    // 0.0321 (sweep / 2n)² rise / n = tolerance, solved for n, with 0.035 for the terms left out.
    let by_height = (0.035 / 4.0 * sweep * sweep * rise / HELIX_TOLERANCE_MM).cbrt().ceil();
    let spans = by_angle.max(by_height);
    #[allow(clippy::cast_precision_loss, reason = "a constant")]
    let fits = spans <= MAX_SPANS as f64;
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "1 ..= MAX_SPANS")]
    fits.then_some(spans as usize)
}

fn distance(p: [f64; 2], q: [f64; 2]) -> f64 {
    (p[0] - q[0]).hypot(p[1] - q[1])
}
