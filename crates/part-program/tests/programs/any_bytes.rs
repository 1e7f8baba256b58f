//! For any bytes the readers return, and the parts that they return are valid.

use part_program::{
    Curve, Dialect, MoveKind, Part, ReadOptions, inspect, read_machine, read_part, read_part_bytes,
    write_g5_2, write_g06_2,
};
use proptest::prelude::*;

/// Pieces of programs and files, which reach further in than random bytes do.
const PIECES: [&str; 44] = [
    "G0",
    "G1",
    "G2",
    "G3",
    "G5",
    "G5.1",
    "G5.2",
    "G5.3",
    "G06.2",
    "G05P10000",
    "G17",
    "G18",
    "G19",
    "G20",
    "G90",
    "G91",
    "G93",
    "G90.1",
    "BSPLINE",
    "SD=2",
    "PW=2",
    "PL=1",
    "CR=5",
    "X",
    "Y",
    "Z",
    "I",
    "J",
    "K",
    "R",
    "P",
    "L",
    "F",
    "0",
    "1",
    "-2.5",
    "99999999999",
    "1e5",
    "(",
    ")",
    ";",
    "\n",
    "\n",
    " ",
];

/// Lines of programs that compute, which loops and calls lead into one another; the fuzz target takes them, too.
const LINES: &str = include_str!("computed_lines.txt");

/// Pieces of what LinuxCNC's interpreter prints.
const CANON_PIECES: [&str; 31] = [
    "\n    1 N..... STRAIGHT_FEED(",
    "\n    2 N10    STRAIGHT_FEED(",
    "\n    3 N..... STRAIGHT_TRAVERSE(",
    "\n    4 N..... ARC_FEED(",
    "\n    5 N..... ARC_FEED(10.0000, 0.0000, 5.0000, 0.0000, ",
    "\n    6 N1234567USE_LENGTH_UNITS(CANON_UNITS_INCHES)",
    "\n    7 N..... SELECT_PLANE(CANON_PLANE_XZ)",
    "\n    8 N..... SELECT_PLANE(",
    "\n    9 N..... SET_G5X_OFFSET(1, ",
    "\n   10 N..... SET_XY_ROTATION(",
    "\n   11 N..... USE_TOOL_LENGTH_OFFSET(0.0000 0.0000 1.0000, ",
    "\n   12 N..... SET_FEED_RATE(",
    "\n   13 N..... SET_MOTION_CONTROL_MODE(CANON_EXACT_PATH)",
    "\n   14 N..... RIGID_TAP(",
    "\n   15 N..... NURBS_FEED(4, ...)",
    "\n   16 N..... DWELL(1.0000)",
    "\n   17 N..... SET_SPINDLE_SPEED(0, ",
    "\n   18 N..... PROGRAM_END()",
    "\n   19 N..... ",
    "0.0000, ",
    "0.0000, 0.0000, 0.0000)",
    "10.0000, ",
    "-2.5000, ",
    "1e300, ",
    "99999999.0000, ",
    "nan, ",
    "1, ",
    "-3, ",
    ")",
    "é",
    "executing",
];

fn options() -> impl Strategy<Value = ReadOptions> {
    let dialect = prop::option::of(prop::sample::select(Dialect::ALL.to_vec()));
    (dialect, any::<bool>()).prop_map(|(dialect, lenient)| ReadOptions {
        dialect,
        lenient,
        ..ReadOptions::default()
    })
}

/// Most curves that are written and read back; programs that repeat lines make more than a test has time for.
const MAX_CURVES: usize = 2_000;

fn curves_at_feed(part: &Part) -> Vec<&Curve> {
    let feed = part.curves.iter().zip(&part.moves).filter(|(_, one)| one.kind == MoveKind::Feed);
    feed.map(|(curve, _)| curve).collect()
}

fn returns(bytes: &[u8], options: ReadOptions) -> Result<(), TestCaseError> {
    match read_part_bytes("any", bytes, options) {
        Ok(part) => {
            prop_assert!(!part.curves.is_empty());
            prop_assert_eq!(part.curves.len(), part.moves.len());
            for curve in &part.curves {
                prop_assert_eq!(curve.faults(), []);
            }
            if part.curves.len() > MAX_CURVES {
                return Ok(());
            }
            drop(inspect(&part));
            drop(write_g5_2(&part));
            // The written text is a program of the same path.
            if let Ok(text) = write_g06_2(&part) {
                match read_part("again", &text) {
                    Ok(again) => {
                        prop_assert_eq!(curves_at_feed(&again), curves_at_feed(&part), "{}", text)
                    }
                    Err(errors) => prop_assert!(curves_at_feed(&part).is_empty(), "{errors}\n{text}"),
                }
            }
        }
        Err(errors) => {
            prop_assert!(errors.count() > 0);
            prop_assert!(!errors.to_string().is_empty());
        }
    }
    Ok(())
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]

    #[test]
    fn bytes(bytes in prop::collection::vec(any::<u8>(), 0..300), options in options()) {
        returns(&bytes, options)?;
    }

    #[test]
    fn pieces(pieces in prop::collection::vec(prop::sample::select(PIECES.to_vec()), 0..120), options in options()) {
        returns(pieces.concat().as_bytes(), options)?;
    }

    #[test]
    fn numbered_pieces(
        pieces in prop::collection::vec((prop::sample::select(PIECES.to_vec()), -30..30_i32), 0..120),
        options in options(),
    ) {
        let text: String = pieces.iter().map(|(piece, n)| match piece.len() {
            1 if piece.chars().all(char::is_alphabetic) => format!("{piece}{n}"),
            _ => format!("{piece} "),
        }).collect();
        returns(text.as_bytes(), options)?;
    }

    #[test]
    fn canon(pieces in prop::collection::vec(prop::sample::select(CANON_PIECES.to_vec()), 0..80), lenient: bool) {
        let text = format!("1 N..... ON_RESET(){}", pieces.concat());
        returns(text.as_bytes(), ReadOptions { dialect: None, lenient, ..ReadOptions::default() })?;
    }

    #[test]
    fn toml(text in "(\\[curve\\]|\\[machine\\]|degree|knots|weights|control_points_mm|=|\\[|\\]|[0-9.,e\\-]|nan|inf|\n|\\{|\\}|\"| ){0,60}") {
        returns(format!("[curve]\n{text}").as_bytes(), ReadOptions::default())?;
        drop(read_machine("any", &text));
    }
}

proptest! {
    // Some of these never end by themselves, and are stopped after two million lines.
    #![proptest_config(ProptestConfig::with_cases(200))]

    #[test]
    fn lines_that_compute(
        lines in prop::collection::vec(prop::sample::select(LINES.lines().collect::<Vec<_>>()), 0..40),
        options in options(),
    ) {
        returns(format!("G21 G0 X0 Y0 Z0\n{}\n", lines.join("\n")).as_bytes(), options)?;
    }
}

#[test]
fn latin_1_comments_are_read() {
    let program = b"(Fr\xe4sen)\nG0 X0\nG1 X5 (\xb0)\n";
    assert_eq!(read_part_bytes("p.nc", program, ReadOptions::default()).unwrap().curves.len(), 1);
    assert!(read_part("p.nc", "\u{feff}G0 X0\nG1 X5\n").is_ok());
}
