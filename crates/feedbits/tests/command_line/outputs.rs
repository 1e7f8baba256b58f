//! Files that a call writes: none of them is an input, each is whole, and a call that is refused leaves everything as it
//! was and says why, in one message.
use std::collections::BTreeMap;
use std::fs;
use std::os::unix::fs::symlink;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::time::{Duration, Instant};

const PROGRAM: &str = env!("CARGO_BIN_EXE_feedbits");

/// Bytes of a message, at most.
const MOST_BYTES: usize = 2000;

const MACHINE: &str = "[machine]\ninterpolation_period_ms = 2.0\nfeedrate_mm_per_s = 100.0\n\
    acceleration_mm_per_s2 = 5000.0\njerk_mm_per_s3 = 400000.0\nchord_error_mm = 0.0005\nfluctuation_limit = 1e-6\n";

/// A curve file with its machine.
fn part() -> String {
    "[curve]\ndegree = 2\ncontrol_points_mm = [[0, 0], [10, 0], [10, 10]]\nweights = [1, 0.8, 1]\nknots = [0, 0, 0, 1, 1, 1]\n\n"
        .to_string()
        + MACHINE
}

/// A program with a warning if it is read leniently, a note about its unit and another about its feedrate.
const PROGRAM_WITH_NOTES: &str = "G1 X0 Y0\nG0 X5\nG1 X10 Q1\nG1 X10 Y10\n";

/// A folder with inputs of every kind.
fn inputs() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let read = |name: &str| fs::read_to_string(root.join(name)).expect("data");
    for (name, content) in [
        ("p.toml", part()),
        ("p.h", part()),
        ("p.nc", PROGRAM_WITH_NOTES.to_string()),
        ("m.toml", MACHINE.to_string()),
        ("servo.toml", read("data/servo.toml")),
        ("t.toml", read("crates/target-cost/targets/ecp5.toml")),
    ] {
        fs::write(folder.path().join(name), content).expect("a file");
    }
    fs::create_dir(folder.path().join("sub")).expect("a folder");
    fs::hard_link(folder.path().join("p.toml"), folder.path().join("hard")).expect("a link");
    symlink("p.toml", folder.path().join("link")).expect("a link");
    symlink("../link", folder.path().join("sub/second")).expect("a link");
    folder
}

fn run(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(PROGRAM).args(arguments).current_dir(folder).output().expect("the program starts")
}

/// Runs a script, in which `feedbits` is the program.
pub(crate) fn in_shell(folder: &Path, script: &str) -> Output {
    let programs = Path::new(PROGRAM).parent().expect("a folder").display();
    let path = format!("{programs}:{}", std::env::var("PATH").unwrap_or_default());
    let mut shell = Command::new("sh");
    shell.args(["-c", script]).current_dir(folder).env("PATH", path).output().expect("a shell")
}

fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Every file below a folder, with its content.
fn content(folder: &Path) -> BTreeMap<PathBuf, Vec<u8>> {
    let mut found = BTreeMap::new();
    for entry in fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry")) {
        let path = entry.path();
        if entry.file_type().expect("a kind").is_dir() {
            found.extend(content(&path));
            found.insert(path, Vec::new());
        } else {
            let text = fs::read(&path).unwrap_or_default();
            found.insert(path, text);
        }
    }
    found
}

/// The command ends with status 2 and one message that has these words, prints nothing else, and changes no file.
fn is_refused(folder: &Path, script: &str, words: &[&str]) {
    let before = content(folder);
    let output = in_shell(folder, script);
    let said = said(&output);
    assert_eq!(output.status.code(), Some(2), "{script}: {said}");
    assert!(output.stdout.is_empty(), "{script}: {}", String::from_utf8_lossy(&output.stdout));
    for word in words {
        assert!(said.contains(word), "{script}: {word:?} is missing in {said}");
    }
    // The parser of the command line says what it refuses by itself.
    let is_one = said.starts_with("feedbits: ") && said.matches("feedbits: ").count() == 1;
    assert!(is_one || said.starts_with("error: "), "{script}: {said}");
    assert!(output.stderr.len() <= MOST_BYTES, "{script}: {} bytes", output.stderr.len());
    let after = content(folder);
    assert!(
        before.keys().eq(after.keys()),
        "{script}: {:?} became {:?}",
        before.keys().collect::<Vec<_>>(),
        after.keys().collect::<Vec<_>>()
    );
    for (path, text) in &before {
        assert!(after[path] == *text, "{script} has changed {}", path.display());
    }
}

