//! Runs that stay with their plans.

use crate::examples::{example_machine, judged, on_example_machine};
use format_compare::{Engine, Options, Problem, ProfileKind, compare, select};
use part_program::{read_machine, read_part};

/// Limits of both axes like those of the path.
const AXES: &str = "\n[machine.axes.x]\nvelocity_mm_per_s = 200\nacceleration_mm_per_s2 = 5000\njerk_mm_per_s3 = 400000\n\
                    [machine.axes.y]\nvelocity_mm_per_s = 200\nacceleration_mm_per_s2 = 5000\njerk_mm_per_s3 = 400000\n";

/// The run gained on its plan in a bend and came to the next one, of a radius of 0.02 mm, a period early: its chord error was
/// twice the limit in every format.
#[test]
fn under_limits_of_axes_a_run_keeps_the_chord_error_in_tight_bends() {
    assert_eq!(example_machine("").chord_error_mm, 5e-4);
    let problem = on_example_machine::<2>(include_str!("butterfly.toml"), AXES);
    for run in judged(&problem, &["f64", "I8F24"]) {
        assert!(run.verdict.is_good(), "{}: {}", run.format, run.verdict);
    }
}

/// Without look-ahead a run has no limit of the jerk: along X it speeds up by A from one period to the next. From rest the third
/// difference of its places is A T²/2 or more, A/(2 J T) = 25/12 of the limit.
#[test]
fn a_run_that_breaks_the_jerk_of_an_axis_is_not_good() {
    let problem = on_example_machine::<2>("G0 X0 Y0\nG1 X60 F12000\n", AXES);
    for (profile, is_good) in [(ProfileKind::WithoutLookAhead, false), (ProfileKind::Fastest, true)] {
        let options = Options { profile, ..Options::default() };
        let formats = select(&["f64", "I8F24"]).unwrap();
        for run in compare(&problem, &formats, &[Engine::Pieces], &options).unwrap().formats {
            assert_eq!(run.verdict.is_good(), is_good, "{}: {}", run.format, run.verdict);
            let of = |what| run.requirements.iter().find(|one| one.what == what).unwrap();
            assert_eq!((of("jerk of X").holds(), of("acceleration of X").holds()), (is_good, true));
            assert!(
                of("velocity of X").found <= 1.0 && of("jerk of Y").found == 0.0,
                "{:?}",
                run.requirements
            );
            if !is_good {
                let jerk = of("jerk of X");
                assert!(jerk.found > 25.0 / 12.0 - 1e-3, "{jerk:?}");
                assert!(
                    jerk.at.is_some_and(|at| at.line == Some(2))
                        && run.verdict.to_string().contains("jerk of X")
                );
            }
        }
    }
    // A machine that limits no axis has no such row.
    let free = judged(&on_example_machine::<2>("G0 X0 Y0\nG1 X60 F12000\n", ""), &["f64"]).remove(0);
    assert!(free.requirements.iter().all(|one| !one.what.contains(" of X")), "{:?}", free.requirements);
}

/// A curve, and a machine that stops from its feed within a period.
const RANDOM: &str = "\
[curve]
degree = 2
control_points_mm = [[30.0181, -32.3787, 1.0437], [37.0093, 17.9752, 17.501], [-9.0436, 39.0714, 17.1339], [30.2826, 24.1201, -32.2284], [-27.9518, -2.1109, 19.0254], [27.8104, -12.3854, 39.0034], [8.743, -37.6678, -33.7484], [21.8768, -33.8657, -11.1783], [-13.4238, 30.1473, -10.4705]]
weights = [1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]
knots = [0.0, 0.0, 0.0, 0.090864, 0.090864, 0.285838, 0.820328, 0.865283, 0.914884, 1.0, 1.0, 1.0]
";
const RANDOM_MACHINE: &str = "\
[machine]
interpolation_period_ms = 4.0
feedrate_mm_per_s = 5.53
acceleration_mm_per_s2 = 16394.9
jerk_mm_per_s3 = 1389904.0
chord_error_mm = 0.0005
fluctuation_limit = 6.61515748753786e-05
[machine.axes.x]
velocity_mm_per_s = 6.19
acceleration_mm_per_s2 = 7203.9
jerk_mm_per_s3 = 834365.3
[machine.axes.y]
velocity_mm_per_s = 4.25
acceleration_mm_per_s2 = 13925.3
jerk_mm_per_s3 = 1104168.5
[machine.axes.z]
velocity_mm_per_s = 5.74
acceleration_mm_per_s2 = 11207.5
jerk_mm_per_s3 = 1617300.0
";

/// The last step comes from full feed to rest. It goes further too far than any before it, and counts: 1.34e-4 by 60 digits.
#[test]
fn a_last_step_as_long_as_the_others_is_judged() {
    let part = read_part("p.toml", RANDOM).unwrap();
    let problem = Problem::<3>::new(&part, &read_machine("m", RANDOM_MACHINE).unwrap()).unwrap();
    let run = judged(&problem, &["I4F28"]).remove(0);
    let found = run.fluctuation.unwrap().cruise_max_abs;
    assert!((1.3e-4..1.4e-4).contains(&found), "{found}: {}", run.verdict);
    assert!(!run.verdict.is_good());
}

/// A curve whose radius changes several times within a chord, and a machine that changes its feed as fast.
const SHARP: &str = "\
[curve]
degree = 2
control_points_mm = [[-0.8752, -1.744], [0.6885, 1.2507], [-1.8658, 1.4149], [-3.2395, 2.2042], [-2.2604, 2.2374], [-2.9938, 1.9271], [-3.7683, 1.8363]]
weights = [1.086, 1.16, 0.363, 0.44, 2.3, 0.885, 0.965]
knots = [0.0, 0.0, 0.0, 0.087422, 0.33327, 0.509201, 0.876241, 1.0, 1.0, 1.0]
";
const SHARP_MACHINE: &str = "\
[machine]
interpolation_period_ms = 4.0
feedrate_mm_per_s = 12.87
acceleration_mm_per_s2 = 5715.9
jerk_mm_per_s3 = 426733.0
chord_error_mm = 0.001
fluctuation_limit = 1e-4
";
const SHARP_AXES: &str = "\
[machine.axes.x]
velocity_mm_per_s = 12.6
acceleration_mm_per_s2 = 5558.5
jerk_mm_per_s3 = 460382.5
[machine.axes.y]
velocity_mm_per_s = 14.24
acceleration_mm_per_s2 = 2346.1
jerk_mm_per_s3 = 210245.8
";

/// The feed limit takes the radius at one place for that of a whole chord. With limits of axes a chord left the path by 1.055 E.
#[test]
fn where_the_radius_changes_within_a_chord_it_keeps_the_chord_error() {
    for axes in ["", SHARP_AXES] {
        let machine = read_machine("m", &(SHARP_MACHINE.to_string() + axes)).unwrap();
        let problem = Problem::<2>::new(&read_part("p.toml", SHARP).unwrap(), &machine).unwrap();
        for profile in ProfileKind::ALL.into_iter().filter(|kind| *kind != ProfileKind::WithoutLookAhead) {
            let options = Options { profile, ..Options::default() };
            let formats = select(&["f64"]).unwrap();
            let runs = compare(&problem, &formats, &[Engine::Pieces], &options).unwrap().formats;
            assert!(runs[0].verdict.is_good(), "{profile:?}: {}", runs[0].verdict);
        }
    }
}
