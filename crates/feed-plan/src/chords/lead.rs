//! By how much a run by chords is ahead of the plan in arcs that it is to follow.
//!
//! The run's place is followed on the path, period by period; each section begins on its own rest. Two lengths show
//! that a run leaves its plan: its *place* may be ahead of the plan's place, so that it reaches a bend at the feed of
//! the straight before it; and its *chords*, summed from the section's begin, may be longer than the plan's distance,
//! which no chord of a shorter way is.

use nurbs_core::Differentiate;
use real::Real;

use crate::chords::shortfall::Path;
use crate::chords::steps::Step;
use crate::{FeedLimit, Stage, sections};

/// By how much a run is ahead of its plan in arcs, at most, at the end of a period.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Lead<R> {
    /// By how much its place on the path is ahead of the plan's, mm; 0 if it never is.
    pub place: R,
    /// By how much the sum of its chords exceeds the plan's distance since the section's begin, mm; 0 if it never does.
    pub chords: R,
    /// The plan's distance from the path's start where the place is farthest ahead, mm.
    pub at: R,
}

impl<R: Real> Lead<R> {
    pub(super) fn none() -> Self {
        Self { place: R::zero(), chords: R::zero(), at: R::zero() }
    }

    /// Looks at the end of a period.
    pub(super) fn see(&mut self, step: &Step<R>) {
        if step.to - step.planned > self.place {
            (self.place, self.at) = (step.to - step.planned, step.planned);
        }
        self.chords = self.chords.max(step.sum - step.travelled);
    }

    /// The larger of both.
    pub(super) fn max(self, other: Self) -> Self {
        let farther = if other.place > self.place { other } else { self };
        Self { chords: self.chords.max(other.chords), ..farther }
    }
}

impl<R: Real> FeedLimit<R> {
    /// By how much a run by `chords` is ahead of the plan `arcs` at the end of a period: [`Planned`](crate::Planned) has
    /// both, made under this limit, and `curves` are those that the limit was made of.
    ///
    /// The run is followed in numbers of type `R`, as [`in_chords`](Self::in_chords) follows it, and lands on each rest.
    #[must_use]
    pub fn lead<const D: usize, C: Differentiate<R, D>>(
        &self,
        curves: &[C],
        arcs: &[Stage<R>],
        chords: &[Stage<R>],
        period: R,
    ) -> Lead<R> {
        let path = Path::new(self, curves);
        let mut lead = Lead::none();
        for (arcs, chords) in sections(arcs).zip(sections(chords)) {
            path.each_step([&arcs, &chords], period, |step| lead.see(&step));
        }
        lead
    }
}

#[cfg(test)]
mod tests {
    use nurbs_core::NurbsBuf;
    use proptest::prelude::*;
    use proptest::test_runner::TestCaseError;

    use super::*;
    use crate::test_paths::{in_periods, paper_limits, seed_000, seed_003};
    use crate::{
        AxisLimits, CommandedCurve, EndFeeds, KinematicLimits, Planned, ProfileKind, plan_through_window,
    };

    /// The most by which a run's place may be ahead of its plan, and its chords longer than the plan's distance, over the
    /// chord error. A correction along the shape of a long change of feed is off its plan by up to half of what the change
    /// falls short by; so the place has more room than the half of a chord error that a run needs for its chords to keep it
    /// where the feed changes most.
    const MOST: [f64; 2] = [2.0, 0.1];

    fn assert_behind(
        limit: &FeedLimit<f64>,
        curve: &NurbsBuf<f64, 2>,
        [arcs, chords]: [&[Stage<f64>]; 2],
        chord_error: f64,
        name: &str,
    ) -> Result<(), TestCaseError> {
        let Lead { place, chords, at } = limit.lead(&[curve.as_curve()], arcs, chords, 1.0);
        prop_assert!(place <= MOST[0] * chord_error, "{name}: {place} of {chord_error} ahead at {at}");
        prop_assert!(chords <= MOST[1] * chord_error, "{name}: chords {chords} of {chord_error} ahead");
        Ok(())
    }

