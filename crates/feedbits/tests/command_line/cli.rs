//! The command line, as a person or a script uses it.

use std::fs;

use crate::command::{data, feedbits, feedbits_in, folder, written};
use crate::message::{text, unfolded};

#[test]
fn without_arguments_the_built_in_example_is_compared() {
    let folder = folder();
    let output = feedbits_in(folder.path(), &[]);
    let table = text(&output.stdout);
    assert_eq!(output.status.code(), Some(0), "{table}{}", unfolded(&output.stderr));
    for expected in [
        "834.707 mm",
        "I16F16",
        "I8F24",
        "I32F32",
        "f32",
        "f64",
        "25 bits are enough: I2F23",
        "Recommended: I8F24",
    ] {
        assert!(table.contains(expected), "{expected} in\n{table}");
    }
    assert!(table.lines().all(|line| line.chars().count() <= 80), "{table}");
    assert!(
        !table.contains('\x1b') && !table.contains("raw"),
        "no styles in a pipe, and pieces alone\n{table}"
    );
}

#[test]
fn both_example_parts_compare_interpolate_and_plan() {
    let folder = folder();
    let machine = data("seed-000.toml");
    for part in ["seed-000.toml", "seed-003.nc"].map(data) {
        let compared =
            feedbits(&["compare", &part, "--machine", &machine, "--formats", "f32,f64,I4F28", "--json"]);
        assert_eq!(compared.status.code(), Some(0), "{}", unfolded(&compared.stderr));
        let json: serde_json::Value = serde_json::from_slice(&compared.stdout).expect("JSON");
        for key in ["part", "machine", "reference", "formats", "recommended"] {
            assert!(json.get(key).is_some(), "{key}");
        }
        let row = &json["formats"][0];
        for key in
            ["format", "bits", "fluctuation", "evaluations", "saturations", "integer_bits_needed", "verdict"]
        {
            assert!(row.get(key).is_some(), "{key} in {row}");
        }

        let setpoints = folder.path().join("s.csv").display().to_string();
        let run = feedbits(&[
            "interpolate",
            &part,
            "--machine",
            &machine,
            "--format",
            "I4F28",
            "--out",
            &setpoints,
        ]);
        assert_eq!(run.status.code(), Some(0), "{}", unfolded(&run.stderr));
        let csv = fs::read_to_string(&setpoints).expect("written");
        let mut lines = csv.lines();
        assert_eq!(
            lines.next(),
            Some("step,time_s,span,t,u,x_mm,y_mm,z_mm,feed_mm_per_s,chord_mm,fluctuation,evaluations")
        );
        let last: Vec<f64> =
            lines.last().expect("setpoints").split(',').map(|x| x.parse().expect("a number")).collect();
        assert_eq!((last.len(), last[4]), (12, 1.0), "the run ends at u = 1");

        let plan = folder.path().join("p.csv").display().to_string();
        let planned = feedbits(&["plan", &part, "--machine", &machine, "--out", &plan]);
        assert_eq!(planned.status.code(), Some(0), "{}", unfolded(&planned.stderr));
        let csv = fs::read_to_string(&plan).expect("written");
        let header =
            "time_s,distance_mm,u,feed_mm_per_s,acceleration_mm_per_s2,jerk_mm_per_s3,limit_mm_per_s";
        assert_eq!(csv.lines().next(), Some(header));
    }
}

/// Numbers are printed so that reading them back gives the same value: two runs give the same file.
#[test]
fn a_run_is_the_same_every_time() {
    let once = feedbits(&["interpolate", "--format", "I8F24"]).stdout;
    assert_eq!(once, feedbits(&["interpolate", "--format", "I8F24"]).stdout);
    assert!(once.len() > 100_000);
}

