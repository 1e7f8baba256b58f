use nurbs_core::{Joint, Piece, Pieces};
use secant_interp::{ChordTolerance, Crossing, LengthStage, PieceInterpolator, StageShape, StepLengths, Section};

const _: () = assert!(
    matches!(secant_interp::VERSION, [0, 1]),
    "these constants are for secant-interp 0.1: take that version, or run `feedbits compile` again"
);
const _: () = secant_interp::TablesOf::<1>::ARE_READ;

/// The number format.
pub type Number = real::FixedPoint<real::fixed::types::I28F36>;

/// T, the interpolation period, in s.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIOD_S: f64 = 0.003;

/// Setpoints from begin to end.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIODS: usize = 2;

/// Path and plan.
pub static PATH: PieceInterpolator<'static, Number, 2> = PieceInterpolator {
    pieces: Pieces {
        pieces: &[
            Piece { origin: [0, 0], coordinate_exponent: -44, step_exponent: -14, range_exponent: -14, joint_ratio: 54613, joint_exponent: 1, joint: Joint::Breaks, step_per_chord: [i28f36(49344752941), i28f36(55705600000)] },
            Piece { origin: [2748779, 0], coordinate_exponent: -45, step_exponent: -14, range_exponent: -14, joint_ratio: 32768, joint_exponent: 1, joint: Joint::Smooth, step_per_chord: [i28f36(82241254902), i28f36(92842666667)] },
        ],
        numerators: &[
            [i28f36(6044629098073146368), i28f36(0)],
            [i28f36(0), i28f36(7253554917687775232)],
        ],
        weights: &[],
        degree: 1,
        coordinate_exponent: -44,
        chord_exponent: 4,
    },
    lengths: StepLengths {
        stages: &[
            LengthStage { duration: 1073735269, reciprocal: 9223428344219772666, reciprocal_exponent: 29, period_share: i28f36(68719476735), feed: i28f36(0), change: i28f36(5497525), shape: StageShape::Onset },
            LengthStage { duration: 1073735270, reciprocal: 9223428335629733201, reciprocal_exponent: 29, period_share: i28f36(68719476735), feed: i28f36(5497525), change: i28f36(5497524), shape: StageShape::Easing },
            LengthStage { duration: 26218, reciprocal: 11527631966727335940, reciprocal_exponent: 14, period_share: i28f36(68719476735), feed: i28f36(10995049), change: i28f36(0), shape: StageShape::Steady },
            LengthStage { duration: 1073735270, reciprocal: 9223428335629733201, reciprocal_exponent: 29, period_share: i28f36(68719476735), feed: i28f36(10995049), change: i28f36(-5497524), shape: StageShape::Onset },
            LengthStage { duration: 1073735269, reciprocal: 9223428344219772666, reciprocal_exponent: 29, period_share: i28f36(68719476735), feed: i28f36(5497525), change: i28f36(-5497525), shape: StageShape::Easing },
            LengthStage { duration: 1073736905, reciprocal: 9223414290936607230, reciprocal_exponent: 29, period_share: i28f36(68719476735), feed: i28f36(0), change: i28f36(3298520), shape: StageShape::Onset },
            LengthStage { duration: 1073736904, reciprocal: 9223414299526620535, reciprocal_exponent: 29, period_share: i28f36(68719476735), feed: i28f36(3298520), change: i28f36(3298520), shape: StageShape::Easing },
            LengthStage { duration: 19678, reciprocal: 15358850233949450842, reciprocal_exponent: 14, period_share: i28f36(68719476735), feed: i28f36(6597040), change: i28f36(0), shape: StageShape::Steady },
            LengthStage { duration: 1073736904, reciprocal: 9223414299526620535, reciprocal_exponent: 29, period_share: i28f36(68719476735), feed: i28f36(6597040), change: i28f36(-3298520), shape: StageShape::Onset },
            LengthStage { duration: 1073736905, reciprocal: 9223414290936607230, reciprocal_exponent: 29, period_share: i28f36(68719476735), feed: i28f36(3298520), change: i28f36(-3298520), shape: StageShape::Easing },
        ],
        crossings: &[
            Crossing { rest: 0, time: 0, stages: 0, distance: i28f36(0) },
            Crossing { rest: 0, time: 0, stages: 0, distance: i28f36(0) },
            Crossing { rest: 0, time: 0, stages: 0, distance: i28f36(0) },
            Crossing { rest: 0, time: 0, stages: 0, distance: i28f36(0) },
            Crossing { rest: 0, time: 0, stages: 0, distance: i28f36(0) },
            Crossing { rest: 0, time: 0, stages: 0, distance: i28f36(0) },
            Crossing { rest: 0, time: 0, stages: 0, distance: i28f36(0) },
            Crossing { rest: 0, time: 0, stages: 0, distance: i28f36(0) },
            Crossing { rest: 0, time: 0, stages: 0, distance: i28f36(0) },
            Crossing { rest: 0, time: 0, stages: 0, distance: i28f36(0) },
        ],
    },
    tolerance: ChordTolerance {
        residual: i28f36(262144),
        growth: i28f36(1073741824),
        fluctuation: i28f36(2),
        max_evaluations: 5,
    },
    landing_step: i28f36(49478023250),
};

/// From stop to stop.
#[allow(dead_code, reason = "a program need not ask")]
pub static SECTIONS: [Section; 2] = [
    Section { pieces: 0..1, stages: 0..5 },
    Section { pieces: 1..2, stages: 5..10 },
];

const fn i28f36(bits: i64) -> real::FixedPoint<real::fixed::types::I28F36> {
    real::FixedPoint(real::fixed::types::I28F36::from_bits(bits))
}
