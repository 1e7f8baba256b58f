//! `feedbits smooth`, as a person or a script uses it.

use std::fs;

use serde_json::Value;

use crate::command::{data, feedbits};
use crate::message::{text, unfolded};

/// A folder with a program in it.
struct Folder(tempfile::TempDir);

impl Folder {
    fn with(program: &str) -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        fs::write(folder.path().join("part.nc"), program).expect("the folder is writable");
        Self(folder)
    }

    fn path(&self, name: &str) -> String {
        self.0.path().join(name).display().to_string()
    }

    fn read(&self, name: &str) -> String {
        fs::read_to_string(self.path(name)).expect("the file is there")
    }

    /// Smooths the program on paper A's machine, and returns the report.
    fn smooth(&self, options: &[&str]) -> Value {
        let (part, machine) = (self.path("part.nc"), data("seed-000.toml"));
        let output = feedbits(&[&["smooth", &part, "--machine", &machine, "--json"], options].concat());
        assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
        serde_json::from_slice(&output.stdout).expect("JSON")
    }
}

fn number(value: &Value) -> f64 {
    value.as_f64().expect("a number")
}

fn kinds(report: &Value) -> Vec<String> {
    let corners = report["corners"].as_array().expect("corners");
    let kind = |corner: &Value| {
        let reason = corner["reason"].as_str().map(|reason| format!(": {reason}")).unwrap_or_default();
        format!("{}{reason}", corner["kind"].as_str().expect("a kind"))
    };
    corners.iter().map(kind).collect()
}

/// The end points of a program's G1 blocks, read by hand: absolute, in mm.
fn points(program: &str) -> Vec<(bool, [f64; 3])> {
    let (mut at, mut points) = ([0.0; 3], Vec::new());
    for line in program.lines().filter(|line| line.starts_with("G0 ") || line.starts_with("G1 ")) {
        for word in line.split_whitespace().skip(1) {
            if let Some(axis) = "XYZ".find(&word[..1]) {
                at[axis] = word[1..].parse().expect("a number");
            }
        }
        points.push((line.starts_with("G1"), at));
    }
    points
}

fn to_side(point: [f64; 3], a: [f64; 3], b: [f64; 3]) -> f64 {
    let (mut along, mut square) = (0.0, 0.0);
    for d in 0..3 {
        along += (point[d] - a[d]) * (b[d] - a[d]);
        square += (b[d] - a[d]).powi(2);
    }
    let u = if square > 0.0 { (along / square).clamp(0.0, 1.0) } else { 0.0 };
    (0..3).map(|d| (a[d] + u * (b[d] - a[d]) - point[d]).powi(2)).sum::<f64>().sqrt()
}

/// The largest distance of the points of one polygon from another.
fn farthest(points: &[(bool, [f64; 3])], from: &[(bool, [f64; 3])]) -> f64 {
    let distance = |point: [f64; 3]| {
        from.windows(2).map(|side| to_side(point, side[0].1, side[1].1)).fold(f64::INFINITY, f64::min)
    };
    points.iter().map(|(_, point)| distance(*point)).fold(0.0, f64::max)
}

/// The first outlines of the engraving.
fn engraving() -> String {
    let text = fs::read_to_string(data("engraving.nc")).expect("the example");
    text.lines().take(160).map(|line| format!("{line}\n")).collect::<String>() + "G0 Z5.000\nM5\nM30\n"
}

