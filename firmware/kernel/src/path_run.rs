//! Whole runs along compiled paths, one call a period.

use core::hint::black_box;

use secant_interp::{LengthCursor, PieceInterpolator, PieceSetpoint, PieceState, StepLengths};

use crate::checksum::Checksum;
use crate::{Bits, Board, Record, compiled};

/// Periods of the first ramp, and of the cruise after it.
const RAMP: u32 = 20;

/// One period of a run; false at its end.
type Step<R> = fn(&PieceInterpolator<'static, R, 2>, &mut PieceState<R, 2>, &mut PieceSetpoint<R, 2>) -> bool;
/// The distance of one period.
type Advance<R> = fn(&StepLengths<'static, R>, &mut LengthCursor, &mut R);

/// A path, and the kernels of its format with their symbols.
struct Run<R: 'static> {
    format: &'static str,
    path: &'static str,
    interpolator: &'static PieceInterpolator<'static, R, 2>,
    step: (&'static str, Step<R>),
    advance: (&'static str, Advance<R>),
}

impl<R: Bits> Run<R> {
    /// The run, to the end of the path.
    fn steps(&self, board: &mut impl Board) {
        let interpolator = black_box(self.interpolator);
        let (symbol, step) = black_box(self.step);
        let mut state = interpolator.start();
        let zero = R::zero();
        let mut setpoint =
            PieceSetpoint { piece: 0, phase: 0, offset: [zero; 2], length: zero, evaluations: 0 };
        let mut checksum = Checksum::new();
        let mut calls = 0;
        board.paint_stack();
        while !interpolator.is_at_end(&state) && step(interpolator, &mut state, &mut setpoint) {
            calls += 1;
            checksum.add(setpoint.piece as u64);
            checksum.add(setpoint.phase);
            checksum.add(u64::from(setpoint.evaluations));
            checksum.add(setpoint.length.bits());
            setpoint.offset.iter().for_each(|x| checksum.add(x.bits()));
        }
        let stack_bytes = board.used_stack();
        let (format, item) = (self.format, self.path);
        board.record(Record { format, item, symbol, calls, checksum: checksum.value(), stack_bytes });
    }

    /// The distances alone: first on a ramp, then at constant feed.
    fn lengths(&self, board: &mut impl Board) {
        let interpolator = black_box(self.interpolator);
        let (symbol, advance) = black_box(self.advance);
        let mut cursor = LengthCursor::default();
        for item in ["advance_ramp", "advance_cruise"] {
            let mut checksum = Checksum::new();
            for _ in 0..RAMP {
                let mut length = R::zero();
                advance(&interpolator.lengths, &mut cursor, &mut length);
                checksum.add(black_box(length).bits());
            }
            let (format, checksum) = (self.format, checksum.value());
            board.record(Record { format, item, symbol, calls: RAMP, checksum, stack_bytes: 0 });
        }
    }
}

macro_rules! formats {
    ($board:ident: $($format:ty = $name:literal: $paper_a:ident, $ten_points:ident;)*) => {$({
        #[unsafe(export_name = concat!("k_step_", $name))]
        #[inline(never)]
        fn step(
            interpolator: &PieceInterpolator<'static, $format, 2>,
            state: &mut PieceState<$format, 2>,
            setpoint: &mut PieceSetpoint<$format, 2>,
        ) -> bool {
            interpolator.step_into(state, setpoint)
        }

        #[unsafe(export_name = concat!("k_advance_", $name))]
        #[inline(never)]
        fn advance(lengths: &StepLengths<'static, $format>, cursor: &mut LengthCursor, length: &mut $format) {
            *length = lengths.advance(cursor).unwrap_or_default();
        }

        let run = Run::<$format> {
            format: $name,
            path: "paper_a",
            interpolator: &compiled::$paper_a,
            step: (concat!("k_step_", $name), step),
            advance: (concat!("k_advance_", $name), advance),
        };
        run.lengths($board);
        run.steps($board);
        Run { path: "ten_points", interpolator: &compiled::$ten_points, ..run }.steps($board);
    })*};
}

/// Every path in every format.
pub(crate) fn run_all(board: &mut impl Board) {
    #[cfg(feature = "floats")]
    formats!(board:
        f64 = "f64": PAPER_A_F64, TEN_POINTS_F64;
        f32 = "f32": PAPER_A_F32, TEN_POINTS_F32;
    );
    #[cfg(feature = "fixed-32")]
    formats!(board:
        real::I3F29 = "I3F29": PAPER_A_I3F29, TEN_POINTS_I3F29;
        real::I4F28 = "I4F28": PAPER_A_I4F28, TEN_POINTS_I4F28;
    );
    #[cfg(feature = "fixed-64")]
    formats!(board:
        real::I4F60 = "I4F60": PAPER_A_I4F60, TEN_POINTS_I4F60;
    );
}
