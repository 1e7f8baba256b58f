//! Programs as controls and their users write them: what is read, what is left out, and how that is said.

use part_program::{Dialect, Part, ReadOptions, Unit, inspect, read_part, read_part_with};

fn part(text: &str) -> Part {
    read_part("p.nc", text).unwrap_or_else(|errors| panic!("{errors}\n{text}"))
}

fn said(part: &Part) -> Vec<(usize, &str)> {
    part.warnings.iter().map(|warning| (warning.line, warning.message.as_str())).collect()
}

/// A helix of many turns was once read as a plunge. This one has 15 turns and rises by 4 mm: √((15·2π·1.5)² + 4²) for
/// the circle's radius of 1.5.
#[test]
fn an_arc_makes_the_turns_of_p() {
    let part = part("G21 G0 X0 Y0 Z0\nG1 X3 F100\nG3 X3 Y0 Z4 I-1.5 P15\nG2 X0 Y0 I-1.5 P2\n");
    let arcs = inspect(&part).length_mm - 3.0;
    let expected = (15.0 * 3.0 * std::f64::consts::PI).hypot(4.0) + 1.5 * 3.0 * std::f64::consts::PI;
    assert!((arcs - expected).abs() < 1e-6, "{arcs}, not {expected}");
}

/// rs274 sets F before it changes the unit: 100 mm/min, then 400 in/min. It was read as 2540 and 400 mm/min.
#[test]
fn a_feed_beside_a_unit_is_read_as_the_control_does() {
    let text = "G21 G0 X0 Y0\nG20 G1 X1 F100\nG21 G1 X40 F400\n";
    let feeds =
        |part: &Part| part.moves.iter().map(|one| one.feedrate_mm_per_s.unwrap() * 60.0).collect::<Vec<_>>();
    let options = ReadOptions { dialect: Some(Dialect::LinuxCnc), ..ReadOptions::default() };
    let linuxcnc = feeds(&read_part_with("p.ngc", text, options).unwrap());
    assert!((linuxcnc[0] - 100.0).abs() < 1e-9 && (linuxcnc[1] - 10_160.0).abs() < 1e-9, "{linuxcnc:?}");
    let unknown = part(text);
    assert!((feeds(&unknown)[0] - 2540.0).abs() < 1e-9);
    assert_eq!(said(&unknown)[0], (2, "`F100` is read in the unit that its block sets"));
}

/// rs274 prints these ends for `@` and `^`.
#[test]
fn polar_coordinates_of_linuxcnc() {
    let part = part("G21 G0 X1.5 Y0 Z0\nG1 @5 ^30 F60\nG91 G1 ^10\n");
    let ends: Vec<_> = part.curves.iter().map(|curve| curve.control_points_mm()[1]).collect();
    for (end, [x, y]) in ends.iter().zip([[4.3301, 2.5], [3.8302, 3.2139]]) {
        assert!((end[0] - x).abs() < 1e-4 && (end[1] - y).abs() < 1e-4, "{ends:?}");
    }
    let holes = self::part("G20 G0 X1.5 Y0 Z0\nG91 G81 R.1 Z-.5 ^60 L6 F10\n");
    let last = holes.curves.last().unwrap().control_points_mm()[1];
    assert!(
        (last[0] - 38.1).abs() < 1e-9 && last[1].abs() < 1e-9,
        "six times 60° is where it began: {last:?}"
    );
}

/// FreeCAD writes K0 beside I and J.
#[test]
fn a_centre_word_of_0_outside_the_plane_says_nothing() {
    assert_eq!(part("G21 G0 X0 Y0\nG2 X10 I5 J0 K0 F60\n").curves.len(), 1);
}

