//! A plan that owns its stages.

use alloc::vec::Vec;

use real::Real;

use crate::{Schedule, Stage, sections};

/// A plan that owns its stages, as [`plan`](crate::plan()) makes it.
#[derive(Clone, Debug, PartialEq)]
pub struct ScheduleBuf<R> {
    pub(crate) stages: Vec<Stage<R>>,
    pub(crate) interpolation_period: R,
    pub(crate) periods: u64,
}

impl<R: Real> ScheduleBuf<R> {
    /// The plan, borrowed. It has all other functions.
    #[must_use]
    pub fn as_schedule(&self) -> Schedule<'_, R> {
        Schedule::new(&self.stages, self.interpolation_period, self.periods)
    }

    /// The stages, in order.
    #[must_use]
    pub fn stages(&self) -> &[Stage<R>] {
        &self.stages
    }

    /// Replaces the stages from each stop to the next by those that `other` makes of them and of their part of `list`.
    /// The starts of the new stages follow from their lengths.
    pub(crate) fn by_sections(
        self,
        list: &[R],
        mut other: impl FnMut(&[Stage<R>], &[R]) -> Vec<Stage<R>>,
    ) -> Self {
        let mut stages: Vec<Stage<R>> = Vec::with_capacity(self.stages.len());
        let (mut rest, mut start) = (list, R::zero());
        for section in sections(&self.stages) {
            let (these, others) = rest.split_at(section.stages().len().min(rest.len()));
            rest = others;
            for stage in other(section.stages(), these) {
                stages.push(Stage { start, ..stage });
                start = start + stage.length;
            }
        }
        Self { stages, ..self }
    }
}
