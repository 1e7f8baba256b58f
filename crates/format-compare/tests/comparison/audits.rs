//! Audits: beside a run they change nothing, and what they say is of the run that is judged.

use std::collections::BTreeMap;
use std::sync::atomic::{AtomicUsize, Ordering};

use format_compare::{AboutRun, ExactPlan, Format, Observer, Options, Problem, RunStep, formats, select};
use real::{Extremes, FormatName, Real};

use crate::examples::{EXAMPLE, on_example_machine};
use crate::vectors::rows;

/// Looks at nothing, and wants the signals or not.
struct Wanting {
    signals: bool,
    stretches: AtomicUsize,
}

impl Observer for Wanting {
    fn wants_signals(&self) -> bool {
        self.signals
    }

    fn look(&self, _: usize, _: &mut dyn Iterator<Item = RunStep>) {
        self.stretches.fetch_add(1, Ordering::Relaxed);
    }

    fn take(&self, _: usize) {}
}

/// The run in a format, with its signals by name or without.
fn run<const D: usize>(
    format: &dyn Format<D>,
    (problem, plan): (&Problem<D>, &ExactPlan),
    signals: bool,
) -> AboutRun {
    let observer = Wanting { signals, stretches: AtomicUsize::new(0) };
    let run = format.run_before(problem, plan, &Options::default(), &observer).unwrap();
    assert!(run.finished && observer.stretches.into_inner() > 0, "{}", format.name());
    run
}

/// Long moves in many directions, slow and fast, and a bend. Without names, periods that are like others are left out.
#[test]
fn extremes_are_those_of_all_periods() {
    let text = "G1 X16 F600\nX-20 Y30 Z1\nG2 X0 Y0 R40\nG1 X7.3 Z-4\nX7.35\nX60 F90\n";
    let problem = on_example_machine::<3>(text, "");
    let plan = ExactPlan::in_format::<f64, 3>(&problem, [0.0; 2]).unwrap();
    for format in select(&["f64", "f32", "I8F24", "I4F28", "I4F60", "I4F12"]).unwrap() {
        let [few, all] = [false, true].map(|signals| run(format.as_ref(), (&problem, &plan), signals));
        let audit = all.audit.unwrap();
        assert!(few.audit.is_none() && audit.signals.len() > 5, "{}", format.name());
        assert_eq!(few.extremes, Extremes::from(&audit), "{}", format.name());
    }
}

/// The value of a register's bits.
fn value(format: FormatName, bits: &str) -> f64 {
    let bits = u64::from_str_radix(bits, 16).unwrap();
    match format {
        FormatName::Fixed { integer_bits, fraction_bits, .. } => {
            let unused = 64 - integer_bits - fraction_bits;
            let word = (bits << unused).cast_signed() >> unused;
            (word as f64).ldexp(-i32::try_from(fraction_bits).unwrap())
        }
        FormatName::Float { bits: 32 } => f32::from_bits(u32::try_from(bits).unwrap()).into(),
        _ => f64::from_bits(bits),
    }
}

/// The most values of a name that the start of a run has before its first period: the begin of the first piece, and the
/// evaluations by which the first step per chord is found. They are in an audit and in no period of the vectors.
const MOST_AT_THE_START: u64 = 40;

/// Test vectors list each value that a step names; an audit has their ranges, and counts each of them, in every format. That
/// the vectors are of the run that is judged is tested beside them.
#[test]
fn an_audit_has_the_ranges_of_the_run_s_own_values() {
    let problem = on_example_machine::<2>(EXAMPLE, "");
    let plan = ExactPlan::in_format::<f64, 2>(&problem, [0.0; 2]).unwrap();
    for format in formats::<2>() {
        let Ok(vectors) = format.vectors(&problem, &plan, &Options::default()) else { continue };
        let mut ranges = BTreeMap::<&str, (u64, f64, f64)>::new();
        for row in rows(&vectors.signals.csv) {
            let name = vectors.about.signals[row("signal").parse::<usize>().unwrap()];
            let x = value(format.name(), &row("word"));
            let (count, min, max) = ranges.entry(name).or_insert((0, x, x));
            (*count, *min, *max) = (*count + 1, min.min(x), max.max(x));
        }
        let audit = run(format.as_ref(), (&problem, &plan), true).audit.unwrap();
        let found: BTreeMap<_, _> =
            audit.signals.iter().map(|(name, range)| (*name, (range.count, range.min, range.max))).collect();
        for (name, (count, min, max)) in ranges {
            let (all, least, most) = found[name];
            let about =
                format!("{} {name}: {count} of {all}, {min} to {max} in {least} to {most}", format.name());
            // A word of 64 bits is rounded as it becomes a float.
            let rounding = 4.0 * f64::EPSILON * min.abs().max(max.abs());
            assert!(least - rounding <= min && max <= most + rounding, "{about}");
            assert!((count..=count + MOST_AT_THE_START).contains(&all), "{about}");
            assert!(name != "offset" || all == count + 2, "one value of each axis at the begin: {about}");
        }
    }
}
