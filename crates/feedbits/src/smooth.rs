//! `feedbits smooth`: corners of straight moves and arcs, cut or looped, within a tolerance.

mod deviation;
mod followed;
mod program;
mod report;
mod smooth_stretch;
mod stretch;
mod timing;

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

use anyhow::{Context, Result, bail};
use clap::{Args, ValueEnum};
use nurbs_core::CornerStyle;
use part_program::{Dialect, Machine, MoveKind, Part};

use crate::ending::Ending;
use crate::input::Input;
use crate::output;
use crate::progress::Progress;
use followed::Followed;
use report::{Forms, Kind, Measured, Report, SetpointCheck};
use stretch::{rest_before, stretches, with_polygons_as_lines};

/// Options of `smooth`.
#[derive(Args)]
pub(crate) struct Arguments {
    #[command(flatten)]
    input: Input,
    /// Largest distance between the smoothed path and the program's moves, both ways, in mm.
    #[arg(long, allow_negative_numbers = true, value_name = "MM")]
    tolerance: f64,
    /// Outer corners, which turn the way that their outline turns: in a loop around the corner, or cut like the others. Those of less
    /// than 30° are cut in any case.
    #[arg(long, value_enum, default_value_t = Outer::Cut)]
    outer: Outer,
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

/// Smooths, measures and prints.
pub(crate) fn run(arguments: &Arguments) -> Result<Ending> {
    let tolerance = arguments.tolerance;
    if !(tolerance > 0.0 && tolerance.is_finite()) {
        bail!("--tolerance {tolerance}: expected a positive length in mm");
    }
    let (part, machine) = arguments.input.part_and_machine()?;
    let outer = match arguments.outer {
        Outer::Loop => CornerStyle::Loop,
        Outer::Cut => CornerStyle::Cut,
    };
    output::expect_place(arguments.out.as_deref())?;
    let progress = Progress::spinning("smoothing and planning");
    let form = arguments.out.as_deref().map(|path| Form::of(path, arguments.input.dialect()));
    let (report, written) = smooth(&with_polygons_as_lines(&part), &machine, tolerance, outer, form)?;
    progress.finish();
    let kept = match (&arguments.out, written) {
        (Some(path), Some(text)) => text.and_then(|text| output::write(Some(path), &text)),
        _ => Ok(()),
    };
    let text = if arguments.json {
        serde_json::to_string_pretty(&report)? + "\n"
    } else {
        report.text(arguments.wide)
    };
    output::write(None, &text)?;
    // Only now: the report holds without the file.
    kept?;
    Ok(if report.faults().is_empty() { Ending::Good } else { Ending::RequirementNotMet })
}

/// What is written.
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
}

/// Smooths every stretch of a part, and says what came of it; the text, if there is to be one, or why there is none.
fn smooth(
    part: &Part,
    machine: &Machine,
    tolerance_mm: f64,
    outer: CornerStyle,
    form: Option<Form>,
) -> Result<(Report, Option<Result<String>>)> {
    let stretches = stretches(part);
    let followed = format_compare::in_parallel(&stretches, |range| {
        let first = part.moves[range.start];
        let outer = (first.kind == MoveKind::Feed).then_some(outer);
        Followed::new(part, range.clone(), machine, tolerance_mm, outer)
            .with_context(|| format!("{}: the moves from line {} on", part.name, first.line))
    });
    let mut followed = followed.into_iter().collect::<Result<Vec<_>>>()?;

    let mut smoothed =
        Part { curves: Vec::new(), moves: Vec::new(), machine: Some(machine.clone()), ..part.clone() };
    let mut report = Report {
        part: part.name.clone(),
        tolerance_mm,
        machine: machine.clone(),
        moves: part.moves.len(),
        stretches: stretches.len(),
        cuts: 0,
        loops: 0,
        shallow: 0,
        left: BTreeMap::new(),
        measured: Measured::default(),
        error_mm_max: 0.0,
        exact_stop: report::Path::default(),
        smoothed: report::Path::default(),
        speedup: 1.0,
        forms: Forms::default(),
        setpoints: SetpointCheck { finished: true, ..SetpointCheck::default() },
        corners: Vec::new(),
    };
    for one in &followed {
        smoothed.moves.extend(one.path.move_of.iter().map(|index| part.moves[one.range.start + index]));
        smoothed.curves.extend_from_slice(&one.path.curves);
        // A corner may take all of the last move, whose end still is the stretch's.
        if let Some(last) = smoothed.moves.last_mut() {
            last.exact_stop |= part.moves[one.range.end - 1].exact_stop;
        }
    }
    let written = form.map(|form| match form {
        Form::Curves => Ok(part_program::write_curves(&smoothed)),
        Form::Program(dialect) => program::text(part, &mut followed, &smoothed, tolerance_mm, dialect),
    });
    if let (Some(Form::Program(_)), Some(Ok(_))) = (form, &written) {
        report.measured = Measured::StraightMoves;
    }
    for one in &followed {
        let next = one.range.end;
        report.add(one);
        if let Some(rest) = rest_before(part, next) {
            report.corners.extend(followed::between(part, next, rest)?);
        }
    }
    report.count();
    Ok((report, written))
}

impl Report {
    /// Adds a stretch.
    fn add(&mut self, followed: &Followed) {
        let sum = |sum: &mut report::Path, path: &report::Path| {
            sum.curves += path.curves;
            sum.length_mm += path.length_mm;
            sum.time_s += path.time_s;
        };
        sum(&mut self.exact_stop, &followed.exact_stop);
        sum(&mut self.smoothed, &followed.smoothed);
        self.error_mm_max = self.error_mm_max.max(followed.error_mm_max);
        self.corners.extend_from_slice(&followed.corners);

        let (forms, other) = (&mut self.forms, &followed.forms);
        forms.polynomials += other.polynomials;
        forms.distance_mm_max = forms.distance_mm_max.max(other.distance_mm_max);
        forms.distance_bound_mm = forms.distance_bound_mm.max(other.distance_bound_mm);
        if other.polynomials > 0 {
            forms.polynomial_degree = other.polynomial_degree;
            forms.trigonometric_operations = other.trigonometric_operations;
            forms.polynomial_operations = other.polynomial_operations;
        }
        let (setpoints, other) = (&mut self.setpoints, &followed.setpoints);
        setpoints.count += other.count;
        setpoints.off_path_mm_max = setpoints.off_path_mm_max.max(other.off_path_mm_max);
        setpoints.off_moves_mm_max = setpoints.off_moves_mm_max.max(other.off_moves_mm_max);
        setpoints.chord_error_mm_max = setpoints.chord_error_mm_max.max(other.chord_error_mm_max);
        setpoints.total_acceleration_max_mm_per_s2 =
            setpoints.total_acceleration_max_mm_per_s2.max(other.total_acceleration_max_mm_per_s2);
        setpoints.finished &= other.finished;
    }

    /// Counts the corners by kind, and compares the times.
    fn count(&mut self) {
        for corner in &self.corners {
            match corner.kind {
                Kind::Cut => {
                    self.cuts += 1;
                    self.shallow += usize::from(corner.reason.is_some());
                }
                Kind::Loop => self.loops += 1,
                Kind::Left => *self.left.entry(corner.reason.clone().unwrap_or_default()).or_default() += 1,
            }
        }
        self.speedup = self.exact_stop.time_s / self.smoothed.time_s;
    }
}
