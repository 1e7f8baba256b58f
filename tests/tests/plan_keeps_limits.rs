//! Every point of a plan sampled at ten times the period keeps feed, acceleration, jerk and chord error.

use feedbits_tests::{PAPER_A, PAPER_D, circle, degree_5, double_knot, on_paper_as_machine, problem};
use format_compare::{ExactPlan, PlanSummary, Problem};
use nurbs_core::{Differentiate, radius};

/// Relative slack: rounding only.
const SLACK: f64 = 1e-9;

fn keeps_every_limit<const D: usize>(problem: &Problem<D>) {
    let plan =
        ExactPlan::in_format::<f64, D>(problem, [0.0; 2]).unwrap_or_else(|e| panic!("{}: {e}", problem.name));
    let machine = &problem.machine;
    let t = problem.period_s();
    for sample in plan.sampled(problem, 10).expect("it was planned") {
        let within = |what: &str, value: f64, limit: f64| {
            assert!(
                value <= limit * (1.0 + SLACK),
                "{}: {what} {value} > {limit} at {sample:?}",
                problem.name
            );
        };
        within("feed", sample.feed_mm_per_s, machine.feedrate_mm_per_s);
        within("feed", sample.feed_mm_per_s, sample.limit_mm_per_s);
        within("acceleration", sample.acceleration_mm_per_s2.abs(), machine.acceleration_mm_per_s2);
        within("jerk", sample.jerk_mm_per_s3.abs(), machine.jerk_mm_per_s3);
        let rho = radius(&problem.curves[0].as_curve().derivatives(sample.u));
        let half_step = sample.feed_mm_per_s * t / 2.0;
        if half_step < rho {
            // ρ - √(ρ² - (L/2)²), without the difference of two large numbers.
            let chord_error = half_step * half_step / (rho + (rho * rho - half_step * half_step).sqrt());
            assert!(
                chord_error <= machine.chord_error_mm * (1.0 + 1e-4),
                "{}: chord error {chord_error} at {sample:?}",
                problem.name
            );
        }
    }
    let summary = PlanSummary::of(&plan, problem).expect("it was planned");
    assert!(summary.time_s >= summary.jerk_free_time_s, "{}: faster than the bound", problem.name);
    let travelled: f64 = summary.stages.iter().map(|s| s.length_mm).sum();
    assert!(
        (travelled - summary.length_mm).abs() < 0.01,
        "{}: {travelled} of {}",
        problem.name,
        summary.length_mm
    );
}

#[test]
fn paper_a() {
    keeps_every_limit(&problem::<2>("paper A", PAPER_A));
}

/// Within 2 % of the bound that ignores jerk, 4.848 s.
#[test]
fn paper_a_is_planned_fast() {
    let problem = problem::<2>("paper A", PAPER_A);
    let plan = ExactPlan::in_format::<f64, 2>(&problem, [0.0; 2]).expect("it can be planned");
    let summary = PlanSummary::of(&plan, &problem).expect("it was planned");
    assert!((summary.jerk_free_time_s - 4.848).abs() < 2e-3, "{}", summary.jerk_free_time_s);
    assert!(summary.time_s < 1.02 * summary.jerk_free_time_s, "{}", summary.time_s);
}

#[test]
fn paper_d() {
    keeps_every_limit(&problem::<2>("paper D", PAPER_D));
}

#[test]
fn other_curves() {
    keeps_every_limit(&on_paper_as_machine("circle", circle()));
    keeps_every_limit(&on_paper_as_machine("degree 5", degree_5()));
    keeps_every_limit(&on_paper_as_machine("double knot", double_knot()));
}

/// Paper A's own procedure breaks down here: on short flanks its stages overlap.
#[test]
fn short_flanks() {
    let mut problem = problem::<2>("paper D, slow", PAPER_D);
    problem.machine.acceleration_mm_per_s2 = 1000.0;
    problem.machine.jerk_mm_per_s3 = 20_000.0;
    keeps_every_limit(&problem);
}
