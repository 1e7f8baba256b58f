//! `feedbits check`: the contents of a part, and anything suspicious in it.

use std::fs;
use std::process::Output;

use crate::command::{data, feedbits};
use crate::message::{text, unfolded};

fn check(arguments: &[&str]) -> Output {
    feedbits(&[&["check"], arguments].concat())
}

struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    fn file(&self, name: &str, content: impl AsRef<[u8]>) -> String {
        let path = self.0.path().join(name);
        fs::write(&path, content).expect("the folder is writable");
        path.display().to_string()
    }
}

/// Paper A's curve: its length and its sharpest bend are those that other commands and tests find.
#[test]
fn the_built_in_example_is_good_and_its_bends_are_slow() {
    let output = check(&[]);
    let said = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{said}{}", unfolded(&output.stderr));
    for expected in [
        "1 spline",
        "degree 3, 7 control points",
        "834.707 mm at feed",
        "X 12.606 to 287.394, Y ",
        "the machine's, 200.000 mm/s",
        "radius      24.7",
        "1 curve must be passed more slowly",
        "nothing is suspicious",
    ] {
        assert!(said.contains(expected), "{expected} in\n{said}");
    }
}

#[test]
fn corners_are_counted_and_the_worst_are_listed() {
    let output = check(&[&data("engraving.nc")]);
    let said = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{said}{}", unfolded(&output.stderr));
    for expected in
        ["rapid moves", "The worst 5 of", "feed        5.000 to 40.000 mm/s", "nothing is suspicious"]
    {
        assert!(said.contains(expected), "{expected} in\n{said}");
    }
    let json = check(&[&data("engraving.nc"), "--json"]).stdout;
    let json: serde_json::Value = serde_json::from_slice(&json).expect("JSON");
    assert!(json["joints"].as_array().is_some_and(|joints| joints.len() > 100), "{}", json["joints"]);
    assert!(json["joints"][0]["tangent_break_rad"].as_f64() > Some(0.001));
    assert_eq!(json["suspicious"].as_array().map(Vec::len), Some(0));
}

/// Each part is given with a machine, so that only the intended thing is suspicious.
#[test]
fn what_is_suspicious_is_exit_status_1() {
    let folder = Folder::new();
    let machine = data("seed-000.toml");
    let curve = |points: &str, rest: &str| {
        format!("[[curve]]\ncontrol_points_mm = {points}\nknots = [0, 0, 0, 1, 1, 1]\ndegree = 2\n{rest}\n")
    };
    let bow = curve("[[0, 0], [50, 50], [100, 0]]", "");
    for (name, content, expected) in [
        (
            "gap.toml",
            bow.clone() + &curve("[[100, 1], [150, 50], [200, 0]]", ""),
            "1 × gap in the path: line 6",
        ),
        (
            "weights.toml",
            curve("[[0, 0], [50, 0], [100, 0]]", "weights = [1, 1000, 1]"),
            "1000 times the least",
        ),
        ("twice.toml", curve("[[0, 0], [0, 0], [100, 0]]", ""), "control points 0 and 1 are the same"),
        ("late.nc", "G0 X0 Y0\nG1 X9\nG1 X19 F600\n".into(), "line 2: no feedrate is commanded"),
        ("sharp.nc", "G0 X0 Y0 F12000\nG3 X0.02 R0.01\n".into(), "less than a tenth of the feed: line 2"),
        ("bent.nc", "G0 X0 Y0 F600\nG3 X10.02 Y0 I5 J0\n".into(), "read over, or arc bent to fit: line 2"),
        (
            "corner.nc",
            "G0 X0 Y0 F600\nG06.2 P3 K0 X0 Y0\nK0 X5\nK0 X9\nK1 X9 Y2\nK1 Y9\nK2\nK2\nK2\n".into(),
            "corner inside a spline: line 2",
        ),
    ] {
        let file = folder.file(name, content);
        let output = check(&[&file, "--machine", &machine]);
        let said = text(&output.stdout);
        assert_eq!(output.status.code(), Some(1), "{name}: {said}{}", unfolded(&output.stderr));
        assert!(said.starts_with(&format!("{name}: one thing is suspicious.")), "{name}: {said}");
        assert!(said.contains(expected), "{name}: {expected} in\n{said}");
    }
}

