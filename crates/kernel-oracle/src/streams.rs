//! Streams of any content with right checksums: each is refused, or it is run, and the run goes forward.

use std::sync::OnceLock;

use arbitrary::{Arbitrary, Unstructured};
use feed_plan::{EndFeeds, FeedLimit, KinematicLimits, ProfileKind, Stage, plan_with};
use nurbs_core::{NurbsBuf, PieceLimits, compile_with_stops};
use real::{Backend, FromWord, I4F28};
use secant_interp::{
    BEHIND_JOINT, ChordTolerance, CompiledPath, OverrideState, PathStream, PieceInterpolator,
    SECTION_HEAD_BYTES, SectionStorage, StreamError, StreamHeader, StreamReader, StreamedRun, VERSION, crc32,
};

use crate::fault::KernelFault;

/// The rows of a small controller.
const PIECES: usize = 64;
const STAGES: usize = 64;
const COEFFICIENTS: usize = 8 * PIECES;
/// Setpoints of a section: any numbers may make a run that stands still for ever.
const MOST_PERIODS: usize = 200;

/// Reads `bytes` as a controller of this format does, and runs what is not refused. Returns the sections that were run.
///
/// # Errors
/// A header that is written otherwise than it was read, a run that goes back or takes more evaluations than its header allows.
pub fn reads_stream<R: FromWord, const D: usize>(bytes: &[u8]) -> Result<usize, KernelFault> {
    let Ok(header) = StreamHeader::read(bytes) else { return Ok(0) };
    let (begin, sections) = bytes.split_at(StreamHeader::BYTES);
    if header.to_bytes() != begin {
        return Err(fault::<R>("a header that is read", "other bytes".into(), "the same bytes".into()));
    }
    let (mut done, mut broken) = (0, None);
    let _ = run_sections::<R, D>(&header, sections, |run| {
        broken = broken.take().or(goes_forward(&header, run).err());
        done += 1;
    });
    broken.map_or(Ok(done), Err)
}

fn fault<R: Backend>(what: &str, found: String, expected: String) -> KernelFault {
    KernelFault { what: what.into(), format: R::name().to_string(), found, expected }
}

fn run_sections<R: FromWord, const D: usize>(
    header: &StreamHeader,
    mut rest: &[u8],
    mut run: impl FnMut(&PieceInterpolator<'_, R, D>),
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
        run(&reader.section(rest, &mut storage)?);
        rest = rest.get(length..).unwrap_or_default();
    }
    Ok(())
}

/// Whatever the numbers of a section are, a run on it goes forward, and a step takes no more evaluations than are allowed.
fn goes_forward<R: FromWord, const D: usize>(
    header: &StreamHeader,
    run: &PieceInterpolator<'_, R, D>,
) -> Result<(), KernelFault> {
    let mut state = run.start();
    let mut from = (0, 0);
    for setpoint in (0..MOST_PERIODS).map_while(|_| run.step(&mut state)) {
        let _ = run.pieces.position(setpoint.piece, &setpoint.offset);
        let to = (setpoint.piece, setpoint.phase);
        if to < from || to.0 > run.pieces.pieces.len() {
            return Err(fault::<R>("a step of a stream", format!("to {to:?}"), format!("from {from:?} on")));
        }
        let joints = u32::try_from(to.0 - from.0).unwrap_or(u32::MAX / 4);
        // A step takes one even where a header allows none.
        let most = run.tolerance.max_evaluations.max(1) + BEHIND_JOINT * joints;
        if setpoint.evaluations > most {
            let found = setpoint.evaluations.to_string();
            return Err(fault::<R>("the evaluations of a step", found, format!("at most {most}")));
        }
        from = to;
    }
    let Some(feed_override) = header.feed_override else { return Ok(()) };
    let (mut state, mut rates) = (run.start(), OverrideState::at(feed_override.commanded));
    for _ in 0..MOST_PERIODS {
        if run.step_overridden(&mut state, &feed_override.feeds, &mut rates).is_none() {
            break;
        }
    }
    Ok(())
}

/// The same bytes with the versions of the layout and of the kernels and every CRC as a reader expects them, so that what
/// these would hide is read too.
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

/// A good stream of which some words are changed and the checksums made right again.
#[derive(Clone, Debug)]
pub struct StreamCase {
    in_fixed_point: bool,
    changes: Vec<(u16, Change)>,
}

/// What is done to the four bytes from a place on.
#[derive(Clone, Copy, Debug)]
enum Change {
    Bit(u8),
    Word(u32),
    /// The word at another place of the stream.
    Copy(u16),
}

