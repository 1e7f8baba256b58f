//! The program: its state, and what it refuses.

use std::fs;
use std::process::{Command, Output};

fn is_refused(output: &Output, says: &[&str]) {
    let said = String::from_utf8_lossy(&output.stderr);
    assert_eq!((output.status.code(), output.stdout.is_empty()), (Some(2), true), "{said}");
    assert!(says.iter().all(|text| said.contains(text)), "{said} does not say {says:?}");
}

#[test]
fn a_soak_goes_on_where_it_stopped_and_refuses_what_is_not_its_own() {
    let folder = tempfile::tempdir().expect("a folder");
    let run = |arguments: &str| {
        let mut program = Command::new(env!("CARGO_BIN_EXE_soak"));
        program.args(arguments.split(' ')).current_dir(folder.path()).output().expect("it starts")
    };
    let first = run("--periods 2k --formats I4F28 --seed 3 --resume s.json");
    assert!(first.status.success(), "{first:?}");
    let again = run("--periods 2k --formats I4F28 --seed 3 --resume s.json --json");
    let state: serde_json::Value = serde_json::from_slice(&again.stdout).expect("JSON");
    assert!(state["formats"][0]["worst"]["periods"].as_u64() >= Some(2000), "{state}");
    assert_eq!(
        (state["violations"].as_u64(), state["next_path"].as_u64().map(|n| n % 32)),
        (Some(0), Some(0))
    );
    let more = run("--periods 3M --formats I4F28 --seed 3 --resume s.json --json");
    let grown: serde_json::Value = serde_json::from_slice(&more.stdout).expect("JSON");
    assert!(grown["next_path"].as_u64() > state["next_path"].as_u64(), "{grown}");
    let once = run("--periods 3M --formats I4F28 --seed 3 --json");
    let once: serde_json::Value = serde_json::from_slice(&once.stdout).expect("JSON");
    assert_eq!((&once["formats"], &once["next_path"]), (&grown["formats"], &grown["next_path"]));

    is_refused(&run("--formats I4F28 --seed 4 --resume s.json"), &["s.json", "seed 3"]);
    is_refused(&run("--formats f64 --seed 3 --resume s.json"), &["s.json", "other formats"]);
    is_refused(
        &run("--formats I4F28 --seed 3 --full-speed --resume s.json"),
        &["s.json", "paths slowed down"],
    );
    is_refused(&run("--formats I99F1"), &["I99F1", "known are f64"]);
    is_refused(&run("--periods 0"), &["'0'", "above 0"]);
    fs::write(folder.path().join("s.json"), "{").expect("a file");
    is_refused(&run("--formats I4F28 --resume s.json"), &["s.json is no state of a soak"]);
}
