//! Canonical machining functions to curves: what LinuxCNC's stand-alone interpreter prints, `rs274 -g part.ngc > part.canon`.
//!
//! The interpreter has already evaluated parameters, O-words, cycles and the compensation of the tool's radius. So each
//! line is a move or a switch.
//!
//! | function | meaning |
//! |---|---|
//! | `STRAIGHT_TRAVERSE` `STRAIGHT_FEED` | straight moves: curves of degree 1 |
//! | `ARC_FEED` with `SELECT_PLANE` | arcs, full circles and helices, also of several turns: one curve a turn |
//! | `USE_LENGTH_UNITS`, `SET_G5X_OFFSET`, `SET_G92_OFFSET`, `SET_XY_ROTATION`, `USE_TOOL_LENGTH_OFFSET` | where coordinates are |
//! | `SET_FEED_RATE`, `SET_FEED_MODE`, `START_SPEED_FEED_SYNC` | feed |
//! | `SET_MOTION_CONTROL_MODE`, `DWELL` | exact stops: G61, G61.1, G64, G4; P of G64 |
//! | `SET_NAIVECAM_TOLERANCE` | Q of G64 |
//! | spindle, tool, coolant, stops, outputs | the M, S and T words that made them; listed |
//! | `RIGID_TAP` | to the depth and back, without a feedrate |
//! | `STRAIGHT_PROBE`, `NURBS_FEED` | not read: where they lead is not printed |
//!
//! `ARC_FEED(a, b, centre a, centre b, turns, c, A, B, C)`: (a, b, c) is (x, y, z) in XY, (y, z, x) in YZ and (z, x, y)
//! in XZ. The number of turns counts the last one as one, even if it is only a part of a turn; it is negative
//! clockwise. An arc with equal printed ends is a full turn: an arc shorter than the last decimal cannot be told from
//! it.
//!
//! These rules were found by trial with LinuxCNC 2.9.0, one block and its printed line at a time:
//!
//! - Lengths are in the unit of `USE_LENGTH_UNITS`, which G20 and G21 print: `G20` `G1 X2 F10` prints 2 and a feed of
//!   10 a minute, and numbers after the next G21 are in millimetres. Offsets and the feed are in the unit in force too,
//!   and are not printed again when it changes. Before G20 and G21 the unit is the millimetre.
//! - Coordinates are the program's, as described in [`frame`]: after `G10 L2 P1 X10` and G54, `G0 X1` prints 1. So the
//!   curves of a part are in the coordinates of the system in force at its first move. If another system shifts or
//!   turns later moves, they are shifted and turned as the machine moves. When a tool's length comes into force, the
//!   tip is at another place at once, though nothing moves: a gap.
//! - The interpreter takes the machine to be at zero at first, which is not known: the first straight move is an
//!   [`Approach`](crate::Approach).
//! - Numbers have four decimals, in millimetres or inches; no option prints more. The end of an arc may be off its
//!   circle by that, or by the distance that LinuxCNC accepts. Any distance is accepted here, and the path goes from
//!   one radius to the other.
//! - In G93 the feed of each move is printed per minute. In G95, in threads and in rigid tapping it is per revolution:
//!   such moves have no feedrate.
//! - Cycles are cut in G61 and switch back to G64 when they end.
//! - Errors go to the standard error output, with status 1, and the lines end there. The text of `(print, …)` stands
//!   among the lines.

mod call;
mod frame;
mod motion;

use domains::machine::FEED;
use domains::shown;

use crate::arc::Plane;
use crate::auxiliary::Auxiliary;
use crate::canon::call::Call;
use crate::canon::frame::Frame;
use crate::diagnostic::{Diagnostic, Report};
use crate::exact_stops::{ExactStops, PathMode};
use crate::options::ReadOptions;
use crate::part::Part;
use crate::path_tolerance::PathTolerance;
use crate::source::Span;
use crate::unit::INCH;

