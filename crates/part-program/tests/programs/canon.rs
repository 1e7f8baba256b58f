//! The output of LinuxCNC's interpreter for a program is read as the moves of the control.

use part_program::{
    Dialect, MoveKind, Part, ReadOptions, Rest, Shape, ToleranceFrom, bounding_box_mm, inspect, read_part,
    read_part_with,
};

/// The lines of these calls, as `rs274 -g` writes them.
fn canon(calls: &str) -> String {
    let lines = calls.lines().map(str::trim).filter(|call| !call.is_empty()).enumerate();
    lines.map(|(index, call)| format!("{:5} N..... {call}\n", index + 1)).collect()
}

/// A part, of calls without the end of a program.
fn part(calls: &str) -> Part {
    let text = canon(&format!("{calls}\nPROGRAM_END()"));
    read_part("p.canon", &text).unwrap_or_else(|errors| panic!("{errors}"))
}

fn ends(part: &Part) -> Vec<[f64; 3]> {
    part.curves.iter().map(|curve| *curve.control_points_mm().last().unwrap()).collect()
}

/// A program and what rs274 of LinuxCNC 2.9.0 prints of it.
const PROGRAM: &str =
    "G21 G17 G90\nG0 X0 Y0 Z5\nT1 M6\nS1000 M3\nG1 Z-1 F200\nX10\nG2 X20 Y0 I5 J0\nG3 X20 Y0 I5 J0 Z-3
G18\nG2 X30 Z-3 I5 K0\nG19\nG3 Y10 Z-3 J5 K0\nG17\nG61\nG1 X0\nG61.1\nG1 X1\nG64\nG1 X3\nM8\nG1 X7\nM2\n";
const PRINTED: &str = "executing
    1 N..... USE_LENGTH_UNITS(CANON_UNITS_MM)
    2 N..... SET_G5X_OFFSET(1, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)
    3 N..... SET_G92_OFFSET(0.0000, 0.0000, 0.0000, 0.0000, 0.0000, 0.0000)
    4 N..... SET_XY_ROTATION(0.0000)
    5 N..... SET_FEED_REFERENCE(CANON_XYZ)
    6 N..... ON_RESET()
    8 N..... SELECT_PLANE(CANON_PLANE_XY)
    9 N..... USE_LENGTH_UNITS(CANON_UNITS_MM)
   10 N..... STRAIGHT_TRAVERSE(0.0000, 0.0000, 5.0000, 0.0000, 0.0000, 0.0000)
   11 N..... SELECT_TOOL(1)
   12 N..... START_CHANGE()
   13 N..... STOP_SPINDLE_TURNING(0)
   14 N..... CHANGE_TOOL(1)
   15 N..... SET_SPINDLE_SPEED(0, 1000.0000)
   16 N..... START_SPINDLE_CLOCKWISE(0)
   17 N..... SET_FEED_RATE(200.0000)
   18 N..... STRAIGHT_FEED(0.0000, 0.0000, -1.0000, 0.0000, 0.0000, 0.0000)
   19 N..... STRAIGHT_FEED(10.0000, 0.0000, -1.0000, 0.0000, 0.0000, 0.0000)
   20 N..... ARC_FEED(20.0000, 0.0000, 15.0000, 0.0000, -1, -1.0000, 0.0000, 0.0000, 0.0000)
   21 N..... ARC_FEED(20.0000, 0.0000, 25.0000, 0.0000, 1, -3.0000, 0.0000, 0.0000, 0.0000)
   22 N..... SELECT_PLANE(CANON_PLANE_XZ)
   23 N..... ARC_FEED(-3.0000, 30.0000, -3.0000, 25.0000, -1, 0.0000, 0.0000, 0.0000, 0.0000)
   24 N..... SELECT_PLANE(CANON_PLANE_YZ)
   25 N..... ARC_FEED(10.0000, -3.0000, 5.0000, -3.0000, 1, 30.0000, 0.0000, 0.0000, 0.0000)
   26 N..... SELECT_PLANE(CANON_PLANE_XY)
   27 N..... SET_MOTION_CONTROL_MODE(CANON_EXACT_PATH)
   28 N..... STRAIGHT_FEED(0.0000, 10.0000, -3.0000, 0.0000, 0.0000, 0.0000)
   29 N..... SET_MOTION_CONTROL_MODE(CANON_EXACT_STOP)
   30 N..... STRAIGHT_FEED(1.0000, 10.0000, -3.0000, 0.0000, 0.0000, 0.0000)
   31 N..... SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, 0.000000)
   32 N..... SET_NAIVECAM_TOLERANCE(0.0000)
   33 N..... STRAIGHT_FEED(3.0000, 10.0000, -3.0000, 0.0000, 0.0000, 0.0000)
   35 N..... FLOOD_ON()
   36 N..... STRAIGHT_FEED(7.0000, 10.0000, -3.0000, 0.0000, 0.0000, 0.0000)
   37 N..... PROGRAM_END()
   38 N..... ON_RESET()
