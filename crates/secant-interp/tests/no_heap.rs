//! A real-time step takes nothing from the heap: measured by every way of stepping, in floats and in fixed
//! point of either width: what else a format is are constants. A program
//! without a test harness, because the count is of the whole process, and a harness has a thread of its own. That none
//! of it can be reached is shown at link time too, by `scripts/no-panic`.

use feed_plan::{Schedule, Stage};
use nurbs_core::{NurbsBuf, PieceLimits, PiecesBuf, compile};
use peak_alloc::PeakAlloc;
use real::{Backend, DoubleDouble, I4F28, I16F16, I16F48, I32F32, Real};
use secant_interp::{
    ChordTolerance, FeedOverride, Interpolator, LengthStage, Method, OverrideLimits, OverrideState,
    PieceInterpolator, Rate, StageShape, StepLengths, Tolerance,
};

#[global_allocator]
static MEMORY: PeakAlloc = PeakAlloc;

/// The value, and the bytes that were taken on the way to it, even if given back.
fn taken<T>(value: impl FnOnce() -> T) -> (T, usize) {
    let before = MEMORY.current_usage();
    MEMORY.reset_peak_usage();
    let value = value();
    (value, MEMORY.peak_usage().saturating_sub(before))
}

/// Steps to the end; the number of steps.
fn runs_without_heap<T>(what: &str, mut step: impl FnMut() -> Option<T>) -> usize {
    let mut steps = 0;
    loop {
        let (setpoint, bytes) = taken(&mut step);
        assert_eq!(bytes, 0, "{what}, step {steps}");
        if setpoint.is_none() {
            return steps;
        }
        steps += 1;
    }
}

fn paper_a() -> NurbsBuf<f64, 2> {
    let points = [[150, 150], [0, 0], [0, 300], [150, 150], [300, 0], [300, 300], [150, 150]];
    let knots = vec![0.0, 0.0, 0.0, 0.0, 0.25, 0.5, 0.75, 1.0, 1.0, 1.0, 1.0];
    NurbsBuf::try_new_nonrational(3, points.map(|p| p.map(f64::from)).to_vec(), knots).unwrap()
}

fn on_pieces<R: Backend>() {
    let limits = PieceLimits { length_mm: 32.0, step_mm: 0.63 };
    let table: PiecesBuf<R, 2> = compile::<DoubleDouble, R, 2>(&[paper_a().as_curve()], &limits).unwrap();
    let unit = 1.0.ldexp(table.as_pieces().chord_exponent);
    let number = |x: f64| R::from_f64(x * unit).unwrap();
    let swing = [(0.0, 0.6), (0.6, 0.3), (0.3, 0.3), (0.3, 0.6)];
    let swing = swing.into_iter().chain([(0.6, 0.3), (0.3, 0.6)].into_iter().cycle().take(100));
    let stages: Vec<LengthStage<R>> = swing
        .filter_map(|(from, to)| LengthStage::new(20 << 32, number(from), number(to) - number(from)))
        .collect();
    let interpolator = PieceInterpolator {
        pieces: table.as_pieces(),
        lengths: StepLengths { stages: &stages, crossings: &[] },
        tolerance: ChordTolerance::for_fluctuation(None, 6),
        landing_step: number(0.03),
    };
    let mut state = interpolator.start();
    let steps = runs_without_heap("pieces", || interpolator.step(&mut state));
    assert!(steps > 1000, "{steps} steps in {}", R::name());

    let limits = OverrideLimits {
        planned_acceleration: 0.02,
        planned_jerk: 0.004,
        planned_feed: 0.6,
        acceleration: 0.04,
        jerk: 0.01,
    };
    let feeds = FeedOverride::new(&limits).unwrap();
    let (mut state, mut rates) = (interpolator.start(), OverrideState::at(Rate::FULL));
    let mut period = 0;
    let steps = runs_without_heap("override", || {
        period += 1;
        match period {
            200 => rates.set(Rate::of(0.3)),
            400 => rates.set(Rate::of(0.0)),
            600 => rates.set(Rate::FULL),
            _ => {}
        }
        interpolator.step_overridden(&mut state, &feeds, &mut rates)
    });
    assert!(steps > 1200, "{steps} steps in {}", R::name());
}

fn on_the_global_parameter<R: Backend>() {
    let curve = paper_a().convert::<R>().unwrap();
    let number = |x: f64| R::from_f64(x).unwrap();
    let stages = [Stage {
        start: R::zero(),
        length: number(600.0),
        start_feed: number(0.6),
        end_feed: number(0.6),
        duration: number(1000.0),
        shape: StageShape::Steady,
        curve_start: 0,
        u_start: R::zero(),
        curve_end: 0,
        u_end: R::one(),
    }];
    for method in [Method::Secant, Method::Taylor1, Method::Taylor2] {
        let interpolator = Interpolator {
            curve: curve.as_curve(),
            schedule: Schedule::new(&stages, R::one(), 1000),
            method,
            tolerance: Tolerance { parameter: number(1e-3), fluctuation: number(1e-3), max_iterations: 8 },
            landing_step: number(0.6),
        };
        let mut state = interpolator.start::<2>();
        let steps = runs_without_heap("global parameter", || interpolator.step(&mut state));
        assert!(steps > 1000, "{steps} steps in {}", R::name());
    }
}

fn main() {
    no_step_takes_memory();
    println!("test no_step_takes_memory ... ok");
}

fn no_step_takes_memory() {
    let (_, bytes) = taken(|| vec![7_u8; 100].len());
    assert_eq!(bytes, 100, "what is given back at once is seen");

    on_pieces::<f64>();
    on_pieces::<f32>();
    on_pieces::<I4F28>();
    on_pieces::<I16F48>();
    on_the_global_parameter::<f64>();
    on_the_global_parameter::<I16F16>();
    on_the_global_parameter::<I32F32>();
}
