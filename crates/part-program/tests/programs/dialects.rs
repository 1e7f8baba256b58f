//! One curve in three dialects and two files is one curve.

use part_program::{
    Curve, Dialect, Move, MoveKind, Part, ReadOptions, Shape, ToleranceFrom, read_part, read_part_with,
    write_curves, write_g1, write_g5_2, write_g06_2,
};

fn part(text: &str) -> Part {
    read_part("p.nc", text).unwrap_or_else(|errors| panic!("{errors}"))
}

const FANUC: &str = "G90 G0 X0 Y0
G06.2 P4 K0 X0 Y0 R1.5 F6000
K0 X10 Y20 R2
K0 X20.5 Y-3 R0.7
K0 X30 Y16
K1 X40.125 Y1 R1
K2 X50 Y38 R2.5
K3
K3
K3
K3
G0 X60
";

const LINUXCNC: &str = "G90 G0 X0 Y0 F6000
G5.2 P1.5 L4
X10 Y20 P2
X20.5 Y-3 P0.7
X30 Y16 P1
X40.125 Y1 P1
X50 Y38 P2.5
G5.3
G0 X60
";

const SIEMENS: &str = "G90 G0 X0 Y0 F6000
BSPLINE SD=3
X0 Y0 PW=1.5 PL=0
X10 Y20 PW=2 PL=1
X=20.5 Y=-3 PW=0.7 PL=1
X30 Y16 PL=1
X40.125 Y1 PL=0
X50 Y38 PW=2.5
G0 X60
";

const TOML: &str = "[curve]
degree = 3
control_points_mm = [[0, 0], [10, 20], [20.5, -3], [30, 16], [40.125, 1], [50, 38]]
weights = [1.5, 2, 0.7, 1, 1, 2.5]
knots = [0, 0, 0, 0, 1, 2, 3, 3, 3, 3]
";

const JSON: &str = r#"{"shape": {"type": "curve", "count": 1, "data": [{"type": "spline", "rational": true,
"dimension": 2, "degree": 3, "knotvector": [0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0, 3.0], "control_points": {
"points": [[0, 0], [10, 20], [20.5, -3], [30, 16], [40.125, 1], [50, 38]], "weights": [1.5, 2, 0.7, 1, 1, 2.5]}}]}}"#;

const DXF: &str = "  0 SECTION   2 HEADER 9 $INSUNITS 70 4 0 ENDSEC 0 SECTION 2 ENTITIES
0 SPLINE 8 0 100 AcDbSpline 210 0 220 0 230 1 70 12 71 3 72 10 73 6 74 0
40 0 40 0 40 0 40 0 40 1 40 2 40 3 40 3 40 3 40 3 41 1.5 41 2 41 0.7 41 1 41 1 41 2.5
10 0 20 0 30 0 10 10 20 20 30 0 10 20.5 20 -3 30 0 10 30 20 16 30 0 10 40.125 20 1 30 0 10 50 20 38 30 0
0 ENDSEC 0 EOF";

/// The same curve in every format that is read, and in every format that is written from any of them.
#[test]
fn the_same_curve_in_every_format_has_the_same_bits() {
    let dxf = DXF.split_whitespace().collect::<Vec<_>>().join("\r\n");
    let reference = part(TOML).curves.remove(0);
    for text in [FANUC, LINUXCNC, SIEMENS, TOML, JSON, &dxf] {
        let mut read = part(text);
        assert_eq!(read.warnings, [], "{text}");
        read.curves.truncate(1);
        read.moves.truncate(1);
        assert_same_bits(&read.curves[0], &reference);
        for written in [write_g06_2(&read).unwrap(), write_g5_2(&read).unwrap(), write_curves(&read)] {
            assert_same_bits(&part(&written).curves[0], &reference);
        }
    }
}

fn assert_same_bits(one: &Curve, other: &Curve) {
    let bits = |curve: &Curve| {
        let numbers = curve.control_points_mm().iter().flatten().chain(curve.weights()).chain(curve.knots());
        numbers.map(|number| number.to_bits()).collect::<Vec<_>>()
    };
    assert_eq!((one.degree(), one.dimension(), bits(one)), (other.degree(), other.dimension(), bits(other)));
}

