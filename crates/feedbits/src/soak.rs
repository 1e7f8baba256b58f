//! `feedbits soak`: random paths in every format, until each format has made so many periods.

use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};
use clap::Args;
use clap_complete::ArgValueCandidates;
use format_compare::in_parallel;
use serde::{Deserialize, Serialize};
use stress::{SOAK_FORMATS, Soak, SoakFormat, SoakPaths, Soaked, soak_path};
use time::OffsetDateTime;

use crate::ending::Ending;
use crate::formats::meant;
use crate::progress::Progress;
use crate::screen::{self, labelled};
use crate::{candidates, files, output};

/// Options of `soak`.
#[derive(Args)]
pub(crate) struct Arguments {
    /// Periods that each format is to make, as in 100M, 250k or 5000.
    #[arg(long, allow_negative_numbers = true, value_name = "N", default_value = "1M", value_parser = count)]
    periods: u64,
    /// The formats, comma-separated. Default: the ten built-in ones, and I5F21 as one chosen at run time.
    #[arg(long, visible_alias = "format", value_delimiter = ',', value_parser = crate::formats::name, value_name = "F,F", add = ArgValueCandidates::new(candidates::formats))]
    formats: Vec<String>,
    /// Which paths are drawn.
    #[arg(long, allow_negative_numbers = true, value_name = "N", default_value_t = 1)]
    seed: u64,
    /// Slow none of the paths down: fewer periods a path, and more bends and joints a period.
    #[arg(long)]
    full_speed: bool,
    /// Run this path only, as a violation names it.
    #[arg(long, allow_negative_numbers = true, value_name = "N", conflicts_with = "resume")]
    path: Option<u64>,
    /// Keep the state in this file, and go on from it if it is there.
    #[arg(long, value_name = "PATH")]
    resume: Option<PathBuf>,
    #[command(flatten)]
    output: output::Output,
}

/// The state of a soak, with its date and duration.
#[derive(Serialize, Deserialize)]
struct Record {
    /// Date of the last path, UTC.
    date: String,
    /// The version that ran.
    version: String,
    /// Time taken, in seconds.
    seconds: f64,
    #[serde(flatten)]
    soak: Soak,
}

/// Paths that are run at a time.
const BATCH: u64 = 32;
/// A format that has refused all of this many paths is given up.
const PATIENCE: u64 = 4096;
/// Time between two states.
const BETWEEN_STATES: Duration = Duration::from_secs(5);

/// Runs until every format has made its periods.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let formats = selected(&arguments.formats)?;
    let paths = SoakPaths { seed: arguments.seed, full_speed: arguments.full_speed };
    let mut record = match &arguments.resume {
        Some(path) if path.exists() => resumed(path, paths, &formats)?,
        _ => Record::new(Soak::new(paths, &formats)),
    };
    match arguments.path {
        Some(path) => record.soak.add(soak_path(paths, path, &formats, |_| false)),
        None => soak(arguments, &formats, &mut record)?,
    }
    let text = match arguments.output.json {
        true => record.to_json()?,
        false => record.to_text(arguments.path),
    };
    output::write(arguments.output.out.as_deref(), &text)?;
    Ok(if record.soak.violations == 0 { Ending::Good } else { Ending::RequirementNotMet })
}

fn soak(arguments: &Arguments, formats: &[SoakFormat], record: &mut Record) -> Result<()> {
    let thousands = |periods: u64| usize::try_from(periods / 1000).unwrap_or(usize::MAX);
    let progress = Progress::of("thousand periods in each format", thousands(arguments.periods));
    let (started, before) = (Instant::now(), record.seconds);
    let mut written = started;
    while record.soak.least_periods() < arguments.periods {
        let next = record.soak.next_path;
        let paths: Vec<u64> = (next..next + BATCH).collect();
        let has = |format| record.soak.has(format, arguments.periods);
        for path in in_parallel(&paths, |path| soak_path(record.soak.paths, *path, formats, has)) {
            record.soak.add(path);
        }
        record.seconds = before + started.elapsed().as_secs_f64();
        record.date = today();
        let is_over = record.soak.least_periods() >= arguments.periods;
        if let Some(path) =
            arguments.resume.as_deref().filter(|_| is_over || written.elapsed() > BETWEEN_STATES)
        {
            output::write(Some(path), &record.to_json()?)?;
            written = Instant::now();
        }
        progress.start_at(thousands(record.soak.least_periods()));
        let hopeless = record.soak.formats.iter().find(|soaked| soaked.paths == 0);
        if let Some(soaked) = hopeless.filter(|_| record.soak.next_path >= PATIENCE) {
            bail!("{} has refused each of {} paths", soaked.format, record.soak.next_path);
        }
    }
    Ok(())
}

