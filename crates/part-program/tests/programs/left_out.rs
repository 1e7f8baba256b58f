//! What lenient reading leaves out is a part of the path, and what it keeps is the path's: no move is invented or longer.

use part_program::{Curve, MoveKind, Part, ReadOptions, inspect, read_part_with};
use proptest::prelude::*;

fn read(text: &str, lenient: bool) -> Part {
    let options = ReadOptions { lenient, ..ReadOptions::default() };
    read_part_with("p.nc", text, options).unwrap_or_else(|errors| panic!("{text}\n{errors}"))
}

/// The moves that cut, by their lines.
fn cuts(part: &Part) -> Vec<(usize, [f64; 3])> {
    let end = |curve: &Curve| *curve.control_points_mm().last().unwrap();
    let moves = part.moves.iter().zip(&part.curves);
    moves.filter(|(one, _)| one.kind == MoveKind::Feed).map(|(one, curve)| (one.line, end(curve))).collect()
}

#[test]
fn behind_a_block_that_is_left_out_nothing_moves_until_its_axes_are_named() {
    let head = "G21 G90\nG0 X0 Y0 Z0\nG1 X10 F300\n";
    for (text, expected) in [
        (
            "G3 X0 Y10 I-10 J0 FOO=2\nG1 X5\nG1 Y7\nZ1\nX9\n",
            &[(3, [10.0, 0.0, 0.0]), (8, [9.0, 7.0, 1.0])][..],
        ),
        ("X20 Y5 FOO=1\nG91 X5 Y5 Z5\nG90 X1 Y1 Z1\nX2\n", &[(3, [10.0, 0.0, 0.0]), (7, [2.0, 1.0, 1.0])]),
        ("CYCLE84(1, 2)\nX20\nY5 Z0\nX30\n", &[(3, [10.0, 0.0, 0.0]), (7, [30.0, 5.0, 0.0])]),
        ("G1 X20 R5\nY5\nX30\nY6\n", &[(3, [10.0, 0.0, 0.0]), (5, [0.0; 3]), (7, [30.0, 6.0, 0.0])]),
        ("G2 X20 I5 J0 L3\nX30 R9\nG1 X40 Y0\nX41\n", &[(3, [10.0, 0.0, 0.0]), (7, [41.0, 0.0, 0.0])]),
        ("M98 P77\nX20\nX0 Y0 Z0\nX1\n", &[(3, [10.0, 0.0, 0.0]), (7, [1.0, 0.0, 0.0])]),
        (
            "G68 X0 Y0 R45\nX20 Y0 Z0\nX30\nG69\nX0 Y0 Z0\nX1\n",
            &[(3, [10.0, 0.0, 0.0]), (9, [1.0, 0.0, 0.0])],
        ),
        ("AROT RPL=30\nX20 Y0 Z0\nX30\nROT\nX0 Y0 Z0\nX1\n", &[(3, [10.0, 0.0, 0.0]), (9, [1.0, 0.0, 0.0])]),
        (
            "SCALE X2 Y2\nX0 Y0 Z0\nX30\nTRANS X5\nX0 Y0 Z0\nX1\n",
            &[(3, [10.0, 0.0, 0.0]), (9, [6.0, 0.0, 0.0])],
        ),
    ] {
        // What moves is where it is known to be; of a line that was left out, nothing is.
        let found = cuts(&read(&format!("{head}{text}"), true));
        let expected: Vec<_> =
            expected.iter().filter(|(line, _)| *line != 5 || text.starts_with("G3")).copied().collect();
        assert_eq!(found, expected, "{text}");
    }
}

