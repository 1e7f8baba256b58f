//! The book's page on the exit status: each of its lines, as a shell runs it.

use std::fs;
use std::os::unix::fs::symlink;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::thread;
use std::time::Duration;

use crate::command::{PROGRAM, data};

const PAGE: &str = include_str!("../../../../docs/exit-status.md");

/// The cells of a table's line of which the first is a status.
fn lines() -> impl Iterator<Item = (i32, Vec<&'static str>)> {
    PAGE.lines().filter_map(|line| {
        let mut cells = line.strip_prefix("| ")?.strip_suffix(" |")?.split(" | ");
        Some((cells.next()?.parse().ok()?, cells.collect()))
    })
}

/// The status that a shell shows.
fn shown(status: ExitStatus) -> Option<i32> {
    status.code().or_else(|| status.signal().map(|signal| 128 + signal))
}

/// Runs the command in a folder, with no signal ignored, and sends Ctrl-C after a while if that is asked for.
fn run(folder: &Path, words: &[&str], is_interrupted: bool) -> Option<i32> {
    let mut command = Command::new("env");
    command.args(["--default-signal=INT", PROGRAM]).args(words).current_dir(folder);
    let mut child = command.stdout(Stdio::null()).stderr(Stdio::null()).spawn().expect("the program starts");
    if is_interrupted {
        thread::sleep(Duration::from_millis(500));
        let sent = Command::new("kill").args(["-INT", &child.id().to_string()]).status();
        assert!(sent.expect("kill starts").success(), "{words:?} was over before it was interrupted");
    }
    shown(child.wait().expect("an end"))
}

#[test]
fn every_line_of_the_page_ends_as_it_says() {
    let folder = tempfile::tempdir().expect("a folder");
    let folder = folder.path();
    fs::create_dir(folder.join("data")).expect("a folder");
    for name in ["engraving.nc", "seed-000.toml", "seed-003.nc"] {
        symlink(data(name), folder.join("data").join(name)).expect("a link");
    }
    fs::write(folder.join("rapid.nc"), "G21 G0 X0 Y0\nX10 Y5\nX30\n").expect("a file");
    let (mut stated, mut tried) = (Vec::new(), Vec::new());
    for (status, cells) in lines() {
        let Some(line) = cells[0].strip_prefix("`feedbits ") else {
            stated.push(status);
            continue;
        };
        let line = line.strip_suffix('`').expect("the end of the command");
        let words: Vec<&str> = line.split(' ').collect();
        let ended = run(folder, &words, status == 130);
        assert_eq!(ended, Some(status), "feedbits {line}");
        tried.push(status);
    }
    assert_eq!(stated, [0, 1, 2, 3, 4, 130]);
    assert!(stated.iter().all(|status| tried.contains(status)), "{tried:?}");
}

/// What a command of a line asks for is one of the book's statuses, and the help names each.
#[test]
fn the_help_names_every_status() {
    let help = Command::new(PROGRAM).arg("--help").output().expect("the program starts");
    let help = String::from_utf8(help.stdout).expect("text");
    let said = help.split("Exit status: ").nth(1).expect("the statuses");
    for (status, _) in lines() {
        assert!(said.contains(&format!("{status} ")), "{status} in {said}");
    }
}