#[test]
fn the_fewest_bits_are_found() {
    let output = feedbits(&["size", "--json"]);
    assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    let bits = json["uniform"]["bits"].as_u64().expect("a width");
    assert!((22..=28).contains(&bits), "{bits}");
    assert!(json["mixed"]["bits"].as_u64() < json["mixed"]["uniform_bits"].as_u64());
    assert!(json["mixed"]["margin"].as_f64() >= Some(1.0));
}

#[test]
fn formats_are_listed_and_any_fixed_point_format_can_be_named() {
    let list = text(&feedbits(&["formats"]).stdout);
    assert!(list.contains("I16F16") && list.contains("f64"), "{list}");
    let made = feedbits(&["compare", "--formats", "I5F21", "--evaluate", "pieces"]);
    assert!(text(&made.stdout).contains("I5F21"), "{}", unfolded(&made.stderr));
}

/// "No format meets the requirements" once gave no reason if each format cuts a corner that the machine file allows to
/// be passed too fast.
#[test]
fn what_is_no_question_of_the_format_is_told_with_its_place_and_what_helps() {
    let folder = folder();
    let part = written(folder.path(), "corners.nc", "G0 X0 Y0\nG1 X10 F3000\nG1 X20\nG1 Y10\nG1 X30\n");
    let machine = "[machine]\ninterpolation_period_ms = 1\nfeedrate_mm_per_s = 50\nacceleration_mm_per_s2 = 1000\n\
                   jerk_mm_per_s3 = 40000\nchord_error_mm = 0.001\nfluctuation_limit = 1e-4\n\
                   parameter_tolerance = 1e-10\nmax_iterations = 8\njunction = \"velocity-jump\"\n\
                   [machine.axes.x]\nvelocity_jump_mm_per_s = 16\n[machine.axes.y]\nvelocity_jump_mm_per_s = 16\n";
    let machine = written(folder.path(), "m.toml", machine);
    let report = folder.path().join("r").display().to_string();
    let run = |more: &[&str]| {
        let output = feedbits(&[&[more[0], &part, "--machine", &machine][..], &more[1..]].concat());
        assert_eq!(output.status.code(), Some(1), "{}", unfolded(&output.stderr));
        text(&output.stdout)
    };
    let words = [
        "It is not a question of the format: f64 pieces fails too.",
        "corner error 3.59e-3 > 1.00e-3 mm of `chord_error_mm` in line 5, at X20.012 Y",
        "What helps: `junction = \"stop\"` in the machine file. The path then takes ",
    ];
    let formats = ["--formats", "I8F24"];
    for said in [run(&[&["compare", "--report", &report][..], &formats].concat()), run(&["size"])] {
        let said = unfolded(said.as_bytes());
        assert!(words.iter().all(|words| said.contains(words)), "{said}");
    }
    let page = fs::read_to_string(folder.path().join("r/index.html")).expect("a page");
    assert!(page.contains(words[0]) && page.contains("corner error 3.59e-3"), "the page says why");
    for found in [run(&[&["compare", "--json"][..], &formats].concat()), run(&["size", "--json"])] {
        let found: serde_json::Value = serde_json::from_str(&found).expect("JSON");
        let why = &found["not_a_question_of_format"];
        assert_eq!(
            (why["run"].as_str(), why["broken"][0]["at"]["line"].as_u64()),
            (Some("f64 pieces"), Some(5))
        );
        let helps = why["helps"].as_array().expect("a list");
        assert!(helps.iter().any(|one| one["change"].as_str().expect("words").contains("stop")), "{why}");
    }
}

