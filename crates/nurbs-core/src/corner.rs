//! Corner smoothing: a path of straight moves and arcs, each corner replaced by one trigonometric segment.
//!
//! At a corner in B the direction turns by φ, from `t_1` to `t_2`. A segment that joins the moves smoothly is given by its ends
//! and the derivatives there, along `t_1` and `t_2`, with k = -1 and λ = 1: only then is it symmetric, and the error the same
//! whichever way the path is followed.
//!
//! **The cut** leaves the incoming move at a distance d before B, and meets the outgoing one at d behind it:
//!
//! `q_0 = B - d t_1`, `q_1 = B + d t_2`, `D_0 = m d t_1`, `D_1 = m d t_2`.
//!
//! It comes nearest to B in the middle, where `H_00 = 1/2` and `H_10 = -H_11 = η`, `η = (√2 - 1)/π`; there its distance, the
//! corner error, is
//!
//! `ε = d sin(φ/2) (1 - 2 η m)`,
//!
//! so the distance for a given error is known. What is left is m, the length of the end derivatives. The longest curve is not
//! the best; the feed on a bend follows from its curvature, so m is taken where the product of greatest curvature and error is
//! least: for φ = 90° that is π/2, the quarter circle, and elsewhere it comes within 21 % of a circle's, which no tangent arc
//! betters.
//!
//! **The loop** leaves B itself along the first move, turns round outside, and comes back to B along the second:
//!
//! `q_0 = q_1 = B`, `D_0 = ℓ t_1`, `D_1 = ℓ t_2`.
//!
//! The corner stays sharp and both moves whole; the way is longer, and the curvature twelve times that of a cut of the same error at
//! 90°. It begins and ends with curvature 0.
//!
//! Two corners share each move: each may take half of it, and more where the other needs less.

use alloc::vec::Vec;

use real::{Real, Trigonometric};

use crate::arc::quarter_turns;
use crate::{Arc, Differentiate, Evaluate, Line, PathCurve, ShapeError, TrigSegment, TrigSplineBuf};

/// How a corner is smoothed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CornerStyle {
    /// Cut off, on the inside.
    Cut,
    /// Left and met again in a loop, on the outside.
    Loop,
}

/// A place where two moves meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Turn<const D: usize> {
    /// Index of the incoming move.
    pub before: usize,
    /// Index of the outgoing move: the next that has a length.
    pub after: usize,
    /// The corner B.
    pub point: [f64; D],
    /// φ, the angle by which the direction turns, in rad, from 0 to π.
    pub turn_rad: f64,
}

/// What became of a corner.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Corner<const D: usize> {
    /// Where it is, and how sharp.
    pub turn: Turn<D>,
    /// Whether it was smoothed.
    pub outcome: CornerOutcome,
}

/// Whether a corner was smoothed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum CornerOutcome {
    /// A segment replaces it.
    Smoothed {
        /// How.
        style: CornerStyle,
        /// Index of the segment among the curves of the smooth path.
        curve: usize,
        /// Distance between the segment and what it replaces: largest one both ways, in mm.
        error_mm: f64,
    },
    /// It stays as it is.
    Left(Reason),
}

/// Why a corner stays as it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Reason {
    /// The moves join smoothly: there is no corner.
    Tangent,
    /// The path turns back on itself, by more than 170°: whatever passes there all but stops.
    Reversal,
    /// The outgoing move does not begin where the incoming one ends.
    NotJoined,
    /// A neighbour is neither a line nor an arc.
    NotLineOrArc,
    /// No segment within the tolerance was found: the moves are too short, or an arc bends too much.
    NoRoom,
    /// The caller wants it so.
    Wanted,
}

impl core::fmt::Display for Reason {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.write_str(match self {
            Self::Tangent => "smooth as it is",
            Self::Reversal => "turns back on itself",
            Self::NotJoined => "moves do not meet",
            Self::NotLineOrArc => "next to a spline",
            Self::NoRoom => "no room within the tolerance",
            Self::Wanted => "to be left",
        })
    }
}

/// A path with its corners smoothed.
#[derive(Clone, Debug, PartialEq)]
pub struct SmoothPath<const D: usize> {
    /// The curves: what is left of the moves, and the segments between them.
    pub curves: Vec<PathCurve<f64, D>>,
    /// For each curve the index of the move that it is part of; for a corner, of the incoming one.
    pub moves: Vec<usize>,
    /// Every corner, in order.
    pub corners: Vec<Corner<D>>,
}

