//! A smoothed part as a program of fine straight moves, and its distance from the original program.

use std::ops::Range;

use part_program::{Curve, Dialect, MoveKind, Part, ReadOptions, is_joined};

use crate::deviation::Paths;
use crate::error::ProgramError;
use crate::followed::Followed;
use crate::smooth_stretch::CHORD_SHARE;

/// The program of a smoothed part. The distances of the stretches are measured again on the program as it reads back.
pub(crate) fn text(
    part: &Part,
    followed: &mut [Followed],
    smoothed: &Part,
    tolerance_mm: f64,
    dialect: Option<Dialect>,
) -> Result<String, ProgramError> {
    let chord_error_mm = tolerance_mm * CHORD_SHARE;
    let rounded = rounded(smoothed, chord_error_mm);
    let text = part_program::write_g1(&rounded, chord_error_mm, dialect)?;
    let options = ReadOptions { dialect, ..ReadOptions::default() };
    let again =
        part_program::read_part_with("what was written", &text, options).map_err(ProgramError::ReadBack)?;
    measure(part, followed, &rounded, &again)?;
    Ok(text)
}

/// A smoothed part whose curves' ends are rounded to a thousandth of the chord error, but to no less than a nanometre.
/// So a control need not read seventeen digits.
fn rounded(smoothed: &Part, chord_error_mm: f64) -> Part {
    let decimals = (6..15).find(|decimals| 0.1_f64.powi(*decimals) <= 1e-3 * chord_error_mm).unwrap_or(15);
    let unit = 10.0_f64.powi(decimals);
    let mut part = smoothed.clone();
    for curve in &mut part.curves {
        // Adding 0 avoids a negative zero.
        let round = |point: &mut [f64; 3]| *point = point.map(|x| (x * unit).round() / unit + 0.0);
        curve.control_points_mm_mut().first_mut().into_iter().for_each(round);
        curve.control_points_mm_mut().last_mut().into_iter().for_each(round);
    }
    close_gaps(&mut part);
    part
}

/// Makes moves at feed begin where the one before ends, if the distance is too short for a gap in a path. A rapid move
/// would otherwise cross it.
fn close_gaps(part: &mut Part) {
    for next in 1..part.curves.len() {
        let (before, after) = part.curves.split_at_mut(next);
        let is_cut = part.moves[next - 1..=next].iter().all(|one| one.kind == MoveKind::Feed);
        let end = before.last().and_then(|curve| curve.control_points_mm().last());
        let start = after.first_mut().and_then(|curve| curve.control_points_mm_mut().first_mut());
        if let (true, Some(end), Some(start)) = (is_cut, end, start)
            && is_joined(end, start)
        {
            *start = *end;
        }
    }
}

/// Measures the stretches of a part again, on the written program as it reads back.
fn measure(part: &Part, followed: &mut [Followed], written: &Part, again: &Part) -> Result<(), ProgramError> {
    let chords = chords(written, again)?;
    let mut first = 0;
    for stretch in followed {
        let of_stretch = &chords[first..first + stretch.path.curves.len()];
        first += of_stretch.len();
        // The rapid moves that cross gaps are left out.
        let curves: Vec<_> =
            of_stretch.iter().flat_map(|chords| again.curves[chords.clone()].to_vec()).collect();
        let move_of = of_stretch.iter().zip(&stretch.path.move_of);
        let move_of: Vec<usize> =
            move_of.flat_map(|(chords, index)| std::iter::repeat_n(*index, chords.len())).collect();
        let paths = Paths::new(&part.curves[stretch.range.clone()], &curves, &move_of)?;
        let mut end = 0;
        let places = of_stretch.iter().map(|chords| {
            end += chords.len();
            end - chords.len()..end
        });
        let places: Vec<_> = places.collect();
        stretch.measure(&paths, |curve| places[curve].clone());
    }
    Ok(())
}

/// For each written curve, the moves that are read for it.
fn chords(written: &Part, again: &Part) -> Result<Vec<Range<usize>>, ProgramError> {
    let mut chords = Vec::with_capacity(written.curves.len());
    let mut next = 0;
    for (curve, one) in written.curves.iter().zip(&written.moves) {
        let Some(end) = curve.control_points_mm().last() else {
            return Err(ProgramError::AnotherPath { line: one.line });
        };
        if is_still(curve, end) {
            chords.push(next..next);
            continue;
        }
        // A rapid move crosses a gap.
        while one.kind == MoveKind::Feed
            && again.moves.get(next).is_some_and(|one| one.kind == MoveKind::Rapid)
        {
            next += 1;
        }
        let begin = next;
        let ends_there = |chord: &Curve| chord.control_points_mm().last() == Some(end);
        match again.curves[begin..].iter().position(ends_there) {
            Some(count) => next += count + 1,
            None => return Err(ProgramError::AnotherPath { line: one.line }),
        }
        chords.push(begin..next);
    }
    Ok(chords)
}

/// Whether a curve has no length once its points are rounded.
fn is_still(curve: &Curve, end: &[f64; 3]) -> bool {
    const NOTHING_MM: f64 = 1e-9;
    curve
        .control_points_mm()
        .iter()
        .flat_map(|point| point.iter().zip(end))
        .all(|(a, b)| (a - b).abs() < NOTHING_MM)
}