#[test]
fn the_same_curve_in_every_dialect_has_the_same_numbers() {
    let reference = part(TOML).curves.remove(0);
    for text in [FANUC, LINUXCNC, SIEMENS] {
        let part = part(text);
        assert_eq!(part.curves[0], reference, "{text}");
        assert_eq!((part.moves[0].kind, part.moves[0].shape), (MoveKind::Feed, Shape::Nurbs));
        assert_eq!(part.moves[0].feedrate_mm_per_s, Some(100.0));
        assert_eq!(part.curves[1].control_points_mm(), [[50.0, 38.0, 0.0], [60.0, 38.0, 0.0]], "{text}");
        assert_eq!(part.warnings, []);
    }
}

#[test]
fn a_given_dialect_refuses_the_others() {
    let texts = [(Dialect::Fanuc, FANUC), (Dialect::LinuxCnc, LINUXCNC), (Dialect::Siemens, SIEMENS)];
    for given in texts.map(|(dialect, _)| dialect) {
        for (own, text) in texts {
            let options = ReadOptions { dialect: Some(given), lenient: false, ..ReadOptions::default() };
            let read = read_part_with("p.nc", text, options);
            // LinuxCNC 2.10 has G6.2, too.
            let is_its_own = given == own || (given, own) == (Dialect::LinuxCnc, Dialect::Fanuc);
            assert_eq!(read.is_ok(), is_its_own, "{given} reads {own}");
            if let Err(errors) = read {
                let said = format!("is a spline of {own}, and the program is read as {given}");
                assert!(errors.to_string().contains(&said), "{errors}");
            }
        }
    }
    let mixed = format!("{FANUC}{LINUXCNC}");
    assert!(read_part("p.nc", &mixed).unwrap_err().to_string().contains("is a spline of linuxcnc"));
}

#[test]
fn dialect_names_are_read_back() {
    for dialect in Dialect::ALL {
        assert_eq!(dialect.name().parse(), Ok(dialect));
    }
    assert!("heidenhain".parse::<Dialect>().is_err());
}

#[test]
fn knots_of_linuxcnc_are_uniform_and_its_order_at_least_3() {
    let knots = |order: &str| {
        let text = format!("G0 X0 Y0\nG5.2 {order} X1 Y1 P1\nX2 Y0 P1\nX3 Y1 P1\nX4 Y0 P1\nG5.3\n");
        part(&text).curves.remove(0).knots().to_vec()
    };
    assert_eq!(knots(""), [0.0, 0.0, 0.0, 1.0, 2.0, 3.0, 3.0, 3.0]);
    assert_eq!(knots("L2"), knots("L3"));
    assert_eq!(knots("L4"), [0.0, 0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0, 2.0]);
}

#[test]
fn cubics_and_quadratics_are_single_bezier_curves() {
    let part = part("G0 X0 Y0\nG5 I0 J3 P0 Q-3 X1 Y1\nX2 Y2 P0 Q-3\nG5.1 X4 Y2 I1 J2\n");
    let points: Vec<_> = part.curves.iter().map(|c| c.control_points_mm()).collect();
    assert_eq!(points[0], [[0.0, 0.0, 0.0], [0.0, 3.0, 0.0], [1.0, -2.0, 0.0], [1.0, 1.0, 0.0]]);
    assert_eq!(points[1], [[1.0, 1.0, 0.0], [1.0, 4.0, 0.0], [2.0, -1.0, 0.0], [2.0, 2.0, 0.0]]);
    assert_eq!(points[2], [[2.0, 2.0, 0.0], [3.0, 4.0, 0.0], [4.0, 2.0, 0.0]]);
}

#[test]
fn siemens_without_intervals_is_uniform_with_a_warning() {
    let part = part("G0 X0 Y0\nBSPLINE SD=2 X1 Y1\nX2 Y0\nX3 Y1\n");
    assert_eq!(part.curves[0].knots(), [0.0, 0.0, 0.0, 1.0, 2.0, 2.0, 2.0]);
    assert_eq!(part.warnings.len(), 1);
}

/// High-precision contouring, comments, incremental points, two curves under one G06.2, M words in between.
#[test]
fn fanuc_programs_as_they_come() {
    let text =
        "G05 P10000\nG91\nG06.2 P2 K0 X0 Y0\nM8\nK0 X10 (up) Y5\nK1\nK1\nK0 X0 Y0\nK0 X5\nK1\nK1\nG05 P0\n";
    let part = part(text);
    let ends: Vec<_> = part.curves.iter().map(|c| c.control_points_mm()).collect();
    assert_eq!(ends, [vec![[0.0; 3], [10.0, 5.0, 0.0]], vec![[10.0, 5.0, 0.0], [15.0, 5.0, 0.0]]]);
    assert_eq!(part.moves.iter().map(|m| m.line).collect::<Vec<_>>(), [3, 8]);
}