/// Moves shorter than this are no moves, and cuts of no more than a thousand times this no cuts, in mm: far below what a drive
/// resolves.
const LEAST_LENGTH_MM: f64 = 1e-9;

/// A gap between two moves that is none, in mm.
const JOINED_MM: f64 = 1e-6;

/// A turn that is none, in rad: a planner that sees it would slow down for less than a millionth.
const TANGENT_RAD: f64 = 1e-6;

/// cos(85°): half of a turn that is a reversal.
const REVERSAL_COSINE: f64 = 0.087_155_742_747_658_17;

/// How often a cut between arcs is halved before the corner is left.
const MAX_HALVINGS: usize = 24;

/// Samples of a segment when its error is measured; they miss less than 2e-4 of it.
const SAMPLES: u32 = 96;

/// The part of the tolerance that is used: the rest is for rounding and for what sampling misses.
const USED: f64 = 0.999;

/// Smooths the corners of `moves`, which follow each other. `style` is asked for each corner that can be smoothed; with `None` it is
/// left.
///
/// Moves without length are dropped. Each smoothed corner stays within `tolerance_mm` of the moves, and they within
/// that of it; parts cut off a move at both its ends do not overlap.
///
/// # Errors
/// [`ShapeError::ToleranceNotPositive`].
pub fn smooth_corners<const D: usize>(
    moves: &[PathCurve<f64, D>],
    tolerance_mm: f64,
    mut style: impl FnMut(&Turn<D>) -> Option<CornerStyle>,
) -> Result<SmoothPath<D>, ShapeError> {
    if !(tolerance_mm > 0.0 && tolerance_mm.is_finite()) {
        return Err(ShapeError::ToleranceNotPositive);
    }
    let legs: Vec<Leg<'_, D>> =
        moves.iter().enumerate().filter_map(|(i, curve)| Leg::new(i, curve)).collect();
    let planned: Vec<Planned<D>> =
        legs.windows(2).map(|pair| Planned::new(&pair[0], &pair[1], tolerance_mm, &mut style)).collect();
    let wanted = |joint: Option<usize>| joint.and_then(|j| planned.get(j)).map_or(0.0, |p| p.wanted_mm);
    // Leg i lies between the joints i - 1 and i.
    let room = |leg: usize, other: Option<usize>| {
        let length = legs[leg].length_mm;
        (length / 2.0).max(length - wanted(other))
    };
    let mut path = SmoothPath { curves: Vec::new(), moves: Vec::new(), corners: Vec::new() };
    let mut used = 0.0; // of the current leg, at its beginning
    for (i, leg) in legs.iter().enumerate() {
        let cut = planned.get(i).zip(legs.get(i + 1)).map(|(plan, next)| {
            let distance = plan.wanted_mm.min(room(i, i.checked_sub(1))).min(room(i + 1, Some(i + 1)));
            (plan, plan.build(leg, next, distance, tolerance_mm))
        });
        let (at_end, next_used) = match &cut {
            Some((_, Ok(built))) => (built.distance_mm, built.distance_mm),
            _ => (0.0, 0.0),
        };
        if let Some(rest) = leg.without(used, at_end) {
            path.curves.push(rest);
            path.moves.push(leg.index);
        }
        used = next_used;
        if let Some((plan, result)) = cut {
            let outcome = match result {
                Ok(built) => {
                    let curve = path.curves.len();
                    path.curves.push(built.curve);
                    path.moves.push(leg.index);
                    CornerOutcome::Smoothed { style: built.style, curve, error_mm: built.error_mm }
                }
                Err(reason) => CornerOutcome::Left(reason),
            };
            path.corners.push(Corner { turn: plan.turn, outcome });
        }
    }
    Ok(path)
}

/// A move that has a length.
struct Leg<'a, const D: usize> {
    index: usize,
    curve: &'a PathCurve<f64, D>,
    /// Of a line or an arc; of others it is not needed.
    length_mm: f64,
}

impl<'a, const D: usize> Leg<'a, D> {
    fn new(index: usize, curve: &'a PathCurve<f64, D>) -> Option<Self> {
        let length_mm = match curve {
            PathCurve::Line(line) => line.length(),
            PathCurve::Arc(arc) => arc.length(),
            _ => f64::INFINITY,
        };
        (length_mm > LEAST_LENGTH_MM).then_some(Self { index, curve, length_mm })
    }

