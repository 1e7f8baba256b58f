//! The fewest periods that a plan can take, by the limits of the machine.

use format_compare::{ExactPlan, LeastPeriods, Machine, Problem};

use crate::examples::{EXAMPLE, on_example_machine};

type Change = fn(&mut Machine);

fn problem(change: Change) -> Problem<2> {
    let mut problem = on_example_machine(EXAMPLE, "");
    change(&mut problem.machine);
    problem
}

/// No plan takes fewer periods. Where one limit dominates, a plan takes at most so many times more.
#[test]
fn no_plan_takes_fewer_periods() {
    let changes: [(Change, &str, f64); 9] = [
        (|_| {}, "chord", 2.0),
        (|m| m.axes.x.velocity_mm_per_s = Some(1.0), "velocity of X", 1.3),
        (|m| m.axes.y.acceleration_mm_per_s2 = Some(10.0), "acceleration of Y", 6.0),
        (|m| m.axes.x.jerk_mm_per_s3 = Some(0.1), "jerk of X", 9.0),
        (|m| m.feedrate_mm_per_s = 5.0, "feedrate", 1.02),
        (|m| m.acceleration_mm_per_s2 = 5.0, "acceleration", 1.6),
        (|m| m.jerk_mm_per_s3 = 10.0, "jerk", 2.0),
        (|m| m.chord_error_mm = 1e-6, "chord", 1.6),
        (|m| m.centripetal_acceleration_mm_per_s2 = Some(0.5), "centripetal", 1.8),
    ];
    for (change, word, most) in changes {
        let problem = problem(change);
        // A path whose axes are so slow begins and ends at rest.
        let ends = if word.contains(" of ") { &[[0.0; 2]][..] } else { &[[0.0; 2], [1.0, 2.0]] };
        for &ends in ends {
            let plan = ExactPlan::in_format::<f64, 2>(&problem, ends).expect("a plan");
            let (planned, least) = (plan.periods() as f64, LeastPeriods::of(&problem, ends));
            assert!(least.periods <= planned, "{word}: {planned} {least}");
            assert!(least.periods * most >= planned, "{word}: {planned} {least}");
            assert!(least.to_string().contains(word) || word == "chord", "{word}: {least}");
        }
    }
}

/// Limits that no machine has are refused, each by its name.
#[test]
fn what_would_take_days_is_seen() {
    let changes: [(Change, &str); 7] = [
        (|m| m.axes.y.velocity_mm_per_s = Some(1e-17), "a velocity of Y of 1e-17 mm/s"),
        (|m| m.axes.x.acceleration_mm_per_s2 = Some(1e-17), "an acceleration of X of 1e-17 mm/s²"),
        (|m| m.axes.x.jerk_mm_per_s3 = Some(1e-26), "a jerk of X of 1e-26 mm/s³"),
        (|m| m.interpolation_period_ms = 1e-9, "periods of 0.000000001 ms"),
        (|m| m.acceleration_mm_per_s2 = 1e-17, "an acceleration of 1e-17 mm/s²"),
        (|m| m.jerk_mm_per_s3 = 1e-26, "a jerk of 1e-26 mm/s³"),
        (|m| m.chord_error_mm = 1e-22, "a chord error of 1e-22 mm"),
    ];
    assert!(!LeastPeriods::of(&problem(|_| {}), [0.0; 2]).are_too_many());
    for (change, words) in changes {
        let least = LeastPeriods::of(&problem(change), [0.0; 2]);
        assert!(least.are_too_many() && least.to_string().contains(words), "{least}");
    }
}
