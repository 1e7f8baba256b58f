//! Parts to part programs. Numbers are written as the shortest decimals that read back as the same f64. They have a
//! decimal point, since a control may read a number without one as micrometres.
//!
//! Rapid moves stay G0 and straight moves G1, however the curves between them are written. Words that do not move the
//! tool stay at their moves: M0, M1, M5 and M9 of a move's own block after it, all others before it. The way to the
//! first curve is written among them, where the program had it.
//!
//! A part in the plane Z = 0 is written without Z, but for the way to it if the program names Z.
//!
//! An exact stop is written before the block that ends in it: as G61, as G61.1 for LinuxCNC, whose G61 passes smooth
//! joints, and as G60 for Siemens. G64 stands before the next block at feed without one.

use crate::bezier;
use crate::curve::Curve;
use crate::gcode::LEAST_ORDER;
use crate::options::Dialect;
use crate::part::Part;
use crate::spline_blocks::uniform_knots;
use crate::text_length::MAX_TEXT;
use crate::words_to_write::Words;
use crate::write_error::{MAX_CHORDS, MAX_HALVINGS, WriteError};
use crate::written_program::{EXACT_STOP, Program};

/// Most chords that are counted in order to report how many a program would need.
const MAX_COUNTED: usize = 4 * MAX_CHORDS;
/// Writes a part as G1 moves that leave its curves by no more than `tolerance_mm`.
///
/// The bound is proven, by the convex hulls of Bézier pieces. Ends of curves are written to the last bit; points
/// between them are rounded to a thousandth of the tolerance, or finer. The control `dialect` determines the word for
/// an exact stop. Without it the word is G61, with which LinuxCNC passes smooth joints.
///
/// # Errors
/// [`WriteError::CurvedRapid`], [`WriteError::SpanTooFine`], [`WriteError::TooManyChords`], [`WriteError::TooLong`].
pub fn write_g1(part: &Part, tolerance_mm: f64, dialect: Option<Dialect>) -> Result<String, WriteError> {
    let exact_stop = match dialect {
        Some(Dialect::LinuxCnc | Dialect::Canon) => "G61.1",
        Some(Dialect::Siemens) => "G60",
        Some(Dialect::Fanuc) | None => EXACT_STOP,
    };
    let decimals = (0..15).find(|decimals| 0.1_f64.powi(*decimals) <= 1e-3 * tolerance_mm).unwrap_or(15);
    let unit = 10.0_f64.powi(decimals);
    let mut count = 0;
    let text = write(part, None, exact_stop, |program, index, curve| {
        let mut ends = Vec::new();
        for piece in bezier::pieces(curve) {
            let before = ends.len();
            // Rounding moves each coordinate by half a unit at most.
            piece
                .chords(tolerance_mm - 1.0 / unit, MAX_HALVINGS, &mut ends)
                .ok_or(WriteError::SpanTooFine { curve: index, line: line_of(part, index) })?;
            count += ends.len() - before;
            if count > MAX_COUNTED {
                return Err(WriteError::TooManyChords { needed: count });
            }
            if count > MAX_CHORDS {
                ends.clear();
            }
        }
        if count > MAX_CHORDS {
            return Ok(());
        }
        ends.pop();
        for end in &mut ends {
            *end = end.map(|x| (x * unit).round() / unit);
        }
        ends.extend(curve.control_points_mm().last());
        program.lines_to_end(ends);
        Ok(())
    })?;
    if count > MAX_CHORDS { Err(WriteError::TooManyChords { needed: count }) } else { readable(text) }
}

/// Writes a part with its curves as FANUC's G06.2. Reading it back gives every control point, weight and knot bit by
/// bit.
///
/// Between curves that do not join stands a G0, which is read back as a rapid move.
///
/// # Errors
/// [`WriteError::CurvedRapid`], [`WriteError::TooLong`].
pub fn write_g06_2(part: &Part) -> Result<String, WriteError> {
    let has_curves = part.curves.iter().any(|curve| !curve.is_straight_move());
    let around = has_curves.then_some(["G05 P10000", "G05 P0"]);
    let text = write(part, around, EXACT_STOP, |program, _, curve| {
        program.path_mode(true);
        for (i, ((point, weight), knot)) in
            curve.control_points_mm().iter().zip(curve.weights()).zip(curve.knots()).enumerate()
        {
            if i == 0 {
                program.word("G06.2 P", curve.degree() + 1);
            }
            program.number("K", *knot);
            program.point(*point);
            program.number("R", *weight);
            program.end_block();
        }
        for knot in curve.knots().iter().skip(curve.control_points_mm().len()) {
            program.number("K", *knot);
            program.end_block();
        }
        Ok(())
    })?;
    readable(text)
}

