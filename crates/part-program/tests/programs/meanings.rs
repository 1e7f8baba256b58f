//! Words that mean different things on different controls, and words that change what others mean.

use part_program::{Dialect, MoveKind, Part, ReadOptions, Severity, Unit, inspect, read_part_with};

fn read(text: &str, options: ReadOptions) -> Part {
    read_part_with("p.nc", text, options).unwrap_or_else(|errors| panic!("{text}{errors}"))
}

fn on(dialect: Dialect) -> ReadOptions {
    ReadOptions { dialect: Some(dialect), ..ReadOptions::default() }
}

/// The feeds of the moves that cut, in mm/s.
fn feeds(part: &Part) -> Vec<f64> {
    part.moves
        .iter()
        .filter(|one| one.kind == MoveKind::Feed)
        .map(|one| one.feedrate_mm_per_s.unwrap_or(f64::NAN))
        .collect()
}

fn near(found: f64, expected: f64, of: &str) {
    assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{of}: {found}, not {expected}");
}

/// SINUMERIK 802D sl, Programming, section 8.2.3: G70 and G71 change the unit of what is geometry, G700 and G710 that of F as well. An
/// F that was written before keeps its value. The base unit is that of `--units`.
#[test]
fn g70_leaves_the_feed_alone_and_g700_changes_it() {
    let metric = on(Dialect::Siemens);
    let inch = ReadOptions { unit: Some(Unit::Inch), ..metric };
    for (text, options, length, feed) in [
        ("G70 G0 X0 Y0\nG1 X1 F300\n", metric, 25.4, 5.0),
        ("G700 G0 X0 Y0\nG1 X1 F300\n", metric, 25.4, 127.0),
        ("G710 G0 X0 Y0\nG1 X1 F300\n", inch, 1.0, 5.0),
        ("G71 G0 X0 Y0\nG1 X1 F300\n", inch, 1.0, 127.0),
        ("G700 G70 G0 X0 Y0\n", metric, 0.0, f64::NAN),
        ("G700\nG71 G0 X0 Y0\nG1 X1 F300\n", metric, 1.0, 5.0),
        ("G0 X0 Y0\nG1 F300\nG700\nG1 X1\n", metric, 25.4, 5.0),
        ("G0 X0 Y0\nG3 X0 Y2 CR=1 F60 G70\n", metric, std::f64::consts::PI * 25.4, 1.0),
        ("G70 G95 S60 G0 X0 Y0\nG1 X1 F0.5\n", metric, 25.4, 0.5),
        ("G700 G95 S60 G0 X0 Y0\nG1 X1 F0.5\n", metric, 25.4, 12.7),
        ("G20 G0 X0 Y0\nG1 X1 F60\n", ReadOptions::default(), 25.4, 25.4),
    ] {
        if feed.is_nan() {
            let errors = read_part_with("p.nc", text, options).unwrap_err().to_string();
            assert!(errors.contains("`G700` and `G70`: two units in one block"), "{errors}");
            continue;
        }
        let part = read(text, options);
        near(inspect(&part).length_mm, length, text);
        near(feeds(&part)[0], feed, text);
        assert_eq!(part.warnings, [], "{text}");
    }
    let unknown = read("G70 G0 X0 Y0\nG1 X1 F300\n", ReadOptions::default());
    near(feeds(&unknown)[0], 5.0, "no dialect");
    assert!(unknown.warnings[0].message.contains("`F300` is read in mm"), "{:?}", unknown.warnings);
}

/// The same words are bolt circles on a Haas mill, and cycles of a lathe in LinuxCNC.
#[test]
fn g70_with_words_of_a_cycle_is_no_unit() {
    for (text, dialect, why) in [
        ("G0 X0 Y0 Z1\nG70 I5 J10 L8\n", None, "`G70` is not read"),
        ("G0 X0 Y0 Z1\nG71 Q100 D0.5\n", None, "G70 to G72 turn a contour"),
        ("G0 X0 Y0 Z1\nG70 Q100\n", Some(Dialect::LinuxCnc), "G70 to G72 turn a contour"),
    ] {
        let options = ReadOptions { dialect, ..ReadOptions::default() };
        let errors = read_part_with("p.nc", &format!("{text}G1 X1 F60\n"), options).unwrap_err().to_string();
        assert!(errors.contains(why), "{errors}");
    }
}

