//! Problems: the curves that are run, where the machine rests, and its feeds.

use format_compare::Problem;

use crate::examples::on_example_machine;

fn problem(program: &str) -> Problem<3> {
    on_example_machine(program, "")
}

#[test]
fn each_move_has_its_own_feedrate() {
    let problem = problem("G0 X0 Y0\nG1 X10 F600\nG0 X20\nG1 X40 F6000\nX60\n");
    assert_eq!((problem.feedrate_mm_per_s(), problem.machine.feedrate_mm_per_s), (100.0, 200.0));
    assert_eq!(problem.feeds_mm_per_s, [10.0, 100.0, 100.0]);
    assert_eq!(problem.at_feedrate(50.0).feeds_mm_per_s, [5.0, 50.0, 50.0]);
    let limit = problem.feed_limit().unwrap();
    let at = |distance: f64| limit.at(distance) / problem.period_s();
    assert!((at(5.0) - 10.0).abs() < 1e-12 && (at(20.0) - 100.0).abs() < 1e-9, "{} {}", at(5.0), at(20.0));
}

#[test]
fn rapid_moves_are_left_out_and_curves_stay_where_they_are() {
    let problem = problem("G0 X0 Y0 Z5\nG0 X3 Y0\nG1 X10 F600\nG0 X20 Y7\nG1 X25 Z6\nG1 X25 Y9\nG0 Z5\n");
    assert_eq!((problem.rapids_left_out, problem.curves.len()), (3, 3));
    assert_eq!((problem.stops.as_slice(), problem.gaps), (&[1][..], 0));
    let ends: Vec<_> =
        problem.curves.iter().map(|c| (c.control_points()[0], c.control_points()[1])).collect();
    assert_eq!(ends[0], ([3.0, 0.0, 5.0], [10.0, 0.0, 5.0]));
    assert_eq!(ends[1], ([20.0, 7.0, 5.0], [25.0, 7.0, 6.0]));
    assert_eq!(ends[2], ([25.0, 7.0, 6.0], [25.0, 9.0, 6.0]));
}

/// The machine rests behind a lift, a gap in a drawing or an exact stop, even if the path goes straight on.
#[test]
fn the_machine_rests_where_it_makes_another_move() {
    let lifted = problem("G0 X0 Y0 Z0\nG1 X10 F600\nG0 Z5\nG0 Z0\nG1 X20\nG1 X30\n");
    assert_eq!((lifted.stops.as_slice(), lifted.gaps), (&[1][..], 0));
    let line = |from: f64, to: f64| {
        format!("[[curve]]\ndegree = 1\nknots = [0, 0, 1, 1]\ncontrol_points_mm = [[{from}, 0], [{to}, 0]]\n")
    };
    let drawn = [line(0.0, 10.0), line(20.0, 30.0), line(30.0, 40.0)].concat();
    let drawn: Problem<2> = on_example_machine(&drawn, "");
    assert_eq!((drawn.stops.as_slice(), drawn.gaps), (&[1][..], 1));
    let limit = drawn.feed_limit().unwrap();
    assert_eq!((limit.at(10.0), limit.at(20.0) > 0.1), (0.0, true));
}

/// `smooth` rested there, but plans and runs once passed these places at full feed.
#[test]
fn the_machine_rests_where_a_word_acts() {
    let stops = |text: &str| problem(text).stops;
    assert_eq!(stops("G0 X0 Y0 Z0\nM3 S900\nG1 X10 F600\nM8\nG1 X20\nG1 X30\nG1 X40\nM30\n"), [1]);
    // A word in the block of a move makes a rest on both sides of the move: some words act before the move and some
    // after it.
    assert_eq!(stops("G0 X0 Y0 Z0\nG1 X10 F600\nG1 X20\nG1 X30 M9\nG1 X40\nG1 X50\nM30\n"), [2, 3]);
    let limit = problem("G0 X0 Y0 Z0\nG1 X10 F600\nM8\nG1 X20\n").feed_limit().unwrap();
    let mut rests = limit.points().filter(|point| point.feedrate == 0.0);
    assert!(rests.any(|point| (point.distance - 10.0).abs() < 1e-12) && limit.at(5.0) > 0.0);
}

#[test]
fn rapid_moves_alone_are_followed() {
    let problem = problem("G0 X0 Y0\nG0 X10\nG0 Y10\n");
    assert_eq!((problem.rapids_left_out, problem.curves.len()), (0, 2));
}
