//! Figures over a whole run.

use std::cmp::Ordering;

use serde::Serialize;

use crate::run::at_cruise::GreatestAtCruise;

/// Feedrate fluctuation δ_i = 1 - |C(u_{i+1}) - C(u_i)|/(V_i T) over a run, a ratio. It is computed from the exact
/// points at the parameters of the run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Fluctuation {
    /// Largest δ: the step that falls furthest short.
    pub max: f64,
    /// Smallest δ: the step that goes furthest too far.
    pub min: f64,
    /// Mean of |δ|.
    pub mean_abs: f64,
    /// Largest |δ| over the steps at cruise, of at least a quarter of F·T. If the plan never reaches F, they are the
    /// steps of at least a quarter of the longest step. The last step of a run that ends at a feed does not count: there it
    /// takes the rest of the path, for such a plan is not fitted to its end. A relative figure of a micrometre step near rest says nothing about the cut,
    /// so a requirement is judged by this figure.
    pub cruise_max_abs: f64,
    /// Largest |δ| over the steps at cruise, computed from the commanded points in place of the exact ones. It includes
    /// the rounding of the positions, which is as large in a short step as in a long one.
    pub commanded_cruise_max_abs: f64,
    /// Largest |chord - wanted chord| in mm, over all steps but the last. This figure also covers the steps near rest.
    /// The last step lands on the end and takes the rest of the path.
    pub length_error_mm_max: f64,
}

/// One step as the reference sees it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JudgedStep {
    /// The chord that the plan wants, in mm.
    pub wanted_mm: f64,
    /// The chord between the exact points, in mm.
    pub chord_mm: f64,
    /// The arc length of the path between them, in mm.
    pub arc_mm: f64,
    /// The longest step that the blocks passed in it command, in mm.
    pub feed_mm: f64,
    /// `wanted - chord`, in mm, subtracted before rounding to f64.
    pub shortfall_mm: f64,
    /// `wanted - chord`, in mm, for the chord between the commanded points.
    pub commanded_shortfall_mm: f64,
    /// Largest distance of the curve from the chord, in mm.
    pub chord_error_mm: f64,
    /// Whether the chord passes a corner of the path, a joint at which the tangent breaks.
    pub passes_corner: bool,
    /// By how much each component of the unit tangent changes at most at a corner that the chord passes or begins at; `None` if there is
    /// none.
    pub turn: Option<[f64; 3]>,
    /// Distance of the commanded point from the exact one, in mm.
    pub position_error_mm: f64,
}

impl JudgedStep {
    /// The feedrate fluctuation δ; 0 if both the wanted chord and the chord are 0.
    #[must_use]
    pub fn fluctuation(&self) -> f64 {
        self.share(self.shortfall_mm)
    }

    /// The feedrate fluctuation of the chord between the commanded points.
    #[must_use]
    pub fn commanded_fluctuation(&self) -> f64 {
        self.share(self.commanded_shortfall_mm)
    }

    fn share(&self, shortfall_mm: f64) -> f64 {
        if shortfall_mm == 0.0 { 0.0 } else { shortfall_mm / self.wanted_mm }
    }
}

impl Fluctuation {
    /// The figures of a run whose full step F·T is `full_step_mm`. For an empty run all figures are 0.
    #[must_use]
    pub fn of(steps: &[JudgedStep], full_step_mm: f64) -> Self {
        let mut tally = FluctuationTally::new(full_step_mm);
        steps.iter().for_each(|step| tally.add(step, ()));
        tally.figures(false).0
    }
}

/// The fluctuation of a run of which steps are added, or parts are joined. A step has a place, by which it is found
/// again.
#[derive(Clone, Debug)]
pub(crate) struct FluctuationTally<P> {
    count: u64,
    /// Largest and smallest δ.
    extremes: Option<[f64; 2]>,
    sum_abs: f64,
    length_error_mm_max: f64,
    at_cruise: GreatestAtCruise<P>,
    commanded_at_cruise: GreatestAtCruise<()>,
    /// The last step: the last of a run lands, and is left out of some figures.
    last: Option<(JudgedStep, P)>,
}

impl<P: Copy> FluctuationTally<P> {
    pub(crate) fn new(full_step_mm: f64) -> Self {
        Self {
            count: 0,
            extremes: None,
            sum_abs: 0.0,
            length_error_mm_max: 0.0,
            at_cruise: GreatestAtCruise::new(full_step_mm),
            commanded_at_cruise: GreatestAtCruise::new(full_step_mm),
            last: None,
        }
    }

