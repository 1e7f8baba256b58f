//! The segment of one corner: its length on the moves, and the best segment that fits.

use alloc::vec::Vec;

use real::{Real, Trigonometric};

use crate::shapes::angle::quarter_turns;
use crate::smoothing::corner_shape::{CornerLambda, CornerShape};
use crate::smoothing::leg::{LEAST_LENGTH_MM, Leg};
use crate::vector::{add, distance, scaled};
use crate::{CornerStyle, Evaluate, PathCurve, Reason, TrigSegment, TrigSplineBuf, Turn, golden_section};

/// Two moves meet if their ends are no farther apart than this, in mm.
const JOINED_MM: f64 = 1e-6;

/// A corner turns by more than this, in rad. At a smaller angle a planner would slow down by less than a millionth.
const TANGENT_RAD: f64 = 1e-6;

/// A turn is a reversal if the cosine of its half is less than this, cos(85°).
const REVERSAL_COSINE: f64 = 0.087_155_742_747_658_17;

/// How often a cut between arcs is halved before the corner is left as it is.
const MAX_HALVINGS: usize = 24;

/// Number of samples of a segment when its error is measured.
const SAMPLES: u32 = 96;

/// The largest error is searched beside every sample that is a local maximum and at least this part of the largest
/// sample.
const LOCAL: f64 = 0.98;

/// The part of a cut's error that the measurement may miss. For the distance between an arc and the cut, it has missed
/// a quarter of this.
const MISSED: f64 = 1e-3;

/// The part of the tolerance that a segment may use: the rest is for rounding and for errors between samples.
const USED: f64 = 0.999;

/// The same for a shape that is searched. Its farthest point lies between samples.
const USED_BY_SEARCH: f64 = 0.997;

/// A corner, and the distance that its segment would take off the moves.
pub(crate) struct Planned<const D: usize> {
    pub(crate) turn: Turn<D>,
    style: Result<CornerStyle, Reason>,
    lambda: CornerLambda,
    /// Distance d of a cut.
    pub(crate) wanted_mm: f64,
}

/// A corner's segment.
pub(crate) struct Built<const D: usize> {
    pub(crate) curve: PathCurve<f64, D>,
    pub(crate) style: CornerStyle,
    /// The distance that the segment takes off each move.
    pub(crate) distance_mm: f64,
    pub(crate) error_mm: f64,
    pub(crate) lambda: f64,
}

impl<const D: usize> Planned<D> {
    pub(crate) fn new(
        before: &Leg<'_, D>,
        after: &Leg<'_, D>,
        tolerance_mm: f64,
        lambda: CornerLambda,
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
                // On an arc at most an eighth of a turn: farther along, the arc is too different from its tangent.
                let reach = |leg: &Leg<'_, D>| match leg.curve {
                    PathCurve::Arc(arc) => arc.radius() * f64::half_pi() / 2.0,
                    _ => f64::INFINITY,
                };
                let by_error = cut_distance(lambda, (sine, cosine), tolerance_mm);
                by_error.min(reach(before)).min(reach(after))
            }
            _ => 0.0,
        };
        Self { turn, style, lambda, wanted_mm }
    }

    pub(crate) fn build(
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
                    let cut =
                        self.build_cut(before, after, distance_mm, tolerance_mm).ok_or(Reason::NoRoom)?;
                    if cut.error_mm * (1.0 + MISSED) <= tolerance_mm {
                        return Ok(cut);
                    }
                    distance_mm /= 2.0;
                }
                Err(Reason::NoRoom)
            }
        }
    }

    fn build_cut(
        &self,
        before: &Leg<'_, D>,
        after: &Leg<'_, D>,
        distance_mm: f64,
        tolerance_mm: f64,
    ) -> Option<Built<D>> {
        let ((q0, t1), (q1, t2)) = (before.at(before.length_mm - distance_mm), after.at(distance_mm));
        let half = half_turn(&t1, &t2);
        if half.1 < REVERSAL_COSINE {
            return None; // an arc has turned the corner into a reversal
        }
        let allowed = USED_BY_SEARCH * tolerance_mm / distance_mm;
        let shape = cut_shape(self.lambda, half, Some(allowed));
        let [d0, d1] = [(&t1, 0), (&t2, 1)].map(|(t, end)| scaled(t, shape.reaches[end] * distance_mm));
        let segment = TrigSegment::between([q0, q1], [d0, d1], shape.lambda).ok()?;
        let off = largest(|u| {
            let point = segment.point(u);
            before.distance_mm(&point).min(after.distance_mm(&point))
        });
        let to_corner = samples(&segment).map(|point| distance(&point, &self.turn.point));
        let nearest = to_corner.fold(f64::INFINITY, f64::min);
        let curve = TrigSplineBuf::try_new(Vec::from([segment])).ok()?.into();
        let (style, lambda) = (CornerStyle::Cut, shape.lambda);
        Some(Built { curve, style, distance_mm, error_mm: off.max(nearest), lambda })
    }

    fn build_loop(
        &self,
        before: &Leg<'_, D>,
        after: &Leg<'_, D>,
        tolerance_mm: f64,
    ) -> Result<Built<D>, Reason> {
        let ((_, t1), (_, t2)) = (before.at(before.length_mm), after.at(0.0));
        let corner = self.turn.point;
        let (style, unit) = (CornerStyle::Loop, CornerShape::symmetric(1.0));
        let CornerShape { lambda, reaches: [m1, m2] } =
            CornerShape::best(self.lambda, style, half_turn(&t1, &t2), unit, None);
        let of_length = |length: f64| {
            TrigSegment::between([corner; 2], [scaled(&t1, m1 * length), scaled(&t2, m2 * length)], lambda)
        };
        let farthest = |segment: &TrigSegment<f64, D>| {
            samples(segment).map(|p| distance(&p, &corner)).fold(0.0, f64::max)
        };
        let of_unit = of_length(1.0).map_err(|_| Reason::NoRoom)?;
        let segment = of_length(USED * tolerance_mm / farthest(&of_unit)).map_err(|_| Reason::NoRoom)?;
        let error_mm = farthest(&segment);
        let curve = TrigSplineBuf::try_new(Vec::from([segment])).map_err(|_| Reason::NoRoom)?.into();
        Ok(Built { curve, style, distance_mm: 0.0, error_mm, lambda })
    }
}

