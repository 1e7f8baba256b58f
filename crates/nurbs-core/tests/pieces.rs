//! Compiled pieces against the curve they were cut from, in every kind of format.

use nurbs_core::{
    CompileError, Evaluate, Joint, MAX_DEGREE, NurbsBuf, ORIGIN_EXPONENT, Piece, PieceLimits, PiecesBuf,
    compile, generate,
};
use proptest::prelude::*;
use real::{Backend, DoubleDouble, FormatName, I3F29, I4F28, I4F60, I8F24, I16F48, Real};

const LIMITS: PieceLimits = PieceLimits { length_mm: 32.0, step_mm: 0.7 };

/// What stands still is a few parts of 1e-9 mm: a piece that is halved is longer than that, its halves may both be shorter.
const STILL_MM: f64 = 1e-8;

/// `cases` unless the environment asks for a long run.
fn config(cases: u32) -> ProptestConfig {
    let cases = std::env::var("PROPTEST_CASES").ok().and_then(|n| n.parse().ok()).unwrap_or(cases);
    ProptestConfig { cases, ..ProptestConfig::default() }
}

fn exactly<R: Backend>(x: R) -> DoubleDouble {
    let (high, low) = x.to_f64_pair();
    DoubleDouble::new(high, low)
}

/// The point of a piece in mm.
fn point<R: Backend, const D: usize>(table: &PiecesBuf<R, D>, piece: usize, t: R) -> [DoubleDouble; D] {
    let pieces = table.as_pieces();
    let (origin, offset) = (pieces.pieces[piece].origin, pieces.offset(piece, t));
    core::array::from_fn(|d| in_mm(origin[d]) + exactly(offset[d]).ldexp(pieces.coordinate_exponent))
}

/// That point as [`Pieces::position`] has it, by way of whole units.
fn position<R: Backend, const D: usize>(table: &PiecesBuf<R, D>, piece: usize, t: R) -> [DoubleDouble; D] {
    let pieces = table.as_pieces();
    pieces.position(piece, &pieces.offset(piece, t)).map(in_mm)
}

fn in_mm(units: i64) -> DoubleDouble {
    let high = (units >> 32) as f64 * 1.0_f64.ldexp(32);
    DoubleDouble::new(high, (units & 0xffff_ffff) as f64).ldexp(ORIGIN_EXPONENT)
}

/// How far a point of a piece may be from the curve, in mm.
///
/// With u the unit of the last place of the piece's coordinates, p coefficients and p + 1 steps of Horner's scheme are
/// each rounded by u/2 in fixed point, and in a float by no more than u where that is the last place of `Σ |n_k|`. So N is
/// off by (p+1)² u. If rational, W is off by as much, and P = N/W with W above ½, for the weights within a piece differ by
/// a factor 1.5, so that a float's P is no more than twice `Σ |n_k|`; the reciprocal is rounded once, which |N| magnifies.
/// Then the offset is rounded to the units that all pieces share, and the origin to its own.
fn bound<R: Backend, const D: usize>(table: &PiecesBuf<R, D>, piece: usize) -> f64 {
    let pieces = table.as_pieces();
    let p = pieces.degree as f64;
    let proven = table.bounds().iter().find(|b| b.signal == "offset").unwrap().bound;
    let largest = if R::IS_FLOATING { 2.0 } else { proven };
    let unit = R::resolution().to_f64() * table.coordinate_size_mm(piece);
    let rational = if pieces.is_rational() { 2.0 * (1.0 + largest) } else { 1.0 };
    let fixed = matches!(R::name(), FormatName::Fixed { .. });
    let shared =
        if fixed { R::resolution().to_f64() * 1.0_f64.ldexp(pieces.coordinate_exponent) } else { 0.0 };
    (p + 1.0) * (p + 1.0) * unit * rational + shared + 1.0_f64.ldexp(ORIGIN_EXPONENT)
}

fn distance<const D: usize>(a: &[DoubleDouble; D], b: &[DoubleDouble; D]) -> f64 {
    let away = |d: usize| (a[d] - b[d]).value().abs();
    (0..D).map(away).fold(0.0, f64::max)
}

