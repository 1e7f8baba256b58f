//! Files may be full, locked, huge, binary, or not files at all. No file is written by halves, and each error names the
//! fault and its place.

use std::fs;
use std::os::unix::fs::{FileTypeExt, PermissionsExt, symlink};
use std::path::Path;
use std::process::{Command, Output};

use crate::command::{PROGRAM, feedbits, names};
use crate::message::{text, unfolded};

/// Runs the program in a shell after `setup`; the program replaces the shell.
fn in_shell(setup: &str, arguments: &str, folder: &Path) -> Output {
    let script = format!("{setup}; exec {PROGRAM} {arguments}");
    Command::new("sh").args(["-c", &script]).current_dir(folder).output().expect("a shell")
}

fn said(output: &Output) -> String {
    unfolded(&output.stderr)
}

fn is_refused(output: &Output, words: &[&str]) {
    let said = said(output);
    assert_eq!(output.status.code(), Some(2), "{said}");
    assert!(output.stdout.is_empty(), "{}", text(&output.stdout));
    for word in words {
        assert!(said.contains(word), "{word:?} is missing in {said}");
    }
    assert!(!said.contains("panicked"), "{said}");
}

#[test]
fn a_full_disk_is_an_error_wherever_it_shows() {
    let folder = tempfile::tempdir().expect("a folder");
    let output = in_shell(":", "formats > /dev/full", folder.path());
    assert_eq!(output.status.code(), Some(2));
    assert!(said(&output).contains("cannot write to the terminal"), "{}", said(&output));
    // `plan` and `interpolate` write row by row.
    for command in ["formats", "plan", "interpolate"] {
        let output = feedbits(&[command, "--out", "/dev/full"]);
        is_refused(&output, &["cannot write /dev/full: No space left"]);
        assert_eq!(said(&output).matches("cannot write").count(), 1, "{command}: {}", said(&output));
    }
}

/// A device is written to, never replaced.
#[test]
fn what_is_no_file_is_not_replaced_by_one() {
    let output = feedbits(&["formats", "--out", "/dev/null"]);
    assert!(output.status.success(), "{}", said(&output));
    assert!(fs::metadata("/dev/null").expect("a device").file_type().is_char_device());

    let folder = tempfile::tempdir().expect("a folder");
    let (file, link) = (folder.path().join("file"), folder.path().join("link"));
    fs::write(&file, "old").expect("a file");
    symlink(&file, &link).expect("a link");
    let output = feedbits(&["formats", "--out", link.to_str().expect("a name")]);
    assert!(output.status.success(), "{}", said(&output));
    assert!(fs::symlink_metadata(&link).expect("a link").file_type().is_symlink());
    assert!(fs::read_to_string(&file).expect("a file").contains("I4F28"));
    assert_eq!(names(folder.path()), ["file", "link"]);
}

#[test]
fn a_folder_that_cannot_be_written_is_named() {
    let folder = tempfile::tempdir().expect("a folder");
    let missing = folder.path().join("missing/s.csv");
    let missing = missing.to_str().expect("a name");
    for command in ["interpolate", "compare", "size", "plan", "servo", "formats"] {
        is_refused(&feedbits(&[command, "--out", missing]), &["cannot write", missing]);
    }
    for command in [["smooth", "--tolerance", "0.01"], ["compile", "--format", "I4F28"]] {
        is_refused(&feedbits(&[&command[..], &["--out", missing]].concat()), &["cannot write", missing]);
    }
    let file = folder.path().join("file");
    fs::write(&file, "").expect("a file");
    let below = file.join("report");
    let below = below.to_str().expect("a name");
    for command in ["compare", "sweep"] {
        let sweep = folder.path().join("sweep.jsonl");
        let output = feedbits(&[command, "--report", below, "--out", sweep.to_str().expect("a name")]);
        is_refused(&output, &[&format!("cannot make the folder {below}")]);
        // The error comes before any work.
        assert!(output.stdout.is_empty() && !sweep.exists(), "{command}");
    }
    // Nobody may make files there, not even root.
    is_refused(&feedbits(&["formats", "--out", "/proc/formats"]), &["cannot write /proc/formats"]);
}

