//! The host's side of a stream: a compiled path as a file, section by section.

use core::fmt;
use std::io;

use feed_plan::StageShape;
use nurbs_core::Piece;
use real::{Backend, FormatName, word_of};

use crate::compiled::compiled_path::CompiledPath;
use crate::compiled::constant::number_type;
use crate::pieces::piece_interpolator::PieceInterpolator;
use crate::step_lengths::LengthStage;
use crate::stream::crc32::crc32;
use crate::stream::header::{MOST_EVALUATIONS, StreamHeader, name_in_header};
use crate::stream::layout::{RowShape, SectionRows};
use crate::stream::rows::{JOINTS, STRAIGHT};
use crate::stream::section_head::SectionHead;
use crate::stream::stored_override::StreamOverride;
use crate::stream::straight::{is_straight, words_beside};

/// What a stream says besides path and plan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StreamedRun {
    /// T, in s.
    pub period_s: f64,
    /// Setpoints from begin to end, without overrides.
    pub periods: u64,
    /// [`PositionChecksum`](crate::PositionChecksum) of all of them.
    pub checksum: u64,
    /// Feed override, if the plan was made for it.
    pub feed_override: Option<StreamOverride>,
}

/// Why a path becomes no stream.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum NoStream {
    /// No machine word holds a number of this format.
    NoWord(FormatName),
    /// The step may take more evaluations in a period than a reader allows.
    TooManyEvaluations {
        /// How many it may take.
        evaluations: u32,
    },
    /// This section, or the number of sections, is beyond what 32 bits count.
    TooLong {
        /// The section, from 0; the number of sections if they are too many.
        section: usize,
    },
}

impl fmt::Display for NoStream {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::NoWord(format) => write!(f, "no machine word holds a number of {format}"),
            Self::TooManyEvaluations { evaluations } => {
                write!(f, "{evaluations} evaluations in a period: expected at most {MOST_EVALUATIONS}")
            }
            Self::TooLong { section } => write!(f, "section {section} is beyond what 32 bits count"),
        }
    }
}

impl std::error::Error for NoStream {}

/// A compiled path that is to become a stream.
#[derive(Clone, Copy, Debug)]
pub struct PathStream<'a, R, const D: usize> {
    path: &'a CompiledPath<R, D>,
    shape: RowShape,
    header: StreamHeader,
}

impl<'a, R: Backend, const D: usize> PathStream<'a, R, D> {
    /// Finds the lengths of all sections.
    ///
    /// # Errors
    /// [`NoStream::NoWord`] unless the numbers are floats of 32 or 64 bits, or fixed point of 8, 16, 32 or 64 bits that
    /// rounds to nearest and wraps. [`NoStream::TooManyEvaluations`] above 1000. [`NoStream::TooLong`].
    pub fn new(path: &'a CompiledPath<R, D>, run: &StreamedRun) -> Result<Self, NoStream> {
        let format = R::name();
        number_type(format).ok_or(NoStream::NoWord(format))?;
        let PieceInterpolator { pieces, tolerance, landing_step, .. } = path.interpolator();
        let evaluations = tolerance.max_evaluations;
        if evaluations > MOST_EVALUATIONS {
            return Err(NoStream::TooManyEvaluations { evaluations });
        }
        let numbers = [landing_step, tolerance.residual, tolerance.growth, tolerance.fluctuation];
        let too_many = NoStream::TooLong { section: path.sections().len() };
        let header = StreamHeader {
            format: name_in_header(format),
            dimension: u8::try_from(D).map_err(|_| too_many)?,
            degree: u8::try_from(pieces.degree).map_err(|_| too_many)?,
            has_weights: pieces.is_rational(),
            period_s: run.period_s,
            coordinate_exponent: pieces.coordinate_exponent,
            chord_exponent: pieces.chord_exponent,
            numbers: numbers.map(word_of),
            max_evaluations: evaluations,
            feed_override: run.feed_override,
            sections: u32::try_from(path.sections().len()).map_err(|_| too_many)?,
            largest_bytes: 0,
            largest_pieces: 0,
            largest_stages: 0,
            file_bytes: 0,
            periods: run.periods,
            checksum: run.checksum,
        };
        let shape = header.row_shape(usize::try_from(format.bits() / 8).unwrap_or(0));
        let mut stream = Self { path, shape, header };
        stream.header.file_bytes = StreamHeader::BYTES as u64;
        for index in 0..path.sections().len() {
            let head = stream.head(index).ok_or(NoStream::TooLong { section: index })?;
            let header = &mut stream.header;
            header.largest_bytes = header.largest_bytes.max(head.bytes);
            header.largest_pieces = header.largest_pieces.max(head.pieces);
            header.largest_stages = header.largest_stages.max(head.stages);
            header.file_bytes += u64::from(head.bytes);
        }
        Ok(stream)
    }

    /// The header of the file.
    #[must_use]
    pub fn header(&self) -> &StreamHeader {
        &self.header
    }

