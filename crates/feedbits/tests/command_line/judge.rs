//! `feedbits judge`, as a person or a script uses it.

use std::fs;
use std::io::Write;
use std::process::{Output, Stdio};

use serde_json::Value;

use crate::command::{command, data, feedbits};
use crate::message::unfolded;

fn json(output: &Output) -> Value {
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", unfolded(&output.stderr)))
}

/// The verdicts of limits, each by what it limits.
fn verdicts(found: &Value) -> Vec<(String, String)> {
    let limits = found["limits"].as_array().expect("limits");
    let text = |value: &Value| value.as_str().expect("a text").to_string();
    limits.iter().map(|limit| (text(&limit["what"]), text(&limit["verdict"]))).collect()
}

/// What `interpolate` says of its own run, its log says too.
#[test]
fn a_log_of_our_own_is_judged_as_its_run_is() {
    let folder = tempfile::tempdir().expect("a folder");
    let log = folder.path().join("log.csv").display().to_string();
    let machine = data("seed-000.toml");
    for (format, status) in [("f64", 0), ("I16F16", 1)] {
        let run = feedbits(&["interpolate", "--format", format, "--out", &log]);
        assert_eq!(run.status.code(), Some(status), "{format}");
        let judged = feedbits(&["judge", &log, "--machine", &machine, "--part", &machine, "--json"]);
        assert_eq!(judged.status.code(), Some(status), "{format}: {}", unfolded(&judged.stdout));
        let found = json(&judged);
        let whats = ["feed", "acceleration along the path", "jerk along the path"];
        let all = whats.map(|what| (what.to_string(), "kept".to_string()));
        // The steps of the coarse format are longer and shorter than commanded.
        let feed = if format == "f64" { "kept" } else { "broken" };
        assert_eq!(verdicts(&found)[0], ("feed".to_string(), feed.to_string()));
        assert!(format != "f64" || verdicts(&found) == all, "{found}");
        let part = &found["part"];
        assert!(part["nearest"]["mm"].as_f64().expect("a distance") < 2e-5, "{part}");
        assert_eq!(part["left_mm"].as_f64().map(|left| left < 1e-3), Some(true), "{part}");
        assert_eq!(part["skipped"].as_array().map(Vec::len), Some(0), "{part}");
        assert_eq!((found["schema"].as_u64(), found["command"].as_str()), (Some(1), Some("judge")));
    }
}

#[test]
fn a_log_comes_from_the_standard_input() {
    let mut child = command(&["judge", "-", "--machine", "mill", "--columns", "x=0,y=1", "--period", "1"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let rows: String = (0..100).map(|_| "1.000 2.000\n").collect();
    child.stdin.take().expect("an input").write_all(rows.as_bytes()).expect("it is read");
    let output = child.wait_with_output().expect("an end");
    let said = unfolded(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{said}");
    assert!(said.starts_with("standard input: every limit is kept."), "{said}");
}

#[test]
fn what_cannot_be_judged_is_refused_with_its_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    fs::write(path("log.csv"), "time,x\n0.000,1\n0.001,one\n").expect("a file");
    fs::write(path("m.toml"), "[machine]\njerk = 3\n").expect("a file");
    let log = path("log.csv");
    for (words, expected) in [
        (vec!["judge", &log, "--machine", "mill"], "line 3, column 7: X is `one`: expected a number"),
        (vec!["judge", &log, "--machine", &path("m.toml")], "unknown key `jerk`"),
        (vec!["judge", &log, "--machine", "mill", "--columns", "x"], "expected NAME=COLUMN"),
        (vec!["judge", &log, "--machine", "mill", "--units", "foot"], "expected mm, m or inch"),
        (vec!["judge", &log, "--machine", "mill", "--tolerance", "1"], "--part"),
        (vec!["judge", &log], "--machine"),
        (vec!["judge", &path("none.csv"), "--machine", "mill"], "cannot read"),
    ] {
        let output = feedbits(&words);
        let said = unfolded(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{words:?}: {said}");
        assert!(said.contains(expected), "{words:?}: {said}");
        assert!(output.stdout.is_empty());
    }
}
