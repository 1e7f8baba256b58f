//! `compare` and `size` of many parts at a call, as a person or a job array uses them.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;
use std::process::Output;

use serde_json::Value;

use crate::command::{data, feedbits_in, names};
use crate::message::{text, unfolded};

const ENGRAVING: &str = include_str!("../../../../data/engraving.nc");

/// The formats of most tests, on the machine that every folder has.
const FORMATS: [&str; 4] = ["--machine", "m.toml", "--formats", "I8F24,I4F28"];

/// A machine on which small parts take few periods.
const MACHINE: &str = "[machine]\ninterpolation_period_ms = 2.0\nfeedrate_mm_per_s = 60\nacceleration_mm_per_s2 = 3000\n\
                       jerk_mm_per_s3 = 200000\nchord_error_mm = 0.002\njunction = \"deviation\"\njunction_deviation_mm = 0.01\n";

/// One letter of the engraving, counted from 0, with its feeds times `factor`.
fn letter(number: usize, factor: f64) -> String {
    let mut letters = ENGRAVING.split("G0 Z5.000\n");
    let letter = letters.nth(number + 1).expect("a letter").replace("M3 S12000\n", "");
    letter.replace("F2400", &format!("F{}", 2400.0 * factor)) + "G0 Z5.000\n"
}

/// A folder with the machine and an empty folder `parts`.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("m.toml"), MACHINE).expect("a machine");
    fs::create_dir(folder.path().join("parts")).expect("a folder");
    folder
}

fn write(folder: &Path, name: &str, text: &str) {
    fs::write(folder.join("parts").join(name), text).expect("a part");
}

/// A folder with so many letters as parts.
fn letters(count: usize) -> tempfile::TempDir {
    let folder = folder();
    for number in 0..count {
        write(folder.path(), &format!("letter-{number}.nc"), &letter(number, 1.0));
    }
    folder
}

/// Runs a command on parts, and gives its JSON.
fn json(folder: &Path, words: &[&str], status: i32) -> Value {
    let output = feedbits_in(folder, &[words, &["--json"]].concat());
    assert_eq!(output.status.code(), Some(status), "{words:?}: {}", unfolded(&output.stderr));
    serde_json::from_slice(&output.stdout).expect("JSON")
}

fn compare(folder: &Path, more: &[&str]) -> Output {
    feedbits_in(folder, &[&["compare", "parts"], &FORMATS[..], more].concat())
}

/// What a set has at `result` is, but for the indentation, what the command prints for the part alone.
fn expect_results_of_single_calls(folder: &Path, set: &Output, words: &[&str]) {
    let value: Value = serde_json::from_slice(&set.stdout).expect("JSON");
    let printed = text(&set.stdout);
    for part in value["parts"].as_array().expect("parts") {
        let name = part["name"].as_str().expect("a name");
        let one = feedbits_in(folder, &[&[words[0], name], &words[1..], &["--json"]].concat());
        let alone = text(&one.stdout);
        let within = printed.contains(alone.trim_end().replace('\n', "\n      ").as_str());
        assert!(within, "{name}: {alone}");
        assert_eq!(part["result"], serde_json::from_str::<Value>(&alone).expect("JSON"), "{name}");
        assert_eq!(part["status"] == "good", one.status.code() == Some(0), "{name}");
    }
}