#[test]
fn an_engraving_becomes_faster_within_the_tolerance() {
    let folder = Folder::with(&engraving());
    let (curves, moves) = (folder.path("smoothed.toml"), folder.path("smoothed.nc"));
    let report = folder.smooth(&["--tolerance", "0.01", "--out", &curves]);
    assert!(number(&report["cuts"]) > 100.0, "{}", report["cuts"]);
    let error = number(&report["error_mm_max"]);
    assert!((0.0095..=0.01).contains(&error), "{error}");
    let [before, after] = ["exact_stop", "smoothed"].map(|path| number(&report[path]["time_s"]));
    assert!(
        (number(&report["speedup"]) - before / after).abs() < 1e-12 && before > 1.3 * after,
        "{before} {after}"
    );
    let corners = report["corners"].as_array().expect("corners");
    assert_eq!(corners.len() as f64, number(&report["moves"]) - 1.0);
    for corner in corners {
        let [chosen, measured] = ["error_mm", "measured_error_mm"].map(|key| number(&corner[key]));
        assert!(measured <= 0.01 && (chosen - measured).abs() <= 1e-5, "{corner}");
        let feeds = ["feed_before_mm_per_s", "feed_after_mm_per_s"].map(|key| number(&corner[key]));
        assert_eq!(feeds[1] > 0.0, corner["kind"] == "cut", "{corner}");
        assert!(feeds[0] == 0.0 || number(&corner["angle_deg"]) < 1.0, "{corner}");
    }
    let setpoints = &report["setpoints"];
    assert!(number(&setpoints["off_path_mm_max"]) <= 1.1e-6 && setpoints["finished"] == true, "{setpoints}");
    assert!(number(&setpoints["off_moves_mm_max"]) <= 0.01, "{setpoints}");
    let forms = &report["forms"];
    assert!(number(&forms["distance_mm_max"]) <= number(&forms["distance_bound_mm"]), "{forms}");
    assert!(number(&forms["polynomial_operations"]) < number(&forms["trigonometric_operations"]), "{forms}");

    // The curves are a part like any other.
    let machine = data("seed-000.toml");
    let periods =
        |arguments: &[&str]| feedbits(&[arguments, &[curves.as_str(), "--machine", &machine]].concat());
    let compared = periods(&["compare", "--formats", "I4F28,f64", "--evaluate", "pieces", "--json"]);
    let compared: Value = serde_json::from_slice(&compared.stdout).expect("JSON");
    // All moves but rapid ones are interpolated.
    let part = &compared["part"];
    assert_eq!(
        number(&part["curves"]) + number(&part["rapids_left_out"]),
        number(&report["smoothed"]["curves"])
    );
    for row in compared["formats"].as_array().expect("rows") {
        assert!(number(&row["position_error_mm_max"]) < 1e-6 && number(&row["end_error_mm"]) < 1e-6, "{row}");
    }
    assert_eq!(periods(&["plan", "--json"]).status.code(), Some(0));
    let table = folder.path("setpoints.csv");
    assert_eq!(periods(&["interpolate", "--format", "I4F28", "--out", &table]).status.code(), Some(0));

    // The fine moves keep all words that stood between the moves.
    let report = folder.smooth(&["--tolerance", "0.01", "--out", &moves]);
    let stated = number(&report["error_mm_max"]);
    // The distance is that of the chords, not of the curves.
    assert!(stated != error && (stated - error).abs() <= 2e-4, "{stated} {error}");
    let (program, fine) = (engraving(), folder.read("smoothed.nc"));
    let (was, is) = (points(&program), points(&fine));
    for [from, to] in [[&was[1..], &is[1..]], [&is[1..], &was[1..]]] {
        let off = farthest(from, to);
        assert!(off <= stated + 1e-9, "{off} > {stated}");
    }
    let rapids = |text: &str| text.lines().filter(|line| line.starts_with("G0 ")).count();
    assert_eq!(rapids(&fine), rapids(&program));
    let spindle = fine.find("M3 S12000").expect("the spindle starts");
    assert!(spindle < fine.find("G1").expect("a cut") && fine.ends_with("M5\nM30\n"), "{fine}");
}

#[test]
fn outer_corners_are_looped_on_demand_and_inner_ones_cut() {
    // An L, counterclockwise: the fourth corner points inward.
    let folder = Folder::with("G0 X0 Y0\nG1 X20 F2400\nY10\nX10\nY20\nX0\nY0\nM30\n");
    let report = folder.smooth(&["--tolerance", "0.1", "--outer", "loop"]);
    assert_eq!(kinds(&report), ["loop", "loop", "cut", "loop", "loop"]);
    assert!(number(&report["error_mm_max"]) <= 0.1);
    assert!(number(&report["setpoints"]["off_path_mm_max"]) < 1.1e-6);
    let report = folder.smooth(&["--tolerance", "0.1"]);
    assert_eq!(kinds(&report), ["cut"; 5]);
}

