use nurbs_core::{Joint, Piece, Pieces};
use secant_interp::{ChordTolerance, LengthStage, PieceInterpolator, StageShape, StepLengths, Section};

/// The number format.
pub type Number = real::FixedPoint<real::fixed::types::I16F48>;

/// T, the interpolation period, in s.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIOD_S: f64 = 0.003;

/// Setpoints from begin to end.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIODS: usize = 135;

/// `secant_interp::PositionChecksum` of all of them.
#[allow(dead_code, reason = "a program need not ask")]
pub const CHECKSUM: u64 = 0x5636c2be3efe0192;

/// Path and plan.
pub static PATH: PieceInterpolator<'static, Number, 3> = PieceInterpolator {
    pieces: Pieces {
        pieces: &[
            Piece { origin: [0, 0, 0], coordinate_exponent: -14, step_exponent: 4, range_exponent: 2, joint_ratio: 46341, joint_exponent: 1, joint: Joint::Breaks, step_per_chord: [i16f48(264917625139441), i16f48(299067162755072)] },
            Piece { origin: [0, 0, 549755813888], coordinate_exponent: -11, step_exponent: 7, range_exponent: 2, joint_ratio: 65535, joint_exponent: 0, joint: Joint::Breaks, step_per_chord: [i16f48(319783861761655), i16f48(422944837628665)] },
            Piece { origin: [2199023255552, 2199023255552, 549755813888], coordinate_exponent: -11, step_exponent: 7, range_exponent: 2, joint_ratio: 32768, joint_exponent: 1, joint: Joint::Smooth, step_per_chord: [i16f48(319783861761655), i16f48(422944837628665)] },
        ],
        numerators: &[
            [i16f48(0), i16f48(0), i16f48(4611686018427387904)],
            [i16f48(0), i16f48(0), i16f48(0)],
            [i16f48(3260954456333195776), i16f48(724), i16f48(0)],
            [i16f48(-955111447119501824), i16f48(2305843009213693228), i16f48(0)],
            [i16f48(0), i16f48(724), i16f48(3260954456333195776)],
            [i16f48(0), i16f48(2305843009213693228), i16f48(-955111447119501824)],
        ],
        weights: &[
            i16f48(281474976710656),
            i16f48(0),
            i16f48(0),
            i16f48(281474976710656),
            i16f48(-164884223888451),
            i16f48(164884223888451),
            i16f48(281474976710656),
            i16f48(-164884223888451),
            i16f48(164884223888451),
        ],
        degree: 2,
        coordinate_exponent: -11,
        chord_exponent: 4,
    },
    lengths: StepLengths {
        stages: &[
            LengthStage { duration: 36506659433, reciprocal: 17361909031347078081, reciprocal_exponent: 35, period_share: i16f48(33115213453954), feed: i16f48(0), change: i16f48(529827085544640), shape: StageShape::Cubic },
            LengthStage { duration: 1125166, reciprocal: 17191075018116497294, reciprocal_exponent: 20, period_share: i16f48(281474976710655), feed: i16f48(529827085544640), change: i16f48(0), shape: StageShape::Steady },
            LengthStage { duration: 36506659433, reciprocal: 17361909031347078081, reciprocal_exponent: 35, period_share: i16f48(33115213453954), feed: i16f48(529827085544640), change: i16f48(-529827085544640), shape: StageShape::Cubic },
            LengthStage { duration: 36586877163, reciprocal: 17323842570392886000, reciprocal_exponent: 35, period_share: i16f48(33042607441697), feed: i16f48(0), change: i16f48(560520396821057), shape: StageShape::Cubic },
            LengthStage { duration: 180229316138, reciprocal: 14067085504087475998, reciprocal_exponent: 37, period_share: i16f48(6707709075969), feed: i16f48(560520396821057), change: i16f48(0), shape: StageShape::Steady },
            LengthStage { duration: 36586877163, reciprocal: 17323842570392886000, reciprocal_exponent: 35, period_share: i16f48(33042607441697), feed: i16f48(560520396821057), change: i16f48(-560520396821057), shape: StageShape::Cubic },
            LengthStage { duration: 36586877163, reciprocal: 17323842570392886000, reciprocal_exponent: 35, period_share: i16f48(33042607441697), feed: i16f48(0), change: i16f48(560520396821056), shape: StageShape::Cubic },
            LengthStage { duration: 180229316138, reciprocal: 14067085504087475998, reciprocal_exponent: 37, period_share: i16f48(6707709075969), feed: i16f48(560520396821056), change: i16f48(0), shape: StageShape::Steady },
            LengthStage { duration: 36586877163, reciprocal: 17323842570392886000, reciprocal_exponent: 35, period_share: i16f48(33042607441697), feed: i16f48(560520396821056), change: i16f48(-560520396821056), shape: StageShape::Cubic },
        ],
    },
    tolerance: ChordTolerance { residual: i16f48(2), max_evaluations: 5 },
    landing_step: i16f48(202661983231672),
};

/// From stop to stop.
#[allow(dead_code, reason = "a program need not ask")]
pub static SECTIONS: [Section; 3] = [
    Section { pieces: 0..1, stages: 0..3 },
    Section { pieces: 1..2, stages: 3..6 },
    Section { pieces: 2..3, stages: 6..9 },
];

const fn i16f48(bits: i64) -> real::FixedPoint<real::fixed::types::I16F48> {
    real::FixedPoint(real::fixed::types::I16F48::from_bits(bits))
}