/// Marlin: `M220 S` is a percentage of every feed from then on, B keeps it and R brings it back.
#[test]
fn m220_scales_the_feed_of_a_printer() {
    let head = "G21 G90\nG28\nG0 X0 Y0 Z0.2\n";
    for (text, expected) in [
        ("M220 S50\nG1 X10 E1 F1800\n", &[15.0][..]),
        ("G1 X10 E1 F1800\nM220 S200\nG1 X20 E2\nG1 X30 F600\nM220 S100\nX40\n", &[30.0, 60.0, 20.0, 10.0]),
        ("G1 X10 E1 F1800\nM220 S50\nM220 B\nM220 S10\nX20\nM220 R\nX30\n", &[30.0, 3.0, 15.0]),
        ("M220 S50\nG3 X10 Y0 I5 J0 E1 F1800\n", &[15.0]),
    ] {
        let part = read(&format!("{head}{text}"), ReadOptions::default());
        let found = feeds(&part);
        assert_eq!(found.len(), expected.len(), "{text}: {found:?}");
        found.iter().zip(expected).for_each(|(found, expected)| near(*found, *expected, text));
        assert!(part.auxiliary.iter().all(|word| word.letter != 'S'), "no speed of a spindle: {text}");
        assert_eq!(part.warnings, [], "{text}");
    }
    // Beside an axis it is some other control's word: the move stays.
    let part = read("G21 G90\nG0 X0 Y0 Z0\nG1 X20 F60 M220\n", ReadOptions::default());
    near(inspect(&part).length_mm, 20.0, "M220 beside an axis");
    let errors =
        read_part_with("p", &format!("{head}M220 S0\nG1 X1 F60\n"), ReadOptions::default()).unwrap_err();
    assert!(errors.to_string().contains("`S0`: a feed of 0 %"), "{errors}");
}

/// M201 to M205 set limits that a printer plans with: here the machine file has them.
#[test]
fn limits_that_a_printer_sets_are_named() {
    let text = "G21 G90\nM201 X1000 Y1000 Z200 E5000\nM203 X200 Y200 Z12 E120\nM204 S1250 T1250\nM205 X8 Y8\n\
                G0 X0 Y0 Z0.2\nG1 X10 E1 F1800\nM204 S500\nG1 X20 E2\n";
    let part = read(text, ReadOptions::default());
    let said: Vec<_> = part.warnings.iter().map(|said| (said.line, said.message.as_str())).collect();
    let limit = |word: &str| format!("`{word}` sets limits of the printer: those of the machine file hold");
    assert_eq!(
        said,
        [
            (2, limit("M201").as_str()),
            (3, limit("M203").as_str()),
            (4, format!("{}, and 1 more like it", limit("M204")).as_str()),
            (5, limit("M205").as_str()),
        ]
    );
    near(inspect(&part).length_mm, 20.0, text);
    // They change nothing of the path: `check` notes them and calls nothing suspicious.
    assert!(part.warnings.iter().all(|said| said.severity == Severity::Note));
}

/// Beside a move a printer's word takes what is its own, and leaves the move its axes and its feed.
#[test]
fn a_word_of_a_printer_beside_a_move_leaves_it_its_axes() {
    let head = "M104 S200\nG21 G90\nG0 X0 Y0 Z0\n";
    for block in [
        "G1 X20 F60 M204 S500",
        "G1 X20 F60 M203 Z5 Y0",
        "M205 G1 X20 F60",
        "M220 S100 G1 X20 F60",
        "G1 X20 F60 M106 S255",
        "G1 M201 X20 F60",
    ] {
        let part = read(&format!("{head}{block}\n"), ReadOptions::default());
        let way = if block.contains("Z5") { 20.0_f64.hypot(5.0) } else { 20.0 };
        near(inspect(&part).length_mm, way, block);
        assert_eq!(feeds(&part), [1.0], "{block}");
    }
    // Without a G word what stands before it is the move's, and all behind it is its own.
    near(
        inspect(&read(&format!("{head}G1 X5 F60\nX20 M203 Y500 Z9\n"), ReadOptions::default())).length_mm,
        20.0,
        "",
    );
    near(
        inspect(&read(&format!("{head}G1 X5 F60\nM203 X500 Y500\n"), ReadOptions::default())).length_mm,
        5.0,
        "",
    );
}

