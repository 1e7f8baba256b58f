//! `feedbits convert`: what is written reads back.

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

fn convert(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_feedbits")).arg("convert").args(arguments).output().expect("starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn data(name: &str) -> String {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../data").join(name).display().to_string()
}

/// Paper D's program to a curve file to a program to a curve file: the two curve files are the same.
#[test]
fn the_round_trip_can_be_typed() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = |name: &str| folder.path().join(name).display().to_string();
    let (one, two, three) = (path("one.toml"), path("two.nc"), path("three.toml"));
    for (from, to, out) in
        [(&data("seed-003.nc"), "toml", &one), (&one, "g06.2", &two), (&two, "toml", &three)]
    {
        let output = convert(&[from, "--to", to, "--out", out]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        assert!(
            text(&output.stderr).contains("1 curves, which read back bit by bit"),
            "{}",
            text(&output.stderr)
        );
        assert!(output.stdout.is_empty());
    }
    let read = |path: &str| fs::read_to_string(path).expect("written");
    assert_eq!(read(&one), read(&three));
    assert!(
        read(&two).starts_with("G21 G90 G94\nG05 P10000\nG0 X0. Y15.\nG06.2 P4 K0. X0. Y15. R1.\n"),
        "{}",
        read(&two)
    );
}

#[test]
fn what_a_dialect_cannot_say_is_said() {
    let output = convert(&[&data("seed-003.nc"), "--to", "g5.2"]);
    assert!(text(&output.stdout).contains("G5.2 P1. L4"), "{}", text(&output.stdout));
    assert!(text(&output.stderr).contains("read back as 7 others"), "{}", text(&output.stderr));
    let output = convert(&[&data("engraving.nc"), "--to", "toml"]);
    assert!(text(&output.stderr).contains("words M, S, T, D or H are left out"), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("read back bit by bit"), "{}", text(&output.stderr));
}

#[test]
fn the_tolerance_of_straight_moves_is_asked_for() {
    let moves = |tolerance: &str| {
        let output = convert(&["--to", "g1", "--tolerance", tolerance]);
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        text(&output.stdout).matches("G1 ").count()
    };
    // Chords grow as the root of the tolerance: a hundredth of it needs ten times as many.
    let (coarse, fine) = (moves("0.1"), moves("0.001"));
    assert!((5..=20).contains(&(fine / coarse)), "{coarse} {fine}");
    for (arguments, said) in [
        (vec!["--to", "g1", "--tolerance", "0"], "--tolerance 0"),
        (vec!["--to", "g1", "--tolerance", "1e-15"], "give a larger one"),
        (vec!["--to", "step"], "possible values: g06.2, g5.2, g1, toml"),
        (vec![], "--to"),
    ] {
        let output = convert(&arguments);
        assert_eq!(output.status.code(), Some(2), "{arguments:?}");
        assert!(text(&output.stderr).contains(said), "{said} in {}", text(&output.stderr));
        assert!(output.stdout.is_empty());
    }
}
