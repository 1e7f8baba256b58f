//! From a plan in arcs to one in chords that lands on its stops.
//!
//! What each stage falls short by ([`FeedLimit::shortfalls`]) is found for the chords of one plan, and the corrected feeds are those
//! of another. In bends that is nearly the same; but over a corner a chord falls short by anything up to a share of itself, depending on
//! where it begins, and at a stop the run is some micrometres off. The last step would take them all. So a run by the corrected
//! plan's chords is followed to each stop, and what it would go beyond is taken off where the plan begins to come to rest there. As
//! a rule that is behind the last corner and changes nothing before: one or two trials more, and the run lands.
//!
//! Nothing can be added there. Where a run does not come as far, all stages of the stretch are shortened by less, by a *lead*, so that
//! there is something to be taken off. But then chords begin elsewhere before each corner, and over one of more than a right angle
//! what they fall short by jumps with that: the run may still not come as far. So may it where the correction reaches back
//! over such a corner. Each time the lead is doubled. Without any shortening each arc is at least as long as planned, and the
//! run goes beyond the stop.

use alloc::vec::Vec;

use nurbs_core::Differentiate;
use real::Real;

use crate::chord_shortfall::Path;
use crate::{FeedLimit, Schedule, ScheduleBuf, Stage, chord_feeds};

/// How often the run is followed to a stop, at most. Of 1,725 stops of `data/engraving.nc`, in 23 settings, none took more than nine.
const TRIALS: usize = 32;
/// A run that is off its stop by less than 2⁻²⁰ of a step lands on it.
const ON_STOP: i32 = -20;

impl<R: Real> FeedLimit<R> {
    /// The plan `arcs`, made under this limit, for setpoints whose chords, not arcs, have the planned lengths:
    /// [`shortened`](ScheduleBuf::shortened) by its [`shortfalls`](Self::shortfalls), and each stretch between stops so that a run
    /// by its chords lands on the stop. `curves` are those that this limit was made of.
    #[must_use]
    pub fn in_chords<const D: usize, C: Differentiate<R, D>>(
        &self,
        curves: &[C],
        arcs: &ScheduleBuf<R>,
    ) -> ScheduleBuf<R> {
        let shortfalls = self.shortfalls(curves, &arcs.as_schedule());
        let path = Path::new(self, curves);
        let fastest = arcs.stages().iter().fold(R::zero(), |most, stage| most.max(stage.start_feed));
        let rounding = if R::IS_FLOATING { R::resolution() * self.length() } else { R::resolution() };
        let enough = (fastest * arcs.interpolation_period.scale(ON_STOP)).max(rounding);
        arcs.clone().by_sections(&shortfalls, |stages, shortfalls| {
            Stretch { limit: self, arcs, stages, shortfalls }.landed(&path, enough)
        })
    }
}

/// The stages from one stop to the next.
struct Stretch<'a, R> {
    limit: &'a FeedLimit<R>,
    /// The whole plan.
    arcs: &'a ScheduleBuf<R>,
    stages: &'a [Stage<R>],
    /// What its stages fall short by.
    shortfalls: &'a [R],
}

impl<R: Real> Stretch<'_, R> {
    /// The stages shortened so that a run by their chords is off the stop by no more than `enough`, or by the least that is found.
    fn landed<const D: usize, C: Differentiate<R, D>>(
        &self,
        path: &Path<'_, R, C>,
        enough: R,
    ) -> Vec<Stage<R>> {
        let shortfall = self.shortfalls.iter().fold(R::zero(), |sum, part| sum + part.max(R::zero()));
        let mut search = Search::new(shortfall);
        let mut best = (self.shortened(&search), R::max_value());
        let ends = self.stages.first().zip(self.stages.last().filter(|last| last.end_feed.is_zero()));
        // Left in motion, there is no stop to land on.
        let Some((first, last)) = ends.filter(|_| shortfall > R::zero()) else { return best.0 };
        let ends = [first.start, last.start + last.length];
        let off_stop = |stages: &[Stage<R>]| {
            let arcs = self.arcs.as_schedule();
            path.beyond_stop(&Schedule::new(stages, arcs.interpolation_period(), arcs.periods()), ends)
        };
        let mut off = off_stop(&best.0);
        best.1 = off.abs();
        for _ in 1..TRIALS {
            if !(off.abs() > enough) {
                break;
            }
            search.go_on(off);
            let stages = self.shortened(&search);
            off = off_stop(&stages);
            if off.abs() < best.1 {
                best = (stages, off.abs());
            }
        }
        best.0
    }

    fn shortened(&self, search: &Search<R>) -> Vec<Stage<R>> {
        let parts: Vec<_> = self.shortfalls.iter().map(|shortfall| *shortfall * search.share).collect();
        chord_feeds::shortened(
            self.limit,
            self.stages,
            (&parts, search.at_the_end),
            self.arcs.interpolation_period,
        )
    }
}

