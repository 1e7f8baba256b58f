//! Every figure beside the printed one.

use nurbs_core::{Differentiate, arc_length, radius};

use super::*;
use crate::adaptive_feed::adaptive_feed;
use crate::papers_data::{PAPER_A, PAPER_D};

fn all() -> &'static PaperFigures {
    static ALL: std::sync::OnceLock<PaperFigures> = std::sync::OnceLock::new();
    ALL.get_or_init(|| paper_figures().expect("all can be computed"))
}

/// Printed, ours, and by which share ours may change: a half of itself for what the secant leaves, which rounding decides.
/// What is 0 here is rounding: below 1e-13.
#[rustfmt::skip]
fn expected() -> Vec<(char, &'static str, &'static str, Printed, f64, f64)> {
    use Printed::{AtMost, Number, Words};
    vec![
        ('A', "equation (7)", "coefficient of u_i", Number(95.0), 99.0, 0.02),
        ('A', "figure 6", "largest feed", AtMost(200.0), 199.9, 0.02),
        ('A', "figure 7", "largest acceleration", AtMost(5000.0), 4997.0, 0.02),
        ('A', "figure 8", "largest jerk", AtMost(400000.0), 399600.0, 0.02),
        ('A', "figure 9", "largest chord error", AtMost(0.5), 0.4996, 0.02),
        ('A', "figures 10 to 12", "peak acceleration around one bend: A is not reached", AtMost(5000.0), 1314.0, 0.02),
        ('A', "table 1", "secant, max", Number(3.83e-05), 3.841e-05, 0.5),
        ('A', "table 1", "secant, min", Number(-0.000211), -7.364e-05, 0.5),
        ('A', "table 1", "secant, mean |δ|", Number(8.79e-07), 2.214e-07, 0.5),
        ('A', "table 1", "Taylor 1, max", Number(1.12), 0.4291, 0.02),
        ('A', "table 1", "Taylor 1, min", Number(-1.35), -0.4473, 0.02),
        ('A', "table 1", "Taylor 1, mean |δ|", Number(0.11), 0.1873, 0.02),
        ('A', "table 1", "Taylor 2, max", Number(0.95), 0.005644, 0.02),
        ('A', "table 1", "Taylor 2, min", Number(-0.93), -0.00203, 0.02),
        ('A', "table 1", "Taylor 2, mean |δ|", Number(0.000208), 0.001169, 0.02),
        ('A', "text on table 1", "mean of Taylor 1 over the secant's", Number(1000000.0), 845700.0, 0.5),
        ('A', "text on table 1", "mean of Taylor 2 over the secant's", Number(1000.0), 5281.0, 0.5),
        ('A', "figure 13", "steps of the secant above 1e-6", Number(1.0), 0.0, 0.5),
        ('A', "figure 14", "largest |δ| of Taylor 1", Number(1.0), 0.4473, 0.02),
        ('A', "figure 15", "steps of Taylor 2 above 0.5 %", Words("few"), 0.0, 0.02),
        ('B', "(3)", "end points and tangents, off by", AtMost(1e-13), 0.0, 0.02),
        ('B', "(5)", "jump of P' at joints", AtMost(1e-13), 0.0, 0.02),
        ('B', "figure 5", "segments of ten points", Number(7.0), 7.0, 0.02),
        ('B', "(8)", "distance from (B - C) C³ + C", AtMost(1e-13), 0.0, 0.02),
        ('B', "(9)", "radial error of the quarter circle, λ = 1", AtMost(1e-13), 0.0, 0.02),
        ('B', "(9)", "radial error of the quarter circle, λ = 0", AtMost(1e-13), 0.0, 0.02),
        ('B', "(9)", "radial error of the quarter circle, λ = 2", AtMost(1e-13), 0.0, 0.02),
        ('B', "figure 9", "λ changes the inner corner's size: by", Words("size changes"), 0.0, 0.02),
        ('B', "figure 8", "λ changes the loop's size: the smallest has λ =", Words("size changes"), 1.0, 0.02),
        ('C', "(2), plus as printed", "fluctuation of a step", Words("second order"), 0.01077, 0.02),
        ('C', "(2), minus", "fluctuation of a step", Words("second order"), 3.458e-05, 0.02),
        ('C', "(10)", "peak acceleration", Number(251.32741228718345), 251.3, 0.02),
        ('C', "(9)", "peak jerk", Number(3158.2734083485943), 3158.0, 0.02),
        ('C', "(12)", "time over the length of (11)", Number(0.25), 0.25, 0.02),
        ('C', "2.1", "half-cosine in place of one S-curve: greatest share of A and J", AtMost(1.0), 1.257, 0.02),
        ('C', "figure 8a", "chord error without look-ahead", AtMost(1.0), 1.0, 0.02),
        ('C', "figure 8b", "chord error with look-ahead", AtMost(1.0), 0.9949, 0.02),
        ('C', "figure 10a", "acceleration without look-ahead, over A: \"over nine times\"", Number(10.0), 6.172, 0.02),
        ('C', "figure 9b", "largest feed with look-ahead", AtMost(100.0), 99.96, 0.02),
        ('C', "figure 10b", "acceleration with look-ahead", AtMost(1000.0), 999.2, 0.02),
        ('C', "figure 11", "jerk with look-ahead", AtMost(50000.0), 49940.0, 0.02),
        ('D', "(6)", "knots", Number(14.0), 16.0, 0.02),
        ('D', "(6)", "inner knot 1", Number(0.1836), 0.1075, 0.02),
        ('D', "(6)", "inner knot 2", Number(0.2781), 0.2371, 0.02),
        ('D', "(6)", "inner knot 3", Number(0.3837), 0.2952, 0.02),
        ('D', "(6)", "inner knot 4", Number(0.5474), 0.3859, 0.02),
        ('D', "(6)", "inner knot 5", Number(0.7104), 0.5775, 0.02),
        ('D', "(6)", "inner knot 6", Number(0.8049), 0.7594, 0.02),
        ('D', "3.1", "following error", Number(5.33), 5.333, 0.02),
        ('D', "table 2", "a: 100 %, feed-forward 95 %: mean radial error", Number(-5.0), -5.337, 0.02),
        ('D', "table 2", "a: roundness", Words("about 5 µm inside, deformed, peaks at quadrants"), 4.792, 0.02),
        ('D', "table 2", "b: 100 %, feed-forward 98 %: mean radial error", Words("close to 0"), -0.4076, 0.02),
        ('D', "table 2", "b: roundness", Words("close to 0"), 4.752, 0.02),
        ('D', "table 2", "c: 200 %, feed-forward 98 %: mean radial error", Words("less deformed, smaller peaks"), -1.832, 0.02),
        ('D', "table 2", "c: roundness", Words("less deformed, smaller peaks"), 2.557, 0.02),
        ('D', "table 2", "d: 300 %, feed-forward 99 %: mean radial error", Words("smaller peaks, rounder"), -0.7968, 0.02),
        ('D', "table 2", "d: roundness", Words("smaller peaks, rounder"), 1.531, 0.02),
        ('D', "section 3, end", "G1 within 0.01 mm of the curve: contour error", Number(0.01), 0.009051, 0.02),
        ('D', "section 3, end", "these moves by convert --fit 0.01: contour error", Words(""), 0.01192, 0.02),
        ('D', "section 3, end", "these by --fit 0.01 --every-point: contour error", Words(""), 0.002576, 0.02),
        ('D', "section 3, end", "G1 within 0.001 mm of the curve: contour error", Words(""), 0.004262, 0.02),
        ('D', "section 3, end", "G06.2, the NURBS: contour error", Number(0.001), 0.002594, 0.02),
    ]
}

