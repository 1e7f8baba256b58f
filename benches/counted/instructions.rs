//! Host instructions of the kernels, exactly: `<group>::<kernel>_<format> <curve>`. `scripts/instructions` compares them
//! with the committed ones.

#![allow(missing_docs, reason = "the benchmark macros make public items without documentation")]

use std::hint::black_box;

use feed_plan::{EndFeeds, FeedLimit, KinematicLimits};
use feedbits_benches::{Path, paper_a, ten_points, thousand_points, winding};
use iai_callgrind as gungraun; // The macros write this name.
use iai_callgrind::{library_benchmark, library_benchmark_group, main};
use nurbs_core::{Evaluate, FastCurve, NurbsBuf, PiecesBuf};
use real::{Backend, I8F24, I16F16, I16F48, I32F32, Real};
use secant_interp::{ChordTolerance, LengthCursor, LengthStage, PieceInterpolator, PieceState, StepLengths};

/// Points of an evaluation, steps of a run.
const CALLS: u32 = 256;

fn curve<R: Backend>(path: &Path<2>) -> NurbsBuf<R, 2> {
    path.curve.convert::<R>().unwrap_or_else(|error| panic!("{}: {error}", path.name))
}

fn points<R: Backend>(curve: &NurbsBuf<R, 2>) -> R {
    let curve = curve.as_curve();
    let at = |i: i32| curve.point(R::from_ratio(2 * i + 1, 512));
    (0..CALLS.cast_signed()).map(|i| at(black_box(i))[0]).fold(R::zero(), Real::max)
}

/// A path and its schedule, and the state at the start, which is formed before real time begins.
type Compiled<R, const D: usize> = (PiecesBuf<R, D>, Vec<LengthStage<R>>, PieceState<R, D>);

fn compiled<R: Backend, const D: usize>(path: &Path<D>) -> Compiled<R, D> {
    let table = path.pieces::<R>();
    let stages = path.stages::<R>(table.as_pieces().chord_exponent);
    let start = interpolator(&table, &stages).start();
    (table, stages, start)
}

fn interpolator<'a, R: Backend, const D: usize>(
    table: &'a PiecesBuf<R, D>,
    stages: &'a [LengthStage<R>],
) -> PieceInterpolator<'a, R, D> {
    PieceInterpolator {
        pieces: table.as_pieces(),
        lengths: StepLengths { stages, crossings: &[] },
        tolerance: ChordTolerance::for_fluctuation(Some(1e-6), 5),
        landing_step: R::zero(),
    }
}

fn steps<R: Backend, const D: usize>((table, stages, start): &Compiled<R, D>) -> u64 {
    let interpolator = interpolator(table, stages);
    let mut state = black_box(*start);
    (0..CALLS)
        .filter_map(|_| interpolator.step(&mut state))
        .map(|setpoint| black_box(setpoint).phase) // All fields are asked for: a setpoint is of use only with its point.
        .fold(0, u64::wrapping_add)
}

/// A path and the chords of the first periods, and the state at the start.
type Given<const D: usize> = (PiecesBuf<f64, D>, Vec<f64>, PieceState<f64, D>);

fn given<const D: usize>(path: &Path<D>) -> Given<D> {
    let (table, stages, _) = compiled::<f64, D>(path);
    let mut cursor = LengthCursor::default();
    let lengths = StepLengths { stages: &stages, crossings: &[] };
    let chords = (0..CALLS).filter_map(|_| lengths.advance(&mut cursor)).collect();
    let start = interpolator(&table, &[]).start();
    (table, chords, start)
}

fn steps_by<const D: usize>((table, chords, start): &Given<D>) -> u64 {
    let interpolator = interpolator(table, &[]);
    let mut state = black_box(*start);
    let step = |chord: &f64| interpolator.step_by(&mut state, *chord);
    chords.iter().filter_map(step).map(|setpoint| black_box(setpoint).phase).fold(0, u64::wrapping_add)
}

fn planned(path: &Path<2>) -> (NurbsBuf<f64, 2>, KinematicLimits<f64>) {
    let limits = KinematicLimits { acceleration: 0.009, jerk: 0.001_35, ..path.limits() };
    (path.curve.clone(), limits)
}

fn plan((curve, limits): &(NurbsBuf<f64, 2>, KinematicLimits<f64>)) -> usize {
    let planned = FeedLimit::along(&[FastCurve::of(curve.as_curve())], limits)
        .and_then(|limit| feed_plan::plan(&limit, limits, EndFeeds { start: 0.0, end: 0.0 }));
    planned.map_or(0, |schedule| schedule.as_schedule().stages().len())
}

macro_rules! point {
    ($($name:ident: $format:ty),+) => {$(
        #[library_benchmark]
        #[bench::a(curve::<$format>(&paper_a()))]
        #[bench::b(curve::<$format>(&ten_points()))]
        fn $name(curve: NurbsBuf<$format, 2>) -> $format {
            black_box(points(black_box(&curve)))
        }
    )+};
}

// Paths are given back, lest their memory is freed while instructions are counted.
macro_rules! step {
    ($($name:ident: $format:ty),+) => {$(
        #[library_benchmark]
        #[bench::a(compiled::<$format, 2>(&paper_a()))]
        #[bench::b(compiled::<$format, 2>(&ten_points()))]
        fn $name(path: Compiled<$format, 2>) -> (u64, Compiled<$format, 2>) {
            (black_box(steps(black_box(&path))), path)
        }
    )+};
}

point!(point_f64: f64, point_f32: f32, point_i16f16: I16F16, point_i32f32: I32F32, point_i16f48: I16F48);
step!(
    step_f64: f64, step_f32: f32, step_i8f24: I8F24, step_i16f16: I16F16, step_i32f32: I32F32, step_i16f48: I16F48
);

#[library_benchmark]
#[bench::c(compiled::<f64, 3>(&thousand_points()))]
fn step_f64_in_space(path: Compiled<f64, 3>) -> (u64, Compiled<f64, 3>) {
    (black_box(steps(black_box(&path))), path)
}

#[library_benchmark]
#[bench::a(given(&paper_a()))]
#[bench::b(given(&ten_points()))]
fn step_by_f64(path: Given<2>) -> (u64, Given<2>) {
    (black_box(steps_by(black_box(&path))), path)
}

#[library_benchmark]
#[bench::c(given(&thousand_points()))]
fn step_by_f64_in_space(path: Given<3>) -> (u64, Given<3>) {
    (black_box(steps_by(black_box(&path))), path)
}

#[library_benchmark]
#[bench::a(planned(&paper_a()))]
#[bench::spans_10(planned(&winding(10)))]
#[bench::spans_100(planned(&winding(100)))]
#[bench::spans_1000(planned(&winding(1000)))]
fn plan_f64(input: (NurbsBuf<f64, 2>, KinematicLimits<f64>)) -> usize {
    black_box(plan(black_box(&input)))
}

library_benchmark_group!(
    name = evaluation;
    benchmarks = point_f64, point_f32, point_i16f16, point_i32f32, point_i16f48
);
library_benchmark_group!(
    name = interpolation;
    benchmarks = step_f64, step_f32, step_i8f24, step_i16f16, step_i32f32, step_i16f48, step_f64_in_space, step_by_f64,
        step_by_f64_in_space
);
library_benchmark_group!(name = planning; benchmarks = plan_f64);
main!(library_benchmark_groups = evaluation, interpolation, planning);
