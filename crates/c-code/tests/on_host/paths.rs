//! Paths by name: the papers' curves, and paths of every kind whose C differs.

use feed_plan::{Junction, KinematicLimits, ProfileKind};
use nurbs_core::NurbsBuf;
use stress::RandomPath;

/// Curves at a feed in mm a period, within limits that suit it.
pub(crate) fn at<const D: usize>(feedrate: f64, curves: Vec<NurbsBuf<f64, D>>) -> RandomPath<D> {
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
pub(crate) fn paper_a() -> RandomPath<2> {
    let points = [[150, 150], [0, 0], [0, 300], [150, 150], [300, 0], [300, 300], [150, 150]];
    let points = points.map(|p| p.map(f64::from)).to_vec();
    at(0.6, NurbsBuf::try_new_nonrational(3, points, clamped(3, &[0.25, 0.5, 0.75])).into_iter().collect())
}

/// The rational curve of ten points, in space.
pub(crate) fn ten_points() -> RandomPath<3> {
    let x = [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 65.0, 70.0, 80.0];
    let y = [15.0, 34.1, 10.1, 16.1, 0.9, 38.0, 2.9, 8.9, 26.1, 5.9];
    let points = x.into_iter().zip(y).map(|(x, y)| [x, y, 0.1 * x]).collect();
    let weights = vec![1.0, 2.0, 1.5, 1.0, 1.0, 2.0, 1.0, 1.0, 2.0, 1.0];
    let knots = clamped(3, &[0.1836, 0.2781, 0.3837, 0.5474, 0.7104, 0.8049]);
    at(0.15, NurbsBuf::try_new(3, points, weights, knots).into_iter().collect())
}

/// Straight lines around a square, with a stop at each corner, and further on through a slight corner.
pub(crate) fn lines() -> RandomPath<2> {
    at(0.5, polyline(&[[0.0, 0.0], [40.0, 0.0], [40.0, 40.0], [0.0, 40.0], [-20.0, 41.0]]))
}

/// Paths in the plane: straight moves, arcs and splines of each degree, alone and with corners, each at one of the profiles.
pub(crate) fn in_the_plane() -> Vec<RandomPath<2>> {
    let half = 0.5_f64.sqrt();
    let quarter = |ends: [[f64; 2]; 3]| polynomial(&ends, &[1.0, half, 1.0]);
    let (right, top, left) = ([1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]);
    let arcs = vec![quarter([right, [1.0, 1.0], top]), quarter([top, [-1.0, 1.0], left])];
    let wave: Vec<_> = (0..9).map(|i| [0.3 * f64::from(i), 0.2 * f64::from(i * i % 5)]).collect();
    let there_and_back = vec![polynomial(&wave[..4], &[]), polynomial(&[wave[3], right, top, left], &[])];
    let zigzag = polyline(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.1], [3.0, 0.0], [3.0, 1.0]]);
    let paths = [
        at(0.01, polyline(&[[0.0, 0.0], [1.0, 0.5]])),
        at(0.01, vec![polynomial(&[[0.0, 0.0], [1.0, 0.5]], &[1.0, 2.0])]),
        at(0.02, zigzag.clone()),
        passing(at(0.02, zigzag)),
        at(0.02, arcs[..1].to_vec()),
        at(0.02, arcs),
        at(0.02, there_and_back.clone()),
        passing(at(0.02, there_and_back)),
        at(0.5, lines().curves),
        at(0.6, paper_a().curves),
    ];
    let of_degrees = (2..9).flat_map(|degree| {
        let weights: Vec<_> = (0..=degree).map(|i| [1.0, 1.5][i % 2]).collect();
        [&[][..], &weights].map(|weights| at(0.02, vec![polynomial(&wave[..=degree], weights)]))
    });
    paths.into_iter().chain(of_degrees).zip(PROFILES.into_iter().cycle()).map(with_profile).collect()
}

/// The same path at each of the profiles.
pub(crate) fn at_every_profile<const D: usize>(path: &RandomPath<D>) -> Vec<RandomPath<D>> {
    PROFILES.into_iter().map(|profile| with_profile((path.clone(), profile))).collect()
}

/// Paths in space: a straight move, a chain of them, a cubic and a rational curve.
pub(crate) fn in_space() -> Vec<RandomPath<3>> {
    let corners = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.5], [2.0, 0.1, 1.0], [2.0, 1.0, 1.0]];
    let paths = [
        at(0.01, polyline(&corners[..2])),
        passing(at(0.02, polyline(&corners))),
        at(0.02, vec![polynomial(&corners, &[])]),
        at(0.02, vec![polynomial(&corners[1..], &[1.0, 2.0, 1.0])]),
        at(0.15, ten_points().curves),
    ];
    paths.into_iter().zip(PROFILES.into_iter().cycle()).map(with_profile).collect()
}

const PROFILES: [ProfileKind; 6] = [
    ProfileKind::Cubic,
    ProfileKind::SCurve,
    ProfileKind::Trigonometric,
    ProfileKind::Flexible,
    ProfileKind::Fastest,
    ProfileKind::WithoutLookAhead,
];

fn with_profile<const D: usize>((path, profile): (RandomPath<D>, ProfileKind)) -> RandomPath<D> {
    RandomPath { profile, ..path }
}

/// The path with corners that are passed within a hundredth of a millimetre.
fn passing<const D: usize>(mut path: RandomPath<D>) -> RandomPath<D> {
    path.limits.junction = Junction::Deviation(0.01);
    path
}

fn polyline<const D: usize>(corners: &[[f64; D]]) -> Vec<NurbsBuf<f64, D>> {
    corners.windows(2).map(|ends| polynomial(ends, &[])).collect()
}

/// The Bézier curve of these points; all weights are 1 if none are given.
fn polynomial<const D: usize>(points: &[[f64; D]], weights: &[f64]) -> NurbsBuf<f64, D> {
    let degree = points.len() - 1;
    let weights = if weights.is_empty() { vec![1.0; points.len()] } else { weights.to_vec() };
    NurbsBuf::try_new(degree, points.to_vec(), weights, clamped(degree, &[])).expect("a curve")
}

/// The knot vector over [0, 1] with these inner knots.
fn clamped(degree: usize, inner: &[f64]) -> Vec<f64> {
    [&vec![0.0; degree + 1], inner, &vec![1.0; degree + 1]].concat()
}
