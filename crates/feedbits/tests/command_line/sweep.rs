//! `feedbits sweep` and `feedbits merge`, as a person or a job array uses them.

use std::fs;
use std::path::Path;
use std::process::Output;

use serde_json::Value;

use crate::command::{data, feedbits_in};
use crate::message::{text, unfolded};
use crate::small_part::PART;

const GRID: [&str; 10] = [
    "sweep",
    "p.toml",
    "--period",
    "1..4/3",
    "--feed",
    "50..100/2",
    "--scale",
    "10..100/2",
    "--formats",
    "I16F16,I4F28",
];

fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("p.toml"), PART).expect("a part");
    folder
}

fn sweep(folder: &Path, more: &[&str]) -> Output {
    let output = feedbits_in(folder, &[&GRID[..], more].concat());
    assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
    output
}

/// The lines of a sweep's file without the first, in the order of the cells.
fn cells(path: &Path) -> Vec<String> {
    let mut lines: Vec<String> =
        fs::read_to_string(path).expect("a file").lines().skip(1).map(String::from).collect();
    let number = |line: &str| serde_json::from_str::<Value>(line).expect("JSON")["cell"].as_u64();
    lines.sort_by_key(|line| number(line));
    lines
}

/// A file whose lines were changed, each with the checksum that it has now.
pub(crate) fn sealed(content: &str) -> String {
    let line = |line: &str| {
        let members = line.split(",\"crc32\"").next().expect("a line");
        format!("{members},\"crc32\":\"{:08x}\"}}\n", secant_interp::crc32(members.as_bytes()))
    };
    content.lines().map(line).collect()
}

/// Finished cells are kept, a torn line is run again, and the result is the same as that of a single run.
#[test]
fn an_interrupted_sweep_goes_on_where_it_was() {
    let folder = folder();
    let path = folder.path().join("s.jsonl");
    let whole = sweep(folder.path(), &["--out", "s.jsonl"]);
    assert!(text(&whole.stdout).starts_with("12 of 12 cells in s.jsonl\n"), "{}", text(&whole.stdout));
    let all = cells(&path);
    assert_eq!(all.len(), 12);
    let first: Value = serde_json::from_str(&all[0]).expect("JSON");
    assert_eq!(
        (first["period_ms"].as_f64(), first["results"].as_array().map(Vec::len)),
        (Some(1.0), Some(4))
    );
    assert_eq!(first["results"][3]["good"], true, "I4F28 on pieces: {first}");

    let content = fs::read_to_string(&path).expect("a file");
    let lines: Vec<&str> = content.lines().collect();
    let torn = format!("{}\n{}", lines[..5].join("\n"), &lines[5][..lines[5].len() / 2]);
    fs::write(&path, &torn).expect("a file");
    let resumed = sweep(folder.path(), &["--out", "s.jsonl"]);
    assert!(unfolded(&resumed.stderr).contains("torn"), "{}", unfolded(&resumed.stderr));
    assert_eq!(cells(&path), all);
    let now = fs::read_to_string(&path).expect("a file");
    assert!(now.starts_with(&(lines[..5].join("\n") + "\n")), "finished cells stay where they were");

    // A sweep that is finished runs nothing.
    sweep(folder.path(), &["--out", "s.jsonl"]);
    assert_eq!(fs::read_to_string(&path).expect("a file"), now);
}

#[test]
fn shards_together_are_the_whole() {
    let folder = folder();
    sweep(folder.path(), &["--out", "whole.jsonl"]);
    for shard in ["1/3", "2/3", "3/3"] {
        sweep(folder.path(), &["--shard", shard, "--out", &format!("{}.jsonl", &shard[..1])]);
    }
    let arguments = ["merge", "3.jsonl", "1.jsonl", "2.jsonl", "--out", "joined.jsonl", "--report", "maps"];
    let merged = feedbits_in(folder.path(), &arguments);
    assert_eq!(merged.status.code(), Some(0), "{}", unfolded(&merged.stderr));
    assert_eq!(cells(&folder.path().join("joined.jsonl")), cells(&folder.path().join("whole.jsonl")));
    let page = fs::read_to_string(folder.path().join("maps/index.html")).expect("a page");
    assert!(page.contains("heat-I4F28_pieces-1.svg") && !page.contains("are missing"));

    // A joined file is a sweep's file in which no cell is missing.
    let resumed = sweep(folder.path(), &["--out", "joined.jsonl"]);
    assert!(text(&resumed.stdout).starts_with("12 of 12"), "{}", text(&resumed.stdout));
}

