//! Names of files, targets and runs, and what they may not do in files that are written, on a terminal, and to a folder.

use std::ffi::{OsStr, OsString};
use std::fs;
use std::os::unix::ffi::{OsStrExt, OsStringExt};
use std::path::Path;
use std::process::{Command, Output};

use foreign_text::hostile::NAMES;
use serde_json::Value;

use crate::sweep::sealed;

/// A part whose runs take little time.
const PART: &str = "[curve]\ndegree = 2\ncontrol_points_mm = [[0, 0], [10, 0], [10, 10]]\nknots = [0, 0, 0, 1, 1, 1]\n\n\
                    [machine]\ninterpolation_period_ms = 2\nfeedrate_mm_per_s = 100\nacceleration_mm_per_s2 = 5000\n\
                    jerk_mm_per_s3 = 400000\n";

/// A target, of which a test changes name and title.
const TARGET: &str = include_str!("../../../target-cost/targets/c28x.toml");

fn feedbits(folder: &Path, arguments: &[&str], name: &OsStr) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_feedbits"));
    command.args(arguments).arg("--").arg(name).current_dir(folder).output().expect("the program starts")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).unwrap_or_else(|error| panic!("{name}: {error}"))
}

/// The names of the files in a folder.
fn files(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("a folder");
    let mut names: Vec<_> =
        entries.map(|entry| text(entry.expect("an entry").file_name().as_bytes())).collect();
    names.sort();
    names
}

/// A folder with a part of this name in it, which may have folders of its own.
fn with_part(name: &OsStr) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join(name);
    fs::create_dir_all(file.parent().expect("a folder")).expect("a folder");
    fs::write(file, PART).expect("a part");
    folder
}

/// Every hostile name of a file, one of them no text.
fn names() -> Vec<OsString> {
    let of_a_file =
        |name: &str| if name.ends_with('/') { format!("{name}part.nc") } else { name.to_string() };
    let no_text = OsString::from_vec(b"\xff*/ int injected(void){return 666;} /*\xff.nc".to_vec());
    NAMES.iter().map(|name| of_a_file(name).into()).chain([no_text]).collect()
}

/// What a name of a file is as text.
fn lossy(name: &OsStr) -> String {
    name.to_string_lossy().into_owned()
}

/// The symbols of a compiled source, with their types and sizes; `None` without the compiler.
fn symbols(folder: &Path, compiler: &str) -> Option<String> {
    let strict = [
        "-std=c99",
        "-Wall",
        "-Wextra",
        "-pedantic",
        "-Werror",
        "-Wno-unused-function",
        "-O0",
        "-c",
        "out.c",
        "-o",
        "out.o",
    ];
    let output = Command::new(compiler).args(strict).current_dir(folder).output().ok()?;
    assert!(output.status.success(), "{compiler}: {}", text(&output.stderr));
    let output = Command::new("nm").args(["-P", "out.o"]).current_dir(folder).output().ok()?;
    Some(text(&output.stdout)).filter(|listed| listed.contains("out_step"))
}

/// A name with `*\` once ended the comment that it stood in, and what followed was compiled.
#[test]
fn a_part_s_name_adds_nothing_to_its_c_files() {
    let compile = |name: &OsStr| {
        let folder = with_part(name);
        let arguments = ["compile", "--format", "I4F28", "--language", "c", "--out", "out"];
        let output = feedbits(folder.path(), &arguments, name);
        assert_eq!(output.status.code(), Some(0), "{name:?}: {}", text(&output.stderr));
        let code = ["out.h", "out.c"].map(|file| {
            let text = read(folder.path(), file);
            let (first, rest) = text.split_once('\n').expect("lines");
            assert!(first.starts_with("/* Part: ") && first.is_ascii(), "{name:?}: {first}");
            rest.to_string()
        });
        let symbols = ["gcc", "clang"].map(|compiler| symbols(folder.path(), compiler));
        (code, symbols)
    };
    let plain = compile(OsStr::new("part.toml"));
    let must = std::env::var_os("FEEDBITS_C_COMPILER").is_some();
    assert!(
        !must || plain.1.iter().any(Option::is_some),
        "no C compiler is found, and FEEDBITS_C_COMPILER asks for one"
    );
    for name in names() {
        assert_eq!(compile(&name), plain, "{name:?}");
    }
}

