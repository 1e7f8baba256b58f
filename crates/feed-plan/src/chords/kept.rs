//! A plan whose run by chords keeps what the plan in arcs keeps: the acceleration and jerk of the path and of its axes, and the chord error.
//!
//! The chords of a plan are fitted to its arcs over whole changes of feed. Where the curvature changes within a few periods, an arc is
//! longer than its chord by another amount than the plan has taken off, and the arcs of the run have an acceleration and a jerk of their own.
//! They fall with the third power of the feed or faster, so a section is slowed down by as much as it needs, by 2⁻⁶ at most. Where it needs
//! more, it is planned again with lower feeds there that change more slowly.
//!
//! The feed at which a chord leaves the path by what is allowed is found from the radius at one place. Where the radius changes within the
//! chord, the chord may leave the path further. The limit is lowered there, and the section is planned again. So it is where the setpoints
//! show that an axis takes too much, as where the feed changes on a bend of short moves. Where that does not help, the section is slowed
//! down in the end.

use alloc::vec::Vec;

use nurbs_core::Differentiate;
use real::Real;

use crate::chords::followed::Followed;
use crate::chords::lead::Lead;
use crate::chords::shortfall::Path;
use crate::limit::too_fast::TooFast;
use crate::plan::whole_periods::{MOST_PERIODS, periods_taken, stretch_section};
use crate::schedule::section;
use crate::schedule::stage::duration;
use crate::{FeedLimit, KinematicLimits, ScheduleBuf, Section, sections};

/// Trials in which sections are planned again or slowed down, at most.
const TRIALS: usize = 10;
/// Sections are planned again in the first of them alone, so many.
const LOWERINGS: usize = 6;
/// In the first two, also where the arcs of the run take too much, if slowing down would cost more than 2⁻⁹ of the time: less is not worth
/// another solution.
const STRAINS: usize = 2;
const WORTH: i32 = -9;
/// Lower feeds that take 2⁻⁴ of a section's time cost little.
const LITTLE: i32 = -4;
/// Floats of a finer resolution than 2⁻⁴⁰ take arcs exactly enough to tell a bend from their rounding, which f32 did not.
const EXACT: i32 = -40;
/// A section is slowed down by no more than this share in all, 2⁻⁶, and then to whole periods. Where a bend of a few steps would take more,
/// all of the section would pay for it, and the section is planned again for the bend alone.
const MOST: i32 = -6;
/// Where lower feeds do not cure chords that are too long, or what an axis takes, all of the section is slowed down in the end, by a quarter
/// in each trial at most: a limit that is kept is worth the time.
const MOST_IN_THE_END: i32 = -2;

/// A plan in arcs with its chords, and what is known of the run of each section.
pub(crate) struct Kept<R> {
    pub(crate) arcs: ScheduleBuf<R>,
    pub(crate) chords: ScheduleBuf<R>,
    sections: Vec<KeptSection<R>>,
    /// Whether the plan was changed for its run.
    is_changed: bool,
}

#[derive(Clone, Copy)]
struct KeptSection<R> {
    lead: Lead<R>,
    /// Whether the run keeps what it is followed for.
    is_kept: bool,
}

