//! The figures of a run, added up while it is made: the memory does not grow with the time that the run takes.

use limit_judge::{Corner, Differences, Setpoint, StatedLimit, StepPlace, Way, Worst};

use crate::judge::metrics::{ChordTally, CountTally, Fluctuation, FluctuationTally, JudgedStep};
use crate::judge::reference::{Reached, Reference};
use crate::run::run::RunStep;

/// The figures of a run, or of a part of one.
#[derive(Clone, Debug)]
pub(crate) struct Tally {
    pub(crate) steps: u64,
    fluctuation: FluctuationTally<StepPlace>,
    pub(crate) evaluations: CountTally,
    chords: ChordTally,
    pub(crate) chord_error_mm: Worst,
    pub(crate) corner_error_mm: Worst,
    pub(crate) position_error_mm: Worst,
    pub(crate) differences: Differences,
    /// The last step, and whether it ends at rest.
    pub(crate) last: Option<StepPlace>,
    ends_at_rest: bool,
}

impl Tally {
    pub(crate) fn new(full_step_mm: f64, limits: &[StatedLimit]) -> Self {
        Self {
            steps: 0,
            fluctuation: FluctuationTally::new(full_step_mm),
            evaluations: CountTally::default(),
            chords: ChordTally::default(),
            chord_error_mm: Worst::default(),
            corner_error_mm: Worst::default(),
            position_error_mm: Worst::default(),
            differences: Differences::new(limits),
            last: None,
            ends_at_rest: false,
        }
    }

    /// Begins a part of a run, whose first step is judged when the part is joined to those before.
    pub(crate) fn begin_part(&mut self, first: &RunStep) {
        let at = StepPlace { index: 0, row: 0, curve: first.curve, point_mm: first.point_mm };
        let ends_at_rest = first.feed_mm_per_s == 0.0;
        // Until it is judged, it is taken for one that passes a corner, and its step may be as long as it likes.
        let (feed_mm, passes_corner) = (f64::INFINITY, true);
        self.differences.begin_part(Setpoint {
            at,
            way: Way::default(),
            feed_mm,
            passes_corner,
            corner: None,
            ends_at_rest,
        });
    }

    /// Judges the next step from a place, moves the place to the step's end, and adds the step. Where it begins a section, it begins at
    /// rest if `begins_at_rest` says that it may.
    pub(crate) fn judge_next<const D: usize>(
        &mut self,
        reference: &Reference<'_, D>,
        at: &mut Reached<D>,
        step: &RunStep,
        begins_at_rest: bool,
    ) -> JudgedStep {
        let begins = begins_at_rest && self.differences.begins_section();
        let standing_mm = begins.then(|| reference.start_of(at, step));
        let judged = reference.judge_next(at, step);
        self.add_from(standing_mm, step, &judged);
        judged
    }

    /// Adds the next step, which begins at `standing_mm` if it begins a section.
    fn add_from(&mut self, standing_mm: Option<[f64; 3]>, step: &RunStep, judged: &JudgedStep) {
        let setpoint = self.add(step, judged);
        self.differences.add(standing_mm, step_of(judged), setpoint);
    }

    /// Adds the next step, but for the limits that the machine states.
    fn add(&mut self, step: &RunStep, judged: &JudgedStep) -> Setpoint {
        let place = StepPlace { index: self.steps, row: 0, curve: step.curve, point_mm: step.point_mm };
        self.steps += 1;
        self.fluctuation.add(judged, place);
        self.evaluations.add(step.evaluations);
        self.chords.add(judged.chord_mm);
        let path_error =
            if judged.passes_corner { &mut self.corner_error_mm } else { &mut self.chord_error_mm };
        path_error.add(judged.chord_error_mm, place);
        self.position_error_mm.add(judged.position_error_mm, place);
        let ends_at_rest = step.feed_mm_per_s == 0.0;
        (self.last, self.ends_at_rest) = (Some(place), ends_at_rest);
        let corner = judged.turn.map(|turn| Corner { turn, step_mm: judged.arc_mm });
        let (feed_mm, passes_corner) = (judged.feed_mm, corner.is_some());
        Setpoint { at: place, way: Way::default(), feed_mm, passes_corner, corner, ends_at_rest }
    }

