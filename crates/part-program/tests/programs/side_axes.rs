//! Axes that move beside the path: what is read, at which feed, and what is refused.

use part_program::{Dialect, Part, ReadOptions, SideMove, read_part, read_part_with};

fn part(text: &str) -> Part {
    read_part("p.nc", text).unwrap_or_else(|errors| panic!("{errors}\n{text}"))
}

fn read_as(dialect: Dialect, text: &str) -> Part {
    read_part_with("p.nc", text, ReadOptions { dialect: Some(dialect), ..ReadOptions::default() }).unwrap()
}

fn refused(text: &str) -> String {
    let errors = read_part("p.nc", text).unwrap_err();
    assert_eq!(errors.count(), 1, "{errors}");
    errors.iter().next().map(|error| error.message.clone()).unwrap_or_default()
}

/// A, B and C at the end of each move at feed that moves X, Y or Z.
fn ends(part: &Part) -> Vec<[f64; 3]> {
    (0..part.curves.len())
        .map(|curve| {
            let next = part.side_moves.partition_point(|one| one.curve <= curve);
            let [a, b, c, ..] = next.checked_sub(1).map_or([0.0; 6], |last| part.side_moves[last].to);
            [a, b, c]
        })
        .collect()
}

/// The places are those that LinuxCNC's `rs274 -g` prints of this program; behind G92 it prints them less the 170°.
#[test]
fn side_axes_are_where_linuxcnc_has_them() {
    let text = "G21 G17 G90 G94 F600\nG0 X0 Y0 Z0 A0 B0 C0\nG1 X10 A90\nG2 X20 Y0 I5 J0 A180 B5\nG91 G1 X1 A-10\nG90 G92 A0\n\
                G1 Y5 A15\nG1 A30\nG93 G1 X30 C45 F2\nG20 G94 F10\nG1 X2 A45\nM2\n";
    let part = read_as(Dialect::LinuxCnc, text);
    let printed = [
        [90.0, 0.0, 0.0],
        [180.0, 5.0, 0.0],
        [170.0, 5.0, 0.0],
        [170.0 + 15.0, 5.0, 0.0],
        [170.0 + 30.0, 5.0, 45.0],
        [170.0 + 45.0, 5.0, 45.0],
    ];
    assert_eq!(ends(&part), printed);
    // A alone turns while the tool rests; all other moves go on where those before them end.
    let rests: Vec<_> = (0..part.curves.len()).map(|next| part.rest_before(next).is_some()).collect();
    assert_eq!(rests, [false, false, false, false, true, false]);
    let turned: Vec<_> = part.side_moves.windows(2).map(|pair| pair[0].to == pair[1].from).collect();
    assert_eq!(turned, [true, true, true, false, true], "A turns alone by 15°");
}

/// F is that of the path, in G94 and in G93: `rs274` prints SET_FEED_RATE(18) for the 9 mm in half a minute.
#[test]
fn the_feed_is_that_along_x_y_and_z() {
    let text = "G21 G0 X0 Y0 A0\nG1 X10 A720 F600\nG93 X19 A0 F2\n";
    let feeds = |part: &Part| part.moves.iter().map(|one| one.feedrate_mm_per_s).collect::<Vec<_>>();
    for dialect in [Dialect::LinuxCnc, Dialect::Siemens] {
        assert_eq!(feeds(&read_as(dialect, text)), [Some(10.0), Some(0.3)], "{dialect:?}");
    }
    let unnamed = part(text);
    assert_eq!(feeds(&unnamed), [Some(10.0), Some(0.3)]);
    assert!(unnamed.warnings[0].message.ends_with("as LinuxCNC does"), "{:?}", unnamed.warnings);
}

