//! A run by chords followed period by period beside its plan in arcs: how far it is ahead, what its arcs take of acceleration and jerk,
//! which of its chords leave the path too far, and where an axis takes too much.

use alloc::vec::Vec;

use nurbs_core::Differentiate;
use real::Real;

use crate::chords::axis_windows::{AxisWindows, SPAN, Setpoint};
use crate::chords::lead::Lead;
use crate::chords::shortfall::Path;
use crate::chords::steps::Step;
use crate::cube_root::cube_root;
use crate::limit::axis_budget::Allowance;
use crate::limit::too_fast::{Slower, TooFast};
use crate::limit::vector::{across, difference};
use crate::{KinematicLimits, Section};

/// An excess of less than 2⁻¹³ of a limit is ignored: the lengths of arcs are that uncertain. A section that takes more is slowed down to
/// 2⁻¹⁰ below the limit.
const SEEN: i32 = -13;
const BELOW: i32 = -10;
/// A chord is too long where it leaves the path by more than 2⁻⁸ above what is allowed.
const LONG: i32 = -8;
/// Points, and what is taken from them, are off by no more than 2³ roundings of the path's largest length.
const ROUNDING: i32 = 3;
/// Setpoints that are kept at once: a long section is looked at in parts, which overlap by the widest window.
const MOST_SEEN: usize = 1 << 14;
/// Places of a chord at which its distance from the path is looked at.
const PLACES: i32 = 8;

/// The findings about the run of a section.
#[derive(Clone, Debug)]
pub(super) struct Followed<R> {
    pub(super) lead: Lead<R>,
    /// The share by which the section must be slowed down for the arcs of the run to keep acceleration and jerk; 0 if they do.
    pub(super) excess: R,
    /// The chords that leave the path too far, and the ways over which an axis takes too much.
    pub(super) too_fast: Vec<TooFast<R>>,
    /// The ways over which the arcs of the run take more than the acceleration or jerk of the path, to be passed with feeds that change more
    /// slowly.
    pub(super) strained: Vec<TooFast<R>>,
    /// The same in threes of steps, to be passed at lower feeds: where a bend makes arcs of like chords differ, only these help.
    pub(super) strained_steps: Vec<TooFast<R>>,
}

