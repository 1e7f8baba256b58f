//! Every number that a person can write has a domain, and no number makes work or memory without a bound.

use std::fs;
use std::path::PathBuf;
use std::process::{Command, Output};
use std::time::{Duration, Instant};

use domains::{Key, TABLES, Value, markdown};

/// A folder with files of this test.
struct Folder(tempfile::TempDir);

impl Folder {
    fn new() -> Self {
        Self(tempfile::tempdir().expect("a temporary folder"))
    }

    fn file(&self, name: &str, text: &str) -> String {
        let path = self.0.path().join(name);
        fs::write(&path, text).expect("the folder is writable");
        path.display().to_string()
    }
}

fn feedbits(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_feedbits")).args(arguments).output().expect("feedbits starts")
}

/// What was said, without the folds of the screen.
fn said(output: &Output) -> String {
    String::from_utf8_lossy(&output.stderr).split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Words as they stand in what was said.
fn words(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}

/// Refused, in at most 2,000 bytes, with these words.
fn assert_refused(output: &Output, expected: &str, about: &str) {
    let message = said(output);
    assert_eq!(output.status.code(), Some(2), "{about}: {message}");
    assert!(message.contains(&words(expected)), "{about}: {expected} in {message}");
    assert!(output.stderr.len() <= 2000, "{about}: {} bytes", output.stderr.len());
}

/// Numbers just inside and just outside of what may be written.
fn ends(key: &Key) -> (Vec<f64>, Vec<f64>) {
    match key.value {
        Value::Number(domain) => {
            let (inside, outside) = domain.ends();
            (inside.to_vec(), outside.to_vec())
        }
        Value::Whole(least, most, _) => {
            let (least, most) = (f64::from(least), f64::from(most));
            (vec![least, most], vec![least - 1.0, most + 1.0])
        }
        Value::Word(_) | Value::Truth | Value::Text | Value::Keys => (Vec::new(), Vec::new()),
    }
}

/// A number as a file has it: whole numbers without a fraction.
fn written(key: &Key, number: f64) -> String {
    match key.value {
        Value::Whole(..) => format!("{number}"),
        _ => format!("{number:e}"),
    }
}

const MACHINE: &str = "[machine]\ninterpolation_period_ms = 1\nfeedrate_mm_per_s = 50\nacceleration_mm_per_s2 = 1000\n\
                       jerk_mm_per_s3 = 40000\n";
const PART: &str = "G21 G90\nG0 X0 Y0 F600\nG1 X1\nM2\n";

/// A machine file in which this key has this value, and the line of the key.
fn machine_with(table: &str, name: &str, value: &str) -> (String, usize) {
    let mut text = MACHINE.to_string();
    let line = format!("{name} = {value}\n");
    let old = text.lines().find(|old| old.starts_with(&format!("{name} ="))).map(|old| format!("{old}\n"));
    match old.filter(|_| table == "machine") {
        Some(old) => text = text.replace(&old, &line),
        None if table == "machine" => text += &line,
        None => text += &format!("[machine.axes.{table}]\n{line}"),
    }
    if name == "junction_deviation_mm" {
        text = text.replacen("[machine]\n", "[machine]\njunction = \"deviation\"\n", 1);
    }
    if name == "velocity_jump_mm_per_s" {
        text = text.replacen("[machine]\n", "[machine]\njunction = \"velocity-jump\"\n", 1);
    }
    let place = text.lines().position(|one| one.starts_with(name) && one.ends_with(value)).expect("the line");
    (text, place + 1)
}

#[test]
fn each_end_of_each_key_of_a_machine_is_where_the_table_says() {
    let folder = Folder::new();
    let part = folder.file("part.nc", PART);
    let tables = [
        ("machine", &domains::machine::KEYS[..]),
        ("x", &domains::machine::AXIS_KEYS[..]),
        ("a", &domains::machine::ROTARY_KEYS[..]),
    ];
    let keys = tables.iter().flat_map(|(table, keys)| keys.iter().map(move |key| (*table, key)));
    for (table, key) in keys {
        let (inside, outside) = ends(key);
        for number in inside {
            let (text, _) = machine_with(table, key.name, &written(key, number));
            let output = feedbits(&["check", &part, "--machine", &folder.file("m.toml", &text)]);
            assert!(output.status.code() < Some(2), "{} = {number}: {}", key.name, said(&output));
        }
        for number in outside.into_iter().chain([0.0, -1.0, 5e-324, 1e-320, 1e300, f64::NAN, f64::INFINITY]) {
            if key.holds(number) || matches!(key.value, Value::Word(_) | Value::Truth | Value::Keys) {
                continue;
            }
            let value = written(key, number).to_lowercase();
            let (text, line) = machine_with(table, key.name, &value);
            let output = feedbits(&["check", &part, "--machine", &folder.file("m.toml", &text)]);
            let about = format!("{} = {value}", key.name);
            assert_refused(&output, &format!("m.toml:{line}:"), &about);
            assert_refused(&output, &format!("`{}`", key.name), &about);
            assert_refused(&output, &format!("expected: {}", key.expected()), &about);
        }
    }
}

#[test]
fn each_end_of_each_key_of_a_servo_is_where_the_table_says() {
    let folder = Folder::new();
    let good = [("position_gain_per_s", "30"), ("velocity_lag_ms", "1")];
    for key in &domains::servo::KEYS {
        let text = |value: &str| {
            let lines = good
                .iter()
                .filter(|(name, _)| *name != key.name)
                .map(|(name, value)| format!("{name} = {value}\n"));
            format!("[servo]\n{}{} = {value}\n", lines.collect::<String>(), key.name)
        };
        let (inside, outside) = ends(key);
        for number in outside {
            let text = text(&written(key, number));
            let output = feedbits(&["servo", "--paper-table", "--servo", &folder.file("s.toml", &text)]);
            if matches!(key.value, Value::Whole(..)) && number < 0.0 {
                continue;
            }
            let line = text.lines().count();
            assert_refused(&output, &format!("s.toml: line {line}: {} = ", key.name), key.name);
            assert_refused(&output, &format!("expected {}", key.expected()), key.name);
        }
        for number in inside {
            // Such a drive may be refused for other reasons: it is not stable, or friction holds it.
            let text = text(&written(key, number));
            let output = feedbits(&["servo", "--paper-table", "--servo", &folder.file("s.toml", &text)]);
            let refusal = words(&format!("expected {}", key.expected()));
            assert!(!said(&output).contains(&refusal), "{} = {number}: {}", key.name, said(&output));
        }
    }
}

/// The commands that have an option, each with what else it must be given.
fn commands(option: &str) -> Vec<Vec<&'static str>> {
    let run = [vec!["compare"], vec!["interpolate"], vec!["size"], vec!["servo"], vec!["sweep"]];
    match option {
        "--piece-length" | "--fluctuation" | "--solver-tolerance" => run.to_vec(),
        "--start-feed" | "--end-feed" | "--window" => [&run[..4], &[vec!["plan"]]].concat(),
        "--oversample" => vec![vec!["plan", "--out", "o.csv"]],
        "--reserve" => vec![
            vec!["interpolate", "--override", "0:100"],
            vec!["compile", "--format", "f32", "--feed-override", "100"],
        ],
        "--feed-override" | "--flash" => vec![vec!["compile", "--format", "f32"]],
        "--buffer" => vec![vec!["compile", "--format", "f32", "--stream", "--out", "o"]],
        "--period" | "sweep --feed" | "--scale" | "--points" | "--most-periods" | "--shard" => {
            vec![vec!["sweep"]]
        }
        "--circle" | "servo --feed" => vec![vec!["servo"]],
        "smooth --tolerance" => vec![vec!["smooth"]],
        "--lambda" => vec![vec!["smooth", "--tolerance", "0.1"]],
        "--fit" => vec![vec!["convert"]],
        "--corner" => vec![vec!["convert", "--fit", "0.1"]],
        "convert --tolerance" => vec![vec!["convert", "--to", "g1"]],
        "--digits" | "--ratios" => vec![vec!["convert", "--to", "g06.2"]],
        "--worse-by" => vec![vec!["compare", "--baseline", "b.json"], vec!["size", "--baseline", "b.json"]],
        "--multipliers" | "--dividers" | "--clock" => vec![vec!["compare"], vec!["size"], vec!["sweep"]],
        "--start" => vec![vec!["check"], vec!["convert", "--to", "g1"]],
        "--override S" | "--override PERCENT" => vec![vec!["interpolate"]],
        "judge --period" | "--resolution" => vec![vec!["judge", "--machine", "router"]],
        "judge --tolerance" => vec![vec!["judge", "--machine", "router", "--part", "no-such-part.nc"]],
        _ => Vec::new(),
    }
}

