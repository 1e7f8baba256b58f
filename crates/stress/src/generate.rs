//! Paths and limits from bytes.
//!
//! Any bytes give a path. So one generator serves a fuzzer, which changes bytes and watches which code they reach; a
//! property test, which shrinks the bytes; and a soak, which draws them at random. Missing bytes read as 0.
//!
//! | kind | share | control points | weights | knots |
//! |---|---|---|---|---|
//! | part | 5/8 | a walk that turns by at most 60° | all 1, or within a factor of 2 | evenly spread, few doubled |
//! | hard | 2/8 | anywhere in a box | 0.01 to 100 | in clusters, up to `degree` fold |
//! | hostile | 1/8 | coincident, in line, turning back | 0.001 to 1000 | one unit of the last place apart |

use std::f64::consts::PI;

use arbitrary::Unstructured;
use feed_plan::{AxisLimits, Junction, KinematicLimits, ProfileKind};
use nurbs_core::{CurveError, MAX_DEGREE, NurbsBuf};
use real::Real;

/// Curves, each of which begins where the one before ends, and the limits and settings with which they are followed.
#[derive(Clone, Debug)]
pub struct RandomPath<const D: usize> {
    /// The curves, in mm.
    pub curves: Vec<NurbsBuf<f64, D>>,
    /// Limits, in mm and interpolation periods.
    pub limits: KinematicLimits<f64>,
    /// The transitions of the plan.
    pub profile: ProfileKind,
    /// K: evaluations of a solver in a period, at most.
    pub max_evaluations: u32,
    /// Longest compiled piece, in mm.
    pub piece_mm: f64,
}

/// How similar a path is to a real part.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Kind {
    Part,
    Hard,
    Hostile,
}

/// Draws from bytes without ever failing: past their end every byte is 0.
struct Draws<'a, 'b>(&'a mut Unstructured<'b>);

impl Draws<'_, '_> {
    fn byte(&mut self) -> u8 {
        self.0.arbitrary().unwrap_or(0)
    }

    fn below(&mut self, end: u8) -> u8 {
        self.byte() % end
    }

    fn one_in(&mut self, n: u8) -> bool {
        self.below(n) == n - 1
    }

    fn share(&mut self) -> f64 {
        f64::from(self.0.arbitrary::<u32>().unwrap_or(0)) / f64::from(u32::MAX)
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.share()
    }

    /// A number whose logarithm is evenly distributed.
    fn power(&mut self, low: f64, high: f64) -> f64 {
        10.0_f64.powf(self.between(low, high))
    }
}

impl<const D: usize> RandomPath<D> {
    /// The path for these bytes; `None` for the few that only give single points.
    pub fn from_bytes(bytes: &[u8]) -> Option<Self> {
        Self::draw(&mut Unstructured::new(bytes))
    }

    /// The path for the next bytes.
    pub fn draw(bytes: &mut Unstructured<'_>) -> Option<Self> {
        let mut draws = Draws(bytes);
        let kind = match draws.below(8) {
            0..=4 => Kind::Part,
            5..=6 => Kind::Hard,
            _ => Kind::Hostile,
        };
        let count = if draws.one_in(4) { 1 + draws.below(4) } else { 1 };
        let size_mm = draws.power(-1.0, 2.7);
        let mut curves: Vec<NurbsBuf<f64, D>> = Vec::new();
        for _ in 0..count {
            let end = curves.last().and_then(|curve| curve.control_points().last().copied());
            curves.push(curve(&mut draws, kind, size_mm, end.unwrap_or([0.0; D]))?);
        }
        let polygon_mm: f64 = curves.iter().map(polygon_length).sum();
        if polygon_mm <= 0.0 || polygon_mm.is_nan() {
            return None;
        }
        let feedrate = polygon_mm / draws.power(0.7, 3.0);
        Some(Self {
            limits: limits(&mut draws, feedrate),
            profile: ProfileKind::ALL[usize::from(draws.below(4))],
            max_evaluations: 1 + u32::from(draws.below(8)),
            piece_mm: if draws.one_in(4) { draws.power(0.0, 2.0) } else { 32.0 },
            curves,
        })
    }

