//! What runs on compiled pieces reach, in every kind of format.

mod path_run;

use path_run::{Figures, Path, Random, Settings, run};
use nurbs_core::NurbsBuf;
use real::{Backend, FixedPoint, I4F28, I4F60, I8F24, I16F48};

type I3F29 = FixedPoint<fixed::types::I3F29>;

fn clamped(degree: usize, inner: impl IntoIterator<Item = f64>) -> Vec<f64> {
    let ends = |u: f64| std::iter::repeat_n(u, degree + 1);
    ends(0.0).chain(inner).chain(ends(1.0)).collect()
}

/// Seven points, 300 mm wide, at 200 mm/s and 3 ms.
fn paper_a() -> Path<2> {
    let points = [[150, 150], [0, 0], [0, 300], [150, 150], [300, 0], [300, 300], [150, 150]];
    let points = points.map(|p| p.map(f64::from)).to_vec();
    let curve = NurbsBuf::try_new_nonrational(3, points, clamped(3, [0.25, 0.5, 0.75])).unwrap();
    Path { curves: vec![curve], feed_mm: 0.6 }
}

/// The 10-point rational curve at 50 mm/s and 3 ms.
fn ten_points() -> Path<2> {
    let x = [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 65.0, 70.0, 80.0];
    let y = [15.0, 34.1, 10.1, 16.1, 0.9, 38.0, 2.9, 8.9, 26.1, 5.9];
    let weights = vec![1.0, 2.0, 1.5, 1.0, 1.0, 2.0, 1.0, 1.0, 2.0, 1.0];
    let knots = clamped(3, [0.1836, 0.2781, 0.3837, 0.5474, 0.7104, 0.8049]);
    let points = x.into_iter().zip(y).map(|(x, y)| [x, y]).collect();
    Path { curves: vec![NurbsBuf::try_new(3, points, weights, knots).unwrap()], feed_mm: 0.15 }
}

/// A full circle of 20 mm radius: nine points of degree 2.
fn circle() -> Path<2> {
    let corners = [[1, 0], [1, 1], [0, 1], [-1, 1], [-1, 0], [-1, -1], [0, -1], [1, -1], [1, 0]];
    let points = corners.map(|p| p.map(|x| 20.0 * f64::from(x))).to_vec();
    let weights = (0..9).map(|i| if i % 2 == 0 { 1.0 } else { 0.5_f64.sqrt() }).collect();
    let knots = clamped(2, [0.25, 0.25, 0.5, 0.5, 0.75, 0.75]);
    Path { curves: vec![NurbsBuf::try_new(2, points, weights, knots).unwrap()], feed_mm: 0.3 }
}

/// Degree 5 in space.
fn quintic() -> Path<3> {
    let mut random = Random(5);
    let points = (0..14).map(|i| {
        let angle = 0.7 * f64::from(i);
        [60.0 * angle.cos(), 60.0 * angle.sin() + random.within(-8.0, 8.0), 6.0 * f64::from(i)]
    });
    let knots = clamped(5, (1..9).map(|i| f64::from(i) / 9.0));
    Path { curves: vec![NurbsBuf::try_new_nonrational(5, points.collect(), knots).unwrap()], feed_mm: 0.4 }
}

/// A rational cubic of twelve points: a wandering line, weights from a half to two.
fn rational(seed: u64) -> Path<2> {
    let mut random = Random(seed);
    let points = (0..12).map(|i| [12.0 * f64::from(i) + random.within(-4.0, 4.0), random.within(-20.0, 20.0)]).collect();
    let weights = (0..12).map(|_| random.within(-1.0, 1.0).exp2()).collect();
    let knots = clamped(3, (1..9).map(|i| (f64::from(i) + random.within(-0.3, 0.3)) / 9.0).collect::<Vec<_>>());
    Path { curves: vec![NurbsBuf::try_new(3, points, weights, knots).unwrap()], feed_mm: 0.15 }
}

/// A thousand points, 3.5 mm apart, of a wandering space curve, mildly non-uniform, at 200 mm/s and 1 ms.
fn thousand_points() -> Path<3> {
    let mut random = Random(1000);
    let (mut at, mut heading, mut climb) = ([0.0; 3], 0.0_f64, 0.0_f64);
    let (mut turn, mut tilt) = (0.0, 0.0);
    let mut points = Vec::new();
    let mut knots = vec![0.0];
    for _ in 0..1000 {
        points.push(at);
        turn = 0.8 * turn + random.within(-0.15, 0.15);
        tilt = 0.8 * tilt + random.within(-0.05, 0.05) - 0.05 * climb;
        (heading, climb) = (heading + turn, climb + tilt);
        let step = 3.5 * random.within(0.9, 1.1);
        at[0] += step * heading.cos() * climb.cos();
        at[1] += step * heading.sin() * climb.cos();
        at[2] += step * climb.sin();
        knots.push(knots[knots.len() - 1] + random.within(0.9, 1.1));
    }
    let last = knots[997];
    let knots = clamped(3, knots[1..997].iter().map(|u| u / last).collect::<Vec<_>>());
    Path { curves: vec![NurbsBuf::try_new_nonrational(3, points, knots).unwrap()], feed_mm: 0.2 }
}

fn row<const D: usize>(name: &str, path: &Path<D>) {
    for piece_mm in [32.0, 64.0] {
    let show = |r: Result<Figures, nurbs_core::CompileError>| match r {
        Ok(f) => format!("{:8.1e} {:6.3} {:4}/{}", f.cruise, f.evaluations, f.crossings, f.steps),
        Err(e) => format!("{e}"),
    };
    println!("--- {name} {piece_mm}");
    for residual in [4e-3, 2e-3, 1e-3, 5e-4, 2e-4, 1e-4, 3e-5, 1e-5, 3e-6, 1e-6, 0.0] {
        let s = Settings { piece_mm, residual, ..Settings::default() };
        println!("{residual:8.0e} f64 {}", show(run::<f64, D>(path, &s)));
    }
    let s = Settings { piece_mm, residual: 0.0, ..Settings::default() };
    println!("f32 {}", show(run::<f32, D>(path, &s)));
    println!("I3F29 {}", show(run::<I3F29, D>(path, &s)));
    println!("I4F28 {}", show(run::<I4F28, D>(path, &s)));
    println!("I8F24 {}", show(run::<I8F24, D>(path, &s)));
    println!("I16F48 {}", show(run::<I16F48, D>(path, &s)));
    println!("I4F60 {}", show(run::<I4F60, D>(path, &s)));
    }
}

#[test]
fn figures() {
    row("A", &paper_a());
    row("B", &ten_points());
    row("circle", &circle());
    row("quintic", &quintic());
    for seed in 1..=5 {
        row("rational", &rational(seed));
    }
    row("1000", &thousand_points());
}