/// Every command that reads a part and writes a file.
const ON_A_PART: [&str; 11] = [
    "check",
    "convert --to toml",
    "compare --formats f64",
    "plan",
    "plan --json",
    "size",
    "smooth --tolerance 0.01",
    "interpolate",
    "compile --format I4F28",
    "compile --format I4F28 --stream",
    "sweep --formats f64",
];

#[test]
fn a_part_is_never_written_whatever_it_is_called() {
    let folder = inputs();
    let absolute = folder.path().join("p.toml").display().to_string();
    for command in ON_A_PART {
        for name in ["p.toml", "./p.toml", "sub/../p.toml", "link", "hard", "sub/second", &absolute] {
            let words = [&format!("--out {name}"), "the part p.toml", "is the same file"];
            is_refused(folder.path(), &format!("feedbits {command} p.toml --out {name}"), &words);
        }
        // As the standard input it may have any name.
        let words = ["--out hard", "the standard input", "is the same file"];
        is_refused(folder.path(), &format!("feedbits {command} - --out hard < p.toml"), &words);
    }
    for name in ["p.toml", "hard"] {
        let words = ["the part p.toml", "is the same file"];
        is_refused(folder.path(), &format!("feedbits servo p.toml --formats f64 --out {name}"), &words);
        is_refused(folder.path(), &format!("feedbits servo p.toml --formats f64 --plot {name}"), &words);
    }
    let c = "feedbits compile p.h --format I4F28 --language c --out p";
    is_refused(folder.path(), c, &["--out p.h", "the part p.h"]);
}

#[test]
fn no_other_input_is_written_either() {
    let folder = inputs();
    let made = in_shell(
        folder.path(),
        "feedbits compare p.toml --formats f64 --json --out base.json && feedbits size p.toml --json --out size.json && \
         feedbits sweep p.toml --formats f64 --feed 50..100/2 --shard 1/2 --out a.jsonl && \
         feedbits sweep p.toml --formats f64 --feed 50..100/2 --shard 2/2 --out b.jsonl && ln b.jsonl c.jsonl",
    );
    assert!(made.status.success(), "{}", said(&made));
    for (script, option) in [
        ("compare p.nc --lenient --machine m.toml --out ./m.toml", "--machine m.toml"),
        ("plan p.nc --lenient --machine m.toml --out ./m.toml", "--machine m.toml"),
        ("convert p.nc --lenient --machine m.toml --to toml --out ./m.toml", "--machine m.toml"),
        ("check p.nc --lenient --machine m.toml --out ./m.toml", "--machine m.toml"),
        ("servo p.toml --servo servo.toml --out servo.toml", "--servo servo.toml"),
        ("servo p.toml --servo servo.toml --plot servo.toml", "--servo servo.toml"),
        ("servo --paper-table --servo servo.toml --out servo.toml", "--servo servo.toml"),
        ("targets --target-file t.toml --out t.toml", "--target-file t.toml"),
        ("compare p.toml --target-file t.toml --out t.toml", "--target-file t.toml"),
        ("sweep p.toml --target-file t.toml --out t.toml", "--target-file t.toml"),
        ("compare p.toml --formats f64 --baseline base.json --json --out base.json", "--baseline base.json"),
        ("size p.toml --baseline size.json --json --out ./size.json", "--baseline size.json"),
        ("merge a.jsonl b.jsonl --out a.jsonl", "the file a.jsonl"),
        ("merge a.jsonl b.jsonl --out c.jsonl", "the file b.jsonl"),
    ] {
        let words = [option, "is the same file"];
        is_refused(folder.path(), &format!("feedbits {script}"), &words);
    }
}

