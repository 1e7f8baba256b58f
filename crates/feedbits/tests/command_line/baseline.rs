//! `--baseline` of `compare` and `size`, and the JSON that it reads.

use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

use serde_json::{Value, json};

use crate::command::feedbits_in;
use crate::message::unfolded;
use crate::small_part::PART;

const COMPARE: [&str; 6] = ["compare", "p.toml", "--formats", "I16F16,I4F28", "--targets", "cortex-m4f"];

const SIZE: [&str; 2] = ["size", "p.toml"];

/// A folder with the part, and the JSON of a command's run in `base.json`.
fn with_baseline(command: &[&str]) -> (tempfile::TempDir, Value) {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("p.toml"), PART).expect("a part");
    let output = feedbits_in(folder.path(), &[command, &["--json", "--out", "base.json"]].concat());
    assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
    let text = fs::read_to_string(folder.path().join("base.json")).expect("a baseline");
    (folder, serde_json::from_str(&text).expect("JSON"))
}

/// Status and message of a run beside this baseline.
fn beside(folder: &Path, baseline: &Value, command: &[&str], more: &[&str]) -> (Option<i32>, String) {
    fs::write(folder.join("base.json"), baseline.to_string()).expect("a baseline");
    let output = feedbits_in(folder, &[command, &["--baseline", "base.json"], more].concat());
    (output.status.code(), unfolded(&output.stderr))
}

#[test]
fn test_a_figure_that_got_worse_ends_with_status_3() {
    let (folder, base) = with_baseline(&COMPARE);
    let folder = folder.path();
    let (status, said) = beside(folder, &base, &COMPARE, &[]);
    assert!(status == Some(0) && said.contains("at most 1 % worse than in base.json"), "{said}");

    let place = |base: &Value| {
        let of = |run: &Value| run["format"] == "I4F28" && run["engine"] == "pieces";
        base["formats"].as_array().unwrap().iter().position(of).unwrap()
    };
    let at = place(&base);
    let mut better = base.clone();
    for key in ["max", "microseconds_max"] {
        let found = &mut better["formats"][at]["cycles"]["cortex-m4f"][key];
        *found = json!(found.as_f64().unwrap() / 1.1);
    }
    let (status, said) = beside(folder, &better, &COMPARE, &[]);
    assert!(status == Some(3) && said.contains("I4F28 pieces: dearest period on cortex-m4f was"), "{said}");
    assert_eq!(said.matches(" was ").count(), 1, "{said}");
    assert_eq!(beside(folder, &better, &COMPARE, &["--worse-by", "11"]).0, Some(0));

    let mut better = base.clone();
    better["fewest_bits"]["bits"] = json!(base["fewest_bits"]["bits"].as_u64().unwrap() - 1);
    let (status, said) = beside(folder, &better, &COMPARE, &[]);
    assert!(status == Some(3) && said.contains("fewest bits was"), "{said}");

    // One that was refused, or not good, and was good before.
    let worse = base["formats"].as_array().unwrap().iter().position(|run| run["verdict"]["result"] != "good");
    let mut better = base.clone();
    better["formats"][worse.unwrap()]["verdict"] = json!({"result": "good"});
    let (status, said) = beside(folder, &better, &COMPARE, &[]);
    assert!(status == Some(3) && said.contains("verdict was good, and is "), "{said}");

    // What is not good enough is worse than worse.
    let mut better = base.clone();
    better["formats"][worse.unwrap()]["verdict"] = json!({"result": "good"});
    let only = ["compare", "p.toml", "--formats", "I16F16", "--targets", "cortex-m4f"];
    better["formats"].as_array_mut().unwrap().retain(|run| run["format"] == "I16F16");
    better["fewest_bits"] = json!({"bits": 1});
    let (status, said) = beside(folder, &better, &only, &[]);
    assert!(status == Some(1) && said.contains("verdict was good, and is "), "{said}");
}

/// A part is known by its text, and a machine by its values: not by their names.
#[test]
fn test_the_same_part_and_machine_elsewhere_are_the_same() {
    let (folder, base) = with_baseline(&COMPARE);
    let folder = folder.path();
    let same = |part: &str, machine: &[&str], text: &str| {
        fs::write(folder.join(part), text).expect("a part");
        let command = [&["compare", part][..], &COMPARE[2..], machine].concat();
        beside(folder, &base, &command, &[])
    };
    fs::create_dir(folder.join("below")).expect("a folder");
    for name in ["./p.toml", "below/../p.toml", "below/q.toml"] {
        let (status, said) = same(name, &[], PART);
        assert_eq!(status, Some(0), "{name}: {said}");
    }
    assert_eq!(same("crlf.toml", &[], &PART.replace('\n', "\r\n")).0, Some(0));
    // The machine's table from a file of its own.
    let machine = PART.split_once("[machine]").expect("a machine").1;
    fs::write(folder.join("m.toml"), format!("[machine]{machine}")).expect("a machine");
    assert_eq!(same("p.toml", &["--machine", "m.toml"], PART).0, Some(0));
    let (status, said) = same("p.toml", &[], &PART.replace("[10, 10]", "[10, 11]"));
    assert!(status == Some(2) && said.contains("has another text"), "{said}");
    let (status, said) = same("p.toml", &["--start", "0,0,1"], PART);
    assert!(status == Some(2) && said.contains("is read by other options"), "{said}");
    // A limit that the baseline's machine does not have.
    let more = format!("[machine]\ncentripetal_acceleration_mm_per_s2 = 900.0{machine}");
    fs::write(folder.join("m.toml"), more).expect("a machine");
    let (status, said) = same("p.toml", &["--machine", "m.toml"], PART);
    assert!(
        status == Some(2) && said.contains("made with centripetal_acceleration_mm_per_s2 = null"),
        "{said}"
    );
}

