//! Machines that have a name, machine files of few keys, and names of formats, as a person types them.

use std::fs;
use std::path::Path;

use expect_test::{Expect, expect};

use crate::command::{command, data, feedbits_in};
use crate::message::{text, unfolded};

const PRESETS: [&str; 7] = ["router-8bit", "router", "router-linuxcnc", "laser", "printer", "mill", "stage"];

const PART: &str = "G21 G90 G17\nG0 X0 Y0\nG1 X20 F600\nG3 X30 Y10 R10\nG1 Y20\n";

/// A folder with a part in it.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a temporary folder");
    fs::write(folder.path().join("part.nc"), PART).expect("the folder is writable");
    folder
}

/// The JSON of a comparison of the part in f64 on a machine.
fn judged(folder: &Path, machine: &str) -> serde_json::Value {
    let arguments = ["compare", "part.nc", "--machine", machine, "--formats", "f64", "--evaluate", "pieces"];
    let output = feedbits_in(folder, &[&arguments[..], &["--json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{machine}: {}", text(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

fn fails(arguments: &[&str], expected: &Expect) {
    let output = feedbits_in(folder().path(), arguments);
    assert_eq!(output.status.code(), Some(2), "{arguments:?}: {}", text(&output.stdout));
    expected.assert_eq(&text(&output.stderr));
}

#[test]
fn every_preset_judges_a_program() {
    let folder = folder();
    for preset in PRESETS {
        let found = judged(folder.path(), preset);
        assert_eq!(found["formats"][0]["verdict"]["result"], "good", "{preset}: {}", found["formats"][0]);
    }
}

/// `feedbits machine` prints a preset as a file for the same machine, so a user can start from it.
#[test]
fn the_file_of_a_preset_is_the_machine_of_its_name() {
    let folder = folder();
    for preset in PRESETS {
        let file = feedbits_in(folder.path(), &["machine", preset]);
        assert_eq!(file.status.code(), Some(0), "{}", text(&file.stderr));
        let kept = data(&format!("machines/{preset}.toml"));
        assert_eq!(text(&file.stdout), fs::read_to_string(kept).expect("a file"));
        fs::write(folder.path().join("m.toml"), &file.stdout).expect("the folder is writable");
        assert_eq!(judged(folder.path(), "m.toml")["machine"], judged(folder.path(), preset)["machine"]);
    }
    let listed = feedbits_in(folder.path(), &["machine", "--json"]);
    let listed: serde_json::Value = serde_json::from_slice(&listed.stdout).expect("JSON");
    let names: Vec<_> =
        listed.as_array().expect("a list").iter().map(|one| one["name"].as_str().expect("a name")).collect();
    assert_eq!(names, PRESETS);
    for one in listed.as_array().expect("a list") {
        assert!(!one["sources"].as_array().expect("a list").is_empty(), "{one}");
        assert!(one["machine"]["feedrate_mm_per_s"].as_f64() > Some(0.0), "{one}");
    }
}

/// A command means the same in every folder: a file does not replace a preset of the same name.
#[test]
fn a_file_that_is_named_as_a_preset_is_given_with_its_folder() {
    let folder = folder();
    let slow = "[machine]\nfeedrate_mm_per_s = 5\nacceleration_mm_per_s2 = 100\njerk_mm_per_s3 = 1000\n\
                interpolation_period_ms = 2\n";
    fs::write(folder.path().join("router"), slow).expect("the folder is writable");
    fs::write(folder.path().join("mine"), slow).expect("the folder is writable");
    let period =
        |machine: &str| judged(folder.path(), machine)["machine"]["interpolation_period_ms"].as_f64();
    assert_eq!(period("router"), Some(1.0));
    assert_eq!((period("./router"), period("mine")), (Some(2.0), Some(2.0)));
    let plan = feedbits_in(folder.path(), &["plan", "part.nc", "--machine", "router"]);
    let said = text(&plan.stderr);
    assert!(
        unfolded(said.as_bytes())
            .contains("--machine router is the preset; the file here is --machine ./router"),
        "{said}"
    );
}

/// The least machine file has four lines: it has no value that a user must look up.
#[test]
fn a_file_of_four_keys_judges_a_program() {
    let folder = folder();
    let four = "[machine]\nfeedrate_mm_per_s = 50\nacceleration_mm_per_s2 = 1000\njerk_mm_per_s3 = 40000\n\
                interpolation_period_ms = 1\n";
    fs::write(folder.path().join("m.toml"), four).expect("the folder is writable");
    let found = judged(folder.path(), "m.toml");
    assert_eq!(found["formats"][0]["verdict"]["result"], "good", "{found}");
    let defaults = ["chord_error_mm", "fluctuation_limit", "parameter_tolerance", "max_iterations"];
    let defaults = defaults.map(|key| found["machine"][key].as_f64().expect("a number"));
    assert_eq!(defaults, [1e-3, 1e-4, 1e-10, 8.0]);
    // The textbook's solver uses the last two values to stop.
    let curve = data("seed-003.nc");
    let arguments = ["compare", &curve, "--machine", "m.toml", "--formats", "f64", "--evaluate", "de-boor"];
    let raw = feedbits_in(folder.path(), &arguments);
    assert_eq!(raw.status.code(), Some(0), "{}{}", text(&raw.stdout), text(&raw.stderr));
}

#[test]
fn a_machine_that_is_none_is_told_with_what_was_meant() {
    fails(
        &["compare", "part.nc", "--machine", "ruter"],
        &expect![[r#"
            feedbits: --machine ruter: no such preset and no such file: did you mean
            `router`? presets are router-8bit, router, router-linuxcnc, laser, printer,
            mill, stage; `feedbits machine` says what they are
        "#]],
    );
    fails(
        &["machine", "lathe"],
        &expect![[r#"
            feedbits: unknown preset "lathe": presets are router-8bit, router,
            router-linuxcnc, laser, printer, mill, stage; `feedbits machine` says what they
            are
        "#]],
    );
    fails(
        &["compare", "part.nc"],
        &expect![[r#"
            feedbits: part.nc names no machine: give its limits with --machine FILE.toml, or
            take a preset such as --machine router; `feedbits machine` lists them
        "#]],
    );
    let missing = feedbits_in(folder().path(), &["compare", "part.nc", "--machine", "router.toml"]);
    assert!(text(&missing.stderr).contains("cannot read router.toml"), "{}", text(&missing.stderr));
}

#[test]
fn a_mistyped_key_of_a_machine_is_told_with_what_was_meant() {
    let folder = folder();
    let file = "[machine]\nfeed_rate = 50\nacceleration_mm_per_s2 = 1000\njerk = 40000\ninterpolation_period_ms = 1\n\
                [machine.axes.x]\nvelocity_mm_per_sec = 50\n";
    fs::write(folder.path().join("m.toml"), file).expect("the folder is writable");
    let said = text(&feedbits_in(folder.path(), &["check", "part.nc", "--machine", "m.toml"]).stderr);
    for meant in ["feedrate_mm_per_s", "jerk_mm_per_s3", "velocity_mm_per_s"] {
        assert!(
            unfolded(said.as_bytes()).contains(&format!("did you mean `{meant}`?")),
            "{meant} in\n{said}"
        );
    }
}

#[test]
fn names_in_q_notation_are_read_by_the_register_that_they_fill() {
    let folder = folder();
    let arguments = ["compare", "part.nc", "--machine", "router", "--evaluate", "pieces", "--json"];
    for (name, format, how) in [
        ("Q16.16", "I16F16", "as Arm counts, the sign is within m, and m + n are 32 bits"),
        ("q4.28", "I4F28", "as Arm counts, the sign is within m, and m + n are 32 bits"),
        ("Q7.24", "I8F24", "as TI counts, the sign is beside m, and m + n + 1 are 32 bits"),
        ("Q1.14", "I2F14", "as TI counts, the sign is beside m, and m + n + 1 are 16 bits"),
        ("Q8.24-floor", "I8F24-floor", "as Arm counts, the sign is within m, and m + n are 32 bits"),
    ] {
        let output = feedbits_in(folder.path(), &[&arguments[..], &["--formats", name]].concat());
        let said = text(&output.stderr);
        assert!(
            unfolded(said.as_bytes()).contains(&format!("feedbits: {name} is read as {format}: {how}")),
            "{said}"
        );
        let found: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        assert_eq!(found["formats"][0]["format"], format, "{name}");
    }
    let twice = feedbits_in(folder.path(), &[&arguments[..], &["--formats", "Q8.24,I8F24,q7.24"]].concat());
    let twice: serde_json::Value = serde_json::from_slice(&twice.stdout).expect("JSON");
    assert_eq!(twice["formats"].as_array().map(Vec::len), Some(1), "a format is run once");
    let one = feedbits_in(folder.path(), &["interpolate", "--format", "Q8.24"]);
    assert_eq!(one.stdout, feedbits_in(folder.path(), &["interpolate", "--format", "I8F24"]).stdout);
    let planned = feedbits_in(folder.path(), &["plan", "--plan-in", "q32.32", "--json"]);
    assert_eq!(planned.status.code(), Some(0), "{}", text(&planned.stderr));
    let quiet = feedbits_in(folder.path(), &["formats", "--quiet"]);
    assert!(text(&quiet.stdout).contains("Q7.24       I8F24   as TI counts"), "{}", text(&quiet.stdout));
}

#[test]
fn a_format_that_is_none_is_told_with_what_was_meant() {
    for (name, expected) in [
        (
            "Q31",
            expect![[r#"
                feedbits: format "Q31" is I1F31, which does not hold the number 1: expected at
                least 2 bits before the point, as in I2F30
            "#]],
        ),
        (
            "q15",
            expect![[r#"
                feedbits: format "q15" is I1F15, which does not hold the number 1: expected at
                least 2 bits before the point, as in I2F14
            "#]],
        ),
        (
            "Q5.13",
            expect![[r#"
                feedbits: unknown format "Q5.13": neither m + n, as Arm counts, nor m + n + 1,
                as TI does, is a register of 8, 16, 32 or 64 bits: expected I5F13 if the sign is
                within m, or I6F13 if it is not
            "#]],
        ),
        (
            "Q24",
            expect![[r#"
                feedbits: unknown format "Q24": a sign and 24 bits behind the point are no
                register of 8, 16, 32 or 64 bits: expected the bits before the point too, as in
                I8F24
            "#]],
        ),
        (
            "l8F24",
            expect![[r#"
                feedbits: unknown format "l8F24": did you mean `I8F24`?
            "#]],
        ),
        (
            "fixed",
            expect![[r#"
                feedbits: unknown format "fixed": expected one that `feedbits formats` lists, or
                a fixed-point format such as I5F13: 3 to 64 bits in all, at least 2 of them
                before the point; behind it -even, -floor or -zero, and then -sat; or one in Q
                notation that fills a register, as Q8.24 (Arm) or Q7.24 (TI) for I8F24
            "#]],
        ),
    ] {
        fails(&["compare", "--formats", name], &expected);
    }
    fails(
        &["compare", "--plan-in", "f46"],
        &expect![[r#"
            feedbits: --plan-in f46, where `same` is each format its own: unknown format
            "f46": did you mean `f64`?
        "#]],
    );
    fails(
        &["targets", "cortex-m4-f"],
        &expect![[r#"
            feedbits: unknown target "cortex-m4-f": did you mean `cortex-m4f`? expected
            cortex-m0plus, cortex-m3, cortex-m4, cortex-m4f, cortex-m7, riscv32imac, c28x,
            c28x-tmu, c674x, dsp48, ecp5, ice40up
        "#]],
    );
}

/// The words that bash asks for while a line is typed, and the answers.
#[test]
fn a_shell_is_told_the_words_that_it_asks_for() {
    let folder = folder();
    let asked = |words: &[&str]| {
        let output = command(&[])
            .current_dir(folder.path())
            .env("FEEDBITS_COMPLETE", "bash")
            .env("_CLAP_IFS", "\n")
            .env("_CLAP_COMPLETE_INDEX", (words.len() - 1).to_string())
            .arg("--")
            .args(words)
            .output()
            .expect("the program starts");
        text(&output.stdout)
    };
    assert_eq!(asked(&["feedbits", "compare", "part.nc", "--machine", "mi"]), "mill");
    assert_eq!(asked(&["feedbits", "compare", "--machine", "part"]), "part.nc");
    assert_eq!(asked(&["feedbits", "compare", "--formats", "f64,I8"]), "f64,I8F24");
    let script = text(&feedbits_in(folder.path(), &["completions", "bash"]).stdout);
    assert!(script.contains("FEEDBITS_COMPLETE=\"bash\""), "{script}");
}

/// Settings of a control become a machine file that runs a part; every assumption is said, and stands in a comment.
#[test]
fn settings_of_a_control_make_a_machine_file() {
    let folder = folder();
    let settings = "$11=0.010\n$100=80\n$110=5000\n$111=5000\n$112=500\n$120=400\n$121=400\n$122=100\n";
    fs::write(folder.path().join("settings.txt"), settings).expect("the folder is writable");
    let made = feedbits_in(folder.path(), &["machine", "--from", "settings.txt", "--out", "m.toml"]);
    assert_eq!(made.status.code(), Some(0), "{}", text(&made.stderr));
    let file = fs::read_to_string(folder.path().join("m.toml")).expect("a file");
    for key in ["interpolation_period_ms", "jerk_mm_per_s3"] {
        let said = unfolded(&made.stderr);
        assert!(said.contains(&format!("feedbits: {key} = ")) && said.contains(" is assumed: "), "{said}");
        let lines: Vec<&str> = file.lines().collect();
        let at = lines.iter().position(|line| line.starts_with(key)).expect("a line");
        assert!(lines[at - 1].starts_with("# Assumed: "), "{file}");
    }
    assert_eq!(judged(folder.path(), "m.toml")["machine"]["acceleration_mm_per_s2"], 400.0);
    let json = feedbits_in(folder.path(), &["machine", "--from", "settings.txt", "--json"]);
    let json: serde_json::Value = serde_json::from_slice(&json.stdout).expect("JSON");
    assert_eq!(json["junction_deviation_mm"], 0.01);

    fs::write(folder.path().join("settings.txt"), settings.replace("$120=400", "$120=-1")).expect("a file");
    let refused = feedbits_in(folder.path(), &["machine", "--from", "settings.txt"]);
    assert_eq!(refused.status.code(), Some(2));
    let said = unfolded(&refused.stderr);
    assert!(said.contains("settings.txt:6: $120 = -1: acceleration_mm_per_s2 is -1: expected"), "{said}");
    let none = feedbits_in(folder.path(), &["machine", "--from", "part.nc"]);
    assert_eq!(none.status.code(), Some(2));
    assert!(unfolded(&none.stderr).contains("no settings that are known"), "{}", unfolded(&none.stderr));
}