/// What changes nothing of the path is noted; only `--strict` ends with 1 for it.
#[test]
fn what_is_only_noted_is_exit_status_0_unless_strict() {
    let folder = Folder::new();
    for (name, program, expected) in [
        ("dwell.nc", "G0 X0 Y0 F600\nG4 P.001\nG1 X9\n", "word beside the path"),
        ("tolerance.ngc", "G64 P0.01\nG0 X0 Y0 F600\nG1 X9\n", "word beside the path"),
        ("optional.nc", "G0 X0 Y0 F600\n/G1 X5\nG1 X9\n", "word beside the path"),
        ("setting.nc", "$100=250\nG0 X0 Y0 F600\nG1 X9\n", "word beside the path"),
        ("unknown.nc", "G1 Z5 F600\nG0 X0 Y0\nG1 X9\n", "approach from an unknown place: line 1"),
        ("still.nc", "G0 X0 Y0 F600\nG1 X9\nG1 X9\nG1 Y9\n", "ends where it starts: line 3"),
        ("short.nc", "G0 X0 Y0 F600\nG1 X9\nG1 X9.0002\n", "line 3: the move is 2.0e-4 mm long"),
    ] {
        let file = folder.file(name, program);
        for (more, status, begin) in
            [(&[][..], 0, "nothing is suspicious."), (&["--strict"][..], 1, "one thing is suspicious.")]
        {
            let output = check(&[&[file.as_str(), "--machine", "router"], more].concat());
            let said = text(&output.stdout);
            assert_eq!(output.status.code(), Some(status), "{name}: {said}{}", unfolded(&output.stderr));
            assert!(said.starts_with(&format!("{name}: {begin}")), "{said}");
            assert!(said.replace("\n            ", " ").contains(expected), "{name}: {expected} in\n{said}");
            assert_eq!(said.contains("\nnoted  "), status == 0, "{said}");
        }
        let json = check(&[file.as_str(), "--machine", "router", "--json"]).stdout;
        let json: serde_json::Value = serde_json::from_slice(&json).expect("JSON");
        let count = |key: &str| json[key].as_array().map(Vec::len);
        assert_eq!((count("suspicious"), count("noted")), (Some(0), Some(1)), "{name}");
    }
    // A note is none for a script that wants results, warnings and errors alone.
    let file = folder.file("quiet.nc", "G0 X0 Y0 F600\nG4 P.001\nG1 X9\n");
    let said = |more: &[&str]| unfolded(&check(&[&[file.as_str(), "--units", "mm"], more].concat()).stderr);
    assert!(said(&[]).starts_with("note: a dwell"), "{}", said(&[]));
    assert_eq!(said(&["--quiet"]), "");
}

#[test]
fn without_a_machine_a_missing_feedrate_is_suspicious() {
    let output = check(&[&data("seed-003.nc")]);
    assert_eq!(output.status.code(), Some(1));
    assert!(text(&output.stdout).contains("no feedrate is commanded"), "{}", text(&output.stdout));
    // With a machine, its feed holds; on paper D's curve that feed is too high for the sharpest bend.
    let output = check(&[&data("seed-003.nc"), "--machine", &data("seed-000.toml")]);
    assert_eq!(output.status.code(), Some(1));
    assert!(!text(&output.stdout).contains("no feedrate is commanded"), "{}", text(&output.stdout));
    assert!(
        text(&output.stdout).contains("less than a tenth of the feed: line 3"),
        "{}",
        text(&output.stdout)
    );
}

#[test]
fn every_error_of_a_file_is_printed() {
    let folder = Folder::new();
    let file = folder.file("bad.nc", "G0 X0\nG1 XX5\nG81 X3\nG2 X5\nG1 Q4\n");
    let output = check(&[&file]);
    let said = unfolded(&output.stderr);
    assert_eq!((output.status.code(), said.matches("error: ").count()), (Some(2), 4), "{said}");
    for place in ["bad.nc:2:", "bad.nc:3:", "bad.nc:4:", "bad.nc:5:", "^"] {
        assert!(said.contains(place), "{place} in\n{said}");
    }
    let output = check(&[&file, "--json"]);
    assert_eq!(output.status.code(), Some(2));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!((json["count"].as_u64(), json["errors"].as_array().map(Vec::len)), (Some(4), Some(4)));
    assert_eq!(
        (json["errors"][1]["line"].as_u64(), json["errors"][1]["severity"].as_str()),
        (Some(3), Some("error"))
    );
}