/// What is taken off a stretch, and how it was found.
struct Search<R> {
    /// What its stages fall short by.
    shortfall: R,
    /// The share of that.
    share: R,
    /// What is taken off at its end besides.
    at_the_end: R,
    /// By so much less than before the stages were shortened last.
    lead: R,
    /// By how much the run before that did not come as far as the stop, negative; 0 if it did.
    short: R,
    /// What was taken off at the end in the run before, and by how much that was off, if only the end differed.
    before: Option<[R; 2]>,
}

impl<R: Real> Search<R> {
    fn new(shortfall: R) -> Self {
        Self {
            shortfall,
            share: R::one(),
            at_the_end: R::zero(),
            lead: R::zero(),
            short: R::zero(),
            before: None,
        }
    }

    /// Goes on to something else from what a run goes beyond the stop.
    fn go_on(&mut self, off: R) {
        let is_nearer =
            self.before.is_none_or(|[_, before]| off.abs() < before.abs() - before.abs().scale(-2));
        let at_the_end = self.at_the_end + off * self.end_per_distance(off);
        if is_nearer && at_the_end > R::zero() {
            self.before = Some([self.at_the_end, off]);
            self.at_the_end = at_the_end;
            return;
        }
        let least = off.abs() + off.abs().half();
        let gained = off - self.short;
        let lead = if !(self.short < R::zero() && off < R::zero()) {
            // Where a corner came between, no less than before, for another one begins elsewhere only then.
            if self.before.is_some() { self.lead.max(least) } else { least }
        } else if gained > least.scale(-3) {
            // What the last one gained says how much more is due.
            self.lead * (least / gained)
        } else {
            self.lead.scale(if gained > R::zero() { 3 } else { 1 })
        };
        self.short = if off < R::zero() && self.before.is_none() { off } else { R::zero() };
        self.lead = lead.min(self.shortfall * R::from_ratio(3, 8));
        self.share = self.share - self.lead / self.shortfall;
        if self.share < R::zero() {
            self.share = self.share + R::one();
            self.short = R::zero();
        }
        (self.at_the_end, self.before) = (R::zero(), None);
    }

    /// By how much more is to be taken off at the end for each distance beyond the stop: 1, or what the last two runs say.
    fn end_per_distance(&self, off: R) -> R {
        let Some([end, before]) = self.before else { return R::one() };
        let (more, less) = (self.at_the_end - end, before - off);
        let is_slope = |a: R, b: R| a.abs().scale(-2) <= b.abs() && b.abs().scale(-2) <= a.abs();
        let rises_together = (more > R::zero()) == (less > R::zero());
        if is_slope(more, less) && rises_together && !less.is_zero() { more / less } else { R::one() }
    }
}