/// Pieces lie on the curve and each begins where the one before it ends, or behind what stands still; whether the format was
/// accepted.
fn lies_on_the_curve<R: Backend, const D: usize>(
    curve: &NurbsBuf<f64, D>,
    limits: &PieceLimits,
) -> Result<bool, TestCaseError> {
    let table: PiecesBuf<R, D> = match compile::<DoubleDouble, R, D>(&[curve.as_curve()], limits) {
        Ok(table) => table,
        Err(CompileError::DoesNotFit { bound, integer_bits, format, .. }) => {
            prop_assert!(matches!(format, FormatName::Fixed { .. }), "{format} holds everything");
            prop_assert!(bound >= R::max_value().to_f64(), "{format} refused {bound}");
            prop_assert!(
                bound < 1.0_f64.ldexp(i32::try_from(integer_bits).unwrap() - 1),
                "{bound}: {integer_bits}"
            );
            return Ok(false);
        }
        Err(error) => return Err(TestCaseError::fail(error.to_string())),
    };
    let exact = curve.convert::<DoubleDouble>().unwrap();
    let count = table.places().len();
    for (piece, place) in table.places().iter().enumerate() {
        let begin = DoubleDouble::new(place.begin.0, place.begin.1);
        let width = DoubleDouble::new(place.end.0, place.end.1) - begin;
        let bound = bound(&table, piece);
        for eighth in 0..=8 {
            let found = point(&table, piece, R::from_ratio(eighth, 8));
            let expected = exact.as_curve().point(begin + width * DoubleDouble::from_ratio(eighth, 8));
            let error = distance(&found, &expected);
            prop_assert!(
                error <= bound,
                "{} piece {piece} of {count}, t = {eighth}/8: {error} > {bound}",
                R::name()
            );
            let off = distance(&position(&table, piece, R::from_ratio(eighth, 8)), &found);
            prop_assert!(off <= 1.0_f64.ldexp(ORIGIN_EXPONENT), "{}: position off by {off}", R::name());
        }
        if piece + 1 < count {
            let gap = distance(&point(&table, piece, R::one()), &point(&table, piece + 1, R::zero()));
            let stands_still = place.end != table.places()[piece + 1].begin;
            let bound = bound + 1.0_f64.ldexp(ORIGIN_EXPONENT) + if stands_still { STILL_MM } else { 0.0 };
            prop_assert!(gap <= bound, "{} after piece {piece}: {gap} > {bound}", R::name());
        }
    }
    Ok(true)
}

fn in_every_kind_of_format<const D: usize>(
    curve: &NurbsBuf<f64, D>,
    limits: &PieceLimits,
) -> Result<(), TestCaseError> {
    lies_on_the_curve::<DoubleDouble, D>(curve, limits)?;
    lies_on_the_curve::<f64, D>(curve, limits)?;
    lies_on_the_curve::<f32, D>(curve, limits)?;
    lies_on_the_curve::<I4F28, D>(curve, limits)?;
    lies_on_the_curve::<I16F48, D>(curve, limits)?;
    Ok(())
}

/// In the plane other places of the point too: a coarser one in words of 32 bits, and a finer one in words of 64.
fn in_every_plane_format(curve: &NurbsBuf<f64, 2>, limits: &PieceLimits) -> Result<(), TestCaseError> {
    in_every_kind_of_format(curve, limits)?;
    lies_on_the_curve::<I8F24, 2>(curve, limits)?;
    lies_on_the_curve::<I4F60, 2>(curve, limits)?;
    Ok(())
}