    /// Adds the part of the run that follows, with its first step, which begins at rest at `standing_mm`, if that is known.
    pub(crate) fn join(
        &mut self,
        standing_mm: Option<[f64; 3]>,
        (first, judged): (&RunStep, &JudgedStep),
        other: Self,
    ) {
        let way = step_of(judged);
        let first = self.add(first, judged);
        let before = self.steps;
        self.steps += other.steps;
        self.fluctuation.join(other.fluctuation, |place| place.later(before));
        self.evaluations.join(&other.evaluations);
        self.chords.join(&other.chords);
        for (own, other) in [
            (&mut self.chord_error_mm, other.chord_error_mm),
            (&mut self.corner_error_mm, other.corner_error_mm),
            (&mut self.position_error_mm, other.position_error_mm),
        ] {
            if let Some(at) = other.at {
                own.add(other.figure, at.later(before));
            }
        }
        self.differences.join(standing_mm, way, first, other.differences, |place| place.later(before));
        if let Some(last) = other.last {
            (self.last, self.ends_at_rest) = (Some(last.later(before)), other.ends_at_rest);
        }
    }

    /// Expects a step of this length, in mm, elsewhere in the run: steps are at cruise if they are at least a quarter as long.
    pub(crate) fn expect_step(&mut self, wanted_mm: f64) {
        self.fluctuation.expect_step(wanted_mm);
    }

    /// The fluctuation, with the first step that has the largest at cruise.
    pub(crate) fn fluctuation(&self) -> (Fluctuation, Worst) {
        let (figures, at) = self.fluctuation.figures(self.ends_at_rest);
        (figures, Worst { figure: figures.cruise_max_abs, at })
    }

    /// The largest change of acceleration along the path from one period to the next, over the period T, in mm/s³:
    /// `|c_{i+1} - 2 c_i + c_{i-1}|/T³` for the chords c between the exact points. It is taken from the second period
    /// on. If a run ends at rest, two periods of rest are appended, so the figure shows a format that ends short of the
    /// path's end.
    pub(crate) fn jerk_max_mm_per_s3(&self, period_s: f64) -> f64 {
        let mut chords = self.chords;
        for _ in 0..if self.ends_at_rest { 2 } else { 0 } {
            chords.add(0.0);
        }
        chords.jerk_max_mm_per_s3(period_s)
    }
}

/// The way of a step.
fn step_of(judged: &JudgedStep) -> Way {
    Way { arc_mm: judged.arc_mm, chords_mm: judged.chord_mm }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(chord_mm: f64) -> JudgedStep {
        JudgedStep {
            wanted_mm: chord_mm,
            chord_mm,
            arc_mm: chord_mm,
            feed_mm: chord_mm,
            shortfall_mm: 0.0,
            commanded_shortfall_mm: 0.0,
            chord_error_mm: 0.0,
            passes_corner: false,
            turn: None,
            position_error_mm: 0.0,
        }
    }

    fn step(feed_mm_per_s: f64) -> RunStep {
        RunStep {
            curve: 0,
            u: (0.0, 0.0),
            point_mm: [0.0; 3],
            wanted_mm: (0.0, 0.0),
            feed_mm_per_s,
            evaluations: 1,
        }
    }

    #[test]
    fn the_jerk_of_a_run_has_its_last_step_in_it() {
        let jerk = |chords: &[f64], last_feed: f64, period_s: f64| {
            let mut tally = Tally::new(1.0, &[]);
            chords.iter().for_each(|chord| tally.add_from(None, &step(last_feed), &judged(*chord)));
            tally.jerk_max_mm_per_s3(period_s)
        };
        // The accelerations are 0, -1, -2, 1, and behind the end -2, 0.
        let chords = [4.0, 4.0, 3.0, 1.0, 2.0];
        assert_eq!(jerk(&chords, 1.0, 1.0), 3.0);
        assert_eq!(jerk(&chords[..4], 0.0, 1.0), 1.0);
        assert_eq!(jerk(&chords, 0.0, 0.5), 8.0 * 3.0);
        assert_eq!((jerk(&chords[..1], 0.0, 1.0), jerk(&[], 1.0, 1.0)), (4.0, 0.0));
    }
}
