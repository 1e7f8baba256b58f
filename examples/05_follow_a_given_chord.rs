//! The feed comes from somewhere else, here from a handwheel: each period has a chord of a given length.
//!
//!     cargo run -p feedbits-examples --example 05_follow_a_given_chord

use std::error::Error;

use feedbits_examples::curve;
use nurbs_core::{PieceLimits, compile};
use real::{Backend, DoubleDouble, I4F28, Real};
use secant_interp::{ChordTolerance, PieceInterpolator, StepLengths};

/// What the wheel commands in a period, in mm: it is turned, held, and turned on.
fn wheel(period: usize) -> f64 {
    match period {
        300..600 => 0.0,
        _ => 0.05 + 0.04 * (period as f64 / 150.0).sin(),
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let curve = curve()?;
    // The longest chord that may be asked for.
    let limits = PieceLimits { length_mm: 32.0, step_mm: 0.1 };
    let table = compile::<DoubleDouble, I4F28, 2>(&[curve.as_curve()], &limits)?;
    let pieces = table.as_pieces();
    let in_chord_units = |mm: f64| I4F28::from_f64(mm.ldexp(pieces.chord_exponent)).unwrap_or_default();
    let tolerance = ChordTolerance::for_fluctuation(Some(1e-6), 5);
    let landing_step = in_chord_units(0.001);
    let run = PieceInterpolator {
        pieces,
        lengths: StepLengths { stages: &[], crossings: &[] },
        tolerance,
        landing_step,
    };

    let mut state = run.start();
    let mut before = [0.0; 2];
    let mut errors = Vec::new();
    while let Some(setpoint) = run.step_by(&mut state, in_chord_units(wheel(errors.len()))) {
        let now =
            run.pieces.position(setpoint.piece, &setpoint.offset).map(|x| x as f64 / f64::powi(2.0, 39));
        let chord = (now[0] - before[0]).hypot(now[1] - before[1]);
        errors.push((chord - wheel(errors.len())).abs());
        before = now;
    }
    let periods = errors.len();
    errors.pop(); // the last chord takes the rest of the curve
    let worst = errors.into_iter().fold(0.0, f64::max);
    println!("{periods} periods; a chord is at most {worst:.1e} mm off the wheel's");
    assert!(worst < 1e-6 && (before[0] - 100.0).abs() < 1e-5);
    Ok(())
}

#[test]
fn it_runs() -> Result<(), Box<dyn Error>> {
    main()
}
