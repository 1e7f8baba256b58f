//! Straight moves, arcs and modal state of part programs.

use std::f64::consts::{FRAC_PI_2, PI, TAU};

use part_program::{Curve, HELIX_TOLERANCE_MM, Move, MoveKind, Nurbs, Part, Shape, read_part};

fn part(text: &str) -> Part {
    read_part("p.nc", text).unwrap_or_else(|errors| panic!("{errors}"))
}

/// The point of a curve at u, by de Boor's algorithm on homogeneous points.
fn point(curve: &Curve, u: f64) -> [f64; 3] {
    let (p, knots) = (curve.degree(), &curve.knots());
    let last = curve.control_points_mm().len() - 1;
    let span = (p..=last).rev().find(|i| knots[*i] <= u && knots[*i] < knots[i + 1]).unwrap_or(p);
    let mut work: Vec<[f64; 4]> = (span - p..=span)
        .map(|i| {
            let ([x, y, z], w) = (curve.control_points_mm()[i], curve.weights()[i]);
            [w * x, w * y, w * z, w]
        })
        .collect();
    for level in 1..=p {
        for j in (level..=p).rev() {
            let i = span - p + j;
            let t = (u - knots[i]) / (knots[i + p + 1 - level] - knots[i]);
            work[j] = std::array::from_fn(|axis| (1.0 - t) * work[j - 1][axis] + t * work[j][axis]);
        }
    }
    [work[p][0] / work[p][3], work[p][1] / work[p][3], work[p][2] / work[p][3]]
}

fn samples(curve: &Curve) -> impl Iterator<Item = [f64; 3]> {
    (0..=1000).map(|i| point(curve, f64::from(i) / 1000.0))
}

fn ends(curve: &Curve) -> ([f64; 3], [f64; 3]) {
    (curve.control_points_mm()[0], *curve.control_points_mm().last().unwrap())
}

#[test]
fn straight_moves_are_curves_of_degree_1() {
    let part = part("G21 G90\nG0 X1 Y2 Z3\nZ0\nG1 X11 F1200\nY12 F600\nG0 Z5 M5\n");
    let kinds: Vec<_> = part.moves.iter().map(|m| (m.kind, m.shape, m.feedrate_mm_per_s, m.line)).collect();
    assert_eq!(
        kinds,
        [
            (MoveKind::Rapid, Shape::Line, None, 3),
            (MoveKind::Feed, Shape::Line, Some(20.0), 4),
            (MoveKind::Feed, Shape::Line, Some(10.0), 5),
            (MoveKind::Rapid, Shape::Line, None, 6),
        ]
    );
    let line = Nurbs {
        degree: 1,
        control_points_mm: vec![[1.0, 2.0, 0.0], [11.0, 2.0, 0.0]],
        dimension: 2,
        weights: vec![1.0; 2],
        knots: vec![0.0, 0.0, 1.0, 1.0],
    };
    assert_eq!(part.curves[1], line.into());
    assert_eq!(part.feedrate_mm_per_s, Some(20.0), "the highest");
    assert!(part.curves.windows(2).all(|pair| ends(&pair[0]).1 == ends(&pair[1]).0));
}

#[test]
fn a_move_to_the_same_place_is_no_curve() {
    assert_eq!(part("G1 X0 Y0\nX5\nX5\nG1\nY5\n").curves.len(), 2);
}

#[test]
fn inches_and_increments() {
    let part = part("G20 G91 G0 X0 Y0\nG1 X1 F60\nX1 Y-2\n");
    assert_eq!(ends(&part.curves[1]), ([25.4, 0.0, 0.0], [50.8, -50.8, 0.0]));
    assert_eq!(part.feedrate_mm_per_s, Some(25.4));
}

#[test]
fn inverse_time_feed_is_length_over_time() {
    let part = part("G93 G0 X0 Y0\nG1 X30 Y40 F6\n");
    assert_eq!(part.feedrate_mm_per_s, Some(50.0 * 6.0 / 60.0));
}

