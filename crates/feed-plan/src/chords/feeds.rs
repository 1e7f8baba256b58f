//! The feeds of a plan in chords: lowered by what the chords fall short, so that feed and acceleration stay continuous.
//!
//! Each stage falls short by a length of its own. If its feeds were lowered by that length alone, they would not meet
//! those of its neighbours. Where the chord error is some micrometres, such a step of feed within a period is a jerk of
//! several times the limit. So the feed V is lowered by a correction c that is a continuous function of time. Over a
//! *change* of feed, from V_s to V_e and from no acceleration to none, the correction goes from c_s to c_e along the
//! same shape:
//!
//! `V - c = V_s - c_s + (1 - k) (V - V_s)`, `k = (c_e - c_s)/(V_e - V_s)`,
//!
//! which has the acceleration and the jerk of V, times `1 - k`. Acceleration and jerk rise where k is negative: where
//! the correction falls while the feed rises, as out of a bend. There the correction may fall by 2⁻¹² of the rise of
//! the feed. Where the feed is constant the correction may change along a cubic, with no more acceleration and jerk
//! than the changes of feed beside it have.
//!
//! `parts.rs` divides the path into these changes and constant feeds, and `joints.rs` finds the corrections between them.

use alloc::vec::Vec;

use real::Real;

use crate::chords::joints::{cut, joints, level};
use crate::chords::parts::{part_way, parts};
use crate::chords::stretch::Stretch;
use crate::{FeedLimit, ScheduleBuf, Stage};

impl<R: Real> ScheduleBuf<R> {
    /// The plan for setpoints whose chords, not arcs, have the planned lengths.
    ///
    /// The chords of each stage are shorter than their arcs by what `shortfalls` says ([`FeedLimit::shortfalls`]). An
    /// interpolator that makes each chord as long as the plan's arc would be ahead of the plan by that much. It would
    /// pass the next bend at the feed of the straight before or behind it. So this function lowers the feed and keeps
    /// the times: from stop to stop the length is less by the sum of the shortfalls. Feed and acceleration stay
    /// continuous wherever they were. Acceleration and jerk rise by no more than the stretch to whole periods left of
    /// their limits.
    ///
    /// The price is that the run leaves its plan near a joint at which the shortfall changes. It does so by a share of
    /// the change of the shortfall over a transition; over a tight bend, by half of the bend's shortfall. A stage of
    /// constant feed may become three stages, of which the outer two lead to other feeds.
    ///
    /// `limit` is the limit that the plan was made under: it says where on the path such a stage is divided.
    #[must_use]
    pub fn shortened(self, limit: &FeedLimit<R>, shortfalls: &[R]) -> Self {
        let period = self.interpolation_period;
        self.by_sections(shortfalls, |stages, shortfalls| {
            shortened(limit, &Stretch::of(stages, shortfalls), R::zero(), period)
        })
    }
}

/// Shortens the stages of a stretch, each by its shortfall, and by `at_the_end` more where the last change of feed
/// begins to brake to the stop. The starts of the stages are left as they are.
pub(crate) fn shortened<R: Real>(
    limit: &FeedLimit<R>,
    stretch: &Stretch<'_, R>,
    at_the_end: R,
    period: R,
) -> Vec<Stage<R>> {
    let &Stretch { stages, shortfalls, begin, count } = stretch;
    let mut parts = parts(stages, shortfalls, period);
    part_way(&mut parts, stages, shortfalls, count);
    let mut joints = joints(&parts, begin);
    if let Some(last) = joints.iter_mut().rev().find(|joint| joint.is_free() && joint.most > R::zero()) {
        last.correction = last.correction + at_the_end / last.time;
    }
    level(&mut joints, &parts);
    cut(&mut joints, &parts);
    let mut short = Vec::with_capacity(count);
    for (part, ends) in parts.iter().zip(joints.windows(2)).take_while(|(part, _)| part.first < count) {
        let Some(whole) = stages.get(part.first..part.behind.min(count)) else { continue };
        let ends = [ends[0].correction, ends[1].correction];
        let ends = if part.is_cut_at(count) { part.wherever_it_ends(ends) } else { ends };
        match (part.is_constant(), whole) {
            (true, [stage]) => part.lower_constant(stage, ends, limit, &mut short),
            _ => short.extend(whole.iter().map(|stage| part.lowered(stage, ends))),
        }
    }
    short
}