#[test]
fn two_results_never_go_to_one_file() {
    let folder = inputs();
    for (script, words) in [
        ("servo p.toml --out x.svg --plot ./x.svg", ["--plot ./x.svg", "--out x.svg"]),
        (
            "compare p.toml --formats f64 --report r --out r/index.html",
            ["--report r/index.html", "--out r/index.html"],
        ),
        (
            "compare p.toml --formats f64 --report r --out r/formats.csv",
            ["--report r/formats.csv", "--out r/formats.csv"],
        ),
    ] {
        is_refused(folder.path(), &format!("feedbits {script}"), &[words[0], words[1], "is the same file"]);
    }
    is_refused(
        folder.path(),
        "feedbits compare p.toml --formats f64 --report r --out r",
        &["cannot write r"],
    );
    // What a shell has opened has the same file's name too.
    fs::write(folder.path().join("x"), "old").expect("a file");
    for command in ["plan", "smooth --tolerance 0.01", "sweep --formats f64"] {
        let output = in_shell(folder.path(), &format!("feedbits {command} p.toml --out x >> x"));
        let said = said(&output);
        assert!(output.status.code() == Some(2) && said.contains("the standard output"), "{command}: {said}");
        assert_eq!(fs::read_to_string(folder.path().join("x")).expect("a file"), "old", "{command}");
    }
    let before = content(folder.path());
    let output = in_shell(folder.path(), "feedbits check p.toml >> p.toml");
    assert!(
        said(&output).contains("the standard output is the same file as the part p.toml"),
        "{}",
        said(&output)
    );
    assert!(content(folder.path()) == before);
}

/// Devices and pipes are no files, and an input may be read for two options.
#[test]
fn what_is_no_file_may_have_several_roles() {
    let folder = inputs();
    for script in [
        "feedbits servo p.toml --formats f64 --evaluate pieces --out /dev/null --plot /dev/null",
        "feedbits convert p.toml --machine p.toml --to toml --out new.toml",
        "feedbits check /dev/stdin < p.toml > /dev/null",
        "feedbits check p.toml --out /dev/stdout | cat",
    ] {
        let output = in_shell(folder.path(), script);
        assert_eq!(output.status.code(), Some(0), "{script}: {}", said(&output));
    }
}

/// A folder that was made for a call that is refused is removed again.
#[test]
fn a_call_that_is_refused_leaves_no_folder() {
    let folder = inputs();
    fs::create_dir(folder.path().join("kept")).expect("a folder");
    for script in [
        "compare p.toml --formats decimal --report a/b",
        "compare nothing.toml --report a/b",
        "compare p.toml --report kept --formats decimal",
        "sweep p.toml --formats decimal --report a",
        "interpolate p.toml --vectors a/b --format decimal",
        "interpolate p.toml --vectors a/b --evaluate de-boor",
    ] {
        is_refused(folder.path(), &format!("feedbits {script}"), &[]);
    }
}

/// A name that is no text once ended a report with a panic.
#[test]
#[cfg(target_os = "linux")]
fn a_name_that_is_no_text_is_a_name() {
    use std::os::unix::ffi::OsStrExt;
    let folder = inputs();
    let name = std::ffi::OsStr::from_bytes(b"part-\xff.toml");
    fs::rename(folder.path().join("p.toml"), folder.path().join(name)).expect("a file");
    for command in ON_A_PART.iter().map(|command| format!("{command} --out out")).chain([
        "compare --formats f64 --report r".to_string(),
        "sweep --formats f64 --report r --out s.jsonl".to_string(),
        "interpolate --vectors v".to_string(),
        "servo --formats f64 --evaluate pieces --plot plot.svg".to_string(),
    ]) {
        let mut words = command.split(' ');
        let subcommand = words.next().expect("a command");
        let mut program = Command::new(PROGRAM);
        let program = program.arg(subcommand).arg(name).args(words).current_dir(folder.path());
        let output = program.output().expect("the program starts");
        assert!(matches!(output.status.code(), Some(0 | 1)), "{command}: {}", said(&output));
        let _ = fs::remove_file(folder.path().join("out"));
    }
    for option in ["--out", "--report", "--vectors"] {
        let mut program = Command::new(PROGRAM);
        let program = program.args(["interpolate", option]).arg(name).current_dir(folder.path());
        let output = program.output().expect("the program starts");
        assert_ne!(output.status.code(), Some(101), "{option}: {}", said(&output));
    }
}

/// The names that a report's page lists, and the page.
fn listed(report: &Path) -> (Vec<String>, String) {
    let page = fs::read_to_string(report.join("index.html")).expect("a page");
    let list = page.split("<summary>All files beside this page</summary><p>").nth(1).expect("a list");
    let list = list.split("</p>").next().expect("an end");
    let names =
        list.split("<a href=\"").skip(1).map(|rest| rest.split('"').next().expect("a name").to_string());
    (names.collect(), page)
}