proptest! {
    #![proptest_config(config(6))]

    #[test]
    fn plane_pieces_lie_on_their_curve(curve in generate::curve::<2>(), step_mm in 0.05..20.0_f64) {
        in_every_plane_format(&curve, &PieceLimits { step_mm, ..LIMITS })?;
    }

    #[test]
    fn space_pieces_lie_on_their_curve(curve in generate::curve::<3>(), length_mm in 8.0..128.0_f64) {
        in_every_kind_of_format(&curve, &PieceLimits { length_mm, ..LIMITS })?;
    }

    #[test]
    fn pieces_of_a_curve_that_stands_still_lie_on_it(
        curve in generate::curve_with_coincident_points::<2>(),
        step_mm in 0.05..20.0_f64,
    ) {
        in_every_plane_format(&curve, &PieceLimits { step_mm, ..LIMITS })?;
    }

    /// The expansion about t gives the chord from there.
    #[test]
    fn the_shifted_chord_is_a_difference_of_points(
        curve in generate::curve::<2>(),
        piece in any::<prop::sample::Index>(),
        (t, h) in (0.0..1.0_f64, 0.0..1.0_f64),
    ) {
        let table = compiled::<DoubleDouble>(&curve)?;
        let pieces = table.as_pieces();
        let piece = piece.index(pieces.pieces.len());
        let row = &pieces.pieces[piece];
        let (t, h) = (DoubleDouble::from(t), DoubleDouble::from(h * (1.0 - t)));
        let at = pieces.shifted(piece, t);
        let step = h.ldexp(i32::from(row.step_exponent));
        let x = step.ldexp(-i32::from(row.range_exponent));
        let zero = DoubleDouble::from(0.0);
        let weight = at.weight.iter().rev().fold(zero, |sum, w| sum.mul_add(x, *w));
        let weight = weight.mul_add(x, DoubleDouble::from(1.0));
        let (from, to) = (point(&table, piece, t), point(&table, piece, t + h));
        for d in 0..2 {
            let chord = at.chord.iter().rev().fold(zero, |sum, c| sum.mul_add(x, c[d]));
            let chord = (chord * step / weight).ldexp(-pieces.chord_exponent);
            let error = (chord - (to[d] - from[d])).value().abs();
            // 106 bits of at most 500 mm, that is 6e-30 mm, magnified by 2^p and the sums of a dozen roundings.
            prop_assert!(error <= 1e-26, "{error}");
        }
    }
}

/// The pieces of a curve; a curve that does not fit the format is none of the cases, of which as many are drawn as were
/// asked for.
fn compiled<R: Backend>(curve: &NurbsBuf<f64, 2>) -> Result<PiecesBuf<R, 2>, TestCaseError> {
    compile::<DoubleDouble, R, 2>(&[curve.as_curve()], &LIMITS)
        .map_err(|error| TestCaseError::reject(error.to_string()))
}

/// About the begin, the polynomials are those about t = 0, whatever stood in their place before.
fn begins_are_those_of_zero<R: Backend>(
    curve: &NurbsBuf<f64, 2>,
    piece: prop::sample::Index,
) -> Result<(), TestCaseError> {
    let table = compiled::<R>(curve)?;
    let pieces = table.as_pieces();
    let piece = piece.index(pieces.pieces.len());
    let mut at = pieces.shifted(piece, R::one().half());
    pieces.shift_to_begin::<MAX_DEGREE, false>(piece, &mut at);
    prop_assert_eq!(at, pieces.shifted(piece, R::zero()), "{}", R::name());
    Ok(())
}

/// From one point to another, of a piece or of two, the polynomials are those that are formed there anew: in every form of the code.
fn shifts_along_are_those_anew<R: Backend>(
    curve: &NurbsBuf<f64, 2>,
    piece: prop::sample::Index,
    [from, to]: [u64; 2],
) -> Result<(), TestCaseError> {
    let table = compiled::<R>(curve)?;
    let pieces = table.as_pieces();
    let piece = piece.index(pieces.pieces.len());
    let row = &pieces.pieces[piece];
    let expected = pieces.shifted(piece, R::fraction(to));
    let place = pieces.in_units_of_path(row, &expected.offset);
    let begin = pieces.shifted(piece, R::fraction(from));
    let rows = [(row, None), (row, pieces.right_shifts(row))];
    for row in rows {
        let mut at = begin;
        let any = pieces.coefficients::<MAX_DEGREE, false>(piece).unwrap();
        prop_assert_eq!(pieces.shift_along::<MAX_DEGREE, false>(row, &any, R::fraction(to), &mut at), place);
        prop_assert_eq!(at, expected, "{}", R::name());
        if pieces.degree == 3 {
            let mut at = begin;
            let cubic = pieces.coefficients::<3, false>(piece).unwrap();
            prop_assert_eq!(pieces.shift_along::<3, false>(row, &cubic, R::fraction(to), &mut at), place);
            prop_assert_eq!(at, expected, "cubics in {}", R::name());
            let mut at = pieces.shifted(0, R::fraction(from));
            prop_assert_eq!(pieces.shift_along::<3, false>(row, &cubic, R::fraction(to), &mut at), place);
            prop_assert_eq!(at, expected, "from another piece in {}", R::name());
            if !pieces.is_rational() {
                let mut at = begin;
                let plain = pieces.coefficients::<3, true>(piece).unwrap();
                prop_assert_eq!(pieces.shift_along::<3, true>(row, &plain, R::fraction(to), &mut at), place);
                prop_assert_eq!(at, expected, "plain cubics in {}", R::name());
            }
        }
    }
    Ok(())
}

