//! Every byte is where `docs/stream.md` says.

use nurbs_core::{Joint, Piece};
use real::{Backend, I4F28, word_of};
use secant_interp::{
    CompiledPath, LengthStage, PieceInterpolator, Rate, Section, StageShape, StreamHeader, StreamOverride,
    StreamedRun, VERSION, crc32,
};

use super::streamed::{compiled, file_with};

/// Takes little-endian integers one after the other.
struct Integers<'a>(&'a [u8]);

impl Integers<'_> {
    /// The next integer of so many bytes.
    fn next(&mut self, bytes: usize) -> u64 {
        let (first, rest) = self.0.split_at(bytes);
        self.0 = rest;
        first.iter().rev().fold(0, |word, byte| word << 8 | u64::from(*byte))
    }

    fn expect(&mut self, fields: &[(usize, u64)]) {
        for (index, (bytes, value)) in fields.iter().enumerate() {
            let mask = u64::MAX >> (64 - 8 * bytes);
            assert_eq!(self.next(*bytes), value & mask, "field {index}, {} bytes are left", self.0.len());
        }
    }

    /// Two's complement of one byte.
    fn expect_small(&mut self, exponents: &[i8]) {
        exponents.iter().for_each(|exponent| self.expect(&[(1, i64::from(*exponent).cast_unsigned())]));
    }

    fn expect_numbers<'n>(&mut self, numbers: impl IntoIterator<Item = &'n I4F28>) {
        numbers.into_iter().for_each(|x| self.expect(&[(4, word_of(*x))]));
    }
}

fn expect_header(bytes: &mut Integers<'_>, file: &[u8], path: &CompiledPath<I4F28, 2>, run: &StreamedRun) {
    let (whole, feeds) = (path.interpolator(), run.feed_override.unwrap().feeds);
    let text = |text: &[u8; 8]| (8, u64::from_le_bytes(*text));
    let signed = |exponent: i32| (4, i64::from(exponent).cast_unsigned());
    bytes.expect(&[text(b"feedbits"), (2, 2), (2, VERSION[0].into()), (2, VERSION[1].into())]);
    bytes.expect(&[(1, 2), (1, whole.pieces.degree as u64), text(b"I4F28\0\0\0"), (4, 1)]);
    bytes.expect(&[(4, whole.tolerance.max_evaluations.into())]);
    bytes.expect(&[signed(whole.pieces.coordinate_exponent), signed(whole.pieces.chord_exponent)]);
    bytes.expect(&[(8, run.period_s.to_bits()), (8, word_of(whole.landing_step))]);
    let tolerance = whole.tolerance;
    let numbers = [tolerance.residual, tolerance.growth, tolerance.fluctuation];
    bytes.expect(&numbers.map(|x| (8, word_of(x))));
    bytes.expect(&[(8, feeds.slope()), (8, feeds.bend())]);
    assert!(bytes.next(8) > 0 && bytes.next(8) > 0, "A and J");
    let most = |count: fn(&Section) -> usize| path.sections().iter().map(count).max().unwrap() as u64;
    let lengths = path.sections().iter().map(|section| section_bytes(path, section));
    bytes.expect(&[(8, 3 << 30), (4, path.sections().len() as u64), (4, lengths.max().unwrap() as u64)]);
    bytes.expect(&[(4, most(|section| section.pieces.len())), (4, most(|section| section.stages.len()))]);
    bytes.expect(&[
        (8, file.len() as u64),
        (8, run.periods),
        (8, run.checksum),
        (4, crc32(&file[..160]).into()),
    ]);
}

/// The pieces of a run, each with the coefficients of its numerator and of its weight.
fn pieces<'r>(
    run: &PieceInterpolator<'r, I4F28, 2>,
) -> impl Iterator<Item = (&'r Piece<I4F28, 2>, &'r [[I4F28; 2]], &'r [I4F28])> {
    let p = run.pieces.degree;
    let coefficients = run.pieces.numerators.chunks(p).zip(run.pieces.weights.chunks(p + 1));
    run.pieces.pieces.iter().zip(coefficients).map(|(row, (n, w))| (row, n, w))
}

/// The path's lines: they have n_1 alone.
fn is_straight(numerators: &[[I4F28; 2]]) -> bool {
    numerators[1..].as_flattened().iter().all(|x| *x == I4F28::default())
}

