//! A part: the curves of one file, in the order in which they are followed.

use crate::approach::Approach;
use crate::bounds::bounding_box_mm;
use crate::curve::Curve;
use crate::diagnostic::Diagnostic;
use crate::machine::Machine;
use crate::unit::INCH;

/// What a part program or a curve file says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// Name of the text, as the caller gave it.
    pub name: String,
    /// The curves, in the order in which they are followed. Never empty in a part that a reader returns.
    pub curves: Vec<Curve>,
    /// What the program says of each curve: `moves[i]` belongs to `curves[i]`.
    pub moves: Vec<Move>,
    /// Moves from where nobody knows, in the order of the program: no curves, but M3 may stand before or behind them.
    pub approaches: Vec<Approach>,
    /// Words that do not move the tool: M, S, T, D and H, and other axes, in the order of the program.
    pub auxiliary: Vec<Auxiliary>,
    /// Lines of moves at feed that end where they start, and so are no curves.
    pub standstills: Vec<usize>,
    /// The feedrate that the program commands, in mm/s; the highest, if it commands several.
    pub feedrate_mm_per_s: Option<f64>,
    /// Whether a part program names no unit of lengths, and millimetres were taken.
    pub unit_is_assumed: bool,
    /// What an extruder pushes, in a program for a 3-D printer.
    pub filament: Option<Filament>,
    /// The machine that the file names, if it does.
    pub machine: Option<Machine>,
    /// Figures that a paper published about the curve: the tables `[table_…]` of a curve file.
    pub published: Option<toml::Table>,
    /// What was read over, and what is odd.
    pub warnings: Vec<Diagnostic>,
}

impl Part {
    /// The highest feedrate that a move commands, in mm/s.
    #[must_use]
    pub fn highest_feedrate(&self) -> Option<f64> {
        self.moves.iter().filter_map(|one| one.feedrate_mm_per_s).reduce(f64::max)
    }

    /// What to say of a unit that was assumed: how large the part is by it, and how large by the other one.
    #[must_use]
    pub fn assumed_unit(&self) -> Option<String> {
        let (least, greatest) = bounding_box_mm(&self.curves).filter(|_| self.unit_is_assumed)?;
        let size = |unit: f64| {
            let side = |axis: usize| format!("{:.1}", (greatest[axis] - least[axis]) * unit);
            format!("{} x {} x {} mm", side(0), side(1), side(2))
        };
        Some(format!(
            "no word names the unit of lengths: millimetres are taken, and the part is {}; in inches it would be {}",
            size(1.0),
            size(INCH)
        ))
    }

    /// Whether a word that does not move the tool stands in the block of this move, in that of the move before it or between
    /// them: the tool rests then between the two. A control begins the next block when the word is done, as FANUC's waits for
    /// the machine's FIN, and LinuxCNC and Grbl let motion end before they switch a spindle or a coolant.
    #[must_use]
    pub(crate) fn has_word_before(&self, next: usize) -> bool {
        let block = |index: usize| self.moves.get(index).map(|one| one.block);
        let Some((before, after)) = next.checked_sub(1).and_then(block).zip(block(next)) else {
            return false;
        };
        let first = self.auxiliary.partition_point(|word| word.block < before);
        let words = self.auxiliary.get(first..).unwrap_or_default();
        words.iter().take_while(|word| word.block <= after).any(|word| !word.is_passed)
    }

    /// Lets the machine pass S words and M3, M4 and M5 without a rest, as [`s_stops`](crate::Machine::s_stops) says.
    pub fn pass_spindle_words(&mut self) {
        for word in &mut self.auxiliary {
            word.is_passed |=
                word.letter == 'S' || word.letter == 'M' && [3.0, 4.0, 5.0].contains(&word.value);
        }
    }
}

/// Highest feedrate that is believed, in mm/s.
pub(crate) const MAX_FEEDRATE: f64 = 1e5;

/// How a curve is to be followed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Move {
    /// At the commanded feedrate, or as fast as the machine can.
    pub kind: MoveKind,
    /// What the program wrote.
    pub shape: Shape,
    /// The feedrate in force, in mm/s.
    pub feedrate_mm_per_s: Option<f64>,
    /// Whether the program wants the tool at rest where the move ends: G9, G61, Siemens' G60. Never of a rapid move,
    /// which a control ends at rest anyhow.
    pub exact_stop: bool,
    /// Line of the block that commands it, from 1.
    pub line: usize,
    /// Number of that block in the order of execution, from 1: a loop executes a line more than once.
    pub block: u32,
}

/// A word that does not move the tool.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Auxiliary {
    /// M, S, T, D or H; A, B, C, U, V or W of an axis that turns the part, E of an extruder that works while the tool rests.
    pub letter: char,
    /// Its number.
    pub value: f64,
    /// Line of its block, from 1.
    pub line: u32,
    /// Number of its block in the order of execution, from 1.
    pub block: u32,
    /// Whether the machine goes on without a rest.
    pub is_passed: bool,
}

impl Auxiliary {
    /// A word in a block of this line and number; the machine rests at it.
    pub(crate) fn new(letter: impl Into<char>, value: f64, line: usize, block: u32) -> Self {
        let line = u32::try_from(line).unwrap_or(u32::MAX);
        Self { letter: letter.into(), value, line, block, is_passed: false }
    }
}

/// The filament that a program for a 3-D printer counts with its words E.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Filament {
    /// The least position that E gets, in mm.
    pub least_mm: f64,
    /// The greatest position that E gets, in mm.
    pub greatest_mm: f64,
}

/// With or without cutting.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum MoveKind {
    /// As fast as the machine can; no feedrate holds.
    Rapid,
    /// At the commanded feedrate.
    Feed,
}

/// What a program or a drawing calls a curve.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum Shape {
    /// A straight line, degree 1.
    Line,
    /// A circular arc or a helix, rational.
    Arc,
    /// A spline as it was given.
    Nurbs,
}