proptest! {
    // Each case compiles a whole curve for one place on it.
    #![proptest_config(config(64))]

    #[test]
    fn shifts_along_are_those_anew_in_every_format(
        curve in generate::curve::<2>(),
        piece in any::<prop::sample::Index>(),
        places in any::<[u64; 2]>(),
    ) {
        shifts_along_are_those_anew::<f64>(&curve, piece, places)?;
        shifts_along_are_those_anew::<f32>(&curve, piece, places)?;
        shifts_along_are_those_anew::<I4F28>(&curve, piece, places)?;
        shifts_along_are_those_anew::<I16F48>(&curve, piece, places)?;
    }

    #[test]
    fn begins_are_those_of_zero_in_every_format(
        curve in generate::curve::<2>(),
        piece in any::<prop::sample::Index>(),
    ) {
        begins_are_those_of_zero::<f64>(&curve, piece)?;
        begins_are_those_of_zero::<f32>(&curve, piece)?;
        begins_are_those_of_zero::<I4F28>(&curve, piece)?;
        begins_are_those_of_zero::<I16F48>(&curve, piece)?;
    }
}

/// The formats of the test accept an ordinary curve, so that the properties above are not idle.
#[test]
fn ordinary_curves_fit_every_format() {
    let points = [[1, 0], [1, 1], [0, 1]].map(|p| p.map(|x| 30.0 * f64::from(x))).to_vec();
    let knots = vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0];
    let quarter = NurbsBuf::try_new(2, points, vec![1.0, 0.5_f64.sqrt(), 1.0], knots).unwrap();
    for limits in [LIMITS, PieceLimits { length_mm: 64.0, step_mm: 0.1 }] {
        assert!(lies_on_the_curve::<f32, 2>(&quarter, &limits).unwrap());
        assert!(lies_on_the_curve::<I3F29, 2>(&quarter, &limits).unwrap());
        assert!(lies_on_the_curve::<I4F28, 2>(&quarter, &limits).unwrap());
        assert!(lies_on_the_curve::<I8F24, 2>(&quarter, &limits).unwrap());
        assert!(lies_on_the_curve::<I16F48, 2>(&quarter, &limits).unwrap());
        assert!(lies_on_the_curve::<I4F60, 2>(&quarter, &limits).unwrap());
    }
}

/// A format too narrow is refused with the signal and the bits it needs; a wider one takes the same path.
#[test]
fn a_refusal_names_signal_and_bits() {
    // All of it is shorter than one step, and winds.
    let points = vec![[0.0, 0.0], [0.02, 0.0], [0.06, 0.4], [0.4, -0.4], [0.5, 0.5], [0.5, 0.0]];
    let knots = vec![0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, 1.0, 1.0, 1.0];
    let curve = NurbsBuf::try_new_nonrational(5, points, knots).unwrap();
    let limits = PieceLimits { length_mm: 32.0, step_mm: 2.0 };
    let narrow = compile::<DoubleDouble, real::I2F30, 2>(&[curve.as_curve()], &limits).err();
    let Some(CompileError::DoesNotFit { signal, bound, integer_bits, .. }) = narrow else {
        panic!("{narrow:?}")
    };
    assert!(!signal.is_empty() && bound >= 2.0 && integer_bits > 2, "{signal} {bound} {integer_bits}");
    assert!(compile::<DoubleDouble, I16F48, 2>(&[curve.as_curve()], &limits).is_ok());
}

