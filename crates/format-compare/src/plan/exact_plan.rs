//! A plan that every format can use: the stages in double-double, which holds the numbers of each format exactly.

use std::ops::Range;
use std::sync::OnceLock;

use feed_plan::{
    CommandedCurve, EndFeeds, FeedLimit, KinematicLimits, Lead, PlanError, Planned, ProfileKind, Schedule,
    Stage, plan_through_window, sections,
};
use nurbs_core::{Differentiate, NurbsBuf};
use real::{Backend, DoubleDouble, Real};

use crate::plan::in_format::{exact, in_format, in_format_or_most, limits_in_format, nearest};
use crate::plan::lengths::{self, Lengths, SectionPeriods, section_periods};
use crate::problem::problem::Problem;
use crate::refusal::Refusal;

/// A plan made in some format, with exactly the numbers that this format computed.
#[derive(Clone, Debug)]
pub struct ExactPlan {
    /// The plan along the path: its distances are arc lengths.
    arcs: Vec<Stage<DoubleDouble>>,
    /// The plan for setpoints: its distances are summed lengths of the chords between them.
    chords: Vec<Stage<DoubleDouble>>,
    periods: u64,
    /// The sections of the plan for setpoints.
    sections: Vec<SectionPeriods>,
    profile: ProfileKind,
    /// The result of [`limit`](Self::limit). A plan made in f64 has its own limit from the start; for any other, the
    /// limit is made at the first call.
    limit: OnceLock<FeedLimit<f64>>,
    /// The result of [`lead`](Self::lead), found in the same way.
    lead: OnceLock<Option<Lead<f64>>>,
}

/// The feed of each curve in the format `R`, in mm per period, if the highest is `highest`. The format rounds the ratio
/// of each feedrate to the highest, for many formats hold no feedrate in mm/s.
fn feeds_in_format<R: Backend, const D: usize>(
    problem: &Problem<D>,
    highest: R,
) -> Result<impl Fn(usize) -> R, Refusal> {
    let ratio = problem.feed_ratios();
    let feed = |curve: usize| match ratio(curve) {
        ratio if ratio < 1.0 => Ok(highest * in_format::<R>("feedrate of a move", ratio)?),
        _ => Ok(highest),
    };
    let feeds = (0..problem.feeds_mm_per_s.len()).map(feed).collect::<Result<Vec<_>, Refusal>>()?;
    Ok(move |curve: usize| feeds.get(curve).copied().unwrap_or(highest))
}

/// The limit of the problem's curves with the feeds of its moves, in the format `R`.
fn feed_limit<R: Backend, C: Differentiate<R, D>, const D: usize>(
    curves: &[C],
    limits: &KinematicLimits<R>,
    problem: &Problem<D>,
) -> Result<FeedLimit<R>, Refusal> {
    let feed_of = feeds_in_format(problem, limits.feedrate)?;
    let limit = FeedLimit::along_with_stops(curves, limits, &problem.stops);
    let limit = limit.and_then(|limit| limit.capped(feed_of)).map_err(|error| problem.plan_refusal(error))?;
    problem.within_side_axes(limit, in_format_or_most)
}

/// The feeds at both ends of the problem, in mm per period, in the format `R`.
fn end_feeds<R: Backend, const D: usize>(
    problem: &Problem<D>,
    end_feeds_mm_per_s: [f64; 2],
) -> Result<EndFeeds<R>, Refusal> {
    let [start, end] = end_feeds_mm_per_s.map(|feed| feed * problem.period_s());
    Ok(EndFeeds { start: in_format("start feed", start)?, end: in_format("end feed", end)? })
}

