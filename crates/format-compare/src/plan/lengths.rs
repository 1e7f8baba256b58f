//! The distance of each period of a plan, from any rest on.

use feed_plan::{Cursor, Schedule, Stage, sections};
use real::DoubleDouble;

/// A section of a plan's stages: where it begins, and how long it takes.
#[derive(Clone, Copy, Debug)]
pub(crate) struct SectionPeriods {
    first_stage: usize,
    first_period: u64,
    periods: u64,
}

/// The sections of these stages on the time grid.
pub(crate) fn section_periods(stages: &[Stage<DoubleDouble>]) -> Vec<SectionPeriods> {
    let mut first_period = 0;
    let section = |section: feed_plan::Section<'_, DoubleDouble>| {
        let units = section.durations().fold(0_u64, u64::saturating_add);
        let periods = units.div_ceil(1 << 32);
        let found = SectionPeriods { first_stage: section.first(), first_period, periods };
        first_period += periods;
        found
    };
    sections(stages).map(section).collect()
}

/// The distance of each period, in mm, exact to the reference's precision, with the feed at the period's end, in mm per
/// period. Each section is walked on its own clock.
#[derive(Clone, Debug)]
pub(crate) struct Lengths<'a> {
    stages: &'a [Stage<DoubleDouble>],
    sections: &'a [SectionPeriods],
    /// The number of the section that is walked.
    section: usize,
    schedule: Schedule<'a, DoubleDouble>,
    cursor: Cursor<DoubleDouble>,
}

impl<'a> Lengths<'a> {
    /// From this period on.
    pub(crate) fn from(
        stages: &'a [Stage<DoubleDouble>],
        sections: &'a [SectionPeriods],
        period: u64,
    ) -> Self {
        let behind = sections.partition_point(|section| section.first_period <= period);
        let schedule = Schedule::new(&[], DoubleDouble::from(1.0), 0);
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
        self.schedule = Schedule::new(own, DoubleDouble::from(1.0), section.periods);
        self.cursor = self.schedule.start();
    }
}

impl Iterator for Lengths<'_> {
    type Item = (DoubleDouble, f64);

    fn next(&mut self) -> Option<Self::Item> {
        while self.section < self.sections.len() {
            if let Some(length) = self.schedule.advance(&mut self.cursor) {
                return Some((length, self.schedule.feed(&self.cursor).value()));
            }
            self.section += 1;
            self.enter();
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use crate::ExactPlan;
    use crate::examples::on_example_machine;

    /// Stairs with a rest at each corner: the lengths from any period on are those of the whole plan, walked in one go.
    #[test]
    fn from_any_period_on_they_are_those_of_the_whole() {
        let problem = on_example_machine::<3>("G1 X16 F6000\nY16\nX32.1\nG2 X42 Y26 I10\nG1 Y48\n", "");
        let plan = ExactPlan::in_format::<f64, 3>(&problem, [0.0; 2]).unwrap();
        let (schedule, mut cursor) = (plan.schedule(), plan.schedule().start());
        let whole: Vec<_> = std::iter::from_fn(|| {
            let length = schedule.advance(&mut cursor)?;
            Some((length, schedule.feed(&cursor).value()))
        })
        .collect();
        assert!(whole.len() as u64 == plan.periods() && schedule.sections().count() > 2);
        for period in [0, 1, whole.len() / 2, whole.len() - 1, whole.len(), whole.len() + 1] {
            let found: Vec<_> = plan.lengths_from(period as u64).collect();
            assert_eq!(found, whole.get(period..).unwrap_or_default(), "{period}");
        }
    }
}
