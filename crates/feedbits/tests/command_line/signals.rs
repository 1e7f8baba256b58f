//! Signals that end the command while it works.

use std::fs;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::thread;
use std::time::{Duration, Instant};

use crate::command::{PROGRAM, names};

const SIGHUP: i32 = 1;
const SIGINT: i32 = 2;
const SIGTERM: i32 = 15;

/// A folder with moves that are planned at once and run for hours: 2 m at 0.1 mm/s.
fn a_long_run() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("p.nc"), "G21 G90\nG0 X0 Y0\nG1 X1000 F6\nG1 X0\nM2\n").expect("a file");
    folder
}

/// The command at work, with no signal ignored, which a shell has its background do.
fn started(folder: &Path, words: &str) -> Child {
    let mut command = Command::new("env");
    command.args(["--default-signal=INT,TERM,HUP", PROGRAM]).args(words.split(' '));
    command.current_dir(folder).stdout(Stdio::piped()).stderr(Stdio::piped());
    command.spawn().expect("the program starts")
}

fn send(child: &Child, signal: i32) {
    let sent = Command::new("kill").args([format!("-{signal}"), child.id().to_string()]).status();
    assert!(sent.expect("kill starts").success());
}

/// Waits until the folder of a command at work shows something.
fn wait_until(child: &mut Child, folder: &Path, shows: impl Fn(&[String]) -> bool) {
    let begun = Instant::now();
    while !shows(&names(folder)) {
        let is_over = child.try_wait().expect("a state").is_some();
        assert!(!is_over && begun.elapsed() < Duration::from_secs(120), "{child:?}: {:?}", names(folder));
        thread::sleep(Duration::from_millis(5));
    }
}

/// A result that is being written is not left half-written by any signal that a program can see, and what was there before
/// stays.
#[test]
fn a_signal_leaves_nothing_half_written() {
    for signal in [SIGINT, SIGTERM, SIGHUP] {
        for words in
            ["interpolate p.nc --machine mill --out out", "interpolate p.nc --machine mill --json --out out"]
        {
            let folder = a_long_run();
            fs::write(folder.path().join("out"), "old\n").expect("a file");
            let mut child = started(folder.path(), words);
            wait_until(&mut child, folder.path(), |names| {
                names.iter().any(|name| name.starts_with(".feedbits-"))
            });
            send(&child, signal);
            let output = child.wait_with_output().expect("an end");
            assert_eq!(output.status.signal(), Some(signal), "{words}: {output:?}");
            assert_eq!(names(folder.path()), ["out", "p.nc"], "{words}: {signal}");
            assert_eq!(fs::read_to_string(folder.path().join("out")).expect("a file"), "old\n", "{words}");
        }
    }
}

/// A folder that was made for a report goes too.
#[test]
fn a_folder_that_was_made_for_a_report_goes_with_the_run() {
    let folder = a_long_run();
    let mut child = started(folder.path(), "compare p.nc --machine mill --report new/report");
    wait_until(&mut child, folder.path(), |names| names.iter().any(|name| name == "new"));
    send(&child, SIGTERM);
    let output = child.wait_with_output().expect("an end");
    assert_eq!(output.status.signal(), Some(SIGTERM), "{output:?}");
    assert_eq!(names(folder.path()), ["p.nc"]);
}

/// What `nohup` has the program ignore it ignores.
#[test]
fn a_signal_that_is_to_be_ignored_is_ignored() {
    let folder = a_long_run();
    let script =
        r#"trap "" HUP; exec env --default-signal=INT,TERM "$0" interpolate p.nc --machine mill --out out"#;
    let mut shell = Command::new("sh");
    shell.args(["-c", script, PROGRAM]).current_dir(folder.path());
    let mut child = shell.stderr(Stdio::null()).spawn().expect("the program starts");
    wait_until(&mut child, folder.path(), |names| names.iter().any(|name| name.starts_with(".feedbits-")));
    send(&child, SIGHUP);
    thread::sleep(Duration::from_millis(200));
    assert!(child.try_wait().expect("a state").is_none(), "it still runs");
    send(&child, SIGTERM);
    assert_eq!(child.wait().expect("an end").signal(), Some(SIGTERM));
}

/// Ctrl-C ends a comparison within seconds: with what is finished, once runs have begun.
#[test]
fn ctrl_c_ends_a_comparison() {
    let folder = a_long_run();
    for after in [1, 400, 3000] {
        let mut child = started(folder.path(), "compare p.nc --machine mill");
        thread::sleep(Duration::from_millis(after));
        if child.try_wait().expect("a state").is_none() {
            send(&child, SIGINT);
        }
        let output = child.wait_with_output().expect("an end");
        let said = String::from_utf8_lossy(&output.stderr).into_owned();
        match (output.status.signal(), output.status.code()) {
            (Some(SIGINT), None) => assert!(output.stdout.is_empty(), "{output:?}"),
            (None, Some(130)) => assert!(said.contains("interrupted: "), "{said}"),
            // It was done before.
            (None, Some(0 | 1)) => assert!(!said.contains("interrupted"), "{said}"),
            other => panic!("{other:?}: {said}"),
        }
    }
}
