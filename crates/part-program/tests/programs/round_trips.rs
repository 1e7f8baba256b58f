//! Every written part reads back bit by bit.

use part_program::{
    Curve, Move, MoveKind, Nurbs, Part, Shape, WriteError, inspect, read_part, write_curves, write_g1,
    write_g5_2, write_g06_2,
};
use proptest::prelude::*;

fn part(text: &str) -> Part {
    read_part("p.nc", text).unwrap_or_else(|errors| panic!("{errors}\n{text}"))
}

/// A part of curves that are all followed at one feedrate.
fn at_feed(curves: &[Curve], feedrate_mm_per_s: Option<f64>) -> Part {
    let one = Move {
        kind: MoveKind::Feed,
        shape: Shape::Nurbs,
        feedrate_mm_per_s,
        exact_stop: false,
        line: 1,
        block: 0,
    };
    Part { curves: curves.to_vec(), moves: vec![one; curves.len()], ..Part::default() }
}

/// Any coordinate that a curve may have, with all its bits.
fn coordinate() -> impl Strategy<Value = f64> {
    prop_oneof![-1e3..1e3, Just(0.0), -1e-9..1e-9, (-1000..1000_i32).prop_map(f64::from), -1e7..1e7]
}

/// Curves of every degree with random bits in points, weights and knots.
fn curves(planar: bool, least_degree: usize) -> impl Strategy<Value = Curve> {
    (least_degree..=9_usize, 0..8_usize)
        .prop_flat_map(move |(degree, extra)| {
            let points = degree + 1 + extra;
            let z = if planar { Just(0.0).boxed() } else { coordinate().boxed() };
            let point = (coordinate(), coordinate(), z).prop_map(|(x, y, z)| [x, y, z]);
            (
                prop::collection::vec(point, points),
                prop::collection::vec(1e-3..1e3_f64, points),
                prop::collection::vec(0.01..1.0_f64, extra + 1),
                -5.0..5.0_f64,
            )
                .prop_map(move |(control_points_mm, weights, steps, first)| {
                    let mut knots = vec![first; degree + 1];
                    let mut u = first;
                    for step in &steps {
                        u += step;
                        knots.push(u);
                    }
                    knots.extend(vec![u; degree]);
                    let flat = control_points_mm.iter().all(|p| p[2] == 0.0);
                    let dimension = if flat { 2 } else { 3 };
                    Curve::from(Nurbs { degree, control_points_mm, dimension, weights, knots })
                })
        })
        .prop_filter("a curve of some length", |curve| curve.faults().is_empty())
}

