//! `feedbits smooth`: corners of straight moves and arcs, cut or looped, within a tolerance.

mod print;

use std::path::{Path, PathBuf};

use anyhow::Result;
use clap::{Args, ValueEnum};
use domains::options::{CORNER_LAMBDA, SMOOTH_TOLERANCE};
use nurbs_core::{CornerLambda, CornerStyle};
use part_program::Dialect;
use path_smooth::{Options, ProgramError, Smoothed};

use crate::ending::Ending;
use crate::input::{Input, expect_no_side_axes};
use crate::numbers::{number, within};
use crate::output;
use crate::places::Place;
use crate::progress::Progress;

/// Options of `smooth`.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    input: Input,
    /// Largest distance between the smoothed path and the program's moves, both ways, in mm.
    #[arg(long, value_name = "MM", value_parser = number(&SMOOTH_TOLERANCE))]
    tolerance: f64,
    /// Outer corners, which turn the way that their outline turns: in a loop around the corner, or cut like the others. Those of less
    /// than 30° are cut in any case.
    #[arg(long, value_enum, default_value_t = Outer::Cut)]
    outer: Outer,
    /// Shape factor λ of the corners' splines, from -2 to 2; or `auto`: for each corner the λ with the greatest least
    /// radius, so that its slowest place is as fast as the tolerance allows.
    #[arg(long, value_name = "LAMBDA", default_value = "1", value_parser = lambda)]
    lambda: CornerLambda,
    /// Write the smoothed path: curves if the name ends in .toml, else a program of fine straight moves.
    #[arg(long, value_name = "PATH")]
    out: Option<PathBuf>,
    /// Print every corner, with z.
    #[arg(long)]
    wide: bool,
    /// JSON instead of a table: every corner, and the totals.
    #[arg(long)]
    json: bool,
}

/// What becomes of outer corners.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Outer {
    /// Left along the first move, and met again along the second; the corner stays sharp.
    Loop,
    /// Cut off on the inside.
    Cut,
}

/// Smooths, measures and prints the result.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let tolerance_mm = arguments.tolerance;
    let lambda = arguments.lambda;
    let out = arguments.out.as_deref().map(|out| Place::named("--out", Some(out))).transpose()?;
    let terminal = Place::terminal()?;
    let (part, machine) = arguments.input.part_and_machine()?;
    expect_no_side_axes(&part, "a smoothed path")?;
    let outer = match arguments.outer {
        Outer::Loop => CornerStyle::Loop,
        Outer::Cut => CornerStyle::Cut,
    };
    let progress = Progress::spinning("smoothing and planning");
    let mut smoothed = path_smooth::smooth(&part, &machine, &Options { tolerance_mm, outer, lambda })?;
    let form = out.as_ref().and_then(Place::path).map(|path| Form::of(path, arguments.input.dialect()));
    let written = form.map(|form| form.text_of(&mut smoothed));
    progress.finish();
    if let (Some(out), Some(text)) = (&out, written) {
        output::write(out, &text?)?;
    }
    let report = &smoothed.report;
    let text = if arguments.json {
        serde_json::to_string_pretty(report)? + "\n"
    } else {
        print::text(report, arguments.wide)
    };
    output::write(&terminal, &text)?;
    Ok(if report.faults().is_empty() { Ending::Good } else { Ending::RequirementNotMet })
}

/// The shape factor that `--lambda` names.
fn lambda(text: &str) -> Result<CornerLambda, String> {
    if text == "auto" {
        return Ok(CornerLambda::Auto);
    }
    within(&CORNER_LAMBDA, text).map(CornerLambda::Given).map_err(|expected| format!("{expected}, or `auto`"))
}

/// The form in which the path is written.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Form {
    /// A curve file, with the smoothed curves as they are.
    Curves,
    /// A program of fine straight moves, for this control.
    Program(Option<Dialect>),
}

impl Form {
    fn of(path: &Path, dialect: Option<Dialect>) -> Self {
        let is_toml = path.extension().is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
        if is_toml { Self::Curves } else { Self::Program(dialect) }
    }

    /// The text to write, or the reason why there is none.
    fn text_of(self, smoothed: &mut Smoothed) -> Result<String> {
        const NO_PROGRAM: &str = "no program is written; a larger --tolerance takes fewer chords, and a curve file, --out NAME.toml, none";
        match self {
            Self::Curves => Ok(part_program::write_curves(&smoothed.path)),
            Self::Program(dialect) => smoothed.write_program(dialect).map_err(|error| match error {
                ProgramError::Write(error) => anyhow::Error::new(error).context(NO_PROGRAM),
                error => error.into(),
            }),
        }
    }
}