#[test]
fn corners_that_are_none_and_moves_that_are_none() {
    // A move of no length, collinear moves, a reversal, steps far shorter than the tolerance, an arc, a word between moves.
    let program = "G0 X0 Y0\nG1 X10 F2400\nX10\nX20\nX5\nX5.01\nY0.01\nX5.02\nY0.02\nX9\nG2 X14 Y5.02 I5\nG1 X16\nY9\nX20\nM8\nY12\nM30\n";
    let report = Folder::with(program).smooth(&["--tolerance", "0.05"]);
    let (smooth, back) = ("left: smooth as it is", "left: turns back on itself");
    let word = "left: at an M, S, T, D or H word";
    let expected = [smooth, back, back, "cut", "cut", "cut", "cut", "cut", smooth, "cut", "cut", word];
    assert_eq!(kinds(&report), expected, "{report:#}");
    assert!(number(&report["error_mm_max"]) <= 0.05 && report["setpoints"]["finished"] == true, "{report:#}");
}

#[test]
fn rapid_moves_and_changes_of_feed_stay_sharp() {
    let program = "G0 X0 Y0 Z5\nG0 X5\nY5\nG1 Z0 F300\nG1 X9 F600\nY9\nG0 Z5\nM30\n";
    let folder = Folder::with(program);
    let fine = folder.path("fine.nc");
    let report = folder.smooth(&["--tolerance", "0.05", "--out", &fine]);
    let (rapid, feed) = ("left: next to a rapid move", "left: the feed changes");
    assert_eq!(kinds(&report), [rapid, rapid, feed, "cut", rapid]);
    let text = folder.read("fine.nc");
    let rapids = "G0 X5. Y0. Z5.\nG0 X5. Y5. Z5.\nG1 X5. Y5. Z0. F300.\nG1 X8.";
    assert!(text.contains(rapids), "{text}");
    // The ends of curves have no more digits than the chords need, either.
    assert!(
        text.split_whitespace().all(|word| word.split('.').nth(1).is_none_or(|d| d.len() <= 7)),
        "{text}"
    );
}

/// A curve file has no rapid moves between curves that do not meet.
#[test]
fn the_tool_rests_at_a_gap() {
    let line =
        |ends: &str| format!("[[curve]]\ndegree = 1\nknots = [0, 0, 1, 1]\ncontrol_points_mm = [{ends}]\n");
    let apart =
        ["[0, 0], [10, 0]", "[10, 0], [10, 10]", "[30, 10], [40, 20]", "[40, 20], [60, 20]"].map(line);
    let folder = Folder::with(&apart.concat());
    let report = folder.smooth(&["--tolerance", "0.02", "--out", &folder.path("s.toml")]);
    assert_eq!(kinds(&report), ["cut", "left: at a gap", "cut"]);
    let setpoints = &report["setpoints"];
    assert!(setpoints["finished"] == true && number(&setpoints["off_path_mm_max"]) < 1e-5, "{setpoints}");
}

#[test]
fn a_word_of_a_move_that_is_cut_stays_at_its_place() {
    // M8 acts before its move, M9 after it; a word between two moves stays between them.
    let folder = Folder::with("G0 X0 Y0\nG1 X10 F2400\nY10\nM3 S900\nX20\nY20 M8\nX30 M9\nM30\n");
    let fine = folder.path("fine.nc");
    let report = folder.smooth(&["--tolerance", "0.05", "--out", &fine]);
    assert_eq!(number(&report["cuts"]), 1.0);
    let text = folder.read("fine.nc");
    assert!(
        text.contains("\nG1 X10. Y10.\nM3 S900\nG1 X20. Y10.\nM8\nG1 X20. Y20.\nG1 X30. Y20.\nM9\nM30\n"),
        "{text}"
    );
}

