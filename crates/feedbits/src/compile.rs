//! `feedbits compile`: a part for a controller, as constants that its firmware includes, or as C.

use anyhow::{Result, bail};
use clap::{Args, ValueEnum};
use clap_complete::ArgValueCandidates;
use format_compare::{
    Constants, Dimension, Engine, ExactPlan, Format, JudgedRun, Options, OverrideTarget, Overrides, Problem,
    Space, Verdict,
};

use crate::compile_to_c::{self, CPlace};
use crate::ending::Ending;
use crate::formats::selected;
use crate::input::{AnyProblem, Input};
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
    /// The number format: a float, or fixed point of 8, 16, 32 or 64 bits.
    #[arg(long, value_name = "F", add = ArgValueCandidates::new(candidates::formats))]
    format: String,
    /// The language: constants for the Rust kernels, or C99 with the step in it.
    #[arg(long, value_enum, default_value_t = Language::Rust)]
    language: Language,
    /// Write to this file instead of the terminal. For C: to PATH.h and PATH.c, whose public names begin with PATH's last
    /// part.
    #[arg(long, value_name = "PATH")]
    out: Option<std::path::PathBuf>,
    /// Bytes of flash for the tables: refuse a part that takes more.
    #[arg(long, value_name = "BYTES")]
    flash: Option<usize>,
    /// In C: with feed override up to this percentage of the commanded feed, 100 to 200, and feed hold. Such a run goes from
    /// rest to rest.
    #[arg(
        long,
        allow_negative_numbers = true,
        value_name = "PERCENT",
        conflicts_with_all = ["start_feed", "end_feed"]
    )]
    feed_override: Option<f64>,
    /// Share of acceleration and jerk that the plan leaves for changes of the override, in per cent.
    #[arg(
        long,
        allow_negative_numbers = true,
        value_name = "PERCENT",
        default_value_t = 20.0,
        requires = "feed_override"
    )]
    reserve: f64,
}

impl Arguments {
    /// The overrides that the files shall allow.
    fn overrides(&self) -> Result<Option<Overrides>> {
        let Some(percent) = self.feed_override else { return Ok(None) };
        if self.language == Language::Rust {
            bail!("--feed-override goes with --language c: in Rust the firmware calls `step_overridden`");
        }
        if !(100.0..=200.0).contains(&percent) {
            bail!("--feed-override {percent}: expected 100 to 200 % of the commanded feed");
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
}

/// A part that is planned, and judged in the format. With feed override, `problem` is that of the highest override.
pub(crate) struct Judged<'a, const D: usize> {
    pub(crate) problem: Problem<D>,
    pub(crate) plan: ExactPlan,
    pub(crate) options: Options,
    pub(crate) format: &'a dyn Format<D>,
    /// The part, its feed and the format, in a line.
    pub(crate) about: String,
    /// Why the run is not good enough; `None` if it is.
    pub(crate) fault: Option<String>,
}

/// Compiles the part, judges the result as `compare` does, and writes it.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let place = match arguments.language {
        Language::Rust => {
            output::expect_place(arguments.out.as_deref())?;
            None
        }
        Language::C => Some(CPlace::of(arguments.out.as_deref())?),
    };
    let fault = match arguments.run.problem(&arguments.input)? {
        AnyProblem::Planar(problem) => compiled(&problem, arguments, place.as_ref())?,
        AnyProblem::Spatial(problem) => compiled(&problem, arguments, place.as_ref())?,
    };
    let Some(fault) = fault else { return Ok(Ending::Good) };
    output::say(&format!("feedbits: {fault}"));
    Ok(Ending::RequirementNotMet)
}

