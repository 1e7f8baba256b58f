//! `feedbits plan`, as a person runs it.

use std::process::Output;

use crate::command::{data, feedbits, folder, written};
use crate::message::{text, unfolded};

fn stdout(output: &Output) -> String {
    assert!(output.status.success(), "{}", unfolded(&output.stderr));
    text(&output.stdout)
}

#[test]
fn profiles_stand_side_by_side() {
    let table = stdout(&feedbits(&["plan", "--profile", "all"]));
    for name in ["cubic", "s-curve", "trigonometric", "flexible", "fastest", "none"] {
        assert!(table.contains(name), "{table}");
    }
    let json = stdout(&feedbits(&["plan", "--profile", "all", "--json"]));
    let summaries: serde_json::Value = serde_json::from_str(&json).expect("JSON");
    let summaries = summaries.as_array().expect("an array");
    assert_eq!(summaries.len(), 6);
    for summary in summaries.iter().filter(|summary| summary["profile"] != "none") {
        let figure = |key: &str| summary[key].as_f64().unwrap_or_else(|| panic!("{key} in {summary}"));
        assert!(figure("time_s") >= figure("jerk_free_time_s"));
        assert!(figure("over_jerk_free") < 0.02, "{summary}");
        assert!(figure("least_time_s") >= figure("jerk_free_time_s"));
        assert!((0.0..figure("over_jerk_free")).contains(&figure("over_least")), "{summary}");
        // In whole periods.
        assert!(summary["profile"] != "fastest" || figure("over_least") < 0.002, "{summary}");
        assert!(figure("acceleration_max_mm_per_s2") <= figure("acceleration_limit_mm_per_s2"));
        assert!(figure("jerk_max_mm_per_s3") <= figure("jerk_limit_mm_per_s3"));
        assert!((0.5..1.0).contains(&figure("share_at_commanded_feed")));
        assert_eq!(
            summary["stages"].as_array().map(|stages| stages.len() as u64),
            summary["stage_count"].as_u64()
        );
    }
}

#[test]
fn each_profile_runs_to_the_end_of_the_path() {
    for profile in ["cubic", "s-curve", "trigonometric", "flexible"] {
        let run = feedbits(&[
            "compare",
            &data("seed-000.toml"),
            "--profile",
            profile,
            "--formats",
            "I4F28,f64",
            "--json",
        ]);
        let comparison: serde_json::Value = serde_json::from_str(&stdout(&run)).expect("JSON");
        for row in comparison["formats"].as_array().expect("rows") {
            if row["engine"] == "pieces" {
                assert_eq!(row["verdict"]["result"], "good", "{profile}: {row}");
            }
        }
    }
}

/// Paper C's figures 8a to 10a: without look-ahead a sharp bend takes several times the acceleration.
#[test]
fn a_run_without_look_ahead_shows_what_look_ahead_buys() {
    let (part, machine) = (data("seed-003.nc"), data("seed-000.toml"));
    let found = |command: &[&str]| -> serde_json::Value {
        let run = feedbits(&[command, &[&part, "--machine", &machine, "--json"]].concat());
        serde_json::from_slice(&run.stdout).expect("JSON")
    };
    let plan = found(&["plan", "--profile", "none"]);
    let over = |key: &str| {
        plan[format!("{key}_max_mm_per_s{}", if key == "jerk" { 3 } else { 2 })].as_f64().unwrap()
    };
    assert!(over("acceleration") > 4.0 * 5000.0 && over("jerk") > 10.0 * 4e5, "{plan}");
    let compared = found(&["compare", "--profile", "none", "--formats", "f64", "--evaluate", "pieces"]);
    let times = &compared["part"]["without_look_ahead"];
    assert!(
        (times["acceleration"].as_f64().unwrap() / (over("acceleration") / 5000.0) - 1.0).abs() < 1e-12,
        "{times}"
    );
    assert!((times["jerk"].as_f64().unwrap() / (over("jerk") / 4e5) - 1.0).abs() < 1e-12, "{times}");
    let looking = found(&["compare", "--formats", "f64", "--evaluate", "pieces"]);
    assert!(looking["part"].get("without_look_ahead").is_none());
    let contour = |profile: &str| {
        let run = found(&["servo", "--profile", profile, "--formats", "f64"]);
        run["formats"][0]["contour_error_mm"]["max"].as_f64().unwrap_or_else(|| panic!("{run}"))
    };
    assert!(contour("none") > 1.5 * contour("fastest"), "{} {}", contour("none"), contour("fastest"));
}