/// At 1 mm/s and 0.25 ms a step is as short as the grid of a narrow format's positions. The parameter, an integer of 64
/// bits, is much finer.
#[test]
fn what_positions_are_rounded_by_is_told_and_judged() {
    let folder = folder();
    let part = written(folder.path(), "slow.nc", "G21 G90 G17\nG0 X0 Y0\nG3 X30 Y0 R15 F60\nG1 Y4\n");
    let machine = "[machine]\ninterpolation_period_ms = 0.25\nfeedrate_mm_per_s = 1\nacceleration_mm_per_s2 = 1000\n\
                   jerk_mm_per_s3 = 5000000\nchord_error_mm = 0.001\nfluctuation_limit = 1e-4\n\
                   parameter_tolerance = 1e-6\nmax_iterations = 5\n";
    let compared = |more: &str| {
        let machine = written(folder.path(), "m.toml", &format!("{machine}{more}"));
        let formats = ["--formats", "I3F17,I8F24", "--evaluate", "pieces", "--json"];
        let output = feedbits(&[&["compare", &part, "--machine", &machine][..], &formats].concat());
        let found: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let row = |index: usize| found["formats"][index].clone();
        [row(0), row(1)]
    };
    let figure = |row: &serde_json::Value, key: &str| row["fluctuation"][key].as_f64().expect("a figure");
    let [narrow, wide] = compared("");
    for row in [&narrow, &wide] {
        assert!(figure(row, "cruise_max_abs") < 1e-4, "{row}");
    }
    // A grid of 2⁻¹² mm against steps of 2⁻¹².
    assert!(figure(&narrow, "commanded_cruise_max_abs") > 0.5, "{narrow}");
    assert_eq!(narrow["verdict"]["result"], "bad", "{narrow}");
    assert_eq!(wide["verdict"]["result"], "good", "{wide}");
    let [_, wide_for_fine_drives] = compared("position_increment_mm = 1e-6\n");
    assert_eq!(wide_for_fine_drives["verdict"]["result"], "bad", "{wide_for_fine_drives}");

    let machine = written(folder.path(), "m.toml", machine);
    let out = folder.path().join("s.csv").display().to_string();
    feedbits(&["interpolate", &part, "--machine", &machine, "--format", "I8F24", "--out", &out]);
    let table = fs::read_to_string(&out).expect("setpoints");
    let columns: Vec<&str> = table.lines().next().expect("a header").split(',').collect();
    let column = |name: &str| columns.iter().position(|column| *column == name).expect(name);
    let [x, y, feed] = ["x_mm", "y_mm", "feed_mm_per_s"].map(column);
    let number = |line: &str, column: usize| {
        line.split(',').nth(column).and_then(|text| text.parse::<f64>().ok()).expect("a number")
    };
    let points: Vec<_> = table.lines().skip(1).map(|line| [x, y, feed].map(|of| number(line, of))).collect();
    // From one second on until one second before the end, the feed is constant.
    let cruise = &points[4000..points.len() - 4000];
    let off = cruise.windows(2).map(|pair| {
        let planned = pair[1][2] * 2.5e-4;
        (1.0 - (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]) / planned).abs()
    });
    let (largest, told) = (off.fold(0.0, f64::max), figure(&wide, "commanded_cruise_max_abs"));
    assert!((0.5..=1.000_001).contains(&(largest / told)), "{largest} of {told}");
}

/// Dropping the bits has an error of up to a unit to one side; rounding has one of up to half a unit to either side.
#[test]
fn a_format_that_drops_bits_is_coarser_than_one_that_rounds() {
    let at_cruise = |format: &str| {
        let output = feedbits(&["compare", "--formats", format, "--evaluate", "pieces", "--json"]);
        let found: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let row = &found["formats"][0];
        assert_eq!(row["format"], format);
        row["fluctuation"]["cruise_max_abs"].as_f64().expect("a figure")
    };
    let (rounded, dropped) = (at_cruise("I2F24"), at_cruise("I2F24-floor"));
    assert!(dropped > 1.2 * rounded && dropped < 8.0 * rounded, "{dropped} for {rounded}");
    // A run that never overflows never saturates.
    assert_eq!(at_cruise("I2F24-floor-sat"), dropped);
}