/// Functions that do not affect the path and that no M, S or T word makes.
const WITHOUT_EFFECT: [&str; 20] = [
    "CHANGE_TOOL_NUMBER",
    "COMMENT",
    "FINISH",
    "LOGAPPEND",
    "LOGCLOSE",
    "LOGOPEN",
    "MESSAGE",
    "ON_RESET",
    "RELOAD_TOOLDATA",
    "SET_CUTTER_RADIUS_COMPENSATION",
    "SET_FEED_REFERENCE",
    "SET_SPINDLE_MODE",
    "SET_TRAVERSE_RATE",
    "START_CHANGE",
    "START_CUTTER_RADIUS_COMPENSATION",
    "STOP_CUTTER_RADIUS_COMPENSATION",
    "TURN_PROBE_OFF",
    "TURN_PROBE_ON",
    "UNCLAMP_AXIS",
    "CLAMP_AXIS",
];

/// Functions that an M word makes, each with the word's number.
const SWITCHES: [(&str, f64); 28] = [
    ("PROGRAM_STOP", 0.0),
    ("OPTIONAL_PROGRAM_STOP", 1.0),
    ("PROGRAM_END", 2.0),
    ("START_SPINDLE_CLOCKWISE", 3.0),
    ("START_SPINDLE_COUNTERCLOCKWISE", 4.0),
    ("STOP_SPINDLE_TURNING", 5.0),
    ("CHANGE_TOOL", 6.0),
    ("MIST_ON", 7.0),
    ("FLOOD_ON", 8.0),
    ("MIST_OFF", 9.0),
    ("FLOOD_OFF", 9.0),
    ("ORIENT_SPINDLE", 19.0),
    ("ENABLE_FEED_OVERRIDE", 50.0),
    ("DISABLE_FEED_OVERRIDE", 50.0),
    ("ENABLE_SPEED_OVERRIDE", 51.0),
    ("DISABLE_SPEED_OVERRIDE", 51.0),
    ("ENABLE_ADAPTIVE_FEED", 52.0),
    ("DISABLE_ADAPTIVE_FEED", 52.0),
    ("ENABLE_FEED_HOLD", 53.0),
    ("DISABLE_FEED_HOLD", 53.0),
    ("PALLET_SHUTTLE", 60.0),
    ("SET_MOTION_OUTPUT_BIT", 62.0),
    ("CLEAR_MOTION_OUTPUT_BIT", 63.0),
    ("SET_AUX_OUTPUT_BIT", 64.0),
    ("CLEAR_AUX_OUTPUT_BIT", 65.0),
    ("WAIT", 66.0),
    ("SET_MOTION_OUTPUT_VALUE", 67.0),
    ("SET_AUX_OUTPUT_VALUE", 68.0),
];

/// Whether a text is output of `rs274`: its first line is, not counting what the interpreter prints when it begins.
pub(crate) fn is_canon(text: &str) -> bool {
    let mut lines = text.lines().filter(|line| !is_chatter(line)).take(1);
    lines.any(|line| Call::of(line, 0).is_some())
}

/// A line without a function: empty, or `executing`, which goes to the standard error output.
fn is_chatter(line: &str) -> bool {
    ["", "executing"].contains(&line.trim())
}

/// Reads canonical functions into `part`. Errors and warnings go to the report.
pub(crate) fn read(report: &mut Report<'_>, part: &mut Part, options: ReadOptions) {
    let text = report.source.text;
    let mut reader = Reader::new(report, part, options);
    let mut at = 0;
    for (index, line) in text.split_inclusive('\n').enumerate() {
        reader.line = index + 1;
        reader.read_line(line, at);
        at += line.len();
    }
    reader.finish(Span::new(text.len(), text.len()));
}

/// The unit of the feed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
enum FeedMode {
    /// Length a minute.
    #[default]
    PerMinute,
    /// Length a revolution of the spindle.
    PerRevolution,
}

/// A remark that is made once for a text.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Once {
    Text,
    Dwell,
    Revolution,
    Rotary,
}