    /// Expects a step of this length, in mm, elsewhere in the run.
    pub(crate) fn expect_step(&mut self, wanted_mm: f64) {
        self.at_cruise.note_length(wanted_mm);
        self.commanded_at_cruise.note_length(wanted_mm);
    }

    /// Adds the next step.
    pub(crate) fn add(&mut self, step: &JudgedStep, place: P) {
        self.add_last();
        let delta = step.fluctuation();
        self.count += 1;
        self.sum_abs += delta.abs();
        let [max, min] = self.extremes.unwrap_or([delta; 2]);
        self.extremes = Some([greater(max, delta), min.min(delta)]);
        self.last = Some((*step, place));
    }

    /// Adds the part of the run that follows, `place` being the place in the whole run of one in it.
    pub(crate) fn join(&mut self, other: Self, place: impl Fn(P) -> P) {
        if other.last.is_some() {
            self.add_last();
        }
        self.count += other.count;
        self.sum_abs += other.sum_abs;
        self.extremes = match (self.extremes, other.extremes) {
            (Some([max, min]), Some(other)) => Some([greater(max, other[0]), min.min(other[1])]),
            (one, other) => one.or(other),
        };
        self.length_error_mm_max = greater(self.length_error_mm_max, other.length_error_mm_max);
        self.at_cruise.join(other.at_cruise, &place);
        self.commanded_at_cruise.join(other.commanded_at_cruise, |at| at);
        self.last = other.last.map(|(step, at)| (step, place(at))).or(self.last);
    }

    /// Adds the step before the last to the figures in which the last does not count.
    fn add_last(&mut self) {
        let Some((step, place)) = self.last.take() else { return };
        self.length_error_mm_max = greater(self.length_error_mm_max, step.shortfall_mm.abs());
        self.add_at_cruise(&step, place);
    }

    fn add_at_cruise(&mut self, step: &JudgedStep, place: P) {
        let (delta, commanded) = (step.fluctuation(), step.commanded_fluctuation().abs());
        if delta.is_nan() {
            self.at_cruise.add_always(delta, place);
            self.commanded_at_cruise.add_always(commanded, ());
        } else {
            self.at_cruise.add(step.wanted_mm, delta.abs(), place);
            self.commanded_at_cruise.add(step.wanted_mm, commanded, ());
        }
    }

    /// The figures, and the place of the first step with the largest fluctuation at cruise. Where the run ends at rest, its last
    /// step is one of those.
    pub(crate) fn figures(&self, ends_at_rest: bool) -> (Fluctuation, Option<P>) {
        let mut whole = self.clone();
        if let Some((step, place)) = self.last.filter(|_| ends_at_rest) {
            whole.add_at_cruise(&step, place);
        }
        let [max, min] = self.extremes.unwrap_or_default();
        let worst = whole.at_cruise.greatest();
        let figures = Fluctuation {
            max,
            min,
            mean_abs: self.sum_abs / self.count.max(1) as f64,
            cruise_max_abs: worst.map_or(0.0, |(figure, _)| figure),
            commanded_cruise_max_abs: whole.commanded_at_cruise.greatest().map_or(0.0, |(figure, ())| figure),
            length_error_mm_max: self.length_error_mm_max,
        };
        (figures, worst.map(|(_, place)| place))
    }
}

/// The greater of two figures, or NaN if either is NaN: a NaN must not be lost before it is judged.
pub(crate) fn greater(one: f64, other: f64) -> f64 {
    if one.is_nan() || other <= one { one } else { other }
}

/// The largest differences of first and second order between the chords of successive periods, of a run of which chords
/// are added, or parts are joined.
#[derive(Clone, Copy, Debug, Default)]
pub struct ChordTally {
    count: u64,
    /// The first two chords, as far as there are any.
    first: [f64; 2],
    /// The last two.
    last: [f64; 2],
    change_max_mm: f64,
    bend_max_mm: f64,
}

impl ChordTally {
    /// Adds the next chord, in mm.
    pub fn add(&mut self, chord_mm: f64) {
        let [before, last] = self.last;
        if self.count > 0 {
            self.change_max_mm = self.change_max_mm.max((chord_mm - last).abs());
        }
        match self.count {
            count @ 0..=1 => self.first[usize::from(count == 1)] = chord_mm,
            _ => {
                self.bend_max_mm = greater(self.bend_max_mm, (chord_mm - last - (last - before)).abs());
            }
        }
        self.last = [last, chord_mm];
        self.count += 1;
    }