/// How many pieces of a section are straight.
fn straight(path: &CompiledPath<I4F28, 2>, section: &Section) -> usize {
    pieces(&path.interpolator().on(section)).filter(|(_, numerators, _)| is_straight(numerators)).count()
}

/// Bytes of a section in I4F28 in the plane, with weights.
fn section_bytes(path: &CompiledPath<I4F28, 2>, section: &Section) -> usize {
    let (p, straight) = (path.interpolator().pieces.degree, straight(path, section));
    let piece = 8 * 2 + 7 + (2 + p * 2) * 4 + (p + 1) * 4;
    let curved = section.pieces.len() - straight;
    28 + curved * piece + straight * 36 + section.stages.len() * (9 + 3 * 4) + 4
}

fn expect_piece(
    bytes: &mut Integers<'_>,
    (row, numerators, weights): (&Piece<I4F28, 2>, &[[I4F28; 2]], &[I4F28]),
) {
    let joint = match row.joint {
        Joint::Continues => 0,
        Joint::Smooth => 1,
        Joint::Breaks => 2,
    };
    let straight = is_straight(numerators);
    bytes.expect(&row.origin.map(|x| (8, x.cast_unsigned())));
    bytes.expect_small(&[row.coordinate_exponent, row.step_exponent, row.range_exponent, row.joint_exponent]);
    bytes.expect(&[(2, row.joint_ratio.into()), (1, joint + 4 * u64::from(straight))]);
    if straight {
        let [least, greatest] = row.step_per_chord.map(|sigma| sigma.word().unwrap());
        let implied = (least * 289 + 128) >> 8;
        bytes.expect(&[(4, least.cast_unsigned()), (1, (greatest - implied).cast_unsigned())]);
        bytes.expect_numbers(&numerators[0]);
        return;
    }
    bytes.expect_numbers(&row.step_per_chord);
    bytes.expect_numbers(numerators.as_flattened());
    bytes.expect_numbers(weights);
}

fn expect_stage(bytes: &mut Integers<'_>, stage: &LengthStage<I4F28>) {
    let (shape, bend) = match stage.shape {
        StageShape::Cubic => (0, I4F28::default()),
        StageShape::Onset => (1, I4F28::default()),
        StageShape::Steady => (2, I4F28::default()),
        StageShape::Easing => (3, I4F28::default()),
        StageShape::Cosine => (4, I4F28::default()),
        StageShape::Bent(by) => (5, by),
    };
    bytes.expect(&[(8, stage.duration), (1, shape)]);
    bytes.expect_numbers(&[stage.feed, stage.change, bend]);
}

#[test]
fn every_byte_is_where_the_book_says() {
    let (path, feeds) = compiled::<I4F28, 2>(true);
    let feed_override = Some(StreamOverride { feeds, commanded: Rate::of(0.75) });
    let run = StreamedRun { period_s: 2e-3, periods: 99, checksum: 0x1234_5678_9abc_def0, feed_override };
    let file = file_with(&path, &run);
    let mut bytes = Integers(&file);
    expect_header(&mut bytes, &file, &path, &run);
    let mut begin = StreamHeader::BYTES;
    for (number, (section, run)) in (0..).zip(path.sections().iter().zip(path.runs())) {
        let end = begin + section_bytes(&path, section);
        bytes.expect(&[(4, number), (4, crc32(&file[..160]).into()), (4, (end - begin) as u64)]);
        bytes.expect(&[(4, section.pieces.len() as u64), (4, straight(&path, section) as u64)]);
        bytes.expect(&[(4, section.stages.len() as u64), (4, crc32(&file[begin..begin + 24]).into())]);
        pieces(&run).for_each(|piece| expect_piece(&mut bytes, piece));
        run.lengths.stages.iter().for_each(|stage| expect_stage(&mut bytes, stage));
        bytes.expect(&[(4, crc32(&file[begin..end - 4]).into())]);
        begin = end;
    }
    assert!(bytes.0.is_empty());
    let [lines, all] =
        [path.sections().iter().map(|section| straight(&path, section)).sum(), path.table().places().len()];
    assert!(0 < lines && lines < all, "{lines} of {all} pieces are straight");
}
