//! Compares how a part program is read with LinuxCNC's interpreter: its feed path against the output of `rs274 -g`.
//!
//! ```text
//! cargo run --release --example same_path -- PROGRAM CANON [--dialect D] [--lenient] [--tools TABLE]
//! ```
//!
//! It writes one line, whose fields are apart by tabs, and ends with a status:
//!
//! | status | line |
//! |---|---|
//! | 0 | `same`, runs, length in mm, tolerance in mm, splines that were left out |
//! | 1 | `different`, `path` or `feed`, place in the program, place in the canon lines, what differs |
//! | 2 | `not read`, `program` or `canon`, the reader's first error |
//!
//! A place is `line:x,y,z`, or `end`. The tool table is LinuxCNC's, in inches, as `rs274` takes it without a file of settings.
//!
//! Two feed paths are the same if they begin anew at the same places, and between them the Fréchet distance is within a tolerance: the
//! pieces into which a reader cuts a curve do not matter. Four decimals are printed. In millimetres each coordinate is off by 0.05 µm at
//! most, a point by 0.09 µm, an arc with its end and its centre by three times that; a tolerance of 1 µm leaves room for chords, which
//! are within 0.1 µm on each side. In inches all that is 25.4 times as much: 5 µm.
//!
//! The interpreter prints no points of splines. They and the move behind them are left out on both sides, and counted:
//! `same` with 0 runs means that nothing was compared. If an interpreter prints splines as chords, the tolerance is 0.1
//! mm.
//!
//! Feedrates are the same within 0.1 %, and within the last decimal; they change at the same places.

mod frechet;
mod path;
mod point;

use std::process::ExitCode;

use part_program::{Dialect, Part, ReadOptions, Shape, ToolTable, Unit, read_part_bytes_with};

use crate::frechet::{Walk, walk};
use crate::path::{Run, cuts, runs};
use crate::point::{Point, distance};

/// The distance in mm that comes from four decimals of millimetres and from the chords of arcs.
const MM_TOLERANCE: f64 = 1e-3;
/// The distance in mm that comes from four decimals of inches and from the chords of arcs.
const INCH_TOLERANCE: f64 = 5e-3;
/// How far chords may be from a spline that an older interpreter prints as such, in mm.
const SPLINE_TOLERANCE: f64 = 0.1;
/// A share of the feedrate.
const FEED_TOLERANCE: f64 = 1e-3;

fn main() -> ExitCode {
    let Some(arguments) = Arguments::of(std::env::args().skip(1)) else {
        eprintln!("usage: same_path PROGRAM CANON [--dialect D] [--lenient] [--tools TABLE]");
        return ExitCode::from(2);
    };
    let (line, status) = match verdict(&arguments) {
        Ok(line) => (line, 0),
        Err(Fault::Different(line)) => (line, 1),
        Err(Fault::NotRead(line)) => (line, 2),
    };
    println!("{line}");
    ExitCode::from(status)
}

struct Arguments {
    files: [String; 2],
    options: ReadOptions,
    tools: Option<String>,
}

impl Arguments {
    fn of(mut words: impl Iterator<Item = String>) -> Option<Self> {
        // The interpreter begins at zero.
        let start = ReadOptions { start_mm: Some([0.0; 3]), ..ReadOptions::default() };
        let (mut files, mut options, mut tools) = (Vec::new(), start, None);
        while let Some(word) = words.next() {
            match word.as_str() {
                "--lenient" => options.lenient = true,
                "--tools" => tools = Some(words.next()?),
                "--dialect" => options.dialect = Some(words.next()?.parse::<Dialect>().ok()?),
                _ => files.push(word),
            }
        }
        Some(Self { files: files.try_into().ok()?, options, tools })
    }
}

enum Fault {
    Different(String),
    NotRead(String),
}

fn verdict(arguments: &Arguments) -> Result<String, Fault> {
    let [program, canon] = [&arguments.files[0], &arguments.files[1]];
    let printed = bytes("canon", canon)?;
    let has = |word: &str| printed.windows(word.len()).any(|part| part == word.as_bytes());
    let has_splines = has(" NURBS_FEED(");
    let tools = arguments.tools.as_ref().map_or(Ok(ToolTable::default()), |file| tools(file))?;
    let program = part("program", program, &bytes("program", program)?, arguments.options, &tools)?;
    let options = ReadOptions {
        dialect: Some(Dialect::Canon),
        lenient: has_splines || arguments.options.lenient,
        ..arguments.options
    };
    let canon = part("canon", canon, &printed, options, &tools)?;
    let splines = program.moves.iter().filter(|one| one.shape == Shape::Nurbs).count();
    let tolerance = match (splines > 0 && !has_splines, has("(CANON_UNITS_INCHES)")) {
        (true, _) => SPLINE_TOLERANCE,
        (false, true) => INCH_TOLERANCE,
        (false, false) => MM_TOLERANCE,
    };
    let [program, canon] = [program, canon].map(|part| runs(&cuts(&part, has_splines), tolerance));
    hold_paths(&program, &canon, tolerance)?;
    hold_feeds(&program, &canon, tolerance)?;
    let length = program.iter().map(Run::length).fold(0.0, |sum, length| sum + length);
    let left_out = if has_splines { splines } else { 0 };
    Ok(format!("same\t{}\t{length:.3}\t{tolerance}\t{left_out}", program.len()))
}