/// Ten small programs: one answer, and each part's result is that of its single call.
#[test]
fn ten_programs_have_one_answer() {
    let folder = letters(8);
    for name in ["seed-000.toml", "trigonometric.toml"] {
        fs::copy(data(name), folder.path().join("parts").join(name)).expect("a part");
    }
    let said = compare(folder.path(), &[]);
    assert_eq!(said.status.code(), Some(0), "{}", unfolded(&said.stderr));
    let words = unfolded(&said.stdout);
    assert!(words.contains("bits are enough for all 10 parts: I"), "{words}");
    assert!(words.contains("Of the formats compared I8F24 is good for all, of 32 bits."), "{words}");
    assert!(text(&said.stdout).lines().all(|line| line.chars().count() <= 80), "{}", text(&said.stdout));

    let set = compare(folder.path(), &["--json"]);
    expect_results_of_single_calls(folder.path(), &set, &[&["compare"], &FORMATS[..]].concat());
    let set: Value = serde_json::from_slice(&set.stdout).expect("JSON");
    assert_eq!((set["schema"].as_u64(), set["command"].as_str()), (Some(1), Some("compare-set")));
    let answer = &set["answer"];
    assert_eq!((answer["parts"].as_u64(), answer["parts_run"].as_u64()), (Some(10), Some(10)));
    let parts = set["parts"].as_array().expect("parts");
    let bits = parts.iter().filter_map(|part| part["bits"].as_u64()).max();
    assert!(answer["fewest_bits"]["bits"].as_u64() >= bits, "{answer}");
    // The least margin of the recommended format is that of a part.
    let margins = parts.iter().filter_map(|part| part["margin"].as_f64());
    let formats = answer["formats"].as_array().expect("formats");
    let recommended = formats.iter().find(|one| one["format"] == "I8F24" && one["engine"] == "pieces");
    assert_eq!(margins.reduce(f64::min), recommended.and_then(|one| one["margin"].as_f64()));
}

/// The good formats of a part of some widths, each as its width and its integer bits, by a run of each format.
fn good_formats(folder: &Path, part: &str, widths: std::ops::RangeInclusive<u32>) -> BTreeSet<(u32, u32)> {
    let splits = widths.flat_map(|width| (2..=width).map(move |integer| (width, integer)));
    let splits: Vec<_> = splits.collect();
    let formats: Vec<String> =
        splits.iter().map(|(width, integer)| format!("I{integer}F{}", width - integer)).collect();
    let words =
        ["compare", part, "--machine", "m.toml", "--evaluate", "pieces", "--formats", &formats.join(",")];
    let output = feedbits_in(folder, &[&words[..], &["--json"]].concat());
    let result: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let is_good = |name: &str| {
        let mut runs = result["formats"].as_array().expect("runs").iter();
        runs.any(|run| run["format"] == name && run["verdict"]["result"] == "good")
    };
    splits.iter().zip(&formats).filter(|(_, name)| is_good(name)).map(|(split, _)| *split).collect()
}

/// The answer for six parts is the first format that every part's brute force has.
fn expect_brute_force(folder: &Path) {
    let set = json(folder, &[&["compare", "parts"], &FORMATS[..]].concat(), 0);
    let fewest = &set["answer"]["fewest_bits"];
    let bits = u32::try_from(fewest["bits"].as_u64().expect("a width")).expect("a width");
    let parts = set["parts"].as_array().expect("parts");
    assert_eq!(parts.len(), 6);
    let good: Vec<BTreeSet<(u32, u32)>> = parts
        .iter()
        .map(|part| good_formats(folder, part["name"].as_str().expect("a name"), 12..=bits))
        .collect();
    let all = |good: &[BTreeSet<(u32, u32)>]| {
        let common = good.iter().skip(1).fold(good[0].clone(), |all, part| &all & part);
        common.first().copied()
    };
    let (width, integer) = all(&good).expect("a common format");
    assert_eq!(fewest["format"], format!("I{integer}F{}", width - integer), "{fewest}");
    // And each part's own answer.
    for (part, good) in parts.iter().zip(&good) {
        assert_eq!(part["bits"].as_u64(), good.first().map(|(width, _)| u64::from(*width)), "{part}");
    }
    if let Some(decides) = fewest["decides"].as_object() {
        let without: Vec<_> = parts
            .iter()
            .zip(&good)
            .filter(|(part, _)| part["name"] != decides["part"])
            .map(|(_, good)| good.clone())
            .collect();
        let without = all(&without).map(|(width, _)| u64::from(width));
        assert!(without < Some(u64::from(bits)), "{decides:?}");
        assert_eq!(decides["bits_without"].as_u64(), without, "{decides:?}");
        // What it breaks with a bit fewer, by a run of its own.
        let (part, narrower) = (decides["part"].as_str().unwrap(), decides["narrower"].as_str().unwrap());
        let words = ["compare", part, "--machine", "m.toml", "--evaluate", "pieces", "--formats", narrower];
        let alone = json(folder, &words, 1);
        let requirements = alone["formats"][0]["requirements"].as_array().expect("requirements");
        let broken = requirements.iter().find(|one| one["found"].as_f64() > one["limit"].as_f64());
        let broken = broken.expect("a broken requirement");
        assert_eq!(
            (&broken["what"], &broken["at"]["line"]),
            (&decides["breaks"]["what"], &decides["breaks"]["line"])
        );
    } else {
        // No part, or several, need so many bits alone; or one does, and the others together as many.
        let own = |good: &BTreeSet<(u32, u32)>| good.first().map(|(width, _)| *width);
        let others: Vec<_> = good.iter().filter(|good| own(good) != Some(bits)).cloned().collect();
        let is_alone = others.len() + 1 == good.len();
        assert!(!is_alone || all(&others).map(|(width, _)| width) == Some(bits), "a part alone decides");
    }
}

