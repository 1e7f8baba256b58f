//! `feedbits compare --report`, as a folder on the disk.

use std::fs;

use crate::command::{feedbits_in, names};
use crate::message::{text, unfolded};

/// The command prints the same with a report and without.
#[test]
fn a_report_is_a_folder_and_changes_nothing_that_is_printed() {
    let folder = tempfile::tempdir().expect("a folder");
    let arguments = ["compare", "--formats", "I16F16,I8F24,I4F28,f32,f64"];
    let plain = feedbits_in(folder.path(), &arguments);
    let with = feedbits_in(folder.path(), &[&arguments[..], &["--report", "a/b"]].concat());
    assert_eq!(with.status.code(), Some(0), "{}", unfolded(&with.stderr));
    assert_eq!(text(&plain.stdout), text(&with.stdout));
    assert!(unfolded(&with.stderr).contains("report in a/b/index.html"), "{}", unfolded(&with.stderr));
    let names = names(&folder.path().join("a/b"));
    for name in [
        "index.html",
        "formats.csv",
        "formats.json",
        "margins.csv",
        "fluctuation.svg",
        "feed.svg",
        "acceleration.svg",
        "jerk.svg",
        "feed-limit.svg",
        "chord-error.svg",
        "solvers.svg",
        "evaluations.svg",
        "bits.svg",
        "path-I8F24_pieces.svg",
        "ranges-I8F24_pieces.svg",
        "schedule-dsp48.svg",
    ] {
        assert!(names.iter().any(|found| found == name), "{name} in {names:?}");
    }
    let size: u64 = names
        .iter()
        .map(|name| fs::metadata(folder.path().join("a/b").join(name)).expect("a file").len())
        .sum();
    assert!(size < 3_000_000, "the whole folder: {size}");
    let quiet = feedbits_in(folder.path(), &[&arguments[..], &["--report", "a/b", "--quiet"]].concat());
    assert_eq!((unfolded(&quiet.stderr), quiet.status.code()), (String::new(), Some(0)));
}

/// A report on a priced comparison shows the targets.
#[test]
fn a_priced_report_has_costs() {
    let folder = tempfile::tempdir().expect("a folder");
    let arguments =
        ["compare", "--formats", "I4F28", "--evaluate", "pieces", "--targets", "cortex-m3", "--report", "r"];
    let run = feedbits_in(folder.path(), &arguments);
    assert_eq!(run.status.code(), Some(0), "{}", unfolded(&run.stderr));
    let names = names(&folder.path().join("r"));
    for name in ["costs.csv", "costs.json", "cycles-cortex-m3.svg", "schedule-cortex-m3.svg"] {
        assert!(names.iter().any(|found| found == name), "{name} in {names:?}");
    }
}

/// A report replaces an older one. Files that only the older one listed are removed, and so are those that interrupted
/// runs left. Files of others stay, and so do files that are still being written.
#[test]
fn a_report_replaces_the_one_before() {
    let folder = tempfile::tempdir().expect("a folder");
    let report = folder.path().join("r");
    let run = |formats: &str| {
        let run = feedbits_in(
            folder.path(),
            &["compare", "--formats", formats, "--evaluate", "pieces", "--report", "r"],
        );
        assert_eq!(run.status.code(), Some(0), "{}", unfolded(&run.stderr));
    };
    fs::create_dir(&report).expect("a folder");
    for name in [".feedbits-aB3dE6.part", ".feedbits-notes.part", ".tmpaB3dE6", "path-mine.svg"] {
        fs::write(report.join(name), "").expect("a file");
    }
    let at_work = fs::File::create(report.join(".feedbits-aB3dE7.part")).expect("a file");
    at_work.lock().expect("a lock");
    run("I4F28,f64");
    let first = names(&report);
    assert!(first.contains(&"path-f64_pieces.svg".to_string()), "{first:?}");
    run("I4F28");
    let mut expected: Vec<String> = first.into_iter().filter(|name| !name.contains("f64")).collect();
    expected.sort();
    assert_eq!(names(&report), expected);
    for kept in [".feedbits-aB3dE7.part", ".feedbits-notes.part", ".tmpaB3dE6", "path-mine.svg"] {
        assert!(expected.iter().any(|name| name == kept), "{kept} in {expected:?}");
    }
    assert!(!report.join(".feedbits-aB3dE6.part").exists());

    // The page of another program lists no file of a report.
    fs::write(report.join("index.html"), "<a href=\"path-mine.svg\" download>").expect("a file");
    run("I4F28");
    assert_eq!(names(&report), expected);
}

#[test]
fn a_folder_that_cannot_be_made_is_an_error() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("file"), "kept").expect("a file");
    let run = feedbits_in(folder.path(), &["compare", "--formats", "f64", "--report", "file"]);
    assert_eq!(run.status.code(), Some(2));
    assert!(unfolded(&run.stderr).contains("cannot make the folder file"), "{}", unfolded(&run.stderr));
    assert_eq!(fs::read_to_string(folder.path().join("file")).expect("a file"), "kept");
}

/// Without a command the built-in example is compared, and the report is written into a folder with a fixed name.
#[test]
fn the_default_run_leaves_a_report() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = feedbits_in(folder.path(), &[]);
    assert_eq!(run.status.code(), Some(0), "{}", unfolded(&run.stderr));
    assert_eq!(
        text(&run.stderr).lines().collect::<Vec<_>>(),
        [
            "feedbits: comparing formats on the built-in example, which takes a few seconds",
            "feedbits: report in feedbits-report/index.html"
        ]
    );
    assert!(folder.path().join("feedbits-report/index.html").exists());

    // If no folder can be made, the answer is still printed.
    let taken = tempfile::tempdir().expect("a folder");
    fs::write(taken.path().join("feedbits-report"), "kept").expect("a file");
    let without = feedbits_in(taken.path(), &[]);
    assert_eq!((without.status.code(), text(&without.stdout)), (Some(0), text(&run.stdout)));
    assert!(
        unfolded(&without.stderr).contains("no report: cannot make the folder"),
        "{}",
        unfolded(&without.stderr)
    );
}