";

#[test]
fn what_is_printed_of_a_program_is_that_program() {
    let options = ReadOptions { dialect: Some(Dialect::LinuxCnc), lenient: false, ..ReadOptions::default() };
    let program = read_part_with("p.ngc", PROGRAM, options).unwrap();
    let printed = read_part("p.canon", PRINTED).unwrap();
    assert_eq!(printed.warnings, []);
    let numbers = |part: &Part| {
        let curves = part.curves.iter().map(|curve| (curve.degree(), curve.control_points_mm().to_vec()));
        curves.collect::<Vec<_>>()
    };
    assert_eq!(numbers(&printed), numbers(&program));
    let said = |part: &Part| {
        let moves = part.moves.iter().map(|one| (one.kind, one.shape, one.feedrate_mm_per_s, one.exact_stop));
        moves.collect::<Vec<_>>()
    };
    assert_eq!(said(&printed), said(&program));
    let rests = |part: &Part| (0..part.moves.len()).map(|next| part.rest_before(next)).collect::<Vec<_>>();
    assert_eq!(rests(&printed), rests(&program));
    assert_eq!(printed.approaches.len(), 1);
    assert_eq!(printed.moves[0].line, 18);
    let words: Vec<_> = printed.auxiliary.iter().map(|word| (word.letter, word.value)).collect();
    assert_eq!(
        words,
        [('T', 1.0), ('M', 5.0), ('M', 6.0), ('S', 1000.0), ('M', 3.0), ('M', 8.0), ('M', 2.0)]
    );
}

#[test]
fn units_are_those_in_force() {
    let part = part(
        "USE_LENGTH_UNITS(CANON_UNITS_INCHES)\nSTRAIGHT_TRAVERSE(1, 2, 3, 0, 0, 0)\nSET_FEED_RATE(10)
         STRAIGHT_FEED(2, 2, 3, 0, 0, 0)\nUSE_LENGTH_UNITS(CANON_UNITS_MM)\nSTRAIGHT_FEED(30, 50.8, 76.2, 0, 0, 0)
         SET_FEED_RATE(60)\nSTRAIGHT_FEED(31, 50.8, 76.2, 0, 0, 0)",
    );
    assert_eq!(ends(&part)[0][0], 50.8);
    assert_eq!(ends(&part)[1][0], 30.0);
    let feeds: Vec<_> = part.moves.iter().map(|one| one.feedrate_mm_per_s.unwrap()).collect();
    assert_eq!(feeds, [254.0 / 60.0, 254.0 / 60.0, 1.0]);
}