#[test]
fn what_does_not_belong_together_is_refused() {
    let folder = folder();
    sweep(folder.path(), &["--shard", "1/6", "--out", "a.jsonl"]);
    let other = feedbits_in(
        folder.path(),
        &[&GRID[..8], &["--formats", "f64", "--shard", "1/6", "--out", "a.jsonl"]].concat(),
    );
    assert_eq!(other.status.code(), Some(2));
    assert!(unfolded(&other.stderr).contains("of another sweep"), "{}", unfolded(&other.stderr));

    let content = fs::read_to_string(folder.path().join("a.jsonl")).expect("a file");
    let changed = sealed(&content.replacen("\"good\":true", "\"good\":false", 1));
    fs::write(folder.path().join("b.jsonl"), changed).expect("a file");
    let merged = feedbits_in(folder.path(), &["merge", "a.jsonl", "b.jsonl", "--out", "c.jsonl"]);
    assert_eq!(merged.status.code(), Some(2));
    assert!(
        unfolded(&merged.stderr).contains("contradict each other on cell"),
        "{}",
        unfolded(&merged.stderr)
    );
    assert!(!folder.path().join("c.jsonl").exists());

    let moved = sealed(&content.replacen("\"cell\":0", "\"cell\":1", 1));
    fs::write(folder.path().join("d.jsonl"), moved).expect("a file");
    let moved = feedbits_in(folder.path(), &["merge", "d.jsonl", "--out", "c.jsonl"]);
    assert!(
        unfolded(&moved.stderr).contains("d.jsonl, line 2: cell 1 does not belong"),
        "{}",
        unfolded(&moved.stderr)
    );
}

/// With a target a cell has the cost of each run, and the cheapest good one is named.
#[test]
fn test_a_sweep_is_priced_on_targets() {
    let folder = folder();
    let output = sweep(folder.path(), &["--targets", "cortex-m4f,ecp5", "--out", "priced.jsonl"]);
    let said = text(&output.stdout);
    assert!(said.contains("cheapest on cortex-m4f: I4F28 pieces in 12"), "{said}");
    for line in cells(&folder.path().join("priced.jsonl")) {
        let cell: Value = serde_json::from_str(&line).expect("JSON");
        assert_eq!(cell["cheapest"]["ecp5"], "I4F28 pieces", "{cell}");
        for run in cell["results"].as_array().expect("results").iter().filter(|run| run["good"] == true) {
            let (on_arm, on_fpga) = (&run["cycles"]["cortex-m4f"], &run["cycles"]["ecp5"]);
            let (max, micros) =
                (on_arm["max"].as_f64().unwrap(), on_arm["microseconds_max"].as_f64().unwrap());
            assert!(
                (max / micros - 168.0).abs() < 1e-9 && on_fpga["dsp_blocks"].as_u64() >= Some(1),
                "{run}"
            );
        }
    }
    // Without a target, or with another, it is another sweep.
    let other = feedbits_in(folder.path(), &[&GRID[..], &["--out", "priced.jsonl"]].concat());
    assert!(unfolded(&other.stderr).contains("of another sweep"), "{}", unfolded(&other.stderr));
}

#[test]
fn test_a_sweep_that_is_not_whole_is_joined_only_if_that_is_asked_for() {
    let folder = folder();
    for shard in ["1/3", "3/3"] {
        sweep(folder.path(), &["--shard", shard, "--out", &format!("{}.jsonl", &shard[..1])]);
    }
    let two = ["merge", "1.jsonl", "3.jsonl", "--out", "joined.jsonl"];
    let refused = feedbits_in(folder.path(), &two);
    let said = unfolded(&refused.stderr);
    assert!(
        refused.status.code() == Some(2) && said.contains("4 of 12 cells are in none of the files"),
        "{said}"
    );
    assert!(!folder.path().join("joined.jsonl").exists());
    let partial = feedbits_in(folder.path(), &[&two[..], &["--partial"]].concat());
    assert!(text(&partial.stdout).starts_with("8 of 12 cells"), "{}", unfolded(&partial.stderr));
}

