//! A smoothed part as a program of fine straight moves, and how far that is from the program that it came from.

use std::ops::Range;

use anyhow::{Context, Result, bail};
use part_program::{Curve, MoveKind, Part};

use super::deviation::Paths;
use super::followed::Followed;

/// A smoothed part with the ends of its curves rounded to a thousandth of the chord error, and to a nanometre at least: a
/// control need not take seventeen digits.
pub(crate) fn rounded(smoothed: &Part, chord_error_mm: f64) -> Part {
    let decimals = (6..15).find(|decimals| 0.1_f64.powi(*decimals) <= 1e-3 * chord_error_mm).unwrap_or(15);
    let unit = 10.0_f64.powi(decimals);
    let mut part = smoothed.clone();
    for curve in &mut part.curves {
        // No negative zero.
        let round = |point: &mut [f64; 3]| *point = point.map(|x| (x * unit).round() / unit + 0.0);
        curve.control_points_mm.first_mut().into_iter().for_each(round);
        curve.control_points_mm.last_mut().into_iter().for_each(round);
    }
    part
}

/// Measures the stretches of a part anew on the text as which they were written, as it reads back.
pub(crate) fn measure(part: &Part, followed: &mut [Followed], written: &Part, text: &str) -> Result<()> {
    let again = part_program::read_part("what was written", text)
        .context("what was written does not read back: nothing is kept")?;
    let chords = chords(written, &again)?;
    let mut first = 0;
    for stretch in followed {
        let of_stretch = &chords[first..first + stretch.path.curves.len()];
        first += of_stretch.len();
        let (Some(begin), Some(end)) = (of_stretch.first(), of_stretch.last()) else { continue };
        let all = begin.start..end.end;
        let move_of = of_stretch.iter().zip(&stretch.path.move_of);
        let move_of: Vec<usize> =
            move_of.flat_map(|(chords, index)| std::iter::repeat_n(*index, chords.len())).collect();
        let paths = Paths::new(&part.curves[stretch.range.clone()], &again.curves[all.clone()], &move_of)?;
        stretch.measure(&paths, |curve| {
            let chords = &of_stretch[curve];
            chords.start - all.start..chords.end - all.start
        });
    }
    Ok(())
}

/// For each curve that was written the moves that are read for it.
fn chords(written: &Part, again: &Part) -> Result<Vec<Range<usize>>> {
    let mut chords = Vec::with_capacity(written.curves.len());
    let mut next = 0;
    for (curve, one) in written.curves.iter().zip(&written.moves) {
        let Some(end) = curve.control_points_mm.last() else { bail!("a curve without points") };
        if is_still(curve, end) {
            chords.push(next..next);
            continue;
        }
        // A gap is crossed by a rapid move.
        while one.kind == MoveKind::Feed
            && again.moves.get(next).is_some_and(|one| one.kind == MoveKind::Rapid)
        {
            next += 1;
        }
        let begin = next;
        let ends_there = |chord: &Curve| chord.control_points_mm.last() == Some(end);
        match again.curves[begin..].iter().position(ends_there) {
            Some(count) => next += count + 1,
            None => bail!("line {}: the path that reads back is another one: nothing is kept", one.line),
        }
        chords.push(begin..next);
    }
    Ok(chords)
}

/// Whether nothing is left of a curve once its points are rounded.
fn is_still(curve: &Curve, end: &[f64; 3]) -> bool {
    const NOTHING_MM: f64 = 1e-9;
    curve
        .control_points_mm
        .iter()
        .flat_map(|point| point.iter().zip(end))
        .all(|(a, b)| (a - b).abs() < NOTHING_MM)
}