    fn is_line_or_arc(&self) -> bool {
        matches!(self.curve, PathCurve::Line(_) | PathCurve::Arc(_))
    }

    /// The parameter at a distance from the beginning, of a line or an arc, both of which run evenly.
    fn parameter(&self, distance_mm: f64) -> f64 {
        let (begin, end) = self.curve.domain();
        begin + (end - begin) * (distance_mm / self.length_mm)
    }

    /// Point and direction at a distance from the beginning; of any other curve, at the end that the distance names.
    fn at(&self, distance_mm: f64) -> ([f64; D], [f64; D]) {
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

    /// What is left when both ends are shortened; `None` if that is nothing.
    fn without(&self, at_begin: f64, at_end: f64) -> Option<PathCurve<f64, D>> {
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
    fn distance_mm(&self, point: &[f64; D]) -> f64 {
        let (begin, end) = self.curve.domain();
        let u = match self.curve {
            PathCurve::Line(line) => {
                let [a, b] = line.ends();
                let along = minus(b, a);
                dot(&minus(point, a), &along) / dot(&along, &along)
            }
            PathCurve::Arc(arc) => nearest_on(arc, point),
            _ => return f64::INFINITY,
        };
        distance(&self.curve.point(u.clamp(begin, end)), point)
    }
}

/// The parameter of the arc's point nearest to `point`, beyond the ends that of the nearer end.
fn nearest_on<const D: usize>(arc: &Arc<f64, D>, point: &[f64; D]) -> f64 {
    let arm = minus(point, arc.centre());
    let [a, b] = arc.radii();
    let (x, y) = (dot(&arm, a), dot(&arm, b));
    if x == 0.0 && y == 0.0 {
        return 0.0;
    }
    let u = quarter_turns(x, y);
    let beyond = u - arc.quarters();
    if beyond > 0.0 && 4.0 - u < beyond { 0.0 } else { u }
}

/// A corner, and how much of the moves it would take.
struct Planned<const D: usize> {
    turn: Turn<D>,
    style: Result<CornerStyle, Reason>,
    /// Distance d of a cut.
    wanted_mm: f64,
}

/// A corner's segment.
struct Built<const D: usize> {
    curve: PathCurve<f64, D>,
    style: CornerStyle,
    /// What it takes off each move.
    distance_mm: f64,
    error_mm: f64,
}

impl<const D: usize> Planned<D> {
    fn new(
        before: &Leg<'_, D>,
        after: &Leg<'_, D>,
        tolerance_mm: f64,
        style: &mut impl FnMut(&Turn<D>) -> Option<CornerStyle>,
    ) -> Self {
        let ((point, t1), (begin, t2)) = (before.at(before.length_mm), after.at(0.0));
        let (sine, cosine) = half_turn(&t1, &t2);
        let turn_rad = 2.0 * f64::half_pi() * if sine > 0.0 { quarter_turns(cosine, sine) } else { 0.0 };
        let turn = Turn { before: before.index, after: after.index, point, turn_rad };
        let style = if distance(&point, &begin) > JOINED_MM {
            Err(Reason::NotJoined)
        } else if turn_rad <= TANGENT_RAD {
            Err(Reason::Tangent)
        } else if cosine < REVERSAL_COSINE {
            Err(Reason::Reversal)
        } else if !(before.is_line_or_arc() && after.is_line_or_arc()) {
            Err(Reason::NotLineOrArc)
        } else {
            style(&turn).ok_or(Reason::Wanted)
        };
        let wanted_mm = match style {
            Ok(CornerStyle::Cut) => {
                // Along an arc no farther than an eighth of a turn: beyond, it is another curve.
                let reach = |leg: &Leg<'_, D>| match leg.curve {
                    PathCurve::Arc(arc) => arc.radius() * f64::half_pi() / 2.0,
                    _ => f64::INFINITY,
                };
                cut_distance(sine, cosine, USED * tolerance_mm).min(reach(before)).min(reach(after))
            }
            _ => 0.0,
        };
        Self { turn, style, wanted_mm }
    }

    fn build(
        &self,
        before: &Leg<'_, D>,
        after: &Leg<'_, D>,
        distance_mm: f64,
        tolerance_mm: f64,
    ) -> Result<Built<D>, Reason> {
        match self.style? {
            CornerStyle::Loop => self.build_loop(before, after, tolerance_mm),
            CornerStyle::Cut => {
                let mut distance_mm = distance_mm;
                for _ in 0..MAX_HALVINGS {
                    if distance_mm <= 1e3 * LEAST_LENGTH_MM {
                        break;
                    }
                    let cut = self.build_cut(before, after, distance_mm).ok_or(Reason::NoRoom)?;
                    if cut.error_mm <= tolerance_mm {
                        return Ok(cut);
                    }
                    distance_mm /= 2.0;
                }
                Err(Reason::NoRoom)
            }
        }
    }

    fn build_cut(&self, before: &Leg<'_, D>, after: &Leg<'_, D>, distance_mm: f64) -> Option<Built<D>> {
        let ((q0, t1), (q1, t2)) = (before.at(before.length_mm - distance_mm), after.at(distance_mm));
        let (_, cosine) = half_turn(&t1, &t2);
        if cosine < REVERSAL_COSINE {
            return None; // an arc has turned the corner into a reversal
        }
        let reach = cut_tangent(cosine) * distance_mm;
        let segment =
            TrigSegment::between([q0, q1], [t1.map(|x| x * reach), t2.map(|x| x * reach)], 1.0).ok()?;
        let (mut off, mut nearest) = (0.0_f64, f64::INFINITY);
        for point in samples(&segment) {
            off = off.max(before.distance_mm(&point).min(after.distance_mm(&point)));
            nearest = nearest.min(distance(&point, &self.turn.point));
        }
        let curve = TrigSplineBuf::try_new(Vec::from([segment])).ok()?.into();
        Some(Built { curve, style: CornerStyle::Cut, distance_mm, error_mm: off.max(nearest) })
    }

    fn build_loop(
        &self,
        before: &Leg<'_, D>,
        after: &Leg<'_, D>,
        tolerance_mm: f64,
    ) -> Result<Built<D>, Reason> {
        let ((_, t1), (_, t2)) = (before.at(before.length_mm), after.at(0.0));
        let corner = self.turn.point;
        let of_length = |reach: f64| {
            TrigSegment::between([corner; 2], [t1.map(|x| x * reach), t2.map(|x| x * reach)], 1.0)
        };
        let farthest = |segment: &TrigSegment<f64, D>| {
            samples(segment).map(|p| distance(&p, &corner)).fold(0.0, f64::max)
        };
        let of_unit = of_length(1.0).map_err(|_| Reason::NoRoom)?;
        let segment = of_length(USED * tolerance_mm / farthest(&of_unit)).map_err(|_| Reason::NoRoom)?;
        let error_mm = farthest(&segment);
        let curve = TrigSplineBuf::try_new(Vec::from([segment])).map_err(|_| Reason::NoRoom)?.into();
        Ok(Built { curve, style: CornerStyle::Loop, distance_mm: 0.0, error_mm })
    }
}

fn samples<const D: usize>(segment: &TrigSegment<f64, D>) -> impl Iterator<Item = [f64; D]> + '_ {
    (0..=SAMPLES).map(|step| segment.point(f64::from(step) / f64::from(SAMPLES)))
}

