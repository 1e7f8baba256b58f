//! Runs of plans that see a window of the path.

use format_compare::{Engine, Options, Problem, ProfileKind, RunStep, compare, plan_for, select};
use part_program::{read_machine, read_part};

const MACHINE: &str = "[machine]
    interpolation_period_ms = 1.0
    feedrate_mm_per_s = 100.0
    acceleration_mm_per_s2 = 2000.0
    jerk_mm_per_s3 = 100000.0
    chord_error_mm = 0.002
    fluctuation_limit = 1e-4
    junction = \"deviation\"
    junction_deviation_mm = 0.01\n";

/// Waves of arcs and lines of 180 mm in all, and then `behind`.
fn waves(behind: &str) -> Problem<2> {
    let mut part = String::from("G21 G90 G0 X0 Y0\nF6000\n");
    for i in 0..10 {
        let x = 12 * i;
        part += &format!("G3 X{} Y0 R2.5\nG2 X{} Y0 R3\nG1 X{} Y0.3\nG1 Y0\n", x + 4, x + 9, x + 12);
    }
    let part = read_part("waves.nc", &(part + behind)).expect("a part");
    Problem::new(&part, &read_machine("mill.toml", MACHINE).expect("a machine")).expect("a problem")
}

fn steps(problem: &Problem<2>, window_mm: f64, profile: ProfileKind) -> Vec<RunStep> {
    let options = Options { window_mm: Some(window_mm), profile, ..Options::default() };
    let formats = select::<2>(&["f64"]).expect("a format");
    let plan = plan_for(problem, formats[0].as_ref(), &options).expect("a plan");
    let run = formats[0].run(problem, &plan, &options).expect("a run");
    assert!(run.about.finished, "{profile:?}");
    run.steps
}

/// The window is 40 mm, and setpoints before 120 mm of 180 mm are compared. In fixed point the scales of the compiled path, which
/// follow from all of it, may change their last bits.
#[test]
fn what_lies_far_behind_changes_no_setpoint() {
    for profile in ProfileKind::ALL {
        let [a, b, c] = ["", "G1 X100 Y1\nG1 X1\n", "G1 X120 Y100\nG4 P1\nG2 X60 Y60 R60\n"]
            .map(|behind| steps(&waves(behind), 40.0, profile));
        let same = a.iter().position(|step| step.point_mm[0] > 80.0).expect("a step beyond 80 mm");
        assert!(same > 1000 && a.len() > same, "{same} of {}", a.len());
        assert!(a[..same] == b[..same] && a[..same] == c[..same], "{profile:?}");
        assert!(a != b && a != c);
    }
}

/// A run by arcs taken for chords comes ever further ahead of its plan.
#[test]
fn a_run_through_a_window_is_good_wherever_the_window_ends() {
    for chord_error_mm in [0.002, 0.02] {
        let mut problem = waves("G1 X100 Y10\nG4 P1\nG2 X60 Y60 R60\n");
        problem.machine.chord_error_mm = chord_error_mm;
        for profile in ProfileKind::ALL {
            for window in [1.0, 4.0, 15.0, 60.0, 1000.0] {
                let options = Options { window_mm: Some(window), profile, ..Options::default() };
                let formats = select::<2>(&["f64"]).expect("a format");
                let found = compare(&problem, &formats, &[Engine::Pieces], &options).expect("a comparison");
                let run = &found.formats[0];
                assert!(run.verdict.is_good(), "{chord_error_mm} {profile:?} {window}: {}", run.verdict);
            }
        }
    }
}
