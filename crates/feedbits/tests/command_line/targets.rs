//! `feedbits targets` and `compare --targets`, as a person or a script uses them.

use std::fs;

use serde_json::Value;

use crate::command::feedbits;
use crate::message::{text, unfolded};

fn json(arguments: &[&str]) -> Value {
    let output = feedbits(&[arguments, &["--json"]].concat());
    serde_json::from_slice(&output.stdout).unwrap_or_else(|_| panic!("{}", unfolded(&output.stderr)))
}

#[test]
fn every_target_is_listed_and_every_number_has_a_source() {
    let listed = text(&feedbits(&["targets"]).stdout);
    for target in
        ["cortex-m0plus", "cortex-m4f", "cortex-m7", "c28x-tmu", "c674x", "dsp48", "ice40up", "ecp5"]
    {
        assert!(listed.contains(target), "{target} in\n{listed}");
    }
    let one = json(&["targets", "c28x-tmu"]);
    for row in one["operation"].as_array().expect("rows") {
        assert!(row["source"].as_str().is_some_and(|source| source.len() > 10), "{row}");
    }
    let check = json(&["targets", "--check"]);
    assert!(
        check.as_array().expect("rows").iter().all(|row| (row["ratio"].as_f64().unwrap() - 1.0).abs() < 0.18)
    );
    let unknown = feedbits(&["targets", "z80"]);
    assert_eq!(unknown.status.code(), Some(2));
    assert!(unfolded(&unknown.stderr).contains("cortex-m3"), "{}", unfolded(&unknown.stderr));
}

/// A format was once said to be the cheapest on the target that comes first in the alphabet, not on the first one
/// named.
#[test]
fn the_first_screen_names_the_target_that_was_named_first() {
    for targets in ["cortex-m4f,cortex-m0plus", "cortex-m0plus,cortex-m4f"] {
        let shown = unfolded(&feedbits(&["compare", "--formats", "f32,I4F28", "--targets", targets]).stdout);
        let first = targets.split(',').next().expect("a name");
        let format = if first == "cortex-m4f" { "f32" } else { "I4F28" };
        assert!(
            shown
                .contains(&format!("Recommended: {format}, whose longest period is the shortest on {first}")),
            "{shown}"
        );
    }
}

/// "25 bits are enough" once stood above "none of the formats compared is good enough".
#[test]
fn what_is_precise_enough_and_too_slow_everywhere_is_not_said_to_be_enough() {
    let compared = |clock: &str| {
        let words =
            ["compare", "--formats", "I8F24,I4F28,f32", "--targets", "cortex-m0plus", "--clock", clock];
        unfolded(&feedbits(&words).stdout)
    };
    let (slow, fast) = (compared("0.5"), compared("48"));
    assert!(slow.contains("bits are precise enough: "), "{slow}");
    assert!(slow.contains("of those that are precise enough I4F28 is the fastest, and takes 3."), "{slow}");
    assert!(fast.contains("bits are enough: ") && !fast.contains("fast enough"), "{fast}");
}

/// Fixed point pays where there is no FPU, and f32 where there is one.
#[test]
fn the_recommendation_is_the_cheapest_on_the_first_target() {
    let report =
        json(&["compare", "--formats", "f32,I4F28,f64", "--targets", "cortex-m0plus,cortex-m4f,cortex-m7"]);
    assert_eq!(report["recommended"], "I4F28");
    assert_eq!(report["recommended_on"]["cortex-m0plus"][0], "I4F28");
    assert_eq!(report["recommended_on"]["cortex-m4f"][0], "f32");
    let rows = report["formats"].as_array().expect("rows");
    let row = rows.iter().find(|r| r["format"] == "f32" && r["engine"] == "pieces").expect("a row");
    let cost = &row["cycles"]["cortex-m4f"];
    assert_eq!(cost["level"], "scheduled_on_counted_costs");
    let (mean, max) = (cost["mean"].as_f64().unwrap(), cost["max"].as_f64().unwrap());
    assert!(250.0 < mean && mean < max, "{cost}");
    assert!(cost["share_of_period"].as_f64().is_some_and(|share| share > 0.0 && share < 1.0), "{cost}");
    assert!(row["cycles"]["cortex-m7"]["microseconds_max"].is_null(), "no published timing, no time");
    assert!(row["operations"]["mul_add"].as_f64().is_some_and(|count| count >= 12.0), "{row}");
}

