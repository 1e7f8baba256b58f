//! `feedbits zoo`: kernels of controllers whose numbers failed in public, run in every format.

use anyhow::{Result, anyhow};
use clap::Args;
use kernel_size::Comparison;
use kernel_zoo::{ALL, Found, Report, Variant};
use real::FormatName;

use crate::ending::Ending;
use crate::{formats, output, screen};

/// Options of `zoo`.
#[derive(Args)]
pub(crate) struct Arguments {
    /// One kernel: all its runs, as it was reported and cured, the first bad step of each, and where it goes another way.
    kernel: Option<String>,
    /// Formats to run the kernels in, besides that of each report; the built-in ones by default.
    #[arg(long, value_name = "NAMES", value_delimiter = ',', value_parser = formats::name)]
    formats: Vec<String>,
    #[command(flatten)]
    output: output::Output,
}

/// Runs the kernels and prints which format cures each fault, or that none does.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let place = arguments.output.place()?;
    let formats = match &arguments.formats[..] {
        [] => kernel_size::built_in(),
        names => names.iter().map(|name| formats::named(name)).collect::<Result<Vec<FormatName>>>()?,
    };
    let reports: Vec<&Report> = match &arguments.kernel {
        None => ALL.to_vec(),
        Some(name) => vec![kernel_zoo::named(name).ok_or_else(|| unknown(name))?],
    };
    let found = reports.iter().map(|report| Ok(report.judge(&formats)?)).collect::<Result<Vec<Found>>>()?;
    let text = match (arguments.output.json, &found[..]) {
        (true, _) => serde_json::to_string_pretty(&found)? + "\n",
        (false, [only]) if arguments.kernel.is_some() => one(only),
        (false, all) => list(all),
    };
    output::write(&place, &text)?;
    Ok(Ending::Good)
}

fn unknown(name: &str) -> anyhow::Error {
    let names: Vec<&str> = ALL.iter().map(|report| report.name).collect();
    let meant = output::did_you_mean(name, &names);
    anyhow!("unknown kernel {name:?}: {meant}expected {}", names.join(", "))
}

/// The formats in which a kernel is good, in words.
fn cured_by(variant: &Variant) -> String {
    let good: Vec<&str> = variant.good_formats.iter().map(String::as_str).collect();
    match &good[..] {
        [] if variant.comparison.not_a_question_of_format => "none: it is no question of format".to_string(),
        [] => "none of these".to_string(),
        good => good.join(", "),
    }
}

fn step(variant: &Variant) -> String {
    variant.first_bad_step.map_or_else(String::new, |step| step.to_string())
}

fn list(all: &[Found]) -> String {
    let row = |found: &Found| {
        let Found { report, as_reported, cured } = found;
        let cure = if cured.good_as_reported { "good" } else { "bad" };
        let cells = [
            report.name,
            report.thread,
            report.reported_in,
            &step(as_reported),
            &cured_by(as_reported),
            cure,
        ];
        cells.map(str::to_string).to_vec()
    };
    let said = format!(
        "{} kernels of controllers whose numbers failed in public, and the formats that cure them. Each also runs with the cure \
         of its algorithm, in the format of the report. Every run of one: feedbits zoo NAME",
        all.len()
    );
    let header = ["kernel", "report", "in", "first\nbad step", "cured by", "with its\ncure"];
    format!("{}\n{}", screen::paragraph(&said), screen::table(&header, all.iter().map(row).collect()))
}

fn one(found: &Found) -> String {
    let Found { report, as_reported, cured } = found;
    let said = match as_reported.good_formats.is_empty() {
        true => format!("None of the formats that ran cures {}.", report.name),
        false => format!("{} is cured by {}.", report.name, cured_by(as_reported)),
    };
    screen::answer(&said)
        + &screen::labelled("Report: ", &format!("{} {}", report.fault, report.url()))
        + &screen::labelled("Cure: ", report.cure)
        + "\nAs it was reported:\n"
        + &runs(&as_reported.comparison)
        + "\nCured:\n"
        + &runs(&cured.comparison)
}

/// The lines of a comparison behind its first, which names the kernel.
fn runs(comparison: &Comparison) -> String {
    let text = comparison.to_string();
    text.lines()
        .skip(1)
        .map(
            |line| {
                if line.len() > screen::COLUMNS { screen::labelled("", line) } else { format!("{line}\n") }
            },
        )
        .collect()
}
