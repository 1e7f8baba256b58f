//! Time of a real-time step, mean over a whole path: `secant-interp/<way>/<curve>/<format>`.

use std::hint::black_box;

use criterion::{Criterion, Throughput, criterion_group, criterion_main};
use feed_plan::{Schedule, Stage, StageShape};
use feedbits_benches::{Path, paper_a, ten_points, thousand_points};
use real::{Backend, I2F30, I3F29, I4F28, I8F24, I16F16, I16F48, I32F32};
use secant_interp::{ChordTolerance, Interpolator, Method, PieceInterpolator, StepLengths, Tolerance};

/// Pieces, as they run at a fluctuation of 1e-6.
fn on_pieces<R: Backend, const D: usize>(criterion: &mut Criterion, path: &Path<D>) {
    let table = path.pieces::<R>();
    let pieces = table.as_pieces();
    let stages = path.stages::<R>(pieces.chord_exponent);
    let interpolator = PieceInterpolator {
        pieces,
        lengths: StepLengths { stages: &stages, crossings: &[] },
        tolerance: ChordTolerance::for_fluctuation(Some(1e-6), 5),
        landing_step: R::zero(),
    };
    let run = || {
        let mut state = interpolator.start();
        let mut steps = 0_u64;
        while !interpolator.is_at_end(&state)
            && let Some(setpoint) = interpolator.step(&mut state)
        {
            black_box(setpoint);
            steps += 1;
        }
        steps
    };
    let mut group = criterion.benchmark_group(format!("secant-interp/pieces/{}", path.name));
    group.throughput(Throughput::Elements(run())).sample_size(20);
    group.bench_function(R::name().to_string(), |bencher| bencher.iter(run));
    group.finish();
}

/// The textbook way: global parameter, de Boor each time, secant iteration to 1e-6.
fn on_global_parameter<R: Backend, const D: usize>(criterion: &mut Criterion, path: &Path<D>) {
    let Ok(curve) = path.curve.convert::<R>() else { return };
    let number = |x: f64| R::from_f64(x).unwrap_or_else(R::zero);
    let periods = 100_000;
    let stage = Stage {
        start: R::zero(),
        length: R::zero(),
        start_feed: number(path.feed_mm),
        end_feed: number(path.feed_mm),
        duration: R::from_f64(periods as f64).unwrap_or_else(R::max_value),
        shape: StageShape::Steady,
        curve_start: 0,
        u_start: R::zero(),
        curve_end: 0,
        u_end: R::one(),
    };
    let interpolator = Interpolator {
        curve: curve.as_curve(),
        schedule: Schedule::new(std::slice::from_ref(&stage), R::one(), periods),
        method: Method::Secant,
        tolerance: Tolerance { parameter: number(1e-6), fluctuation: number(1e-6), max_iterations: 5 },
        landing_step: number(path.feed_mm / 16.0),
    };
    let run = || {
        let mut state = interpolator.start();
        let mut steps = 0_u64;
        while !state.is_landed()
            && let Some(setpoint) = interpolator.step(&mut state)
        {
            black_box(setpoint);
            steps += 1;
        }
        steps
    };
    let mut group = criterion.benchmark_group(format!("secant-interp/de-boor/{}", path.name));
    group.throughput(Throughput::Elements(run())).sample_size(20);
    group.bench_function(R::name().to_string(), |bencher| bencher.iter(run));
    group.finish();
}

fn steps(criterion: &mut Criterion) {
    let (a, b, c) = (paper_a(), ten_points(), thousand_points());
    macro_rules! every_format {
        ($run:ident, $path:expr, $($format:ty),+) => { $( $run::<$format, _>(criterion, $path); )+ };
    }
    every_format!(on_pieces, &a, f64, f32, I2F30, I3F29, I4F28, I8F24, I16F16, I32F32, I16F48);
    every_format!(on_pieces, &b, f64, f32, I8F24, I16F16, I32F32, I16F48);
    every_format!(on_pieces, &c, f64, f32, I3F29, I4F28, I8F24, I16F16, I32F32, I16F48);
    every_format!(on_global_parameter, &a, f64, f32, I16F16, I32F32, I16F48);
    every_format!(on_global_parameter, &b, f64, f32, I16F16, I32F32, I16F48);
    every_format!(on_global_parameter, &c, f64, f32);
}

criterion_group!(benches, steps);
criterion_main!(benches);