#[test]
fn dialect_and_lenience_are_options_of_every_command_that_reads_a_part() {
    let folder = Folder::new();
    let strange = folder.file("strange.nc", "G0 X0 Y0 F6000\nG1 X10\nG1 X20 Q7\nFOOBAR\n");
    let machine = data("seed-000.toml");
    for command in ["check", "compare", "plan"] {
        let run = |more: &[&str]| {
            let mut arguments = vec![command, &strange, "--machine", &machine];
            arguments.extend(more);
            if command == "compare" {
                arguments.extend(["--formats", "f64"]);
            }
            feedbits(&arguments)
        };
        assert_eq!(run(&[]).status.code(), Some(2), "{command}");
        let lenient = run(&["--lenient"]);
        assert_eq!(lenient.status.code(), Some(i32::from(command == "check")), "{command}");
        assert_eq!(
            unfolded(&lenient.stderr).matches("warning: ").count(),
            2,
            "{}",
            unfolded(&lenient.stderr)
        );
    }
    let fanuc = data("seed-003.nc");
    assert!(text(&check(&[&fanuc, "--machine", &machine, "--dialect", "fanuc"]).stdout).contains("1 spline"));
    let other = check(&[&fanuc, "--dialect", "siemens"]);
    assert_eq!(other.status.code(), Some(2));
    assert!(unfolded(&other.stderr).contains("is a spline of fanuc"), "{}", unfolded(&other.stderr));
    assert!(unfolded(&check(&["--dialect", "klingon"]).stderr).contains("fanuc, linuxcnc, siemens or canon"));
}

#[test]
fn bytes_that_are_no_text_and_files_that_are_too_long_are_refused() {
    let folder = Folder::new();
    let latin = folder.file("latin.nc", b"(Fr\xe4sen)\nG0 X0 Y0 F600\nG1 X5\n");
    assert_eq!(check(&[&latin]).status.code(), Some(0));
    let long = folder.0.path().join("long.nc");
    // A file of zeros that takes no space on the disk.
    fs::File::create(&long).and_then(|file| file.set_len((512 << 20) + 1)).expect("a sparse file");
    let output = check(&[&long.display().to_string()]);
    assert_eq!(output.status.code(), Some(2));
    assert!(unfolded(&output.stderr).contains("longer than 512 MiB"), "{}", unfolded(&output.stderr));
}

