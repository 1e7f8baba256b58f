//! `feedbits compile`: a part for a controller, as constants that its firmware includes, as C, as a core in Verilog, or as a file
//! that it reads section by section.

mod c;
mod judged;
mod rust;
mod stream;
mod verilog;

use std::borrow::Cow;

use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use clap_complete::ArgValueCandidates;
use domains::options::{BUFFER, FEED_OVERRIDE, FLASH, RESERVE};
use format_compare::{
    Compared, Dimension, Engine, JudgedRun, Options, OverrideTarget, Overrides, Problem, Space, Verdict,
    Watch,
};

use c::CPlace;
use judged::Judged;
use stream::StreamPlace;

use crate::bounds::expect_an_end;
use crate::ending::Ending;
use crate::formats::selected;
use crate::input::{AnyProblem, Input, expect_path_alone, in_part};
use crate::numbers::{number, whole};
use crate::places::{Folder, Place};
use crate::progress::Progress;
use crate::run_arguments::RunArguments;
use crate::{candidates, output};

/// Options of `compile`.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    input: Input,
    #[command(flatten)]
    run: RunArguments,
    /// The number format: a float, or fixed point of 8, 16, 32 or 64 bits; for a core, fixed point of 16 to 32 bits.
    #[arg(long, value_name = "F", add = ArgValueCandidates::new(candidates::formats))]
    format: String,
    /// The language: constants for the Rust kernels, C99 with the step in it, or a core that makes the step.
    #[arg(long, value_enum, default_value_t = Language::Rust)]
    language: Language,
    /// A file of sections from stop to stop, which a controller reads through a small buffer, instead of a language.
    #[arg(long, requires = "out", conflicts_with_all = ["language", "flash"])]
    stream: bool,
    /// Bytes of that buffer: refuse a part with a section that takes more.
    #[arg(long, value_name = "BYTES", requires = "stream", value_parser = whole::<usize>(&BUFFER))]
    buffer: Option<usize>,
    /// Write to this file instead of the terminal. For C: to PATH.h and PATH.c, whose public names begin with PATH's last
    /// part. For Verilog: into this folder.
    #[arg(long, value_name = "PATH")]
    out: Option<std::path::PathBuf>,
    /// Bytes of flash for the tables: refuse a part that takes more.
    #[arg(long, value_name = "BYTES", value_parser = whole::<usize>(&FLASH))]
    flash: Option<usize>,
    /// In C and in a stream: with feed override up to this percentage of the commanded feed, 100 to 200, and feed hold. Such
    /// a run goes from rest to rest.
    #[arg(
        long,
        value_name = "PERCENT",
        conflicts_with_all = ["start_feed", "end_feed"],
        value_parser = number(&FEED_OVERRIDE)
    )]
    feed_override: Option<f64>,
    /// Share of acceleration and jerk that the plan leaves for changes of the override, in per cent.
    #[arg(
        long,
        value_name = "PERCENT",
        default_value_t = 20.0,
        requires = "feed_override",
        value_parser = number(&RESERVE)
    )]
    reserve: f64,
}

impl Arguments {
    /// The overrides that the files shall allow.
    fn overrides(&self) -> Result<Option<Overrides>> {
        let Some(percent) = self.feed_override else { return Ok(None) };
        if self.language == Language::Verilog {
            bail!(
                "--feed-override goes with --language c or --stream: the core has no feed override and no hold"
            );
        }
        if self.language == Language::Rust && !self.stream {
            bail!(
                "--feed-override goes with --language c or --stream: in Rust the firmware calls `step_overridden`"
            );
        }
        let highest = OverrideTarget { time_s: 0.0, share: percent / 100.0 };
        Ok(Some(Overrides::try_new(vec![highest], self.reserve / 100.0)?))
    }
}

/// Languages, by their names on the command line.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Language {
    /// Constants for the crates nurbs-core, real and secant-interp.
    Rust,
    /// A header and a source that need nothing else.
    C,
    /// A small core with its microcode and tables, and a testbench.
    Verilog,
}

