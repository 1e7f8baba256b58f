//! A plan in which one axis is slower than the path: a heavy table in x.
//!
//!     cargo run -p feedbits-examples --example 03_axis_limits

use std::error::Error;

use feed_plan::{AxisLimits, EndFeeds, KinematicLimits, Planned, ProfileKind};
use feedbits_examples::{curve, limits};
use nurbs_core::{PieceLimits, compile_with_stops};
use real::DoubleDouble;
use secant_interp::{ChordTolerance, CompiledPath};

/// The periods of a run, and the greatest acceleration of x, in mm per period².
fn run(limits: &KinematicLimits<f64>) -> Result<(usize, f64), Box<dyn Error>> {
    let curve = curve()?;
    let curves = [curve.as_curve()];
    let planned = Planned::along(&curves, limits, EndFeeds::default(), ProfileKind::default())?;
    let cut = PieceLimits { length_mm: 32.0, step_mm: limits.feedrate + limits.acceleration };
    let pieces = compile_with_stops::<DoubleDouble, f64, 2>(&curves, &cut, &planned.rests())?;
    let tolerance = ChordTolerance::for_fluctuation(Some(1e-9), 5);
    let path = CompiledPath::new(pieces, &planned.chords.as_schedule(), tolerance, limits.acceleration)?;
    // At rest one period long before the first setpoint.
    let mut x = vec![0.0, 0.0];
    for run in path.runs() {
        let mut state = run.start();
        while let Some(setpoint) = run.step(&mut state) {
            x.push(run.pieces.position(setpoint.piece, &setpoint.offset)[0] as f64 / f64::powi(2.0, 39));
        }
    }
    let acceleration = |three: &[f64]| (three[2] - 2.0 * three[1] + three[0]).abs();
    Ok((x.len() - 2, x.windows(3).map(acceleration).fold(0.0, f64::max)))
}

fn main() -> Result<(), Box<dyn Error>> {
    let free = limits();
    let table = AxisLimits { acceleration: Some(0.2 * free.acceleration), ..AxisLimits::default() };
    let limited = KinematicLimits { axes: [table, AxisLimits::default(), AxisLimits::default()], ..free };
    let ((fast, most), (slow, least)) = (run(&free)?, run(&limited)?);
    println!("without limits of axes: {fast} periods, x accelerates with {:.0} mm/s²", 1e6 * most);
    println!("x limited to 200 mm/s²: {slow} periods, x accelerates with {:.0} mm/s²", 1e6 * least);
    assert!(fast < slow && most > 0.000_4 && least < 0.000_201);
    Ok(())
}

#[test]
fn it_runs() -> Result<(), Box<dyn Error>> {
    main()
}
