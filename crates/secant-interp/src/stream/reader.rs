//! The controller's side of a stream: it takes one section after the other from a buffer.

use nurbs_core::Pieces;
use real::FromWord;

use crate::pieces::chord_step::ChordTolerance;
use crate::pieces::piece_interpolator::PieceInterpolator;
use crate::step_lengths::StepLengths;
use crate::stream::bytes::Bytes;
use crate::stream::crc32::crc32;
use crate::stream::error::StreamError;
use crate::stream::header::{StreamHeader, name_in_header};
use crate::stream::layout::{CRC_BYTES, RowShape, SECTION_HEAD_BYTES};
use crate::stream::section_head::SectionHead;
use crate::stream::storage::SectionStorage;

/// Reads the sections of a stream in their order.
///
/// The caller reads bytes from wherever they lie: for each section first its head of [`SECTION_HEAD_BYTES`], and then as
/// many as [`section_bytes`](Self::section_bytes) says. A section becomes rows in a [`SectionStorage`] before its first
/// setpoint. So the buffer is free for the next section while this one is run, and a section that is damaged is refused
/// while the machine stands on the rest before it.
///
/// An error leaves the reader where it is: the section may be read again.
#[derive(Clone, Copy, Debug)]
pub struct StreamReader<R, const D: usize> {
    shape: RowShape,
    coordinate_exponent: i32,
    chord_exponent: i32,
    tolerance: ChordTolerance<R>,
    landing_step: R,
    file: u32,
    largest_bytes: u32,
    sections: u32,
    next: u32,
}

impl<R: FromWord, const D: usize> StreamReader<R, D> {
    /// A reader before the first section.
    ///
    /// # Errors
    /// [`StreamError::OtherFormat`] and [`StreamError::OtherDimension`] if the file has other numbers than `R` or other
    /// points than `D` has.
    pub fn new(header: &StreamHeader) -> Result<Self, StreamError> {
        if header.format != name_in_header(R::name()) {
            return Err(StreamError::OtherFormat { expected: R::name(), found: header.format });
        }
        if usize::from(header.dimension) != D {
            return Err(StreamError::OtherDimension { expected: D, found: header.dimension });
        }
        let [landing_step, residual, growth, fluctuation] = header.numbers.map(R::from_word);
        Ok(Self {
            shape: header.row_shape(R::BYTES),
            coordinate_exponent: header.coordinate_exponent,
            chord_exponent: header.chord_exponent,
            tolerance: ChordTolerance {
                residual,
                growth,
                fluctuation,
                max_evaluations: header.max_evaluations,
            },
            landing_step,
            file: header.crc(),
            largest_bytes: header.largest_bytes,
            sections: header.sections,
            next: 0,
        })
    }

    /// The number of the section that comes next; `None` behind the last one.
    #[must_use]
    pub fn next_section(&self) -> Option<u32> {
        (self.next < self.sections).then_some(self.next)
    }

    /// The bytes of the next section, its head included, of which `head` has at least [`SECTION_HEAD_BYTES`]. They are no
    /// more than [`StreamHeader::largest_bytes`].
    ///
    /// # Errors
    /// [`StreamError`], the first one that holds: `NoMoreSections`, `ShortSection`, `DamagedHead`, `OtherFile`,
    /// `OtherSection`, `OtherLength`.
    pub fn section_bytes(&self, head: &[u8]) -> Result<usize, StreamError> {
        self.head(head).map(|(_, bytes)| bytes)
    }

    /// The head of the next section, and the section's length.
    fn head(&self, bytes: &[u8]) -> Result<(SectionHead, usize), StreamError> {
        let none_left = StreamError::NoMoreSections { sections: self.sections };
        let section = self.next_section().ok_or(none_left)?;
        let head = SectionHead::read(bytes, section, self.file)?;
        let other = |expected| StreamError::OtherLength { section, expected, found: head.bytes };
        let length = self.shape.section_bytes(&head.rows()).unwrap_or(usize::MAX);
        if u32::try_from(length) != Ok(head.bytes) {
            return Err(other(length));
        }
        if head.bytes > self.largest_bytes {
            return Err(other(usize::try_from(self.largest_bytes).unwrap_or(usize::MAX)));
        }
        Ok((head, length))
    }

    /// The run of the next section, whose bytes are the first of `bytes`, on rows in `storage`. It is the run of
    /// [`CompiledPath::runs`](crate::CompiledPath::runs), and its setpoints are the same bit for bit.
    ///
    /// # Errors
    /// As of [`section_bytes`](Self::section_bytes); then [`StreamError::NoRoom`] if the storage has too few rows,
    /// [`StreamError::ShortSection`], [`StreamError::DamagedSection`], and [`StreamError::SectionField`] for a value that
    /// no writer writes.
    pub fn section<'s>(
        &mut self,
        bytes: &[u8],
        storage: &'s mut SectionStorage<'_, R, D>,
    ) -> Result<PieceInterpolator<'s, R, D>, StreamError> {
        let (head, length) = self.head(bytes)?;
        let section = head.number;
        let short = StreamError::ShortSection { section, expected: length, found: bytes.len() };
        let (fields, crc) =
            bytes.get(..length).and_then(<[u8]>::split_last_chunk::<CRC_BYTES>).ok_or(short)?;
        let (expected, found) = (u32::from_le_bytes(*crc), crc32(fields));
        if expected != found {
            return Err(StreamError::DamagedSection { section, expected, found });
        }
        let mut rows = storage.rows_of(&head, &self.shape)?;
        let mut bytes = Bytes(fields.get(SECTION_HEAD_BYTES..).unwrap_or_default());
        rows.fill(&mut bytes, &self.shape, &head).unwrap_or(Err(short))?;
        let SectionStorage { pieces, numerators, weights, stages } = rows;
        self.next += 1;
        Ok(PieceInterpolator {
            pieces: Pieces {
                pieces,
                numerators,
                weights,
                degree: self.shape.degree,
                coordinate_exponent: self.coordinate_exponent,
                chord_exponent: self.chord_exponent,
            },
            lengths: StepLengths { stages, crossings: &[] },
            tolerance: self.tolerance,
            landing_step: self.landing_step,
        })
    }
}
