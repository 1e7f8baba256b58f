//! Runs of a plan that sees no more than a window of the path.

use crate::command::feedbits;
use crate::message::unfolded;

fn json(arguments: &[&str]) -> serde_json::Value {
    let output = feedbits(&[arguments, &["--json"]].concat());
    assert!(output.status.success(), "{arguments:?}: {}", unfolded(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

/// Chords of each period, in mm.
fn chords(arguments: &[&str]) -> Vec<f64> {
    let rows = json(&[&["interpolate"], arguments].concat());
    let rows = rows.as_array().expect("rows");
    rows.iter().map(|row| row["chord_mm"].as_f64().expect("a chord")).collect()
}

/// Paper A's machine, with a period of 3 ms.
const ACCELERATION: f64 = 5000.0 * 3e-3 * 3e-3;
const JERK: f64 = 4e5 * 3e-3 * 3e-3 * 3e-3;

fn assert_kept(chords: &[f64]) {
    let steps = [&[0.0, 0.0], chords, &[0.0, 0.0]].concat();
    let acceleration = steps.windows(2).map(|w| (w[1] - w[0]).abs()).fold(0.0, f64::max);
    let jerk = steps.windows(3).map(|w| (w[2] - 2.0 * w[1] + w[0]).abs()).fold(0.0, f64::max);
    assert!(acceleration <= ACCELERATION + 1e-9, "{}", acceleration / ACCELERATION);
    assert!(jerk <= JERK * 1.001 + 1e-6, "{}", jerk / JERK);
}

#[test]
fn a_run_through_a_window_keeps_what_a_run_of_the_whole_plan_keeps() {
    let compared = |window: &[&str]| {
        let found = json(&[&["compare", "--formats", "I4F28,f64", "--evaluate", "pieces"], window].concat());
        for row in found["formats"].as_array().expect("rows") {
            assert_eq!(row["verdict"]["result"], "good", "{window:?}: {row}");
            let jerk = row["jerk_max_mm_per_s3"].as_f64().expect("a jerk");
            assert!(jerk <= 4e5 * 1.001, "{window:?}: {jerk}");
        }
        found["part"].clone()
    };
    let whole = compared(&[]);
    assert!(whole.get("window_mm").is_none());
    let mut before = f64::MAX;
    for window in ["2", "5", "20", "1000"] {
        for profile in ["fastest", "cubic", "s-curve", "trigonometric", "flexible"] {
            let part = compared(&["--window", window, "--profile", profile]);
            assert_eq!(part["window_mm"].as_f64(), window.parse().ok());
            let [time, best] = [&part, &whole].map(|part| part["planned_time_s"].as_f64().expect("a time"));
            assert!(time >= best - 0.01, "{window} {profile}: {time} for {best}");
            if profile == "fastest" {
                assert!(time <= before, "{window}: {time} after {before}");
                before = time;
            }
        }
    }
    let best = whole["planned_time_s"].as_f64().expect("a time");
    assert!(before <= best + 0.01, "{before} for {best}");
}

#[test]
fn every_command_that_runs_a_plan_takes_a_window_and_says_so() {
    let commands: [&[&str]; 5] = [
        &["interpolate"],
        &["compare", "--formats", "f64", "--evaluate", "pieces"],
        &["size"],
        &["servo", "--formats", "f64"],
        &["compile", "--format", "I4F28"],
    ];
    for command in commands {
        let output = feedbits(&[command, &["--window", "20"]].concat());
        assert!(output.status.success(), "{command:?}: {}", unfolded(&output.stderr));
        let said = unfolded(&output.stderr);
        assert!(said.contains("with 20 mm of the path in view at a time"), "{command:?}: {said}");
        for window in ["0", "-1", "nan", "inf"] {
            let refused = feedbits(&[command, &["--window", window]].concat());
            assert_eq!(refused.status.code(), Some(2), "{command:?} {window}");
            let expected = format!("'{window}' for '--window <MM>': expected a number of 0.01 to 1e7 mm");
            assert!(unfolded(&refused.stderr).contains(&expected), "{}", unfolded(&refused.stderr));
        }
        let refused = feedbits(&[command, &["--window", "20", "--end-feed", "10"]].concat());
        assert_eq!(refused.status.code(), Some(2), "{command:?}");
        assert!(unfolded(&refused.stderr).contains("--window"), "{command:?}");
    }
    let output = feedbits(&["compare", "--window", "20", "--formats", "f64"]);
    assert!(unfolded(&output.stdout).contains("with 20 mm in view"), "{}", unfolded(&output.stdout));
}

#[test]
fn overrides_go_with_a_window() {
    let overrides = ["--window", "20", "--override", "0.9:50,1.8:0,3.5:150"];
    let run = chords(&overrides);
    assert_kept(&run);
    // A hold from 1.8 s on, which is over at 3.5 s.
    let still = |from: usize, to: usize| run[from..to].iter().all(|chord| *chord == 0.0);
    assert!(still(700, 1160) && !still(1180, 1200), "{:?}", &run[1160..1200]);
    let (plain, whole): (f64, f64) = (chords(&["--window", "20"]).iter().sum(), run.iter().sum());
    assert!((plain - whole).abs() < 1e-3, "{plain} {whole}");
}

#[test]
fn a_window_goes_with_every_format_that_plans() {
    let time = |planner: &str| {
        let found = json(&["plan", "--window", "20", "--plan-in", planner]);
        found["time_s"].as_f64().expect("a time")
    };
    let expected = time("f64");
    for planner in ["f32", "I32F32"] {
        let found = time(planner);
        assert!((found / expected - 1.0).abs() < 0.02, "{planner}: {found} for {expected}");
    }
    let same = json(&["compare", "--window", "20", "--plan-in", "same", "--formats", "f32,f64"]);
    assert!(same["formats"].as_array().is_some_and(|rows| rows.len() >= 2), "{same}");
}