/// Of two frames that are not read each lasts until its own end.
#[test]
fn each_frame_ends_by_its_own_word() {
    let head = "G21 G90\nG0 X0 Y0 Z0\nG1 X10 F300\n";
    for (frames, first_ends, second_ends) in [
        ("G68 X0 Y0 R45\nG51 X0 Y0 P2", "G69", "G50"),
        ("G68 X0 Y0 R45\nG51 X0 Y0 P2", "G50", "G69"),
        ("G51.1 X0\nG66 P77", "G67", "G50.1"),
        ("G16\nG68 X0 Y0 R45", "G15", "G69"),
        ("G68 X0 Y0 R45\nAROT RPL=30", "G69", "ROT"),
        ("SCALE X2\nTRANSMIT", "TRAFOOF", "SCALE"),
        ("MCALL CYCLE81(5, 0, 1, -3)\nCYCLE800(1, 2)", "MCALL", "CYCLE800()"),
    ] {
        let text =
            format!("{head}{frames}\nX20 Y0 Z0\n{first_ends}\nX5 Y5 Z5\nX6\n{second_ends}\nX0 Y0 Z0\nX1\n");
        assert_eq!(
            cuts(&read(&text, true)),
            [(3, [10.0, 0.0, 0.0]), (text.lines().count(), [1.0, 0.0, 0.0])],
            "{text}"
        );
    }
    // What is added to a frame that is not read ends with it.
    let text = format!("{head}SCALE X2\nATRANS X5\nX0 Y0 Z0\nX1\nTRANS\nX0 Y0 Z0\nX1\n");
    assert_eq!(cuts(&read(&text, true)), [(3, [10.0, 0.0, 0.0]), (10, [1.0, 0.0, 0.0])]);
}

/// A word that changes what the moves behind it mean, and that is left out, takes them with it until it ends.
#[test]
fn moves_of_another_meaning_are_left_out() {
    for (begin, end) in [
        ("MCALL CYCLE81(5, 0, 1, -3)", "MCALL"),
        ("CYCLE800(0,\"TC1\",100,57,0,0,0,0,30,0,0,0,0,-1)", "CYCLE800()"),
        ("TRANSMIT", "TRAFOOF"),
        ("TRACYL(40)", "TRAFOOF"),
        ("TRAORI", "TRAFOOF"),
        ("TOROT", "TOROTOF"),
        ("DIAMON", "DIAMOF"),
        ("GEOAX(3, Q)", "GEOAX()"),
        ("ASPLINE X3 Y4", "G1"),
        ("POLY X3 Y4", "G1"),
        ("G12.1", "G13.1"),
        ("G112", "G113"),
        ("G43.4 H1", "G49"),
        ("G54.1 P3", "G54"),
        ("G107 C20.", "G107 C0"),
        ("G16", "G15"),
    ] {
        let text = format!(
            "G21 G90\nG0 X0 Y0 Z0\nG1 X10 F300\n{begin}\nX20\nX30 Y0 Z0\nX40\n{end}\nG1 X0 Y0 Z0\nX1\n"
        );
        assert_eq!(
            cuts(&read(&text, true)),
            [(3, [10.0, 0.0, 0.0]), (text.lines().count(), [1.0, 0.0, 0.0])],
            "{text}"
        );
    }
}

/// Where Z alone is not known, a move that brings X and Y elsewhere without naming them loses them too.
#[test]
fn an_axis_that_moves_without_its_name_is_lost_too() {
    let head = "G21 G90\nG0 X0 Y0 Z0\nG1 X10 F300\nZ5 R9\n";
    for block in [
        "@20 ^30",
        "G3 I-10 J0 AR=90",
        "G91 G81 X3 Y1 Z-2 R1 L3\nG90",
        "G2 X20 I5 J0 FOO=3",
        "G5.7",
        "G31 X3",
    ] {
        let text = format!("{head}{block}\nG1 Z0\nX7\nX20 Y3 Z0\nX21\n");
        let found = cuts(&read(&text, true));
        let last = text.lines().count();
        assert_eq!(found, [(3, [10.0, 0.0, 0.0]), (last, [21.0, 3.0, 0.0])], "{text}");
    }
    // G33.1 comes back: where it is named to is not where it is.
    let text = format!("{head}S100 G33.1 X20 K1\nG1 Z0\nX21\n");
    assert_eq!(cuts(&read(&text, true)), [(3, [10.0, 0.0, 0.0]), (7, [21.0, 0.0, 0.0])]);
}