/// A write past so many blocks of 512 bytes fails, as on a full disk. The old file stays whole, and no other file is
/// left.
#[test]
fn a_write_that_fails_half_way_leaves_the_old_file() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("s.csv"), "old").expect("a file");
    let output = in_shell("trap '' XFSZ; ulimit -f 8", "interpolate --out s.csv", folder.path());
    is_refused(&output, &["cannot write s.csv", "File too large"]);
    assert_eq!(fs::read_to_string(folder.path().join("s.csv")).expect("a file"), "old");
    assert_eq!(names(folder.path()), ["s.csv"]);
}

/// The program is killed past so many blocks of 512 bytes: the old file stays whole.
#[test]
fn a_run_that_is_killed_half_way_leaves_the_old_file() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("s.csv"), "old").expect("a file");
    let output = in_shell("ulimit -c 0; ulimit -f 8", "interpolate --out s.csv", folder.path());
    assert_eq!(output.status.code(), None, "killed: {}", said(&output));
    assert_eq!(fs::read_to_string(folder.path().join("s.csv")).expect("a file"), "old");
}

/// A file of 16 GiB that takes no space on the disk, and is larger than the limit of the address space.
#[test]
fn a_huge_file_is_refused_before_memory_is_taken_for_it() {
    let folder = tempfile::tempdir().expect("a folder");
    let huge = fs::File::create(folder.path().join("huge.nc")).expect("a file");
    huge.set_len(16 << 30).expect("room");
    let limit = "ulimit -v 1000000";
    is_refused(&in_shell(limit, "check huge.nc", folder.path()), &["huge.nc is longer than 512 MiB"]);
    is_refused(&in_shell(limit, "check /dev/zero", folder.path()), &["/dev/zero begins with 512 bytes of 0"]);
    let machine = in_shell(limit, "plan --machine huge.nc", folder.path());
    is_refused(&machine, &["huge.nc is longer than 64 MiB"]);
}

#[test]
fn binary_files_are_refused() {
    let folder = tempfile::tempdir().expect("a folder");
    let head = fs::read(PROGRAM).expect("the program").into_iter().take(100_000).collect::<Vec<_>>();
    fs::write(folder.path().join("elf"), head).expect("a file");
    let noise: Vec<u8> =
        (0..100_000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 23).to_le_bytes()[0]).collect();
    fs::write(folder.path().join("noise"), noise).expect("a file");
    fs::write(folder.path().join("zeros"), vec![0; 100_000]).expect("a file");
    fs::write(folder.path().join("empty"), "").expect("a file");
    for name in ["elf", "noise", "zeros", "empty"] {
        for command in ["check", "compare", "plan", "convert --to g1 --tolerance 0.1"] {
            let output = in_shell(":", &format!("{command} {name}"), folder.path());
            is_refused(&output, &[name]);
            assert!(output.stderr.len() < 1 << 20, "{command} {name}: {} bytes", output.stderr.len());
        }
        is_refused(&in_shell(":", &format!("plan --machine {name}"), folder.path()), &[name]);
    }
    is_refused(&in_shell(":", "check .", folder.path()), &["cannot read .", "directory"]);
}

/// If nobody reads the output, it is not written, and the exit status is the same as if somebody did.
#[test]
fn streams_that_are_closed_or_full_change_no_exit_status() {
    let folder = tempfile::tempdir().expect("a folder");
    let machine = include_str!("../../../../data/seed-000.toml");
    let part = "G1 X0 Y0 F6000\nG0 X5\nG1 X10 Q1\n";
    for (name, content) in [("bad.nc", "G1 X\n"), ("p.nc", part), ("m.toml", machine)] {
        fs::write(folder.path().join(name), content).expect("a file");
    }
    for (arguments, status) in [
        ("check bad.nc", 2),
        ("check p.nc --lenient", 1),
        ("convert p.nc --lenient --to g1 --out q.nc", 0),
        ("interpolate p.nc --lenient --machine m.toml --out s.csv", 0),
        ("interpolate --override 0.1:50,1:100 --out s.csv", 0),
        ("compare --formats I16F16", 1),
        ("compare --formats", 2),
        ("--help", 0),
    ] {
        let full = in_shell(":", &format!("{arguments} 2> /dev/full"), folder.path());
        assert_eq!(full.status.code(), Some(status), "{arguments}, full");
        // The reader has ended before the program starts.
        for stream in ["2>&1 >/dev/null", ">&1 2>/dev/null", "2>&1"] {
            let script = format!("(sleep 0.2; {PROGRAM} {arguments} {stream}; echo $? > status) | true");
            let ran = Command::new("sh").args(["-c", &script]).current_dir(folder.path()).status();
            assert!(ran.expect("a shell").success(), "{arguments}");
            let found = fs::read_to_string(folder.path().join("status")).expect("a status");
            assert_eq!(found.trim(), status.to_string(), "{arguments} {stream}");
        }
    }
}