/// As printed of G64 P0.05, G64 P0.002 Q0.001 in inches, a cycle, which is cut in G61, and G64.
#[test]
fn the_tolerance_of_g64_is_printed_by_two_functions() {
    let part = part(
        "SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, 0.050000)\nSET_NAIVECAM_TOLERANCE(0.0500)\nSTRAIGHT_TRAVERSE(0, 0, 0, 0, 0, 0)
         STRAIGHT_FEED(1, 0, 0, 0, 0, 0)\nUSE_LENGTH_UNITS(CANON_UNITS_INCHES)
         SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, 0.002000)\nSET_NAIVECAM_TOLERANCE(0.0010)\nSTRAIGHT_FEED(1, 1, 0, 0, 0, 0)
         SET_MOTION_CONTROL_MODE(CANON_EXACT_PATH)\nSTRAIGHT_FEED(1, 1, 1, 0, 0, 0)
         SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, 0.002000)\nSTRAIGHT_FEED(1, 1, 2, 0, 0, 0)
         SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, 0.000000)\nSET_NAIVECAM_TOLERANCE(0.0000)\nSTRAIGHT_FEED(1, 2, 2, 0, 0, 0)",
    );
    let of = |from: &ToleranceFrom| {
        (from.first_move, from.tolerance.map(|tolerance| [tolerance.rounding_mm, tolerance.merging_mm]))
    };
    let second = Some([0.002 * 25.4, 0.001 * 25.4]);
    let found: Vec<_> = part.tolerances.iter().map(of).collect();
    assert_eq!(found, [(0, Some([0.05, 0.05])), (1, second), (2, None), (3, second), (4, None)]);
}

/// As printed of `G10 L2 P1 X10 Y20`, `G54`, `G0 X1 Y2 Z3`, `G92 X0`, `G1 X5`, `G92.1`, `G10 L2 P1 R90`, `G1 X1 Y0`.
#[test]
fn offsets_shift_what_comes_later() {
    let part = part(
        "SET_G5X_OFFSET(1, 10, 20, 30, 0, 0, 0)\nSTRAIGHT_TRAVERSE(1, 2, 3, 0, 0, 0)\nSET_FEED_RATE(60)
         SET_G92_OFFSET(1, 0, 0, 0, 0, 0)\nSTRAIGHT_FEED(5, 2, 3, 0, 0, 0)\nSET_G92_OFFSET(0, 0, 0, 0, 0, 0)
         SET_XY_ROTATION(90)\nSTRAIGHT_FEED(1, 0, 3, 0, 0, 0)
         ARC_FEED(3, 0, 2, 0, -1, 3, 0, 0, 0)",
    );
    let [shifted, turned, arc] = [0, 1, 2].map(|index| ends(&part)[index]);
    assert_eq!(part.curves[0].control_points_mm()[0], [1.0, 2.0, 3.0]);
    assert_eq!(shifted, [6.0, 2.0, 3.0]);
    let is_near = |p: [f64; 3], q: [f64; 3]| (0..3).all(|axis| (p[axis] - q[axis]).abs() < 1e-12);
    assert!(is_near(turned, [0.0, 1.0, 3.0]) && is_near(arc, [0.0, 3.0, 3.0]), "{turned:?} {arc:?}");
    // Clockwise from (0, 1) to (0, 3) is by negative X.
    let (low, high) = bounding_box_mm(part.curves.get(2..).unwrap()).unwrap();
    assert!((low[0] + 1.0).abs() < 1e-9 && high[0].abs() < 1e-9, "{low:?} {high:?}");
}

/// A half circle in XZ, turned by 90° about Z: it is one in YZ.
#[test]
fn a_rotation_turns_the_planes_of_arcs() {
    let part = part(
        "STRAIGHT_TRAVERSE(0, 1, 0, 0, 0, 0)\nSET_XY_ROTATION(90)\nSELECT_PLANE(CANON_PLANE_XZ)\nSTRAIGHT_TRAVERSE(1, 0, 0, 0, 0, 0)\nSET_FEED_RATE(60)
         ARC_FEED(0, 3, 0, 2, 1, 0, 0, 0, 0)\nSTRAIGHT_FEED(4, 0, 0, 0, 0, 0)",
    );
    assert_eq!(part.rest_before(2), None);
    let (low, high) = bounding_box_mm(&part.curves[1..2]).unwrap();
    let is_near = |p: [f64; 3], q: [f64; 3]| (0..3).all(|axis| (p[axis] - q[axis]).abs() < 1e-9);
    // Counterclockwise in G18 goes from Z to X: from the centre it begins at negative X, and goes over positive Z.
    assert!(is_near(low, [0.0, 1.0, 0.0]) && is_near(high, [0.0, 3.0, 1.0]), "{low:?} {high:?}");
}