/// Letters at feeds that differ, and a part that needs more than all of them.
#[test]
fn the_answer_of_a_set_is_that_of_brute_force() {
    let folder = folder();
    for number in 0..5 {
        write(folder.path(), &format!("l{number}.nc"), &letter(number, 0.5 + 0.5 * number as f64));
    }
    write(folder.path(), "long.nc", "G21 G90 G0 X0 Y0\nG1 X700 Y13 F3600\nG2 X720 Y33 R20\nG1 X733 Y140\n");
    expect_brute_force(folder.path());
}

/// Splines, a circle, and slow and fast lines.
#[test]
fn the_answer_of_a_set_of_curves_is_that_of_brute_force() {
    let folder = folder();
    let name = "trigonometric.toml";
    fs::copy(data(name), folder.path().join("parts").join(name)).expect("a part");
    write(folder.path(), "curve.nc", "G21 G90 G0 X0 Y0\nG5 X12 Y3 I3 J6 P-3 Q4 F1500\n");
    write(folder.path(), "circle.nc", "G21 G90 G17 G0 X4 Y0\nG3 X4 Y0 I-4 J0 F1800\n");
    write(folder.path(), "slow.nc", "G21 G90 G0 X0 Y0\nG1 X1 Y0.3 F60\nG1 X2 Y0.5\n");
    write(folder.path(), "fast.nc", "G21 G90 G0 X0 Y0\nG1 X300 Y170 F12000\n");
    write(folder.path(), "small.nc", "G21 G90 G17 G0 X0 Y0\nG2 X0.5 Y0.5 R0.5 F600\nG3 X1 Y1 R0.5\n");
    expect_brute_force(folder.path());
}

/// Parts that cannot be read or run are named and counted, and have a status of their own; a part that no format is good for goes first.
#[test]
fn parts_that_are_not_run_are_named() {
    let folder = letters(2);
    write(folder.path(), "empty.nc", "");
    write(folder.path(), "rapid.nc", "G21 G0 X0 Y0\nX10 Y5\n");
    write(folder.path(), "wrong.nc", "G21 G0 X0 Y0\nG1 X5 Y F100\n");
    let huge = fs::File::create(folder.path().join("parts/huge.nc")).expect("a file");
    huge.set_len(513 << 20).expect("a length");
    fs::write(folder.path().join("list"), "# parts of today\nparts\n\nparts/none.nc\n").expect("a list");
    let words =
        |parts: &'static str, more: &[&'static str]| [&["compare", parts], &FORMATS[..], more].concat();
    let output = feedbits_in(folder.path(), &words("@list", &[]));
    let said = unfolded(&output.stdout);
    assert_eq!(output.status.code(), Some(4), "{said}");
    assert!(said.contains("2 parts, ") && said.contains("4 cannot be read, 1 cannot be run"), "{said}");
    assert!(said.contains("5 parts are not run:"), "{said}");
    for part in ["empty.nc: ", "rapid.nc: ", "wrong.nc: ", "huge.nc: ", "none.nc: "] {
        assert!(said.contains(&format!("- {part}")), "{part} in {said}");
    }
    assert!(said.contains("longer than 512 MiB") && said.contains("wrong.nc:2:"), "{said}");
    assert_eq!(feedbits_in(folder.path(), &words("@list", &["--skip-refused"])).status.code(), Some(0));

    let set = json(folder.path(), &words("@list", &[]), 4);
    let of = |status: &str| {
        let parts = set["parts"].as_array().expect("parts").iter().filter(|part| part["status"] == *status);
        parts.filter_map(|part| part["name"].as_str()).collect::<Vec<_>>()
    };
    assert_eq!(of("good"), ["parts/letter-0.nc", "parts/letter-1.nc"]);
    assert_eq!(of("unread"), ["parts/empty.nc", "parts/huge.nc", "parts/wrong.nc", "parts/none.nc"]);
    assert_eq!(of("refused"), ["parts/rapid.nc"]);

    // Not good enough goes before refused, and is named with its reason.
    let bad = [&["compare", "@list", "--machine", "m.toml", "--formats", "I24F8"][..], &["--skip-refused"]]
        .concat();
    let output = feedbits_in(folder.path(), &bad);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stdout));
    let said = unfolded(&output.stdout);
    assert!(
        said.contains("None of the formats compared is good enough for all parts. I24F8 is for 0 of 2"),
        "{said}"
    );

    // Without a part that can be run there is no answer.
    let output =
        feedbits_in(folder.path(), &["compare", "parts/rapid.nc", "parts/wrong.nc", "--machine", "m.toml"]);
    assert_eq!(output.status.code(), Some(2));
    assert!(unfolded(&output.stderr).contains("none of 2 parts can be run"), "{}", unfolded(&output.stderr));
    assert!(output.stdout.is_empty());
}