#[cfg(test)]
mod tests {
    use nurbs_core::NurbsBuf;
    use proptest::prelude::*;
    use proptest::test_runner::TestCaseError;

    use crate::chords::stretch::Stretch;
    use crate::plan::promises::planned;
    use crate::schedule::stage::examples::stages;
    use crate::test_paths::{in_periods, jerk_over_periods, limit_through, paper_limits, seed_000};
    use crate::{
        EndFeeds, FeedLimit, KinematicLimits, ProfileKind, ScheduleBuf, Stage, StageShape, plan_with,
    };

    /// The share by which peaks may rise, with an allowance for rounding.
    const ROOM: f64 = 1.0 + 1.0 / 4096.0 + 1e-9;

    /// Checks a shortened plan. Feeds and accelerations of neighbours meet. Times stay the same, and so do the places
    /// of stops. The lengths between stops are less by the shortfalls.
    fn assert_smooth(
        arcs: &ScheduleBuf<f64>,
        short: &ScheduleBuf<f64>,
        shortfalls: &[f64],
    ) -> Result<(), TestCaseError> {
        let (mut feed, mut acceleration, mut start, mut before) = (0.0, 0.0, 0.0, 0.0_f64);
        let most = |of: fn(&Stage<f64>) -> f64| arcs.stages().iter().map(of).fold(0.0, f64::max);
        let accelerations = most(|stage| stage.piece().peak_acceleration().abs());
        let jerks = most(|stage| stage.piece().peak_jerk().abs());
        for stage in short.stages() {
            prop_assert!((stage.start_feed - feed).abs() < 1e-14, "{stage:?} behind {feed}");
            // A feed is rounded, and over a stage of a millionth of a period that rounding is a jerk.
            let rounding = 8.0 * f64::EPSILON * stage.start_feed.max(stage.end_feed) / stage.duration;
            let begins = (stage.acceleration_at(0.0) - acceleration).abs();
            prop_assert!(
                begins <= 1e-9 * accelerations + rounding.max(before),
                "{stage:?} behind {acceleration}"
            );
            prop_assert!((stage.start - start).abs() < 1e-11 && stage.start_feed.min(stage.end_feed) >= 0.0);
            let length = stage.piece().length();
            prop_assert!((stage.length - length).abs() < 1e-10 * (1.0 + length), "{stage:?}: {length}");
            let piece = stage.piece();
            prop_assert!(piece.peak_acceleration().abs() <= accelerations * ROOM + rounding, "{stage:?}");
            prop_assert!(
                piece.peak_jerk().abs() <= jerks * ROOM + rounding / stage.duration,
                "{stage:?} {jerks}"
            );
            before = rounding;
            (feed, acceleration) = (stage.end_feed, stage.acceleration_at(stage.duration));
            start = stage.start + stage.length;
        }
        prop_assert_eq!(feed, 0.0);
        let lengths = |plan: &ScheduleBuf<f64>| -> Vec<f64> {
            let sections = plan.stages.split_inclusive(|stage| stage.end_feed == 0.0);
            sections.map(|stages| stages.iter().map(|stage| stage.length).sum()).collect()
        };
        let (before, after) = (lengths(arcs), lengths(short));
        prop_assert_eq!(before.len(), after.len());
        let mut rest = shortfalls;
        let sections = arcs.stages.split_inclusive(|stage| stage.end_feed == 0.0);
        for ((section, before), after) in sections.zip(before).zip(after) {
            let (these, others) = rest.split_at(section.len());
            let sum: f64 = these.iter().sum();
            prop_assert!((before - after - sum).abs() < 1e-11 * (1.0 + before), "{before} {after} {sum}");
            rest = others;
        }
        let (time, whole) = (short.as_schedule().duration(), arcs.as_schedule().duration());
        prop_assert!((time - whole).abs() < 1e-12 * whole);
        Ok(())
    }

