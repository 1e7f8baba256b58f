//! Whole outputs on a terminal. Digits of measured figures are masked, since they differ in the last place with every rounding of a
//! kernel; screens with little but figures are those of results that are written down, in `src/frozen.rs`.
//! `UPDATE_EXPECT=1 cargo test -p feedbits --test command_line terminal` writes the present outputs.

use expect_test::{ExpectFile, expect_file};

use crate::command::{command, feedbits, feedbits_in};
use crate::message::text;

/// Figures like `2.5e-7` become `#.#e#`, padding included, so that a table stays as wide as it is.
fn masked(text: &str) -> String {
    let mut shown = String::new();
    let mut rest = text;
    while let Some(place) = rest.find('e') {
        let (before, after) = rest.split_at(place);
        let digits = before.len()
            - before.trim_end_matches(|c: char| c.is_ascii_digit() || c == '.' || c == '-').len();
        let exponent =
            after[1..].len() - after[1..].trim_start_matches(|c: char| c.is_ascii_digit() || c == '-').len();
        let is_figure = digits > 0 && exponent > 0;
        if is_figure {
            shown += &before[..before.len() - digits];
            shown += &"#".repeat(digits + 1 + exponent);
            rest = &after[1 + exponent..];
        } else {
            shown += before;
            shown.push('e');
            rest = &after[1..];
        }
    }
    shown + rest
}

/// Numbers with a point, of four digits and more, or of times (108×) become as many `#`, but for those in names, as F4000.
fn without_figures(text: &str) -> String {
    let mut shown = String::new();
    let mut rest = text;
    while let Some(place) = rest.find(|c: char| c.is_ascii_digit()) {
        let (before, from) = rest.split_at(place);
        let after = from.trim_start_matches(|c: char| c.is_ascii_digit() || c == '.');
        let number = from[..from.len() - after.len()].trim_end_matches('.');
        let is_in_a_name = before.ends_with(|c: char| c.is_alphanumeric() || c == '_');
        let is_long = number.contains('.') || number.len() > 3 || from[number.len()..].starts_with('×');
        let is_figure = !is_in_a_name && is_long;
        shown += before;
        shown += &if is_figure { "#".repeat(number.len()) } else { number.to_string() };
        rest = &from[number.len()..];
    }
    shown + rest
}

/// The files that commands find in their folder.
const FILES: [(&str, &str); 7] = [
    ("part.nc", "G21 G90 G17\nG0 X0 Y0\nG1 X20 F3000\nG3 X20 Y10 I0 J5\nG1 X0\nM30\n"),
    ("corners.nc", "G21 G90\nG0 X0 Y0\nG1 X20 F2400\nY10\nX10\nY20\nX0\nY0\nM30\n"),
    ("fine.nc", FINE),
    ("bad.nc", "G21 G90\nG0 X0 Y0\nG1 XX20 F3000\n"),
    ("mill.toml", MACHINE),
    ("typo.toml", ""),
    ("zero.toml", ""),
];

/// A quarter circle of 18 chords between straight moves.
const FINE: &str = "G21 G90\nG0 X10 Y-8\nG1 Y0 F1200\nG1 X9.962 Y0.872\nG1 X9.848 Y1.736\nG1 X9.659 Y2.588\n\
    G1 X9.397 Y3.420\nG1 X9.063 Y4.226\nG1 X8.660 Y5.000\nG1 X8.192 Y5.736\nG1 X7.660 Y6.428\n\
    G1 X7.071 Y7.071\nG1 X6.428 Y7.660\nG1 X5.736 Y8.192\nG1 X5.000 Y8.660\nG1 X4.226 Y9.063\n\
    G1 X3.420 Y9.397\nG1 X2.588 Y9.659\nG1 X1.736 Y9.848\nG1 X0.872 Y9.962\nG1 X0.000 Y10.000\nG1 X-8\n\
    G1 Y0\nM30\n";

const MACHINE: &str = "[machine]\ninterpolation_period_ms = 1\nfeedrate_mm_per_s = 100\nacceleration_mm_per_s2 = 1000\n\
    jerk_mm_per_s3 = 50000\nchord_error_mm = 0.002\nfluctuation_limit = 1e-5\nparameter_tolerance = 1e-8\nmax_iterations = 8\n";

/// What a command prints on both streams, and its exit status.
fn printed(arguments: &[&str]) -> (String, Option<i32>) {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, content) in FILES {
        let spoilt = match name {
            "typo.toml" => MACHINE.replace("acceleration_", "acceleraton_"),
            "zero.toml" => MACHINE.replace("jerk_mm_per_s3 = 50000", "jerk_mm_per_s3 = 0"),
            _ => content.to_string(),
        };
        std::fs::write(folder.path().join(name), spoilt).expect("the folder is writable");
    }
    let output = feedbits_in(folder.path(), arguments);
    (text(&output.stdout) + &text(&output.stderr), output.status.code())
}

fn shows(arguments: &[&str], expected: &ExpectFile) {
    expected.assert_eq(&masked(&printed(arguments).0));
}

/// The same without figures that are not known to be the same with another kernel.
fn shows_words(arguments: &[&str], expected: &ExpectFile) {
    expected.assert_eq(&without_figures(&masked(&printed(arguments).0)));
}

/// README shows the figures.
#[test]
fn no_arguments() {
    shows_words(&[], &expect_file!["terminal/feedbits.txt"]);
}

#[test]
fn a_part_that_is_looked_over() {
    shows(&["check", "part.nc"], &expect_file!["terminal/check.txt"]);
    shows(&["check", "corners.nc", "--machine", "mill.toml"], &expect_file!["terminal/check-corners.txt"]);
}