/// A part that every format fails, since its plan does, is named; the answer is that of the others.
#[test]
fn a_part_that_no_format_is_enough_for_is_named() {
    let folder = letters(2);
    // The step to the corner is a period's way at this feed, and its chord cuts it.
    write(folder.path(), "fails.nc", &letter(3, 1.0));
    let words = ["compare", "parts", "--machine", "m.toml", "--formats", "I4F28", "--profile", "none"];
    let output = feedbits_in(folder.path(), &words);
    let set: Value =
        serde_json::from_slice(&feedbits_in(folder.path(), &[&words[..], &["--json"]].concat()).stdout)
            .expect("JSON");
    let none_for = set["answer"]["fewest_bits"]["none_for"].as_array().expect("a list");
    let failing = set["parts"].as_array().unwrap().iter().filter(|part| part["status"] == "bad").count();
    assert_eq!(output.status.code() == Some(1), failing > 0, "{}", text(&output.stdout));
    assert_eq!(none_for.len(), failing, "{}", set["answer"]);
}

/// Finished parts are kept, a torn line is run again, and the result has the same bytes as that of a single call.
#[test]
fn a_set_that_was_killed_goes_on_where_it_was() {
    let folder = letters(6);
    let path = folder.path().join("s.jsonl");
    let straight = compare(folder.path(), &["--json"]).stdout;
    let resumed = |status: i32| {
        let output = compare(folder.path(), &["--json", "--resume", "s.jsonl"]);
        assert_eq!(output.status.code(), Some(status), "{}", unfolded(&output.stderr));
        output
    };
    assert_eq!(text(&resumed(0).stdout), text(&straight));
    let whole = fs::read_to_string(&path).expect("a file");
    let lines: Vec<&str> = whole.lines().collect();
    for kept in [1, 2, lines.len() / 2, lines.len() - 1] {
        let torn = format!("{}\n{}", lines[..kept].join("\n"), &lines[kept][..lines[kept].len() / 2]);
        fs::write(&path, &torn).expect("a file");
        let again = resumed(0);
        assert!(unfolded(&again.stderr).contains("torn"), "{}", unfolded(&again.stderr));
        assert_eq!(text(&again.stdout), text(&straight), "{kept} lines");
    }
    // What is finished is not run again.
    fs::write(&path, &whole).expect("a file");
    resumed(0);
    assert_eq!(fs::read_to_string(&path).expect("a file"), whole);

    // Another list of formats is another set, and a damaged line is an error with its place.
    let other = feedbits_in(
        folder.path(),
        &["compare", "parts", "--machine", "m.toml", "--formats", "f64", "--resume", "s.jsonl"],
    );
    assert_eq!(other.status.code(), Some(2));
    assert!(unfolded(&other.stderr).contains("is of another set of parts"), "{}", unfolded(&other.stderr));
    fs::write(&path, whole.replacen("finished", "finishes", 1)).expect("a file");
    assert!(unfolded(&resumed(2).stderr).contains("s.jsonl, line 2: "));
    // So is one of a part that has changed.
    fs::write(&path, &whole).expect("a file");
    write(folder.path(), "letter-0.nc", &letter(7, 1.0));
    assert!(unfolded(&resumed(2).stderr).contains("is of another set of parts"));
}

