//! Words of Siemens beside its splines: heads of programs, arcs, and numbers that say where they count from.

use std::f64::consts::{PI, TAU};

use part_program::{Part, ReadOptions, Shape, inspect, read_part, read_part_with};
use proptest::prelude::*;

fn part(text: &str) -> Part {
    read_part("p.mpf", text).unwrap_or_else(|errors| panic!("{text}{errors}"))
}

fn refusal(text: &str) -> String {
    read_part("p.mpf", text).unwrap_err().to_string()
}

fn near(found: f64, expected: f64, of: &str) {
    assert!((found - expected).abs() < 1e-9 * expected.abs().max(1.0), "{of}: {found}, not {expected}");
}

/// The middle of an arc of one or two spans: its point between the first and the last.
fn ends(part: &Part) -> Vec<[f64; 3]> {
    part.curves.iter().map(|curve| *curve.control_points_mm().last().unwrap()).collect()
}

#[test]
fn heads_of_programs_are_no_path() {
    let body = "G17 G90 G71\nG0 X0 Y0 Z0\nG1 X10 F600\n";
    for (head, warned) in [
        ("%_N_PART1_MPF\n;$PATH=/_N_WKS_DIR/_N_X_WPD\n", 0),
        ("%1234\n", 0),
        ("PROC MAIN SAVE DISPLOF\n", 0),
        ("MSG(\"roughing (1)\")\nMSG()\n", 0),
        ("T=\"MILL_10\"\nM6\n", 1),
        ("T1=5 D1\nM1=3 S1=5000\n", 0),
        ("N10 STOPRE\nN20 FFWON SOFT CUT2D\nCUT3DC\n", 0),
        ("WALIMON\nSETMS(1)\nGROUP_BEGIN(0, \"a\", 0, 0)\n", 0),
        ("CYCLE832(0.05, 3, 1)\nCOMPCAD\nCOMPOF\n", 2),
    ] {
        let part = part(&format!("{head}{body}M30\n"));
        near(inspect(&part).length_mm, 10.0, head);
        assert_eq!(part.warnings.len(), warned, "{head}: {:?}", part.warnings);
    }
    for end in ["RET", "%_N_A_MPF\nM17"] {
        let (head, end) = end.split_once('\n').unwrap_or(("", end));
        let part = part(&format!("{head}\n{body}{end}\nG1 X99\n"));
        near(inspect(&part).length_mm, 10.0, end);
        assert_eq!(part.warnings[0].message, "what follows the end of the program is not read");
    }
    assert!(refusal("PROC SUB(REAL A)\nG0 X0 Y0\nG1 X1\n").contains("`PROC` is not executed"));
    let part = part(&format!("S1=6000 M1=3\n{body}"));
    let words: Vec<_> = part.auxiliary.iter().map(|word| (word.letter, word.value)).collect();
    assert_eq!(words, [('M', 3.0), ('S', 6000.0)]);
    assert!(refusal(&format!("X=\"a\"\n{body}")).contains("a text is no number"));
}

/// AC() counts from 0 and IC() from the place of the tool, for this number alone.
#[test]
fn numbers_may_say_where_they_count_from() {
    let text = "G17 G90 G71\nG0 X110 Y0 Z0\nF300\nG3 X100 Y10 I=AC(100) J=AC(0)\nG91\nG3 X=AC(90) Y=AC(0) I0 J-10\nG1 X=IC(5)\n\
                G90 G1 X=IC(5)\nY=ic( 2 + 1 ) X7\nG700 X=IC(1)\n";
    let part = part(text);
    near(inspect(&part).length_mm, PI * 10.0 + 10.0 + 93.0_f64.hypot(3.0) + 25.4, text);
    assert_eq!(ends(&part)[2..5], [[95.0, 0.0, 0.0], [100.0, 0.0, 0.0], [7.0, 3.0, 0.0]]);
    let lenient = ReadOptions { lenient: true, ..ReadOptions::default() };
    let lost =
        read_part_with("p", "G0 X0 Y0\nG1 X5 F60\nFOOBAR(1)\nX=IC(5) Y0\nY9\nX1 Y1\nX2\n", lenient).unwrap();
    near(inspect(&lost).length_mm, 6.0, "an unknown place stays unknown");
}

