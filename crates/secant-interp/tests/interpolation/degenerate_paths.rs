//! Paths at the edge of what a curve may be: each runs to its end in every format, or is refused with a reason.

use crate::path_run::{Figures, Path, Settings, compiled, run, run_watched};
use nurbs_core::{CompileError, NurbsBuf};
use real::{Backend, I3F29, I4F28, I4F60, I8F24, I16F48};

fn clamped(degree: usize, inner: &[f64]) -> Vec<f64> {
    let ends = |u: f64| std::iter::repeat_n(u, degree + 1);
    ends(0.0).chain(inner.iter().copied()).chain(ends(1.0)).collect()
}

fn plain(degree: usize, points: Vec<[f64; 2]>, inner: &[f64]) -> NurbsBuf<f64, 2> {
    NurbsBuf::try_new_nonrational(degree, points, clamped(degree, inner)).unwrap()
}

fn path(curve: NurbsBuf<f64, 2>, feed_mm: f64) -> Path<2> {
    Path { curves: vec![curve], feed_mm }
}

/// The outcome in each format: f64, f32, I3F29, I4F28, I8F24, I16F48, I4F60. A run that is not refused has no
/// overflow and no division by zero, and makes the same steps unwatched.
fn in_every_format(path: &Path<2>) -> [Result<Figures, CompileError>; 7] {
    fn one<R: Backend>(path: &Path<2>) -> Result<Figures, CompileError> {
        let (watched, audit) = run_watched(&R::name().to_string(), path, &Settings::default());
        assert_eq!((audit.overflows, audit.divisions_by_zero), (0, 0), "{}", R::name());
        let plain = run::<R, 2>(path, &Settings::default());
        assert_eq!(plain.as_ref().ok().map(|f| f.checksum), watched.as_ref().ok().map(|f| f.checksum));
        plain
    }
    [
        one::<f64>(path),
        one::<f32>(path),
        one::<I3F29>(path),
        one::<I4F28>(path),
        one::<I8F24>(path),
        one::<I16F48>(path),
        one::<I4F60>(path),
    ]
}

/// Runs in every format; the largest fluctuation at cruise in f64.
fn runs_in_every_format(path: &Path<2>) -> f64 {
    let outcomes = in_every_format(path);
    for outcome in &outcomes {
        assert!(outcome.is_ok(), "{}", outcome.as_ref().unwrap_err());
    }
    let cruise: Vec<_> = outcomes.iter().map(|outcome| outcome.as_ref().unwrap().cruise).collect();
    println!("{cruise:?} in {} steps", outcomes[0].as_ref().unwrap().steps);
    cruise[0]
}

/// x = 10 s², y = 10 s³ with s = 1 - 2t: the direction turns round in a point of no speed, at t = ½. A run that does not stop there
/// goes on where it turns back: the one step that crosses is shorter than wanted.
#[test]
fn a_cusp_is_crossed() {
    let cusp = plain(3, vec![[10.0, 10.0], [-10.0 / 3.0, -10.0], [-10.0 / 3.0, 10.0], [10.0, -10.0]], &[]);
    let cruise = runs_in_every_format(&path(cusp, 0.2));
    assert!(cruise <= 1.0, "{cruise}");
}

/// The double point takes all speed out of the curve's ends, though not its smoothness.
#[test]
fn coincident_end_points_are_left_and_reached() {
    let curve = plain(3, vec![[0.0, 0.0], [0.0, 0.0], [20.0, 10.0], [40.0, 0.0], [40.0, 0.0]], &[0.5]);
    let cruise = runs_in_every_format(&path(curve, 0.2));
    assert!(cruise < 1e-9, "{cruise}");
}

/// A triple point takes all speed out of the curve where its direction goes on. What stands still is 1e-9 mm of a step on either side.
#[test]
fn a_place_without_speed_is_passed_where_the_direction_goes_on() {
    let points = [0.0, 10.0, 20.0, 20.0, 20.0, 30.0, 40.0].map(|x| [x, 0.5 * x]).to_vec();
    let cruise = runs_in_every_format(&path(plain(3, points, &[0.25, 0.5, 0.75]), 0.2));
    assert!(cruise < 3e-8, "{cruise}");
}

#[test]
fn a_curve_that_is_a_point_is_refused_by_name() {
    for outcome in in_every_format(&path(plain(2, vec![[3.0, 4.0]; 4], &[0.5]), 0.2)) {
        assert!(matches!(outcome, Err(CompileError::Cusp { curve: 0, .. })), "{outcome:?}");
    }
}

