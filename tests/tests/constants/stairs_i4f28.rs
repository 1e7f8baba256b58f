use nurbs_core::{Joint, Piece, Pieces};
use secant_interp::{ChordTolerance, Crossing, LengthStage, PieceInterpolator, StageShape, StepLengths, Section};

const _: () = assert!(
    matches!(secant_interp::VERSION, [0, 1]),
    "these constants are for secant-interp 0.1: take that version, or run `feedbits compile` again"
);
const _: () = secant_interp::TablesOf::<1>::ARE_READ;

/// The number format.
pub type Number = real::FixedPoint<real::fixed::types::I4F28>;

/// T, the interpolation period, in s.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIOD_S: f64 = 0.003;

/// Setpoints from begin to end.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIODS: usize = 97;

/// Path and plan.
pub static PATH: PieceInterpolator<'static, Number, 2> = PieceInterpolator {
    pieces: Pieces {
        pieces: &[
            Piece { origin: [0, 0], coordinate_exponent: 0, step_exponent: 6, range_exponent: 3, joint_ratio: 32768, joint_exponent: 1, joint: Joint::Breaks, step_per_chord: [i4f28(336860180), i4f28(380283563)] },
            Piece { origin: [3298534883328, 0], coordinate_exponent: 0, step_exponent: 6, range_exponent: 3, joint_ratio: 54529, joint_exponent: 0, joint: Joint::Breaks, step_per_chord: [i4f28(336860180), i4f28(380283563)] },
            Piece { origin: [3298534883328, 3298534883328], coordinate_exponent: 0, step_exponent: 6, range_exponent: 3, joint_ratio: 32768, joint_exponent: 1, joint: Joint::Smooth, step_per_chord: [i4f28(280284612), i4f28(316415050)] },
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
            LengthStage { duration: 17992430564, reciprocal: 17613665309407907429, reciprocal_exponent: 34, period_share: i4f28(64078141), feed: i4f28(0), change: i4f28(200244191), shape: StageShape::Onset },
            LengthStage { duration: 10795458339, reciprocal: 14678054423690798996, reciprocal_exponent: 33, period_share: i4f28(106796901), feed: i4f28(200244191), change: i4f28(240293029), shape: StageShape::Steady },
            LengthStage { duration: 17992430564, reciprocal: 17613665309407907429, reciprocal_exponent: 34, period_share: i4f28(64078141), feed: i4f28(440537220), change: i4f28(200244191), shape: StageShape::Easing },
            LengthStage { duration: 39583347242, reciprocal: 16012423008067214043, reciprocal_exponent: 35, period_share: i4f28(29126427), feed: i4f28(640781411), change: i4f28(0), shape: StageShape::Steady },
            LengthStage { duration: 17992430564, reciprocal: 17613665309407907429, reciprocal_exponent: 34, period_share: i4f28(64078141), feed: i4f28(640781411), change: i4f28(-200244191), shape: StageShape::Onset },
            LengthStage { duration: 10795458339, reciprocal: 14678054423690798996, reciprocal_exponent: 33, period_share: i4f28(106796901), feed: i4f28(440537220), change: i4f28(-240293029), shape: StageShape::Steady },
            LengthStage { duration: 17992430564, reciprocal: 17613665309407907429, reciprocal_exponent: 34, period_share: i4f28(64078141), feed: i4f28(200244191), change: i4f28(-200244191), shape: StageShape::Easing },
            LengthStage { duration: 17992430564, reciprocal: 17613665309407907429, reciprocal_exponent: 34, period_share: i4f28(64078141), feed: i4f28(0), change: i4f28(200244191), shape: StageShape::Onset },
            LengthStage { duration: 10795458339, reciprocal: 14678054423690798996, reciprocal_exponent: 33, period_share: i4f28(106796901), feed: i4f28(200244191), change: i4f28(240293029), shape: StageShape::Steady },
            LengthStage { duration: 17992430564, reciprocal: 17613665309407907429, reciprocal_exponent: 34, period_share: i4f28(64078141), feed: i4f28(440537220), change: i4f28(200244191), shape: StageShape::Easing },
            LengthStage { duration: 39583347242, reciprocal: 16012423008067214043, reciprocal_exponent: 35, period_share: i4f28(29126427), feed: i4f28(640781411), change: i4f28(0), shape: StageShape::Steady },
            LengthStage { duration: 17992430564, reciprocal: 17613665309407907429, reciprocal_exponent: 34, period_share: i4f28(64078141), feed: i4f28(640781411), change: i4f28(-200244191), shape: StageShape::Onset },
            LengthStage { duration: 10795458339, reciprocal: 14678054423690798996, reciprocal_exponent: 33, period_share: i4f28(106796901), feed: i4f28(440537220), change: i4f28(-240293029), shape: StageShape::Steady },
            LengthStage { duration: 17992430564, reciprocal: 17613665309407907429, reciprocal_exponent: 34, period_share: i4f28(64078141), feed: i4f28(200244191), change: i4f28(-200244191), shape: StageShape::Easing },
            LengthStage { duration: 17962238520, reciprocal: 17643271449947172306, reciprocal_exponent: 34, period_share: i4f28(64185847), feed: i4f28(0), change: i4f28(200580774), shape: StageShape::Onset },
            LengthStage { duration: 10777343112, reciprocal: 14702726208289310255, reciprocal_exponent: 33, period_share: i4f28(106976412), feed: i4f28(200580774), change: i4f28(240696928), shape: StageShape::Steady },
            LengthStage { duration: 17962238520, reciprocal: 17643271449947172306, reciprocal_exponent: 34, period_share: i4f28(64185847), feed: i4f28(441277702), change: i4f28(200580774), shape: StageShape::Easing },
            LengthStage { duration: 56920215056, reciprocal: 11135328626052032615, reciprocal_exponent: 35, period_share: i4f28(20255044), feed: i4f28(641858476), change: i4f28(0), shape: StageShape::Steady },
            LengthStage { duration: 17962238520, reciprocal: 17643271449947172306, reciprocal_exponent: 34, period_share: i4f28(64185847), feed: i4f28(641858476), change: i4f28(-200580774), shape: StageShape::Onset },
            LengthStage { duration: 10777343112, reciprocal: 14702726208289310255, reciprocal_exponent: 33, period_share: i4f28(106976412), feed: i4f28(441277702), change: i4f28(-240696928), shape: StageShape::Steady },
            LengthStage { duration: 17962238520, reciprocal: 17643271449947172306, reciprocal_exponent: 34, period_share: i4f28(64185847), feed: i4f28(200580774), change: i4f28(-200580774), shape: StageShape::Easing },
        ],
        crossings: &[
            Crossing { rest: 812561379, time: 3482405916, stages: 1, distance: i4f28(229983599) },
            Crossing { rest: 3018085126, time: 1276882169, stages: 1, distance: i4f28(421058806) },
            Crossing { rest: 3830646506, time: 464320789, stages: 1, distance: i4f28(638082953) },
            Crossing { rest: 464320788, time: 3830646507, stages: 1, distance: i4f28(638082953) },
            Crossing { rest: 1276882168, time: 3018085127, stages: 1, distance: i4f28(421058807) },
            Crossing { rest: 3482405915, time: 812561380, stages: 1, distance: i4f28(229983601) },
            Crossing { rest: 0, time: 0, stages: 0, distance: i4f28(0) },
            Crossing { rest: 812561379, time: 3482405916, stages: 1, distance: i4f28(229983599) },
            Crossing { rest: 3018085126, time: 1276882169, stages: 1, distance: i4f28(421058806) },
            Crossing { rest: 3830646506, time: 464320789, stages: 1, distance: i4f28(638082953) },
            Crossing { rest: 464320788, time: 3830646507, stages: 1, distance: i4f28(638082953) },
            Crossing { rest: 1276882168, time: 3018085127, stages: 1, distance: i4f28(421058807) },
            Crossing { rest: 3482405915, time: 812561380, stages: 1, distance: i4f28(229983601) },
            Crossing { rest: 0, time: 0, stages: 0, distance: i4f28(0) },
            Crossing { rest: 782369335, time: 3512597960, stages: 1, distance: i4f28(231091803) },
            Crossing { rest: 2969777855, time: 1325189440, stages: 1, distance: i4f28(422800622) },
            Crossing { rest: 3752147191, time: 542820104, stages: 1, distance: i4f28(639309726) },
            Crossing { rest: 542820103, time: 3752147192, stages: 1, distance: i4f28(639309726) },
            Crossing { rest: 1325189439, time: 2969777856, stages: 1, distance: i4f28(422800623) },
            Crossing { rest: 3512597959, time: 782369336, stages: 1, distance: i4f28(231091804) },
            Crossing { rest: 0, time: 0, stages: 0, distance: i4f28(0) },
        ],
    },
    tolerance: ChordTolerance {
        residual: i4f28(16384),
        growth: i4f28(8388608),
        fluctuation: i4f28(2),
        max_evaluations: 5,
    },
    landing_step: i4f28(96636764),
};

/// From stop to stop.
#[allow(dead_code, reason = "a program need not ask")]
pub static SECTIONS: [Section; 3] = [
    Section { pieces: 0..1, stages: 0..7 },
    Section { pieces: 1..2, stages: 7..14 },
    Section { pieces: 2..3, stages: 14..21 },
];

const fn i4f28(bits: i32) -> real::FixedPoint<real::fixed::types::I4F28> {
    real::FixedPoint(real::fixed::types::I4F28::from_bits(bits))
}
