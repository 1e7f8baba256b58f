//! Whether a run by chords keeps the acceleration and jerk of the path, and a plan that is slowed down where it does not.
//!
//! The chords of a plan are fitted to its arcs over whole changes of feed. Where the curvature changes within a few periods, an arc is
//! longer than its chord by another amount than the plan has taken off, and the arcs of the run have an acceleration and a jerk of their own.
//! They fall with the third power of the feed or faster, so a section is slowed down by as much as it needs, by 2⁻⁶ at most.

use alloc::vec::Vec;

use nurbs_core::Differentiate;
use real::Real;

use crate::chords::shortfall::Path;
use crate::cube_root::cube_root;
use crate::plan::whole_periods::{MOST_PERIODS, round_up, stretch_section};
use crate::schedule::section;
use crate::{FeedLimit, KinematicLimits, Schedule, ScheduleBuf, Section, sections};

/// How often sections are slowed down, at most.
const TRIALS: usize = 3;
/// Less than 2⁻¹³ above a limit is no excess, for arcs are found to about so much of it. A section that takes more is slowed down to 2⁻¹⁰
/// below the limit.
const SEEN: i32 = -13;
const BELOW: i32 = -10;
/// A section is slowed down by no more than this share in all, 2⁻⁶, and then to whole periods. Where a bend of a few steps would take more, all of the section would pay for
/// it, and the run is left to its judge.
const MOST: i32 = -6;

impl<R: Real> FeedLimit<R> {
    /// The plan `arcs` and the plan [in chords](Self::in_chords), both slowed down in each section in which the arcs of a run by the
    /// chords take more than the acceleration or jerk of `limits`.
    pub(crate) fn kept_by_chords<const D: usize, C: Differentiate<R, D>>(
        &self,
        curves: &[C],
        limits: &KinematicLimits<R>,
        mut arcs: ScheduleBuf<R>,
    ) -> (ScheduleBuf<R>, ScheduleBuf<R>) {
        let mut chords = self.in_chords(curves, &arcs);
        let path = Path::new(self, curves);
        let most = R::one() + R::one().ldexp(MOST);
        let longest: Vec<_> = sections(arcs.stages()).map(|section| section.duration() * most).collect();
        for _ in 0..TRIALS {
            let both = sections(arcs.stages()).zip(sections(chords.stages()));
            let excess = both.zip(&longest).map(|((arcs, chords), longest)| {
                let share = path.excess(&arcs, &chords, limits);
                let takes = arcs.duration() * (R::one() + share);
                if takes > *longest { R::zero() } else { share }
            });
            let excess: Vec<_> = excess.collect();
            if !excess.iter().any(|excess| *excess > R::zero()) {
                break;
            }
            let Some(slower) = slowed(&arcs, &excess) else { break };
            arcs = slower;
            chords = self.in_chords(curves, &arcs);
        }
        (arcs, chords)
    }
}

/// The plan with each section slowed down by these shares at least, to whole periods; `None` where the time is no number or too long.
fn slowed<R: Real>(plan: &ScheduleBuf<R>, shares: &[R]) -> Option<ScheduleBuf<R>> {
    let (mut slower, period) = (plan.clone(), plan.interpolation_period);
    let mut rest = slower.stages.as_mut_slice();
    for share in shares {
        let (stages, behind) = rest.split_at_mut(section::count(rest));
        if *share > R::zero() {
            let duration = stages.iter().fold(R::zero(), |sum, stage| sum + stage.duration);
            let (before, _) = round_up(duration / period - R::one().half())?;
            let taken = stretch_section(stages, *share, period).ok()?;
            slower.periods = slower.periods.saturating_sub(before.into()).saturating_add(taken.into());
        }
        rest = behind;
    }
    Some(slower).filter(|plan| plan.periods <= MOST_PERIODS)
}