/// Plans the problem in f64, in which the fastest profile has more ways to a plan than in other formats.
fn fastest_or<C: Differentiate<f64, D> + Sync, const D: usize>(
    curves: &[C],
    limits: &KinematicLimits<f64>,
    problem: &Problem<D>,
    end_feeds_mm_per_s: [f64; 2],
    profile: ProfileKind,
) -> Result<Planned<f64>, Refusal> {
    if profile != ProfileKind::Fastest {
        return planned(curves, limits, problem, end_feeds_mm_per_s, profile);
    }
    let refusal = |error| problem.plan_refusal(error);
    if !limits.limit_accelerations_of_axes(D) {
        let limit = feed_limit(curves, limits, problem)?;
        let ends = end_feeds(problem, end_feeds_mm_per_s)?;
        return Planned::fastest(limit, curves, limits, ends).map_err(refusal);
    }
    // The limit of a long path takes much memory: that of today's plan goes before the other is made.
    let today = planned(curves, limits, problem, end_feeds_mm_per_s, profile)?.arcs;
    let limit = FeedLimit::without_reserves(curves, limits, &problem.stops)?
        .capped(feeds_in_format(problem, limits.feedrate)?)?;
    let limit = problem.within_side_axes(limit, in_format_or_most)?;
    Planned::within_axes(&today, limit, curves, limits).map_err(refusal)
}

/// Plans the problem with its curves and limits in the format `R`.
fn planned<R: Backend, C: Differentiate<R, D>, const D: usize>(
    curves: &[C],
    limits: &KinematicLimits<R>,
    problem: &Problem<D>,
    end_feeds_mm_per_s: [f64; 2],
    profile: ProfileKind,
) -> Result<Planned<R>, Refusal> {
    let limit = feed_limit(curves, limits, problem)?;
    let ends = end_feeds(problem, end_feeds_mm_per_s)?;
    Planned::under(limit, curves, limits, ends, profile).map_err(|error| problem.plan_refusal(error))
}

impl ExactPlan {
    /// Plans `problem` in the format `R` by the default profile, with the interpolation period as the unit of time.
    ///
    /// # Errors
    /// [`Refusal`] when the curves or a limit do not fit the format, or no plan exists.
    pub fn in_format<R: Backend, const D: usize>(
        problem: &Problem<D>,
        end_feeds_mm_per_s: [f64; 2],
    ) -> Result<Self, Refusal> {
        Self::in_format_with::<R, D>(problem, end_feeds_mm_per_s, ProfileKind::default())
    }

    /// Plans `problem` in the format `R` by transitions of this kind, with the interpolation period as the unit of time.
    ///
    /// # Errors
    /// As [`in_format`](Self::in_format).
    pub fn in_format_with<R: Backend, const D: usize>(
        problem: &Problem<D>,
        end_feeds_mm_per_s: [f64; 2],
        profile: ProfileKind,
    ) -> Result<Self, Refusal> {
        if R::name() == f64::name() {
            let limits = limits_in_format::<f64>(&problem.limits_per_period()?)?;
            let curves = problem.fast_curves();
            let planned = fastest_or(&curves, &limits, problem, end_feeds_mm_per_s, profile)?;
            drop(curves);
            let plan = Self::of(&planned, profile);
            return Ok(Self { limit: planned.limit.into(), lead: Some(planned.lead).into(), ..plan });
        }
        let limits = limits_in_format::<R>(&problem.limits_per_period()?)?;
        let curves = problem.curves.iter().map(NurbsBuf::convert::<R>).collect::<Result<Vec<_>, _>>()?;
        let curves: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
        Ok(Self::of(&planned(&curves, &limits, problem, end_feeds_mm_per_s, profile)?, profile))
    }

    /// The numbers of a plan made in the format `R`, without its limit.
    fn of<R: Backend>(planned: &Planned<R>, profile: ProfileKind) -> Self {
        let [arcs, chords] = [&planned.arcs, &planned.chords]
            .map(|schedule| on_the_grid(schedule.stages().iter().map(|stage| stage.map(exact)).collect()));
        let periods = planned.chords.as_schedule().periods();
        let sections = section_periods(&chords);
        Self { arcs, chords, periods, sections, profile, limit: OnceLock::new(), lead: OnceLock::new() }
    }

