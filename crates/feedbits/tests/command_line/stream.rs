//! `compile --stream`: a part as a file of sections. That a reader makes the judged run of it is tested where it is written.

use std::fs;
use std::path::Path;
use std::process::Command;

use crate::command::{PROGRAM, feedbits_in, names};
use crate::message::unfolded;

/// Two sections: the second begins behind a rapid move.
const PART: &str = "G0 X0 Y0\nG1 X10 F3000\nG3 X10 Y20 R10\nG0 X0\nG1 Y30\n";

fn compile(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let part = ["compile", "part.nc", "--machine", "router"];
    let output = feedbits_in(folder, &[&part[..], arguments].concat());
    assert!(output.stdout.is_empty());
    (output.status.code(), unfolded(&output.stderr))
}

/// The number before some words.
fn number_before(said: &str, words: &str) -> u64 {
    let (before, _) = said.split_once(words).unwrap_or_else(|| panic!("{words:?} is missing in {said}"));
    before.rsplit(' ').next().and_then(|digits| digits.parse().ok()).expect("a number")
}

#[test]
fn a_part_becomes_a_file_of_sections_with_the_checksum_of_the_constants() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("part.nc"), PART).expect("a file");
    for format in ["I4F28", "f32", "f64", "I16F48"] {
        let (status, said) =
            compile(folder.path(), &["--format", format, "--stream", "--out", "part.stream"]);
        assert_eq!(status, Some(0), "{said}");
        assert!(said.contains("periods in 2 sections"), "{said}");
        let file = fs::read(folder.path().join("part.stream")).expect("a file");
        assert_eq!(file.len() as u64, number_before(&said, " bytes;"));
        assert!(file.starts_with(b"feedbits") && file[16..24].starts_with(format.as_bytes()));
        let largest = u32::from_le_bytes(*file[124..].first_chunk().expect("four bytes"));
        assert_eq!(u64::from(largest), number_before(&said, " bytes and room"));
        let (_, constants) = compile(folder.path(), &["--format", format, "--out", "part.rs"]);
        let checksum = said.split("checksum ").nth(1).expect("a checksum");
        assert!(constants.ends_with(checksum), "{constants} and {said}");
    }
    assert_eq!(names(folder.path()), ["part.nc", "part.rs", "part.stream"]);
}

#[test]
fn what_is_refused_changes_no_file() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("part.nc"), PART).expect("a file");
    fs::write(folder.path().join("part.stream"), "old").expect("a file");
    let stream = ["--stream", "--out", "part.stream"];
    let (status, said) =
        compile(folder.path(), &[&["--format", "I4F28", "--buffer", "100"], &stream[..]].concat());
    assert_eq!(status, Some(2), "{said}");
    assert!(
        said.contains("part.nc:2: section 0, up to line 3, takes ") && said.ends_with("the buffer has 100"),
        "{said}"
    );
    let needed = number_before(&said, " bytes, and").to_string();
    for (arguments, expected) in [
        (vec!["--format", "I5F13"], "I5F13 is no type of a controller"),
        (vec!["--format", "f32", "--language", "c"], "cannot be used with"),
        (vec!["--format", "f32", "--flash", "9"], "cannot be used with"),
        (vec!["--format", "f32", "--evaluate", "de-boor"], "a controller runs compiled pieces"),
    ] {
        let (status, said) = compile(folder.path(), &[&arguments[..], &stream].concat());
        assert!(status == Some(2) && said.contains(expected), "{said}");
    }
    for (arguments, expected) in [
        (vec!["--format", "f32", "--stream"], "--out <PATH>"),
        (vec!["--format", "f32", "--buffer", "99", "--out", "a"], "--stream"),
        (vec!["--format", "f32", "--stream", "--out", "no/part"], "cannot write no/part"),
    ] {
        let (status, said) = compile(folder.path(), &arguments);
        assert!(status == Some(2) && said.contains(expected), "{said}");
    }
    assert_eq!(fs::read(folder.path().join("part.stream")).expect("a file"), b"old");
    assert_eq!(names(folder.path()), ["part.nc", "part.stream"]);
    let (status, said) =
        compile(folder.path(), &[&["--format", "I4F28", "--buffer", &needed], &stream[..]].concat());
    assert_eq!(status, Some(0), "{said}");
}

#[test]
fn a_stream_for_overrides_says_so_in_its_header() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("part.nc"), PART).expect("a file");
    let stream = ["--format", "I8F24", "--stream", "--out", "part.stream"];
    let commanded = |arguments: &[&str]| {
        let (status, said) = compile(folder.path(), &[arguments, &stream].concat());
        assert_eq!(status, Some(0), "{said}");
        let file = fs::read(folder.path().join("part.stream")).expect("a file");
        u64::from_le_bytes(*file[112..].first_chunk().expect("eight bytes"))
    };
    assert_eq!(commanded(&["--feed-override", "125"]), (1_u64 << 32) * 4 / 5);
    assert_eq!(commanded(&[]), 0);
}

/// A write past so many blocks of 512 bytes fails, as on a full disk.
#[test]
#[cfg(unix)]
fn a_write_that_fails_half_way_leaves_the_old_file() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("part.stream"), "old").expect("a file");
    let script =
        format!("trap '' XFSZ; ulimit -f 4; exec {PROGRAM} compile --format f64 --stream --out part.stream");
    let output =
        Command::new("sh").args(["-c", &script]).current_dir(folder.path()).output().expect("a shell");
    let said = unfolded(&output.stderr);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(said.contains("cannot write part.stream") && said.contains("File too large"), "{said}");
    assert_eq!(fs::read(folder.path().join("part.stream")).expect("a file"), b"old");
    assert_eq!(names(folder.path()), ["part.stream"]);
}
