//! A number format of your own: any signed type of the crate `fixed`, or a width that is chosen at run time.
//!
//!     cargo run -p feedbits-examples --example 02_own_number_format

use std::error::Error;

use feedbits_examples::curve;
use nurbs_core::{PieceLimits, compile};
use real::fixed::{FixedI32, types::extra::U27};
use real::{Backend, DoubleDouble, FixedPoint, I4F28, Overflow, Real, Rounding, RuntimeFixed, RuntimeFormat};
use secant_interp::{ChordTolerance, PieceInterpolator, StepLengths};

/// 5 integer bits, the sign among them, and 27 fraction bits.
type I5F27 = FixedPoint<FixedI32<U27>>;

/// The largest error of a chord of 0.1 mm along the curve, over 0.1 mm.
fn fluctuation<R: Backend>() -> Result<f64, Box<dyn Error>> {
    let curve = curve()?;
    let limits = PieceLimits { length_mm: 32.0, step_mm: 0.1 };
    let table = compile::<DoubleDouble, R, 2>(&[curve.as_curve()], &limits)?;
    let pieces = table.as_pieces();
    let chord = R::from_f64(0.1.ldexp(pieces.chord_exponent)).ok_or("0.1 mm does not fit")?;
    let tolerance = ChordTolerance::for_fluctuation(Some(1e-9), 5);
    let run = PieceInterpolator {
        pieces,
        lengths: StepLengths { stages: &[], crossings: &[] },
        tolerance,
        landing_step: chord,
    };
    let mut state = run.start();
    let (mut before, mut worst) = ([0.0; 2], 0.0_f64);
    let mut chords = Vec::new();
    while let Some(setpoint) = run.step_by(&mut state, chord) {
        let position = run.pieces.position(setpoint.piece, &setpoint.offset);
        let now = position.map(|x| x as f64 / f64::powi(2.0, 39));
        chords.push((now[0] - before[0]).hypot(now[1] - before[1]));
        before = now;
    }
    chords.pop(); // the last takes the rest of the curve
    for length in chords {
        worst = worst.max((length / 0.1 - 1.0).abs());
    }
    Ok(worst)
}

fn main() -> Result<(), Box<dyn Error>> {
    println!("f64     {:.1e}", fluctuation::<f64>()?);
    println!("I4F28   {:.1e}", fluctuation::<I4F28>()?);
    println!("I5F27   {:.1e}", fluctuation::<I5F27>()?);
    for width in [24, 20, 16] {
        // Two integer bits; the format is set for all numbers of this type on this thread.
        let format = RuntimeFormat::new(width, width - 2, Rounding::Floor, Overflow::Saturate)
            .ok_or("no such format")?;
        let worst = format.run::<0, _>(fluctuation::<RuntimeFixed<0>>)?;
        println!("I2F{}   {worst:.1e}, in a datapath that drops bits and saturates", width - 2);
    }
    assert!(fluctuation::<I4F28>()? <= fluctuation::<I5F27>()?);
    Ok(())
}

#[test]
fn it_runs() -> Result<(), Box<dyn Error>> {
    main()
}
