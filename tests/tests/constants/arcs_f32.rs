use nurbs_core::{Joint, Piece, Pieces};
use secant_interp::{ChordTolerance, LengthStage, PieceInterpolator, StageShape, StepLengths, Section};

/// The number format.
pub type Number = f32;

/// T, the interpolation period, in s.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIOD_S: f64 = 0.003;

/// Setpoints from begin to end.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIODS: usize = 135;

/// `secant_interp::PositionChecksum` of all of them.
#[allow(dead_code, reason = "a program need not ask")]
pub const CHECKSUM: u64 = 0x76f9fd937441eee8;

/// Path and plan.
pub static PATH: PieceInterpolator<'static, Number, 3> = PieceInterpolator {
    pieces: Pieces {
        pieces: &[
            Piece { origin: [0, 0, 0], coordinate_exponent: -2, step_exponent: 0, range_exponent: 0, joint_ratio: 46341, joint_exponent: -2, joint: Joint::Breaks, step_per_chord: [0.23529412, 0.265625] },
            Piece { origin: [0, 0, 549755813888], coordinate_exponent: -2, step_exponent: 0, range_exponent: 0, joint_ratio: 65535, joint_exponent: 0, joint: Joint::Breaks, step_per_chord: [0.03550314, 0.04695631] },
            Piece { origin: [2199023255552, 2199023255552, 549755813888], coordinate_exponent: -2, step_exponent: 0, range_exponent: 0, joint_ratio: 32768, joint_exponent: 1, joint: Joint::Smooth, step_per_chord: [0.03550314, 0.04695631] },
        ],
        numerators: &[
            [0.0, 0.0, 4.0],
            [0.0, 0.0, 0.0],
            [22.627417, 5.0242958e-15, 0.0],
            [-6.627417, 16.0, 0.0],
            [0.0, 5.0242958e-15, 22.627417],
            [0.0, 16.0, -6.627417],
        ],
        weights: &[
            1.0,
            0.0,
            0.0,
            1.0,
            -0.58578646,
            0.58578646,
            1.0,
            -0.58578646,
            0.58578646,
        ],
        degree: 2,
        coordinate_exponent: -2,
        chord_exponent: 2,
    },
    lengths: StepLengths {
        stages: &[
            LengthStage { duration: 36506659433, reciprocal: 17361909031347078081, reciprocal_exponent: 35, period_share: 0.11764887, feed: 0.0, change: 0.470581, shape: StageShape::Cubic },
            LengthStage { duration: 1125166, reciprocal: 17191075018116497294, reciprocal_exponent: 20, period_share: 0.99999994, feed: 0.470581, change: 0.0, shape: StageShape::Steady },
            LengthStage { duration: 36506659433, reciprocal: 17361909031347078081, reciprocal_exponent: 35, period_share: 0.11764887, feed: 0.470581, change: -0.470581, shape: StageShape::Cubic },
            LengthStage { duration: 36586877163, reciprocal: 17323842570392886000, reciprocal_exponent: 35, period_share: 0.11739092, feed: 0.0, change: 0.49784213, shape: StageShape::Cubic },
            LengthStage { duration: 180229316138, reciprocal: 14067085504087475998, reciprocal_exponent: 37, period_share: 0.023830568, feed: 0.49784213, change: 0.0, shape: StageShape::Steady },
            LengthStage { duration: 36586877163, reciprocal: 17323842570392886000, reciprocal_exponent: 35, period_share: 0.11739092, feed: 0.49784213, change: -0.49784213, shape: StageShape::Cubic },
            LengthStage { duration: 36586877163, reciprocal: 17323842570392886000, reciprocal_exponent: 35, period_share: 0.11739092, feed: 0.0, change: 0.49784213, shape: StageShape::Cubic },
            LengthStage { duration: 180229316138, reciprocal: 14067085504087475998, reciprocal_exponent: 37, period_share: 0.023830568, feed: 0.49784213, change: 0.0, shape: StageShape::Steady },
            LengthStage { duration: 36586877163, reciprocal: 17323842570392886000, reciprocal_exponent: 35, period_share: 0.11739092, feed: 0.49784213, change: -0.49784213, shape: StageShape::Cubic },
        ],
    },
    tolerance: ChordTolerance { residual: 2.3841858e-7, max_evaluations: 5 },
    landing_step: 0.18,
};

/// From stop to stop.
#[allow(dead_code, reason = "a program need not ask")]
pub static SECTIONS: [Section; 3] = [
    Section { pieces: 0..1, stages: 0..3 },
    Section { pieces: 1..2, stages: 3..6 },
    Section { pieces: 2..3, stages: 6..9 },
];
