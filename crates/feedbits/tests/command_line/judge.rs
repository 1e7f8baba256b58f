//! `feedbits judge`, as a person or a script uses it.

use std::collections::BTreeSet;
use std::fs;
use std::io::Write;
use std::process::{Output, Stdio};

use serde_json::Value;

use crate::baseline::keys;
use crate::command::{command, data, feedbits, feedbits_in, names};
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

/// From a line into an arc and back an axis takes more than its jerk, by less than the fluctuation that its machine allows makes:
/// `interpolate` called such runs good, and `judge` broken.
#[test]
fn a_run_that_is_good_within_what_its_machine_allows_is_judged_as_a_run() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("a file");
    write("m.toml", OF_A_RUN);
    write("p.nc", "G21 G90 G1 X0 Y0 F6000\nG1 X10\nG2 X20 Y-10 R10\nG1 Y-20\n");
    for (format, is_good) in [("f64", true), ("f32", true), ("I8F24", true), ("I12F20", false)] {
        let words = ["interpolate", "p.nc", "--machine", "m.toml", "--format", format, "--out", "log.csv"];
        let run = feedbits_in(folder.path(), &words);
        let status = Some(i32::from(!is_good));
        assert_eq!(run.status.code(), status, "{format}: {}", unfolded(&run.stderr));
        let judged = |more: &[&str]| {
            let words = ["judge", "log.csv", "--machine", "m.toml", "--part", "p.nc", "--json"];
            let output = feedbits_in(folder.path(), &[&words, more].concat());
            (output.status.code(), json(&output)["faults"].to_string())
        };
        let (alone, faults) = judged(&[]);
        assert!(alone == Some(1) && faults.contains("jerk of X is broken"), "{format}: {faults}");
        let (as_run, faults) = judged(&["--as-run"]);
        assert_eq!(as_run, status, "{format}: {faults}");
    }
}

/// Moves that motan has kept, sampled at the period that the machine's file assumes: one of them takes twice the velocity of X.
#[test]
fn moves_of_motan_are_judged() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("a file");
    let machine = |velocity: f64| {
        format!(
            "[machine]\ninterpolation_period_ms = 1.0\nassumed = [\"interpolation_period_ms\"]\n[machine.axes.x]\n\
             velocity_mm_per_s = {velocity:?}\nacceleration_mm_per_s2 = 3000.0\n"
        )
    };
    let moves = "[[4.0,0.01,0.0,3000.0,[1.0,2.0,0.0],[1.0,0.0,0.0]],[4.01,0.01,30.0,0.0,[1.15,2.0,0.0],[1.0,0.0,0.0]],\
                 [4.02,0.01,30.0,-3000.0,[1.45,2.0,0.0],[1.0,0.0,0.0]]]";
    write("log", &format!("{{\"q\":\"trapq:toolhead\",\"params\":{{\"data\":{moves}}}}}\u{3}"));
    for (velocity, status, faults) in
        [(30.0, 0, serde_json::json!([])), (15.0, 1, serde_json::json!(["velocity of X is broken"]))]
    {
        write("m.toml", &machine(velocity));
        let output = feedbits_in(folder.path(), &["judge", "log", "--machine", "m.toml", "--json"]);
        assert_eq!(output.status.code(), Some(status), "{}", unfolded(&output.stderr));
        let found = json(&output);
        assert_eq!(found["faults"], faults);
        // Each setpoint's time is a sum of the moves' times.
        assert!((found["period_s"].as_f64().unwrap() - 1e-3).abs() < 1e-12, "{}", found["period_s"]);
    }
}

/// A log that is read in the wrong unit, of a part that the tool comes to from elsewhere, as one whose approach is left out.
#[test]
fn a_log_in_the_wrong_unit_says_which_option_helps() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("a file");
    write("p.nc", "G21 G90 F1200\nG0 X50 Y50\nG1 X90\n");
    let rows = log_of_x(0.0);
    let shifted: String = rows.lines().skip(1).fold(String::from("time,x,y\n"), |text, row| {
        let mut words = row.split(',');
        let mut next = || words.next().and_then(|word| word.parse::<f64>().ok()).unwrap_or(0.0);
        let (time, x) = (next(), next());
        text + &format!("{time:.3},{:.6},{:.6}\n", 50.0 + x, 50.0)
    });
    write("log.csv", &shifted);
    let output = feedbits_in(
        folder.path(),
        &["judge", "log.csv", "--machine", "mill", "--period", "1", "--part", "p.nc", "--units", "inch"],
    );
    let said = unfolded(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(
        said.contains(
            "its size is that of the part times 25.4, as of another unit: --units says that of the log"
        ),
        "{said}"
    );
}