    /// A spline that winds through points, more tightly at first.
    fn spline() -> impl Strategy<Value = NurbsBuf<f64, 2>> {
        let strides = prop::collection::vec((-0.3..0.7_f64, -0.5..0.5_f64), 6..30);
        (2..5_usize, 4.0..60.0_f64, strides).prop_map(|(degree, scale, strides)| {
            let (mut at, half) = ([0.0; 2], strides.len() / 2);
            let points = strides.iter().enumerate().map(|(index, (x, y))| {
                let scale = if index < half { scale } else { 3.0 * scale };
                at = [at[0] + scale * x, at[1] + scale * y];
                at
            });
            let points: Vec<_> = points.collect();
            let last = (points.len() - degree) as f64;
            let inner = (1..points.len() - degree).map(|knot| knot as f64);
            let ends = |knot| std::iter::repeat_n(knot, degree + 1);
            let knots = ends(0.0).chain(inner).chain(ends(last)).collect();
            NurbsBuf::try_new_nonrational(degree, points, knots).unwrap()
        })
    }

    #[test]
    fn a_shortened_plan_keeps_its_times_and_its_feeds_meet() {
        let plan = ScheduleBuf { stages: stages().to_vec(), interpolation_period: 1.0, periods: 4 };
        let limit = limit_through(&[(0.0, 1.0), (2.475, 1.0)]);
        let shortened = |shortfalls: &[f64]| {
            let short = plan.clone().shortened(&limit, shortfalls);
            assert!((short.as_schedule().duration() - plan.as_schedule().duration()).abs() < 1e-15);
            let (mut start, mut feed) = (0.0, 0.0);
            for stage in short.stages() {
                assert!((stage.start - start).abs() < 1e-15, "{stage:?}");
                assert_eq!(stage.start_feed, feed);
                let mean = f64::midpoint(stage.start_feed, stage.end_feed);
                assert!((mean * stage.duration - stage.length).abs() < 1e-15, "{stage:?}");
                (start, feed) = (start + stage.length, stage.end_feed);
            }
            plan.as_schedule().length() - short.as_schedule().length()
        };
        // 0.3 is more than the second stage has.
        for shortfalls in [[0.01, 0.0, 0.02], [0.0, 0.3, 0.0], [0.2, 0.0, 0.0]] {
            let sum: f64 = shortfalls.iter().sum();
            let less = shortened(&shortfalls);
            assert!((less - sum).abs() < 1e-15, "{shortfalls:?}: {less}");
        }
        // A negative shortfall counts as 0, and so does a missing one.
        assert!((shortened(&[-1.0, 0.02, 0.0]) - 0.02).abs() < 1e-15);
        assert_eq!(plan.clone().shortened(&limit, &[]), plan);
        // No more than half of the path is taken off.
        assert!((shortened(&[2.0, 2.0, 2.0]) - 2.475 / 2.0).abs() < 1e-15);
    }

    /// The last acceleration of a fall is a rounding instead of 0, and then the feed rises. The planner once took both for one
    /// change, whose ends differ by little. Its correction went far below 0, so the feed in between rose above its limit.
    #[test]
    fn what_falls_and_then_rises_is_no_one_change() {
        let rows = [
            (0.0, 0.5, StageShape::Onset),
            (0.5, 1.0, StageShape::Easing),
            (1.0, 0.6, StageShape::Onset),
            (0.6, 0.2, StageShape::Bent(1.0 - f64::EPSILON)),
            (0.2, 0.6, StageShape::Onset),
            (0.6, 0.99, StageShape::Easing),
            (0.99, 0.5, StageShape::Onset),
            (0.5, 0.0, StageShape::Easing),
        ];
        let mut start = 0.0;
        let stages = rows.map(|(start_feed, end_feed, shape)| {
            let stage = Stage { start, start_feed, end_feed, shape, duration: 4.0, ..stages()[0] };
            let length = stage.piece().length();
            start += length;
            Stage { length, ..stage }
        });
        let plan = ScheduleBuf { stages: stages.to_vec(), interpolation_period: 1.0, periods: 32 };
        let limit = limit_through(&[(0.0, 1.0), (start, 1.0)]);
        for bend in 0..stages.len() {
            let shortfalls: Vec<_> =
                (0..stages.len()).map(|stage| f64::from(u8::from(stage == bend)) * 0.02).collect();
            let short = plan.clone().shortened(&limit, &shortfalls);
            for (whole, short) in plan.stages().iter().zip(short.stages()) {
                let is_lower = short.start_feed <= whole.start_feed && short.end_feed <= whole.end_feed;
                assert!(is_lower && short.length <= whole.length + 1e-12, "{bend}: {whole:?} {short:?}");
            }
        }
    }