/// A part that has not changed is not run again; a damaged result is.
#[test]
fn results_that_are_kept_are_taken() {
    let folder = letters(4);
    let cached = |more: &[&str]| {
        let output = compare(folder.path(), &[&["--json", "--cache", "kept"], more].concat());
        assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
        output
    };
    let first = cached(&[]);
    assert_eq!(text(&first.stdout), text(&compare(folder.path(), &["--json"]).stdout));
    let files = names(&folder.path().join("kept"));
    assert_eq!(files.len(), 4);
    let written = |name: &str| {
        let found = fs::metadata(folder.path().join("kept").join(name)).expect("a file");
        found.modified().expect("a time")
    };
    let before: Vec<_> = files.iter().map(|name| written(name)).collect();
    assert_eq!(text(&cached(&[]).stdout), text(&first.stdout));
    assert_eq!(files.iter().map(|name| written(name)).collect::<Vec<_>>(), before, "nothing is run again");

    // A part that has changed has a file of its own, and so has one with another option.
    write(folder.path(), "letter-1.nc", &letter(9, 1.0));
    cached(&[]);
    assert_eq!(names(&folder.path().join("kept")).len(), 5);
    cached(&["--fluctuation", "2e-4"]);
    assert_eq!(names(&folder.path().join("kept")).len(), 9);

    let damaged = folder.path().join("kept").join(&files[0]);
    let whole = fs::read_to_string(&damaged).expect("a file");
    for text_of_file in [&whole[..whole.len() / 2], &whole.replacen("good", "bood", 1), "\0\0\0"] {
        fs::write(&damaged, text_of_file).expect("a file");
        let again = compare(folder.path(), &["--cache", "kept"]);
        assert_eq!(again.status.code(), Some(0), "{}", unfolded(&again.stderr));
    }
}

/// Shards together are the whole, and the joined file has the answer.
#[test]
fn shards_of_a_set_together_are_the_whole() {
    let folder = letters(5);
    let whole = compare(folder.path(), &["--json"]);
    for shard in ["1/2", "2/2"] {
        let output = compare(folder.path(), &["--json", "--shard", shard]);
        assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
        let part: Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let finished = part["answer"]["parts_run"].as_u64();
        assert_eq!(finished, Some(if shard == "1/2" { 3 } else { 2 }));
    }
    let one = feedbits_in(folder.path(), &["merge", "compare-1-of-2.jsonl", "--out", "all.jsonl"]);
    assert_eq!(one.status.code(), Some(2));
    assert!(
        unfolded(&one.stderr)
            .contains("2 of 5 parts are in none of the files, the first of them parts/letter-1.nc"),
        "{}",
        unfolded(&one.stderr)
    );
    let files = ["merge", "compare-2-of-2.jsonl", "compare-1-of-2.jsonl", "--out", "all.jsonl"];
    let merged = feedbits_in(folder.path(), &files);
    assert_eq!(merged.status.code(), Some(0), "{}", unfolded(&merged.stderr));
    assert!(
        unfolded(&merged.stdout).starts_with("5 of 5 parts in all.jsonl;"),
        "{}",
        unfolded(&merged.stdout)
    );
    let joined = compare(folder.path(), &["--json", "--resume", "all.jsonl"]);
    assert_eq!(text(&joined.stdout), text(&whole.stdout));
}

