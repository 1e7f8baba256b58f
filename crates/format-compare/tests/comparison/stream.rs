//! A stream holds the run that was judged, in every built-in format, in the plane and in space.

use format_compare::{
    Dimension, Options, OverrideTarget, Overrides, Problem, Refusal, Space, StreamFailure, StreamRequest,
    format_named, formats, plan_for,
};
use part_program::{Machine, read_machine, read_part};
use real::{FromWord, I2F30, I3F29, I4F28, I4F60, I8F24, I16F16, I16F48, I32F32};
use secant_interp::{
    OverrideState, PositionChecksum, Rate, SECTION_HEAD_BYTES, SectionBuf, StreamHeader, StreamReader,
};

/// The built-in example: one curve, and the machine of all parts here.
const EXAMPLE: &str = include_str!("../../../../data/seed-000.toml");
const IN_SPACE: &str =
    "G0 X0 Y0 Z5\nG1 Z0 F3000\nX20\nG2 X30 Y10 Z-1 R10\nG1 Y30\nX10 Y35 Z2\nG0 Z5\nX0 Y0\nG1 Z0\nX5 Y5\n";

fn machine() -> Machine {
    let (_, behind) = EXAMPLE.split_once("[machine]").unwrap();
    let (machine, _) = behind.split_once("[table").unwrap();
    read_machine("mill.toml", &format!("[machine]{machine}")).unwrap()
}

fn problem<const D: usize>(name: &str, part: &str) -> Problem<D> {
    Problem::new(&read_part(name, part).unwrap(), &machine()).unwrap()
}

/// The stream of a part, if the format holds it.
fn streamed<const D: usize>(
    problem: &Problem<D>,
    format: &str,
    options: &Options,
    buffer: Option<usize>,
) -> Result<(Vec<u8>, StreamHeader), (usize, Refusal)>
where
    Space: Dimension<D>,
{
    let format = format_named::<D>(format).unwrap();
    let plan = plan_for(problem, format.as_ref(), options).unwrap();
    let mut file = Vec::new();
    let mut request = StreamRequest { buffer, to: &mut file };
    match format.stream(problem, &plan, options, &mut request) {
        Ok(header) => Ok((file, header)),
        Err(StreamFailure::Refused(refusal)) => Err((file.len(), refusal)),
        Err(other) => panic!("{other}"),
    }
}

/// The checksum of the run that a controller makes of a file.
fn run<R: FromWord, const D: usize>(file: &[u8]) -> (u64, u64) {
    let header = StreamHeader::read(file).unwrap();
    let mut reader = StreamReader::<R, D>::new(&header).unwrap();
    let (mut rows, mut rest) = (SectionBuf::for_stream(&header, file).unwrap(), &file[StreamHeader::BYTES..]);
    let (mut storage, mut periods, mut checksum) = (rows.storage(), 0, PositionChecksum::default());
    while reader.next_section().is_some() {
        let (section, behind) = rest.split_at(reader.section_bytes(&rest[..SECTION_HEAD_BYTES]).unwrap());
        let run = reader.section(section, &mut storage).unwrap();
        let mut state = run.start();
        while let Some(setpoint) = run.step(&mut state) {
            checksum.add(run.pieces.position(setpoint.piece, &setpoint.offset));
            periods += 1;
        }
        rest = behind;
    }
    assert!(rest.is_empty());
    (periods, checksum.value())
}

/// Returns whether the format holds the part.
fn is_the_judged_run<R: FromWord, const D: usize>(problem: &Problem<D>) -> bool
where
    Space: Dimension<D>,
{
    let (name, options) = (R::name().to_string(), Options::default());
    let format = format_named::<D>(&name).unwrap();
    let plan = plan_for(problem, format.as_ref(), &options).unwrap();
    match (format.constants(problem, &plan, &options), streamed(problem, &name, &options, None)) {
        (Ok(constants), Ok((file, header))) => {
            let ran = run::<R, D>(&file);
            assert_eq!(ran, (constants.periods as u64, constants.checksum), "{name} in {D}");
            assert_eq!(ran, (header.periods, header.checksum), "{name} in {D}");
            assert_eq!(header.sections as usize, constants.sections, "{name} in {D}");
            true
        }
        (Err(expected), Err((0, found))) => {
            assert_eq!(expected, found);
            false
        }
        (constants, found) => panic!("{constants:?} and {found:?}"),
    }
}