/// The option with this number in it.
fn argument(option: &str, number: &str) -> String {
    match option {
        "--override S" => format!("--override={number}:100"),
        "--override PERCENT" => format!("--override=0:{number},1:100"),
        "--start" => format!("--start=0,0,{number}"),
        "--shard" => format!("--shard={number}/{number}"),
        _ => format!("--{}={number}", option.split_once("--").expect("an option").1),
    }
}

#[test]
fn each_end_of_each_option_is_where_the_table_says() {
    for key in &domains::options::KEYS {
        let (inside, mut outside) = ends(key);
        let commands = commands(key.name);
        assert!(!commands.is_empty(), "{}: no command", key.name);
        if !matches!(key.value, Value::Whole(..)) {
            outside.extend([f64::NAN, f64::INFINITY]);
        }
        for command in &commands {
            for number in &outside {
                let option = argument(key.name, &written(key, *number));
                let output = feedbits(&[&command[..], &["no-such-part.nc", &option]].concat());
                let about = format!("{command:?} {option}");
                let name = option.split('=').next().expect("a name").to_string();
                assert_refused(&output, &name, &about);
                let expected = match key.name {
                    "--shard" => "expected I/N".into(),
                    "--ratios" => "expected the largest knot that a control takes".into(),
                    name if name.starts_with("--period") || name.ends_with("--feed") || name == "--scale" => {
                        if key.unit() == "mm/min" || *number > 0.0 && number.is_finite() {
                            format!("expected {}", key.expected())
                        } else {
                            "expected a positive number".into()
                        }
                    }
                    _ => key.expected(),
                };
                assert_refused(&output, &expected, &about);
            }
            for number in inside.iter().filter(|_| key.name != "--ratios") {
                let option = argument(key.name, &written(key, *number));
                let output = feedbits(&[&command[..], &["no-such-part.nc", &option]].concat());
                let message = said(&output);
                assert!(!message.contains("invalid value"), "{command:?} {option}: {message}");
            }
        }
    }
}

