//! `feedbits convert`: everything that it writes reads back.

use std::fs;
use std::path::Path;
use std::process::Output;

use nurbs_core::{Evaluate, distance_to_segment};

use crate::command::{data, feedbits};
use crate::message::{text, unfolded};

fn convert(arguments: &[&str]) -> Output {
    feedbits(&[&["convert"], arguments].concat())
}

/// The words are not part of a curve file. If the path went straight on, the rest at a word was once lost with the
/// word.
#[test]
fn a_curve_file_is_planned_as_its_program_is() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (program, curves, smoothed) = (path("p.nc"), path("p.toml"), path("s.toml"));
    fs::write(&program, "G0 X0 Y0\nM3 S900\nG1 X10 F2400\nM8\nX20\nX30\nX40 M9\nX50\nY10\nM5\nM30\n")
        .expect("the folder is writable");
    let machine = data("seed-000.toml");
    let plan = |part: &str| -> serde_json::Value {
        let plan = feedbits(&["plan", part, "--machine", &machine, "--json"]);
        serde_json::from_slice(&plan.stdout).expect("JSON")
    };
    let rests = |plan: &serde_json::Value| {
        let stages = plan["stages"].as_array().expect("stages");
        stages.iter().filter(|stage| stage["end_feed_mm_per_s"] == 0.0).count()
    };
    let output = convert(&[&program, "--machine", &machine, "--to", "toml", "--out", &curves]);
    assert!(unfolded(&output.stderr).contains("but rests at them"), "{}", unfolded(&output.stderr));
    let of_program = plan(&program);
    assert_eq!(plan(&curves), of_program);
    // The tool rests at M8, on both sides of the block with M9, at the corner and at the end; not at the corner once it
    // is smoothed.
    assert_eq!(rests(&of_program), 5);
    let smoothing = ["smooth", &program, "--machine", &machine, "--tolerance", "0.05", "--out", &smoothed];
    let smooth = feedbits(&smoothing);
    assert!(smooth.status.success(), "{}", unfolded(&smooth.stderr));
    assert_eq!(rests(&plan(&smoothed)), 4);
}

/// Words that were skipped were once missing in the written program; a rapid move stood in their place, without a
/// warning.
#[test]
fn what_is_not_in_the_program_that_is_written_is_said() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let program = path("p.nc");
    let lost = "G0 X0 Y0 Z1\nG1 X5 F300\nG38.2 X10 Y10 Z-2 F100\nG80\nG1 X0 Y0 F100\nX10 Y10 Z-1\nX20\n";
    for (text_of, options, gap, names) in [
        (lost, vec!["--lenient"], true, true),
        ("G0 X0 Y0\nG1 X5 F300\nG4 P1\nX9\n", vec![], false, true),
        ("G0 X0 Y0\nG1 X5 F300\nG0 X7\nG1 X9\n", vec![], false, false),
    ] {
        fs::write(&program, text_of).expect("the folder is writable");
        let out = path("q.nc");
        let output = convert(&[&[program.as_str(), "--to", "g06.2", "--out", &out], &options[..]].concat());
        let said = unfolded(&output.stderr);
        assert!(output.status.success(), "{said}");
        assert_eq!(said.contains("1 gap is crossed by a rapid move"), gap, "{said}");
        assert_eq!(said.contains("what the warnings name is not in what is written"), names, "{said}");
    }
}

/// A printer's words were once dropped in silence.
#[test]
fn words_that_are_left_out_are_said_by_kind_and_count() {
    let program = "G21 G90 F600\nG0 X0 Y0 Z0\nG1 X10 E1\nM106 S10\nG1 X20 E2\nM8\nG1 X30 E3\nM2\n";
    for to in ["g1", "g06.2", "g5.2", "toml"] {
        let (status, written, said) = convert_text(program, &["--to", to]);
        assert!(status == Some(0) && said.contains("left out: 3 E, 1 M106"), "{to}: {said}");
        assert_eq!(written.contains("M8"), to != "toml", "{written}");
    }
}

/// Paper D's program is converted to a curve file, to a program and to a curve file again: the two curve files are the
/// same.
#[test]
fn the_round_trip_can_be_typed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (one, two, three) = (path("one.toml"), path("two.nc"), path("three.toml"));
    for (from, to, out) in
        [(&data("seed-003.nc"), "toml", &one), (&one, "g06.2", &two), (&two, "toml", &three)]
    {
        let output = convert(&[from, "--to", to, "--out", out]);
        assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
        assert!(
            unfolded(&output.stderr).contains("1 curve, which reads back bit by bit"),
            "{}",
            unfolded(&output.stderr)
        );
        assert!(output.stdout.is_empty());
    }
    let read = |path: &str| fs::read_to_string(path).expect("written");
    assert_eq!(read(&one), read(&three));
    assert!(
        read(&two).starts_with("G21 G90 G94\nG05 P10000\nG0 X0. Y15.\nG06.2 P4 K0. X0. Y15. R1.\n"),
        "{}",
        read(&two)
    );
}