/// The plan `arcs` and its chords. A section is planned again under a lower limit where its chords are too long or an axis takes too much,
/// and slowed down where the arcs of its run take more than the acceleration or jerk of `limits`, or planned again where that takes too long;
/// where it can be planned `by_strain`, it is so first, with less of them where they take too much. `plan_again` plans the sections of these
/// ways, if it can, and may leave others as they are in the plan that it is given.
pub(crate) fn kept<R: Real, C: Differentiate<R, D>, const D: usize>(
    limit: &FeedLimit<R>,
    arcs: ScheduleBuf<R>,
    curves: &[C],
    limits: &KinematicLimits<R>,
    by_strain: bool,
    plan_again: impl Fn(&FeedLimit<R>, &ScheduleBuf<R>, &[TooFast<R>]) -> Option<ScheduleBuf<R>>,
) -> Kept<R> {
    let (chords, followed) = limit.followed(curves, &arcs, limits);
    let mut repaired = Repaired::of(arcs, chords, followed);
    let mut lowered: Option<FeedLimit<R>> = None;
    let mut trial = 0;
    while trial < TRIALS {
        let tries = repaired.tries(trial, by_strain && trial < STRAINS);
        let before = tries.contains(&Again::StrainedAndSlower).then(|| lowered.clone()).flatten();
        let ways = |counts: &dyn Fn(usize) -> bool| ways(&repaired.followed, &tries, counts);
        let again = tries.iter().any(|again| *again != Again::No).then(|| {
            let (lowered, ways) = (lowered.get_or_insert_with(|| limit.clone()), ways(&|_| true));
            lowered.lower_over(&ways);
            plan_again(lowered, &repaired.found, &ways)
        });
        let next = repaired.next(again.flatten(), &tries, trial);
        // Where no lower feeds change a section, it is slowed down at once.
        trial = if next.is_some() { trial + 1 } else { LOWERINGS.max(trial + 1) };
        let Some((next, changed)) = next else { continue };
        // The other sections are followed already.
        let mut part = ScheduleBuf { stages: Vec::new(), periods: 0, ..next };
        wanted(&next, &changed).for_each(|section| part.push(&section));
        let (chords_of_part, followed_again) = limit.followed(curves, &part, limits);
        let taken = helped([&repaired.found, &next], [&repaired.followed, &followed_again], &changed, &tries);
        if taken != changed {
            let mut again = before.unwrap_or_else(|| limit.clone());
            again.lower_over(&ways(&|section| taken[section]));
            lowered = Some(again);
        }
        repaired.take(&next, &chords_of_part, followed_again, [&changed, &taken], &tries);
    }
    repaired.kept()
}

/// A plan that is repaired section by section.
struct Repaired<R> {
    found: ScheduleBuf<R>,
    chords: ScheduleBuf<R>,
    followed: Vec<Followed<R>>,
    /// The longest time that each section may take once it is slowed down.
    longest: Vec<R>,
    /// Whether lower feeds did not help a section.
    in_vain: Vec<bool>,
    is_changed: bool,
}

impl<R: Real> Repaired<R> {
    fn of(arcs: ScheduleBuf<R>, chords: ScheduleBuf<R>, followed: Vec<Followed<R>>) -> Self {
        let (longest, in_vain) = (most_of(&arcs), followed.iter().map(|_| false).collect());
        Self { found: arcs, chords, followed, longest, in_vain, is_changed: false }
    }

    /// Whether each section takes too long if it is slowed down by as much as it needs.
    fn too_long(&self) -> impl Iterator<Item = bool> {
        let sections = sections(self.found.stages()).zip(&self.followed).zip(&self.longest);
        sections.map(|((section, one), longest)| section.duration() * (R::one() + one.excess) > *longest)
    }

    /// The reason for which each section is planned again in this trial. A section that the last of these trials does not cure stays as it
    /// is, and the judge of the run tells it.
    fn tries(&self, trial: usize, by_strain: bool) -> Vec<Again> {
        let sections = self.followed.iter().zip(self.too_long()).zip(&self.in_vain);
        sections.map(|((one, too_long), in_vain)| one.tries(trial, by_strain, too_long && !in_vain)).collect()
    }

    /// The plan in which `again` replaces the sections that were planned again, and others are slowed down; and which sections differ from
    /// those found so far. `None` if no section differs.
    fn next(
        &self,
        again: Option<ScheduleBuf<R>>,
        tries: &[Again],
        trial: usize,
    ) -> Option<(ScheduleBuf<R>, Vec<bool>)> {
        let again = again.filter(|again| sections(again.stages()).count() == tries.len());
        // No section that is to be planned again is slowed down in the same trial.
        let is_again: Vec<_> = tries.iter().map(|again| *again != Again::No).collect();
        let share = |((one, too_long), is_again): ((&Followed<R>, bool), &bool)| {
            let of_arcs = if too_long || *is_again { R::zero() } else { one.excess };
            if trial < LOWERINGS { of_arcs } else { of_arcs.max(one.slower_in_the_end()) }
        };
        let shares: Vec<_> = self.followed.iter().zip(self.too_long()).zip(&is_again).map(share).collect();
        let slower = slowed(&self.found, &shares);
        if slower.is_none() && again.is_none() {
            return None;
        }
        let others = slower.unwrap_or_else(|| self.found.clone());
        let next = match &again {
            Some(again) => spliced(&others, wanted(again, &is_again), &is_again),
            None => others,
        };
        let both = sections(self.found.stages()).zip(sections(next.stages()));
        let changed: Vec<_> = both.map(|(a, b)| a.stages() != b.stages()).collect();
        changed.contains(&true).then_some((next, changed))
    }