fn bytes(which: &str, file: &str) -> Result<Vec<u8>, Fault> {
    std::fs::read(file).map_err(|error| Fault::NotRead(format!("not read\t{which}\t{error}")))
}

fn tools(file: &str) -> Result<ToolTable, Fault> {
    let text = bytes("tools", file)?;
    ToolTable::read(file, &String::from_utf8_lossy(&text), Unit::Inch).map_err(|errors| {
        Fault::NotRead(format!("not read\ttools\t{}", errors.to_string().replace(['\t', '\n'], " ")))
    })
}

fn part(
    which: &str,
    file: &str,
    bytes: &[u8],
    options: ReadOptions,
    tools: &ToolTable,
) -> Result<Part, Fault> {
    read_part_bytes_with(file, bytes, options, tools).map_err(|errors| {
        let first = errors.iter().next();
        let said = first
            .map_or(String::new(), |first| format!("{}:{}: {}", first.line, first.column, first.message));
        Fault::NotRead(format!("not read\t{which}\t{}", said.replace(['\t', '\n'], " ")))
    })
}

/// Says where the one path first leaves the other.
fn hold_paths(program: &[Run], canon: &[Run], tolerance: f64) -> Result<(), Fault> {
    for index in 0..program.len().max(canon.len()) {
        let (one, other) = (program.get(index), canon.get(index));
        let places = match (one, other) {
            (Some(one), Some(other)) => match walk(&one.points, &other.points, tolerance) {
                Walk::Ends => continue,
                Walk::Stops(i, j) => [place(one, i), place(other, j)],
            },
            _ => [one, other].map(|run| run.map_or("end".into(), |run| place(run, 0))),
        };
        let runs = format!("run {} of {} and {}", index + 1, program.len(), canon.len());
        return Err(Fault::Different(format!("different\tpath\t{}\t{}\t{runs}", places[0], places[1])));
    }
    Ok(())
}

/// The start of a segment.
fn place(run: &Run, segment: usize) -> String {
    let [x, y, z] = run.points[segment];
    format!("{}:{x:.4},{y:.4},{z:.4}", run.lines[segment])
}

/// A stretch of one feedrate.
struct SameFeed {
    feed: Option<f64>,
    start: Point,
    length: f64,
    place: String,
}

/// Says where feedrates first differ on a path that is the same.
fn hold_feeds(program: &[Run], canon: &[Run], tolerance: f64) -> Result<(), Fault> {
    let [program, canon] = [program, canon].map(|runs| stretches(runs, tolerance));
    let is_same = |one: &SameFeed, other: &SameFeed| {
        // Of moves with the spindle rs274 prints no feed.
        (other.feed.is_none() || is_same_feed(one.feed, other.feed))
            && distance(one.start, other.start) <= 2.0 * tolerance
    };
    let wrong = program.iter().zip(&canon).find(|(one, other)| !is_same(one, other));
    let (places, feeds) = match wrong {
        Some((one, other)) => ([one.place.as_str(), &other.place], [one.feed, other.feed]),
        None if program.len() == canon.len() || canon.iter().any(|one| one.feed.is_none()) => return Ok(()),
        None => {
            let shorter = program.len().min(canon.len());
            let at = |list: &[SameFeed]| list.get(shorter).map_or("end".into(), |one| one.place.clone());
            let [one, other] = [at(&program), at(&canon)];
            return Err(Fault::Different(format!("different\tfeed\t{one}\t{other}\tfeeds end")));
        }
    };
    let [one, other] = feeds.map(|feed| feed.map_or("none".into(), |feed| format!("{feed:.4}")));
    Err(Fault::Different(format!("different\tfeed\t{}\t{}\t{one} and {other} mm/s", places[0], places[1])))
}

/// Joins what follows at one feedrate; stretches within the tolerance are left out.
fn stretches(runs: &[Run], tolerance: f64) -> Vec<SameFeed> {
    let mut stretches: Vec<SameFeed> = Vec::new();
    for run in runs {
        for (segment, feed) in run.feeds.iter().enumerate() {
            let (start, length) =
                (run.points[segment], distance(run.points[segment], run.points[segment + 1]));
            match stretches.last_mut() {
                Some(last) if is_same_feed(last.feed, *feed) => last.length += length,
                _ => stretches.push(SameFeed { feed: *feed, start, length, place: place(run, segment) }),
            }
        }
    }
    stretches.retain(|stretch| stretch.length > 2.0 * tolerance);
    stretches.dedup_by(|next, last| is_same_feed(last.feed, next.feed));
    stretches
}

fn is_same_feed(one: Option<f64>, other: Option<f64>) -> bool {
    // Half of the last decimal, in inches a minute.
    let decimal = 25.4 * 0.5e-4 / 60.0;
    match (one, other) {
        (Some(one), Some(other)) => (one - other).abs() <= decimal + FEED_TOLERANCE * one.max(other),
        (one, other) => one == other,
    }
}