/// A file that existed keeps its mode, and a new one has the mode that the umask leaves.
#[test]
fn modes_are_kept_and_the_umask_obeyed() {
    let folder = tempfile::tempdir().expect("a folder");
    let mode =
        |name: &str| fs::metadata(folder.path().join(name)).expect("a file").permissions().mode() & 0o7777;
    fs::write(folder.path().join("secret"), "old").expect("a file");
    fs::set_permissions(folder.path().join("secret"), fs::Permissions::from_mode(0o600)).expect("a mode");
    for (umask, name, expected) in
        [("022", "secret", 0o600), ("022", "new", 0o644), ("077", "own", 0o600), ("002", "group", 0o664)]
    {
        let output = in_shell(&format!("umask {umask}"), &format!("formats --out {name}"), folder.path());
        assert!(output.status.success(), "{}", said(&output));
        assert_eq!(mode(name), expected, "{name}: {:o}", mode(name));
    }
}

/// A link is followed even if its target does not exist; a link that leads back to itself is an error.
#[test]
fn links_that_lead_nowhere_are_followed() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::create_dir(folder.path().join("there")).expect("a folder");
    symlink("second", folder.path().join("first")).expect("a link");
    symlink("there/file", folder.path().join("second")).expect("a link");
    symlink("round", folder.path().join("round")).expect("a link");
    let output = in_shell(":", "formats --out first", folder.path());
    assert!(output.status.success(), "{}", said(&output));
    assert!(fs::read_to_string(folder.path().join("there/file")).expect("a file").contains("I4F28"));
    for link in ["first", "second"] {
        let found = fs::symlink_metadata(folder.path().join(link)).expect("a link");
        assert!(found.file_type().is_symlink(), "{link}");
    }
    is_refused(&in_shell(":", "formats --out round", folder.path()), &["cannot write round"]);
}

#[test]
fn a_folder_is_refused_in_one_sentence() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::create_dir(folder.path().join("d")).expect("a folder");
    let output = in_shell(":", "formats --out d", folder.path());
    is_refused(&output, &[]);
    assert_eq!(said(&output), "feedbits: cannot write d: it is a folder");
    let output = in_shell(":", "formats --out no/file", folder.path());
    assert_eq!(said(&output), "feedbits: cannot write no/file: No such file or directory (os error 2)");
    assert_eq!(names(folder.path()), ["d"]);
}

/// A part may come through a pipe; its content tells its kind, as that of a file does.
#[test]
fn the_standard_input_is_a_part() {
    let folder = tempfile::tempdir().expect("a folder");
    let part = "G1 X0 Y0 F6000\nG1 X10\nG1 X20 Y5\n";
    fs::write(folder.path().join("p.nc"), part).expect("a file");
    let named = in_shell(":", "check p.nc", folder.path());
    let piped = in_shell("exec < p.nc", "check -", folder.path());
    assert_eq!(piped.status.code(), named.status.code(), "{}", said(&piped));
    let shown = |output: &Output| text(&output.stdout);
    assert_eq!(shown(&piped), shown(&named).replace("p.nc", "standard input"));
    is_refused(
        &in_shell("exec < /dev/zero", "check -", folder.path()),
        &["standard input begins with 512 bytes of 0"],
    );
}
