use nurbs_core::{Joint, Piece, Pieces};
use secant_interp::{ChordTolerance, LengthStage, PieceInterpolator, StageShape, StepLengths, Section};

/// The number format.
pub type Number = real::FixedPoint<real::fixed::types::I4F28>;

/// T, the interpolation period, in s.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIOD_S: f64 = 0.003;

/// Setpoints from begin to end.
#[allow(dead_code, reason = "a program need not ask")]
pub const PERIODS: usize = 97;

/// `secant_interp::PositionChecksum` of all of them.
#[allow(dead_code, reason = "a program need not ask")]
pub const CHECKSUM: u64 = 0xee4a2bb2fd5a19ab;

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
            LengthStage { duration: 14961343463, reciprocal: 10591049220973871521, reciprocal_exponent: 33, period_share: i4f28(77060025), feed: i4f28(0), change: i4f28(138708045), shape: StageShape::Onset },
            LengthStage { duration: 3259630325, reciprocal: 12152936777311448284, reciprocal_exponent: 31, period_share: i4f28(268435455), feed: i4f28(138708045), change: i4f28(66157765), shape: StageShape::Bent(i4f28(-23197062)) },
            LengthStage { duration: 3259630325, reciprocal: 12152936777311448284, reciprocal_exponent: 31, period_share: i4f28(268435455), feed: i4f28(204865810), change: i4f28(72258485), shape: StageShape::Bent(i4f28(-1425218)) },
            LengthStage { duration: 7344579436, reciprocal: 10787297380966653022, reciprocal_exponent: 32, period_share: i4f28(156975837), feed: i4f28(277124295), change: i4f28(163676813), shape: StageShape::Steady },
            LengthStage { duration: 17981659317, reciprocal: 17624216123227608715, reciprocal_exponent: 34, period_share: i4f28(64116524), feed: i4f28(440801108), change: i4f28(200364139), shape: StageShape::Easing },
            LengthStage { duration: 39526395817, reciprocal: 16035494433861619514, reciprocal_exponent: 35, period_share: i4f28(29168394), feed: i4f28(641165247), change: i4f28(0), shape: StageShape::Steady },
            LengthStage { duration: 17981659317, reciprocal: 17624216123227608715, reciprocal_exponent: 34, period_share: i4f28(64116524), feed: i4f28(641165247), change: i4f28(-200364139), shape: StageShape::Onset },
            LengthStage { duration: 10151655845, reciprocal: 15608914195665256536, reciprocal_exponent: 33, period_share: i4f28(113569798), feed: i4f28(440801108), change: i4f28(-226233604), shape: StageShape::Steady },
            LengthStage { duration: 3716088868, reciprocal: 10660154443091259462, reciprocal_exponent: 31, period_share: i4f28(268435455), feed: i4f28(214567504), change: i4f28(-75859459), shape: StageShape::Bent(i4f28(24610989)) },
            LengthStage { duration: 14961343463, reciprocal: 10591049220973871521, reciprocal_exponent: 33, period_share: i4f28(77060025), feed: i4f28(138708045), change: i4f28(-138708045), shape: StageShape::Easing },
            LengthStage { duration: 14961343463, reciprocal: 10591049220973871521, reciprocal_exponent: 33, period_share: i4f28(77060025), feed: i4f28(0), change: i4f28(138708045), shape: StageShape::Onset },
            LengthStage { duration: 3259630325, reciprocal: 12152936777311448284, reciprocal_exponent: 31, period_share: i4f28(268435455), feed: i4f28(138708045), change: i4f28(66157765), shape: StageShape::Bent(i4f28(-23197062)) },
            LengthStage { duration: 3259630325, reciprocal: 12152936777311448284, reciprocal_exponent: 31, period_share: i4f28(268435455), feed: i4f28(204865810), change: i4f28(72258485), shape: StageShape::Bent(i4f28(-1425218)) },
            LengthStage { duration: 7344579436, reciprocal: 10787297380966653022, reciprocal_exponent: 32, period_share: i4f28(156975837), feed: i4f28(277124295), change: i4f28(163676813), shape: StageShape::Steady },
            LengthStage { duration: 17981659317, reciprocal: 17624216123227608715, reciprocal_exponent: 34, period_share: i4f28(64116524), feed: i4f28(440801108), change: i4f28(200364139), shape: StageShape::Easing },
            LengthStage { duration: 39526395817, reciprocal: 16035494433861619514, reciprocal_exponent: 35, period_share: i4f28(29168394), feed: i4f28(641165247), change: i4f28(0), shape: StageShape::Steady },
            LengthStage { duration: 17981659317, reciprocal: 17624216123227608715, reciprocal_exponent: 34, period_share: i4f28(64116524), feed: i4f28(641165247), change: i4f28(-200364139), shape: StageShape::Onset },
            LengthStage { duration: 10151655845, reciprocal: 15608914195665256536, reciprocal_exponent: 33, period_share: i4f28(113569798), feed: i4f28(440801108), change: i4f28(-226233604), shape: StageShape::Steady },
            LengthStage { duration: 3716088868, reciprocal: 10660154443091259462, reciprocal_exponent: 31, period_share: i4f28(268435455), feed: i4f28(214567504), change: i4f28(-75859459), shape: StageShape::Bent(i4f28(24610989)) },
            LengthStage { duration: 14961343463, reciprocal: 10591049220973871521, reciprocal_exponent: 33, period_share: i4f28(77060025), feed: i4f28(138708045), change: i4f28(-138708045), shape: StageShape::Easing },
            LengthStage { duration: 14939519265, reciprocal: 10606521014351305847, reciprocal_exponent: 33, period_share: i4f28(77172597), feed: i4f28(0), change: i4f28(138910675), shape: StageShape::Onset },
            LengthStage { duration: 3254875483, reciprocal: 12170690235013260197, reciprocal_exponent: 31, period_share: i4f28(268435455), feed: i4f28(138910675), change: i4f28(66254410), shape: StageShape::Bent(i4f28(-23197062)) },
            LengthStage { duration: 3254875483, reciprocal: 12170690235013260197, reciprocal_exponent: 31, period_share: i4f28(268435455), feed: i4f28(205165085), change: i4f28(72364043), shape: StageShape::Bent(i4f28(-1425218)) },
            LengthStage { duration: 7333865856, reciprocal: 10803055860293108910, reciprocal_exponent: 32, period_share: i4f28(157205153), feed: i4f28(277529128), change: i4f28(163915918), shape: StageShape::Steady },
            LengthStage { duration: 17955429367, reciprocal: 17649962224768966193, reciprocal_exponent: 34, period_share: i4f28(64210188), feed: i4f28(441445046), change: i4f28(200656839), shape: StageShape::Easing },
            LengthStage { duration: 56873340514, reciprocal: 11144506272813210487, reciprocal_exponent: 35, period_share: i4f28(20271738), feed: i4f28(642101885), change: i4f28(0), shape: StageShape::Steady },
            LengthStage { duration: 17955429366, reciprocal: 17649962225751953670, reciprocal_exponent: 34, period_share: i4f28(64210188), feed: i4f28(642101885), change: i4f28(-200656839), shape: StageShape::Onset },
            LengthStage { duration: 9786185152, reciprocal: 16191838041828280665, reciprocal_exponent: 33, period_share: i4f28(117811127), feed: i4f28(441445046), change: i4f28(-218726597), shape: StageShape::Steady },
            LengthStage { duration: 1999734452, reciprocal: 9904835418900951354, reciprocal_exponent: 30, period_share: i4f28(268435455), feed: i4f28(222718449), change: i4f28(-43469428), shape: StageShape::Bent(i4f28(7569226)) },
            LengthStage { duration: 16970600422, reciprocal: 9337107768038207080, reciprocal_exponent: 33, period_share: i4f28(67936400), feed: i4f28(179249021), change: i4f28(-179249021), shape: StageShape::Easing },
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
    Section { pieces: 0..1, stages: 0..10 },
    Section { pieces: 1..2, stages: 10..20 },
    Section { pieces: 2..3, stages: 20..30 },
];

const fn i4f28(bits: i32) -> real::FixedPoint<real::fixed::types::I4F28> {
    real::FixedPoint(real::fixed::types::I4F28::from_bits(bits))
}
