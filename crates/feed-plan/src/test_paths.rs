//! Limits and curves for tests.

pub(crate) use nurbs_core::golden::{circle, seed_000, seed_003};
use nurbs_core::{Arc, Derivatives, Differentiate, Evaluate, NurbsBuf};
use real::{Backend, RuntimeFixed, RuntimeFormat};

use crate::{FeedLimit, Junction, KinematicLimits, LimitPoint, Schedule, Stage};

/// Paper A: T = 3 ms, F = 200 mm/s, A = 5000 mm/s², J = 4e5 mm/s³, E = 0.5 µm, with T as the unit of
/// time.
pub(crate) fn paper_limits() -> KinematicLimits<f64> {
    in_periods(3e-3, 200.0, 5000.0, 4e5, 5e-4)
}

/// Limits given in seconds, with the period as the unit of time.
pub(crate) fn in_periods(
    t: f64,
    feedrate: f64,
    acceleration: f64,
    jerk: f64,
    chord_error: f64,
) -> KinematicLimits<f64> {
    KinematicLimits {
        interpolation_period: 1.0,
        feedrate: feedrate * t,
        acceleration: acceleration * t * t,
        jerk: jerk * t * t * t,
        chord_error,
        centripetal_acceleration: None,
        axes: Default::default(),
        junction: Junction::Stop,
    }
}

/// A right angle in one cubic: two lines of 30 mm that meet at a triple knot, where the curvature is 0 on
/// both sides.
pub(crate) fn triple_knot() -> NurbsBuf<f64, 2> {
    let points = [[0., 0.], [10., 0.], [20., 0.], [30., 0.], [30., 10.], [30., 20.], [30., 30.]];
    let knots = [0., 0., 0., 0., 0.5, 0.5, 0.5, 1., 1., 1., 1.];
    NurbsBuf::try_new(3, points.to_vec(), vec![1.0; 7], knots.to_vec()).unwrap()
}

/// In the middle, where the curve turns by 180° or more, `|C'|²/|C''| = (3/4 width)²/60`; width 0 is a cusp.
pub(crate) fn hairpin(width: f64) -> NurbsBuf<f64, 2> {
    let points = [[0.0, 0.0], [10.0 - width / 2.0, 10.0], [width / 2.0, 10.0], [10.0, 0.0]];
    NurbsBuf::try_new(3, points.to_vec(), vec![1.0; 4], vec![0., 0., 0., 0., 1., 1., 1., 1.]).unwrap()
}

/// One line for each pair of neighbouring points.
pub(crate) fn polyline(points: &[[f64; 2]]) -> Vec<NurbsBuf<f64, 2>> {
    let line =
        |ends: &[[f64; 2]]| NurbsBuf::try_new(1, ends.to_vec(), vec![1.0; 2], vec![0., 0., 1., 1.]).unwrap();
    points.windows(2).map(line).collect()
}

/// Arcs, each given by its angle in quarter turns and its radius. They bend to the left and to the right in turn, and
/// each begins in the direction in which the one before ends.
pub(crate) fn arcs(shapes: impl IntoIterator<Item = (f64, f64)>) -> Vec<Arc<f64, 2>> {
    let (mut at, mut heading, mut side) = ([0.0, 0.0], 0.0_f64, 1.0);
    let arc = |(radius, quarters): (f64, f64)| {
        let (sine, cosine) = heading.sin_cos();
        let [out, along] =
            [[side * radius * sine, -side * radius * cosine], [radius * cosine, radius * sine]];
        let centre = [at[0] - out[0], at[1] - out[1]];
        let arc = Arc::try_new(centre, [out, along], quarters).unwrap();
        at = arc.point(1.0);
        heading += side * quarters * core::f64::consts::FRAC_PI_2;
        side = -side;
        arc
    };
    shapes.into_iter().map(arc).collect()
}

/// The limit along curves that follow each other.
pub(crate) fn limit_along(curves: &[NurbsBuf<f64, 2>], limits: &KinematicLimits<f64>) -> FeedLimit<f64> {
    let curves: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
    FeedLimit::along(&curves, limits).unwrap()
}