    /// The path with corners that are passed instead of stopped at. They may be cut by a tenth to ten times the chord
    /// error; the chord error's digits decide how much.
    #[must_use]
    pub fn passing_corners(mut self) -> Self {
        let share = f64::from_phase(self.limits.chord_error.to_bits() << 12, 0);
        self.limits.junction =
            Junction::Deviation(self.limits.chord_error * 10.0_f64.powf(2.0 * share - 1.0));
        self
    }

    /// The path with the fastest profile in place of the drawn one, which is one of the others.
    #[must_use]
    pub fn fastest(self) -> Self {
        Self { profile: ProfileKind::Fastest, ..self }
    }
}

/// Limits with which the feed is reached within 1 to 300 periods and the acceleration within 1 to 100.
fn limits(draws: &mut Draws<'_, '_>, feedrate: f64) -> KinematicLimits<f64> {
    let acceleration = feedrate * draws.power(-2.5, 0.0);
    KinematicLimits {
        interpolation_period: 1.0,
        feedrate,
        acceleration,
        jerk: acceleration * draws.power(-2.0, 0.0),
        chord_error: feedrate * draws.power(-5.0, -0.5),
        centripetal_acceleration: draws.one_in(4).then(|| acceleration * draws.power(-0.5, 0.5)),
        axes: [AxisLimits::default(); 3],
        junction: Junction::default(),
    }
}

fn polygon_length<const D: usize>(curve: &NurbsBuf<f64, D>) -> f64 {
    let leg = |p: &[[f64; D]]| f64::norm(&core::array::from_fn::<_, D, _>(|d| p[1][d] - p[0][d]));
    curve.control_points().windows(2).map(leg).sum()
}

/// A curve of this kind that begins at `start` and has about this size; `None` if rounding has merged its knots.
fn curve<const D: usize>(
    draws: &mut Draws<'_, '_>,
    kind: Kind,
    size_mm: f64,
    start: [f64; D],
) -> Option<NurbsBuf<f64, D>> {
    let highest = if kind == Kind::Part { 5 } else { u8::try_from(MAX_DEGREE).unwrap_or(1) };
    let degree = 1 + usize::from(draws.below(highest));
    let inner = usize::from(draws.below(if kind == Kind::Hostile { 40 } else { 21 }));
    let knots = knots(draws, kind, degree, inner);
    let count = degree + 1 + inner;
    let points = points(draws, kind, size_mm, count, start);
    let decades = match (kind, draws.below(3)) {
        (Kind::Part, 2) => 0.15,
        (Kind::Hard, 1..) => 2.0,
        (Kind::Hostile, _) => 3.0,
        _ => return NurbsBuf::try_new_nonrational(degree, points, knots).ok(),
    };
    let weights = (0..count).map(|_| draws.power(-decades, decades)).collect();
    NurbsBuf::try_new(degree, points, weights, knots).ok()
}

fn points<const D: usize>(
    draws: &mut Draws<'_, '_>,
    kind: Kind,
    size_mm: f64,
    count: usize,
    start: [f64; D],
) -> Vec<[f64; D]> {
    let mut points = Vec::with_capacity(count);
    let mut at = start;
    let mut heading = 0.0_f64;
    for index in 0..count {
        points.push(at);
        let habit = if kind == Kind::Hostile { draws.below(4) } else { 0 };
        at = match (kind, habit) {
            (Kind::Hostile, 1) => at,
            (Kind::Hostile, 2) => points[usize::from(draws.byte()) % (index + 1)],
            (Kind::Part, _) | (Kind::Hostile, 3) => {
                heading += draws.between(-PI / 3.0, PI / 3.0);
                let leg = size_mm * draws.between(0.05, 0.3);
                let rise = draws.between(-0.3, 0.3);
                let along = [heading.cos(), heading.sin(), rise];
                core::array::from_fn(|d| at[d] + leg * along.get(d).copied().unwrap_or(0.0))
            }
            _ => core::array::from_fn(|d| start[d] + draws.between(-size_mm, size_mm)),
        };
    }
    points
}

