//! `feedbits compile` in each language.

use std::fs;

use crate::command::{data, feedbits};
use crate::message::{text, unfolded};

/// Only what concerns the command: that the files run as Rust does is tested where they are written.
#[test]
fn a_part_is_compiled_to_c() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("part");
    let compile = |arguments: &[&str]| {
        let out = ["compile", "--language", "c", "--out", out.to_str().expect("a name")];
        feedbits(&[&out[..], arguments].concat())
    };
    let files = || {
        let names = fs::read_dir(folder.path()).expect("a folder").flatten().map(|file| file.file_name());
        let mut names: Vec<_> = names.map(|name| name.to_string_lossy().into_owned()).collect();
        names.sort();
        names
    };
    for (arguments, expected) in [
        (vec!["--format", "I5F13"], "I5F13 is no type of C"),
        (vec!["--format", "I4F28", "--flash", "5000"], "the tables take 7016 bytes, and --flash says 5000"),
        (
            vec!["--format", "I4F28", "--feed-override", "90"],
            "'--feed-override <PERCENT>': expected a number of 100 to 200 %",
        ),
        (
            vec!["--format", "I4F28", "--feed-override", "120", "--reserve", "0"],
            "expected a number of 0.1 to 99 %",
        ),
        (vec!["--format", "f32", "--evaluate", "de-boor"], "a controller runs compiled pieces"),
    ] {
        let output = compile(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(unfolded(&output.stderr).contains(expected), "{}", unfolded(&output.stderr));
        assert_eq!(files(), [""; 0], "nothing is written");
    }
    let output = compile(&["--format", "I4F28", "--flash", "7016"]);
    assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
    assert_eq!(files(), ["part.c", "part.h"]);
    let header = fs::read_to_string(out.with_extension("h")).expect("a header");
    let rust = text(&feedbits(&["compile", "--format", "I4F28", "--quiet"]).stdout);
    let checksum = rust.split("CHECKSUM: u64 = ").nth(1).and_then(|rest| rest.get(..18)).expect("a checksum");
    assert!(header.contains(&format!("#define PART_CHECKSUM {checksum}ULL")), "{checksum}");

    let elsewhere = |name: &str| {
        let out = folder.path().join(name);
        feedbits(&["compile", "--format", "f32", "--language", "c", "--out", out.to_str().expect("a name")])
    };
    for (name, expected) in [
        ("part.c", "expected a name without an ending, as `part`"),
        ("2nd", "\"2nd\" cannot begin names in C"),
        ("no/part", "cannot write"),
    ] {
        let output = elsewhere(name);
        assert_eq!(output.status.code(), Some(2), "{name}");
        assert!(unfolded(&output.stderr).contains(expected), "{}", unfolded(&output.stderr));
    }
    let nowhere = feedbits(&["compile", "--format", "f32", "--language", "c"]);
    assert!(unfolded(&nowhere.stderr).contains("give --out PATH"), "{}", unfolded(&nowhere.stderr));
    let rust = feedbits(&["compile", "--format", "f32", "--feed-override", "120"]);
    assert!(unfolded(&rust.stderr).contains("goes with --language c"), "{}", unfolded(&rust.stderr));
}