#[test]
fn a_coordinate_that_is_not_written_keeps_its_value() {
    let part = part("G0 X0 Y0 Z4\nG06.2 P3 K0\nK0 X10\nK0 Y10 Z5\nK1\nK1\nK1\n");
    let curve: &Curve = &part.curves[0];
    assert_eq!(curve.control_points_mm(), [[0.0, 0.0, 4.0], [10.0, 0.0, 4.0], [10.0, 10.0, 5.0]]);
    assert_eq!(curve.dimension(), 3);
}

#[test]
fn lenient_reading_lists_what_it_reads_over() {
    let text = "G0 X0 Y0\nG1 X10 Q7 A5\nFOOBAR\nG64.7\nX20\n";
    assert_eq!(read_part("p.nc", text).unwrap_err().count(), 3);
    let part =
        read_part_with("p.nc", text, ReadOptions { lenient: true, dialect: None, ..ReadOptions::default() })
            .unwrap();
    assert_eq!(part.curves.len(), 1);
    let said: Vec<_> = part.warnings.iter().map(|w| (w.line, w.message.as_str())).collect();
    let expected = [
        (2, "`Q7` is no word of G1"),
        (2, "beside `A5` F is read as the feed along X, Y and Z, as LinuxCNC does"),
        (3, "unknown word `FOOBAR`"),
        (4, "`G64.7` is not read"),
        (5, "left out: where the tool is is not known, since a block before it was left out"),
    ];
    assert_eq!(said, expected);
}

/// A feed per revolution was taken for one per minute, and later not read at all.
#[test]
fn a_feed_per_revolution_needs_the_speed_of_the_spindle() {
    let part =
        part("G0 X0 Y0\nG1 X5 F300\nG95 F0.2 S1500\nX10\nX20 F0.3\nG94\nX30\nX40 F600\nG95 S3000\nX50\n");
    let feeds: Vec<_> = part.moves.iter().map(|one| one.feedrate_mm_per_s).collect();
    assert_eq!(feeds, [5.0, 5.0, 7.5, 5.0, 10.0, 15.0].map(Some));
    assert_eq!(part.feedrate_mm_per_s, Some(15.0));
    let unknown = self::part("G0 X0 Y0\nG95 F0.2\nG1 X10\n");
    let expected = [(3, "a feed per revolution of a spindle whose speed is not known: the move has none")];
    assert_eq!((unknown.moves[0].feedrate_mm_per_s, said(&unknown)), (None, expected.to_vec()));
    assert_eq!(
        read_part("p.nc", "G94 G95 G1 X1\n").unwrap_err().iter().next().unwrap().message,
        "`G94` and `G95`: two kinds of feed in one block"
    );
}

/// A control comes to rest for a dwell; the feed went on through it, and corners there were cut.
#[test]
fn the_tool_rests_at_a_dwell() {
    let part = part("G0 X0 Y0 F600\nG1 X10\nG4 P500\nX20\nG1 X30\nG0 X40\nG4 X1.5\nG1 X50\n");
    let stops: Vec<_> = part.moves.iter().map(|one| one.exact_stop).collect();
    assert_eq!(stops, [true, false, false, false, false]);
    assert_eq!(part.curves[1].control_points_mm()[1], [20.0, 0.0, 0.0]);
    assert_eq!(said(&part).iter().map(|(line, _)| *line).collect::<Vec<_>>(), [3, 7]);
}

/// Calls of subprograms were once skipped but for their words, and without words there was no message.
#[test]
fn a_call_of_a_subprogram_is_an_error_that_says_so() {
    for text in [
        "G0 X0 F60\nG1 X10\nM98 P2000 L3\n",
        "G0 X0 F60\nG1 X10\nM98 P2000\n",
        "G0 X0 F60\nG1 X9\nM198 Q2 P1\n",
    ] {
        let errors = read_part("p.nc", text).unwrap_err();
        let messages: Vec<_> = errors.iter().map(|error| (error.line, error.message.as_str())).collect();
        let called =
            if text.contains("M198") { "a subprogram of another device" } else { "subprogram O2000" };
        assert_eq!(messages, [(3, format!("{called} is not in this file").as_str())]);
        let left_out = format!("{called} is not in this file: its moves are left out");
        assert_eq!(said(&lenient(text)), [(3, left_out.as_str())]);
    }
}