const OF_A_RUN: &str = "[machine]\ninterpolation_period_ms = 1.0\nfeedrate_mm_per_s = 100.0\nacceleration_mm_per_s2 = 1000.0\n\
     jerk_mm_per_s3 = 10000.0\n[machine.axes.x]\njerk_mm_per_s3 = 10000.0\n";

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

/// X from rest to rest over 40 mm: up at 900 mm/s² to 30 mm/s, and down, without a limit of the jerk. Row 500 is off by `off_mm`.
fn log_of_x(off_mm: f64) -> String {
    let (a, v, whole) = (900e-6, 30e-3, 40.0);
    let ramp = v / a;
    let total = whole / v + ramp;
    let way = |t: f64| if t < ramp { a * t * t / 2.0 } else { v * (t - ramp / 2.0) };
    let place = |t: f64| if t < total / 2.0 { way(t) } else { whole - way((total - t).max(0.0)) };
    let row = |row: u32| {
        let x = place(f64::from(row.saturating_sub(5))) + if row == 500 { off_mm } else { 0.0 };
        format!("{:.3},{x:.6},0.000000\n", 1e-3 * f64::from(row))
    };
    (0..1400).map(row).fold(String::from("time,x,y\n"), |text, row| text + &row)
}

const SETTINGS: &str = "[EMC]\n[EMCMOT]\nSERVO_PERIOD = 1000000\n[TRAJ]\nLINEAR_UNITS = mm\nDEFAULT_LINEAR_VELOCITY = 20\n\
     MAX_LINEAR_ACCELERATION = 1000\n[AXIS_X]\nMAX_VELOCITY = 40\nMAX_ACCELERATION = 1000\n[AXIS_Y]\nMAX_VELOCITY = 40\n\
     MAX_ACCELERATION = 1000\n";

/// The settings of a control, which bounds neither the jerk nor the feed of the path, become limits of a log as they
/// are. The plan of such a file has a jerk and a feed, which are told and not judged.
#[test]
fn a_log_is_judged_by_the_settings_of_its_control() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("mill.ini"), SETTINGS).expect("a file");
    fs::write(folder.path().join("log.csv"), log_of_x(0.0)).expect("a file");
    let made = feedbits_in(folder.path(), &["machine", "--from", "mill.ini", "--out", "m.toml"]);
    assert_eq!(made.status.code(), Some(0), "{}", unfolded(&made.stderr));
    let judged = feedbits_in(folder.path(), &["judge", "log.csv", "--machine", "m.toml"]);
    let said = unfolded(&judged.stdout);
    assert_eq!(judged.status.code(), Some(0), "{said}");
    for what in [
        "jerk along the path: the machine's file assumes 40000 mm/s³",
        "feed: the machine's file assumes 20 mm/s",
    ] {
        assert!(said.contains(what), "{what}: {said}");
    }
    let with =
        feedbits_in(folder.path(), &["judge", "log.csv", "--machine", "m.toml", "--assumed", "--json"]);
    assert_eq!(with.status.code(), Some(1));
    let found = json(&with);
    assert_eq!(found["faults"], serde_json::json!(["feed is broken"]));
    // The deviation that is assumed lets the path have corners that the log does not show.
    let jerk = ("jerk along the path".to_string(), "broken_unless_corner".to_string());
    assert!(verdicts(&found).contains(&jerk), "{found}");
}

#[test]
fn a_log_that_is_worse_than_the_baseline_has_a_status_of_its_own() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("a file");
    write("m.toml", "[machine]\n[machine.axes.x]\nvelocity_mm_per_s = 40\nacceleration_mm_per_s2 = 1000\n");
    write("other.toml", "[machine]\n[machine.axes.x]\nvelocity_mm_per_s = 50\n");
    write("log.csv", &log_of_x(0.0));
    write("worse.csv", &log_of_x(4.8e-4));
    let judge = |log: &str, machine: &str, more: &[&str]| {
        feedbits_in(folder.path(), &[&["judge", log, "--machine", machine], more].concat())
    };
    assert_eq!(judge("log.csv", "m.toml", &["--json", "--out", "before.json"]).status.code(), Some(0));
    let baseline = ["--baseline", "before.json"];
    let same = judge("log.csv", "m.toml", &baseline);
    assert_eq!(same.status.code(), Some(0), "{}", unfolded(&same.stderr));
    assert!(
        unfolded(&same.stderr).contains("every figure is at most 1 % worse"),
        "{}",
        unfolded(&same.stderr)
    );
    // 4.8e-4 mm are 960 mm/s², of a limit of 1000, where the motion takes 900.
    let worse = judge("worse.csv", "m.toml", &baseline);
    let said = unfolded(&worse.stderr);
    assert_eq!(worse.status.code(), Some(3), "{said}");
    assert!(said.contains("acceleration of X, share of its limit as it is was 0.9"), "{said}");
    let refused = judge("log.csv", "other.toml", &baseline);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        unfolded(&refused.stderr).contains("before.json was made with axes"),
        "{}",
        unfolded(&refused.stderr)
    );
    write("part.nc", "G21 G90\nG1 X40 F1800\n");
    let refused = judge("log.csv", "m.toml", &["--baseline", "before.json", "--part", "part.nc"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        unfolded(&refused.stderr).contains("is of a log without a part"),
        "{}",
        unfolded(&refused.stderr)
    );
}