/// One print once gave 42,994 errors.
#[test]
fn a_print_is_read_and_its_filament_counted() {
    let text = "M104 S200\nM109 S200\nG21\nG28\nG29\nM82\nG92 E0\nG0 X0 Y0 Z0.2 F6000\nG1 X10 E1.5 F1200\nG1 X10 Y10 E3\nG1 E1 F2400\n\
                M106 S255\nM117 Layer 2: (half\nSET_PRESSURE_ADVANCE ADVANCE=0.04\nG1 X0 Y10 E5\nM83\nG1 Y0 E2.5\nM204 P500 T1000\nM84\n";
    let part = part(text);
    assert_eq!(part.curves.len(), 4);
    let filament = part.filament.unwrap();
    assert_eq!([filament.least_mm, filament.greatest_mm], [0.0, 7.5]);
    let rests: Vec<_> = (1..4).map(|next| part.rest_before(next).is_some()).collect();
    assert_eq!(rests, [false, true, false], "at the retraction alone");
    assert_eq!(
        said(&part),
        [
            (14, "`SET_PRESSURE_ADVANCE` is a command of the control: it is left out"),
            (18, "`M204` sets limits of the printer: those of the machine file hold"),
        ]
    );
}

/// One axis once gave 7,002 lines of messages.
#[test]
fn an_axis_that_is_not_followed_is_said_once() {
    let turned = |count: u32| (1..=count).map(|index| format!("X{index} A{index}\n")).collect::<String>();
    let text = format!("G21 G0 X0 Y0 Z5 A0\nG81 X0 Z-1 R1 F60\n{}", turned(1166));
    let errors = read_part("p.nc", &text).unwrap_err();
    assert_eq!(errors.count(), 1);
    let error = errors.iter().next().unwrap();
    assert_eq!(
        (error.line, error.message.as_str()),
        (
            3,
            "`A1` moves an axis that is not followed while the tool cuts in this motion, and 1,165 more like it"
        )
    );
}

/// An indexed part is cut on X, Y and Z, and the machine rests while it turns.
#[test]
fn a_part_that_is_turned_between_cuts_is_read() {
    let part = part("G21 G0 X0 Y0 A0 C0\nG1 X5 F60\nG1 X6 A0\nG0 A90\nG1 X7\n");
    assert_eq!(said(&part), [(4, "`A90` turns the part: its path is read as it runs on X, Y and Z")]);
    assert_eq!((1..3).map(|next| part.rest_before(next).is_some()).collect::<Vec<_>>(), [false, true]);
}

#[test]
fn settings_of_a_control_are_left_out_and_counted() {
    let part = part("$100=250\n$101=250\n$$\nG21 G0 X0 Y0\nG1 X5 F60\n");
    assert_eq!(said(&part), [(1, "`$100=250` sets the control up: it is left out, and 2 more like it")]);
}

/// Moves behind a lone CR vanished in a comment, and a file of CR alone was one line.
#[test]
fn line_ends_of_cr_alone() {
    let text = "G21 G0 X0 Y0 (go)\rG1 X5 F60\rG1 X6 (end)\r";
    assert_eq!(part(text).curves.len(), 2);
    assert_eq!(part(text).moves[1].line, 3);
    let mixed = part("G21 G0 X0 Y0 (go\rG1 X9)\nG1 X5 F60\n");
    assert_eq!(said(&mixed), [(1, "a CR without LF in a comment: what follows it may be a line of its own")]);
}

/// A name in lower case with `=`, or brackets, made a program a curve file.
#[test]
fn a_program_is_no_curve_file() {
    assert_eq!(
        part(
            "(g76)\n#<depth>=2\no1 if [1]\n[\no1 endif\nG21 G0 X0\nG1 X#<depth>\n"
                .replace("[\n", "\n")
                .as_str()
        )
        .curves
        .len(),
        1
    );
    let options = ReadOptions { dialect: Some(Dialect::Siemens), ..ReadOptions::default() };
    let errors = read_part_with("p.mpf", "depth=5\nG0 X0\nG1 X5\n", options).unwrap_err();
    assert!(errors.to_string().contains("unknown word `depth=`"), "{errors}");
}