/// When all blocks were skipped, no message said why no curve was left.
#[test]
fn a_program_of_nothing_names_what_was_read_over() {
    let options = ReadOptions { lenient: true, dialect: None, ..ReadOptions::default() };
    let errors = read_part_with("p.nc", "G0 X0 Y0\nG38.2 X10 Y10\nX20\n", options).unwrap_err();
    let hint = errors.iter().next().unwrap().hint.as_deref().unwrap();
    assert!(hint.contains("line 2: `G38.2` is not read"), "{hint}");
    let nothing = read_part("p.nc", "M30\n").unwrap_err();
    assert_eq!(nothing.iter().next().unwrap().hint, None);
}

#[test]
fn lengths_without_a_decimal_point_are_warned_of_once_for_fanuc() {
    let read = |dialect, text| {
        read_part_with("p.nc", text, ReadOptions { dialect, lenient: false, ..ReadOptions::default() })
            .unwrap()
    };
    let text = "G0 X0 Y0.\nG1 X1000 F600\nG2 X2000 R500\n";
    let part = read(Some(Dialect::Fanuc), text);
    assert_eq!(said(&part), [(2, "numbers without a decimal point are read as whole millimetres: `X1000`")]);
    let arc = read(Some(Dialect::Fanuc), "G20 G0 X0 Y0\nG2 X1. R5 F9\n");
    assert_eq!(said(&arc), [(2, "numbers without a decimal point are read as whole inches: `R5`")]);
    for (dialect, text) in [
        (None, text),
        (Some(Dialect::LinuxCnc), text),
        (Some(Dialect::Fanuc), "G0 X0 Y0\nG06.2 P2 K0 X0 R1\nK0 X5. R2\nK1\nK1\n"),
    ] {
        assert_eq!(read(dialect, text).warnings, []);
    }
}

fn lenient(text: &str) -> Part {
    let options = ReadOptions { lenient: true, dialect: None, ..ReadOptions::default() };
    read_part_with("p.nc", text, options).unwrap_or_else(|errors| panic!("{errors}"))
}

fn ends(part: &Part) -> Vec<(MoveKind, [f64; 3])> {
    let last = |curve: &Curve| *curve.control_points_mm().last().unwrap();
    part.moves.iter().zip(&part.curves).map(|(one, curve)| (one.kind, last(curve))).collect()
}

fn said(part: &Part) -> Vec<(usize, &str)> {
    part.warnings.iter().map(|warning| (warning.line, warning.message.as_str())).collect()
}

#[test]
fn words_that_switch_nothing_of_the_path_are_read() {
    let part = part("G98 G20 G90 G15 G50 G50.1 G67 G97\nG99 G0 X0 Y0\nG1 X1 F10\n");
    assert_eq!(ends(&part), [(MoveKind::Feed, [25.4, 0.0, 0.0])]);
    assert_eq!(part.warnings, []);
    let options = ReadOptions { lenient: false, dialect: Some(Dialect::Siemens), ..ReadOptions::default() };
    let errors = read_part_with("p.nc", "G500 G450 G0 X0 Y0\nG98 G1 X1\n", options).unwrap_err();
    assert_eq!(errors.iter().map(|error| error.message.as_str()).collect::<Vec<_>>(), ["`G98` is not read"]);
}

/// The motion of a block with a word that is not read holds; its axes are left out, and their place is unknown.
#[test]
fn a_word_that_is_not_read_takes_no_modal_word_with_it() {
    let part = lenient("G0 X0 Y0\nG47 D1 G1 X10 F600\nY10\nX20 Y20\nX30\n");
    assert_eq!(ends(&part), [(MoveKind::Feed, [30.0, 20.0, 0.0])]);
    assert!(part.moves.iter().all(|one| one.feedrate_mm_per_s == Some(10.0)));
    assert_eq!(part.auxiliary[0].letter, 'D');
    let lost = "where the tool is on X, Y before this move at feed is not known: its way there is left out";
    let moves = "left out: where the tool is is not known, since a block before it was left out";
    assert_eq!(said(&part), [(2, "`G47` is not read: X10 left out of its block"), (3, moves), (4, lost)]);
    let zero = lenient("G21 G0 X5 Y5 Z9\nG28 G91 Z0\nG53 G90 G0 X1 Y1\nG20 G187 P2\nG1 X1 Y1 Z1\nX2\n");
    assert_eq!(ends(&zero), [(MoveKind::Feed, [50.8, 25.4, 25.4])]);
    let lost =
        "where the tool is on X, Y, Z before this move at feed is not known: its way there is left out";
    assert_eq!(said(&zero), [(5, lost)]);
}

