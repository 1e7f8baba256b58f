//! A move between two corners: its points by length, and the part left when its ends are cut off.

use real::Real;

use crate::shapes::angle::quarter_turns;
use crate::vector::{distance, dot, sub};
use crate::{Arc, Differentiate, Evaluate, Line, PathCurve};

/// A move shorter than this, in mm, is dropped, and a cut of no more than a thousand times this is not made: both are
/// far below the resolution of a drive.
pub(crate) const LEAST_LENGTH_MM: f64 = 1e-9;

/// A move that has a length.
pub(crate) struct Leg<'a, const D: usize> {
    pub(crate) index: usize,
    pub(crate) curve: &'a PathCurve<f64, D>,
    /// The length of a line or an arc; for other curves it is not needed.
    pub(crate) length_mm: f64,
}

impl<'a, const D: usize> Leg<'a, D> {
    pub(crate) fn new(index: usize, curve: &'a PathCurve<f64, D>) -> Option<Self> {
        let length_mm = match curve {
            PathCurve::Line(line) => line.length(),
            PathCurve::Arc(arc) => arc.length(),
            _ => f64::INFINITY,
        };
        (length_mm > LEAST_LENGTH_MM).then_some(Self { index, curve, length_mm })
    }

    pub(crate) fn is_line_or_arc(&self) -> bool {
        matches!(self.curve, PathCurve::Line(_) | PathCurve::Arc(_))
    }

    /// The parameter at a distance from the beginning, on a line or an arc: both have constant |C'|.
    fn parameter(&self, distance_mm: f64) -> f64 {
        let (begin, end) = self.curve.domain();
        begin + (end - begin) * (distance_mm / self.length_mm)
    }

    /// Point and direction at a distance from the beginning; on any other curve, at the end that the distance stands
    /// for.
    pub(crate) fn at(&self, distance_mm: f64) -> ([f64; D], [f64; D]) {
        let (begin, end) = self.curve.domain();
        let (span, u) = match distance_mm {
            d if d <= 0.0 => (0, begin),
            d if d >= self.length_mm => (usize::MAX, end),
            d => (usize::MAX, self.parameter(d)),
        };
        let derivatives = self.curve.derivatives_in(span, u);
        let speed = f64::norm(&derivatives.first);
        (derivatives.point, derivatives.first.map(|x| if speed > 0.0 { x / speed } else { 0.0 }))
    }

    /// The part left when both ends are shortened; `None` if nothing is left.
    pub(crate) fn without(&self, at_begin: f64, at_end: f64) -> Option<PathCurve<f64, D>> {
        if at_begin <= 0.0 && at_end <= 0.0 {
            return Some(self.curve.clone());
        }
        if self.length_mm - at_begin - at_end <= LEAST_LENGTH_MM {
            return None;
        }
        match self.curve {
            PathCurve::Line(_) => {
                let ends = [self.at(at_begin).0, self.at(self.length_mm - at_end).0];
                Line::try_new(ends[0], ends[1]).ok().map(PathCurve::Line)
            }
            PathCurve::Arc(arc) => {
                let (begin, end) = (self.parameter(at_begin), self.parameter(self.length_mm - at_end));
                arc.part(begin, end).ok().map(PathCurve::Arc)
            }
            other => Some(other.clone()),
        }
    }

    /// Distance from a point to the move.
    pub(crate) fn distance_mm(&self, point: &[f64; D]) -> f64 {
        let (begin, end) = self.curve.domain();
        let u = match self.curve {
            PathCurve::Line(line) => {
                let [a, b] = line.ends();
                let along = sub(b, a);
                dot(&sub(point, a), &along) / dot(&along, &along)
            }
            PathCurve::Arc(arc) => nearest_on(arc, point),
            _ => return f64::INFINITY,
        };
        distance(&self.curve.point(u.clamp(begin, end)), point)
    }
}

/// The parameter of the arc's point nearest to `point`. Beyond the ends it is that of the nearer end.
fn nearest_on<const D: usize>(arc: &Arc<f64, D>, point: &[f64; D]) -> f64 {
    let arm = sub(point, arc.centre());
    let [a, b] = arc.radii();
    let (x, y) = (dot(&arm, a), dot(&arm, b));
    if x == 0.0 && y == 0.0 {
        return 0.0;
    }
    let u = quarter_turns(x, y);
    let beyond = u - arc.quarters();
    if beyond > 0.0 && 4.0 - u < beyond { 0.0 } else { u }
}