/// No option takes a number without its domain in the help, and so in the table.
#[test]
fn every_option_that_takes_a_number_says_its_domain() {
    const NUMBERS: [&str; 15] = [
        "<MM>",
        "<N>",
        "<RATIO>",
        "<PERCENT>",
        "<MM_PER_S>",
        "<MM_PER_MIN>",
        "<BYTES>",
        "<DEGREES>",
        "<LAMBDA>",
        "<LARGEST>",
        "<I/N>",
        "<LO..HI>",
        "<X,Y,Z>",
        "<POINTS>",
        "<OVERSAMPLE>",
    ];
    let commands = [
        "compare",
        "interpolate",
        "compile",
        "plan",
        "size",
        "sweep",
        "merge",
        "servo",
        "papers",
        "smooth",
        "targets",
        "check",
        "convert",
        "machine",
        "formats",
    ];
    let mut found = 0;
    for command in commands {
        let help = String::from_utf8(feedbits(&[command, "--help"]).stdout).expect("text");
        // An option begins with its dashes, and what it means is indented further.
        let mut options: Vec<String> = Vec::new();
        for line in help.lines() {
            let text = line.trim_start();
            if text.starts_with('-') && line.len() - text.len() <= 6 {
                options.push(String::new());
            }
            if let Some(option) = options.last_mut() {
                option.push_str(&words(text));
                option.push(' ');
            }
        }
        for option in options {
            if NUMBERS.iter().any(|name| option.split(' ').any(|word| word == *name)) {
                assert!(option.contains(" to ") && option.contains('['), "{command}: {option}");
                found += 1;
            }
        }
    }
    assert!(found > 40, "{found}");
}