/// Moves that are not cut are not compared, and a note says so.
#[test]
fn rapid_moves_are_left_out_of_a_comparison() {
    let folder = Folder::new();
    let machine = data("seed-000.toml");
    let part = folder.file("two.nc", "G0 X0 Y0 F6000\nG3 X20 R10\nG0 X50\nG3 X90 R20\nG0 X0\n");
    let run = |arguments: &[&str]| {
        let mut all = vec![arguments[0], &part, "--machine", &machine];
        all.extend(&arguments[1..]);
        feedbits(&all)
    };
    let output = run(&["compare", "--formats", "f64,I4F28", "--evaluate", "pieces", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}{}", text(&output.stdout), unfolded(&output.stderr));
    assert!(unfolded(&output.stderr).contains("2 rapid moves are left out"), "{}", unfolded(&output.stderr));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(
        (json["part"]["curves"].as_u64(), json["part"]["rapids_left_out"].as_u64()),
        (Some(2), Some(2))
    );
    let length = json["part"]["length_mm"].as_f64().expect("a length");
    assert!((length - 30.0 * std::f64::consts::PI).abs() < 1e-9, "{length}");
    assert_eq!(run(&["plan"]).status.code(), Some(0));
    // Setpoints are in the part's coordinates: the second arc ends at (90, 0).
    let setpoints = text(&run(&["interpolate"]).stdout);
    let last: Vec<f64> = setpoints
        .lines()
        .last()
        .unwrap_or_default()
        .split(',')
        .map(|x| x.parse().expect("a number"))
        .collect();
    assert!((last[5] - 90.0).abs() < 1e-9 && last[6].abs() < 1e-9, "{last:?}");
}

/// A program may leave the tool's first place and the first unit to the person who runs it.
#[test]
fn start_and_unit_can_be_given() {
    let folder = Folder::new();
    let part = folder.file("p.nc", "G1 X10 F600\nG1 Y10\nG1 X20\n");
    let plain = check(&[&part]);
    let said = unfolded(&plain.stderr);
    assert!(said.contains("where the tool is on X before this move at feed is not known"), "{said}");
    assert!(
        said.contains("in inches it would be 254.0 x 0.0 x 0.0 mm; `--units mm` or `--units inch`"),
        "{said}"
    );
    let given = check(&[&part, "--start", "0,0,5", "--units", "inch"]);
    assert_eq!((given.status.code(), unfolded(&given.stderr)), (Some(0), String::new()));
    assert!(text(&given.stdout).contains("762.000 mm at feed"), "{}", text(&given.stdout));
    for (option, value, expected) in [
        ("--start", "0,0", "expected three numbers in mm, as 0,0,5"),
        ("--start", "0,0,x", "expected three numbers in mm, as 0,0,5"),
        ("--start", "0,0,1e9", "expected three numbers in mm, as 0,0,5"),
        ("--units", "feet", "expected mm or inch"),
    ] {
        let wrong = check(&[&part, option, value]);
        assert_eq!(wrong.status.code(), Some(2));
        assert!(unfolded(&wrong.stderr).contains(expected), "{}", unfolded(&wrong.stderr));
    }
}

/// The tool's radius comes from a table, of LinuxCNC or in CSV, in the unit that belongs to it.
#[test]
fn a_tool_table_gives_the_radius_of_the_cutter() {
    let folder = Folder::new();
    let part = folder.file("p.ngc", "G21 G90 F600\nG0 X0 Y0 Z0\nG41 D3\nG1 X20\nX50\nG40\nX70\n");
    let tables = [("t.tbl", "T3 P3 D4 ; end mill\n"), ("t.csv", "tool,radius_mm\n3,2\n")];
    for (name, table) in tables {
        let table = folder.file(name, table);
        let output = check(&[&part, "--dialect", "linuxcnc", "--tools", &table]);
        let said = text(&output.stdout);
        assert_eq!(output.status.code(), Some(0), "{said}{}", unfolded(&output.stderr));
        // In and out across 2 mm, and 30 mm beside the contour.
        let expected = format!("length      {:.3} mm at feed", 2.0 * 20.0_f64.hypot(2.0) + 30.0);
        assert!(said.contains(&expected), "{expected} in\n{said}");
    }
    let wrong = folder.file("wrong.tbl", "T3 P3 D4\nT3 D5\n");
    for (arguments, expected) in [
        (&[part.as_str(), "--dialect", "linuxcnc"][..], "the radius of tool 3 is not known"),
        (&[&part, "--tools", &wrong], "tool 3 is there twice"),
        (&[&part, "--tools", "nothing.tbl"], "cannot read nothing.tbl"),
    ] {
        let output = check(arguments);
        let said = unfolded(&output.stderr);
        assert!(output.status.code() == Some(2) && said.contains(expected), "{expected} in\n{said}");
    }
}

/// The limits that a slicer writes change nothing of the path.
#[test]
fn the_limits_of_a_printer_are_not_suspicious() {
    let folder = Folder::new();
    let head = "M201 X500 Y500 Z100\nM203 X200 Y200 Z12\nM204 P500 T500\nM205 X8 Y8\nG21\nG90\nM82\n";
    let part = folder.file("p.gcode", format!("{head}G0 X0 Y0 Z0.2 F6000\nG1 X10 E1 F1200\nG1 X20 E2\n"));
    let output = check(&[&part, "--units", "mm"]);
    let said = text(&output.stdout);
    assert!(output.status.code() == Some(0) && said.contains("nothing is suspicious"), "{said}");
    assert!(
        said.contains("noted") && unfolded(&output.stderr).contains("`M201` sets limits of the printer"),
        "{said}"
    );
}
