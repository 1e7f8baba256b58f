//! A path compiled for a format, followed at a feed that swings.

use std::hint::black_box;

use feedbits_benches::Path;
use nurbs_core::{Pieces, PiecesBuf};
use real::{Backend, Real};
use secant_interp::{ChordTolerance, LengthStage, PieceInterpolator, StepLengths};

/// Steps of a run at most: the stages last no longer on the longest curve.
const MOST_STEPS: u64 = 400_000;

/// A path compiled for a format, with its feeds.
pub(crate) struct Compiled<R, const D: usize> {
    pub(crate) table: PiecesBuf<R, D>,
    pub(crate) stages: Vec<LengthStage<R>>,
}

impl<R: Backend, const D: usize> Compiled<R, D> {
    pub(crate) fn new(path: &Path<D>) -> Self {
        let table = path.pieces::<R>();
        let stages = path.stages::<R>(table.as_pieces().chord_exponent);
        let whole = Self { table, stages };
        let steps = whole.follow().0;
        Self { stages: first_periods(&whole.stages, steps), ..whole }
    }

    pub(crate) fn interpolator(&self) -> PieceInterpolator<'_, R, D> {
        PieceInterpolator {
            pieces: self.table.as_pieces(),
            lengths: StepLengths { stages: &self.stages, crossings: &[] },
            tolerance: ChordTolerance::for_fluctuation(Some(1e-6), 5),
            landing_step: R::zero(),
        }
    }

    /// Follows the path; steps, and the mean of the coordinates in mm.
    pub(crate) fn follow(&self) -> (u64, f64) {
        let interpolator = self.interpolator();
        let pieces = interpolator.pieces;
        let mut state = interpolator.start();
        let (mut steps, mut sum) = (0_u64, 0.0);
        while steps < MOST_STEPS
            && !interpolator.is_at_end(&state)
            && let Some(setpoint) = interpolator.step(&mut state)
        {
            let row = setpoint.piece.min(pieces.pieces.len() - 1);
            let point = millimetres(&pieces, row, &setpoint.offset);
            sum += point.iter().sum::<f64>();
            steps += 1;
        }
        (steps, sum / steps as f64)
    }

    /// Runs the path and looks at the last point alone, so that only the steps are timed.
    pub(crate) fn run(&self) -> f64 {
        let interpolator = self.interpolator();
        let mut state = interpolator.start();
        let mut steps = 0;
        while steps < MOST_STEPS
            && !interpolator.is_at_end(&state)
            && let Some(setpoint) = interpolator.step(&mut state)
        {
            black_box(setpoint);
            steps += 1;
        }
        steps as f64
    }
}

/// The stages up to so many periods: a run would stand on its end until its schedule is over.
fn first_periods<R: Backend>(stages: &[LengthStage<R>], periods: u64) -> Vec<LengthStage<R>> {
    let mut left = periods << 32;
    let first = stages.iter().map_while(|stage| {
        let duration = stage.duration.min(left);
        left -= duration;
        LengthStage::new(duration, stage.feed, stage.change).map(|first| first.shaped(stage.shape))
    });
    first.collect()
}

fn millimetres<R: Backend, const D: usize>(
    pieces: &Pieces<'_, R, D>,
    piece: usize,
    offset: &[R; D],
) -> [f64; D] {
    let origin = pieces.pieces[piece].origin;
    let at = |d: usize| {
        (origin[d] as f64).ldexp(nurbs_core::ORIGIN_EXPONENT)
            + offset[d].to_f64().ldexp(pieces.coordinate_exponent)
    };
    std::array::from_fn(at)
}