#[test]
fn what_is_no_limit_is_refused() {
    let curve = NurbsBuf::try_new_nonrational(1, vec![[0.0], [9.0]], vec![0.0, 0.0, 1.0, 1.0]).unwrap();
    for bad in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        for limits in [PieceLimits { length_mm: bad, ..LIMITS }, PieceLimits { step_mm: bad, ..LIMITS }] {
            let error = compile::<DoubleDouble, f64, 1>(&[curve.as_curve()], &limits).err();
            assert!(matches!(error, Some(CompileError::LimitNotPositive { .. })), "{error:?}");
        }
    }
}

#[test]
fn coordinates_beyond_the_origins_range_are_refused() {
    let far = NurbsBuf::try_new_nonrational(1, vec![[0.0], [4e7]], vec![0.0, 0.0, 1.0, 1.0]).unwrap();
    let limits = PieceLimits { length_mm: 1e6, step_mm: 1.0 };
    let error = compile::<DoubleDouble, f64, 1>(&[far.as_curve()], &limits).err();
    assert_eq!(error, Some(CompileError::OriginOutOfRange { curve: 0 }));
}

/// The first ones reached an assertion that a point is a number; of the last one, f32 held no inverse of the speed and made steps of
/// nothing, so that a run never ended.
#[test]
fn weights_too_far_apart_and_curves_too_small_are_refused() {
    let line = |end: f64, weights: [f64; 2]| {
        let points = vec![[0.0, 0.0], [end, 0.0]];
        NurbsBuf::try_new(1, points, weights.to_vec(), vec![0.0, 0.0, 1.0, 1.0]).unwrap()
    };
    let is_refused = |error: Option<CompileError>| {
        assert!(matches!(error, Some(CompileError::SpeedOutOfRange { curve: 0, .. })), "{error:?}");
    };
    for weights in [[0.0118, 5e-324], [5e-324, 0.0118], [1e-200, 1.1e-200]] {
        let line = line(9.0, weights);
        let error = compile::<f64, f32, 2>(&[line.as_curve()], &LIMITS).err();
        // Where the speed vanishes before W does it is a cusp to the compiler.
        let is_known =
            matches!(error, Some(CompileError::SpeedOutOfRange { .. } | CompileError::Cusp { .. }));
        assert!(is_known, "{weights:?}: {error:?}");
    }
    let tiny = line(9e-100, [1.0, 1.0]);
    is_refused(compile::<f64, f32, 2>(&[tiny.as_curve()], &LIMITS).err());
    is_refused(compile::<DoubleDouble, f32, 2>(&[tiny.as_curve()], &LIMITS).err());
    let small = line(9e-30, [1.0, 1.0]);
    let pieces = compile::<f64, f32, 2>(&[small.as_curve()], &LIMITS).unwrap();
    assert!(
        pieces.as_pieces().pieces[0].step_per_chord.iter().all(|sigma| *sigma > 0.0 && sigma.is_finite())
    );
}

/// In a format of two integer bits the variable of the chord polynomials was once twice as long as the format reaches: a step
/// on a straight line at full feed was 5e-4 too short, and no audit saw it, for the bound was not among the proven ones.
#[test]
fn the_variable_of_the_chord_fits_two_integer_bits() {
    let line = NurbsBuf::try_new_nonrational(1, vec![[0.0], [90.0]], vec![0.0, 0.0, 1.0, 1.0]).unwrap();
    let arc =
        NurbsBuf::try_new_nonrational(2, vec![[0.0], [7.0], [9.0]], vec![0., 0., 0., 1., 1., 1.]).unwrap();
    for curve in [line, arc] {
        for step_mm in [0.4, 0.49, 0.51, 0.99] {
            let limits = PieceLimits { length_mm: 32.0, step_mm };
            let table = compile::<DoubleDouble, real::I2F30, 1>(&[curve.as_curve()], &limits).unwrap();
            let bound = table.bounds().iter().find(|b| b.signal == "chord_variable").unwrap().bound;
            assert!((0.3..2.0).contains(&bound), "{step_mm} mm: {bound}");
        }
    }
}