#[test]
fn what_a_dialect_cannot_say_is_said() {
    let output = convert(&[&data("seed-003.nc"), "--to", "g5.2"]);
    assert!(text(&output.stdout).contains("G5.2 P1. L4"), "{}", text(&output.stdout));
    assert!(unfolded(&output.stderr).contains("read back as 7 others"), "{}", unfolded(&output.stderr));
    let output = convert(&[&data("engraving.nc"), "--to", "toml"]);
    assert!(
        unfolded(&output.stderr).contains("words M, S, T, D or H are left out"),
        "{}",
        unfolded(&output.stderr)
    );
    assert!(unfolded(&output.stderr).contains("read back bit by bit"), "{}", unfolded(&output.stderr));
}

#[test]
fn the_tolerance_of_straight_moves_is_asked_for() {
    let moves = |tolerance: &str| {
        let output = convert(&["--to", "g1", "--tolerance", tolerance]);
        assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
        text(&output.stdout).matches("G1 ").count()
    };
    // The length of a chord grows as the root of the tolerance: for a hundredth of the tolerance there are ten times as
    // many.
    let (coarse, fine) = (moves("0.1"), moves("0.001"));
    assert!((5..=20).contains(&(fine / coarse)), "{coarse} {fine}");
    for (arguments, said) in [
        (vec!["--to", "g1", "--tolerance", "0"], "'--tolerance <MM>': expected a number of 1e-9 to 100 mm"),
        (vec!["--to", "g1", "--tolerance", "1e-15"], "expected a number of 1e-9 to 100 mm"),
        (vec!["--to", "step"], "possible values: g06.2, g5.2, g1, toml"),
        (vec![], "--to"),
    ] {
        let output = convert(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(unfolded(&output.stderr).contains(said), "{said} in {}", unfolded(&output.stderr));
        assert!(output.stdout.is_empty());
    }
}

/// A line, and a spline whose end is off the grid of thousandths by (0.3, 0.3) µm, the farthest of all: 0.4243 µm.
const FINE: &str = "G0 X0 Y0
G1 X1.0001 Y0.0001 F100.12345
G06.2 P3 K0 X1.0001 Y0.0001
K0 X2 Y1 R0.70710678
K0 X3.0003 Y0.0003
K1.23456
K1.23456
K1.23456
";

/// Converts a program that is given as text.
fn convert_text(program: &str, arguments: &[&str]) -> (Option<i32>, String, String) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("part.nc").display().to_string();
    fs::write(&path, program).expect("the folder is writable");
    let output = convert(&[&[path.as_str()], arguments].concat());
    (output.status.code(), text(&output.stdout), unfolded(&output.stderr))
}

#[test]
fn coordinates_have_the_digits_asked_and_how_far_off_that_is_is_said() {
    let (status, written, said) = convert_text(FINE, &["--to", "g06.2", "--digits", "3"]);
    assert_eq!(status, Some(0), "{said}");
    // Feed, weight and knots are not coordinates, so they are not rounded; and the curves join.
    let expected = "G0 X0. Y0.
G1 X1. Y0. F100.12345
G06.2 P3 K0. X1. Y0. R1.
K0. X2. Y1. R0.70710678
K0. X3. Y0. R1.
K1.23456
";
    assert!(written.contains(expected), "{written}");
    assert!(
        said.contains("3 decimals: the path is at most 0.000425 mm off the part; other numbers"),
        "{said}"
    );
    // If there are chords, their tolerance is added.
    let lines = "G0 X0 Y0\nG1 X1.0003 Y-1.0003 F600\n";
    for (program, bound) in [(FINE, "at most 0.010"), (lines, "at most 0.000425 mm")] {
        let (_, _, said) = convert_text(program, &["--to", "g1", "--tolerance", "0.01", "--digits", "3"]);
        assert!(said.contains(bound), "{said}");
    }
    // Chords shorter than the decimals resolve make a staircase; long chords and fine decimals do not.
    for (tolerance, decimals, hint) in [
        (
            "0.001",
            "2",
            Some(
                "straight moves by up to 13°, and a control may slow down at such corners: give more --digits or a larger",
            ),
        ),
        ("0.01", "3", None),
    ] {
        let output =
            convert(&[&data("seed-003.nc"), "--to", "g1", "--tolerance", tolerance, "--digits", decimals]);
        let said = unfolded(&output.stderr);
        assert!(hint.map_or(!said.contains("straight moves by"), |hint| said.contains(hint)), "{said}");
    }
    let output = convert(&[&data("seed-003.nc"), "--to", "g5.2", "--digits", "4"]);
    let (written, said) = (text(&output.stdout), unfolded(&output.stderr));
    assert!(said.contains("1 curve is written as 7") && said.contains("where curves are cut"), "{said}");
    let short = |word: &str| word.split('.').nth(1).is_some_and(|digits| digits.len() <= 4);
    assert!(written.split_whitespace().filter(|word| word.starts_with(['X', 'Y'])).all(short), "{written}");
}

