//! The head of a section: which one it is, and how long.

use crate::stream::bytes::Bytes;
use crate::stream::crc32::crc32;
use crate::stream::error::StreamError;
use crate::stream::layout::{CRC_BYTES, SECTION_HEAD_BYTES, SectionRows};

/// The head of a section.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct SectionHead {
    /// The section, from 0.
    pub(crate) number: u32,
    /// The CRC of the header of its file.
    pub(crate) file: u32,
    /// Bytes from the head's first to the last of the section's CRC.
    pub(crate) bytes: u32,
    pub(crate) pieces: u32,
    /// Pieces with the short row of a straight one.
    pub(crate) straight: u32,
    pub(crate) stages: u32,
}

impl SectionHead {
    /// The head at the begin of `bytes`, if it is the one that comes next.
    pub(crate) fn read(bytes: &[u8], next: u32, file: u32) -> Result<Self, StreamError> {
        let short =
            StreamError::ShortSection { section: next, expected: SECTION_HEAD_BYTES, found: bytes.len() };
        let head = bytes.first_chunk::<SECTION_HEAD_BYTES>().ok_or(short)?;
        let (fields, crc) = head.split_last_chunk::<CRC_BYTES>().ok_or(short)?;
        let (expected, found) = (u32::from_le_bytes(*crc), crc32(fields));
        if expected != found {
            return Err(StreamError::DamagedHead { section: next, expected, found });
        }
        let [number, of_file, bytes, pieces, straight, stages] =
            Bytes(fields).array(Bytes::u32).ok_or(short)?;
        if of_file != file {
            return Err(StreamError::OtherFile { section: next, expected: file, found: of_file });
        }
        if number != next {
            return Err(StreamError::OtherSection { expected: next, found: number });
        }
        Ok(Self { number, file, bytes, pieces, straight, stages })
    }

    /// How many rows there are.
    pub(crate) fn rows(&self) -> SectionRows {
        let [pieces, straight, stages] = [self.pieces, self.straight, self.stages]
            .map(|count| usize::try_from(count).unwrap_or(usize::MAX));
        SectionRows { pieces, straight, stages }
    }

    /// The bytes of the head.
    #[cfg(feature = "std")]
    pub(crate) fn to_bytes(self) -> [u8; SECTION_HEAD_BYTES] {
        let fields = [self.number, self.file, self.bytes, self.pieces, self.straight, self.stages];
        let mut head = [0; SECTION_HEAD_BYTES];
        let bytes = fields.iter().flat_map(|field| field.to_le_bytes());
        head.iter_mut().zip(bytes).for_each(|(to, byte)| *to = byte);
        if let Some((fields, crc)) = head.split_last_chunk_mut::<CRC_BYTES>() {
            *crc = crc32(fields).to_le_bytes();
        }
        head
    }
}