    /// Replaces the sections that are `taken` by those of the next plan. `chords` and `followed` hold the `changed` sections alone.
    fn take(
        &mut self,
        next: &ScheduleBuf<R>,
        chords: &ScheduleBuf<R>,
        followed: Vec<Followed<R>>,
        [changed, taken]: [&[bool]; 2],
        tries: &[Again],
    ) {
        let of_changed = || changed.iter().zip(taken).filter(|(is_changed, _)| **is_changed);
        let taken_of_changed: Vec<_> = of_changed().map(|(_, is_taken)| *is_taken).collect();
        self.chords = restarted(spliced(&self.chords, wanted(chords, &taken_of_changed), taken));
        self.found = spliced(&self.found, wanted(next, taken), taken);
        self.is_changed |= taken.contains(&true);
        let mut followed = followed.into_iter();
        let all = self.followed.iter_mut().zip(&mut self.in_vain).zip(&mut self.longest);
        let all = all.zip(most_of(next)).zip(changed.iter().zip(taken).zip(tries));
        for ((((own, in_vain), longest), most), ((is_changed, is_taken), again)) in all {
            let one = if *is_changed { followed.next() } else { None };
            match one {
                Some(one) if *is_taken => {
                    *own = one;
                    if *again != Again::No {
                        *longest = most;
                    }
                }
                Some(_) => *in_vain = true,
                None => {}
            }
        }
    }

    fn kept(self) -> Kept<R> {
        let section = |one: &Followed<R>| KeptSection {
            lead: one.lead,
            is_kept: one.too_fast.is_empty() && !one.has_excess(),
        };
        let sections = self.followed.iter().map(section).collect();
        Kept { arcs: self.found, chords: self.chords, sections, is_changed: self.is_changed }
    }
}

/// Whether a section is planned again in a trial, and what for.
#[derive(Clone, Copy, PartialEq)]
enum Again {
    No,
    /// For its chords or the axes alone.
    TooFast,
    /// With feeds that change more slowly where the arcs of the run take too much.
    Strained,
    /// And at lower feeds there.
    StrainedAndSlower,
}

impl<R: Real> Followed<R> {
    /// What a section is planned again for in this trial, if that can be done. Where its arcs take so much that slowing it down would take
    /// `too_long`, it is planned again in any case. Except in fixed point and in f32, where that much may be the rounding of the arcs.
    fn tries(&self, trial: usize, by_strain: bool, too_long: bool) -> Again {
        let is_trial = trial < LOWERINGS;
        let is_exact = R::IS_FLOATING && R::resolution() < R::one().ldexp(EXACT);
        if self.has_excess() && by_strain {
            Again::Strained
        } else if self.has_excess() && is_trial && too_long && is_exact {
            Again::StrainedAndSlower
        } else if is_trial && !self.too_fast.is_empty() {
            Again::TooFast
        } else {
            Again::No
        }
    }

    /// The share by which the section is slowed down where lower feeds have not cured the ways that are passed too fast; none where it would
    /// be too much.
    fn slower_in_the_end(&self) -> R {
        let longest = self.too_fast.iter().fold(R::one(), |longest, way| longest.max(way.longer));
        let share = longest - R::one();
        if share > R::one().ldexp(MOST_IN_THE_END) { R::zero() } else { share }
    }