/// Two equal inner control points slow the curve without stopping it.
#[test]
fn coincident_inner_points_are_passed() {
    let points = vec![[0.0, 0.0], [10.0, 15.0], [20.0, -5.0], [20.0, -5.0], [30.0, 20.0], [45.0, 0.0]];
    let cruise = runs_in_every_format(&path(plain(3, points, &[0.3, 0.7]), 0.2));
    assert!(cruise < 1e-12, "{cruise}");
}

/// A step over a corner covers as much of the path as it is long, however sharp that is.
#[test]
fn corners_are_crossed() {
    let corner = |degrees: f64| {
        let (sine, cosine) = degrees.to_radians().sin_cos();
        plain(1, vec![[0.0, 0.0], [20.0, 0.0], [20.0 + 20.0 * cosine, 20.0 * sine]], &[0.5])
    };
    for degrees in [10.0, 45.0, 90.0, 150.0, 180.0] {
        let cruise = runs_in_every_format(&path(corner(degrees), 0.7));
        assert!(cruise < 1e-11, "{degrees}°: {cruise}");
    }
}

/// A knot of multiplicity p: the directions before and after have nothing to do with each other. The second turns back by 148°,
/// and the speed falls behind it.
#[test]
fn a_continuous_knot_is_crossed() {
    for behind in [[29.0, 3.0], [20.0, 9.0]] {
        let points =
            vec![[0.0, 0.0], [5.0, 8.0], [15.0, 8.0], [20.0, 0.0], behind, [30.0, 12.0], [35.0, 3.0]];
        let cruise = runs_in_every_format(&path(plain(3, points, &[0.5, 0.5, 0.5]), 0.3));
        assert!(cruise < 1e-11, "{behind:?}: {cruise}");
    }
}

/// The chord is; a place of f64 has 52 digits of the piece, of which the shortest step seen here takes a thousandth.
#[test]
fn a_straight_line_is_exact() {
    let bound = 1000.0 * f64::EPSILON;
    let cruise = runs_in_every_format(&path(plain(1, vec![[0.0, 0.0], [100.0, 75.0]], &[]), 0.4));
    assert!(cruise < bound, "{cruise}");
    let cruise =
        runs_in_every_format(&path(plain(1, vec![[0.0, 0.0], [40.0, 30.0], [80.0, 60.0]], &[0.1]), 0.4));
    assert!(cruise < bound, "{cruise}");
}

/// The one step that a short curve takes lands on its end.
#[test]
fn a_curve_shorter_than_a_step_ends_in_few() {
    for length in [1e-1, 1e-3, 1e-6] {
        let curve = plain(2, vec![[0.0, 0.0], [0.5 * length, 0.1 * length], [length, 0.0]], &[]);
        for outcome in in_every_format(&path(curve, 0.5)) {
            let figures = outcome.unwrap();
            assert!(figures.steps <= 20, "{length} mm: {} steps", figures.steps);
        }
    }
}

/// Spans of 1e-3 mm and 1e-6 mm, of which a step of 0.4 mm crosses up to thirty.
#[test]
fn spans_much_shorter_than_a_step_are_crossed() {
    for gap in [1e-4, 1e-7] {
        let points: Vec<_> =
            (0..36).map(|i| [3.0 * f64::from(i), 4.0 * (0.4 * f64::from(i)).sin()]).collect();
        let inner: Vec<_> = (0..32).map(|i| 0.5 + gap * f64::from(i)).collect();
        let outcomes = in_every_format(&path(plain(3, points, &inner), 0.4));
        for (outcome, wide) in outcomes.iter().zip([true, true, false, false, true, true, false]) {
            assert!(
                outcome.is_ok() || (!wide && matches!(outcome, Err(CompileError::DoesNotFit { .. }))),
                "{outcome:?}"
            );
        }
    }
}

/// The next float after ½ as a knot: a span of one ulp, 1e-14 mm long.
#[test]
fn knots_one_ulp_apart_are_crossed() {
    let next = 0.5_f64.next_up();
    let points: Vec<_> = (0..8).map(|i| [9.0 * f64::from(i), 5.0 * f64::from(i % 3)]).collect();
    let cruise = runs_in_every_format(&path(plain(3, points, &[0.25, 0.5, next, 0.75]), 0.3));
    assert!(cruise < 1e-11, "{cruise}");
}