#[test]
fn arcs_lie_on_their_circle_and_end_where_they_are_sent() {
    // Text, end, angle turned, centre, radius.
    let cases = [
        ("G3 X0 Y10 I-10 J0", [0.0, 10.0], FRAC_PI_2, [0.0, 0.0], 10.0),
        ("G2 X0 Y10 I-10 J0", [0.0, 10.0], -1.5 * PI, [0.0, 0.0], 10.0),
        ("G3 X0 Y10 R10", [0.0, 10.0], FRAC_PI_2, [0.0, 0.0], 10.0),
        ("G3 X0 Y10 R-10", [0.0, 10.0], 1.5 * PI, [10.0, 10.0], 10.0),
        ("G2 X0 Y10 R10", [0.0, 10.0], -FRAC_PI_2, [10.0, 10.0], 10.0),
        ("G2 X0 Y10 CR=10", [0.0, 10.0], -FRAC_PI_2, [10.0, 10.0], 10.0),
        ("G3 X-10 R10", [-10.0, 0.0], PI, [0.0, 0.0], 10.0),
        ("G3 I-10", [10.0, 0.0], TAU, [0.0, 0.0], 10.0),
        ("G2 X10 Y0 J5", [10.0, 0.0], -TAU, [10.0, 5.0], 5.0),
        ("G90.1 G3 X0 Y10 I0 J0", [0.0, 10.0], FRAC_PI_2, [0.0, 0.0], 10.0),
    ];
    for (text, end, turn, centre, radius) in cases {
        let part = part(&format!("G0 X10 Y0\n{text} F600\n"));
        let curve = &part.curves[0];
        assert_eq!(curve.degree(), 2);
        assert_eq!(part.moves[0].shape, Shape::Arc);
        assert_eq!(ends(curve), ([10.0, 0.0, 0.0], [end[0], end[1], 0.0]), "{text}");
        let mut angle = 0.0;
        let mut before: Option<[f64; 3]> = None;
        for p in samples(curve) {
            let (x, y) = (p[0] - centre[0], p[1] - centre[1]);
            assert!((x.hypot(y) - radius).abs() < 1e-13 * radius * 4.0, "{text}: {p:?}");
            if let Some(q) = before {
                let (bx, by) = (q[0] - centre[0], q[1] - centre[1]);
                angle += (bx * y - by * x).atan2(bx * x + by * y);
            }
            before = Some(p);
        }
        assert!((angle - turn).abs() < 1e-11, "{text}: {angle}");
    }
}

#[test]
fn planes_turn_as_their_axes_do() {
    // Seen from the positive normal, G2 is clockwise: Z to X in G18, Y to Z in G19.
    let part = part("G0 X10 Y0 Z0\nG18 G2 X0 Z10 I-10 K0\nG0 X0 Y10 Z0\nG19 G3 Y0 Z10 J-10\n");
    let arcs: Vec<_> = part.curves.iter().filter(|c| c.degree() == 2).collect();
    let middle = 10.0 / 2.0_f64.sqrt();
    for (arc, expected) in arcs.iter().zip([[middle, 0.0, middle], [0.0, middle, middle]]) {
        let p = point(arc, 0.5);
        assert!((0..3).all(|axis| (p[axis] - expected[axis]).abs() < 1e-13), "{p:?}");
    }
}

#[test]
fn an_arc_with_a_rounded_centre_meets_both_ends() {
    let part = part("G0 X0 Y0\nG2 X10 Y3 I5.001 J1.502\n");
    assert_eq!(ends(&part.curves[0]), ([0.0; 3], [10.0, 3.0, 0.0]));
    assert_eq!(part.curves[0].faults(), []);
}

/// On the cylinder exactly, and at the height of the helix within the stated tolerance.
#[test]
fn a_helix_keeps_its_height() {
    for (text, rise, turn) in [("G3 X0 Y10 Z2 I-10 J0", 2.0, FRAC_PI_2), ("G3 X10 Y0 Z-30 I-10", -30.0, TAU)]
    {
        let part = part(&format!("G0 X10 Y0 Z0\n{text}\n"));
        let curve = &part.curves[0];
        let mut worst: f64 = 0.0;
        for p in samples(curve) {
            assert!((p[0].hypot(p[1]) - 10.0).abs() < 1e-12);
            let angle = p[1].atan2(p[0]).rem_euclid(TAU);
            let height = rise * angle / turn;
            // The last point of a full turn has the angle 0 or 2π.
            worst = worst.max(
                (p[2] - height).abs().min((p[2] - height - rise).abs()).min((p[2] - height + rise).abs()),
            );
        }
        assert!(worst <= HELIX_TOLERANCE_MM, "{text}: {worst}");
        assert!(worst >= HELIX_TOLERANCE_MM / 2.0, "{text}: spans are needlessly short: {worst}");
    }
}

#[test]
fn comments_numbers_and_delimiters_are_no_words() {
    let text = "%\nO1000 (PART 7)\nN10 G0 X0 Y0 ; go\nN20 g1 x 10 (slow) y5. f600\n:\n";
    let text = text.replace(":\n", "M30\n%\n");
    let part = part(&text);
    assert_eq!(ends(&part.curves[0]).1, [10.0, 5.0, 0.0]);
    assert_eq!(part.warnings, []);
}

#[test]
fn nothing_is_read_after_the_end() {
    let part = part("G0 X0\nG1 X10\nM30\nG1 X20\nG1 X30\n");
    assert_eq!((part.curves.len(), part.warnings.len()), (1, 1));
    assert_eq!(part.warnings[0].line, 4);
}