/// Constants of Rust begin with one line of comment that names the part.
#[test]
fn a_part_s_name_is_one_line_of_its_constants() {
    let compile = |name: &OsStr| {
        let folder = with_part(name);
        let output = feedbits(folder.path(), &["compile", "--format", "I4F28", "--out", "out.rs"], name);
        assert_eq!(output.status.code(), Some(0), "{name:?}: {}", text(&output.stderr));
        let text = read(folder.path(), "out.rs");
        let (first, rest) = text.split_once('\n').expect("lines");
        assert!(first.starts_with("// ") && first.is_ascii(), "{name:?}: {first}");
        rest.to_string()
    };
    let plain = compile(OsStr::new("part.toml"));
    for name in names() {
        assert_eq!(compile(&name), plain, "{name:?}");
    }
}

/// Programs, curve files and tables of numbers do not name the part: whatever its name, they are the same.
#[test]
fn programs_and_tables_of_numbers_name_no_part() {
    let commands: [&[&str]; 6] = [
        &["convert", "--to", "g06.2"],
        &["convert", "--to", "g1"],
        &["convert", "--to", "toml"],
        &["interpolate", "--format", "I4F28"],
        &["plan"],
        &["compile", "--format", "I4F28", "--stream"],
    ];
    let written = |name: &OsStr| {
        let folder = with_part(name);
        commands.map(|command| {
            let output = feedbits(folder.path(), &[command, &["--out", "out"]].concat(), name);
            assert_eq!(output.status.code(), Some(0), "{name:?}: {}", text(&output.stderr));
            fs::read(folder.path().join("out")).expect("a file")
        })
    };
    let plain = written(OsStr::new("part.toml"));
    for name in names() {
        assert_eq!(written(&name), plain, "{name:?}");
    }
    assert!(!text(&plain[1]).contains(['(', ';']), "a program without comments");
}

/// JSON holds any name: it reads back as it was, but for bytes that are no text.
#[test]
fn json_gives_a_name_back() {
    for name in names() {
        let folder = with_part(&name);
        for command in [&["check", "--json"][..], &["compare", "--json", "--formats", "f64"]] {
            for to_file in [false, true] {
                let out: &[&str] = if to_file { &["--out", "out.json"] } else { &[] };
                let output = feedbits(folder.path(), &[command, out].concat(), &name);
                let json = if to_file { read(folder.path(), "out.json") } else { text(&output.stdout) };
                let value: Value = serde_json::from_str(&json)
                    .unwrap_or_else(|error| panic!("{name:?}: {error}: {json:.200}"));
                let part = value["part"].as_str().or(value["part"]["name"].as_str());
                assert_eq!(part, Some(lossy(&name).as_str()), "{command:?}");
            }
        }
    }
}