proptest! {
    #[test]
    fn g06_2_keeps_every_bit(curve in curves(false, 1)) {
        let part = part(&write_g06_2(&at_feed(std::slice::from_ref(&curve), None)).unwrap());
        prop_assert_eq!(part.curves, [curve]);
    }

    #[test]
    fn g5_2_keeps_every_bit_of_a_curve_with_its_own_knots(curve in curves(true, 2)) {
        let spans = curve.control_points_mm().len() - curve.degree();
        let knot = |i: usize| i.saturating_sub(curve.degree()).min(spans) as f64;
        let knots = (0..curve.knots().len()).map(knot).collect();
        let curve = Curve::from(Nurbs { knots, ..curve.to_nurbs() });
        let part = part(&write_g5_2(&at_feed(std::slice::from_ref(&curve), None)).unwrap());
        prop_assert_eq!(part.curves, [curve]);
    }

    /// A curve of other knots is cut into Bézier curves: the ends are exact and the joints closed. Spans that are points are
    /// left out.
    #[test]
    fn g5_2_of_other_knots_is_the_same_path(curve in curves(true, 2)) {
        let part = part(&write_g5_2(&at_feed(std::slice::from_ref(&curve), None)).unwrap());
        let moves = |points: &[[f64; 3]]| points.iter().any(|point| *point != points[0]);
        let inner = &curve.knots()[curve.degree()..curve.knots().len() - curve.degree()];
        let spans = inner.windows(2).zip(curve.control_points_mm().windows(curve.degree() + 1));
        let spans = spans.filter(|(knots, points)| knots[0] < knots[1] && moves(points)).count();
        prop_assert!(part.curves.len() == spans || part.curves.len() == 1, "{} of {spans}", part.curves.len());
        prop_assert_eq!(part.curves[0].control_points_mm().first(), curve.control_points_mm().first());
        prop_assert_eq!(part.curves.last().unwrap().control_points_mm().last(), curve.control_points_mm().last());
        for pair in part.curves.windows(2) {
            prop_assert_eq!(pair[0].control_points_mm().last(), pair[1].control_points_mm().first());
        }
    }

    #[test]
    fn g1_keeps_every_bit(
        points in prop::collection::vec([coordinate(), coordinate(), coordinate()], 2..20),
        feed in (1..2_000_000_u32).prop_map(|hundredths| f64::from(hundredths) / 100.0),
    ) {
        let line = |ends: &[[f64; 3]]| Nurbs {
            degree: 1,
            control_points_mm: ends.to_vec(),
            dimension: 3,
            weights: vec![1.0; 2],
            knots: vec![0.0, 0.0, 1.0, 1.0],
        };
        let lines: Vec<_> = points.windows(2).filter(|ends| ends[0] != ends[1]).map(line).map(Curve::from).collect();
        prop_assume!(!lines.is_empty());
        let text = write_g1(&at_feed(&lines, Some(feed / 60.0)), 1e-3, None).unwrap();
        let again = part(&text);
        let ends = |curve: &Curve| curve.control_points_mm().to_vec();
        prop_assert_eq!(again.curves.iter().map(ends).collect::<Vec<_>>(), lines.iter().map(ends).collect::<Vec<_>>());
        prop_assert_eq!(again.moves[0].feedrate_mm_per_s, Some(feed / 60.0));
        // As it was commanded: 60 times the quotient often has other last digits.
        let word = format!(" F{feed}{}\n", if feed.fract() == 0.0 { "." } else { "" });
        prop_assert!(text.contains(&word), "{}", text);
    }
}

#[test]
fn what_is_cut_for_g5_2_has_the_points_of_the_curve() {
    let paper = read_part("d.nc", include_str!("../../../../data/seed-003.nc")).unwrap();
    let cut = part(&write_g5_2(&at_feed(&paper.curves, Some(50.0))).unwrap());
    assert_eq!(cut.curves.len(), 7);
    assert_eq!(cut.feedrate_mm_per_s, Some(50.0));
    // The middle of each Bézier cubic, (P0 w0 + 3 P1 w1 + 3 P2 w2 + P3 w3)/Σ, on the curve by de Boor.
    let curve = &paper.curves[0];
    let knots: Vec<f64> = {
        let mut k = curve.knots().to_vec();
        k.dedup();
        k
    };
    for (piece, pair) in cut.curves.iter().zip(knots.windows(2)) {
        let middle = de_boor(piece, 0.5);
        let expected = de_boor(curve, f64::midpoint(pair[0], pair[1]));
        let off = (middle[0] - expected[0]).hypot(middle[1] - expected[1]);
        assert!(off < 1e-12, "{pair:?}: {off}");
    }
}

fn de_boor(curve: &Curve, u: f64) -> [f64; 2] {
    let (p, knots) = (curve.degree(), &curve.knots());
    let span = knots.iter().rposition(|knot| *knot <= u).unwrap();
    let mut work: Vec<[f64; 3]> = (span - p..=span)
        .map(|i| {
            let ([x, y, _], w) = (curve.control_points_mm()[i], curve.weights()[i]);
            [w * x, w * y, w]
        })
        .collect();
    for level in 1..=p {
        for j in (level..=p).rev() {
            let i = span - p + j;
            let t = (u - knots[i]) / (knots[i + p + 1 - level] - knots[i]);
            work[j] = std::array::from_fn(|axis| (1.0 - t) * work[j - 1][axis] + t * work[j][axis]);
        }
    }
    [work[p][0] / work[p][2], work[p][1] / work[p][2]]
}