/// Writes a part with its curves, which have to be planar, as LinuxCNC's G5.2, which has no word for knots.
///
/// A curve of knots 0 …, 1, 2, … is read back bit by bit; one of other uniform knots is the same curve with those
/// knots. Any other is cut at its knots into Bézier curves, which are the same points to rounding. Degree 1, which
/// G5.2 does not have, becomes G1 moves.
///
/// # Errors
/// [`WriteError::NotPlanar`] when z changes along a curve, [`WriteError::CurvedRapid`], [`WriteError::TooLong`].
pub fn write_g5_2(part: &Part) -> Result<String, WriteError> {
    let text = write(part, None, "G61.1", |program, index, curve| {
        let height = curve.control_points_mm().first().map_or(0.0, |point| point[2]);
        if curve.degree() + 1 < LEAST_ORDER {
            program.lines_to_end(curve.control_points_mm().get(1..).unwrap_or_default().to_vec());
        } else if curve.control_points_mm().iter().any(|point| point[2] != height) {
            return Err(WriteError::NotPlanar { curve: index, line: line_of(part, index) });
        } else if has_uniform_knots(curve) {
            program.path_mode(true);
            program.g5_2(curve.degree(), curve.control_points_mm(), curve.weights());
        } else {
            let mut pieces = bezier::pieces(curve);
            // The curve stands still over such a span, and G5.2 has no such curve.
            pieces.retain(|piece| piece.points_mm().windows(2).any(|pair| pair[0] != pair[1]));
            for (number, piece) in pieces.iter().enumerate() {
                let mut points = piece.points_mm();
                program.path_mode(number + 1 == pieces.len());
                if let (true, Some(end), Some(last)) =
                    (number + 1 == pieces.len(), points.last_mut(), curve.control_points_mm().last())
                {
                    *end = *last;
                }
                program.g5_2(curve.degree(), &points, &piece.weights());
            }
        }
        Ok(())
    })?;
    readable(text)
}

/// A program that is not too long to be read back.
fn readable(text: String) -> Result<String, WriteError> {
    if text.len() > MAX_TEXT { Err(WriteError::TooLong { bytes: text.len() }) } else { Ok(text) }
}

fn line_of(part: &Part, curve: usize) -> usize {
    part.moves.get(curve).map_or(0, |one| one.line)
}

/// Writes a part between a first and a last line. `write_curve` writes curves that are neither rapid nor straight
/// moves.
fn write(
    part: &Part,
    around: Option<[&str; 2]>,
    exact_stop: &'static str,
    mut write_curve: impl FnMut(&mut Program, usize, &Curve) -> Result<(), WriteError>,
) -> Result<String, WriteError> {
    let is_planar = !part.curves.iter().any(Curve::leaves_z_0);
    let mut program = Program::new(is_planar, exact_stop);
    around.into_iter().for_each(|[first, _]| program.line(first));
    let all: Vec<_> = part.auxiliary.iter().collect();
    let mut words = Words(&all);
    let mut approaches = part.whole_approaches().into_iter().peekable();
    for (index, (curve, one)) in part.curves.iter().zip(&part.moves).enumerate() {
        while let Some(approach) = approaches.next_if(|approach| approach.block <= one.block) {
            program.auxiliary(words.before(approach.block));
            // If a block makes a curve, its words are written with the curve.
            let is_own = approach.block < one.block && part.approaches_in(approach.block);
            let [ahead, behind] = words.of_block(approach.block, is_own);
            program.auxiliary(&ahead);
            program.approach(&approach, curve, one);
            program.auxiliary(&behind);
        }
        program.auxiliary(words.before(one.block));
        // Several curves may come from one block: its words are written once, at the last of them.
        let is_last = part.moves.get(index + 1).is_none_or(|next| next.block > one.block);
        let [ahead, behind] = words.of_block(one.block, is_last);
        program.auxiliary(&ahead);
        program.curve(index, curve, one, &mut write_curve)?;
        program.auxiliary(&behind);
    }
    program.auxiliary(words.0);
    around.into_iter().for_each(|[_, last]| program.line(last));
    Ok(program.end())
}

/// Whether the knots are those of G5.2, up to origin and unit.
fn has_uniform_knots(curve: &Curve) -> bool {
    let uniform = || uniform_knots(curve.control_points_mm().len(), curve.degree());
    let first = curve.knots().first().copied().unwrap_or(0.0);
    let unit = curve.knots().iter().find(|knot| **knot > first).map_or(1.0, |knot| knot - first);
    uniform().zip(curve.knots()).all(|(u, knot)| first + u * unit == *knot)
}
