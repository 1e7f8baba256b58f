//! The figures of each period of a run, from which charts are drawn.

use std::collections::BTreeMap;

use real::{Histogram, SignalRange};

use crate::judge::metrics::JudgedStep;
use crate::run::run::Run;

/// A run with a value for each period; entry i is the period that ends at time (i + 1)·T.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Trace {
    /// The commanded point at the end of the period, in mm, in the part's coordinates.
    pub point_mm: Vec<[f64; 3]>,
    /// The wanted chord, in mm.
    pub wanted_mm: Vec<f64>,
    /// Feedrate fluctuation δ, a ratio.
    pub fluctuation: Vec<f64>,
    /// Largest distance of the curve from the chord, in mm.
    pub chord_error_mm: Vec<f64>,
    /// Evaluations of the curve.
    pub evaluations: Vec<u32>,
    /// The range of each named signal over the whole run.
    pub signals: BTreeMap<&'static str, SignalRange>,
    /// A histogram of the magnitudes of each named signal.
    pub histograms: BTreeMap<&'static str, Histogram>,
}

impl Trace {
    /// The trace of a run. `steps` are its steps as the reference judged them, one for each step of the run.
    #[must_use]
    pub fn of(run: &Run, steps: &[JudgedStep]) -> Self {
        Self {
            point_mm: run.steps.iter().map(|step| step.point_mm).collect(),
            wanted_mm: steps.iter().map(|step| step.wanted_mm).collect(),
            fluctuation: steps.iter().map(JudgedStep::fluctuation).collect(),
            chord_error_mm: steps.iter().map(|step| step.chord_error_mm).collect(),
            evaluations: run.steps.iter().map(|step| step.evaluations).collect(),
            signals: run.audit.signals.clone(),
            histograms: run.audit.histograms.clone(),
        }
    }

    /// Number of periods.
    #[must_use]
    pub fn periods(&self) -> usize {
        self.fluctuation.len()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::examples::{EXAMPLE, on_example_machine};
    use crate::{Engine, Fluctuation, JudgedRun, Options, compare, compare_with, select};

    /// The figures of a row are those of its trace, and keeping traces changes no row.
    #[test]
    fn a_trace_holds_the_figures_of_its_row() {
        let problem = on_example_machine::<2>(EXAMPLE, "");
        let formats = select::<2>(&["I4F28", "f64"]).expect("formats");
        let engines = [Engine::DeBoorSecant, Engine::Pieces];
        let keep = |_: &JudgedRun, run: Option<(&Run, &[JudgedStep])>| {
            run.map(|(run, steps)| (Trace::of(run, steps), Fluctuation::of(steps, 0.6)))
        };
        let (comparison, kept) =
            compare_with(&problem, &formats, &engines, &Options::default(), keep).expect("a comparison");
        let plain = compare(&problem, &formats, &engines, &Options::default()).expect("a comparison");
        assert_eq!(kept.len(), 4);
        for ((row, again), kept) in comparison.formats.iter().zip(&plain.formats).zip(kept) {
            assert_eq!(row.fluctuation, again.fluctuation);
            let Some((trace, fluctuation)) = kept else {
                assert_eq!(row.fluctuation, None);
                continue;
            };
            assert_eq!(row.fluctuation, Some(fluctuation));
            let largest = |of: &[f64]| of.iter().copied().fold(0.0, f64::max);
            assert_eq!(row.chord_error_mm_max, Some(largest(&trace.chord_error_mm)));
            assert_eq!(row.evaluations.map(|e| e.max), trace.evaluations.iter().max().copied());
            assert_eq!(row.periods.map(|p| p as usize), Some(trace.periods()));
            let lengths = [trace.point_mm.len(), trace.wanted_mm.len(), trace.evaluations.len()];
            assert_eq!(lengths, [trace.periods(); 3]);
            assert!(
                trace.histograms.contains_key("step") || trace.histograms.contains_key("secant_residual")
            );
        }
    }

    /// In every format the largest fluctuation found is at least a quarter of the fluctuation that comes from rounding
    /// the solved quantity alone: of more than a thousand periods, at least one comes near it.
    #[test]
    fn fluctuation_is_of_the_order_of_the_resolution() {
        let problem = on_example_machine::<2>(EXAMPLE, "");
        let names = ["I16F16", "I8F24", "I4F28", "f32", "I32F32", "f64"];
        let formats = select::<2>(&names).expect("formats");
        let options = Options { fluctuation: Some(1e-15), ..Options::default() };
        for engine in [Engine::DeBoorSecant, Engine::Pieces] {
            let compared = compare(&problem, &formats, &[engine], &options).expect("a comparison");
            for row in compared.formats.iter().filter(|row| row.fluctuation.is_some()) {
                let (found, resolution) = (
                    row.fluctuation.map_or(0.0, |f| f.cruise_max_abs),
                    row.fluctuation_resolution.unwrap_or(0.0),
                );
                assert!(resolution > 0.0, "{} {engine}", row.format);
                assert!(found > 0.25 * resolution, "{} {engine}: {found} {resolution}", row.format);
            }
        }
    }
}