#[test]
fn another_tool_length_moves_the_tip_and_not_the_machine() {
    let part = part(
        "STRAIGHT_TRAVERSE(0, 0, 5, 0, 0, 0)\nSET_FEED_RATE(60)\nSTRAIGHT_FEED(1, 0, 5, 0, 0, 0)
         USE_TOOL_LENGTH_OFFSET(0 0 7, 0 0 0, 0 0 0)\nSTRAIGHT_FEED(2, 0, -2, 0, 0, 0)",
    );
    assert_eq!(part.curves[1].control_points_mm(), [[1.0, 0.0, -2.0], [2.0, 0.0, -2.0]]);
    assert_eq!(part.rest_before(1), Some(Rest::Gap));
}

#[test]
fn arcs_off_their_circle_and_of_several_turns_are_taken() {
    let part = part(
        "STRAIGHT_TRAVERSE(10, 0, 0, 0, 0, 0)\nSET_FEED_RATE(60)\nARC_FEED(0.0001, 10.0001, 0, 0, 1, 0, 0, 0, 0)
         ARC_FEED(10.3, 0, 0, 0, 1, 0, 0, 0, 0)\nARC_FEED(0, 10.3, 0, 0, 3, 9, 0, 0, 0)",
    );
    let sweeps: Vec<_> = part.curves.iter().map(|curve| inspect_length(curve.clone()) / 10.0).collect();
    let quarter = std::f64::consts::FRAC_PI_2;
    for (sweep, turn) in sweeps.iter().zip([1.0, 3.0, 4.0, 4.0, 1.0]) {
        assert!((sweep - turn * quarter).abs() < 0.05 * turn * quarter, "{sweeps:?}");
    }
    let heights: Vec<_> = ends(&part).iter().map(|end| end[2]).collect();
    assert_eq!(heights, [0.0, 0.0, 4.0, 8.0, 9.0]);
}

fn inspect_length(curve: part_program::Curve) -> f64 {
    let one = part_program::Move {
        kind: MoveKind::Feed,
        shape: Shape::Arc,
        feedrate_mm_per_s: None,
        exact_stop: false,
        line: 1,
        block: 1,
    };
    inspect(&Part { curves: vec![curve], moves: vec![one], ..Part::default() }).length_mm
}

#[test]
fn moves_by_the_revolution_have_no_feed() {
    let part = part(
        "STRAIGHT_TRAVERSE(0, 0, 5, 0, 0, 0)\nSET_FEED_MODE(0, 1)\nSET_FEED_RATE(0.1)\nSTRAIGHT_FEED(1, 0, 5, 0, 0, 0)
         SET_FEED_MODE(0, 0)\nSET_FEED_RATE(0)\nSET_FEED_RATE(60)\nSTRAIGHT_FEED(2, 0, 5, 0, 0, 0)
         START_SPEED_FEED_SYNC(1.000000,0)\nSTRAIGHT_FEED(2, 0, 0, 0, 0, 0)\nRIGID_TAP(2, 0, -3)\nSTOP_SPEED_FEED_SYNCH()
         STRAIGHT_FEED(3, 0, 0, 0, 0, 0)",
    );
    let feeds: Vec<_> = part.moves.iter().map(|one| one.feedrate_mm_per_s).collect();
    assert_eq!(feeds, [None, Some(1.0), None, None, None, Some(1.0)]);
    assert_eq!(ends(&part)[3..5], [[2.0, 0.0, -3.0], [2.0, 0.0, 0.0]]);
    assert_eq!(part.warnings.len(), 1);
}