/// A text that is being read.
struct Reader<'r, 't, 'p> {
    report: &'r mut Report<'t>,
    part: &'p mut Part,
    options: ReadOptions,
    /// Number of the line that is being read, from 1.
    line: usize,
    /// Millimetres of the unit in force.
    unit: f64,
    plane: Plane,
    frame: Frame,
    /// The frame of the first move, whose coordinates are those of the part.
    first_frame: Option<Frame>,
    /// The place of the tip in the part; unknown before the first move, and after a move that is not read.
    position: Option<[f64; 3]>,
    /// Places of rotary axes and second linear axes after the last move.
    rotary: [f64; 6],
    feed_mode: FeedMode,
    /// Threading: the feed follows the spindle.
    is_synchronous: bool,
    feedrate_mm_per_s: Option<f64>,
    path_mode: PathMode,
    /// P and Q of G64, in mm, as far as they are printed.
    tolerance_mm: [Option<f64>; 2],
    stops: ExactStops,
    said: Vec<Once>,
    /// `PROGRAM_END`, or `FINISH` of a program between two `%`.
    has_end: bool,
}

impl<'r, 't, 'p> Reader<'r, 't, 'p> {
    fn new(report: &'r mut Report<'t>, part: &'p mut Part, options: ReadOptions) -> Self {
        Self {
            report,
            part,
            options,
            line: 0,
            unit: 1.0,
            plane: Plane::Xy,
            frame: Frame::default(),
            first_frame: None,
            position: options.start_mm,
            rotary: [0.0; 6],
            feed_mode: FeedMode::PerMinute,
            is_synchronous: false,
            feedrate_mm_per_s: None,
            path_mode: PathMode::default(),
            tolerance_mm: [None; 2],
            stops: ExactStops::default(),
            said: Vec::new(),
            has_end: false,
        }
    }

    /// Number of the line, in whose order canon lines are executed.
    fn block(&self) -> u32 {
        u32::try_from(self.line).unwrap_or(u32::MAX)
    }

    fn read_line(&mut self, line: &str, start: usize) {
        if is_chatter(line) {
            return;
        }
        match Call::of(line, start) {
            Some(call) => self.call(&call),
            None => {
                let span = Span::new(start, start + line.trim_end().len());
                self.say_once(Once::Text, span, "a line that is no canonical function is not read").map(
                    |said| {
                        said.hint("`(print, …)` writes such lines, and errors of the interpreter are such")
                    },
                );
            }
        }
    }

    /// Executes one function.
    fn call(&mut self, call: &Call<'_>) {
        match call.name {
            "STRAIGHT_TRAVERSE" | "STRAIGHT_FEED" => self.straight(call),
            "ARC_FEED" => self.arc(call),
            "RIGID_TAP" => self.tap(call),
            "STRAIGHT_PROBE" | "NURBS_FEED" | "SPINDLE_RETRACT_TRAVERSE" => self.lose(call),
            "USE_LENGTH_UNITS" => self.length_units(call),
            "SELECT_PLANE" => self.select_plane(call),
            "SET_G5X_OFFSET" => self.offset(call, |frame, offset| frame.g5x = offset),
            "SET_G92_OFFSET" => self.offset(call, |frame, offset| frame.g92 = offset),
            "USE_TOOL_LENGTH_OFFSET" => self.tool_length(call),
            "SET_XY_ROTATION" => self.rotation(call),
            "SET_FEED_RATE" => self.feed_rate(call),
            "SET_FEED_MODE" => self.set_feed_mode(call),
            "START_SPEED_FEED_SYNC" | "START_SPEED_FEED_SYNCH" => self.is_synchronous = true,
            "STOP_SPEED_FEED_SYNC" | "STOP_SPEED_FEED_SYNCH" => self.is_synchronous = false,
            "SET_MOTION_CONTROL_MODE" => self.motion_control_mode(call),
            "SET_NAIVECAM_TOLERANCE" => self.merging_tolerance(call),
            "DWELL" => {
                let said = "dwells: the tool rests, and for how long is no part of the path";
                self.say_once(Once::Dwell, call.span, said).map(Diagnostic::note);
                self.rest();
            }
            "SET_SPINDLE_SPEED" => self.word(call, 'S', |numbers| numbers.last()),
            "SELECT_TOOL" => self.word(call, 'T', |numbers| numbers.first()),
            "CANON_ERROR" => drop(self.report.error(call.span, "the interpreter found an error here")),
            name => self.switch(call, name),
        }
    }