#[test]
fn the_tables_of_the_book_are_those_of_the_program() {
    let printed = String::from_utf8(feedbits(&["machine", "--keys"]).stdout).expect("text");
    let page = |name: &str| {
        let path = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../docs").join(name);
        fs::read_to_string(path).expect("a page")
    };
    for table in &TABLES {
        assert!(printed.contains(&markdown(table)), "{}", table.title);
    }
    for (name, titles) in [
        ("machine-file.md", &["`[machine]`", "`[machine.axes.x]`", "`[machine.axes.a]`"][..]),
        ("servo.md", &["`[servo]`"]),
        ("programs.md", &["`[curve]`", "words of a part program"]),
        ("period-cost.md", &["a target file"]),
    ] {
        for title in titles {
            let table = TABLES.iter().find(|table| table.title == *title).expect("a table");
            assert!(
                page(name).contains(&markdown(table)),
                "docs/{name} differs from `feedbits machine --keys`: {title}\n{}",
                markdown(table)
            );
        }
    }
}

/// Runs feedbits with at most so many KiB of memory of its own, and expects an end within seconds.
fn within(kib: usize, arguments: &[&str]) -> Output {
    let begin = Instant::now();
    let script = format!("ulimit -d {kib}; exec \"$@\"");
    let all = [&["-c", &script, "sh", env!("CARGO_BIN_EXE_feedbits")], arguments].concat();
    let output = Command::new("sh").args(all).output().expect("a shell");
    let taken = begin.elapsed();
    assert!(taken < Duration::from_secs(60), "{arguments:?}: {taken:?}");
    output
}

/// What took gigabytes, or ran on without an end.
#[test]
fn what_a_number_or_a_file_costs_is_bounded() {
    let folder = Folder::new();
    let slow = folder.file("slow.toml", &format!("{MACHINE}centripetal_acceleration_mm_per_s2 = 1e-9\n"));
    let servo = folder.file("servo.toml", "[servo]\nposition_gain_per_s = 30\nvelocity_lag_ms = 1e9\n");
    let slow_servo = folder.file(
        "slow-servo.toml",
        "[servo]\nposition_gain_per_s = 0.05\nvelocity_lag_ms = 1e4\nsub_steps = 10000\n",
    );
    for (arguments, expected) in [
        (vec!["plan", "--machine", &slow], "centripetal_acceleration_mm_per_s2"),
        (vec!["compare", "--piece-length", "1e-300"], "--piece-length"),
        (vec!["compare", "--piece-length", "0.001"], "--piece-length 0.001: the path takes"),
        (vec!["plan", "--window", "0.01", "--machine", "router-8bit", "no.nc"], "no.nc"),
        (vec!["interpolate", "--override", "0:1e-9"], "--override"),
        (vec!["interpolate", "--override", "0:0,1e300:100"], "--override"),
        (vec!["servo", "--servo", &servo], "velocity_lag_ms = 1000000000"),
        (vec!["servo", "--servo", &slow_servo], "`sub_steps`"),
        (vec!["servo", "--paper-table", "--servo", &slow_servo], "`sub_steps`"),
        (vec!["compare", "--baseline", "/dev/zero"], "/dev/zero begins with 512 bytes of 0"),
        (vec!["check", "/dev/zero"], "/dev/zero begins with 512 bytes of 0"),
        (vec!["servo", "--servo", "/dev/zero"], "/dev/zero"),
        (vec!["compare", "--target-file", "/dev/zero"], "/dev/zero"),
        (vec!["compare", "--machine", "/dev/zero"], "/dev/zero"),
        (vec!["merge", "/dev/zero", "--out", "o"], "line"),
    ] {
        let output = within(200_000, &arguments);
        assert_refused(&output, expected, &format!("{arguments:?}"));
    }
}

