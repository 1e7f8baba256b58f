use nurbs_core::{Joint, Piece, Pieces};
use secant_interp::{ChordTolerance, Crossing, LengthStage, PieceInterpolator, StageShape, StepLengths, Section};

const _: () = assert!(
    matches!(secant_interp::VERSION, [0, 1]),
    "these constants are for secant-interp 0.1: take that version, or run `feedbits compile` again"
);
const _: () = secant_interp::TablesOf::<1>::ARE_READ;

/// The number format.
pub type Number = real::FixedPoint<real::fixed::types::I16F48>;

/// T, the interpolation period, in s.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIOD_S: f64 = 0.003;

/// Setpoints from begin to end.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIODS: usize = 129;

/// Path and plan.
pub static PATH: PieceInterpolator<'static, Number, 3> = PieceInterpolator {
    pieces: Pieces {
        pieces: &[
            Piece { origin: [0, 0, 0], coordinate_exponent: -14, step_exponent: 4, range_exponent: 3, joint_ratio: 46341, joint_exponent: 1, joint: Joint::Breaks, step_per_chord: [i16f48(264917625139441), i16f48(299067162755072)] },
            Piece { origin: [0, 0, 549755813888], coordinate_exponent: -11, step_exponent: 7, range_exponent: 4, joint_ratio: 65535, joint_exponent: 0, joint: Joint::Breaks, step_per_chord: [i16f48(319783861761655), i16f48(422944837628665)] },
            Piece { origin: [2199023255552, 2199023255552, 549755813888], coordinate_exponent: -11, step_exponent: 7, range_exponent: 4, joint_ratio: 32768, joint_exponent: 1, joint: Joint::Smooth, step_per_chord: [i16f48(319783861761655), i16f48(422944837628665)] },
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
            LengthStage { duration: 16106081065, reciprocal: 9838291784887938237, reciprocal_exponent: 33, period_share: i16f48(75060209540465), feed: i16f48(0), change: i16f48(300239112166202), shape: StageShape::Onset },
            LengthStage { duration: 16106081066, reciprocal: 9838291784277094932, reciprocal_exponent: 33, period_share: i16f48(75060209535805), feed: i16f48(300239112166202), change: i16f48(300239112166202), shape: StageShape::Easing },
            LengthStage { duration: 185178, reciprocal: 13056905459769834156, reciprocal_exponent: 17, period_share: i16f48(281474976710655), feed: i16f48(600478224332404), change: i16f48(0), shape: StageShape::Steady },
            LengthStage { duration: 16106081066, reciprocal: 9838291784277094932, reciprocal_exponent: 33, period_share: i16f48(75060209535805), feed: i16f48(600478224332404), change: i16f48(-300239112166202), shape: StageShape::Onset },
            LengthStage { duration: 16106081065, reciprocal: 9838291784887938237, reciprocal_exponent: 33, period_share: i16f48(75060209540465), feed: i16f48(300239112166202), change: i16f48(-300239112166202), shape: StageShape::Easing },
            LengthStage { duration: 14822934973, reciprocal: 10689942667707652176, reciprocal_exponent: 33, period_share: i16f48(81557790128384), feed: i16f48(0), change: i16f48(282407607636837), shape: StageShape::Onset },
            LengthStage { duration: 14822934973, reciprocal: 10689942667707652176, reciprocal_exponent: 33, period_share: i16f48(81557790128384), feed: i16f48(282407607636837), change: i16f48(282407607636838), shape: StageShape::Easing },
            LengthStage { duration: 185521395980, reciprocal: 13665815670823084558, reciprocal_exponent: 37, period_share: i16f48(6516368709003), feed: i16f48(564815215273675), change: i16f48(0), shape: StageShape::Steady },
            LengthStage { duration: 14822934973, reciprocal: 10689942667707652176, reciprocal_exponent: 33, period_share: i16f48(81557790128384), feed: i16f48(564815215273675), change: i16f48(-282407607636838), shape: StageShape::Onset },
            LengthStage { duration: 14822934973, reciprocal: 10689942667707652176, reciprocal_exponent: 33, period_share: i16f48(81557790128384), feed: i16f48(282407607636837), change: i16f48(-282407607636837), shape: StageShape::Easing },
            LengthStage { duration: 14822934973, reciprocal: 10689942667707652176, reciprocal_exponent: 33, period_share: i16f48(81557790128384), feed: i16f48(0), change: i16f48(282407607636837), shape: StageShape::Onset },
            LengthStage { duration: 14822934973, reciprocal: 10689942667707652176, reciprocal_exponent: 33, period_share: i16f48(81557790128384), feed: i16f48(282407607636837), change: i16f48(282407607636836), shape: StageShape::Easing },
            LengthStage { duration: 185521395980, reciprocal: 13665815670823084558, reciprocal_exponent: 37, period_share: i16f48(6516368709003), feed: i16f48(564815215273673), change: i16f48(0), shape: StageShape::Steady },
            LengthStage { duration: 14822934973, reciprocal: 10689942667707652176, reciprocal_exponent: 33, period_share: i16f48(81557790128384), feed: i16f48(564815215273673), change: i16f48(-282407607636836), shape: StageShape::Onset },
            LengthStage { duration: 14822934973, reciprocal: 10689942667707652176, reciprocal_exponent: 33, period_share: i16f48(81557790128384), feed: i16f48(282407607636837), change: i16f48(-282407607636837), shape: StageShape::Easing },
        ],
        crossings: &[
            Crossing { rest: 3221179176, time: 1073788119, stages: 1, distance: i16f48(263099905718146) },
            Crossing { rest: 2147391058, time: 2147391059, stages: 2, distance: i16f48(598699249487630) },
            Crossing { rest: 0, time: 0, stages: 0, distance: i16f48(0) },
            Crossing { rest: 1073788118, time: 3221179177, stages: 1, distance: i16f48(263099905718146) },
            Crossing { rest: 0, time: 0, stages: 0, distance: i16f48(0) },
            Crossing { rest: 1938033084, time: 2356934211, stages: 1, distance: i16f48(289808586564649) },
            Crossing { rest: 3876066169, time: 418901126, stages: 1, distance: i16f48(559006228115026) },
            Crossing { rest: 418901125, time: 3876066170, stages: 1, distance: i16f48(559006228115026) },
            Crossing { rest: 2356934210, time: 1938033085, stages: 1, distance: i16f48(289808586564650) },
            Crossing { rest: 0, time: 0, stages: 0, distance: i16f48(0) },
            Crossing { rest: 1938033084, time: 2356934211, stages: 1, distance: i16f48(289808586564649) },
            Crossing { rest: 3876066169, time: 418901126, stages: 1, distance: i16f48(559006228115024) },
            Crossing { rest: 418901125, time: 3876066170, stages: 1, distance: i16f48(559006228115024) },
            Crossing { rest: 2356934210, time: 1938033085, stages: 1, distance: i16f48(289808586564649) },
            Crossing { rest: 0, time: 0, stages: 0, distance: i16f48(0) },
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
    Section { pieces: 0..1, stages: 0..5 },
    Section { pieces: 1..2, stages: 5..10 },
    Section { pieces: 2..3, stages: 10..15 },
];

const fn i16f48(bits: i64) -> real::FixedPoint<real::fixed::types::I16F48> {
    real::FixedPoint(real::fixed::types::I16F48::from_bits(bits))
}
