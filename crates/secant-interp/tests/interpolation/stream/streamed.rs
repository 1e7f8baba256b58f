//! A path with stops, as a stream, and a controller that reads it.

use feed_plan::{EndFeeds, FeedLimit, KinematicLimits, ProfileKind, ScheduleBuf, Stage, plan_with};
use nurbs_core::{NurbsBuf, PieceLimits, compile_with_stops};
use real::{Backend, DoubleDouble, FromWord};
use secant_interp::{
    ChordTolerance, CompiledPath, FeedOverride, PathStream, PieceInterpolator, SECTION_HEAD_BYTES,
    SectionBuf, StreamError, StreamHeader, StreamReader, StreamedRun, crc32,
};

use crate::landing_run::overrides;

/// Lines and arcs with corners that stop the plan. Coordinates beyond the plane rise with each curve.
fn curves<const D: usize>(rational: bool) -> Vec<NurbsBuf<f64, D>> {
    let lift = |[x, y]: [f64; 2], z: f64| core::array::from_fn(|d| [x, y, z][d]);
    let corners = [[0.0, 0.0], [3.0, 0.0], [3.0, 2.0], [6.0, 2.5], [4.0, 5.0], [0.0, 5.0]];
    let mut curves = Vec::new();
    for (index, pair) in (0..).zip(corners.windows(2)) {
        let height = f64::from(index) * 0.25;
        let ends = pair.iter().zip([height, height + 0.25]).map(|(point, z)| lift(*point, z)).collect();
        curves.push(NurbsBuf::try_new_nonrational(1, ends, vec![0.0, 0.0, 1.0, 1.0]).unwrap());
    }
    let bend = [[0.0, 5.0], [-2.0, 5.0], [-2.0, 7.0]].map(|point| lift(point, 1.25)).to_vec();
    let weights = if rational { vec![1.0, 0.5_f64.sqrt(), 1.0] } else { vec![1.0; 3] };
    curves.push(NurbsBuf::try_new(2, bend, weights, vec![0.0, 0.0, 0.0, 1.0, 1.0, 1.0]).unwrap());
    curves
}

fn limits(share: f64) -> KinematicLimits<f64> {
    KinematicLimits {
        interpolation_period: 1.0,
        feedrate: 0.1,
        acceleration: share * 0.008,
        jerk: share * 0.001,
        chord_error: 0.001,
        centripetal_acceleration: None,
        axes: Default::default(),
        junction: Default::default(),
    }
}

/// Path and plan with a reserve, and what an override may do with it.
pub(crate) fn compiled<R: Backend, const D: usize>(rational: bool) -> (CompiledPath<R, D>, FeedOverride) {
    compiled_for(rational, 5)
}

/// The same for so many evaluations in a period.
pub(crate) fn compiled_for<R: Backend, const D: usize>(
    rational: bool,
    evaluations: u32,
) -> (CompiledPath<R, D>, FeedOverride) {
    let (curves, machine, kept) = (curves::<D>(rational), limits(1.0), limits(0.8));
    let whole: Vec<_> = curves.iter().map(NurbsBuf::as_curve).collect();
    let limit = FeedLimit::along(&whole, &kept).unwrap();
    let arcs = plan_with(&limit, &kept, EndFeeds::default(), ProfileKind::default()).unwrap();
    let plan: ScheduleBuf<f64> = limit.in_chords(&whole, &arcs);
    let feeds = overrides(&plan, &machine);
    let stops: Vec<_> = plan.stages().iter().filter_map(Stage::rest).collect();
    let cut = PieceLimits { length_mm: 2.0, step_mm: machine.feedrate + machine.acceleration };
    let table = compile_with_stops::<DoubleDouble, R, D>(&whole, &cut, &stops).unwrap();
    let tolerance = ChordTolerance::for_fluctuation(None, evaluations);
    let path = CompiledPath::new(table, &plan.as_schedule(), tolerance, machine.acceleration).unwrap();
    assert!(path.sections().len() > 4, "{}: the path has stops", R::name());
    (path, feeds)
}

/// The file of a path. `periods` only tells files apart.
pub(crate) fn file_of<R: Backend, const D: usize>(path: &CompiledPath<R, D>, periods: u64) -> Vec<u8> {
    file_with(path, &StreamedRun { period_s: 1e-3, periods, checksum: 7, feed_override: None })
}

/// The file of a path, and of what else it says.
pub(crate) fn file_with<R: Backend, const D: usize>(path: &CompiledPath<R, D>, run: &StreamedRun) -> Vec<u8> {
    let stream = PathStream::new(path, run).unwrap();
    let mut file = Vec::new();
    stream.write(&mut file).unwrap();
    let sections: u64 = stream.section_bytes().map(u64::from).sum();
    assert_eq!(file.len() as u64, StreamHeader::BYTES as u64 + sections);
    assert_eq!(stream.header().expect_file_bytes(file.len() as u64), Ok(()));
    file
}

/// Where each section begins and ends in a file.
pub(crate) fn places(file: &[u8]) -> Vec<std::ops::Range<usize>> {
    let mut at = StreamHeader::BYTES;
    let length = |at: usize| u32::from_le_bytes(*file[at + 8..].first_chunk().unwrap()) as usize;
    core::iter::from_fn(|| {
        (at < file.len()).then(|| {
            let place = at..at + length(at);
            at = place.end;
            place
        })
    })
    .collect()
}

/// Reads a file as a controller does, with a buffer and rows of the sizes in its header. Each section is given to `run`.
/// Returns how many there were, and the error that ended the reading.
pub(crate) fn read<R: FromWord, const D: usize>(
    file: &[u8],
    mut run: impl FnMut(&PieceInterpolator<'_, R, D>),
) -> (usize, Result<(), StreamError>) {
    let mut done = 0;
    let result = (|| {
        let header = StreamHeader::read(file)?;
        let mut reader = StreamReader::<R, D>::new(&header)?;
        let buffer = vec![0; header.largest_bytes as usize];
        let mut rows = SectionBuf::<R, D>::for_stream(&header, &buffer)?;
        let mut storage = rows.storage();
        let mut rest = &file[StreamHeader::BYTES..];
        while reader.next_section().is_some() {
            let length = reader.section_bytes(&rest[..rest.len().min(SECTION_HEAD_BYTES)])?;
            assert!(length <= header.largest_bytes as usize);
            let section = &rest[..rest.len().min(length)];
            run(&reader.section(section, &mut storage)?);
            (done, rest) = (done + 1, &rest[length..]);
        }
        Ok(())
    })();
    (done, result)
}

/// Writes the CRC of the bytes before the last four into these four.
pub(crate) fn seal(bytes: &mut [u8]) {
    let (fields, crc) = bytes.split_last_chunk_mut().unwrap();
    *crc = crc32(fields).to_le_bytes();
}
