//! Input and options that the command refuses: a message names the place and what was expected.

use std::fs;
use std::path::Path;

use crate::command::{data, feedbits, feedbits_in, folder, written};
use crate::message::unfolded;

/// Bad input gives exit status 2, a message with the fault and its place, and no file.
#[test]
fn bad_input_is_explained() {
    let folder = folder();
    let good = fs::read_to_string(data("seed-000.toml")).expect("readable");
    let cases = [
        ("not a part at all \u{1F600}", vec![]),
        (&good.replace("weights = [1, 1", "weights = [1, -1") as &str, vec!["weight"]),
        (&good.replace("0.25, 0.5,", "0.5, 0.25,"), vec!["knot"]),
        (&good.replace("feedrate_mm_per_s = 200.0", "feedrate_mm_per_s = 0.0"), vec!["feedrate_mm_per_s"]),
        (
            &good.replace("interpolation_period_ms = 3.0", "interpolation_period_ms = 0.0"),
            vec!["interpolation_period_ms"],
        ),
        (&good.replace("jerk_mm_per_s3 = 400000.0", "jerk_mm_per_s3 = nan"), vec!["jerk_mm_per_s3"]),
        (&good.replace("degree = 3", "degre = 3"), vec!["degre"]),
        (&good.replace("[0, 300]", "[0, inf]"), vec!["control"]),
    ];
    for (index, (content, expected)) in cases.iter().enumerate() {
        assert_ne!(*content, good, "case {index} changes something");
        let part = written(folder.path(), &format!("case{index}.toml"), content);
        let out = folder.path().join("out.csv").display().to_string();
        let output = feedbits(&["interpolate", &part, "--machine", &part, "--out", &out]);
        let message = unfolded(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "case {index}: {message}");
        assert!(message.contains(&format!("case{index}.toml")), "case {index}: {message}");
        for word in expected {
            assert!(message.contains(word), "case {index}: {word} in {message}");
        }
        assert!(!Path::new(&out).exists(), "case {index} wrote a file");
    }
}

#[test]
fn bad_usage_is_explained() {
    let machine = data("seed-003.nc");
    for (arguments, word) in [
        (vec!["compare", "no-such-file.toml"], "no-such-file.toml"),
        (vec!["compare", machine.as_str()], "--machine"),
        (vec!["compare", "--formats", "Q31"], "Q31"),
        (vec!["compare", "--plan-in", "f16"], "f16"),
        (vec!["compare", "--fluctuation", "2"], "--fluctuation"),
        (vec!["interpolate", "--piece-length", "0"], "--piece-length"),
        (vec!["interpolate", "--evaluate", "pieces", "--solver", "secant"], "de-boor"),
        (vec!["interpolate", "--out", "no/such/folder/s.csv"], "no/such/folder/s.csv"),
        (vec!["compare", "--formats", "I1F31"], "3 to 64 bits in all, at least 2 of them before the point"),
        (vec!["compare", "--formats", "I64F64"], "3 to 64 bits in all"),
        (
            vec!["compare", "--piece-length", "-1"],
            "'--piece-length <MM>': expected a number of 0.001 to 1e6 mm",
        ),
        (vec!["compare", "--start-feed", "-1"], "'--start-feed <MM_PER_S>': expected 0, or a number of"),
        (
            vec!["compare", "--fluctuation", "-0.001"],
            "'--fluctuation <RATIO>': expected a ratio of 1e-16 to below 1",
        ),
        (vec!["compare", "--solver-tolerance", "0"], "'--solver-tolerance <RATIO>': expected a ratio"),
        (vec!["plan", "--oversample", "3"], "--out"),
        (vec!["plan", "--oversample", "3", "--out", "s.csv", "--json"], "--json"),
        (vec!["plan", "--window", "-1"], "'--window <MM>': expected a number of 0.01 to 1e7 mm"),
        (vec!["plan", "--oversample", "-1"], "expected a whole number of 1 to 1000 a period"),
        (vec!["interpolate", "--override", "-1:50,2:100"], "the time -1: expected a number of 0 to 1e6 s"),
        (
            vec!["interpolate", "--override", "1:50,2:100", "--reserve", "-1"],
            "'--reserve <PERCENT>': expected a number of 0.1 to 99 %",
        ),
        (
            vec!["convert", "--to", "g1", "--tolerance", "-1"],
            "'--tolerance <MM>': expected a number of 1e-9 to 100 mm",
        ),
        (vec!["convert", "--to", "g06.2", "--tolerance", "0.1"], "expected --to g1"),
        (vec!["compare", "--multipliers", "4"], "--multipliers: no target is priced that has multipliers"),
        (vec!["compare", "--targets", "cortex-m3", "--dividers", "1"], "--dividers: no target is priced"),
        (vec!["compare", "--dialect", "-0.0"], "invalid value '-0.0' for '--dialect"),
        (vec!["size", "--formats", "-1"], "unexpected argument '--formats'"),
        (vec!["compare", "--formats", "-1"], "unknown format \"-1\""),
        (vec!["plan", "--solver", "secant"], "unexpected argument '--solver'"),
        (vec!["plan", "--piece-length", "8"], "unexpected argument '--piece-length'"),
        (vec!["smooth", "--tolerance", "-1"], "'--tolerance <MM>': expected a number of 1e-9 to 100 mm"),
        (vec!["servo", "--circle", "-1"], "'--circle <MM>': expected a number of 1e-6 to 1e5 mm"),
        (vec!["size", "--evaluate", "de-boor"], "registers are sized for compiled pieces"),
        (vec!["size", "--solver", "taylor-1"], "registers are sized for compiled pieces"),
        (
            vec!["interpolate", "--format", "f32", "--plan-in", "I4F28"],
            "planning in I4F28: control point 0 does not fit",
        ),
    ] {
        let output = feedbits(&arguments);
        let message = unfolded(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(word), "{arguments:?}: {message}");
    }
}