/// What cannot be compared is said before any run: of a program that takes minutes.
#[test]
fn test_a_baseline_is_refused_before_the_work() {
    let (folder, base) = with_baseline(&COMPARE);
    let folder = folder.path();
    fs::write(folder.join("long.nc"), "G21 G90\nG0 X0 Y0\nG1 X1000 F6\nG1 X0\nM2\n").expect("a program");
    let begun = std::time::Instant::now();
    let long = ["compare", "long.nc", "--machine", "mill"];
    let (status, said) = beside(folder, &base, &long, &[]);
    assert!(status == Some(2) && said.contains("base.json is of the part \"p.toml\""), "{said}");
    assert!(begun.elapsed() < std::time::Duration::from_secs(30), "{:?}", begun.elapsed());

    let fewer = ["compare", "p.toml", "--formats", "I4F28", "--targets", "cortex-m4f"];
    let (status, said) = beside(folder, &base, &fewer, &[]);
    assert!(status == Some(2) && said.contains("has a run in \"I16F16\" by"), "{said}");
    let (status, said) = beside(folder, &base, &COMPARE[..4], &[]);
    assert!(status == Some(2) && said.contains("has costs on cortex-m4f"), "{said}");
    // At another clock every time would be longer or shorter.
    let (status, said) = beside(folder, &base, &[&COMPARE[..], &["--clock", "84"]].concat(), &[]);
    let expected = "has costs on cortex-m4f at 168 MHz, and this comparison at 84: give --clock 168";
    assert!(status == Some(2) && said.contains(expected), "{said}");
    assert_eq!(beside(folder, &base, &[&COMPARE[..], &["--clock", "168"]].concat(), &[]).0, Some(0));
}

#[test]
fn test_a_growth_far_below_the_limit_is_none() {
    let (folder, base) = with_baseline(&COMPARE);
    let mut better = base.clone();
    for run in better["formats"].as_array_mut().unwrap() {
        for requirement in run["requirements"].as_array_mut().into_iter().flatten() {
            if requirement["unit"] == "mm" {
                let limit = requirement["limit"].as_f64().unwrap();
                requirement["found"] = json!(requirement["found"].as_f64().unwrap() - 1e-6 * limit);
            }
        }
    }
    let (status, said) = beside(folder.path(), &better, &COMPARE, &[]);
    assert_eq!(status, Some(0), "{said}");
}

#[test]
fn test_bits_that_grow_end_a_search_with_status_3() {
    let (folder, base) = with_baseline(&SIZE);
    let (status, said) = beside(folder.path(), &base, &SIZE, &[]);
    assert_eq!(status, Some(0), "{said}");
    let mut better = base.clone();
    better["mixed"]["bits"] = json!(base["mixed"]["bits"].as_u64().unwrap() - 10);
    let (status, said) = beside(folder.path(), &better, &SIZE, &[]);
    assert!(status == Some(3) && said.contains("bits of all registers was"), "{said}");
}

#[test]
fn test_a_baseline_of_another_question_is_refused() {
    let (folder, base) = with_baseline(&COMPARE);
    let folder = folder.path();
    let refused = |change: &dyn Fn(&mut Value), expected: &str| {
        let mut other = base.clone();
        change(&mut other);
        let (status, said) = beside(folder, &other, &COMPARE, &[]);
        assert!(status == Some(2) && said.contains(expected), "{said}");
    };
    refused(&|base| base["schema"] = json!(99), "\"schema\" is 99");
    refused(&|base| base["command"] = json!("size"), "expected what `feedbits compare --json` prints");
    refused(&|base| *base = json!({"formats": []}), "no \"schema\"");
    refused(&|base| base["part_crc32"] = json!("00000000"), "is of the part \"p.toml\"");
    refused(&|base| drop(base.as_object_mut().unwrap().remove("part_crc32")), "no \"part_crc32\"");
    refused(&|base| base["machine"]["jerk_mm_per_s3"] = json!(1.0), "made with jerk_mm_per_s3 = 1.0");

    fs::write(folder.join("base.json"), "no JSON").unwrap();
    let output = feedbits_in(folder, &[&COMPARE[..], &["--baseline", "base.json"]].concat());
    let said = unfolded(&output.stderr);
    assert!(output.status.code() == Some(2) && said.contains("base.json"), "{said}");
    let output = feedbits_in(folder, &[&COMPARE[..], &["--baseline", "none.json"]].concat());
    let said = unfolded(&output.stderr);
    assert!(output.status.code() == Some(2) && said.contains("cannot read none.json"), "{said}");
}

/// All keys of an object and of what is in it, but no names that are data: formats, targets, kinds of operation.
pub(crate) fn keys(value: &Value, into: &mut BTreeSet<String>) {
    match value {
        Value::Object(map) => {
            for (key, inner) in map {
                into.insert(key.clone());
                if !["cycles", "operations", "recommended_on"].contains(&key.as_str()) {
                    keys(inner, into);
                } else if key == "cycles" {
                    map[key].as_object().into_iter().flatten().for_each(|(_, cost)| keys(cost, into));
                }
            }
        }
        Value::Array(all) => all.iter().for_each(|inner| keys(inner, into)),
        _ => {}
    }
}

#[test]
fn test_the_page_on_json_has_every_key() {
    let page = include_str!("../../../../docs/json.md");
    let mut found = BTreeSet::new();
    for command in [&COMPARE[..], &SIZE[..]] {
        keys(&with_baseline(command).1, &mut found);
    }
    let missing: Vec<_> = found.iter().filter(|key| !page.contains(&format!("`{key}`"))).collect();
    assert!(missing.is_empty(), "docs/json.md does not have {missing:?}");
}