    /// The ways over which the arcs of the run take too much, as they are to be passed in this trial.
    fn strained_ways(&self, again: Again) -> impl Iterator<Item = &TooFast<R>> {
        let (changes, steps) = match again {
            Again::No | Again::TooFast => (None, None),
            Again::Strained => (Some(&self.strained), None),
            Again::StrainedAndSlower => (Some(&self.strained), Some(&self.strained_steps)),
        };
        changes.into_iter().chain(steps).flatten()
    }

    /// Whether a section takes so much too much that it is worth another plan; less may be rounding in a coarse format.
    fn has_excess(&self) -> bool {
        self.excess > R::one().ldexp(WORTH)
    }
}

/// The ways of the sections for which `counts` is true: those that are passed too fast, and those over which the arcs take too much.
fn ways<R: Real>(
    followed: &[Followed<R>],
    tries: &[Again],
    counts: &dyn Fn(usize) -> bool,
) -> Vec<TooFast<R>> {
    let of = followed.iter().zip(tries).enumerate().filter(|(section, _)| counts(*section));
    of.flat_map(|(_, (one, again))| one.too_fast.iter().chain(one.strained_ways(*again))).copied().collect()
}

/// Whether each section is replaced by its changed form. `followed` has the findings of all sections before the change, and `followed_again`
/// those of the changed sections.
fn helped<R: Real>(
    [before, after]: [&ScheduleBuf<R>; 2],
    [followed, followed_again]: [&[Followed<R>]; 2],
    changed: &[bool],
    tries: &[Again],
) -> Vec<bool> {
    let mut taken = changed.to_vec();
    let both = sections(before.stages()).zip(sections(after.stages())).zip(followed.iter().zip(tries));
    let changed = both.zip(&mut taken).filter(|(_, is_taken)| **is_taken);
    for ((((before, after), (was, again)), is_taken), is) in changed.zip(followed_again) {
        let durations = [before.duration(), after.duration()];
        *is_taken = *again != Again::StrainedAndSlower || is_worth_it([was.excess, is.excess], durations);
    }
    taken
}

/// Whether a section is replaced by its plan at lower feeds: if that takes little more time, or what its arcs take too much falls by a
/// quarter. What lower feeds do not cure would make each plan many times longer than the one before.
fn is_worth_it<R: Real>([before, after]: [R; 2], [taken, takes]: [R; 2]) -> bool {
    takes <= taken + taken.ldexp(LITTLE) || after < before - before.ldexp(-2)
}

/// The sections of a plan for which that is said.
fn wanted<'a, R: Real>(
    plan: &'a ScheduleBuf<R>,
    is_wanted: &'a [bool],
) -> impl Iterator<Item = Section<'a, R>> {
    sections(plan.stages()).zip(is_wanted).filter_map(|(section, is_wanted)| is_wanted.then_some(section))
}

/// A plan with the next of other sections in the place of each section for which that is said.
fn spliced<'a, R: Real>(
    plan: &'a ScheduleBuf<R>,
    mut others: impl Iterator<Item = Section<'a, R>>,
    is_other: &[bool],
) -> ScheduleBuf<R> {
    let mut found = ScheduleBuf { stages: Vec::with_capacity(plan.stages().len()), periods: 0, ..*plan };
    for (own, is_other) in sections(plan.stages()).zip(is_other) {
        let other = if *is_other { others.next() } else { None };
        found.push(&other.unwrap_or(own));
    }
    found
}

/// A plan in chords whose stages begin where the sums of those before them end.
fn restarted<R: Real>(plan: ScheduleBuf<R>) -> ScheduleBuf<R> {
    plan.by_sections(&[], |stages, _| stages.to_vec())
}

impl<R: Real> ScheduleBuf<R> {
    /// Adds a section of whole periods.
    fn push(&mut self, section: &Section<'_, R>) {
        self.stages.extend_from_slice(section.stages());
        self.periods = self.periods.saturating_add(periods_of(section, self.interpolation_period).into());
    }
}

/// The whole periods that a section takes.
fn periods_of<R: Real>(section: &Section<'_, R>, period: R) -> u32 {
    periods_taken(section.duration(), period).unwrap_or(0)
}

