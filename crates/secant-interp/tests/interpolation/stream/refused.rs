//! What is damaged, swapped, cut off or of another kind is refused by its name, and no section behind it is run.

use proptest::prelude::*;
use real::{Backend, FromWord, I3F29, I4F28};
use secant_interp::{
    NoStream, PathStream, SECTION_HEAD_BYTES, SectionBuf, SectionStorage, StreamError, StreamHeader,
    StreamReader, StreamedRun,
};

use super::streamed::{compiled, compiled_for, file_of, places, read, seal};

fn file() -> Vec<u8> {
    file_of(&compiled::<I4F28, 2>(true).0, 0)
}

/// The sections that are read from a file, and the error behind them.
fn refusal(file: &[u8]) -> (usize, StreamError) {
    let (done, end) = read::<I4F28, 2>(file, |_| {});
    (done, end.expect_err("a damaged file was read"))
}

/// Whether the error is the one for a change of this byte.
fn names_the_place(file: &[u8], at: usize, (done, error): (usize, StreamError)) -> bool {
    let Some(number) = places(file).iter().position(|place| place.contains(&at)) else {
        return done == 0
            && match error {
                StreamError::NotAStream { .. } => at < 8,
                StreamError::OtherLayout { .. } => at == 8 || at == 9,
                StreamError::DamagedHeader { .. } => (10..StreamHeader::BYTES).contains(&at),
                _ => false,
            };
    };
    let is_head = at < places(file)[number].start + SECTION_HEAD_BYTES;
    let number = u32::try_from(number).unwrap();
    done == number as usize
        && match error {
            StreamError::DamagedHead { section, .. } => is_head && section == number,
            StreamError::DamagedSection { section, .. } => !is_head && section == number,
            _ => false,
        }
}

/// Every bit of the file.
#[test]
fn any_flipped_bit_is_named_and_the_sections_before_it_are_read() {
    let file = file();
    let mut damaged = file.clone();
    for (at, bit) in (0..file.len()).flat_map(|at| (0..8).map(move |bit| (at, bit))) {
        damaged[at] ^= 1 << bit;
        let found = refusal(&damaged);
        assert!(names_the_place(&file, at, found), "bit {bit} of byte {at}: {found:?}");
        damaged[at] = file[at];
    }
}

/// Every length.
#[test]
fn a_file_that_is_cut_off_anywhere_is_named() {
    let file = file();
    for length in 0..file.len() {
        let (done, error) = refusal(&file[..length]);
        let Some(number) = places(&file).iter().position(|place| place.end > length && place.start <= length)
        else {
            let expected = StreamHeader::BYTES;
            assert_eq!((done, error), (0, StreamError::ShortHeader { expected, found: length }));
            continue;
        };
        let (place, section) = (&places(&file)[number], u32::try_from(number).unwrap());
        let found = length - place.start;
        let expected = if found < SECTION_HEAD_BYTES { SECTION_HEAD_BYTES } else { place.len() };
        assert_eq!(
            (done, error),
            (number, StreamError::ShortSection { section, expected, found }),
            "{length}"
        );
        let header = StreamHeader::read(&file).unwrap();
        let (expected, found) = (file.len() as u64, length as u64);
        assert_eq!(header.expect_file_bytes(found), Err(StreamError::OtherFileLength { expected, found }));
    }
}

/// A header once took 68 GB, whatever the length of its file.
#[test]
fn a_header_takes_no_memory_for_rows_that_its_file_cannot_hold() {
    let file = file();
    let header = StreamHeader::read(&file).unwrap();
    let buffer = vec![0; header.largest_bytes as usize];
    assert!(SectionBuf::<I4F28, 2>::for_stream(&header, &buffer).is_ok());
    let found = u32::MAX.into();
    let with = |change: fn(&mut StreamHeader)| {
        let mut asks = header;
        change(&mut asks);
        asks
    };
    let longer = with(|header| header.largest_bytes = u32::MAX);
    for (asks, field) in [
        (with(|header| header.largest_pieces = u32::MAX), "number of pieces"),
        (with(|header| header.largest_stages = u32::MAX), "number of stages"),
        (longer, "largest section"),
    ] {
        let refused = SectionBuf::<I4F28, 2>::for_stream(&asks, &buffer).unwrap_err();
        assert_eq!(refused, StreamError::HeaderField { field, found });
    }
    let refused = StreamError::HeaderField { field: "largest section", found };
    assert_eq!(StreamHeader::read(&longer.to_bytes()), Err(refused));
}

