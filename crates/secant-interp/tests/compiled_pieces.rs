//! The step on compiled pieces, judged in double-double: chords, ends, evaluations, in every kind of format.

use nurbs_core::{Evaluate, NurbsBuf, PieceLimits, PiecesBuf, compile};
use real::{Backend, DoubleDouble, FixedPoint, I4F28, I4F60, Real};
use secant_interp::{ChordTolerance, LengthStage, PieceInterpolator, StepLengths};

type I3F29 = FixedPoint<fixed::types::I3F29>;

/// A path, its feed per period in mm, and the number of periods.
struct Case<const D: usize> {
    curve: NurbsBuf<f64, D>,
    feed_mm: f64,
}

fn paper_a() -> Case<2> {
    let points = [[150, 150], [0, 0], [0, 300], [150, 150], [300, 0], [300, 300], [150, 150]];
    let points = points.map(|p| p.map(f64::from)).to_vec();
    let knots = vec![0.0, 0.0, 0.0, 0.0, 0.25, 0.5, 0.75, 1.0, 1.0, 1.0, 1.0];
    Case { curve: NurbsBuf::try_new(3, points, vec![1.0; 7], knots).unwrap(), feed_mm: 0.6 }
}

/// The 10-point rational curve at 50 mm/s and 3 ms.
fn ten_points() -> Case<2> {
    let x = [0.0, 10.0, 20.0, 30.0, 40.0, 50.0, 60.0, 65.0, 70.0, 80.0];
    let y = [15.0, 34.1, 10.1, 16.1, 0.9, 38.0, 2.9, 8.9, 26.1, 5.9];
    let weights = vec![1.0, 2.0, 1.5, 1.0, 1.0, 2.0, 1.0, 1.0, 2.0, 1.0];
    let mut knots = vec![0.0; 4];
    knots.extend([0.1836, 0.2781, 0.3837, 0.5474, 0.7104, 0.8049]);
    knots.extend([1.0; 4]);
    let points = x.into_iter().zip(y).map(|(x, y)| [x, y]).collect();
    Case { curve: NurbsBuf::try_new(3, points, weights, knots).unwrap(), feed_mm: 0.15 }
}

/// What a run was like.
#[derive(Debug)]
struct Figures {
    /// Largest |1 - chord/L| over the steps of at least a quarter of the feed.
    cruise: f64,
    evaluations: f64,
    most_evaluations: u32,
    steps: usize,
}

/// Runs at a feed that swings between half and full, as limits make it, and measures each chord exactly.
fn run<R: Backend, const D: usize>(case: &Case<D>, piece_mm: f64, residual: f64) -> Figures {
    let limits = PieceLimits { length_mm: piece_mm, step_mm: case.feed_mm * 1.05 };
    let table: PiecesBuf<R, D> = compile::<DoubleDouble, R, D>(&[case.curve.as_curve()], &limits).unwrap();
    let pieces = table.as_pieces();
    let unit = 1.0_f64.scale(pieces.chord_exponent);
    let feed = |part: f64| R::from_f64(part * case.feed_mm * unit).unwrap();
    let swing = [(0.0, 1.0), (1.0, 1.0), (1.0, 0.5), (0.5, 0.5), (0.5, 1.0)];
    let stages: Vec<_> = swing
        .iter()
        .cycle()
        .take(4000)
        .enumerate()
        .filter_map(|(i, (v, w))| {
            let v = if i > 4 && *v == 0.0 { 1.0 } else { *v };
            LengthStage::new(20 << 32, feed(v), feed(*w) - feed(v))
        })
        .collect();
    let interpolator = PieceInterpolator {
        pieces,
        lengths: StepLengths { stages: &stages },
        tolerance: ChordTolerance {
            residual: R::from_f64(residual).unwrap().max(R::resolution().scale(2)),
            max_evaluations: 5,
        },
        landing_step: feed(0.05),
    };

    let exact = case.curve.convert::<DoubleDouble>().unwrap();
    let place = |piece: usize, phase: u64| {
        let at = &table.places()[piece.min(table.places().len() - 1)];
        let (begin, end) = (DoubleDouble::new(at.begin.0, at.begin.1), DoubleDouble::new(at.end.0, at.end.1));
        let t = if piece < table.places().len() {
            DoubleDouble::from_phase(phase, 0)
        } else {
            DoubleDouble::from(1.0)
        };
        exact.as_curve().point(begin + (end - begin) * t)
    };
    let mut state = interpolator.start();
    let mut from = place(0, 0);
    let mut before = (0, 0);
    let mut figures = Figures { cruise: 0.0, evaluations: 0.0, most_evaluations: 0, steps: 0 };
    while let Some(setpoint) = interpolator.step(&mut state) {
        let to = place(setpoint.piece, setpoint.phase);
        assert!((setpoint.piece, setpoint.phase) >= before, "goes back: {before:?} {setpoint:?}");
        before = (setpoint.piece, setpoint.phase);
        let chord = DoubleDouble::norm(&core::array::from_fn::<_, D, _>(|d| to[d] - from[d]));
        let (high, low) = setpoint.length.to_f64_pair();
        let wanted = DoubleDouble::new(high, low).scale(-pieces.chord_exponent);
        if setpoint.piece < table.places().len() && wanted.value() >= 0.25 * case.feed_mm {
            let delta = (DoubleDouble::from(1.0) - chord / wanted).value().abs();
            figures.cruise = figures.cruise.max(delta);
        }
        figures.evaluations += f64::from(setpoint.evaluations);
        figures.most_evaluations = figures.most_evaluations.max(setpoint.evaluations);
        figures.steps += 1;
        assert!(figures.steps < 100_000, "does not end");
        from = to;
    }
    figures.evaluations /= figures.steps as f64;
    assert_eq!(before.0, table.places().len(), "ends at the end");
    figures
}

#[test]
fn figures_on_both_curves() {
    for piece_mm in [32.0, 64.0] {
        for residual in [1e-4, 1e-5, 0.0] {
            println!("pieces {piece_mm}, residual {residual}");
            println!("A f64   {:?}", run::<f64, 2>(&paper_a(), piece_mm, residual));
            println!("A f32   {:?}", run::<f32, 2>(&paper_a(), piece_mm, residual));
            println!("A I4F28 {:?}", run::<I4F28, 2>(&paper_a(), piece_mm, residual));
            println!("A I3F29 {:?}", run::<I3F29, 2>(&paper_a(), piece_mm, residual));
            println!("A I4F60 {:?}", run::<I4F60, 2>(&paper_a(), piece_mm, residual));
            println!("B f64   {:?}", run::<f64, 2>(&ten_points(), piece_mm, residual));
            println!("B f32   {:?}", run::<f32, 2>(&ten_points(), piece_mm, residual));
            println!("B I4F28 {:?}", run::<I4F28, 2>(&ten_points(), piece_mm, residual));
            println!("B I4F60 {:?}", run::<I4F60, 2>(&ten_points(), piece_mm, residual));
        }
    }
}