/// `d = ε / (sin(φ/2)(1 - 2ηm))`, from sine and cosine of φ/2.
fn cut_distance(sine: f64, cosine: f64, error_mm: f64) -> f64 {
    let eta = (core::f64::consts::SQRT_2 - 1.0) / (2.0 * f64::half_pi());
    error_mm / (sine * (1.0 - 2.0 * eta * cut_tangent(cosine)))
}

/// The best m for cos(φ/2), at which greatest curvature times error is least.
///
/// The table was found by golden-section search at steps of a tenth; between its entries the product is within 2 % of its least.
fn cut_tangent(cosine: f64) -> f64 {
    const TABLE: [f64; 11] =
        [0.2, 0.4765, 0.8025, 1.0411, 1.2215, 1.362, 1.474, 1.565, 1.7135, 1.8553, 1.9858];
    let place = (cosine * 10.0).clamp(0.0, 10.0);
    let pairs = (0_u8..).zip(TABLE.windows(2));
    let entry = |(i, pair): (u8, &[f64])| (place - f64::from(i), pair[0], pair[1]);
    let (part, low, high) = pairs.map(entry).find(|(part, ..)| *part <= 1.0).unwrap_or((1.0, 0.0, TABLE[10]));
    low + (high - low) * part
}

/// Sine and cosine of half the angle between two unit vectors: half the length of their difference and of their sum.
fn half_turn<const D: usize>(t1: &[f64; D], t2: &[f64; D]) -> (f64, f64) {
    let sum: [f64; D] = core::array::from_fn(|d| t1[d] + t2[d]);
    (f64::norm(&minus(t2, t1)) / 2.0, f64::norm(&sum) / 2.0)
}

