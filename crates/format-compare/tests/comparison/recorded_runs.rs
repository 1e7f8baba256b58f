//! The operations of each step of a run.

use format_compare::{ExactPlan, Options, format_named};

use crate::examples::on_example_machine;

/// On stairs of equal steps, every kind of period occurs more than once, including the one from rest and the one
/// onto a stop.
#[test]
fn what_is_recorded_comes_to_rest_at_every_stop() {
    let problem = on_example_machine::<3>("G1 X16 F6000\nY16\nX32\nY32\nX48\nY48\n", "");
    let plan = ExactPlan::in_format::<f64, 3>(&problem, [0.0; 2]).unwrap();
    let (format, options) = (format_named::<3>("I8F24").unwrap(), Options::default());
    let run = format.run(&problem, &plan, &options).unwrap();
    let recorded = format.record(&problem, &plan, &options, usize::MAX).unwrap();
    let counts: Vec<_> = recorded.steps.iter().map(|(_, count)| *count as usize).collect();
    assert_eq!(counts.iter().sum::<usize>(), run.steps.len());
    assert!(counts.iter().all(|count| *count > 1), "{counts:?}");
}