/// A circle through three places: by the closed form of its centre and radius, in the plane and in space.
#[test]
fn cip_passes_its_point() {
    let plane = part("G17 G90\nG0 X30 Y40 Z0\nF500\nCIP X50 Y40 I1=40 J1=45\n");
    // The circle about (40, 32.5) of radius 12.5.
    near(inspect(&plane).length_mm, 12.5 * 2.0 * 10.0_f64.atan2(7.5), "in the plane");
    assert_eq!((plane.moves[0].shape, plane.warnings.len()), (Shape::Arc, 0));
    // The other way round the same circle, and the same by increments.
    let around = "CIP X50 Y40 I1=40 J1=20\n";
    let long = part(&format!("G90 G0 X30 Y40\n{around}"));
    near(inspect(&long).length_mm, 12.5 * (TAU - 2.0 * 10.0_f64.atan2(7.5)), around);
    let steps = part("G90 G0 X30 Y40\nG91 CIP X20 Y0 I1=10 J1=-20\n");
    near(inspect(&steps).length_mm, inspect(&long).length_mm, "G91");
    let each = part("G90 G0 X30 Y40\nCIP X50 Y40 I1=IC(10) J1=IC(-20)\n");
    near(inspect(&each).length_mm, inspect(&long).length_mm, "IC() in G90");
    // Half of a circle of radius 5 that stands on the diagonal of X and Y.
    let root = 50.0_f64.sqrt();
    let space =
        part(&format!("G90 G0 X0 Y0 Z0\nCIP X{root} Y{root} I1={} J1={} K1=5\n", root / 2.0, root / 2.0));
    near(inspect(&space).length_mm, PI * 5.0, "in space");
    let (least, most) = inspect(&space).bounding_box_mm.unwrap();
    assert!(least[2] > -1e-12 && (most[2] - 5.0).abs() < 1e-9, "{least:?} {most:?}");
    assert!(refusal("G0 X0 Y0\nCIP X9 Y9 I1=3 J1=3\n").contains("on one line"));
    assert!(refusal("G0 X0 Y0\nCIP X9 Y9\n").contains("CIP without its point in between"));
}

#[test]
fn ct_goes_on_in_the_direction_of_the_move_before() {
    let quarter = part("G17 G90\nG0 X0 Y0 Z0\nG1 X20 F300\nCT X30 Y10\nCT X20 Y20\nX0\n");
    // A quarter of a circle of radius 10, the next one, and a straight line, which is tangent too.
    near(inspect(&quarter).length_mm, 20.0 + 10.0 * PI + 20.0, "quarters");
    let clockwise = part("G0 X0 Y0\nG1 X20 F300\nCT Y-8\n");
    near(inspect(&clockwise).length_mm, 20.0 + 4.0 * PI, "half a circle to the right");
    assert!(inspect(&clockwise).joints.iter().all(|joint| joint.tangent_break_rad < 1e-9));
    let zx = part("G18 G0 X0 Z0\nG1 X20 F300\nCT Z8\n");
    near(inspect(&zx).length_mm, 20.0 + 4.0 * PI, "in G18");
    assert!(refusal("G0 X0 Y0\nCT X9 Y9\n").contains("behind no move"));
    assert!(refusal("G0 X0 Y0\nG1 X9 F60\nCT X5\n").contains("straight behind"));
}

