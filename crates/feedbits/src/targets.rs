//! `feedbits targets`, and the choice of targets for `compare`.

use std::path::PathBuf;

use anyhow::{Result, bail};
use clap::Args;
use clap_complete::ArgValueCandidates;
use domains::options::{CLOCK, DIVIDERS, MULTIPLIERS};
use serde::Serialize;
use target_cost::{Calibration, Clock, Confidence, Kind, Known, Measure, Mhz, Prediction, Target, built_in};

use crate::ending::Ending;
use crate::numbers::{number, whole};
use crate::screen::{self, labelled, short};
use crate::{candidates, files, output};

/// Options of `targets`.
#[derive(Args)]
pub(crate) struct Arguments {
    /// The target whose every number is to be listed, with its source. Default: all targets, a line each.
    #[arg(add = ArgValueCandidates::new(candidates::targets))]
    target: Option<String>,
    /// Target files to list beside the built-in ones.
    #[arg(long, value_name = "FILE")]
    target_file: Vec<PathBuf>,
    /// Predict the steps that were traced in the emulator, and print the ratios.
    #[arg(long, conflicts_with = "target")]
    check: bool,
    /// Print the order of operations and where costs are from beside each target, and a source in each row of one: about 190
    /// columns.
    #[arg(long, conflicts_with = "check")]
    wide: bool,
    #[command(flatten)]
    output: output::Output,
}

/// Targets to price a comparison on.
#[derive(Args)]
pub(crate) struct TargetArguments {
    /// Targets to price a period on, comma-separated; the recommendation is for the first. See `feedbits targets`.
    #[arg(long, value_delimiter = ',', value_name = "T,T", add = ArgValueCandidates::new(candidates::targets))]
    targets: Vec<String>,
    /// A target file (TOML); may be given more than once.
    #[arg(long, value_name = "FILE")]
    target_file: Vec<PathBuf>,
    /// Multipliers on an FPGA.
    #[arg(long, value_name = "N", value_parser = whole::<u32>(&MULTIPLIERS))]
    multipliers: Option<u32>,
    /// Dividers on an FPGA.
    #[arg(long, value_name = "N", value_parser = whole::<u32>(&DIVIDERS))]
    dividers: Option<u32>,
    /// The clock of every target, in MHz, in place of the target's own.
    #[arg(long, value_name = "MHZ", value_parser = number(&CLOCK))]
    clock: Option<f64>,
}

impl TargetArguments {
    /// The targets in the order of the options; targets of files that are not named come last.
    pub(crate) fn read(&self) -> Result<Vec<Target>> {
        let from_files = files(&self.target_file)?;
        // The built-in targets are read only where a target is named: that takes as long as a fifth of a comparison in one
        // format.
        let built_in = if self.targets.is_empty() { Vec::new() } else { built_in()? };
        let known: Vec<Target> = from_files.iter().cloned().chain(built_in).collect();
        let mut chosen: Vec<Target> = Vec::new();
        for name in &self.targets {
            match known.iter().find(|target| target.name == *name) {
                Some(target) if chosen.iter().any(|one| one.name == target.name) => {}
                Some(target) => chosen.push(target.clone()),
                None => bail!("{}", unknown(name, &known)),
            }
        }
        let unnamed = from_files.into_iter().filter(|target| !self.targets.contains(&target.name));
        chosen.extend(unnamed);
        let units = [("multiplier", self.multipliers), ("divider", self.dividers)];
        let has = |name: &str| chosen.iter().any(|target| target.unit.iter().any(|unit| unit.name == name));
        if let Some((name, _)) = units.iter().find(|(name, count)| count.is_some() && !has(name)) {
            bail!(
                "--{name}s: no target is priced that has {name}s to count: expected one on an FPGA with --targets"
            );
        }
        if self.clock.is_some() && !chosen.iter().any(|target| target.measure == Measure::Cycles) {
            bail!("--clock: no target is priced in cycles: expected one with --targets");
        }
        let with = |target: Target| {
            let target = units.iter().fold(target, |target, (name, count)| match count {
                Some(count) => target.with_units(name, *count),
                None => target,
            });
            match self.clock {
                Some(mhz) => target.with_clock(mhz),
                None => target,
            }
        };
        Ok(chosen.into_iter().map(with).collect())
    }
}