#[test]
fn g06_2_is_written_as_people_write_it() {
    let part = part("G0 X0 Y0\nG06.2 P2 K0 X0 Y0 R1\nK0 X10.25 Y5 R0.5\nK1\nK1\n");
    let written = "G21 G90 G94
G05 P10000
G0 X0. Y0.
G06.2 P2 K0. X0. Y0. R1. F1200.
K0. X10.25 Y5. R0.5
K1.
K1.
G05 P0
M30
";
    assert_eq!(write_g06_2(&at_feed(&part.curves, Some(20.0))).unwrap(), written);
}

#[test]
fn g5_2_refuses_a_curve_that_leaves_its_plane() {
    let part = part("G0 X0 Y0 Z0\nG18 G3 X5 Z5 R5\n");
    assert_eq!(write_g5_2(&part), Err(WriteError::NotPlanar { curve: 0, line: 2 }));
}

#[test]
fn curves_that_do_not_join_are_reached_by_a_rapid() {
    let one = part("G0 X0 Y0\nG3 X10 Y0 R5\n").curves.remove(0);
    let two = part("G0 X20 Y0\nG3 X30 Y0 R5\n").curves.remove(0);
    let read = part(&write_g06_2(&at_feed(&[one.clone(), two.clone()], None)).unwrap());
    assert_eq!(read.curves.len(), 3);
    assert_eq!([&read.curves[0], &read.curves[2]], [&one, &two]);
}

const PROGRAM: &str = "(three kinds of move, at three feeds)
T1 M6
S1200 M3
G0 X1.5 Y-2 Z5
G1 Z-0.2 F300
G1 X10.1 F2400.7 M8
G3 X20.1 Y8 R10
G06.2 P3 K0 X20.1 Y8 F777
K0 X30.3 R2
K0 X30 Y0 Z-0.3
K0.3 X31
K1
K1
K1
G1 X40 M9
G0 Z5 M5
M30
";

/// Moves, feeds and words are where they were, and every number is the same.
#[test]
fn a_whole_program_makes_the_round_trip() {
    let before = part(PROGRAM);
    for text in [write_g06_2(&before).unwrap(), write_curves(&before)] {
        let after = part(&text);
        assert_eq!(after.curves, before.curves, "{text}");
        let said = |part: &Part| part.moves.iter().map(|m| (m.kind, m.feedrate_mm_per_s)).collect::<Vec<_>>();
        assert_eq!(said(&after), said(&before), "{text}");
    }
    let after = part(&write_g06_2(&before).unwrap());
    let words = |part: &Part| part.auxiliary.iter().map(|w| (w.letter, w.value)).collect::<Vec<_>>();
    assert_eq!(words(&after), words(&before));
    // Each word stands before or behind the same move as it did.
    let place = |part: &Part, letter: char, value: f64| {
        let line =
            part.auxiliary.iter().find(|w| (w.letter, w.value) == (letter, value)).unwrap().line as usize;
        part.moves.iter().filter(|one| one.line < line).count()
    };
    for (letter, value, moves_before) in [('M', 3.0, 0), ('M', 8.0, 1), ('M', 9.0, 5), ('M', 5.0, 6)] {
        assert_eq!(
            place(&after, letter, value),
            moves_before,
            "{letter}{value}\n{}",
            write_g06_2(&before).unwrap()
        );
    }
}

#[test]
fn chords_are_as_near_as_asked_and_keep_the_ends() {
    let before = part(PROGRAM);
    let coarse = part(&write_g1(&before, 0.1, None).unwrap());
    let fine = part(&write_g1(&before, 0.001, None).unwrap());
    assert!(fine.curves.len() > 5 * coarse.curves.len() / 2, "{} {}", fine.curves.len(), coarse.curves.len());
    assert!(fine.curves.iter().all(|curve| curve.degree() == 1));
    let (curve, chords) = (inspect(&before).length_mm, inspect(&fine).length_mm);
    assert!(curve - chords > 0.0 && curve - chords < 0.01, "{curve} {chords}");
    for curve in &before.curves {
        let end = curve.control_points_mm().last();
        assert!(fine.curves.iter().any(|chord| chord.control_points_mm().last() == end), "{end:?}");
    }
    assert_eq!(fine.feedrate_mm_per_s, before.feedrate_mm_per_s);
    assert!(
        matches!(write_g1(&before, 1e-14, None), Err(WriteError::SpanTooFine { curve: 2, .. })),
        "{:?}",
        write_g1(&before, 1e-14, None)
    );
}

