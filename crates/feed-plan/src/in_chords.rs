//! From a plan in arcs to one in chords that lands on its stops.
//!
//! What each stage falls short by ([`FeedLimit::shortfalls`]) is found for the chords of one plan, and the corrected feeds are those
//! of another. In bends that is nearly the same; but over a corner a chord falls short by anything up to a share of itself, depending on
//! where it begins, and at a stop the run is some micrometres off. The last step would take them all. So a run by the corrected
//! plan's chords is followed to each stop. What it would go beyond is taken off the last stage of the stretch, behind its
//! last corner as a rule, where it changes nothing before. Where a run does not come as far, all its stages are shortened by
//! less first.

use alloc::vec::Vec;

use nurbs_core::Differentiate;
use real::Real;

use crate::chord_shortfall::Path;
use crate::{FeedLimit, Schedule, ScheduleBuf, Stage};

/// How often the run is followed.
const TRIALS: usize = 8;
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
        let mut stretches: Vec<_> = stretches(arcs.stages(), &shortfalls).collect();
        let fastest = arcs.stages().iter().fold(R::zero(), |most, stage| most.max(stage.start_feed));
        let enough = fastest * arcs.interpolation_period.scale(ON_STOP);
        let mut chords = arcs.clone().shortened(self, &shortfalls);
        for trial in 1..=TRIALS {
            let off = path.beyond_stops(&chords.as_schedule(), stretches.iter().map(|stretch| stretch.end));
            stretches.iter_mut().zip(off).for_each(|(stretch, off)| stretch.judge(off, enough));
            if stretches.iter().all(|stretch| stretch.is_done) {
                break; // These chords are of the corrections that were found to be enough.
            }
            if trial == TRIALS {
                stretches.iter_mut().for_each(|stretch| stretch.correction = stretch.best.0);
            }
            chords = arcs.clone().shortened(self, &corrected(&stretches, &shortfalls));
        }
        chords
    }
}

/// The stages from one stop to the next.
struct Stretch<R> {
    stages: usize,
    /// Distance of the stop.
    end: R,
    /// What its stages fall short by.
    shortfall: R,
    /// That of the trial at hand.
    correction: Correction<R>,
    /// The one whose run was least off its stop, and by how much.
    best: (Correction<R>, R),
    is_done: bool,
}

/// What is taken off a stretch.
#[derive(Clone, Copy)]
struct Correction<R> {
    /// The share of what its stages fall short by.
    share: R,
    /// What is taken off the last stage besides.
    at_the_end: R,
}

impl<R: Real> Stretch<R> {
    /// Takes what a run goes beyond the stop, and goes on to another correction unless that is little.
    fn judge(&mut self, off: R, enough: R) {
        if self.is_done {
            return;
        }
        if off.abs() < self.best.1 {
            self.best = (self.correction, off.abs());
        }
        let Correction { share, at_the_end } = &mut self.correction;
        self.is_done = !(off.abs() > enough) || !(self.shortfall > R::zero());
        if self.is_done {
            return;
        }
        if off < R::zero() && at_the_end.is_zero() {
            // By so much more that there is something to be taken off.
            *share = (*share + (off + off.half()) / self.shortfall).max(R::zero());
        } else {
            *at_the_end = (*at_the_end + off).max(R::zero());
        }
    }
}

fn stretches<R: Real>(stages: &[Stage<R>], shortfalls: &[R]) -> impl Iterator<Item = Stretch<R>> {
    let mut rest = shortfalls;
    stages.split_inclusive(|stage| stage.end_feed.is_zero()).map(move |stages| {
        let (these, others) = rest.split_at(stages.len().min(rest.len()));
        rest = others;
        let shortfall = these.iter().fold(R::zero(), |sum, shortfall| sum + shortfall.max(R::zero()));
        let end = stages.last().map_or_else(R::zero, |last| last.start + last.length);
        // One that is left in motion has no stop to land on.
        let is_done = stages.last().is_none_or(|last| !last.end_feed.is_zero());
        let correction = Correction { share: R::one(), at_the_end: R::zero() };
        let best = (correction, R::max_value());
        Stretch { stages: stages.len(), end, shortfall, correction, best, is_done }
    })
}

/// What the stages are shortened by.
fn corrected<R: Real>(stretches: &[Stretch<R>], shortfalls: &[R]) -> Vec<R> {
    let mut corrected = Vec::with_capacity(shortfalls.len());
    let mut rest = shortfalls;
    for stretch in stretches {
        let (these, others) = rest.split_at(stretch.stages.min(rest.len()));
        rest = others;
        corrected.extend(these.iter().map(|shortfall| *shortfall * stretch.correction.share));
        if let Some(last) = corrected.last_mut() {
            *last = *last + stretch.correction.at_the_end;
        }
    }
    corrected
}

impl<R: Real, C> Path<'_, R, C> {
    /// By how much a run by chords would go beyond each stop if it did not land there; of a last stretch without a stop, 0.
    fn beyond_stops<const D: usize>(&self, chords: &Schedule<'_, R>, stops: impl Iterator<Item = R>) -> Vec<R>
    where
        C: Differentiate<R, D>,
    {
        let (mut cursor, mut reached) = (chords.start(), R::zero());
        let follow = |stop: R| {
            let mut beyond = R::zero();
            loop {
                let begun_in = cursor.stage();
                let Some(wanted) = chords.advance(&mut cursor) else { return R::zero() };
                let passed = chords.stages().get(begun_in..cursor.stage()).unwrap_or_default();
                let is_last = chords.is_over(&cursor) || passed.iter().any(|stage| stage.end_feed.is_zero());
                let is_near = stop - reached <= wanted + wanted;
                let rest = if is_last || is_near { self.chord_between(reached, stop) } else { wanted };
                if is_last || rest < wanted {
                    // Once there, all that is still wanted goes beyond.
                    (beyond, reached) = (beyond + wanted - rest, stop);
                } else {
                    reached = (reached + self.arc_over(reached, wanted)).min(stop);
                }
                if is_last {
                    return beyond;
                }
            }
        };
        stops.map(follow).collect()
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
        let ends: Vec<_> = stretches(arcs.stages(), &shortfalls).map(|stretch| stretch.end).collect();
        [&once, &limit.in_chords(&curves, &arcs)].map(|plan| {
            assert!((plan.as_schedule().duration() - arcs.as_schedule().duration()).abs() < 1e-9);
            path.beyond_stops(&plan.as_schedule(), ends.iter().copied())
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
            assert!(largest(&landed) < 2e-5, "{kind:?}: {landed:?}");
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
