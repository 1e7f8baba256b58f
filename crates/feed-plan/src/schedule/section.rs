//! Sections: the parts of a plan from one rest to the next.
//!
//! At each rest the machine stands still, and no distance is left over from before. So a section has a clock of its
//! own, which begins at 0 and ends on a whole period. No rounding in earlier sections changes it. Runs are made and
//! judged section by section.

use real::Real;

use crate::Stage;
use crate::schedule::stage::duration;

/// A rest that is off a whole period by less than 2⁻¹⁰ of a period counts as on it: sections are planned in whole
/// periods, and the difference is the rounding of times.
pub(crate) const AT_REST: i32 = -10;

/// The stages from one rest to the next, or to the end of the plan. Pauses after a rest belong to the section before
/// the rest.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Section<'a, R> {
    stages: &'a [Stage<R>],
    first: usize,
}

/// The sections of a plan's stages, in order.
pub fn sections<R: Real>(stages: &[Stage<R>]) -> impl Iterator<Item = Section<'_, R>> {
    let mut first = 0;
    core::iter::from_fn(move || {
        let rest = stages.get(first..).filter(|rest| !rest.is_empty())?;
        let section = Section { stages: rest.get(..count(rest)).unwrap_or(rest), first };
        first += section.stages.len();
        Some(section)
    })
}

/// The number of stages in the section with which these stages begin.
pub(crate) fn count<R: Real>(stages: &[Stage<R>]) -> usize {
    let goes_on = |pair: &&[Stage<R>]| !pair[0].end_feed.is_zero() || pair[1].is_pause();
    stages.windows(2).take_while(goes_on).count() + 1
}

impl<'a, R: Real> Section<'a, R> {
    /// Its stages.
    #[must_use]
    pub fn stages(&self) -> &'a [Stage<R>] {
        self.stages
    }

    /// The number of its first stage in the plan.
    #[must_use]
    pub fn first(&self) -> usize {
        self.first
    }

    /// Curve and parameter of the rest at its end; `None` if the plan ends there in motion.
    #[must_use]
    pub fn rest(&self) -> Option<(usize, R)> {
        self.stages.last().and_then(Stage::rest)
    }

    /// Duration of the section.
    #[must_use]
    pub fn duration(&self) -> R {
        duration(self.stages)
    }

    /// Durations of the section's stages in 2⁻³² periods, the unit in which a controller counts time. The plan's unit
    /// of time must be the period.
    ///
    /// Each stage ends at the nearest such time of the section's clock, so that roundings do not add up. The last stage
    /// ends at a whole period if the section rests within 2⁻¹⁰ of one. A stage may get the duration 0.
    pub fn durations(&self) -> impl Iterator<Item = u64> + use<'a, R> {
        let half_unit = R::one().ldexp(-33);
        let last = self.rest().map(|_| self.stages.len());
        let (mut time, mut begin) = (R::zero(), 0);
        (1..).zip(self.stages).map(move |(number, stage)| {
            time = time + stage.duration;
            let end = (time + half_unit).to_phase(-32);
            let end = if last == Some(number) { at_whole_period(end) } else { end };
            end.saturating_sub(core::mem::replace(&mut begin, end))
        })
    }
}

/// Rounds a time in 2⁻³² periods to a whole period if that is within 2⁻¹⁰ of a period; otherwise returns the time.
fn at_whole_period(time: u64) -> u64 {
    let nearest = time.saturating_add(1 << 31) >> 32 << 32;
    if time.abs_diff(nearest) < 1 << (32 + AT_REST) { nearest } else { time }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::schedule::stage::examples::stages;

    fn with(duration: f64, end_feed: f64) -> Stage<f64> {
        Stage { duration, end_feed, ..stages()[0] }
    }

    #[test]
    fn a_section_ends_at_a_rest_and_behind_its_pauses() {
        let pause = Stage { start_feed: 0.0, ..with(0.5, 0.0) };
        let fall = |duration: f64| Stage { start_feed: 1.0, ..with(duration, 0.0) };
        let plan = [with(1.0, 1.0), fall(1.5), pause, fall(2.0), with(1.0, 0.5)];
        let found: Vec<_> = sections(&plan).map(|one| (one.first(), one.stages().len())).collect();
        assert_eq!(found, [(0, 3), (3, 1), (4, 1)]);
        assert_eq!(sections(&plan).map(|one| one.rest().is_some()).collect::<Vec<_>>(), [true, true, false]);
        assert_eq!(sections::<f64>(&[]).count(), 0);
    }

    /// When times were summed over a whole program, some thirty thousand rests were a unit behind their period, and
    /// runs were a period late.
    #[test]
    fn each_section_takes_whole_periods_however_many_lie_before_it() {
        let third = 1.0 / 3.0 + 1e-13;
        let plan: Vec<_> = (0..300_000).map(|i| with(third, f64::from(u8::from(i % 3 != 2)))).collect();
        assert_eq!(sections(&plan).count(), 100_000);
        for section in sections(&plan) {
            let durations: Vec<_> = section.durations().collect();
            assert_eq!(durations.iter().sum::<u64>(), 1 << 32);
            assert!(durations.iter().all(|duration| duration.abs_diff((1 << 32) / 3) <= 1));
        }
    }

    /// Three stages of a third of a period: each is rounded down by a third of a unit, and together they are still a
    /// period.
    #[test]
    fn rounded_durations_do_not_add_up() {
        let plan: Vec<_> = (0..300).map(|_| with(1.0 / 3.0, 1.0)).collect();
        let durations: Vec<_> = sections(&plan).flat_map(|section| section.durations()).collect();
        assert!(durations.iter().all(|duration| duration.abs_diff((1 << 32) / 3) <= 1));
        assert_eq!(durations.iter().sum::<u64>(), 100 << 32);
    }

    #[test]
    fn a_rest_within_a_period_stays_there() {
        for (duration, units) in [(2.5, 5 << 31), (2.0 + 1e-4, 2 << 32), (2.0 - 1e-4, 2 << 32)] {
            let plan = [with(duration, 0.0)];
            assert_eq!(sections(&plan).flat_map(|one| one.durations()).sum::<u64>(), units);
        }
    }
}
