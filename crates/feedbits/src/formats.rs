//! `feedbits formats`: the built-in number formats.

use anyhow::{Result, anyhow, bail};
use clap::Args;
use format_compare::{Dimension, Space};
use real::{FormatName, QName, RuntimeFormat};
use serde::Serialize;

use crate::ending::Ending;
use crate::{output, screen};

/// How names are formed; printed below the list.
const NAMES: &str = "
Any fixed-point format of 3 to 64 bits can be named: I5F13 has 5 bits before the
point, the sign among them and at least 2 of them, and 13 behind it. After that
-even, -floor or -zero round otherwise than to nearest, and -sat saturates.

A name in Q notation is read by the register of 8, 16, 32 or 64 bits it fills:
    Q8.24       I8F24   as Arm counts: the sign is within m, m + n bits
    Q7.24       I8F24   as TI counts: the sign is beside m, m + n + 1 bits
    Q15, Q.15   I1F15   a sign and n bits behind the point; too few before it
                        to be run here, for 1 is no number of that format
";

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
    let place = arguments.output.place()?;
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
    output::write(&place, &text)?;
    Ok(Ending::Good)
}

/// The formats of these names; all formats if there are no names. A note says how a name in Q notation was read.
pub(crate) fn selected<const D: usize>(names: &[String]) -> Result<Vec<Box<dyn format_compare::Format<D>>>>
where
    Space: Dimension<D>,
{
    if names.is_empty() {
        return Ok(format_compare::formats());
    }
    let names = names.iter().map(|name| meant(name)).collect::<Result<Vec<String>>>()?;
    format_compare::select(&names).map_err(|name| unknown(&name))
}

/// The name of the format that is meant. A note says how a name in Q notation was read.
pub(crate) fn named(name: &str) -> Result<FormatName> {
    let name = meant(name)?;
    by_name::<3>(&name).map(|format| format.name()).ok_or_else(|| unknown(&name))
}

/// The name in this program's notation. A name in Q notation is translated, which a note says; other names are returned
/// unchanged.
pub(crate) fn meant(name: &str) -> Result<String> {
    let (format, how) = match QName::read(name) {
        None => return Ok(name.to_string()),
        Some(QName::Arm(format)) => {
            (format, format!("as Arm counts, the sign is within m, and m + n are {} bits", format.bits()))
        }
        Some(QName::Ti(format)) => {
            (format, format!("as TI counts, the sign is beside m, and m + n + 1 are {} bits", format.bits()))
        }
        Some(QName::Fraction(format)) => {
            (format, format!("a sign and n bits behind the point are {} bits", format.bits()))
        }
        Some(QName::Unclear { integer_bits: Some(m), fraction_bits: n }) => bail!(
            "unknown format {name:?}: neither m + n, as Arm counts, nor m + n + 1, as TI does, is a register of 8, 16, 32 or 64 bits: \
             expected I{m}F{n} if the sign is within m, or I{}F{n} if it is not",
            m + 1
        ),
        Some(QName::Unclear { integer_bits: None, fraction_bits: n }) => bail!(
            "unknown format {name:?}: a sign and {n} bits behind the point are no register of 8, 16, 32 or 64 bits: expected the bits \
             before the point too, as in I{}F{n}",
            if n <= 30 { 32 - n } else { 64_u32.saturating_sub(n).max(2) }
        ),
    };
    let (read, bits) = (format.to_string(), format.bits());
    if RuntimeFormat::named(&read).is_none() {
        bail!(
            "format {name:?} is {read}, which does not hold the number 1: expected at least 2 bits before the point, as in I2F{}",
            bits - 2
        );
    }
    output::note(&format!("{name} is read as {read}: {how}"));
    Ok(read)
}

/// The error for a name that no format has.
fn unknown(name: &str) -> anyhow::Error {
    let cases = [name.to_uppercase(), name.to_lowercase()];
    let built_in: Vec<String> =
        format_compare::formats::<3>().iter().map(|format| format.name().to_string()).collect();
    let built_in: Vec<&str> = built_in.iter().map(String::as_str).collect();
    let in_other_case = cases.iter().find(|meant| by_name::<3>(meant).is_some()).map(String::as_str);
    let meant = in_other_case.or_else(|| part_program::nearest(name, &built_in));
    match meant {
        Some(meant) => anyhow!("unknown format {name:?}: did you mean `{meant}`?"),
        None => anyhow!(
            "unknown format {name:?}: expected one that `feedbits formats` lists, or a fixed-point format such as I5F13: 3 to 64 bits \
             in all, at least 2 of them before the point; behind it -even, -floor or -zero, and then -sat; or one in Q notation that \
             fills a register, as Q8.24 (Arm) or Q7.24 (TI) for I8F24"
        ),
    }
}

/// One name of a list, without the blanks beside its commas.
pub(crate) fn name(text: &str) -> Result<String, std::convert::Infallible> {
    Ok(text.trim().to_string())
}

/// The format of this name.
pub(crate) fn by_name<const D: usize>(name: &str) -> Option<Box<dyn format_compare::Format<D>>>
where
    Space: Dimension<D>,
{
    format_compare::format_named(name)
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
    screen::table(&["format", "bits", "kind", "range", "step at 1"], listed.iter().map(row).collect()) + NAMES
}