    /// Adds the chords of the part of the run that follows.
    pub(crate) fn join(&mut self, other: &Self) {
        let bend = self.bend_max_mm;
        for chord in other.first.iter().take(usize::try_from(other.count).unwrap_or(2)) {
            self.add(*chord);
        }
        self.change_max_mm = self.change_max_mm.max(other.change_max_mm);
        self.bend_max_mm = greater(greater(bend, self.bend_max_mm), other.bend_max_mm);
        if other.count > 2 {
            self.count += other.count - 2;
            self.last = other.last;
        }
    }

    /// The largest acceleration along the path, `|c_{i+1} - c_i|/T²`, in mm/s², for periods T in s.
    #[must_use]
    pub fn acceleration_max_mm_per_s2(&self, period_s: f64) -> f64 {
        self.change_max_mm / period_s.powi(2)
    }

    /// The largest change of acceleration over the period T, `|c_{i+1} - 2 c_i + c_{i-1}|/T³`, in mm/s³; 0 for fewer
    /// than three chords, and NaN if a chord is.
    #[must_use]
    pub fn jerk_max_mm_per_s3(&self, period_s: f64) -> f64 {
        self.bend_max_mm / period_s.powi(3)
    }
}

/// Mean and largest of a count per period.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PerPeriod {
    /// Mean over the periods.
    pub mean: f64,
    /// Largest in a period.
    pub max: u32,
    /// The number of periods with the largest.
    pub periods_at_max: u64,
}

/// A count per period of a run of which periods are added, or parts are joined.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct CountTally {
    periods: u64,
    sum: u64,
    max: u32,
    at_max: u64,
}

impl CountTally {
    pub(crate) fn add(&mut self, count: u32) {
        self.join(&Self { periods: 1, sum: count.into(), max: count, at_max: 1 });
    }

    pub(crate) fn join(&mut self, other: &Self) {
        self.periods += other.periods;
        self.sum += other.sum;
        match self.max.cmp(&other.max) {
            Ordering::Less => (self.max, self.at_max) = (other.max, other.at_max),
            Ordering::Equal => self.at_max += other.at_max,
            Ordering::Greater => (),
        }
    }