/// LinuxCNC's dwell takes P alone: coordinates of its block are those of the motion in force, which follows the dwell.
#[test]
fn a_dwell_with_coordinates_moves_where_it_does() {
    let text = "G21 G90 F600\nG0 X0 Y0 Z0\nG1 X5\nG4 P1 X10\nG1 Y7\n";
    for dialect in [Some(Dialect::LinuxCnc), None] {
        let part = read(text, ReadOptions { dialect, ..ReadOptions::default() });
        near(inspect(&part).length_mm, 17.0, "linuxcnc");
        assert!(part.moves[0].exact_stop && !part.moves[1].exact_stop);
    }
    // FANUC's X is the time, and so are Siemens' F and S.
    near(inspect(&read(text, on(Dialect::Fanuc))).length_mm, 5.0_f64 + 7.0, "fanuc");
    let seconds = "G21 G90\nG0 X0 Y0 Z0\nG1 X5 F600\nG4 X10\nG4 F60\nG1 Y7\n";
    for (dialect, feed) in [(Some(Dialect::Fanuc), 1.0), (Some(Dialect::Siemens), 10.0), (None, 10.0)] {
        let part = read(seconds, ReadOptions { dialect, ..ReadOptions::default() });
        near(inspect(&part).length_mm, 12.0, seconds);
        assert_eq!(feeds(&part), [10.0, feed]);
    }
    let feed = "G0 X0 Y0\nG4 P1 F60\nG1 X1\n";
    assert_eq!(feeds(&read(feed, on(Dialect::LinuxCnc))), [1.0], "LinuxCNC's F is the feed");
}

/// FANUC's EOB is printed as `;`. Elsewhere a comment begins there.
#[test]
fn a_semicolon_ends_a_block_of_fanuc() {
    let text =
        "O1;\nG21 G90 G17;\nG0 X0. Y0. Z0.;\nG1 X10. F300. (a ; b); G1 Y5.;; N9 G1 X0.;\n/G1 Y0.; M30;\n";
    let part = read(text, on(Dialect::Fanuc));
    near(inspect(&part).length_mm, 30.0, text);
    assert_eq!(part.moves.iter().map(|one| one.line).collect::<Vec<_>>(), [4, 4, 4, 5]);
    let blocks: Vec<_> = part.moves.iter().map(|one| one.block).collect();
    assert!(blocks.windows(2).all(|pair| pair[0] < pair[1]), "{blocks:?}");
    near(inspect(&read(text, ReadOptions::default())).length_mm, 10.0, "a comment");
    // A jump or a call from within a line would not come back to it.
    for text in ["IF [1 EQ 1] GOTO 5; G1 Y5.;\nN5 G1 X3.;\n", "M98 P7; G1 Y5.;\nM30\nO7\nG1 X1.\nM99\n"] {
        let errors = read_part_with("p", &format!("G0 X0. Y0.\n{text}"), on(Dialect::Fanuc)).unwrap_err();
        assert!(errors.to_string().contains("a block behind a jump or a call, on its line"), "{errors}");
    }
    let found_out =
        read("G0 X0 Y0\n#1=1\nIF [#1 EQ 2] GOTO 5\nG1 X1 F60; G1 Y5\nN5 G1 X3\n", ReadOptions::default());
    assert!(
        found_out
            .warnings
            .iter()
            .any(|said| said.line == 4 && said.message.contains("`;` ends a block of fanuc")),
        "{:?}",
        found_out.warnings
    );
}

/// Start lines of printers: letters without a number, and texts.
#[test]
fn letters_alone_are_words_of_printers() {
    let start = "G90\nM82\nG0 X10 Y10 Z0.2 F3000\nG1 X20 Y10 E1 F1800\n";
    for line in [
        "G28 W",
        "G28 X Y",
        "G28 X0 Y0",
        "G28 O",
        "G28 R5 Z",
        "G29",
        "G29 T",
        "G29 S1 P2",
        "M84 X Y E",
        "M18 X",
        "M862.3 P \"MK3S\" ; model",
        "M862.1 P0.4",
        "M486 S0 A\"a part\"",
        "M420 S1 V",
        "M73 P0 R10",
    ] {
        let part = read(&format!("G21\n{line}\n{start}{line}\n"), ReadOptions::default());
        near(inspect(&part).length_mm, 10.0, line);
        assert_eq!(part.warnings, [], "{line}");
    }
    // Only the axes that are named go home.
    let part = read(&format!("G21\n{start}G28 X\nG1 Y15 E2\nG1 X12\nG1 Y10\n"), ReadOptions::default());
    near(inspect(&part).length_mm, 20.0, "Y is known, X begins anew");
    for (text, dialect) in [("G1 X", None), ("M3 S", None), ("G28 X", Some(Dialect::LinuxCnc))] {
        let options = ReadOptions { dialect, ..ReadOptions::default() };
        let errors = read_part_with("p", &format!("{start}{text}\n"), options).unwrap_err().to_string();
        assert!(errors.contains("has no number"), "{errors}");
    }
}

