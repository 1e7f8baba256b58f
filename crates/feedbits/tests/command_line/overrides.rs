//! Feed override and feed hold while a plan runs.

use std::process::Output;

use crate::command::{data, feedbits};
use crate::message::unfolded;

fn interpolate(arguments: &[&str]) -> Output {
    feedbits(&[&["interpolate"], arguments].concat())
}

/// Chords of each period in mm, and the time of the run in s.
fn chords(arguments: &[&str]) -> (Vec<f64>, f64) {
    let output = interpolate(&[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{}", unfolded(&output.stderr));
    let rows: Vec<serde_json::Value> = serde_json::from_slice(&output.stdout).expect("JSON");
    let chord = |row: &serde_json::Value| row["chord_mm"].as_f64().expect("a chord");
    (rows.iter().map(chord).collect(), rows.last().expect("rows")["time_s"].as_f64().expect("a time"))
}

/// Paper A's machine, with a period of 3 ms.
const ACCELERATION: f64 = 5000.0 * 3e-3 * 3e-3;
const JERK: f64 = 4e5 * 3e-3 * 3e-3 * 3e-3;

fn assert_kept(chords: &[f64], slack: f64) {
    let steps = [&[0.0, 0.0], chords, &[0.0, 0.0]].concat();
    let acceleration = steps.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
    let jerk = steps.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).abs()).fold(0.0, f64::max);
    assert!(acceleration <= ACCELERATION + slack, "{}", acceleration / ACCELERATION);
    assert!(jerk <= JERK + slack, "{}", jerk / JERK);
}

#[test]
fn a_hold_stops_the_feed_and_the_path_is_finished_all_the_same() {
    for (format, slack) in [("f64", 1e-7), ("I4F28", 1e-6)] {
        let overrides = ["--format", format, "--override", "0.9:50,1.8:0,3.5:150"];
        let (chords, time) = chords(&overrides);
        assert_kept(&chords, slack);
        // At most half of the feed of 200 mm/s, then a hold that ends at period 1167.
        let slow = chords[400..600].iter().copied().fold(0.0, f64::max);
        assert!(slow <= 0.3 * (1.0 + 1e-6), "{format}: {slow}");
        let held = chords.iter().take_while(|chord| **chord > 0.0).count();
        assert!((600..800).contains(&held), "{format}: held from period {held}");
        assert!(chords[held..1166].iter().all(|chord| *chord == 0.0), "{format}");
        assert!(chords[1170] > 0.0, "{format}");
        let fastest = chords.iter().copied().fold(0.0, f64::max);
        assert!(fastest > 0.85 && fastest < 0.9 + 1e-6, "{format}: {fastest}");
        let travelled: f64 = chords.iter().sum();
        assert!((travelled - 834.706).abs() < 2e-2 && time > 6.0, "{format}: {travelled} mm in {time} s");
    }
}

#[test]
fn without_a_change_the_feed_is_the_plan_s() {
    let (chords, _) = chords(&["--override", "0:100"]);
    assert_kept(&chords, 1e-7);
    let fastest = chords.iter().copied().fold(0.0, f64::max);
    // The plan takes a whole number of periods, so it is slightly slower than possible.
    assert!((0.599..=0.6).contains(&fastest), "{fastest}");
}

/// An override that holds from the start on holds at the start too: the run does not begin at the full feed and then
/// slow down.
#[test]
fn an_override_from_the_start_on_is_there_at_the_start() {
    let (held, _) = chords(&["--override", "0:0,1:100"]);
    assert_kept(&held, 1e-7);
    assert!(held[..333].iter().all(|chord| *chord == 0.0) && held[340] > 0.0, "{:?}", &held[330..342]);
    let (slow, _) = chords(&["--override", "0:50"]);
    let fastest = slow.iter().copied().fold(0.0, f64::max);
    assert!((0.299..=0.3).contains(&fastest), "{fastest}");
}