impl<R: Real> Kept<R> {
    /// Of each section the one of both plans that takes fewer periods, if its run is kept like the other's. Both rest at the same places.
    pub(crate) fn faster_by_sections(self, other: Self) -> Self {
        self.with_sections_of(other, |own, other, is_faster| is_faster && (other || !own))
    }

    /// Of each section the one of both plans whose run is kept, or if that says nothing, the one that takes fewer periods.
    pub(crate) fn better_by_sections(self, other: Self) -> Self {
        self.with_sections_of(other, |own, other, is_faster| if own == other { is_faster } else { other })
    }

    /// Of each section the other plan's where that is said by whether both runs are kept and the other takes fewer periods.
    fn with_sections_of(self, other: Self, is_better: impl Fn(bool, bool, bool) -> bool) -> Self {
        let period = self.arcs.interpolation_period;
        let periods = |plan: &Self| -> Vec<_> {
            sections(plan.arcs.stages()).map(|section| periods_of(&section, period)).collect()
        };
        let [own, others] = [&self, &other].map(periods);
        let both = own.iter().zip(&others).zip(self.sections.iter().zip(&other.sections));
        let is_other: Vec<_> = both
            .map(|((own, others), (section, other))| is_better(section.is_kept, other.is_kept, others < own))
            .collect();
        if own.len() != others.len() || !is_other.iter().any(|is_other| *is_other) {
            return self;
        }
        let section = |((own, other), is_other): ((&KeptSection<R>, &KeptSection<R>), &bool)| {
            if *is_other { *other } else { *own }
        };
        Self {
            arcs: spliced(&self.arcs, wanted(&other.arcs, &is_other), &is_other),
            chords: restarted(spliced(&self.chords, wanted(&other.chords, &is_other), &is_other)),
            sections: self.sections.iter().zip(&other.sections).zip(&is_other).map(section).collect(),
            is_changed: true,
        }
    }

    /// Whether the plan was changed for its run, or would have to be.
    pub(crate) fn is_in_question(&self) -> bool {
        self.is_changed || self.sections.iter().any(|section| !section.is_kept)
    }

    /// By how much the run is ahead at most.
    pub(crate) fn lead(&self) -> Lead<R> {
        self.sections.iter().fold(Lead::none(), |most, section| most.max(section.lead))
    }
}

/// The longest time that each section may take once it is slowed down.
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

