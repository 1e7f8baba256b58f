use nurbs_core::{Joint, Piece, Pieces};
use secant_interp::{ChordTolerance, LengthStage, PieceInterpolator, StageShape, StepLengths, Section};

/// The number format.
pub type Number = real::FixedPoint<real::fixed::types::I4F28>;

/// T, the interpolation period, in s.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIOD_S: f64 = 0.003;

/// Setpoints from begin to end.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIODS: usize = 103;

/// `secant_interp::PositionChecksum` of all of them.
#[allow(dead_code, reason = "a program need not ask")]
pub const CHECKSUM: u64 = 0x4a958277ef808db1;

/// Path and plan.
pub static PATH: PieceInterpolator<'static, Number, 2> = PieceInterpolator {
    pieces: Pieces {
        pieces: &[
            Piece { origin: [0, 0], coordinate_exponent: 0, step_exponent: 6, range_exponent: 1, joint_ratio: 32768, joint_exponent: 1, joint: Joint::Breaks, step_per_chord: [i4f28(336860180), i4f28(380283563)] },
            Piece { origin: [3298534883328, 0], coordinate_exponent: 0, step_exponent: 6, range_exponent: 1, joint_ratio: 54529, joint_exponent: 0, joint: Joint::Breaks, step_per_chord: [i4f28(336860180), i4f28(380283563)] },
            Piece { origin: [3298534883328, 3298534883328], coordinate_exponent: 0, step_exponent: 6, range_exponent: 1, joint_ratio: 32768, joint_exponent: 1, joint: Joint::Smooth, step_per_chord: [i4f28(280284612), i4f28(316415050)] },
        ],
        numerators: &[
            [i4f28(1610612736), i4f28(0)],
            [i4f28(0), i4f28(1610612736)],
            [i4f28(1610612736), i4f28(1073741824)],
        ],
        weights: &[],
        degree: 1,
        coordinate_exponent: 0,
        chord_exponent: 3,
    },
    lengths: StepLengths {
        stages: &[
            LengthStage { duration: 55599517945, reciprocal: 11399834450743000965, reciprocal_exponent: 35, period_share: i4f28(20736178), feed: i4f28(0), change: i4f28(642486979), shape: StageShape::Cubic },
            LengthStage { duration: 30534884878, reciprocal: 10378707872102996646, reciprocal_exponent: 34, period_share: i4f28(37757519), feed: i4f28(642486979), change: i4f28(0), shape: StageShape::Steady },
            LengthStage { duration: 55599517945, reciprocal: 11399834450743000965, reciprocal_exponent: 35, period_share: i4f28(20736178), feed: i4f28(642486979), change: i4f28(-642486979), shape: StageShape::Cubic },
            LengthStage { duration: 55599517945, reciprocal: 11399834450743000965, reciprocal_exponent: 35, period_share: i4f28(20736178), feed: i4f28(0), change: i4f28(642486979), shape: StageShape::Cubic },
            LengthStage { duration: 30534884878, reciprocal: 10378707872102996646, reciprocal_exponent: 34, period_share: i4f28(37757519), feed: i4f28(642486979), change: i4f28(0), shape: StageShape::Steady },
            LengthStage { duration: 55599517945, reciprocal: 11399834450743000965, reciprocal_exponent: 35, period_share: i4f28(20736178), feed: i4f28(642486979), change: i4f28(-642486979), shape: StageShape::Cubic },
            LengthStage { duration: 55527399163, reciprocal: 11414640513839452429, reciprocal_exponent: 35, period_share: i4f28(20763110), feed: i4f28(0), change: i4f28(643321438), shape: StageShape::Cubic },
            LengthStage { duration: 47858991626, reciprocal: 13243599135293546870, reciprocal_exponent: 35, period_share: i4f28(24089966), feed: i4f28(643321438), change: i4f28(0), shape: StageShape::Steady },
            LengthStage { duration: 55527399163, reciprocal: 11414640513839452429, reciprocal_exponent: 35, period_share: i4f28(20763110), feed: i4f28(643321438), change: i4f28(-643321438), shape: StageShape::Cubic },
        ],
    },
    tolerance: ChordTolerance { residual: i4f28(2), max_evaluations: 5 },
    landing_step: i4f28(96636764),
};

/// From stop to stop.
#[allow(dead_code, reason = "a program need not ask")]
pub static SECTIONS: [Section; 3] = [
    Section { pieces: 0..1, stages: 0..3 },
    Section { pieces: 1..2, stages: 3..6 },
    Section { pieces: 2..3, stages: 6..9 },
];

const fn i4f28(bits: i32) -> real::FixedPoint<real::fixed::types::I4F28> {
    real::FixedPoint(real::fixed::types::I4F28::from_bits(bits))
}
