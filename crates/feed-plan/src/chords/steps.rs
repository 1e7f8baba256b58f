//! The periods of a run by chords, beside its plan in arcs.

use nurbs_core::Differentiate;
use real::Real;

use crate::chords::shortfall::Path;
use crate::plan::whole_periods::periods_taken;
use crate::{Schedule, Section};

/// One period of a run, in mm from the path's start.
#[derive(Clone, Copy)]
pub(super) struct Step<R> {
    /// Where the plan in arcs is at the period's end, and how far it has gone in the section.
    pub(super) planned: R,
    pub(super) travelled: R,
    /// Where the run is at the begin and at the end.
    pub(super) from: R,
    pub(super) to: R,
    pub(super) chord: R,
    /// The sum of the chords in the section.
    pub(super) sum: R,
    pub(super) is_last: bool,
}

impl<R: Real, C: Differentiate<R, D>, const D: usize> Path<'_, R, C, D> {
    /// Shows each period of a section's run by `chords`, which lands on the section's end.
    pub(super) fn each_step(
        &self,
        [arcs, chords]: [&Section<'_, R>; 2],
        period: R,
        mut show: impl FnMut(Step<R>),
    ) {
        let (Some(first), Some(last)) = (arcs.stages().first(), arcs.stages().last()) else { return };
        let (begin, stop) = (first.start, last.start + last.length);
        let Some(periods) = periods_taken(chords.duration(), period) else { return };
        let [arcs, chords] =
            [arcs, chords].map(|one| Schedule::new(one.stages(), period, u64::from(periods)));
        let [mut by_arcs, mut by_chords] = [arcs.start(), chords.start()];
        let (mut travelled, mut sum, mut from) = (R::zero(), R::zero(), begin);
        while let (Some(arc), Some(chord)) = (arcs.advance(&mut by_arcs), chords.advance(&mut by_chords)) {
            let is_last = chords.is_over(&by_chords) || by_chords.stage() >= chords.stages().len();
            (travelled, sum) = (travelled + arc, sum + chord);
            let to = if is_last { stop } else { (from + self.arc_of_step(from, chord)).min(stop) };
            show(Step { planned: begin + travelled, travelled, from, to, chord, sum, is_last });
            from = to;
            if is_last {
                break;
            }
        }
    }
}
