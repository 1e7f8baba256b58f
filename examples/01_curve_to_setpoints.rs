//! From a curve to a setpoint each period, in fixed point of 32 bits.
//!
//!     cargo run -p feedbits-examples --example 01_curve_to_setpoints

use std::error::Error;

use feed_plan::{EndFeeds, Planned, ProfileKind};
use feedbits_examples::{curve, limits};
use nurbs_core::{PieceLimits, compile_with_stops};
use real::{DoubleDouble, I4F28};
use secant_interp::{ChordTolerance, CompiledPath};

fn main() -> Result<(), Box<dyn Error>> {
    // Before real time: a plan within the limits, and the path in pieces that end where the plan rests.
    let (curve, limits) = (curve()?, limits());
    let curves = [curve.as_curve()];
    let planned = Planned::along(&curves, &limits, EndFeeds::default(), ProfileKind::default())?;
    let landing_step = limits.acceleration;
    let cut = PieceLimits { length_mm: 32.0, step_mm: limits.feedrate + landing_step };
    let pieces = compile_with_stops::<DoubleDouble, I4F28, 2>(&curves, &cut, &planned.rests())?;
    let tolerance = ChordTolerance::for_fluctuation(Some(1e-6), 5);
    let path = CompiledPath::new(pieces, &planned.chords.as_schedule(), tolerance, landing_step)?;

    // In real time: a setpoint a period. Positions are integers in units of 2⁻³⁹ mm.
    let (mut periods, mut last) = (0, [0.0; 2]);
    for run in path.runs() {
        let mut state = run.start();
        while let Some(setpoint) = run.step(&mut state) {
            let position = run.pieces.position(setpoint.piece, &setpoint.offset);
            last = position.map(|x| x as f64 / f64::powi(2.0, 39));
            periods += 1;
            if periods % 200 == 0 {
                println!("{periods:5} ms  x {:8.4}  y {:8.4}", last[0], last[1]);
            }
        }
    }
    println!("{periods:5} ms  x {:8.4}  y {:8.4}, the end", last[0], last[1]);
    assert_eq!(periods, planned.chords.as_schedule().periods());
    assert!((last[0] - 100.0).abs() < 1e-5 && last[1].abs() < 1e-5);
    Ok(())
}

#[test]
fn it_runs() -> Result<(), Box<dyn Error>> {
    main()
}