fn selected(names: &[String]) -> Result<Vec<SoakFormat>> {
    if names.is_empty() {
        return Ok(SOAK_FORMATS.to_vec());
    }
    let mut selected: Vec<SoakFormat> = Vec::with_capacity(names.len());
    for name in names {
        let name = &meant(name)?;
        let found = SOAK_FORMATS.iter().find(|format| format.name() == name).copied();
        let format = found.with_context(|| {
            let known: Vec<_> = SOAK_FORMATS.iter().map(SoakFormat::name).collect();
            format!("{name:?} cannot be soaked; known are {}", known.join(", "))
        })?;
        if selected.iter().all(|one| one.name() != format.name()) {
            selected.push(format);
        }
    }
    Ok(selected)
}

/// The state that an earlier run has written.
fn resumed(path: &Path, paths: SoakPaths, formats: &[SoakFormat]) -> Result<Record> {
    let name = path.display();
    let record: Record =
        serde_json::from_str(&files::text(path)?).with_context(|| format!("{name} is no state of a soak"))?;
    let soak = &record.soak;
    let SoakPaths { seed, full_speed } = soak.paths;
    ensure!(seed == paths.seed, "{name} is the state of a soak with seed {seed}");
    let speed = if full_speed { "at full speed" } else { "with paths slowed down" };
    ensure!(full_speed == paths.full_speed, "{name} is the state of a soak {speed}");
    let same = soak.formats.iter().map(|one| one.format.as_str()).eq(formats.iter().map(SoakFormat::name));
    ensure!(same, "{name} is the state of a soak in other formats");
    let version = env!("CARGO_PKG_VERSION");
    ensure!(record.version == version, "{name} is the state of a soak by version {}", record.version);
    Ok(record)
}

impl Record {
    fn new(soak: Soak) -> Self {
        Self { date: today(), version: env!("CARGO_PKG_VERSION").to_string(), seconds: 0.0, soak }
    }

    fn to_json(&self) -> Result<String> {
        Ok(serde_json::to_string_pretty(self)? + "\n")
    }

    fn to_text(&self, only: Option<u64>) -> String {
        let Self { soak, seconds, date, .. } = self;
        let counted = &soak.counted;
        let paths = only.map_or_else(|| format!("{} paths", soak.next_path), |path| format!("path {path}"));
        let mut text = match soak.violations {
            0 => screen::answer("Every promise of a step is kept."),
            count => screen::answer(&format!("{count} times a step breaks a promise.")),
        };
        text += "\n";
        text += &self.table();
        if counted.operations > 0 {
            text += &labelled(
                "operations  ",
                &format!(
                    "{} at most in a step, {:.2} of the bound that the code's loops prove",
                    counted.operations, counted.operations_share
                ),
            );
        }
        let speed = if soak.paths.full_speed { ", full speed" } else { "" };
        text += &format!("seed        {}{speed}, {paths}, {seconds:.0} s, {date}\n", soak.paths.seed);
        text += &format!("violations  {}\n", soak.violations);
        for violation in &soak.first_violations {
            let path = format!("  path {}: ", only.unwrap_or(violation.path));
            text += &labelled(&path, &violation.what.to_string());
        }
        text
    }

    fn table(&self) -> String {
        let row = |soaked: &Soaked| {
            let worst = &soaked.worst;
            vec![
                soaked.format.clone(),
                worst.periods.to_string(),
                soaked.paths.to_string(),
                soaked.refused.to_string(),
                worst.evaluations.to_string(),
                format!("{:.2}", worst.length_share),
                format!("{:.2}", worst.chord_error_share),
            ]
        };
        screen::table(
            &[
                "format",
                "periods",
                "paths",
                "refused",
                "evaluations\nat most",
                "chord off,\nof its bound",
                "chord error,\nof its limit",
            ],
            self.soak.formats.iter().map(row).collect(),
        )
    }
}

/// A number that may end in k, M or G.
fn count(text: &str) -> Result<u64, String> {
    let units = [('k', 1_000), ('M', 1_000_000), ('G', 1_000_000_000)];
    let (digits, unit) = units
        .into_iter()
        .find_map(|(letter, unit)| Some((text.strip_suffix(letter)?, unit)))
        .unwrap_or((text, 1_u64));
    let number = digits.parse::<u64>().ok().and_then(|n| n.checked_mul(unit)).filter(|n| *n > 0);
    number.ok_or_else(|| format!("{text:?}: expected a count above 0, as in 100M, 250k or 5000"))
}

fn today() -> String {
    OffsetDateTime::now_utc().date().to_string()
}