impl<R: Real, C: Differentiate<R, D>, const D: usize> Path<'_, R, C, D> {
    /// By which share a section must be slowed down for the arcs of a run by its chords to keep acceleration and jerk; 0 if they do.
    fn excess(&self, arcs: &Section<'_, R>, chords: &Section<'_, R>, limits: &KinematicLimits<R>) -> R {
        let (Some(first), Some(last)) = (arcs.stages().first(), arcs.stages().last()) else {
            return R::zero();
        };
        let (begin, stop) = (first.start, last.start + last.length);
        if !self.limit.bends_over(begin, stop) {
            return R::zero();
        }
        let period = limits.interpolation_period;
        let Some((periods, _)) = round_up(chords.duration() / period - R::one().half()) else {
            return R::zero();
        };
        let chords = Schedule::new(chords.stages(), period, periods.into());
        let mut cursor = chords.start();
        let rounding = if R::IS_FLOATING { R::resolution() * self.limit.length() } else { R::resolution() };
        let (acceleration, jerk) =
            (limits.acceleration * period * period, limits.jerk * period * period * period);
        let mut judged =
            Differences { last: [R::zero(); 2], count: 0, acceleration: R::zero(), jerk: R::zero() };
        if first.start_feed.is_zero() {
            judged.count = 2;
        }
        let (mut reached, mut at) = (begin, begin);
        while let Some(chord) = chords.advance(&mut cursor) {
            let is_last = cursor.stage() >= chords.stages().len();
            reached = if is_last { stop } else { (reached + self.arc_of_step(reached, chord)).min(stop) };
            let length = if is_last { stop } else { self.length_to(reached) };
            // A last step in motion takes the rest of the path, and is not judged.
            if !is_last || last.end_feed.is_zero() {
                judged.add(length - at);
            }
            at = length;
            if is_last {
                break;
            }
        }
        if last.end_feed.is_zero() {
            judged.add(R::zero());
            judged.add(R::zero());
        }
        let hidden = rounding.ldexp(3);
        let over = |found: R, most: R| ((found - hidden) / most - R::one()).max(R::zero());
        let [a, j] = [over(judged.acceleration, acceleration), over(judged.jerk, jerk)];
        let seen = R::one().ldexp(SEEN);
        let to = R::one() + R::one().ldexp(BELOW);
        let by_acceleration = if a > seen { (to + a).sqrt() - R::one() } else { R::zero() };
        let by_jerk = if j > seen { cube_root(to + j) - R::one() } else { R::zero() };
        by_acceleration.max(by_jerk)
    }
}

/// The largest differences of first and second order between successive steps.
struct Differences<R> {
    last: [R; 2],
    count: usize,
    acceleration: R,
    jerk: R,
}

impl<R: Real> Differences<R> {
    fn add(&mut self, step: R) {
        let [before, last] = self.last;
        if self.count > 0 {
            self.acceleration = self.acceleration.max((step - last).abs());
        }
        if self.count > 1 {
            self.jerk = self.jerk.max(((step - last) - (last - before)).abs());
        }
        self.last = [last, step];
        self.count = self.count.saturating_add(1);
    }
}

#[cfg(test)]
mod tests {
    use nurbs_core::NurbsBuf;

    use super::*;
    use crate::test_paths::in_periods;
    use crate::{EndFeeds, Planned, ProfileKind, plan_with};

    /// Waves on a machine whose chords are short beside the chord error that it allows.
    #[test]
    fn the_arcs_of_a_run_keep_the_limits_of_the_path() {
        let limits = in_periods(1e-3, 50.0, 1000.0, 4e4, 1e-3);
        let (mut repaired, mut slower) = (0, 0.0_f64);
        for (scale, height) in [1.0, 2.0, 4.0].into_iter().flat_map(|scale| (1..=8).map(move |h| (scale, h)))
        {
            let height = scale * 0.25 * f64::from(height);
            let point = |i: u32| [scale * f64::from(i), if i.is_multiple_of(2) { height } else { 0.0 }];
            let points: Vec<_> = (0..12).map(point).collect();
            let knots = [0.0; 4].into_iter().chain((1..9).map(f64::from)).chain([9.0; 4]).collect();
            let curve = NurbsBuf::try_new_nonrational(3, points, knots).unwrap();
            let curves = [curve.as_curve()];
            for kind in [ProfileKind::Fastest, ProfileKind::SCurve] {
                let planned = Planned::along(&curves, &limits, EndFeeds::default(), kind).unwrap();
                let excess = |arcs: &ScheduleBuf<f64>, chords: &ScheduleBuf<f64>| {
                    let path = Path::new(&planned.limit, &curves);
                    let both = sections(arcs.stages()).zip(sections(chords.stages()));
                    both.map(|(arcs, chords)| path.excess(&arcs, &chords, &limits)).fold(0.0, f64::max)
                };
                let left = excess(&planned.arcs, &planned.chords);
                let plain = plan_with(&planned.limit, &limits, EndFeeds::default(), kind).unwrap();
                let [after, before] = [&planned.arcs, &plain].map(|plan| plan.as_schedule().periods() as f64);
                let longest = before * (1.0 + 1.0 / 64.0);
                assert!(left == 0.0 || after * (1.0 + left) > longest, "{height} {kind:?}: {left}");
                assert!(after <= longest + 1.0, "{before} {after}");
                if left == 0.0 && excess(&plain, &planned.limit.in_chords(&curves, &plain)) > 0.0 {
                    let duration = planned.arcs.as_schedule().duration();
                    assert!((duration - after).abs() < 1e-9 * duration, "{duration} {after}");
                    (repaired, slower) = (repaired + 1, slower.max(after / before - 1.0));
                }
            }
        }
        assert!(repaired > 2 && slower > 0.0, "{repaired} {slower}");
    }
}