#[test]
fn an_exact_stop_is_left_sharp_and_kept() {
    // Exact stops by block and by mode; the tool also rests at a smooth joint.
    let program = "G0 X0 Y0\nG1 X10 F2400\nG9 Y10\nX20\nG61 Y20\nX30\nG64 X40\nY30\nM30\n";
    let folder = Folder::with(program);
    let (fine, curves) = (folder.path("fine.nc"), folder.path("curves.toml"));
    let stop = "left: at an exact stop";
    for out in [&fine, &curves] {
        let report = folder.smooth(&["--tolerance", "0.05", "--out", out]);
        assert_eq!(kinds(&report), ["cut", stop, "cut", stop, stop, "cut"]);
        assert_eq!(number(&report["left"]["at an exact stop"]), 3.0);
        // The written path has the same stops.
        let machine = data("seed-000.toml");
        let again = feedbits(&["smooth", out, "--machine", &machine, "--tolerance", "0.05", "--json"]);
        let again: Value = serde_json::from_slice(&again.stdout).expect("JSON");
        assert_eq!(number(&again["left"]["at an exact stop"]), 3.0, "{out}");
    }
    let text = folder.read("fine.nc");
    assert!(text.contains("\nG61\nG1 X10. Y10.\nG64\nG1 "), "{text}");
}

#[test]
fn a_planner_that_rounds_corners_rests_at_exact_stops_and_words() {
    let machine = fs::read_to_string(data("seed-000.toml")).expect("the machine");
    let machine =
        machine.replace("[machine]", "[machine]\njunction = \"deviation\"\njunction_deviation_mm = 0.5");
    let stops = |program: &str, options: &[&str]| {
        let folder = Folder::with(program);
        let (path, part) = (folder.path("machine.toml"), folder.path("part.nc"));
        fs::write(&path, &machine).expect("the folder is writable");
        let output = feedbits(&[&["plan", &part, "--machine", &path, "--json"], options].concat());
        let plan: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let stages = plan["stages"].as_array().expect("stages");
        stages
            .iter()
            .filter(|stage| number(&stage["end_feed_mm_per_s"]) == 0.0 && number(&stage["length_mm"]) > 0.0)
            .count()
    };
    let sharp = "G0 X0 Y0\nG1 X10 F2400\nY10\nX20\nX30\n";
    let exact = "G0 X0 Y0\nG61 G1 X10 F2400\nG64 Y10\nG9 X20\nX30\n";
    // Coolant on and off: `smooth` rests at both words.
    let words = "G0 X0 Y0\nG1 X10 F2400\nM8\nY10\nX20\nM9\nX30\nM30\n";
    // The end is one of them; X20 lies on a straight line.
    for options in [&[][..], &["--window", "15"]] {
        assert_eq!([sharp, exact, words].map(|program| stops(program, options)), [1, 3, 3], "{options:?}");
    }
}

#[test]
fn an_arc_that_becomes_chords_has_its_words_and_its_stop_at_its_end() {
    let folder = Folder::with("G0 X5 Y0\nG9 G3 X0 Y5 I-5 F600 M9\nG1 Y9\nM30\n");
    let fine = folder.path("fine.nc");
    let report = folder.smooth(&["--tolerance", "0.05", "--out", &fine]);
    let text = folder.read("fine.nc");
    assert!(text.contains("\nG61\nG1 X0. Y5.\nM9\nG64\nG1 X0. Y9.\n"), "{text}");
    // A thousandth of a millimetre is left to the chords, and they use most of it. The report states the distance of
    // the chords.
    let error = number(&report["error_mm_max"]);
    assert!((3e-4..=1e-3).contains(&error), "{error}");
    assert_eq!(report["measured"], "straight_moves");
    let curves = folder.smooth(&["--tolerance", "0.05", "--out", &folder.path("fine.toml")]);
    assert!(curves["measured"] == "curves" && number(&curves["error_mm_max"]) < error, "{curves:#}");
}

#[test]
fn splines_are_followed_as_they_are() {
    let report = feedbits(&["smooth", &data("seed-000.toml"), "--tolerance", "0.1", "--json"]);
    let report: Value = serde_json::from_slice(&report.stdout).expect("JSON");
    assert_eq!((number(&report["speedup"]), number(&report["cuts"])), (1.0, 0.0));
}