/// A quadrant of radius r = 5 in 2¹⁹ chords has control points (π/2/2¹⁹)² r/4 = 1.1e-11 mm off them, in 2¹⁸ four times
/// as far: at 2e-11 mm a circle takes 2²¹ chords.
#[test]
fn what_a_program_does_not_hold_is_refused_with_what_it_would_take() {
    let refused = |circles: usize| {
        let circles = part(&("G0 X0 Y0\n".to_owned() + &"G3 X0 Y0 I5\n".repeat(circles)));
        write_g1(&circles, 2e-11, None).unwrap_err()
    };
    let of_one = refused(1);
    assert!(matches!(of_one, WriteError::TooLong { bytes: 70_000_000..100_000_000 }), "{of_one:?}");
    assert_eq!(refused(3), WriteError::TooManyChords { needed: 3 << 21 });
    let said = refused(10);
    assert_eq!(
        said.to_string(),
        "the tolerance takes at least 20447232 chords, and a program has at most 5000000: give a larger one"
    );
}

/// The last spans of a spline are points: it is written to where it last moves.
#[test]
fn a_spline_is_written_without_the_points_that_its_last_spans_are() {
    let mut control_points_mm = vec![[0.0; 3]; 6];
    control_points_mm[1][1] = -2.842_554_749_496_391_4e-10;
    let end = 0.239_402_677_881_482_98;
    let knots = vec![0.0, 0.0, 0.0, 0.01, 0.02, 0.03, end, end, end];
    let curve =
        Curve::from(Nurbs { degree: 2, control_points_mm, dimension: 2, weights: vec![1e-3; 6], knots });
    let written = part(&write_g5_2(&at_feed(std::slice::from_ref(&curve), None)).unwrap());
    assert_eq!(written.curves.len(), 2, "of four spans");
    assert_eq!(written.curves[1].control_points_mm().last(), curve.control_points_mm().last());
}

/// Four equal control points of a cubic: the curve stands still over a span.
#[test]
fn a_curve_that_stands_still_for_a_span_is_written_without_it() {
    let text = "[curve]\ndegree = 3\ncontrol_points_mm = [[0, 0], [2, 2], [2, 2], [2, 2], [2, 2], [4, 0], [5, 0]]\n\
                knots = [0, 0, 0, 0, 0.1, 0.2, 0.7, 1, 1, 1, 1]\n";
    let before = read_part("p.toml", text).unwrap();
    let cut = part(&write_g5_2(&before).unwrap());
    assert_eq!(cut.curves.len(), 3, "of four spans");
    let chords = part(&write_g1(&before, 0.01, None).unwrap());
    assert!(chords.standstills.is_empty());
    assert!((inspect(&chords).length_mm - inspect(&before).length_mm).abs() < 0.01);
}

#[test]
fn a_rapid_move_that_is_not_straight_is_refused() {
    let mut part = part("G0 X0 Y0\nG3 X10 Y0 R5\n");
    part.moves[0].kind = MoveKind::Rapid;
    for written in [write_g06_2(&part), write_g5_2(&part), write_g1(&part, 0.01, None)] {
        assert_eq!(written, Err(WriteError::CurvedRapid { curve: 0, line: 2 }));
    }
}

proptest! {
    /// Feedrates too.
    #[test]
    fn feedrates_are_read_back(feed in 0.001..2e5_f64, inches in any::<bool>()) {
        let unit = if inches { "G20" } else { "G21" };
        let before = part(&format!("{unit} G0 X0 Y0\nG1 X1 F{feed}\n"));
        let after = part(&write_g06_2(&before).unwrap());
        prop_assert_eq!(after.feedrate_mm_per_s, before.feedrate_mm_per_s);
    }
}