/// The limit along one curve, with the limits of paper A.
pub(crate) fn paper_limit_along(curve: &NurbsBuf<f64, 2>) -> FeedLimit<f64> {
    limit_along(core::slice::from_ref(curve), &paper_limits())
}

/// A point of a limit without a path.
pub(crate) fn limit_point(distance: f64, feedrate: f64) -> LimitPoint<f64> {
    LimitPoint { distance, curve: 0, u: distance, feedrate }
}

/// The limit through points (distance, feed).
pub(crate) fn limit_through(points: &[(f64, f64)]) -> FeedLimit<f64> {
    let points: Vec<_> = points.iter().map(|&(distance, feed)| limit_point(distance, feed)).collect();
    FeedLimit::from_points(&points).unwrap()
}

/// The largest change of acceleration from one period to the next.
pub(crate) fn jerk_over_periods(schedule: &Schedule<'_, f64>) -> f64 {
    let mut cursor = schedule.start();
    let steps: Vec<_> = core::iter::from_fn(|| schedule.advance(&mut cursor)).collect();
    let change = |three: &[f64]| (three[2] - three[1] - three[1] + three[0]).abs();
    steps.windows(3).map(change).fold(0.0, f64::max)
}

/// The distance along a plan as a function of the time; the time must not exceed the duration.
pub(crate) fn place_at(stages: &[Stage<f64>]) -> impl Fn(f64) -> f64 {
    let end_of = |time: &mut f64, stage: &Stage<f64>| {
        *time += stage.duration;
        Some(*time)
    };
    let ends: Vec<_> = stages.iter().scan(0.0, end_of).collect();
    move |time| {
        let index = ends.partition_point(|end| *end < time).min(ends.len() - 1);
        stages[index].start + stages[index].distance_at(time - ends[index] + stages[index].duration)
    }
}

/// Fixed point whose format a test chooses at run time, so that the planner is compiled once for all widths.
pub(crate) type Fixed = RuntimeFixed<0>;

/// What `work` finds where [`Fixed`] is the format of this name.
pub(crate) fn in_fixed<T>(format: &str, work: impl FnOnce() -> T) -> T {
    RuntimeFormat::named(format).unwrap().run::<0, _>(work)
}

/// Limits in another format.
pub(crate) fn in_range<Q: Backend>(limits: &KinematicLimits<f64>) -> KinematicLimits<Q> {
    limits.try_map(|what, value| Q::from_f64(value).ok_or(what)).unwrap()
}

/// `C(t) = scale ((t - origin)^m, (t - origin)^n)` for t in [0, 1]: a cusp for m = 2, n = 3.
pub(crate) struct Power {
    pub(crate) origin: f64,
    pub(crate) exponents: [i32; 2],
    pub(crate) scale: f64,
}

impl Evaluate<f64, 2> for Power {
    fn domain(&self) -> (f64, f64) {
        (0.0, 1.0)
    }
    fn point(&self, u: f64) -> [f64; 2] {
        self.derivatives(u).point
    }
    fn span_count(&self) -> usize {
        1
    }
    fn span_bounds(&self, _: usize) -> (f64, f64) {
        self.domain()
    }
}

impl Differentiate<f64, 2> for Power {
    fn derivatives(&self, u: f64) -> Derivatives<f64, 2> {
        let t = u - self.origin;
        let power = |k: i32| {
            self.exponents.map(|n| {
                let factor: i32 = (0..k).map(|i| n - i).product();
                self.scale * f64::from(factor) * t.powi(n - k)
            })
        };
        Derivatives { point: power(0), first: power(1), second: power(2) }
    }
    fn derivatives_in(&self, _: usize, u: f64) -> Derivatives<f64, 2> {
        self.derivatives(u)
    }
}

/// Bits that look random.
pub(crate) fn hashed(i: u64) -> u32 {
    u32::try_from(i.wrapping_mul(0x9e37_79b9_7f4a_7c15) >> 32).unwrap()
}
