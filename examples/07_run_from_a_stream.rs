//! A controller that reads a part from a file, one section after the other, through a buffer as large as the largest
//! section:
//!
//!     feedbits compile part.nc --format I4F28 --stream --out part.stream
//!     cargo run -p feedbits-examples --example 07_run_from_a_stream part.stream
//!
//! It prints the periods and the checksum of all positions, which are those that `compile` has printed. A damaged file ends
//! at the last section that is whole: there the machine stands. Without a file it runs a part of its own.
//!
//! Real firmware has one format, and arrays in place of what is allocated here once for every format.

use std::error::Error;
use std::fs::File;
use std::io::Read;

use format_compare::{Options, Problem, StreamRequest, plan_for, select};
use part_program::{read_machine, read_part};
use real::{FromWord, I2F30, I3F29, I4F28, I4F60, I8F24, I16F16, I16F48, I32F32};
use secant_interp::{PositionChecksum, SECTION_HEAD_BYTES, SectionBuf, StreamHeader, StreamReader};

const MACHINE: &str = "[machine]
interpolation_period_ms = 1.0
feedrate_mm_per_s = 50.0
acceleration_mm_per_s2 = 1000.0
jerk_mm_per_s3 = 40000.0
";

const PART: &str = "G0 X0 Y0\nG1 X10 F3000\nG2 X20 Y10 R10\nG1 X10 Y20\nX0 Y0\n";

/// What a file gave.
#[derive(Debug, PartialEq)]
struct Ran {
    sections: usize,
    periods: u64,
    checksum: u64,
}

fn main() -> Result<(), Box<dyn Error>> {
    let Some(path) = std::env::args().nth(1).filter(|word| !word.starts_with('-')) else {
        return run_file(&mut &own_part()?[..], None);
    };
    let mut file = File::open(&path)?;
    let bytes = file.metadata()?.len();
    run_file(&mut file, Some(bytes))
}

/// Runs a file of any format and says what it gave.
fn run_file(file: &mut dyn Read, bytes: Option<u64>) -> Result<(), Box<dyn Error>> {
    let mut begin = [0; StreamHeader::BYTES];
    let found = read_into(file, &mut begin)?;
    let header = StreamHeader::read(&begin[..found])?;
    bytes.map_or(Ok(()), |bytes| header.expect_file_bytes(bytes))?;
    let mut ran = Ran { sections: 0, periods: 0, checksum: 0 };
    let end = if header.dimension == 2 {
        run_in_its_format::<2>(&header, file, &mut ran)
    } else {
        run_in_its_format::<3>(&header, file, &mut ran)
    };
    let Ran { sections, periods, checksum } = ran;
    println!("{periods} periods; sections: {sections}; checksum {checksum:#018x}");
    end?;
    assert_eq!((periods, checksum), (header.periods, header.checksum), "bit for bit the run that was judged");
    Ok(())
}

fn run_in_its_format<const D: usize>(
    header: &StreamHeader,
    file: &mut dyn Read,
    ran: &mut Ran,
) -> Result<(), Box<dyn Error>> {
    match header.format_name() {
        "I16F16" => run::<I16F16, D>(header, file, ran),
        "I8F24" => run::<I8F24, D>(header, file, ran),
        "I4F28" => run::<I4F28, D>(header, file, ran),
        "I3F29" => run::<I3F29, D>(header, file, ran),
        "I2F30" => run::<I2F30, D>(header, file, ran),
        "f32" => run::<f32, D>(header, file, ran),
        "I32F32" => run::<I32F32, D>(header, file, ran),
        "I16F48" => run::<I16F48, D>(header, file, ran),
        "I4F60" => run::<I4F60, D>(header, file, ran),
        _ => run::<f64, D>(header, file, ran),
    }
}

/// What a controller does, in its format. Whatever the file is, it is compiled once.
fn run<R: FromWord, const D: usize>(
    header: &StreamHeader,
    file: &mut dyn Read,
    ran: &mut Ran,
) -> Result<(), Box<dyn Error>> {
    let mut reader = StreamReader::<R, D>::new(header)?;
    let mut buffer = vec![0; usize::try_from(header.largest_bytes)?];
    let mut rows = SectionBuf::for_stream(header, &buffer)?;
    let mut storage = rows.storage();
    let mut checksum = PositionChecksum::default();
    while reader.next_section().is_some() {
        // The machine stands. A section becomes a run once all of it is there and undamaged.
        let head = read_into(file, &mut buffer[..SECTION_HEAD_BYTES])?;
        let length = reader.section_bytes(&buffer[..head])?;
        let rest = read_into(file, &mut buffer[head..length])?;
        let run = reader.section(&buffer[..head + rest], &mut storage)?;
        let mut state = run.start();
        while let Some(setpoint) = run.step(&mut state) {
            checksum.add(run.pieces.position(setpoint.piece, &setpoint.offset)); // The position goes to the axes.
            ran.periods += 1;
        }
        ran.sections += 1;
        ran.checksum = checksum.value();
    }
    Ok(())
}

/// Reads until the buffer is full or the file ends. Returns how many bytes were read.
fn read_into(file: &mut dyn Read, buffer: &mut [u8]) -> std::io::Result<usize> {
    let mut filled = 0;
    while filled < buffer.len() {
        let read = file.read(&mut buffer[filled..])?;
        if read == 0 {
            break;
        }
        filled += read;
    }
    Ok(filled)
}

/// The file of a small part, as `feedbits compile --stream` writes it.
fn own_part() -> Result<Vec<u8>, Box<dyn Error>> {
    let problem = Problem::<2>::new(&read_part("part.nc", PART)?, &read_machine("mill.toml", MACHINE)?)?;
    let (formats, options) = (select(&["I4F28"])?, Options::default());
    let plan = plan_for(&problem, formats[0].as_ref(), &options)?;
    let mut file = Vec::new();
    let mut request = StreamRequest { buffer: Some(4096), to: &mut file };
    formats[0].stream(&problem, &plan, &options, &mut request)?;
    Ok(file)
}

#[test]
fn it_runs() -> Result<(), Box<dyn Error>> {
    main()
}

/// The sections before the damaged one are run, and nothing of it is.
#[test]
fn a_damaged_section_ends_the_run_at_the_rest_before_it() -> Result<(), Box<dyn Error>> {
    let good = own_part()?;
    let header = StreamHeader::read(&good)?;
    let mut whole = Ran { sections: 0, periods: 0, checksum: 0 };
    run::<I4F28, 2>(&header, &mut &good[StreamHeader::BYTES..], &mut whole)?;
    assert!(whole.sections > 1 && whole.checksum == header.checksum, "{whole:?}");
    let mut bad = good;
    *bad.last_mut().expect("a byte") ^= 1;
    let mut ran = Ran { sections: 0, periods: 0, checksum: 0 };
    let error =
        run::<I4F28, 2>(&header, &mut &bad[StreamHeader::BYTES..], &mut ran).expect_err("it is damaged");
    let last = whole.sections - 1;
    assert!(error.to_string().starts_with(&format!("section {last} is damaged")), "{error}");
    assert!(ran.sections == last && ran.periods < whole.periods, "{ran:?}");
    Ok(())
}
