//! `feedbits judge`: what a controller really did, by a log of its setpoints.

mod baseline;
mod page;
mod print;

use std::io::Read;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result};
use clap::Args;
use clap_complete::{ArgValueCandidates, ArgValueCompleter};
use domains::options::{LOG_PERIOD, LOG_TOLERANCE, RESOLUTION};
use part_program::{Dialect, Part, ReadOptions, StatedLimits, Unit};
use secant_interp::crc32;
use serde::Serialize;
use setpoint_log::{ColumnMap, Followed, Judgement, LengthUnit, Log, LogOptions};

use crate::baseline::{BaselineArguments, SCHEMA};
use crate::ending::Ending;
use crate::judge::baseline::LogBaseline;
use crate::numbers::number;
use crate::progress::Progress;
use crate::{candidates, claims, files, input, output, presets, report};

/// Options of `judge`.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Log: rows of numbers separated by commas, semicolons, tabs or blanks, as LinuxCNC's halsampler, a controller or `feedbits
    /// interpolate` writes them; a ROS joint trajectory as CSV; or moves that Klipper's motan has kept. Packed by gzip or not. `-` is
    /// the standard input.
    log: PathBuf,
    /// Machine, whose limits are judged: a preset's name, or a file (TOML with a table `machine`) which may leave out any limit.
    #[arg(long, value_name = "NAME|FILE", add = ArgValueCompleter::new(candidates::machines))]
    machine: PathBuf,
    /// Judge by the limits that the machine's file assumes as well, as plans of feedbits keep them. Default: by those
    /// that it states.
    #[arg(long)]
    assumed: bool,
    /// Which column is what, by number from 0 or by name: time=0,x=1,y=2,z=3,line=6; also time_ms and sample, the number that the
    /// controller counts. Default: by the names in the log's head.
    #[arg(long, value_name = "NAME=COLUMN,...")]
    columns: Option<ColumnMap>,
    /// The unit of the log's positions: mm, m or inch. Default: mm, and m for a ROS joint trajectory.
    #[arg(long, value_name = "UNIT")]
    units: Option<LengthUnit>,
    /// The time between two setpoints, in ms. Default: that of the log's times, or the machine's if the log has none.
    #[arg(long, value_name = "MS", value_parser = number(&LOG_PERIOD))]
    period: Option<f64>,
    /// How far the motion may be from the log's positions in each axis, in mm. Default: half of a unit of their last decimal.
    #[arg(long, value_name = "MM", value_parser = number(&RESOLUTION))]
    resolution: Option<f64>,
    /// Judge the limits as `compare` and `interpolate` judge a run of ours: the motion may also be off the positions by half of the
    /// fluctuation that the machine allows in a full step, or by half of its position_increment_mm, where the file states more than the
    /// default. Default: only by what the log's decimals hide.
    #[arg(long)]
    as_run: bool,
    /// The axes stand before the first row and behind the last. Default: where the log shows it.
    #[arg(long)]
    from_rest: bool,
    /// The part that was run: the log is followed along its path, and the feed that it commands is judged. It is read as every part is;
    /// where a program begins is where the log does.
    #[arg(long, value_name = "FILE")]
    part: Option<PathBuf>,
    /// Largest distance between the log and the path of moves at feed, both ways, in mm. Default: what the part states, as LinuxCNC's G64 P
    /// does; where it states none, the distance is told, and not judged.
    #[arg(long, value_name = "MM", requires = "part", value_parser = number(&LOG_TOLERANCE))]
    tolerance: Option<f64>,
    /// The control that the part is for: fanuc, linuxcnc or siemens; canon is what LinuxCNC's rs274 prints. Default: told by its text.
    #[arg(long, value_name = "CONTROL", requires = "part", add = ArgValueCandidates::new(candidates::dialects))]
    dialect: Option<Dialect>,
    /// Read over unknown words of the part, with a warning each.
    #[arg(long, requires = "part")]
    lenient: bool,
    /// The unit of the part's lengths until a word names one: mm or inch.
    #[arg(long, value_name = "UNIT", requires = "part")]
    part_units: Option<Unit>,
    /// Write a report into this folder: the path coloured by what it takes of limits, and feed, acceleration and jerk over time.
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    #[command(flatten)]
    baseline: BaselineArguments,
    #[command(flatten)]
    output: output::Output,
}

