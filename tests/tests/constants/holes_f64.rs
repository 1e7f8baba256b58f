use nurbs_core::{Joint, Piece, Pieces};
use secant_interp::{ChordTolerance, Crossing, LengthStage, PieceInterpolator, StageShape, StepLengths, Section};

const _: () = assert!(
    matches!(secant_interp::VERSION, [0, 1]),
    "these constants are for secant-interp 0.1: take that version, or run `feedbits compile` again"
);
const _: () = secant_interp::TablesOf::<1>::ARE_READ;

/// The number format.
pub type Number = f64;

/// T, the interpolation period, in s.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIOD_S: f64 = 0.003;

/// Setpoints from begin to end.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIODS: usize = 105;

/// Path and plan.
pub static PATH: PieceInterpolator<'static, Number, 3> = PieceInterpolator {
    pieces: Pieces {
        pieces: &[
            Piece { origin: [549755813888, 1099511627776, 1649267441664], coordinate_exponent: -2, step_exponent: 0, range_exponent: 0, joint_ratio: 32768, joint_exponent: 1, joint: Joint::Smooth, step_per_chord: [0.058823529411764705, 0.06640625] },
            Piece { origin: [2748779069440, 1099511627776, 1649267441664], coordinate_exponent: -2, step_exponent: 0, range_exponent: 0, joint_ratio: 32768, joint_exponent: 1, joint: Joint::Breaks, step_per_chord: [0.058823529411764705, 0.06640625] },
            Piece { origin: [2748779069440, -2199023255552, 1649267441664], coordinate_exponent: -2, step_exponent: 0, range_exponent: 0, joint_ratio: 32768, joint_exponent: 1, joint: Joint::Smooth, step_per_chord: [0.058823529411764705, 0.06640625] },
        ],
        numerators: &[
            [0.0, 0.0, -16.0],
            [0.0, 0.0, -16.0],
            [16.0, 0.0, 0.0],
        ],
        weights: &[],
        degree: 1,
        coordinate_exponent: -2,
        chord_exponent: 2,
    },
    lengths: StepLengths {
        stages: &[
            LengthStage { duration: 16419115229, reciprocal: 9650722515708868540, reciprocal_exponent: 33, period_share: 0.26158335793965815, feed: 0.0, change: 0.29245908507142276, shape: StageShape::Onset },
            LengthStage { duration: 16419115229, reciprocal: 9650722515708868540, reciprocal_exponent: 33, period_share: 0.26158335793965815, feed: 0.29245908507142276, change: 0.29245908507142276, shape: StageShape::Easing },
            LengthStage { duration: 84647394444, reciprocal: 14975660013573912924, reciprocal_exponent: 36, period_share: 0.050739509753503546, feed: 0.5849181701428455, change: 0.0, shape: StageShape::Steady },
            LengthStage { duration: 16419115229, reciprocal: 9650722515708868540, reciprocal_exponent: 33, period_share: 0.26158335793965815, feed: 0.5849181701428455, change: -0.29245908507142276, shape: StageShape::Onset },
            LengthStage { duration: 16419115229, reciprocal: 9650722515708868540, reciprocal_exponent: 33, period_share: 0.26158335793965815, feed: 0.29245908507142276, change: -0.29245908507142276, shape: StageShape::Easing },
            LengthStage { duration: 16419115229, reciprocal: 9650722515708868540, reciprocal_exponent: 33, period_share: 0.26158335793965815, feed: 0.0, change: 0.29245908507142276, shape: StageShape::Onset },
            LengthStage { duration: 16419115229, reciprocal: 9650722515708868540, reciprocal_exponent: 33, period_share: 0.26158335793965815, feed: 0.29245908507142276, change: 0.29245908507142276, shape: StageShape::Easing },
            LengthStage { duration: 84647394444, reciprocal: 14975660013573912924, reciprocal_exponent: 36, period_share: 0.050739509753503546, feed: 0.5849181701428455, change: 0.0, shape: StageShape::Steady },
            LengthStage { duration: 16419115229, reciprocal: 9650722515708868540, reciprocal_exponent: 33, period_share: 0.26158335793965815, feed: 0.5849181701428455, change: -0.29245908507142276, shape: StageShape::Onset },
            LengthStage { duration: 16419115229, reciprocal: 9650722515708868540, reciprocal_exponent: 33, period_share: 0.26158335793965815, feed: 0.29245908507142276, change: -0.29245908507142276, shape: StageShape::Easing },
            LengthStage { duration: 16419115229, reciprocal: 9650722515708868540, reciprocal_exponent: 33, period_share: 0.26158335793965815, feed: 0.0, change: 0.29245908507142276, shape: StageShape::Onset },
            LengthStage { duration: 16419115229, reciprocal: 9650722515708868540, reciprocal_exponent: 33, period_share: 0.26158335793965815, feed: 0.29245908507142276, change: 0.29245908507142276, shape: StageShape::Easing },
            LengthStage { duration: 84647394444, reciprocal: 14975660013573912924, reciprocal_exponent: 36, period_share: 0.050739509753503546, feed: 0.5849181701428455, change: 0.0, shape: StageShape::Steady },
            LengthStage { duration: 16419115229, reciprocal: 9650722515708868540, reciprocal_exponent: 33, period_share: 0.26158335793965815, feed: 0.5849181701428455, change: -0.29245908507142276, shape: StageShape::Onset },
            LengthStage { duration: 16419115229, reciprocal: 9650722515708868540, reciprocal_exponent: 33, period_share: 0.26158335793965815, feed: 0.29245908507142276, change: -0.29245908507142276, shape: StageShape::Easing },
        ],
        crossings: &[
            Crossing { rest: 3534213340, time: 760753955, stages: 1, distance: 0.24673759728944722 },
            Crossing { rest: 2773459385, time: 1521507910, stages: 1, distance: 0.5831219898332685 },
            Crossing { rest: 1521507909, time: 2773459386, stages: 1, distance: 0.5831219898332685 },
            Crossing { rest: 760753954, time: 3534213341, stages: 1, distance: 0.24673759728944722 },
            Crossing { rest: 0, time: 0, stages: 0, distance: 0.0 },
            Crossing { rest: 3534213340, time: 760753955, stages: 1, distance: 0.24673759728944722 },
            Crossing { rest: 2773459385, time: 1521507910, stages: 1, distance: 0.5831219898332685 },
            Crossing { rest: 1521507909, time: 2773459386, stages: 1, distance: 0.5831219898332685 },
            Crossing { rest: 760753954, time: 3534213341, stages: 1, distance: 0.24673759728944722 },
            Crossing { rest: 0, time: 0, stages: 0, distance: 0.0 },
            Crossing { rest: 3534213340, time: 760753955, stages: 1, distance: 0.24673759728944722 },
            Crossing { rest: 2773459385, time: 1521507910, stages: 1, distance: 0.5831219898332685 },
            Crossing { rest: 1521507909, time: 2773459386, stages: 1, distance: 0.5831219898332685 },
            Crossing { rest: 760753954, time: 3534213341, stages: 1, distance: 0.24673759728944722 },
            Crossing { rest: 0, time: 0, stages: 0, distance: 0.0 },
        ],
    },
    tolerance: ChordTolerance {
        residual: 1.4901161193847656e-8,
        growth: 0.001953125,
        fluctuation: 4.440892098500626e-16,
        max_evaluations: 5,
    },
    landing_step: 0.18,
};

/// From stop to stop.
#[allow(dead_code, reason = "a program need not ask")]
pub static SECTIONS: [Section; 3] = [
    Section { pieces: 0..1, stages: 0..5 },
    Section { pieces: 1..2, stages: 5..10 },
    Section { pieces: 2..3, stages: 10..15 },
];
