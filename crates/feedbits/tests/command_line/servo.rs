//! `feedbits servo`, as a person or a script uses it.

use std::fs;
use std::path::Path;
use std::process::Output;

use serde_json::Value;

use crate::command::feedbits;
use crate::message::{text, unfolded};

fn servo(arguments: &[&str]) -> Output {
    feedbits(&[&["servo"], arguments].concat())
}

fn json(arguments: &[&str]) -> Value {
    let output = servo(&[arguments, &["--json"]].concat());
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", unfolded(&output.stderr)))
}

fn row<'a>(report: &'a Value, format: &str, engine: &str) -> &'a Value {
    let rows = report["formats"].as_array().expect("rows");
    rows.iter().find(|row| row["format"] == format && row["engine"] == engine).expect("the format was run")
}

#[test]
fn coarse_setpoints_raise_the_contour_error_and_fine_ones_do_not() {
    let report = json(&["--formats", "I16F16,I8F24,f64"]);
    let contour = |format, engine| row(&report, format, engine)["contour_error_mm"]["max"].as_f64().unwrap();
    let exact = contour("f64", "pieces");
    assert!((1e-3..1e-2).contains(&exact), "what the drive makes of exact setpoints: {exact} mm");
    let coarse = contour("I16F16", "de-boor-secant");
    assert!(coarse > 2.0 * exact, "{coarse} against {exact} mm");
    let fine = contour("I8F24", "pieces");
    assert!((fine / exact - 1.0).abs() < 0.01, "{fine} against {exact} mm");
    assert!(row(&report, "I8F24", "de-boor-secant")["refused"].as_str().unwrap().contains("control point 0"));
}

