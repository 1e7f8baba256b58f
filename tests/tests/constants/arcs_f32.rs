use nurbs_core::{Joint, Piece, Pieces};
use secant_interp::{ChordTolerance, Crossing, LengthStage, PieceInterpolator, StageShape, StepLengths, Section};

const _: () = assert!(
    matches!(secant_interp::VERSION, [0, 1]),
    "these constants are for secant-interp 0.1: take that version, or run `feedbits compile` again"
);
const _: () = secant_interp::TablesOf::<1>::ARE_READ;

/// The number format.
pub type Number = f32;

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
            LengthStage { duration: 16106081065, reciprocal: 9838291784887938237, reciprocal_exponent: 33, period_share: 0.26666743, feed: 0.0, change: 0.2666659, shape: StageShape::Onset },
            LengthStage { duration: 16106081066, reciprocal: 9838291784277094932, reciprocal_exponent: 33, period_share: 0.26666743, feed: 0.2666659, change: 0.2666659, shape: StageShape::Easing },
            LengthStage { duration: 185178, reciprocal: 13056905459769834156, reciprocal_exponent: 17, period_share: 0.99999994, feed: 0.5333318, change: 0.0, shape: StageShape::Steady },
            LengthStage { duration: 16106081066, reciprocal: 9838291784277094932, reciprocal_exponent: 33, period_share: 0.26666743, feed: 0.5333318, change: -0.2666659, shape: StageShape::Onset },
            LengthStage { duration: 16106081065, reciprocal: 9838291784887938237, reciprocal_exponent: 33, period_share: 0.26666743, feed: 0.2666659, change: -0.2666659, shape: StageShape::Easing },
            LengthStage { duration: 14822934973, reciprocal: 10689942667707652176, reciprocal_exponent: 33, period_share: 0.28975147, feed: 0.0, change: 0.25082836, shape: StageShape::Onset },
            LengthStage { duration: 14822934973, reciprocal: 10689942667707652176, reciprocal_exponent: 33, period_share: 0.28975147, feed: 0.25082836, change: 0.25082836, shape: StageShape::Easing },
            LengthStage { duration: 185521395980, reciprocal: 13665815670823084558, reciprocal_exponent: 37, period_share: 0.02315079, feed: 0.5016567, change: 0.0, shape: StageShape::Steady },
            LengthStage { duration: 14822934973, reciprocal: 10689942667707652176, reciprocal_exponent: 33, period_share: 0.28975147, feed: 0.5016567, change: -0.25082836, shape: StageShape::Onset },
            LengthStage { duration: 14822934973, reciprocal: 10689942667707652176, reciprocal_exponent: 33, period_share: 0.28975147, feed: 0.25082836, change: -0.25082836, shape: StageShape::Easing },
            LengthStage { duration: 14822934973, reciprocal: 10689942667707652176, reciprocal_exponent: 33, period_share: 0.28975147, feed: 0.0, change: 0.25082836, shape: StageShape::Onset },
            LengthStage { duration: 14822934973, reciprocal: 10689942667707652176, reciprocal_exponent: 33, period_share: 0.28975147, feed: 0.25082836, change: 0.25082836, shape: StageShape::Easing },
            LengthStage { duration: 185521395980, reciprocal: 13665815670823084558, reciprocal_exponent: 37, period_share: 0.02315079, feed: 0.5016567, change: 0.0, shape: StageShape::Steady },
            LengthStage { duration: 14822934973, reciprocal: 10689942667707652176, reciprocal_exponent: 33, period_share: 0.28975147, feed: 0.5016567, change: -0.25082836, shape: StageShape::Onset },
            LengthStage { duration: 14822934973, reciprocal: 10689942667707652176, reciprocal_exponent: 33, period_share: 0.28975147, feed: 0.25082836, change: -0.25082836, shape: StageShape::Easing },
        ],
        crossings: &[
            Crossing { rest: 3221179176, time: 1073788119, stages: 1, distance: 0.23367965 },
            Crossing { rest: 2147391058, time: 2147391059, stages: 2, distance: 0.53175175 },
            Crossing { rest: 0, time: 0, stages: 0, distance: 0.0 },
            Crossing { rest: 1073788118, time: 3221179177, stages: 1, distance: 0.23367965 },
            Crossing { rest: 0, time: 0, stages: 0, distance: 0.0 },
            Crossing { rest: 1938033084, time: 2356934211, stages: 1, distance: 0.25740176 },
            Crossing { rest: 3876066169, time: 418901126, stages: 1, distance: 0.49649724 },
            Crossing { rest: 418901125, time: 3876066170, stages: 1, distance: 0.49649727 },
            Crossing { rest: 2356934210, time: 1938033085, stages: 1, distance: 0.25740173 },
            Crossing { rest: 0, time: 0, stages: 0, distance: 0.0 },
            Crossing { rest: 1938033084, time: 2356934211, stages: 1, distance: 0.25740176 },
            Crossing { rest: 3876066169, time: 418901126, stages: 1, distance: 0.49649724 },
            Crossing { rest: 418901125, time: 3876066170, stages: 1, distance: 0.49649727 },
            Crossing { rest: 2356934210, time: 1938033085, stages: 1, distance: 0.25740173 },
            Crossing { rest: 0, time: 0, stages: 0, distance: 0.0 },
        ],
    },
    tolerance: ChordTolerance {
        residual: 0.00034526698,
        growth: 0.0625,
        fluctuation: 2.3841858e-7,
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