/// Back and forth along X, and round a corner of arcs, on axes that can do less than the path.
#[test]
fn what_each_axis_can_do_is_kept_while_the_rate_changes() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name).display().to_string();
        std::fs::write(&path, text).expect("the folder is writable");
        path
    };
    let machine = "[machine]\ninterpolation_period_ms = 1.0\nfeedrate_mm_per_s = 100.0\nacceleration_mm_per_s2 = 2000.0\n\
        jerk_mm_per_s3 = 50000.0\nchord_error_mm = 0.0005\nfluctuation_limit = 1e-6\nparameter_tolerance = 1e-6\n\
        max_iterations = 5\n";
    let acceleration =
        "[machine.axes.x]\nvelocity_mm_per_s = 80\nacceleration_mm_per_s2 = 500\njerk_mm_per_s3 = 9000\n";
    let jerk_only = "[machine.axes.x]\njerk_mm_per_s3 = 9000\n";
    let line = file("line.nc", "G21 G90\nG0 X0 Y0\nG1 X60 F4800\nX0\n");
    let arcs = file("arcs.nc", "G21 G90\nG0 X0 Y0\nG3 X40 Y0 I20 J0 F4800\nG3 X0 Y0 I-20 J0\n");
    for (part, axes, most) in
        [(&line, acceleration, 500.0), (&arcs, acceleration, 500.0), (&arcs, jerk_only, f64::INFINITY)]
    {
        let machine = file("machine.toml", &format!("{machine}{axes}"));
        let overrides = ["--override", "0.3:0,0.5:100,0.9:30,1.3:100"];
        let output =
            interpolate(&[&[part.as_str(), "--machine", &machine, "--json"], &overrides[..]].concat());
        assert!(output.status.success(), "{}", unfolded(&output.stderr));
        let rows: Vec<serde_json::Value> = serde_json::from_slice(&output.stdout).expect("JSON");
        let x = |row: &serde_json::Value| row["point_mm"][0].as_f64().expect("a place");
        // The tool is at rest before and after.
        let end = rows.last().map(x).expect("rows");
        let places: Vec<f64> = [0.0; 3].into_iter().chain(rows.iter().map(x)).chain([end; 3]).collect();
        let peak = |differences: Vec<f64>| differences.iter().fold(0.0_f64, |most, d| most.max(d.abs()));
        let acceleration = peak(places.windows(3).map(|w| w[2] - 2.0 * w[1] + w[0]).collect()) * 1e6;
        let jerk = peak(places.windows(4).map(|w| w[3] - 3.0 * (w[2] - w[1]) - w[0]).collect()) * 1e9;
        assert!(acceleration <= most * (1.0 + 1e-3), "{part}: {acceleration} mm/s²");
        assert!(jerk <= 9000.0 * (1.0 + 1e-2), "{part}: {jerk} mm/s³");
    }
}

/// A run slower than its plan was once up to a few micrometres before a stop when the plan was there. It cut the
/// corner, and took the rest in the last period, with up to 32 times the jerk limit.
#[test]
fn a_slower_run_lands_on_every_stop() {
    let part = data("engraving.nc");
    for overrides in ["0:30", "0:50", "0:80", "0.5:120,9:60,15:0,16:90"] {
        let folder = tempfile::tempdir().expect("a temporary folder");
        let machine = folder.path().join("machine.toml").display().to_string();
        let text = "[machine]\ninterpolation_period_ms = 1.0\nfeedrate_mm_per_s = 100.0\nacceleration_mm_per_s2 = 1500.0\n\
            jerk_mm_per_s3 = 30000.0\nchord_error_mm = 0.002\nfluctuation_limit = 1e-6\nparameter_tolerance = 1e-6\n\
            max_iterations = 5\n";
        std::fs::write(&machine, text).expect("the folder is writable");
        let (chords, _) = chords(&[&part, "--machine", &machine, "--override", overrides]);
        let steps = [&[0.0, 0.0], &chords[..], &[0.0, 0.0]].concat();
        let jerk = steps.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).abs()).fold(0.0, f64::max) / 3e-5;
        assert!(jerk <= 1.05, "{overrides}: {jerk} J");
    }
}

#[test]
fn overrides_out_of_range_are_refused() {
    for (arguments, reason) in [
        (&["--override", "1:0"][..], "the last override is 0 %"),
        (&["--override", "1:250"], "the override 250: expected 0, or a number of 1 to 200 %"),
        (&["--override", "2:50,1:100"], "override at 1 s: expected a number of 0 to 1e6 s, in order"),
        (&["--override", "1"], "expected S:PERCENT, as in 0.5:150"),
        (
            &["--override", "1:50", "--reserve", "0"],
            "'--reserve <PERCENT>': expected a number of 0.1 to 99 %",
        ),
        (&["--override", "1:50", "--solver", "secant"], "--override goes with pieces"),
        (&["--override", "1:50", "--start-feed", "100"], "cannot be used with"),
        (&["--override", "1:50", "--end-feed", "100"], "cannot be used with"),
    ] {
        let refused = interpolate(arguments);
        let message = unfolded(&refused.stderr);
        assert_eq!(refused.status.code(), Some(2), "{arguments:?}");
        assert!(message.contains(reason) && refused.stdout.is_empty(), "{arguments:?}: {message}");
    }
}

/// An override that came too late once changed nothing, without a message.
#[test]
fn an_override_behind_the_end_of_the_run_is_named() {
    let said = |overrides: &str| {
        let output = interpolate(&["--override", overrides]);
        assert_eq!(output.status.code(), Some(0));
        unfolded(&output.stderr)
    };
    let late = said("1:50,20:100");
    assert!(late.contains("the override at 20 s is never in force: the run ends at 8.691 s"), "{late}");
    assert!(!said("1:50,2:100").contains("never in force"));
}
