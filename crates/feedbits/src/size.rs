//! `feedbits size`: the fewest bits that are enough.

use std::fmt::Write;

use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use comfy_table::{CellAlignment, Table, presets};
use format_compare::{Dimension, Engine, Mixed, Problem, Sizing, Space};
use real::{Datapath, Overflow, Rounding};

use crate::formats::selected;
use crate::input::{AnyProblem, Input};
use crate::progress::Progress;
use crate::run_arguments::RunArguments;
use crate::{Ending, output};

/// Options of `size`.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    run: RunArguments,
    /// How the datapath rounds products, quotients, roots and shifts.
    #[arg(long, value_enum, default_value_t = RoundingName::Nearest)]
    rounding: RoundingName,
    /// What sums and products do that do not fit. Quotients and roots saturate in any case.
    #[arg(long, value_enum, default_value_t = OverflowName::Wrap)]
    overflow: OverflowName,
    #[command(flatten)]
    output: output::Output,
}

/// Ways of rounding, by their names on the command line.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum RoundingName {
    /// To nearest, ties up.
    Nearest,
    /// To nearest, ties to even.
    Even,
    /// Toward -∞: the bits are dropped, which takes no adder.
    Floor,
    /// Toward zero.
    Zero,
}

/// Ways of overflowing, by their names on the command line.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum OverflowName {
    /// The high bits are lost.
    Wrap,
    /// The nearest extreme is taken.
    Saturate,
}

impl Arguments {
    fn datapath(&self) -> Datapath {
        let rounding = match self.rounding {
            RoundingName::Nearest => Rounding::Nearest,
            RoundingName::Even => Rounding::NearestEven,
            RoundingName::Floor => Rounding::Floor,
            RoundingName::Zero => Rounding::TowardZero,
        };
        let overflow = match self.overflow {
            OverflowName::Wrap => Overflow::Wrap,
            OverflowName::Saturate => Overflow::Saturate,
        };
        Datapath { rounding, overflow }
    }
}

/// Searches and prints.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    output::expect_place(arguments.output.out.as_deref())?;
    let progress = Progress::spinning("running the path in formats of 12 to 48 bits");
    let sizing = match arguments.run.problem(&arguments.input)? {
        AnyProblem::Planar(problem) => size(&problem, arguments)?,
        AnyProblem::Spatial(problem) => size(&problem, arguments)?,
    };
    progress.finish();
    let text =
        if arguments.output.json { serde_json::to_string_pretty(&sizing)? + "\n" } else { report(&sizing)? };
    output::write(arguments.output.out.as_deref(), &text)?;
    Ok(if sizing.uniform.is_some() { Ending::Good } else { Ending::RequirementNotMet })
}

fn size<const D: usize>(problem: &Problem<D>, arguments: &Arguments) -> Result<Sizing>
where
    Space: Dimension<D>,
{
    let options = arguments.run.options_for(problem)?;
    if options.engine != Engine::Pieces {
        bail!("registers are sized for compiled pieces: give --evaluate pieces, or nothing");
    }
    let formats = selected::<D>(&["f64".to_string()])?;
    let plan = format_compare::plan_for(problem, formats[0].as_ref(), &options)?;
    Ok(format_compare::size(problem, &plan, &options, arguments.datapath())?)
}

fn report(sizing: &Sizing) -> Result<String> {
    let mut text = String::from("Bits against fluctuation, one format for all signals:\n");
    let mut table = Table::new();
    table.load_preset(presets::UTF8_FULL_CONDENSED).set_header(["format", "bits", "fluctuation", ""]);
    for point in &sizing.front {
        let good = if point.good { "good enough" } else { "" };
        table.add_row([&point.format, &point.bits.to_string(), &format!("{:.1e}", point.fluctuation), good]);
    }
    for column in [1, 2] {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    writeln!(text, "{table}")?;
    match (&sizing.uniform, sizing.uniform_margin) {
        (Some(row), Some(margin)) => {
            writeln!(
                text,
                "\nFewest bits, one format: {} ({} bits), {margin:.1} times better than asked.",
                row.format, row.bits
            )?;
        }
        _ => {
            writeln!(text, "\nNo format of up to 48 bits meets the requirements.")?;
            if let Some(widest) = sizing.tried.last() {
                writeln!(text, "The widest, {}: {}.", widest.format, widest.verdict)?;
            }
            if let Some(why) = &sizing.not_a_question_of_format {
                writeln!(text, "{why}")?;
            }
        }
    }
    if let Some(mixed) = &sizing.mixed {
        text += &registers(mixed)?;
    }
    writeln!(text, "{} runs of the whole path.", sizing.runs)?;
    Ok(text)
}

fn registers(mixed: &Mixed) -> Result<String> {
    let mut table = Table::new();
    table.load_preset(presets::UTF8_FULL_CONDENSED).set_header([
        "signal",
        "group",
        "format",
        "bits",
        "proven bound",
    ]);
    for s in &mixed.signals {
        table.add_row([s.signal, s.group, &s.format, &s.bits.to_string(), &format!("{:.4}", s.bound)]);
    }
    for column in [3, 4] {
        if let Some(column) = table.column_mut(column) {
            column.set_cell_alignment(CellAlignment::Right);
        }
    }
    let mut text = String::new();
    writeln!(
        text,
        "Fewest bits, a register for each signal: {} bits in all, against {} in one format; fluctuation {:.1e}, {:.1} times better than asked.\n{table}",
        mixed.bits, mixed.uniform_bits, mixed.fluctuation, mixed.margin
    )?;
    Ok(text)
}