#[test]
fn what_is_merged_is_explained() {
    let said = stdout(&feedbits(&["plan", "--explain", "--wide"]));
    let rows: serde_json::Value =
        serde_json::from_str(&stdout(&feedbits(&["plan", "--explain", "--json"]))).expect("JSON");
    let rows = rows.as_array().expect("rows");
    let merged = rows.iter().filter(|row| row["merged"] == true).count();
    assert_eq!(said.matches("merged, ").count(), merged, "{said}");
    assert_eq!(said.matches("kept: ").count(), rows.len() - merged, "{said}");
    for row in rows {
        assert_eq!(row["time_s"].is_null(), row["merged"] == false, "{row}");
        assert_eq!(row["why_not"].is_null(), row["merged"] == true, "{row}");
    }
    let plan: serde_json::Value =
        serde_json::from_str(&stdout(&feedbits(&["plan", "--profile", "flexible", "--json"]))).expect("JSON");
    let cosines =
        plan["stages"].as_array().expect("stages").iter().filter(|stage| stage["shape"] == "cosine");
    let level = rows.iter().filter(|row| row["merged"] == true && row["becomes"] == "constant");
    assert_eq!(cosines.count() + level.count(), merged);
    let refused = feedbits(&["plan", "--explain", "--profile", "cubic"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(unfolded(&refused.stderr).contains("expected --profile flexible, or none"));
}

#[test]
fn all_profiles_at_once_are_for_plan_only() {
    let refused = feedbits(&["compare", "--profile", "all"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(unfolded(&refused.stderr).contains("--profile all goes with `plan`"));
}

#[test]
fn a_window_is_hardly_slower_when_it_is_long_enough() {
    let time = |window: &[&str]| {
        let arguments = [&["plan", "--profile", "s-curve", "--json"], window].concat();
        let summary: serde_json::Value = serde_json::from_str(&stdout(&feedbits(&arguments))).expect("JSON");
        summary["time_s"].as_f64().expect("a time")
    };
    let (whole, wide, narrow) = (time(&[]), time(&["--window", "100"]), time(&["--window", "3"]));
    assert!(wide >= whole - 0.006 && wide < 1.02 * whole, "{wide} against {whole}");
    assert!(narrow >= whole - 0.006, "{narrow} against {whole}");
    let refused = feedbits(&["plan", "--window", "0"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(unfolded(&refused.stderr).contains("'--window <MM>': expected a number of 0.01 to 1e7 mm"));
}

/// `u end 0` and the following `u start 1` belong to two curves; the output once did not say to which.
#[test]
fn a_plan_along_several_curves_names_them() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (program, samples, machine) = (path("part.nc"), path("p.csv"), data("seed-000.toml"));
    std::fs::write(&program, "G21 G90\nG1 X0 Y0 F6000\nX20\nX40\nX40 Y20\nM30\n").expect("a file");
    let several = ["plan", &program, "--machine", &machine];
    let table = stdout(&feedbits(&several));
    let cells = |line: &str| {
        line.split("  ")
            .map(|cell| cell.trim().to_string())
            .filter(|cell| !cell.is_empty())
            .collect::<Vec<_>>()
    };
    let is_row = |line: &&str| !line.starts_with("and ");
    let lines = table.lines().skip_while(|line| !line.starts_with("stage ")).take_while(is_row);
    let rows: Vec<_> = lines.map(cells).collect();
    assert_eq!(rows[0][2], "curve", "{table}");
    let curves: Vec<_> = rows[2..].iter().map(|row| row[2].as_str()).collect();
    assert_eq!((curves.first(), curves.last()), (Some(&"0"), Some(&"2")), "{table}");
    assert!(curves.contains(&"0 to 1"), "{table}");
    let plan: serde_json::Value =
        serde_json::from_str(&stdout(&feedbits(&[&several[..], &["--json"]].concat()))).expect("JSON");
    assert_eq!((&plan["curves"], &plan["stages"][0]["curve_start"]), (&3.into(), &0.into()));
    stdout(&feedbits(&[&several[..], &["--out", &samples]].concat()));
    let csv = std::fs::read_to_string(&samples).expect("written");
    assert!(csv.starts_with("time_s,distance_mm,curve,u,"), "{csv}");
    assert!(!stdout(&feedbits(&["plan", &machine])).contains("curve"), "one curve needs no number");
}

/// The first screen has the first stages; --wide has all of them, with u and coefficients.
#[test]
fn long_plans_are_cut_short_on_the_first_screen_only() {
    let [first, wide] = [&["plan"][..], &["plan", "--wide"]].map(|plan| stdout(&feedbits(plan)));
    let json: serde_json::Value =
        serde_json::from_str(&stdout(&feedbits(&["plan", "--json"]))).expect("JSON");
    let count = json["stage_count"].as_u64().expect("a count");
    assert!(first.contains(&format!("and {} more stages", count - 20)), "{first}");
    assert!(!first.contains("u start") && first.lines().count() < 35, "{first}");
    assert!(wide.contains("u start") && wide.contains("a3"), "{wide}");
    assert!(wide.lines().count() as u64 > count && first.lines().next() == wide.lines().next(), "{wide}");
}

/// The least time of any plan has the same end feeds as the plan. It does not depend on how the plan shares out an
/// axis's limits.
#[test]
fn no_plan_beats_its_lower_bound() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let machine = folder.path().join("machine.toml");
    let text = std::fs::read_to_string(data("seed-000.toml")).expect("the example");
    let from = text.find("[machine]").expect("its machine");
    std::fs::write(&machine, format!("{}\n[machine.axes.x]\njerk_mm_per_s3 = 100.0\n", &text[from..]))
        .expect("a file");
    let slow = ["--machine", machine.to_str().expect("a path")];
    for more in [&["--start-feed", "100", "--end-feed", "100"][..], &slow, &[]] {
        let output = feedbits(&[&["plan", "--json", &data("seed-000.toml")], more].concat());
        assert!(output.status.success(), "{}", unfolded(&output.stderr));
        let plan: serde_json::Value = serde_json::from_str(&stdout(&output)).expect("JSON");
        assert!(
            plan["over_jerk_free"].as_f64().expect("a share") > 0.0,
            "{more:?}: {}",
            plan["over_jerk_free"]
        );
        assert!(plan["over_least"].as_f64().expect("a share") > 0.0, "{more:?}: {}", plan["over_least"]);
        let bound = plan["jerk_free_time_s"].as_f64().expect("a time");
        assert!(bound < 4.848, "{more:?}: {bound}");
    }
}

/// Each break of a circle in moves of 1 µm is far too small for a stop. The plan once passed the breaks at up to 135
/// mm/s, 20 µm off.
#[test]
fn a_circle_in_fine_moves_is_planned_within_the_chord_error() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let program = folder.path().join("circle.ngc");
    let at = |i: u32| core::f64::consts::TAU * f64::from(i) / 6283.0;
    let line = |i: u32| format!("G1 X{:.9} Y{:.9} F12000\n", at(i).cos(), at(i).sin());
    std::fs::write(&program, "G21 G90\n".to_string() + &(0..=6283).map(line).collect::<String>())
        .expect("a file");
    let (program, machine) = (program.to_str().expect("a path"), data("seed-000.toml"));
    let arguments = [program, "--machine", &machine, "--json"];
    let json = |more: &[&str]| -> serde_json::Value {
        serde_json::from_str(&stdout(&feedbits(&[more, &arguments].concat()))).expect("JSON")
    };
    // At 2 sqrt(E (2 ρ - E))/T = 21.08 mm/s, 6.283 mm take 0.298 s.
    for window in [&[][..], &["--window", "1"]] {
        let plan = json(&[&["plan"], window].concat());
        let time = plan["time_s"].as_f64().expect("a time");
        assert!((0.298..0.335).contains(&time), "{window:?}: {time}");
    }
    let comparison = json(&["compare", "--evaluate", "pieces", "--formats", "f64,I8F56"]);
    let rows = comparison["formats"].as_array().expect("rows");
    assert_eq!(rows.len(), 2, "{comparison}");
    for row in rows {
        assert_eq!(row["verdict"]["result"], "good", "{row}");
    }
}

/// Stages of 1e-10 s have feeds that differ by a unit of the last place. For such stages twice the allowed jerk was
/// once printed.
#[test]
fn what_rounding_makes_of_the_shortest_stages_is_no_peak() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let (smoothed, machine) = (folder.path().join("smoothed.toml"), data("seed-000.toml"));
    let smoothed = smoothed.to_str().expect("a path");
    let smooth = ["smooth", &data("engraving.nc"), "--machine", &machine, "--tolerance", "0.01"];
    stdout(&feedbits(&[&smooth[..], &["--out", smoothed]].concat()));
    let plan = ["plan", smoothed, "--machine", &machine, "--profile", "trigonometric", "--json"];
    let plan: serde_json::Value = serde_json::from_str(&stdout(&feedbits(&plan))).expect("JSON");
    let shortest =
        plan["stages"].as_array().expect("stages").iter().filter_map(|stage| stage["time_s"].as_f64());
    assert!(shortest.fold(f64::MAX, f64::min) < 1e-9);
    let jerk = plan["jerk_max_mm_per_s3"].as_f64().expect("a jerk");
    assert!((3.9e5..=4.001e5).contains(&jerk), "{jerk}");
}

/// With a chord error of 0.1 mm a stage once ended at 154.528 mm/s and the next began at 153.787. The third difference
/// of the distance was twice the allowed jerk, though the printed peak was within it.
#[test]
fn feeds_meet_where_the_chord_error_is_large() {
    let part = "[curve]
degree = 3
control_points_mm = [[19.57, -18.5], [36.01, -23.32], [49.09, -31.56], [54.93, -31.23], [36.56, -19.17], [51.55, -19.96],
                     [46.35, 0.82], [40.52, 18.44], [36.74, 12.57]]
weights = [1.16, 0.53, 0.98, 0.88, 0.53, 1.54, 1.33, 0.45, 0.73]
knots = [0.0, 0.0, 0.0, 0.0, 0.113, 0.134, 0.373, 0.919, 0.951, 1.0, 1.0, 1.0, 1.0]
";
    assert_third_differences_within(part, "chord_error_mm = 0.1");
}

/// Where corners are passed at a feed, the chord over each is shorter than the path, and the difference falls into one
/// period.
#[test]
fn feeds_meet_at_corners_that_are_passed() {
    let zigzag = "G21 G90\nG0 X0 Y0\nG1 X1 F1500\nY1\nX2\nY0\nX3\nY1\nX4\nM30\n";
    assert_third_differences_within(
        zigzag,
        "chord_error_mm = 0.002\njunction = \"deviation\"\njunction_deviation_mm = 0.02",
    );
}

/// Third differences of the distance over a period are means of the jerk. They are no more than the printed jerk, and
/// the printed jerk is no more than the limit.
fn assert_third_differences_within(part: &str, more: &str) {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let file = |name: &str, text: &str| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("a file");
        path.to_str().expect("a path").to_owned()
    };
    let machine = format!(
        "[machine]\ninterpolation_period_ms = 5\nfeedrate_mm_per_s = 200\nacceleration_mm_per_s2 = 2000\n\
         jerk_mm_per_s3 = 20000\nfluctuation_limit = 1e-5\nparameter_tolerance = 1e-6\nmax_iterations = 5\n{more}\n"
    );
    let part = file(if part.starts_with('[') { "part.toml" } else { "part.nc" }, part);
    let (machine, samples) = (file("machine.toml", &machine), file("samples.csv", ""));
    let period = 5e-3_f64;
    for profile in ["cubic", "s-curve", "trigonometric", "flexible"] {
        let plan = ["plan", &part, "--machine", &machine, "--profile", profile];
        stdout(&feedbits(&[&plan[..], &["--out", &samples]].concat()));
        let text = std::fs::read_to_string(&samples).expect("samples");
        let distance = |line: &str| line.split(',').nth(1).and_then(|field| field.parse().ok());
        let distances: Vec<f64> = text.lines().skip(1).filter_map(distance).collect();
        let third = |d: &[f64]| ((d[3] - d[0]) - 3.0 * (d[2] - d[1])).abs() / period.powi(3);
        let found = distances.windows(4).map(third).fold(0.0, f64::max);
        let json = stdout(&feedbits(&[&plan[..], &["--json"]].concat()));
        let summary: serde_json::Value = serde_json::from_str(&json).expect("JSON");
        let printed = summary["jerk_max_mm_per_s3"].as_f64().expect("a jerk");
        // The allowance is for rounding of stages and distances, in a file with all their digits.
        assert!(found <= (1.0 + 1e-7) * printed && printed <= 20_000.0, "{profile}: {found} {printed}");
    }
}

/// Writes a part and a machine into a folder and returns their names. The machine has a period of 1 ms, 1000 mm/s² and
/// the given further keys.
fn turned(folder: &tempfile::TempDir, program: &str, more: &str) -> [String; 2] {
    let machine = format!(
        "[machine]\ninterpolation_period_ms = 1\nfeedrate_mm_per_s = 100\nacceleration_mm_per_s2 = 1000\n\
         jerk_mm_per_s3 = 50000\nchord_error_mm = 0.01\nfluctuation_limit = 1e-5\nparameter_tolerance = 1e-6\n\
         max_iterations = 5\n{more}\n"
    );
    let files = [("part.nc", format!("G21 G90\nG0 X0 Y0\n{program}\nM30\n")), ("machine.toml", machine)];
    files.map(|(name, text)| {
        let path = folder.path().join(name);
        std::fs::write(&path, text).expect("a file");
        path.to_str().expect("a path").to_owned()
    })
}

/// A line of 16 m took 0.23 s longer than at F500, but was said to be run at F500.
#[test]
fn the_feed_that_is_run_is_said() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    for (program, at_least, at_most) in [
        ("G1 X16000 F500", 1.0 - 1e-6, 1.0),
        // A section that bends keeps one part in 8,192 in reserve.
        ("G2 I300 J0 F500", 1.0 - 1.0 / 8192.0 - 1e-5, 1.0 - 1.0 / 8192.0 + 1e-7),
    ] {
        let [part, machine] = turned(&folder, program, "");
        let plan = ["plan", &part, "--machine", &machine];
        let summary: serde_json::Value =
            serde_json::from_str(&stdout(&feedbits(&[&plan[..], &["--json"]].concat()))).expect("JSON");
        let run = summary["feed_over_commanded"].as_f64().expect("a feed");
        assert!((at_least..=at_most).contains(&run), "{program}: {run}");
        let at_feed = summary["length_mm"].as_f64().expect("a length") / (500.0 / 60.0);
        let time = summary["time_s"].as_f64().expect("a time");
        // The ramps at both ends take some hundredths of a second longer than the feed F would.
        assert!((0.0..0.05).contains(&(time - at_feed / run)), "{program}: {time} {at_feed}");
        let text = stdout(&feedbits(&plan));
        let said = format!("100 % of the path at {:.3} % of the commanded feed.", 100.0 * run);
        assert!(text.contains(&said), "{text}");
    }
}