/// The targets of these files. Their names are parts of names of files, where some systems do not tell `A` from `a`.
fn files(paths: &[PathBuf]) -> Result<Vec<Target>> {
    let mut targets: Vec<Target> = Vec::new();
    for path in paths {
        let text = files::text("--target-file", path, files::MOST_OF_SMALL)?;
        let target = Target::read(&path.display().to_string(), &text)?;
        if let Some(known) = targets.iter().find(|known| known.name.eq_ignore_ascii_case(&target.name)) {
            bail!(
                "{}: name = {:?}: another --target-file has {:?}; expected a name for each",
                path.display(),
                target.name,
                known.name
            );
        }
        targets.push(target);
    }
    Ok(targets)
}

fn unknown(name: &str, known: &[Target]) -> String {
    let names: Vec<&str> = known.iter().map(|target| target.name.as_str()).collect();
    format!("unknown target {name:?}: {}expected {}", output::did_you_mean(name, &names), names.join(", "))
}

/// Lists targets, or one target's numbers, or the predictions.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let place = arguments.output.place()?;
    let known: Vec<Target> = files(&arguments.target_file)?.into_iter().chain(built_in()?).collect();
    let json = arguments.output.json;
    let text = if arguments.check {
        let checked = checks(&known)?;
        if json { serde_json::to_string_pretty(&checked)? + "\n" } else { check_table(&checked) }
    } else if let Some(name) = &arguments.target {
        let Some(target) = known.iter().find(|target| target.name == *name) else {
            bail!("{}", unknown(name, &known));
        };
        if json { serde_json::to_string_pretty(target)? + "\n" } else { numbers(target, arguments.wide) }
    } else if json {
        serde_json::to_string_pretty(&known)? + "\n"
    } else {
        list(&known, arguments.wide)
    };
    output::write(&place, &text)?;
    Ok(Ending::Good)
}

fn list(targets: &[Target], wide: bool) -> String {
    let clock = |target: &Target| {
        let mhz = || target.clock.iter().map(|clock| clock.mhz.range().typical);
        match mhz().reduce(f64::min).zip(mhz().reduce(f64::max)) {
            Some((least, most)) if least < most => format!("{least} to {most}, by format"),
            Some((only, _)) => only.to_string(),
            None => "unknown".to_string(),
        }
    };
    let row = |target: &Target| {
        let mut cells = vec![target.name.clone(), target.title.clone()];
        if wide {
            let order = match target.kind {
                Kind::Processor => "in program order",
                Kind::Vliw => "list schedule, several a cycle",
                Kind::Fpga => "list schedule on bought units",
            };
            cells.push(order.to_string());
        }
        cells.push(clock(target));
        if wide {
            let costs = match (target.calibrated, target.measure) {
                (true, Measure::Cycles) => "instructions counted in an emulator, cycles of the manual",
                (true, Measure::Instructions) => "instructions counted in an emulator; cycles unknown",
                (false, _) => "manuals",
            };
            cells.push(costs.to_string());
        }
        cells
    };
    let rows: Vec<_> = targets.iter().map(row).collect();
    let said = format!("{} targets. Every number of one with its source: feedbits targets NAME", rows.len());
    let table = if wide {
        let header = ["target", "what it is", "order", "clock MHz", "costs of operations"];
        screen::wide_table(&header, rows, &[0, 1, 2, 3, 4])
    } else {
        screen::table(&["target", "what it is", "clock MHz"], rows)
    };
    format!("{}\n{table}", screen::paragraph(&said))
}

/// A clock, its formats, and where it is from.
fn clock_and_source(clock: &Clock) -> String {
    let mhz = match clock.mhz {
        Mhz::Exactly(mhz) => short(mhz),
        Mhz::Range(mhz) => format!("{} ({}–{})", short(mhz.typical), short(mhz.low), short(mhz.high)),
    };
    let formats = match (&clock.numbers, clock.max_bits) {
        (Some(format), _) => format!(" in {format}"),
        (None, Some(bits)) => format!(" to {bits} bits"),
        (None, None) => String::new(),
    };
    format!("clock {mhz} MHz{formats}: {}", clock.source)
}