/// The points of a motion that is not read were once read as rapid moves, and so was the motion behind it.
#[test]
fn after_a_motion_that_is_not_read_nothing_moves_until_another() {
    let part = lenient("G0 X0 Y0 Z2\nG38.2 X10 Y10 Z-5 F100\nX20\nM8\nG80\nG0 X50 Y50\nG0 Z2\nG1 X60\n");
    assert_eq!(ends(&part), [(MoveKind::Feed, [60.0, 50.0, 2.0])]);
    let expected = [
        (2, "`G38.2` is not read: X10 Y10 Z-5 left out of its block"),
        (3, "X20 left out: the motion in force is not read"),
        (6, "left out: where the tool is is not known, since a block before it was left out"),
    ];
    assert_eq!(said(&part), expected);
}

#[test]
fn a_spline_with_a_word_that_is_not_read_is_refused() {
    let options = ReadOptions { lenient: true, dialect: None, ..ReadOptions::default() };
    let text = "G0 X0 Y0\nBSPLINE SD=2 X1 Y1\nG41 X2 Y0\nX3 Y1\n";
    let errors = read_part_with("p.nc", text, options).unwrap_err();
    assert!(
        errors.to_string().contains("p.nc:3:1") && errors.to_string().contains("`G41` is not read"),
        "{errors}"
    );
}

/// Which moves at feed end in an exact stop.
fn stops(text: &str, dialect: Option<Dialect>) -> Vec<bool> {
    let part =
        read_part_with("p.nc", text, ReadOptions { lenient: false, dialect, ..ReadOptions::default() });
    let part = part.unwrap_or_else(|errors| panic!("{errors}\n{text}"));
    let feed = part.moves.iter().filter(|one| one.kind == MoveKind::Feed);
    feed.map(|one| one.exact_stop).collect()
}

#[test]
fn exact_stop_holds_for_a_block_or_until_it_is_ended() {
    let (fanuc, linuxcnc, siemens) = (Some(Dialect::Fanuc), Some(Dialect::LinuxCnc), Some(Dialect::Siemens));
    let path = |first: &str, second: &str, last: &str| {
        format!("G0 X0 Y0 F600\nG1 X1\n{first} Y1\nG0 Z1\nG1 X2\n{second} Y2\nX3\n{last}\nY3\n")
    };
    let modal = [false, true, true, false, false, false];
    for (first, second, dialect) in [
        ("G61", "G64", None),
        ("G61", "G64", fanuc),
        ("G61", "G62", fanuc),
        ("G61", "G63", fanuc),
        ("G61.1", "G64", linuxcnc),
        ("G61", "G64", linuxcnc),
        ("G60 G602", "G64", siemens),
    ] {
        assert_eq!(stops(&path(first, second, ""), dialect), modal, "{first} {second}");
    }
    assert_eq!(stops(&path("G9", "G09", ""), None), [false, true, false, true, false, false]);
    assert_eq!(stops(&path("", "", "G61"), None), [false, false, false, false, false, true]);
    // What another control means by the same word is not taken for it.
    for (word, dialect) in [("G9", linuxcnc), ("G60", fanuc), ("G60", None), ("G62", siemens)] {
        let options = ReadOptions { lenient: false, dialect, ..ReadOptions::default() };
        let errors = read_part_with("p.nc", &path(word, "", ""), options).unwrap_err();
        assert!(errors.to_string().contains(&format!("`{word}` is not read")), "{errors}");
    }
}

#[test]
fn exact_path_rests_where_the_direction_breaks() {
    // A quarter circle between its tangents, then a corner.
    let text = "G61 G0 X0 Y0 F600\nG1 X10\nG3 X20 Y10 J10\nG1 Y20\nX30\n";
    assert_eq!(stops(text, Some(Dialect::LinuxCnc)), [false, false, true, true]);
    assert_eq!(stops(text, Some(Dialect::Fanuc)), [true; 4]);
}