/// CT goes on as the move before it ends. If that was left out, it is nowhere to be seen, however near another move ended.
#[test]
fn an_arc_does_not_go_on_from_a_move_that_was_left_out() {
    let options = ReadOptions { lenient: true, ..ReadOptions::default() };
    for between in ["X20 FOO=1\nG0 X10 Y0 Z0\n", "CYCLE84(1)\nG0 X10 Y0 Z0\n", "G28 X10\nG0 X10\n"] {
        let text = format!("G0 X0 Y0 Z0\nG1 X10 F300\n{between}CT X20 Y10\n");
        let errors = read_part_with("p.mpf", &text, options).unwrap_err().to_string();
        assert!(errors.contains("CT behind no move"), "{text}\n{errors}");
    }
    // Neither does a corner that was to be rounded, nor a spline that goes on smoothly.
    let text = "G0 X0 Y0 Z0\nG1 X10 RND=2 F300\nX20 FOO=1\nG0 X10 Y0 Z0\nG1 Y10\n";
    assert_eq!(cuts(&read(text, true)), [(2, [10.0, 0.0, 0.0]), (5, [10.0, 10.0, 0.0])]);
    let text = "G0 X0 Y0 Z0 F300\nG5 X4 Y4 I1 J0 P0 Q-1\nX8 FOO=1 Y8 P0 Q1\nG0 X8 Y8 Z0\nG5 X9 Y9 P0 Q-1\n";
    let errors = read_part_with("p.ngc", text, options).unwrap_err().to_string();
    assert!(errors.contains("G5 without I and J"), "{errors}");
}

/// IC() counts from the place of the tool. On an axis that no block has named there is none: it is no place 0.
#[test]
fn an_increment_from_no_place_is_refused() {
    let text = "G90 G71\nG0 Y0 Z0\nG1 X=IC(5) F300\nX10\n";
    let errors = read_part_with("p.mpf", text, ReadOptions::default()).unwrap_err().to_string();
    assert!(
        errors.contains("p.mpf:3:4") && errors.contains("counts from a place that is not known"),
        "{errors}"
    );
    // A lenient reader moves only once the axis is named.
    let text = "G90 G71\nG0 Y0 Z0\nG1 X=IC(5) F300\nX10\nX12\n";
    assert_eq!(cuts(&read(text, true)), [(5, [12.0, 0.0, 0.0])]);
    // With --start it is known, and AC() names it in G91.
    let options = ReadOptions { start_mm: Some([1.0, 0.0, 0.0]), ..ReadOptions::default() };
    let part = read_part_with("p.mpf", "G90 G71\nG1 X=IC(5) F300\n", options).unwrap();
    assert_eq!(cuts(&part), [(2, [6.0, 0.0, 0.0])]);
    assert_eq!(
        cuts(&read("G91 F300\nG1 X=AC(5) Y2\nX1\n", false)),
        [(2, [5.0, 2.0, 0.0]), (3, [6.0, 2.0, 0.0])]
    );
}

/// A quarter and two turns of a helix, SINUMERIK's TRANS: the place is that of the shifted coordinates.
#[test]
fn a_shift_of_the_coordinates_is_no_move() {
    let text = "G17 G90 G71\nG0 X0 Y0 Z0\nG1 X10 F300\nTRANS X100 Y50\nG1 X0 Y0\nG1 X10\n";
    for lenient in [false, true] {
        let length = inspect(&read(text, lenient)).length_mm;
        let expected = 10.0 + 90.0_f64.hypot(50.0) + 10.0;
        assert!((length - expected).abs() < 1e-9, "{length}, not {expected}");
    }
    // ATRANS adds to it, TRANS replaces it on every axis, and alone it ends it.
    let text =
        "G0 X0 Y0 Z0\nTRANS X100 Y50\nATRANS X1 Z2\nG1 X0 Y0 Z0 F60\nTRANS Y7\nX0 Y0 Z0\nTRANS\nX0 Y0 Z0\n";
    let expected = [(4, [101.0, 50.0, 2.0]), (6, [0.0, 7.0, 0.0]), (8, [0.0; 3])];
    assert_eq!(cuts(&read(text, false)), expected);
    for word in ["ROT RPL=30", "AROT Z30", "SCALE X2", "MIRROR X0", "AMIRROR X0"] {
        let text = format!("G0 X0 Y0 Z0\n{word}\nG1 X9 F60\n");
        let errors = read_part_with("p.nc", &text, ReadOptions::default()).unwrap_err().to_string();
        assert!(errors.contains("turns or scales the coordinates") || word.contains('='), "{errors}");
    }
}