    /// Plans `problem` in the format `R` with no more than `window_mm` in view at a time, from rest to rest. At each stop
    /// the plan waits for the end of the period.
    ///
    /// # Errors
    /// As [`in_format`](Self::in_format).
    pub fn through_window<R: Backend, const D: usize>(
        problem: &Problem<D>,
        window_mm: f64,
        profile: ProfileKind,
    ) -> Result<Self, Refusal> {
        if !problem.side_axes.is_empty() {
            return Err(Refusal::SideAxesInWindow(problem.side_axes.letters()));
        }
        let limits = limits_in_format::<R>(&problem.limits_per_period()?)?;
        let window = in_format::<R>("window", window_mm)?;
        let curves = problem.curves.iter().map(NurbsBuf::convert::<R>).collect::<Result<Vec<_>, _>>()?;
        let feed_of = feeds_in_format(problem, limits.feedrate)?;
        let curves = curves.iter().enumerate().map(|(index, curve)| CommandedCurve {
            curve: curve.as_curve(),
            feed: feed_of(index),
            from_rest: problem.rests_before(index),
        });
        let (mut arcs, mut chords) = (Vec::new(), Vec::new());
        let done = plan_through_window(curves, &limits, window, profile, |stages| {
            arcs.extend(stages.arcs.iter().map(|stage| stage.map(exact)));
            chords.extend(stages.chords.iter().map(|stage| stage.map(exact)));
        })
        .map_err(|error| problem.plan_refusal(error))?;
        let [arcs, chords] = [arcs, chords].map(on_the_grid);
        let sections = section_periods(&chords);
        Ok(Self {
            arcs,
            chords,
            periods: done.periods,
            sections,
            profile,
            limit: OnceLock::new(),
            lead: OnceLock::new(),
        })
    }

    /// The largest feed at each distance, in f64, in mm and periods, with the place on the path. `problem` must be the
    /// one that was planned. Unless the plan has kept its limit, it is made once.
    ///
    /// # Errors
    /// As [`Problem::feed_limit`].
    pub fn limit<const D: usize>(&self, problem: &Problem<D>) -> Result<&FeedLimit<f64>, PlanError> {
        match self.limit.get() {
            Some(limit) => Ok(limit),
            None => problem.feed_limit().map(|limit| self.limit.get_or_init(|| limit)),
        }
    }

    /// By how much a run by the plan for setpoints is ahead of the plan along the path, in f64, in mm; `None` if the path has no limit in f64.
    /// `problem` must be the one that was planned.
    pub(crate) fn lead<const D: usize>(&self, problem: &Problem<D>) -> Option<Lead<f64>> {
        *self.lead.get_or_init(|| {
            let [arcs, chords] = self.in_f64();
            let lead = |limit: &FeedLimit<f64>| limit.lead(&problem.fast_curves(), &arcs, &chords, 1.0);
            match self.limit.get() {
                Some(limit) => Some(lead(limit)),
                None => problem.feed_limit().ok().map(|limit| lead(&limit)),
            }
        })
    }

    /// The plan without its limit, which takes more memory than the path.
    pub(crate) fn without_limit(self) -> Self {
        Self { limit: OnceLock::new(), ..self }
    }