/// `check` takes 64 MB and twelve times its input.
#[test]
fn what_a_text_costs_is_bounded() {
    let folder = Folder::new();
    let repeated = |head: &str, each: &str, tail: &str, bytes: usize| {
        format!("{head}{}{tail}", each.repeat(bytes / each.len()))
    };
    const LENGTH: usize = 4 << 20;
    let curve =
        "[[curve]]\ndegree = 1\ncontrol_points_mm = [[0.125, 0.25], [1.5, 1.75]]\nknots = [0, 0, 1, 1]\n";
    let one = |key: &str, each: &str| {
        let other =
            if key == "knots" { "control_points_mm = [[0, 0], [1, 1]]" } else { "knots = [0, 0, 1, 1]" };
        repeated(&format!("[curve]\ndegree = 1\n{other}\n{key} = ["), each, "]\n", LENGTH)
    };
    let insert = "0\nSECTION\n2\nHEADER\n9\n$INSUNITS\n70\n4\n0\nENDSEC\n0\nSECTION\n2\nBLOCKS\n0\nBLOCK\n2\nA\n10\n0\n20\n0\n0\nLINE\n\
                  10\n0\n20\n0\n11\n1\n21\n1\n0\nENDBLK\n0\nENDSEC\n0\nSECTION\n2\nENTITIES\n0\nINSERT\n2\nA\n10\n0\n20\n0\n70\n9999\n71\n\
                  9999\n44\n2\n45\n2\n0\nENDSEC\n0\nEOF\n";
    let turns = format!("G21 G90 F100\nG0 X0 Y0 Z0\n{}", "G2 X0 Y0 Z1 I10 J0 P10000\n".repeat(100));
    let json = "{\"shape\":{\"type\":\"curve\",\"data\":[],\"x\":[1";
    let points = "{\"shape\":{\"type\":\"curve\",\"data\":[{\"degree\":3,\"control_points\":{\"points\":[[0]";
    for (name, text) in [
        ("brackets.toml", repeated("[[1", ",1", "", LENGTH)),
        ("unclosed.toml", repeated("", "[", "", LENGTH)),
        ("equals.toml", repeated("[curve]\n", "=\n", "", LENGTH)),
        ("words.toml", repeated("[curve]\n", "a\n", "", LENGTH)),
        ("keys.toml", repeated("x = [1", ",1", "]\n[curve]\n", LENGTH)),
        ("curves.toml", repeated("", curve, "", LENGTH)),
        ("knots.toml", one("knots", "0,")),
        ("points.toml", one("control_points_mm", "[0,1],")),
        ("values.json", repeated(json, ",1", "]}}", LENGTH)),
        ("points.json", repeated(points, ",[0]", "]}}]}}", LENGTH)),
        ("deep.json", repeated("{\"x\":", "[", "", LENGTH)),
        ("moves.nc", repeated("G21 G90 F600\nG0 X0 Y0\n", "G1 X10 Y0\nG1 X0 Y10\n", "", LENGTH)),
        ("short.nc", repeated("G21 G90 F600\nG0 X0 Y0\nG1\n", "X1\nX0\n", "", LENGTH)),
        ("faults.nc", repeated("", "G1 X1 Q7 XX\n", "", LENGTH)),
        ("lines.nc", repeated("", "\n", "", LENGTH)),
        ("insert.dxf", insert.into()),
        ("turns.ngc", turns),
    ] {
        let file = folder.file(name, &text);
        // In KiB, and without the program itself.
        let most = (64_000 + 12 * text.len() / 1000) * 1000 / 1024;
        let output = within(most, &["check", &file]);
        let message = said(&output);
        assert!(matches!(output.status.code(), Some(0..=2)), "{name}: {:?} {message:.300}", output.status);
        assert!(!message.contains("memory allocation"), "{name}: {message:.300}");
    }
}

