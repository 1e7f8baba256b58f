//! Plans sampled at instants.

use format_compare::{ExactPlan, FeedSample};
use nurbs_core::arc_length;

use crate::examples::{EXAMPLE, on_example_machine};

/// A long plan has few samples for a picture, and none of its transitions is missed.
#[test]
fn a_picture_of_a_long_plan_has_both_ends_of_each_stage() {
    let problem = on_example_machine::<2>(EXAMPLE, "");
    let plan = ExactPlan::in_format::<f64, 2>(&problem, [0.0; 2]).unwrap();
    let all = plan.sampled(&problem, 1).unwrap();
    let few = plan.sampled_for_a_picture(&problem, 100).unwrap();
    assert!(few.len() < all.len() / 3 && few.is_sorted_by(|a, b| a.time_s < b.time_s), "{}", few.len());
    let most = |of: &[FeedSample]| of.iter().fold(0.0, |most: f64, one| most.max(one.acceleration_mm_per_s2));
    assert!(most(&few) > 0.95 * most(&all));
    assert_eq!(few.last().map(|last| last.time_s), all.last().map(|last| last.time_s));
    let same = plan.sampled_for_a_picture(&problem, 1 << 20).unwrap();
    assert_eq!(same.len(), all.len());
}

/// Sums of chords were once taken for arc lengths. The last row was short of the end, and feeds stood beside the
/// limit of another place.
#[test]
fn the_places_of_samples_are_those_of_the_plan() {
    let mut problem = on_example_machine::<2>(EXAMPLE, "");
    problem.machine.chord_error_mm = 0.1;
    let plan = ExactPlan::in_format::<f64, 2>(&problem, [0.0; 2]).unwrap();
    let limit = plan.limit(&problem).unwrap();
    let chords: f64 = plan.lengths().map(|(length, _)| length.value()).sum();
    assert!(limit.length() - chords > 1e-3, "chords fall short: {chords} of {}", limit.length());
    let samples = plan.sampled(&problem, 2).unwrap();
    let last = samples.last().unwrap();
    assert!((last.distance_mm - limit.length()).abs() < 1e-9 && last.u > 1.0 - 1e-9, "{last:?}");
    for sample in &samples {
        assert!(sample.feed_mm_per_s <= sample.limit_mm_per_s * (1.0 + 1e-9), "{sample:?}");
        let length = arc_length(&problem.curves[0].as_curve(), 0.0, sample.u, 0.0).length;
        assert!((length - sample.distance_mm).abs() < 1e-9, "{length} {sample:?}");
    }
}
