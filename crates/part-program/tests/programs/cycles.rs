//! Drilling cycles and shifted coordinates: the moves that LinuxCNC's `rs274` prints for the same blocks.

use part_program::{Dialect, MoveKind, Part, ReadOptions, read_part_with};

fn linuxcnc(text: &str) -> Part {
    let options = ReadOptions { dialect: Some(Dialect::LinuxCnc), ..ReadOptions::default() };
    read_part_with("p.ngc", text, options).unwrap_or_else(|errors| panic!("{errors}\n{text}"))
}

/// The moves behind a start at X0 Y0 Z5, each with its end, and `F` at feed.
fn moves(text: &str) -> Vec<String> {
    let part = linuxcnc(&format!("G21 G90 S500\nG0 X0 Y0 Z5\nF100\n{text}"));
    let lines = part.moves.iter().zip(&part.curves).map(|(one, curve)| {
        let [x, y, z] = curve.control_points_mm()[1];
        let round = |x: f64| (x * 1e4).round() / 1e4 + 0.0;
        format!("{}{} {} {}", if one.kind == MoveKind::Feed { "F" } else { "" }, round(x), round(y), round(z))
    });
    lines.collect()
}

#[test]
fn cycles_are_the_moves_of_rs274() {
    for (text, expected) in [
        (
            "G83 X1 Y1 Z-3 R2 Q1.2",
            "1 1 5|1 1 2|F1 1 0.8|1 1 2|1 1 1.054|F1 1 -0.4|1 1 2|1 1 -0.146|F1 1 -1.6|1 1 2|1 1 -1.346|F1 1 -2.8|1 1 2|\
             1 1 -2.546|F1 1 -3|1 1 2",
        ),
        (
            "G73 X3 Z-3 R2 Q1.2",
            "3 0 5|3 0 2|F3 0 0.8|3 0 1.054|F3 0 -0.4|3 0 -0.146|F3 0 -1.6|3 0 -1.346|F3 0 -2.8|3 0 -2.546|F3 0 -3|3 0 2",
        ),
        ("G82 X4 Z-1 R1 P0.5\nX6", "4 0 5|4 0 1|F4 0 -1|4 0 1|6 0 1|F6 0 -1|6 0 1"),
        ("G91 G98 G81 X1 Z-2 R-1 L2", "1 0 5|1 0 4|F1 0 2|1 0 5|2 0 5|2 0 4|F2 0 2|2 0 5"),
        ("G98 G85 X5 Z-1 R1", "5 0 5|5 0 1|F5 0 -1|F5 0 1|5 0 5"),
        ("G84 X7 Z-1 R1", "7 0 5|7 0 1|F7 0 -1|F7 0 1"),
        ("G0 Z0\nG99 G81 X2 Z-1 R1", "0 0 0|0 0 1|2 0 1|F2 0 -1|2 0 1"),
        ("G18 G81 X1 Z3 Y-1 R1", "0 1 5|1 1 3|F1 -1 3|1 1 3"),
    ] {
        let expected: Vec<_> = expected.split('|').collect();
        assert_eq!(moves(text), expected, "{text}");
    }
}

#[test]
fn a_cycle_goes_on_until_another_motion() {
    assert_eq!(
        moves("G81 Z-1 R1\nM8\nX2\nG80\nG1 X3"),
        ["0 0 1", "F0 0 -1", "0 0 1", "2 0 1", "F2 0 -1", "2 0 1", "F3 0 1"]
    );
}

#[test]
fn a_thread_moves_with_the_spindle() {
    let part = linuxcnc("G21 G0 X0 Y0 Z5\nS300 M3\nG33 Z-2 K1.5\nG33.1 Z-4 K1\nG1 X1 F60\n");
    let feeds: Vec<_> = part.moves.iter().map(|one| one.feedrate_mm_per_s).collect();
    assert_eq!(feeds, [7.5, 5.0, 5.0, 1.0].map(Some));
    assert_eq!(part.curves[3].control_points_mm(), [[0.0, 0.0, -2.0], [1.0, 0.0, -2.0]]);
}