/// Over a millionth of its span this curve runs along two sides of its polygon. It was planned without these, 208 mm too short.
#[test]
fn a_length_that_the_planner_does_not_see_is_refused_at_its_curve() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let part = "[curve]\ndegree = 3\ncontrol_points_mm = [[150, 150], [0, 0], [0, 300], [150, 150], [300, 0], [300, 300], [150, 150]]\n\
                weights = [1, 1e9, 1e-9, 1, 1e6, 1, 1]\nknots = [0, 0, 0, 0, 0.25, 0.5, 0.75, 1, 1, 1, 1]\n";
    fs::write(folder.path().join("lost.toml"), part).expect("the folder is writable");
    for command in ["plan", "compare", "interpolate", "size", "smooth --tolerance 0.01"] {
        let words: Vec<&str> = command.split(' ').chain(["lost.toml", "--machine", "mill"]).collect();
        let output = feedbits_in(folder.path(), &words);
        let said = unfolded(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{command}: {said}");
        assert!(said.contains("lost.toml") && said.contains("span 0 of curve 0 runs much faster"), "{said}");
        assert!(output.stdout.is_empty(), "{command}");
    }
}

/// Runs of more than 2^30 periods are refused at once, and the message has the numbers that make them so long. Each of these is within
/// its domain.
#[test]
fn endless_runs_are_refused_before_they_begin() {
    let folder = folder();
    let good = fs::read_to_string(data("seed-000.toml")).expect("readable");
    let short = good.replace("interpolation_period_ms = 3.0", "interpolation_period_ms = 1e-3");
    for (from, key, words) in [
        ("feedrate_mm_per_s = 200.0", "feedrate_mm_per_s = 0.001", "a feedrate of 0.001 mm/s"),
        (
            "acceleration_mm_per_s2 = 5000.0",
            "acceleration_mm_per_s2 = 0.001",
            "an acceleration of 0.001 mm/s²",
        ),
        (
            "chord_error_mm = 0.0005",
            "chord_error_mm = 1\ncentripetal_acceleration_mm_per_s2 = 0.001",
            "a centripetal acceleration of 0.001 mm/s²",
        ),
    ] {
        let changed = short.replace(from, key);
        assert_ne!(changed, short, "{key}");
        let machine = written(folder.path(), "m.toml", &changed);
        for command in ["compare", "interpolate", "plan", "size"] {
            let output = feedbits(&[command, "--machine", &machine]);
            let message = unfolded(&output.stderr);
            assert_eq!(output.status.code(), Some(2), "{command} {key}: {message}");
            assert!(
                message.contains(words)
                    && message.contains("periods of 0.001 ms")
                    && message.contains("at most 1073741824"),
                "{command} {key}: {message}"
            );
        }
    }
    let slow = good.replace("feedrate_mm_per_s = 200.0", "feedrate_mm_per_s = 0.01");
    let slow = written(folder.path(), "m.toml", &slow);
    let message = unfolded(&feedbits(&["servo", "--machine", &slow]).stderr);
    assert!(message.contains("at most 4194304 in `servo`"), "{message}");
    for arguments in [["--circle", "1e5"], ["--feed", "1e-3"]] {
        let output = feedbits(&[&["servo"], &arguments[..]].concat());
        let message = unfolded(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}: {message}");
        assert!(message.contains(arguments[0]) && message.contains("at most 1048576 in all"), "{message}");
    }
}
