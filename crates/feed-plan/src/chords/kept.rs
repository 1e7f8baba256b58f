//! A plan whose run by chords keeps what the plan in arcs keeps: the acceleration and jerk of the path, and the chord error.
//!
//! The chords of a plan are fitted to its arcs over whole changes of feed. Where the curvature changes within a few periods, an arc is
//! longer than its chord by another amount than the plan has taken off, and the arcs of the run have an acceleration and a jerk of their own.
//! They fall with the third power of the feed or faster, so a section is slowed down by as much as it needs, by 2⁻⁶ at most.
//!
//! The feed at which a chord leaves the path by what is allowed is found from the radius at one place. Where the radius changes within the
//! chord, the chord may leave the path further. The limit is lowered there, and the section is planned again.

use alloc::vec::Vec;

use nurbs_core::Differentiate;
use real::Real;

use crate::chords::followed::{Followed, LongChord};
use crate::chords::lead::Lead;
use crate::chords::shortfall::Path;
use crate::plan::whole_periods::{MOST_PERIODS, round_up, stretch_section};
use crate::schedule::section;
use crate::{FeedLimit, KinematicLimits, PlanError, ScheduleBuf, sections};

/// How often a path is planned again or slowed down, at most.
const TRIALS: usize = 6;
/// A section is slowed down by no more than this share in all, 2⁻⁶, and then to whole periods. Where a bend of a few steps would take more, all of the section would pay for
/// it, and the run is left to its judge.
const MOST: i32 = -6;

/// A plan in arcs with its chords, by how much the run of each section is ahead, and whether the plan was changed for its run.
pub(crate) struct Kept<R> {
    pub(crate) arcs: ScheduleBuf<R>,
    pub(crate) chords: ScheduleBuf<R>,
    pub(crate) leads: Vec<Lead<R>>,
    pub(crate) is_changed: bool,
}

/// The plan `arcs` and its chords, planned again under a lower limit where chords are too long, and slowed down where the run's arcs take
/// more than the acceleration or jerk of `limits`. `plan_again` plans the sections of these chords under the lower limit, and leaves others
/// as they are in the plan that it is given.
pub(crate) fn kept<R: Real, C: Differentiate<R, D>, const D: usize>(
    limit: &FeedLimit<R>,
    mut arcs: ScheduleBuf<R>,
    curves: &[C],
    limits: &KinematicLimits<R>,
    plan_again: impl Fn(&FeedLimit<R>, &ScheduleBuf<R>, &[LongChord<R>]) -> Result<ScheduleBuf<R>, PlanError>,
) -> Result<Kept<R>, PlanError> {
    let mut longest = most_of(&arcs);
    let mut lowered: Option<FeedLimit<R>> = None;
    for trial in 0.. {
        let (chords, followed) = limit.followed(curves, &arcs, limits);
        let leads = followed.iter().map(|one| one.lead).collect();
        let kept = |arcs, chords| Ok(Kept { arcs, chords, leads, is_changed: trial > 0 });
        if trial == TRIALS {
            return kept(arcs, chords);
        }
        let long: Vec<_> = followed.iter().flat_map(|one| one.long.iter().copied()).collect();
        if !long.is_empty() {
            let lowered = lowered.get_or_insert_with(|| limit.clone());
            long.iter().for_each(|chord| lowered.lower_bends(chord.from, chord.to, chord.feed));
            arcs = plan_again(lowered, &arcs, &long)?;
            longest = most_of(&arcs);
            continue;
        }
        let durations = sections(arcs.stages()).map(|section| section.duration());
        let share = |((duration, one), longest): ((R, &Followed<R>), &R)| {
            let takes = duration * (R::one() + one.excess);
            if takes > *longest { R::zero() } else { one.excess }
        };
        let shares: Vec<_> = durations.zip(&followed).zip(&longest).map(share).collect();
        let is_slow = !shares.iter().any(|share| *share > R::zero());
        match slowed(&arcs, &shares).filter(|_| !is_slow) {
            Some(slower) => arcs = slower,
            None => return kept(arcs, chords),
        }
    }
    Err(PlanError::DurationOverflows)
}

impl<R: Real> Kept<R> {
    /// Of each section the one of both plans that takes less time, this one if both take the same. Both rest at the same places.
    pub(crate) fn faster_by_sections(self, other: Self) -> Self {
        if self.leads.len() != other.leads.len() {
            return self;
        }
        let period = self.arcs.interpolation_period;
        let mut found = Self {
            arcs: ScheduleBuf { stages: Vec::new(), periods: 0, ..self.arcs },
            chords: ScheduleBuf { stages: Vec::new(), periods: 0, ..self.chords },
            leads: Vec::with_capacity(self.leads.len()),
            is_changed: true,
        };
        let [own, others] = [&self, &other].map(|plan| {
            let both = sections(plan.arcs.stages()).zip(sections(plan.chords.stages()));
            both.zip(plan.leads.iter().copied())
        });
        for (own, other) in own.zip(others) {
            let ((arcs, chords), lead) = if other.0.0.duration() < own.0.0.duration() { other } else { own };
            let taken = round_up(arcs.duration() / period - R::one().half());
            let taken = taken.map_or(0, |(periods, _)| u64::from(periods));
            for (plan, section) in [(&mut found.arcs, arcs), (&mut found.chords, chords)] {
                plan.stages.extend_from_slice(section.stages());
                plan.periods = plan.periods.saturating_add(taken);
            }
            found.leads.push(lead);
        }
        found
    }

    /// By how much the run is ahead at most.
    pub(crate) fn lead(&self) -> Lead<R> {
        self.leads.iter().fold(Lead::none(), |most, lead| most.max(*lead))
    }
}

/// What each section may take at most.
fn most_of<R: Real>(plan: &ScheduleBuf<R>) -> Vec<R> {
    let most = R::one() + R::one().ldexp(MOST);
    sections(plan.stages()).map(|section| section.duration() * most).collect()
}

impl<R: Real> FeedLimit<R> {
    /// The plan [in chords](Self::in_chords), and what its run does in each section.
    fn followed<const D: usize, C: Differentiate<R, D>>(
        &self,
        curves: &[C],
        arcs: &ScheduleBuf<R>,
        limits: &KinematicLimits<R>,
    ) -> (ScheduleBuf<R>, Vec<Followed<R>>) {
        let chords = self.in_chords(curves, arcs);
        let path = Path::new(self, curves);
        let both = sections(arcs.stages()).zip(sections(chords.stages()));
        let followed = both.filter_map(|(arcs, chords)| path.followed([&arcs, &chords], limits)).collect();
        (chords, followed)
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
                    both.map(|(arcs, chords)| path.followed([&arcs, &chords], &limits).unwrap().excess)
                        .fold(0.0, f64::max)
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