/// SINUMERIK 840D sl, Fundamentals, "Axial zero offset": with axes G58 and G59 shift the coordinates, and move nothing.
#[test]
fn siemens_g58_with_axes_is_no_move() {
    let text = "G90 G0 X0 Y0\nG1 X5 F60\nG58 X100\nG1 X10\nX20\n";
    let errors = read_part_with("p.nc", text, on(Dialect::Siemens)).unwrap_err().to_string();
    assert!(errors.contains("`G58` is not read"), "{errors}");
    let part = read(text, ReadOptions { lenient: true, ..on(Dialect::Siemens) });
    near(inspect(&part).length_mm, 5.0, text);
}

/// FANUC 15i, B-63324EN/03, section 4.17: the first block may have no point, which is where the tool is, and no knot, which is the second's.
#[test]
fn the_first_block_of_a_nurbs_may_lack_its_point_and_its_knot() {
    let rest = "K0. X20. Y20. R1.\nK0. X30. Y0.\nK0. X40. Y10.\nK1.\nK1.\nK1.\nK1.\nG01 X50.\n";
    let head = "G21 G90 G17\nG00 X10. Y10. Z0.\nG01 X10. Y10. F1000.\n";
    let whole = read(&format!("{head}G06.2 P4 K0. X10. Y10. R1. F1000.\n{rest}"), ReadOptions::default());
    for first in ["G06.2 P4 F1000.", "G06.2 P4 K0.", "G06.2 P4 X10. Y10.", "G06.2"] {
        assert_eq!(
            read(&format!("{head}{first}\n{rest}"), ReadOptions::default()).curves,
            whole.curves,
            "{first}"
        );
    }
    let second = rest.replacen("K0. X20.", "X20.", 1);
    let errors =
        read_part_with("p", &format!("{head}G06.2 P4\n{second}"), ReadOptions::default()).unwrap_err();
    assert!(errors.to_string().contains("PS1002"), "{errors}");
}

/// An arc that has R beside I and J: FANUC takes R.
#[test]
fn r_wins_on_fanuc() {
    let text = "G21 G90 G17\nG0 X0 Y0 Z0\nG02 X20. Y0. I10. J0. R15. F600.\n";
    near(inspect(&read(text, on(Dialect::Fanuc))).length_mm, 30.0 * (10.0_f64 / 15.0).asin(), text);
    for dialect in [None, Some(Dialect::LinuxCnc)] {
        let options = ReadOptions { dialect, ..ReadOptions::default() };
        assert!(
            read_part_with("p", text, options).unwrap_err().to_string().contains("both centre and radius")
        );
    }
}

#[test]
fn levels_of_precision_of_fanuc_are_no_path() {
    for words in ["G05.1 Q1 R5", "G05.1 Q1", "G05.1 Q2 X0 Y0 Z0", "G08 P1", "G05 P10000"] {
        let text = format!("G21 G90\n{words}\nG0 X0. Y0. Z0.\nG1 X10. F1200.\nG05.1 Q0\n");
        let part = read(&text, on(Dialect::Fanuc));
        near(inspect(&part).length_mm, 10.0, words);
        assert_eq!(part.warnings, [], "{words}");
    }
}

/// A number that is computed lacks no point.
#[test]
fn an_expression_lacks_no_decimal_point() {
    let text = "#1=3\nG0 X0. Y0. Z0.\nG1 X[#1*10] F300.\nG1 Y#1\nG1 X[10 + 5]\n";
    assert_eq!(read(text, on(Dialect::Fanuc)).warnings, []);
    let warned = read(&format!("{text}X -7\n"), on(Dialect::Fanuc));
    assert!(warned.warnings[0].message.contains("`X -7`"), "{:?}", warned.warnings);
}

/// rs274 drops white space outside of comments before it reads a line.
#[test]
fn linuxcnc_reads_numbers_with_spaces() {
    let text = "G2 1 G9 0 F 6 0 0\nG0 X0 Y0 Z0\nG1 X 1 0 . 5 Y+0. 12 34 (a 1)\nG 1 X [1 0 + 1 0 ] \n#1 = 2 0\nX#1\nX- 1 ; 5\n";
    let part = read(text, on(Dialect::LinuxCnc));
    let ends: Vec<_> = part.curves.iter().map(|curve| curve.control_points_mm()[1]).collect();
    assert_eq!(ends, [[10.5, 0.1234, 0.0], [20.0, 0.1234, 0.0], [-1.0, 0.1234, 0.0]]);
    assert_eq!(feeds(&part), [10.0; 3]);
    let errors = read_part_with("p", "G0 X5 12\n", ReadOptions::default()).unwrap_err();
    assert!(errors.to_string().contains("the number `12` has no letter"), "{errors}");
}