/// A length that was printed as NaN: derivatives over the first span are infinite.
#[test]
fn knots_that_are_next_to_equal_are_refused_at_their_place() {
    let folder = Folder::new();
    let points = "[[150, 150], [0, 0], [0, 300], [150, 150], [300, 0], [300, 300], [150, 150]]";
    let curve = |knots: &str| format!("[curve]\ndegree = 3\ncontrol_points_mm = {points}\nknots = {knots}\n");
    for (knots, place) in [
        ("[0,0,0,0,5e-324,1e-323,0.75,1,1,1,1]", "c.toml:4:18"),
        ("[0,0,0,0,0.25,0.5,0.75,1e-320,1,1,1]", "c.toml:4:32"),
        ("[0,0,0,0,1e-320,2e-320,3e-320,1e-319,1e-319,1e-319,1e-319]", "c.toml:4:9"),
    ] {
        let output = feedbits(&["check", &folder.file("c.toml", &curve(knots))]);
        assert_refused(&output, place, knots);
        assert!(output.stdout.is_empty(), "{knots}");
    }
    let neighbours = curve("[0,0,0,0,0.5,0.5000000000000001,0.75,1,1,1,1]");
    let output = feedbits(&["check", &folder.file("c.toml", &neighbours)]);
    assert!(output.status.code() < Some(2), "{}", said(&output));
    let length = String::from_utf8_lossy(&output.stdout).into_owned();
    assert!(length.contains(" mm at feed") && !length.contains("NaN"), "{length}");
}

/// A number of a million digits, a word and a key of a megabyte, a name as long as a name may be.
#[test]
fn no_message_is_above_2000_bytes() {
    let folder = Folder::new();
    let (digits, letters) = ("1".repeat(1_000_000), "x".repeat(1_000_000));
    let long = format!("{}.toml", "n".repeat(240));
    for (name, text) in [
        ("number.nc", format!("G1 X{digits}\n")),
        ("word.nc", format!("G1 X1 {letters}\n")),
        ("name.nc", format!("#<{letters}> = 1\nG1 X#<{letters}y>\n")),
        ("label.nc", format!("o<{letters}> call\n")),
        ("canon.txt", format!("N1 {letters}(1)\nSTRAIGHT_FEED(1, 2, 3, 0, 0, 0)\n")),
        ("number.toml", format!("[curve]\ndegree = {digits}\n")),
        ("key.toml", format!("[curve]\n{letters} = 1\n")),
        ("text.toml", format!("[curve]\nshape = \"{letters}\"\n")),
        (
            "knot.toml",
            "[curve]\ndegree = 1\ncontrol_points_mm = [[1e300, 0], [1, 1]]\nknots = [0, 0, 5e-324, 1]\n"
                .into(),
        ),
        ("key.json", format!("{{\"{letters}\": 1}}")),
        ("number.json", format!("{{\"shape\": {digits}}}")),
        ("layer.dxf", format!("0\nSECTION\n2\nENTITIES\n0\nLINE\n10\n{letters}\n20\n0\n0\nENDSEC\n0\nEOF\n")),
        (&long, "[curve]\ndegree = 0\n".into()),
    ] {
        let file = folder.file(name, &text);
        let output = feedbits(&["check", &file]);
        assert_eq!(output.status.code(), Some(2), "{name}: {:.300}", said(&output));
        assert!(output.stderr.len() <= 2000, "{name}: {} bytes: {:.300}", output.stderr.len(), said(&output));
    }
    for (name, text) in [
        ("machine.toml", format!("{MACHINE}chord_error_mm = {digits}\n")),
        ("machine.toml", format!("{MACHINE}{letters} = 1\n")),
        ("machine.toml", format!("{MACHINE}chord_error_mm = 1e300\n")),
    ] {
        let file = folder.file(name, &text);
        let output = feedbits(&["plan", "--machine", &file]);
        assert_eq!(output.status.code(), Some(2), "{name}: {:.300}", said(&output));
        assert!(output.stderr.len() <= 2000, "{name}: {} bytes: {:.300}", output.stderr.len(), said(&output));
    }
}
