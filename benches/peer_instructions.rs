//! Host instructions of an evaluation, ours and the peers': `<group>::<function> <curve>`, to be divided by [`CALLS`].

#![allow(missing_docs, reason = "the benchmark macros make public items without documentation")]

#[allow(dead_code, reason = "one of several benches that share it")]
mod contestants;

use std::hint::black_box;

use contestants::{Asked, BASIS, BSPLINE, CURVO, Contestant, LOOKED_UP, REMEMBERED, TRUCK, contestants};
use feedbits_benches::{Path, paper_a, ten_points, thousand_points};
use iai_callgrind as gungraun; // The macros write this name.
use iai_callgrind::{library_benchmark, library_benchmark_group, main};
use nurbs_core::Evaluate;

/// Parameters of a pass.
const CALLS: u32 = 10_000;

type Work = (Contestant, Vec<f64>);

fn work(path: &Path<3>, asked: Asked, name: &str) -> Work {
    let (first, last) = path.curve.as_curve().domain();
    let at = |i: u32| first + (last - first) * (f64::from(i) + 0.5) / f64::from(CALLS);
    let found = contestants(path, asked).into_iter().find(|contestant| contestant.name == name);
    (found.expect("a contestant of this name"), (0..CALLS).map(at).collect())
}

macro_rules! evaluations {
    ($($function:ident: $asked:ident of $name:ident),+) => {$(
        #[library_benchmark]
        #[bench::a(work(&paper_a().in_space(), Asked::$asked, $name))]
        #[bench::b(work(&ten_points().in_space(), Asked::$asked, $name))]
        #[bench::c(work(&thousand_points(), Asked::$asked, $name))]
        fn $function((contestant, parameters): Work) -> f64 {
            black_box((contestant.run)(black_box(&parameters)))
        }
    )+};
}

evaluations!(
    point_remembered: Point of REMEMBERED,
    point_looked_up: Point of LOOKED_UP,
    point_basis: Point of BASIS,
    point_curvo: Point of CURVO,
    point_bspline: Point of BSPLINE,
    point_truck: Point of TRUCK,
    derivatives_remembered: Derivatives of REMEMBERED,
    derivatives_looked_up: Derivatives of LOOKED_UP,
    derivatives_basis: Derivatives of BASIS,
    derivatives_curvo: Derivatives of CURVO
);

library_benchmark_group!(
    name = peers;
    benchmarks = point_remembered, point_looked_up, point_basis, point_curvo, point_bspline, point_truck,
        derivatives_remembered, derivatives_looked_up, derivatives_basis, derivatives_curvo
);
main!(library_benchmark_groups = peers);