/// RS274/NGC, 3.5.16: a cycle in inverse time feed is an error. What is not read has its own word.
#[test]
fn what_is_not_read_is_refused_with_the_right_word() {
    for (text, why) in [
        ("G93 G0 X0 Y0 Z5\nG81 X10 Y0 Z-5 R1 F6\nX20 F6\nG80 G94\n", "a drilling cycle in inverse time feed"),
        ("G0 X0 Y0 Z20\nG98 G87 X30 Y0 Z-5 R-20 I2 J0 K3\nG80\n", "`G87` bores from behind"),
        ("G0 X5 U1 A2 Q7\nG1 X9 ~\nG50 S2000\nG1 Z5 Q1\n", "this is a program for a lathe: G50 with S"),
        (
            "G0 X50 Z5\nG96 S200 M3\nG1 Z-20 F0.2\n",
            "this is a program for a lathe: G96 keeps the speed of the cut",
        ),
    ] {
        let errors = read_part_with("p", text, ReadOptions::default()).unwrap_err();
        assert!(errors.count() == 1 && errors.to_string().contains(why), "{text}{errors}");
    }
}

/// On a mill G96 says how fast the spindle turns, and the feed in G94 does not depend on it.
#[test]
fn the_speed_of_the_cut_is_kept_on_a_mill() {
    let text = "G21 G96 D2500 S150\nG0 X0 Y0 Z0\nG1 X10 F600\nG95 F0.1\nG1 Y10\nG97 S600\nG1 X0\n";
    let part = read(text, ReadOptions::default());
    let found = feeds(&part);
    assert!(found[0] == 10.0 && found[1].is_nan() && (found[2] - 1.0).abs() < 1e-12, "{found:?}");
    assert!(part.warnings[0].message.contains("that of the spindle is not known"), "{:?}", part.warnings);
}

/// Turned coordinates were turned forth and back, and a move of 9e-16 mm was left of it.
#[test]
fn turned_coordinates_make_no_moves_of_rounding() {
    let program = |turn: &str| {
        format!(
            "G21 G90 G17 F600\nG10 L2 P1 {turn}\nG54\nG0 X0 Y0 Z0\nG1 X10.3 Y7.7\nG28 X20\nG1 X30\nG1 Y12.1\n"
        )
    };
    let straight = read(&program("R0"), ReadOptions::default());
    for turn in ["R30", "R-77.7", "X3.3 Y1.1 R30"] {
        let turned = read(&program(turn), ReadOptions::default());
        assert_eq!(turned.moves, straight.moves, "{turn}");
        for (one, other) in turned.curves.iter().zip(&straight.curves) {
            let points = one.control_points_mm().iter().zip(other.control_points_mm());
            points.for_each(|(one, other)| (0..3).for_each(|axis| near(one[axis], other[axis], turn)));
        }
    }
    // Turned against the part: a move to where the tool is stays one of no length.
    let text =
        "G21 G90 F600\nG0 X0 Y0\nG1 X1\nG10 L2 P1 R33.3\nG1 X10.1 Y7.7\nX10.1\nY7.7\nX10.1 Y7.7\nX20.3\n";
    let part = read(text, ReadOptions::default());
    assert_eq!((part.curves.len(), part.standstills.as_slice()), (3, &[6, 7, 8][..]));
}

/// What a program has and its path does not hold is counted.
#[test]
fn words_that_the_path_does_not_hold_are_counted() {
    for (text, left_out) in [
        (
            "G0 X0 Y0 Z0\nG1 X10 E1\nM106 S10\nG1 X20 E2\nM8\nm204 S500\nM220 S50\nG1 X30 E3\n",
            Some("3 E, 1 M106, 1 M204, 1 M220"),
        ),
        ("G0 X0 Y0\nG4 P1\nG43 H1\nM62 P3\nG1 X1\n", Some("1 G4, 1 G43, 1 P of M62")),
        ("G40 G49 G80 G17\nG0 X0 Y0\nM3 S100 T5\nG1 X1 F60\nM30\n", None),
    ] {
        assert_eq!(read(text, ReadOptions::default()).left_out.as_deref(), left_out, "{text}");
    }
}