fn minus<const D: usize>(a: &[f64; D], b: &[f64; D]) -> [f64; D] {
    core::array::from_fn(|d| a[d] - b[d])
}

fn dot<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    f64::sum_of_products(a.iter().copied().zip(b.iter().copied()))
}

fn distance<const D: usize>(a: &[f64; D], b: &[f64; D]) -> f64 {
    f64::norm(&minus(a, b))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Sense, curvature};
    use proptest::prelude::*;

    fn polyline<const D: usize>(points: &[[f64; D]]) -> Vec<PathCurve<f64, D>> {
        points.windows(2).map(|p| Line::try_new(p[0], p[1]).unwrap().into()).collect()
    }

    fn cut<const D: usize>(moves: &[PathCurve<f64, D>], tolerance: f64) -> SmoothPath<D> {
        smooth_corners(moves, tolerance, |_| Some(CornerStyle::Cut)).unwrap()
    }

    fn reason<const D: usize>(path: &SmoothPath<D>, corner: usize) -> Option<Reason> {
        match path.corners[corner].outcome {
            CornerOutcome::Left(reason) => Some(reason),
            CornerOutcome::Smoothed { .. } => None,
        }
    }

    /// Points along a curve, close together.
    fn dense<const D: usize>(curve: &PathCurve<f64, D>, count: i32) -> Vec<[f64; D]> {
        let (begin, end) = curve.domain();
        (0..=count).map(|i| curve.point(begin + (end - begin) * f64::from(i) / f64::from(count))).collect()
    }

    /// Distance from a point to a polygon, by projecting on each side.
    fn to_polygon<const D: usize>(point: &[f64; D], polygon: &[[f64; D]]) -> f64 {
        let to_side = |side: &[[f64; D]]| {
            let (a, b) = (side[0], side[1]);
            let (mut along, mut square) = (0.0, 0.0);
            for d in 0..D {
                along += (point[d] - a[d]) * (b[d] - a[d]);
                square += (b[d] - a[d]).powi(2);
            }
            let u = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
            (0..D).map(|d| (a[d] + u * (b[d] - a[d]) - point[d]).powi(2)).sum::<f64>().sqrt()
        };
        polygon.windows(2).map(to_side).fold(f64::INFINITY, f64::min)
    }

    /// The largest distance between the smooth path and the moves, both ways, by polygons of many points: a check that shares
    /// nothing with what it checks but the points of the curves.
    fn deviation<const D: usize>(moves: &[PathCurve<f64, D>], path: &SmoothPath<D>) -> f64 {
        let sides = |curve: &PathCurve<f64, D>| if matches!(curve, PathCurve::Line(_)) { 1 } else { 400 };
        let of_moves: Vec<_> = moves.iter().map(|m| dense(m, sides(m))).collect();
        let of_path: Vec<_> = path.curves.iter().map(|c| dense(c, sides(c))).collect();
        let (mut worst, near) = (0.0_f64, 3);
        for (curve, index) in path.curves.iter().zip(&path.moves) {
            let close = index.saturating_sub(near)..(index + near + 1).min(moves.len());
            let nearest = |p: &[f64; D]| {
                of_moves[close.clone()].iter().map(|m| to_polygon(p, m)).fold(f64::MAX, f64::min)
            };
            worst = dense(curve, 40).iter().map(nearest).fold(worst, f64::max);
        }
        let mut first = 0;
        for (index, polygon) in of_moves.iter().enumerate() {
            // Curves are in order of moves; those of near moves lie close together.
            while path.moves.get(first).is_some_and(|m| m + near < index) {
                first += 1;
            }
            let close = of_path.iter().zip(&path.moves).skip(first).take_while(|(_, m)| **m <= index + near);
            let close: Vec<_> = close.map(|(polygon, _)| polygon).collect();
            let nearest = |p: &[f64; D]| close.iter().map(|c| to_polygon(p, c)).fold(f64::MAX, f64::min);
            worst = [polygon[0], polygon[polygon.len() - 1]].iter().map(nearest).fold(worst, f64::max);
        }
        worst
    }

    /// The curves follow each other, with one direction but for the corners that were left.
    fn is_continuous<const D: usize>(path: &SmoothPath<D>) -> Result<(), TestCaseError> {
        let left: Vec<_> = path
            .corners
            .iter()
            .filter(|c| matches!(c.outcome, CornerOutcome::Left(_)))
            .map(|c| c.turn.point)
            .collect();
        for (i, pair) in path.curves.windows(2).enumerate() {
            let (end, begin) = (pair[0].domain().1, pair[1].domain().0);
            let (a, b) = (pair[0].derivatives_in(usize::MAX, end), pair[1].derivatives_in(0, begin));
            prop_assert!(distance(&a.point, &b.point) <= 1e-11, "curves {i}: {:?} {:?}", a.point, b.point);
            let is_left = left.iter().any(|corner| distance(corner, &a.point) <= 1e-9);
            let (sine, cosine) = half_turn(&unit(a.first), &unit(b.first));
            prop_assert!(is_left || sine <= 1e-6 && cosine > 0.0, "curves {i}: {:?} {:?}", a.first, b.first);
        }
        Ok(())
    }

    fn unit<const D: usize>(v: [f64; D]) -> [f64; D] {
        let length = f64::norm(&v);
        v.map(|x| x / length)
    }

    fn corner_of<const D: usize>(path: &SmoothPath<D>, corner: usize) -> (&PathCurve<f64, D>, f64) {
        match path.corners[corner].outcome {
            CornerOutcome::Smoothed { curve, error_mm, .. } => (&path.curves[curve], error_mm),
            CornerOutcome::Left(reason) => panic!("left: {reason}"),
        }
    }

    fn greatest_curvature(curve: &PathCurve<f64, 2>) -> f64 {
        (1..1000).map(|i| curvature(&curve.derivatives(f64::from(i) / 1000.0))).fold(0.0, f64::max)
    }

    /// Two moves of 100 mm, turning by an angle in degrees.
    fn turning(degrees: f64) -> Vec<PathCurve<f64, 2>> {
        let angle = degrees.to_radians();
        polyline(&[[-100.0, 0.0], [0.0, 0.0], [100.0 * angle.cos(), 100.0 * angle.sin()]])
    }

    proptest! {
        #[test]
        fn every_corner_of_a_polyline_is_within_tolerance(
            steps in proptest::collection::vec([-1.0..1.0, -1.0..1.0, -0.2..0.2], 3..20),
            scale in -2..2_i32, exponent in -4..1_i32, loops: bool,
        ) {
            let (scale, tolerance) = (10.0_f64.powi(scale), 10.0_f64.powi(exponent));
            let mut points = vec![[0.0; 3]];
            for step in steps {
                let last = points[points.len() - 1];
                points.push(core::array::from_fn(|d| last[d] + scale * step[d]));
            }
            let moves = polyline(&points);
            let style = if loops { CornerStyle::Loop } else { CornerStyle::Cut };
            let path = smooth_corners(&moves, tolerance, |_| Some(style)).unwrap();
            prop_assert_eq!(path.corners.len(), moves.len() - 1);
            is_continuous(&path)?;
            prop_assert!(deviation(&moves, &path) <= tolerance * (1.0 + 1e-9), "{}", deviation(&moves, &path));
            for (i, corner) in path.corners.iter().enumerate() {
                let expected = [None, Some(Reason::Reversal)];
                prop_assert!(expected.contains(&reason(&path, i)), "{corner:?}");
                let reversal = corner.turn.turn_rad > 170.0_f64.to_radians();
                prop_assert_eq!(reason(&path, i).is_some(), reversal);
            }
            prop_assert_eq!(path.curves[0].point(0.0), points[0]);
            let last = path.curves.last().unwrap();
            prop_assert_eq!(last.point(last.domain().1), points[points.len() - 1]);
        }

        #[test]
        fn corners_of_lines_and_arcs_are_within_tolerance_or_left(
            radius in 0.5..20.0_f64, by in 0.1..3.9_f64, turn in 10.0..160.0_f64, clockwise: bool, exponent in -4..0_i32,
        ) {
            // A line, an arc that leaves it at an angle, and a line that leaves the arc at an angle.
            let tolerance = 10.0_f64.powi(exponent);
            let (side, sense) = if clockwise { (-1.0, Sense::Clockwise) } else { (1.0, Sense::Counterclockwise) };
            let direction = turn.to_radians();
            let centre = [-radius * side * direction.sin(), radius * side * direction.cos()];
            let around = |quarters: f64| {
                let angle = direction - side * core::f64::consts::FRAC_PI_2 + side * quarters * core::f64::consts::FRAC_PI_2;
                [centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin()]
            };
            let end = around(by);
            let arc = Arc::in_plane([[0.0, 0.0], end, centre], [0, 1], sense, 1e-6).unwrap();
            let line = |a, b| PathCurve::from(Line::try_new(a, b).unwrap());
            let moves = [line([-30.0, 0.0], [0.0, 0.0]), arc.into(), line(end, [end[0], end[1] + 30.0])];
            let path = cut(&moves, tolerance);
            is_continuous(&path)?;
            // Polygons of 400 sides leave an arc of 20 mm and a full turn by 6e-4 mm at most.
            prop_assert!(deviation(&moves, &path) <= tolerance + 7e-4, "{}", deviation(&moves, &path));
            let expected = [None, Some(Reason::Reversal), Some(Reason::Tangent)];
            prop_assert!(expected.contains(&reason(&path, 0)) && expected.contains(&reason(&path, 1)), "{:?}", path.corners);
        }
    }

    #[test]
    fn a_cut_is_nearly_as_round_as_a_circle() {
        for degrees in (1..170).map(f64::from) {
            let path = cut(&turning(degrees), 0.1);
            let (curve, error) = corner_of(&path, 0);
            assert!((path.corners[0].turn.turn_rad.to_degrees() - degrees).abs() < 1e-6);
            // The distance follows from the error: the tolerance is used up.
            assert!((0.0998..=0.1).contains(&error), "{degrees}: {error}");
            // A circle of radius ρ, tangent to both, comes within ρ(1/cos(φ/2) - 1) of the corner.
            let of_circle = 1.0 / (degrees.to_radians() / 2.0).cos() - 1.0;
            let ratio = greatest_curvature(curve) * error / of_circle;
            assert!(ratio <= 1.21, "{degrees}: {ratio}");
        }
        let path = cut(&turning(90.0), 0.1);
        let (quarter, _) = corner_of(&path, 0);
        let bend = greatest_curvature(quarter);
        assert!((bend * 0.0999 / (2.0_f64.sqrt() - 1.0) - 1.0).abs() < 5e-3, "{bend}");
    }

    #[test]
    fn a_loop_has_the_figures_of_another_program() {
        // For ℓ = 1 and 90°: farthest 0.187, greatest curvature 28.3; no curvature at its ends.
        let moves = turning(90.0);
        let path = smooth_corners(&moves, 0.187, |_| Some(CornerStyle::Loop)).unwrap();
        let (curve, error) = corner_of(&path, 0);
        assert!((error - 0.999 * 0.187).abs() < 1e-12);
        assert!((greatest_curvature(curve) - 28.3).abs() < 0.1, "{}", greatest_curvature(curve));
        let outside = curve.point(0.5);
        assert!(outside[0] > 0.1 && outside[1] < -0.1, "{outside:?}");
        for end in [0.0, 1.0] {
            assert_eq!(curve.point(end), [0.0, 0.0]);
            assert!(curvature(&curve.derivatives(end)) < 1e-9);
        }
        assert_eq!((&path.curves[0], &path.curves[2]), (&moves[0], &moves[1]));
    }

    #[test]
    fn moves_that_are_none_and_corners_that_are_none() {
        // A zero-length move is dropped, and the corner is that of its neighbours.
        let path = cut(&polyline(&[[0.0, 0.0], [10.0, 0.0], [10.0, 0.0], [10.0, 10.0]]), 0.1);
        assert_eq!(path.moves, [0, 0, 2]);
        assert_eq!((path.corners.len(), path.corners[0].turn.after), (1, 2));
        // Collinear moves have no corner; a reversal has one that stays.
        let path = cut(&polyline(&[[0.0, 0.0], [10.0, 5.0], [20.0, 10.0], [0.0, 0.0]]), 0.1);
        assert_eq!([reason(&path, 0), reason(&path, 1)], [Some(Reason::Tangent), Some(Reason::Reversal)]);
        assert_eq!((path.corners[1].turn.turn_rad - core::f64::consts::PI).abs(), 0.0);
        assert_eq!(path.curves.len(), 3);
        // Moves apart, a spline, and what the caller wants left.
        let line = |a, b| PathCurve::from(Line::try_new(a, b).unwrap());
        let spline = line([10.0, 0.0], [10.0, 10.0]).to_nurbs(1.0).unwrap().into();
        let path = cut(&[line([0.0, 0.0], [9.0, 0.0]), line([10.0, 0.0], [10.0, 5.0])], 0.1);
        assert_eq!(reason(&path, 0), Some(Reason::NotJoined));
        let path = cut(&[line([0.0, 0.0], [10.0, 0.0]), spline], 0.1);
        assert_eq!((reason(&path, 0), path.curves.len()), (Some(Reason::NotLineOrArc), 2));
        let path = smooth_corners(&turning(90.0), 0.1, |_| None).unwrap();
        assert_eq!((reason(&path, 0), path.curves), (Some(Reason::Wanted), turning(90.0)));
        assert_eq!(cut::<2>(&[], 0.1).curves, []);
        assert_eq!(smooth_corners::<2>(&[], 0.0, |_| None), Err(ShapeError::ToleranceNotPositive));
    }

    #[test]
    fn moves_shorter_than_the_tolerance_share_their_room() {
        // A staircase of 10 µm steps with a tolerance of 1 mm: each corner takes half of both moves, and nothing is left of them.
        let stairs: Vec<_> =
            (0..=20_i32).map(|i| [f64::from((i + 1) / 2) * 0.01, f64::from(i / 2) * 0.01]).collect();
        let path = cut(&polyline(&stairs), 1.0);
        assert_eq!((path.corners.len(), path.curves.len()), (19, 21));
        is_continuous(&path).unwrap();
        let middle = corner_of(&path, 9).0;
        assert!(
            (middle.point(0.0)[0] - stairs[9][0]).abs().max((middle.point(0.0)[1] - stairs[9][1]).abs())
                < 5.1e-3
        );
        // A corner that needs less than half leaves the rest to its neighbour.
        let path = cut(&polyline(&[[-50.0, 0.0], [0.0, 0.0], [0.0, 1.0], [0.01, 50.0]]), 0.3);
        let (sharp, flat) = (corner_of(&path, 0).0, corner_of(&path, 1).0);
        assert!(sharp.point(1.0)[1] > 0.49 && flat.point(0.0)[1] >= sharp.point(1.0)[1]);
    }

    #[test]
    fn every_corner_of_an_engraving_is_within_tolerance() {
        // 6 500 cutting moves of 75 outlines; rapid moves and plunges are followed as they are.
        let program = include_str!("../../../data/engraving.nc");
        let (mut at, mut points, mut cuts) = ([0.0; 3], vec![[0.0; 3]], Vec::new());
        for line in program.lines().filter(|line| line.starts_with('G')) {
            let mut next = at;
            for word in line.split_whitespace() {
                if let Some(axis) = "XYZ".find(&word[..1]) {
                    next[axis] = word[1..].parse().unwrap();
                }
            }
            if next != at {
                cuts.push(line.starts_with("G1") && next[2] == at[2]);
                points.push(next);
                at = next;
            }
        }
        let moves = polyline(&points);
        let cutting = |turn: &Turn<3>| cuts[turn.before] && cuts[turn.after];
        let tolerance = 0.01;
        let path =
            smooth_corners(&moves, tolerance, |turn| cutting(turn).then_some(CornerStyle::Cut)).unwrap();
        let count = |of: Option<Reason>| (0..path.corners.len()).filter(|i| reason(&path, *i) == of).count();
        let smoothed = count(None);
        assert_eq!(smoothed + count(Some(Reason::Tangent)) + count(Some(Reason::Wanted)), path.corners.len());
        assert!(smoothed > 6000, "{smoothed}");
        is_continuous(&path).unwrap();
        let worst = deviation(&moves, &path);
        assert!(worst <= tolerance, "{worst}");
    }
}