#[test]
fn what_cannot_be_smoothed_is_said() {
    let folder = Folder::with("G1 X0 Y0 F600\nX5\nY5\n");
    let (part, machine) = (folder.path("part.nc"), data("seed-000.toml"));
    for (options, expected) in [
        (&["--tolerance", "0"][..], "'--tolerance <MM>': expected a number of 1e-9 to 100 mm"),
        (&["--tolerance", "nan"], "'--tolerance <MM>': expected a number of 1e-9 to 100 mm"),
        (&["--tolerance", "0.1", "--outer", "round"], "possible values: loop, cut"),
        (&[], "--tolerance <MM>"),
    ] {
        let output = feedbits(&[&["smooth", &part, "--machine", &machine], options].concat());
        let said = unfolded(&output.stderr);
        assert!(output.status.code() == Some(2) && said.contains(expected), "{said}");
    }
    let output = feedbits(&["smooth", &part, "--tolerance", "0.1"]);
    assert!(unfolded(&output.stderr).contains("names no machine"));
}

/// A joint may be slightly open: no rapid move crosses it, and the moves behind it are measured against their own
/// moves.
#[test]
fn a_joint_that_is_not_exact_is_cut_through() {
    for gap in ["5.0000008", "5.0001"] {
        let ends =
            [["0, 0", "5, 0"], [&format!("{gap}, 0"), "20, 0"], ["20, 0", "20, 10"], ["20, 10", "30, 10"]];
        let curve = |[from, to]: &[&str; 2]| {
            format!("[[curve]]\ndegree = 1\ncontrol_points_mm = [[{from}], [{to}]]\nknots = [0, 0, 1, 1]\n")
        };
        let folder = Folder::with("");
        let (path, fine) = (folder.path("gap.toml"), folder.path("fine.nc"));
        fs::write(&path, ends.iter().map(curve).collect::<String>()).expect("the folder is writable");
        let machine = data("seed-000.toml");
        let output = feedbits(&[
            "smooth",
            &path,
            "--machine",
            &machine,
            "--tolerance",
            "0.05",
            "--json",
            "--out",
            &fine,
        ]);
        let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert!(number(&report["error_mm_max"]) <= 0.05, "{gap}: {}", report["error_mm_max"]);
        let rapids = folder.read("fine.nc").lines().filter(|line| line.starts_with("G0 ")).count();
        assert_eq!(rapids, if gap == "5.0001" { 2 } else { 1 }, "{gap}");
    }
}

/// At 1e-9 mm a circle of R5 is more than the bytes of a program, and one of R8000 more than 2^20 chords in a quadrant.
#[test]
fn a_program_that_is_too_long_is_refused_and_nothing_printed() {
    let machine = data("seed-000.toml");
    for (radius, limit) in
        [("5", "bytes, and at most 67108864 (64 MiB)"), ("8000", "more than 2^20 chords in a span")]
    {
        let folder = Folder::with(&format!("G0 X0 Y0\nG3 X0 Y0 I{radius} F12000\nM30\n"));
        let (part, fine) = (folder.path("part.nc"), folder.path("fine.nc"));
        for options in [&[][..], &["--json"]] {
            let arguments = ["smooth", &part, "--machine", &machine, "--tolerance", "1e-9", "--out", &fine];
            let output = feedbits(&[&arguments, options].concat());
            let said = unfolded(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{said}");
            assert!(
                said.contains(limit) && said.contains("a larger --tolerance") && said.contains(".toml"),
                "{said}"
            );
            assert!(output.stdout.is_empty(), "{}", text(&output.stdout));
        }
        assert_eq!(fs::read_dir(folder.0.path()).expect("the folder").count(), 1, "the program alone");
    }
}

#[test]
fn a_path_that_smoothing_makes_slower_is_said_to_be() {
    let folder = Folder::with("G0 X0 Y0\nG1 X20 F2400\nY20\nX0\nY0\nM30\n");
    let options = ["--tolerance", "0.1", "--outer", "loop"];
    let speedup = number(&folder.smooth(&options)["speedup"]);
    assert!((0.5..0.99).contains(&speedup), "{speedup}");
    let (part, machine) = (folder.path("part.nc"), data("seed-000.toml"));
    let output = feedbits(&[&["smooth", &part, "--machine", &machine], &options[..]].concat());
    let said = text(&output.stdout);
    assert!(said.contains(&format!(" at every corner: {speedup:.2} times as fast.\n")), "{said}");
}