/// With G61 the same moves stop.
#[test]
fn a_sweep_of_a_part_with_other_stops_is_another() {
    let folder = folder();
    let on = |program: &str| {
        fs::write(folder.path().join("p.nc"), program).expect("the folder is writable");
        let arguments = [
            "sweep",
            "p.nc",
            "--machine",
            &data("seed-000.toml"),
            "--formats",
            "f64",
            "--evaluate",
            "pieces",
        ];
        feedbits_in(folder.path(), &[&arguments[..], &["--dialect", "linuxcnc", "--out", "s.jsonl"]].concat())
    };
    let first = on("G0 X0 Y0\nG1 X10 F600\nG1 X20\n");
    assert_eq!(first.status.code(), Some(0), "{}", unfolded(&first.stderr));
    let stopping = on("G61.1\nG0 X0 Y0\nG1 X10 F600\nG1 X20\n");
    assert_eq!(stopping.status.code(), Some(2), "{}", text(&stopping.stdout));
    assert!(unfolded(&stopping.stderr).contains("of another sweep"), "{}", unfolded(&stopping.stderr));
}

/// A cell that would take too long is said to be left out, not forgotten.
#[test]
fn a_cell_of_too_many_periods_says_so() {
    let folder = folder();
    let run =
        feedbits_in(folder.path(), &[&GRID[..], &["--most-periods", "20", "--out", "s.jsonl"]].concat());
    // None is good in a cell that was run.
    assert_eq!(run.status.code(), Some(1), "{}", unfolded(&run.stderr));
    assert!(text(&run.stdout).contains("cells were not run; the file says why"), "{}", text(&run.stdout));
    let skipped =
        cells(&folder.path().join("s.jsonl")).into_iter().filter(|line| line.contains("more than 20"));
    assert!(skipped.count() > 0);
}

/// A file that is not a sweep's stays byte for byte the same, be it a single line without an end or many lines.
#[test]
fn a_file_that_is_no_sweeps_is_left_as_it_is() {
    let folder = folder();
    let path = folder.path().join("notes.txt");
    let into = ["sweep", "p.toml", "--formats", "f64", "--evaluate", "pieces", "--out", "notes.txt"];
    for content in ["important", "G1 X1 F600\nG1 X2", "{\"part\":1}\n", "\n", "{\"part\":\"other", "\u{e4}"] {
        fs::write(&path, content).expect("a file");
        let refused = feedbits_in(folder.path(), &into);
        assert_eq!(refused.status.code(), Some(2), "{content:?}: {}", unfolded(&refused.stderr));
        assert!(
            unfolded(&refused.stderr).contains("notes.txt"),
            "{content:?}: {}",
            unfolded(&refused.stderr)
        );
        assert_eq!(fs::read_to_string(&path).expect("a file"), content);
    }
    let latin = b"caf\xe9\n";
    fs::write(&path, latin).expect("a file");
    assert_eq!(feedbits_in(folder.path(), &into).status.code(), Some(2));
    assert_eq!(fs::read(&path).expect("a file"), latin);

    // The start of its own first line is what an interrupted sweep leaves.
    fs::write(&path, "").expect("a file");
    assert_eq!(feedbits_in(folder.path(), &into).status.code(), Some(0));
    let whole = fs::read_to_string(&path).expect("a file");
    fs::write(&path, &whole[..20]).expect("a file");
    assert_eq!(feedbits_in(folder.path(), &into).status.code(), Some(0));
    assert_eq!(fs::read_to_string(&path).expect("a file"), whole);

    // A torn line is not cut off another sweep's file either.
    let torn = &whole[..whole.len() - 3];
    fs::write(&path, torn).expect("a file");
    let other = feedbits_in(folder.path(), &[&into[..], &["--feed", "3"]].concat());
    assert_eq!(other.status.code(), Some(2), "{}", unfolded(&other.stderr));
    assert_eq!(fs::read_to_string(&path).expect("a file"), torn);
}

