//! `feedbits compile`: a part for a controller, as constants that its firmware includes.

use anyhow::{Result, bail};
use clap::Args;
use clap_complete::ArgValueCandidates;
use format_compare::{Constants, Dimension, Engine, JudgedRun, Problem, Space, Verdict};

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
    /// Write to this file instead of the terminal.
    #[arg(long, value_name = "PATH")]
    out: Option<std::path::PathBuf>,
}

/// Compiles the part, judges the result as `compare` does, and writes it.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    output::expect_place(arguments.out.as_deref())?;
    let progress = Progress::spinning("compiling");
    let (constants, row, about) = match arguments.run.problem(&arguments.input)? {
        AnyProblem::Planar(problem) => compiled(&problem, arguments)?,
        AnyProblem::Spatial(problem) => compiled(&problem, arguments)?,
    };
    progress.finish();
    let fault = match row.verdict {
        Verdict::Good => None,
        Verdict::Bad(reasons) => Some(reasons.join("; ")),
        Verdict::Refused(reason) => Some(reason),
    };
    let fault = fault.map(|why| format!("{} is not good enough: {why}", row.format));
    let text = header(&about, fault.as_deref(), constants.bytes) + &constants.source;
    output::write(arguments.out.as_deref(), &text)?;
    let Constants { sections, pieces, stages, bytes, periods, checksum, .. } = constants;
    let stops =
        if sections == 1 { String::new() } else { format!(" in {sections} sections from stop to stop") };
    output::note(&format!(
        "{periods} periods{stops}; {pieces} pieces and {stages} stages in {bytes} bytes; checksum {checksum:#018x}"
    ));
    let Some(fault) = fault else { return Ok(Ending::Good) };
    output::say(&format!("feedbits: {fault}"));
    Ok(Ending::RequirementNotMet)
}

/// The constants, the judged run that they make, and a line about their origin.
fn compiled<const D: usize>(
    problem: &Problem<D>,
    arguments: &Arguments,
) -> Result<(Constants, JudgedRun, String)>
where
    Space: Dimension<D>,
{
    let options = arguments.run.options_for(problem)?;
    if options.engine != Engine::Pieces {
        bail!("a controller runs compiled pieces: give --evaluate pieces, or nothing");
    }
    let formats = selected::<D>(std::slice::from_ref(&arguments.format))?;
    let Some(format) = formats.first() else { bail!("no format") };
    let plan = format_compare::plan_for(problem, format.as_ref(), &options)?;
    let constants = format.constants(problem, &plan, &options)?;
    let mut comparison = format_compare::compare(problem, &formats, &[Engine::Pieces], &options)?;
    let Some(row) = comparison.formats.pop() else { bail!("no run") };
    let machine = &comparison.machine;
    let about = format!("{} at {} mm/s, in {}", comparison.part.name, machine.feedrate_mm_per_s, row.format);
    Ok((constants, row, about))
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