/// "Peak acceleration 1000 of 1000 mm/s²" was once the only message where setpoints have five times as much across the
/// path.
#[test]
fn what_bends_take_is_said() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let circle = "G2 I2 J0 F6000\nG2 I2 J0";
    let limited = "centripetal_acceleration_mm_per_s2 = 1000";
    for (program, more, at_least, at_most, warns) in [
        // V²/ρ at 100 mm/s and 2 mm is 5000.
        (circle, "", 4000.0, 5010.0, true),
        (circle, limited, 900.0, 1415.0, false),
        ("G1 X50 F6000", "", 900.0, 1000.1, false),
    ] {
        let [part, machine] = turned(&folder, program, more);
        for command in [&["plan"][..], &["smooth", "--tolerance", "0.01"]] {
            let arguments = [command, &[&part, "--machine", &machine]].concat();
            let text = stdout(&feedbits(&arguments));
            assert_eq!(
                text.contains("Warning: `acceleration_mm_per_s2`, 1000, holds along"),
                warns,
                "{text}"
            );
            let json = stdout(&feedbits(&[&arguments[..], &["--json"]].concat()));
            let found: serde_json::Value = serde_json::from_str(&json).expect("JSON");
            let of = if command[0] == "plan" { &found } else { &found["setpoints"] };
            let most = of["total_acceleration_max_mm_per_s2"].as_f64().expect("an acceleration");
            assert!((at_least..=at_most).contains(&most), "{command:?} {program} {more}: {most}");
            assert!(
                text.contains(&format!("In all directions: peak acceleration {most:.0} mm/s²")),
                "{text}"
            );
        }
    }
}