#[test]
fn a_stop_inside_a_span_becomes_a_joint() {
    let points = [[0, 0], [10, 30], [40, 30], [50, 0], [90, 10]].map(|p| p.map(f64::from)).to_vec();
    let curve =
        NurbsBuf::try_new_nonrational(3, points, vec![0.0, 0.0, 0.0, 0.0, 0.5, 1.0, 1.0, 1.0, 1.0]).unwrap();
    let curves = [curve.as_curve()];
    let stops = [(0, 0.0), (0, 0.123), (0, 0.5), (0, 0.7), (0, 1.0), (3, 0.2)];
    let table = nurbs_core::compile_with_stops::<DoubleDouble, f64, 2>(&curves, &LIMITS, &stops).unwrap();
    let places = table.places();
    for (stop, begins) in [(0.0, true), (0.123, true), (0.5, true), (0.7, true), (1.0, false)] {
        let joint = table.joint(0, stop).unwrap();
        assert_eq!(places.get(joint).is_some_and(|place| place.begin.0 == stop), begins, "{stop}");
        assert!(joint == 0 || places[joint - 1].end.0 == stop, "{stop}");
        assert!(joint == 0 || table.as_pieces().pieces[joint - 1].joint != Joint::Continues, "{stop}");
    }
    assert_eq!((table.joint(0, 0.2), table.joint(1, 0.5)), (None, None));
    for (before, after) in places.iter().zip(&places[1..]) {
        assert_eq!(before.end, after.begin);
    }

    // A part of the path is the same pieces.
    let (all, first) = (table.as_pieces(), table.joint(0, 0.5).unwrap());
    let part = all.part(first..places.len());
    assert_eq!(part.pieces.len(), places.len() - first);
    assert_eq!(part.offset(0, 0.25), all.offset(first, 0.25));
    assert_eq!(all.part(3..99).pieces.len(), 0);
}

#[test]
fn a_row_takes_the_bytes_that_are_said() {
    assert_eq!((size_of::<Piece<I4F28, 2>>(), size_of::<Piece<f64, 3>>()), (32, 48));
}

#[test]
fn positions_of_no_piece_are_those_of_the_last_one() {
    let curve = NurbsBuf::try_new_nonrational(1, vec![[1.0, 2.0], [11.0, 2.0]], vec![0.0, 0.0, 1.0, 1.0]);
    let table: PiecesBuf<I4F28, 2> =
        compile::<DoubleDouble, I4F28, 2>(&[curve.unwrap().as_curve()], &LIMITS).unwrap();
    let pieces = table.as_pieces();
    let (last, mm) = (pieces.pieces.len() - 1, 1_i64 << -ORIGIN_EXPONENT);
    assert_eq!(pieces.position(last, &pieces.offset(last, I4F28::from_ratio(1, 1))), [11 * mm, 2 * mm]);
    assert_eq!(pieces.position(usize::MAX, &pieces.offset(last, I4F28::from_ratio(1, 1))), [11 * mm, 2 * mm]);
    assert_eq!(pieces.part(0..0).position(0, &[I4F28::from_ratio(1, 1); 2]), [0, 0]);
}

/// A coordinate, a weight or a knot that became 0 would be other geometry.
#[test]
fn a_number_that_the_computing_type_does_not_hold_is_refused() {
    let line = |far: f64, weight: f64, end: f64| {
        NurbsBuf::try_new(1, vec![[0.0], [far]], vec![1.0, weight], vec![0.0, 0.0, end, end]).unwrap()
    };
    for (curve, fits) in [
        (line(10.0, 1.2, 1.0), true),
        (line(1e300, 1.0, 1.0), false),
        (line(10.0, 1e300, 1.0), false),
        (line(10.0, 1.0, 1e300), false),
    ] {
        let limits = PieceLimits { length_mm: f64::MAX, ..LIMITS };
        let outcome = compile::<f32, f64, 1>(&[curve.as_curve()], &limits);
        let refused =
            |error: CompileError| matches!(error, CompileError::SpeedOutOfRange { curve: 0, parameter: 0.0 });
        assert!(outcome.as_ref().map_or_else(|e| !fits && refused(*e), |_| fits), "{:?}", outcome.err());
    }
    let narrow = nurbs_core::PowerCurve::new::<f32>(&line(1e300, 1.0, 1.0).as_curve());
    assert!(nurbs_core::Evaluate::point(&narrow, 0.5)[0].is_nan());
}