fn samples<const D: usize>(segment: &TrigSegment<f64, D>) -> impl Iterator<Item = [f64; D]> + '_ {
    (0..=SAMPLES).map(|step| segment.point(f64::from(step) / f64::from(SAMPLES)))
}

/// The largest value of `of` over [0, 1]: samples, and a golden-section search beside those that are local maxima.
///
/// Between lines the farthest point of a cut is its middle, which is a sample. Beside an arc the farthest point may be
/// anywhere. There, samples alone miss up to 0.25 % if the arc bends away by much more than the error.
fn largest(of: impl Fn(f64) -> f64) -> f64 {
    const STEPS: usize = 20;
    let at = |step: u32| f64::from(step) / f64::from(SAMPLES);
    let values: Vec<f64> = (0..=SAMPLES).map(|step| of(at(step))).collect();
    let sampled = values.iter().copied().fold(0.0, f64::max);
    let mut found = sampled;
    for (step, three) in (0..).zip(values.windows(3)) {
        if three[1] < three[0] || three[1] < three[2] || three[1] < sampled * LOCAL {
            continue;
        }
        found = found.max(golden_section((at(step), at(step + 2)), STEPS, &of, |y| -*y).found);
    }
    found
}

/// The shape of a cut, from sine and cosine of φ/2. The error in units of d may be `error_allowed`; if it is `None`, d
/// follows from the error.
fn cut_shape(lambda: CornerLambda, half: (f64, f64), error_allowed: Option<f64>) -> CornerShape {
    let symmetric = CornerShape::symmetric(cut_tangent(half.1));
    CornerShape::best(lambda, CornerStyle::Cut, half, symmetric, error_allowed)
}

/// The distance d at which a cut uses up the tolerance, in mm, from sine and cosine of φ/2. With λ = 1 it is
/// `d = ε / (sin(φ/2)(1 - 2ηm))`.
fn cut_distance(lambda: CornerLambda, half: (f64, f64), tolerance_mm: f64) -> f64 {
    let (sine, cosine) = half;
    if lambda == CornerLambda::default() {
        let eta = (core::f64::consts::SQRT_2 - 1.0) / (2.0 * f64::half_pi());
        USED * tolerance_mm / (sine * (1.0 - 2.0 * eta * cut_tangent(cosine)))
    } else {
        USED_BY_SEARCH * tolerance_mm / cut_shape(lambda, half, None).error(half)
    }
}

/// The best m for cos(φ/2), at which greatest curvature times error is least.
///
/// The table was found by golden-section search at steps of a tenth; between its entries the product is within 2 % of its least.
pub(crate) fn cut_tangent(cosine: f64) -> f64 {
    const TABLE: [f64; 11] =
        [0.2, 0.4765, 0.8025, 1.0411, 1.2215, 1.362, 1.474, 1.565, 1.7135, 1.8553, 1.9858];
    let place = (cosine * 10.0).clamp(0.0, 10.0);
    let pairs = (0_u8..).zip(TABLE.windows(2));
    let entry = |(i, pair): (u8, &[f64])| (place - f64::from(i), pair[0], pair[1]);
    let (part, low, high) = pairs.map(entry).find(|(part, ..)| *part <= 1.0).unwrap_or((1.0, 0.0, TABLE[10]));
    low + (high - low) * part
}

/// Sine and cosine of half the angle between two unit vectors: half the length of their difference and of their sum.
pub(crate) fn half_turn<const D: usize>(t1: &[f64; D], t2: &[f64; D]) -> (f64, f64) {
    (distance(t2, t1) / 2.0, f64::norm(&add(t1, t2)) / 2.0)
}