/// Each pair of sections.
#[test]
fn swapped_sections_are_named() {
    let file = file();
    let places = places(&file);
    for (first, second) in (0..places.len()).flat_map(|i| (i + 1..places.len()).map(move |j| (i, j))) {
        let mut order: Vec<_> = (0..places.len()).collect();
        order.swap(first, second);
        let sections = order.iter().flat_map(|index| file[places[*index].clone()].to_vec());
        let swapped: Vec<u8> = file[..StreamHeader::BYTES].iter().copied().chain(sections).collect();
        let [expected, found] = [first, second].map(|index| u32::try_from(index).unwrap());
        assert_eq!(refusal(&swapped), (first, StreamError::OtherSection { expected, found }));
    }
}

#[test]
fn a_section_of_another_file_is_named() {
    let (file, other) = (file(), file_of(&compiled::<I4F28, 2>(true).0, 1));
    let at = places(&file)[2].start;
    let mixed = [&file[..at], &other[at..]].concat();
    let (done, error) = refusal(&mixed);
    assert!(done == 2 && matches!(error, StreamError::OtherFile { section: 2, .. }), "{error}");
}

#[test]
fn another_version_format_or_dimension_is_named() {
    let changed = |at: usize, value: u8| {
        let mut header = file();
        header[at] = value;
        seal(&mut header[..StreamHeader::BYTES]);
        header
    };
    for version in [1, 3] {
        let (done, error) = refusal(&changed(8, version));
        assert_eq!((done, error), (0, StreamError::OtherLayout { found: version.into() }));
        assert_eq!(error.to_string(), format!("the layout has version {version}, expected 2"));
    }
    let [major, minor] = secant_interp::VERSION;
    assert_eq!(refusal(&changed(10, 9)), (0, StreamError::OtherKernels { found: [9, minor] }));
    assert_eq!(refusal(&changed(12, 9)), (0, StreamError::OtherKernels { found: [major, 9] }));
    for degree in [0, 200] {
        let field = StreamError::HeaderField { field: "degree", found: degree.into() };
        assert_eq!(refusal(&changed(15, degree)), (0, field));
    }
    let as_other = |error: StreamError| error.to_string();
    let other = read::<I3F29, 2>(&file(), |_| {}).1.unwrap_err();
    assert_eq!(as_other(other), "the file has numbers of I4F28, expected I3F29");
    let other = read::<f32, 2>(&file(), |_| {}).1.unwrap_err();
    assert_eq!(as_other(other), "the file has numbers of I4F28, expected f32");
    let other = read::<I4F28, 3>(&file(), |_| {}).1.unwrap_err();
    assert_eq!(other, StreamError::OtherDimension { expected: 3, found: 2 });
}

/// A forged header asked for four thousand million evaluations, and a step took them.
#[test]
fn a_step_of_too_many_evaluations_is_neither_written_nor_read() {
    let run = StreamedRun { period_s: 1e-3, periods: 0, checksum: 0, feed_override: None };
    let written =
        |evaluations| PathStream::new(&compiled_for::<I4F28, 2>(true, evaluations).0, &run).map(|_| ()).err();
    assert_eq!(written(1000), None);
    assert_eq!(written(1001), Some(NoStream::TooManyEvaluations { evaluations: 1001 }));
    for evaluations in [1001, u32::MAX] {
        let mut forged = file();
        forged[28..32].copy_from_slice(&evaluations.to_le_bytes());
        seal(&mut forged[..StreamHeader::BYTES]);
        let field = StreamError::HeaderField { field: "number of evaluations", found: evaluations.into() };
        assert_eq!(refusal(&forged), (0, field));
    }
}

/// Values that no writer writes, under a CRC that fits.
#[test]
fn a_row_that_no_file_has_is_named() {
    let file = file();
    let place = places(&file)[1].clone();
    let changed = |at: usize, bytes: &[u8]| {
        let mut file = file.clone();
        file[at..at + bytes.len()].copy_from_slice(bytes);
        seal(&mut file[place.clone()]);
        refusal(&file)
    };
    let joint = place.start + SECTION_HEAD_BYTES + 2 * 8 + 6;
    let field = |field| StreamError::SectionField { section: 1, field, row: 0 };
    // Bits that no row of this layout has, and a long row where the head says that all are short.
    for value in [3, 4 | 3, 8 | 4, 1 << 7, file[joint] & !4] {
        assert_eq!(changed(joint, &[value]), (1, field("joint")), "{value}");
    }
    let count = |at: usize| u32::from_le_bytes(*file[place.start + at..].first_chunk().unwrap()) as usize;
    assert_eq!(count(12), count(16), "the section is straight");
    let stage = place.start + SECTION_HEAD_BYTES + count(12) * 36;
    assert_eq!(changed(stage, &[0; 8]), (1, field("duration")));
    assert_eq!(changed(stage, &u64::MAX.to_le_bytes()), (1, field("duration")));
    assert_eq!(changed(stage + 8, &[6]), (1, field("shape")));
}