    /// Executes a function that an M word made, ignores one without effect, and refuses an unknown one.
    fn switch(&mut self, call: &Call<'_>, name: &str) {
        self.has_end |= ["PROGRAM_END", "FINISH"].contains(&name);
        let name = if name.ends_with(".WAIT_ORIENT_COMPLETE") { "ORIENT_SPINDLE" } else { name };
        if let Some((_, value)) = SWITCHES.iter().find(|(switch, _)| *switch == name) {
            self.part.auxiliary.push(Auxiliary::new(b'M', *value, self.line, self.block()));
        } else if !WITHOUT_EFFECT.contains(&name) {
            let message = format!("the canonical function `{name}` is not known");
            self.refuse(call.span, message, "a function of rs274 as LinuxCNC 2.9 prints it");
        }
    }

    /// Lists a word that does not move the tool.
    fn word(&mut self, call: &Call<'_>, letter: char, pick: impl Fn(&[f64]) -> Option<&f64>) {
        let numbers = call.numbers();
        let value = numbers.as_ref().and_then(|numbers| pick(numbers.split::<0>()?.1)).copied();
        match value {
            Some(value) => self.part.auxiliary.push(Auxiliary::new(letter, value, self.line, self.block())),
            None => self.malformed(call, "a number"),
        }
    }

    fn length_units(&mut self, call: &Call<'_>) {
        self.unit = match call.arguments {
            Some("CANON_UNITS_MM") => 1.0,
            Some("CANON_UNITS_INCHES") => INCH,
            Some("CANON_UNITS_CM") => 10.0,
            _ => return self.malformed(call, "CANON_UNITS_MM or CANON_UNITS_INCHES"),
        };
    }

    fn select_plane(&mut self, call: &Call<'_>) {
        self.plane = match call.arguments {
            Some("CANON_PLANE_XY") => Plane::Xy,
            Some("CANON_PLANE_XZ") => Plane::Zx,
            Some("CANON_PLANE_YZ") => Plane::Yz,
            _ => return self.malformed(call, "CANON_PLANE_XY, CANON_PLANE_XZ or CANON_PLANE_YZ"),
        };
    }

    /// An offset, given by the last six numbers at most; the first number of `SET_G5X_OFFSET` is that of the system.
    fn offset(&mut self, call: &Call<'_>, set: impl Fn(&mut Frame, [f64; 3])) {
        let skipped = usize::from(call.name == "SET_G5X_OFFSET");
        let numbers = call.numbers();
        let offset =
            numbers.as_ref().and_then(|numbers| numbers.split::<0>()?.1.get(skipped..)?.first_chunk::<3>());
        let Some(offset) = offset else { return self.malformed(call, "at least three offsets") };
        let offset = offset.map(|x| x * self.unit);
        set(&mut self.frame, offset);
    }

    /// When another tool length comes into force, the tip is at another place at once, since the machine stands still.
    fn tool_length(&mut self, call: &Call<'_>) {
        let numbers = call.numbers();
        let Some((offset, _)) = numbers.as_ref().and_then(|numbers| numbers.split::<3>()) else {
            return self.malformed(call, "at least three offsets");
        };
        let offset = offset.map(|x| x * self.unit);
        if let Some(position) = &mut self.position {
            *position = std::array::from_fn(|axis| position[axis] - (offset[axis] - self.frame.tool[axis]));
        }
        self.frame.tool = offset;
    }

    fn rotation(&mut self, call: &Call<'_>) {
        match call.numbers().as_ref().and_then(|numbers| numbers.split::<1>()) {
            Some(([degrees], _)) => self.frame.rotation = degrees.to_radians(),
            None => self.malformed(call, "an angle"),
        }
    }