#[test]
fn moves_that_become_curves() {
    shows(&["convert", "fine.nc", "--fit", "0.012"], &expect_file!["terminal/convert-fit.txt"]);
    shows(&["convert", "corners.nc", "--fit", "0.01"], &expect_file!["terminal/convert-fit-nothing.txt"]);
}

/// Of the papers' figures only those of paper B hang on no kernel; docs/papers.md shows others.
#[test]
fn the_papers_figures() {
    let (text, _) = printed(&["papers"]);
    assert!(text.lines().all(|line| line.chars().count() <= 80), "{text}");
    let paper_b = text.split("\n\n").find(|paper| paper.starts_with("Paper B"));
    expect_file!["terminal/papers.txt"].assert_eq(&masked(paper_b.expect("a table of paper B")));
    shows(&["papers", "--report", "r", "--out", "papers.txt"], &expect_file!["terminal/papers-report.txt"]);
}

/// From stop to stop, plans have the same stages with every planner.
#[test]
fn a_plan() {
    shows_words(&["plan", "part.nc", "--machine", "mill.toml"], &expect_file!["terminal/plan.txt"]);
    shows_words(&["plan", "corners.nc", "--machine", "mill.toml"], &expect_file!["terminal/plan-long.txt"]);
    shows_words(
        &["plan", "corners.nc", "--machine", "mill.toml", "--profile", "all"],
        &expect_file!["terminal/plan-all.txt"],
    );
}

#[test]
fn corners_that_are_smoothed() {
    shows_words(
        &["smooth", "corners.nc", "--machine", "mill.toml", "--tolerance", "0.02", "--outer", "loop"],
        &expect_file!["terminal/smooth.txt"],
    );
}

#[test]
fn a_machine_that_follows() {
    shows_words(
        &["servo", "part.nc", "--machine", "mill.toml", "--formats", "I4F28,I2F30"],
        &expect_file!["terminal/servo.txt"],
    );
}

#[test]
fn the_targets() {
    shows(&["targets"], &expect_file!["terminal/targets.txt"]);
    shows(&["targets", "dsp48"], &expect_file!["terminal/target.txt"]);
}

#[test]
fn the_formats() {
    shows(&["formats"], &expect_file!["terminal/formats.txt"]);
}

#[test]
fn the_machines() {
    shows(&["machine"], &expect_file!["terminal/machines.txt"]);
}

#[test]
fn a_sweep() {
    shows(
        &["sweep", "part.nc", "--machine", "mill.toml", "--feed", "20..50/2", "--formats", "I8F24"],
        &expect_file!["terminal/sweep.txt"],
    );
}

#[test]
fn a_sweep_of_wrong_words() {
    shows(&["sweep", "--period", "4..1"], &expect_file!["terminal/wrong-span.txt"]);
}

/// Ten mistakes that people make.
#[test]
fn errors() {
    let mistakes = [
        "check missing.nc",
        "compare part.nc --machine mill.toml --formats I8F24,decimal",
        "plan part.nc --machine typo.toml",
        "plan --window far",
        "check bad.nc",
        "plan part.nc",
        "plan part.nc --machine zero.toml",
        "targets z80",
        "plan --out nowhere/plan.csv",
        "check part.nc --dialect klingon",
    ];
    let shown = mistakes.map(|command| {
        let (text, status) = printed(&command.split(' ').collect::<Vec<_>>());
        assert_eq!(status, Some(2), "{command}: {text}");
        format!("$ feedbits {command}\n{text}")
    });
    expect_file!["terminal/errors.txt"].assert_eq(&masked(&shown.join("\n")));
}

/// A line of a file is shown unfolded and may be longer.
#[test]
fn no_line_is_longer_than_a_terminal_of_80_columns() {
    let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/command_line/terminal");
    let mut snapshots = 0;
    for entry in std::fs::read_dir(folder).expect("the snapshots") {
        let path = entry.expect("an entry").path();
        let text = std::fs::read_to_string(&path).expect("a snapshot");
        let is_of_a_file = |line: &str| {
            line.trim_start().trim_start_matches(|c: char| c.is_ascii_digit()).starts_with(" | ")
        };
        for line in text.lines().filter(|line| !is_of_a_file(line)) {
            assert!(line.chars().count() <= 80, "{}: {line}", path.display());
        }
        snapshots += 1;
    }
    assert!(snapshots >= 18, "{snapshots}");
}

#[test]
fn figures_are_masked_and_words_are_not() {
    assert_eq!(masked("refused 2.5e-7 │ -1.2e-10 e 3e"), "refused ###### │ ######## e 3e");
    assert_eq!(without_figures("R10 F4000, 12 of 1234 in 0.57 s."), "R10 F4000, 12 of #### in #### s.");
}

#[test]
fn every_shell_gets_its_script() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let script = String::from_utf8(feedbits(&["completions", shell]).stdout).expect("text");
        assert!(script.contains("FEEDBITS_COMPLETE") && script.contains("feedbits"), "{shell}: {script}");
    }
}

/// Only a terminal gets colours or progress, whatever the options say.
#[test]
fn no_colours_where_nobody_looks() {
    for (name, value) in [("NO_COLOR", "1"), ("CLICOLOR", "1")] {
        let output = command(&["--help"]).env(name, value).output();
        let output = output.expect("the program starts");
        assert!(![output.stdout, output.stderr].concat().contains(&0x1b), "{name}");
    }
}