/// The first screen has pieces alone; --wide has both forms. The exit status depends on both forms.
#[test]
fn the_first_screen_has_the_answer_and_pieces() {
    let [first, wide] = [&[][..], &["--wide"]].map(|more| {
        let output = servo(&[&["--formats", "I16F16,I8F24,f64"], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
        text(&output.stdout)
    });
    assert!(first.starts_with("The table is at most 3.5") && !first.contains("raw"), "{first}");
    assert!(wide.contains("I16F16 ┆ raw") && wide.contains("refused: control point 0"), "{wide}");
}

#[test]
fn every_setting_of_the_tuning_table_is_there_and_the_papers_trend_with_it() {
    let report = json(&["--formats", "f64"]);
    let rows = report["tuning"].as_array().unwrap();
    assert_eq!(rows.len(), 15);
    let radial = |alpha: f64, gain: f64| {
        let row = rows.iter().find(|r| r["feed_forward"] == alpha && r["velocity_gain_percent"] == gain);
        row.unwrap()["radial_error_mean_mm"].as_f64().unwrap()
    };
    assert!((radial(0.95, 100.0) + 0.005).abs() < 0.001 && radial(0.98, 100.0).abs() < 0.001);
}

#[test]
fn the_circle_is_drawn() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let plot = folder.path().join("circle.svg");
    let plot = plot.to_str().unwrap();
    let output = servo(&["--formats", "f64", "--circle", "25", "--feed", "3000", "--plot", plot]);
    assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
    assert!(text(&output.stdout).contains("Circle R25 F3000"), "{}", text(&output.stdout));
    let svg = fs::read_to_string(Path::new(plot)).expect("the plot was written");
    assert!(svg.contains("<svg") && svg.contains("radius 25 mm"), "{svg}");
}

#[test]
fn a_loop_that_cannot_be_is_refused_by_name() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = folder.path().join("servo.toml");
    for (content, expected) in [
        ("[servo]\nposition_gain_per_s = 50000\nvelocity_lag_ms = 0.39\n", "unstable"),
        ("[servo]\nposition_gain_per_s = -3\nvelocity_lag_ms = 0.39\n", "position_gain_per_s"),
        ("[servo]\nposition_gain_per_s = 30\nvelocity_lag_ms = 0.39\nfeed_foward = 1\n", "feed_foward"),
        ("[servo]\nvelocity_lag_ms = 0.39\n", "position_gain_per_s"),
    ] {
        fs::write(&file, content).expect("the folder is writable");
        let output = servo(&["--servo", file.to_str().unwrap(), "--formats", "f64"]);
        let message = unfolded(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{content}{message}");
        assert!(message.contains(expected), "{expected} in {message}");
    }
    let output = servo(&["--circle", "0"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(unfolded(&output.stderr).contains("'--circle <MM>'"), "{}", unfolded(&output.stderr));
}

/// A quarter of a circle of 5 mm at 50 mm/s, on a machine and with a drive in files beside it.
struct Quarter {
    folder: tempfile::TempDir,
}

impl Quarter {
    const MACHINE: &str = "[machine]\ninterpolation_period_ms = 1.0\nfeedrate_mm_per_s = 100.0\n\
        acceleration_mm_per_s2 = 5000.0\njerk_mm_per_s3 = 400000.0\nchord_error_mm = 0.001\n\
        fluctuation_limit = 1e-6\nparameter_tolerance = 1e-6\nmax_iterations = 5\n";
    /// Position gain 30 1/s, lag 1 ms.
    const DRIVE: &str = "[servo]\nposition_gain_per_s = 30\nvelocity_lag_ms = 1.0\n";

    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let program = "G21 G90 G17\nG0 X5 Y0\nG2 X0 Y-5 I-5 J0 F3000\nM30\n";
        for (name, content) in [("quarter.nc", program), ("m.toml", Self::MACHINE)] {
            fs::write(folder.path().join(name), content).expect("the folder is writable");
        }
        Self { folder }
    }

    fn path(&self, name: &str) -> String {
        self.folder.path().join(name).display().to_string()
    }

    /// Runs with the drive and `drive`, further lines of the servo file.
    fn servo(&self, drive: &str, arguments: &[&str]) -> Output {
        let file = self.path("s.toml");
        fs::write(&file, Self::DRIVE.to_string() + drive).expect("the folder is writable");
        let (part, machine) = (self.path("quarter.nc"), self.path("m.toml"));
        let run =
            [&part, "--machine", &machine, "--servo", &file, "--formats", "f64", "--evaluate", "pieces"];
        servo(&[&run, arguments].concat())
    }
}

/// The figures of an independent simulation, by Euler's method in Python: the largest and the root mean square over the
/// motion. With the standstill behind it, the mean would be 65 and 367 µm.
#[test]
fn root_mean_squares_are_those_of_the_motion() {
    let output = Quarter::new().servo("", &["--json", "--profile", "cubic"]);
    assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let row = row(&report, "f64", "pieces");
    for (size, [max, rms]) in
        [(&row["contour_error_mm"], [0.2265, 0.1499]), (&row["following_error_mm"][0], [1.4558, 0.8897])]
    {
        for (found, expected) in [(&size["max"], max), (&size["rms"], rms)] {
            let found = found.as_f64().unwrap();
            assert!((found / expected - 1.0).abs() < 5e-3, "{found} {expected} mm");
        }
    }
}

/// With equal axes the table stays on straight lines, and the closed-up path has a corner between them.
#[test]
fn a_rapid_move_is_no_corner() {
    let part = Quarter::new();
    let program = "G21 G90\nG0 X0 Y0\nG1 X10 Y0 F3000\nG0 X100 Y100\nG1 X110 Y90\nM30\n";
    fs::write(part.path("quarter.nc"), program).expect("the folder is writable");
    let output = part.servo("", &["--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let row = row(&report, "f64", "pieces");
    let contour = row["contour_error_mm"]["max"].as_f64().unwrap();
    assert!(contour < 1e-6, "{contour} mm");
    // V/Kp on the first of the moves.
    let following = row["following_error_mm"][0]["max"].as_f64().unwrap();
    assert!((following / (50.0 / 30.0) - 1.0).abs() < 0.01, "{following} mm");
}

#[test]
fn a_machine_that_does_not_move_is_not_perfect() {
    let quarter = Quarter::new();
    let output = quarter.servo("friction_mm_per_s2 = 1e9\n", &[]);
    let said = text(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{said}{}", unfolded(&output.stderr));
    assert!(said.contains("Circle R10 F4000: the table does not follow the circle: it goes 0.0°"), "{said}");
    assert!(
        said.contains("Left out: velocity gain 100 %, feed-forward 0, 95, 98, 99, 100 %: the table"),
        "{said}"
    );
    let report = quarter.servo("friction_mm_per_s2 = 1e9\n", &["--json"]);
    let report: Value = serde_json::from_slice(&report.stdout).expect("JSON");
    let reason = row(&report, "f64", "pieces")["does_not_follow"].as_str().expect("a reason");
    assert!(reason.starts_with("the table does not follow: it ends 7071.068 µm"), "{reason}");
    assert_eq!(report["circle"]["radial_error_mean_mm"], Value::Null);
    // The built-in drive has 3 µm of friction and 2 µm of play: it does not make a circle of 1 µm.
    for circle in [["--circle", "0.001", "--feed", "10"], ["--circle", "0.0005", "--feed", "0.5"]] {
        let plot = quarter.path("c.svg");
        let output = servo(&[&["--formats", "f64", "--plot", &plot], &circle[..]].concat());
        let said = text(&output.stdout);
        assert_eq!(output.status.code(), Some(1), "{said}{}", unfolded(&output.stderr));
        assert!(said.contains("the table does not follow the circle"), "{said}");
        assert!(unfolded(&output.stderr).contains("c.svg is not written") && !Path::new(&plot).exists());
    }
}

/// Play of 1 mm on a path of 5 mm is bad, but it is measured, not refused.
#[test]
fn a_machine_that_follows_badly_is_measured() {
    let output = Quarter::new().servo("backlash_mm = 1\n", &[]);
    let said = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{said}{}", unfolded(&output.stderr));
    assert!(!said.contains("does not follow") && said.contains("mean radial error -393.9"), "{said}");
}

#[test]
fn a_feed_at_an_end_is_refused() {
    for option in ["--start-feed", "--end-feed"] {
        let output = Quarter::new().servo("", &[option, "100"]);
        let message = unfolded(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{message}");
        assert!(message.contains(&format!("{option} 100: expected 0")), "{message}");
        assert_eq!(Quarter::new().servo("", &[option, "0"]).status.code(), Some(0));
    }
}

#[test]
fn settings_that_oscillate_are_left_out_with_the_reason() {
    let drive = "velocity_gain_percent = 50\nvelocity_gain_limit_percent = 60\n";
    let output = Quarter::new().servo(drive, &[]);
    let said = unfolded(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{said}{}", unfolded(&output.stderr));
    for gain in [100, 200, 300] {
        let expected = format!(
            "Left out: velocity gain {gain} %, feed-forward 0, 95, 98, 99, 100 %: velocity_gain_percent = {gain}: the \
             velocity loop oscillates"
        );
        assert!(said.contains(&expected), "{said}");
    }
}

/// The closed form beside a simulation is that of the simulated loop: the filter causes 10.7 µm.
#[test]
fn the_closed_form_has_the_command_filter() {
    let said = unfolded(&Quarter::new().servo("command_filter_ms = 24\n", &[]).stdout);
    assert!(said.contains("mean radial error -234.7") && said.contains("closed form: -234.7"), "{said}");
}

/// Before interpolation the average of 24 ms leaves the circle as it is, and slows the run; after it, the same average
/// takes 10.7 µm and more off the path.
#[test]
fn a_ramp_of_the_feed_does_not_change_the_path() {
    let run = |drive: &str| {
        let exact = "feed_forward = 1\nacceleration_feed_forward = 1\n";
        let output = Quarter::new().servo(&format!("{exact}{drive}"), &["--json"]);
        assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
        let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let contour = row(&report, "f64", "pieces")["contour_error_mm"]["max"].as_f64().unwrap();
        (contour, report["circle"]["radial_error_mean_mm"].as_f64().unwrap())
    };
    let [plain, ramped, filtered] = ["", "feed_ramp_ms = 24\n", "command_filter_ms = 24\n"].map(run);
    assert!((plain.1 - ramped.1).abs() < 1e-8, "{plain:?} {ramped:?} mm");
    assert!((plain.1 - filtered.1 - 0.01066).abs() < 1e-4, "{plain:?} {filtered:?} mm");
    assert!(
        ramped.0 <= 1.01 * plain.0 && filtered.0 > plain.0 + 0.01,
        "{plain:?} {ramped:?} {filtered:?} mm"
    );
}

/// The plan rests at each corner. A ramp that went on across it would cut it: 24 ms at 50 mm/s are 1.2 mm of path.
#[test]
fn a_ramp_of_the_feed_rests_where_the_plan_does() {
    let part = Quarter::new();
    let program = "G21 G90\nG0 X0 Y0\nG1 X10 Y0 F3000\nG1 X10 Y10\nG1 X20 Y10\nM30\n";
    fs::write(part.path("quarter.nc"), program).expect("the folder is writable");
    let drive = "feed_forward = 1\nacceleration_feed_forward = 1\nfeed_ramp_ms = 24\n";
    let output = part.servo(drive, &["--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
    let report: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let contour = row(&report, "f64", "pieces")["contour_error_mm"]["max"].as_f64().unwrap();
    assert!(contour < 0.001, "{contour} mm");
}

#[test]
fn table_2_of_paper_d_is_one_command() {
    let output = servo(&["--paper-table"]);
    assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
    let said = text(&output.stdout);
    assert!(said.contains("-4.930") && said.contains("-13.66") && said.contains("close to 0"), "{said}");
    let rows = json(&["--paper-table"]);
    assert_eq!(rows.as_array().map(Vec::len), Some(4));
    assert_eq!(rows[0]["printed_radial_error_mm"], -0.005);
    let closed = rows[0]["printed_gain"]["closed_form_mm"].as_f64().unwrap();
    assert!((closed + 0.01366).abs() < 1e-5, "{closed} mm");
    assert_eq!(servo(&["part.nc", "--paper-table"]).status.code(), Some(2));
}

/// The circle that paper D prints, from its text to the contour error: three turns about (-10, 0). With the fitted drive
/// as a linear loop the table is 4.97 µm inside in the steady state, and further off while it starts and stops.
#[test]
fn the_program_of_the_papers_circle_runs_to_its_contour_error() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let program = "G91;\nG08P1;\nG17G02I-10.0F4000;\nI-10.0;\nI-10.0;\nG08P0;\nG04X3;\nM99;\n";
    let drive = "[servo]\nposition_gain_per_s = 50.7\nvelocity_lag_ms = 0.39\nfeed_forward = 0.95\nfeed_ramp_ms = 24\n";
    for (name, content) in [("circle.nc", program), ("m.toml", Quarter::MACHINE), ("s.toml", drive)] {
        fs::write(path(name), content).expect("the folder is writable");
    }
    let (part, machine, drive) = (path("circle.nc"), path("m.toml"), path("s.toml"));
    for dialect in [&[][..], &["--dialect", "fanuc"]] {
        let arguments =
            [&part, "--machine", &machine, "--servo", &drive, "--formats", "f64", "--evaluate", "pieces"];
        let report = json(&[&arguments[..], dialect].concat());
        let row = row(&report, "f64", "pieces");
        assert_eq!(row["reached_the_end"], true, "{row}");
        let [max, rms] = ["max", "rms"].map(|size| row["contour_error_mm"][size].as_f64().unwrap());
        assert!((rms - 0.00497).abs() < 0.0002 && (0.00495..0.006).contains(&max), "{max} {rms} mm");
        let following = row["following_error_mm"][0]["max"].as_f64().unwrap();
        // (1 - α) V/Kp = 65.7 µm, and what the lag adds.
        assert!((following / 0.0657 - 1.0).abs() < 0.1, "{following} mm");
    }
}

#[test]
fn a_servo_file_is_refused_with_its_line() {
    let output = Quarter::new().servo("feed_forward = 98\n", &[]);
    let message = unfolded(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{message}");
    assert!(message.contains("s.toml: line 4: feed_forward = 98"), "{message}");
}
