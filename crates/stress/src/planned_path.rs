//! The plan of a random path, and a check of its promises.

use feed_plan::{EndFeeds, FeedLimit, Planned, ScheduleBuf, Stage, plan_with};
use kernel_oracle::{PlanPromises, Violation};
use nurbs_core::FastCurve;

use crate::RandomPath;

/// A path with its plan, made in f64.
#[derive(Debug)]
pub struct PlannedPath<'a, const D: usize> {
    /// The path.
    pub path: &'a RandomPath<D>,
    /// The largest feed at each distance.
    pub limit: FeedLimit<f64>,
    /// The plan along the curve.
    pub arcs: ScheduleBuf<f64>,
    /// The plan for setpoints: the planned lengths are those of chords, not of arcs.
    pub chords: ScheduleBuf<f64>,
    /// By which factor the path is run slower than planned.
    slower: u32,
}

impl<'a, const D: usize> PlannedPath<'a, D> {
    /// Plans from rest to rest; `None` for a path that is refused or takes more than `most_periods` periods.
    #[must_use]
    pub fn new(path: &'a RandomPath<D>, most_periods: u32) -> Option<Self> {
        let curves: Vec<_> = path.curves.iter().map(|curve| FastCurve::of(curve.as_curve())).collect();
        let limit = FeedLimit::along(&curves, &path.limits).ok()?;
        let (limits, ends) = (&path.limits, EndFeeds::default());
        let arcs = plan_with(&limit, limits, ends, path.profile).ok()?;
        if arcs.as_schedule().periods() > u64::from(most_periods) {
            return None;
        }
        let Planned { limit, arcs, chords, .. } =
            Planned::under(limit, &curves, limits, ends, path.profile).ok()?;
        Some(Self { path, limit, arcs, chords, slower: 1 })
    }

    /// The same path and plan, run `times` times slower, as with an override. The run has `times` times as many
    /// periods. Its chords count as long as their arcs: their shortfall falls with the square of `times`.
    #[must_use]
    pub fn slower(self, times: u32) -> Self {
        Self { slower: times, chords: self.arcs.clone(), ..self }
    }

    /// Periods of a run.
    #[must_use]
    pub fn periods(&self) -> u64 {
        self.chords.as_schedule().periods().saturating_mul(u64::from(self.slower))
    }

    /// The longest step from which a run comes to rest: A T² over the square of the factor by which the run is slower.
    #[must_use]
    pub fn landing_step(&self) -> f64 {
        self.path.limits.acceleration / f64::from(self.slower).powi(2)
    }

    /// Number of periods after which a run must be over.
    #[must_use]
    pub fn most_periods(&self) -> usize {
        usize::try_from(2 * self.periods() + 16).unwrap_or(usize::MAX)
    }

    /// Curve and parameter of each rest, in order.
    #[must_use]
    pub fn stops(&self) -> Vec<(usize, f64)> {
        self.chords.stages().iter().filter_map(Stage::rest).collect()
    }

    /// The stages of a run.
    #[must_use]
    pub fn stages(&self) -> Vec<Stage<f64>> {
        let slower = f64::from(self.slower);
        let slowed = |stage: &Stage<f64>| Stage {
            duration: stage.duration * slower,
            start_feed: stage.start_feed / slower,
            end_feed: stage.end_feed / slower,
            ..*stage
        };
        self.chords.stages().iter().map(slowed).collect()
    }

    /// Checks that the plan keeps feed, acceleration and jerk at every stage, joins its stages, ends at rest at the
    /// end, and stays under the limit at a hundred places of each stage.
    ///
    /// # Errors
    /// The first promise that is broken.
    pub fn check(&self) -> Result<(), Violation> {
        PlanPromises { limit: &self.limit, limits: &self.path.limits, places: 100 }
            .check(&self.arcs.as_schedule())
    }
}