/// If a part leaves the plane, each of its plane curves was once said to read back as another one: it had a third
/// coordinate, which is 0.
#[test]
fn curves_in_the_plane_and_out_of_it_read_back_bit_by_bit() {
    let program = "G21 G90\nG0 X0 Y0 Z0\nG1 X10 Y10 F1200\nG1 Z2\n";
    for to in ["toml", "g06.2"] {
        let (_, _, said) = convert_text(program, &["--to", to]);
        assert!(said.contains("2 curves, which read back bit by bit"), "{to}: {said}");
    }
}

/// The tool was once on during the way to the part: M3 stood before the first rapid move, in every dialect.
#[test]
fn the_tool_is_switched_on_where_the_program_says() {
    let program = "G21 G90\nG0 X50 Y50\nM3 S100\nG1 X60 F1000\nM5\nG0 X80\nM3\nG1 X90\nM5\nM30\n";
    for arguments in [
        vec!["--to", "g06.2"],
        vec!["--to", "g06.2", "--digits", "3", "--ratios", "999999.999"],
        vec!["--to", "g5.2"],
        vec!["--to", "g1"],
        vec!["--to", "g1", "--digits", "3"],
    ] {
        let (_, written, said) = convert_text(program, &arguments);
        assert!(written.starts_with("G21 G90 G94\nG0 X50. Y50.\nM3 S100\nG1 X60."), "{written}{said}");
    }
}

#[test]
fn knots_and_weights_have_the_digits_of_a_control_if_asked() {
    let (status, written, said) =
        convert_text(FINE, &["--to", "g06.2", "--digits", "3", "--ratios", "999999.999"]);
    assert_eq!(status, Some(0), "{said}");
    // Factors that are powers of ten make words of all of them.
    let expected = "G06.2 P3 K0. X1. Y0. R100000.
K0. X2. Y1. R70710.678
K0. X3. Y0. R100000.
K123.456
K123.456
K123.456
";
    assert!(written.contains(expected), "{written}");
    assert!(
        said.contains("0.000425 mm off the part feedbits: ") && said.contains(" mm farther off the part"),
        "{said}"
    );
    // For a circle of 100 mm, six digits of sin 45° are kept.
    let circle = "G0 X100 Y0\nG3 X100 Y0 I-100 F600\n";
    let (_, written, said) = convert_text(circle, &["--to", "g06.2", "--ratios", "99.9999"]);
    let bound: f64 =
        said.split("at most ").nth(1).and_then(|rest| rest.split(' ').next()).unwrap().parse().unwrap();
    assert!((1e-6..1e-4).contains(&bound), "{said}");
    assert!(written.contains("R99.9999") && written.contains("R70.7106"), "{written}");
    let quintic =
        "G0 X0 Y0\nG06.2 P6 K0 X0 Y0 F600\nK0 X1\nK0 X2\nK0 X3\nK0 X4\nK0 X5\nK1\nK1\nK1\nK1\nK1\nK1\n";
    let (_, written, said) = convert_text(quintic, &["--to", "g06.2", "--ratios", "99.9999"]);
    assert!(
        written.contains("K1.\n") && said.contains("curves of P6: a FANUC control takes P2 to P4"),
        "{said}"
    );
}

#[test]
fn what_rounding_would_break_is_refused() {
    let circle = "G0 X0 Y0\nG1 X5 F600\nG3 X5 Y0 I0.0002\n";
    for (program, arguments, said) in [
        (FINE, ["--to", "toml", "--digits", "3"], "a curve file keeps every number bit by bit"),
        (FINE, ["--to", "g1", "--ratios", "9.9"], "--ratios: no knots and weights are rounded there"),
        (FINE, ["--to", "g06.2", "--ratios", "9e5"], "expected the largest knot that a control takes"),
        (
            FINE,
            ["--to", "g1", "--digits", "16"],
            "'16' for '--digits <N>': expected a whole number of 0 to 15",
        ),
        (
            FINE,
            ["--to", "g1", "--digits", "-1"],
            "'-1' for '--digits <N>': expected a whole number of 0 to 15",
        ),
        (circle, ["--to", "g06.2", "--digits", "3"], "the curve of line 3 would stand still with 3 decimals"),
        (circle, ["--to", "g5.2", "--digits", "3"], "the curve of line 3 would stand still with 3 decimals"),
        (
            "G0 X0 Y0\nG1 X0.3 F60\n",
            ["--to", "g1", "--digits", "0"],
            "every move at feed rounds to one point",
        ),
    ] {
        let (status, written, error) = convert_text(program, &arguments);
        assert!(status == Some(2) && error.contains(said) && written.is_empty(), "{said} in {error}");
    }
    let (status, written, said) = convert_text(circle, &["--to", "g1", "--digits", "3"]);
    assert!(status == Some(0) && written.contains("G1 X5. Y0. F600.\nM30"), "{written}");
    assert!(said.contains("moves that round to one point are left out"), "{said}");
}