#[test]
fn a_spline_stops_as_its_last_block_does() {
    for (text, expected) in [
        (FANUC.replace("G0 X60", "G61 G1 X60"), [false, true]),
        (FANUC.replace("G06.2", "G61 G06.2").replace("G0 X60", "G64 G1 X60"), [true, false]),
        (LINUXCNC.replace("G5.2", "G61.1 G5.2").replace("G0 X60", "G64 G1 X60"), [true, false]),
        (SIEMENS.replace("X50", "G9 X50").replace("G0 X60", "G1 X60"), [true, false]),
        (SIEMENS.replace("X40", "G9 X40").replace("G0 X60", "G9 G1 X60"), [false, true]),
    ] {
        assert_eq!(stops(&text, None), expected, "{text}");
    }
}

#[test]
fn exact_stops_are_written_and_read_back() {
    let program = "G0 X0 Y0\nG1 X10 F600\nG9 Y10\nG61 G3 X0 Y20 I-10\nG0 Z1\nG1 X-5\nG64 Y0\nG61 Y-5\n";
    let part = part(program);
    let expected = stops(program, None);
    assert_eq!(expected, [false, true, true, true, false, true]);
    for text in [write_g06_2(&part).unwrap(), write_g5_2(&part).unwrap(), write_curves(&part)] {
        assert_eq!(stops(&text, None), expected, "{text}");
        assert!(!text.contains("G61") || text.ends_with("G64\nM30\n"), "{text}");
    }
    // Of an arc's chords the last alone.
    let chords = stops(&write_g1(&part, 1e-2, None).unwrap(), None);
    assert_eq!((chords.iter().filter(|stop| **stop).count(), chords.last()), (4, Some(&true)));
    // What has none is written as ever.
    let plain = part_without(&part);
    assert!(!write_g1(&plain, 1e-2, None).unwrap().contains("G6"));
}

fn part_without(part: &Part) -> Part {
    let moves = part.moves.iter().map(|one| Move { exact_stop: false, ..*one }).collect();
    Part { moves, ..part.clone() }
}

#[test]
fn exact_stops_are_written_in_the_words_of_the_control() {
    // A smooth joint, which LinuxCNC's G61 passes.
    let program = "G0 X0 Y0\nG1 X5 F600\nG61 X10\nG64 X20\nY10\n";
    for (dialect, word) in [(Dialect::Fanuc, "G61"), (Dialect::LinuxCnc, "G61.1"), (Dialect::Siemens, "G60")]
    {
        let text = write_g1(&part(program), 1e-2, Some(dialect)).unwrap();
        assert!(text.contains(&format!("\n{word}\nG1 X10. Y0.\nG64\n")), "{text}");
        assert_eq!(stops(&text, Some(dialect)), [false, true, false, false], "{text}");
    }
}

#[test]
fn a_block_that_goes_nowhere_stops_all_the_same() {
    for text in ["G0 X0 Y0\nG1 X5 F600\nG9 X5\nY10\n", "G0 X0 Y0\nG1 X5 F600\nG61 X5\nG64 Y10\n"] {
        assert_eq!(stops(text, None), [true, false], "{text}");
    }
    assert_eq!(stops("G0 X0 Y0\nG1 X5 F600\nG61 X5\nX10\n", Some(Dialect::LinuxCnc)), [false, true]);
}

#[test]
fn path_modes_of_linuxcnc_and_siemens_end_exact_stops() {
    let text = "G61.1 G0 X0 Y0\nG1 X5 F600\nG64 P0.01 Q0.02\nX10\n";
    assert_eq!(stops(text, Some(Dialect::LinuxCnc)), [true, false]);
    assert_eq!(stops(text, None), [true, false]);
    assert_eq!(said(&part(text)), [(3, "a tolerance of the path: it is taken as commanded")]);
    let options = ReadOptions { lenient: false, dialect: Some(Dialect::Fanuc), ..ReadOptions::default() };
    let errors = read_part_with("p.nc", text, options).unwrap_err();
    assert!(errors.to_string().contains("p.nc:3:5") && errors.to_string().contains("`P0.01`"), "{errors}");
    let siemens = "G60 G0 X0 Y0\nG1 X5 F600\nG641 X8\nX9\n";
    assert_eq!(stops(siemens, Some(Dialect::Siemens)), [true, false, false]);
}