#[test]
fn stops_out_of_order_are_refused_by_their_index() {
    let points = vec![[0.0, 0.0], [10.0, 30.0], [40.0, 30.0], [50.0, 0.0]];
    let curve = NurbsBuf::try_new_nonrational(3, points, vec![0., 0., 0., 0., 1., 1., 1., 1.]).unwrap();
    let curves = [curve.as_curve(), curve.as_curve()];
    let check = |stops: &[(usize, f64)]| {
        nurbs_core::compile_with_stops::<DoubleDouble, f64, 2>(&curves, &LIMITS, stops).err()
    };
    let out_of_order = |index| Some(CompileError::StopOutOfOrder { index });
    assert_eq!(check(&[(0, 0.2), (0, 0.2), (0, 0.3), (1, 0.1), (1, 1.0)]), None);
    assert_eq!(check(&[(0, 0.3), (0, 0.2)]), out_of_order(1));
    assert_eq!(check(&[(0, 0.1), (1, 0.3), (0, 0.4)]), out_of_order(2));
    assert_eq!(check(&[(0, f64::NAN)]), out_of_order(0));
    assert_eq!(check(&[(0, 0.1), (0, f64::NAN), (0, 0.5)]), out_of_order(1));
}

/// Cusps, doubled points, lines there and back: each was refused in every format. Places and pieces take the whole domain in turn,
/// and the pieces are no more than some per halving on either side.
#[test]
fn where_a_curve_stands_still_it_is_cut() {
    let clamped = |degree: usize, inner: &[f64]| -> Vec<f64> {
        let ends = |u: f64| std::iter::repeat_n(u, degree + 1);
        ends(0.0).chain(inner.iter().copied()).chain(ends(1.0)).collect()
    };
    let [b, c] = [[10.0, 30.0], [40.0, 35.0]];
    let [p, q, r] = [[10.0, 15.0], [20.0, -5.0], [30.0, 20.0]];
    // Degree, control points, inner knots, and where the curve stands still.
    type Case<'a> = (&'a str, usize, &'a [[f64; 2]], &'a [f64], &'a [f64]);
    let cases: [Case; 7] = [
        ("cusp", 3, &[[10.0, 10.0], [-10.0 / 3.0, -10.0], [-10.0 / 3.0, 10.0], [10.0, -10.0]], &[], &[0.5]),
        ("doubled ends", 3, &[b, b, p, c, c], &[0.5], &[0.0, 1.0]),
        ("tripled ends", 3, &[b, b, b, p, c, c, c], &[0.2, 0.5, 0.8], &[0.0, 1.0]),
        ("tripled inside", 3, &[b, p, q, q, q, r, c], &[0.25, 0.5, 0.75], &[0.5]),
        ("a span without length", 3, &[b, p, q, q, q, q, r, c], &[0.2, 0.4, 0.6, 0.8], &[0.4, 0.5, 0.6]),
        ("there and back", 2, &[b, c, b], &[], &[0.5]),
        ("a line with C' = 0 inside", 3, &[b, c, b, c], &[], &[0.5]),
    ];
    for (name, degree, points, inner, still) in cases {
        let curve = NurbsBuf::try_new_nonrational(degree, points.to_vec(), clamped(degree, inner)).unwrap();
        let table = compile::<DoubleDouble, I4F28, 2>(&[curve.as_curve()], &LIMITS).unwrap();
        let mut all: Vec<_> = table.places().iter().chain(table.still_places()).collect();
        all.sort_by(|a, b| a.begin.partial_cmp(&b.begin).unwrap());
        assert_eq!((all[0].begin.0, all[all.len() - 1].end.0), (0.0, 1.0), "{name}");
        assert!(all.windows(2).all(|pair| pair[0].end == pair[1].begin), "{name}");
        let count = table.places().len();
        assert!(count <= 160 * still.len(), "{name}: {count} pieces");
        for place in table.still_places() {
            let is_known = still.iter().any(|u| place.begin.0 - 1e-3 <= *u && *u <= place.end.0 + 1e-3);
            assert!(is_known, "{name}: {place:?}");
            let [from, to] = [place.begin.0, place.end.0].map(|u| curve.as_curve().point(u));
            let way = f64::norm(&[to[0] - from[0], to[1] - from[1]]);
            assert!(way <= 2e-9, "{name}: {way} mm at {place:?}");
        }
        for u in still {
            let joint = table.joint(0, *u).unwrap_or_else(|| panic!("{name}: no joint at {u}"));
            let (before, behind) =
                (joint.checked_sub(1).map(|i| table.places()[i]), table.places().get(joint));
            assert!(before.is_none_or(|place| place.end.0 <= *u), "{name}: {before:?}");
            assert!(behind.is_none_or(|place| place.begin.0 >= *u), "{name}: {behind:?}");
            let goes_on = joint > 0 && table.as_pieces().pieces[joint - 1].joint == Joint::Continues;
            assert!(!goes_on, "{name}: {u}");
        }
    }
}

