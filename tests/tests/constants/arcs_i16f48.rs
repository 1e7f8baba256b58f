use nurbs_core::{Joint, Piece, Pieces};
use secant_interp::{ChordTolerance, LengthStage, PieceInterpolator, StageShape, StepLengths, Section};

/// The number format.
pub type Number = real::FixedPoint<real::fixed::types::I16F48>;

/// T, the interpolation period, in s.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIOD_S: f64 = 0.003;

/// Setpoints from begin to end.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIODS: usize = 129;

/// `secant_interp::PositionChecksum` of all of them.
#[allow(dead_code, reason = "a program need not ask")]
pub const CHECKSUM: u64 = 0x2b3640a8f8bfffea;

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
            LengthStage { duration: 16106127360, reciprocal: 9838263505978427528, reciprocal_exponent: 33, period_share: i16f48(75059993789508), feed: i16f48(0), change: i16f48(300239975158033), shape: StageShape::Onset },
            LengthStage { duration: 16106127360, reciprocal: 9838263505978427528, reciprocal_exponent: 33, period_share: i16f48(75059993789508), feed: i16f48(300239975158033), change: i16f48(300239975158033), shape: StageShape::Easing },
            LengthStage { duration: 16106127360, reciprocal: 9838263505978427528, reciprocal_exponent: 33, period_share: i16f48(75059993789508), feed: i16f48(600479950316066), change: i16f48(-300239975158033), shape: StageShape::Onset },
            LengthStage { duration: 16106127360, reciprocal: 9838263505978427528, reciprocal_exponent: 33, period_share: i16f48(75059993789508), feed: i16f48(300239975158033), change: i16f48(-300239975158033), shape: StageShape::Easing },
            LengthStage { duration: 14823531364, reciprocal: 10689512582227951980, reciprocal_exponent: 33, period_share: i16f48(81554508836578), feed: i16f48(0), change: i16f48(282409173078591), shape: StageShape::Onset },
            LengthStage { duration: 14823531365, reciprocal: 10689512581506834163, reciprocal_exponent: 33, period_share: i16f48(81554508831076), feed: i16f48(282409173078591), change: i16f48(282409173078591), shape: StageShape::Easing },
            LengthStage { duration: 185519010414, reciprocal: 13665991397855876679, reciprocal_exponent: 37, period_share: i16f48(6516452502181), feed: i16f48(564818346157182), change: i16f48(0), shape: StageShape::Steady },
            LengthStage { duration: 14823531365, reciprocal: 10689512581506834163, reciprocal_exponent: 33, period_share: i16f48(81554508831076), feed: i16f48(564818346157182), change: i16f48(-282409173078591), shape: StageShape::Onset },
            LengthStage { duration: 14823531364, reciprocal: 10689512582227951980, reciprocal_exponent: 33, period_share: i16f48(81554508836578), feed: i16f48(282409173078591), change: i16f48(-282409173078591), shape: StageShape::Easing },
            LengthStage { duration: 14823531364, reciprocal: 10689512582227951980, reciprocal_exponent: 33, period_share: i16f48(81554508836578), feed: i16f48(0), change: i16f48(282409173078591), shape: StageShape::Onset },
            LengthStage { duration: 14823531365, reciprocal: 10689512581506834163, reciprocal_exponent: 33, period_share: i16f48(81554508831076), feed: i16f48(282409173078591), change: i16f48(282409173078591), shape: StageShape::Easing },
            LengthStage { duration: 92759505207, reciprocal: 13665991397855876679, reciprocal_exponent: 36, period_share: i16f48(13032905004363), feed: i16f48(564818346157182), change: i16f48(1), shape: StageShape::Onset },
            LengthStage { duration: 92759505207, reciprocal: 13665991397855876679, reciprocal_exponent: 36, period_share: i16f48(13032905004363), feed: i16f48(564818346157183), change: i16f48(0), shape: StageShape::Easing },
            LengthStage { duration: 14823531365, reciprocal: 10689512581506834163, reciprocal_exponent: 33, period_share: i16f48(81554508831076), feed: i16f48(564818346157183), change: i16f48(-282409173078592), shape: StageShape::Onset },
            LengthStage { duration: 14823531364, reciprocal: 10689512582227951980, reciprocal_exponent: 33, period_share: i16f48(81554508836578), feed: i16f48(282409173078591), change: i16f48(-282409173078591), shape: StageShape::Easing },
        ],
    },
    tolerance: ChordTolerance {
        residual: i16f48(16777216),
        growth: i16f48(1099511627776),
        fluctuation: i16f48(2),
        max_evaluations: 5,
    },
    landing_step: i16f48(202661983231672),
};

/// From stop to stop.
#[allow(dead_code, reason = "a program need not ask")]
pub static SECTIONS: [Section; 3] = [
    Section { pieces: 0..1, stages: 0..4 },
    Section { pieces: 1..2, stages: 4..9 },
    Section { pieces: 2..3, stages: 9..15 },
];

const fn i16f48(bits: i64) -> real::FixedPoint<real::fixed::types::I16F48> {
    real::FixedPoint(real::fixed::types::I16F48::from_bits(bits))
}
