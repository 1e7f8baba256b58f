//! A part as constants of a Rust module.

use anyhow::Result;
use foreign_text::in_a_comment;
use format_compare::Constants;
use target_cost::{Limits, PeriodBound, period_bounds};

use super::judged::{Judged, expect_room};
use crate::output;
use crate::places::Place;
use crate::progress::Progress;

/// Writes the constants of a Rust module.
pub(crate) fn write<const D: usize>(
    judged: &Judged<'_, D>,
    place: &Place,
    flash: Option<usize>,
    progress: Progress,
) -> Result<()> {
    let Judged { problem, plan, options, format, about, fault } = judged;
    let constants = format.constants(problem, plan, options)?;
    expect_room(constants.bytes, flash)?;
    progress.finish();
    let text = header(about, fault.as_deref(), constants.bytes) + &constants.source;
    output::write(place, &text)?;
    let Constants { sections, pieces, stages, bytes, periods, checksum, limits, degree, is_plain, .. } =
        constants;
    let stops =
        if sections == 1 { String::new() } else { format!(" in {sections} sections from stop to stop") };
    output::note(&format!(
        "{periods} periods{stops}; {pieces} pieces and {stages} stages in {bytes} bytes; checksum {checksum:#018x}"
    ));
    let count = |count| u64::try_from(count).unwrap_or(u64::MAX);
    let limits = Limits {
        evaluations: limits.evaluations.into(),
        joints: count(limits.joints),
        stages: count(limits.stages),
    };
    // Bounds are known for this kind of part.
    let known =
        if is_plain { period_bounds(&format.name().to_string(), (D, degree), limits) } else { Vec::new() };
    known.iter().for_each(|bound| output::note(&most(bound, limits)));
    Ok(())
}

/// The most that a period takes on a core.
fn most(bound: &PeriodBound, limits: Limits) -> String {
    let PeriodBound { target, instructions, cycles } = bound;
    let Limits { evaluations, joints, stages } = limits;
    format!(
        "at most {} instructions a period on {target}, {} cycles (K = {evaluations}, J = {joints}, S = {stages}); a landing \
         step at most {} and {}",
        instructions.period, cycles.period, instructions.landing, cycles.landing
    )
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