    pub(crate) fn per_period(&self) -> PerPeriod {
        let mean = if self.periods > 0 { self.sum as f64 / self.periods as f64 } else { 0.0 };
        PerPeriod { mean, max: self.max, periods_at_max: self.at_max }
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    fn step(wanted: f64, shortfall: f64) -> JudgedStep {
        JudgedStep {
            wanted_mm: wanted,
            chord_mm: wanted - shortfall,
            arc_mm: wanted - shortfall,
            feed_mm: wanted,
            shortfall_mm: shortfall,
            commanded_shortfall_mm: 2.0 * shortfall,
            chord_error_mm: 0.0,
            passes_corner: false,
            turn: None,
            position_error_mm: 0.0,
        }
    }

    fn jerk_of_chords(chords_mm: &[f64], period_s: f64) -> f64 {
        let mut chords = ChordTally::default();
        chords_mm.iter().for_each(|chord| chords.add(*chord));
        chords.jerk_max_mm_per_s3(period_s)
    }

    #[test]
    fn the_jerk_of_chords_is_that_of_their_second_differences() {
        // The accelerations are 0, -1, -2, 1.
        let chords = [4.0, 4.0, 3.0, 1.0, 2.0];
        assert_eq!(jerk_of_chords(&chords, 1.0), 3.0);
        assert_eq!(jerk_of_chords(&chords, 0.5), 8.0 * 3.0);
        assert_eq!([jerk_of_chords(&chords[..2], 1.0), jerk_of_chords(&[], 1.0)], [0.0; 2]);
        assert!(jerk_of_chords(&[f64::NAN, 4.0, 4.0, 4.0], 1.0).is_nan());
    }

    proptest! {
        /// A run in two parts, wherever it is cut, has the figures of the whole.
        #[test]
        fn figures_do_not_depend_on_where_a_run_is_cut(
            lengths in proptest::collection::vec((0.0_f64..1.0, -0.1_f64..0.1), 1..20),
            cut in 0_usize..20,
        ) {
            let steps: Vec<_> = lengths.iter().map(|(wanted, shortfall)| step(*wanted, *shortfall)).collect();
            let (first, second) = steps.split_at(cut.min(steps.len()));
            let tally = |steps: &[JudgedStep]| {
                let (mut figures, mut chords) = (FluctuationTally::new(0.8), ChordTally::default());
                for (i, step) in steps.iter().enumerate() {
                    figures.add(step, i);
                    chords.add(step.chord_mm);
                }
                (figures, chords)
            };
            let (mut joined, mut chords) = tally(first);
            let (others, other_chords) = tally(second);
            joined.join(others, |place| place + first.len());
            chords.join(&other_chords);
            let figures = |tally: FluctuationTally<usize>| tally.figures(cut % 2 == 0);
            let ((mut found, at), (whole, expected_at)) = (figures(joined), figures(tally(&steps).0));
            prop_assert!((found.mean_abs - whole.mean_abs).abs() <= 1e-15);
            found.mean_abs = whole.mean_abs;
            prop_assert_eq!((found, at), (whole, expected_at));
            let all: Vec<f64> = steps.iter().map(|step| step.chord_mm).collect();
            prop_assert_eq!(chords.jerk_max_mm_per_s3(0.5), jerk_of_chords(&all, 0.5));
            let change = all.windows(2).fold(0.0, |most: f64, pair| most.max((pair[1] - pair[0]).abs()));
            prop_assert_eq!(chords.acceleration_max_mm_per_s2(0.5), 4.0 * change);
        }
    }

    #[test]
    fn short_steps_count_in_all_figures_but_the_cruise() {
        let run = [step(0.6, 0.0006), step(0.6, -0.0012), step(0.001, 0.0005)];
        let figures = Fluctuation::of(&run, 0.6);
        assert_eq!((figures.max, figures.min), (0.5, -0.002));
        assert_eq!((figures.cruise_max_abs, figures.length_error_mm_max), (0.002, 0.0012));
        assert_eq!(figures.commanded_cruise_max_abs, 0.004);
        assert!((figures.mean_abs - (0.001 + 0.002 + 0.5) / 3.0).abs() < 1e-15);
    }

    /// If the plan never reaches the feed, its longest steps are still judged.
    #[test]
    fn where_the_plan_stays_far_below_the_feed_its_longest_steps_are_the_cruise() {
        let run = [step(0.001, 0.0005), step(0.04, 0.0002), step(0.01, 0.0001), step(0.6, 0.3)];
        assert_eq!(Fluctuation::of(&run, 0.6).cruise_max_abs, 0.01);
    }

    /// A plan that ends in motion ends within a step at cruise, which takes the rest of the path. From full feed to rest, the
    /// last step is one like the others.
    #[test]
    fn the_last_step_is_at_cruise_if_the_run_ends_at_rest() {
        let run = [step(0.6, 0.0006), step(0.6, -0.0012), step(0.6, 0.3)];
        let mut tally = FluctuationTally::new(0.6);
        run.iter().for_each(|step| tally.add(step, ()));
        for (ends_at_rest, expected) in [(false, 0.002), (true, 0.5)] {
            let figures = tally.figures(ends_at_rest).0;
            assert_eq!(
                (figures.cruise_max_abs, figures.commanded_cruise_max_abs),
                (expected, 2.0 * expected)
            );
            assert_eq!((figures.length_error_mm_max, figures.max), (0.0012, 0.5));
        }
    }

    /// `f64::max` returns the other number if one is NaN.
    #[test]
    fn a_figure_that_is_no_number_is_not_lost() {
        for at in 0..3 {
            let mut steps = [step(1.0, 0.1); 4];
            steps[at] = step(1.0, f64::NAN);
            let found = Fluctuation::of(&steps, 1.0);
            assert!(
                found.max.is_nan() && found.cruise_max_abs.is_nan() && found.length_error_mm_max.is_nan()
            );
        }
    }

    #[test]
    fn counts_have_mean_and_maximum() {
        let of = |counts: &[u32]| {
            let mut tally = CountTally::default();
            counts.iter().for_each(|count| tally.add(*count));
            tally.per_period()
        };
        assert_eq!(of(&[3, 4, 5]), PerPeriod { mean: 4.0, max: 5, periods_at_max: 1 });
        assert_eq!(of(&[2, 1, 2, 0, 2]), PerPeriod { mean: 1.4, max: 2, periods_at_max: 3 });
        assert_eq!(of(&[]), PerPeriod { mean: 0.0, max: 0, periods_at_max: 0 });
    }
}