/// A clamped knot vector over [0, 1].
fn knots(draws: &mut Draws<'_, '_>, kind: Kind, degree: usize, inner: usize) -> Vec<f64> {
    let (mut u, mut multiplicity) = (0.0_f64, degree + 1);
    let mut knots = Vec::with_capacity(inner);
    for _ in 0..inner {
        let habit = draws.below(8);
        let gap = draws.between(0.3, 1.0);
        let most = if kind == Kind::Part { degree.saturating_sub(2).max(1) } else { degree };
        let next = match (kind, habit) {
            (_, 7) if multiplicity < most => u,
            (Kind::Hard, 6) => u + gap * 1e-2,
            (Kind::Hard | Kind::Hostile, 5) => u + gap * 1e-4,
            (Kind::Hostile, 4) if u > 0.0 => u.next_up(),
            _ => u + gap,
        };
        multiplicity = if next == u { multiplicity + 1 } else { 1 };
        u = next;
        knots.push(u);
    }
    let end = u + draws.between(0.3, 1.0);
    let ends = |u: f64| core::iter::repeat_n(u, degree + 1);
    ends(0.0).chain(knots.into_iter().map(|u| u / end)).chain(ends(1.0)).collect()
}

/// Any number: every bit pattern is possible, and numbers at which arithmetic changes are more frequent.
pub fn any_number(bytes: &mut Unstructured<'_>) -> f64 {
    let mut draws = Draws(bytes);
    match draws.below(8) {
        0 => 0.0,
        1 => f64::from(draws.byte()) - 128.0,
        2 => f64::MAX * draws.between(-1.0, 1.0),
        3 => f64::MIN_POSITIVE * draws.between(-2.0, 2.0),
        4 => draws.power(-6.0, 6.0),
        5 => f64::from(draws.byte()) / 16.0,
        6 => [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, -0.0][usize::from(draws.below(4))],
        _ => f64::from_bits(draws.0.arbitrary().unwrap_or(0)),
    }
}

/// A curve of any numbers, of any count: most are refused.
///
/// # Errors
/// The reason why the curve is refused.
pub fn any_curve<const D: usize>(bytes: &mut Unstructured<'_>) -> Result<NurbsBuf<f64, D>, CurveError> {
    let mut draws = Draws(bytes);
    let degree = usize::from(draws.below(12));
    let count = usize::from(draws.below(24));
    let is_sorted = !draws.one_in(8);
    let is_clamped = !draws.one_in(8);
    let is_tame = !draws.one_in(4);
    let number = |bytes: &mut Unstructured<'_>| match is_tame {
        true => f64::from(bytes.arbitrary::<u8>().unwrap_or(0)) / 16.0,
        false => any_number(bytes),
    };
    let knot_count = count + degree + 1 + usize::from(draws.one_in(16));
    let weight_count = count + usize::from(draws.one_in(16));
    let points = (0..count).map(|_| core::array::from_fn(|_| number(draws.0))).collect();
    let weights = (0..weight_count).map(|_| number(draws.0).abs()).collect();
    let mut knots: Vec<f64> = (0..knot_count).map(|_| number(draws.0)).collect();
    if is_sorted {
        knots.sort_by(f64::total_cmp);
    }
    if is_clamped && knots.len() > 2 * degree + 1 {
        let (first, last) = (knots[degree], knots[knots.len() - 1 - degree]);
        knots[..degree].fill(first);
        let end = knots.len() - degree;
        knots[end..].fill(last);
    }
    NurbsBuf::try_new(degree, points, weights, knots)
}
