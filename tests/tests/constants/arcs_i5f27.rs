use nurbs_core::{Joint, Piece, Pieces};
use secant_interp::{ChordTolerance, Crossing, LengthStage, PieceInterpolator, StageShape, StepLengths, Section};

const _: () = assert!(
    matches!(secant_interp::VERSION, [0, 1]),
    "these constants are for secant-interp 0.1: take that version, or run `feedbits compile` again"
);
const _: () = secant_interp::TablesOf::<1>::ARE_READ;

/// The number format.
pub type Number = real::FixedPoint<real::fixed::types::I5F27>;

/// T, the interpolation period, in s.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIOD_S: f64 = 0.003;

/// Setpoints from begin to end.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIODS: usize = 132;

/// Path and plan.
pub static PATH: PieceInterpolator<'static, Number, 3> = PieceInterpolator {
    pieces: Pieces {
        pieces: &[
            Piece { origin: [0, 0, 0], coordinate_exponent: -3, step_exponent: 4, range_exponent: 3, joint_ratio: 46341, joint_exponent: 1, joint: Joint::Breaks, step_per_chord: [i5f27(126322568), i5f27(142606336)] },
            Piece { origin: [0, 0, 549755813888], coordinate_exponent: 0, step_exponent: 7, range_exponent: 4, joint_ratio: 65535, joint_exponent: 0, joint: Joint::Breaks, step_per_chord: [i5f27(152484828), i5f27(201675814)] },
            Piece { origin: [2199023255552, 2199023255552, 549755813888], coordinate_exponent: 0, step_exponent: 7, range_exponent: 4, joint_ratio: 32768, joint_exponent: 1, joint: Joint::Smooth, step_per_chord: [i5f27(152484828), i5f27(201675814)] },
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
            LengthStage { duration: 34359353163, reciprocal: 9223475440693858628, reciprocal_exponent: 34, period_share: i5f27(16777404), feed: i5f27(0), change: i5f27(268432447), shape: StageShape::Cosine },
            LengthStage { duration: 770410, reciprocal: 12553583879904250201, reciprocal_exponent: 19, period_share: i5f27(134217727), feed: i5f27(268432447), change: i5f27(0), shape: StageShape::Steady },
            LengthStage { duration: 34359353163, reciprocal: 9223475440693858628, reciprocal_exponent: 34, period_share: i5f27(16777404), feed: i5f27(268432447), change: i5f27(-268432447), shape: StageShape::Cosine },
            LengthStage { duration: 33062672966, reciprocal: 9585209592187373250, reciprocal_exponent: 34, period_share: i5f27(17435394), feed: i5f27(0), change: i5f27(268230335), shape: StageShape::Cosine },
            LengthStage { duration: 182982757236, reciprocal: 13855410415455604622, reciprocal_exponent: 37, period_share: i5f27(3150355), feed: i5f27(268230335), change: i5f27(0), shape: StageShape::Steady },
            LengthStage { duration: 33062672966, reciprocal: 9585209592187373250, reciprocal_exponent: 34, period_share: i5f27(17435394), feed: i5f27(268230335), change: i5f27(-268230335), shape: StageShape::Cosine },
            LengthStage { duration: 33062672966, reciprocal: 9585209592187373250, reciprocal_exponent: 34, period_share: i5f27(17435394), feed: i5f27(0), change: i5f27(268230335), shape: StageShape::Cosine },
            LengthStage { duration: 182982757236, reciprocal: 13855410415455604622, reciprocal_exponent: 37, period_share: i5f27(3150355), feed: i5f27(268230335), change: i5f27(0), shape: StageShape::Steady },
            LengthStage { duration: 33062672966, reciprocal: 9585209592187373250, reciprocal_exponent: 34, period_share: i5f27(17435394), feed: i5f27(268230335), change: i5f27(-268230335), shape: StageShape::Cosine },
        ],
        crossings: &[
            Crossing { rest: 4294582090, time: 385205, stages: 1, distance: i5f27(265010146) },
            Crossing { rest: 385204, time: 4294582091, stages: 1, distance: i5f27(265010148) },
            Crossing { rest: 0, time: 0, stages: 0, distance: i5f27(0) },
            Crossing { rest: 2997901893, time: 1297065402, stages: 1, distance: i5f27(266969429) },
            Crossing { rest: 1297065401, time: 2997901894, stages: 1, distance: i5f27(266969431) },
            Crossing { rest: 0, time: 0, stages: 0, distance: i5f27(0) },
            Crossing { rest: 2997901893, time: 1297065402, stages: 1, distance: i5f27(266969429) },
            Crossing { rest: 1297065401, time: 2997901894, stages: 1, distance: i5f27(266969431) },
            Crossing { rest: 0, time: 0, stages: 0, distance: i5f27(0) },
        ],
    },
    tolerance: ChordTolerance {
        residual: i5f27(11585),
        growth: i5f27(4194304),
        fluctuation: i5f27(2),
        max_evaluations: 5,
    },
    landing_step: i5f27(96636764),
};

/// From stop to stop.
#[allow(dead_code, reason = "a program need not ask")]
pub static SECTIONS: [Section; 3] = [
    Section { pieces: 0..1, stages: 0..3 },
    Section { pieces: 1..2, stages: 3..6 },
    Section { pieces: 2..3, stages: 6..9 },
];

const fn i5f27(bits: i32) -> real::FixedPoint<real::fixed::types::I5F27> {
    real::FixedPoint(real::fixed::types::I5F27::from_bits(bits))
}
