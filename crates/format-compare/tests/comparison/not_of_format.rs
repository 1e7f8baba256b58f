//! What every format fails by.

use format_compare::{NotOfFormat, Options, Problem, Remedy, not_of_format};
use part_program::{Junction, Machine};

use crate::examples::{judged, mill};

fn explained(problem: &Problem<3>, formats: &[&str]) -> Option<NotOfFormat> {
    not_of_format(problem, &judged(problem, formats), &Options::default())
}

/// A corner at which the velocity of two axes jumps. Every format cuts it by more than the chord error.
const CORNER: &str = "G0 X0 Y0\nG1 X10 F3000\nG1 X20\nG1 X20 Y10\nG1 X30 Y10\n";
const JUMP: &str = "junction = \"velocity-jump\"\n[machine.axes.x]\nvelocity_jump_mm_per_s = 16\n\
                    [machine.axes.y]\nvelocity_jump_mm_per_s = 16\n";

#[test]
fn what_every_format_fails_by_is_told_with_its_place_and_what_helps() {
    let problem = mill(CORNER, JUMP);
    for formats in [&["f64", "I8F24"][..], &["I8F24"][..]] {
        let found = explained(&problem, formats).unwrap();
        let [one] = found.broken.as_slice() else { panic!("{found:?}") };
        assert_eq!((one.what, one.unit), ("corner error", "mm"));
        assert!((one.limit - 1.005e-3).abs() < 1e-9, "{}", one.limit);
        // The most that can be cut is Δv T/4 = √(16² + 16²) · 0.001/4.
        assert!(one.found > 1.2e-3 && one.found < 5.657e-3, "{}", one.found);
        let at = one.at.unwrap();
        let near = |corner: [f64; 2]| (at.point_mm[0] - corner[0]).hypot(at.point_mm[1] - corner[1]) < 0.1;
        assert!(matches!(at.line, Some(4)) && near([20.0, 0.0]) || at.line == Some(5) && near([20.0, 10.0]));
        let [Remedy { change, time_s }] = found.helps.as_slice() else { panic!("{found}") };
        assert!(change.contains("`junction = \"stop\"`") && *time_s > found.time_s, "{found}");
        let mut machine = problem.machine.clone();
        machine.junction = Junction::Stop;
        assert_eq!(explained(&Problem { machine, ..problem.clone() }, formats), None);
        let words = found.to_string();
        assert!(words.contains("not a question of the format") && words.contains("in line "), "{words}");
    }
}

/// One format that is too coarse says nothing about the others.
#[test]
fn what_a_format_alone_fails_by_is_a_question_of_the_format() {
    let stop = mill(CORNER, "");
    assert_eq!(explained(&stop, &["f64"]), None);
    let coarse =
        Problem { machine: Machine { fluctuation_limit: 1e-12, ..stop.machine.clone() }, ..stop.clone() };
    assert_eq!(explained(&coarse, &["I16F16"]), None);
    // If 53 bits are not enough, the path is not the cause either.
    let fine = Problem { machine: Machine { fluctuation_limit: 1e-17, ..stop.machine.clone() }, ..stop };
    assert_eq!(explained(&fine, &["f64"]), None);
}
