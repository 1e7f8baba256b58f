//! `feedbits convert`: a part as a program of another dialect, as straight moves, or as a curve file.

use std::path::PathBuf;

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use part_program::{
    Curve, MoveKind, Part, ReadOptions, read_part_with, write_curves, write_g1, write_g5_2, write_g06_2,
};

use crate::input::Input;
use crate::{Ending, output};

/// Options of `convert`.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    input: Input,
    /// What to write.
    #[arg(long, value_enum)]
    to: Target,
    /// With --to g1: largest distance between the curves and the straight moves, in mm.
    #[arg(long, allow_negative_numbers = true, value_name = "MM", default_value_t = 0.001)]
    tolerance: f64,
    /// Write to this file instead of the terminal.
    #[arg(long, value_name = "PATH")]
    out: Option<PathBuf>,
}

/// What can be written.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Target {
    /// FANUC's NURBS; every number is kept bit by bit.
    #[value(name = "g06.2")]
    G06_2,
    /// LinuxCNC's NURBS, planar; knots other than uniform ones are cut into Bézier curves.
    #[value(name = "g5.2")]
    G5_2,
    /// Straight moves within --tolerance.
    G1,
    /// A curve file, with the machine if one is given; every number is kept bit by bit.
    Toml,
}

/// Reads, writes, reads back, and says what has changed.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let tolerance = arguments.tolerance;
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        bail!("--tolerance {tolerance}: expected a positive length in mm");
    }
    let mut part = arguments.input.part()?;
    part.machine = arguments.input.machine_of(&part)?;
    let text = match arguments.to {
        Target::G06_2 => write_g06_2(&part)?,
        Target::G5_2 => write_g5_2(&part)?,
        Target::G1 => write_g1(&part, tolerance, arguments.input.dialect())?,
        Target::Toml => write_curves(&part),
    };
    // Of the others, the words tell whose they are.
    let dialect = arguments.input.dialect().filter(|_| arguments.to == Target::G1);
    let again = read_part_with("what was written", &text, ReadOptions { dialect, lenient: false })
        .context("what was written does not read back: nothing is kept")?;
    output::write(arguments.out.as_deref(), &text)?;
    for note in notes(&part, &again, arguments.to) {
        output::note(&note);
    }
    Ok(Ending::Good)
}

/// What a reader of the new file has to know.
fn notes(part: &Part, again: &Part, to: Target) -> Vec<String> {
    let (before, after) = (at_feed(part), at_feed(again));
    let mut notes = vec![match to {
        Target::G1 => format!("{} curves are {} straight moves", before.len(), after.len()),
        _ if before == after => format!("{} curves, which read back bit by bit", before.len()),
        _ => format!(
            "{} curves, which read back as {} others: the dialect lacks words",
            before.len(),
            after.len()
        ),
    }];
    let (words, kept) = (part.auxiliary.len(), again.auxiliary.len());
    if to == Target::Toml && words > 0 {
        notes.push(format!("{words} words M, S, T, D or H are left out: a curve file has none"));
    } else if kept > words {
        notes.push("M30 was added at the end".into());
    }
    if !part.standstills.is_empty() {
        notes.push(format!("{} moves that go nowhere are left out", part.standstills.len()));
    }
    let stops = |part: &Part| part.moves.iter().filter(|one| one.exact_stop).count();
    if stops(again) < stops(part) {
        notes.push(format!("{} of {} exact stops are lost", stops(part) - stops(again), stops(part)));
    }
    if part.machine.is_some() && to != Target::Toml {
        notes.push("the machine is left out: a program has none".into());
    }
    notes
}

fn at_feed(part: &Part) -> Vec<&Curve> {
    let feed = part.curves.iter().zip(&part.moves).filter(|(_, one)| one.kind == MoveKind::Feed);
    feed.map(|(curve, _)| curve).collect()
}