/// P and Q of G64 hold for the moves behind it, in the unit of its block, until another word for the path; a program of another control
/// states none.
#[test]
fn the_tolerance_of_g64_holds_for_the_moves_behind_it() {
    let of = |text: &str, dialect| {
        let read = read_part_with("p.nc", text, ReadOptions { dialect, ..ReadOptions::default() }).unwrap();
        let one = |from: &ToleranceFrom| {
            (from.first_move, from.tolerance.map(|tolerance| [tolerance.rounding_mm, tolerance.merging_mm]))
        };
        read.tolerances.iter().map(one).collect::<Vec<_>>()
    };
    let linuxcnc = Some(Dialect::LinuxCnc);
    let path = |word: &str| format!("G0 X0 Y0 F600\nG1 X1\n{word}\nY1\nG0 Z1\n");
    for (word, expected) in [
        ("G64 P0.05", Some([0.05, 0.05])),
        ("G64 P0.05 Q0.02", Some([0.05, 0.02])),
        ("G64 P0.05 Q0", Some([0.05, 0.0])),
        ("G64 P0.05 Q-1", Some([0.05, 0.05])),
        ("G20 G64 P0.01\nG21", Some([0.254, 0.254])),
        ("G64 P0.01 G20\nG21", Some([0.254, 0.254])),
        ("G20\nG64 P0.01 G21", Some([0.01, 0.01])),
        ("G64", None),
        ("G64 P0", None),
        ("G64 P-1", None),
        ("G64 Q0.05", None),
        ("G61", None),
    ] {
        let expected: Vec<_> = expected.map(|tolerance| (1, Some(tolerance))).into_iter().collect();
        for dialect in [linuxcnc, None] {
            assert_eq!(of(&path(word), dialect), expected, "{word}");
        }
    }
    for end in ["G64", "G61", "G61.1", "G64 P0"] {
        let text = format!("G64 P0.05\n{}G1 X3\n", path(end));
        assert_eq!(of(&text, linuxcnc), [(0, Some([0.05; 2])), (1, None)], "{end}");
    }
    let twice = format!("G64 P0.05\n{}", path("G64 P0.05\nX3\nG64 P0.1"));
    assert_eq!(of(&twice, linuxcnc), [(0, Some([0.05; 2])), (2, Some([0.1; 2]))]);
    // A word that no move follows changes nothing.
    assert_eq!(of("G0 X0 Y0 F600\nG1 X1\nG64 P0.05\n", linuxcnc), []);
    for dialect in [Dialect::Fanuc, Dialect::Siemens] {
        assert_eq!(of(&path("G64"), Some(dialect)), []);
    }
}

/// Under compensation moves wait for those behind them.
#[test]
fn the_tolerance_of_g64_is_that_of_moves_that_wait() {
    let text = "G0 X0 Y0\nG64 P0.05\nG41.1 D2 G1 X10 Y10 F600\nX20\nG64 P0.1\nX30\nY20\nG40\nX40\n";
    let options = ReadOptions { dialect: Some(Dialect::LinuxCnc), ..ReadOptions::default() };
    let read = read_part_with("p.nc", text, options).unwrap();
    let lines: Vec<_> = read.tolerances.iter().map(|from| read.moves[from.first_move].line).collect();
    assert_eq!(lines, [3, 6]);
}

/// Without a dialect given, only a spline tells that G61 meant something else.
#[test]
fn a_g61_before_the_first_spline_of_linuxcnc_is_warned_of() {
    let text = LINUXCNC.replace("G0 X0 Y0", "G61 G0 X0 Y0");
    assert_ne!(text, LINUXCNC);
    let warned = |text: &str, dialect| {
        let part =
            read_part_with("p.nc", text, ReadOptions { dialect, lenient: false, ..ReadOptions::default() })
                .unwrap();
        part.warnings.iter().filter(|warning| warning.message.starts_with("G61 before this")).count()
    };
    assert_eq!(
        (warned(&text, None), warned(&text, Some(Dialect::LinuxCnc)), warned(LINUXCNC, None)),
        (1, 0, 0)
    );
}

