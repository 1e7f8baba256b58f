use nurbs_core::{Joint, Piece, Pieces};
use secant_interp::{ChordTolerance, LengthStage, PieceInterpolator, StageShape, StepLengths, Section};

/// The number format.
pub type Number = f64;

/// T, the interpolation period, in s.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIOD_S: f64 = 0.003;

/// Setpoints from begin to end.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIODS: usize = 108;

/// `secant_interp::PositionChecksum` of all of them.
#[allow(dead_code, reason = "a program need not ask")]
pub const CHECKSUM: u64 = 0x37f66570912746b9;

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
            LengthStage { duration: 39431637335, reciprocal: 16074029458358901817, reciprocal_exponent: 35, period_share: 0.10892186037092948, feed: 0.0, change: 0.5965895993069906, shape: StageShape::Cubic },
            LengthStage { duration: 75755547986, reciprocal: 16733435819941497921, reciprocal_exponent: 36, period_share: 0.0566950858410229, feed: 0.5965895993069906, change: 0.0, shape: StageShape::Steady },
            LengthStage { duration: 39431637335, reciprocal: 16074029458358901817, reciprocal_exponent: 35, period_share: 0.10892186037092948, feed: 0.5965895993069906, change: -0.5965895993069906, shape: StageShape::Cubic },
            LengthStage { duration: 39431637335, reciprocal: 16074029458358901817, reciprocal_exponent: 35, period_share: 0.10892186037092948, feed: 0.0, change: 0.5965895993069916, shape: StageShape::Cubic },
            LengthStage { duration: 75755547986, reciprocal: 16733435819941497921, reciprocal_exponent: 36, period_share: 0.0566950858410229, feed: 0.5965895993069916, change: 0.0, shape: StageShape::Steady },
            LengthStage { duration: 39431637335, reciprocal: 16074029458358901817, reciprocal_exponent: 35, period_share: 0.10892186037092948, feed: 0.5965895993069916, change: -0.5965895993069916, shape: StageShape::Cubic },
            LengthStage { duration: 39431637335, reciprocal: 16074029458358901817, reciprocal_exponent: 35, period_share: 0.10892186037092948, feed: 0.0, change: 0.5965895993069916, shape: StageShape::Cubic },
            LengthStage { duration: 75755547986, reciprocal: 16733435819941497921, reciprocal_exponent: 36, period_share: 0.0566950858410229, feed: 0.5965895993069916, change: 0.0, shape: StageShape::Steady },
            LengthStage { duration: 39431637335, reciprocal: 16074029458358901817, reciprocal_exponent: 35, period_share: 0.10892186037092948, feed: 0.5965895993069916, change: -0.5965895993069916, shape: StageShape::Cubic },
        ],
    },
    tolerance: ChordTolerance { residual: 4.440892098500626e-16, max_evaluations: 5 },
    landing_step: 0.18,
};

/// From stop to stop.
#[allow(dead_code, reason = "a program need not ask")]
pub static SECTIONS: [Section; 3] = [
    Section { pieces: 0..1, stages: 0..3 },
    Section { pieces: 1..2, stages: 3..6 },
    Section { pieces: 2..3, stages: 6..9 },
];