#[test]
fn a_report_has_the_path_and_the_charts() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("log.csv"), log_of_x(4e-3)).expect("a file");
    fs::write(folder.path().join("m.toml"), "[machine]\n[machine.axes.x]\nacceleration_mm_per_s2 = 1000\n")
        .expect("a file");
    let judged = feedbits_in(folder.path(), &["judge", "log.csv", "--machine", "m.toml", "--report", "out"]);
    assert_eq!(judged.status.code(), Some(1), "{}", unfolded(&judged.stderr));
    assert!(unfolded(&judged.stderr).contains("report in out"), "{}", unfolded(&judged.stderr));
    let files = [
        "acceleration.svg",
        "feed.svg",
        "index.html",
        "jerk.svg",
        "limits.csv",
        "limits.json",
        "log-path.svg",
    ];
    assert_eq!(names(&folder.path().join("out")), files);
    let read = |name: &str| fs::read_to_string(folder.path().join("out").join(name)).expect("a file");
    assert!(read("index.html").contains("acceleration of X is broken"));
    assert!(read("limits.csv").contains("acceleration of X,1000"), "{}", read("limits.csv"));
    // The place that takes more than its limit has a colour of its own.
    assert!(read("log-path.svg").contains("trail v4"), "{}", read("log-path.svg"));
    let input =
        feedbits_in(folder.path(), &["judge", "out/feed.svg", "--machine", "m.toml", "--report", "out"]);
    assert_eq!(input.status.code(), Some(2));
}

/// A line of the charts ends at a gap of the log: a log with a gap has one more stretch in each, and no point is drawn across.
#[test]
fn a_chart_of_a_log_breaks_where_rows_are_missing() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("m.toml"), "[machine]\n[machine.axes.x]\nacceleration_mm_per_s2 = 1000\n")
        .expect("a file");
    let whole = log_of_x(0.0);
    let rows: Vec<&str> = whole.lines().collect();
    let with_a_gap = [&rows[..700], &rows[760..]].concat().join("\n") + "\n";
    let stretches = |log: &str, charts: [&str; 3]| {
        fs::write(folder.path().join("log.csv"), log).expect("a file");
        let arguments = ["judge", "log.csv", "--machine", "m.toml", "--report", "out"];
        feedbits_in(folder.path(), &arguments);
        charts.map(|chart| {
            let svg = fs::read_to_string(folder.path().join("out").join(chart)).expect("a picture");
            let lines = svg.lines().filter(|line| line.contains("class=\"line\""));
            lines.map(|line| line.matches('M').count()).sum::<usize>()
        })
    };
    let charts = ["feed.svg", "acceleration.svg", "jerk.svg"];
    let [sound, broken] = [&whole, &with_a_gap].map(|log| stretches(log, charts));
    assert_eq!(broken, [sound[0] + 1, sound[1] + 3, sound[2] + 3], "{sound:?}");
}

/// The page on JSON has each key that a judged log may have.
#[test]
fn the_page_on_json_has_every_key_of_a_judged_log() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).expect("a file");
    write(
        "m.toml",
        "[machine]\n[machine.axes.x]\nacceleration_mm_per_s2 = 900\nassumed = [\"acceleration_mm_per_s2\"]\n[machine.axes.y]\njerk_mm_per_s3 = 9\n",
    );
    // Off, with rows twice and missing.
    let mut rows: Vec<String> = log_of_x(4e-3).lines().map(str::to_string).collect();
    rows.remove(700);
    rows.insert(800, rows[800].clone());
    write("log.csv", &(rows.join("\n") + "\n"));
    write("part.nc", "G21 G90\nG1 X20 F600\nG1 X20 Y9\nG1 X20 Y0\nG1 X45\n");
    let words =
        ["judge", "log.csv", "--machine", "m.toml", "--part", "part.nc", "--tolerance", "0.01", "--json"];
    let mut found = BTreeSet::new();
    keys(&json(&feedbits_in(folder.path(), &words)), &mut found);
    assert!(
        found.contains("over_feed") && found.contains("skipped") && found.contains("missing_at_rest"),
        "{found:?}"
    );
    let page = include_str!("../../../../docs/json.md");
    let missing: Vec<_> = found.iter().filter(|key| !page.contains(&format!("`{key}`"))).collect();
    assert!(missing.is_empty(), "docs/json.md does not have {missing:?}");
}