fn numbers(target: &Target, wide: bool) -> String {
    let clocks = target.clock.iter().map(clock_and_source);
    let head = screen::answer(&format!("{}: {}", target.name, target.title))
        + &clocks.map(|clock| screen::paragraph(&clock)).collect::<String>()
        + "\n";
    let mut sources: Vec<&str> = Vec::new();
    let mut rows = Vec::new();
    for row in &target.operation {
        let formats = match row.max_bits {
            Some(bits) => format!("{} to {bits} bits", row.numbers),
            None => row.numbers.clone(),
        };
        let per_bit = match (row.per_bit, row.per_fraction_bit) {
            (0.0, 0.0) => String::new(),
            (bit, fraction) => format!(" + {bit}·bits + {fraction}·fraction"),
        };
        let trust = match row.confidence {
            Confidence::High => "high",
            Confidence::Medium => "medium",
            Confidence::Low => "low",
        };
        let unit = row.unit.clone().unwrap_or_default();
        let mut cells = vec![row.name.name().to_string(), formats];
        if wide {
            cells.extend(match row.cycles {
                Known::Cycles(c) => [c.low, c.typical, c.high].map(|cycles| format!("{cycles:.1}{per_bit}")),
                Known::Not(_) => ["unknown"; 3].map(String::from),
            });
            cells.extend([unit, row.source.clone(), trust.to_string()]);
        } else {
            cells.push(match row.cycles {
                Known::Cycles(c) => format!("{:.1} ({:.1}–{:.1}){per_bit}", c.typical, c.low, c.high),
                Known::Not(_) => "unknown".to_string(),
            });
            let number = sources.iter().position(|source| *source == row.source);
            let number = number.unwrap_or_else(|| {
                sources.push(&row.source);
                sources.len() - 1
            });
            cells.extend([unit, trust.to_string(), format!("[{}]", number + 1)]);
        }
        rows.push(cells);
    }
    if wide {
        let header =
            ["operation", "formats", "cycles\nlow", "\ntypical", "\nhigh", "unit", "source", "trust"];
        return head + &screen::wide_table(&header, rows, &[0, 1, 5, 6, 7]);
    }
    let header = ["operation", "formats", "cycles, typical\n(low–high)", "unit", "trust", "source"];
    let sources = sources.iter().enumerate();
    let sources = sources.map(|(index, source)| labelled(&format!("[{}] ", index + 1), source));
    head + &screen::table(&header, rows) + "\n" + &sources.collect::<String>()
}

/// A target's predictions.
#[derive(Serialize)]
struct Check {
    target: String,
    format: String,
    path: String,
    traced: f64,
    predicted: f64,
    ratio: f64,
}

fn checks(targets: &[Target]) -> Result<Vec<Check>> {
    let calibration = Calibration::committed()?;
    let of = |target: &Target| {
        let check = |p: Prediction| Check {
            target: target.name.clone(),
            format: p.format,
            path: p.path,
            traced: p.traced.typical,
            predicted: p.predicted.typical,
            ratio: p.predicted.typical / p.traced.typical,
        };
        calibration.predictions(&target.name, target.measure).into_iter().map(check).collect::<Vec<_>>()
    };
    Ok(targets.iter().filter(|target| target.calibrated).flat_map(of).collect())
}

fn check_table(checks: &[Check]) -> String {
    let row = |check: &Check| {
        vec![
            check.target.clone(),
            check.format.clone(),
            check.path.clone(),
            format!("{:.0}", check.traced),
            format!("{:.0}", check.predicted),
            format!("{:.3}", check.ratio),
        ]
    };
    let off = checks.iter().map(|check| (check.ratio - 1.0).abs()).fold(0.0, f64::max);
    screen::answer(&format!("Predictions are at most {:.0} % off.", 100.0 * off))
        + &screen::paragraph(
            "A step, mean: traced in the emulator, and predicted from the costs of its operations.",
        )
        + "\n"
        + &screen::table(
            &["target", "format", "path", "traced", "predicted", "ratio"],
            checks.iter().map(row).collect(),
        )
}