/// A report of one format, and another of two.
const REPORTS: [&str; 2] = [
    "compare p.toml --evaluate pieces --formats f64 --report r",
    "compare p.toml --evaluate pieces --formats f64,I4F28 --report r",
];

/// Writes stop at so many blocks of 512 bytes, as on a full disk: the page is the largest file.
#[test]
fn a_report_that_cannot_be_written_leaves_the_one_before() {
    let folder = inputs();
    let made = in_shell(folder.path(), &format!("feedbits {}", REPORTS[0]));
    assert!(made.status.success(), "{}", said(&made));
    fs::write(folder.path().join("r/notes.txt"), "mine").expect("a file");
    let page = fs::metadata(folder.path().join("r/index.html")).expect("a page").len();
    for blocks in [0, 2, 16, page / 1024] {
        let script = format!("trap '' XFSZ; ulimit -f {blocks}; feedbits {}", REPORTS[1]);
        is_refused(folder.path(), &script, &["cannot write r/", "File too large"]);
    }
    for vectors in ["interpolate p.toml --vectors v", "compile p.toml --format I4F28 --language c --out c"] {
        let made = in_shell(folder.path(), &format!("feedbits {vectors}"));
        assert!(made.status.success(), "{}", said(&made));
        let script = format!("trap '' XFSZ; ulimit -f 2; feedbits {vectors} --piece-length 3");
        is_refused(folder.path(), &script, &["cannot write", "File too large"]);
    }
}

