//! `part-program`: which path does a text describe, and where does it have faults?
//!
//! | text | reader | writer |
//! |---|---|---|
//! | curve file: TOML, tables `[curve]` or `[[curve]]`, and `[machine]` | [`read_part`] | [`write_curves`] |
//! | curve file with `shape = "trigonometric"`: paper B's splines | [`read_part`] | |
//! | part program: G0 to G3, cycles, variables, loops and subprograms | [`read_part`] | [`write_g1`] |
//! | splines as FANUC writes them, G06.2 | [`read_part`] | [`write_g06_2`] |
//! | splines as LinuxCNC writes them, G5.2, G5, G5.1 | [`read_part`] | [`write_g5_2`] |
//! | splines as Siemens writes them, BSPLINE | [`read_part`] | |
//! | tool table: LinuxCNC's, or CSV | [`ToolTable::read`] | |
//! | what LinuxCNC's `rs274 -g` prints of a part program | [`read_part`] | |
//! | drawing: DXF, as text or binary | [`read_part_bytes`] | |
//! | JSON as geomdl exports it | [`read_part`] | |
//! | machine file: TOML, table `[machine]` | [`read_machine`]; its limits alone, of which some may be missing, [`read_limits`] | |
//!
//! The content of a text tells its kind. [`read_part_with`] is given a known dialect, and may skip unknown words;
//! [`read_part_bytes`] reads the bytes of a file. [`inspect`] finds a part's lengths, bends, joints, and oddities;
//! [`bounding_box_mm`] finds the bounds of curves. [`Part::rounded`] gives coordinates fewer decimals, and returns how
//! far that moves a path; [`Part::in_ratio_words`] does the same for knots and weights.
//!
//! ```
//! let part = part_program::read_part("seed.nc", "G06.2 P2 K0 X0 Y0\nK0 X10 Y5\nK1\nK1\n")?;
//! assert_eq!((part.curves[0].degree(), part.curves[0].knots().len()), (1, 4));
//!
//! let fault = part_program::read_part("bad.nc", "G06.2 P2 K0 X0 Y0\nX10 Y5\n").unwrap_err();
//! assert!(fault.to_string().contains("bad.nc:2:1"));
//! # Ok::<(), part_program::Diagnostics>(())
//! ```
//!
//! Every fault of a text is reported, with line, column, the correct form and a hint; nothing is dropped silently.
//!
//! STEP is not read. The only parser for its text, `ruststep` (0.4, which `truck-stepio` uses too), panics at a whole
//! number beyond 64 bits, overflows the stack at nested brackets and refuses every file with an apostrophe in a name.
//! So it cannot be given unknown files. CAD systems export the same curves as DXF.

mod approach;
mod arc;
mod assumed_value;
mod auxiliary;
mod axis_limits;
mod bend;
mod bezier;
mod bounds;
mod canon;
mod clamp;
mod curve;
mod curve_fault;
mod curve_file;
mod curve_numbers;
mod diagnostic;
mod drawing;
mod ellipse;
mod exact_stops;
mod gcode;
mod geomdl;
mod inspect;
mod joint;
mod kinds;
mod lean_toml;
mod machine;
mod moves;
mod options;
mod part;
mod path_tolerance;
mod ratio_words;
mod remark;
mod rest;
mod rounding;
mod side_axes;
mod source;
mod spline_blocks;
mod text_length;
mod toml_table;
mod tool_table;
mod trig_curve;
mod unit;
mod vector;
mod words_to_write;
mod write;
mod write_curves;
mod write_error;
mod written_program;

pub use approach::Approach;
pub use arc::HELIX_TOLERANCE_MM;
pub use assumed_value::AssumedValue;
pub use auxiliary::Auxiliary;
pub use axis_limits::{Axes, AxisLimits, RotaryLimits, SideLimits};
pub use bounds::bounding_box_mm;
pub use curve::{Curve, End, MAX_COORDINATE_MM, MAX_DEGREE, MAX_KNOT, MAX_WEIGHT, Nurbs};
pub use curve_fault::{CurveFault, Element};
pub use diagnostic::{Diagnostic, Diagnostics, MAX_DIAGNOSTICS, Severity};
pub use gcode::{KnownWord, WordUse, known_words};
pub use inspect::{Bend, Inspection, inspect};
pub use joint::{GAP_MM, Joint, Joints, TANGENT_BREAK_RAD, is_joined};
pub use machine::{Junction, Machine, StatedLimits, coarse_increment_mm, read_limits, read_machine};
pub use moves::{Move, MoveKind, Shape};
pub use options::{Dialect, ReadOptions, Unit};
pub use part::{Filament, Part};
pub use path_tolerance::{PathTolerance, ToleranceFrom};
pub use ratio_words::{NoLargestRatio, RatioLost, RatioWords};
pub use remark::{Oddity, Remark, SHORT_SPAN, TINY_MM, WEIGHT_RATIO};
pub use rest::Rest;
pub use rounding::{Rounded, StandsStill};
pub use side_axes::{SIDE_AXES, SideMove};
pub use text_length::{MAX_PROGRAM, MAX_TEXT};
pub use toml_table::nearest;
pub use tool_table::ToolTable;
pub use write::{write_g1, write_g5_2, write_g06_2};
pub use write_curves::write_curves;
pub use write_error::WriteError;

use source::Span;
use text_length::{opened, too_long};

/// Reads a part: a curve file, a part program or a drawing, told by its content. Diagnostics call it `name`.
///
/// # Errors
/// Every fault of the text.
pub fn read_part(name: &str, text: &str) -> Result<Part, Diagnostics> {
    read_part_with(name, text, ReadOptions::default())
}