/// Parts that are new, gone or worse are named.
#[test]
fn a_set_is_gated_on_an_earlier_one() {
    let folder = letters(3);
    let base = compare(folder.path(), &["--json", "--out", "base.json"]);
    assert_eq!(base.status.code(), Some(0), "{}", unfolded(&base.stderr));
    let gated = |more: &[&str]| {
        let output = compare(folder.path(), &[&["--baseline", "base.json"], more].concat());
        (output.status.code(), unfolded(&output.stderr))
    };
    let (status, said) = gated(&[]);
    assert!(status == Some(0) && said.contains("3 parts are at most 1 % worse"), "{said}");

    write(folder.path(), "new.nc", &letter(5, 0.5));
    let (status, said) = gated(&[]);
    assert!(
        status == Some(0)
            && said.contains("new parts, which are not in base.json")
            && said.contains("new.nc"),
        "{said}"
    );

    let mut better: Value =
        serde_json::from_str(&fs::read_to_string(folder.path().join("base.json")).unwrap()).expect("JSON");
    let periods = &mut better["parts"][1]["result"]["formats"][1]["periods"];
    *periods = (periods.as_u64().unwrap() * 9 / 10).into();
    fs::write(folder.path().join("base.json"), better.to_string()).expect("a baseline");
    let (status, said) = gated(&[]);
    assert!(
        status == Some(3) && said.contains("parts/letter-1.nc: ") && said.contains(": periods was"),
        "{said}"
    );

    fs::remove_file(folder.path().join("parts/letter-0.nc")).expect("a part");
    let (status, said) = gated(&["--worse-by", "20"]);
    assert!(status == Some(3) && said.contains("parts/letter-0.nc was run, and is gone"), "{said}");

    // A baseline of one part is none of a set, and the other way round.
    let alone = ["compare", "parts/letter-1.nc", "--machine", "m.toml", "--baseline", "base.json"];
    assert_eq!(feedbits_in(folder.path(), &alone).status.code(), Some(2));
}

