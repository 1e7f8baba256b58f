//! The operations of a step, counted by hand and by the counting wrapper.

use crate::steps::step;
use nurbs_core::{NurbsBuf, PieceLimits, PiecesBuf, compile};
use real::{Backend, Counted, DoubleDouble, I4F28, OperationCounts, Real};
use secant_interp::{ChordTolerance, LengthStage, PieceInterpolator, StepLengths};

/// A step at constant feed on a non-rational plane cubic that stays on its piece and takes one evaluation.
///
/// | what | mul_add | mul | sums of products | scale | add, sub, neg | compare | convert |
/// |---|---|---|---|---|---|---|---|
/// | the period's distance: no change of feed | | | | | | 1 | |
/// | start value, in the range? Subtracted, in fixed point thrice, lest it leave the format; floats need not be | | | | | 2 + 1 | 2 or 0 | |
/// | does the step stay on the piece, which in floats is asked of its bits? Its phase is asked for only on one that ends at a knot, as [`at_knot`] has it | | 1 | | | | 1 | |
/// | x, of which floats make pieces | | | | 1 | | | |
/// | Horner's scheme for q, 2 products a coordinate, and q', 1; x q' | 6 | 2 | | | | | |
/// | σq, σxq', the sign in f, f, g | | 2 + 2 | 2 of 3 and 2 terms | | 1 | | |
/// | the correction: half of σ, f, the products of its polynomial at once; in floats one by one | | 2 | 1 of 2 terms | 1 | 3 | | |
/// | are f and g small? | | | | | | 2 + 2 | |
/// | in range? Subtracted as before; floats need not be | | | | | 2 + 1 | 2 or 0 | |
/// | the next start value: a difference, and the extrapolation of it and the one before | | | | | 3 | | |
/// | the phase of the step, and the place; in f64 the place is a sum, and the phase made of it | | 1 | | | | | 2 or 1 |
/// | the point, with the shift to it, a coordinate: 2 + 2 + 1 products of synthetic division, value·t | 10 | 2 | | | | | |
/// | rescale three coefficients a coordinate and the point, which floats need not | | | | 6 + 2 | | | |
/// | **sum** | **16** | **12** | **3** | **10** | **13** | **10** | **2** |
const BY_HAND: OperationCounts = OperationCounts {
    add: 0, // with `sub` and `neg`, in `sub`
    sub: 13,
    neg: 0,
    mul: 12,
    mul_add: 16,
    sum_of_products: 3,
    sum_of_products_terms: 7,
    div: 0,
    sqrt: 0,
    norm: 0,
    norm_terms: 0,
    scale: 10,
    compare: 10,
    convert: 2,
};

/// [`BY_HAND`] in a format.
fn by_hand<R: Real>() -> OperationCounts {
    if !R::IS_FLOATING {
        return BY_HAND;
    }
    OperationCounts {
        sub: BY_HAND.sub - 2 - 2 + 1,
        mul: BY_HAND.mul + 2,
        sum_of_products: BY_HAND.sum_of_products - 1,
        sum_of_products_terms: BY_HAND.sum_of_products_terms - 2,
        scale: BY_HAND.scale - (1 + 6 + 2),
        compare: BY_HAND.compare - 2 - 2,
        convert: BY_HAND.convert - 1,
        ..BY_HAND
    }
}

/// The operations of a common step on a piece that ends at a knot: fixed point compares phases, floats places with the rest of the piece.
fn at_knot<R: Real>() -> OperationCounts {
    let common = by_hand::<R>();
    if !R::IS_FLOATING {
        return OperationCounts { convert: common.convert + 1, ..common };
    }
    OperationCounts { sub: common.sub + 2, scale: common.scale + 1, compare: common.compare + 1, ..common }
}

fn counts_of_common_steps<R: Backend>() -> Vec<OperationCounts> {
    let points = [[150, 150], [0, 0], [0, 300], [150, 150], [300, 0], [300, 300], [150, 150]];
    let knots = vec![0.0, 0.0, 0.0, 0.0, 0.25, 0.5, 0.75, 1.0, 1.0, 1.0, 1.0];
    let points = points.map(|p| p.map(f64::from)).to_vec();
    let curve = NurbsBuf::try_new_nonrational(3, points, knots).unwrap();
    let limits = PieceLimits { length_mm: 32.0, step_mm: 0.6 };
    let table: PiecesBuf<Counted<R>, 2> =
        compile::<DoubleDouble, _, 2>(&[curve.as_curve()], &limits).unwrap();
    let pieces = table.as_pieces();
    let number = |x: f64| Counted::<R>::from_f64(x).unwrap();
    let unit = 1.0.ldexp(pieces.chord_exponent);
    let stages = [LengthStage::new(1500 << 32, number(0.5 * unit), number(0.0)).unwrap()];
    let interpolator = PieceInterpolator {
        pieces,
        lengths: StepLengths { stages: &stages, crossings: &[] },
        tolerance: ChordTolerance::for_fluctuation(Some(1e-6), 6),
        landing_step: number(0.01 * unit),
    };
    let mut state = interpolator.start();
    let mut piece = usize::MAX;
    let mut counts = Vec::new();
    for _ in 0..1400 {
        let (setpoint, of_step) = OperationCounts::of(|| step(&interpolator, &mut state));
        let setpoint = setpoint.unwrap();
        if setpoint.piece == piece && setpoint.evaluations == 1 {
            counts.push(of_step);
        }
        piece = setpoint.piece;
    }
    counts
}

#[test]
fn a_step_makes_the_operations_that_were_counted_by_hand() {
    fn check<R: Backend>() {
        let counts = counts_of_common_steps::<R>();
        assert!(counts.len() > 1300, "the common step is the common one: {}", counts.len());
        let (common, at_knot) = (by_hand::<R>(), at_knot::<R>());
        for step in counts {
            let is_common = (step.scale, step.convert) == (common.scale, common.convert);
            let expected = if is_common { common } else { at_knot };
            // The absolute value of a negative f or g is one sign more.
            let sums = step.add + step.sub + step.neg;
            assert!((expected.sub..=expected.sub + 2).contains(&sums), "{sums} in {}", R::name());
            let sums = OperationCounts { add: 0, sub: expected.sub, neg: 0, ..step };
            assert_eq!(sums, expected, "{}", R::name());
        }
    }
    check::<f64>();
    check::<I4F28>();
}