#[test]
fn bits_are_sized_for_a_way_of_rounding() {
    let sized = |arguments: &[&str]| {
        let output = feedbits(&[&["size", "--json"], arguments].concat());
        let found: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let register = found["mixed"]["signals"][0]["format"].as_str().expect("a register").to_string();
        let bits = |of: &str| found[of]["bits"].as_u64().expect("bits");
        (
            found["uniform"]["format"].as_str().expect("a format").to_string(),
            bits("uniform"),
            found["mixed"]["uniform_bits"].as_u64().expect("bits"),
            bits("mixed"),
            register,
        )
    };
    let (format, bits, most, all, _) = sized(&[]);
    assert!(!format.contains('-'), "{format}");
    let (dropping, more, most_dropping, all_dropping, register) =
        sized(&["--rounding", "floor", "--overflow", "saturate"]);
    assert!(dropping.ends_with("-floor-sat") && register.ends_with("-floor-sat"), "{dropping}, {register}");
    // The error is up to a unit to one side, in place of half a unit to either side: about one or two bits more.
    assert!((bits..=bits + 2).contains(&more), "{more} bits for {bits}");
    // Register by register a format of more bits may come out lower: each register is as short as the others leave it.
    assert!(
        all < most && all_dropping < most_dropping,
        "{all} of {most} bits, {all_dropping} of {most_dropping}"
    );
}

#[test]
fn a_requirement_that_no_format_meets_is_exit_status_1() {
    let output = feedbits(&["compare", "--formats", "I16F16"]);
    assert_eq!(output.status.code(), Some(1), "{}", text(&output.stdout));
}

/// `--fluctuation` once set only the fluctuation at which the solver stops; the verdict still used the machine file's.
#[test]
fn the_fluctuation_that_is_asked_for_is_the_one_that_is_judged() {
    let good = |more: &[&str]| {
        let arguments = ["compare", "--formats", "I4F28,f64", "--evaluate", "pieces", "--json"];
        let output = feedbits(&[&arguments[..], more].concat());
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        let rows = json["formats"].as_array().expect("rows").clone();
        let of =
            |row: &serde_json::Value| (row["verdict"]["result"] == "good", row["evaluations"]["max"].clone());
        (json["machine"]["fluctuation_limit"].clone(), rows.iter().map(of).collect::<Vec<_>>())
    };
    let (limit, rows) = good(&[]);
    assert!(limit == 1e-6 && rows.iter().all(|(good, _)| *good), "{rows:?}");
    let (limit, rows) = good(&["--fluctuation", "1e-9"]);
    assert_eq!((limit, rows[0].0, rows[1].0), (serde_json::json!(1e-9), false, true));
    let (limit, coarse) = good(&["--solver-tolerance", "1e-5"]);
    assert_eq!(limit, 1e-6);
    assert!(coarse.iter().all(|(good, evaluations)| *good && *evaluations == 1), "{coarse:?}");

    let bits = |asked: &str| {
        let output = feedbits(&["size", "--fluctuation", asked, "--json"]);
        let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
        json["uniform"]["bits"].as_u64().expect("bits")
    };
    let [fine, coarse] = ["1e-9", "1e-4"].map(bits);
    assert!(fine >= coarse + 8, "{fine} {coarse}");
}