    /// Every profile, the whole path and windows, without limits of axes and with them.
    fn assert_all_behind(
        curve: &NurbsBuf<f64, 2>,
        limits: &KinematicLimits<f64>,
    ) -> Result<(), TestCaseError> {
        let curves = [curve.as_curve()];
        let limit =
            FeedLimit::along(&curves, limits).map_err(|error| TestCaseError::reject(error.to_string()))?;
        for kind in ProfileKind::ALL {
            let planned = Planned::under(limit.clone(), &curves, limits, EndFeeds::default(), kind);
            let Ok(mut planned) = planned else { continue };
            if kind == ProfileKind::Fastest && limits.limit_accelerations_of_axes(2) {
                let free = FeedLimit::without_reserves(&curves, limits, &[]).unwrap();
                let Ok(within) = Planned::within_axes(&planned.arcs, free, &curves, limits) else { continue };
                planned = within;
            }
            let both = [planned.arcs.stages(), planned.chords.stages()];
            assert_behind(&planned.limit, curve, both, limits.chord_error, &format!("{kind:?}"))?;
            let commanded = [CommandedCurve { curve: curve.as_curve(), feed: f64::MAX, from_rest: false }];
            let (mut arcs, mut chords) = (Vec::new(), Vec::new());
            let window = plan_through_window(commanded, limits, 40.0, kind, |some| {
                arcs.extend_from_slice(&some.arcs);
                chords.extend_from_slice(&some.chords);
            });
            if window.is_ok() {
                assert_behind(
                    &limit,
                    curve,
                    [&arcs, &chords],
                    limits.chord_error,
                    &format!("{kind:?} window"),
                )?;
            }
        }
        Ok(())
    }

    fn axes(limits: KinematicLimits<f64>, share: f64) -> KinematicLimits<f64> {
        let axis = AxisLimits {
            velocity: Some(limits.feedrate),
            acceleration: Some(limits.acceleration * share),
            jerk: Some(limits.jerk * share),
        };
        KinematicLimits { axes: [axis; 3], ..limits }
    }

    #[test]
    fn runs_of_the_papers_curves_are_not_ahead() {
        for curve in [seed_000(), seed_003()] {
            assert_all_behind(&curve, &paper_limits()).unwrap();
            assert_all_behind(&curve, &axes(paper_limits(), 1.0)).unwrap();
        }
    }

    /// A spline through points that wind.
    fn spline() -> impl Strategy<Value = NurbsBuf<f64, 2>> {
        let strides = prop::collection::vec((-0.3..0.7_f64, -0.5..0.5_f64), 6..24);
        (2..5_usize, 4.0..60.0_f64, strides).prop_map(|(degree, scale, strides)| {
            let mut at = [0.0; 2];
            let points: Vec<_> = strides
                .iter()
                .map(|(x, y)| {
                    at = [at[0] + scale * x, at[1] + scale * y];
                    at
                })
                .collect();
            let last = (points.len() - degree) as f64;
            let inner = (1..points.len() - degree).map(|knot| knot as f64);
            let ends = |knot| std::iter::repeat_n(knot, degree + 1);
            let knots = ends(0.0).chain(inner).chain(ends(last)).collect();
            NurbsBuf::try_new_nonrational(degree, points, knots).unwrap()
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(48))]

        #[test]
        fn no_run_is_ahead_of_its_plan_in_arcs(
            curve in spline(), period in 1e-3..5e-3_f64, feedrate in 50.0..300.0_f64,
            acceleration in 500.0..4500.0_f64, jerk in 1e4..1e5_f64, exponent in -4.0..-1.0_f64,
            share in prop_oneof![Just(None), (0.3..1.0_f64).prop_map(Some)],
        ) {
            let limits = in_periods(period, feedrate, acceleration, jerk, 10.0_f64.powf(exponent));
            assert_all_behind(&curve, &share.map_or(limits, |share| axes(limits, share)))?;
        }
    }
}
