//! What the terminal shows, as a whole. Digits of measured figures are masked: they may differ in the last place between
//! machines. `UPDATE_EXPECT=1 cargo test -p feedbits --test terminal` writes what is shown now.

use std::process::Command;

use expect_test::{ExpectFile, expect_file};

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

fn shows(arguments: &[&str], expected: &ExpectFile) {
    let folder = tempfile::tempdir().expect("a folder");
    let output = Command::new(env!("CARGO_BIN_EXE_feedbits"))
        .args(arguments)
        .current_dir(folder.path())
        .output()
        .expect("the program starts");
    let text =
        String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
    expected.assert_eq(&masked(&text));
}

#[test]
fn a_comparison() {
    shows(
        &["compare", "--formats", "I16F16,I8F24,I4F28", "--report", "r"],
        &expect_file!["terminal/compare.txt"],
    );
}

#[test]
fn nothing_that_is_good_enough() {
    shows(&["compare", "--formats", "I16F16"], &expect_file!["terminal/none.txt"]);
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
fn a_sweep_of_wrong_words() {
    shows(&["sweep", "--period", "4..1"], &expect_file!["terminal/wrong-span.txt"]);
}

#[test]
fn figures_are_masked_and_words_are_not() {
    assert_eq!(masked("refused 2.5e-7 │ -1.2e-10 e 3e"), "refused ###### │ ######## e 3e");
}

#[test]
fn every_shell_gets_its_script() {
    for shell in ["bash", "zsh", "fish", "elvish", "powershell"] {
        let output = Command::new(env!("CARGO_BIN_EXE_feedbits")).args(["completions", shell]).output();
        let script = String::from_utf8(output.expect("the program starts").stdout).expect("text");
        assert!(script.contains("FEEDBITS_COMPLETE") && script.contains("feedbits"), "{shell}: {script}");
    }
}

/// Nothing that is not a terminal gets colours or progress, asked for or not.
#[test]
fn no_colours_where_nobody_looks() {
    for (name, value) in [("NO_COLOR", "1"), ("CLICOLOR", "1")] {
        let output = Command::new(env!("CARGO_BIN_EXE_feedbits")).args(["--help"]).env(name, value).output();
        let output = output.expect("the program starts");
        assert!(![output.stdout, output.stderr].concat().contains(&0x1b), "{name}");
    }
}