fn all_formats<const D: usize>(problem: &Problem<D>) -> Vec<bool>
where
    Space: Dimension<D>,
{
    vec![
        is_the_judged_run::<I16F16, D>(problem),
        is_the_judged_run::<I8F24, D>(problem),
        is_the_judged_run::<I4F28, D>(problem),
        is_the_judged_run::<I3F29, D>(problem),
        is_the_judged_run::<I2F30, D>(problem),
        is_the_judged_run::<f32, D>(problem),
        is_the_judged_run::<I32F32, D>(problem),
        is_the_judged_run::<I16F48, D>(problem),
        is_the_judged_run::<I4F60, D>(problem),
        is_the_judged_run::<f64, D>(problem),
    ]
}

#[test]
fn every_built_in_format_streams_what_was_judged() {
    assert_eq!(all_formats(&problem::<2>("curve.toml", EXAMPLE)), [true; 10]);
    assert_eq!(all_formats(&problem::<3>("part.nc", IN_SPACE)), [true; 10]);
    assert_eq!(formats::<2>().len(), 10);
}

/// The message has the lines and the bytes; a buffer of exactly that many bytes will do.
#[test]
fn a_section_that_is_too_long_is_named_before_anything_is_written() {
    let problem = problem::<3>("part.nc", IN_SPACE);
    let (_, header) = streamed(&problem, "I4F28", &Options::default(), None).unwrap();
    let needed = header.largest_bytes as usize;
    let (written, refusal) = streamed(&problem, "I4F28", &Options::default(), Some(needed - 1)).unwrap_err();
    let expected = format!("takes {needed} bytes, and the buffer has {}", needed - 1);
    let said = refusal.to_string();
    assert_eq!((written, said), (0, format!("part.nc:4: section 2 {expected}")));
    assert!(streamed(&problem, "I4F28", &Options::default(), Some(needed)).is_ok());
}

#[test]
fn a_plan_for_overrides_says_how_fast_the_rate_may_change() {
    let asked = problem::<3>("part.nc", IN_SPACE);
    let overrides = Overrides::try_new(vec![OverrideTarget { time_s: 0.0, share: 1.25 }], 0.2).unwrap();
    let to_plan = overrides.to_plan(&asked);
    let format = format_named::<3>("I8F24").unwrap();
    let plan = plan_for(&to_plan, format.as_ref(), &Options::default()).unwrap();
    let commands = overrides.commands(&asked, &plan).unwrap();
    let options = Options { overrides: Some(commands), ..Options::default() };
    let (file, header) = streamed(&to_plan, "I8F24", &options, None).unwrap();
    assert_eq!(StreamHeader::read(&file), Ok(header));
    let found = header.feed_override.unwrap();
    assert_eq!(found.commanded, Rate::of(0.8));
    // From hold to the commanded feed, the rate changes as the bounds allow.
    let mut rates = OverrideState::at(Rate::HOLD);
    rates.set(found.commanded);
    let header = StreamHeader::read(&file).unwrap();
    let mut reader = StreamReader::<real::I8F24, 3>::new(&header).unwrap();
    let mut rows = SectionBuf::for_stream(&header, &file).unwrap();
    let mut storage = rows.storage();
    let section = reader.section(&file[StreamHeader::BYTES..], &mut storage).unwrap();
    let (mut state, mut before) = (section.start(), 0.0);
    while section.step_overridden(&mut state, &found.feeds, &mut rates).is_some() && !rates.is_settled() {
        let rate = rates.rate().share::<f64>();
        let most = found.feeds.slope() as f64 / 2.0_f64.powi(32);
        assert!(rate - before <= most, "{rate} after {before}");
        before = rate;
    }
    assert!(before > 0.0);
}
