//! From a plan in arcs to one in chords that lands on its stops.
//!
//! The shortfall of each stage ([`FeedLimit::shortfalls`]) is computed for the chords of one plan, and the corrected feeds make
//! another plan, whose chords fall short by slightly different lengths. In a run of a thousand bends some micrometres remain, and the
//! last step before a stop would take them all. So the planner follows a run by the corrected plan's chords to each stop. It takes the
//! length by which the run would pass the stop off the stages that brake for it, behind most of the bends. After one or two more
//! trials the run lands.
//!
//! Those stages cannot be lengthened. Where a run ends before the stop, all stages of the section are shortened by less, by a *lead*,
//! so that the run passes the stop and the braking stages can take the rest off.

use alloc::vec::Vec;

use nurbs_core::Differentiate;
use real::Real;

use crate::chords::feeds;
use crate::chords::shortfall::Path;
use crate::chords::stretch::Stretch;
use crate::{Cursor, FeedLimit, Schedule, ScheduleBuf, Stage};

/// How often the run is followed to a stop, at most.
const TRIALS: usize = 8;
/// A run that is off its stop by less than 2⁻²⁰ of a step lands on it.
const ON_STOP: i32 = -20;

impl<R: Real> FeedLimit<R> {
    /// The plan `arcs` for setpoints whose chords, not arcs, have the planned lengths. `arcs` must have been made under
    /// this limit, and `curves` are those that this limit was made of. Each section is
    /// [`shortened`](ScheduleBuf::shortened) by its [`shortfalls`](Self::shortfalls) so that a run by its chords lands
    /// on the stop at its end.
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
        let enough = (fastest * arcs.interpolation_period.ldexp(ON_STOP)).max(rounding);
        arcs.clone().by_sections(&shortfalls, |stages, shortfalls| {
            let begin = stages.first().map_or(R::zero(), |first| first.start);
            let before = Before { stages: &[], cursor: arcs.as_schedule().start(), reached: begin };
            path.landed(&before, &Stretch::of(stages, shortfalls), arcs.interpolation_period, enough)
        })
    }
}

/// A run by chords up to the end of the last whole period before a stretch.
#[derive(Clone, Copy)]
pub(crate) struct Before<'a, R> {
    /// The stages that this period ends in, and those from there to the stretch.
    pub(crate) stages: &'a [Stage<R>],
    /// The end of the period in these stages and those that follow.
    pub(crate) cursor: Cursor<R>,
    /// The distance that the chords have come to.
    pub(crate) reached: R,
}