/// The worst step takes 0.12 ms with the typical costs of its operations, and 0.34 ms with the highest.
#[test]
fn a_format_that_may_not_fit_the_period_is_named() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let example = include_str!("../../../../data/seed-000.toml");
    let path = |period: &str| {
        let path = folder.path().join(format!("{period}.toml"));
        let text =
            example.replace("interpolation_period_ms = 3.0", &format!("interpolation_period_ms = {period}"));
        std::fs::write(&path, text).expect("the folder is writable");
        path.display().to_string()
    };
    for (period, is_named) in [("0.2", true), ("3.0", false)] {
        let machine = path(period);
        let arguments =
            ["compare", "--machine", &machine, "--targets", "cortex-m0plus", "--formats", "I4F28"];
        let said = text(&feedbits(&arguments).stdout);
        assert!(said.contains("Cheapest good format on cortex-m0plus: I4F28"), "{said}");
        assert_eq!(said.contains("I4F28 fits by what operations typically take"), is_named, "{said}");
    }
}

const SLOW: &str = r#"
name = "relay"
title = "A computer of relays"
kind = "processor"
[[clock]]
mhz = 0.001
source = "a guess"
"#;

#[test]
fn a_target_of_ones_own_is_read_and_a_format_that_does_not_fit_the_period_fails() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("relay.toml");
    let row = |name: &str| {
        format!(
            "[[operation]]\nname = \"{name}\"\nnumbers = \"f64\"\ncycles = {{ low = 1, typical = 2, high = 3 }}\n\
             source = \"a guess\"\nconfidence = \"low\"\n"
        )
    };
    let rows = ["add", "mul", "compare", "scale", "div", "convert", "sqrt"].map(row).concat();
    fs::write(&path, format!("{SLOW}{rows}")).expect("the folder is writable");
    let file = path.to_str().unwrap();
    let output = feedbits(&["compare", "--formats", "f64", "--evaluate", "pieces", "--target-file", file]);
    assert_eq!(output.status.code(), Some(1), "{}", unfolded(&output.stderr));
    let said = unfolded(&output.stdout);
    assert!(said.contains("times the interpolation period"), "{said}");

    fs::write(&path, format!("{SLOW}{rows}").replace("typical = 2", "typical = 0")).expect("writable");
    let output = feedbits(&["compare", "--formats", "f64", "--target-file", file]);
    assert_eq!(output.status.code(), Some(2));
    let message = unfolded(&output.stderr);
    assert!(
        message.contains("relay.toml")
            && message.contains("operation 1: cycles")
            && message.contains("typical = 0")
    );
    let output = feedbits(&["compare", "--targets", "relay"]);
    assert!(unfolded(&output.stderr).contains("unknown target \"relay\""), "{}", unfolded(&output.stderr));
}

/// The narrowest format costs what `compare` says of it, and registers as much as a format of the widest one.
#[test]
fn test_a_search_is_priced_as_a_comparison_is() {
    let targets = ["--targets", "cortex-m4f,dsp48"];
    let sized = json(&[&["size"], &targets[..]].concat());
    let format = sized["uniform"]["format"].as_str().expect("a format");
    // A search has the solver stop at a quarter of the fluctuation that is allowed.
    let tolerance = ["--evaluate", "pieces", "--solver-tolerance", "0.25e-6", "--formats", format];
    let compared = json(&[&["compare"], &tolerance[..], &targets[..]].concat());
    for target in ["cortex-m4f", "dsp48"] {
        let of = |cycles: &Value| cycles[target]["max"].as_f64().expect("a cost");
        let uniform = of(&sized["uniform"]["cycles"]);
        assert_eq!(uniform, of(&compared["formats"][0]["cycles"]), "{target}");
        // Which way the worst period takes depends on the last bits too.
        let mixed = of(&sized["mixed"]["cycles"]);
        assert!((mixed / uniform - 1.0).abs() < 0.02, "{target}: {mixed} for {uniform}");
    }
    assert!(sized["mixed"]["cycles"]["dsp48"]["dsp_blocks"].as_u64() >= Some(1));
    let shown = text(&feedbits(&[&["size"], &targets[..]].concat()).stdout);
    assert!(
        shown.contains("registers   I3F22") && shown.lines().all(|line| line.chars().count() <= 80),
        "{shown}"
    );
}