#[test]
fn coordinates_that_are_given_to_a_lost_place_are_refused() {
    let options = ReadOptions { lenient: true, ..ReadOptions::default() };
    let text = "G0 X0 Y0\nG1 X5 FOO=3 F60\nG92 X0\nX5\n";
    let errors = read_part_with("p.nc", text, options).unwrap_err().to_string();
    assert!(errors.contains("p.nc:3:1") && errors.contains("since a block was left out"), "{errors}");
}

/// A block of a program: its words, which a word that is not read may join.
fn block() -> impl Strategy<Value = String> {
    let number = -20_i32..20;
    let axes = prop::collection::vec(prop::option::of(number.clone()), 3).prop_map(|values| {
        let words = ["X", "Y", "Z"].iter().zip(values);
        words.filter_map(|(letter, value)| Some(format!("{letter}{}", value?))).collect::<Vec<_>>().join(" ")
    });
    prop_oneof![
        8 => (prop::sample::select(vec!["G0", "G1", "", "G1"]), axes.clone()).prop_map(|(word, axes)| format!("{word} {axes}")),
        2 => (prop::sample::select(vec!["G2", "G3"]), number.clone(), number.clone())
            .prop_map(|(word, x, y)| format!("{word} X{x} Y{y} R400\nG1")),
        2 => axes.clone().prop_map(|axes| format!("G90 G53 G0 {axes}\nG1 X1 Y1 Z1")),
        1 => (number.clone(), number).prop_map(|(x, y)| format!("G99 G81 X{x} Y{y} Z-30 R25\nX1\nG80 G1")),
        1 => axes.prop_map(|axes| format!("G92 {axes}\nG1")),
        1 => Just("G91".into()),
        1 => Just("G90".into()),
        1 => Just("G54".into()),
        1 => Just("G4 P1".into()),
    ]
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(400))]

    /// The same program with words in some of its blocks that change nothing, and that the reader does not know.
    #[test]
    fn what_moves_is_a_part_of_the_path(
        blocks in prop::collection::vec((block(), prop::option::weighted(0.2, prop::sample::select(vec![
            "FOO=3", "TURN0=1", "COMPXY", "G5.7", "~", "SUB7(1, 2)", "G44.3",
        ]))), 1..30),
    ) {
        let program = |with: bool| {
            let mut text = "G21 G90 F600\nG0 X0 Y0 Z0\nG1 X1 Y1 Z1\n".to_owned();
            for (block, word) in &blocks {
                match word {
                    Some(word) if with => text += &block.replacen('\n', &format!(" {word}\n"), 1),
                    _ => text += block,
                }
                if with && !block.contains('\n') {
                    text += &word.map_or(String::new(), |word| format!(" {word}"));
                }
                text.push('\n');
            }
            text
        };
        let whole = read_part_with("p.nc", &program(false), ReadOptions::default())
            .map_err(|errors| TestCaseError::reject(errors.to_string()))?;
        let text = program(true);
        let options = ReadOptions { lenient: true, ..ReadOptions::default() };
        // G92 at a place that is not known is refused.
        let kept =
            read_part_with("p.nc", &text, options).map_err(|errors| TestCaseError::reject(errors.to_string()))?;
        let mut moves = whole.moves.iter().zip(&whole.curves);
        for (one, curve) in kept.moves.iter().zip(&kept.curves) {
            prop_assert!(
                moves.any(|(other, whole)| other.line == one.line && other.kind == one.kind && whole == curve),
                "line {}: {:?}\n{text}", one.line, curve
            );
        }
    }
}