#[test]
fn very_different_weights_are_cut_finely() {
    let points: Vec<_> = (0..8).map(|i| [9.0 * f64::from(i), 5.0 * f64::from(i % 3)]).collect();
    let weights = vec![1.0, 1e-3, 1e3, 1.0, 1e3, 1e-3, 1e-3, 1.0];
    let curve = NurbsBuf::try_new(3, points, weights, clamped(3, &[0.2, 0.4, 0.6, 0.8])).unwrap();
    let path = path(curve, 0.2);
    for outcome in in_every_format(&path) {
        assert!(outcome.is_ok() || matches!(outcome, Err(CompileError::DoesNotFit { .. })), "{outcome:?}");
    }
    assert!(run::<f64, 2>(&path, &Settings::default()).is_ok());
    let table = compiled::<f64, 2>(&path, &Settings::default()).unwrap();
    assert!(table.places().len() < 2000, "{} pieces", table.places().len());
}

#[test]
fn almost_equal_weights_are_rational_and_do_no_harm() {
    let points: Vec<_> = (0..8).map(|i| [9.0 * f64::from(i), 5.0 * f64::from(i % 3)]).collect();
    let mut weights = vec![1.0; 8];
    weights[3] = 1.0_f64.next_up();
    let curve = NurbsBuf::try_new(3, points, weights, clamped(3, &[0.2, 0.4, 0.6, 0.8])).unwrap();
    let cruise = runs_in_every_format(&path(curve, 0.2));
    assert!(cruise < 1e-12, "{cruise}");
}

/// A path of a line, a rational arc that goes on in its direction, and a cubic that does so too: degrees and weights
/// differ, and the speeds at the joints do.
#[test]
fn a_path_of_several_curves_is_one_path() {
    let line = plain(1, vec![[0.0, 0.0], [30.0, 0.0]], &[]);
    let arc = NurbsBuf::try_new(
        2,
        vec![[30.0, 0.0], [40.0, 0.0], [40.0, 10.0]],
        vec![1.0, 0.5_f64.sqrt(), 1.0],
        clamped(2, &[]),
    )
    .unwrap();
    let cubic = plain(3, vec![[40.0, 10.0], [40.0, 25.0], [20.0, 30.0], [10.0, 60.0]], &[]);
    let cruise = runs_in_every_format(&Path { curves: vec![line, arc, cubic], feed_mm: 0.2 });
    assert!(cruise < 1e-11, "{cruise}");
}

/// One evaluation at most: the run is coarse, but it ends, and goes forward.
#[test]
fn one_evaluation_is_enough_to_end() {
    let points: Vec<_> = (0..8).map(|i| [9.0 * f64::from(i), 5.0 * f64::from(i % 3)]).collect();
    let path = path(plain(3, points, &[0.2, 0.4, 0.6, 0.8]), 0.2);
    let settings = Settings { max_evaluations: 1, ..Settings::default() };
    let figures = run::<I4F28, 2>(&path, &settings).unwrap();
    assert!(figures.cruise < 1e-3, "{}", figures.cruise);
}

/// In the middle of an S the curvature is 0 and changes its sign.
#[test]
fn an_inflection_is_passed() {
    let points = vec![[0.0, 0.0], [20.0, 20.0], [20.0, -20.0], [40.0, 0.0]];
    let cruise = runs_in_every_format(&path(plain(3, points, &[]), 0.2));
    assert!(cruise < 1e-12, "{cruise}");
}

/// A loop that crosses itself: a place is a parameter, not a point.
#[test]
fn a_self_intersection_is_passed() {
    let points = vec![[0.0, 0.0], [60.0, 40.0], [-20.0, 40.0], [40.0, 0.0]];
    let cruise = runs_in_every_format(&path(plain(3, points, &[]), 0.2));
    assert!(cruise < 1e-12, "{cruise}");
}

#[test]
fn a_hundred_thousand_control_points_are_compiled_and_run() {
    let count = 100_000_u32;
    let points = (0..count).map(|i| [0.25 * f64::from(i), (0.3 * f64::from(i)).sin()]).collect();
    let inner: Vec<_> = (1..count - 3).map(|i| f64::from(i) / f64::from(count - 3)).collect();
    let long = path(plain(3, points, &inner), 5.0);
    let figures = run::<f64, 2>(&long, &Settings::default()).unwrap();
    assert!(figures.steps > 5000 && figures.joints >= 99_990, "{} {}", figures.steps, figures.joints);
    let coarse = run::<I8F24, 2>(&long, &Settings::default()).unwrap();
    assert!(coarse.steps.abs_diff(figures.steps) <= 2, "{} {}", coarse.steps, figures.steps);
}
