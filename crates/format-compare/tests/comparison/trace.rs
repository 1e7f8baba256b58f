//! Traces of runs beside their rows.

use format_compare::{Engine, Options, Watch, compare, compare_with, select};

use crate::examples::{EXAMPLE, on_example_machine};

/// The figures of a row are those of its trace, and keeping traces changes no row.
#[test]
fn a_trace_holds_the_figures_of_its_row() {
    let problem = on_example_machine::<2>(EXAMPLE, "");
    let formats = select::<2>(&["I4F28", "f64"]).expect("formats");
    let engines = [Engine::DeBoorSecant, Engine::Pieces];
    let watch = Watch { traces: true, ..Watch::default() };
    let compared =
        compare_with(&problem, &formats, &engines, &Options::default(), &watch).expect("a comparison");
    let (comparison, traces) = (compared.comparison, compared.traces);
    let plain = compare(&problem, &formats, &engines, &Options::default()).expect("a comparison");
    assert_eq!(traces.len(), 4);
    for ((row, again), trace) in comparison.formats.iter().zip(&plain.formats).zip(traces) {
        assert_eq!(row.fluctuation, again.fluctuation);
        let Some(trace) = trace else {
            assert_eq!(row.fluctuation, None);
            continue;
        };
        let largest = |of: &[f64]| of.iter().copied().fold(0.0, f64::max);
        assert_eq!(row.fluctuation.map(|of| of.max), Some(largest(&trace.fluctuation)));
        assert_eq!(row.chord_error_mm_max, Some(largest(&trace.chord_error_mm)));
        assert_eq!(row.evaluations.map(|e| e.max as usize + 1), Some(trace.evaluations.len()));
        assert_eq!((row.periods, trace.evaluations.iter().sum()), (Some(trace.periods()), trace.periods()));
        let lengths = [trace.point_mm.len(), trace.wanted_mm.len(), trace.entries()];
        assert_eq!(lengths.map(|length| length as u64), [trace.periods(); 3]);
        assert!(trace.histograms.contains_key("step") || trace.histograms.contains_key("secant_residual"));
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
