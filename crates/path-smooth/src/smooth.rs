//! Every stretch of a part smoothed, and the report on all of them.

use std::collections::BTreeMap;

use nurbs_core::CornerLambda;
use part_program::{Dialect, Machine, MoveKind, Part};

use crate::error::{ProgramError, SmoothError};
use crate::followed::{Followed, between};
use crate::options::Options;
use crate::program;
use crate::report::{CornerKind, CornerRow, Forms, Measured, PathSummary, Report, SetpointCheck};
use crate::stretch::{rest_before, stretches, with_polygons_as_lines};

/// A part with smoothed corners.
pub struct Smoothed {
    /// The smoothed curves, each with its move. Words that do not move the tool are copied from the part.
    pub path: Part,
    /// The table of corners, and the totals.
    pub report: Report,
    /// The part before smoothing, with each polygon as straight moves.
    original: Part,
    stretches: Vec<Followed>,
    /// For each stretch, the corner at its end, where the tool rests.
    rests: Vec<Option<CornerRow>>,
    options: Options,
}

/// Smooths the corners of a part's straight moves and arcs, plans the path before and after for a machine, and measures
/// both.
///
/// Each stretch of the part, from rest to rest, is smoothed by itself. Rapid moves, gaps, exact stops, words that do
/// not move the tool and changes of feed stay where they are. Corners are trigonometric splines; in [`Smoothed::path`]
/// they are the polynomials that real time evaluates. Lengths are in mm, feeds in mm/s, times in s.
///
/// # Errors
/// [`SmoothError::Tolerance`] unless the tolerance is above 0 and finite. [`SmoothError::Lambda`] unless a given λ is
/// from -2 to 2. [`SmoothError::Moves`], with the line of the
/// first move, if a stretch has a curve that is not valid, cannot be planned for the machine, or cannot be run.
///
/// # Source
/// Paper B (Tao Jianming et al.; see `docs/papers.md`): corners as trigonometric splines. The paper does not cover
/// planning and measuring.
pub fn smooth(part: &Part, machine: &Machine, options: &Options) -> Result<Smoothed, SmoothError> {
    let &Options { tolerance_mm, outer, lambda } = options;
    if !(tolerance_mm > 0.0 && tolerance_mm.is_finite()) {
        return Err(SmoothError::Tolerance(tolerance_mm));
    }
    if let CornerLambda::Given(given) = lambda
        && !lambda.is_in_range()
    {
        return Err(SmoothError::Lambda(given));
    }
    let part = with_polygons_as_lines(part);
    let followed = feed_plan::in_parallel(&stretches(&part), |range| {
        let first = part.moves[range.start];
        let outer = (first.kind == MoveKind::Feed).then_some(outer);
        Followed::new(&part, range.clone(), machine, options, outer)
            .map_err(|error| error.of_moves(&part.name, first.line))
    });
    let followed = followed.into_iter().collect::<Result<Vec<_>, _>>()?;
    let behind = |one: &Followed| match rest_before(&part, one.range.end) {
        Some(rest) => between(&part, one.range.end, rest),
        None => Ok(None),
    };
    let rests = followed.iter().map(behind).collect::<Result<Vec<_>, _>>()?;
    let path = joined(&part, machine, &followed);
    let report = empty_report(&part, machine, options, followed.len());
    let mut smoothed =
        Smoothed { path, report, original: part, stretches: followed, rests, options: *options };
    smoothed.tally(Measured::Curves);
    Ok(smoothed)
}

/// The smoothed curves of all stretches.
fn joined(part: &Part, machine: &Machine, followed: &[Followed]) -> Part {
    let mut smoothed =
        Part { curves: Vec::new(), moves: Vec::new(), machine: Some(machine.clone()), ..part.clone() };
    for one in followed {
        smoothed.moves.extend(one.path.move_of.iter().map(|index| part.moves[one.range.start + index]));
        smoothed.curves.extend_from_slice(&one.path.curves);
        // A corner may take up the last move, but the stop at that move's end still belongs to the stretch.
        if let Some(last) = smoothed.moves.last_mut() {
            last.exact_stop |= part.moves[one.range.end - 1].exact_stop;
        }
    }
    smoothed
}

/// A report to which no stretch has been added.
fn empty_report(part: &Part, machine: &Machine, options: &Options, stretches: usize) -> Report {
    let &Options { tolerance_mm, lambda, .. } = options;
    let is_plain = lambda == CornerLambda::default();
    Report {
        part: part.name.clone(),
        tolerance_mm,
        machine: machine.clone(),
        moves: part.moves.len(),
        stretches,
        cuts: 0,
        loops: 0,
        shallow: 0,
        left: BTreeMap::new(),
        measured: Measured::default(),
        error_mm_max: 0.0,
        exact_stop: PathSummary::default(),
        smoothed: PathSummary::default(),
        lambda: lambda.into(),
        with_lambda_1: (!is_plain).then(PathSummary::default),
        speedup: 1.0,
        forms: Forms::default(),
        setpoints: SetpointCheck { finished: true, ..SetpointCheck::default() },
        corners: Vec::new(),
    }
}