#[test]
fn rotary_axes_are_said_once() {
    let begin = "STRAIGHT_TRAVERSE(0, 0, 0, 0, 0, 0)\nSET_FEED_RATE(60)\nSTRAIGHT_FEED(1, 0, 0, 5, 0, 0)
        STRAIGHT_TRAVERSE(1, 0, 0, 9, 0, 0)\nSTRAIGHT_FEED(2, 0, 0, 7, 0, 0)\n";
    let part = part(begin);
    assert_eq!((part.curves.len(), part.warnings.len()), (2, 1));
    let text = canon(&format!("{begin}STRAIGHT_FEED(2, 0, 0, 70, 0, 0)\nPROGRAM_END()"));
    let errors = read_part("p.canon", &text).unwrap_err();
    assert!(errors.to_string().contains("a cut by rotary axes alone"), "{errors}");
    let options = ReadOptions { dialect: Some(Dialect::Canon), lenient: true, ..ReadOptions::default() };
    assert_eq!(read_part_with("p.canon", &text, options).unwrap().curves.len(), 2);
}

#[test]
fn a_dwell_is_a_rest() {
    let part = part(
        "STRAIGHT_TRAVERSE(0, 0, 0, 0, 0, 0)\nSTRAIGHT_FEED(1, 0, 0, 0, 0, 0)\nDWELL(0.5000)
         STRAIGHT_FEED(2, 0, 0, 0, 0, 0)\nSTRAIGHT_FEED(3, 0, 0, 0, 0, 0)",
    );
    assert_eq!([1, 2].map(|next| part.rest_before(next)), [Some(Rest::ExactStop), None]);
}

/// A spline is refused, since its points are not printed; if it is skipped, the path goes on behind it.
#[test]
fn a_move_whose_end_is_not_printed_is_not_read() {
    let text = canon(
        "STRAIGHT_TRAVERSE(0, 0, 0, 0, 0, 0)\nSET_FEED_RATE(60)\nSTRAIGHT_FEED(1, 0, 0, 0, 0, 0)\nNURBS_FEED(4, ...)
         STRAIGHT_FEED(9, 0, 0, 0, 0, 0)\nSTRAIGHT_FEED(10, 0, 0, 0, 0, 0)\nPROGRAM_END()",
    );
    assert!(read_part("p.canon", &text).unwrap_err().to_string().contains("p.canon:4:14"));
    let options = ReadOptions { dialect: None, lenient: true, ..ReadOptions::default() };
    let part = read_part_with("p.canon", &text, options).unwrap();
    assert_eq!(ends(&part), [[1.0, 0.0, 0.0], [10.0, 0.0, 0.0]]);
    assert_eq!((part.approaches.len(), part.approaches[1].line), (2, 5));
}

#[test]
fn an_early_end_and_other_lines_are_said() {
    let text = canon("STRAIGHT_TRAVERSE(0, 0, 0, 0, 0, 0)\nSTRAIGHT_FEED(1, 0, 0, 0, 0, 0)");
    let part = read_part("p.canon", &format!("{text} hello\n hello\nUnknown g code used\n")).unwrap();
    let said: Vec<_> = part.warnings.iter().map(|said| (said.line, said.message.as_str())).collect();
    assert_eq!(said.len(), 2, "{said:?}");
    assert!(said[0].0 == 3 && said[0].1.contains("no canonical function"), "{said:?}");
    assert!(said[1].1.contains("PROGRAM_END"), "{said:?}");
}

