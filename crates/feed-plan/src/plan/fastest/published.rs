//! The fastest plan against optima found by a nonlinear program over a grid of the arc length.

use crate::plan::look_ahead;
use crate::test_paths::{circle, in_periods, limit_along, seed_000, seed_003};
use crate::{EndFeeds, FeedLimit, KinematicLimits, ProfileKind, Stage};
use nurbs_core::NurbsBuf;

/// By `scripts/reference-optima`.
const TABLE: &str = include_str!("../../../../../data/reference-optima.csv");

/// Curve, period in s, A in mm/s², J in mm/s³, optimum in s. F is 200 mm/s, E 0.5 µm.
pub(crate) fn cases() -> Vec<(&'static str, f64, f64, f64, f64)> {
    let rows = TABLE.lines().filter(|line| !line.starts_with('#')).skip(1);
    let case = |row: &'static str| {
        let mut cells = row.split(',');
        let name = cells.next().unwrap();
        let mut number = || cells.next().unwrap().parse().unwrap();
        (name, number(), number(), number(), number())
    };
    rows.map(case).collect()
}

pub(crate) fn case(
    (name, t, a, j, _): (&str, f64, f64, f64, f64),
) -> (FeedLimit<f64>, KinematicLimits<f64>, NurbsBuf<f64, 2>) {
    let curve = match name {
        "seed-000" => seed_000(),
        "seed-003" => seed_003(),
        _ => circle(10.0),
    };
    let limits = in_periods(t, 200.0, a, j, 5e-4);
    (limit_along(core::slice::from_ref(&curve), &limits), limits, curve)
}

fn stages(limit: &FeedLimit<f64>, limits: &KinematicLimits<f64>, kind: ProfileKind) -> Vec<Stage<f64>> {
    look_ahead::stages(limit, limits, EndFeeds::default(), None, kind).unwrap()
}

fn duration(stages: &[Stage<f64>]) -> f64 {
    stages.iter().map(|stage| stage.duration).sum()
}

/// Time above the optimum in percent: before whole periods are made.
#[test]
fn published_curves_come_within_half_a_percent_of_the_optimum() {
    let mut sum = 0.0;
    let cases = cases();
    assert_eq!(cases.len(), 12);
    for row in cases {
        let (limit, limits, _) = case(row);
        let (name, t, a, j, optimum) = row;
        let over = |duration: f64| 100.0 * (duration * t / optimum - 1.0);
        let curves = stages(&limit, &limits, ProfileKind::SCurve);
        let fastest = stages(&limit, &limits, ProfileKind::Fastest);
        let (slow, fast) = (over(duration(&curves)), over(duration(&fastest)));
        println!(
            "{name}, T {t} s, A {a}, J {j}: {fast:.3} % in {} stages, s-curve {slow:.3} % in {}",
            fastest.len(),
            curves.len()
        );
        assert!(fast < 0.5 && fast > -0.05, "{row:?}: {fast} %");
        sum += fast;
    }
    assert!(sum / 12.0 < 0.1, "{} % on average", sum / 12.0);
}