    /// The run lands on each stop: shortfalls before the stop do not shorten the path behind it.
    #[test]
    fn a_stop_divides_what_is_shortened() {
        let [up, cruise, down] = stages();
        let land = Stage { start_feed: 1.0, end_feed: 0.0, length: 0.55, ..down };
        let stages = vec![up, cruise, land, Stage { start: 2.2, ..up }, Stage { start: 3.45, ..land }];
        let plan = ScheduleBuf { stages, interpolation_period: 1.0, periods: 8 };
        let limit = limit_through(&[(0.0, 1.0), (4.0, 1.0)]);
        let short = plan.clone().shortened(&limit, &[0.1, 0.0, 0.0, 0.0, 0.02]);
        let length = |stages: &[Stage<f64>]| stages.iter().map(|stage| stage.length).sum::<f64>();
        for (range, less) in [(0..3, 0.1), (3..5, 0.02)] {
            let [whole, less_long] = [&plan, &short].map(|plan| length(&plan.stages()[range.clone()]));
            assert!((whole - less_long - less).abs() < 1e-15, "{range:?}: {whole} {less_long}");
        }
        assert_eq!((short.stages()[2].end_feed, short.stages()[3].start_feed), (0.0, 0.0));
    }

    #[test]
    fn chords_of_a_shortened_plan_sum_to_what_the_curve_takes() {
        let limits = paper_limits();
        let (limit, plan) = planned(&seed_000(), &limits);
        let shortfalls = limit.shortfalls(&[seed_000().as_curve()], &plan.as_schedule());
        let shortfall: f64 = shortfalls.iter().sum();
        // Found independently, with chords solved to 50 digits: 1.37 µm.
        assert!((shortfall - 1.37e-3).abs() < 1e-5, "{shortfall}");
        let short = plan.shortened(&limit, &shortfalls);
        assert!((short.as_schedule().length() - (limit.length() - shortfall)).abs() < 1e-11);
    }

