//! DXF drawings: their curves, in the order of the file, in millimetres.
//!
//! | entity | groups that are read |
//! |---|---|
//! | SPLINE | 71 degree, 40 knots, 41 weights, 10 20 30 control points; 72 and 73 are their numbers; 42 which knots are equal |
//! | SPLINE without control points | 11 21 31 points to pass through, 12 and 13 the tangents of its ends, 70 whether it is closed |
//! | LINE | 10 20 30 start, 11 21 31 end |
//! | ARC, CIRCLE | 10 20 30 centre, 40 radius, 50 and 51 first and last angle in degrees, counterclockwise |
//! | ELLIPSE | 10 20 30 centre, 11 21 31 from there to the end of the major axis, 40 the minor one's share of it, 41 and 42 first and last angle in rad |
//! | LWPOLYLINE | 10 20 vertices, 42 bulge of the segment that follows, 38 height, 70 whether it is closed |
//! | POLYLINE | 30 height, 70 whether it is closed, or in space; its entities VERTEX: 10 20 30, 42 bulge |
//! | INSERT | 2 block, 10 20 30 place, 41 42 43 scales, 50 angle in degrees, 70 and 71 columns and rows, 44 and 45 their distances |
//!
//! A plane is turned by its normal, 210 220 230. $INSUNITS gives the unit. Knot vectors are converted to clamped ones,
//! and a spline that breaks becomes several curves.
//!
//! Entities on paper (67), invisible ones (60), those on a layer that is frozen (70, bit 1) or off (62 below 0), and
//! all other kinds are left out. One warning counts them by kind. A block that is inserted on a layer that is off shows
//! its entities of other layers; on one that is frozen it shows nothing.
//!
//! # Source
//! Autodesk, DXF Reference, chapters "ENTITIES section" and "Object coordinate systems".

mod affine;
pub(crate) mod binary;
mod block;
mod conic;
mod fit;
mod groups;
mod insert;
mod inserting;
mod item;
mod layout;
mod polyline;
mod reader;
mod spline;

use crate::diagnostic::Report;
use crate::options::Unit;
use crate::part::Part;
use crate::source::Span;
use crate::unit::INCH;
use affine::Affine;
use groups::Groups;
use layout::Layout;
use reader::Reader;

/// Whether a text is a drawing: pairs of a group code and a value, of which the first is `0` and `SECTION`.
pub(crate) fn is_drawing(text: &str) -> bool {
    let mut groups = Groups::new(text, 0);
    loop {
        match groups.next(None) {
            Some(comment) if comment.code == 999 => {}
            first => return first.is_some_and(|first| first.code == 0 && first.text == "SECTION"),
        }
    }
}

/// Reads a drawing into `part`.
pub(crate) fn read(report: &mut Report<'_>, part: &mut Part, given: Option<Unit>) {
    let unit = unit(report, given);
    let layout = Layout::read(report);
    let mut reader = Reader::new(report, part, layout);
    reader.entities(&Affine::scaling([unit; 3]));
    let Reader { left_out, free_ends, .. } = reader;
    if part.curves.is_empty() && !report.has_errors() {
        report
            .error(Span::default(), "the drawing holds no curve")
            .expected("an entity SPLINE, LINE, ARC, CIRCLE, ELLIPSE, LWPOLYLINE, POLYLINE or INSERT");
    }
    if let Some((span, words)) = left_out.words() {
        report.warning_beside_errors(span, format!("left out: {words}"));
    }
    if let Some((span, words)) = free_ends.words() {
        report
            .warning(
                span,
                format!("{words} by points alone, without tangents at the ends: read so that no curvature is there"),
            )
            .hint("CAD systems may draw it otherwise: convert it to control points where it was drawn");
    }
}

/// Units of $INSUNITS, in mm, from 1 on; those that the reference names, up to the decimetre, the hectometre and the feet of surveyors.
const UNITS_MM: [(&str, f64); 20] = [
    ("1", INCH),
    ("2", 12.0 * INCH),
    ("3", 63_360.0 * INCH),
    ("4", 1.0),
    ("5", 10.0),
    ("6", 1000.0),
    ("7", 1e6),
    ("8", 1e-6 * INCH),
    ("9", 1e-3 * INCH),
    ("10", 36.0 * INCH),
    ("11", 1e-7),
    ("12", 1e-6),
    ("13", 1e-3),
    ("14", 100.0),
    ("15", 1e4),
    ("16", 1e5),
    // An inch of surveyors is 100/3937 m.
    ("21", 12.0e5 / 3937.0),
    ("22", 1e5 / 3937.0),
    ("23", 36.0e5 / 3937.0),
    ("24", 63_360.0e5 / 3937.0),
];

/// Millimetres of the drawing's unit; 1 after an error was reported. If the drawing names none, it is the given one.
fn unit(report: &mut Report<'_>, given: Option<Unit>) -> f64 {
    let mut groups = Groups::new(report.source.text, 0);
    while let Some(group) = groups.next(None) {
        if (group.code, group.text) == (0, "ENDSEC") {
            break;
        }
        if (group.code, group.text) != (9, "$INSUNITS") {
            continue;
        }
        let Some(value) = groups.next(None) else { break };
        if value.text == "0" {
            return no_unit(report, value.span, given);
        }
        let named = UNITS_MM.iter().find(|(number, _)| *number == value.text);
        if named.is_none() {
            report
                .error(value.span, format!("the drawing is in the unit {}", value.text))
                .expected("a unit of $INSUNITS from 1 to 16, or 21 to 24: 1 inches, 4 millimetres");
        }
        return named.map_or(1.0, |(_, mm)| *mm);
    }
    no_unit(report, Span::default(), given)
}

fn no_unit(report: &mut Report<'_>, span: Span, given: Option<Unit>) -> f64 {
    if given.is_none() {
        report
            .warning(span, "the drawing names no unit: its numbers are taken as millimetres")
            .hint("`--units mm` or `--units inch` says what they are");
    }
    if given == Some(Unit::Inch) { INCH } else { 1.0 }
}
