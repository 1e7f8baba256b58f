//! A program in place of random paths.

use std::fs;
use std::process::Command;

#[test]
fn a_program_is_run_in_every_format_with_overrides_and_holds() {
    let folder = tempfile::tempdir().expect("a folder");
    let machine = concat!(env!("CARGO_MANIFEST_DIR"), "/../../data/machines/router.toml");
    let part = "G21 G90\nG0 X0 Y0\nG1 X200 F600\nG3 X200 Y60 I0 J30\nG1 X0\nG1 Y0\nG0 X50 Y10\nG1 X150\n";
    fs::write(folder.path().join("part.nc"), part).expect("a file");
    let run = |seed: &str| {
        let mut program = Command::new(env!("CARGO_BIN_EXE_soak"));
        let arguments = ["--program", "part.nc", "--machine", machine, "--json", "--seed", seed];
        let output = program.args(arguments).current_dir(folder.path()).output().expect("it starts");
        assert!(output.status.success(), "{output:?}");
        serde_json::from_slice::<serde_json::Value>(&output.stdout).expect("JSON")
    };
    let soak = run("5");
    let formats = soak["formats"].as_array().expect("formats");
    assert!(soak["holds"].as_u64() > Some(0) && soak["sections"].as_u64() > Some(1), "{soak}");
    let good = formats.iter().filter(|run| run["verdict"]["result"] == "good").count();
    assert!(formats.len() == 11 && good >= 4, "{soak}");
    // Every format runs the plan at the same rates; a coarse one may land later.
    let periods =
        |format: &str| formats.iter().find(|run| run["format"] == format).map(|run| run["periods"].as_u64());
    assert_eq!(periods("f64"), periods("I4F60"));
    assert_eq!((&run("5")["formats"], run("6")["commands"] == soak["commands"]), (&soak["formats"], false));
}