/// A part is in the coordinates that held first; later shifts are made in them.
#[test]
fn shifts_move_what_follows_them() {
    for (text, expected) in [
        ("G10 L2 P2 X100\nG55 G1 X1 Y0\nG54 G1 X2", "F101 0 5|F2 0 5"),
        ("G92 X10\nG1 X11\nG92.2\nG1 X2\nG92.3 G1 X13\nG92.1 G1 X4", "F1 0 5|F2 0 5|F3 0 5|F4 0 5"),
        ("G52 X10\nG1 X11\nG52 Y5\nG91 G1 X1\nG90 G52 X0 Y0\nG1 X3 Y1", "F21 0 5|F22 0 5|F3 1 5"),
        ("G52 X10\nG92 X100\nG1 X101\nG52 X-1\nX0", "F1 0 5|F-1 0 5"),
        // What G92.3 takes up is what was written last, whether or not it was put aside.
        ("G92 X10\nG92.3\nG1 X11\nG92.2\nG92.2\nG1 X2\nG92.3\nG1 X13", "F1 0 5|F2 0 5|F3 0 5"),
        ("G10 L20 P1 X3\nG1 X4 Y1", "F1 1 5"),
        ("G92 X1\nG2 X3 I1", "F2 0 5"),
    ] {
        let part = linuxcnc(&format!("G21 G90\nG0 X0 Y0 Z5\nF100\n{text}\n"));
        let ends: Vec<_> = part
            .curves
            .iter()
            .map(|curve| {
                curve.control_points_mm()[curve.control_points_mm().len() - 1]
                    .map(|x| (x * 1e9).round() / 1e9 + 0.0)
            })
            .map(|[x, y, z]| format!("F{x} {y} {z}"))
            .collect();
        assert_eq!(ends, expected.split('|').collect::<Vec<_>>(), "{text}");
    }
}

/// The machine's own places are unknown: a move to such a place is not a curve, nor is a move away from it.
#[test]
fn places_of_the_machine_are_not_known() {
    // Y was not sent there, and moves on.
    assert_eq!(moves("G28 X8 Z9\nG0 X1 Y1 Z1\nG1 X2"), ["8 0 9", "1 1 1", "F2 1 1"]);
    assert_eq!(moves("G53 G0 Z0\nG0 X3 Y3\nZ2\nG1 X4"), ["3 3 2", "F4 3 2"]);
}

/// Offsets that are set before the first move are where the part begins, and those behind it turn and shift what follows.
#[test]
fn a_part_has_the_coordinates_of_its_first_move() {
    let ends = |text: &str| {
        let part = linuxcnc(&format!("G21 G90 F100\n{text}\n"));
        let last =
            |curve: &part_program::Curve| curve.control_points_mm()[curve.control_points_mm().len() - 1];
        part.curves.iter().map(|curve| last(curve).map(|x| (x * 1e9).round() / 1e9 + 0.0)).collect::<Vec<_>>()
    };
    let square = "G0 X0 Y0 Z0\nG1 X4\nG3 X4 Y2 J1\n";
    for before in ["", "G10 L2 P1 X-500 Y3 R30\n", "G92 X7\nG92 X0\n", "G10 L2 P2 X9 R-45\nG55\n"] {
        assert_eq!(ends(&format!("{before}{square}")), [[4.0, 0.0, 0.0], [4.0, 2.0, 0.0]], "{before}");
    }
    // A quarter turn about the place (1, 0), and then an arc and increments in the turned system.
    let turned =
        ends("G0 X0 Y0 Z0\nG10 L2 P2 X1 R90\nG55 G1 X2 Y0\nG2 X4 I1\nG91 G1 X1 Y1\nG54 G90 G1 X9 Y9");
    assert_eq!(turned, [[1.0, 2.0, 0.0], [1.0, 4.0, 0.0], [0.0, 5.0, 0.0], [9.0, 9.0, 0.0]]);
}

/// LinuxCNC 2.9 taps along other axes than the cycle names in G18 and G19, as its own tests have it. The cycle is read as it is written,
/// and a warning says that the control goes elsewhere.
#[test]
fn tapping_in_another_plane_is_warned_of() {
    let warned = |text: &str| {
        linuxcnc(text).warnings.iter().any(|said| said.message.contains("when it taps in G18 and G19"))
    };
    for word in ["G84", "G74"] {
        assert!(warned(&format!("G18 G21 F100 S9\nG0 X0 Y5 Z0\n{word} X5 Z6 Y-3 R2\n")), "{word}");
        assert!(!warned(&format!("G17 G21 F100 S9\nG0 X0 Y0 Z5\n{word} X5 Y6 Z-3 R2\n")), "{word}");
    }
}