/// `size` of a set: the fewest bits as `compare` finds them, and the union of the registers.
#[test]
fn registers_of_a_set_hold_what_every_part_needs() {
    let folder = folder();
    write(folder.path(), "a.nc", "G21 G90 G0 X0 Y0\nG1 X8 Y1 F1800\n");
    write(folder.path(), "b.nc", "G21 G90 G17 G0 X0 Y0\nG2 X4 Y4 R4 F900\n");
    let words = ["size", "parts", "--machine", "m.toml"];
    let output = feedbits_in(folder.path(), &[&words[..], &["--json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
    expect_results_of_single_calls(folder.path(), &output, &["size", "--machine", "m.toml"]);
    let set: Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let compared = json(folder.path(), &["compare", "parts", "--machine", "m.toml", "--formats", "f64"], 0);
    assert_eq!(set["answer"]["fewest_bits"]["format"], compared["answer"]["fewest_bits"]["format"]);
    let bits = |format: &Value| {
        let format = format.as_str().expect("a format").trim_start_matches('I').to_string();
        let (integer, fraction) = format.split_once('F').expect("a format");
        (integer.parse::<u32>().unwrap(), fraction.parse::<u32>().unwrap())
    };
    for register in set["answer"]["registers"]["signals"].as_array().expect("registers") {
        let of_parts = set["parts"].as_array().unwrap().iter().filter_map(|part| {
            let mut signals = part["result"]["mixed"]["signals"].as_array()?.iter();
            signals
                .find(|one| one["signal"] == register["signal"])
                .map(|one| (&part["name"], bits(&one["format"])))
        });
        let of_parts: Vec<_> = of_parts.collect();
        let (integer, fraction) = bits(&register["format"]);
        assert_eq!(Some(integer), of_parts.iter().map(|(_, bits)| bits.0).max(), "{register}");
        assert_eq!(Some(fraction), of_parts.iter().map(|(_, bits)| bits.1).max(), "{register}");
        assert!(
            of_parts.iter().any(|(name, bits)| **name == register["integer_bits_for"] && bits.0 == integer)
        );
        assert!(
            of_parts.iter().any(|(name, bits)| **name == register["fraction_bits_for"] && bits.1 == fraction)
        );
    }
}

/// The page of a set has its answer, the map, the curve, and a row for each part.
#[test]
fn a_set_has_a_page() {
    let folder = letters(3);
    write(folder.path(), "rapid.nc", "G21 G0 X0 Y0\nX10 Y5\n");
    let output = compare(folder.path(), &["--report", "page"]);
    assert_eq!(output.status.code(), Some(4), "{}", unfolded(&output.stderr));
    let files = names(&folder.path().join("page"));
    assert_eq!(files, ["index.html", "map.svg", "parts.csv", "parts.json", "shares.svg"]);
    let page = fs::read_to_string(folder.path().join("page/index.html")).expect("a page");
    assert!(page.contains("bits are enough for all 3 parts") && page.contains("rapid.nc"), "{page}");
    let table = fs::read_to_string(folder.path().join("page/parts.csv")).expect("a table");
    assert_eq!(table.lines().count(), 5, "{table}");
}

/// Costs on targets are the worst over the parts, and decide what is recommended.
#[test]
fn costs_of_a_set_are_the_worst_of_its_parts() {
    let folder = letters(3);
    let words = [&["compare", "parts"], &FORMATS[..], &["--targets", "cortex-m4f"]].concat();
    let set = json(folder.path(), &words, 0);
    for format in set["answer"]["formats"].as_array().expect("formats") {
        let runs = set["parts"].as_array().unwrap().iter().map(|part| {
            let mut runs = part["result"]["formats"].as_array().unwrap().iter();
            runs.find(|run| run["format"] == format["format"] && run["engine"] == format["engine"]).unwrap()
        });
        let ran = runs.filter(|run| run["verdict"]["result"] != "refused");
        let max = ran.filter_map(|run| run["cycles"]["cortex-m4f"]["max"].as_f64()).reduce(f64::max);
        assert_eq!(format["cycles"]["cortex-m4f"]["max"].as_f64(), max, "{format}");
    }
    let [name, engine] = [0, 1].map(|at| set["answer"]["recommended_on"]["cortex-m4f"][at].clone());
    assert_eq!((&set["answer"]["recommended"], &set["answer"]["recommended_engine"]), (&name, &engine));
}

/// What no set can have is refused in a line, before the work.
#[test]
fn what_a_set_cannot_have_is_refused() {
    let folder = letters(2);
    fs::write(folder.path().join("circle"), "@circle\n").expect("a list");
    fs::create_dir(folder.path().join("nothing")).expect("a folder");
    for (words, expected) in [
        (&["compare", "parts", "--machine", "m.toml", "--wide"][..], "--wide"),
        (&["size", "parts", "--machine", "m.toml", "--types", "c"], "--types"),
        (&["compare", "parts", "-", "--machine", "m.toml"], "standard input"),
        (&["compare", "@none", "--machine", "m.toml"], "cannot read none"),
        (&["compare", "@circle", "--machine", "m.toml"], "not another list"),
        (&["compare", "nothing", "--machine", "m.toml"], "no part is given"),
        (&["compare", "parts", "--shard", "3/2"], "I/N"),
        (&["compare", "parts", "--formats", "I99F99"], "I99F99"),
    ] {
        let output = feedbits_in(folder.path(), words);
        assert_eq!(output.status.code(), Some(2), "{words:?}: {}", text(&output.stdout));
        assert!(unfolded(&output.stderr).contains(expected), "{words:?}: {}", unfolded(&output.stderr));
        assert!(output.stdout.is_empty(), "{words:?}");
    }
    // A part that is named twice, by whatever path, is run once.
    let words = [
        "compare",
        "parts",
        "parts/letter-0.nc",
        "./parts/letter-1.nc",
        "--machine",
        "m.toml",
        "--formats",
        "f64",
    ];
    assert_eq!(json(folder.path(), &words, 0)["answer"]["parts"], 2);
}

/// The keys of a value, but for those of the parts' results, which are those of single calls, and of names in their place.
fn keys(value: &Value, found: &mut BTreeSet<String>) {
    const OF_NAMES: [&str; 3] = ["result", "cycles", "recommended_on"];
    match value {
        Value::Object(members) => {
            for (key, value) in members {
                found.insert(key.clone());
                if !OF_NAMES.contains(&key.as_str()) {
                    keys(value, found);
                }
            }
        }
        Value::Array(values) => values.iter().for_each(|value| keys(value, found)),
        _ => {}
    }
}

#[test]
fn the_page_on_json_has_every_key_of_a_set() {
    let folder = letters(2);
    write(folder.path(), "rapid.nc", "G21 G0 X0 Y0\nX10 Y5\n");
    let page = include_str!("../../../../docs/json.md");
    let mut found = BTreeSet::new();
    let compared = [&["compare", "parts"], &FORMATS[..], &["--targets", "cortex-m4f"]].concat();
    keys(&json(folder.path(), &compared, 4), &mut found);
    keys(&json(folder.path(), &["size", "parts", "--machine", "m.toml"], 4), &mut found);
    assert!(found.contains("registers") && found.contains("formats"), "{found:?}");
    let missing: Vec<_> = found.iter().filter(|key| !page.contains(&format!("`{key}`"))).collect();
    assert!(missing.is_empty(), "docs/json.md does not have {missing:?}");
}

/// A set that is killed while it works goes on, and ends with the bytes of a call that was not.
#[cfg(unix)]
#[test]
fn a_set_that_is_killed_while_it_works_ends_the_same() {
    use std::process::Stdio;
    use std::time::{Duration, Instant};

    let folder = letters(8);
    let words = [&["compare", "parts"], &FORMATS[..], &["--json", "--resume", "s.jsonl"]].concat();
    let straight = compare(folder.path(), &["--json"]).stdout;
    let path = folder.path().join("s.jsonl");
    let lines = || fs::read_to_string(&path).map_or(0, |text| text.lines().count());
    for wanted in [2, 5] {
        let mut child = crate::command::command(&words)
            .current_dir(folder.path())
            .stdout(Stdio::null())
            .stderr(Stdio::null())
            .spawn()
            .expect("the program starts");
        let begun = Instant::now();
        while lines() < wanted && begun.elapsed() < Duration::from_secs(60) {
            std::thread::sleep(Duration::from_millis(2));
        }
        // SIGKILL, which no program sees; it may have ended before.
        let _ = child.kill();
        child.wait().expect("an end");
    }
    assert!(lines() >= 5);
    let resumed = feedbits_in(folder.path(), &words);
    assert_eq!(text(&resumed.stdout), text(&straight), "{}", unfolded(&resumed.stderr));
}

/// The result went over a part of the set once: the part counted as one that cannot be read.
#[test]
fn no_part_of_a_set_is_written_over() {
    let folder = letters(2);
    fs::write(folder.path().join("list"), "parts\n").expect("a list");
    let before = fs::read(folder.path().join("parts/letter-0.nc")).expect("a part");
    for parts in [vec!["parts"], vec!["@list"], vec!["parts/letter-0.nc", "parts/letter-1.nc"]] {
        for command in [&["compare", "--formats", "I8F24"][..], &["compare", "--json"], &["size"]] {
            let words = [command, &parts, &["--machine", "m.toml", "--out", "parts/letter-0.nc"]].concat();
            let output = feedbits_in(folder.path(), &words);
            assert_eq!(output.status.code(), Some(2), "{words:?}");
            let said = unfolded(&output.stderr);
            assert!(said.contains("is the same file as"), "{words:?}: {said}");
            assert_eq!(fs::read(folder.path().join("parts/letter-0.nc")).expect("a part"), before);
        }
    }
}

/// The folder was made and filled, and then the result had no place.
#[test]
fn no_folder_is_made_where_a_file_is_to_be_written() {
    let folder = letters(2);
    for cache in ["both", "./both/", "both/below"] {
        let words = ["size", "parts", "--machine", "m.toml", "--out", "both", "--cache", cache];
        let output = feedbits_in(folder.path(), &words);
        assert_eq!(output.status.code(), Some(2), "{cache}");
        let said = unfolded(&output.stderr);
        assert!(said.contains("is also --out both: expected a name of its own for each"), "{cache}: {said}");
        assert!(!folder.path().join("both").exists(), "{cache}");
    }
}

/// A pipe gives its text once: as a part of a set it is refused, and of shards that are merged it is read once.
#[test]
#[cfg(unix)]
fn a_pipe_is_read_once_or_refused() {
    use crate::outputs::in_shell;
    let folder = letters(2);
    for shard in ["1/2", "2/2"] {
        let words = [&["compare", "parts"], &FORMATS[..], &["--shard", shard]].concat();
        let output = feedbits_in(folder.path(), &words);
        assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
    }
    let script = "mkfifo pipe; cat compare-1-of-2.jsonl > pipe & timeout 20 feedbits merge pipe compare-2-of-2.jsonl --out all.jsonl";
    let output = in_shell(folder.path(), script);
    assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
    let refused =
        in_shell(folder.path(), "timeout 20 feedbits compare parts pipe --machine m.toml --formats I8F24");
    assert_eq!(refused.status.code(), Some(2));
    assert!(
        unfolded(&refused.stderr).contains("expected a file, not a pipe"),
        "{}",
        unfolded(&refused.stderr)
    );
}