impl Smoothed {
    /// Writes the smoothed path as a program of fine straight moves for a control. The report's distances are measured
    /// again on that program as it reads back. Its moves are at most 0.02 of the tolerance off the curves.
    ///
    /// # Errors
    /// [`ProgramError`] if the program would be too long, or if it is not the smoothed path when it is read back.
    pub fn write_program(&mut self, dialect: Option<Dialect>) -> Result<String, ProgramError> {
        let tolerance_mm = self.options.tolerance_mm;
        let written = program::text(&self.original, &mut self.stretches, &self.path, tolerance_mm, dialect);
        self.tally(if written.is_ok() { Measured::StraightMoves } else { Measured::Curves });
        written
    }

    /// Makes the report from the data of each stretch.
    fn tally(&mut self, measured: Measured) {
        let machine = self.report.machine.clone();
        let mut report = empty_report(&self.original, &machine, &self.options, self.stretches.len());
        report.measured = measured;
        for (one, rest) in self.stretches.iter().zip(&self.rests) {
            report.add(one);
            report.corners.extend(rest.clone());
        }
        report.count();
        self.report = report;
    }
}

impl Report {
    /// Adds a stretch.
    fn add(&mut self, followed: &Followed) {
        let sum = |sum: &mut PathSummary, path: &PathSummary| {
            sum.curves += path.curves;
            sum.length_mm += path.length_mm;
            sum.time_s += path.time_s;
        };
        sum(&mut self.exact_stop, &followed.exact_stop);
        sum(&mut self.smoothed, &followed.smoothed);
        if let Some((total, plain)) = self.with_lambda_1.as_mut().zip(followed.with_lambda_1.as_ref()) {
            sum(total, plain);
        }
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
                CornerKind::Cut => {
                    self.cuts += 1;
                    self.shallow += usize::from(corner.reason.is_some());
                }
                CornerKind::Loop => self.loops += 1,
                CornerKind::Left => {
                    *self.left.entry(corner.reason.clone().unwrap_or_default()).or_default() += 1
                }
            }
        }
        self.speedup = self.exact_stop.time_s / self.smoothed.time_s;
    }
}

#[cfg(test)]
mod tests {
    use nurbs_core::CornerStyle;

    use super::*;

    const MACHINE: &str = "[machine]\ninterpolation_period_ms = 1\nfeedrate_mm_per_s = 50\n\
                           acceleration_mm_per_s2 = 1000\njerk_mm_per_s3 = 50000\n";

    fn smoothed(program: &str, tolerance_mm: f64) -> Result<Smoothed, SmoothError> {
        let part = part_program::read_part("p.nc", program).unwrap();
        let machine = part_program::read_machine("m.toml", MACHINE).unwrap();
        smooth(
            &part,
            &machine,
            &Options { tolerance_mm, outer: CornerStyle::Cut, lambda: CornerLambda::default() },
        )
    }

    #[test]
    fn a_tolerance_is_a_positive_length() {
        for tolerance_mm in [0.0, -1.0, f64::INFINITY] {
            let refused = smoothed("G1 X0 Y0 F600\nX9\nY9\n", tolerance_mm).err();
            assert_eq!(refused, Some(SmoothError::Tolerance(tolerance_mm)));
        }
    }

    /// The chords of a program are farther off than the curves. Once the program is written, the report gives their
    /// distance.
    #[test]
    fn a_program_is_measured_as_it_reads_back() {
        let mut smoothed = smoothed("G1 X0 Y0 F600\nX9\nY9\nM8\nX0\n", 0.1).unwrap();
        let rests: Vec<_> = smoothed.report.corners.iter().map(|corner| corner.kind).collect();
        assert_eq!(rests, [CornerKind::Cut, CornerKind::Left]);
        let of_curves = smoothed.report.error_mm_max;
        let program = smoothed.write_program(None).unwrap();
        assert!(program.contains("M8") && program.lines().count() > 10, "{program}");
        assert_eq!(smoothed.report.measured, Measured::StraightMoves);
        let of_program = smoothed.report.error_mm_max;
        assert!(of_program != of_curves && of_program <= 0.1, "{of_program}, of the curves {of_curves}");
        assert_eq!((smoothed.report.cuts, smoothed.report.corners.len()), (1, 2));
    }
}