/// What a terminal acts on is not printed, be it in a name, in a part or in a target.
#[test]
fn a_name_moves_no_cursor() {
    let acts = |text: &str| {
        text.chars()
            .find(|c| (c.is_control() && *c != '\n') || "\u{202e}\u{2066}\u{200f}\u{2028}".contains(*c))
    };
    let demand_plain = |output: &Output, what: &dyn std::fmt::Debug| {
        for stream in [&output.stdout, &output.stderr] {
            assert_eq!(acts(&text(stream)), None, "{what:?}: {}", text(stream));
        }
    };
    let commands: [&[&str]; 6] = [
        &["check"],
        &["plan"],
        &["compare", "--formats", "f64"],
        &["compare", "--formats", "f64", "--wide"],
        &["interpolate", "--format", "I4F4"],
        &["servo", "--formats", "f64"],
    ];
    for name in names() {
        let folder = with_part(&name);
        for command in commands {
            demand_plain(&feedbits(folder.path(), command, &name), &(command, &name));
        }
        fs::write(
            folder.path().join(&name),
            format!("G0 X0 Y0\nG1 X1 F60 !{}\u{1b}[2J\u{202e}\n", lossy(&name)),
        )
        .expect("a part");
        let refused = feedbits(folder.path(), &["check"], &name);
        assert_eq!(refused.status.code(), Some(2), "{name:?}");
        demand_plain(&refused, &name);
        demand_plain(
            &feedbits(folder.path(), &["check"], OsStr::new(&format!("none{}", lossy(&name)))),
            &name,
        );
    }
    let folder = with_part(OsStr::new("p.toml"));
    let target =
        TARGET.replace("title = \"", "title = \"\\u001b[2J\\u202e").replace("TI SPRS945", "\\u001b[2J");
    fs::write(folder.path().join("t.toml"), target).expect("a target");
    for command in
        [&["targets", "--target-file", "t.toml"][..], &["targets", "--target-file", "t.toml", "--wide"]]
    {
        let run = Command::new(env!("CARGO_BIN_EXE_feedbits"))
            .args(command)
            .arg("c28x")
            .current_dir(folder.path())
            .output();
        let output = run.expect("the program starts");
        assert_eq!(output.status.code(), Some(0), "{}", text(&output.stderr));
        demand_plain(&output, &command);
    }
}