/// Calls, and what is said of the second line.
const MALFORMED: [(&str, &str); 23] = [
    ("STRAIGHT_FEED(1, 2)", "`STRAIGHT_FEED` is not as rs274 prints it"),
    ("STRAIGHT_FEED(1, 2, three)", "is not as rs274 prints it"),
    ("STRAIGHT_FEED(1, 2, nan)", "is not as rs274 prints it"),
    ("STRAIGHT_FEED(1, 2, 3", "is not as rs274 prints it"),
    ("STRAIGHT_FEED(1, 2, 30000000)", "a coordinate is out of range"),
    ("ARC_FEED(1, 2, 3, 4, 5)", "is not as rs274 prints it"),
    ("ARC_FEED(1, 2, 3, 4, 0, 5)", "is not as rs274 prints it"),
    ("ARC_FEED(1, 2, 3, 4, 1.5, 5)", "is not as rs274 prints it"),
    ("ARC_FEED(1, 2, 3, 4, 1001, 5)", "is not as rs274 prints it"),
    ("USE_LENGTH_UNITS(UNKNOWN)", "is not as rs274 prints it"),
    ("SELECT_PLANE(CANON_PLANE_UV)", "is not as rs274 prints it"),
    ("SET_G5X_OFFSET(1, 2, 3)", "is not as rs274 prints it"),
    ("USE_TOOL_LENGTH_OFFSET(1)", "is not as rs274 prints it"),
    ("SET_XY_ROTATION()", "is not as rs274 prints it"),
    ("SET_FEED_RATE(-1)", "is not as rs274 prints it"),
    ("SET_FEED_MODE(0, 7)", "is not as rs274 prints it"),
    ("SET_MOTION_CONTROL_MODE(UNKNOWN)", "is not as rs274 prints it"),
    ("SET_MOTION_CONTROL_MODE(CANON_CONTINUOUS, wide)", "is not as rs274 prints it"),
    ("SET_NAIVECAM_TOLERANCE(wide)", "is not as rs274 prints it"),
    ("SET_SPINDLE_SPEED()", "is not as rs274 prints it"),
    ("STRAIGHT_PROBE(1, 2, 3, 0, 0, 0)", "a probing move"),
    ("TELEPORT(1, 2, 3)", "the canonical function `TELEPORT` is not known"),
    ("CANON_ERROR(no)", "the interpreter found an error here"),
];

#[test]
fn what_is_malformed_is_said_where_it_stands() {
    for (call, message) in MALFORMED {
        let text =
            canon(&format!("STRAIGHT_TRAVERSE(0, 0, 0)\n{call}\nSTRAIGHT_FEED(7, 7, 7)\nPROGRAM_END()"));
        let errors = read_part("p.canon", &text).map(|part| part.warnings).unwrap_err();
        let first = errors.iter().next().unwrap();
        assert!(first.message.contains(message), "{call}: {first}");
        assert_eq!((first.line, first.column), (2, 14), "{call}: {first}");
    }
}

#[test]
fn an_arc_from_nowhere_and_a_text_without_moves_are_refused() {
    let errors = read_part("p.canon", &canon("ARC_FEED(1, 2, 3, 4, 1, 5)\nPROGRAM_END()")).unwrap_err();
    assert!(errors.to_string().contains("where this arc starts is not known"), "{errors}");
    let errors = read_part("p.canon", &canon("ON_RESET()\nPROGRAM_END()")).unwrap_err();
    assert!(errors.to_string().contains("the program holds no curve"), "{errors}");
}

/// A part program is not taken for what rs274 prints, nor the other way round.
#[test]
fn a_text_is_told_by_its_content() {
    assert!(read_part("p.nc", "10 N..... G1 X5\n").is_err());
    assert_eq!(read_part("p.nc", "N10 G0 X0 (FEED)\nN20 G1 X5\n").unwrap().curves.len(), 1);
    let options = ReadOptions { dialect: Some(Dialect::Fanuc), lenient: false, ..ReadOptions::default() };
    assert!(read_part_with("p.canon", PRINTED, options).is_ok());
    let options = ReadOptions { dialect: Some(Dialect::Canon), lenient: false, ..ReadOptions::default() };
    assert!(read_part_with("p.nc", "G0 X0\nG1 X5\n", options).is_err());
}
