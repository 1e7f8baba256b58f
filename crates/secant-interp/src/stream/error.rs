//! Why a stream is not read.

use core::fmt;

use real::FormatName;

use crate::VERSION;
use crate::stream::layout::LAYOUT;

/// Why a stream is not read. Sections count from 0, and lengths are in bytes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum StreamError {
    /// There are too few bytes for a header.
    ShortHeader {
        /// The header's length.
        expected: usize,
        /// The bytes that there are.
        found: usize,
    },
    /// The file begins with other bytes than a stream.
    NotAStream {
        /// Its first bytes.
        found: [u8; 8],
    },
    /// The layout is of another version.
    OtherLayout {
        /// The version in the file.
        found: u16,
    },
    /// A byte of the header has changed.
    DamagedHeader {
        /// The CRC in the header.
        expected: u32,
        /// The CRC of the header as it is.
        found: u32,
    },
    /// The stream is for another [`VERSION`] of the kernels.
    OtherKernels {
        /// The version in the file.
        found: [u16; 2],
    },
    /// The stream has other numbers.
    OtherFormat {
        /// The format that is read.
        expected: FormatName,
        /// The name in the file, with zeros behind it.
        found: [u8; 8],
    },
    /// The path is in another number of dimensions.
    OtherDimension {
        /// The dimensions that are read.
        expected: usize,
        /// The dimensions of the file.
        found: u8,
    },
    /// A field of the header has a value that no stream has.
    HeaderField {
        /// The field.
        field: &'static str,
        /// Its value.
        found: u64,
    },
    /// The file is shorter or longer than its header says.
    OtherFileLength {
        /// The length in the header.
        expected: u64,
        /// The file's length.
        found: u64,
    },
    /// All sections have been read.
    NoMoreSections {
        /// How many there are.
        sections: u32,
    },
    /// The section, or its head, is not there as a whole.
    ShortSection {
        /// The section.
        section: u32,
        /// Its length, or that of its head.
        expected: usize,
        /// The bytes that there are.
        found: usize,
    },
    /// A byte of the section's head has changed.
    DamagedHead {
        /// The section that was to come.
        section: u32,
        /// The CRC in the head.
        expected: u32,
        /// The CRC of the head as it is.
        found: u32,
    },
    /// The section is of another file.
    OtherFile {
        /// The section that was to come.
        section: u32,
        /// The CRC of this file's header.
        expected: u32,
        /// The CRC of the header of the section's file.
        found: u32,
    },
    /// Another section comes than the next one.
    OtherSection {
        /// The section that was to come.
        expected: u32,
        /// The section that comes.
        found: u32,
    },
    /// The section's length is not that of its pieces and stages, or above the largest in the header.
    OtherLength {
        /// The section.
        section: u32,
        /// The length of its pieces and stages, or the largest one.
        expected: usize,
        /// The length in its head.
        found: u32,
    },
    /// The caller's storage has too few rows for the section.
    NoRoom {
        /// The section.
        section: u32,
        /// The rows.
        rows: &'static str,
        /// How many the section has.
        needed: usize,
        /// How many the storage has.
        room: usize,
    },
    /// A byte of the section has changed.
    DamagedSection {
        /// The section.
        section: u32,
        /// The CRC in the section.
        expected: u32,
        /// The CRC of the section as it is.
        found: u32,
    },
    /// A field of a row has a value that no stream has.
    SectionField {
        /// The section.
        section: u32,
        /// The field.
        field: &'static str,
        /// The row, from 0.
        row: usize,
    },
}

impl fmt::Display for StreamError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::ShortHeader { expected, found } => {
                write!(f, "the file ends within its header: expected {expected} bytes, found {found}")
            }
            Self::NotAStream { found } => {
                write!(f, "the file begins with \"{}\", expected \"feedbits\"", found.escape_ascii())
            }
            Self::OtherLayout { found } => write!(f, "the layout has version {found}, expected {LAYOUT}"),
            Self::DamagedHeader { expected, found } => {
                write!(f, "the header is damaged: its CRC is {found:#010x}, expected {expected:#010x}")
            }
            Self::OtherKernels { found: [major, minor] } => {
                let [own_major, own_minor] = VERSION;
                write!(f, "the file is for kernels {major}.{minor}, expected {own_major}.{own_minor}")
            }
            Self::OtherFormat { expected, found } => {
                let name = found.split(|byte| *byte == 0).next().unwrap_or_default();
                write!(f, "the file has numbers of {}, expected {expected}", name.escape_ascii())
            }
            Self::OtherDimension { expected, found } => {
                write!(f, "the path has {found} dimensions, expected {expected}")
            }
            Self::HeaderField { field, found } => {
                write!(f, "the header's {field} is {found}, which no file has")
            }
            Self::OtherFileLength { expected, found } => {
                write!(f, "the file has {found} bytes, expected {expected}")
            }
            Self::NoMoreSections { sections } => write!(f, "all {sections} sections have been read"),
            Self::ShortSection { section, expected, found } => {
                write!(f, "section {section} ends early: expected {expected} bytes, found {found}")
            }
            Self::DamagedHead { section, expected, found } => write!(
                f,
                "the head of section {section} is damaged: its CRC is {found:#010x}, expected {expected:#010x}"
            ),
            Self::OtherFile { section, expected, found } => write!(
                f,
                "section {section} is of a file with header {found:#010x}, expected {expected:#010x}"
            ),
            Self::OtherSection { expected, found } => {
                write!(f, "section {found} comes, expected section {expected}")
            }
            Self::OtherLength { section, expected, found } => {
                write!(f, "section {section} has {found} bytes, expected {expected}")
            }
            Self::NoRoom { section, rows, needed, room } => {
                write!(f, "section {section} has {needed} {rows}, and there is room for {room}")
            }
            Self::DamagedSection { section, expected, found } => {
                write!(f, "section {section} is damaged: its CRC is {found:#010x}, expected {expected:#010x}")
            }
            Self::SectionField { section, field, row } => {
                write!(f, "section {section}: the {field} of row {row} is one that no file has")
            }
        }
    }
}

impl core::error::Error for StreamError {}
