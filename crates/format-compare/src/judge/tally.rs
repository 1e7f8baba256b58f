//! The figures of a run, added up while it is made: the memory does not grow with the time that the run takes.

use crate::judge::metrics::{ChordTally, CountTally, Fluctuation, FluctuationTally, JudgedStep};
use crate::run::at_cruise::is_less;
use crate::run::run::RunStep;

/// A step of a run, by which a figure is found again.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct StepPlace {
    /// Number of the step, from 0.
    pub(crate) index: u64,
    pub(crate) curve: usize,
    /// The commanded point, in mm.
    pub(crate) point_mm: [f64; 3],
}

impl StepPlace {
    fn later(self, by: u64) -> Self {
        Self { index: self.index + by, ..self }
    }
}

/// The greatest figure of a run, and the first step that has it.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Worst {
    pub(crate) figure: f64,
    pub(crate) at: Option<StepPlace>,
}

impl Worst {
    /// Adds the figure of a later step. NaN counts as greater than any number.
    fn add(&mut self, figure: f64, at: StepPlace) {
        if self.at.is_none() || is_less(self.figure, figure) {
            *self = Self { figure, at: Some(at) };
        }
    }
}

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
    /// The last step, and whether it ends at rest.
    pub(crate) last: Option<StepPlace>,
    ends_at_rest: bool,
}

impl Tally {
    pub(crate) fn new(full_step_mm: f64) -> Self {
        Self {
            steps: 0,
            fluctuation: FluctuationTally::new(full_step_mm),
            evaluations: CountTally::default(),
            chords: ChordTally::default(),
            chord_error_mm: Worst::default(),
            corner_error_mm: Worst::default(),
            position_error_mm: Worst::default(),
            last: None,
            ends_at_rest: false,
        }
    }

    /// Adds the next step.
    pub(crate) fn add(&mut self, step: &RunStep, judged: &JudgedStep) {
        let place = StepPlace { index: self.steps, curve: step.curve, point_mm: step.point_mm };
        self.steps += 1;
        self.fluctuation.add(judged, place);
        self.evaluations.add(step.evaluations);
        self.chords.add(judged.chord_mm);
        let path_error =
            if judged.passes_corner { &mut self.corner_error_mm } else { &mut self.chord_error_mm };
        path_error.add(judged.chord_error_mm, place);
        self.position_error_mm.add(judged.position_error_mm, place);
        (self.last, self.ends_at_rest) = (Some(place), step.feed_mm_per_s == 0.0);
    }

    /// Adds the part of the run that follows.
    pub(crate) fn join(&mut self, other: Self) {
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
        if let Some(last) = other.last {
            (self.last, self.ends_at_rest) = (Some(last.later(before)), other.ends_at_rest);
        }
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

#[cfg(test)]
mod tests {
    use super::*;

    fn judged(chord_mm: f64) -> JudgedStep {
        JudgedStep {
            wanted_mm: chord_mm,
            chord_mm,
            shortfall_mm: 0.0,
            commanded_shortfall_mm: 0.0,
            chord_error_mm: 0.0,
            passes_corner: false,
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
            let mut tally = Tally::new(1.0);
            chords.iter().for_each(|chord| tally.add(&step(last_feed), &judged(*chord)));
            tally.jerk_max_mm_per_s3(period_s)
        };
        // The accelerations are 0, -1, -2, 1, and behind the end -2, 0.
        let chords = [4.0, 4.0, 3.0, 1.0, 2.0];
        assert_eq!(jerk(&chords, 1.0, 1.0), 3.0);
        assert_eq!(jerk(&chords[..4], 0.0, 1.0), 1.0);
        assert_eq!(jerk(&chords, 0.0, 0.5), 8.0 * 3.0);
        assert_eq!((jerk(&chords[..1], 0.0, 1.0), jerk(&[], 1.0, 1.0)), (4.0, 0.0));
    }

    #[test]
    fn the_worst_step_is_found_whatever_its_figure() {
        let worst = |figures: &[f64]| {
            let mut found = Worst::default();
            for (index, figure) in (0..).zip(figures) {
                found.add(*figure, StepPlace { index, curve: 0, point_mm: [0.0; 3] });
            }
            (found.figure, found.at.map(|at| at.index))
        };
        assert_eq!([worst(&[1.0, 3.0, 2.0]), worst(&[1.0, 3.0, 3.0])], [(3.0, Some(1)); 2]);
        assert_eq!((worst(&[0.0, 0.0]), worst(&[])), ((0.0, Some(0)), (0.0, None)));
        for at in 0..3 {
            let mut figures = [1.0; 3];
            figures[at] = f64::NAN;
            let (figure, step) = worst(&figures);
            assert!(figure.is_nan() && step == u64::try_from(at).ok(), "{at}");
        }
    }
}