/// A target with `/` in its name once led to half a report.
#[test]
fn a_target_s_name_is_refused_if_it_is_no_name_of_a_file() {
    let folder = with_part(OsStr::new("p.toml"));
    let long = "a".repeat(65);
    for name in ["a/b", "../x", "..", ".x", "-x", "a b", "", "a\\\\b", "C:x", "a,b", "ä", "a\\u0000", &long]
    {
        let target = TARGET.replacen("name = \"c28x\"", &format!("name = \"{name}\""), 1);
        assert_ne!(target, TARGET);
        fs::write(folder.path().join("t.toml"), target).expect("a target");
        for command in [
            &["compare", "--formats", "f64", "--report", "r"][..],
            &["sweep", "--formats", "f64", "--report", "r"],
        ] {
            let output = feedbits(
                folder.path(),
                &[command, &["--target-file", "t.toml"]].concat(),
                OsStr::new("p.toml"),
            );
            let said = text(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ");
            assert_eq!(output.status.code(), Some(2), "{name}: {said}");
            assert!(
                said.contains("t.toml:2: name = ") && said.contains("expected letters and digits"),
                "{said}"
            );
            assert_eq!(files(folder.path()), ["p.toml", "t.toml"], "nothing is written");
        }
    }
    fs::write(folder.path().join("t.toml"), TARGET.replacen("c28x", "One", 1)).expect("a target");
    fs::write(folder.path().join("u.toml"), TARGET.replacen("c28x", "one", 1)).expect("a target");
    let arguments = [
        "compare",
        "--formats",
        "f64",
        "--target-file",
        "t.toml",
        "--target-file",
        "u.toml",
        "--report",
        "r",
    ];
    let output = feedbits(folder.path(), &arguments, OsStr::new("p.toml"));
    assert_eq!(output.status.code(), Some(2), "{}", text(&output.stderr));
    assert!(text(&output.stderr).contains("u.toml: name = \"one\""), "{}", text(&output.stderr));
    assert!(!folder.path().join("r").exists());
}

/// The text of a page's element as a browser shows it.
fn shown(page: &str, begin: &str, end: &str) -> String {
    let rest = page.split_once(begin).expect("the element begins").1;
    let text = rest.split_once(end).expect("the element ends").0;
    let marks = [("&#60;", "<"), ("&#62;", ">"), ("&#34;", "\""), ("&#39;", "'"), ("&#38;", "&")];
    marks.iter().fold(text.to_string(), |text, (escaped, mark)| text.replace(escaped, mark))
}

/// The page names the part in words alone, and its command is one that a shell reads as it was given.
#[test]
fn a_report_names_its_part_and_its_command_in_words() {
    for name in NAMES.into_iter().filter(|name| !name.ends_with('/')) {
        let folder = with_part(OsStr::new(name));
        let arguments = ["compare", "--formats", "f64", "--evaluate", "pieces", "--report", "r"];
        let output = feedbits(folder.path(), &arguments, OsStr::new(name));
        assert_eq!(output.status.code(), Some(0), "{name:?}: {}", text(&output.stderr));
        let page = read(&folder.path().join("r"), "index.html");
        assert_eq!(page.matches("<script").count(), 1, "{name:?}");
        assert_eq!(shown(&page, "<h1>", "</h1>"), foreign_text::in_lines(name));
        let command = shown(&page, "Made by <code>", "</code>");
        let words = shlex::split(&command).unwrap_or_else(|| panic!("{command}"));
        let given: Vec<_> =
            ["feedbits"].iter().chain(&arguments).chain(&["--"]).map(ToString::to_string).collect();
        assert_eq!(words[..words.len() - 1], given, "{command}");
        if foreign_text::in_lines(name) == name {
            assert_eq!(words.last().map(String::as_str), Some(name), "{command}");
        }
    }
}

/// A sweep's file names runs, which become names of pictures: in the folder of the report, and nowhere else.
#[test]
fn a_run_s_name_in_a_sweep_s_file_is_no_path() {
    let folder = with_part(OsStr::new("p.toml"));
    let swept = feedbits(
        folder.path(),
        &["sweep", "--formats", "f64,f32", "--evaluate", "pieces", "--out", "s.jsonl"],
        OsStr::new("p.toml"),
    );
    assert_eq!(swept.status.code(), Some(0), "{}", text(&swept.stderr));
    let whole = read(folder.path(), "s.jsonl");
    let merged = |run: &str| {
        let header = whole.replacen("\"f32 pieces\"", &serde_json::to_string(run).expect("JSON"), 1);
        assert_ne!(header, whole);
        fs::write(folder.path().join("t.jsonl"), sealed(&header)).expect("a file");
        let _ = fs::remove_dir_all(folder.path().join("r"));
        let others = || {
            files(folder.path())
                .into_iter()
                .filter(|name| name != "r" && name != "u.jsonl")
                .collect::<Vec<_>>()
        };
        let before = others();
        let output =
            feedbits(folder.path(), &["merge", "--out", "u.jsonl", "--report", "r"], OsStr::new("t.jsonl"));
        assert_eq!(others(), before, "{run:?}");
        output
    };
    for run in NAMES.into_iter().chain(["../../x", "/x"]) {
        let output = merged(run);
        if run.len() > 64 {
            assert_eq!(output.status.code(), Some(2), "{run:?}");
            continue;
        }
        assert_eq!(output.status.code(), Some(0), "{run:?}: {}", text(&output.stderr));
        let names = files(&folder.path().join("r"));
        assert_eq!(names.len(), 7, "a page, two pictures and two tables of two files: {names:?}");
    }
    let twice = merged("f64?pieces");
    assert_eq!(twice.status.code(), Some(2));
    assert!(text(&twice.stderr).contains("t.jsonl, line 1: expected runs"), "{}", text(&twice.stderr));
}

/// The words of options are text. One that is none is refused with its option, whatever other words are none.
#[test]
fn a_word_that_is_no_text_is_refused_with_its_option() {
    let name = OsString::from_vec(b"part-\xff".to_vec());
    let folder = with_part(&name);
    for option in ["--units", "--feed", "--start", "--formats"] {
        let mut command = Command::new(env!("CARGO_BIN_EXE_feedbits"));
        command
            .arg("sweep")
            .arg(&name)
            .arg(option)
            .arg(OsStr::from_bytes(b"\xff"))
            .current_dir(folder.path());
        let refused = command.output().expect("the program starts");
        let said = text(&refused.stderr);
        assert_eq!(refused.status.code(), Some(2), "{said}");
        assert!(said.contains(&format!("{option} \"")) && said.contains("UTF-8"), "{said}");
    }
}