#[test]
fn rapid_moves_alone_are_not_good() {
    let folder = folder();
    let part = written(folder.path(), "r.nc", "G0 X0 Y0\nX10 Y5\nX30\n");
    for command in ["compare", "size", "plan", "interpolate", "compile", "servo", "sweep", "smooth"] {
        let more: &[&str] = match command {
            "smooth" => &["--tolerance", "0.01"],
            "interpolate" | "compile" => &["--format", "f64"],
            _ => &[],
        };
        let words = [&[command, &part, "--machine", "router"], more].concat();
        let output = feedbits_in(folder.path(), &words);
        let said = unfolded(&output.stderr);
        assert_eq!(output.status.code(), Some(2), "{command}: {said}");
        assert!(said.contains("r.nc: every move is a rapid one"), "{command}: {said}");
    }
    let output = feedbits(&["check", &part]);
    let said = text(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(said.contains("every move is a rapid one: nothing is cut"), "{said}");
    let mixed = written(folder.path(), "m.nc", "G0 X0 Y0\nX10 Y5\nG1 X30 F600\n");
    let output = feedbits(&["compare", &mixed, "--machine", &data("seed-000.toml"), "--formats", "f64"]);
    assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
}

#[test]
fn a_feedrate_that_nobody_commands_is_said() {
    let folder = folder();
    for (program, expected) in [
        ("G1 X0 Y0\nX10\nX20\n", Some("in line 2: the machine's, 200 mm/s, is taken")),
        ("G1 X0 Y0\nX10\nX20 F600\n", Some("in line 2: the highest of the part, 10 mm/s, is taken")),
        ("G0 X0 Y0 F600\nX10\nG1 X20\n", None),
    ] {
        let part = written(folder.path(), "p.nc", program);
        let output = feedbits(&["compare", &part, "--machine", &data("seed-000.toml"), "--formats", "f64"]);
        let said = unfolded(&output.stderr);
        assert_eq!(said.contains("no feedrate is commanded"), expected.is_some(), "{said}");
        assert!(expected.is_none_or(|expected| said.contains(expected)), "{said}");
    }
    assert_eq!(unfolded(&feedbits(&["compare", "--formats", "f64", "--quiet"]).stderr), "");
    assert!(!unfolded(&feedbits(&["compare", "--formats", "f64"]).stderr).contains("no feedrate"));
}

/// The second curve of the run, behind a rapid move, was once refused in every format.
#[test]
fn a_cusp_is_run() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("cusp.nc");
    let program = "G21 G90\nG0 X0 Y0\nG1 X10 F600\nG0 X20\nG06.2 P4 K0 X20 Y0\nK0 X40 Y20\nK0 X20 Y20\nK0 X40 Y0\nK1\nK1\nK1\nK1\n";
    fs::write(&path, program).expect("the folder is writable");
    let output =
        feedbits(&["interpolate", path.to_str().expect("a path"), "--machine", &data("seed-000.toml")]);
    assert!(output.status.success(), "{}", unfolded(&output.stderr));
    let table = text(&output.stdout);
    let last: Vec<f64> =
        table.lines().last().expect("a row").split(',').map_while(|x| x.parse().ok()).collect();
    assert!((last[5] - 40.0).abs() < 1e-9 && last[6].abs() < 1e-9, "{last:?}");
}

/// The path would go straight on, but the machine makes another move in between, so the run goes from rest to rest.
#[test]
fn a_run_rests_at_a_rapid_move() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("gap.nc");
    fs::write(&path, "G0 X0 Y0\nG1 X10 F3000\nG0 X100 Y100\nG1 X110\n").expect("the folder is writable");
    let path = path.to_str().expect("a path");
    let machine = data("seed-000.toml");
    let output = feedbits(&["interpolate", path, "--machine", &machine, "--format", "f64"]);
    let table = text(&output.stdout);
    let rows: Vec<Vec<f64>> = table
        .lines()
        .skip_while(|line| !line.starts_with("step,"))
        .skip(1)
        .map(|line| line.split(',').map(|cell| cell.parse().expect("a number")).collect())
        .collect();
    let jump = rows.windows(2).position(|pair| pair[1][5] - pair[0][5] > 50.0).expect("a jump to X100");
    let [before, after] = [&rows[jump], &rows[jump + 1]];
    assert!((before[5] - 10.0).abs() < 1e-9 && before[8] == 0.0, "{before:?}");
    // This is the first step from rest; a step at the feed has 0.15 mm.
    assert!(after[5] - 100.0 < 0.02 && after[6] == 100.0, "{after:?}");
    assert!(unfolded(&output.stderr).contains("1 rapid move is left out"), "{}", unfolded(&output.stderr));
}