#[test]
fn a_curve_that_ends_in_a_doubled_point_keeps_its_stop() {
    let text = "[curve]\ndegree = 1\ncontrol_points_mm = [[0, 0], [10, 0], [10, 5], [10, 5]]\n\
                knots = [0, 0, 1, 2, 3, 3]\nexact_stop = true\n";
    let part = part(text);
    for text in
        [write_g5_2(&part).unwrap(), write_g06_2(&part).unwrap(), write_g1(&part, 0.01, None).unwrap()]
    {
        assert_eq!(stops(&text, None).iter().filter(|stop| **stop).count(), 1, "{text}");
    }
    let rapid = text.replace("exact_stop", "move = \"rapid\"\nexact_stop");
    let errors = read_part("p.toml", &rapid).unwrap_err();
    assert!(
        errors.to_string().contains("p.toml:6:14")
            && errors.to_string().contains("`exact_stop` of a rapid move"),
        "{errors}"
    );
}

/// The place of the tool before the program is unknown: a rapid move straight down could end in the clamps.
#[test]
fn a_written_program_goes_down_where_it_begins_to_cut() {
    let down = part("G0 X50 Y0\nG1 Z-2 F300\nX60\nY10\n");
    let text = write_g1(&down, 0.01, None).unwrap();
    assert!(text.starts_with("G21 G90 G94\nG0 X50. Y0.\nG1 Z-2. F300.\nG1 X60. Y0. Z-2.\n"), "{text}");
    let up = part("G0 X50 Y0 Z5\nG1 Z-2 F300\nX60\n");
    let text = write_g1(&up, 0.01, None).unwrap();
    assert!(text.starts_with("G21 G90 G94\nG0 Z5.\nG0 X50. Y0. Z5.\nG1 X50. Y0. Z-2. F300.\n"), "{text}");
    for before in [down, up] {
        assert_eq!(part(&write_g1(&before, 0.01, None).unwrap()).curves, before.curves);
    }
}

/// As LinuxCNC 2.10 comes with them: G6.2 in front of the closing knots, and Q. The same curve as FANUC's.
#[test]
fn g6_2_of_linuxcnc_is_that_of_fanuc() {
    let points = "X10 Y20 R2 K0\nX20 Y-3 R0.7 K0\nX30 Y16 R1 K0\n";
    let fanuc = part(&format!("G21 G0 X0 Y0\nG06.2 P4 K0 X0 Y0 R1.5 F600\n{points}K1\nK1\nK1\nK1\nG1 X31\n"));
    let closing = "G6.2 K1\n".repeat(4);
    let linuxcnc = part(&format!("G21 G0 X0 Y0\nG6.2 X0 Y0 R1.5 K0 P4 Q1 F600\n{points}{closing}G1 X31\n"));
    assert_eq!(linuxcnc.curves, fanuc.curves);
    assert_eq!(linuxcnc.curves.len(), 2);
}

#[test]
fn splines_of_linuxcnc_lie_in_any_plane() {
    let xy = "G5.2 X1 Y2 P1 L3\nX3 Y0 P2\nX4 Y1 P1\nG5.3\nG5 X6 Y2 I1 J0.5 P-1 Q0.25\nG5.1 X8 Y3 I1 J2\n";
    let in_xy = part(&format!("G0 X0 Y0 Z0\n{xy}"));
    for (plane, letters, axes) in [
        ("G18", [('X', 'X'), ('Y', 'Z'), ('J', 'K')], [0, 2]),
        ("G19", [('Y', 'Z'), ('X', 'Y'), ('J', 'K')], [1, 2]),
    ] {
        let mut text = xy.to_owned();
        for (from, to) in letters {
            text = text.replace(from, &to.to_string());
        }
        let text = if plane == "G19" { text.replace('I', "J") } else { text };
        let turned = part(&format!("G0 X0 Y0 Z0\n{plane}\n{text}"));
        for (a, b) in in_xy.curves.iter().zip(&turned.curves) {
            let seen = |point: &[f64; 3]| [point[axes[0]], point[axes[1]]];
            let expected: Vec<_> = a.control_points_mm().iter().map(|point| [point[0], point[1]]).collect();
            assert_eq!(
                b.control_points_mm().iter().map(seen).collect::<Vec<_>>(),
                expected,
                "{plane}\n{text}"
            );
        }
        assert_eq!(turned.curves.len(), 3);
    }
}