#[test]
fn every_figure_stands_beside_the_printed_one() {
    let (rows, expected) = (&all().rows, expected());
    for (row, (paper, place, quantity, printed, ours, share)) in rows.iter().zip(&expected) {
        assert_eq!((&row.paper, &row.place, row.quantity.as_str()), (paper, place, *quantity));
        match (row.printed, *printed) {
            (Printed::Number(a), Printed::Number(b)) => assert!((a - b).abs() <= 1e-9 * b.abs(), "{row:?}"),
            (a, b) => assert_eq!(a, b, "{row:?}"),
        }
        let off = (row.measured - ours).abs();
        assert!(off <= share * ours.abs() + 1e-13, "{row:?}: {ours}");
    }
    assert_eq!(rows.len(), expected.len());
}

/// What differs from the print has a reason; what has a setting says it once.
#[test]
fn what_differs_says_why() {
    for row in &all().rows {
        assert!(row.agrees() || !row.reason.is_empty(), "{row:?}");
        assert!(!row.setting.is_empty(), "{row:?}");
    }
}

#[test]
fn every_plot_of_the_papers_has_a_picture() {
    let names: Vec<&str> = all().pictures.iter().map(|picture| picture.name.as_str()).collect();
    let of_paper = |paper: &str, figures: std::ops::RangeInclusive<u32>| {
        for figure in figures {
            let begin = format!("{paper}-{figure:02}-");
            assert_eq!(names.iter().filter(|name| name.starts_with(&begin)).count(), 1, "{begin}: {names:?}");
        }
    };
    of_paper("a", 5..=15);
    of_paper("c", 8..=11);
    assert!(names.contains(&"d-table-2"));
    for picture in &all().pictures {
        let file = picture.file();
        assert!(file.contains("class=\"line\"") && file.contains(&picture.title), "{}", picture.name);
    }
}