#[test]
fn where_no_format_is_enough_the_widest_says_why() {
    let folder = tempfile::tempdir().expect("a temporary folder");
    let path = folder.path().join("part.toml");
    let example = fs::read_to_string(data("seed-000.toml")).expect("the example");
    let asked = example.replace("fluctuation_limit = 1e-6", "fluctuation_limit = 1e-16");
    assert_ne!(asked, example);
    fs::write(&path, asked).expect("the folder is writable");
    let output = feedbits(&["size", path.to_str().expect("a path")]);
    let said = text(&output.stdout);
    assert_eq!(output.status.code(), Some(1), "{said}");
    assert!(
        said.contains("No format of up to 48 bits") && said.contains("The widest, I2F46: fluctuation"),
        "{said}"
    );
}

/// A format or a target that is named twice counts once.
#[test]
fn what_is_named_twice_is_run_once() {
    let output = feedbits(&[
        "compare",
        "--formats",
        "f64,I4F28,f64",
        "--evaluate",
        "pieces",
        "--targets",
        "cortex-m3,cortex-m3",
        "--json",
    ]);
    assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
    let json: serde_json::Value = serde_json::from_slice(&output.stdout).expect("JSON");
    assert_eq!(json["formats"].as_array().map(Vec::len), Some(2));
    let table = feedbits(&[
        "compare",
        "--formats",
        "I4F28",
        "--evaluate",
        "pieces",
        "--targets",
        "cortex-m3,cortex-m3",
    ]);
    assert_eq!(text(&table.stdout).matches("Cheapest good format on cortex-m3").count(), 1);
}

/// The last step of a path that ends in motion is not a step at cruise.
#[test]
fn a_path_that_is_left_in_motion_has_a_good_format() {
    let output = feedbits(&["compare", "--formats", "I4F28", "--evaluate", "pieces", "--end-feed", "200"]);
    assert_eq!(output.status.code(), Some(0), "{}", text(&output.stdout));
}

/// Notes are not results, warnings or errors.
#[test]
fn quiet_runs_say_nothing_beside_the_result() {
    let folder = folder();
    let machine = data("seed-000.toml");
    let part = written(folder.path(), "p.nc", "G0 X0 Y0 F6000\nG1 X5\nG0 X10\nG1 X20 Y5\nM8\n");
    let out = folder.path().join("out").display().to_string();
    for arguments in [
        vec!["convert", &part, "--to", "toml", "--out", &out],
        vec!["compare", &part, "--machine", &machine, "--formats", "f64", "--out", &out],
        vec!["interpolate", "--override", "0.1:50,1:100", "--out", &out],
    ] {
        let said = feedbits(&arguments);
        assert!(!said.stderr.is_empty(), "{arguments:?}");
        let quiet = feedbits(&[&["--quiet"], &arguments[..]].concat());
        assert_eq!(
            (unfolded(&quiet.stderr), quiet.status.code()),
            (String::new(), said.status.code()),
            "{arguments:?}"
        );
    }
}