/// Only what concerns the command: that the core runs as Rust does is tested where it is made.
#[test]
fn a_part_is_compiled_to_a_core() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("step");
    let compile = |arguments: &[&str]| {
        let out = ["compile", "--language", "verilog", "--out", out.to_str().expect("a name")];
        feedbits(&[&out[..], arguments].concat())
    };
    for (arguments, expected) in [
        (vec!["--format", "f32"], "the core has no numbers of f32: expected fixed point of 16 to 32 bits"),
        (vec!["--format", "I8F32"], "the core has no numbers of I8F32"),
        (vec!["--format", "I4F28-floor"], "the core has no numbers of I4F28-floor"),
        (vec!["--format", "I4F28", "--feed-override", "120"], "the core has no feed override and no hold"),
        (vec!["--format", "I4F28", "--flash", "500"], "and --flash says 500: nothing is written"),
    ] {
        let output = compile(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(unfolded(&output.stderr).contains(expected), "{}", unfolded(&output.stderr));
        assert!(!out.exists(), "{arguments:?}: nothing is written");
    }
    let nowhere = feedbits(&["compile", "--format", "I4F28", "--language", "verilog"]);
    assert!(unfolded(&nowhere.stderr).contains("give --out FOLDER"), "{}", unfolded(&nowhere.stderr));
    let output = compile(&["--format", "I4F28"]);
    assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
    let read = |name: &str| fs::read_to_string(out.join(name)).expect("a file");
    assert!(read("core.v").contains("module feedbits_core"));
    assert!(read("testbench.v").contains("localparam PERIODS = 1621;"));
    assert!([read("microcode.hex"), read("part.hex")].iter().all(|image| image.lines().count() > 1000));
    let rust = text(&feedbits(&["compile", "--format", "I4F28", "--quiet"]).stdout);
    let checksum = rust.split("CHECKSUM: u64 = ").nth(1).and_then(|rest| rest.get(..18)).expect("a checksum");
    assert!(unfolded(&output.stderr).contains(checksum), "{checksum}: {}", unfolded(&output.stderr));
    // With a queue the least period is near the mean and not the worst.
    let said = unfolded(&output.stderr);
    let periods = said.split("QUEUE: ").nth(1).expect("the least periods");
    let with = |queue: &str| {
        let found = periods.split(", ").find_map(|one| one.trim().strip_prefix(queue)?.strip_prefix(": "));
        found.and_then(|cycles| cycles.parse::<u32>().ok()).expect("a number of cycles")
    };
    assert!(with("4") <= 320 && with("1") > 2 * with("4"), "{said}");
}

#[test]
fn a_part_is_compiled_for_a_controller() {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("part.rs");
    let compile = |arguments: &[&str]| {
        let out = ["--out", file.to_str().expect("a name")];
        feedbits(&[&["compile"], arguments, &out].concat())
    };
    let output = compile(&["--format", "I4F28"]);
    assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
    // The bound of a period, on the cores that have one for such a part.
    let note = unfolded(&output.stderr);
    for core in ["cortex-m0plus", "cortex-m3"] {
        assert!(note.contains(&format!(" instructions a period on {core}, ")), "{note}");
    }
    assert_eq!(note.matches("(K = 5, J = 1, S = 1)").count(), 2, "{note}");
    let source = fs::read_to_string(&file).expect("a file");
    let setpoints = text(&feedbits(&["interpolate", "--format", "I4F28"]).stdout).lines().count() - 1;
    assert!(source.contains(&format!("pub const PERIODS: usize = {setpoints};")), "{setpoints}");
    assert!(source.starts_with("// built-in example at 200 mm/s, in I4F28: written by `feedbits compile`"));
    assert_eq!(text(&feedbits(&["compile", "--format", "I4F28", "--quiet"]).stdout), source);

    let coarse = compile(&["--format", "I4F12"]);
    assert_eq!(coarse.status.code(), Some(1));
    assert!(!unfolded(&coarse.stderr).contains("at most"), "no bound is known in I4F12");
    assert!(
        unfolded(&coarse.stderr).contains("I4F12 is not good enough: fluctuation"),
        "{}",
        unfolded(&coarse.stderr)
    );
    let before = fs::read_to_string(&file).expect("it is written all the same");
    assert!(before.contains("real::fixed::types::I4F12"));
    assert!(before.contains("// I4F12 is not good enough: fluctuation"), "{}", &before[..400]);

    let odd = folder.path().join("a\u{202e}b\nc.toml");
    fs::copy(data("seed-000.toml"), &odd).expect("a file");
    let named = text(&feedbits(&["compile", odd.to_str().expect("a name"), "--format", "f64"]).stdout);
    assert!(named.lines().next().is_some_and(|line| line.contains("a?b?c.toml at 200 mm/s")), "{named:.200}");

    for (arguments, expected) in [
        (vec!["--format", "I5F13"], "I5F13 is no type of a controller"),
        (vec!["--format", "I1F31"], "unknown format \"I1F31\""),
        (vec!["--format", "i5f27"], "unknown format \"i5f27\": did you mean `I5F27`?"),
        (vec!["--format", "F32"], "unknown format \"F32\": did you mean `f32`?"),
        (vec!["--format", "f32", "--evaluate", "de-boor"], "a controller runs compiled pieces"),
        (vec!["--format", "f32", "--end-feed", "-1"], "'--end-feed <MM_PER_S>': expected 0, or a number of"),
    ] {
        let output = compile(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(unfolded(&output.stderr).contains(expected), "{}", unfolded(&output.stderr));
        assert_eq!(fs::read_to_string(&file).expect("a file"), before, "what was there is kept");
    }
}