/// A head whose numbers do not agree, under a CRC that fits.
#[test]
fn a_length_that_is_not_that_of_the_rows_is_named() {
    let file = file();
    let place = places(&file)[0].clone();
    for (at, value) in
        [(8, u32::MAX), (8, 0), (12, u32::MAX), (16, u32::MAX), (20, u32::MAX), (12, 0), (16, 0), (20, 77)]
    {
        let mut file = file.clone();
        file[place.start + at..place.start + at + 4].copy_from_slice(&value.to_le_bytes());
        seal(&mut file[place.start..place.start + SECTION_HEAD_BYTES]);
        let (done, error) = refusal(&file);
        assert!(done == 0 && matches!(error, StreamError::OtherLength { section: 0, .. }), "{at}: {error}");
    }
}

/// An error changes nothing: with more room, the section is read after all.
#[test]
fn a_storage_that_is_too_small_is_named_and_may_be_replaced() {
    let file = file();
    let header = StreamHeader::read(&file).unwrap();
    let mut reader = StreamReader::<I4F28, 2>::new(&header).unwrap();
    let section = &file[places(&file)[0].clone()];
    let count = |at: usize| u32::from_le_bytes(*section[at..].first_chunk().unwrap()) as usize;
    let (pieces, stages, degree) = (count(12), count(20), usize::from(header.degree));
    let needed = [pieces, pieces * degree, pieces * (degree + 1), stages];
    let names = ["pieces", "coefficients of numerators", "coefficients of weights", "stages"];
    for short in 0..5 {
        let room: [usize; 4] = std::array::from_fn(|rows| needed[rows] - usize::from(rows == short));
        let mut storage = SectionStorage {
            pieces: &mut vec![SectionStorage::no_piece(); room[0]],
            numerators: &mut vec![[I4F28::default(); 2]; room[1]],
            weights: &mut vec![I4F28::default(); room[2]],
            stages: &mut vec![SectionStorage::<I4F28, 2>::no_stage(); room[3]],
        };
        let found = reader.section(section, &mut storage).map(|run| run.pieces.pieces.len());
        match names.get(short) {
            Some(rows) => {
                let (needed, room) = (needed[short], room[short]);
                assert_eq!(found, Err(StreamError::NoRoom { section: 0, rows, needed, room }));
            }
            None => assert_eq!((found, reader.next_section()), (Ok(pieces), Some(1))),
        }
    }
}

#[test]
fn a_format_without_a_word_becomes_no_stream() {
    real::RuntimeFormat::named("I5F21").unwrap().run::<1, _>(|| {
        let (path, _) = compiled::<real::RuntimeFixed<1>, 2>(false);
        let run = StreamedRun { period_s: 1e-3, periods: 0, checksum: 0, feed_override: None };
        let name = real::RuntimeFixed::<1>::name();
        assert_eq!(PathStream::new(&path, &run).err(), Some(NoStream::NoWord(name)));
    });
}

/// Reads whatever is there, and runs it for a while.
fn reads_anything<R: FromWord, const D: usize>(file: &[u8]) {
    let _ = read::<R, D>(file, |run| {
        let mut state = run.start();
        for _ in 0..50 {
            let Some(setpoint) = crate::steps::step(run, &mut state) else { break };
            let _ = run.pieces.position(setpoint.piece, &setpoint.offset);
        }
    });
}

proptest! {
    /// Damage of several bytes is refused too.
    #[test]
    fn any_damage_is_refused(changes in prop::collection::vec((any::<prop::sample::Index>(), 1_u8..), 1..40)) {
        let file = file();
        let mut damaged = file.clone();
        changes.iter().for_each(|(at, by)| damaged[at.index(file.len())] ^= by);
        prop_assume!(damaged != file);
        let (_, end) = read::<I4F28, 2>(&damaged, |_| {});
        prop_assert!(end.is_err());
    }

    /// Where all CRCs fit, anything may come out, but no panic.
    #[test]
    fn forged_sections_do_not_panic(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 1..40),
    ) {
        for mut file in [file(), file_of(&compiled::<f64, 3>(true).0, 0)] {
            let places = places(&file);
            for (at, value) in &changes {
                let at = StreamHeader::BYTES + at.index(file.len() - StreamHeader::BYTES);
                let is_row = places.iter().any(|place| (place.start + SECTION_HEAD_BYTES..place.end).contains(&at));
                file[at] = if is_row { *value } else { file[at] };
            }
            places.iter().for_each(|place| seal(&mut file[place.clone()]));
            reads_anything::<I4F28, 2>(&file);
            reads_anything::<f64, 3>(&file);
        }
    }
}
