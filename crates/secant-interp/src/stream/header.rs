//! The header of a stream: what the whole path has in common.

use core::fmt::{self, Write};

use nurbs_core::MAX_DEGREE;
use real::FormatName;

use crate::VERSION;
use crate::stream::bytes::Bytes;
use crate::stream::crc32::crc32;
use crate::stream::error::StreamError;
use crate::stream::layout::{CRC_BYTES, LAYOUT, MAGIC, RowShape};
use crate::stream::stored_override::{NoOverride, StreamOverride};

/// The header of a stream, which comes before its sections.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StreamHeader {
    /// The name of the number format, with zeros behind it.
    pub format: [u8; 8],
    /// D, the number of coordinates of a point.
    pub dimension: u8,
    /// p, the degree of all pieces.
    pub degree: u8,
    /// Whether pieces have weights.
    pub has_weights: bool,
    /// T, the interpolation period, in s.
    pub period_s: f64,
    /// Offsets are in units of 2^this mm: [`Pieces::coordinate_exponent`](nurbs_core::Pieces::coordinate_exponent).
    pub coordinate_exponent: i32,
    /// λ: chords are in units of 2^-λ mm.
    pub chord_exponent: i32,
    /// The words of the landing step, and of the tolerance's residual, growth and fluctuation.
    pub(crate) numbers: [u64; 4],
    /// K: evaluations in a period, at most; not above 1000.
    pub max_evaluations: u32,
    /// What the plan leaves for changes of the feed, if it was made for feed override.
    pub feed_override: Option<StreamOverride>,
    /// How many sections there are.
    pub sections: u32,
    /// Bytes of the longest section: the buffer that a reader needs.
    pub largest_bytes: u32,
    /// Pieces of the section that has most of them.
    pub largest_pieces: u32,
    /// Stages of the section that has most of them.
    pub largest_stages: u32,
    /// Bytes of the whole file.
    pub file_bytes: u64,
    /// Setpoints from begin to end, without overrides.
    pub periods: u64,
    /// [`PositionChecksum`](crate::PositionChecksum) of all of them.
    pub checksum: u64,
}

/// The most evaluations that a period may be allowed: more would not end within a period on any controller.
pub(crate) const MOST_EVALUATIONS: u32 = 1000;

impl StreamHeader {
    /// Bytes of a header.
    pub const BYTES: usize = 164;

    /// The version of the layout that is read and written.
    pub const LAYOUT: u16 = LAYOUT;

    /// The header at the begin of `bytes`.
    ///
    /// # Errors
    /// [`StreamError`], the first one that holds: `ShortHeader`, `NotAStream`, `OtherLayout`, `DamagedHeader`,
    /// `OtherKernels`, `HeaderField`.
    pub fn read(bytes: &[u8]) -> Result<Self, StreamError> {
        let short = StreamError::ShortHeader { expected: Self::BYTES, found: bytes.len() };
        let header = bytes.first_chunk::<{ Self::BYTES }>().ok_or(short)?;
        let (fields, crc) = header.split_last_chunk::<CRC_BYTES>().ok_or(short)?;
        let mut bytes = Bytes(fields);
        let found = bytes.next().ok_or(short)?;
        if found != MAGIC {
            return Err(StreamError::NotAStream { found });
        }
        let found = bytes.u16().ok_or(short)?;
        if found != LAYOUT {
            return Err(StreamError::OtherLayout { found });
        }
        let (expected, found) = (u32::from_le_bytes(*crc), crc32(fields));
        if expected != found {
            return Err(StreamError::DamagedHeader { expected, found });
        }
        let found = bytes.array(Bytes::u16).ok_or(short)?;
        if found != VERSION {
            return Err(StreamError::OtherKernels { found });
        }
        Self::fields(&mut bytes).ok_or(short)?
    }

