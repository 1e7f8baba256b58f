//! `soak`: random paths in every format, until each format has made so many periods. Its status is 0 if every promise
//! was kept, 1 if one was broken, and 2 if it could not run. With `--program` it runs that program in place of random
//! paths, with feed overrides and holds.

mod program;

use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::ExitCode;
use std::time::{Duration, Instant};

use anyhow::{Context, Result, bail, ensure};
use clap::Parser;
use comfy_table::{CellAlignment, Table, presets};
use feed_plan::in_parallel;
use indicatif::{ProgressBar, ProgressStyle};
use serde::{Deserialize, Serialize};
use stress::{SOAK_FORMATS, Soak, SoakFormat, SoakPaths, Soaked, soak_path};
use time::OffsetDateTime;

/// Runs random paths in every format, and holds each step to its promises, until so many periods were made.
#[derive(Parser)]
#[command(version)]
struct Arguments {
    /// Periods that each format is to make, as in 100M, 250k or 5000.
    #[arg(long, allow_negative_numbers = true, value_name = "N", default_value = "1M", value_parser = count)]
    periods: u64,
    /// The formats, comma-separated. Default: the ten built-in ones, and I5F21 as one chosen at run time.
    #[arg(long, visible_alias = "format", value_delimiter = ',', value_name = "F,F")]
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
    /// Run this part program in every format instead, section by section, with feed overrides and holds that the seed draws.
    #[arg(long, value_name = "FILE", requires = "machine", conflicts_with_all = ["periods", "full_speed", "path", "resume"])]
    program: Option<PathBuf>,
    /// The machine file that the program is run on, as those in data/machines.
    #[arg(long, value_name = "FILE", requires = "program")]
    machine: Option<PathBuf>,
    /// JSON instead of a table.
    #[arg(long)]
    json: bool,
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

fn main() -> ExitCode {
    match run(&Arguments::parse()) {
        Ok(true) => ExitCode::SUCCESS,
        Ok(false) => ExitCode::from(1),
        Err(error) => {
            eprintln!("soak: {error:#}");
            ExitCode::from(2)
        }
    }
}

/// Runs until every format has made its periods. Returns whether every promise was kept.
fn run(arguments: &Arguments) -> Result<bool> {
    let formats = selected(&arguments.formats)?;
    if let (Some(program), Some(machine)) = (&arguments.program, &arguments.machine) {
        let names: Vec<_> = formats.iter().map(SoakFormat::name).collect();
        let soak = program::soak(program, machine, &names, arguments.seed, today())?;
        written(&if arguments.json { soak.to_json()? } else { soak.to_text() })?;
        return Ok(soak.is_kept());
    }
    let paths = SoakPaths { seed: arguments.seed, full_speed: arguments.full_speed };
    let mut record = match &arguments.resume {
        Some(path) if path.exists() => resumed(path, paths, &formats)?,
        _ => Record::new(Soak::new(paths, &formats)),
    };
    match arguments.path {
        Some(path) => record.soak.add(soak_path(paths, path, &formats, |_| false)),
        None => soak(arguments, &formats, &mut record)?,
    }
    written(&if arguments.json { record.to_json()? } else { record.to_text(arguments.path) })?;
    Ok(record.soak.violations == 0)
}

fn written(text: &str) -> Result<()> {
    match std::io::stdout().lock().write_all(text.as_bytes()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => {
            Err(error).context("cannot write to the terminal")
        }
        _ => Ok(()),
    }
}

fn soak(arguments: &Arguments, formats: &[SoakFormat], record: &mut Record) -> Result<()> {
    let style = ProgressStyle::with_template("{bar:30} {pos}/{len} {msg}, {elapsed} (eta {eta})")?;
    let progress =
        ProgressBar::new(arguments.periods).with_style(style).with_message("periods in each format");
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
            write_whole(path, &record.to_json()?)
                .with_context(|| format!("cannot write {}", path.display()))?;
            written = Instant::now();
        }
        progress.set_position(record.soak.least_periods());
        let hopeless = record.soak.formats.iter().find(|soaked| soaked.paths == 0);
        if let Some(soaked) = hopeless.filter(|_| record.soak.next_path >= PATIENCE) {
            bail!("{} has refused each of {} paths", soaked.format, record.soak.next_path);
        }
    }
    progress.finish_and_clear();
    Ok(())
}

/// Writes a file that appears whole, in place of what was there, or not at all.
fn write_whole(path: &Path, text: &str) -> Result<()> {
    let folder = path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."));
    let mut file = tempfile::NamedTempFile::new_in(folder)?;
    file.write_all(text.as_bytes())?;
    file.persist(path)?;
    Ok(())
}

fn selected(names: &[String]) -> Result<Vec<SoakFormat>> {
    if names.is_empty() {
        return Ok(SOAK_FORMATS.to_vec());
    }
    let mut selected: Vec<SoakFormat> = Vec::with_capacity(names.len());
    for name in names {
        let found = SOAK_FORMATS.iter().find(|format| format.name() == name.as_str()).copied();
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
    let text = std::fs::read_to_string(path).with_context(|| format!("cannot read {name}"))?;
    let record: Record =
        serde_json::from_str(&text).with_context(|| format!("{name} is no state of a soak"))?;
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
            0 => "Every promise of a step is kept.\n\n".to_string(),
            count => format!("{count} times a step breaks a promise.\n\n"),
        };
        text += &self.table();
        if counted.operations > 0 {
            let share = counted.operations_share;
            text += &format!(
                "operations  {} at most in a step, {share:.2} of the bound that the code's loops prove\n",
                counted.operations
            );
        }
        let speed = if soak.paths.full_speed { ", full speed" } else { "" };
        text += &format!("seed        {}{speed}, {paths}, {seconds:.0} s, {date}\n", soak.paths.seed);
        text += &format!("violations  {}\n", soak.violations);
        for violation in &soak.first_violations {
            text += &format!("  path {}: {}\n", only.unwrap_or(violation.path), violation.what);
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
        let header = [
            "format",
            "periods",
            "paths",
            "refused",
            "evaluations\nat most",
            "chord off,\nof its bound",
            "chord error,\nof its limit",
        ];
        let mut table = Table::new();
        table.load_preset(presets::NOTHING).set_header(header);
        table.add_rows(self.soak.formats.iter().map(row));
        for column in table.column_iter_mut().skip(1) {
            column.set_cell_alignment(CellAlignment::Right);
        }
        table.trim_fmt() + "\n"
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
