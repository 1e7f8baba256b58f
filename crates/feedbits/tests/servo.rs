//! `feedbits servo`, as a person or a script uses it.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use serde_json::Value;

fn servo(arguments: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_feedbits"));
    command.arg("servo").args(arguments).output().expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn json(arguments: &[&str]) -> Value {
    let output = servo(&[arguments, &["--json"]].concat());
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", text(&output.stderr)))
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
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
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
        let message = text(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{content}{message}");
        assert!(message.contains(expected), "{expected} in {message}");
    }
    let output = servo(&["--circle", "0"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(text(&output.stderr).contains("radius"), "{}", text(&output.stderr));
}