/// FANUC's F holds along all axes, and a degree counts as a mm or an inch: 30 mm and 40° are 50.
#[test]
fn fanuc_counts_a_degree_as_a_mm_of_the_feed() {
    let feed = |text: &str| read_as(Dialect::Fanuc, text).moves.last().unwrap().feedrate_mm_per_s.unwrap();
    assert!((feed("G21 G0 X0. Y0. A0.\nG1 X30. A40. F600.\n") - 6.0).abs() < 1e-12);
    assert!((feed("G20 G0 X0. Y0. A0.\nG1 X30. A40. F60.\n") - 0.6 * 25.4).abs() < 1e-12);
    assert!((feed("G21 G0 X0. Y0. U0.\nG1 X30. U40. F600.\n") - 6.0).abs() < 1e-12);
}

#[test]
fn linear_side_axes_are_in_mm() {
    let part = part("G20 G0 X0 Y0 W0\nG1 X1 W2 F10\n");
    assert_eq!(part.side_moves, [SideMove { curve: 0, from: [0.0; 6], to: [0.0, 0.0, 0.0, 0.0, 0.0, 50.8] }]);
}

/// A part that turns at rest alone has the path of X, Y and Z, as it had before.
#[test]
fn a_part_that_turns_at_rest_alone_has_no_side_moves() {
    let part = part("G21 G0 X0 Y0 A0\nG1 X5 F60\nG0 A90\nG1 X10\nG1 A180\nG1 X15\n");
    assert_eq!(part.side_moves, []);
    assert_eq!((0..3).map(|next| part.rest_before(next).is_some()).collect::<Vec<_>>(), [false, true, true]);
}

/// Where a rapid move turns the part, the axis stands there when it begins to move beside the path.
#[test]
fn an_axis_begins_where_a_rapid_move_has_left_it() {
    let part = part("G21 G0 X0 Y0 A10\nG1 X5 F60\nG0 A90\nG1 X10\nG1 X15 A100\n");
    let found: Vec<_> = part.side_moves.iter().map(|one| (one.curve, one.from[0], one.to[0])).collect();
    assert_eq!(found, [(0, 10.0, 10.0), (1, 90.0, 90.0), (2, 90.0, 100.0)]);
}

#[test]
fn what_is_not_followed_is_refused_by_its_reason() {
    let said = |text: &str| refused(&format!("G21 G0 X0 Y0 Z5 A0\n{text}"));
    assert!(said("G5 X1 Y1 I0 J1 P0 Q1 A5 F60\n").ends_with("while the tool cuts in this motion"));
    assert!(said("G41.1 D1\nG1 X5 F60\nX10 A5\n").ends_with("under cutter compensation"));
    assert!(said("G1 X5 F60 ,R1 A5\nY5\n").ends_with("beside a corner that is rounded or cut off"));
    assert_eq!(said("G28 A0\nG1 X5 A7 F60\n"), "`A7`: where this axis is is not known");
}

/// Leaving a block out moves nothing, so the axis is not where the block would have led it.
#[test]
fn a_block_that_is_left_out_turns_nothing() {
    let text = "G21 G0 X0 Y0 A0\nG1 X5 A10 F60\nG68.7 X7 A20\nG0 X9 Y0 Z0 A20\nG1 X10 A30\n";
    let options = ReadOptions { lenient: true, ..ReadOptions::default() };
    let part = read_part_with("p.nc", text, options).unwrap();
    for one in &part.side_moves {
        assert!(one.to[0] - one.from[0] <= 10.0, "{one:?}");
    }
}

/// B was lost and is placed in the block in which A moves: it stood at 0 along that move, and jumped behind it.
#[test]
fn an_axis_that_its_block_places_stands_there() {
    let options = ReadOptions { lenient: true, ..ReadOptions::default() };
    let text = "G21 G90 F600\nG0 X0 Y0 A0 B30\nG1 X5 A5\nG28 B0\nG0 X5 Y0\nG1 X10 A10 B40\nX20 A20\n";
    let part = read_part_with("p.nc", text, options).unwrap_or_else(|errors| panic!("{errors}"));
    let places: Vec<[f64; 2]> = part.side_moves.iter().map(|one| [one.from[1], one.to[1]]).collect();
    assert_eq!(places.last(), Some(&[40.0; 2]), "{places:?}");
    assert_eq!(places[places.len() - 2], [40.0; 2], "{places:?}");
}
