//! The least number of periods that a run takes, from its path and its limits alone. So a run that would take hours, or
//! more memory than there is, can be refused before it is planned.
//!
//! Let L be the path's length and V the larger of the feeds at its ends. A run takes a time t of at least
//! - `L/F` at the feedrate F;
//! - `∫ ds/v` where chord error or centripetal acceleration allow the feed v;
//! - the time that follows from the acceleration A: `L ≤ V·t + A·t²/4`, with half the time up and half of it down;
//! - the time that follows from the jerk J: `L ≤ V·t + J·t³/32`, with a quarter of the time up, two down and one up.
//!   One of the two terms makes up half of L or more, so `t ≥ min(L/(2V), ∛(16·L/J))`.
//!
//! The first and the last two hold for each axis too, with its own limits, and with the way that it goes back and forth for L.
//! Stops on the way are left out.

use std::fmt;

use domains::shown;
pub use feed_plan::MOST_PERIODS;
use feed_plan::chord_feedrate;
use nurbs_core::{Differentiate, Evaluate, radius};
use real::Real;

use crate::problem::problem::Problem;

/// The limit by which a run takes longest, and the least number of periods under it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LeastPeriods {
    /// The periods.
    pub periods: f64,
    length_mm: f64,
    period_ms: f64,
    limit: (&'static str, f64, &'static str),
}

impl LeastPeriods {
    /// The least periods of a run of `problem` with these feeds at its ends, in mm/s.
    #[must_use]
    pub fn of<const D: usize>(problem: &Problem<D>, end_feeds_mm_per_s: [f64; 2]) -> Self {
        let (machine, ends) = (&problem.machine, end_feeds_mm_per_s[0].max(end_feeds_mm_per_s[1]));
        let chord = machine.chord_error_mm;
        let (acceleration, jerk) = (machine.acceleration_mm_per_s2, machine.jerk_mm_per_s3);
        let across = machine.centripetal_acceleration_mm_per_s2;
        // A bend with a radius below the chord error may be a stop, which takes no time, however low the feed.
        let bends = |radius: f64| {
            let radius = radius.max(chord);
            [
                chord_feedrate(radius, chord, problem.period_s()),
                across.map_or(f64::INFINITY, |across| (across * radius).sqrt()),
            ]
        };
        let Passed { length_mm, times: [by_chord, by_across], along_axes } = passed(problem, bends);
        let by_acceleration =
            |length: f64, most: f64| 2.0 * length / (ends + (ends * ends + most * length).sqrt());
        let by_jerk = |length: f64, most: f64| (16.0 * length / most).cbrt().min(length / (2.0 * ends));
        let of_path = [
            (by_chord, ("a chord error of", chord, "mm")),
            (by_across, ("a centripetal acceleration of", across.unwrap_or(f64::INFINITY), "mm/s²")),
            (by_acceleration(length_mm, acceleration), ("an acceleration of", acceleration, "mm/s²")),
            (by_jerk(length_mm, jerk), ("a jerk of", jerk, "mm/s³")),
        ];
        let axes = along_axes.into_iter().zip([machine.axes.x, machine.axes.y, machine.axes.z]).zip(AXES);
        let of_axes = axes.flat_map(|((length, axis), [velocity, acceleration, jerk])| {
            // An axis that does not move is not limited.
            let limit = |value: Option<f64>| value.filter(|_| length > 0.0);
            [
                limit(axis.velocity_mm_per_s).map(|most| (length / most, (velocity, most, "mm/s"))),
                limit(axis.acceleration_mm_per_s2)
                    .map(|most| (by_acceleration(length, most), (acceleration, most, "mm/s²"))),
                limit(axis.jerk_mm_per_s3).map(|most| (by_jerk(length, most), (jerk, most, "mm/s³"))),
            ]
        });
        let limits = of_path.into_iter().chain(of_axes.flatten());
        let feed = problem.feedrate_mm_per_s();
        let first = (length_mm / feed, ("a feedrate of", feed, "mm/s"));
        let (time_s, limit) = limits.fold(first, |most, one| if one.0 > most.0 { one } else { most });
        let period_ms = machine.interpolation_period_ms;
        Self { periods: time_s / problem.period_s(), length_mm, period_ms, limit }
    }

    /// Whether that is more than [`MOST_PERIODS`].
    #[must_use]
    pub fn are_too_many(&self) -> bool {
        self.periods > MOST_PERIODS as f64
    }
}

impl fmt::Display for LeastPeriods {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { periods, length_mm, period_ms, limit: (what, value, unit) } = self;
        write!(
            f,
            "{length_mm:.3} mm with {what} {} {unit} take at least {periods:.3e} periods of {} ms",
            shown(*value),
            shown(*period_ms)
        )
    }
}

/// The words for the limits of each axis: of its velocity, its acceleration and its jerk.
const AXES: [[&str; 3]; 3] = [
    ["a velocity of X of", "an acceleration of X of", "a jerk of X of"],
    ["a velocity of Y of", "an acceleration of Y of", "a jerk of Y of"],
    ["a velocity of Z of", "an acceleration of Z of", "a jerk of Z of"],
];

/// A path by its chords.
struct Passed<const D: usize> {
    /// Its length, in mm.
    length_mm: f64,
    /// The time at each of two feeds that depend on the radius, in s.
    times: [f64; 2],
    /// How far each axis goes, back and forth, in mm.
    along_axes: [f64; D],
}

/// The path by its chords. For a step between two samples, the higher feed of its two ends counts, so that a sharp bend does not
/// slow its surroundings.
fn passed<const D: usize>(problem: &Problem<D>, feeds: impl Fn(f64) -> [f64; 2]) -> Passed<D> {
    /// Steps on a span of a curve; a line has one.
    const STEPS: usize = 8;
    let mut passed = Passed { length_mm: 0.0, times: [0.0; 2], along_axes: [0.0; D] };
    for (curve, fast) in problem.curves.iter().zip(problem.fast_curves()) {
        let steps = if curve.degree() == 1 { 1 } else { STEPS };
        for span in 0..fast.span_count() {
            let (begin, end) = fast.span_bounds(span);
            let at = |step: usize| {
                let u = begin + (end - begin) * step as f64 / steps as f64;
                let derivatives = fast.derivatives_in(span, u);
                (derivatives.point, feeds(radius(&derivatives)))
            };
            let mut before = at(0);
            for step in 1..=steps {
                let here = at(step);
                let way = core::array::from_fn::<_, D, _>(|d| here.0[d] - before.0[d]);
                let chord = f64::norm(&way);
                passed.length_mm += chord;
                for (along, way) in passed.along_axes.iter_mut().zip(way) {
                    *along += way.abs();
                }
                for (time, (a, b)) in passed.times.iter_mut().zip(before.1.into_iter().zip(here.1)) {
                    *time += if chord > 0.0 { chord / a.max(b) } else { 0.0 };
                }
                before = here;
            }
        }
    }
    passed
}
