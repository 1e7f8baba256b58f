//! A path and the chords of its first periods, stepped by on pieces and by plain Newton iteration.

use std::hint::black_box;

use feedbits_benches::Path;
use nurbs_core::{Evaluate, ORIGIN_EXPONENT, PiecesBuf, PowerCurve};
use real::Real;
use secant_interp::{
    ChordTolerance, LengthCursor, PieceInterpolator, PieceSetpoint, PieceState, StepLengths,
};

use crate::newton::{NewtonSetpoint, NewtonState};

/// Steps of a run.
pub(crate) const STEPS: u32 = 256;

/// Asks for all fields of a setpoint.
pub(crate) fn look<T>(setpoint: &T) {
    black_box(setpoint);
}

/// What both ways begin with, formed before real time.
pub(crate) struct Chords<const D: usize> {
    table: PiecesBuf<f64, D>,
    tolerance: ChordTolerance<f64>,
    start: PieceState<f64, D>,
    /// In chord units.
    lengths: Vec<f64>,
    curve: PowerCurve<D>,
    first_sigma: f64,
    lengths_mm: Vec<f64>,
}

impl<const D: usize> Chords<D> {
    /// The chords of a feed that swings, at a fluctuation of 1e-6 as in the other benches.
    ///
    /// # Panics
    /// Never: a feed has chords.
    pub(crate) fn of(path: &Path<D>) -> Self {
        let table = path.pieces::<f64>();
        let exponent = table.as_pieces().chord_exponent;
        let stages = path.stages::<f64>(exponent);
        let plan = StepLengths { stages: &stages, crossings: &[] };
        let mut cursor = LengthCursor::default();
        let lengths: Vec<f64> = (0..STEPS).filter_map(|_| plan.advance(&mut cursor)).collect();
        let lengths_mm: Vec<f64> = lengths.iter().map(|length| length.ldexp(-exponent)).collect();
        let tolerance = ChordTolerance::for_fluctuation(Some(1e-6), 5);
        let pieces = table.as_pieces();
        let start = PieceInterpolator { pieces, lengths: plan, tolerance, landing_step: 0.0 }.start();
        let curve = PowerCurve::new::<f64>(&path.curve.as_curve());
        let first_sigma = NewtonState::first_sigma(&curve, lengths_mm[0]);
        Self { table, tolerance, start, lengths, curve, first_sigma, lengths_mm }
    }

    /// The path on pieces; shows each setpoint. Returns the last length.
    #[inline(always)]
    pub(crate) fn on_pieces(&self, mut show: impl FnMut(&PieceSetpoint<f64, D>)) -> f64 {
        let run = PieceInterpolator {
            pieces: self.table.as_pieces(),
            lengths: StepLengths { stages: &[], crossings: &[] },
            tolerance: self.tolerance,
            landing_step: 0.0,
        };
        let (mut state, mut setpoint) = (self.start, PieceSetpoint::default());
        for length in &self.lengths {
            if !run.step_by_into(&mut state, *length, &mut setpoint) {
                break;
            }
            show(&setpoint);
        }
        setpoint.length
    }

    /// The path by Newton iteration; shows each setpoint. Returns the last length.
    #[inline(always)]
    pub(crate) fn by_newton<const TREND: bool>(&self, mut show: impl FnMut(&NewtonSetpoint<D>)) -> f64 {
        let mut state = NewtonState::start(&self.curve, self.first_sigma);
        let mut setpoint = NewtonSetpoint::NONE;
        for length in &self.lengths_mm {
            if !state.step_by::<TREND>(*length, &self.tolerance, &mut setpoint) {
                break;
            }
            show(&setpoint);
        }
        setpoint.length
    }

    /// The steps that a run makes, their evaluations, and by which part of its length the worst chord is off. `run` hands each point
    /// in mm on, and the step's evaluations.
    pub(crate) fn judged(&self, run: impl FnOnce(&mut dyn FnMut([f64; D], u32)) -> f64) -> (u32, u32, f64) {
        let (mut steps, mut evaluations, mut worst) = (0, 0, 0.0_f64);
        let mut last = self.curve.point(self.curve.domain().0);
        let mut lengths = self.lengths_mm.iter();
        run(&mut |point, made| {
            let chord = (0..D).map(|d| (point[d] - last[d]).powi(2)).sum::<f64>().sqrt();
            worst = lengths.next().map_or(worst, |length| worst.max((1.0 - chord / length).abs()));
            last = point;
            steps += 1;
            evaluations += made;
        });
        (steps, evaluations, worst)
    }

    /// A setpoint on pieces in mm.
    pub(crate) fn in_mm(&self, setpoint: &PieceSetpoint<f64, D>) -> [f64; D] {
        let pieces = self.table.as_pieces();
        let origin = pieces.pieces[setpoint.piece.min(pieces.pieces.len() - 1)].origin;
        std::array::from_fn(|d| {
            (origin[d] as f64).ldexp(ORIGIN_EXPONENT) + setpoint.offset[d].ldexp(pieces.coordinate_exponent)
        })
    }
}