#[test]
fn a_unit_that_nothing_names_is_told_with_both_sizes() {
    let size = part("G0 X0 Y0\nG1 X4 Y2 F60\n").assumed_unit().unwrap();
    assert!(size.contains("4.0 x 2.0 x 0.0 mm; in inches it would be 101.6 x 50.8 x 0.0 mm"), "{size}");
    assert_eq!(part("G21 G0 X0\nG1 X4\n").assumed_unit(), None);
    let options = ReadOptions { unit: Some(Unit::Inch), ..ReadOptions::default() };
    let inches = read_part_with("p.nc", "G0 X0 Y0\nG1 X4 F60\n", options).unwrap();
    assert_eq!(inches.curves[0].control_points_mm()[1], [101.6, 0.0, 0.0]);
    assert_eq!((inches.assumed_unit(), inches.feedrate_mm_per_s), (None, Some(25.4)));
}

/// The way from the first place of the tool was once left out without a message.
#[test]
fn the_way_to_the_first_point_is_cut_from_a_start_that_is_given() {
    let text = "G21 G1 X10 F60\nG1 Y5\nG1 X20\n";
    let options = ReadOptions { start_mm: Some([0.0, 1.0, 0.0]), ..ReadOptions::default() };
    let begun = read_part_with("p.nc", text, options).unwrap();
    assert_eq!(begun.curves[0].control_points_mm(), [[0.0, 1.0, 0.0], [10.0, 1.0, 0.0]]);
    let unknown = part(text);
    assert_eq!(
        said(&unknown)[0],
        (
            1,
            "where the tool is on X before this move at feed is not known: its way there is left out, and 1 more like it"
        )
    );
}

/// FANUC's G70 and G71 are cycles of a lathe, Siemens' are inches and millimetres.
#[test]
fn g70_is_what_the_control_makes_of_it() {
    let read = |dialect| {
        let options = ReadOptions { dialect: Some(dialect), ..ReadOptions::default() };
        read_part_with("p.nc", "G70 G0 X0 Y0\nG1 X1 F60\n", options)
    };
    assert_eq!(read(Dialect::Siemens).unwrap().curves[0].control_points_mm()[1], [25.4, 0.0, 0.0]);
    assert!(read(Dialect::Fanuc).unwrap_err().to_string().contains("G70 to G72 turn a contour"));
}

#[test]
fn a_program_for_a_lathe_is_refused_by_what_shows_it() {
    for (text, why) in [
        ("G7 G0 X10", "G7 makes X a diameter"),
        ("G96 S100", "G96 keeps the speed of the cut"),
        ("G50 S2000", "G50 with S limits"),
        ("G71 U2 R1", "G70 to G72 turn a contour"),
    ] {
        for lenient in [false, true] {
            let options = ReadOptions { lenient, ..ReadOptions::default() };
            let errors =
                read_part_with("p.nc", &format!("{text}\nG0 X1 Z1\nG1 Z2 F60\n"), options).unwrap_err();
            assert!(errors.to_string().contains(why), "{errors}");
        }
    }
}

/// Two sides of a square with a corner of radius 2, and one that 3 mm are cut off: 8 + π + 5 + √18 + 7 mm.
#[test]
fn corners_are_rounded_and_cut_off() {
    for text in ["G1 X10 ,R2\nG1 Y10 ,C3\n", "G1 X10 RND=2\nG1 Y10 CHR=3\n"] {
        let part = part(&format!("G21 G0 X0 Y0\nF60\n{text}G1 X0\n"));
        let length = inspect(&part).length_mm;
        let expected = 8.0 + std::f64::consts::PI + 5.0 + 18.0_f64.sqrt() + 7.0;
        assert!((length - expected).abs() < 1e-9, "{length}, not {expected}");
        let arc = &part.curves[1];
        let off = |point: [f64; 3], [x, y]: [f64; 2]| (point[0] - x).hypot(point[1] - y);
        assert!(
            off(arc.control_points_mm()[0], [8.0, 0.0]) < 1e-12
                && off(arc.control_points_mm()[2], [10.0, 2.0]) < 1e-12
        );
        assert_eq!(part.moves.iter().map(|one| one.line).collect::<Vec<_>>(), [3, 3, 4, 4, 5]);
        assert_eq!(part.warnings, []);
    }
}
