//! What a plan asks of each axis.

use format_compare::{ExactPlan, PlanSummary, ProfileKind};

use crate::examples::on_example_machine;

fn summary(part: &str, axes: &str) -> PlanSummary {
    let problem = on_example_machine::<2>(part, axes);
    let plan = ExactPlan::in_format_with::<f64, 2>(&problem, [0.0; 2], ProfileKind::SCurve).unwrap();
    PlanSummary::of(&plan, &problem).unwrap()
}

#[test]
fn along_an_axis_the_path_s_values_are_the_axis_s() {
    let summary = summary("G0 X0 Y0\nG1 X100 F6000\n", "");
    let [x, y] = summary.axes.as_slice() else { panic!("two axes") };
    assert!((99.5..=100.0).contains(&x.velocity_max_mm_per_s), "{x:?}");
    assert!((x.acceleration_max_mm_per_s2 / summary.acceleration_max_mm_per_s2 - 1.0).abs() < 0.01, "{x:?}");
    assert!((x.jerk_max_mm_per_s3 / summary.jerk_max_mm_per_s3 - 1.0).abs() < 0.01, "{x:?}");
    assert_eq!((y.velocity_max_mm_per_s, y.jerk_max_mm_per_s3), (0.0, 0.0));
}

#[test]
fn on_a_circle_an_axis_turns_and_keeps_its_limits() {
    let circle = "G0 X0 Y0\nG2 I30 J0 F6000\n";
    let free = summary(circle, "");
    // At F on radius 30 the acceleration across is V²/r. The x axis has it where the path runs along y. Near the
    // start and the end, where the feed changes, x has a small share of that change too.
    let (x, turning) = (free.axes[0], 100.0_f64.powi(2) / 30.0);
    let used = x.acceleration_max_mm_per_s2 / turning;
    assert!((0.98..2.0).contains(&used), "{x:?}");
    let limits =
        "\n[machine.axes.x]\nvelocity_mm_per_s = 60\nacceleration_mm_per_s2 = 200\njerk_mm_per_s3 = 5000\n";
    let x = summary(circle, limits).axes[0];
    assert!(x.velocity_max_mm_per_s <= 60.0 * (1.0 + 1e-9) && x.velocity_max_mm_per_s > 30.0, "{x:?}");
    assert!(x.acceleration_max_mm_per_s2 <= 200.0 * (1.0 + 1e-9), "{x:?}");
    assert!(x.jerk_max_mm_per_s3 <= 5000.0 * (1.0 + 1e-6), "{x:?}");
}

/// At an inner knot of degree 2 the curvature steps. This step is not part of the jerk of the span on either side.
/// The plan keeps the jerk of the axes, and so do its samples.
#[test]
fn a_step_of_curvature_is_no_jerk() {
    let spline = "[curve]\ndegree = 2\ncontrol_points_mm = [[0, 0], [30, 40], [60, -20], [90, 30]]\nknots = [0, 0, 0, 1, 2, 2, 2]\n";
    let limits = "\n[machine.axes.x]\njerk_mm_per_s3 = 100000\n[machine.axes.y]\njerk_mm_per_s3 = 100000\n";
    for axis in &summary(spline, limits).axes[..2] {
        assert!(axis.jerk_max_mm_per_s3 <= 1e5 * 1.05, "{axis:?}");
    }
}

/// The jerk at the begin of a move was once counted for the axis of the move before.
#[test]
fn a_stop_begins_in_the_direction_of_the_next_move() {
    let limits = "\n[machine.axes.x]\njerk_mm_per_s3 = 10000\n";
    let summary = summary("G21 G90\nG0 X0 Y0\nG1 Y20 F6000\nG1 X5\nG1 Y30\n", limits);
    let [x, y] = summary.axes.as_slice() else { panic!("two axes") };
    assert!(x.jerk_max_mm_per_s3 <= 1e4 && x.jerk_max_mm_per_s3 > 9e3, "{x:?}");
    assert!((y.jerk_max_mm_per_s3 / summary.jerk_max_mm_per_s3 - 1.0).abs() < 0.01, "{y:?}");
}
