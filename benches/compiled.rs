//! A path compiled for a format, followed at a feed that swings.

use std::hint::black_box;

use feedbits_benches::Path;
use nurbs_core::{Pieces, PiecesBuf};
use real::{Backend, Real};
use secant_interp::{ChordTolerance, LengthCursor, LengthStage, PieceInterpolator, StepLengths};

/// Steps of a run at most: the stages last no longer on the longest curve.
const MOST_STEPS: u64 = 400_000;

/// A path compiled for a format, with its feeds.
pub(crate) struct Compiled<R, const D: usize> {
    pub(crate) table: PiecesBuf<R, D>,
    pub(crate) stages: Vec<LengthStage<R>>,
    /// What the last step may reach further, so that it ends where the path does.
    landing_step: R,
}

impl<R: Backend, const D: usize> Compiled<R, D> {
    pub(crate) fn new(path: &Path<D>) -> Self {
        let table = path.pieces::<R>();
        let stages = path.stages::<R>(table.as_pieces().chord_exponent);
        // The pieces are compiled for steps that are longer by a twentieth.
        let landing_mm = path.feed_mm / 32.0;
        let landing_step = landing_mm.ldexp(table.as_pieces().chord_exponent);
        let landing_step = R::from_f64(landing_step).unwrap_or_else(R::zero);
        let whole = Self { table, stages, landing_step };
        let steps = whole.follow().0;
        Self { stages: first_periods(&whole.stages, steps), ..whole }
    }

    pub(crate) fn interpolator(&self) -> PieceInterpolator<'_, R, D> {
        PieceInterpolator {
            pieces: self.table.as_pieces(),
            lengths: StepLengths { stages: &self.stages, crossings: &[] },
            tolerance: ChordTolerance::for_fluctuation(Some(1e-6), 5),
            landing_step: self.landing_step,
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

/// The stages up to so many periods: a run would stand on its end until its schedule is over. The last one is cut, and has the mean feed
/// that it had so far.
fn first_periods<R: Backend>(stages: &[LengthStage<R>], periods: u64) -> Vec<LengthStage<R>> {
    let mut left = periods;
    let first = stages.iter().map_while(|stage| {
        let taken = left.min(stage.duration >> 32);
        left -= taken;
        LengthStage::new(taken << 32, stage.feed, change_over(stage, taken))
            .map(|first| first.shaped(stage.shape))
    });
    first.collect()
}

/// The change of the feed by which a stage of so many periods goes as far as this one does in them.
fn change_over<R: Backend>(stage: &LengthStage<R>, periods: u64) -> R {
    if periods << 32 == stage.duration {
        return stage.change;
    }
    let alone = StepLengths { stages: std::slice::from_ref(stage), crossings: &[] };
    let mut cursor = LengthCursor::default();
    let distance: f64 =
        (0..periods).filter_map(|_| alone.advance(&mut cursor)).map(|step| step.to_f64()).sum();
    // The mean feed over a stage lies in the middle between those at its ends.
    let change = 2.0 * (distance / periods as f64 - stage.feed.to_f64());
    R::from_f64(change).unwrap_or_else(R::zero)
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
