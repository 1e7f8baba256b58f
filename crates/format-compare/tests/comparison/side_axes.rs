//! Axes beside the path: the plan keeps their limits, and takes the time that they leave.

use format_compare::{ExactPlan, Problem, ProfileKind};
use part_program::{read_machine, read_part};

const MACHINE: &str = "[machine]\ninterpolation_period_ms = 1\nfeedrate_mm_per_s = 50\nacceleration_mm_per_s2 = 1000\n\
                       jerk_mm_per_s3 = 1e5\n";
const LIMITS: &str =
    "[machine.axes.a]\nvelocity_deg_per_s = 60\nacceleration_deg_per_s2 = 400\njerk_deg_per_s3 = 8000\n";

fn problem(program: &str, axes: &str) -> Problem<2> {
    let part = read_part("p.nc", program).unwrap();
    Problem::new(&part, &read_machine("m.toml", &format!("{MACHINE}{axes}")).unwrap()).unwrap()
}

fn planned(problem: &Problem<2>, profile: ProfileKind) -> ExactPlan {
    ExactPlan::in_format_with::<f64, 2>(problem, [0.0; 2], profile).unwrap()
}

/// The greatest velocity, acceleration and jerk, in seconds, of places that follow each other by a period of 1 ms, from rest
/// to rest.
fn greatest(mut places: Vec<f64>) -> [f64; 3] {
    let (first, last) = (places[0], *places.last().unwrap());
    places.splice(..0, [first; 3]);
    places.extend([last; 3]);
    [1, 2, 3].map(|order| {
        places = places.windows(2).map(|pair| pair[1] - pair[0]).collect();
        places.iter().fold(0.0, |most: f64, one| most.max(one.abs())) * 1000.0_f64.powi(order)
    })
}

/// 100 mm on which A turns by 200°: the path has 60/2 mm/s, 400/2 mm/s² and 8000/2 mm/s³. It takes `v/a + a/j` = 0.2 s and
/// 3 mm to reach 30 mm/s, as long and as far to rest, and 94 mm at 30 mm/s between.
#[test]
fn a_line_with_an_axis_takes_the_time_of_its_s_curve() {
    let expected_s = 0.2 + 0.2 + 94.0 / 30.0;
    for profile in [ProfileKind::SCurve, ProfileKind::Fastest] {
        let problem = problem("G0 X0 Y0 A0\nG1 X100 A200 F3000\n", LIMITS);
        let plan = planned(&problem, profile);
        let taken_s = plan.periods() as f64 * problem.period_s();
        assert!(
            (expected_s..expected_s + 0.003).contains(&taken_s),
            "{profile:?}: {taken_s}, not {expected_s} s"
        );
        let mut at = 0.0;
        let places = [0.0].into_iter().chain(plan.lengths().map(|(length, _)| {
            at += 2.0 * length.value();
            at
        }));
        let found = greatest(places.collect());
        for (found, most) in found.into_iter().zip([60.0, 400.0, 8000.0]) {
            assert!(found <= most * (1.0 + 1e-6) && found > 0.9 * most, "{profile:?}: {found} of {most}");
        }
    }
}

/// Without limits of the axis the path has its own: 0.05 + 0.01 s and 1.5 mm for each change.
#[test]
fn an_axis_without_limits_takes_nothing() {
    let with = problem("G0 X0 Y0 A0\nG1 X100 A200 F3000\n", "");
    let without = problem("G0 X0 Y0 A0\nG1 X100 F3000\n", "");
    let [with, without] = [with, without].map(|problem| planned(&problem, ProfileKind::SCurve).periods());
    assert_eq!(with, without);
    let expected_s = 2.0 * 0.06 + 97.0 / 50.0;
    assert!((with as f64 / 1000.0 - expected_s).abs() < 0.003, "{with}");
}

/// Two lines in one direction; A turns three times as fast along the second.
const JOINT: &str = "G0 X0 Y0 A0\nG1 X50 A50 F3000\nX100 A200\n";

#[test]
fn a_change_of_the_axis_share_is_a_rest_unless_a_jump_is_allowed() {
    assert_eq!(problem(JOINT, LIMITS).stops, [1]);
    assert_eq!(problem("G0 X0 Y0 A0\nG1 X50 A50 F3000\nX100 A100\n", LIMITS).stops, [0_usize; 0]);
    assert_eq!(problem(JOINT, "").stops, [0_usize; 0]);
    // 20°/s of 2°/mm are 10 mm/s.
    let jump = problem(JOINT, &format!("{LIMITS}velocity_jump_deg_per_s = 20\n"));
    assert_eq!(jump.stops, [0_usize; 0]);
    for profile in [ProfileKind::Cubic, ProfileKind::SCurve, ProfileKind::Fastest] {
        let plan = planned(&jump, profile);
        let points = plan.limit(&jump).unwrap().points();
        let at_joint =
            points.filter(|point| (point.distance - 50.0).abs() < 1e-6).map(|point| point.feedrate);
        let at = at_joint.fold(f64::MAX, f64::min);
        assert!((at - 0.01).abs() < 1e-12, "{profile:?}: {at}");
        let (mut way, mut passed) = (0.0, 0.0_f64);
        let mut places = vec![0.0];
        for (length, feed) in plan.lengths() {
            way += length.value();
            if (way - 50.0).abs() < 0.006 {
                passed = passed.max(feed);
            }
            places.push(if way < 50.0 { way } else { 50.0 + 3.0 * (way - 50.0) });
        }
        assert!(passed <= 0.0104 && passed > 0.005, "{profile:?}: {passed}");
        let [velocity, ..] = greatest(places);
        assert!(velocity <= 60.0 * (1.0 + 1e-6), "{profile:?}: {velocity}");
    }
}

/// Lines of random ways and turns, each planned with its rests: no difference of the axis' places is above its limit.
#[test]
fn whatever_the_axis_does_its_limits_hold() {
    let mut state = 7_u32;
    let mut random = || {
        state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
        f64::from(state >> 8) / f64::from(1 << 24)
    };
    let (mut program, mut ways) = (String::from("G0 X0 Y0 A0\nG1 F3000\n"), vec![(0.0, 0.0)]);
    for _ in 0..30 {
        let &(x, a) = ways.last().unwrap();
        // A quarter does not turn, and half turn on evenly.
        let share = match random() {
            kind if kind < 0.25 => 0.0,
            kind if kind < 0.75 => 1.0,
            _ => 5.0 * random() - 2.5,
        };
        let way = 1.0 + 9.0 * random();
        ways.push((x + way, a + share * way));
        program += &format!("X{} A{}\n", x + way, a + share * way);
    }
    let problem = problem(&program, LIMITS);
    for profile in [ProfileKind::Cubic, ProfileKind::SCurve, ProfileKind::Fastest] {
        let plan = planned(&problem, profile);
        let (mut at, mut line) = (0.0, 0);
        let places = [0.0].into_iter().chain(plan.lengths().map(|(length, _)| {
            at += length.value();
            while line + 2 < ways.len() && at > ways[line + 1].0 {
                line += 1;
            }
            let ((x, a), (to_x, to_a)) = (ways[line], ways[line + 1]);
            a + (at - x) * (to_a - a) / (to_x - x)
        }));
        let found = greatest(places.collect());
        for (found, most) in found.into_iter().zip([60.0, 400.0, 8000.0]) {
            assert!(found <= most * 1.0001, "{profile:?}: {found} of {most}");
        }
    }
}