/// Where a part goes.
enum Destination {
    Rust(Place),
    C(CPlace),
    Verilog(Folder),
    Stream(StreamPlace),
}

impl Arguments {
    /// The files to write, refused before long work if they cannot be written.
    fn destination(&self) -> Result<Destination> {
        let out = self.out.as_deref();
        Ok(match self.language {
            _ if self.stream => Destination::Stream(StreamPlace::of(out, self.buffer)?),
            Language::C => Destination::C(CPlace::of(out)?),
            Language::Verilog => Destination::Verilog(verilog::folder(out)?),
            Language::Rust => Destination::Rust(Place::named("--out", out)?),
        })
    }
}

/// Compiles the part, judges the result as `compare` does, and writes it.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let place = arguments.destination()?;
    let fault = match arguments.run.problem(&arguments.input)? {
        AnyProblem::Planar(problem) => in_part(&problem, compiled(&problem, arguments, &place))?,
        AnyProblem::Spatial(problem) => in_part(&problem, compiled(&problem, arguments, &place))?,
    };
    let Some(fault) = fault else { return Ok(Ending::Good) };
    output::say(&format!("feedbits: {fault}"));
    Ok(Ending::RequirementNotMet)
}

/// Plans and judges the part, and writes it in its language. Returns why it is not good enough, if it is not.
fn compiled<const D: usize>(
    problem: &Problem<D>,
    arguments: &Arguments,
    place: &Destination,
) -> Result<Option<String>>
where
    Space: Dimension<D>,
{
    expect_path_alone(problem, "compile")?;
    let options = arguments.run.options_for(problem)?;
    if options.engine != Engine::Pieces {
        bail!("a controller runs compiled pieces: give --evaluate pieces, or nothing");
    }
    let formats = selected::<D>(std::slice::from_ref(&arguments.format))?;
    let Some(format) = formats.first().map(AsRef::as_ref) else { bail!("no format") };
    let overrides = arguments.overrides()?;
    let to_plan =
        overrides.as_ref().map_or(Cow::Borrowed(problem), |overrides| Cow::Owned(overrides.to_plan(problem)));
    expect_an_end(&to_plan, &options)?;
    // A format that C or the core cannot hold is refused before the long run of the judge.
    match place {
        Destination::C(_) => c::expect_type(format)?,
        Destination::Verilog(_) => verilog::expect_format(format)?,
        _ => {}
    }
    let progress = Progress::spinning("compiling");
    let Compared { mut comparison, plan, .. } =
        format_compare::compare_with(&to_plan, &formats, &[Engine::Pieces], &options, &Watch::default())?;
    let plan = match plan {
        Some(plan) => plan,
        None => format_compare::plan_for(&to_plan, format, &options)?,
    };
    let Some(row) = comparison.formats.pop() else { bail!("no run") };
    let (name, feed) = (&comparison.part.name, problem.machine.feedrate_mm_per_s);
    let up_to = arguments.feed_override.map(|percent| format!(", with feed override up to {percent} %"));
    let about = format!("{name} at {feed} mm/s, in {}{}", row.format, up_to.unwrap_or_default());
    let commands = overrides.map(|overrides| overrides.commands(problem, &plan)).transpose()?;
    let options = Options { overrides: commands, ..options };
    let judged = Judged { problem: to_plan, plan, options, format, about, fault: fault_of(row) };
    match place {
        Destination::C(place) => c::write(&judged, place, arguments.flash, progress)?,
        Destination::Verilog(folder) => verilog::write(&judged, folder, arguments.flash, progress)?,
        Destination::Stream(place) => stream::write(&judged, place, progress)?,
        Destination::Rust(place) => rust::write(&judged, place, arguments.flash, progress)?,
    }
    Ok(judged.fault)
}

/// Why a run is not good enough.
fn fault_of(row: JudgedRun) -> Option<String> {
    let why = match row.verdict {
        Verdict::Good => return None,
        Verdict::Bad(reasons) => reasons.join("; "),
        Verdict::Refused(reason) => reason,
    };
    Some(format!("{} is not good enough: {why}", row.format))
}