/// Plans and judges the part, and writes it in its language. Returns why it is not good enough, if it is not.
fn compiled<const D: usize>(
    problem: &Problem<D>,
    arguments: &Arguments,
    place: Option<&CPlace>,
) -> Result<Option<String>>
where
    Space: Dimension<D>,
{
    let progress = Progress::spinning("compiling");
    let options = arguments.run.options_for(problem)?;
    if options.engine != Engine::Pieces {
        bail!("a controller runs compiled pieces: give --evaluate pieces, or nothing");
    }
    let formats = selected::<D>(std::slice::from_ref(&arguments.format))?;
    let Some(format) = formats.first().map(AsRef::as_ref) else { bail!("no format") };
    let overrides = arguments.overrides()?;
    let to_plan = overrides.as_ref().map_or_else(|| problem.clone(), |overrides| overrides.to_plan(problem));
    if place.is_some() {
        // What C cannot hold is refused before the long run of the judge.
        compile_to_c::expect_type(format)?;
    }
    let plan = format_compare::plan_for(&to_plan, format, &options)?;
    let mut comparison = format_compare::compare(&to_plan, &formats, &[Engine::Pieces], &options)?;
    let Some(row) = comparison.formats.pop() else { bail!("no run") };
    let (name, feed) = (&comparison.part.name, problem.machine.feedrate_mm_per_s);
    let up_to = arguments.feed_override.map(|percent| format!(", with feed override up to {percent} %"));
    let about = format!("{name} at {feed} mm/s, in {}{}", row.format, up_to.unwrap_or_default());
    let commands = overrides.map(|overrides| overrides.commands(problem, &plan)).transpose()?;
    let options = Options { overrides: commands, ..options };
    let judged = Judged { problem: to_plan, plan, options, format, about, fault: fault_of(row) };
    match place {
        Some(place) => compile_to_c::write(&judged, place, arguments.flash, progress)?,
        None => write_constants(&judged, arguments, progress)?,
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

/// Writes the constants of a Rust module.
fn write_constants<const D: usize>(
    judged: &Judged<'_, D>,
    arguments: &Arguments,
    progress: Progress,
) -> Result<()> {
    let Judged { problem, plan, options, format, about, fault } = judged;
    let constants = format.constants(problem, plan, options)?;
    expect_room(constants.bytes, arguments.flash)?;
    progress.finish();
    let text = header(about, fault.as_deref(), constants.bytes) + &constants.source;
    output::write(arguments.out.as_deref(), &text)?;
    let Constants { sections, pieces, stages, bytes, periods, checksum, .. } = constants;
    let stops =
        if sections == 1 { String::new() } else { format!(" in {sections} sections from stop to stop") };
    output::note(&format!(
        "{periods} periods{stops}; {pieces} pieces and {stages} stages in {bytes} bytes; checksum {checksum:#018x}"
    ));
    Ok(())
}

/// Refuses tables that take more flash than there is.
pub(crate) fn expect_room(bytes: usize, flash: Option<usize>) -> Result<()> {
    match flash {
        Some(flash) if bytes > flash => {
            bail!("the tables take {bytes} bytes, and --flash says {flash}: nothing is written")
        }
        _ => Ok(()),
    }
}

/// The comment before the module's text. It is no inner documentation, so that the file may be a module or be included
/// in one.
fn header(about: &str, fault: Option<&str>, bytes: usize) -> String {
    let fault = fault.map_or_else(String::new, |fault| format!("// {}\n//\n", in_a_comment(fault)));
    format!(
        "// {}: written by `feedbits compile`, edited by nobody.
//
{fault}// {bytes} bytes of tables, for the crates nurbs-core, real and secant-interp, without std. A setpoint a period:
//
//     for section in &SECTIONS {{
//         let run = PATH.on(section);
//         let mut state = run.start(); // at rest at run.pieces.pieces[0].origin, in 2^-39 mm
//         while let Some(setpoint) = run.step(&mut state) {{
//             let position = run.pieces.position(setpoint.piece, &setpoint.offset); // in 2^-39 mm
//         }}
//     }}
//
// Where a section begins elsewhere than the one before it ends, the part has a rapid move or a gap.

",
        in_a_comment(about)
    )
}

/// Removes characters that would end a comment's line or change the order of its text on a screen.
fn in_a_comment(text: &str) -> String {
    let is_odd = |c: char| {
        c.is_control()
            || matches!(c, '\u{200e}'..='\u{200f}' | '\u{2028}'..='\u{202e}' | '\u{2066}'..='\u{2069}')
    };
    text.replace(is_odd, "?")
}