/// Paper B's line (8) and quarter of a circle (9) are exact, so every setpoint is as near to them as the polynomials of the curve file,
/// 1e-6 mm, and the format's resolution allow.
#[test]
fn the_exact_line_and_arc_of_paper_b_are_run_in_every_format() {
    let folder = folder();
    let curve = |points: &str, lambda: f64| {
        format!(
            "[curve]\nshape = \"trigonometric\"\ncontrol_points_mm = {points}\nlambda = {lambda:?}\nk = -1.0\n\
             ends = \"as-given\"\n"
        )
    };
    let tangent = 10.0 * std::f64::consts::FRAC_PI_2;
    let arc = curve(&format!("[[10, 0], [0, 10], [10, {tangent:?}], [{:?}, 10]]", -tangent), 2.0);
    let line = curve("[[0, 0], [30, 10], [0, 0], [30, 10]]", 0.0);
    for (name, contents) in [("arc.toml", arc), ("line.toml", line)] {
        let off = |x: f64, y: f64| match name {
            "arc.toml" => (x.hypot(y) - 10.0).abs(),
            _ => (x - 3.0 * y).abs() / 10.0_f64.sqrt(),
        };
        let part = written(folder.path(), name, &contents);
        for (format, resolution) in [
            ("f64", 0.0),
            ("f32", 4e-6),
            ("I4F28", 1e-6),
            ("I8F24", 4e-6),
            ("I16F16", 1e-3),
            ("I32F32", 1e-7),
        ] {
            let run = ["interpolate", &part, "--machine", "router", "--format", format];
            let output = feedbits(&run);
            assert_eq!(output.status.code(), Some(0), "{name} {format}: {}", unfolded(&output.stderr));
            let table = text(&output.stdout);
            let mut lines = table.lines();
            let header: Vec<_> = lines.next().expect("a header").split(',').collect();
            let column = |name: &str| header.iter().position(|one| *one == name).expect("a column");
            let (x, y) = (column("x_mm"), column("y_mm"));
            let mut periods = 0;
            for line in lines {
                let cells: Vec<&str> = line.split(',').collect();
                let [x, y] = [x, y].map(|at| cells[at].parse::<f64>().expect("a number"));
                assert!(off(x, y) < 1e-6 + resolution, "{name} {format}: {x} {y} is {} off", off(x, y));
                periods += 1;
            }
            assert!(periods > 300, "{name} {format}: {periods}");
        }
    }
}

/// Test vectors come as five files or not at all, and two runs of a part write the same bytes.
#[test]
fn test_vectors_are_written_whole_or_not_at_all() {
    let folder = folder();
    let part = data("seed-003.nc");
    let run = |more: &[&str]| {
        let arguments = ["interpolate", &part, "--machine", "router", "--format", "I4F28"];
        feedbits_in(folder.path(), &[&arguments[..], more].concat())
    };
    let files = |name: &str| {
        let names = ["about.json", "periods.csv", "periods.hex", "signals.csv", "signals.hex"];
        names.map(|file| fs::read_to_string(folder.path().join(name).join(file)).unwrap())
    };
    for name in ["once", "again"] {
        let output = run(&["--vectors", name]);
        assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
    }
    assert_eq!(files("once"), files("again"));
    let [about, periods, image, ..] = files("once");
    assert!(about.contains("\"format\": \"I4F28\""), "{about}");
    assert_eq!(periods.lines().count(), image.lines().count() + 1);

    let output = run(&["--vectors", "beside", "--out", "setpoints.csv"]);
    assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
    assert_eq!(files("beside"), files("once"));
    let setpoints = fs::read_to_string(folder.path().join("setpoints.csv")).unwrap();
    assert_eq!(setpoints.lines().count(), periods.lines().count());

    let output = feedbits_in(
        folder.path(),
        &["size", &part, "--machine", "router", "--types", "c", "--out", "t.h", "--vectors", "registers"],
    );
    assert_eq!(output.status.code(), Some(0), "{}", unfolded(&output.stderr));
    let about: serde_json::Value = serde_json::from_str(&files("registers")[0]).unwrap();
    let header = fs::read_to_string(folder.path().join("t.h")).unwrap();
    for register in about["registers"].as_array().unwrap() {
        let name = register["signal"].as_str().unwrap().to_uppercase();
        let bits = format!("#define FEED_{name}_BITS {}\n", register["bits"]);
        assert!(header.contains(&bits), "{bits}");
    }

    let refused = run(&["--vectors", "none", "--evaluate", "de-boor"]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(unfolded(&refused.stderr).contains("give --evaluate pieces"), "{}", unfolded(&refused.stderr));
    assert!(!folder.path().join("none").exists(), "a refusal makes no folder");
    fs::write(folder.path().join("taken"), "mine").unwrap();
    let refused = run(&["--vectors", "taken"]);
    assert_eq!(refused.status.code(), Some(2));
    assert_eq!(fs::read_to_string(folder.path().join("taken")).unwrap(), "mine");
}