/// Between knots a rounding apart lie many joints, and their parameters differ only in the second of their two floats. The
/// first of them was once taken for the joint at the stop.
#[test]
fn a_stop_between_knots_a_rounding_apart_becomes_its_own_joint() {
    let knot = 0.507_274_961_421_666_2_f64;
    let stops = [(0, knot), (0, knot.next_up())];
    let points = vec![[0.0, 0.0], [10.0, 0.0], [20.0, 0.0], [40.0, 20.0], [60.0, 0.0], [70.0, 0.0]];
    let knots = vec![0.0, 0.0, 0.0, knot, knot, knot.next_up(), 1.0, 1.0, 1.0];
    let curve = NurbsBuf::try_new(2, points, vec![1.0; 6], knots).unwrap();
    let cut = PieceLimits { length_mm: 4.0, step_mm: 1.0 };
    let table =
        nurbs_core::compile_with_stops::<DoubleDouble, f64, 2>(&[curve.as_curve()], &cut, &stops).unwrap();
    let joints = stops.map(|(curve, u)| table.joint(curve, u).unwrap());
    assert!(joints[0] + 4 < joints[1], "{joints:?}");
    for (joint, (_, u)) in joints.iter().zip(stops) {
        assert_eq!(table.places()[*joint].begin, (u, 0.0));
    }
}

/// Between curves that move, one that is a point has no piece; a stop on it is the joint of the others. A path that is nothing else
/// is refused.
#[test]
fn a_curve_that_is_a_point_has_no_piece() {
    let line = |from: [f64; 2], to: [f64; 2]| {
        NurbsBuf::try_new_nonrational(1, vec![from, to], vec![0.0, 0.0, 1.0, 1.0]).unwrap()
    };
    let corner = [30.0, 0.0];
    let point = NurbsBuf::try_new_nonrational(2, vec![corner; 3], vec![0., 0., 0., 1., 1., 1.]).unwrap();
    let curves = [line([0.0; 2], corner), point, line(corner, [30.0, 30.0])];
    let curves = curves.each_ref().map(NurbsBuf::as_curve);
    let stops = [(0, 1.0), (1, 0.4), (1, 1.0)];
    let table = nurbs_core::compile_with_stops::<DoubleDouble, I4F28, 2>(&curves, &LIMITS, &stops).unwrap();
    assert_eq!(table.places().iter().map(|place| place.curve).collect::<Vec<_>>(), [0, 2]);
    assert_eq!(stops.map(|(curve, u)| table.joint(curve, u)), [Some(1); 3]);
    assert_eq!((table.joint(1, 1.5), table.joint(3, 0.5)), (None, None));
    let refused = compile::<DoubleDouble, I4F28, 2>(&curves[1..2], &LIMITS).err();
    assert!(matches!(refused, Some(CompileError::Cusp { curve: 0, .. })), "{refused:?}");
}