/// A plan of a raster with 53,000 S words once rested 53,000 times.
#[test]
fn a_laser_passes_its_s_words() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let lines: String = (1..=50).map(|x| format!("G1 X{x} S{}\n", x * 10)).collect();
    let program = format!("G21 G0 X0 Y0\nM4 S5\nF6000\n{lines}");
    let time = |more: &str| {
        let [part, machine] = turned(&folder, &program, more);
        let json = stdout(&feedbits(&["plan", &part, "--machine", &machine, "--json"]));
        let summary: serde_json::Value = serde_json::from_str(&json).expect("JSON");
        summary["time_s"].as_f64().expect("a time")
    };
    // The path is 50 mm at 100 mm/s, and half of that time again to start and stop; with a rest at each millimetre it
    // takes ten times as long.
    let (passed, stopped) = (time("s_stops = false"), time("s_stops = true"));
    assert!(passed < 0.7 && stopped > 4.0, "{passed} {stopped}");
}

/// Without look-ahead a bend is braked for within a period. Setpoints and plan are given all the same.
#[test]
fn a_limit_that_is_broken_is_said_with_status_1() {
    for (command, what) in [("plan", "the plan: "), ("interpolate", "the run in f64: ")] {
        let output = feedbits(&[command, "--profile", "none"]);
        let said = unfolded(&output.stderr);
        assert_eq!(output.status.code(), Some(1), "{command}: {said}");
        assert!(said.contains(what) && said.contains("jerk along the path"), "{command}: {said}");
        assert!(output.stdout.len() > 500, "{command}");
        let kept = feedbits(&[command]);
        assert!(kept.status.success() && !unfolded(&kept.stderr).contains("limit"), "{command}");
    }
}

