//! What is promised of a stream of any bytes: it is refused, or it is run, and neither panics.

use real::FromWord;
use secant_interp::{
    OverrideState, PieceInterpolator, SECTION_HEAD_BYTES, SectionStorage, StreamError, StreamHeader,
    StreamReader, VERSION, crc32,
};

/// The rows of a small controller.
const PIECES: usize = 64;
const STAGES: usize = 64;
const COEFFICIENTS: usize = 8 * PIECES;
/// Setpoints of a section: any numbers may make a run that stands still for ever.
const MOST_PERIODS: usize = 200;

/// Reads `bytes` as a controller of this format does, and runs what is not refused.
///
/// # Panics
/// When a header that is read is written otherwise.
pub fn reads_stream<R: FromWord, const D: usize>(bytes: &[u8]) {
    let Ok(header) = StreamHeader::read(bytes) else { return };
    let (begin, sections) = bytes.split_at(StreamHeader::BYTES);
    assert_eq!(header.to_bytes(), begin);
    let _ = run_sections::<R, D>(&header, sections);
}

fn run_sections<R: FromWord, const D: usize>(
    header: &StreamHeader,
    mut rest: &[u8],
) -> Result<(), StreamError> {
    let mut reader = StreamReader::<R, D>::new(header)?;
    let mut storage = SectionStorage {
        pieces: &mut [SectionStorage::no_piece(); PIECES],
        numerators: &mut [[R::zero(); D]; COEFFICIENTS],
        weights: &mut [R::zero(); COEFFICIENTS],
        stages: &mut [SectionStorage::<R, D>::no_stage(); STAGES],
    };
    while reader.next_section().is_some() {
        let length = reader.section_bytes(rest)?;
        run(header, &reader.section(rest, &mut storage)?);
        rest = rest.get(length..).unwrap_or_default();
    }
    Ok(())
}

fn run<R: FromWord, const D: usize>(header: &StreamHeader, run: &PieceInterpolator<'_, R, D>) {
    let mut state = run.start();
    for setpoint in (0..MOST_PERIODS).map_while(|_| run.step(&mut state)) {
        let _ = run.pieces.position(setpoint.piece, &setpoint.offset);
    }
    let Some(feed_override) = header.feed_override else { return };
    let (mut state, mut rates) = (run.start(), OverrideState::at(feed_override.commanded));
    for _ in 0..MOST_PERIODS {
        if run.step_overridden(&mut state, &feed_override.feeds, &mut rates).is_none() {
            return;
        }
    }
}

/// The same bytes with the versions of the layout and of the kernels and every CRC as a reader expects them, so that what is behind
/// these is read too.
#[must_use]
pub fn sealed(bytes: &[u8]) -> Vec<u8> {
    let mut file = bytes.to_vec();
    let Some(header) = file.get_mut(..StreamHeader::BYTES) else { return file };
    let [major, minor] = VERSION.map(u16::to_le_bytes);
    header[8..10].copy_from_slice(&StreamHeader::LAYOUT.to_le_bytes());
    header[10..14].copy_from_slice(&[major, minor].concat());
    let of_file = seal(header);
    let mut at = StreamHeader::BYTES;
    while let Some(head) = file.get_mut(at..at + SECTION_HEAD_BYTES) {
        head[4..8].copy_from_slice(&of_file);
        seal(head);
        let length = head[8..].first_chunk().map_or(0, |bytes| u32::from_le_bytes(*bytes) as usize);
        let Some(section) =
            file.get_mut(at..at + length).filter(|section| section.len() > SECTION_HEAD_BYTES + 4)
        else {
            break;
        };
        seal(section);
        at += length;
    }
    file
}

/// Writes the CRC of the bytes before the last four into these four. Returns them.
fn seal(bytes: &mut [u8]) -> [u8; 4] {
    let Some((fields, crc)) = bytes.split_last_chunk_mut() else { return [0; 4] };
    *crc = crc32(fields).to_le_bytes();
    *crc
}
