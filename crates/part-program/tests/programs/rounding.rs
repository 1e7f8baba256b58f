//! A part written with few decimals lies within the stated distance of the original, and its curves stay joined.

use nurbs_core::{Evaluate, NurbsBuf};
use part_program::{
    Curve, Move, MoveKind, Nurbs, Part, RatioWords, Rounded, Shape, read_part, write_g1, write_g5_2,
    write_g06_2,
};
use proptest::prelude::*;

fn nurbs(curve: &Curve) -> NurbsBuf<f64, 3> {
    curve.for_evaluation().unwrap()
}

fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1]).hypot(a[2] - b[2])
}

fn to_segment(point: [f64; 3], from: [f64; 3], to: [f64; 3]) -> f64 {
    let along = |a: [f64; 3]| (0..3).map(|d| (a[d] - from[d]) * (to[d] - from[d])).sum::<f64>();
    let share = if from == to { 0.0 } else { (along(point) / along(to)).clamp(0.0, 1.0) };
    distance(point, std::array::from_fn(|d| from[d] + share * (to[d] - from[d])))
}

/// Distance of the farthest of some points from a polygon.
fn farthest(points: &[[f64; 3]], polygon: &[[f64; 3]]) -> f64 {
    let nearest = |point: &[f64; 3]| {
        polygon.windows(2).map(|side| to_segment(*point, side[0], side[1])).fold(f64::INFINITY, f64::min)
    };
    points.iter().map(nearest).fold(0.0, f64::max)
}

/// By basis functions, whose terms have one sign: accurate with any weights.
fn samples(curve: &Curve, count: u32) -> Vec<[f64; 3]> {
    let nurbs = nurbs(curve);
    let (first, last) = nurbs.as_curve().domain();
    let share = |k: u32| f64::from(k) / f64::from(count);
    (0..=count).map(|k| nurbs.as_curve().point((first + (last - first) * share(k)).min(last))).collect()
}

/// The corners of a part of chords that join.
fn corners(chords: &Part) -> Vec<[f64; 3]> {
    let start = chords.curves[0].control_points_mm()[0];
    let ends = chords.curves.iter().map(|chord| chord.control_points_mm()[1]);
    std::iter::once(start).chain(ends).collect()
}

fn at_feed(curves: Vec<Curve>) -> Part {
    let one = Move {
        kind: MoveKind::Feed,
        shape: Shape::Nurbs,
        feedrate_mm_per_s: Some(10.0),
        exact_stop: false,
        line: 1,
        block: 0,
    };
    Part { moves: vec![one; curves.len()], curves, ..Part::default() }
}

fn read(text: &str) -> Part {
    read_part("p.nc", text).unwrap_or_else(|errors| panic!("{errors}\n{text}"))
}

/// A part as `write` writes it with `decimals`, and as it reads back.
fn rounded(part: &Part, decimals: usize, write: impl Fn(&Part) -> String) -> (Rounded, Part, String) {
    let rounded = read(&write(part)).rounded(decimals);
    let text = write(&rounded.part);
    let again = read(&text);
    assert_eq!(again.curves, rounded.part.curves, "{text}");
    for pair in again.curves.windows(2) {
        assert_eq!(pair[0].control_points_mm().last(), pair[1].control_points_mm().first(), "{text}");
    }
    for word in text.split_whitespace().filter(|word| word.starts_with(['X', 'Y', 'Z'])) {
        assert!(word.split('.').nth(1).is_some_and(|digits| digits.len() <= decimals), "{word}");
    }
    // Half a unit in each axis, and what f64 makes of the coordinate.
    let most = 0.75_f64.sqrt() * 0.1_f64.powi(i32::try_from(decimals).unwrap()) + 1e-12;
    assert!(rounded.moved_mm <= most, "{} > {most}", rounded.moved_mm);
    (rounded, again, text)
}

/// Two curves that join, of any degree, with random bits.
fn joined(size: f64) -> impl Strategy<Value = Part> {
    let curve = (1..=5_usize, 0..5_usize).prop_flat_map(move |(degree, extra)| {
        let points = degree + 1 + extra;
        (
            prop::collection::vec([-size..size, -size..size, -size..size], points),
            prop::collection::vec(1e-2..1e2_f64, points),
            prop::collection::vec(0.01..1.0_f64, extra + 1),
        )
            .prop_map(move |(control_points_mm, weights, steps)| {
                let mut knots = vec![-0.3; degree + 1];
                for step in steps {
                    knots.push(knots[knots.len() - 1] + step);
                }
                knots.extend(vec![knots[knots.len() - 1]; degree]);
                Curve::from(Nurbs { degree, control_points_mm, dimension: 3, weights, knots })
            })
    });
    (curve.clone(), curve).prop_map(|(one, mut two)| {
        two.control_points_mm_mut()[0] = one.control_points_mm()[one.control_points_mm().len() - 1];
        at_feed(vec![one, two])
    })
}