/// Reads a part from a file's bytes: UTF-8, or else Latin-1, as older controls and editors write their comments; or a binary drawing.
///
/// # Errors
/// As [`read_part_with`].
pub fn read_part_bytes(name: &str, bytes: &[u8], options: ReadOptions) -> Result<Part, Diagnostics> {
    read_part_bytes_with(name, bytes, options, &ToolTable::default())
}

/// Reads a part from a file's bytes as [`read_part_bytes`] does, with the tools that cutter compensation needs.
///
/// # Errors
/// As [`read_part_with`].
pub fn read_part_bytes_with(
    name: &str,
    bytes: &[u8],
    options: ReadOptions,
    tools: &ToolTable,
) -> Result<Part, Diagnostics> {
    if bytes.starts_with(drawing::binary::SENTINEL) {
        return read_part_with(name, &drawing::binary::as_text(name, bytes)?, options);
    }
    match std::str::from_utf8(bytes) {
        Ok(text) => read_text(name, text, options, tools),
        // Latin-1 at most doubles in length: a text that is too long is refused before it is copied.
        Err(_) if bytes.len() > MAX_PROGRAM => Err(too_long(name, bytes.len(), MAX_PROGRAM)),
        Err(_) => {
            let text: String = bytes.iter().map(|byte| char::from(*byte)).collect();
            read_text(name, &text, options, tools)
        }
    }
}

/// Reads a part as [`read_part`] does, with options.
///
/// # Errors
/// Every fault of the text; with `lenient`, unknown words are warnings instead.
pub fn read_part_with(name: &str, text: &str, options: ReadOptions) -> Result<Part, Diagnostics> {
    read_text(name, text, options, &ToolTable::default())
}

fn read_text(name: &str, text: &str, options: ReadOptions, tools: &ToolTable) -> Result<Part, Diagnostics> {
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    if text.as_bytes().starts_with(drawing::binary::SENTINEL) {
        return read_part_bytes_with(name, text.as_bytes(), options, tools);
    }
    if text.contains('\r') && !text.contains('\n') {
        // The text keeps its length, so that every place in it stays the same.
        return read_lines(name, &text.replace('\r', "\n"), options, tools);
    }
    read_lines(name, text, options, tools)
}

/// Reads a part from a text whose lines end with LF.
fn read_lines(name: &str, text: &str, options: ReadOptions, tools: &ToolTable) -> Result<Part, Diagnostics> {
    let is_program =
        options.dialect == Some(Dialect::Canon) || canon::is_canon(text) || is_part_program(text, options);
    let mut report = opened(name, text, if is_program { MAX_PROGRAM } else { MAX_TEXT })?;
    let mut part = Part { name: name.to_owned(), ..Part::default() };
    if let Some((format, hint)) = unread(text) {
        report
            .error(Span::default(), format!("this is {format}, which is not read"))
            .expected(READ)
            .hint(hint);
    } else if options.dialect == Some(Dialect::Canon) || canon::is_canon(text) {
        canon::read(&mut report, &mut part, options);
    } else if text.trim_start().starts_with('{') {
        geomdl::read(&mut report, &mut part);
    } else if drawing::is_drawing(text) {
        drawing::read(&mut report, &mut part, options.unit);
    } else if options.dialect.is_none() && is_toml(text) {
        if let Some(file) = curve_file::read(&mut report, text) {
            (part.curves, part.moves) = file.curves.into_iter().unzip();
            part.feedrate_mm_per_s = part.highest_feedrate();
            part.machine = file.machine;
            part.published = file.published;
        }
    } else {
        gcode::read(&mut report, &mut part, options, tools);
    }
    part.warnings = report.finish()?;
    Ok(part)
}

/// Whether a text is none of the other kinds.
fn is_part_program(text: &str, options: ReadOptions) -> bool {
    let is_other = text.trim_start().starts_with('{') || drawing::is_drawing(text);
    !is_other && (options.dialect.is_some() || !is_toml(text))
}

/// The kinds of texts.
const READ: &str =
    "a part program, what rs274 prints of one, a curve file (TOML), a drawing (DXF) or geomdl's JSON";

/// The name of another kind of text, with a hint how to read it.
fn unread(text: &str) -> Option<(&'static str, &'static str)> {
    const EXPORT: &str = "export the curves as DXF (text), where a spline is an entity SPLINE";
    let changed = "a binary DXF file whose first bytes were changed, as a transfer of text does,";
    [("ISO-10303-21", "a STEP file"), ("AutoCAD Binary DXF", changed), ("AC10", "a DWG file")]
        .into_iter()
        .find(|(begin, _)| text.trim_start().starts_with(begin))
        .map(|(_, format)| (format, EXPORT))
}

/// Whether the first line that is neither empty nor a comment opens a table of TOML or gives a value to a key. Later
/// lines do not count, since a part program may have similar ones: an O-word's name looks like a key, and expressions
/// stand in brackets.
fn is_toml(text: &str) -> bool {
    let is_comment = |line: &&str| {
        line.is_empty() || line.starts_with('#') && !line[1..].trim_start().starts_with(is_parameter)
    };
    let Some(line) = text.lines().map(str::trim).find(|line| !is_comment(line)) else { return false };
    let key = line.split('=').next().unwrap_or("").trim_end();
    let is_key = key.len() < line.len()
        && key.len() > 2
        && key.chars().all(|c| c.is_ascii_lowercase() || c == '_' || c.is_ascii_digit());
    is_key || line.starts_with('[')
}

/// The characters that follow the `#` of a variable, and rarely that of a comment.
fn is_parameter(c: char) -> bool {
    c.is_ascii_digit() || c == '<'
}
