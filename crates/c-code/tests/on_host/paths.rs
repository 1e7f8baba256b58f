//! Paths of every kind whose C differs.

use feed_plan::ProfileKind;
use stress::{RandomPath, bezier, curves_at, passing, polyline};

pub(crate) use stress::{lines, paper_a, ten_points};

/// Paths in the plane: straight moves, arcs and splines of each degree, alone and with corners, each at one of the profiles.
pub(crate) fn in_the_plane() -> Vec<RandomPath<2>> {
    let half = 0.5_f64.sqrt();
    let quarter = |ends: [[f64; 2]; 3]| bezier(&ends, &[1.0, half, 1.0]);
    let (right, top, left) = ([1.0, 0.0], [0.0, 1.0], [-1.0, 0.0]);
    let arcs = vec![quarter([right, [1.0, 1.0], top]), quarter([top, [-1.0, 1.0], left])];
    let wave: Vec<_> = (0..9).map(|i| [0.3 * f64::from(i), 0.2 * f64::from(i * i % 5)]).collect();
    let there_and_back = vec![bezier(&wave[..4], &[]), bezier(&[wave[3], right, top, left], &[])];
    let zigzag = polyline(&[[0.0, 0.0], [1.0, 0.0], [2.0, 0.1], [3.0, 0.0], [3.0, 1.0]]);
    let paths = [
        curves_at(0.01, polyline(&[[0.0, 0.0], [1.0, 0.5]])),
        curves_at(0.01, vec![bezier(&[[0.0, 0.0], [1.0, 0.5]], &[1.0, 2.0])]),
        curves_at(0.02, zigzag.clone()),
        passing(curves_at(0.02, zigzag)),
        curves_at(0.02, arcs[..1].to_vec()),
        curves_at(0.02, arcs),
        curves_at(0.02, there_and_back.clone()),
        passing(curves_at(0.02, there_and_back)),
        curves_at(0.5, lines().curves),
        curves_at(0.6, paper_a().curves),
    ];
    let of_degrees = (2..9).flat_map(|degree| {
        let weights: Vec<_> = (0..=degree).map(|i| [1.0, 1.5][i % 2]).collect();
        [&[][..], &weights].map(|weights| curves_at(0.02, vec![bezier(&wave[..=degree], weights)]))
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
        curves_at(0.01, polyline(&corners[..2])),
        passing(curves_at(0.02, polyline(&corners))),
        curves_at(0.02, vec![bezier(&corners, &[])]),
        curves_at(0.02, vec![bezier(&corners[1..], &[1.0, 2.0, 1.0])]),
        curves_at(0.15, ten_points().curves),
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