    /// The fields behind the versions; `None` if there are too few bytes.
    fn fields(bytes: &mut Bytes<'_>) -> Option<Result<Self, StreamError>> {
        let refused = |field, found: u64| Some(Err(StreamError::HeaderField { field, found }));
        let (dimension, degree, format) = (bytes.u8()?, bytes.u8()?, bytes.next()?);
        if !(1..=MAX_DEGREE).contains(&usize::from(degree)) {
            return refused("degree", degree.into());
        }
        let weights = bytes.u32()?;
        if weights > 1 {
            return refused("sign of weights", weights.into());
        }
        let max_evaluations = bytes.u32()?;
        if max_evaluations > MOST_EVALUATIONS {
            return refused("number of evaluations", max_evaluations.into());
        }
        // Fields are taken in the order in which they stand here.
        let header = Self {
            format,
            dimension,
            degree,
            has_weights: weights == 1,
            max_evaluations,
            coordinate_exponent: bytes.i32()?,
            chord_exponent: bytes.i32()?,
            period_s: f64::from_bits(bytes.u64()?),
            numbers: bytes.array(Bytes::u64)?,
            feed_override: match StreamOverride::of_words(bytes.array(Bytes::u64)?) {
                Ok(feed_override) => feed_override,
                Err(NoOverride { bend }) => return refused("feed override", bend),
            },
            sections: bytes.u32()?,
            largest_bytes: bytes.u32()?,
            largest_pieces: bytes.u32()?,
            largest_stages: bytes.u32()?,
            file_bytes: bytes.u64()?,
            periods: bytes.u64()?,
            checksum: bytes.u64()?,
        };
        // A reader that compares the length of its file takes no buffer that is longer.
        if u64::from(header.largest_bytes) > header.file_bytes {
            return refused("largest section", header.largest_bytes.into());
        }
        Some(Ok(header))
    }

    /// The bytes of the header.
    #[must_use]
    pub fn to_bytes(&self) -> [u8; Self::BYTES] {
        let [major, minor] = VERSION;
        let [landing_step, residual, growth, fluctuation] = self.numbers;
        let [slope, bend, acceleration, jerk, commanded] = StreamOverride::words(self.feed_override.as_ref());
        let fields: [&[u8]; 27] = [
            &MAGIC,
            &LAYOUT.to_le_bytes(),
            &major.to_le_bytes(),
            &minor.to_le_bytes(),
            &[self.dimension, self.degree],
            &self.format,
            &u32::from(self.has_weights).to_le_bytes(),
            &self.max_evaluations.to_le_bytes(),
            &self.coordinate_exponent.to_le_bytes(),
            &self.chord_exponent.to_le_bytes(),
            &self.period_s.to_bits().to_le_bytes(),
            &landing_step.to_le_bytes(),
            &residual.to_le_bytes(),
            &growth.to_le_bytes(),
            &fluctuation.to_le_bytes(),
            &slope.to_le_bytes(),
            &bend.to_le_bytes(),
            &acceleration.to_le_bytes(),
            &jerk.to_le_bytes(),
            &commanded.to_le_bytes(),
            &self.sections.to_le_bytes(),
            &self.largest_bytes.to_le_bytes(),
            &self.largest_pieces.to_le_bytes(),
            &self.largest_stages.to_le_bytes(),
            &self.file_bytes.to_le_bytes(),
            &self.periods.to_le_bytes(),
            &self.checksum.to_le_bytes(),
        ];
        let mut header = [0; Self::BYTES];
        let bytes = fields.iter().flat_map(|field| field.iter());
        header.iter_mut().zip(bytes).for_each(|(to, byte)| *to = *byte);
        if let Some((fields, crc)) = header.split_last_chunk_mut::<CRC_BYTES>() {
            *crc = crc32(fields).to_le_bytes();
        }
        header
    }

    /// The CRC of the header, by which its sections know it.
    pub(crate) fn crc(&self) -> u32 {
        self.to_bytes().last_chunk().map_or(0, |crc| u32::from_le_bytes(*crc))
    }

    /// The name of the number format; empty if it is no text.
    #[must_use]
    pub fn format_name(&self) -> &str {
        let name = self.format.split(|byte| *byte == 0).next().unwrap_or_default();
        core::str::from_utf8(name).unwrap_or_default()
    }

    /// What the lengths of rows depend on, for numbers of so many bytes.
    pub(crate) fn row_shape(&self, number: usize) -> RowShape {
        let (dimension, degree) = (self.dimension.into(), self.degree.into());
        RowShape { dimension, degree, has_weights: self.has_weights, number }
    }

    /// For a reader that knows the file's length: refuses a file that is not whole, before its first section.
    ///
    /// # Errors
    /// [`StreamError::OtherFileLength`].
    pub fn expect_file_bytes(&self, found: u64) -> Result<(), StreamError> {
        let expected = self.file_bytes;
        if found == expected { Ok(()) } else { Err(StreamError::OtherFileLength { expected, found }) }
    }
}

/// The name of a format as a header has it: its letters and digits, and zeros behind them. What is longer than eight bytes
/// is cut off.
pub(crate) fn name_in_header(format: FormatName) -> [u8; 8] {
    let mut name = Name { bytes: [0; 8], length: 0 };
    let _ = write!(name, "{format}"); // What does not fit is cut off.
    name.bytes
}

/// A short text.
struct Name {
    bytes: [u8; 8],
    length: usize,
}

impl Write for Name {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for byte in text.bytes() {
            *self.bytes.get_mut(self.length).ok_or(fmt::Error)? = byte;
            self.length += 1;
        }
        Ok(())
    }
}