/// Without look-ahead the feed is V(s) of the place: dV/dt = d(V²/2)/ds, here by differences over arcs of 1 µm. A period's change is a
/// mean over 0.1 mm, and so is less than the peak, by no more than a quarter where the limit dips for 8 ms.
#[test]
fn acceleration_without_look_ahead_is_that_of_the_limit_curve() {
    let part = judged::part("paper D", PAPER_D).unwrap();
    let machine = judged::machine("paper A", PAPER_A).unwrap();
    let problem = judged::problem(&part, &machine).unwrap();
    let curve = &problem.curves[0];
    let (feedrate, error, period) = (100.0, 0.001, 0.001);
    let steps = adaptive_feed(curve, feedrate, error, period);
    let changes = steps.windows(2).map(|pair| (pair[1].feed_mm_per_s - pair[0].feed_mm_per_s) / period);
    let found = changes.fold(0.0, |most: f64, change| most.max(change.abs()));
    let curve = curve.as_curve();
    let feed = |u: f64| {
        let rho = radius(&curve.derivatives(u));
        // V = (2/T) √(2ρE - E²).
        feedrate.min(2.0 / period * (2.0 * rho * error - error * error).sqrt())
    };
    let mut most = 0.0_f64;
    for k in 0..100_000_u32 {
        let u = [f64::from(k) / 100_000.0, f64::from(k + 1) / 100_000.0];
        let length = arc_length(&curve, u[0], u[1], 1e-12).length;
        most = most.max((feed(u[1]).powi(2) - feed(u[0]).powi(2)).abs() / (2.0 * length));
    }
    assert!((0.75..1.0).contains(&(found / most)), "{found} of {most}");
    let travelled: f64 = steps.iter().map(|step| step.feed_mm_per_s * period).sum();
    assert!((travelled - 134.006).abs() < 0.2, "{travelled}");
}

/// The printed 0.01 and 0.001 mm: fine moves are off by what the CAM system leaves, the NURBS by what the servo leaves, and so are
/// curves through every point of the moves.
#[test]
fn fine_moves_are_farther_off_than_the_nurbs() {
    let table = contour_table().unwrap();
    let [cam, few, every, fine, nurbs] = table.as_slice() else { panic!("{table:?}") };
    assert!(
        (0.005..=0.0105).contains(&cam.setpoint_error_mm) && fine.setpoint_error_mm <= 0.00105,
        "{table:?}"
    );
    assert!(
        nurbs.setpoint_error_mm < 1e-8 && cam.contour_error_mm > 3.0 * nurbs.contour_error_mm,
        "{table:?}"
    );
    assert!(cam.contour_error_rms_mm > 3.0 * nurbs.contour_error_rms_mm, "{table:?}");
    assert!((every.contour_error_mm / nurbs.contour_error_mm - 1.0).abs() < 0.1, "{table:?}");
    assert!(
        every.setpoint_error_mm < 0.3 * cam.setpoint_error_mm && few.setpoint_error_mm <= 0.02,
        "{table:?}"
    );
    assert_eq!([cam.printed_mm, nurbs.printed_mm], [Some(0.01), Some(0.001)]);
}
