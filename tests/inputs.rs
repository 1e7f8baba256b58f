//! Inputs that several tests share: the papers' curves and curves that are hard in some way.

use format_compare::Problem;
use nurbs_core::NurbsBuf;
use part_program::{Machine, read_machine, read_part};

/// Paper A's curve and machine file.
pub const PAPER_A: &str = include_str!("../data/seed-000.toml");

/// Paper D's G06.2 program.
pub const PAPER_D: &str = include_str!("../data/seed-003.nc");

/// Paper A's machine.
///
/// # Panics
/// If the committed file is broken.
#[must_use]
pub fn machine() -> Machine {
    read_machine("seed-000.toml", PAPER_A).unwrap_or_else(|error| panic!("{error}"))
}

/// The problem of a part program on paper A's machine.
///
/// # Panics
/// If the text is not a part.
#[must_use]
pub fn problem<const D: usize>(name: &str, text: &str) -> Problem<D> {
    let part = read_part(name, text).unwrap_or_else(|error| panic!("{error}"));
    Problem::new(&part, &machine()).unwrap_or_else(|error| panic!("{error}"))
}

/// A problem of one curve on paper A's machine.
#[must_use]
pub fn on_paper_as_machine<const D: usize>(name: &str, curve: NurbsBuf<f64, D>) -> Problem<D> {
    Problem {
        name: name.to_string(),
        curves: vec![curve],
        feeds_mm_per_s: Vec::new(),
        stops: Vec::new(),
        breaks: Vec::new(),
        lines: Vec::new(),
        rapids_left_out: 0,
        gaps: 0,
        filament_mm: None,
        side_axes: format_compare::SideAxes::default(),
        machine: machine(),
    }
}

fn curve<const D: usize>(
    degree: usize,
    points: &[[f64; D]],
    weights: Vec<f64>,
    inner: &[f64],
) -> NurbsBuf<f64, D> {
    let mut knots = vec![0.0; degree + 1];
    knots.extend(inner);
    knots.extend(vec![1.0; degree + 1]);
    NurbsBuf::try_new(degree, points.to_vec(), weights, knots).unwrap_or_else(|error| panic!("{error}"))
}

/// A full circle of 10 mm radius: rational, degree 2, nine points.
#[must_use]
pub fn circle() -> NurbsBuf<f64, 2> {
    let h = 0.5_f64.sqrt();
    let corners = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]];
    let points = corners.map(|p| p.map(|x| f64::from(x) * 10.0));
    let weights = (0..9).map(|i| if i % 2 == 0 { 1.0 } else { h }).collect();
    curve(2, &points, weights, &[0.25, 0.25, 0.5, 0.5, 0.75, 0.75])
}

/// A space curve of degree 5.
#[must_use]
pub fn degree_5() -> NurbsBuf<f64, 3> {
    let points = [
        [0.0, 0.0, 0.0],
        [10.0, 15.0, 2.0],
        [25.0, 18.0, 6.0],
        [35.0, 5.0, 9.0],
        [50.0, -5.0, 8.0],
        [60.0, 8.0, 3.0],
        [70.0, 20.0, 0.0],
        [85.0, 10.0, -2.0],
    ];
    curve(5, &points, vec![1.0; 8], &[0.35, 0.7])
}

/// A cubic with a double interior knot: its curvature jumps there.
#[must_use]
pub fn double_knot() -> NurbsBuf<f64, 2> {
    let points = [[0.0, 0.0], [10.0, 20.0], [30.0, 25.0], [45.0, 10.0], [60.0, 5.0], [80.0, 20.0]];
    curve(3, &points, vec![1.0; 6], &[0.5, 0.5])
}

/// A closed cubic: it ends where it starts, and no step may take the one for the other.
#[must_use]
pub fn closed() -> NurbsBuf<f64, 2> {
    let points =
        [[0.0, 0.0], [30.0, -10.0], [50.0, 20.0], [20.0, 45.0], [-15.0, 25.0], [-12.0, 4.0], [0.0, 0.0]];
    curve(3, &points, vec![1.0; 7], &[0.25, 0.5, 0.75])
}

/// A cubic with a cusp at u = ½: its derivative vanishes there.
#[must_use]
pub fn cusp() -> NurbsBuf<f64, 2> {
    curve(3, &[[0.0, 0.0], [40.0, 40.0], [0.0, 40.0], [40.0, 0.0]], vec![1.0; 4], &[])
}

/// A cubic with a triple knot where two straight flanks meet at a right angle.
#[must_use]
pub fn corner() -> NurbsBuf<f64, 2> {
    let points =
        [[0.0, 0.0], [10.0, 0.0], [20.0, 0.0], [30.0, 0.0], [30.0, 10.0], [30.0, 20.0], [30.0, 30.0]];
    curve(3, &points, vec![1.0; 7], &[0.5, 0.5, 0.5])
}

/// A straight line of degree 1.
#[must_use]
pub fn line() -> NurbsBuf<f64, 2> {
    curve(1, &[[1.0, 2.0], [61.0, 82.0]], vec![1.0; 2], &[])
}