/// The result as JSON.
#[derive(Serialize)]
struct Judged<'a> {
    schema: u64,
    command: &'static str,
    log: &'a str,
    machine: &'a StatedLimits,
    /// A checksum of the part's text and of how it is read, by which a baseline knows it.
    #[serde(skip_serializing_if = "Option::is_none")]
    part_crc32: Option<String>,
    /// The faults, in short: with any of them the status is 1.
    faults: &'a [String],
    #[serde(flatten)]
    judgement: &'a Judgement,
}

/// Judges the log and prints what was found.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let (folder, place) = (report::folder(arguments.report.as_deref())?, arguments.output.place()?);
    let stated = presets::read_limits(&arguments.machine)?;
    let machine = if arguments.assumed { stated.with_assumed() } else { stated };
    let (name, log) = opened(&arguments.log)?;
    let progress = Progress::spinning("reading and judging");
    let options = LogOptions {
        columns: arguments.columns.clone(),
        unit: arguments.units,
        period_s: arguments.period.map(|period| 1e-3 * period),
        resolution_mm: arguments.resolution,
        as_run: arguments.as_run,
        from_rest_to_rest: arguments.from_rest,
        traces: folder.is_some(),
    };
    let log = Log::begin(log, &machine, &options).with_context(|| name.clone())?;
    let text = arguments.part_text()?;
    let part_crc32 = text.as_deref().map(|bytes| arguments.checksum(bytes));
    let machine_json = serde_json::to_value(&machine)?;
    let baseline = LogBaseline::read(&arguments.baseline, &machine_json, part_crc32.as_deref())?;
    let part = text.map(|bytes| arguments.part_from(&bytes, log.first_point_mm())).transpose()?;
    let followed = part.as_ref().map(|part| Followed { part, tolerance_mm: arguments.tolerance });
    let judgement = log.judge(followed).with_context(|| name.clone())?;
    progress.finish();
    let faults = judgement.faults();
    let judged = Judged {
        schema: SCHEMA,
        command: "judge",
        log: &name,
        machine: &machine,
        part_crc32,
        faults: &faults,
        judgement: &judgement,
    };
    let text = if arguments.output.json {
        serde_json::to_string_pretty(&judged)? + "\n"
    } else {
        print::text(&name, &judgement, &faults)
    };
    // The report comes first: if it cannot be written, nothing is printed beside the error.
    if let Some(folder) = &folder {
        let page = report::into(folder, &page::of(&name, &machine, &judgement, &faults)?)?;
        output::note(&format!("report in {}", page.display()));
    }
    output::write(&place, &text)?;
    let ending = if faults.is_empty() { Ending::Good } else { Ending::RequirementNotMet };
    match baseline {
        Some(baseline) => Ok(baseline.judge(&serde_json::to_value(&judged)?, ending)),
        None => Ok(ending),
    }
}

impl Arguments {
    /// The text of the part, if one is named.
    fn part_text(&self) -> Result<Option<Vec<u8>>> {
        self.part.as_ref().map(|path| files::bytes("--part", path, files::MOST_OF_PART)).transpose()
    }

    /// A checksum of a part's text, whose lines end alike on every system, and of the options by which it is read.
    fn checksum(&self, bytes: &[u8]) -> String {
        let options = format!("{:?} {} {:?}", self.dialect.map(Dialect::name), self.lenient, self.part_units);
        let text = bytes.iter().copied().filter(|byte| *byte != b'\r');
        format!("{:08x}", crc32(&text.chain(options.into_bytes()).collect::<Vec<u8>>()))
    }

    /// The part of a text, which begins where the log does.
    fn part_from(&self, bytes: &[u8], start_mm: [f64; 3]) -> Result<Part> {
        let name = self.part.as_ref().map_or_else(String::new, |path| path.display().to_string());
        let options = ReadOptions {
            dialect: self.dialect,
            lenient: self.lenient,
            start_mm: Some(start_mm),
            unit: self.part_units,
        };
        let part = part_program::read_part_bytes(&name, bytes, options)?;
        input::say_warnings(&part);
        Ok(part)
    }
}

/// The log, and what a person calls it.
fn opened(path: &Path) -> Result<(String, Box<dyn Read>)> {
    if path == Path::new("-") {
        claims::read_standard_input()?;
        return Ok(("standard input".into(), Box::new(std::io::stdin().lock())));
    }
    Ok((path.display().to_string(), Box::new(files::open("the log", path)?)))
}
