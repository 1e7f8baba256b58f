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
        ("G2 X20 I5 J0 L3\nX30 R9\nG1 X40\n", &[(3, [10.0, 0.0, 0.0]), (6, [40.0, 0.0, 0.0])]),
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
        let Ok(whole) = read_part_with("p.nc", &program(false), ReadOptions::default()) else { return Ok(()) };
        let text = program(true);
        let options = ReadOptions { lenient: true, ..ReadOptions::default() };
        // G92 at a place that is not known is refused.
        let Ok(kept) = read_part_with("p.nc", &text, options) else { return Ok(()) };
        let mut moves = whole.moves.iter().zip(&whole.curves);
        for (one, curve) in kept.moves.iter().zip(&kept.curves) {
            prop_assert!(
                moves.any(|(other, whole)| other.line == one.line && other.kind == one.kind && whole == curve),
                "line {}: {:?}\n{text}", one.line, curve
            );
        }
    }
}