    fn feed_rate(&mut self, call: &Call<'_>) {
        let Some(([rate], _)) = call.numbers().as_ref().and_then(|numbers| numbers.split::<1>()) else {
            return self.malformed(call, "a feed");
        };
        let feedrate = rate * self.unit / 60.0;
        if feedrate < 0.0 {
            return self.malformed(call, "a feed of at least 0");
        }
        if feedrate > FEED.most() {
            let feedrate = shown(feedrate.round());
            let message =
                format!("{feedrate} mm/s are as fast as any machine can: the machine's own feed is taken");
            self.report.of_kind(false, call.span, "fast", message);
        }
        // The interpreter prints 0 if no feed is set.
        self.feedrate_mm_per_s = Some(feedrate).filter(|feedrate| FEED.holds(*feedrate));
    }

    /// `SET_FEED_MODE(spindle, mode)`, or without a spindle in older versions.
    fn set_feed_mode(&mut self, call: &Call<'_>) {
        let numbers = call.numbers();
        let mode = numbers.as_ref().and_then(|numbers| numbers.split::<0>()?.1.last());
        match mode {
            Some(0.0) => self.feed_mode = FeedMode::PerMinute,
            Some(1.0) => self.feed_mode = FeedMode::PerRevolution,
            _ => self.malformed(call, "0, per minute, or 1, per revolution"),
        }
    }

    fn motion_control_mode(&mut self, call: &Call<'_>) {
        let mut arguments = call.arguments.unwrap_or_default().split(',').map(str::trim);
        self.path_mode = match (arguments.next(), arguments.next().map(str::parse)) {
            (Some("CANON_CONTINUOUS"), Some(Ok(p))) if f64::is_finite(p) => {
                self.tolerance_mm[0] = Some(p * self.unit);
                self.continuous()
            }
            (Some("CANON_CONTINUOUS"), None) => PathMode::Continuous(None),
            (Some("CANON_EXACT_PATH"), _) => PathMode::ExactPath,
            (Some("CANON_EXACT_STOP"), _) => PathMode::ExactStop,
            (Some("CANON_CONTINUOUS"), _) => {
                return self.malformed(call, "a tolerance behind CANON_CONTINUOUS");
            }
            _ => return self.malformed(call, "CANON_CONTINUOUS, CANON_EXACT_PATH or CANON_EXACT_STOP"),
        };
    }

    /// Q of G64, behind its P.
    fn merging_tolerance(&mut self, call: &Call<'_>) {
        let Some(([q], _)) = call.numbers().as_ref().and_then(|numbers| numbers.split::<1>()) else {
            return self.malformed(call, "a tolerance");
        };
        self.tolerance_mm[1] = Some(q * self.unit);
        if matches!(self.path_mode, PathMode::Continuous(Some(_))) {
            self.path_mode = self.continuous();
        }
    }

    fn continuous(&self) -> PathMode {
        let [p_mm, q_mm] = self.tolerance_mm;
        PathMode::Continuous(PathTolerance::of(p_mm, q_mm))
    }

    /// Reports what is missing at the end of a text, and sets the highest feedrate.
    fn finish(self, end: Span) {
        self.part.feedrate_mm_per_s = self.part.highest_feedrate();
        if !self.has_end {
            self.report
                .warning(end, "there is no PROGRAM_END: the interpreter did not come to an end of the program")
                .hint("what it found wrong it writes to the standard error output; M2 at the end of the program is also missed");
        }
        if self.part.curves.is_empty() && !self.report.has_errors() {
            self.report
                .error(Span::new(0, 0), "the program holds no curve")
                .expected("a move from one point to another");
        }
    }

    /// Reports a function whose arguments are wrong.
    fn malformed(&mut self, call: &Call<'_>, expected: &str) {
        let message = format!("`{}` is not as rs274 prints it", call.name);
        self.report.error(call.span, message).expected(expected);
    }

    /// An error, or a warning for a lenient reader.
    fn refuse(&mut self, span: Span, message: impl Into<String>, expected: &str) {
        if self.options.lenient {
            self.report.warning(span, message).expected(expected);
        } else {
            self.report.error(span, message).expected(expected);
        }
    }

    /// Warns of something that may be in every line, only the first time.
    fn say_once(&mut self, what: Once, span: Span, message: &str) -> Option<&mut Diagnostic> {
        if self.said.contains(&what) {
            return None;
        }
        self.said.push(what);
        Some(self.report.warning(span, message))
    }
}