impl<R: Real, C> Path<'_, R, C> {
    /// By how much a run by chords from one distance to another would go beyond that stop if it did not land there.
    fn beyond_stop<const D: usize>(&self, chords: &Schedule<'_, R>, [begin, stop]: [R; 2]) -> R
    where
        C: Differentiate<R, D>,
    {
        let (mut cursor, mut reached, mut beyond) = (chords.start(), begin, R::zero());
        while let Some(wanted) = chords.advance(&mut cursor) {
            let is_last = chords.is_over(&cursor) || cursor.stage() >= chords.stages().len();
            let is_near = stop - reached <= wanted + wanted;
            let rest = if is_last || is_near { self.chord_between(reached, stop) } else { wanted };
            if is_last || rest < wanted {
                // Once there, all that is still wanted goes beyond.
                (beyond, reached) = (beyond + wanted - rest, stop);
            } else {
                reached = (reached + self.arc_of_step(reached, wanted)).min(stop);
            }
            if is_last {
                break;
            }
        }
        beyond
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_paths::{in_periods, polyline, seed_000};
    use crate::{EndFeeds, Junction, KinematicLimits, ProfileKind, plan_with};
    use nurbs_core::NurbsBuf;

    /// What a run goes beyond each stop, in arcs shortened once and in chords.
    fn beyond(
        curves: &[NurbsBuf<f64, 2>],
        limits: &KinematicLimits<f64>,
        feed: f64,
        kind: ProfileKind,
    ) -> [Vec<f64>; 2] {
        let curves: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
        let limit = FeedLimit::along(&curves, limits).unwrap().capped(|_| feed).unwrap();
        let arcs = plan_with(&limit, limits, EndFeeds::default(), kind).unwrap();
        let path = Path::new(&limit, &curves);
        let shortfalls = limit.shortfalls(&curves, &arcs.as_schedule());
        let once = arcs.clone().shortened(&limit, &shortfalls);
        [&once, &limit.in_chords(&curves, &arcs)].map(|plan| {
            assert!((plan.as_schedule().duration() - arcs.as_schedule().duration()).abs() < 1e-9);
            let (mut off, mut begin) = (Vec::new(), 0.0);
            let whole = arcs.stages().split_inclusive(|stage| stage.end_feed == 0.0);
            for (whole, stages) in whole.zip(plan.stages().split_inclusive(|stage| stage.end_feed == 0.0)) {
                let stop = whole.last().map_or(0.0, |last| last.start + last.length);
                off.push(path.beyond_stop(&Schedule::new(stages, 1.0, u32::MAX), [begin, stop]));
                begin = stop;
            }
            off
        })
    }

    fn largest(off: &[f64]) -> f64 {
        off.iter().fold(0.0, |most, x| most.max(x.abs()))
    }

    /// A zigzag whose corners are passed: with the chords of the corrected feeds the run came to the end five periods early.
    #[test]
    fn a_run_over_corners_lands_on_its_end() {
        let points = [[0, 0], [1, 0], [1, 1], [2, 1], [2, 0], [3, 0], [3, 1], [4, 1]];
        let curves = polyline(&points.map(|point| point.map(f64::from)));
        let limits = in_periods(2e-3, 150.0, 1500.0, 3e4, 2e-3);
        let limits = KinematicLimits { junction: Junction::Deviation(0.02), ..limits };
        for kind in ProfileKind::ALL {
            let [once, landed] = beyond(&curves, &limits, 0.05, kind);
            assert!(largest(&once) > 1e-3, "{kind:?}: {once:?}");
            // J T³, what the jerk may change a step by, is 2.4e-4 mm.
            assert!(largest(&landed) < 1e-7, "{kind:?}: {landed:?}");
        }
    }

    /// At one feed all the way, what was taken off at the end was taken off from the start on: chords began elsewhere before the
    /// corner of 135°, whose shortfall then jumped from two thirds of a step too much to one too little, and no trial landed.
    #[test]
    fn what_is_taken_off_at_the_end_changes_nothing_at_a_corner_long_before() {
        let curves = polyline(&[[0.0, 0.0], [15.7, 0.0], [0.0, 15.7]]);
        let limits = in_periods(2e-3, 150.0, 1500.0, 3e4, 2e-3);
        let limits = KinematicLimits { junction: Junction::Deviation(0.02), ..limits };
        for feed in [3.1e-3, 3.2e-3, 3.332e-3, 3.4e-3, 3.5e-3] {
            for kind in ProfileKind::ALL {
                let [_, landed] = beyond(&curves, &limits, feed, kind);
                assert!(largest(&landed) < 4e-9, "{feed} {kind:?}: {landed:?}");
            }
        }
    }

    #[test]
    fn a_run_round_bends_lands_on_its_end() {
        for chord_error in [5e-4, 0.05] {
            let limits = KinematicLimits { chord_error, ..crate::test_paths::paper_limits() };
            let [_, landed] = beyond(&[seed_000()], &limits, limits.feedrate, ProfileKind::Cubic);
            assert!(largest(&landed) < 1e-6, "{landed:?}");
        }
    }
}
