//! The bytes of a log: unpacked where they are packed, with lines that have an end.

use std::io::{self, Cursor, Read};

use flate2::read::MultiGzDecoder;

use crate::log_error::LogError;

/// Bytes of the begin of a log by which its kind is told.
const HEAD: u64 = 1 << 14;

/// The first two bytes of what gzip packs.
const PACKED: [u8; 2] = [0x1f, 0x8b];

/// A log's text, and its begin.
pub(crate) struct Text<'a> {
    pub(crate) head: Vec<u8>,
    pub(crate) all: Box<dyn Read + 'a>,
}

/// Begins to read a log, and unpacks it if it is packed.
pub(crate) fn begun<'a>(mut source: impl Read + 'a) -> Result<Text<'a>, LogError> {
    let mut first = Vec::new();
    (&mut source).take(2).read_to_end(&mut first).map_err(|error| unreadable(&error))?;
    let is_packed = first == PACKED;
    let source = Cursor::new(first).chain(source);
    let mut unpacked: Box<dyn Read + 'a> =
        if is_packed { Box::new(MultiGzDecoder::new(source)) } else { Box::new(source) };
    let mut head = Vec::new();
    (&mut unpacked).take(HEAD).read_to_end(&mut head).map_err(|error| unreadable(&error))?;
    let all = Box::new(Cursor::new(head.clone()).chain(unpacked));
    Ok(Text { head, all })
}

/// Why bytes could not be had.
pub(crate) fn unreadable(error: &io::Error) -> LogError {
    LogError::whole(format!("cannot read the log: {error}"), "a text, or one that gzip has packed")
}

/// Bytes of a line, at most: a row of a log has some hundred.
const LONGEST_LINE: usize = 1 << 16;

/// A text whose lines are not longer than any row, so that a file of something else takes no memory.
pub(crate) struct BoundedLines<R> {
    source: R,
    /// Bytes since the last end of a line.
    length: usize,
}

impl<R> BoundedLines<R> {
    pub(crate) fn new(source: R) -> Self {
        Self { source, length: 0 }
    }
}

impl<R: Read> Read for BoundedLines<R> {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        let count = self.source.read(into)?;
        for part in into[..count].split_inclusive(|byte| *byte == b'\n' || *byte == b'\r') {
            self.length += part.len();
            if self.length > LONGEST_LINE {
                return Err(io::Error::new(
                    io::ErrorKind::InvalidData,
                    format!("a line is longer than {LONGEST_LINE} bytes"),
                ));
            }
            if part.ends_with(b"\n") || part.ends_with(b"\r") {
                self.length = 0;
            }
        }
        Ok(count)
    }
}