/// A file of twelve cells, each followed by ten MiB of spaces, is longer than a part may be.
#[test]
fn a_large_file_is_merged_and_resumed() {
    let folder = folder();
    sweep(folder.path(), &["--out", "s.jsonl"]);
    let path = folder.path().join("s.jsonl");
    let before = cells(&path);
    let padding = " ".repeat(10 << 20) + "\n";
    let content = fs::read_to_string(&path).expect("a file").replace('\n', &padding);
    assert!(content.len() > 64 << 20, "{}", content.len());
    fs::write(&path, content).expect("a file");
    let merged = feedbits_in(folder.path(), &["merge", "s.jsonl", "--out", "joined.jsonl"]);
    assert_eq!(merged.status.code(), Some(0), "{}", unfolded(&merged.stderr));
    assert_eq!(cells(&folder.path().join("joined.jsonl")), before);
    let resumed = sweep(folder.path(), &["--out", "s.jsonl"]);
    assert!(text(&resumed.stdout).starts_with("12 of 12"), "{}", text(&resumed.stdout));

    // A file without line ends is not read for ever, and a hole not at all.
    let endless = fs::File::create(folder.path().join("zeros")).expect("a file");
    endless.set_len(1 << 34).expect("room");
    fs::write(folder.path().join("long"), vec![b'{'; (64 << 20) + 1]).expect("a file");
    for (name, why) in [("zeros", "begins with a byte of 0"), ("long", "longer than 64 MiB")] {
        let refused = feedbits_in(folder.path(), &["merge", name, "--out", "z.jsonl"]);
        assert_eq!(refused.status.code(), Some(2));
        let said = unfolded(&refused.stderr);
        assert!(said.contains(&format!("{name}, line 1: {why}")), "{said}");
    }
}

/// A file of a sweep that lies where the report has a table is refused before anything is written.
#[test]
fn a_merge_that_would_overwrite_its_input_by_a_report_writes_nothing() {
    let folder = folder();
    sweep(folder.path(), &["--out", "s.jsonl"]);
    fs::create_dir(folder.path().join("maps")).expect("a folder");
    for name in ["cells.csv", "cells.json", "summary.csv"] {
        let input = format!("maps/{name}");
        fs::copy(folder.path().join("s.jsonl"), folder.path().join(&input)).expect("a copy");
        let refused =
            feedbits_in(folder.path(), &["merge", &input, "--out", "joined.jsonl", "--report", "maps"]);
        assert_eq!(refused.status.code(), Some(2), "{}", unfolded(&refused.stderr));
        assert!(unfolded(&refused.stderr).contains(name), "{}", unfolded(&refused.stderr));
        assert!(!folder.path().join("joined.jsonl").exists(), "{name}");
        fs::remove_file(folder.path().join(&input)).expect("a file");
    }
}

/// A pipe that nobody writes into is not waited for.
#[cfg(unix)]
#[test]
fn a_sweep_goes_into_a_file_alone() {
    let folder = folder();
    let made = std::process::Command::new("mkfifo").arg(folder.path().join("pipe")).status();
    assert!(made.expect("mkfifo starts").success());
    for place in ["pipe", "/dev/null"] {
        let refused = feedbits_in(folder.path(), &[&GRID[..], &["--out", place]].concat());
        assert_eq!(refused.status.code(), Some(2), "{}", unfolded(&refused.stderr));
        assert!(unfolded(&refused.stderr).contains(&format!("{place} is no file")), "{place}");
    }
}