impl<R: Real, C: Differentiate<R, D>, const D: usize> Path<'_, R, C, D> {
    /// Follows a section's run by its chords; `both` are the section in arcs and in chords.
    pub(super) fn followed(
        &self,
        both: [&Section<'_, R>; 2],
        limits: &KinematicLimits<R>,
    ) -> Option<Followed<R>> {
        let stages = both[0].stages();
        let (first, last) = (stages.first()?, stages.last()?);
        let (begin, stop) = (first.start, last.start + last.length);
        let rests = [first.start_feed, last.end_feed].map(|feed| feed.is_zero());
        let mut lead = Lead::none();
        let mut too_fast = Vec::new();
        let rounding = if R::IS_FLOATING { R::resolution() * self.limit.length() } else { R::resolution() };
        let mut judged = Differences::after(rests[0], limits, rounding.ldexp(ROUNDING));
        let mut begins_at_rest = rests[0];
        let windows = |setpoints: &[Setpoint<R, D>], rests| {
            let rounding = self.rounding_of(&self.leaving(begin));
            AxisWindows { setpoints, rests, rounding, limits }.too_fast()
        };
        let mut seen = limits.limit_accelerations_of_axes(D).then(|| Vec::from([self.beginning_at(begin)]));
        let within = stop - self.limit.rounding();
        if self.limit.bends_over(begin, stop) || (seen.is_some() && self.passes_corner(begin, within)) {
            let mut at = begin;
            self.each_step(both, limits.interpolation_period, |step| {
                lead.see(&step);
                let length = if step.is_last { stop } else { self.length_to(step.to) };
                // A last step in motion takes the rest of the path, and is not judged.
                if !step.is_last || rests[1] {
                    judged.add(length - at, length, limits);
                    too_fast.extend(self.long_chord(&step, length - at, limits));
                    if let Some(setpoints) = &mut seen {
                        self.see(&step, setpoints);
                        if setpoints.len() >= MOST_SEEN {
                            too_fast.extend(windows(setpoints, [begins_at_rest, false]));
                            setpoints.drain(..setpoints.len() - SPAN);
                            begins_at_rest = false;
                        }
                    }
                }
                at = length;
            });
        }
        if rests[1] {
            judged.add(R::zero(), stop, limits);
            judged.add(R::zero(), stop, limits);
        }
        if let Some(setpoints) = seen {
            too_fast.extend(windows(&setpoints, [begins_at_rest, rests[1]]));
        }
        let excess = judged.excess();
        let Differences { strained, strained_steps, .. } = judged;
        Some(Followed { lead, excess, too_fast, strained, strained_steps })
    }

    /// The setpoint at which a section begins.
    fn beginning_at(&self, begin: R) -> Setpoint<R, D> {
        Setpoint { point: self.leaving(begin), distance: begin, corners: 0 }
    }

    /// Adds the setpoint at the end of a step.
    fn see(&self, step: &Step<R>, setpoints: &mut Vec<Setpoint<R, D>>) {
        let rounding = self.limit.rounding();
        let at_corner = self.passes_corner(step.from - rounding, step.to + rounding);
        let corners = setpoints.last().map_or(0, |last| last.corners) + usize::from(at_corner);
        setpoints.push(Setpoint { point: self.arriving(step.from, step.to), distance: step.to, corners });
    }

    /// By how much rounding may move points of the path, of which this is one.
    fn rounding_of(&self, point: &[R; D]) -> R {
        let farthest = if R::IS_FLOATING { self.limit.length().max(R::norm(point)) } else { R::one() };
        (R::resolution() * farthest).ldexp(ROUNDING)
    }

    /// The chord of a step if its distance from the path exceeds what is allowed by more than rounding explains. That distance is at most
    /// half of `√(arc² - chord²)`, so that most chords need no look at the path.
    fn long_chord(&self, step: &Step<R>, arc: R, limits: &KinematicLimits<R>) -> Option<TooFast<R>> {
        let allowed = limits.chord_error + limits.chord_error.ldexp(LONG);
        let farthest = ((arc - step.chord).max(R::zero()) * (arc + step.chord)).sqrt().half();
        if !(farthest > allowed) || self.passes_corner(step.from, step.to) {
            return None;
        }
        let begin = self.leaving(step.from);
        let way_to = |share: R| {
            difference(&self.arriving(step.from, step.from + (step.to - step.from) * share), &begin)
        };
        let chord = way_to(R::one());
        let off = |k| off_chord(&way_to(R::from_ratio(k, PLACES)), &chord);
        let (mut before, mut here, mut found) = (R::zero(), R::zero(), R::zero());
        for next in (1..PLACES).map(off).chain([R::zero()]) {
            found = found.max(summit([before, here, next]));
            (before, here) = (here, next);
        }
        (found > allowed + self.rounding_of(&begin)).then(|| {
            let share = (limits.chord_error / found).sqrt().max(R::one().half());
            let length = step.chord.max(R::norm(&chord));
            let feed = length / limits.interpolation_period * share;
            let slower = Slower::Feed { feed, at_corners: feed };
            TooFast {
                from: step.from,
                to: step.to,
                way: step.to - step.from,
                longer: R::one() / share,
                slower,
            }
        })
    }
}

/// The distance of a place from a chord, both as ways from the chord's begin.
fn off_chord<R: Real, const D: usize>(place: &[R; D], chord: &[R; D]) -> R {
    let product = |a: &[R; D], b: &[R; D]| R::sum_of_products(a.iter().copied().zip(*b));
    let (along, square) = (product(place, chord), product(chord, chord));
    if along <= R::zero() {
        R::norm(place)
    } else if along >= square {
        R::norm(&difference(place, chord))
    } else {
        R::norm(&across(place, chord))
    }
}

/// The highest value of the parabola through three values, evenly apart, if the middle one is the highest of them; else the middle one.
fn summit<R: Real>([before, here, next]: [R; 3]) -> R {
    let (rise, bend) = (next - before, (here - before) + (here - next));
    if here >= before && here >= next && bend > R::zero() { here + rise * rise / bend.ldexp(3) } else { here }
}