proptest! {
    #[test]
    fn splines_are_as_near_as_stated(part in joined(1e3), decimals in 0..=12_usize) {
        prop_assume!(part.keeps_moving_rounded(decimals).is_ok());
        let (rounded, again, _) = rounded(&part, decimals, |part| write_g06_2(part).unwrap());
        // A polygon of one side may have become none.
        prop_assume!(rounded.left_out == 0);
        for (before, after) in part.curves.iter().zip(&again.curves) {
            prop_assert_eq!((&before.knots(), &before.weights()), (&after.knots(), &after.weights()));
            for (a, b) in samples(before, 100).into_iter().zip(samples(after, 100)) {
                let off = distance(a, b);
                prop_assert!(off <= rounded.moved_mm + 1e-11, "{} > {}", off, rounded.moved_mm);
            }
        }
    }

    /// At the same shares of the spans; the words are no longer than asked, and read back.
    #[test]
    fn splines_of_ratio_words_are_as_near_as_stated(
        part in joined(1e3),
        largest in prop::sample::select(vec!["999999.999", "99999", "99.9999", "9999.9"]),
    ) {
        let fitted = part.in_ratio_words(&largest.parse::<RatioWords>().unwrap());
        prop_assume!(fitted.is_ok());
        let (fitted, moved_mm) = fitted.unwrap();
        let text = write_g06_2(&fitted).unwrap();
        prop_assert_eq!(&read(&text).curves, &fitted.curves);
        let decimals = largest.split_once('.').map_or(0, |(_, decimals)| decimals.len());
        for word in text.split_whitespace().filter(|word| word.starts_with(['K', 'R'])) {
            let (_, after) = word.split_once('.').unwrap();
            prop_assert!(after.len() <= decimals, "{}", word);
            prop_assert!(word[1..].parse::<f64>().unwrap() <= largest.parse::<f64>().unwrap(), "{}", word);
        }
        for (before, after) in part.curves.iter().zip(&fitted.curves) {
            let (from, to) = (nurbs(before), nurbs(after));
            prop_assert_eq!(&before.control_points_mm(), &after.control_points_mm());
            prop_assert_eq!(from.as_curve().span_count(), to.as_curve().span_count());
            for span in 0..from.as_curve().span_count() {
                for k in 0..=16 {
                    let place = |curve: &NurbsBuf<f64, 3>| {
                        let (a, b) = curve.as_curve().span_bounds(span);
                        curve.as_curve().point((a + (b - a) * f64::from(k) / 16.0).min(b))
                    };
                    let off = distance(place(&from), place(&to));
                    prop_assert!(off <= moved_mm + 1e-10, "{} > {}", off, moved_mm);
                }
            }
        }
    }

    #[test]
    fn chords_are_as_near_as_stated(part in joined(10.0), decimals in 0..=6_usize, tolerance in 0.01..0.5_f64) {
        let (rounded, again, _) = rounded(&part, decimals, |part| write_g1(part, tolerance, None).unwrap());
        let polygon = corners(&again);
        for curve in &part.curves {
            let off = farthest(&samples(curve, 100), &polygon);
            let bound = tolerance + rounded.moved_mm;
            prop_assert!(off <= bound + 1e-12, "{} > {}", off, bound);
        }
    }
}

/// Both ways, for a curve whose samples are near enough to each other to stand for it.
#[test]
fn the_written_path_is_as_near_to_the_part_as_the_part_to_it() {
    let part = read(include_str!("../../../../data/seed-003.nc"));
    let samples = samples(&part.curves[0], 2000);
    for (decimals, tolerance) in [(0, 0.5), (1, 0.1), (3, 0.001)] {
        let (rounded, again, _) = rounded(&part, decimals, |part| write_g1(part, tolerance, None).unwrap());
        let polygon = corners(&again);
        let bound = tolerance + rounded.moved_mm;
        for off in [farthest(&polygon, &samples), farthest(&samples, &polygon)] {
            assert!(off <= bound + 1e-4, "{decimals}: {off} > {bound}");
        }
    }
}

/// G5.2 cuts the curve at its knots: what is rounded are the pieces.
#[test]
fn pieces_are_as_near_as_stated() {
    let part = read(include_str!("../../../../data/seed-003.nc"));
    let curve = nurbs(&part.curves[0]);
    let mut knots = part.curves[0].knots().to_vec();
    knots.dedup();
    for decimals in 0..=9 {
        let (rounded, again, _) = rounded(&part, decimals, |part| write_g5_2(part).unwrap());
        assert_eq!(again.curves.len(), knots.len() - 1);
        for (piece, span) in again.curves.iter().zip(knots.windows(2)) {
            for (k, written) in samples(piece, 50).into_iter().enumerate() {
                let u = span[0] + (span[1] - span[0]) * k as f64 / 50.0;
                let off = distance(written, curve.as_curve().point(u));
                assert!(off <= rounded.moved_mm + 1e-12, "{decimals}: {off} > {}", rounded.moved_mm);
            }
        }
    }
}