impl<R: Real, C: Differentiate<R, D>, const D: usize> Path<'_, R, C, D> {
    /// Shortens the stages to a stop by their shortfalls. Of at most [`TRIALS`] trials it returns the first after which a
    /// run by the chords is off the stop by no more than `enough`, or else the best.
    pub(crate) fn landed(
        &self,
        before: &Before<'_, R>,
        stretch: &Stretch<'_, R>,
        period: R,
        enough: R,
    ) -> Vec<Stage<R>> {
        // Shortens all stages by a share of their shortfalls, and those that brake to the stop by `at_the_end` more.
        let shortened = |share: R, at_the_end: R| {
            let parts: Vec<_> = stretch.shortfalls.iter().map(|shortfall| *shortfall * share).collect();
            feeds::shortened(self.limit, &Stretch { shortfalls: &parts, ..*stretch }, at_the_end, period)
        };
        let shortfall = stretch.shortfalls.iter().fold(R::zero(), |sum, part| sum + part.max(R::zero()));
        let (mut lead, mut at_the_end) = (R::zero(), R::zero());
        let mut best = (shortened(R::one(), at_the_end), R::max_value());
        let rest = stretch.stages.last().filter(|last| last.end_feed.is_zero());
        let is_off = shortfall > enough || stretch.begin.is_some();
        // A section that ends in motion has no stop to land on.
        let Some(last) = rest.filter(|_| is_off) else { return best.0 };
        let stop = last.start + last.length;
        for trial in 0..TRIALS {
            let share = if lead < shortfall { R::one() - lead / shortfall } else { R::zero() };
            let short = if trial > 0 { shortened(share, at_the_end) } else { best.0.clone() };
            let run = [before.stages, &short].concat();
            let off = self.off_stop(&Schedule::new(&run, period, u64::MAX), before, stop);
            if off.abs() < best.1 {
                best = (short, off.abs());
            }
            if !(off.abs() > enough) {
                break;
            }
            at_the_end = at_the_end + off;
            if at_the_end < R::zero() {
                (lead, at_the_end) = (lead - at_the_end - at_the_end, R::zero());
            }
        }
        best.0
    }

    /// By how much a run by chords would pass `stop` if it did not land there.
    pub(crate) fn off_stop(&self, chords: &Schedule<'_, R>, before: &Before<'_, R>, stop: R) -> R {
        let (mut cursor, mut reached, mut beyond) = (before.cursor, before.reached, R::zero());
        while let Some(wanted) = chords.advance(&mut cursor) {
            let is_last = chords.is_over(&cursor) || cursor.stage() >= chords.stages().len();
            let is_near = stop - reached <= wanted + wanted;
            // A run at the stop has no way left: what follows on the path may begin behind a rapid move.
            let rest = match reached < stop {
                true if is_last || is_near => self.step_between(reached, stop),
                true => wanted,
                false => R::zero(),
            };
            if is_last || rest < wanted {
                // Once the run is at the stop, each length that is still wanted would pass it.
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
    use crate::{EndFeeds, Junction, KinematicLimits, ProfileKind, plan_with, sections};
    use nurbs_core::NurbsBuf;

    /// By how much a run in chords would pass each stop.
    fn beyond(
        curves: &[NurbsBuf<f64, 2>],
        limits: &KinematicLimits<f64>,
        feed: f64,
        kind: ProfileKind,
    ) -> Vec<f64> {
        let curves: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
        let limit = FeedLimit::along(&curves, limits).unwrap().capped(|_| feed).unwrap();
        let arcs = plan_with(&limit, limits, EndFeeds::default(), kind).unwrap();
        of_sections(&curves, &limit, &arcs)
    }

    fn of_sections<C: Differentiate<f64, 2>>(
        curves: &[C],
        limit: &FeedLimit<f64>,
        arcs: &ScheduleBuf<f64>,
    ) -> Vec<f64> {
        let chords = limit.in_chords(curves, arcs);
        assert!((chords.as_schedule().duration() - arcs.as_schedule().duration()).abs() < 1e-9);
        let path = Path::new(limit, curves);
        let mut begin = 0.0;
        let sections = sections(arcs.stages()).zip(sections(chords.stages()));
        let beyond = sections.map(|(whole, chords)| {
            let stop = whole.stages().last().map_or(0.0, |last| last.start + last.length);
            let chords = Schedule::new(chords.stages(), 1.0, u64::MAX);
            let reached = core::mem::replace(&mut begin, stop);
            let before = Before { stages: &[], cursor: chords.start(), reached };
            path.off_stop(&chords, &before, stop)
        });
        beyond.collect()
    }

    fn largest(off: &[f64]) -> f64 {
        off.iter().fold(0.0, |most, x| most.max(x.abs()))
    }

    /// Between two arcs is a stop. A run lands on it equally well whether the second arc begins there or far away.
    #[test]
    fn a_path_that_goes_on_elsewhere_behind_a_stop_lands_there_too() {
        let arc = |x: f64| {
            let points = vec![[x, 0.0], [x, 4.0], [x + 4.0, 4.0], [x + 8.0, 4.0], [x + 8.0, 0.0]];
            NurbsBuf::try_new_nonrational(2, points, vec![0.0, 0.0, 0.0, 0.3, 0.6, 1.0, 1.0, 1.0]).unwrap()
        };
        let limits = in_periods(2e-3, 50.0, 1500.0, 3e4, 2e-3);
        let beyond = |second: f64| {
            let curves = [arc(0.0), arc(second)];
            let curves: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
            let limit = FeedLimit::along_with_stops(&curves, &limits, &[1]).unwrap();
            let arcs = plan_with(&limit, &limits, EndFeeds::default(), ProfileKind::Cubic).unwrap();
            (arcs.as_schedule().periods(), of_sections(&curves, &limit, &arcs))
        };
        let [(near, joined), (far, apart)] = [8.0, 500.0].map(beyond);
        assert_eq!(near, far);
        assert!(largest(&joined) < 1e-7 && largest(&apart) < 1e-7, "{joined:?} {apart:?}");
    }

    /// A run that is at its stop early stands there, and passes it by all that it still wants. The planner once subtracted the
    /// length of the rapid move behind the stop, and then did not shorten the section at all.
    #[test]
    fn a_run_that_is_early_at_a_stop_passes_it_by_as_much_wherever_the_path_goes_on() {
        let limits = in_periods(2e-3, 50.0, 1500.0, 3e4, 2e-3);
        for second in [10.0, 500.0] {
            let line = |x: f64| polyline(&[[x, 0.0], [x + 10.0, 0.0]]).remove(0);
            let curves = [line(0.0), line(second)];
            let curves: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
            let limit = FeedLimit::along_with_stops(&curves, &limits, &[1]).unwrap();
            for kind in ProfileKind::ALL {
                let arcs = plan_with(&limit, &limits, EndFeeds::default(), kind).unwrap();
                let section = sections(arcs.stages()).next().unwrap();
                let schedule = Schedule::new(section.stages(), 1.0, u64::MAX);
                let before = Before { stages: &[], cursor: schedule.start(), reached: 0.5 };
                let off = Path::new(&limit, &curves).off_stop(&schedule, &before, 10.0);
                assert!((off - 0.5).abs() < 1e-12, "{second} {kind:?}: {off}");
            }
        }
    }

    /// The plan passes the corners of a zigzag. When chords went straight over the corners, the run came to the end
    /// five periods early.
    #[test]
    fn a_run_over_corners_lands_on_its_end() {
        let points = [[0, 0], [1, 0], [1, 1], [2, 1], [2, 0], [3, 0], [3, 1], [4, 1]];
        let curves = polyline(&points.map(|point| point.map(f64::from)));
        let limits = in_periods(2e-3, 150.0, 1500.0, 3e4, 2e-3);
        let limits = KinematicLimits { junction: Junction::Deviation(0.02), ..limits };
        for kind in ProfileKind::ALL {
            let landed = beyond(&curves, &limits, 0.05, kind);
            // The jerk may change a step by J T³, which is 2.4e-4 mm.
            assert!(largest(&landed) < 1e-7, "{kind:?}: {landed:?}");
        }
    }

    /// A corner of 135°; at each of these feeds a step meets it at another place within the step.
    #[test]
    fn a_run_over_a_sharp_corner_lands_wherever_a_step_meets_it() {
        let curves = polyline(&[[0.0, 0.0], [15.7, 0.0], [0.0, 15.7]]);
        let limits = in_periods(2e-3, 150.0, 1500.0, 3e4, 2e-3);
        let limits = KinematicLimits { junction: Junction::Deviation(0.02), ..limits };
        for feed in [3.1e-3, 3.2e-3, 3.332e-3, 3.4e-3, 3.5e-3] {
            for kind in ProfileKind::ALL {
                let landed = beyond(&curves, &limits, feed, kind);
                assert!(largest(&landed) < 4e-9, "{feed} {kind:?}: {landed:?}");
            }
        }
    }

    #[test]
    fn a_run_round_bends_lands_on_its_end() {
        for chord_error in [5e-4, 0.05] {
            let limits = KinematicLimits { chord_error, ..crate::test_paths::paper_limits() };
            let landed = beyond(&[seed_000()], &limits, limits.feedrate, ProfileKind::Cubic);
            assert!(largest(&landed) < 1e-6, "{landed:?}");
        }
    }
}