    /// The plan along the path, in arc length. It tells where on the path the tool is, and keeps the limit there.
    #[must_use]
    pub fn arcs(&self) -> Schedule<'_, DoubleDouble> {
        Schedule::new(&self.arcs, DoubleDouble::from(1.0), self.periods)
    }

    /// The plan for setpoints. Its distances are summed lengths of the chords between setpoints. Where chords are
    /// shorter than their arcs, its distances are less than those along the path.
    #[must_use]
    pub fn schedule(&self) -> Schedule<'_, DoubleDouble> {
        Schedule::new(&self.chords, DoubleDouble::from(1.0), self.periods)
    }

    /// The part of the [`schedule`](Self::schedule) that takes these periods, which are those of whole sections.
    pub(crate) fn schedule_within(&self, periods: &Range<u64>) -> Schedule<'_, DoubleDouble> {
        let stage = |period| lengths::first_stage(&self.sections, period).unwrap_or(self.chords.len());
        let stages = self.chords.get(stage(periods.start)..stage(periods.end)).unwrap_or_default();
        Schedule::new(stages, DoubleDouble::from(1.0), periods.end - periods.start)
    }

    /// Curve and parameter of each rest, in order.
    pub(crate) fn rests(&self) -> impl Iterator<Item = (usize, f64)> {
        self.chords.iter().filter_map(Stage::rest).map(|(curve, u)| (curve, u.value()))
    }

    /// The kind of transitions in the plan.
    #[must_use]
    pub fn profile(&self) -> ProfileKind {
        self.profile
    }

    /// The stages in arcs and in chords, in f64.
    fn in_f64(&self) -> [Vec<Stage<f64>>; 2] {
        [&self.arcs, &self.chords]
            .map(|stages| stages.iter().map(|stage| stage.map(DoubleDouble::value)).collect())
    }

    /// By which part of itself the feed is lowered for setpoints, at most: at a period's end the feed of the [`schedule`](Self::schedule) is
    /// less than that of [`arcs`](Self::arcs) by as much as chords are shorter than arcs. Feeds of a quarter of the greatest count.
    pub(crate) fn lowering(&self) -> f64 {
        let [arcs, chords] = self.in_f64();
        let sections = [&arcs, &chords].map(|stages| section_periods(stages));
        let [planned, lowered] =
            [Lengths::from(&arcs, &sections[0], 0), Lengths::from(&chords, &sections[1], 0)];
        let least = self.greatest_feed() / 4.0;
        let feeds = planned.zip(lowered).map(|((_, planned), (_, lowered))| (planned, lowered));
        feeds
            .filter(|(planned, _)| *planned >= least)
            .fold(0.0, |most: f64, (planned, lowered)| most.max(1.0 - lowered / planned))
    }

    /// The greatest feed, in mm per period.
    pub(crate) fn greatest_feed(&self) -> f64 {
        let feeds = self.chords.iter().map(|stage| stage.start_feed.value().max(stage.end_feed.value()));
        feeds.fold(0.0, f64::max)
    }

    /// Whole number of interpolation periods that the plan takes.
    #[must_use]
    pub fn periods(&self) -> u64 {
        self.periods
    }

    /// The stages in the format `R`.
    ///
    /// Feeds and durations must fit, since real time uses them. Distances and parameters are for the table only; a
    /// value out of range becomes the nearest number of the format.
    ///
    /// # Errors
    /// [`Refusal::Limit`] naming the quantity that does not fit.
    pub fn stages_in<R: Backend>(&self) -> Result<Vec<Stage<R>>, Refusal> {
        let refusal =
            |what, value: DoubleDouble| Refusal::Limit { what, value: value.value(), format: R::name() };
        for stage in &self.chords {
            for (what, value) in [
                ("stage feed", stage.start_feed),
                ("stage feed", stage.end_feed),
                ("stage duration", stage.duration),
            ] {
                nearest::<R>(value).ok_or_else(|| refusal(what, value))?;
            }
        }
        let saturated = |x: DoubleDouble| {
            nearest(x).unwrap_or(if x.value() > 0.0 { R::max_value() } else { R::min_value() })
        };
        Ok(self.chords.iter().map(|stage| stage.map(saturated)).collect())
    }

    /// The distance of each period, in mm, exact to the reference's precision, with the feed at the period's end, in mm
    /// per period.
    pub fn lengths(&self) -> impl Iterator<Item = (DoubleDouble, f64)> {
        self.lengths_from(0).map(|(length, feed)| (length, feed.value()))
    }

    /// As [`lengths`](Self::lengths), from this period on.
    pub(crate) fn lengths_from(&self, period: u64) -> Lengths<'_> {
        Lengths::from(&self.chords, &self.sections, period)
    }
}

/// Moves the ends of stages to multiples of 2⁻³² periods on their section's clock, in which a controller counts time. A
/// distance changes by at most 1e-10 of a step.
fn on_the_grid(mut stages: Vec<Stage<DoubleDouble>>) -> Vec<Stage<DoubleDouble>> {
    let durations: Vec<_> = sections(&stages).flat_map(|section| section.durations()).collect();
    for (stage, duration) in stages.iter_mut().zip(durations) {
        stage.duration = DoubleDouble::from_phase(duration, 32);
    }
    stages
}
