//! The plan of a random path, and a check of its promises.

use feed_plan::{EndFeeds, FeedLimit, Planned, ScheduleBuf, Stage, plan_with};
use nurbs_core::FastCurve;

use crate::RandomPath;
use crate::violation::{Violation, demand};

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

/// The rounding that is allowed in a quantity of the plan: 10⁻¹² is promised, over some hundred stages.
const ROUNDING: f64 = 1e-9;

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
        let limits = &self.path.limits;
        let plan = self.arcs.as_schedule();
        let rounded = |bound: f64| bound * (1.0 + ROUNDING);
        let (mut feed, mut distance) = (0.0, 0.0);
        let feed_unit = ROUNDING * limits.feedrate;
        for (index, stage) in plan.stages().iter().enumerate() {
            let piece = stage.piece();
            demand(
                "a stage begins with the feed before it",
                "f64",
                index,
                (stage.start_feed - feed).abs(),
                feed_unit,
            )?;
            demand(
                "a stage begins where the one before ends",
                "f64",
                index,
                (stage.start - distance).abs(),
                ROUNDING * (1.0 + plan.length()),
            )?;
            demand("feed", "f64", index, stage.start_feed.max(stage.end_feed), rounded(limits.feedrate))?;
            demand("no feed is negative", "f64", index, -stage.start_feed.min(stage.end_feed), 0.0)?;
            demand(
                "acceleration",
                "f64",
                index,
                piece.peak_acceleration().abs(),
                rounded(limits.acceleration),
            )?;
            demand("jerk", "f64", index, piece.peak_jerk().abs(), rounded(limits.jerk))?;
            (feed, distance) = (stage.end_feed, stage.start + stage.length);
            for sample in 0..=100 {
                let time = stage.duration * f64::from(sample) / 100.0;
                let at = stage.start + stage.distance_at(time);
                // Where the limit jumps, the values on both sides are allowed: rounding decides on which side a place
                // lies.
                let near = ROUNDING * (1.0 + plan.length());
                let allowed =
                    self.limit.at(at).max(self.limit.at((at - near).max(0.0))).max(self.limit.at(at + near));
                demand(
                    "feed under the limit",
                    "f64",
                    index,
                    stage.feed_at(time),
                    allowed * (1.0 + 1e-6) + feed_unit,
                )?;
            }
        }
        demand("the plan ends at rest", "f64", plan.stages().len(), feed, feed_unit)?;
        let length = self.limit.length();
        demand(
            "the plan ends at the end",
            "f64",
            plan.stages().len(),
            (distance - length).abs(),
            ROUNDING * (1.0 + length),
        )?;
        let periods = plan.periods() as f64;
        demand(
            "the plan takes whole periods",
            "f64",
            0,
            (plan.duration() - periods).abs(),
            ROUNDING * (1.0 + periods),
        )?;
        Ok(())
    }
}