/// The differences of first and second order between the arcs of successive periods.
struct Differences<R> {
    last: [R; 2],
    count: usize,
    /// The limits of both, over a period.
    most: Allowance<R>,
    /// By how much rounding may change a difference.
    hidden: R,
    /// The largest shares of the limits that are taken.
    taken: Allowance<R>,
    strained: Vec<TooFast<R>>,
    strained_steps: Vec<TooFast<R>>,
}

impl<R: Real> Differences<R> {
    /// No differences yet. The two steps before the first have no length if it follows a rest, and are unknown otherwise.
    fn after(rest: bool, limits: &KinematicLimits<R>, hidden: R) -> Self {
        let period = limits.interpolation_period;
        let acceleration = limits.acceleration * period * period;
        let most = Allowance { acceleration, jerk: limits.jerk * period * period * period };
        let taken = Allowance { acceleration: R::zero(), jerk: R::zero() };
        let count = if rest { 2 } else { 0 };
        let (strained, strained_steps) = (Vec::new(), Vec::new());
        Self { last: [R::zero(); 2], count, most, hidden, taken, strained, strained_steps }
    }

    /// Adds a step, which ends at a distance.
    fn add(&mut self, step: R, end: R, limits: &KinematicLimits<R>) {
        let [before, last] = self.last;
        let share = |difference: R, most: R| (difference.abs() - self.hidden) / most;
        let acceleration =
            if self.count > 0 { share(step - last, self.most.acceleration) } else { R::zero() };
        let jerk =
            if self.count > 1 { share((step - last) - (last - before), self.most.jerk) } else { R::zero() };
        self.taken.acceleration = self.taken.acceleration.max(acceleration);
        self.taken.jerk = self.taken.jerk.max(jerk);
        if acceleration.max(jerk) > R::one() + R::one().ldexp(SEEN) {
            self.strain([before, last, step], end, Allowance { acceleration, jerk }, limits);
        }
        self.last = [last, step];
        self.count = self.count.saturating_add(1);
    }

    /// Adds the way of three steps over which so much of the limits is taken; of ways that overlap the changes of feed are one's.
    fn strain(&mut self, steps: [R; 3], end: R, taken: Allowance<R>, limits: &KinematicLimits<R>) {
        let most = Allowance::of_path(limits);
        let below = R::one() - R::one().ldexp(BELOW);
        let share = |taken: R| if taken > R::one() { below / taken } else { R::one() };
        let mut shares = Allowance { acceleration: share(taken.acceleration), jerk: share(taken.jerk) };
        let slow = shares.acceleration.sqrt().min(cube_root(shares.jerk));
        let longer = R::one() / slow;
        let feed = steps.into_iter().fold(R::zero(), R::max) / limits.interpolation_period * slow;
        let way = steps.into_iter().fold(R::zero(), |sum, step| sum + step);
        let mut begin = end - way;
        let slower = Slower::Feed { feed, at_corners: feed };
        self.strained_steps.push(TooFast { from: begin, to: end, way, longer, slower });
        if let Some(TooFast { from, slower: Slower::Changes { shares: others, .. }, .. }) =
            self.strained.pop_if(|last| last.to >= begin)
        {
            (begin, shares) = (from, shares.min(others));
        }
        let slower = Slower::Changes { most, shares };
        self.strained.push(TooFast { from: begin, to: end, way: end - begin, longer, slower });
    }

    /// The share by which the motion must be slowed down to keep acceleration and jerk; 0 if it keeps them.
    fn excess(&self) -> R {
        let over = |taken: R| (taken - R::one()).max(R::zero());
        let [a, j] = [over(self.taken.acceleration), over(self.taken.jerk)];
        let (seen, to) = (R::one().ldexp(SEEN), R::one() + R::one().ldexp(BELOW));
        let by_acceleration = if a > seen { (to + a).sqrt() - R::one() } else { R::zero() };
        let by_jerk = if j > seen { cube_root(to + j) - R::one() } else { R::zero() };
        by_acceleration.max(by_jerk)
    }
}