    /// Bytes of each section, in order.
    pub fn section_bytes(&self) -> impl Iterator<Item = u32> + '_ {
        (0..self.path.sections().len()).filter_map(|index| Some(self.head(index)?.bytes))
    }

    /// The head of a section, without the file's CRC; `None` if a number does not fit.
    fn head(&self, index: usize) -> Option<SectionHead> {
        let section = self.path.sections().get(index)?;
        let run = self.path.interpolator().on(section);
        let straight = self.pieces(&run).filter(|piece| self.words_beside(piece).is_some()).count();
        let rows = SectionRows { pieces: section.pieces.len(), straight, stages: section.stages.len() };
        let bytes = self.shape.section_bytes(&rows)?;
        Some(SectionHead {
            number: u32::try_from(index).ok()?,
            file: 0,
            bytes: u32::try_from(bytes).ok()?,
            pieces: u32::try_from(rows.pieces).ok()?,
            straight: u32::try_from(rows.straight).ok()?,
            stages: u32::try_from(rows.stages).ok()?,
        })
    }

    /// Writes the file. No more than one section is in memory.
    ///
    /// # Errors
    /// Those of `to`.
    pub fn write(&self, to: &mut dyn io::Write) -> io::Result<()> {
        to.write_all(&self.header.to_bytes())?;
        let file = self.header.crc();
        let mut bytes = Vec::with_capacity(usize::try_from(self.header.largest_bytes).unwrap_or(0));
        for (index, run) in self.path.runs().enumerate() {
            let head = self.head(index).map(|head| SectionHead { file, ..head });
            bytes.clear();
            bytes.extend(head.into_iter().flat_map(SectionHead::to_bytes));
            self.rows(&run, &mut bytes);
            bytes.extend(crc32(&bytes).to_le_bytes());
            to.write_all(&bytes)?;
        }
        Ok(())
    }

    /// The pieces of a section, each with the coefficients of its numerator and of its weight.
    fn pieces<'r>(&self, run: &PieceInterpolator<'r, R, D>) -> impl Iterator<Item = StoredPiece<'r, R, D>> {
        let pieces = run.pieces;
        let (degree, weights) = (self.shape.degree, self.shape.weights());
        let part = |index: usize, count: usize| index * count..(index + 1) * count;
        pieces.pieces.iter().enumerate().map(move |(index, row)| StoredPiece {
            row,
            numerators: pieces.numerators.get(part(index, degree)).unwrap_or_default(),
            weights: pieces.weights.get(part(index, weights)).unwrap_or_default(),
        })
    }

    /// For a piece that has the short row of a straight one: by how many words its greatest step per chord lies beside what the
    /// least implies, in two's complement.
    fn words_beside(&self, piece: &StoredPiece<'_, R, D>) -> Option<[u8; 2]> {
        let beside = i16::try_from(words_beside(piece.row.step_per_chord)).ok()?;
        let fits = self.shape.beside_bytes() == 2 || i8::try_from(beside).is_ok();
        (fits && is_straight(piece.numerators, piece.weights)).then(|| beside.to_le_bytes())
    }

    /// The rows of a section.
    fn rows(&self, run: &PieceInterpolator<'_, R, D>, bytes: &mut Vec<u8>) {
        self.pieces(run).for_each(|piece| self.piece(&piece, bytes));
        run.lengths.stages.iter().for_each(|stage| self.stage(stage, bytes));
    }

    fn piece(&self, piece: &StoredPiece<'_, R, D>, bytes: &mut Vec<u8>) {
        let StoredPiece { row, numerators, weights } = *piece;
        let beside = self.words_beside(piece);
        bytes.extend(row.origin.iter().flat_map(|x| x.to_le_bytes()));
        let exponents = [row.coordinate_exponent, row.step_exponent, row.range_exponent, row.joint_exponent];
        bytes.extend(exponents.map(i8::cast_unsigned));
        bytes.extend(row.joint_ratio.to_le_bytes());
        let kind = if beside.is_some() { STRAIGHT } else { 0 };
        let joint = (0..).zip(JOINTS).find(|(_, joint)| *joint == row.joint);
        bytes.extend(joint.map(|(number, _): (u8, _)| number | kind));
        let [least, greatest] = row.step_per_chord;
        self.number(least, bytes);
        if let Some(beside) = beside {
            bytes.extend(beside.iter().take(self.shape.beside_bytes()));
            numerators.iter().take(1).flatten().for_each(|x| self.number(*x, bytes));
            return;
        }
        self.number(greatest, bytes);
        numerators.iter().flatten().chain(weights).for_each(|x| self.number(*x, bytes));
    }

    fn stage(&self, stage: &LengthStage<R>, bytes: &mut Vec<u8>) {
        let (shape, bend) = match stage.shape {
            StageShape::Cubic => (0, R::zero()),
            StageShape::Onset => (1, R::zero()),
            StageShape::Steady => (2, R::zero()),
            StageShape::Easing => (3, R::zero()),
            StageShape::Cosine => (4, R::zero()),
            StageShape::Bent(by) => (5, by),
        };
        bytes.extend(stage.duration.to_le_bytes());
        bytes.push(shape);
        [stage.feed, stage.change, bend].iter().for_each(|x| self.number(*x, bytes));
    }

    fn number(&self, x: R, bytes: &mut Vec<u8>) {
        bytes.extend(word_of(x).to_le_bytes().iter().take(self.shape.number));
    }
}

/// A piece and its coefficients.
#[derive(Clone, Copy)]
struct StoredPiece<'r, R, const D: usize> {
    row: &'r Piece<R, D>,
    numerators: &'r [[R; D]],
    weights: &'r [R],
}
