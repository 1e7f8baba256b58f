//! Figures over a whole run.

use serde::Serialize;

use crate::run::run::cruise_mm;

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
    /// steps of at least a quarter of the longest step. The last step does not count: it takes the rest of the path,
    /// even if it is passed at full feed. A relative figure of a micrometre step near rest says nothing about the cut,
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
    /// `wanted - chord`, in mm, subtracted before rounding to f64.
    pub shortfall_mm: f64,
    /// `wanted - chord`, in mm, for the chord between the commanded points.
    pub commanded_shortfall_mm: f64,
    /// Largest distance of the curve from the chord, in mm.
    pub chord_error_mm: f64,
    /// Whether the chord passes a corner of the path, a joint at which the tangent breaks.
    pub passes_corner: bool,
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
        let mut result = Self::default();
        let wanted = steps.iter().take(steps.len().saturating_sub(1)).map(|step| step.wanted_mm);
        let cruise = cruise_mm(wanted, full_step_mm);
        for (index, step) in steps.iter().enumerate() {
            let delta = step.fluctuation();
            if index == 0 {
                (result.max, result.min) = (delta, delta);
            }
            result.max = greater(result.max, delta);
            result.min = result.min.min(delta);
            result.mean_abs += delta.abs();
            if index + 1 == steps.len() {
                continue;
            }
            result.length_error_mm_max = greater(result.length_error_mm_max, step.shortfall_mm.abs());
            if step.wanted_mm >= cruise || delta.is_nan() {
                result.cruise_max_abs = greater(result.cruise_max_abs, delta.abs());
                let commanded = step.commanded_fluctuation().abs();
                result.commanded_cruise_max_abs = greater(result.commanded_cruise_max_abs, commanded);
            }
        }
        result.mean_abs /= steps.len().max(1) as f64;
        result
    }
}

/// The greater of two figures, or NaN if either is NaN: a NaN must not be lost before it is judged.
pub(crate) fn greater(one: f64, other: f64) -> f64 {
    if one.is_nan() || other <= one { one } else { other }
}

/// The largest change of acceleration along the path from one period to the next, over the period T, in mm/s³:
/// `|c_{i+1} - 2 c_i + c_{i-1}|/T³` for the chords c between the exact points. It is taken from the second period on.
/// If a run ends at rest, two periods of rest are appended, so the figure shows a format that ends short of the path's
/// end.
pub(crate) fn jerk_max_mm_per_s3(steps: &[JudgedStep], period_s: f64, ends_at_rest: bool) -> f64 {
    let rest = [0.0; 2].into_iter().take(if ends_at_rest { 2 } else { 0 });
    let chords: Vec<f64> = steps.iter().map(|step| step.chord_mm).chain(rest).collect();
    jerk_of_chords(&chords, period_s)
}

/// The largest `|c_{i+1} - 2 c_i + c_{i-1}|/T³`, in mm/s³, for the chords c of successive periods T, in mm and s; 0 for
/// fewer than three chords.
#[must_use]
pub fn jerk_of_chords(chords_mm: &[f64], period_s: f64) -> f64 {
    let bends = chords_mm.windows(3).map(|three| (three[2] - three[1] - (three[1] - three[0])).abs());
    bends.fold(0.0, greater) / period_s.powi(3)
}

/// Mean and largest of a count per period.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct PerPeriod {
    /// Mean over the periods.
    pub mean: f64,
    /// Largest in a period.
    pub max: u32,
}

impl PerPeriod {
    /// Mean and largest of `counts`.
    #[must_use]
    pub fn of(counts: impl IntoIterator<Item = u32>) -> Self {
        let (mut sum, mut number, mut max) = (0.0, 0.0, 0);
        for count in counts {
            sum += f64::from(count);
            number += 1.0;
            max = max.max(count);
        }
        Self { mean: if number > 0.0 { sum / number } else { 0.0 }, max }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn step(wanted: f64, shortfall: f64) -> JudgedStep {
        JudgedStep {
            wanted_mm: wanted,
            chord_mm: wanted - shortfall,
            shortfall_mm: shortfall,
            commanded_shortfall_mm: 2.0 * shortfall,
            chord_error_mm: 0.0,
            passes_corner: false,
            position_error_mm: 0.0,
        }
    }

    #[test]
    fn the_jerk_of_a_run_has_its_last_step_in_it() {
        let steps = [4.0, 4.0, 3.0, 1.0, 2.0].map(|chord| step(chord, 0.0));
        // The accelerations are 0, -1, -2, 1, and behind the end -2, 0.
        assert_eq!(jerk_max_mm_per_s3(&steps, 1.0, false), 3.0);
        assert_eq!(jerk_max_mm_per_s3(&steps[..4], 1.0, true), 1.0);
        assert_eq!(jerk_max_mm_per_s3(&steps, 0.5, true), 8.0 * 3.0);
        assert_eq!(jerk_max_mm_per_s3(&steps[..1], 1.0, true), 4.0);
        assert_eq!(jerk_max_mm_per_s3(&[], 1.0, true), 0.0);
        let lost = JudgedStep { chord_mm: f64::NAN, ..steps[0] };
        assert!(jerk_max_mm_per_s3(&[lost, steps[0], steps[0], steps[0]], 1.0, false).is_nan());
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

    /// A plan that ends in motion ends within a step at cruise.
    #[test]
    fn the_last_step_is_no_cruise() {
        let run = [step(0.6, 0.0006), step(0.6, -0.0012), step(0.6, 0.3)];
        let figures = Fluctuation::of(&run, 0.6);
        assert_eq!((figures.cruise_max_abs, figures.length_error_mm_max, figures.max), (0.002, 0.0012, 0.5));
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
        assert_eq!(PerPeriod::of([3, 4, 5]), PerPeriod { mean: 4.0, max: 5 });
        assert_eq!(PerPeriod::of([]), PerPeriod { mean: 0.0, max: 0 });
    }
}