/// The plan with each section slowed down by these shares at least, to whole periods; `None` where none is, or where the time is no number
/// or too long.
fn slowed<R: Real>(plan: &ScheduleBuf<R>, shares: &[R]) -> Option<ScheduleBuf<R>> {
    if shares.iter().all(R::is_zero) {
        return None;
    }
    let (mut slower, period) = (plan.clone(), plan.interpolation_period);
    let mut rest = slower.stages.as_mut_slice();
    for share in shares {
        let (stages, behind) = rest.split_at_mut(section::count(rest));
        if *share > R::zero() {
            let before = periods_taken(duration(stages), period)?;
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
    use crate::limit::track::arc;
    use crate::test_paths::{hashed, in_periods, in_range, polyline};
    use crate::{AxisLimits, EndFeeds, Junction, Planned, ProfileKind, plan_with};

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
                let at_first = excess(&plain, &planned.limit.in_chords(&curves, &plain));
                assert!(left < 1.0 / 512.0, "{height} {kind:?}: {left}");
                assert!(after <= longest + 1.0 || at_first > 1.0 / 64.0, "{before} {after}");
                if left == 0.0 && at_first > 0.0 && at_first < 1.0 / 64.0 {
                    let duration = planned.arcs.as_schedule().duration();
                    assert!((duration - after).abs() < 1e-9 * duration, "{duration} {after}");
                    (repaired, slower) = (repaired + 1, slower.max(after / before - 1.0));
                }
            }
        }
        assert!(repaired > 2 && slower > 0.0, "{repaired} {slower}");
    }

    /// Circles of short moves that end at rest: while the feed falls on a bend, its fall and the bend take of an axis' jerk together.
    #[test]
    fn setpoints_keep_the_limits_of_axes_along_short_moves() {
        let axis = AxisLimits { velocity: Some(0.3), acceleration: Some(1e-3), jerk: Some(1e-5) };
        let junction = Junction::Deviation(0.01);
        let limits =
            KinematicLimits { junction, axes: [axis; 3], ..in_periods(1e-3, 60.0, 1000.0, 1e4, 1e-3) };
        let mut repaired = 0;
        for radius in [2.0, 3.5, 5.0, 9.0] {
            let arc = arc(radius, 0.3, 3.0);
            let end = arc[arc.len() - 1];
            let straight = [[end[0], end[1] + 4.0], [end[0] - 12.0, end[1] + 4.0]];
            let points: Vec<_> =
                arc.iter().copied().chain(straight).chain(arc.iter().map(|[x, y]| [-x, -y])).collect();
            let curves = polyline(&points);
            let curves: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
            let stops = [arc.len() - 1, arc.len(), arc.len() + 1, arc.len() + 2];
            for kind in [ProfileKind::Fastest, ProfileKind::SCurve] {
                let limit = FeedLimit::along_with_stops(&curves, &limits, &stops).unwrap();
                let plain = plan_with(&limit, &limits, EndFeeds::default(), kind).unwrap();
                let planned = Planned::under(limit, &curves, &limits, EndFeeds::default(), kind).unwrap();
                let too_fast = |arcs: &ScheduleBuf<f64>, chords: &ScheduleBuf<f64>| {
                    let path = Path::new(&planned.limit, &curves);
                    let both = sections(arcs.stages()).zip(sections(chords.stages()));
                    both.filter(|(arcs, chords)| {
                        !path.followed([arcs, chords], &limits).unwrap().too_fast.is_empty()
                    })
                    .count()
                };
                assert!(sections(planned.arcs.stages()).count() > 2);
                assert_eq!(too_fast(&planned.arcs, &planned.chords), 0, "radius {radius}, {kind:?}");
                repaired += too_fast(&plain, &planned.limit.in_chords(&curves, &plain));
                // Sections that were followed again have the chords that they would have had at once.
                let at_once = planned.limit.in_chords(&curves, &planned.arcs);
                assert_eq!(at_once.stages().len(), planned.chords.stages().len());
                let off = at_once
                    .stages()
                    .iter()
                    .zip(planned.chords.stages())
                    .map(|(a, b)| (a.length - b.length).abs());
                assert!(off.fold(0.0, f64::max) < 1e-9);
                let [after, before] = [&planned.arcs, &plain].map(|plan| plan.as_schedule().periods() as f64);
                assert!(after <= 1.2 * before, "radius {radius}, {kind:?}: {before} {after}");
            }
        }
        assert!(repaired > 2, "{repaired}");
    }

    /// The last corner is so near to the end that the tool brakes from it on. The corner alone takes three quarters of the jerk that its
    /// turn may take of an axis: slower changes of feed did not bring both below it in six trials.
    #[test]
    fn a_corner_from_which_the_tool_brakes_is_passed_more_slowly() {
        let axis = AxisLimits { velocity: Some(0.3), acceleration: Some(1e-3), jerk: Some(1e-5) };
        let junction = Junction::Deviation(0.01);
        let limits =
            KinematicLimits { junction, axes: [axis; 3], ..in_periods(1e-3, 25.0, 1000.0, 1e4, 1e-3) };
        let bend = [[0.7, 2.0], [0.0, 0.62], [0.19, 0.14], [0.05, 0.0]];
        let hatch = [[1.12, -0.21], [0.6, -0.06], [0.44, -0.23], [0.09, 0.09], [0.0, 0.0]];
        for points in [&bend[..], &hatch] {
            let curves = polyline(points);
            let curves: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
            let too_fast = |limit: &FeedLimit<f64>, arcs: &ScheduleBuf<f64>| {
                let (_, followed) = limit.followed(&curves, arcs, &limits);
                followed.iter().filter(|one| !one.too_fast.is_empty()).count()
            };
            for kind in [ProfileKind::Fastest, ProfileKind::SCurve] {
                let planned = Planned::along(&curves, &limits, EndFeeds::default(), kind).unwrap();
                let plain = plan_with(&planned.limit, &limits, EndFeeds::default(), kind).unwrap();
                assert!(too_fast(&planned.limit, &plain) > 0, "{points:?} {kind:?}");
                assert_eq!(too_fast(&planned.limit, &planned.arcs), 0, "{points:?} {kind:?}");
                let [after, before] = [&planned.arcs, &plain].map(|plan| plan.as_schedule().periods() as f64);
                assert!(after <= 1.06 * before, "{points:?} {kind:?}: {before} {after}");
            }
        }
    }

    /// Parabolas with apexes so sharp that the arcs of steps of like chords differ by more than the jerk, and slowing down all of the section
    /// for it would take too long: such a section was left as it was.
    #[test]
    fn a_sharp_bend_on_a_long_way_is_passed_more_slowly() {
        let limits = in_periods(1e-3, 50.0, 1000.0, 4e4, 1e-3);
        for [width, height] in [[60.0, 1.5], [30.0, 0.8], [40.0, 0.8]] {
            let points = vec![[0.0, 0.0], [width, height], [0.0, 3.0 * height]];
            let curve = NurbsBuf::try_new_nonrational(2, points, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0]).unwrap();
            let curves = [curve.as_curve()];
            for kind in [ProfileKind::SCurve, ProfileKind::Fastest, ProfileKind::Cubic] {
                let planned = Planned::along(&curves, &limits, EndFeeds::default(), kind).unwrap();
                let plain = plan_with(&planned.limit, &limits, EndFeeds::default(), kind).unwrap();
                let [left, excess] = [&planned.arcs, &plain].map(|arcs| {
                    let (_, followed) = planned.limit.followed(&curves, arcs, &limits);
                    followed.iter().map(|one| one.excess).fold(0.0, f64::max)
                });
                let [after, before] = [&planned.arcs, &plain].map(|plan| plan.as_schedule().periods() as f64);
                assert!(excess > 1.0 / 64.0 && left < 1.0 / 512.0, "{width} {kind:?}: {excess} {left}");
                assert!(after <= 1.1 * before, "{width} {kind:?}: {before} {after}");
            }
        }
    }

    /// On a path of the soak lower feeds left the excess as it was, and each plan took ten times as long as the one before.
    #[test]
    fn a_section_that_lower_feeds_do_not_cure_is_left_to_its_judge() {
        assert!(is_worth_it([6.75, 4.0], [405.0, 2838.0]) && is_worth_it([0.03, 0.031], [379.0, 380.0]));
        assert!(!is_worth_it([6.75, 6.75], [405.0, 2838.0]));
    }

    /// Rounding of f32 is more than a 256th of the chord error here: nearly every plan was lowered for it, by up to 5 % of its time.
    #[test]
    fn rounding_is_no_long_chord() {
        let (mut periods, mut before) = (0, 0);
        for seed in 0..12_u64 {
            let share = |i: u64, bits: u32| f64::from(hashed(100 * seed + i) >> bits & 0xff) / 256.0;
            let mut at = [90.0, 100.0];
            let points: Vec<_> = (0..14)
                .map(|i| {
                    at = [at[0] + 12.0 * (share(i, 0) - 0.3), at[1] + 12.0 * (share(i, 8) - 0.5)];
                    at
                })
                .collect();
            let inner = (1..11).map(f64::from);
            let knots = [0.0; 4].into_iter().chain(inner).chain([11.0; 4]).collect();
            let curve = NurbsBuf::try_new_nonrational(3, points, knots).unwrap().convert::<f32>().unwrap();
            let limits = in_range::<f32>(&in_periods(3e-3, 200.0, 5000.0, 4e5, 5e-4));
            let planned =
                Planned::along(&[curve.as_curve()], &limits, EndFeeds::default(), ProfileKind::SCurve)
                    .unwrap();
            let plain = plan_with(&planned.limit, &limits, EndFeeds::default(), ProfileKind::SCurve).unwrap();
            periods += planned.arcs.as_schedule().periods();
            before += plain.as_schedule().periods();
        }
        assert!(periods <= before + before / 500, "{periods} for {before}");
    }
}