/// On a part of a spiral of short moves the feed rises where the tool gets out of a bend: its rise and the bend take of the acceleration of X
/// together, which no lower feed at the corners cures. The section is slowed down in the end.
#[test]
fn an_axis_keeps_its_acceleration_where_lower_feeds_do_not_help() {
    let folder = folder();
    let point = |i: u32| {
        let (turn, radius) = (f64::from(i) * 4.5_f64.to_radians(), 50.8 - 0.0635 * f64::from(i));
        format!("X{:.6} Y{:.6}\n", radius * turn.cos(), radius * turn.sin())
    };
    let moves: String = (301..500).map(|i| format!("G1 {}", point(i))).collect();
    let program = format!("G21 G90 G64\nG0 Z-2.54 {}F609.6\n{moves}M2\n", point(300));
    let machine = "[machine]\ninterpolation_period_ms = 2\nfeedrate_mm_per_s = 125.5\nacceleration_mm_per_s2 = 12.2\n\
        jerk_mm_per_s3 = 2474\nchord_error_mm = 0.00581\njunction = \"deviation\"\njunction_deviation_mm = 0.00519\n\
        [machine.axes.x]\nacceleration_mm_per_s2 = 3.417\njerk_mm_per_s3 = 4091\n";
    let [program, machine] = [("spiral.nc", program.as_str()), ("machine.toml", machine)]
        .map(|(name, text)| written(folder.path(), name, text));
    let ran = feedbits(&["interpolate", &program, "--machine", &machine, "--quiet"]);
    assert!(ran.status.success(), "{}", String::from_utf8_lossy(&ran.stderr));
}
