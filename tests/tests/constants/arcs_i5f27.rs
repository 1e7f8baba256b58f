use nurbs_core::{Piece, Pieces};
use secant_interp::{ChordTolerance, LengthStage, PieceInterpolator, StageShape, StepLengths, Stretch};

/// The number format.
pub type Number = real::FixedPoint<real::fixed::types::I5F27>;

/// T, the interpolation period, in s.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIOD_S: f64 = 0.003;

/// Setpoints from begin to end.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIODS: usize = 135;

/// `secant_interp::PositionChecksum` of all of them.
#[allow(dead_code, reason = "a program need not ask")]
pub const CHECKSUM: u64 = 0xcbac7585b2496f0f;

/// Path and plan.
pub static PATH: PieceInterpolator<'static, Number, 3> = PieceInterpolator {
    pieces: Pieces {
        pieces: &[
            Piece { origin: [0, 0, 0], coordinate_exponent: -3, step_exponent: 4, range_exponent: 2, joint_ratio: 46341, joint_exponent: 1, continues: false, step_per_chord: [i5f27(126322568), i5f27(142606336)] },
            Piece { origin: [0, 0, 549755813888], coordinate_exponent: 0, step_exponent: 7, range_exponent: 2, joint_ratio: 65535, joint_exponent: 0, continues: false, step_per_chord: [i5f27(152484828), i5f27(201675814)] },
            Piece { origin: [2199023255552, 2199023255552, 549755813888], coordinate_exponent: 0, step_exponent: 7, range_exponent: 2, joint_ratio: 32768, joint_exponent: 1, continues: false, step_per_chord: [i5f27(152484828), i5f27(201675814)] },
        ],
        numerators: &[
            [i5f27(0), i5f27(0), i5f27(1073741824)],
            [i5f27(0), i5f27(0), i5f27(0)],
            [i5f27(759250125), i5f27(0), i5f27(0)],
            [i5f27(-222379213), i5f27(536870912), i5f27(0)],
            [i5f27(0), i5f27(0), i5f27(759250125)],
            [i5f27(0), i5f27(536870912), i5f27(-222379213)],
        ],
        weights: &[
            i5f27(134217728),
            i5f27(0),
            i5f27(0),
            i5f27(134217728),
            i5f27(-78622925),
            i5f27(78622925),
            i5f27(134217728),
            i5f27(-78622925),
            i5f27(78622925),
        ],
        degree: 2,
        coordinate_exponent: 0,
        chord_exponent: 4,
    },
    lengths: StepLengths {
        stages: &[
            LengthStage { duration: 36506659433, reciprocal: 17361909031347078081, reciprocal_exponent: 35, period_share: i5f27(15790564), feed: i5f27(0), change: i5f27(252641242), shape: StageShape::Cubic },
            LengthStage { duration: 1125166, reciprocal: 17191075018116497294, reciprocal_exponent: 20, period_share: i5f27(134217727), feed: i5f27(252641242), change: i5f27(0), shape: StageShape::Steady },
            LengthStage { duration: 36506659433, reciprocal: 17361909031347078081, reciprocal_exponent: 35, period_share: i5f27(15790564), feed: i5f27(252641242), change: i5f27(-252641242), shape: StageShape::Cubic },
            LengthStage { duration: 36586877163, reciprocal: 17323842570392886000, reciprocal_exponent: 35, period_share: i5f27(15755943), feed: i5f27(0), change: i5f27(267279288), shape: StageShape::Cubic },
            LengthStage { duration: 180229316138, reciprocal: 14067085504087475998, reciprocal_exponent: 37, period_share: i5f27(3198484), feed: i5f27(267276236), change: i5f27(0), shape: StageShape::Steady },
            LengthStage { duration: 36586877163, reciprocal: 17323842570392886000, reciprocal_exponent: 35, period_share: i5f27(15755943), feed: i5f27(267281686), change: i5f27(-267281686), shape: StageShape::Cubic },
            LengthStage { duration: 36586877163, reciprocal: 17323842570392886000, reciprocal_exponent: 35, period_share: i5f27(15755943), feed: i5f27(0), change: i5f27(267279288), shape: StageShape::Cubic },
            LengthStage { duration: 180229316138, reciprocal: 14067085504087475998, reciprocal_exponent: 37, period_share: i5f27(3198484), feed: i5f27(267276236), change: i5f27(0), shape: StageShape::Steady },
            LengthStage { duration: 36586877163, reciprocal: 17323842570392886000, reciprocal_exponent: 35, period_share: i5f27(15755943), feed: i5f27(267281686), change: i5f27(-267281686), shape: StageShape::Cubic },
        ],
    },
    tolerance: ChordTolerance { residual: i5f27(2), max_evaluations: 5 },
    landing_step: i5f27(96636764),
};

/// From stop to stop.
pub static STRETCHES: [Stretch; 3] = [
    Stretch { pieces: 0..1, stages: 0..3 },
    Stretch { pieces: 1..2, stages: 3..6 },
    Stretch { pieces: 2..3, stages: 6..9 },
];

const fn i5f27(bits: i32) -> real::FixedPoint<real::fixed::types::I5F27> {
    real::FixedPoint(real::fixed::types::I5F27::from_bits(bits))
}