#[test]
fn arcs_by_turns_and_by_their_angle() {
    let head = "G17 G90\nG0 X10 Y0 Z0\nF300\n";
    for (text, length, end) in [
        ("G3 X0 Y10 Z20 I-10 J0 TURN=2", (2.25 * TAU * 10.0).hypot(20.0), [0.0, 10.0, 20.0]),
        ("G3 X0 Y10 I-10 J0 TURN=0", 0.25 * TAU * 10.0, [0.0, 10.0, 0.0]),
        ("G3 X0 Y10 AR=90", 0.25 * TAU * 10.0, [0.0, 10.0, 0.0]),
        ("G2 X0 Y10 AR=270", 0.75 * TAU * 10.0, [0.0, 10.0, 0.0]),
        ("G3 I-10 J0 AR=90", 0.25 * TAU * 10.0, [0.0, 10.0, 0.0]),
        ("G2 I-10 AR=180", 0.5 * TAU * 10.0, [-10.0, 0.0, 0.0]),
        ("G2 I-10 Z5 AR=180", (0.5 * TAU * 10.0).hypot(5.0), [-10.0, 0.0, 5.0]),
    ] {
        let part = part(&format!("{head}{text}\n"));
        near(inspect(&part).length_mm, length, text);
        ends(&part)[0].iter().zip(end).for_each(|(found, end)| near(*found, end, text));
    }
    for (text, why) in [
        ("G3 X0 Y10 AR=360", "an arc that turns by 360°"),
        ("G3 X0 Y10 I-10 J0 AR=90", "has its end, or its centre"),
        ("G3 AR=90", "has its end, or its centre"),
        ("G3 X0 Y10 I-10 TURN=-1", "an arc of 0 turns"),
    ] {
        let errors = refusal(&format!("{head}{text}\n"));
        assert!(errors.contains(why), "{text}: {errors}");
    }
}

/// CHF= is the length of the line that cuts the corner off, CHR= that of its sides.
#[test]
fn a_chamfer_has_its_length() {
    let part = part("G17 G90 G71\nG0 X0 Y0 Z0\nG1 X20 F300 RND=5\nY20 CHF=2\nX0\n");
    near(inspect(&part).length_mm, 60.0 - 10.0 + PI * 2.5 - 2.0 * 2.0_f64.sqrt() + 2.0, "a right angle");
    let sharp = self::part("G0 X0 Y0\nG1 X20 F300 CHF=2\nX10 Y10\n");
    let chamfer = sharp.curves[1].control_points_mm();
    near((chamfer[0][0] - chamfer[1][0]).hypot(chamfer[0][1] - chamfer[1][1]), 2.0, "45°");
}

/// The manual allows weights of 0 to 3.
#[test]
fn a_weight_of_0_takes_its_point_away() {
    let part = part("G0 X0 Y0\nF300\nBSPLINE X10 Y20 PW=0\nX20 Y20 PW=0.5\nX30 Y0 PW=2\nX40 Y10\n");
    let curve = &part.curves[0];
    assert_eq!((curve.control_points_mm().len(), curve.weights()[1]), (5, 1e-9));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(200))]

    /// An arc through a point of the same circle is the arc by its centre.
    #[test]
    fn cip_is_the_arc_by_its_centre(
        centre in [-50.0_f64..50.0, -50.0_f64..50.0],
        radius in 0.5_f64..40.0,
        first in 0.0_f64..TAU,
        share in 0.1_f64..0.9,
        sweep in 0.2_f64..6.0,
    ) {
        let at = |angle: f64| [centre[0] + radius * angle.cos(), centre[1] + radius * angle.sin()];
        let (a, m, e) = (at(first), at(first + share * sweep), at(first + sweep));
        let through = part(&format!("G0 X{} Y{}\nCIP X{} Y{} I1={} J1={}\n", a[0], a[1], e[0], e[1], m[0], m[1]));
        let length = inspect(&through).length_mm;
        prop_assert!((length - radius * sweep).abs() < 1e-6 * radius, "{length}, not {}", radius * sweep);
    }
}