/// Points of the curves and moves of a program at feed, in order, `count` a span.
fn points_at_feed(program: &str, count: u32) -> Vec<Vec<[f64; 3]>> {
    let part = part_program::read_part("p.nc", program).expect("it reads");
    let feed =
        part.curves.iter().zip(&part.moves).filter(|(_, one)| one.kind == part_program::MoveKind::Feed);
    let sampled = |curve: &part_program::Curve| {
        let nurbs = curve.for_evaluation().expect("a curve");
        let nurbs = nurbs.as_curve();
        let (begin, end) = nurbs.domain();
        let all =
            if curve.degree() == 1 { 1 } else { count * u32::try_from(nurbs.span_count()).expect("few") };
        (0..=all).map(|k| nurbs.point(begin + (end - begin) * f64::from(k) / f64::from(all))).collect()
    };
    feed.map(|(curve, _)| sampled(curve)).collect()
}

fn distance(point: &[f64; 3], path: &[Vec<[f64; 3]>]) -> f64 {
    let sides = path.iter().flat_map(|points| points.windows(2));
    sides.map(|side| distance_to_segment(point, &[side[0], side[1]])).fold(f64::MAX, f64::min)
}

/// The engraving within 0.01 mm: what is written reads back, is planned, and is as near to the moves as is said, measured with
/// no knowledge of which curve stands for which move.
#[test]
fn an_engraving_of_fine_moves_becomes_curves() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let out = folder.path().join("curves.nc").display().to_string();
    let output = convert(&[&data("engraving.nc"), "--fit", "0.01", "--out", &out]);
    let said = unfolded(&output.stderr);
    assert!(output.status.success() && said.contains("which read back bit by bit"), "{said}");
    let words: Vec<&str> = said.split_whitespace().collect();
    let number = |before: &str| -> f64 {
        let place = words.iter().position(|word| *word == before).expect("it is said");
        words[place - 1].parse().expect("a number")
    };
    let (fitted, bound) = (number("of"), number("mm"));
    assert!(fitted > 6000.0 && bound <= 0.01, "{said}");
    let (before, after) = (
        points_at_feed(&fs::read_to_string(data("engraving.nc")).expect("it is there"), 1),
        points_at_feed(&fs::read_to_string(&out).expect("written"), 4),
    );
    assert!(after.len() < before.len() / 8, "{} of {}", after.len(), before.len());
    for point in after.iter().flatten().step_by(11) {
        let off = distance(point, &before);
        assert!(off <= bound, "{point:?} is {off} mm from the moves");
    }
    // The polygon of the samples is up to 1 µm off the curve.
    for point in before.iter().flatten().step_by(37) {
        let off = distance(point, &after);
        assert!(off <= bound + 0.001, "{point:?} is {off} mm from the curves");
    }
    let check = feedbits(&["check", &out]);
    assert!(text(&check.stdout).contains("nothing is suspicious"), "{}", text(&check.stdout));
}

#[test]
fn a_fit_that_cannot_be_is_refused_and_nothing_is_written() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (square, out) = (path("square.nc"), path("out.nc"));
    fs::write(&square, "G0 X0 Y0\nG1 X9 F600\nG1 Y9\nG1 X0\nG1 Y0\n").expect("the folder is writable");
    for (options, expected) in [
        (&["--fit", "0.01"][..], "--fit 0.01: nothing is written: no curve is made of 4 straight moves"),
        (&["--fit", "0"], "'0' for '--fit <MM>': expected a number of 1e-9 to 100 mm"),
        (&["--fit", "-1"], "'-1' for '--fit <MM>': expected a number of 1e-9 to 100 mm"),
        (
            &["--fit", "1", "--corner", "120"],
            "'120' for '--corner <DEGREES>': expected a number of 0.01 to 90 °",
        ),
        (&["--fit", "1", "--to", "g1"], "expected --to g06.2, g5.2 or toml"),
        (&["--to", "toml", "--corner", "20"], "--fit"),
        (&[], "--to"),
    ] {
        let output = convert(&[&[square.as_str(), "--out", &out], options].concat());
        let said = unfolded(&output.stderr);
        assert!(output.status.code() == Some(2) && said.contains(expected), "{options:?}: {said}");
        assert!(!Path::new(&out).exists());
    }
}
