//! What one period of a compiled run may take: with a bound of the code between, it says how long a period lasts at most.

use real::Backend;

use crate::compiled::compiled_path::CompiledPath;
use crate::step_lengths::{LengthStage, PERIOD};

/// The most that a period of a run at the plan's own speed may take.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PeriodLimits {
    /// K: evaluations that its pieces share, [`max_evaluations`](crate::ChordTolerance::max_evaluations).
    pub evaluations: u32,
    /// J: joints of pieces, the end of the path among them.
    pub joints: usize,
    /// S: stages, in the last period of a section. The others read from [`crossings`](CompiledPath::crossings) what they cross.
    pub stages: usize,
}

impl<R: Backend, const D: usize> CompiledPath<R, D> {
    /// What a period may take.
    ///
    /// A chord of the length L passes a piece from end to end only if the step over the whole piece is at most σL, σ being the
    /// piece's greatest step per chord. So the joints that a period touches are one more than the pieces in a row whose
    /// `whole/(σL)` add up to 1 at most, where L is the greatest feed with the landing step.
    #[must_use]
    pub fn period_limits(&self) -> PeriodLimits {
        let path = self.interpolator();
        let feeds = self.stages().iter().map(|stage| stage.feed.max(stage.feed + stage.change).to_f64());
        let longest = feeds.fold(0.0, f64::max) + path.landing_step.to_f64();
        let share =
            |row: &nurbs_core::Piece<R, D>| row.whole().to_f64() / (row.step_per_chord[1].to_f64() * longest);
        let stages = |section: &crate::Section| self.stages().get(section.stages.clone()).map(in_last_period);
        PeriodLimits {
            evaluations: path.tolerance.max_evaluations,
            joints: 1 + most_in_a_row(path.pieces.pieces.iter().map(share)),
            stages: self.sections().iter().filter_map(stages).max().unwrap_or(0),
        }
    }
}

/// The most neighbours that together are at most 1, up to roundings.
fn most_in_a_row(shares: impl Iterator<Item = f64> + Clone) -> usize {
    const ROUNDING: f64 = 1e-9;
    let (mut most, mut count, mut sum) = (0, 0, 0.0);
    let mut first = shares.clone();
    for share in shares {
        (sum, count) = (sum + share, count + 1);
        while sum > 1.0 + ROUNDING
            && let Some(dropped) = first.next()
        {
            (sum, count) = (sum - dropped, count - 1);
        }
        most = most.max(count);
    }
    most
}

/// How many stages of a schedule its last period touches.
fn in_last_period<R>(stages: &[LengthStage<R>]) -> usize {
    let total = stages.iter().fold(0_u64, |sum, stage| sum.wrapping_add(stage.duration));
    let mut left = total.wrapping_sub(1) % PERIOD + 1;
    let touched = stages.iter().rev().take_while(|stage| {
        let is_touched = left > 0;
        left = left.saturating_sub(stage.duration);
        is_touched
    });
    touched.count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ChordTolerance;
    use feed_plan::{EndFeeds, KinematicLimits, Planned, ProfileKind};
    use nurbs_core::{NurbsCurve, PieceLimits, compile_with_stops};
    use real::{DoubleDouble, I4F28};

    /// A bend of 30 mm at 0.2 mm a period, in pieces of at most this length.
    fn path(length_mm: f64) -> CompiledPath<I4F28, 2> {
        let points = [[0.0, 0.0], [10.0, 0.0], [20.0, 0.0], [20.0, 10.0]];
        let curve =
            NurbsCurve::try_new(3, &points, &[1.0; 4], &[0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0]).unwrap();
        let limits = KinematicLimits {
            interpolation_period: 1.0,
            feedrate: 0.2,
            acceleration: 0.005,
            jerk: 0.0004,
            chord_error: 0.0005,
            centripetal_acceleration: None,
            axes: Default::default(),
            junction: Default::default(),
        };
        let curves = [curve];
        let plan = Planned::along(&curves, &limits, EndFeeds::default(), ProfileKind::default()).unwrap();
        let cut = PieceLimits { length_mm, step_mm: limits.feedrate + limits.acceleration };
        let pieces = compile_with_stops::<DoubleDouble, I4F28, 2>(&curves, &cut, &plan.rests()).unwrap();
        let tolerance = ChordTolerance::for_fluctuation(None, 5);
        CompiledPath::new(pieces, &plan.chords.as_schedule(), tolerance, limits.acceleration).unwrap()
    }

    #[test]
    fn no_period_passes_more_joints_than_it_may() {
        for length in [8.0, 0.3, 0.1, 0.03] {
            let path = path(length);
            let joints = path.period_limits().joints;
            let (mut last, mut most) = (0, 0);
            for run in path.runs() {
                let mut state = run.start();
                while let Some(setpoint) = run.step(&mut state) {
                    most = most.max(setpoint.piece - last);
                    last = setpoint.piece;
                }
            }
            assert!((1..=joints).contains(&most), "{length}: {most} of {joints}");
            // Pieces are halved until they are short enough, and σ is at most some percent above what it is in a step.
            assert!(joints <= 2 * most + 1, "{length}: {joints} for {most}");
        }
    }

    #[test]
    fn neighbours_add_up_to_one() {
        assert_eq!(most_in_a_row([2.0, 3.0].into_iter()), 0);
        assert_eq!(most_in_a_row([0.6, 0.5, 0.25, 0.25, 0.9, 0.05].into_iter()), 3);
    }

    #[test]
    fn the_last_period_touches_the_stages_that_end_in_it() {
        let stages = |durations: &[u64]| {
            let stage = |duration: &u64| LengthStage::<f64>::new(*duration, 1.0, 0.0).unwrap();
            durations.iter().map(stage).collect::<alloc::vec::Vec<_>>()
        };
        // The last period is a half, a whole one, and three quarters.
        assert_eq!(in_last_period(&stages(&[PERIOD, PERIOD / 2])), 1);
        assert_eq!(in_last_period(&stages(&[PERIOD / 2, PERIOD, PERIOD / 2])), 2);
        assert_eq!(in_last_period(&stages(&[2 * PERIOD, PERIOD / 4, PERIOD / 4, PERIOD / 4])), 3);
    }
}
