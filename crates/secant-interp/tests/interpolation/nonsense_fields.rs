//! A step on pieces and stages whose public fields hold nonsense: it makes something, and no panic, with overflow checks too.

use crate::steps::{step, step_by};
use nurbs_core::{NurbsBuf, PieceLimits, Pieces, compile};
use real::{Backend, DoubleDouble, I4F28, I16F48, Real};
use secant_interp::{ChordTolerance, LengthStage, PieceInterpolator, StepLengths};

/// Steps a few times with each field at an extreme of its type, one by one.
fn steps<R: Backend>() {
    let points = vec![[0.0, 0.0], [20.0, 0.0], [40.0, 30.0], [80.0, 30.0]];
    let weights = vec![1.0, 0.8, 0.8, 1.0];
    let knots = vec![0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0];
    let curve = NurbsBuf::try_new(3, points, weights, knots).unwrap();
    let limits = PieceLimits { length_mm: 8.0, step_mm: 0.6 };
    let table = compile::<DoubleDouble, R, 2>(&[curve.as_curve()], &limits).unwrap();
    let good = table.as_pieces();
    let feed = R::from_f64(0.5.ldexp(good.chord_exponent)).unwrap();
    let stage = LengthStage::new(100 << 32, R::zero(), feed).unwrap();
    let run = |pieces: Pieces<'_, R, 2>, stage: LengthStage<R>| {
        let run = PieceInterpolator {
            pieces,
            lengths: StepLengths { stages: &[stage, stage], crossings: &[] },
            tolerance: ChordTolerance::for_fluctuation(Some(1e-6), 5),
            landing_step: R::resolution(),
        };
        let mut state = run.start();
        for _ in 0..250 {
            let Some(setpoint) = step(&run, &mut state) else { break };
            let _ = run.pieces.position(setpoint.piece, &setpoint.offset);
        }
        let mut state = run.start();
        for length in [R::zero(), R::resolution(), feed, R::max_value(), -R::max_value(), R::min_value()] {
            let _ = step_by(&run, &mut state, length);
        }
    };
    for extreme in [i32::MIN, i32::MIN + 1, -1000, 1000, i32::MAX - 1, i32::MAX] {
        run(Pieces { coordinate_exponent: extreme, ..good }, stage);
        run(Pieces { chord_exponent: extreme, ..good }, stage);
    }
    for extreme in [i8::MIN, i8::MAX] {
        let mut rows =
            [good.pieces.to_vec(), good.pieces.to_vec(), good.pieces.to_vec(), good.pieces.to_vec()];
        rows[0].iter_mut().for_each(|row| row.coordinate_exponent = extreme);
        rows[1].iter_mut().for_each(|row| row.step_exponent = extreme);
        rows[2].iter_mut().for_each(|row| row.range_exponent = extreme);
        rows[3].iter_mut().for_each(|row| row.joint_exponent = extreme);
        for rows in &rows {
            for chord_exponent in [i32::MIN, good.chord_exponent, i32::MAX] {
                run(Pieces { pieces: rows, chord_exponent, ..good }, stage);
            }
        }
    }
    for reciprocal_exponent in [0, 63, 64, u32::MAX - 1, u32::MAX] {
        run(good, LengthStage { reciprocal_exponent, ..stage });
    }
    for duration in [0, 1, 1 << 63, u64::MAX] {
        run(good, LengthStage { duration, ..stage });
    }
}

#[test]
fn extremes_of_public_fields_do_not_panic() {
    steps::<f64>();
    steps::<f32>();
    steps::<I4F28>();
    steps::<I16F48>();
}
