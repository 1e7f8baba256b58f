//! `feedbits formats`: the built-in number formats.

use anyhow::Result;
use clap::Args;
use format_compare::{Dimension, Space};
use real::FormatName;
use serde::Serialize;

use crate::{Ending, output, screen};

/// Options of `formats`.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    output: output::Output,
}

#[derive(Serialize)]
struct Listed {
    format: String,
    bits: u32,
    kind: &'static str,
    largest: f64,
    resolution_at_1: f64,
}

/// Prints name, width, range and resolution of each format.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let listed: Vec<Listed> = format_compare::formats::<3>()
        .iter()
        .map(|format| Listed {
            format: format.name().to_string(),
            bits: format.name().bits(),
            kind: match format.name() {
                FormatName::Fixed { .. } => "fixed point",
                _ => "floating point",
            },
            largest: format.largest(),
            resolution_at_1: format.resolution(),
        })
        .collect();
    let text =
        if arguments.output.json { serde_json::to_string_pretty(&listed)? + "\n" } else { table(&listed) };
    output::write(arguments.output.out.as_deref(), &text)?;
    Ok(Ending::Good)
}

/// The formats of these names, or all if none is given.
pub(crate) fn selected<const D: usize>(names: &[String]) -> Result<Vec<Box<dyn format_compare::Format<D>>>>
where
    Space: Dimension<D>,
{
    if names.is_empty() {
        return Ok(format_compare::formats());
    }
    format_compare::select(names)
        .map_err(|name| {
            let cases = [name.to_uppercase(), name.to_lowercase()];
            match cases.iter().find(|meant| by_name::<D>(meant).is_some()) {
                Some(meant) => anyhow::anyhow!("unknown format {name:?}: did you mean {meant}?"),
                None => anyhow::anyhow!("unknown format {name:?}: expected one that `feedbits formats` lists, or a fixed-point format such as I5F13: 3 to 64 bits in all, at least 2 of them before the point; behind it -even, -floor or -zero, and then -sat"),
            }
        })
}

/// One name of a list, which may have blanks beside its commas.
pub(crate) fn name(text: &str) -> Result<String, std::convert::Infallible> {
    Ok(text.trim().to_string())
}

/// The format of this name.
pub(crate) fn by_name<const D: usize>(name: &str) -> Option<Box<dyn format_compare::Format<D>>>
where
    Space: Dimension<D>,
{
    format_compare::select(&[name.to_string()]).ok().and_then(|mut found| found.pop())
}

fn table(listed: &[Listed]) -> String {
    let row = |format: &Listed| {
        vec![
            format.format.clone(),
            format.bits.to_string(),
            format.kind.to_string(),
            format!("±{:.3e}", format.largest),
            format!("{:.1e}", format.resolution_at_1),
        ]
    };
    screen::table(&["format", "bits", "kind", "range", "step at 1"], listed.iter().map(row).collect())
        + "\n"
        + &screen::paragraph(
            "Any other fixed-point format of 3 to 64 bits can be named too, as I5F13; see `feedbits compare --help`.",
        )
}