impl<'a> Arbitrary<'a> for StreamCase {
    fn arbitrary(bytes: &mut Unstructured<'a>) -> arbitrary::Result<Self> {
        let in_fixed_point = bytes.arbitrary()?;
        let change = |bytes: &mut Unstructured<'a>| -> arbitrary::Result<(u16, Change)> {
            let place = bytes.arbitrary()?;
            let change = match bytes.int_in_range(0..=3)? {
                0 => Change::Bit(bytes.int_in_range(0..=31)?),
                1 => Change::Word([0, 1, u32::MAX, 1 << 31, (1 << 31) - 1][bytes.choose_index(5)?]),
                2 => Change::Word(bytes.arbitrary()?),
                _ => Change::Copy(bytes.arbitrary()?),
            };
            Ok((place, change))
        };
        let count = bytes.int_in_range(0..=6)?;
        let changes = (0..count).map(|_| change(bytes)).collect::<arbitrary::Result<_>>()?;
        Ok(Self { in_fixed_point, changes })
    }
}

impl StreamCase {
    /// Reads and runs the changed stream. Returns the sections that were run, and how many the good stream has.
    ///
    /// # Errors
    /// As [`reads_stream`], and where a stream without a change is not run whole.
    pub fn check(&self) -> Result<(usize, usize), KernelFault> {
        static STREAMS: OnceLock<[Stream; 2]> = OnceLock::new();
        let [float, fixed] = STREAMS.get_or_init(|| [stream::<f64>(), stream::<I4F28>()]);
        let good = if self.in_fixed_point { fixed } else { float };
        let file = sealed(&self.changed(&good.bytes));
        let run = if self.in_fixed_point {
            reads_stream::<I4F28, 2>(&file)?
        } else {
            reads_stream::<f64, 2>(&file)?
        };
        if self.changes.is_empty() && run != good.sections {
            let found = format!("{run} sections");
            return Err(fault::<f64>("a good stream", found, format!("{} sections", good.sections)));
        }
        Ok((run, good.sections))
    }

    fn changed(&self, good: &[u8]) -> Vec<u8> {
        let mut file = good.to_vec();
        let places = file.len().saturating_sub(3);
        for (place, change) in &self.changes {
            let at = usize::from(*place) % places;
            let word = |at: usize| {
                good.get(at..).and_then(|rest| rest.first_chunk()).map_or(0, |word| u32::from_le_bytes(*word))
            };
            let word = match change {
                Change::Bit(bit) => word(at) ^ 1 << bit,
                Change::Word(word) => *word,
                Change::Copy(from) => word(usize::from(*from) % places),
            };
            file[at..at + 4].copy_from_slice(&word.to_le_bytes());
        }
        file
    }
}

/// A good stream.
struct Stream {
    bytes: Vec<u8>,
    sections: usize,
}

/// Two lines with a stop between them, and an arc by weights.
///
/// # Panics
/// Where this path, which is always the same, is refused.
fn stream<R: FromWord>() -> Stream {
    let line = |from, to| NurbsBuf::try_new_nonrational(1, vec![from, to], vec![0.0, 0.0, 1.0, 1.0]);
    let bend = [[3.0, 2.0], [3.0, 4.0], [1.0, 4.0]].to_vec();
    let arc = NurbsBuf::try_new(2, bend, vec![1.0, 0.5_f64.sqrt(), 1.0], vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0]);
    let curves = [line([0.0, 0.0], [3.0, 0.0]), line([3.0, 0.0], [3.0, 2.0]), arc]
        .map(|curve| curve.expect("a curve"));
    let curves: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
    let limits = KinematicLimits {
        interpolation_period: 1.0,
        feedrate: 0.1,
        acceleration: 0.008,
        jerk: 0.001,
        chord_error: 0.001,
        centripetal_acceleration: None,
        axes: Default::default(),
        junction: Default::default(),
    };
    let limit = FeedLimit::along(&curves, &limits).expect("limits");
    let arcs = plan_with(&limit, &limits, EndFeeds::default(), ProfileKind::default()).expect("a plan");
    let plan = limit.in_chords(&curves, &arcs);
    let stops: Vec<_> = plan.stages().iter().filter_map(Stage::rest).collect();
    let cut = PieceLimits { length_mm: 2.0, step_mm: limits.feedrate + limits.acceleration };
    let table = compile_with_stops::<f64, R, 2>(&curves, &cut, &stops).expect("pieces");
    let tolerance = ChordTolerance::for_fluctuation(None, 5);
    let path = CompiledPath::new(table, &plan.as_schedule(), tolerance, limits.acceleration).expect("a path");
    let run = StreamedRun {
        period_s: 1e-3,
        periods: plan.as_schedule().periods(),
        checksum: 7,
        feed_override: None,
    };
    let stream = PathStream::new(&path, &run).expect("a stream");
    let mut bytes = Vec::new();
    stream.write(&mut bytes).expect("memory");
    Stream { bytes, sections: path.sections().len() }
}