    #[test]
    fn chords_of_a_shortened_plan_stay_with_the_plan() {
        // Straights and tight bends, most of the shortfall in the bends; the setpoints are solved for one by one.
        let points: Vec<_> = (0..12_i32).map(|i| [f64::from(i) * 3.0, f64::from(i % 2) * 40.0]).collect();
        let inner = (1..10).map(f64::from);
        let knots = [0.0; 3].into_iter().chain(inner).chain([10.0; 3]).collect();
        let curve = NurbsBuf::try_new(2, points, vec![1.0; 12], knots).unwrap();
        let limits = KinematicLimits { chord_error: 0.02, ..paper_limits() };
        let (limit, plan) = planned(&curve, &limits);
        let curve = curve.as_curve();
        let shortfalls = limit.shortfalls(&[curve], &plan.as_schedule());
        assert!(shortfalls.iter().sum::<f64>() > 0.05, "{shortfalls:?}");
        let short = plan.clone().shortened(&limit, &shortfalls);
        let (arcs, chords) = (plan.as_schedule(), short.as_schedule());
        let (mut along, mut by_chord) = (arcs.start(), chords.start());
        let (mut travelled, mut u, mut arc, mut worst, mut at_the_end) = (0.0, 0.0, 0.0, 0.0_f64, 0.0);
        while let (Some(step), Some(chord)) = (arcs.advance(&mut along), chords.advance(&mut by_chord)) {
            travelled += step;
            let from = nurbs_core::Evaluate::point(&curve, u);
            let reach = |u: f64| {
                let to = nurbs_core::Evaluate::point(&curve, u);
                (to[0] - from[0]).hypot(to[1] - from[1])
            };
            let (mut low, mut high) = (u, (u + 0.1).min(10.0));
            for _ in 0..60 {
                let middle = f64::midpoint(low, high);
                if reach(middle) < chord { low = middle } else { high = middle }
            }
            arc += nurbs_core::arc_length(&curve, u, low, 1e-12).length;
            u = low;
            worst = worst.max((arc - travelled).abs());
            at_the_end = if travelled < limit.length() - 2.0 { (arc - travelled).abs() } else { at_the_end };
        }
        // In bends the run falls short, and what it falls short by is taken off beside them too. The last place is within the
        // last stage.
        assert!(worst < 1e-2 && at_the_end < 1e-3, "{worst} {at_the_end}");
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        /// When each stage was shortened for itself, a step of feed between two stages was a jerk of up to 15 times the
        /// limit.
        #[test]
        fn a_plan_in_chords_keeps_the_jerk_at_any_chord_error(
            curve in spline(), period in 1e-3..5e-3_f64, feedrate in 50.0..300.0_f64, acceleration in 500.0..4500.0_f64,
            jerk in 1e4..1e5_f64, exponent in -4.0..-1.0_f64,
        ) {
            let limits = in_periods(period, feedrate, acceleration, jerk, 10.0_f64.powf(exponent));
            let limit = FeedLimit::along(&[curve.as_curve()], &limits).map_err(|error| TestCaseError::reject(error.to_string()))?;
            for kind in ProfileKind::ALL {
                let arcs = plan_with(&limit, &limits, EndFeeds::default(), kind).map_err(|error| TestCaseError::fail(error.to_string()))?;
                let shortfalls = limit.shortfalls(&[curve.as_curve()], &arcs.as_schedule());
                let short = arcs.clone().shortened(&limit, &shortfalls);
                assert_smooth(&arcs, &short, &shortfalls)?;
                let found = jerk_over_periods(&short.as_schedule());
                prop_assert!(found <= limits.jerk * (1.0 + 1e-9), "{kind:?}: {found} of {}", limits.jerk);
            }
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(400))]

        #[test]
        fn whatever_falls_short_is_taken_off_without_a_step(
            rows in prop::collection::vec((0.01..30.0_f64, 0.02..1.0_f64, prop::bool::weighted(0.1)), 2..40),
            shares in prop::collection::vec(prop_oneof![Just(0.0), 0.0..0.01_f64, 0.0..0.3_f64], 200),
            jerk in 1e-5..0.1_f64, end in 0.0..0.1_f64,
        ) {
            let (mut distance, mut rests) = (0.0, true);
            let points: Vec<_> = rows.into_iter().enumerate().map(|(index, (stride, feedrate, stops))| {
                distance += if index > 0 { stride } else { 0.0 };
                rests = stops && !rests;
                (distance, if rests { 0.0 } else { feedrate })
            }).collect();
            let limits = KinematicLimits { jerk, ..in_periods(3e-3, 200.0, 5000.0, 4e5, 5e-4) };
            let limit = limit_through(&points);
            for kind in ProfileKind::ALL {
                let arcs = plan_with(&limit, &limits, EndFeeds::default(), kind).map_err(|error| TestCaseError::fail(error.to_string()))?;
                let shares = shares.iter().cycle();
                let mut shortfalls: Vec<_> = arcs.stages().iter().zip(shares).map(|(stage, share)| stage.length * share).collect();
                assert_smooth(&arcs, &arcs.clone().shortened(&limit, &shortfalls), &shortfalls)?;
                let at_the_end = |stages: &[Stage<f64>]| stages[stages.len() - 1].length * end;
                let short = arcs.clone().by_sections(&shortfalls, |stages, these| {
                    super::shortened(&limit, &Stretch::of(stages, these), at_the_end(stages), 1.0)
                });
                let mut behind = 0;
                for section in arcs.stages.split_inclusive(|stage| stage.end_feed == 0.0) {
                    behind += section.len();
                    shortfalls[behind - 1] += at_the_end(section);
                }
                assert_smooth(&arcs, &short, &shortfalls)?;
            }
        }
    }
}
