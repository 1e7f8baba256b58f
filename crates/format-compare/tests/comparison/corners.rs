//! Corners that a run passes, and what they are judged by.

use std::fmt::Write;

use format_compare::{ExactPlan, JudgedRun, JudgedStep, Options, Problem, Reference, RunStep, format_named};

use crate::examples::{judged, mill, on_example_machine};

const DEVIATION: &str = "junction = \"deviation\"\njunction_deviation_mm = 0.01\n";

/// A place: the number of a curve, and its parameter.
type Place = (usize, (f64, f64));

/// The step from a place to another, as the reference judges it.
fn step<const D: usize>(problem: &Problem<D>, from: Place, to: Place) -> JudgedStep {
    let onto = |(curve, u): Place| RunStep {
        curve,
        u,
        point_mm: [0.0; 3],
        wanted_mm: (1.0, 0.0),
        feed_mm_per_s: 1.0,
        evaluations: 1,
    };
    Reference::new(problem).unwrap().judge(&[onto(from), onto(to)])[1]
}

/// A corner of 30°, passed at 16.8 mm/s, is cut by up to 2.2 µm of the 10 µm allowed. Every format was once judged
/// bad there, by the chord error.
#[test]
fn a_passed_corner_is_judged_by_what_it_may_be_cut_by() {
    let mut part = String::from("G0 X0 Y0\nG91\n");
    for i in 0..24 {
        // The lengths differ, so that corners are cut at many different places within a period.
        let (length, is_level) = (3.0 + 0.0137 * f64::from(i), i % 2 == 0);
        let (x, y) = if is_level { (length, 0.0) } else { (0.866_025 * length, 0.5 * length) };
        writeln!(part, "G1 X{x:.6} Y{y:.6} F3000").unwrap();
    }
    let judged = |junction| judged(&mill::<2>(&part, junction), &["f64"]).remove(0);
    let row = judged(DEVIATION);
    let (chord, corner) = (row.chord_error_mm_max.unwrap(), row.corner_error_mm_max.unwrap());
    assert!(
        row.verdict.is_good() && chord < 1e-9 && corner > 1e-3 && corner < 1e-2,
        "{chord} {corner} {}",
        row.verdict
    );
    let limit =
        |row: &JudgedRun| row.requirements.iter().find(|one| one.what == "corner error").unwrap().limit;
    assert!((limit(&row) - 0.01 * 1.005).abs() < 1e-9);
    let stops = judged("");
    assert!(stops.corner_error_mm_max == Some(0.0) && (limit(&stops) - 0.001 * 1.005).abs() < 1e-9);
    // For a corner that is passed with a jump of velocity, the chord error is still the limit.
    let jumps = judged(
        "junction = \"velocity-jump\"\n[machine.axes.x]\nvelocity_jump_mm_per_s = 20\n\
                        [machine.axes.y]\nvelocity_jump_mm_per_s = 20\n",
    );
    assert!(jumps.verdict.to_string().starts_with("corner error "), "{}", jumps.verdict);
    assert!(jumps.verdict.to_string().contains("mm of `chord_error_mm` in line "), "{}", jumps.verdict);
}

/// The curves at whose begin a step passes a corner.
fn corners<const D: usize>(problem: &Problem<D>) -> Vec<usize> {
    let passes = |curve: &usize| step(problem, (curve - 1, (0.5, 0.0)), (*curve, (0.5, 0.0))).passes_corner;
    (1..problem.curves.len()).filter(passes).collect()
}

/// A chord passes no corner at a smooth joint, at an exact stop, or where it only begins or ends at a corner.
#[test]
fn corners_are_where_the_tangent_breaks_within_a_chord() {
    let part =
        "G0 X0 Y0\nG1 X10 F3000\nG1 X20\nG1 X20 Y10\nG9 G1 X30\nG1 X30 Y20\nG2 X40 Y30 I10\nG1 X50 Y31\n";
    let problem = mill::<2>(part, DEVIATION);
    assert_eq!(corners(&problem), [2, 3, 6]);
    let from_to =
        |from: (usize, f64), to: (usize, f64)| step(&problem, (from.0, (from.1, 0.0)), (to.0, (to.1, 0.0)));
    // From corner to corner: 5 mm to the first, 10 mm to the second, and 5 mm on.
    assert_eq!(from_to((1, 0.5), (3, 0.5)).chord_mm, 20.0);
    for (from, to) in [((1, 0.5), (2, 0.0)), ((1, 0.5), (1, 1.0)), ((1, 1.0), (2, 0.5)), ((2, 0.0), (2, 0.5))]
    {
        assert!(!from_to(from, to).passes_corner, "{from:?} {to:?}");
    }
    assert!(step(&problem, (1, (1.0, -1e-17)), (2, (0.0, 1e-30))).passes_corner);
}

#[test]
fn a_knot_of_full_multiplicity_may_be_a_corner() {
    let passes = |points: &str, from: f64, to: f64| {
        let part = format!("[[curve]]\ndegree = 1\nknots = [0, 0, 1, 2, 2]\ncontrol_points_mm = {points}\n");
        step(&mill::<2>(&part, DEVIATION), (0, (from, 0.0)), (0, (to, 0.0))).passes_corner
    };
    let corner = "[[0, 0], [10, 0], [10, 10]]";
    assert!(passes(corner, 0.5, 1.5) && !passes(corner, 0.5, 1.0) && !passes(corner, 1.0, 1.5));
    assert!(!passes("[[0, 0], [10, 0], [15, 0]]", 0.5, 1.5));
}

/// Thousands of straight moves along a circle of 1 mm: each corner is within the limit, and a chord passes many of
/// them. Chords over joints were once not judged.
#[test]
fn a_chord_over_joints_is_judged() {
    let mut program = String::from("G0 X1 Y0\n");
    for i in 1..=6283 {
        let (y, x) = (f64::from(i) * 1e-3).sin_cos();
        writeln!(program, "G1 X{x:.9} Y{y:.9} F12000").unwrap();
    }
    let problem = on_example_machine::<2>(&program, "");
    let row = judged(&problem, &["f64"]).remove(0);
    let plan = ExactPlan::in_format::<f64, 2>(&problem, [0.0; 2]).unwrap();
    let run = format_named("f64").unwrap().run(&problem, &plan, &Options::default()).unwrap();
    let longest = run.steps.iter().map(|step| step.wanted_mm.0).fold(0.0, f64::max);
    // Moves of 1 µm turn by 1e-3 rad: each chord passes corners.
    let (found, sagitta) = (row.corner_error_mm_max.unwrap(), longest * longest / 8.0);
    assert!((found / sagitta - 1.0).abs() < 0.05, "{found} mm, not {sagitta}");
    assert!(!row.verdict.is_good() || found <= 1.005 * problem.machine.chord_error_mm, "{}", row.verdict);
}
