//! The papers' curves in every format.

use feed_plan::{KinematicLimits, ProfileKind};
use nurbs_core::NurbsBuf;
use real::{I3F29, I4F28, I4F60, I8F24, I16F16, I16F48};
use secant_interp::TABLE_LAYOUT;
use stress::RandomPath;

use crate::compiler::Parts;

type I4F12 = real::FixedPoint<real::fixed::types::I4F12>;

fn clamped(inner: &[f64]) -> Vec<f64> {
    [&[0.0; 4], inner, &[1.0; 4]].concat()
}

/// Curves at a feed in mm a period, within limits that suit it.
fn at<const D: usize>(feedrate: f64, curves: Vec<NurbsBuf<f64, D>>) -> RandomPath<D> {
    let limits = KinematicLimits {
        interpolation_period: 1.0,
        feedrate,
        acceleration: feedrate / 15.0,
        jerk: feedrate / 60.0,
        chord_error: 5e-4,
        centripetal_acceleration: None,
        axes: Default::default(),
        junction: Default::default(),
    };
    RandomPath { curves, limits, profile: ProfileKind::Cubic, max_evaluations: 5, piece_mm: 32.0 }
}

/// Paper A's curve, seven points, 300 mm wide.
fn paper_a() -> RandomPath<2> {
    let points = [[150, 150], [0, 0], [0, 300], [150, 150], [300, 0], [300, 300], [150, 150]];
    let points = points.map(|p| p.map(f64::from)).to_vec();
    at(0.6, NurbsBuf::try_new_nonrational(3, points, clamped(&[0.25, 0.5, 0.75])).into_iter().collect())
}

/// The rational curve of ten points, in space.
fn ten_points() -> RandomPath<3> {
    let x = [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 65.0, 70.0, 80.0];
    let y = [15.0, 34.1, 10.1, 16.1, 0.9, 38.0, 2.9, 8.9, 26.1, 5.9];
    let points = x.into_iter().zip(y).map(|(x, y)| [x, y, 0.1 * x]).collect();
    let weights = vec![1.0, 2.0, 1.5, 1.0, 1.0, 2.0, 1.0, 1.0, 2.0, 1.0];
    let knots = clamped(&[0.1836, 0.2781, 0.3837, 0.5474, 0.7104, 0.8049]);
    at(0.15, NurbsBuf::try_new(3, points, weights, knots).into_iter().collect())
}

/// Straight lines around a square, with a stop at each corner, and further on through a slight corner.
fn lines() -> RandomPath<2> {
    let points = [[0.0, 0.0], [40.0, 0.0], [40.0, 40.0], [0.0, 40.0], [-20.0, 41.0]];
    let line = |ends: &[[f64; 2]]| {
        NurbsBuf::try_new_nonrational(1, ends.to_vec(), vec![0.0, 0.0, 1.0, 1.0]).expect("a line")
    };
    at(0.5, points.windows(2).map(line).collect())
}

macro_rules! in_every_format {
    ($($test:ident: $path:expr;)*) => {$(
        #[test]
        fn $test() {
            let mut parts = Parts::default();
            let path = $path;
            let added = [
                parts.add::<I4F12, _>(&path, 9000, false),
                parts.add::<I16F16, _>(&path, 9000, false),
                parts.add::<I8F24, _>(&path, 9000, false),
                parts.add::<I4F28, _>(&path, 9000, false),
                parts.add::<I3F29, _>(&path, 9000, false),
                parts.add::<I16F48, _>(&path, 9000, false),
                parts.add::<I4F60, _>(&path, 9000, false),
                parts.add::<f32, _>(&path, 9000, false),
                parts.add::<f64, _>(&path, 9000, false),
            ];
            assert_eq!(added, [true; 9], "every format holds the path");
            parts.demand_the_same_runs();
        }
    )*};
}

in_every_format! {
    the_plane_cubic_runs_as_in_rust: paper_a();
    the_rational_cubic_in_space_runs_as_in_rust: ten_points();
    lines_from_stop_to_stop_run_as_in_rust: lines();
    half_cosines_run_as_in_rust: RandomPath { profile: ProfileKind::Trigonometric, ..paper_a() };
    constant_jerk_runs_as_in_rust: paper_a().fastest();
    // In I4F28, x is above 2 here: no factor for the products of halves.
    long_chords_run_as_in_rust: at(0.72, paper_a().curves);
}

/// The last place of one coefficient, one stage and one operation: each is enough.
#[test]
fn a_self_test_finds_the_slightest_change() {
    let mut parts = Parts::default();
    let path = paper_a();
    for _ in 0..3 {
        assert!(parts.add::<I4F28, _>(&path, 9000, false));
    }
    assert!(parts.add::<f32, _>(&path, 9000, true));
    // The first coefficient of the table, which is the first word of its first row.
    parts.change(0, |source| {
        let (before, table) =
            source.split_once("numerators[][AXES][DEGREE] = {\n    { { ").expect("the table");
        let (first, after) = table.split_once(',').expect("a number");
        let word: i32 = first.parse().expect("a word");
        format!("{before}numerators[][AXES][DEGREE] = {{\n    {{ {{ {},{after}", word + 1)
    });
    // Products are cut instead of rounded.
    parts.change(1, |source| source.replace(" + ((low >> (FRACTION_BITS - 1u)) & 1u)", ""));
    // The rate may change faster: the run without override is the same.
    parts.change(3, |source| source.replace("#define MAX_BEND INT64_C(", "#define MAX_BEND INT64_C(1"));
    parts.demand_verdicts(&[2, 2, 0, 3]);
}

/// The two files are of one run, or the compiler says which layout each has.
#[test]
fn a_header_of_another_layout_is_refused_by_name() {
    let mut parts = Parts::default();
    assert!(parts.add::<I4F28, _>(&paper_a(), 9000, false));
    let own = format!("#define PART0_LAYOUT {TABLE_LAYOUT}\n");
    parts.change_header(0, |header| header.replace(&own, "#define PART0_LAYOUT 99\n"));
    let tables = format!("the tables of part0.c are of layout {TABLE_LAYOUT}");
    parts.demand_refusal(&["part0.h is of layout 99", &tables, "take both files"]);
}