/// Text behind the second `%` was executed, and so was a subprogram behind M99.
#[test]
fn the_second_percent_sign_and_m99_end_the_program() {
    for (text, warned) in [
        ("%\nO1 (50% of it)\nG0 X0\nG1 X10\n%\nG1 X20\n", Some(6)),
        ("G0 X0\nG1 X10\n%\n\n(done)\ntool list: 3 drills\n", Some(6)),
        ("%\nG0 X0\nG1 X10 % G1 X20\nG1 X30\n", Some(3)),
        ("% G0 X0\nG1 X10\n% (end) ; %\n", None),
        ("G0 X0\nG1 X10\nM99\nG1 X20\n", Some(4)),
        ("%\nG0 X0\nG1 X10\nM99\n%\n", None),
    ] {
        let part = part(text);
        assert_eq!(part.curves.len(), 1, "{text}");
        assert_eq!(part.warnings.first().map(|warning| warning.line), warned, "{text}");
        assert!(part.warnings.len() < 2, "{text}: {:?}", part.warnings);
    }
}

#[test]
fn an_axis_begins_where_it_is_first_sent() {
    // Z is first named after the first curve, which was made at that height.
    let part = part("G0 X0 Y0\nG1 X10\nG1 Z5\nG1 Z3\n");
    assert_eq!(ends(&part.curves[0]), ([0.0, 0.0, 5.0], [10.0, 0.0, 5.0]));
    assert_eq!(ends(&part.curves[1]), ([10.0, 0.0, 5.0], [10.0, 0.0, 3.0]));
    assert_eq!((part.curves.len(), part.curves[0].dimension(), part.standstills), (2, 3, vec![]));
    assert_eq!(self::part("G0 X7 Z5\nG1 X10\n").curves[0].control_points_mm()[0], [7.0, 0.0, 5.0]);
}

/// Increments are known wherever they start; two sides of a square were lost, and a plunge.
#[test]
fn incremental_moves_from_an_unknown_position_keep_their_length() {
    let square = part("G21 G91\nG1 X10 F600\nY10\nX-10\nY-10\nM30\n");
    let corners: Vec<_> = square.curves.iter().map(|curve| ends(curve).1).collect();
    assert_eq!(corners, [[10.0, 0.0, 0.0], [10.0, 10.0, 0.0], [0.0, 10.0, 0.0], [0.0, 0.0, 0.0]]);
    let plunge = part("G0 X0 Y0\nG91\nG1 Z-1\nX10\n");
    assert_eq!(ends(&plunge.curves[0]), ([0.0; 3], [0.0, 0.0, -1.0]));
    assert_eq!(ends(&plunge.curves[1]).1, [10.0, 0.0, -1.0]);
    assert_eq!((square.warnings.len(), plunge.warnings.len()), (0, 0));
    let spline = part("G91\nBSPLINE SD=2 X1 Y1 PL=1\nX1 Y-1\nG90 G1 X5\n");
    assert_eq!(ends(&spline.curves[0]), ([0.0; 3], [2.0, 0.0, 0.0]));
    assert_eq!(ends(&spline.curves[1]), ([2.0, 0.0, 0.0], [5.0, 0.0, 0.0]));
    assert_eq!(spline.warnings[0].message, "where X, Y began to move by increments is not known");
}

#[test]
fn moves_and_curves_go_together() {
    let part = part("G0 X0 Y0\nG1 X10 F60\nG2 X20 R5\nG0 X0\n");
    assert_eq!(part.moves.len(), part.curves.len());
    let rapid = |m: &Move| m.kind == MoveKind::Rapid;
    assert_eq!(part.moves.iter().map(rapid).collect::<Vec<_>>(), [false, false, true]);
}

/// Arcs were once bent by up to 0.02 mm without a message.
#[test]
fn radii_that_a_control_may_refuse_are_named_with_their_line() {
    let said = |text: &str| {
        let part = read_part("p.nc", text).unwrap();
        part.warnings.iter().map(|warning| (warning.line, warning.message.clone())).collect::<Vec<_>>()
    };
    let off_circle = "the end is off the circle: radius 5.0000 at the start, 5.0190 at the end; the path goes from one to the other";
    assert_eq!(said("G0 X0 Y0\nG2 X10.019 I5\n"), [(2, off_circle.to_string())]);
    let too_small = "radius 5.0000 does not reach: 5.0100 is taken";
    assert_eq!(said("G0 X0 Y0\nG2 X10.02 R5\n"), [(2, too_small.to_string())]);
    // What rounding to three decimals does, and a ten-thousandth of the radius.
    for taken in ["G0 X0 Y0\nG2 X10.004 I5\n", "G0 X0 Y0\nG3 X400.019 I200\n", "G0 X0 Y0\nG2 X10.002 R5\n"] {
        assert_eq!(said(taken), [], "{taken}");
    }
}
