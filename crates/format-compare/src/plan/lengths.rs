//! The distance of each period of a plan, from any rest on.

use feed_plan::{Cursor, Schedule, Stage, sections};
use real::{DoubleDouble, Real};

/// A section of a plan's stages: where it begins, and how long it takes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SectionPeriods {
    first_stage: usize,
    first_period: u64,
    periods: u64,
}

/// The sections of these stages on the time grid.
pub(crate) fn section_periods<R: Real>(stages: &[Stage<R>]) -> Vec<SectionPeriods> {
    let mut first_period = 0;
    let section = |section: feed_plan::Section<'_, R>| {
        let units = section.durations().fold(0_u64, u64::saturating_add);
        let periods = units.div_ceil(1 << 32);
        let found = SectionPeriods { first_stage: section.first(), first_period, periods };
        first_period += periods;
        found
    };
    sections(stages).map(section).collect()
}

/// The number of the stage with which the section begins that begins at this period, or behind it; `None` behind the last.
pub(crate) fn first_stage(sections: &[SectionPeriods], period: u64) -> Option<usize> {
    let section = sections.partition_point(|section| section.first_period < period);
    sections.get(section).map(|section| section.first_stage)
}

/// The distance of each period, in mm, exact to the precision of `R`, which is the reference's unless another is named, with the feed at
/// the period's end, in mm per period. Each section is walked on its own clock.
#[derive(Clone, Debug)]
pub(crate) struct Lengths<'a, R = DoubleDouble> {
    stages: &'a [Stage<R>],
    sections: &'a [SectionPeriods],
    /// The number of the section that is walked.
    section: usize,
    schedule: Schedule<'a, R>,
    cursor: Cursor<R>,
}

impl<'a, R: Real> Lengths<'a, R> {
    /// From this period on.
    pub(crate) fn from(stages: &'a [Stage<R>], sections: &'a [SectionPeriods], period: u64) -> Self {
        let behind = sections.partition_point(|section| section.first_period <= period);
        let schedule = Schedule::new(&[], R::one(), 0);
        let cursor = schedule.start();
        let mut lengths = Self { stages, sections, section: behind.saturating_sub(1), schedule, cursor };
        lengths.enter();
        let begin = sections.get(lengths.section).map_or(0, |section| section.first_period);
        for _ in begin..period {
            let _ = lengths.next();
        }
        lengths
    }

    fn enter(&mut self) {
        let Some(section) = self.sections.get(self.section) else { return };
        let end = self.sections.get(self.section + 1).map_or(self.stages.len(), |next| next.first_stage);
        let own = self.stages.get(section.first_stage..end).unwrap_or_default();
        self.schedule = Schedule::new(own, R::one(), section.periods);
        self.cursor = self.schedule.start();
    }
}

impl<R: Real> Iterator for Lengths<'_, R> {
    type Item = (R, R);

    fn next(&mut self) -> Option<Self::Item> {
        while self.section < self.sections.len() {
            if let Some(length) = self.schedule.advance(&mut self.cursor) {
                return Some((length, self.schedule.feed(&self.cursor)));
            }
            self.section += 1;
            self.enter();
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use feed_plan::StageShape;

    use super::*;

    /// A plan of three sections, of 4, 3 and 9 periods; the second has a joint at a whole period.
    fn stages() -> Vec<Stage<DoubleDouble>> {
        let feeds = [(0.0, 1.0, 2.5), (1.0, 0.0, 1.5), (0.0, 0.7, 2.0), (0.7, 0.0, 1.0)];
        let last = [(0.0, 0.4, 1.25), (0.4, 0.4, 6.5), (0.4, 0.0, 1.25)];
        let mut place = 0.0;
        let stage = |&(start_feed, end_feed, duration): &(f64, f64, f64)| {
            let (start, length) = (place, (start_feed + end_feed) / 2.0 * duration);
            place += length;
            let stage = Stage {
                start,
                length,
                start_feed,
                end_feed,
                duration,
                shape: StageShape::Cubic,
                curve_start: 0,
                u_start: 0.0,
                curve_end: 0,
                u_end: 0.0,
            };
            stage.map(DoubleDouble::from)
        };
        feeds.iter().chain(&last).map(stage).collect()
    }

    #[test]
    fn from_any_period_on_they_are_those_of_the_whole_walked_in_one_go() {
        let stages = stages();
        let sections = section_periods(&stages);
        let schedule = Schedule::new(&stages, DoubleDouble::from(1.0), 16);
        let mut cursor = schedule.start();
        let whole: Vec<_> = std::iter::from_fn(|| {
            let length = schedule.advance(&mut cursor)?;
            Some((length, schedule.feed(&cursor)))
        })
        .collect();
        assert_eq!((whole.len(), sections.len()), (16, 3));
        for period in 0..=17 {
            let found: Vec<_> = Lengths::from(&stages, &sections, period as u64).collect();
            assert_eq!(found, whole.get(period..).unwrap_or_default(), "{period}");
        }
    }
}