/// A second sweep on the same file ends with a message and changes nothing. Shards without a named file have a file
/// each.
#[test]
fn two_sweeps_never_write_into_one_file() {
    let folder = folder();
    sweep(folder.path(), &["--shard", "1/6", "--out", "s.jsonl"]);
    let path = folder.path().join("s.jsonl");
    let before = fs::read_to_string(&path).expect("a file");
    let other = fs::File::open(&path).expect("a file");
    other.lock().expect("a lock");
    let refused = feedbits_in(folder.path(), &[&GRID[..], &["--out", "s.jsonl"]].concat());
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        unfolded(&refused.stderr).contains("another sweep writes s.jsonl"),
        "{}",
        unfolded(&refused.stderr)
    );
    assert_eq!(fs::read_to_string(&path).expect("a file"), before);
    other.unlock().expect("a lock");
    sweep(folder.path(), &["--out", "s.jsonl"]);

    sweep(folder.path(), &["--shard", "2/6"]);
    sweep(folder.path(), &["--shard", "3/6"]);
    sweep(folder.path(), &["--shard", "1/1"]);
    for name in ["sweep-2-of-6.jsonl", "sweep-3-of-6.jsonl", "sweep.jsonl"] {
        assert!(folder.path().join(name).exists(), "{name}");
    }
}

/// Programs of the same curves are different if the feed or the kind of a move differs; a comment makes no difference.
#[test]
fn a_sweep_of_another_program_is_not_resumed() {
    let folder = folder();
    let run = |program: &str| {
        fs::write(folder.path().join("p.nc"), program).expect("a part");
        let arguments = ["sweep", "p.nc", "--machine", "p.toml", "--formats", "f64", "--evaluate", "pieces"];
        feedbits_in(folder.path(), &arguments)
    };
    let first = run("G1 X0 Y0 F6000\nG1 X10\nG1 X20 Y5\n");
    assert_eq!(first.status.code(), Some(0), "{}", unfolded(&first.stderr));
    for other in ["G1 X0 Y0 F6000\nG1 X10\nG1 X20 Y5 F3000\n", "G1 X0 Y0 F6000\nG1 X10\nG0 X20 Y5\n"] {
        let refused = run(other);
        assert_eq!(refused.status.code(), Some(2), "{other}");
        assert!(unfolded(&refused.stderr).contains("of another sweep"), "{}", unfolded(&refused.stderr));
    }
    let same = run("(once more)\nG1 X0 Y0 F6000\nG1 X10\nG1 X20 Y5\n");
    assert_eq!(same.status.code(), Some(0), "{}", unfolded(&same.stderr));
}

#[test]
fn spans_and_points_have_bounds() {
    let folder = folder();
    for (arguments, words) in [
        (["--points", "999999999999"], "expected a whole number of 1 to 1000"),
        (["--points", "0"], "expected a whole number of 1 to 1000"),
        (["--period", "1..5000"], "'--period <LO..HI>': 5000: expected a number of 0.001 to 1000 ms"),
        (["--feed", "1e9"], "'--feed <LO..HI>': 1000000000: expected a number of 1e-6 to 1e5 mm/s"),
        (["--feed", "-1"], "expected a positive number"),
    ] {
        let refused = feedbits_in(folder.path(), &[&["sweep", "p.toml"], &arguments[..]].concat());
        assert_eq!(refused.status.code(), Some(2), "{arguments:?}");
        assert!(unfolded(&refused.stderr).contains(words), "{arguments:?}: {}", unfolded(&refused.stderr));
    }
    assert!(!folder.path().join("sweep.jsonl").exists());
}

/// A sweep in which no format is good in any cell once ended with the exit status of success.
#[test]
fn a_sweep_in_which_nothing_is_good_says_so_at_its_end() {
    let folder = folder();
    let arguments =
        ["sweep", "p.toml", "--formats", "I16F16", "--evaluate", "pieces", "--fluctuation", "1e-12"];
    let with = |more: &[&str]| feedbits_in(folder.path(), &[&arguments[..], more].concat()).status.code();
    assert_eq!(with(&["--period", "1..4/3"]), Some(1));
    // The results of the other shards are not known.
    assert_eq!(with(&["--period", "1..4/3", "--shard", "1/3"]), Some(0));
    assert_eq!(with(&["--period", "2", "--formats", "f64", "--out", "good.jsonl"]), Some(0));
}
