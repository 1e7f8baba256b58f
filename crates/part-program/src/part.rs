//! A part: the curves of one file, in the order in which they are followed.

use crate::approach::Approach;
use crate::auxiliary::Auxiliary;
use crate::bounds::bounding_box_mm;
use crate::curve::Curve;
use crate::diagnostic::Diagnostic;
use crate::machine::Machine;
use crate::moves::{Move, MoveKind};
use crate::path_tolerance::ToleranceFrom;
use crate::side_axes::SideMove;
use crate::unit::INCH;

/// The contents of a part program or a curve file.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Part {
    /// Name of the text, as the caller gave it.
    pub name: String,
    /// The curves, in the order in which they are followed. Never empty in a part that a reader returns.
    pub curves: Vec<Curve>,
    /// The moves: `moves[i]` belongs to `curves[i]`.
    pub moves: Vec<Move>,
    /// How the side axes move along the curves, in the order of the curves. Empty unless one moves while the tool cuts.
    pub side_moves: Vec<SideMove>,
    /// Where the program changes how far from its path the control may go, in the order of the moves; none is stated before the first.
    pub tolerances: Vec<ToleranceFrom>,
    /// Moves from an unknown place, in the order of the program. They are not curves, but M3 may stand before or after
    /// them.
    pub approaches: Vec<Approach>,
    /// Words that do not move the tool: M, S, T, D and H, and other axes, in the order of the program.
    pub auxiliary: Vec<Auxiliary>,
    /// The words that were read and that neither the path nor its other words hold, such as a printer's E and M106: `3 E, 1 M106`.
    /// Those that are resolved, as offsets and calls, are not among them.
    pub left_out: Option<String>,
    /// Lines of moves at feed that end where they start, and so are not curves.
    pub standstills: Vec<usize>,
    /// The feedrate that the program commands, in mm/s; the highest, if it commands several.
    pub feedrate_mm_per_s: Option<f64>,
    /// Whether a part program names no unit of lengths, and millimetres were taken.
    pub unit_is_assumed: bool,
    /// The filament of an extruder, in a program for a 3-D printer.
    pub filament: Option<Filament>,
    /// The machine in the file, if it has one.
    pub machine: Option<Machine>,
    /// Figures that a paper published about the curve: the tables `[table_…]` of a curve file.
    pub published: Option<toml::Table>,
    /// Remarks about words that were skipped, and oddities.
    pub warnings: Vec<Diagnostic>,
}

impl Part {
    /// The highest feedrate that a move commands, in mm/s.
    #[must_use]
    pub fn highest_feedrate(&self) -> Option<f64> {
        self.moves.iter().filter_map(|one| one.feedrate_mm_per_s).reduce(f64::max)
    }

    /// A remark about a unit that was assumed: the size of the part in this unit and in the other one.
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

    /// Whether the tool rests before this move at a word that does not move the tool: in the block of this move, in
    /// that of the move before it, or between them. A control begins the next block when the word is done: FANUC's
    /// waits for the machine's FIN, and LinuxCNC and Grbl let motion end before they switch a spindle or a coolant.
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

    /// Makes the machine pass S words and M3, M4 and M5 without a rest, as [`s_stops`](crate::Machine::s_stops) allows.
    pub fn pass_spindle_words(&mut self) {
        for word in &mut self.auxiliary {
            word.is_passed |=
                word.letter == 'S' || word.letter == 'M' && [3.0, 4.0, 5.0].contains(&word.value);
        }
    }

    /// Whether the part gives the place of Z: in a word Z, or with a third coordinate.
    pub(crate) fn names_z(&self) -> bool {
        let in_space = |curve: &Curve| curve.dimension() == 3 || curve.leaves_z_0();
        self.approaches.iter().any(|approach| approach.axes[2]) || self.curves.iter().any(in_space)
    }

    /// Whether this block is an approach.
    pub(crate) fn approaches_in(&self, block: u32) -> bool {
        self.approaches.binary_search_by_key(&block, |approach| approach.block).is_ok()
    }

    /// The approaches. Axes of the first curve that none of them makes known are added to them.
    pub(crate) fn whole_approaches(&self) -> Vec<Approach> {
        let mut approaches = self.approaches.clone();
        let Some(first) = self.moves.first() else { return approaches };
        let own = approaches.partition_point(|approach| approach.block <= first.block);
        let is_needed = [true, true, self.names_z()];
        let missing = std::array::from_fn(|axis| {
            is_needed[axis] && !approaches[..own].iter().any(|approach| approach.axes[axis])
        });
        let rapid = |axes, (line, block)| Approach {
            axes,
            kind: MoveKind::Rapid,
            feedrate_mm_per_s: None,
            line,
            block,
        };
        let begin = (first.line, first.block);
        if own == 0 {
            let switch = self.first_switch().filter(|word| word.block < first.block);
            approaches
                .insert(0, rapid(missing, switch.map_or(begin, |word| (word.line as usize, word.block))));
            return approaches;
        }
        // The place in the plane, and a height above it, are reached before a word behind the first approach is
        // executed. The way down comes last.
        let goes_up = self.curves[0].control_points_mm().first().is_some_and(|point| point[2] > 0.0);
        approaches[0].axes[0] |= missing[0];
        approaches[0].axes[1] |= missing[1];
        approaches[0].axes[2] |= missing[2] && goes_up;
        if missing[2] && !goes_up {
            let down = Approach { kind: MoveKind::Feed, ..rapid([false, false, true], begin) };
            approaches.insert(own, down);
        }
        approaches
    }

    /// The first word that may switch the tool on: any M word but the tool change.
    fn first_switch(&self) -> Option<&Auxiliary> {
        self.auxiliary.iter().find(|word| word.letter == 'M' && word.value != 6.0)
    }
}

/// The filament that a program for a 3-D printer counts in its words E.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Filament {
    /// The least position of E, in mm.
    pub least_mm: f64,
    /// The greatest position of E, in mm.
    pub greatest_mm: f64,
}