/// A run that is killed while it writes leaves a whole page, with every file that it lists, and the next run clears up.
#[test]
fn a_report_is_killed_at_any_time() {
    let (folder, beside) = (inputs(), inputs());
    let report = folder.path().join("r");
    for script in REPORTS {
        let made = in_shell(beside.path(), &format!("feedbits {script}"));
        assert!(made.status.success(), "{}", said(&made));
        let _ = fs::rename(beside.path().join("r"), beside.path().join(script.len().to_string()));
    }
    let wholes = REPORTS.map(|script| beside.path().join(script.len().to_string()));
    let pages = [listed(&wholes[0]).1, listed(&wholes[1]).1];
    let made = in_shell(folder.path(), &format!("feedbits {}", REPORTS[0]));
    assert!(made.status.success(), "{}", said(&made));
    fs::write(report.join("notes.txt"), "mine").expect("a file");
    for turn in 0..12 {
        let arguments: Vec<&str> = REPORTS[(turn + 1) % 2].split(' ').collect();
        let mut child = Command::new(PROGRAM)
            .args(arguments)
            .current_dir(folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program starts");
        let begun = Instant::now();
        let writes = || {
            let mut names = fs::read_dir(&report).expect("a folder").flatten();
            names.any(|entry| entry.file_name().to_string_lossy().starts_with(".feedbits-"))
        };
        while turn > 0 && !writes() && child.try_wait().expect("a child").is_none() {
            assert!(begun.elapsed() < Duration::from_secs(60), "the program hangs");
            std::thread::sleep(Duration::from_micros(100));
        }
        std::thread::sleep(Duration::from_micros(700) * u32::try_from(turn).expect("a turn"));
        let _ = child.kill();
        child.wait().expect("a child");
        let (names, page) = listed(&report);
        assert!(pages.contains(&page), "turn {turn}: a page of neither report");
        for name in names {
            let text = fs::read(report.join(&name)).expect("a listed file");
            let is_whole =
                wholes.iter().any(|whole| fs::read(whole.join(&name)).is_ok_and(|found| found == text));
            assert!(is_whole, "turn {turn}: {name}");
        }
        assert_eq!(fs::read_to_string(report.join("notes.txt")).expect("a file"), "mine");
    }
    let made = in_shell(folder.path(), &format!("feedbits {}", REPORTS[1]));
    assert!(made.status.success(), "{}", said(&made));
    let (mut names, page) = listed(&report);
    assert!(page == pages[1], "the new page");
    names.extend(["index.html".to_string(), "notes.txt".to_string()]);
    names.sort();
    let mut found: Vec<String> = fs::read_dir(&report)
        .expect("a folder")
        .map(|entry| entry.expect("an entry").file_name().to_string_lossy().into_owned())
        .collect();
    found.sort();
    assert_eq!(found, names);
}

const SWEEP: &str =
    "sweep p.toml --evaluate pieces --formats f64,I4F28 --feed 50..100/3 --period 1..2/2 --out s.jsonl";

/// A sweep's file, line by line.
fn swept(folder: &Path) -> Vec<String> {
    let output = in_shell(folder, &format!("feedbits {SWEEP}"));
    assert_eq!(output.status.code(), Some(0), "{}", said(&output));
    let text = fs::read_to_string(folder.join("s.jsonl")).expect("a file");
    text.lines().map(String::from).collect()
}

#[test]
fn a_changed_digit_of_a_sweep_is_found() {
    let folder = inputs();
    let lines = swept(folder.path());
    let path = folder.path().join("s.jsonl");
    for line in [0, 1, lines.len() - 1] {
        for digit in [0, 1] {
            let mut changed = lines.clone();
            let digits: Vec<usize> =
                lines[line].char_indices().filter_map(|(at, c)| c.is_ascii_digit().then_some(at)).collect();
            // One of the figures, and one of the checksum.
            let at = if digit == 0 { digits[digits.len() / 3] } else { digits[digits.len() - 1] };
            let other = if &lines[line][at..=at] == "7" { "3" } else { "7" };
            changed[line].replace_range(at..=at, other);
            fs::write(&path, changed.join("\n") + "\n").expect("a file");
            let words = ["s.jsonl", &format!("line {}", line + 1), "damaged"];
            is_refused(folder.path(), &format!("feedbits {SWEEP}"), &words);
            is_refused(folder.path(), "feedbits merge s.jsonl --out joined.jsonl", &words);
        }
    }
    // A line that is taken out is run again.
    let mut without = lines.clone();
    without.remove(3);
    fs::write(&path, without.join("\n") + "\n").expect("a file");
    let mut again = swept(folder.path());
    again.sort();
    let mut sorted = lines.clone();
    sorted.sort();
    assert_eq!(again, sorted);
    // So is one that is torn, wherever that is.
    let whole = lines.join("\n") + "\n";
    for cut in [whole.len() - 1, whole.len() - 2, whole.len() - lines[lines.len() - 1].len()] {
        fs::write(&path, &whole[..cut]).expect("a file");
        assert_eq!(swept(folder.path()), lines, "cut at {cut}");
    }
    // A file without checksums, as older versions wrote it.
    let bare = |line: &String| line.split(",\"crc32\"").next().expect("a line").to_string() + "}\n";
    fs::write(&path, lines.iter().map(bare).collect::<String>()).expect("a file");
    is_refused(folder.path(), &format!("feedbits {SWEEP}"), &["s.jsonl, line 1", "checksum"]);
    is_refused(folder.path(), "feedbits merge s.jsonl --out joined.jsonl", &["s.jsonl, line 1", "checksum"]);
}

/// Where the disk is full, a sweep keeps its whole lines and nothing behind them, and the next one goes on from there.
#[test]
fn a_sweep_on_a_full_disk_tears_no_line() {
    let folder = inputs();
    let lines = swept(folder.path());
    let path = folder.path().join("s.jsonl");
    let whole = fs::metadata(&path).expect("a file").len();
    for blocks in 1..whole.div_ceil(512) {
        fs::remove_file(&path).expect("a file");
        let output = in_shell(folder.path(), &format!("trap '' XFSZ; ulimit -f {blocks}; feedbits {SWEEP}"));
        let said = said(&output);
        assert!(output.status.code() == Some(2) && output.stdout.is_empty(), "{blocks} blocks: {said}");
        assert!(said.contains("cannot write a finished cell to s.jsonl: File too large"), "{said}");
        let left = fs::read_to_string(&path).expect("a file");
        assert!(left.is_empty() || left.ends_with("\"}\n"), "{blocks} blocks: {left}");
        let mut again = swept(folder.path());
        again[1..].sort();
        let mut sorted = lines.clone();
        sorted[1..].sort();
        assert_eq!(again, sorted, "{blocks} blocks");
    }
}

/// Notes and warnings about an input are printed once nothing about it is refused any more.
#[test]
fn nothing_is_printed_before_a_refusal() {
    let folder = inputs();
    let base = in_shell(folder.path(), "feedbits compare p.toml --formats f64 --json --out base.json");
    assert!(base.status.success(), "{}", said(&base));
    for (script, word) in [
        ("plan p.nc --lenient --machine m.toml --window 5 --plan-in decimal", "unknown format"),
        ("plan p.nc --lenient --machine m.toml --window -5", "invalid value '-5' for '--window"),
        ("plan p.nc --lenient --machine nothing.toml", "nothing.toml"),
        ("plan p.nc --lenient", "names no machine"),
        ("check p.nc --lenient --machine nothing.toml", "nothing.toml"),
        ("compare p.nc --lenient --machine m.toml --formats Q8.24,decimal", "unknown format"),
        ("compare p.nc --lenient --machine m.toml --baseline base.json", "is of the part"),
        ("compile p.nc --lenient --machine m.toml --format Q8.24 --evaluate de-boor", "--evaluate pieces"),
        (
            "compile p.nc --lenient --machine m.toml --format Q8.24 --feed-override 90 --language c --out c",
            "--feed-override",
        ),
        (
            "interpolate p.nc --lenient --machine m.toml --override 1:50 --evaluate de-boor",
            "--evaluate pieces",
        ),
        ("interpolate p.nc --lenient --machine m.toml --override 1:50 --reserve 200", "reserve"),
        ("size p.nc --lenient --machine m.toml --evaluate de-boor", "--evaluate pieces"),
        ("servo p.nc --lenient --machine m.toml --circle 1e9", "--circle"),
        ("smooth p.nc --lenient --machine m.toml --tolerance 0.01 --out nothing/x", "cannot write nothing/x"),
        ("sweep p.nc --lenient --machine m.toml --formats Q8.24,decimal", "unknown format"),
        ("convert p.nc --lenient --machine nothing.toml --to g1", "nothing.toml"),
    ] {
        is_refused(folder.path(), &format!("feedbits {script}"), &[word]);
    }
    // The same notes are there if nothing is refused.
    let output = in_shell(folder.path(), "feedbits plan p.nc --lenient --machine m.toml --window 5");
    let said = said(&output);
    for word in ["warning: ", "no feedrate is commanded", "left out", "in view"] {
        assert!(output.status.success() && said.contains(word), "{word}: {said}");
    }
}

#[test]
fn what_is_printed_is_printed_whole_or_the_status_is_2() {
    let folder = inputs();
    for script in [
        "feedbits --help",
        "feedbits -h",
        "feedbits --version",
        "feedbits help",
        "feedbits compare --help",
        "feedbits completions bash",
        "FEEDBITS_COMPLETE=bash feedbits",
        "FEEDBITS_COMPLETE=bash _CLAP_COMPLETE_INDEX=1 feedbits -- feedbits comp",
        "feedbits formats",
        "feedbits machine",
        "feedbits targets",
        "feedbits check p.toml",
        "feedbits convert p.toml --to toml",
        "feedbits plan p.toml",
        "feedbits plan p.toml --out plan.csv",
        "feedbits smooth p.toml --tolerance 0.01",
        "feedbits interpolate p.toml",
        "feedbits compare p.toml --formats f64",
        "feedbits compile p.toml --format I4F28",
        "feedbits sweep p.toml --formats f64",
    ] {
        let output = in_shell(folder.path(), &format!("{script} > /dev/full"));
        assert_eq!(output.status.code(), Some(2), "{script}: {}", said(&output));
        assert!(said(&output).contains("No space left"), "{script}: {}", said(&output));
        // The reader has ended before the program starts.
        let gone = format!("{{ sleep 0.1; {script}; echo $? > status; }} 2> messages | true");
        in_shell(folder.path(), &gone);
        let status = fs::read_to_string(folder.path().join("status")).expect("a status");
        let messages = fs::read_to_string(folder.path().join("messages")).expect("messages");
        assert_eq!(status.trim(), "0", "{script}: {messages}");
        assert!(!messages.contains("terminal") && !messages.contains("roken"), "{script}: {messages}");
    }
}

/// However long a name or a number is, the message that has it is short, and has the place and what was expected.
#[test]
fn a_message_is_short_however_long_a_name_is() {
    let folder = inputs();
    let long = "7".repeat(100_000);
    let name = format!("{}.nc", "n".repeat(240));
    let machine =
        |key: &str, value: &str| MACHINE.replace(&format!("{key} = "), &format!("{key} = {value} # "));
    for (name, text) in [
        ("digits.toml", machine("jerk_mm_per_s3", &long)),
        ("key.toml", format!("{MACHINE}k{long} = 1\n")),
        ("text.toml", machine("jerk_mm_per_s3", &format!("\"{long}\""))),
        ("words.toml", machine("jerk_mm_per_s3", &format!("\"{}\"", "7 ".repeat(50_000)))),
        ("digits.nc", format!("G1 X{long}\n")),
        ("word.nc", format!("G1 {}{long}\n", "Q".repeat(1000))),
        (name.as_str(), "G1 X\n".repeat(40)),
        ("base.json", format!("{{\"schema\": 1, \"command\": \"{long}\"}}")),
    ] {
        fs::write(folder.path().join(name), text).expect("a file");
    }
    let noise: Vec<u8> =
        (0..50_000_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 23).to_le_bytes()[0]).collect();
    fs::write(folder.path().join("noise"), noise).expect("a file");
    let path = format!("{}x.nc", format!("{}/", "d".repeat(200)).repeat(15));
    for (script, words) in [
        ("plan p.toml --machine digits.toml".to_string(), vec!["digits.toml:5:18", "jerk_mm_per_s3"]),
        ("plan p.toml --machine key.toml".into(), vec!["key.toml:8:1", "unknown key"]),
        ("plan p.toml --machine text.toml".into(), vec!["text.toml:5:18", "jerk_mm_per_s3"]),
        ("plan p.toml --machine words.toml".into(), vec!["words.toml:5:18", "jerk_mm_per_s3"]),
        ("plan digits.nc --machine m.toml".into(), vec!["digits.nc:1:", "expected"]),
        ("plan word.nc --machine m.toml".into(), vec!["word.nc:1:"]),
        (format!("plan {name} --machine m.toml"), vec!["nnn.nc:1:4", "more", "`X` has no number"]),
        ("plan noise --machine m.toml".into(), vec!["noise:1:"]),
        (format!("plan {path}"), vec!["cannot read ddd", "x.nc: "]),
        (format!("formats --out {path}"), vec!["cannot write ddd", "x.nc: "]),
        (
            "compare p.toml --baseline base.json".into(),
            vec!["base.json", "expected what `feedbits compare --json` prints"],
        ),
        (format!("compare p.toml --formats I{long}"), vec!["unknown format", "expected"]),
        (format!("plan p.toml --window -{long}"), vec!["--window", "expected"]),
        (format!("plan p.toml --window 1e{long}"), vec!["--window", "expected"]),
        (format!("compare p.toml --targets {long}"), vec!["unknown target", "expected", "ice40up"]),
        (format!("machine {long}"), vec!["unknown preset", "presets are"]),
        (format!("plan p.toml --machine {long}"), vec!["--machine", "presets are"]),
        (format!("plan p.toml --window x{long}"), vec!["--window <MM>", "--help"]),
        (format!("plan p.toml --{long}"), vec!["unexpected argument", "--help"]),
        (format!("{long} p.toml"), vec!["unrecognized subcommand", "--help"]),
        (format!("plan p.toml '{}'", "7 ".repeat(50_000)), vec!["unexpected argument", "--help"]),
        (format!("sweep p.toml --period {long}..1"), vec!["--period <LO..HI>", "--help"]),
    ] {
        let shown = &script[..script.len().min(80)];
        let output = in_shell(folder.path(), &format!("feedbits {script}"));
        let said = said(&output);
        assert_eq!(output.status.code(), Some(2), "{shown}: {said}");
        assert!(output.stderr.len() <= MOST_BYTES, "{shown}: {} bytes", output.stderr.len());
        assert!(output.stdout.is_empty() && output.stderr.ends_with(b"\n"), "{shown}: {said}");
        for word in words {
            assert!(said.contains(word), "{shown}: {word:?} is missing in {said}");
        }
    }
    // `check` prints every error, each in a short message.
    let output = in_shell(folder.path(), &format!("feedbits check {name}"));
    let text = String::from_utf8_lossy(&output.stderr).into_owned();
    assert_eq!(text.matches("`X` has no number").count(), 40, "{text}");
    assert!(text.split("\n\n").all(|message| message.len() <= MOST_BYTES), "{text}");
    // Nothing that a name holds acts on the terminal.
    let output = run(folder.path(), &["check", "a\u{1b}[31mb\rc"]);
    assert!(!output.stderr.iter().any(|byte| *byte == 0x1b || *byte == b'\r'), "{}", said(&output));
}
